//! The fused lattice step: enthalpy to potential, pair sum and update in one pass through memory.
//!
//! A band of rows is swept upward. Only 2 m + 1 rows of potentials live at a time, so memory holds nothing but the
//! enthalpies. Within a row the sum over a disc of offsets is folded by symmetry (`block`). Every particle sees the same
//! operations in the same order whatever the width of the vectors or the number of bands, and products are fused with sums
//! in the same places: the bits are the same everywhere.

mod block;
mod lanes;
mod line;
mod settle;

use crate::bonds::stencil::Stencil;
use crate::instruction_set::InstructionSet;
use crate::kernels::target::Target;
use crate::memory::HeapSize;
use crate::physics::laws::Laws;
use crate::space::lattice::Lattice;

use block::{BlockRates, Near, Soon};
use lanes::LANES;
use line::{Along, LineRates};

/// Widest stencil that has a compiled sweep, in cells; wider ones take the pair list.
pub const WIDEST: usize = 8;

/// Columns whose slots are made ready together: these stay in the first cache.
const BLOCK: usize = 1024;

/// Bytes of a cache line: the first particles of rows stand on one, so that a group of eight does not straddle two.
const CACHE_LINE: usize = 64;

/// What a sweep needs to know of the ghosts around a row.
pub trait Surroundings: Sync {
    /// Completes a row of potentials: `potentials[column + reach]` is set for every particle of the row.
    fn complete(&self, row: usize, potentials: &mut [f64]);
    /// Heat rate through each open wall (W per volume of a particle) into a row, from its neighbourhood of rows.
    fn patches(&self, row: usize, rows: &[&[f64]], rates: &mut [f64; 4]);
    /// Whether any wall lets heat through, so that rates are worth taking.
    fn has_patches(&self) -> bool;
    /// The ends of a line, where ghosts behind both are images.
    fn ends(&self) -> Option<&Ends>;
}

/// The left and the right end of a line.
#[derive(Debug, Clone)]
pub struct Ends {
    /// What lies behind them.
    pub behind: [Behind; 2],
    /// Whether they let heat through.
    pub open: [bool; 2],
    /// How particles see an end.
    pub weights: EndWeights,
}

/// Weights of all pairs of a line that reach behind an end.
#[derive(Debug, Clone, Default)]
pub struct EndWeights {
    /// Those of a ghost, by its layer from the wall outward.
    pub of_ghosts: [f64; WIDEST],
    /// Those of a particle, by its distance from the wall.
    pub of_particles: [f64; WIDEST],
}

/// Ghosts behind a wall by the particles before it: each `sign` times its image, and `shift` (W/m) on top.
#[derive(Debug, Clone, Copy)]
pub struct Behind {
    /// 1, -1 or, where images do not count, 0.
    pub sign: f64,
    /// What the potential of a wall adds.
    pub shift: f64,
}

/// Shape of the rows that a sweep works on.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Reach of the stencil in columns.
    pub reach: usize,
    /// Reach in rows: the same, or zero on a line.
    pub reach_rows: usize,
    /// Length of a buffer row: columns and a margin of `reach` on both sides, at least.
    pub width: usize,
}

impl Shape {
    /// The shape of rows of `columns` particles under a stencil of some reach; on a line there are no other rows.
    pub fn new(columns: usize, reach: usize, line: bool) -> Self {
        // A group to the left, all that the last particle is in, and one to the right.
        let needed = columns + 3 * LANES;
        // Whole cache lines, and not a whole number of pages: rows a page apart would fight for the same places.
        let width = needed.next_multiple_of(LANES);
        let width = if width.is_multiple_of(512) { width + LANES } else { width };
        Shape { reach, reach_rows: if line { 0 } else { reach }, width }
    }
}

/// Some rows of potentials.
#[derive(Debug)]
pub struct RowBuffer {
    shape: Shape,
    values: Vec<f64>,
    /// Where the first row starts: a group before its first particle, on a cache line.
    start: usize,
}

impl RowBuffer {
    fn new(rows: usize, shape: Shape) -> Self {
        let values = vec![0.0; rows * shape.width + CACHE_LINE / size_of::<f64>()];
        let start = values.as_ptr().align_offset(CACHE_LINE).min(CACHE_LINE / size_of::<f64>());
        RowBuffer { shape, values, start }
    }

    /// A row from a group before its first particle on.
    #[inline(always)]
    fn groups(&self, row: usize) -> &[f64] {
        &self.values[self.start + row * self.shape.width..][..self.shape.width]
    }

