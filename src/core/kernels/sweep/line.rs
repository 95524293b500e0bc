//! Rates of a line, the only row of its lattice, in one pass over its particles: potentials of a group stay in registers until the groups
//! beside it have theirs.
//!
//! Laws of straight pieces are evaluated there, of the enthalpies themselves: what goes through memory and is read again at other
//! distances has to be waited for, which takes a short line longer than its sums. Potentials of other laws are read.

use super::block::for_each_distance;
#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512};
use super::lanes::{LANES, Lanes, Portable};
use super::settle::{Groups, settle};
use super::{Behind, EndWeights, Ends, WIDEST, Weights};
use crate::kernels::target::Slots;
use crate::physics::potential::Kinked;

/// Fewest particles of a line whose potentials are made as they are summed: those of both ends are made first.
pub(super) const FEWEST: usize = 2 * LANES;

/// What lies around the particles of a line.
pub(super) struct Along<'a> {
    pub(super) weights: &'a Weights,
    /// Potentials, from a group before the first particle on, and as long as a group after the one that the last particle is in. Where
    /// there is a law, those of ghosts and of the particles at the ends are written, by the group; else all are read.
    pub(super) potentials: &'a mut [f64],
    /// The law of all particles, if it is evaluated here, and the ends.
    pub(super) law: Option<(&'a Kinked, &'a Ends)>,
}

/// Rates of all particles of a line, into their slots; where there is a law, those through the ends beside them.
pub(super) type LineRates = unsafe fn(Along<'_>, Slots<'_>, &mut [f64; 4]);

