//! The fused lattice step: enthalpy to potential, pair sum and update in one pass through memory.
//!
//! A band of rows is swept upward. Only 2 m + 1 rows of potentials live at a time, so memory holds nothing but the
//! enthalpies. Within a row the sum over a disc of offsets is folded by symmetry: rows +dy and -dy are added first
//! (`s_dy`), then each column distance k gathers its rows (`v_k = sum_dy w(k, dy) s_dy`), and the particle adds
//! `v_k` from its left and right. Every particle sees the same operations in the same order whatever the width of
//! the vectors or the number of bands, and no multiply is fused with an add: the bits are the same everywhere.

use crate::bonds::stencil::Stencil;
use crate::kernels::target::{Target, settle};
use crate::memory::HeapSize;
use crate::physics::laws::Laws;
use crate::space::lattice::Lattice;

/// Widest stencil that has a compiled sweep, in cells; wider ones take the pair list.
pub const WIDEST: usize = 8;

/// Columns handled between two passes over the column sums: these stay in the first cache.
const BLOCK: usize = 256;

/// Lanes that one group may hold at most; buffers are padded so that the last group fits.
pub const MOST_LANES: usize = 16;

/// Bytes of a cache line: rows start on one, so that a group of eight does not straddle two.
const CACHE_LINE: usize = 64;

/// Length of one buffer of column sums.
const PADDED: usize = BLOCK + 2 * WIDEST + MOST_LANES;

/// What a sweep needs to know of the ghosts around a row.
pub trait Surroundings: Sync {
    /// Completes a row of potentials: `potentials[column + reach]` is set for every particle of the row.
    fn complete(&self, row: usize, potentials: &mut [f64]);
    /// Heat rate through each wall (W per volume of a particle) into a row, from its neighbourhood of rows.
    fn patches(&self, row: usize, rows: &[&[f64]]) -> [f64; 4];
    /// Whether any wall lets heat through, so that rates are worth taking.
    fn has_patches(&self) -> bool;
}

impl Shape {
    /// The shape of rows of `columns` particles under a stencil of some reach; on a line there are no other rows.
    pub fn new(columns: usize, reach: usize, line: bool) -> Self {
        let needed = columns + 2 * reach + MOST_LANES;
        // Whole cache lines, and not a whole number of pages: rows a page apart would fight for the same places.
        let width = needed.next_multiple_of(8);
        let width = if width.is_multiple_of(512) { width + 8 } else { width };
        Shape { reach, reach_rows: if line { 0 } else { reach }, width }
    }
}

/// The rows of one band and its buffers.
#[derive(Debug, Clone)]
pub struct Band {
    /// Rows of the lattice, first and one past the last.
    pub rows: (usize, usize),
    /// Potentials of the rows next below and above the band, `reach` each.
    pub below: Vec<f64>,
    /// Potentials above.
    pub above: Vec<f64>,
    ring: Vec<f64>,
    /// Where the ring starts on a cache line.
    ring_start: usize,
    sums: Vec<Sums>,
    rate: Vec<f64>,
}

/// Column sums of one distance, on cache lines of their own.
#[derive(Debug, Clone)]
#[repr(align(64))]
struct Sums([f64; PADDED]);

/// Shape of the rows that a sweep works on.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Reach of the stencil in columns.
    pub reach: usize,
    /// Reach in rows: the same, or zero on a line.
    pub reach_rows: usize,
    /// Length of a buffer row: columns, a margin of `reach` on both sides, and room for a last group of lanes.
    pub width: usize,
}

impl Band {
    /// A band with its buffers.
    pub fn new(rows: (usize, usize), shape: Shape) -> Self {
        let ring = vec![0.0; (2 * shape.reach_rows + 1) * shape.width + CACHE_LINE / size_of::<f64>()];
        Band {
            rows,
            below: vec![0.0; shape.reach_rows * shape.width],
            above: vec![0.0; shape.reach_rows * shape.width],
            ring_start: ring.as_ptr().align_offset(CACHE_LINE).min(CACHE_LINE / size_of::<f64>()),
            ring,
            sums: vec![Sums([0.0; PADDED]); shape.reach + 1],
            rate: vec![0.0; BLOCK + MOST_LANES],
        }
    }
}

