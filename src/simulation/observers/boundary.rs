//! What cools a body from outside: its walls and pipes, where they are and how warm.

use frazil_core::boundary::condition::Condition;
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;
use glam::DVec2;

/// Temperatures that differ by less, over the range of the scene, are the same.
const SAME: f64 = 1e-9;

/// The shape of a wall or pipe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// A straight wall or a part of it.
    Segment(DVec2, DVec2),
    /// A round wall or a pipe, by centre and radius (m).
    Circle(DVec2, f64),
}

impl Shape {
    /// Distance of a place from it (m).
    fn distance(&self, place: DVec2) -> f64 {
        match *self {
            Shape::Segment(a, b) => {
                let along = ((place - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
                place.distance(a.lerp(b, along))
            }
            Shape::Circle(centre, radius) => (place.distance(centre) - radius).abs(),
        }
    }
}

/// Walls and pipes with a temperature.
pub(super) struct Boundary {
    parts: Vec<(Shape, Series)>,
    same: f64,
}

impl Boundary {
    pub(super) fn of(scene: &Scene) -> Self {
        let mut parts = Vec::new();
        let mut straight = |wall: WallId, from: DVec2, to: DVec2| {
            let (length, way) = (from.distance(to), (to - from).normalize_or_zero());
            let origin = if way.x > 0.5 { from.x } else { from.y };
            let own = || scene.wall_parts.iter().filter(|part| part.wall == wall);
            let mut ends: Vec<f64> = own().flat_map(|part| [part.from - origin, part.to - origin]).collect();
            ends.extend([0.0, length]);
            ends.sort_by(f64::total_cmp);
            for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
                let middle = origin + 0.5 * (pair[0] + pair[1]);
                if let Some(series) = scene.wall_at(wall, middle).and_then(temperature) {
                    parts.push((Shape::Segment(from + pair[0] * way, from + pair[1] * way), series));
                }
            }
        };
        match scene.domain {
            Domain::Rectangle { width, height } => sides((0.0, width), height, WallId::ends(false), &mut straight),
            Domain::Axial { inner, outer, height } => {
                sides((inner, outer), height, [WallId::Inner, WallId::Outer], &mut straight)
            }
            Domain::Ring { outer_radius, .. } => {
                let outer = scene.wall(WallId::Outer).and_then(temperature);
                parts.extend(outer.map(|series| (Shape::Circle(DVec2::ZERO, outer_radius), series)));
            }
            Domain::Line { .. } | Domain::Radial { .. } => {}
        }
        for ring in &scene.rings {
            let Some(temperature) = ring.condition.temperature() else { continue };
            let pipe = |k: usize| (Shape::Circle(ring.place(k), ring.pipe_radius), temperature.clone());
            parts.extend(ring.numbers().map(pipe));
        }
        let (low, high) = scene.temperature_range();
        Boundary { parts, same: SAME * (high - low) }
    }

    /// What is coldest at a time (s).
    pub(super) fn coldest(&self, time: f64) -> Vec<Shape> {
        let least = self.parts.iter().map(|(_, series)| series.at(time)).fold(f64::INFINITY, f64::min);
        self.no_warmer_than(least + self.same, time)
    }

    /// What is no warmer than a temperature at a time (s).
    pub(super) fn no_warmer_than(&self, temperature: f64, time: f64) -> Vec<Shape> {
        let cold = self.parts.iter().filter(|(_, series)| series.at(time) <= temperature);
        cold.map(|(shape, _)| *shape).collect()
    }
}

/// The four sides of a rectangle.
fn sides(
    (low, high): (f64, f64),
    height: f64,
    [left, right]: [WallId; 2],
    straight: &mut impl FnMut(WallId, DVec2, DVec2),
) {
    let at = DVec2::new;
    straight(left, at(low, 0.0), at(low, height));
    straight(right, at(high, 0.0), at(high, height));
    straight(WallId::Bottom, at(low, 0.0), at(high, 0.0));
    straight(WallId::Top, at(low, height), at(high, height));
}

/// The temperature that a wall is held at, or that is beyond its film.
fn temperature(condition: &Condition) -> Option<Series> {
    match condition {
        Condition::Temperature(series) | Condition::Film { ambient: series, .. } => Some(series.clone()),
        Condition::Symmetry
        | Condition::Periodic
        | Condition::Flux(_)
        | Condition::Runoff { .. }
        | Condition::FreeDrainage
        | Condition::Exact => None,
    }
}

/// Least distance of a contour from shapes, and its mean along the contour (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Distance {
    least: f64,
    sum: f64,
    length: f64,
}

impl Distance {
    pub(super) const NONE: Distance = Distance { least: f64::INFINITY, sum: 0.0, length: 0.0 };

    /// Takes a straight piece of the contour.
    pub(super) fn add(&mut self, shapes: &[Shape], a: DVec2, b: DVec2) {
        let nearest = |place: DVec2| shapes.iter().map(|shape| shape.distance(place)).fold(f64::INFINITY, f64::min);
        let (middle, length) = (nearest(0.5 * (a + b)), a.distance(b));
        self.least = self.least.min(nearest(a)).min(nearest(b)).min(middle);
        (self.sum, self.length) = (self.sum + length * middle, self.length + length);
    }

    /// Least and mean, where there are a contour and shapes.
    pub(super) fn of(self) -> [Option<f64>; 2] {
        let there = self.length > 0.0 && self.least.is_finite();
        [there.then_some(self.least), there.then(|| self.sum / self.length)]
    }
}
