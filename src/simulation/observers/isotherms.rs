//! Isotherms: how deep they are along the freezing direction; in a plane without one, what they enclose, how long they are and how far
//! from what is coldest outside.

use crate::recorded::Recorded;
use frazil_core::boundary::condition::Condition;
use frazil_core::memory::HeapSize;
use frazil_core::saved::{Pass, Saved};
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::{Role, RunResult, Table, Unit};
use frazil_scene::{FreezingDirection, Scene};

use super::boundary::{Boundary, Distance};
use super::level_set::LevelSet;
use super::observer::{End, Made, Observer, Schedule, Setup, View};
use super::profiles::layers;
use super::shells::RadialFront;

/// Its table.
pub(super) const TABLE: &str = "isotherms.csv";

struct Isotherms {
    temperatures: Vec<f64>,
    body: Body,
    images: f64,
    table: Table,
}

enum Body {
    /// One in which a front runs one way.
    Deep(FreezingDirection, [WallId; 2]),
    Plane(LevelSet, Boundary),
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, temperatures) = (setup.scene, setup.scene.watch.isotherms.clone());
    if temperatures.is_empty() {
        return None;
    }
    let columns = [
        ("isotherm_c", "isotherm", Unit::Celsius, Role::Key),
        ("depth_m", "depth", Unit::Metre, Role::Value),
        ("colder_m2", "colder area", Unit::SquareMetre, Role::Sum),
        ("length_m", "length", Unit::Metre, Role::Sum),
        ("distance_least_m", "least distance", Unit::Metre, Role::Value),
        ("distance_mean_m", "mean distance", Unit::Metre, Role::Value),
    ];
    let table = Table::over_time(TABLE, "Isotherms", &columns, temperatures.len() * setup.outputs());
    let body = match direction(scene) {
        Some((direction, walls)) => Body::Deep(direction, walls),
        None => Body::Plane(LevelSet::over(setup), Boundary::of(scene)),
    };
    Some(Box::new(Isotherms { temperatures, body, images: setup.images(), table }))
}

/// The one direction of a body in which all that it has runs one way, and its walls there, that from which depths count first.
fn direction(scene: &Scene) -> Option<(FreezingDirection, [WallId; 2])> {
    let direction = match scene.domain {
        Domain::Radial { inner, outer, .. } => {
            let from_end = RadialFront::of(scene).is_some_and(|front| front.from_outer);
            FreezingDirection { along_y: false, length: outer - inner, across: 1.0, from_end }
        }
        _ => scene.freezing_direction()?,
    };
    let mut walls = match scene.domain {
        Domain::Radial { .. } => [WallId::Inner, WallId::Outer],
        _ => WallId::ends(direction.along_y),
    };
    if direction.from_end {
        walls.reverse();
    }
    Some((direction, walls))
}

/// Temperatures by depth (m), from one wall to the other: on a wall that which it is held at, or where the two particles before
/// it lead.
fn by_depth(view: &View<'_>, direction: &FreezingDirection, walls: [WallId; 2]) -> Vec<(f64, f64)> {
    let particles = view.particles;
    let corner = particles.lattice.corner;
    let first = if direction.along_y { corner.y } else { corner.x };
    let rows = layers(particles, direction, f64::INFINITY, view.time, 1);
    let mut points: Vec<(f64, f64)> =
        rows.map(|row| (direction.distance(row.along_m - first), row.temperature_c)).collect();
    if direction.from_end {
        points.reverse();
    }
    let on_wall = |wall: WallId, depth: f64, [near, next]: [(f64, f64); 2]| {
        let held = match view.scene.wall(wall) {
            Some(Condition::Temperature(series)) => Some(series.at(view.time)),
            _ => None,
        };
        let led = || near.1 + (near.1 - next.1) * (depth - near.0) / (near.0 - next.0);
        (depth, held.unwrap_or_else(led))
    };
    if let ([first, second, ..], [.., last_but_one, last]) = (&points[..], &points[..]) {
        let near = on_wall(walls[0], 0.0, [*first, *second]);
        let far = on_wall(walls[1], direction.length, [*last, *last_but_one]);
        points.insert(0, near);
        points.push(far);
    }
    points
}

/// Depth (m) at which temperatures first pass one; linear between two places.
fn depth(points: &[(f64, f64)], temperature: f64) -> Option<f64> {
    let crossing = points.windows(2).find(|pair| (pair[0].1 < temperature) != (pair[1].1 < temperature))?;
    let [(from, before), (to, behind)] = [crossing[0], crossing[1]];
    Some(from + (to - from) * (temperature - before) / (behind - before))
}

impl Saved for Isotherms {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        Recorded(&mut self.table.rows).pass(pass);
    }
}

impl Observer for Isotherms {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        let rows = match &mut self.body {
            Body::Deep(direction, walls) => {
                let points = by_depth(view, direction, *walls);
                let of = |isotherm: &f64| [depth(&points, *isotherm), None, None, None, None];
                self.temperatures.iter().map(of).collect::<Vec<_>>()
            }
            Body::Plane(field, boundary) => {
                field.read(view.particles, |i| view.particles.reading_by(i, || view.fractions()[i]));
                let coldest = boundary.coldest(view.time);
                let of = |isotherm: &f64| {
                    let mut distance = Distance::NONE;
                    let parted = field.part(*isotherm, |a, b| distance.add(&coldest, a, b));
                    let [least, mean] = distance.of();
                    let whole = [parted.below, parted.length].map(|part| Some(self.images * part));
                    [None, whole[0], whole[1], least, mean]
                };
                self.temperatures.iter().map(of).collect()
            }
        };
        for (isotherm, values) in self.temperatures.iter().zip(rows) {
            self.table.rows.push([Some(view.time), Some(*isotherm)].into_iter().chain(values).collect());
        }
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.tables.push(self.table);
    }

    fn held_at_the_end(&self) -> usize {
        let field = match &self.body {
            Body::Deep(..) => 0,
            Body::Plane(field, _) => field.heap_size(),
        };
        field + self.table.held_when_full()
    }
}
