//! What fronts exchange with what lies around them.

use super::faces::Faces;
use super::numbers::{Flags as _, Kind, Numbers as _};
use super::orientation::Orientation;
use super::pairs::{Pairs, near};
use super::window::Window;

/// What fronts exchange that are side by side in the middle of a window, in materials that freeze between two enthalpies
/// (J/m3).
///
/// Particles that a front is `ENTERING` from a face have potentials of their own, by which they exchange heat with others:
/// that is taken back.
#[inline(always)]
pub(super) fn exchange<K: Kind<L>, const L: usize, const ENTERING: bool>(
    kind: K,
    pairs: &Pairs,
    faces: &Faces,
    interval: (f64, f64),
    window: &mut Window<L>,
) {
    if ENTERING {
        window.note_all_phases(faces);
    } else {
        window.note_phases(faces);
    }
    let lies = if pairs.turned { Orientation::of(kind, window, interval) } else { Orientation::flat(kind) };
    let (zero, one, half) = (kind.of(0.0), kind.of(1.0), kind.of(0.5));
    let own = if ENTERING { kind.load(&window.all_above[window.above.len() / 2]) } else { zero };
    let fractions = kind.load(&window.fractions);
    window.changes.fill([0.0; L]);
    let mut to_middle = zero;
    for pair in &pairs.own {
        let (other, weight) = (pair.other as usize, kind.of(pair.weight));
        let above = kind.load(&window.above[other]);
        let beyond = kind.load(&window.above[pair.opposite as usize]);
        let carried = lies.carried(kind, (pair.offset, pair.cells), (above, beyond), fractions);
        let mut change = weight * above * if ENTERING { carried } else { carried - one };
        let freezing = kind.flags(&window.freezing[other]);
        if ENTERING {
            let all_above = kind.load(&window.all_above[other]);
            let plain = weight * (all_above - own);
            // On its own side a particle exchanges by its own potential until that lies on the line from the front to the
            // other.
            let limited = change.or_less(plain).or(zero.is_less(own), change.or_greater(plain));
            let beside = limited.or(zero.is_less(above * own), change);
            // Of two that are entered, each takes back half.
            let back = (half * plain).or(all_above.differs(zero), plain);
            let at_front = (zero - back).or(freezing, zero);
            change = (beside - plain).or(above.differs(zero), at_front);
        }
        if pairs.turned && freezing.any() {
            let other = window.frozen_fraction(kind, other, interval);
            let along = weight * lies.along(kind, pair.offset, (fractions, other));
            change = change + along.or(freezing, zero);
        }
        let changes = kind.load(&window.changes[other]) - change;
        kind.store(changes, &mut window.changes[other]);
        to_middle = to_middle + change;
    }
    exchange_over(kind, pairs, window, to_middle);
}

/// Adds what pairs over the fronts exchange, and notes what comes to the middle.
#[inline(always)]
fn exchange_over<K: Kind<L>, const L: usize>(
    kind: K,
    pairs: &Pairs,
    window: &mut Window<L>,
    mut to_middle: K::Numbers,
) {
    for (cells, own) in window.near.iter_mut().enumerate().skip(1) {
        *own = near(kind, cells, &window.fractions);
    }
    let zero = kind.of(0.0);
    for pair in &pairs.over {
        let taken = pair.taken(kind, &pairs.ways, window);
        if !taken.any() {
            continue;
        }
        let (frozen, unfrozen, weight) = (pair.frozen as usize, pair.unfrozen as usize, kind.of(pair.weight));
        let carried = kind.of(pair.weight * pair.cells as f64);
        let below = kind.load(&window.above[frozen]).or(taken, zero);
        let above = kind.load(&window.above[unfrozen]).or(taken, zero);
        let near = kind.load(&window.near[pair.before][0]);
        let far = kind.load(&window.near[pair.cells - pair.before][1]);
        let (cold, warm) = (carried * below * near, carried * above * far);
        let direct = weight * (above - below);
        let of_frozen = kind.load(&window.changes[frozen]) - (cold + direct);
        let of_unfrozen = kind.load(&window.changes[unfrozen]) + (direct - warm);
        kind.store(of_frozen, &mut window.changes[frozen]);
        kind.store(of_unfrozen, &mut window.changes[unfrozen]);
        to_middle = to_middle + (cold + warm);
    }
    let middle = window.changes.len() / 2;
    kind.store(to_middle, &mut window.changes[middle]);
}
