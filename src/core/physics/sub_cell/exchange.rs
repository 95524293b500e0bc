//! What fronts exchange with what lies around them.

use super::faces::Faces;
use super::orientation::Orientation;
use super::pairs::{OwnPair, Pairs, near};
use super::window::Window;

/// What fronts exchange that are side by side in the middle of a window, in materials that freeze between two enthalpies
/// (J/m3).
///
/// Particles that a front is `ENTERING` from a face have potentials of their own, by which they exchange heat with others:
/// that is taken back.
#[inline(always)]
pub(super) fn exchange<const L: usize, const ENTERING: bool>(
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
    let lies = if pairs.turned { Orientation::of(window, interval) } else { Orientation::FLAT };
    let own = if ENTERING { window.all_above[window.above.len() / 2] } else { [0.0; L] };
    let fractions = window.fractions;
    window.changes.fill([0.0; L]);
    // Lanes are copied out and back as wholes: a compiler turns the loops over them into vectors.
    let mut to_middle = [0.0; L];
    for OwnPair { other, opposite, cells, offset, weight } in &pairs.own {
        let other = *other as usize;
        let (above, beyond, freezing) = (window.above[other], window.above[*opposite as usize], window.freezing[other]);
        let all_above = if ENTERING { window.all_above[other] } else { above };
        let mut change = [0.0; L];
        for lane in 0..L {
            let carried = lies.carried((*offset, *cells), (above[lane], beyond[lane]), fractions[lane], lane);
            change[lane] = weight * above[lane] * if ENTERING { carried } else { carried - 1.0 };
        }
        if ENTERING {
            for lane in 0..L {
                let plain = weight * (all_above[lane] - own[lane]);
                // On its own side a particle exchanges by its own potential until that lies on the line from the front to the
                // other.
                let least = if change[lane] < plain { change[lane] } else { plain };
                let most = if change[lane] > plain { change[lane] } else { plain };
                let limited = if own[lane] > 0.0 { least } else { most };
                let beside = if above[lane] * own[lane] > 0.0 { limited } else { change[lane] };
                // Of two that are entered, each takes back half.
                let back = if all_above[lane] != 0.0 { -0.5 * plain } else { -plain };
                let at_front = if freezing[lane] != 0 { back } else { 0.0 };
                change[lane] = if above[lane] != 0.0 { beside - plain } else { at_front };
            }
        }
        if pairs.turned && freezing.iter().fold(0, |any, freezing| any | freezing) != 0 {
            for lane in 0..L {
                let other = window.frozen_fraction(other, lane, interval);
                let along = weight * lies.along(*offset, (fractions[lane], other), lane);
                change[lane] += if freezing[lane] != 0 { along } else { 0.0 };
            }
        }
        let mut changes = window.changes[other];
        for lane in 0..L {
            changes[lane] -= change[lane];
            to_middle[lane] += change[lane];
        }
        window.changes[other] = changes;
    }
    exchange_over(pairs, window, to_middle);
}

/// Adds what pairs over the fronts exchange, and notes what comes to the middle.
#[inline(always)]
fn exchange_over<const L: usize>(pairs: &Pairs, window: &mut Window<L>, mut to_middle: [f64; L]) {
    for (cells, own) in window.near.iter_mut().enumerate().skip(1) {
        *own = near(cells, &window.fractions);
    }
    for pair in &pairs.over {
        let taken = pair.taken(&pairs.ways, window);
        let (frozen, unfrozen) = (pair.frozen as usize, pair.unfrozen as usize);
        let carried = pair.weight * pair.cells as f64;
        let (below, above) = (window.above[frozen], window.above[unfrozen]);
        let (near, far) = (window.near[pair.before][0], window.near[pair.cells - pair.before][1]);
        let (mut of_frozen, mut of_unfrozen) = (window.changes[frozen], window.changes[unfrozen]);
        for lane in 0..L {
            // Nothing, where the pair is not taken.
            let below = f64::from_bits(below[lane].to_bits() & taken[lane]);
            let above = f64::from_bits(above[lane].to_bits() & taken[lane]);
            let (cold, warm) = (carried * below * near[lane], carried * above * far[lane]);
            let direct = pair.weight * (above - below);
            of_frozen[lane] -= cold + direct;
            of_unfrozen[lane] += direct - warm;
            to_middle[lane] += cold + warm;
        }
        (window.changes[frozen], window.changes[unfrozen]) = (of_frozen, of_unfrozen);
    }
    let middle = window.changes.len() / 2;
    window.changes[middle] = to_middle;
}
