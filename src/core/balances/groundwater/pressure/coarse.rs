//! Blocks of the body, and the exact solution for their pressures alone.

use glam::DVec2;

use crate::balances::groundwater::diagonals::sum;
use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::pressure::bands::Bands;
use crate::instruction_set::widest;
use crate::memory::{HeapSize, total};

/// Particles of a block, as far as the number of blocks allows.
const PARTICLES: f64 = 16.0;

/// Blocks over the root of the number of particles, at most: their matrix, whose rows reach as far as the shorter side has blocks, is then
/// factorised in about the time of two iterations.
const MOST_BLOCKS: f64 = 8.0;

/// A pivot over the largest below which a block has no balance of its own.
const PIVOT: f64 = 1e-14;

/// The blocks.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    /// Block of each particle.
    pub(super) blocks: Vec<u32>,
    /// Rows of the matrix times the blocks: start of each particle's entries.
    starts: Vec<usize>,
    /// Block of each entry.
    columns: Vec<u32>,
    values: Vec<f64>,
    /// The same by blocks: start of each block's entries and the end of the last, and the particle and the place of each entry.
    block_starts: Vec<usize>,
    by_block: Vec<[u32; 2]>,
    /// Entries of each path, from its earlier end and from its later, by slot; and of each particle itself.
    of_path: Vec<[u32; 2]>,
    of_particle: Vec<u32>,
    factor: Envelope,
    /// What was found last for each block.
    pub(super) work: Vec<f64>,
}

/// A lower triangle, row by row, each from its first entry that is not zero.
#[derive(Debug, Clone, Default)]
struct Envelope {
    /// First column of each row.
    firsts: Vec<usize>,
    /// Start of each row's entries, and the end of the last.
    starts: Vec<usize>,
    entries: Vec<f64>,
}

impl Envelope {
    /// Room for rows that begin at these columns.
    fn new(firsts: Vec<usize>) -> Self {
        let mut starts = vec![0];
        for (row, first) in firsts.iter().enumerate() {
            starts.push(starts[row] + row + 1 - first);
        }
        let entries = vec![0.0; starts[firsts.len()]];
        Envelope { firsts, starts, entries }
    }

    /// The entry of a row at a column that it reaches.
    fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[self.starts[row] + column - self.firsts[row]]
    }
}

impl HeapSize for Coarse {
    fn heap_size(&self) -> usize {
        let indices = total(&[&self.blocks, &self.columns, &self.of_particle, &self.of_path, &self.starts]);
        let factor = total(&[&self.factor.firsts, &self.factor.starts, &self.factor.entries]);
        indices + factor + total(&[&self.values, &self.work, &self.block_starts, &self.by_block])
    }
}

impl Coarse {
    pub(super) fn new(network: &Network, positions: &[DVec2]) -> Self {
        let low = positions.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = positions.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let particles = positions.len() as f64;
        let wanted = (particles / PARTICLES).min(MOST_BLOCKS * particles.sqrt()).max(1.0);
        let flat = extent.y < 1e-9 * extent.x;
        let across = if flat { 1.0 } else { (wanted * extent.y / extent.x).sqrt().round().clamp(1.0, wanted.floor()) };
        let along = (wanted / across).floor().max(1.0);
        let cell = |part: f64, cells: f64| ((part * cells) as usize).min(cells as usize - 1);
        let block = |place: &DVec2| {
            let part = (*place - low) / extent;
            let (column, row) = (cell(part.x, along), if flat { 0 } else { cell(part.y, across) });
            // Rows of the matrix reach as far as the shorter side.
            let number = if along > across { column * across as usize + row } else { row * along as usize + column };
            number as u32
        };
        let blocks: Vec<u32> = positions.iter().map(block).collect();
        let count = along as usize * across as usize;
        let (mut starts, mut columns) = (vec![0], Vec::new());
        let (mut of_path, mut of_particle) = (vec![[0; 2]; network.places], Vec::new());
        for i in 0..network.len() {
            let start = columns.len();
            let mut entry = |block: u32| {
                let found = columns[start..].iter().position(|column| *column == block);
                let place = found.map_or(columns.len(), |place| start + place);
                if found.is_none() {
                    columns.push(block);
                }
                place as u32
            };
            of_particle.push(entry(blocks[i]));
            for (j, slot, later) in network.paths(i) {
                of_path[slot][usize::from(!later)] = entry(blocks[j]);
            }
            starts.push(columns.len());
        }
        let values = vec![0.0; columns.len()];
        let mut firsts: Vec<usize> = (0..count).collect();
        for i in 0..network.len() {
            let first = &mut firsts[blocks[i] as usize];
            *first = columns[starts[i]..starts[i + 1]].iter().fold(*first, |first, column| first.min(*column as usize));
        }
        let particles = (0..network.len()).flat_map(|i| (starts[i]..starts[i + 1]).map(move |_| i as u32));
        let mut by_block: Vec<[u32; 2]> = particles.zip(0..).map(|(particle, entry)| [particle, entry]).collect();
        // As they stand within each block.
        by_block.sort_by_key(|[_, entry]| columns[*entry as usize]);
        let before = |block: usize| by_block.partition_point(|[_, entry]| (columns[*entry as usize] as usize) < block);
        let block_starts = (0..=count).map(before).collect();
        let (factor, work) = (Envelope::new(firsts), vec![0.0; count]);
        Coarse { blocks, starts, columns, values, block_starts, by_block, of_path, of_particle, factor, work }
    }

