//! Rates of neighbouring particles of a row, in one pass over what lies around them.
//!
//! Groups of eight columns are visited from left to right. Of each, rows +dy and -dy are added first (`s_dy`), then each
//! distance k gathers its rows (`v_k = sum_dy w(k, dy) s_dy`). These column sums stay in registers until the group behind
//! is known too, and a particle adds `v_k` from its left and right. On a line potentials are all there is to be added.

#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512, Four};
use super::lanes::{LANES, Lanes, Portable};
use super::{WIDEST, Weights};
use crate::kernels::target::Taken;

/// Rates of some particles of a row, into their slots. Only the reach and the processor's vectors are compiled into it: laws and targets
/// have their potentials and slots ready before.
pub(super) type BlockRates = unsafe fn(&Near<'_>, &mut [f64], Taken<'_>);

/// What lies around the particles of a block.
pub(super) struct Near<'a> {
    pub(super) weights: &'a Weights,
    /// Rows of potentials, from the lowest to the highest, each from a group before its first particle on, and as long as a
    /// group after the one that the last particle is in.
    pub(super) rows: &'a [&'a [f64]],
    /// First column.
    pub(super) column: usize,
    /// What is read next from memory.
    pub(super) soon: Soon,
}

/// Numbers that are read soon: fetched between sums, which leave memory idle, they do not have to be waited for.
#[derive(Clone, Copy)]
pub(super) struct Soon {
    first: *const f64,
    count: usize,
}

impl Soon {
    /// These numbers.
    #[inline(always)]
    pub(super) fn of(numbers: &[f64]) -> Self {
        Soon { first: numbers.as_ptr(), count: numbers.len() }
    }

    /// Fetches the cache line of one of them.
    #[inline(always)]
    fn fetch(self, number: usize) {
        #[cfg(target_arch = "x86_64")]
        if number < self.count {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            // SAFETY: a fetch reads and writes nothing that a program sees.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(self.first.wrapping_add(number).cast()) };
        }
        // Others fetch what they read in a row by themselves.
        #[cfg(not(target_arch = "x86_64"))]
        let _ = (self.first, self.count, number);
    }
}

/// Blocks by whether they lie on a line or in the plane, and by their reach, from 0, which is none.
type Blocks = [[BlockRates; WIDEST + 1]; 2];

