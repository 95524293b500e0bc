//! Particles in the order of cells, slabs of cells, and the pairs of each slab.
//!
//! The box is cut into slabs of whole rows of cells. A pair belongs to the slab of that end from which the other lies in
//! the same row or a later one, so pairs of a slab touch particles of this slab and of the next alone: all slabs of even
//! number can be worked on at once, then all of odd number. Slabs follow from the box and the reach of pairs, never from
//! the number of threads, and neither does the order in which pairs of a slab are met.

use rayon::prelude::*;

use super::particle::Particle;
use super::power::round;

/// Most slabs: beyond this there is nothing to gain from smaller ones.
const MOST_SLABS: usize = 64;

/// Neighbours of a cell in space that come after it.
const FORWARD: usize = 13;

/// A cell in space and all around it.
pub const AROUND: usize = 27;

/// Cells of a periodic box.
#[derive(Debug, Clone)]
pub struct Grid<const D: usize> {
    /// Lengths of the box.
    pub lengths: [f64; D],
    /// One over them.
    pub inverses: [f64; D],
    cells: [usize; D],
    /// Square of the distance up to which pairs are listed.
    listed: f64,
    /// First row of each slab along the last direction, and their number.
    rows: Vec<usize>,
}

/// Pairs of a slab.
#[derive(Debug, Clone, Default)]
pub struct SlabPairs {
    /// Number of particles of the slab.
    pub count: usize,
    /// For each particle, where its partners in the slab and those in the next one begin; then their number.
    pub starts: Vec<[u32; 2]>,
    /// Partners, by number within their slab.
    pub partners: Vec<u32>,
}

impl<const D: usize> Grid<D> {
    /// Cells at least as wide as the distance (reach and skin) up to which pairs are listed.
    ///
    /// # Errors
    /// A box that is narrower than three cells.
    pub fn new(lengths: [f64; D], distance: f64) -> Result<Self, String> {
        let mut cells = [0; D];
        for axis in 0..D {
            cells[axis] = (lengths[axis] / distance) as usize;
            if cells[axis] < 3 {
                return Err(format!(
                    "a periodic box of length {} is too small: it must be at least {} long, three times the cut-off radius \
                     and the skin around it",
                    lengths[axis],
                    3.0 * distance
                ));
            }
        }
        let last = cells[D - 1];
        let slabs = (last - last % 2).min(MOST_SLABS);
        let rows = (0..=slabs).map(|slab| slab * last / slabs).collect();
        Ok(Grid { lengths, inverses: lengths.map(|length| 1.0 / length), cells, listed: distance * distance, rows })
    }

    /// Number of slabs: even.
    pub fn slabs(&self) -> usize {
        self.rows.len() - 1
    }