/// Lines for the vectors of one kind of processor, by the reach of the stencil, from 0, which is none.
macro_rules! lines {
    ($lines:ident, $lanes:ty $(, $feature:literal)?) => {
        pub(super) const $lines: [LineRates; WIDEST + 1] = {
            $(#[target_feature(enable = $feature)])?
            fn line<const REACH: usize>(along: Along<'_>, slots: Slots<'_>, through: &mut [f64; 4]) {
                // SAFETY: this is compiled for the instructions of these lanes.
                unsafe { self::line::<$lanes, REACH>(along, slots, through) }
            }

            [line::<1>, line::<1>, line::<2>, line::<3>, line::<4>, line::<5>, line::<6>, line::<7>, line::<8>]
        };
    };
}

lines!(PORTABLE, Portable);
#[cfg(target_arch = "x86_64")]
lines!(AVX2, Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
lines!(AVX512, Avx512, "avx512f,avx512vl");

/// Where the potentials of groups come from.
trait Potentials<V: Lanes> {
    /// Those of a whole group, by its first particle.
    ///
    /// # Safety
    /// As [`Lanes`].
    unsafe fn group(&self, first: usize) -> V;
}

/// From where they have been filled in.
struct Filled {
    /// That of the first particle.
    start: *const f64,
}

impl<V: Lanes> Potentials<V> for Filled {
    #[inline(always)]
    unsafe fn group(&self, first: usize) -> V {
        // SAFETY: as the caller says.
        unsafe { V::load(self.start.add(first)) }
    }
}

/// By a law of straight pieces from enthalpies.
struct OfLaw<F> {
    /// Enthalpy of the first particle.
    enthalpy: *const f64,
    frozen_slope: F,
    unfrozen_slope: F,
    frozen_below: F,
    unfrozen_above: F,
    frozen_rest: F,
    unfrozen_rest: F,
}

impl<V: Lanes> Potentials<V> for OfLaw<V::Factor> {
    #[inline(always)]
    unsafe fn group(&self, first: usize) -> V {
        // SAFETY: as the caller says. The operations are those of the law itself.
        unsafe {
            let enthalpy = V::load(self.enthalpy.add(first));
            let cold = enthalpy.lesser(self.frozen_below).less(self.frozen_rest);
            let warm = enthalpy.greater(self.unfrozen_above).less(self.unfrozen_rest);
            cold.times(self.frozen_slope).plus(warm.times(self.unfrozen_slope))
        }
    }
}

/// Potentials of three groups, one after the other, of which rates of the one in the middle follow.
struct Window<V: Lanes, P, const REACH: usize> {
    weights: [V::Factor; WIDEST + 1],
    /// Weight of the particle itself.
    own: V::Factor,
    potentials: P,
    /// Those after whole groups, by the first particle.
    filled: Filled,
    /// Particles in whole groups.
    whole: usize,
    before: V,
    here: V,
}

impl<V: Lanes, P: Potentials<V>, const REACH: usize> Groups<V> for Window<V, P, REACH> {
    const IS_SHORT: bool = true;

    #[inline(always)]
    unsafe fn next(&mut self, first: usize) -> V {
        // SAFETY: as the caller says.
        unsafe {
            let next = first + LANES;
            let after = if next < self.whole { self.potentials.group(next) } else { self.filled.group(next) };
            self.rates(after)
        }
    }

    #[inline(always)]
    unsafe fn last(&mut self, first: usize) -> V {
        // SAFETY: as the caller says.
        unsafe {
            let after = self.filled.group(first + LANES);
            self.rates(after)
        }
    }
}

impl<V: Lanes, P, const REACH: usize> Window<V, P, REACH> {
    /// Rates of the group in the middle, before the window moves on.
    ///
    /// # Safety
    /// As [`Lanes`].
    #[inline(always)]
    unsafe fn rates(&mut self, after: V) -> V {
        // SAFETY: as the caller says.
        unsafe {
            let mut total = self.here.times(self.own);
            for_each_distance!(K, {
                if K <= REACH {
                    let pair = V::from_before::<K>(self.before, self.here).plus(V::from_after::<K>(self.here, after));
                    total = pair.times_plus(self.weights[K], total);
                }
            });
            (self.before, self.here) = (self.here, after);
            total
        }
    }
}

/// Potentials behind an end, from the wall outward, of those before it, from the wall inward.
///
/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn behind<V: Lanes>(end: &Behind, images: V) -> V {
    // SAFETY: as the caller says.
    unsafe { images.times(V::factor(end.sign)).less(V::factor(-end.shift)) }
}

/// Heat rate through an end, from the potentials of its ghosts and of the particles before it.
#[inline(always)]
fn through_end<const REACH: usize>(
    weights: &EndWeights,
    ghost: impl Fn(usize) -> f64,
    particle: impl Fn(usize) -> f64,
) -> f64 {
    let mut rate = 0.0;
    for (layer, weight) in weights.of_ghosts.iter().enumerate().take(REACH) {
        rate += weight * ghost(layer);
    }
    for (cell, weight) in weights.of_particles.iter().enumerate().take(REACH) {
        rate -= weight * particle(cell);
    }
    rate
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn line<V: Lanes, const REACH: usize>(along: Along<'_>, slots: Slots<'_>, through: &mut [f64; 4]) {
    let Slots { rates, enthalpy, taken } = slots;
    let count = rates.len();
    let whole = count - count % LANES;
    let row = along.potentials[..whole + 3 * LANES].as_mut_ptr();
    let rates = rates.as_mut_ptr();
    // SAFETY: as the caller says; enthalpies are as many as slots, and the row has room for a group before and after them.
    unsafe {
        let start = row.add(LANES);
        let filled = Filled { start };
        let own = V::factor(-along.weights.sum);
        let mut weights = [own; WIDEST + 1];
        for (k, weight) in weights.iter_mut().enumerate().take(REACH + 1) {
            *weight = V::factor(along.weights.by_distance[k][0]);
        }
        match along.law {
            Some((law, Ends { behind: [left, right], open, weights: of_ends })) => {
                assert!(count >= LANES);
                let potentials = OfLaw {
                    enthalpy: enthalpy.map_or(rates.cast_const(), |enthalpy| enthalpy[..count].as_ptr()),
                    frozen_slope: V::factor(law.frozen_slope),
                    unfrozen_slope: V::factor(law.unfrozen_slope),
                    frozen_below: V::factor(law.frozen_below),
                    unfrozen_above: V::factor(law.unfrozen_above),
                    frozen_rest: V::factor(law.frozen_rest),
                    unfrozen_rest: V::factor(law.unfrozen_rest),
                };
                let (last, here): (V, V) = (potentials.group(count - LANES), potentials.group(0));
                last.store(start.add(count - LANES));
                behind(right, last.reversed()).store(start.add(count));
                let before = behind(left, here.reversed());
                before.store(row);
                here.store(start);
                if open[0] {
                    through[0] = through_end::<REACH>(of_ends, |layer| *start.sub(1 + layer), |cell| *start.add(cell));
                }
                if open[1] {
                    let end = start.add(count);
                    through[1] = through_end::<REACH>(of_ends, |layer| *end.add(layer), |cell| *end.sub(1 + cell));
                }
                let window: Window<V, _, REACH> = Window { weights, own, potentials, filled, whole, before, here };
                settle(window, rates, count, taken);
            }
            None => {
                let (potentials, before, here) = (Filled { start }, V::load(row), filled.group(0));
                let window: Window<V, _, REACH> = Window { weights, own, potentials, filled, whole, before, here };
                settle(window, rates, count, taken);
            }
        }
    }
}