    /// The same to be written.
    #[inline(always)]
    fn groups_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.values[self.start + row * self.shape.width..][..self.shape.width]
    }

    /// A row from its margin on: `potentials[column + reach]` is that of a particle.
    #[inline(always)]
    pub fn row(&mut self, row: usize) -> &mut [f64] {
        let reach = self.shape.reach;
        &mut self.groups_mut(row)[LANES - reach..]
    }
}

impl Clone for RowBuffer {
    fn clone(&self) -> Self {
        let rows = (self.values.len() - CACHE_LINE / size_of::<f64>()) / self.shape.width;
        let mut copy = RowBuffer::new(rows, self.shape);
        for row in 0..rows {
            copy.row(row).copy_from_slice(&self.groups(row)[LANES - self.shape.reach..]);
        }
        copy
    }
}

impl HeapSize for RowBuffer {
    fn heap_size(&self) -> usize {
        self.values.heap_size()
    }
}

/// The rows of one band and its buffers.
#[derive(Debug, Clone)]
pub struct Band {
    /// Rows of the lattice, first and one past the last.
    pub rows: (usize, usize),
    /// Potentials of the rows next below the band, `reach_rows` of them.
    pub below: RowBuffer,
    /// Potentials above.
    pub above: RowBuffer,
    ring: RowBuffer,
}

impl Band {
    /// A band with its buffers.
    pub fn new(rows: (usize, usize), shape: Shape) -> Self {
        Band {
            rows,
            below: RowBuffer::new(shape.reach_rows, shape),
            above: RowBuffer::new(shape.reach_rows, shape),
            ring: RowBuffer::new(2 * shape.reach_rows + 1, shape),
        }
    }
}

impl HeapSize for Band {
    fn heap_size(&self) -> usize {
        self.below.heap_size() + self.above.heap_size() + self.ring.heap_size()
    }
}

/// Weights of a stencil, as blocks read them.
#[derive(Debug, Clone)]
pub struct Weights {
    /// By distance in columns and in rows.
    by_distance: [[f64; WIDEST + 1]; WIDEST + 1],
    /// Sum of all weights, the weight of the particle itself.
    sum: f64,
    /// Whether they fit a disc.
    disc: bool,
}

impl Weights {
    /// Those of a stencil.
    pub fn new(stencil: &Stencil) -> Self {
        let by_distance = std::array::from_fn(|k| std::array::from_fn(|dy| stencil.at(k, dy)));
        Weights { by_distance, sum: stencil.sum(), disc: stencil.fits_disc() }
    }
}

/// Everything constant about a sweep.
pub struct Frame<'a, L, S> {
    /// Shape of rows.
    pub shape: Shape,
    /// Rows and their particles.
    pub lattice: &'a Lattice,
    /// Weights.
    pub weights: &'a Weights,
    /// Enthalpy to potential.
    pub laws: &'a L,
    /// Ghosts.
    pub surroundings: &'a S,
}

/// Sweeps one band. `patches` receives the wall rates of each row of the band.
#[inline]
pub fn sweep<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
) {
    if frame.shape.reach_rows == 0 {
        only_row(frame, band, target, patches);
    } else {
        plane(frame, band, target, patches);
    }
}

/// All rows of a band of a plane.
#[inline(never)]
fn plane<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
) {
    let reach = frame.shape.reach.min(WIDEST);
    match InstructionSet::widest() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has just been asked for these features.
        InstructionSet::Avx512 => unsafe { sweep_avx512(frame, band, target, patches, block::AVX512[reach]) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        InstructionSet::Avx2 => unsafe { sweep_avx2(frame, band, target, patches, block::AVX2[reach]) },
        _ => rows(frame, band, target, patches, block::PORTABLE[reach]),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl")]
fn sweep_avx512<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
    block: BlockRates,
) {
    rows(frame, band, target, patches, block);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn sweep_avx2<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
    block: BlockRates,
) {
    rows(frame, band, target, patches, block);
}

/// The only row of a line: none lies below or above, and what is asked of each of many rows costs more than a short line.
#[inline]
fn only_row<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
) {
    let (reach, count) = (frame.shape.reach.min(WIDEST), frame.lattice.len());
    let set = InstructionSet::widest();
    let ends = if count >= line::FEWEST { frame.surroundings.ends() } else { None };
    let law = frame.laws.pieces().zip(ends);
    if law.is_none() {
        fill_only_row(set, frame, band.ring.row(0), target.enthalpy(0..count));
        if frame.surroundings.has_patches() {
            frame.surroundings.patches(0, &[band.ring.row(0)], &mut patches[0]);
        }
    }
    let line: LineRates = match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => line::AVX512[reach],
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => line::AVX2[reach],
        _ => line::PORTABLE[reach],
    };
    let law = law.as_ref().map(|(law, ends)| (law, *ends));
    let along = Along { weights: frame.weights, potentials: band.ring.groups_mut(0), law };
    // SAFETY: it is that of this processor.
    unsafe { line(along, target.slots(0..count), &mut patches[0]) };
}

