//! What becomes of the rates of a row: group by group into their slots, as these take them.

use super::lanes::Lanes;
use crate::kernels::target::Taken;

/// Rates of the groups of a row, which are asked for one after the other.
pub(super) trait Groups<V: Lanes> {
    /// Whether a row may be as short as what is left over of whole groups, so that what these cost counts.
    const IS_SHORT: bool;

    /// Rates of the particles from one on, as many as stand side by side.
    ///
    /// # Safety
    /// As [`Lanes`], and there must be so many particles.
    unsafe fn next(&mut self, first: usize) -> V;

    /// Rates of the last particles, fewer than stand side by side.
    ///
    /// # Safety
    /// As [`Lanes`], and there must be some.
    unsafe fn last(&mut self, first: usize) -> V;
}

/// Hands on the rates of all particles with the number of the first, and those of the last, which may be fewer than stand side by side,
/// to another.
///
/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn each<V: Lanes, G: Groups<V>>(
    mut groups: G,
    count: usize,
    mut whole: impl FnMut(usize, V),
    some: impl FnOnce(usize, V),
) {
    let end = count - count % V::WIDTH;
    // SAFETY: as the caller says.
    unsafe {
        for first in (0..end).step_by(V::WIDTH) {
            whole(first, groups.next(first));
        }
        if end < count {
            some(end, groups.last(end));
        }
    }
}

/// Numbers of the last group, which are too few for one.
///
/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn load_rest<V: Lanes, G: Groups<V>>(from: &[f64]) -> V {
    // SAFETY: as the caller says.
    unsafe { if G::IS_SHORT { V::load_end(from) } else { V::load_some(from) } }
}

/// # Safety
/// As [`Lanes`].
#[inline(always)]
unsafe fn store_rest<V: Lanes, G: Groups<V>>(numbers: V, into: &mut [f64]) {
    // SAFETY: as the caller says.
    unsafe { if G::IS_SHORT { numbers.store_end(into) } else { numbers.store_some(into) } }
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

/// Settles the rates of `count` particles, whose slots begin at `slots`; what rates are made of may stand there, too.
///
/// # Safety
/// As [`Lanes`], and there must be as many slots.
#[inline(always)]
pub(super) unsafe fn settle<V: Lanes, G: Groups<V>>(groups: G, slots: *mut f64, count: usize, taken: Taken<'_>) {
    // SAFETY: as the caller says; nobody else has the last slots while they are filled.
    unsafe {
        let rest = |first: usize| std::slice::from_raw_parts_mut(slots.add(first), count - first);
        match taken {
            Taken::Replacing => each(
                groups,
                count,
                |first, rates: V| rates.store(slots.add(first)),
                |first, rates| store_rest::<V, G>(rates, rest(first)),
            ),
            Taken::Adding(step) => {
                let step = V::factor(step);
                each(
                    groups,
                    count,
                    |first, rates: V| rates.times_plus(step, V::load(slots.add(first))).store(slots.add(first)),
                    |first, rates| {
                        let slots = rest(first);
                        store_rest::<V, G>(rates.times_plus(step, load_rest::<V, G>(slots)), slots);
                    },
                );
            }
            Taken::Keeping { step, lost } => {
                let step = V::factor(step);
                let (lost, lost_rest) = lost.split_at_mut(count - count % V::WIDTH);
                let lost = lost.as_mut_ptr();
                each(
                    groups,
                    count,
                    |first, rates: V| {
                        let slots = slots.add(first);
                        let (next, left) = kept(rates, step, V::load(slots), V::load(lost.add(first)));
                        next.store(slots);
                        left.store(lost.add(first));
                    },
                    |first, rates| {
                        let slots = rest(first);
                        let (content, lost) = (load_rest::<V, G>(slots), load_rest::<V, G>(lost_rest));
                        let (next, left) = kept(rates, step, content, lost);
                        store_rest::<V, G>(next, slots);
                        store_rest::<V, G>(left, lost_rest);
                    },
                );
            }
        }
    }
}