/// Blocks for the vectors of one kind of processor: those of lines and of stencils that reach far, and those of others.
macro_rules! blocks {
    ($blocks:ident, $far:ty, $near:ty $(, $feature:literal)?) => {
        pub(super) const $blocks: Blocks = {
            $(#[target_feature(enable = $feature)])?
            fn line<const REACH: usize>(near: &Near<'_>, slots: &mut [f64], taken: Taken<'_>) {
                // SAFETY: this is compiled for the instructions of these lanes.
                unsafe { block::<$far, REACH, 0, true>(near, slots, taken) }
            }

            $(#[target_feature(enable = $feature)])?
            fn plane<const REACH: usize>(near: &Near<'_>, slots: &mut [f64], taken: Taken<'_>) {
                // SAFETY: as above.
                unsafe {
                    match (REACH <= <$near as Lanes>::WIDTH, near.weights.disc) {
                        (true, true) => block::<$near, REACH, REACH, true>(near, slots, taken),
                        (true, false) => block::<$near, REACH, REACH, false>(near, slots, taken),
                        (false, true) => block::<$far, REACH, REACH, true>(near, slots, taken),
                        (false, false) => block::<$far, REACH, REACH, false>(near, slots, taken),
                    }
                }
            }

            [
                [line::<1>, line::<1>, line::<2>, line::<3>, line::<4>, line::<5>, line::<6>, line::<7>, line::<8>],
                [plane::<1>, plane::<1>, plane::<2>, plane::<3>, plane::<4>, plane::<5>, plane::<6>, plane::<7>, plane::<8>],
            ]
        };
    };
}

blocks!(PORTABLE, Portable, Portable);
#[cfg(target_arch = "x86_64")]
blocks!(AVX2, Avx2, Four, "avx2,fma");
#[cfg(target_arch = "x86_64")]
blocks!(AVX512, Avx512, Avx512, "avx512f,avx512vl");

/// Whether offset (k, dy) can carry weight in a stencil of this reach: all of the square or its disc, or a line.
#[inline(always)]
const fn carries<const REACH: usize, const ROWS: usize, const DISC: bool>(k: usize, dy: usize) -> bool {
    dy <= ROWS && (!DISC || k * k + dy * dy <= REACH * REACH)
}

/// Column sums of a group of columns, by distance.
type Sums<V> = [V; WIDEST + 1];

/// What all groups of a block share.
struct Factors<F> {
    by_distance: [[F; WIDEST + 1]; WIDEST + 1],
    /// The weight of the particle itself.
    own: F,
}

/// Repeats a block for each distance up to the widest, a constant in it: the compiler would not unroll loops as long as those
/// of wide stencils, and sums that a loop counts through do not stay in registers.
macro_rules! for_each_distance {
    ($k:ident, $body:block) => {
        for_each_distance!($k, $body, 1 2 3 4 5 6 7 8)
    };
    ($k:ident, $body:block, $($distance:literal)*) => {
        $({
            const $k: usize = $distance;
            $body
        })*
    };
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn column_sums<V: Lanes, const REACH: usize, const ROWS: usize, const DISC: bool>(
    factors: &Factors<V::Factor>,
    rows: &[*const f64; 2 * WIDEST + 1],
    at: usize,
) -> Sums<V> {
    // SAFETY: as the caller says.
    unsafe {
        let middle = V::load(rows[ROWS].add(at));
        let mut sums = [middle; WIDEST + 1];
        sums[0] = middle.times(factors.own);
        for_each_distance!(K, {
            if K <= REACH && carries::<REACH, ROWS, DISC>(K, 1) {
                sums[K] = middle.times(factors.by_distance[K][0]);
            }
        });
        for_each_distance!(DY, {
            if DY <= ROWS {
                let folded = V::load(rows[ROWS - DY].add(at)).plus(V::load(rows[ROWS + DY].add(at)));
                sums[0] = folded.times_plus(factors.by_distance[0][DY], sums[0]);
                for_each_distance!(K, {
                    if K <= REACH && carries::<REACH, ROWS, DISC>(K, DY) {
                        sums[K] = folded.times_plus(factors.by_distance[K][DY], sums[K]);
                    }
                });
            }
        });
        sums
    }
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn rates<V: Lanes, const REACH: usize, const ROWS: usize, const DISC: bool>(
    factors: &Factors<V::Factor>,
    [before, here, after]: [&Sums<V>; 3],
) -> V {
    // SAFETY: as the caller says.
    unsafe {
        let mut total = here[0];
        for_each_distance!(K, {
            if K <= REACH {
                let pair = V::from_before::<K>(before[K], here[K]).plus(V::from_after::<K>(here[K], after[K]));
                total = if carries::<REACH, ROWS, DISC>(K, 1) {
                    total.plus(pair)
                } else {
                    // The row itself is all that carries: its weight has been left for now.
                    pair.times_plus(factors.by_distance[K][0], total)
                };
            }
        });
        total
    }
}

/// Rates of a group of the only row of a line: what stands beside particles is read where it stands, which takes less than shifts
/// between registers where there are no sums to be shifted.
///
/// # Safety
/// As [`Lanes`], and there must be a group on either side.
#[inline(always)]
unsafe fn line_rates<V: Lanes, const REACH: usize>(factors: &Factors<V::Factor>, from: *const f64) -> V {
    // SAFETY: as the caller says: distances are no longer than a group.
    unsafe {
        let mut total = V::load(from).times(factors.own);
        for_each_distance!(K, {
            if K <= REACH {
                let pair = V::load(from.sub(K)).plus(V::load(from.add(K)));
                total = pair.times_plus(factors.by_distance[K][0], total);
            }
        });
        total
    }
}

/// Column sums of three groups, one after the other, of which rates of the one in the middle follow.
struct Window<V: Lanes, const REACH: usize, const ROWS: usize, const DISC: bool> {
    factors: Factors<V::Factor>,
    /// Where rows begin, a group before the first particle.
    rows: [*const f64; 2 * WIDEST + 1],
    before: Sums<V>,
    here: Sums<V>,
}

impl<V: Lanes, const REACH: usize, const ROWS: usize, const DISC: bool> Window<V, REACH, ROWS, DISC> {
    /// Rates of the particles from one on, the next ones.
    ///
    /// # Safety
    /// As [`Lanes`], and there must be as many numbers after them as there are lanes.
    #[inline(always)]
    unsafe fn next(&mut self, first: usize) -> V {
        // SAFETY: as the caller says.
        unsafe {
            let at = LANES + first;
            if ROWS == 0 {
                return line_rates::<V, REACH>(&self.factors, self.rows[0].add(at));
            }
            let after = column_sums::<V, REACH, ROWS, DISC>(&self.factors, &self.rows, at + V::WIDTH);
            let rates = rates::<V, REACH, ROWS, DISC>(&self.factors, [&self.before, &self.here, &after]);
            (self.before, self.here) = (self.here, after);
            rates
        }
    }

    /// Hands on the rates of all particles with their slots, by the number of the first, and those of the last, which may be fewer than
    /// there are lanes, to another.
    ///
    /// # Safety
    /// As [`Lanes`].
    #[inline(always)]
    unsafe fn settle(
        mut self,
        slots: &mut [f64],
        soon: Soon,
        mut whole: impl FnMut(usize, V, *mut f64),
        some: impl FnOnce(V, &mut [f64]),
    ) {
        let end = slots.len() - slots.len() % V::WIDTH;
        // SAFETY: as the caller says.
        unsafe {
            for first in (0..end).step_by(V::WIDTH) {
                // Shorter sums leave no time for it.
                if REACH > 1 && first.is_multiple_of(LANES) {
                    soon.fetch(first);
                }
                whole(first, self.next(first), slots.as_mut_ptr().add(first));
            }
            if end < slots.len() {
                some(self.next(end), &mut slots[end..]);
            }
        }
    }
}

/// Numbers of the last group, which are too few for one.
///
/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn load_rest<V: Lanes, const ROWS: usize>(from: &[f64]) -> V {
    // SAFETY: as the caller says.
    unsafe { if ROWS == 0 { V::load_end(from) } else { V::load_some(from) } }
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn store_rest<V: Lanes, const ROWS: usize>(numbers: V, into: &mut [f64]) {
    // SAFETY: as the caller says.
    unsafe { if ROWS == 0 { numbers.store_end(into) } else { numbers.store_some(into) } }
}

/// Contents and what rounding keeps from them after a change by a rate, as [`crate::solvers::kept`] has it.
///
/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn kept<V: Lanes>(rates: V, step: V::Factor, content: V, lost: V) -> (V, V) {
    // SAFETY: as the caller says.
    unsafe {
        let change = rates.times(step).plus(lost);
        let next = content.plus(change);
        (next, change.minus(next.minus(content)))
    }
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn block<V: Lanes, const REACH: usize, const ROWS: usize, const DISC: bool>(
    near: &Near<'_>,
    slots: &mut [f64],
    taken: Taken<'_>,
) {
    let (at, groups) = (near.column, slots.len().div_ceil(LANES));
    let mut rows = [std::ptr::null(); 2 * WIDEST + 1];
    for (row, near) in rows.iter_mut().zip(&near.rows[..2 * ROWS + 1]) {
        *row = near[at..at + (groups + 2) * LANES].as_ptr();
    }
    // SAFETY: as the caller says.
    unsafe {
        let own = V::factor(-near.weights.sum);
        let mut factors = Factors { by_distance: [[own; WIDEST + 1]; WIDEST + 1], own };
        for k in 0..=REACH {
            for dy in 0..=ROWS {
                factors.by_distance[k][dy] = V::factor(near.weights.by_distance[k][dy]);
            }
        }
        let before = column_sums::<V, REACH, ROWS, DISC>(&factors, &rows, LANES - V::WIDTH);
        let here = column_sums::<V, REACH, ROWS, DISC>(&factors, &rows, LANES);
        let window: Window<V, REACH, ROWS, DISC> = Window { factors, rows, before, here };
        match taken {
            Taken::Replacing => {
                window.settle(
                    slots,
                    near.soon,
                    |_, rates, slots| rates.store(slots),
                    |rates, slots| store_rest::<V, ROWS>(rates, slots),
                );
            }
            Taken::Adding(step) => {
                let step = V::factor(step);
                window.settle(
                    slots,
                    near.soon,
                    |_, rates, slots| rates.times_plus(step, V::load(slots)).store(slots),
                    |rates, slots| store_rest::<V, ROWS>(rates.times_plus(step, load_rest::<V, ROWS>(slots)), slots),
                );
            }
            Taken::Keeping { step, lost } => {
                let step = V::factor(step);
                let (lost, lost_rest) = lost.split_at_mut(slots.len() - slots.len() % V::WIDTH);
                let lost = lost.as_mut_ptr();
                window.settle(
                    slots,
                    near.soon,
                    |first, rates, slots| {
                        let (next, left) = kept(rates, step, V::load(slots), V::load(lost.add(first)));
                        next.store(slots);
                        left.store(lost.add(first));
                    },
                    |rates, slots| {
                        let (content, lost) = (load_rest::<V, ROWS>(slots), load_rest::<V, ROWS>(lost_rest));
                        let (next, left) = kept(rates, step, content, lost);
                        store_rest::<V, ROWS>(next, slots);
                        store_rest::<V, ROWS>(left, lost_rest);
                    },
                );
            }
        }
    }
}
