//! Unsaturated water under gravity: against closed forms, at rest, and turned.

use std::sync::Arc;

use frazil::registry::methods;
use frazil_core::physics::curve::Curve;
use frazil_core::physics::retention::scale::head;
use frazil_core::solvers::step::Clock;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};

use crate::sketch::{Sketch, bundled, even, soil, through};

/// The root of the mean square error of the profiles of the column of Srivastava and Yeh, in saturation.
fn error(method: &str, changes: &[(String, String)]) -> f64 {
    let changes: Vec<(&str, &str)> = changes.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
    let scene = bundled("infiltration-column", &changes);
    let truth = frazil_cases::truth(&scene).expect("a closed form").reference.map(Arc::from);
    let result = march::run(&scene, method, truth.as_ref(), &Options::default()).expect("a run");
    assert_eq!(result.record.outcome, Outcome::Ok);
    assert!(result.record.energy_balance_rel.abs() < 1e-9, "{method}: {:e}", result.record.energy_balance_rel);
    result.record.errors.saturation_rms.expect("an error")
}

/// At 200 particles as the scene stands, and of second order with steps that are short enough to tell.
#[test]
fn infiltration_follows_its_closed_form_in_second_order() {
    for kind in even() {
        let as_it_stands = error(kind.name, &[]);
        assert!(as_it_stands < 3e-4, "{}: {as_it_stands}", kind.name);
        let [coarse, fine] = [0.02, 0.01].map(|spacing_m: f64| {
            let key = |key: &str| format!("method.{}.{key}", kind.name);
            error(kind.name, &[(key("spacing_m"), spacing_m.to_string()), (key("tolerance"), "1e-6".into())])
        });
        let order = (coarse / fine).log2();
        eprintln!("{}: {as_it_stands:.1e} at 200 particles, order {order:.2}", kind.name);
        assert!((1.8..2.2).contains(&order), "{}: {coarse} {fine}", kind.name);
    }
}

/// A column of fine sand.
fn column(spacing_m: f64) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, spacing_m);
    (sketch.of_water, sketch.initial_c) = (true, -0.5);
    sketch.materials = vec![("sand", soil())];
    sketch.gravity = "towards = \"left\"".into();
    sketch
}

/// Places along the body (m) and saturations at the end of a run.
fn profile(result: &RunResult) -> Vec<(f64, f64)> {
    let end = result.profiles.last().expect("a profile").time_s;
    let last = result.profiles.iter().filter(|row| row.time_s == end && row.plane == "line");
    last.filter_map(|row| Some((row.x_m?, row.temperature_c))).collect()
}

/// In a closed column water comes to rest with one total head everywhere, but for the second power of the spacing.
#[test]
fn closed_columns_come_to_rest_with_one_total_head() {
    for kind in even() {
        let spread = |spacing_m: f64| {
            let mut sketch = column(spacing_m).with("tolerance = 1e-5");
            sketch.duration_s = 1e8;
            let mut plan = sketch.plan(kind);
            let mut time = 0.0;
            while time < sketch.duration_s {
                let step = plan.method.wanted_step().min(sketch.duration_s - time);
                let clock = Clock { time, step, index: 0, turned: time == 0.0 };
                time += plan.method.advance(&mut plan.particles, &clock).expect("a step");
            }
            let mut heads = Vec::new();
            plan.particles.visit(|i, place| {
                let thermal = plan.particles.materials.of(i);
                heads.push(head(thermal.temperature(plan.particles.enthalpy[i])) + place.x);
            });
            let (low, high) =
                heads.iter().fold((f64::MAX, f64::MIN), |(low, high), head| (low.min(*head), high.max(*head)));
            high - low
        };
        let [coarse, fine] = [0.04, 0.02].map(spread);
        eprintln!("{}: heads spread by {coarse:.1e} and {fine:.1e} m", kind.name);
        assert!(fine < 5e-3 && coarse / fine > 3.0, "{}: {coarse} {fine}", kind.name);
    }
}

/// Saturated water stands still to rounding, whatever its walls are.
#[test]
fn saturated_water_at_rest_stays_at_rest() {
    for kind in even() {
        let mut sketch = column(0.02).wall("left", "head_m = 3").wall("right", "head_m = 2");
        (sketch.initial_c, sketch.duration_s, sketch.outputs) = (2.5, 1e5, 2);
        let result = sketch.run(kind);
        let entered = through(&result, "left");
        // All that enters is what the pressure stores at first.
        assert!((entered[1] - entered[0]).abs() < 1e-15, "{}: {entered:?}", kind.name);
        for (_, saturation) in profile(&result) {
            assert_eq!(saturation, 1.0);
        }
    }
}

