//! Rates of neighbouring particles of a row, in one pass over what lies around them.
//!
//! Groups of eight columns are visited from left to right. Of each, rows +dy and -dy are added first (`s_dy`), then each
//! distance k gathers its rows (`v_k = sum_dy w(k, dy) s_dy`). These column sums stay in registers until the group behind
//! is known too, and a particle adds `v_k` from its left and right.

#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512, Four};
use super::lanes::{LANES, Lanes, Portable};
use super::settle::{Groups, settle};
use super::{WIDEST, Weights};
use crate::kernels::target::Slots;

/// Rates of some particles of a row, into their slots. Only the reach and the processor's vectors are compiled into it: laws and targets
/// have their potentials and slots ready before.
pub(super) type BlockRates = unsafe fn(&Near<'_>, Slots<'_>);

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

/// Blocks for the vectors of one kind of processor, by their reach, from 0, which is none: those of stencils that reach far, and those of
/// others.
macro_rules! blocks {
    ($blocks:ident, $far:ty, $near:ty $(, $feature:literal)?) => {
        pub(super) const $blocks: [BlockRates; WIDEST + 1] = {
            $(#[target_feature(enable = $feature)])?
            fn plane<const REACH: usize>(near: &Near<'_>, slots: Slots<'_>) {
                // SAFETY: this is compiled for the instructions of these lanes.
                unsafe {
                    match (REACH <= <$near as Lanes>::WIDTH, near.weights.disc) {
                        (true, true) => block::<$near, REACH, true>(near, slots),
                        (true, false) => block::<$near, REACH, false>(near, slots),
                        (false, true) => block::<$far, REACH, true>(near, slots),
                        (false, false) => block::<$far, REACH, false>(near, slots),
                    }
                }
            }

            [plane::<1>, plane::<1>, plane::<2>, plane::<3>, plane::<4>, plane::<5>, plane::<6>, plane::<7>, plane::<8>]
        };
    };
}

blocks!(PORTABLE, Portable, Portable);
#[cfg(target_arch = "x86_64")]
blocks!(AVX2, Avx2, Four, "avx2,fma");
#[cfg(target_arch = "x86_64")]
blocks!(AVX512, Avx512, Avx512, "avx512f,avx512vl");

/// Whether offset (k, dy) can carry weight in a stencil of this reach: all of the square or its disc.
#[inline(always)]
const fn carries<const REACH: usize, const DISC: bool>(k: usize, dy: usize) -> bool {
    dy <= REACH && (!DISC || k * k + dy * dy <= REACH * REACH)
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
pub(super) use for_each_distance;

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn column_sums<V: Lanes, const REACH: usize, const DISC: bool>(
    factors: &Factors<V::Factor>,
    rows: &[*const f64; 2 * WIDEST + 1],
    at: usize,
) -> Sums<V> {
    // SAFETY: as the caller says.
    unsafe {
        let middle = V::load(rows[REACH].add(at));
        let mut sums = [middle; WIDEST + 1];
        sums[0] = middle.times(factors.own);
        for_each_distance!(K, {
            if K <= REACH && carries::<REACH, DISC>(K, 1) {
                sums[K] = middle.times(factors.by_distance[K][0]);
            }
        });
        for_each_distance!(DY, {
            if DY <= REACH {
                let folded = V::load(rows[REACH - DY].add(at)).plus(V::load(rows[REACH + DY].add(at)));
                sums[0] = folded.times_plus(factors.by_distance[0][DY], sums[0]);
                for_each_distance!(K, {
                    if K <= REACH && carries::<REACH, DISC>(K, DY) {
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
unsafe fn rates<V: Lanes, const REACH: usize, const DISC: bool>(
    factors: &Factors<V::Factor>,
    [before, here, after]: [&Sums<V>; 3],
) -> V {
    // SAFETY: as the caller says.
    unsafe {
        let mut total = here[0];
        for_each_distance!(K, {
            if K <= REACH {
                let pair = V::from_before::<K>(before[K], here[K]).plus(V::from_after::<K>(here[K], after[K]));
                total = if carries::<REACH, DISC>(K, 1) {
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

/// Column sums of three groups, one after the other, of which rates of the one in the middle follow.
struct Window<V: Lanes, const REACH: usize, const DISC: bool> {
    factors: Factors<V::Factor>,
    /// Where rows begin, a group before the first particle.
    rows: [*const f64; 2 * WIDEST + 1],
    /// What is read next from memory.
    soon: Soon,
    before: Sums<V>,
    here: Sums<V>,
}

impl<V: Lanes, const REACH: usize, const DISC: bool> Groups<V> for Window<V, REACH, DISC> {
    const IS_SHORT: bool = false;

    #[inline(always)]
    unsafe fn next(&mut self, first: usize) -> V {
        // Shorter sums leave no time for it.
        if REACH > 1 && first.is_multiple_of(LANES) {
            self.soon.fetch(first);
        }
        // SAFETY: as the caller says.
        unsafe { self.last(first) }
    }

    #[inline(always)]
    unsafe fn last(&mut self, first: usize) -> V {
        // SAFETY: as the caller says.
        unsafe {
            let after = column_sums::<V, REACH, DISC>(&self.factors, &self.rows, LANES + first + V::WIDTH);
            let rates = rates::<V, REACH, DISC>(&self.factors, [&self.before, &self.here, &after]);
            (self.before, self.here) = (self.here, after);
            rates
        }
    }
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn block<V: Lanes, const REACH: usize, const DISC: bool>(near: &Near<'_>, slots: Slots<'_>) {
    let (at, groups) = (near.column, slots.rates.len().div_ceil(LANES));
    let mut rows = [std::ptr::null(); 2 * WIDEST + 1];
    for (row, near) in rows.iter_mut().zip(&near.rows[..2 * REACH + 1]) {
        *row = near[at..at + (groups + 2) * LANES].as_ptr();
    }
    // SAFETY: as the caller says.
    unsafe {
        let own = V::factor(-near.weights.sum);
        let mut factors = Factors { by_distance: [[own; WIDEST + 1]; WIDEST + 1], own };
        for k in 0..=REACH {
            for dy in 0..=REACH {
                factors.by_distance[k][dy] = V::factor(near.weights.by_distance[k][dy]);
            }
        }
        let before = column_sums::<V, REACH, DISC>(&factors, &rows, LANES - V::WIDTH);
        let here = column_sums::<V, REACH, DISC>(&factors, &rows, LANES);
        let window: Window<V, REACH, DISC> = Window { factors, rows, soon: near.soon, before, here };
        settle(window, slots.rates.as_mut_ptr(), slots.rates.len(), slots.taken);
    }
}
