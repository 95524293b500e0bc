//! Integrals over regions: how large they are, their temperatures, what of them is frozen, and the heat that they have taken up.

use frazil_core::ledger::Sum;
use frazil_core::particles::Particles;
use frazil_core::space::domain::Domain;
use frazil_core::space::symmetry::Symmetry;
use frazil_record::{Role, Table, Unit};
use frazil_scene::Scene;
use frazil_scene::region::{Cell, Shape};

use super::observer::{Instants, Made, Setup};
use super::series::series;

/// Its table.
pub(super) const TABLE: &str = "regions.csv";

/// Particles that lie in a region, with the volumes (m^d) of theirs that do.
type Parts = Vec<(u32, f64)>;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, particles) = (setup.scene, setup.particles);
    let regions = &scene.watch.regions;
    if regions.is_empty() {
        return None;
    }
    let (size, unit) = match scene.domain {
        Domain::Line { .. } => (("length_m", "length"), Unit::Metre),
        Domain::Rectangle { .. } | Domain::Ring { .. } => (("area_m2", "area"), Unit::SquareMetre),
        Domain::Radial { symmetry: Symmetry::Axial, .. } => (("area_m2", "area"), Unit::SquareMetre),
        Domain::Radial { .. } | Domain::Axial { .. } => (("volume_m3", "volume"), Unit::CubicMetre),
    };
    let columns = [
        ("region", "region", Unit::One, Role::Key),
        (size.0, size.1, unit, Role::Value),
        ("mean_c", "mean temperature", Unit::Celsius, Role::Value),
        ("least_c", "least temperature", Unit::Celsius, Role::Value),
        ("greatest_c", "greatest temperature", Unit::Celsius, Role::Value),
        ("frozen_fraction", "frozen fraction", Unit::One, Role::Value),
        ("heat_j_per_m3", "heat taken up", Unit::JoulePerCubicMetre, Role::Value),
    ];
    let table = Table::over_time(TABLE, "Regions", &columns, 0);
    let mut all: Vec<Parts> = regions.iter().map(|shape| parts(scene, particles, shape)).collect();
    let by_row = table.columns.len() * size_of::<Option<f64>>();
    let beside = all.iter().map(|parts| parts.capacity() * size_of::<(u32, f64)>()).sum();
    series(
        Instants::Outputs,
        Vec::with_capacity(regions.len() * setup.outputs()),
        (by_row, beside),
        move |view, rows| {
            for (k, (shape, parts)) in view.scene.watch.regions.iter().zip(&mut all).enumerate() {
                if view.particles.move_about() {
                    *parts = self::parts(view.scene, view.particles, shape);
                }
                let row = [Some(view.time), Some((k + 1) as f64)].into_iter().chain(values(view.particles, parts));
                rows.push(row.collect());
            }
        },
        |rows, result| result.tables.push(Table { rows, ..table }),
    )
}

/// What of the particles lies in a shape where they stand now.
fn parts(scene: &Scene, particles: &Particles, shape: &Shape) -> Parts {
    let part = |i: usize| {
        let share = scene.share_of(shape, &Cell::around(particles.position(i), particles.lattice.spacing));
        (share > 0.0).then(|| (i as u32, share * particles.volumes.of(i)))
    };
    (0..particles.len()).filter_map(part).collect()
}

/// Size, temperatures, frozen fraction and heat taken up of what lies in a region; no numbers where all of it is dug.
fn values(particles: &Particles, parts: &Parts) -> [Option<f64>; 6] {
    let there = || parts.iter().map(|(i, volume)| (*i as usize, *volume)).filter(|(i, _)| !particles.is_gone(*i));
    let integral = |value: &dyn Fn(usize) -> f64| there().map(|(i, volume)| volume * value(i)).collect::<Sum>().value();
    let size = integral(&|_| 1.0);
    if size == 0.0 {
        return [Some(0.0), None, None, None, None, None];
    }
    let temperatures = || there().map(|(i, _)| particles.reading(i));
    let taken_up = |i: usize| particles.enthalpy[i] - particles.start.get(i).copied().unwrap_or(0.0);
    [
        Some(size),
        Some(integral(&|i| particles.reading(i)) / size),
        Some(temperatures().fold(f64::INFINITY, f64::min)),
        Some(temperatures().fold(f64::NEG_INFINITY, f64::max)),
        Some(integral(&|i| particles.front_fraction(i)) / size),
        // Particles that move have brought heat from elsewhere.
        (!particles.move_about()).then(|| integral(&taken_up) / size),
    ]
}