/// Which way a column lies makes no difference but that of rounding.
#[test]
fn mirrored_and_turned_columns_do_the_same() {
    for kind in even() {
        let run = |domain: Domain, towards: &'static str, above: &'static str| {
            let mut sketch = column(0.02).wall(above, "water_flux_m_per_s = 2e-7").wall(towards, "head_m = -0.5");
            (sketch.domain, sketch.duration_s) = (domain, 1e6);
            sketch.gravity = format!("towards = \"{towards}\"");
            sketch.run(kind)
        };
        let line = Domain::Line { length: 1.0 };
        let down = profile(&run(line, "left", "right"));
        let mut mirrored: Vec<f64> = profile(&run(line, "right", "left")).iter().map(|row| row.1).collect();
        mirrored.reverse();
        for ((_, own), other) in down.iter().zip(&mirrored) {
            assert!((own - other).abs() < 1e-9, "{}: {own} {other}", kind.name);
        }
        let narrow = |wide: f64, high: f64| Domain::Rectangle { width: wide, height: high };
        let [upright, lying] = [(narrow(0.2, 1.0), "bottom", "top"), (narrow(1.0, 0.2), "left", "right")].map(
            |(domain, towards, above)| {
                let result = run(domain, towards, above);
                assert_eq!(result.record.outcome, Outcome::Ok, "{:?}", result.record.cause);
                through(&result, towards)
            },
        );
        for (one, other) in upright.iter().zip(&lying) {
            assert!((one / other - 1.0).abs() < 1e-9, "{}: {one} {other}", kind.name);
        }
    }
}

/// Under steady rain on a wall and free drainage below, ground becomes as moist as lets the rain through by its weight.
#[test]
fn rain_drains_freely_by_its_weight_alone() {
    for kind in even() {
        let mut sketch =
            column(0.05).wall("right", "water_flux_m_per_s = 3e-7").wall("left", "condition = \"free-drainage\"");
        sketch.duration_s = 3e7;
        let result = sketch.run(kind);
        assert_eq!(result.record.outcome, Outcome::Ok);
        assert!(result.record.energy_balance_rel.abs() < 1e-9);
        let scene = sketch.scene(kind);
        let curve = Curve::new(&scene.materials[0]);
        let moisture = curve.moisture().expect("a soil");
        for (_, saturation) in profile(&result) {
            let flux = moisture.hydraulic_conductivity(moisture.soil().place_of(saturation));
            assert!((flux / 3e-7 - 1.0).abs() < 1e-5, "{}: {flux}", kind.name);
        }
    }
}

/// Where gravity outruns what potentials even out, saturations stay between those of the data: a coarse column of coarse sand.
#[test]
fn coarse_columns_keep_the_range_of_the_data() {
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let changes = [("materials.soil.retention.alpha_per_m", "60"), ("domain.line.length_m", "2")];
        let spacing = (format!("method.{}.spacing_m", kind.name), "0.1");
        let changes: Vec<(&str, &str)> = changes.into_iter().chain([(spacing.0.as_str(), spacing.1)]).collect();
        let result = march::run(&bundled("infiltration-column", &changes), kind.name, None, &Options::default());
        let result = result.expect("a run");
        assert_eq!(result.record.outcome, Outcome::Ok);
        for row in &result.profiles {
            assert!((0.1 - 1e-9..=0.9 + 1e-9).contains(&row.temperature_c), "{}: {}", kind.name, row.temperature_c);
        }
    }
}

/// A solute of one concentration everywhere keeps it, however water falls through walls of all kinds.
#[test]
fn an_even_solute_stays_even_in_falling_water() {
    for kind in even() {
        for below in ["head_m = -0.4", "condition = \"free-drainage\"", "condition = \"symmetry\""] {
            let mut sketch =
                column(0.02).wall("right", "water_flux_m_per_s = 2e-7\nconcentration = 1").wall("left", below);
            if below.starts_with("head") {
                sketch = sketch.wall("left", format!("{below}\nconcentration = 1"));
            }
            sketch.duration_s = 2e5;
            sketch.materials[0].1 = soil().replace("1e-6 }", "1e-6, solute = { diffusion_m2_per_s = 1e-9 } }");
            let text = sketch.text(kind.name).replace("head_m = -0.5\n", "head_m = -0.5\nconcentration = 1\n");
            let scene = Scene::read(&text, "even", "even.toml", &[], &[kind]).expect("a scene");
            let result = march::run(&scene, kind.name, None, &Options::default()).expect("a run");
            assert_eq!(result.record.outcome, Outcome::Ok, "{:?}", result.record.cause);
            for row in &result.profiles {
                let found = row.concentration.expect("a concentration");
                assert!((found - 1.0).abs() < 1e-8, "{} over {below}: {found}", kind.name);
            }
        }
    }
}
