//! Segments of the plane: on which side of each other they lie, and whether they meet. Signs are exact for the numbers as
//! they are stored (adaptive predicates of Shewchuk 1997), so that no answer hangs on rounding.

use std::cmp::Ordering;

use glam::DVec2;
use robust::{Coord, orient2d};

/// A segment from one point to another (m).
pub type Segment = (DVec2, DVec2);

/// Twice the area (m2) of the triangle that a point makes with the line from `a` to `b`: positive on the left.
pub fn offset((a, b): Segment, point: DVec2) -> f64 {
    let coord = |point: DVec2| Coord { x: point.x, y: point.y };
    orient2d(coord(a), coord(b), coord(point))
}

/// On which side of the line of a segment a point lies: greater on the left, equal on the line.
pub fn side(segment: Segment, point: DVec2) -> Ordering {
    // Not by the total order, in which the two zeros differ.
    offset(segment, point).partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// Whether a point on the line of a segment lies between its ends, or on one.
fn between((a, b): Segment, point: DVec2) -> bool {
    point.cmpge(a.min(b)).all() && point.cmple(a.max(b)).all()
}

/// Whether two segments, their ends included, share a point.
pub fn meet(first: Segment, second: Segment) -> bool {
    let (a, b) = (side(first, second.0), side(first, second.1));
    let (c, d) = (side(second, first.0), side(second, first.1));
    if a != b && c != d {
        return true;
    }
    let on = |side: Ordering, segment: Segment, point: DVec2| side.is_eq() && between(segment, point);
    on(a, first, second.0) || on(b, first, second.1) || on(c, second, first.0) || on(d, second, first.1)
}

/// Distance (m) of a point from a segment.
pub fn distance((a, b): Segment, point: DVec2) -> f64 {
    let way = b - a;
    let share = if a == b { 0.0 } else { ((point - a).dot(way) / way.length_squared()).clamp(0.0, 1.0) };
    (a + share * way - point).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(a: (f64, f64), b: (f64, f64)) -> Segment {
        (DVec2::from(a), DVec2::from(b))
    }

    #[test]
    fn segments_meet_in_points_and_stretches() {
        let level = segment((0.0, 0.0), (2.0, 0.0));
        for (other, expected) in [
            (segment((1.0, -1.0), (1.0, 1.0)), true),
            (segment((1.0, 0.0), (1.0, 1.0)), true),
            (segment((2.0, 0.0), (3.0, 1.0)), true),
            (segment((1.0, 0.0), (5.0, 0.0)), true),
            (segment((0.5, 0.0), (1.5, 0.0)), true),
            (segment((3.0, 0.0), (5.0, 0.0)), false),
            (segment((1.0, 1e-300), (1.0, 1.0)), false),
            (segment((3.0, -1.0), (3.0, 1.0)), false),
        ] {
            assert_eq!(meet(level, other), expected, "{other:?}");
            assert_eq!(meet(other, level), expected, "{other:?}");
            assert_eq!(meet(level, (other.1, other.0)), expected, "{other:?}");
        }
    }

    #[test]
    fn sides_are_those_of_the_numbers_as_stored() {
        // 0.1 + 0.2 lies above 0.3 by one part in 2^54.
        let line = segment((0.0, 0.3), (1e6, 0.3));
        assert_eq!(side(line, DVec2::new(12.0, 0.1 + 0.2)), Ordering::Greater);
        assert_eq!(side(line, DVec2::new(12.0, 0.3)), Ordering::Equal);
    }
}
