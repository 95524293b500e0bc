//! What fronts exchange with what lies around them.

use super::faces::Faces;
use super::numbers::{Flags as _, Kind, Numbers as _};
use super::orientation::Orientation;
use super::pairs::{Cut, End, Pairs};
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
    let (zero, half) = (kind.of(0.0), kind.of(0.5));
    let own = if ENTERING { kind.load(&window.all_above[window.above.len() / 2]) } else { zero };
    let fractions = kind.load(&window.fractions);
    window.changes.fill([0.0; L]);
    let mut to_middle = zero;
    for pair in &pairs.own {
        let (other, weight) = (pair.other as usize, kind.of(pair.weight));
        let freezing = kind.flags(&window.freezing[other]);
        let mut change = zero;
        if pair.cells < 2.0 {
            let straight = (pair.other, pair.offset, pair.cells, pair.weight);
            change = of_pair::<_, L, ENTERING>(kind, straight, &lies, window, own);
        }
        if ENTERING {
            let all_above = kind.load(&window.all_above[other]);
            let plain = weight * (all_above - own);
            // Of two that are entered, each takes back half.
            let back = (half * plain).or(all_above.differs(zero), plain);
            change = (zero - back).or(freezing, change);
        }
        if pairs.turned && freezing.any() {
            let other = window.frozen_fraction(kind, other, interval);
            let along = weight * lies.along(kind, pair.offset, (fractions, other));
            change = change + along.or(freezing, zero);
        }
        window.change(kind, other, zero - change);
        to_middle = to_middle + change;
    }
    to_middle = to_middle + exchange_cuts::<_, L, ENTERING>(kind, pairs, &lies, window, (interval, own));
    let middle = window.changes.len() / 2;
    kind.store(to_middle, &mut window.changes[middle]);
}

/// What a particle with a front gets more, or less, by a pair than plainly: along the pair, from the other end, which is not freezing, to the
/// front. The pair is given by the place of the other end, the spacings to it, those along the axis, and the weight (m^-2).
#[inline(always)]
fn of_pair<K: Kind<L>, const L: usize, const ENTERING: bool>(
    kind: K,
    (other, offset, cells, weight): (u32, [f64; 2], f64, f64),
    lies: &Orientation<K::Numbers>,
    window: &Window<L>,
    own: K::Numbers,
) -> K::Numbers {
    let (zero, one, weight) = (kind.of(0.0), kind.of(1.0), kind.of(weight));
    let (above, beyond) = (
        kind.load(&window.above[other as usize]),
        kind.load(&window.above[opposite(window.above.len(), other) as usize]),
    );
    let carried = lies.carried(kind, (offset, cells), (above, beyond), kind.load(&window.fractions));
    if !ENTERING {
        return weight * above * (carried - one);
    }
    let change = weight * above * carried;
    let plain = weight * (above - own);
    // On its own side a particle exchanges by its own potential until that lies on the line from the front to the
    // other.
    let limited = change.or_less(plain).or(zero.is_less(own), change.or_greater(plain));
    let beside = limited.or(zero.is_less(above * own), change);
    (beside - plain).or(above.differs(zero), zero)
}