/// Potentials of all particles of a line, and of its ghosts.
#[inline(never)]
fn fill_only_row<L: Laws, S: Surroundings>(
    set: InstructionSet,
    frame: &Frame<'_, L, S>,
    potentials: &mut [f64],
    enthalpy: &[f64],
) {
    let of_particles = &mut potentials[frame.shape.reach..][..enthalpy.len()];
    match set {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has been asked for these features.
        InstructionSet::Avx512 => unsafe { fill_avx512(frame.laws, enthalpy, of_particles) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        InstructionSet::Avx2 => unsafe { fill_avx2(frame.laws, enthalpy, of_particles) },
        _ => frame.laws.fill(0, enthalpy, of_particles),
    }
    frame.surroundings.complete(0, potentials);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl")]
fn fill_avx512<L: Laws>(laws: &L, enthalpy: &[f64], potentials: &mut [f64]) {
    laws.fill(0, enthalpy, potentials);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fill_avx2<L: Laws>(laws: &L, enthalpy: &[f64], potentials: &mut [f64]) {
    laws.fill(0, enthalpy, potentials);
}

/// Fills the slot of a row in the ring of rows.
#[inline(always)]
fn fill_slot<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    row: usize,
    base: usize,
    ring: &mut RowBuffer,
    target: &T,
) {
    let Shape { reach, reach_rows, .. } = frame.shape;
    let slot = ring.row(row % (2 * reach_rows + 1));
    let ((first, end), start) = (frame.lattice.span(row), frame.lattice.start(row));
    let enthalpy = target.enthalpy(start - base..start - base + end - first);
    frame.laws.fill(start, enthalpy, &mut slot[first + reach..end + reach]);
    frame.surroundings.complete(row, slot);
}

#[inline(always)]
fn rows<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
    block: BlockRates,
) {
    let Shape { reach, reach_rows, .. } = frame.shape;
    let (first_row, end_row) = band.rows;
    let slots = 2 * reach_rows + 1;
    let base = frame.lattice.start(first_row);
    let Band { below, above, ring, .. } = band;
    let has_patches = frame.surroundings.has_patches();
    for row in first_row..end_row.min(first_row + reach_rows) {
        fill_slot::<L, S, T>(frame, row, base, ring, target);
    }
    for row in first_row..end_row {
        if row + reach_rows < end_row {
            fill_slot::<L, S, T>(frame, row + reach_rows, base, ring, target);
        }
        let at = |offset: usize| -> &[f64] {
            // offset 0..=2 reach_rows stands for row - reach_rows ..= row + reach_rows
            let position = row + offset;
            if position < first_row + reach_rows {
                below.groups(position - first_row)
            } else if position - reach_rows < end_row {
                ring.groups((position - reach_rows) % slots)
            } else {
                above.groups(position - reach_rows - end_row)
            }
        };
        let mut near: [&[f64]; 2 * WIDEST + 1] = [&[]; 2 * WIDEST + 1];
        for (offset, near) in near.iter_mut().enumerate().take(slots) {
            *near = at(offset);
        }
        let ((first, end), start) = (frame.lattice.span(row), frame.lattice.start(row));
        if has_patches {
            let mut rows: [&[f64]; 2 * WIDEST + 1] = [&[]; 2 * WIDEST + 1];
            for (row, near) in rows.iter_mut().zip(&near[..slots]) {
                *row = &near[LANES - reach..];
            }
            frame.surroundings.patches(row, &rows[..slots], &mut patches[row - first_row]);
        }
        let mut column = first;
        while column < end {
            let count = (end - column).min(BLOCK);
            let from = start - base + column - first;
            // The same columns of the row that is filled next, as far as it has them.
            let next = row + reach_rows + 1;
            let soon = if next < end_row {
                let ((first, end), start) = (frame.lattice.span(next), frame.lattice.start(next));
                let at = |column: usize| start - base + column.clamp(first, end) - first;
                Soon::of(target.enthalpy(at(column)..at(column + count)))
            } else {
                Soon::of(&[])
            };
            let slots = target.slots(from..from + count);
            let near = Near { weights: frame.weights, rows: &near, column, soon };
            // SAFETY: blocks are those of this processor.
            unsafe { block(&near, slots) };
            column += count;
        }
    }
}

#[cfg(test)]
mod tests;
