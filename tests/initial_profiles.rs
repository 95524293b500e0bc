//! Starts that vary along an axis.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::physics::retention::scale::head;
use frazil_core::solvers::step::Clock;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_simulation::plan::Plan;

use crate::sketch::{Sketch, even, soil, steady_material, without_noise};

/// Of `steady_material`.
const DIFFUSIVITY: f64 = 1e-6;

/// All bodies hold the heat that a table gives them, each point by its volume.
#[test]
fn bodies_hold_the_heat_of_the_table() {
    // From -4 to 6 degrees along x, but constant at the last tenth; frozen in the first four tenths.
    let table = "{ x_m = [0, 0.9], values = [-4, 5] }";
    // Integral of the temperature, of its frozen part below zero, and the frozen volume, of a line.
    let along = |symmetry: Option<Symmetry>| -> [f64; 3] {
        const PIECES: usize = 100_000;
        let mut sums = [0.0; 3];
        for k in 0..PIECES {
            let (low, high) = (k as f64 / PIECES as f64, (k + 1) as f64 / PIECES as f64);
            let volume = symmetry.map_or(high - low, |symmetry| symmetry.volume(low, high));
            let temperature = (10.0 * 0.5 * (low + high) - 4.0).min(5.0);
            sums[0] += volume * temperature.max(0.0);
            sums[1] += volume * temperature.min(0.0);
            sums[2] += if temperature < 0.0 { volume } else { 0.0 };
        }
        sums
    };
    let bodies = [
        (Domain::Line { length: 1.0 }, None, 1.0),
        (Domain::Rectangle { width: 1.0, height: 0.5 }, None, 0.5),
        (Domain::Radial { symmetry: Symmetry::Axial, inner: 0.0, outer: 1.0 }, Some(Symmetry::Axial), 1.0),
        (Domain::Radial { symmetry: Symmetry::Spherical, inner: 0.0, outer: 1.0 }, Some(Symmetry::Spherical), 1.0),
        (Domain::Axial { inner: 0.0, outer: 1.0, height: 0.5 }, Some(Symmetry::Axial), 0.5),
    ];
    for kind in even() {
        for (domain, symmetry, height) in bodies {
            for spacing in [0.1, 0.025] {
                let mut sketch = Sketch::new(domain, spacing);
                sketch.initial_along = table.into();
                let particles = sketch.plan(kind).particles;
                let thermal = &particles.materials.thermals[0];
                let held = particles.integral(|i| particles.enthalpy[i]);
                let whole = particles.integral(|_| 1.0);
                let [warm, cold, frozen] = along(symmetry).map(|sum| sum * height);
                // Water: heat from 0 degrees thawed, as the particles count theirs from a temperature of their own.
                let exact =
                    4.182e6 * warm + 2.06e6 * cold - 3.34e8 * frozen - whole * absolute(thermal.zero_temperature);
                // The front lies in a slice of a sixteenth of a cell, a corner of the table in another.
                let front = 3.34e8 * height * symmetry.map_or(1.0, |symmetry| symmetry.volume(0.39, 0.41) / 0.02);
                let error = (held - exact).abs();
                assert!(error < front * spacing / 16.0, "{} {domain:?} {spacing}: {held} {exact}", kind.name);
            }
        }
    }
}

/// Heat (J/m3) of water at a temperature, from thawed water of 0 degrees.
fn absolute(temperature: f64) -> f64 {
    if temperature < 0.0 { 2.06e6 * temperature - 3.34e8 } else { 4.182e6 * temperature }
}

/// A straight profile between walls of its own end temperatures stays as it is.
#[test]
fn a_straight_profile_between_its_walls_stays() {
    for kind in methods() {
        let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.05)
            .with(without_noise(kind))
            .wall("left", "temperature_c = 2")
            .wall("right", "temperature_c = 12");
        sketch.materials = vec![("ground", steady_material())];
        sketch.initial_along = "{ x_m = [0, 1], values = [2, 12] }".into();
        sketch.duration_s = 1e5;
        let result = sketch.run(kind);
        assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
        for row in &result.profiles {
            let expected = 2.0 + 10.0 * row.along_m;
            assert!((row.temperature_c - expected).abs() < 1e-9, "{}: {row:?}", kind.name);
        }
    }
}