/// Adds what pairs exchange that are cut by the fronts, and gives what comes to the middle.
#[inline(always)]
fn exchange_cuts<K: Kind<L>, const L: usize, const ENTERING: bool>(
    kind: K,
    pairs: &Pairs,
    lies: &Orientation<K::Numbers>,
    window: &mut Window<L>,
    (interval, own): ((f64, f64), K::Numbers),
) -> K::Numbers {
    let (zero, one) = (kind.of(0.0), kind.of(1.0));
    let fractions = kind.load(&window.fractions);
    for (end, flows) in pairs.ends.iter().zip(&mut window.flows) {
        let above = kind.load(&window.above[end.place as usize]);
        let before = kind.load(&window.above[end.before as usize]);
        let beyond = kind.load(&window.above[opposite(window.above.len(), end.before) as usize]);
        let are_two = zero.is_less(before * beyond);
        let [by_normal, by_axis] = lies.flows(kind, (end.offset, end.cells), (above, are_two), fractions);
        kind.store(by_normal, &mut flows[0]);
        kind.store(by_axis, &mut flows[1]);
    }
    for (offset, spans) in pairs.spans.iter().zip(&mut window.spans) {
        let [one, other] = lies.spans(kind, *offset);
        kind.store(one, &mut spans[0]);
        kind.store(other, &mut spans[1]);
    }
    let mut to_middle = zero;
    let (of_middle, over) = pairs.cuts.split_at(pairs.own_cuts);
    for cut in of_middle {
        let end = kind.load(&window.above[cut.end as usize]);
        let mut made = cut.is_made(kind, pairs, (window, interval), true);
        if ENTERING || !window.is_clear {
            // Where the front enters the particle, its own side exchanges with it; so do ends with images behind walls.
            let there = end.differs(zero);
            let is_free = if window.is_clear { there } else { window.is_free(kind, cut.sums) };
            let whole = if ENTERING { made & !zero.is_less(end * own) } else { made };
            let straight = there & !whole & !(is_free & !made);
            let End { offset, cells, .. } = pairs.ends[cut.number as usize];
            let pair = (cut.end, offset, cells, cut.weight);
            let change = of_pair::<_, L, ENTERING>(kind, pair, lies, window, own);
            // What goes by the potential of the middle goes to none of both.
            let change = change.or(straight, (kind.of(cut.weight) * own).or(there, zero));
            window.change(kind, cut.end as usize, zero - change);
            to_middle = to_middle + change;
            made = whole;
        }
        let part = one.or(made, zero);
        let plain = kind.of(cut.weight) * part * end;
        to_middle = to_middle + (exchange_cut(kind, cut, window, part, plain) - plain);
    }
    for cut in over {
        let made = cut.is_made(kind, pairs, (window, interval), false);
        if !made.any() {
            continue;
        }
        let end = kind.load(&window.above[cut.end as usize]);
        let part = one.or(made, zero);
        let plain = kind.of(cut.weight) * part * end;
        window.change(kind, cut.other as usize, zero - plain);
        let to_front = exchange_cut(kind, cut, window, part, plain);
        to_middle = to_middle + to_front;
        let next = cut.next[0] as usize;
        let goes_on = made & kind.flags(&window.freezing[next]);
        if pairs.turned && goes_on.any() {
            let other = window.frozen_fraction(kind, next, interval);
            let goes_on = goes_on & !window.meets(kind, end, cut.next, interval);
            let part = lies.part_of_next(kind, (fractions, other), end).or(goes_on, zero);
            window.change(kind, next, to_front * part);
            to_middle = to_middle - to_front * part;
        }
    }
    to_middle
}

/// Takes from the end of a pair a part, all or none, of what it exchanges with the front, gives it back what it exchanges plainly, and
/// tells what comes to the front.
#[inline(always)]
fn exchange_cut<K: Kind<L>, const L: usize>(
    kind: K,
    cut: &Cut,
    window: &mut Window<L>,
    part: K::Numbers,
    plain: K::Numbers,
) -> K::Numbers {
    let zero = kind.of(0.0);
    let flows = &window.flows[cut.number as usize];
    let (by_normal, by_axis) = (kind.load(&flows[0]), kind.load(&flows[1]));
    let spans = &window.spans[cut.span as usize];
    let (frozen, unfrozen) = (kind.load(&spans[cut.directions[0]]), kind.load(&spans[cut.directions[1]]));
    let span = frozen.or(by_normal.is_less(zero), unfrozen);
    let to_front = kind.of(cut.weight) * part * (span * by_normal + kind.of(cut.cells) * by_axis);
    window.change(kind, cut.end as usize, plain - to_front);
    to_front
}

/// The place on the opposite side of the middle, among so many.
#[inline(always)]
pub(super) fn opposite(places: usize, place: u32) -> u32 {
    places as u32 - 1 - place
}

impl<const L: usize> Window<L> {
    /// Adds to what is added at a place.
    #[inline(always)]
    fn change<K: Kind<L>>(&mut self, kind: K, place: usize, by: K::Numbers) {
        let changes = kind.load(&self.changes[place]) + by;
        kind.store(changes, &mut self.changes[place]);
    }
}
