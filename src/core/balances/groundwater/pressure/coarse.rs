//! Blocks of the body, and the exact solution for their pressures alone.

use std::ops::Range;

use glam::DVec2;

use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::pressure::bands::Bands;
use crate::balances::groundwater::pressure::envelope::{Envelope, FOUR};
use crate::memory::{HeapSize, total};

/// Particles of a block, as far as the number of blocks allows.
const PARTICLES: f64 = 16.0;

/// Blocks over the root of the number of particles, at most, as the rows of their matrix reach as far as the shorter side has blocks.
/// Half as many more save an eighth of the iterations, and take that time for themselves.
const MOST_BLOCKS: f64 = 8.0;

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
    /// The same by blocks: start of each block's entries and the end of the last, the particle and the place of each, and its value.
    block_starts: Vec<usize>,
    by_block: Vec<[u32; 2]>,
    block_values: Vec<f64>,
    /// Entries of each path, from this end and, at the earlier one, from the other, as they stand in rows; and of each particle itself.
    of_path: Vec<[u32; 2]>,
    of_particle: Vec<u32>,
    factor: Envelope,
    /// What was found last for each block.
    pub(super) work: Vec<f64>,
}

impl HeapSize for Coarse {
    fn heap_size(&self) -> usize {
        let indices = total(&[&self.blocks, &self.columns, &self.of_particle, &self.of_path, &self.starts]);
        indices
            + self.factor.heap_size()
            + total(&[&self.values, &self.work, &self.block_starts, &self.by_block, &self.block_values])
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
        let (mut of_path, mut of_particle) = (vec![[0; 2]; network.partners.len()], Vec::new());
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
            for k in network.starts[i]..network.starts[i + 1] {
                of_path[k][0] = entry(blocks[network.partners[k] as usize]);
            }
            starts.push(columns.len());
        }
        for i in 0..network.len() {
            for k in network.laters[i]..network.starts[i + 1] {
                let j = network.partners[k] as usize;
                let back = network.starts[j]..network.laters[j];
                let twin = back.start + network.partners[back].partition_point(|other| (*other as usize) < i);
                of_path[k][1] = of_path[twin][0];
            }
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
        let (factor, work) = (Envelope::new(&firsts), vec![0.0; count]);
        let block_values = values.clone();
        Coarse {
            blocks,
            starts,
            columns,
            values,
            block_starts,
            by_block,
            block_values,
            of_path,
            of_particle,
            factor,
            work,
        }
    }

    /// Takes a matrix by its diagonal and the entries of slots.
    pub(super) fn assemble(&mut self, network: &Network, diagonal: &[f64], rest: &[f64], bands: &Bands) {
        let Coarse { starts, of_path, of_particle, values, .. } = self;
        let paths = |range: Range<usize>| {
            let ends = network.partners[range.clone()].iter().zip(&network.slots[range.clone()]);
            ends.map(|(j, slot)| (*j as usize, rest[*slot as usize])).zip(&of_path[range])
        };
        bands.each(bands.rows(starts, values), |(band, values)| {
            let (particles, base) = (bands.particles(band, starts.len() - 1), starts[band.first]);
            values.fill(0.0);
            for i in particles.clone() {
                values[of_particle[i] as usize - base] += diagonal[i];
                // Of a path from another band, which does not write here.
                let earlier = paths(network.starts[i]..network.laters[i]);
                for ((_, value), [own, _]) in earlier.take_while(|((j, _), _)| *j < particles.start) {
                    values[*own as usize - base] += value;
                }
            }
            for i in particles.clone() {
                for ((j, value), [own, other]) in paths(network.laters[i]..network.starts[i + 1]) {
                    values[*own as usize - base] += value;
                    if j < particles.end {
                        values[*other as usize - base] += value;
                    }
                }
            }
        });
        self.take_blocks(bands);
        self.factor.factorise();
    }

    /// Takes the entries of blocks from those of particles, and their matrix.
    fn take_blocks(&mut self, bands: &Bands) {
        let Coarse { blocks, values, block_starts, by_block, block_values, factor, .. } = self;
        let (count, mut rest) = (block_starts.len() - 1, &mut block_values[..]);
        let pieces = factor.pieces(count.div_ceil(bands.count().max(1)).next_multiple_of(FOUR)).map(|piece| {
            let rows = piece.rows(count);
            let (own, later) =
                std::mem::take(&mut rest).split_at_mut(block_starts[rows.end] - block_starts[rows.start]);
            rest = later;
            (piece, own)
        });
        bands.each(pieces, |(mut piece, block_values)| {
            piece.clear();
            let rows = piece.rows(count);
            let base = block_starts[rows.start];
            for row in rows {
                for place in block_starts[row]..block_starts[row + 1] {
                    let [particle, entry] = by_block[place];
                    let value = values[entry as usize];
                    block_values[place - base] = value;
                    let column = blocks[particle as usize] as usize;
                    if column >= row {
                        *piece.entry(row, column) += value;
                    }
                }
            }
        });
    }

    /// Finds what a column holds of each block, as the matrix sees it.
    pub(super) fn find(&mut self, column: &[f64], bands: &Bands) {
        let Coarse { block_starts, by_block, block_values, work, .. } = self;
        bands.blocks(work, |first, found| {
            for (block, found) in (first..).zip(found) {
                let entries = block_starts[block]..block_starts[block + 1];
                let held = by_block[entries.clone()].iter().zip(&block_values[entries]);
                *found = held.fold(0.0, |sum, ([particle, _], value)| sum + value * column[*particle as usize]);
            }
        });
        self.factor.solve(&mut self.work);
    }

    /// Moves the blocks of a solution so that the residual of each sums to zero.
    pub(super) fn correct(&mut self, solution: &mut [f64], residual: &mut [f64], bands: &Bands) {
        self.work.fill(0.0);
        for (i, value) in residual.iter().enumerate() {
            self.work[self.blocks[i] as usize] += value;
        }
        self.factor.solve(&mut self.work);
        let Coarse { blocks, starts, columns, values, work, .. } = &*self;
        let parts = bands.iter().zip(bands.parts(solution)).zip(bands.parts(residual));
        bands.each(parts, |((band, solution), residual)| {
            for (i, (solution, residual)) in (band.first..).zip(solution.iter_mut().zip(residual)) {
                *solution += work[blocks[i] as usize];
                for entry in starts[i]..starts[i + 1] {
                    *residual -= values[entry] * work[columns[entry] as usize];
                }
            }
        });
    }
}