/// A cosine between insulated walls decays as it should, along x, along y, and in a line.
#[test]
fn a_cosine_decays() {
    let rows = |axis: &str| {
        let places: Vec<f64> = (0..=200).map(|k| f64::from(k) / 200.0).collect();
        let values: Vec<f64> = places.iter().map(|place| 5.0 + 3.0 * (PI * place).cos()).collect();
        format!("{{ {axis} = {places:?}, values = {values:?} }}")
    };
    let bodies = [
        (Domain::Line { length: 1.0 }, "x_m"),
        (Domain::Rectangle { width: 1.0, height: 0.2 }, "x_m"),
        (Domain::Rectangle { width: 0.2, height: 1.0 }, "y_m"),
    ];
    for kind in methods() {
        let mut ends = Vec::new();
        for (domain, axis) in bodies {
            let mut errors = [0.0; 2];
            for (error, spacing) in errors.iter_mut().zip([0.05, 0.025]) {
                let mut sketch = Sketch::new(domain, spacing).with(without_noise(kind));
                sketch.materials = vec![("ground", steady_material())];
                sketch.initial_along = rows(axis);
                // Half a time constant.
                sketch.duration_s = 0.5 / DIFFUSIVITY / PI.powi(2);
                let result = sketch.run(kind);
                assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
                let last = result.profiles.iter().map(|row| row.time_s).fold(0.0, f64::max);
                let at_end = result.profiles.iter().filter(|row| row.time_s == last);
                for row in at_end.clone() {
                    let exact = 5.0 + 3.0 * (PI * row.along_m).cos() * (-0.5_f64).exp();
                    *error = f64::max(*error, (row.temperature_c - exact).abs());
                }
                if spacing == 0.025 {
                    ends.push(at_end.map(|row| row.temperature_c).collect::<Vec<_>>());
                }
            }
            assert!(errors[1] < 0.03 && errors[1] < 0.35 * errors[0], "{} {domain:?}: {errors:?}", kind.name);
        }
        // The plane along y is that along x, turned.
        for (x, y) in ends[1].iter().zip(&ends[2]) {
            assert!((x - y).abs() < 1e-9, "{}: {x} {y}", kind.name);
        }
    }
}

/// Water that hangs in a column with one total head stays as it is: what moves is by the second power of the spacing, as in
/// `gravity::closed_columns_come_to_rest_with_one_total_head`.
#[test]
fn hanging_water_stays() {
    let profiles = ["{ x_m = [0, 1], values = [-0.5, -1.5] }", "{ formula = \"-0.5 - x\" }"];
    for (kind, profile) in even().flat_map(|kind| profiles.map(|profile| (kind, profile))) {
        let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.02);
        (sketch.of_water, sketch.duration_s, sketch.outputs) = (true, 1e6, 2);
        sketch.materials = vec![("soil", soil())];
        sketch.gravity = "towards = \"left\"".into();
        sketch.initial_along = profile.into();
        let mut plan = sketch.plan(kind);
        let spread = |plan: &Plan| {
            let mut range = (f64::MAX, f64::MIN);
            plan.particles.visit(|i, place| {
                let head = head(plan.particles.materials.of(i).temperature(plan.particles.enthalpy[i])) + place.x;
                range = (range.0.min(head), range.1.max(head));
            });
            range
        };
        let mut time = 0.0;
        while time < sketch.duration_s {
            let (low, high) = spread(&plan);
            assert!((low + 0.5).abs() < 5e-3 && (high + 0.5).abs() < 5e-3, "{}: {low} to {high} m", kind.name);
            let step = plan.method.wanted_step().min(sketch.duration_s - time);
            let clock = Clock { time, step, index: 0, turned: time == 0.0 };
            time += plan.method.advance(&mut plan.particles, &clock).expect("a step");
        }
    }
}

#[test]
fn tables_that_no_body_has_are_refused() {
    let message = |domain: Domain, table: &str| {
        let mut sketch = Sketch::new(domain, 0.05);
        sketch.initial_along = table.into();
        match Scene::read(sketch.text("pd").as_str(), "own", "own.toml", &[], methods()) {
            Ok(_) => String::new(),
            Err(problems) => problems.to_string(),
        }
    };
    let line = Domain::Line { length: 1.0 };
    let plane = Domain::Rectangle { width: 1.0, height: 1.0 };
    assert_eq!(message(plane, "{ y_m = [0, 1], values = [1, 2] }"), "");
    for (domain, table, key, words) in [
        (line, "{ y_m = [0, 1], values = [1, 2] }", "initial.temperature_c.y_m", "found in a body without y"),
        (plane, "{ x_m = [0, 1, 1], values = [1, 2, 3] }", "initial.temperature_c.x_m", "found 1 after 1"),
        (plane, "{ x_m = [0, 1], values = [1, 2, 3] }", "initial.temperature_c.values", "found 3 values for 2 places"),
        (plane, "{ x_m = [0], values = [1] }", "initial.temperature_c", "fewer than two places"),
        (plane, "{ x_m = [0, 1], y_m = [0, 1], values = [1, 2] }", "initial.temperature_c.y_m", "only one of them"),
        (plane, "{ x_m = [0, 1], values = [1, -300] }", "initial.temperature_c.values", "-300"),
        (plane, "{ values = [1, 2] }", "initial.temperature_c", "x_m"),
        (plane, "\"warm\"", "initial.temperature_c", "warm"),
        (
            Domain::Ring { outer_radius: 1.0, sector: Sector::Whole },
            "{ y_m = [0, 1], values = [1, 2] }",
            "initial",
            "a plan across the pipes lies at one depth",
        ),
    ] {
        let found = message(domain, table);
        assert!(found.contains("own.toml:") && found.contains(key) && found.contains(words), "{table}: {found}");
    }
}
