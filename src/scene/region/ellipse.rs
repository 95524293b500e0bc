//! Ellipses, as what makes circles of them maps them.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::{Cell, ON_EDGE, crossings_of_circle, edges};

/// Chords of the unit circle that are no longer than this are left out, which changes no area to rounding: an edge that touches the
/// circle has none or a short one, as rounding has it.
const NO_CHORD: f64 = 1e-8;

/// An ellipse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Centre (m).
    pub centre: DVec2,
    /// Half axes (m).
    pub half_axes: DVec2,
    /// Angle from the x axis to the first of them (rad).
    pub angle: f64,
}

impl Ellipse {
    /// A place as the map has it that makes the ellipse the unit circle.
    fn on_circle(&self, place: DVec2) -> DVec2 {
        DVec2::from_angle(-self.angle).rotate(place - self.centre) / self.half_axes
    }

    /// The place that the same map takes to another.
    fn off_circle(&self, place: DVec2) -> DVec2 {
        self.centre + DVec2::from_angle(self.angle).rotate(self.half_axes * place)
    }

    /// Corners of a polygon with the ellipse's centre and directions whose size on the unit circle is this.
    fn polygon(&self, count: usize, size: f64) -> impl Iterator<Item = DVec2> + '_ {
        let angle = TAU / count as f64;
        (0..count).map(move |k| self.off_circle(size * DVec2::from_angle((k as f64 + 0.5) * angle)))
    }

    /// Corners of the polygon that encloses as much.
    pub fn as_large(&self, count: usize) -> Vec<DVec2> {
        let angle = TAU / count as f64;
        self.polygon(count, (angle / angle.sin()).sqrt()).collect()
    }

    /// Corners of a polygon around it, whose edges touch it.
    pub(crate) fn around(&self, count: usize) -> Vec<DVec2> {
        self.polygon(count, 1.0 / (PI / count as f64).cos()).collect()
    }

    /// The box around it.
    pub(super) fn extent(&self) -> Cell {
        let (sin, cos) = self.angle.sin_cos();
        let DVec2 { x: a, y: b } = self.half_axes;
        let half = DVec2::new((a * cos).hypot(b * sin), (a * sin).hypot(b * cos));
        Cell { low: self.centre - half, high: self.centre + half }
    }

    pub(super) fn contains(&self, point: DVec2) -> bool {
        self.on_circle(point).length() <= 1.0 + ON_EDGE
    }

    pub(super) fn crossings(&self, from: DVec2, to: DVec2, show: impl FnMut(f64)) {
        let (from, to) = (self.on_circle(from), self.on_circle(to));
        crossings_of_circle(1.0, from, to - from, show);
    }

    /// Area of the part of a cell that it covers, over that of the cell.
    pub(super) fn share_of(&self, cell: &Cell) -> f64 {
        let Cell { low, high } = *cell;
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let corners = corners.map(|corner| self.on_circle(corner));
        if corners.iter().all(|corner| corner.length_squared() <= 1.0) {
            return 1.0;
        }
        let whole = (corners[1] - corners[0]).perp_dot(corners[3] - corners[0]);
        circle_in(&corners) / whole
    }
}

/// Area of the unit circle within a convex polygon, whose corners run counter-clockwise: the polygon of what of its edges
/// lies in the circle, and segments of the circle between them.
fn circle_in(corners: &[DVec2]) -> f64 {
    let mut kept: Vec<(DVec2, DVec2)> = Vec::with_capacity(corners.len());
    for (a, b) in edges(corners) {
        let mut ends = [0.0, 0.0];
        let mut found = 0;
        crossings_of_circle(1.0, a, b - a, |place| {
            ends[found] = place.clamp(0.0, 1.0);
            found += 1;
        });
        if (ends[1] - ends[0]) * a.distance(b) > NO_CHORD {
            // Ends of an edge are its corners to the last bit.
            let at = |place: f64| if place == 1.0 { b } else { a + place * (b - a) };
            kept.push((at(ends[0]), at(ends[1])));
        }
    }
    let Some((reference, _)) = kept.first().copied() else {
        let inside = edges(corners).all(|(a, b)| a.perp_dot(b) > 0.0);
        return if inside { PI } else { 0.0 };
    };
    let triangle = |a: DVec2, b: DVec2| 0.5 * (a - reference).perp_dot(b - reference);
    let mut sum = 0.0;
    for (k, (from, to)) in kept.iter().enumerate() {
        let next = kept[(k + 1) % kept.len()].0;
        sum += triangle(*from, *to) + triangle(*to, next);
        if *to != next {
            let angle = to.perp_dot(next).atan2(to.dot(next));
            // Rounding may turn an arc of no length round; one of all but a chord has that chord.
            let angle = if angle < -0.5 * NO_CHORD { angle + TAU } else { angle };
            sum += 0.5 * (angle - angle.sin());
        }
    }
    sum
}
