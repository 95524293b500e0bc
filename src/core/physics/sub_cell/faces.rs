//! Fronts on faces between particles.
//!
//! A front that has left one cell and not yet entered the next lies on the face between the two, while the particle that
//! it is to enter still has to give off what its unfrozen cell holds above the freezing point, or, frozen, to take up what
//! it lacks. That particle counts as one that freezes, with a frozen fraction of 0 or 1. Otherwise a front could not leave
//! a cell before the next is at the freezing point as a whole: where heat from both sides is nearly in balance it would wait
//! there, half of the time and by a quarter of a spacing on average.
//!
//! The front enters the particle whose potential is nearer to that of freezing: the other side drives it.

use super::extent::Extent;
use super::phases::Phases;
use crate::memory::HeapSize;
use crate::physics::laws::Laws;
use crate::physics::sharp_stretches::{Sharp, Stretch, material_of};
use crate::space::lattice::Lattice;

/// Bytes that are read at once.
const WORD: usize = size_of::<u64>();

/// Faces of a body at which fronts lie.
#[derive(Debug, Clone, Default)]
pub(super) struct Faces {
    /// Particles that have neighbours in one direction, the first and one past the last, and how many numbers further these
    /// are.
    neighbours: Vec<(u32, u32, u32)>,
    /// Neighbours between which a front lies.
    apart: Vec<(u32, u32)>,
    /// Particles that are entered, by material and number.
    entered: Vec<(u32, u32)>,
    /// A bit for each particle: whether it is entered. There is a word of bytes from each on.
    marks: Vec<u8>,
}

impl Faces {
    /// Faces of a lattice across which fronts may move.
    pub(super) fn new(lattice: &Lattice, extent: &Extent) -> Self {
        let mut neighbours = Vec::new();
        let rows = if extent.free { lattice.rows } else { 0 };
        let along_rows = extent.along_y != Some(true);
        let along_columns = lattice.dimension > 1 && extent.along_y != Some(false);
        // Rows, of which each has one above it, or the first again.
        for row in 0..rows {
            let (first, end) = (lattice.start(row) as u32, lattice.start(row + 1) as u32);
            if along_rows && end - first > 1 {
                neighbours.push((first, end - 1, 1));
                // Of two that repeat, each is the other's neighbour on both sides.
                if extent.repeats[0] && end - first > 2 {
                    neighbours.push((first, first + 1, end - 1 - first));
                }
            }
            let last = row + 1 == lattice.rows;
            if !along_columns || last && !(extent.repeats[1] && lattice.rows > 2) {
                continue;
            }
            let (lower, upper) = if last { (0, row) } else { (row, row + 1) };
            let ((from, until), (above_from, above_until)) = (lattice.span(lower), lattice.span(upper));
            let (from_both, until_both) = (from.max(above_from), until.min(above_until));
            if from_both < until_both {
                let number = |row: usize, column: usize| (lattice.start(row) + column - lattice.span(row).0) as u32;
                let (first, above) = (number(lower, from_both), number(upper, from_both));
                neighbours.push((first, first + (until_both - from_both) as u32, above - first));
            }
        }
        Faces { neighbours, marks: vec![0; lattice.len() / 8 + WORD], ..Faces::default() }
    }

    /// Finds fronts on faces in a state of enthalpies (J/m3) of particles in some phases.
    pub(super) fn update(
        &mut self,
        phases: &Phases,
        (materials, stretches): (&[Sharp], &[Stretch]),
        enthalpy: &[f64],
        laws: &impl Laws,
    ) {
        for (_, particle) in self.entered.drain(..) {
            self.marks[particle as usize / 8] = 0;
        }
        self.apart.clear();
        phases.find_apart(&self.neighbours, &mut self.apart);
        for (one, other) in &self.apart {
            // Neighbours whose fronts are followed are of one material.
            let sharp = material_of(stretches, *one);
            let from_front = |particle: u32| {
                let potential = laws.potential_of(particle as usize, enthalpy[particle as usize]);
                (potential - materials[sharp as usize].potential).abs()
            };
            let (own, beyond) = (from_front(*one), from_front(*other));
            // Heat from both sides in balance moves no front.
            if own < beyond {
                self.entered.push((sharp, *one));
            } else if beyond < own {
                self.entered.push((sharp, *other));
            }
        }
        self.entered.sort_unstable();
        self.entered.dedup();
        for (_, particle) in &self.entered {
            self.marks[*particle as usize / 8] |= 1 << (particle % 8);
        }
    }

    /// Particles that are entered, by material and number.
    pub(super) fn entered(&self) -> &[(u32, u32)] {
        &self.entered
    }

    /// Neighbours between which a front lies.
    pub(super) fn apart(&self) -> &[(u32, u32)] {
        &self.apart
    }

    /// Whether a particle is entered.
    #[inline(always)]
    pub(super) fn holds(&self, particle: u32) -> bool {
        self.marks[particle as usize / 8] >> (particle % 8) & 1 != 0
    }

    /// A bit for each of at most 57 particles, from one on: whether they are entered.
    #[inline(always)]
    pub(super) fn of(&self, first: u32, count: usize) -> u64 {
        let mut bytes = [0; WORD];
        bytes.copy_from_slice(&self.marks[first as usize / 8..][..WORD]);
        u64::from_le_bytes(bytes) >> (first % 8) & (u64::MAX >> (64 - count))
    }
}

impl HeapSize for Faces {
    fn heap_size(&self) -> usize {
        self.neighbours.heap_size() + self.apart.heap_size() + self.entered.heap_size() + self.marks.heap_size()
    }
}
