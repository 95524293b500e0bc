//! Blocks of the body, and the exact solution for their pressures alone.

use glam::DVec2;

use crate::balances::groundwater::diagonals::sum;
use crate::balances::groundwater::network::Network;
use crate::instruction_set::widest;
use crate::memory::{HeapSize, total};

/// Particles of a block, as far as the number of blocks allows.
const PARTICLES: f64 = 64.0;

/// Blocks, at most: their matrix is full.
const MOST_BLOCKS: f64 = 256.0;

/// A pivot over the largest below which a block has no balance of its own.
const PIVOT: f64 = 1e-14;

/// The blocks.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    blocks: Vec<u32>,
    count: usize,
    /// Rows of the matrix times the blocks: start of each particle's entries.
    starts: Vec<usize>,
    /// Block of each entry.
    columns: Vec<u32>,
    values: Vec<f64>,
    /// Entries of each path, from its earlier end and from its later, by slot; and of each particle itself.
    of_path: Vec<[u32; 2]>,
    of_particle: Vec<u32>,
    /// Lower triangle of the factor, row by row.
    factor: Vec<f64>,
    work: Vec<f64>,
}

impl HeapSize for Coarse {
    fn heap_size(&self) -> usize {
        let indices = total(&[&self.blocks, &self.columns, &self.of_particle, &self.of_path, &self.starts]);
        indices + total(&[&self.values, &self.factor, &self.work])
    }
}

impl Coarse {
    pub(super) fn new(network: &Network, positions: &[DVec2]) -> Self {
        let low = positions.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = positions.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let wanted = (positions.len() as f64 / PARTICLES).clamp(1.0, MOST_BLOCKS);
        let flat = extent.y < 1e-9 * extent.x;
        let across = if flat { 1.0 } else { (wanted * extent.y / extent.x).sqrt().round().clamp(1.0, wanted.floor()) };
        let along = (wanted / across).floor().max(1.0);
        let cell = |part: f64, cells: f64| ((part * cells) as usize).min(cells as usize - 1);
        let block = |place: &DVec2| {
            let part = (*place - low) / extent;
            let row = if flat { 0 } else { cell(part.y, across) };
            (row * along as usize + cell(part.x, along)) as u32
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
        let (factor, work) = (vec![0.0; count * count], vec![0.0; count]);
        Coarse { blocks, count, starts, columns, values, of_path, of_particle, factor, work }
    }

    /// Takes a matrix by its diagonal and the entries of slots.
    pub(super) fn assemble(&mut self, network: &Network, diagonal: &[f64], rest: &[f64]) {
        self.values.fill(0.0);
        self.factor.fill(0.0);
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
            let row = self.blocks[i] as usize * self.count;
            for entry in self.starts[i]..self.starts[i + 1] {
                self.factor[row + self.columns[entry] as usize] += self.values[entry];
            }
        }
        factorise(self.count, &mut self.factor);
    }

    /// Solves for the blocks, in place.
    fn solve(&mut self) {
        let n = self.count;
        for row in 0..n {
            let entries = &self.factor[row * n..row * n + row + 1];
            let (a, b) = (&entries[..row], &self.work[..row]);
            let left = sum(row, |k| a[k] * b[k]);
            self.work[row] = (self.work[row] - left) / entries[row];
        }
        for row in (0..n).rev() {
            let value = self.work[row] / self.factor[row * n + row];
            self.work[row] = value;
            for column in 0..row {
                self.work[column] -= self.factor[row * n + column] * value;
            }
        }
    }

    /// Takes out of a direction what a column holds of each block, as the matrix sees it.
    pub(super) fn deflate(&mut self, column: &[f64], direction: &mut [f64]) {
        self.work.fill(0.0);
        for (i, value) in column.iter().enumerate() {
            for entry in self.starts[i]..self.starts[i + 1] {
                self.work[self.columns[entry] as usize] += self.values[entry] * value;
            }
        }
        self.solve();
        for (direction, block) in direction.iter_mut().zip(&self.blocks) {
            *direction -= self.work[*block as usize];
        }
    }

    /// Moves the blocks of a solution so that the residual of each sums to zero.
    pub(super) fn correct(&mut self, solution: &mut [f64], residual: &mut [f64]) {
        self.work.fill(0.0);
        for (i, value) in residual.iter().enumerate() {
            self.work[self.blocks[i] as usize] += value;
        }
        self.solve();
        for i in 0..solution.len() {
            solution[i] += self.work[self.blocks[i] as usize];
            for entry in self.starts[i]..self.starts[i + 1] {
                residual[i] -= self.values[entry] * self.work[self.columns[entry] as usize];
            }
        }
    }
}

widest!(factorise, factorise_rows, (count: usize, factor: &mut [f64]));

/// Cholesky's factor in place.
#[inline(always)]
fn factorise_rows(count: usize, factor: &mut [f64]) {
    let most = (0..count).map(|i| factor[i * count + i]).fold(0.0, f64::max);
    for column in 0..count {
        let (done, below) = factor.split_at_mut((column + 1) * count);
        let own = &mut done[column * count..];
        let done = &own[..column];
        let left = sum(column, |k| done[k] * done[k]);
        let pivot = own[column] - left;
        // An empty block, or one that balances by itself, takes no part.
        let root = if pivot > PIVOT * most { pivot.sqrt() } else { f64::INFINITY };
        own[column] = root;
        for row in below.chunks_exact_mut(count) {
            let (a, b) = (&row[..column], &own[..column]);
            let left = sum(column, |k| a[k] * b[k]);
            row[column] = (row[column] - left) / root;
        }
    }
}