impl HeapSize for Band {
    fn heap_size(&self) -> usize {
        let rows = self.below.heap_size() + self.above.heap_size() + self.ring.heap_size();
        rows + self.sums.capacity() * size_of::<Sums>() + self.rate.heap_size()
    }
}

/// Everything constant about a sweep.
pub struct Frame<'a, L, S> {
    /// Shape of rows.
    pub shape: Shape,
    /// Rows and their particles.
    pub lattice: &'a Lattice,
    /// Weights.
    pub stencil: &'a Stencil,
    /// Sum of all weights, the weight of the particle itself.
    pub sum: f64,
    /// Enthalpy to potential.
    pub laws: &'a L,
    /// Ghosts.
    pub surroundings: &'a S,
}

/// Sweeps one band. `patches` receives the wall rates of each row of the band.
pub fn sweep<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
) {
    let reach = frame.shape.reach_rows.min(WIDEST);
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
            // SAFETY: the processor has just been asked for these features.
            return unsafe { sweep_avx512(frame, band, target, patches, avx512::BY_REACH[reach]) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { sweep_avx2(frame, band, target, patches, avx2::BY_REACH[reach]) };
        }
    }
    rows(frame, band, target, patches, plain::BY_REACH[reach]);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl")]
fn sweep_avx512<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
    block: BlockSums,
) {
    rows(frame, band, target, patches, block);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sweep_avx2<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    band: &mut Band,
    target: &mut T,
    patches: &mut [[f64; 4]],
    block: BlockSums,
) {
    rows(frame, band, target, patches, block);
}

/// Rates of some particles of a row, into their slots. Only the reach and the processor's vectors are compiled into it: laws and targets
/// have their potentials and slots ready before.
type BlockSums = unsafe fn(&Near<'_>, &mut [Sums], &mut [f64], Option<f64>);

/// What lies around the particles of a block.
struct Near<'a> {
    weights: &'a [[f64; 9]; 9],
    /// Whether the weights fit a disc.
    disc: bool,
    /// Sum of all weights.
    sum: f64,
    reach: usize,
    /// Rows of potentials, from the lowest to the highest.
    rows: &'a [&'a [f64]; 17],
    /// First column.
    column: usize,
}