    /// Takes a matrix by its diagonal and the entries of slots.
    pub(super) fn assemble(&mut self, network: &Network, diagonal: &[f64], rest: &[f64]) {
        self.values.fill(0.0);
        self.factor.entries.fill(0.0);
        for i in 0..network.len() {
            self.values[self.of_particle[i] as usize] += diagonal[i];
        }
        let Coarse { of_path, values, .. } = self;
        // Places without a path add zero to the first entry.
        network.each_path(|_, _, slot| {
            for entry in of_path[slot] {
                values[entry as usize] += rest[slot];
            }
        });
        for i in 0..network.len() {
            let row = self.blocks[i] as usize;
            for entry in self.starts[i]..self.starts[i + 1] {
                let column = self.columns[entry] as usize;
                if column <= row {
                    *self.factor.entry(row, column) += self.values[entry];
                }
            }
        }
        factorise(&mut self.factor);
    }

    /// Finds what a column holds of each block, as the matrix sees it.
    pub(super) fn find(&mut self, column: &[f64], bands: &Bands) {
        let Coarse { block_starts, by_block, values, work, .. } = self;
        bands.blocks(work, |first, found| {
            for (block, found) in (first..).zip(found) {
                let held = by_block[block_starts[block]..block_starts[block + 1]].iter();
                let held = held.map(|[particle, entry]| values[*entry as usize] * column[*particle as usize]);
                *found = held.fold(0.0, |sum, held| sum + held);
            }
        });
        back_substitute(&self.factor, &mut self.work);
    }

    /// Moves the blocks of a solution so that the residual of each sums to zero.
    pub(super) fn correct(&mut self, solution: &mut [f64], residual: &mut [f64]) {
        self.work.fill(0.0);
        for (i, value) in residual.iter().enumerate() {
            self.work[self.blocks[i] as usize] += value;
        }
        back_substitute(&self.factor, &mut self.work);
        for i in 0..solution.len() {
            solution[i] += self.work[self.blocks[i] as usize];
            for entry in self.starts[i]..self.starts[i + 1] {
                residual[i] -= self.values[entry] * self.work[self.columns[entry] as usize];
            }
        }
    }
}

widest!(factorise, factorise_rows, (factor: &mut Envelope));
widest!(back_substitute, substitute_rows, (factor: &Envelope, work: &mut [f64]));

/// Cholesky's factor in place.
#[inline(always)]
fn factorise_rows(factor: &mut Envelope) {
    let Envelope { firsts, starts, entries } = factor;
    let most = (0..firsts.len()).map(|row| entries[starts[row + 1] - 1]).fold(0.0, f64::max);
    for row in 0..firsts.len() {
        let (done, own) = entries.split_at_mut(starts[row]);
        let first = firsts[row];
        for column in first..row {
            let from = first.max(firsts[column]);
            let above = &done[starts[column] + from - firsts[column]..starts[column + 1]];
            let (root, above) = (above[column - from], &above[..column - from]);
            let left = &own[from - first..column - first];
            let left = sum(above.len(), |k| left[k] * above[k]);
            own[column - first] = (own[column - first] - left) / root;
        }
        let own = &mut own[..=row - first];
        let pivot = own[row - first] - sum(row - first, |k| own[k] * own[k]);
        // An empty block, or one that balances by itself, takes no part.
        own[row - first] = if pivot > PIVOT * most { pivot.sqrt() } else { f64::INFINITY };
    }
}

/// Solves for the blocks, in place.
#[inline(always)]
fn substitute_rows(factor: &Envelope, work: &mut [f64]) {
    let rows = || factor.firsts.iter().zip(factor.starts.windows(2)).enumerate();
    for (row, (first, place)) in rows() {
        let (own, before) = (&factor.entries[place[0]..place[1]], &work[*first..row]);
        let left = sum(before.len(), |k| own[k] * before[k]);
        work[row] = (work[row] - left) / own[row - first];
    }
    for (row, (first, place)) in rows().rev() {
        let own = &factor.entries[place[0]..place[1]];
        let value = work[row] / own[row - first];
        work[row] = value;
        for (before, own) in work[*first..row].iter_mut().zip(own) {
            *before -= own * value;
        }
    }
}