    /// Puts every particle back into the box and sorts them by cell. `sorted` is filled and exchanged; returns the number
    /// of particles before each cell.
    fn sort(&self, particles: &mut Vec<Particle<D>>, sorted: &mut Vec<Particle<D>>, starts: &mut Vec<u32>) {
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

    /// Sorts particles and lists the pairs of each slab, but for those of two particles named `apart` or above.
    ///
    /// # Errors
    /// A particle with more partners than `most`.
    pub fn list(
        &self,
        particles: &mut Vec<Particle<D>>,
        sorted: &mut Vec<Particle<D>>,
        (starts, places): (&mut Vec<u32>, &mut Vec<[f64; D]>),
        slabs: &mut [SlabPairs],
        (apart, most): (u32, usize),
        parallel: bool,
    ) -> Result<(), String> {
        self.sort(particles, sorted, starts);
        places.clear();
        places.extend(particles.iter().map(|particle| particle.position));
        let (particles, starts, places) = (&particles[..], &starts[..], &places[..]);
        let name = |i: usize| particles[i].name;
        let list = |(number, slab): (usize, &mut SlabPairs)| match apart {
            u32::MAX => self.pairs_of(number, slab, places, starts, |_, _| true),
            _ => self.pairs_of(number, slab, places, starts, |i, j| name(i).min(name(j)) < apart),
        };
        let crowded = match parallel {
            true => slabs.par_iter_mut().enumerate().map(list).max(),
            false => slabs.iter_mut().enumerate().map(list).max(),
        };
        match crowded.unwrap_or(0) {
            found if found > most => {
                Err(format!("a particle has {found} partners within reach, must be at most {most}"))
            }
            _ => Ok(()),
        }
    }

    /// Lists the pairs of a slab, and returns the most that one particle has.
    fn pairs_of(
        &self,
        number: usize,
        slab: &mut SlabPairs,
        places: &[[f64; D]],
        starts: &[u32],
        wanted: impl Fn(usize, usize) -> bool,
    ) -> usize {
        let row: usize = self.cells[..D - 1].iter().product();
        let (first, last) = (self.rows[number] * row, self.rows[number + 1] * row);
        let next = (last % (row * self.cells[D - 1]), number + 1);
        let begin = starts[first] as usize;
        let begin_next = starts[next.0] as usize;
        slab.count = starts[last] as usize - begin;
        slab.starts.clear();
        let (mut most, mut filled) = (0, 0);
        let mut ways = [0; FORWARD];
        for cell in first..last {
            let (count, across) = self.forward(cell, &mut ways);
            let ways = &ways[..count];
            for i in starts[cell] as usize..starts[cell + 1] as usize {
                let me = &places[i];
                let from = filled;
                // Whether a candidate is near enough cannot be guessed: each is written, and the next one over it if not.
                let mut add = |range: std::ops::Range<usize>, base: usize| {
                    if slab.partners.len() < filled + range.len() {
                        slab.partners.resize(2 * (filled + range.len()), 0);
                    }
                    let partners = &mut slab.partners[..];
                    for j in range {
                        partners[filled] = (j - base) as u32;
                        let square = match across {
                            true => self.square(me, &places[j]),
                            false => plain_square(me, &places[j]),
                        };
                        filled += usize::from((square < self.listed) & wanted(i, j));
                    }
                    filled
                };
                let of = |cell: usize| starts[cell] as usize..starts[cell + 1] as usize;
                add(i + 1..of(cell).end, begin);
                for &way in ways.iter().filter(|way| (first..last).contains(*way)) {
                    add(of(way), begin);
                }
                let middle = add(0..0, 0);
                for &way in ways.iter().filter(|way| !(first..last).contains(*way)) {
                    add(of(way), begin_next);
                }
                slab.starts.push([from as u32, middle as u32]);
                most = most.max(filled - from);
            }
        }
        slab.starts.push([filled as u32; 2]);
        most
    }

    /// The half of a cell's neighbours that come after it: later along the last direction at which they differ. Says how many
    /// they are, and whether any lies across a side of the box.
    fn forward(&self, cell: usize, ways: &mut [usize; FORWARD]) -> (usize, bool) {
        let mut at = [0; D];
        let mut rest = cell;
        for axis in 0..D {
            at[axis] = rest % self.cells[axis];
            rest /= self.cells[axis];
        }
        let mut count = 0;
        let across = (0..D).any(|axis| at[axis] == 0 || at[axis] + 1 == self.cells[axis]);
        for code in 0..3usize.pow(D as u32) {
            let mut rest = code;
            let mut offset = [0i64; D];
            for axis in 0..D {
                offset[axis] = (rest % 3) as i64 - 1;
                rest /= 3;
            }
            let after = offset.iter().rev().find(|way| **way != 0).is_some_and(|way| *way > 0);
            if after {
                let mut number = 0;
                for axis in (0..D).rev() {
                    let count = self.cells[axis] as i64;
                    number = number * self.cells[axis] + (at[axis] as i64 + offset[axis]).rem_euclid(count) as usize;
                }
                ways[count % FORWARD] = number;
                count += 1;
            }
        }
        (count, across)
    }

    /// The cell of a place and all around it; says how many they are.
    pub fn around(&self, place: &[f64; D], ways: &mut [usize; AROUND]) -> usize {
        let mut at = [0i64; D];
        for axis in 0..D {
            at[axis] = (place[axis] / self.lengths[axis] * self.cells[axis] as f64).floor() as i64;
        }
        let all = 3usize.pow(D as u32).min(AROUND);
        for (code, way) in (0..).zip(&mut ways[..all]) {
            let (mut rest, mut offsets): (i64, _) = (code, [0; D]);
            for offset in &mut offsets {
                *offset = rest % 3 - 1;
                rest /= 3;
            }
            let mut number = 0;
            for axis in (0..D).rev() {
                let count = self.cells[axis] as i64;
                number = number * self.cells[axis] + (at[axis] + offsets[axis]).rem_euclid(count) as usize;
            }
            *way = number;
        }
        all
    }

    /// The shortest way from `b` to `a`.
    #[inline(always)]
    pub fn way(&self, a: &[f64; D], b: &[f64; D]) -> [f64; D] {
        let mut way = [0.0; D];
        for axis in 0..D {
            let plain = a[axis] - b[axis];
            way[axis] = plain - self.lengths[axis] * round(plain * self.inverses[axis]);
        }
        way
    }

    /// Square of the distance between two places, by the nearest images.
    #[inline(always)]
    pub fn square(&self, a: &[f64; D], b: &[f64; D]) -> f64 {
        self.way(a, b).iter().map(|way| way * way).sum()
    }
}

/// Square of the distance between two places, no side between them.
#[inline(always)]
fn plain_square<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum()
}
