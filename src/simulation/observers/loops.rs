//! Which pipes are neighbours, and when those whose frozen bodies have joined surround the centre.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

/// Lengths and angles that differ by less, relative to the greater or to a turn, are the same.
pub(super) const SAME: f64 = 1e-9;

/// Pairs of pipes between which no other stands: none lies in the circle over the line between them. Pipes that stand opposite each
/// other, with the centre between them, are no neighbours, for it cannot be told on which side of the centre they join.
pub(crate) fn neighbours(places: &[DVec2]) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    for a in 0..places.len() {
        for b in a + 1..places.len() {
            let ends = [places[a], places[b]];
            if turn(ends[0], ends[1]).abs() > PI * (1.0 - SAME) {
                continue;
            }
            let (middle, radius) = (0.5 * (ends[0] + ends[1]), 0.5 * ends[0].distance(ends[1]));
            let others = (0..places.len()).filter(|k| *k != a && *k != b).map(|k| places[k]);
            if !others.clone().any(|place| place.distance(middle) < radius * (1.0 - SAME)) {
                // Across a circle of pipes, others stand on it to both sides.
                let side = |place: DVec2| (place - middle).perp_dot(ends[1] - ends[0]) > 0.0;
                let mut on_circle = others.filter(|place| place.distance(middle) <= radius * (1.0 + SAME)).map(side);
                let first = on_circle.next();
                if first.is_none_or(|first| on_circle.all(|side| side == first)) {
                    found.push([a, b]);
                }
            }
        }
    }
    found
}

/// Angle from one place to another as seen from the centre, at most half a turn; none from or to a place at the centre, from which
/// nothing turns around it.
pub(super) fn turn(from: DVec2, to: DVec2) -> f64 {
    if from.length().min(to.length()) <= SAME * from.distance(to) {
        return 0.0;
    }
    let angle = to.to_angle() - from.to_angle();
    angle - TAU * (angle / TAU).round()
}

/// When links that join one after the other first make a loop around the centre. Links to a pipe at the centre are on no loop around it.
pub(crate) fn closure(places: &[DVec2], mut joined: Vec<([usize; 2], f64)>) -> Option<f64> {
    joined.sort_by(|a, b| a.1.total_cmp(&b.1));
    // Groups of joined pipes: each pipe's next towards the head of its group, and the angle to it.
    let mut heads: Vec<(usize, f64)> = (0..places.len()).map(|k| (k, 0.0)).collect();
    fn head(heads: &[(usize, f64)], mut at: usize) -> (usize, f64) {
        let mut angle = 0.0;
        while heads[at].0 != at {
            angle += heads[at].1;
            at = heads[at].0;
        }
        (at, angle)
    }
    let at_centre =
        |[a, b]: [usize; 2]| places[a].length().min(places[b].length()) <= SAME * places[a].distance(places[b]);
    for ([a, b], time) in joined.into_iter().filter(|(ends, _)| !at_centre(*ends)) {
        let (from, to) = (head(&heads, a), head(&heads, b));
        let around = turn(places[a], places[b]) + to.1 - from.1;
        if from.0 != to.0 {
            heads[from.0] = (to.0, around);
        } else if around.abs() > PI {
            return Some(time);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: usize, radius: f64, first: f64) -> Vec<DVec2> {
        (0..count).map(|k| radius * DVec2::from_angle(first + TAU * k as f64 / count as f64)).collect()
    }

    #[test]
    fn neighbours_of_a_ring_are_those_beside_each_other() {
        for count in [3, 4, 5, 26] {
            let mut found = neighbours(&ring(count, 5.0, 0.1));
            found.sort();
            let mut expected: Vec<_> = (0..count).map(|k| [k.min((k + 1) % count), k.max((k + 1) % count)]).collect();
            expected.sort();
            assert_eq!(found, expected);
        }
        // Two staggered rings: each ring's own, and twice as many between them.
        let mut both = ring(26, 5.0, 0.0);
        both.extend(ring(26, 4.2, PI / 26.0));
        let between = |pair: &&[usize; 2]| (pair[0] < 26) != (pair[1] < 26);
        let found = neighbours(&both);
        assert_eq!(found.iter().filter(between).count(), 52);
    }

    /// Wherever it stands: across its middle other pipes are as near.
    #[test]
    fn a_ring_that_stands_aside_has_the_same_neighbours() {
        for count in [4, 6, 26] {
            let aside: Vec<DVec2> = ring(count, 5.0, 0.1).iter().map(|place| *place + DVec2::new(0.3, -0.2)).collect();
            assert_eq!(neighbours(&aside).len(), count);
        }
        // A right angle's ends are neighbours: no other pipes stand across the line between them.
        assert_eq!(neighbours(&[DVec2::new(1.0, 0.9), DVec2::new(-1.0, -1.1), DVec2::new(1.0, -1.1)]).len(), 3);
    }

    /// A row of pipes through the centre: each has its neighbours on both sides, that at the centre too, and no loop is closed by it.
    #[test]
    fn a_pipe_at_the_centre_has_neighbours_and_turns_nothing() {
        let places: Vec<DVec2> = (-3..=3).map(|k| DVec2::new(f64::from(k), 0.0)).collect();
        let found = neighbours(&places);
        assert_eq!(found, (0..6).map(|k| [k, k + 1]).collect::<Vec<_>>());
        assert_eq!(closure(&places, found.into_iter().map(|ends| (ends, 1.0)).collect()), None);
        // In the middle of a ring it does not close what is open.
        let mut wheel = ring(6, 1.0, 0.0);
        wheel.push(DVec2::ZERO);
        let spokes = (0..6).map(|k| ([k, 6], 1.0));
        assert_eq!(closure(&wheel, spokes.clone().collect()), None);
        let rim = (0..6).map(|k| ([k, (k + 1) % 6], 2.0 + k as f64));
        assert_eq!(closure(&wheel, rim.collect()), Some(7.0));
    }

    #[test]
    fn a_wall_is_closed_once_a_loop_runs_around_the_centre() {
        let places = ring(6, 5.0, 0.0);
        let around: Vec<_> = (0..6).map(|k| ([k, (k + 1) % 6], k as f64)).collect();
        assert_eq!(closure(&places, around.clone()), Some(5.0));
        assert_eq!(closure(&places, around[..5].to_vec()), None);
        // Three pipes are enough.
        let places = ring(3, 1.0, 0.3);
        assert_eq!(closure(&places, (0..3).map(|k| ([k, (k + 1) % 3], k as f64)).collect()), Some(2.0));
        // A loop beside the centre is none around it.
        let mut beside = ring(6, 5.0, 0.0);
        beside.extend([DVec2::new(6.0, 0.0), DVec2::new(6.0, 1.0)]);
        assert_eq!(closure(&beside, vec![([0, 6], 1.0), ([6, 7], 2.0), ([7, 0], 3.0)]), None);
    }
}
