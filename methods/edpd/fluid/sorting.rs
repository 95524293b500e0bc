//! Particles in the order of cells, slabs of cells, and where the partners of a cell's particles stand.
//!
//! The box is cut into slabs of whole rows of cells. A pair belongs to the slab of that end from which the other lies in
//! the same row or a later one, so pairs of a slab touch particles of this slab and of the next alone: all slabs of even
//! number can be worked on at once, then all of odd number. Slabs follow from the box and the reach of pairs, never from
//! the number of threads, and neither does the order in which pairs of a slab are met.
//!
//! Cells that lie beside each other along the first direction hold particles one after the other, so all partners of a
//! cell stand in a few ranges, which are looked through in vectors each time. Rejected: lists of partners, which take
//! longer to read than ranges to look through.

use super::FluidError;
use super::particle::Particle;

/// Most slabs: beyond this there is nothing to gain from smaller ones.
const MOST_SLABS: usize = 64;

/// Most ranges of partners of a cell: five rows, each cut once by a side of the box.
pub const RANGES: usize = 10;

/// Cells of a periodic box.
#[derive(Debug, Clone)]
pub struct CellGrid<const D: usize> {
    /// Lengths of the box.
    pub lengths: [f64; D],
    /// Cells along each direction.
    cells: [usize; D],
    /// First row of each slab along the last direction, and their number.
    rows: Vec<usize>,
}

/// Particles one after the other, among which those of a cell have partners.
#[derive(Debug, Clone, Copy)]
pub struct PartnerRange<const D: usize> {
    /// The first of them.
    pub begin: usize,
    /// After the last.
    pub end: usize,
    /// Where they are seen from the cell, across sides of the box, over where they stand.
    pub shift: [f64; D],
    /// Whether they belong to the next slab, and that is the first one: the particles of every other stand right after the
    /// cell's own slab.
    pub beyond: bool,
}

impl<const D: usize> CellGrid<D> {
    /// Cells at least as wide as a distance, reach and skin.
    ///
    /// # Errors
    /// A box that is narrower than three cells.
    pub fn new(lengths: [f64; D], distance: f64) -> Result<Self, FluidError> {
        let mut cells = [0; D];
        for axis in 0..D {
            cells[axis] = (lengths[axis] / distance) as usize;
            if cells[axis] < 3 {
                let least = (3e3 * distance).ceil() / 1e3;
                return Err(FluidError::Narrow { length: lengths[axis], least });
            }
        }
        let last = cells[D - 1];
        let slabs = (last - last % 2).min(MOST_SLABS);
        let rows = (0..=slabs).map(|slab| slab * last / slabs).collect();
        Ok(CellGrid { lengths, cells, rows })
    }

    /// Number of slabs: even.
    pub fn slabs(&self) -> usize {
        self.rows.len() - 1
    }

    /// Puts every particle back into the box and sorts them by cell. `sorted` is filled and exchanged; returns the number
    /// of particles before each cell.
    pub fn sort(&self, particles: &mut Vec<Particle<D>>, sorted: &mut Vec<Particle<D>>, starts: &mut Vec<u32>) {
        starts.clear();
        starts.resize(self.cells.iter().product::<usize>() + 1, 0);
        for particle in particles.iter_mut() {
            for axis in 0..D {
                let turns = (particle.position[axis] / self.lengths[axis]).floor();
                particle.position[axis] -= turns * self.lengths[axis];
                particle.turns[axis] += turns as i32;
            }
            starts[self.cell(&particle.position) + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        sorted.clone_from(particles);
        for particle in particles.iter() {
            let place = &mut starts[self.cell(&particle.position)];
            sorted[*place as usize] = *particle;
            *place += 1;
        }
        // Every start has moved to that of the next cell.
        starts.rotate_right(1);
        starts[0] = 0;
        std::mem::swap(particles, sorted);
    }

    #[inline]
    fn cell(&self, position: &[f64; D]) -> usize {
        let mut number = 0;
        for axis in (0..D).rev() {
            let along = (position[axis] / self.lengths[axis] * self.cells[axis] as f64) as usize;
            number = number * self.cells[axis] + along.min(self.cells[axis] - 1);
        }
        number
    }

    /// The cells of a slab.
    pub fn cells(&self, slab: usize) -> std::ops::Range<usize> {
        let row: usize = self.cells[..D - 1].iter().product();
        self.rows[slab] * row..self.rows[slab + 1] * row
    }

    /// Where partners of the particles of a cell of a slab stand: first those of the cell itself, of which each pair is met
    /// from its first end, then those of cells that come after it: later along the last direction at which they differ.
    /// Those of the next slab come last.
    pub fn ranges(&self, slab: usize, cell: usize, starts: &[u32]) -> ([PartnerRange<D>; RANGES], usize) {
        let own = self.cells(slab);
        let mut at = [0; D];
        let mut rest = cell;
        for axis in 0..D {
            at[axis] = rest % self.cells[axis];
            rest /= self.cells[axis];
        }
        let mut ranges = [PartnerRange { begin: 0, end: 0, shift: [0.0; D], beyond: false }; RANGES];
        let mut count = 0;
        for code in 0..3usize.pow(D as u32 - 1) {
            let mut rest = code;
            let (mut row, mut stride) = (0, 1);
            let mut shift = [0.0; D];
            let mut last = 0;
            for axis in 1..D {
                let (offset, cells) = ((rest % 3) as i64 - 1, self.cells[axis] as i64);
                rest /= 3;
                let turns = (at[axis] as i64 + offset).div_euclid(cells);
                shift[axis] = turns as f64 * self.lengths[axis];
                row += (at[axis] as i64 + offset - turns * cells) as usize * stride;
                stride *= self.cells[axis];
                last = if offset == 0 { last } else { offset };
            }
            if last < 0 {
                continue;
            }
            let row = row * self.cells[0];
            // Cells of the row, from and to, up to three of them, and the one across a side of the box.
            let (first, end) = (if last == 0 { at[0] } else { at[0].wrapping_sub(1) }, at[0] + 2);
            let mut add = |from: usize, to: usize, across: f64| {
                let mut shift = shift;
                shift[0] = across * self.lengths[0];
                let beyond = row + from < own.start;
                ranges[count % RANGES] =
                    PartnerRange { begin: starts[row + from] as usize, end: starts[row + to] as usize, shift, beyond };
                count += 1;
            };
            let inside = if first > at[0] { 0 } else { first };
            add(inside, end.min(self.cells[0]), 0.0);
            if first > at[0] {
                add(self.cells[0] - 1, self.cells[0], -1.0);
            }
            if end > self.cells[0] {
                add(0, 1, 1.0);
            }
        }
        (ranges, count)
    }
}
