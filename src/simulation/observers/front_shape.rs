//! The front of a plane body that is not frozen from one side: the line on which half is frozen, what it encloses, and how far it is
//! from the walls that freeze the body.

use crate::recorded::Recorded;
use frazil_core::saved::{Pass, Saved};
use std::sync::Arc;

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::physics::material::FreezingLaw;
use frazil_core::space::domain::Domain;
use frazil_record::{Role, RunResult, Table, Unit};

use super::boundary::{Boundary, Distance};
use super::level_set::LevelSet;
use super::observer::{End, Made, Observer, Schedule, Setup, View};
use crate::reference::Reference;

/// Its table.
pub(super) const TABLE: &str = "front_shape.csv";

struct FrontShape {
    field: LevelSet,
    boundary: Boundary,
    freezing_point: f64,
    reference: Option<Arc<dyn Reference>>,
    /// Extent of the temperatures of the scene.
    range: f64,
    table: Table,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let scene = setup.scene;
    let freezes = scene.materials.iter().any(|material| material.law != FreezingLaw::None);
    let is_plane = matches!(scene.domain, Domain::Rectangle { .. });
    if !is_plane || !freezes || scene.freezing_direction().is_some() || !scene.rings.is_empty() {
        return None;
    }
    let columns = [
        ("frozen_m2", "frozen area", Unit::SquareMetre, Role::Sum),
        ("length_m", "length of the front", Unit::Metre, Role::Sum),
        ("distance_least_m", "least distance", Unit::Metre, Role::Value),
        ("distance_mean_m", "mean distance", Unit::Metre, Role::Value),
        ("temperature_rms_rel", "error of temperatures", Unit::One, Role::Value),
    ];
    let (low, high) = scene.temperature_range();
    Some(Box::new(FrontShape {
        field: LevelSet::over(setup),
        boundary: Boundary::of(scene),
        freezing_point: scene.materials[0].freezing_point,
        reference: setup.reference.cloned(),
        range: high - low,
        table: Table::over_time(TABLE, "Front", &columns, setup.outputs()),
    }))
}

impl FrontShape {
    /// Rms difference of all particles from the reference, over the range of temperatures, where that knows points.
    fn error(&self, particles: &Particles, time: f64) -> Option<f64> {
        let reference = self.reference.as_ref()?;
        let (mut squares, mut count) = (0.0, 0.0);
        particles.visit(|i, place| {
            if let Some(expected) = reference.point_temperature(place.x, place.y, time) {
                squares += (particles.reading(i) - expected).powi(2);
                count += 1.0;
            }
        });
        (count > 0.0 && self.range > 0.0).then(|| (squares / count).sqrt() / self.range)
    }
}

impl Saved for FrontShape {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        Recorded(&mut self.table.rows).pass(pass);
    }
}

impl Observer for FrontShape {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        let fractions = view.fractions();
        self.field.read(view.particles, |i| fractions[i]);
        let cold = self.boundary.no_warmer_than(self.freezing_point, view.time);
        let mut distance = Distance::NONE;
        let parted = self.field.part(0.5, |a, b| distance.add(&cold, a, b));
        let [least, mean] = distance.of();
        let error = if view.is_kept() { self.error(view.particles, view.time) } else { None };
        self.table.rows.push(vec![Some(view.time), Some(parted.above), Some(parted.length), least, mean, error]);
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.tables.push(self.table);
    }

    fn held_at_the_end(&self) -> usize {
        self.field.heap_size() + self.table.held_when_full()
    }
}