/// Blocks by their reach, for the vectors of one kind of processor.
macro_rules! blocks {
    ($name:ident, $lanes:literal $(, $feature:literal)?) => {
        mod $name {
            use super::{BlockSums, Near, Sums};

            $(#[target_feature(enable = $feature)])?
            fn block<const ROWS: usize>(near: &Near<'_>, sums: &mut [Sums], slots: &mut [f64], step: Option<f64>) {
                super::block::<$lanes, ROWS>(near, sums, slots, step);
            }

            /// Those of each reach; on a line there is none.
            pub(super) const BY_REACH: [BlockSums; super::WIDEST + 1] = [
                block::<1>, block::<1>, block::<2>, block::<3>, block::<4>, block::<5>, block::<6>, block::<7>, block::<8>,
            ];
        }
    };
}

blocks!(plain, 4);
#[cfg(target_arch = "x86_64")]
blocks!(avx2, 8, "avx2");
#[cfg(target_arch = "x86_64")]
blocks!(avx512, 8, "avx512f,avx512vl");

/// Fills the slot of a row in the ring of rows.
#[inline(always)]
fn fill_slot<L: Laws, S: Surroundings, T: Target>(
    frame: &Frame<'_, L, S>,
    row: usize,
    slots: usize,
    base: usize,
    ring: &mut [f64],
    target: &T,
) {
    let Shape { reach, width, .. } = frame.shape;
    let slot = &mut ring[(row % slots) * width..][..width];
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
    block: BlockSums,
) {
    let Shape { reach, reach_rows, width } = frame.shape;
    let (first_row, end_row) = band.rows;
    let slots = 2 * reach_rows + 1;
    let base = frame.lattice.start(first_row);
    let Band { below, above, ring, ring_start, sums, rate, .. } = band;
    let ring = &mut ring[*ring_start..];
    let has_patches = frame.surroundings.has_patches();
    let mut weights = [[0.0; 9]; 9];
    for (k, by_row) in weights.iter_mut().enumerate().take(reach_rows + 1) {
        for (dy, weight) in by_row.iter_mut().enumerate().take(reach_rows + 1) {
            *weight = frame.stencil.at(k, dy);
        }
    }
    let disc = frame.stencil.fits_disc();
    for row in first_row..end_row.min(first_row + reach_rows) {
        fill_slot::<L, S, T>(frame, row, slots, base, ring, target);
    }
    for row in first_row..end_row {
        if row + reach_rows < end_row {
            fill_slot::<L, S, T>(frame, row + reach_rows, slots, base, ring, target);
        }
        let at = |offset: usize| -> &[f64] {
            // offset 0..=2 reach_rows stands for row - reach_rows ..= row + reach_rows
            let position = row + offset;
            if position < first_row + reach_rows {
                &below[(position - first_row) * width..][..width]
            } else if position - reach_rows < end_row {
                &ring[((position - reach_rows) % slots) * width..][..width]
            } else {
                &above[(position - reach_rows - end_row) * width..][..width]
            }
        };
        let mut near: [&[f64]; 17] = [&[]; 17];
        for (offset, near) in near.iter_mut().enumerate().take(slots) {
            *near = at(offset);
        }
        let ((first, end), start) = (frame.lattice.span(row), frame.lattice.start(row));
        if has_patches {
            patches[row - first_row] = frame.surroundings.patches(row, &near[..slots]);
        }
        let mut column = first;
        while column < end {
            let count = (end - column).min(BLOCK);
            let from = start - base + column - first;
            let step = target.step();
            if reach_rows == 0 {
                line(frame.stencil, frame.sum, reach, near[0], column, &mut rate[..count]);
                let slots = target.slots(from..from + count);
                slots.iter_mut().zip(&rate[..count]).for_each(|(slot, rate)| settle(slot, *rate, step));
            } else {
                let slots = target.slots(from..from + count);
                let near = Near { weights: &weights, disc, sum: frame.sum, reach, rows: &near, column };
                // SAFETY: blocks are those of this processor.
                unsafe { block(&near, sums, slots, step) };
            }
            column += count;
        }
    }
}

/// Rates of particles on a line from column `column` on, where the column sums are the weighted potentials themselves.
#[inline(always)]
fn line(stencil: &Stencil, sum: f64, reach: usize, row: &[f64], column: usize, rate: &mut [f64]) {
    let row = &row[column..column + rate.len() + 2 * reach];
    for (rate, centre) in rate.iter_mut().zip(&row[reach..]) {
        *rate = -(sum * centre);
    }
    for k in 1..=reach {
        let weight = stencil.at(k, 0);
        let pairs = row[reach - k..].iter().zip(&row[reach + k..]);
        for (rate, (left, right)) in rate.iter_mut().zip(pairs) {
            *rate += weight * (left + right);
        }
    }
}

#[inline(always)]
fn block<const LANES: usize, const ROWS: usize>(
    near: &Near<'_>,
    sums: &mut [Sums],
    slots: &mut [f64],
    step: Option<f64>,
) {
    let Near { weights, disc, sum, reach, rows: near, column } = *near;
    // Column sums of all columns that the block reaches.
    let length = slots.len() + 2 * reach;
    if disc {
        column_sums::<LANES, ROWS, true>(weights, sum, near, column, length, sums);
    } else {
        column_sums::<LANES, ROWS, false>(weights, sum, near, column, length, sums);
    }
    // Every particle adds the column sums from its left and right.
    let (slots, rest) = slots.as_chunks_mut::<LANES>();
    let groups = slots.len();
    let (mut left, mut right) = ([&[][..]; WIDEST + 1], [&[][..]; WIDEST + 1]);
    for k in 0..=ROWS {
        left[k] = groups_of::<LANES>(&sums[k].0[reach - k..], groups);
        right[k] = groups_of::<LANES>(&sums[k].0[reach + k..], groups);
    }
    for (group, slots) in slots.iter_mut().enumerate() {
        if opaque() {
            break;
        }
        let mut total = left[0][group];
        for k in 1..=ROWS {
            for lane in 0..LANES {
                total[lane] += left[k][group][lane] + right[k][group][lane];
            }
        }
        for lane in 0..LANES {
            settle(&mut slots[lane], total[lane], step);
        }
    }
    for (place, slot) in (reach + groups * LANES..).zip(rest) {
        let mut total = sums[0].0[place];
        for (k, sums) in sums.iter().enumerate().take(ROWS + 1).skip(1) {
            total += sums.0[place - k] + sums.0[place + k];
        }
        settle(slot, total, step);
    }
}

/// False, but the compiler cannot know: a loop over groups that may end early is not vectorised a second time
/// across groups, which gathers and scatters and is two to three times slower for stencils of one or two cells.
#[inline(always)]
fn opaque() -> bool {
    std::hint::black_box(false)
}

/// The first groups of lanes of a slice that is padded to hold them.
#[inline(always)]
fn groups_of<const LANES: usize>(values: &[f64], groups: usize) -> &[[f64; LANES]] {
    &values[..groups * LANES].as_chunks::<LANES>().0[..groups]
}

/// Whether offset (k, dy) can carry weight in a stencil of this reach: all of the square, or its disc.
#[inline(always)]
const fn carries<const ROWS: usize, const DISC: bool>(k: usize, dy: usize) -> bool {
    !DISC || k * k + dy * dy <= ROWS * ROWS
}

#[inline(always)]
fn column_sums<const LANES: usize, const ROWS: usize, const DISC: bool>(
    weights: &[[f64; 9]; 9],
    sum: f64,
    near: &[&[f64]; 17],
    column: usize,
    length: usize,
    sums: &mut [Sums],
) {
    let groups = length.div_ceil(LANES);
    let mut rows = [&[][..]; 2 * WIDEST + 1];
    for (row, near) in rows.iter_mut().zip(near).take(2 * ROWS + 1) {
        *row = groups_of::<LANES>(&near[column..], groups);
    }
    let sums = &mut sums[..ROWS + 1];
    for group in 0..groups {
        if ROWS < 3 && opaque() {
            break;
        }
        let mut folded = [[0.0; LANES]; WIDEST + 1];
        folded[0] = rows[ROWS][group];
        for dy in 1..=ROWS {
            for lane in 0..LANES {
                folded[dy][lane] = rows[ROWS - dy][group][lane] + rows[ROWS + dy][group][lane];
            }
        }
        for k in 0..=ROWS {
            let mut total = [0.0; LANES];
            for lane in 0..LANES {
                total[lane] = if k == 0 { -(sum * folded[0][lane]) } else { weights[k][0] * folded[0][lane] };
            }
            for dy in 1..=ROWS {
                if carries::<ROWS, DISC>(k, dy) {
                    for lane in 0..LANES {
                        total[lane] += weights[k][dy] * folded[dy][lane];
                    }
                }
            }
            sums[k].0[group * LANES..group * LANES + LANES].copy_from_slice(&total);
        }
    }
}

#[cfg(test)]
mod tests;
