//! Regions that release heat.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};

use crate::sketch::{SHARP, Sketch, bundled, even, sand, steady_material, through, without_noise};

/// Heat that the first region has released at the end (J by metre of each missing dimension).
fn released(result: &frazil_record::RunResult) -> f64 {
    through(result, "region_1").last().copied().expect("a row")
}

/// At rest a layer between two walls at 5 °C holds 5 + q x (L - x) / 2k.
#[test]
fn a_layer_at_rest_holds_a_parabola() {
    for kind in methods() {
        let integrator = if kind.stochastic { "noise = false" } else { "integrator = \"implicit\"\ntolerance = 0.001" };
        let mut errors = [0.0; 2];
        for (error, spacing) in errors.iter_mut().zip([0.04, 0.02]) {
            let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, spacing).with(integrator);
            for wall in ["left", "right"] {
                sketch = sketch.wall(wall, "temperature_c = 5");
            }
            sketch.materials = vec![("ground", steady_material())];
            sketch.regions = vec!["heat_W_per_m3 = 400\nx_min_m = 0\nx_max_m = 1".into()];
            // Ten times the slowest decay, L^2 / (pi^2 alpha).
            (sketch.initial_c, sketch.duration_s) = (5.0, 1e6);
            let result = sketch.run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
            let exact = |x: f64| 5.0 + 400.0 * x * (1.0 - x) / 4.0;
            for row in &result.profiles {
                *error = f64::max(*error, (row.temperature_c - exact(row.along_m)).abs());
            }
        }
        // Of second order (a quarter; first order would be a half), and of 25 K at the middle: the horizon of three spacings smears a parabola by a tenth of a degree at most.
        assert!(errors[1] < 0.1 && errors[1] < 0.35 * errors[0], "{}: {errors:?}", kind.name);
    }
}

/// Ice that melts in a closed box by an even source is at every time where its enthalpy puts it, whatever advances it.
#[test]
fn ice_in_a_closed_box_melts_by_its_enthalpy() {
    for kind in methods() {
        let integrators = ["euler", "heun", "rkl2", "implicit"];
        for integrator in integrators.iter().take(if kind.stochastic { 1 } else { 4 }) {
            let mut sketch = Sketch::new(Domain::Rectangle { width: 0.5, height: 0.5 }, 0.05)
                .with(&format!("integrator = \"{integrator}\""))
                .with(without_noise(kind));
            sketch.regions = vec!["heat_W_per_m3 = 1000\ncircle = { x_m = 0.2, y_m = 0.2, radius_m = 1 }".into()];
            (sketch.initial_c, sketch.duration_s) = (-1.0, 200_000.0);
            let result = sketch.run(kind);
            // Of 2e8 J/m3, 2.06e6 warm the ice, and melting takes 3.34e8.
            let thawed = (2e8 - 2.06e6) / 3.34e8;
            let frozen = result.frozen.last().expect("a row").frozen_volume / 0.25;
            assert!((frozen - (1.0 - thawed)).abs() < 1e-9, "{} {integrator}: {frozen} {thawed}", kind.name);
            assert!((released(&result) / 5e7 - 1.0).abs() < 1e-12, "{} {integrator}", kind.name);
            assert!(result.record.energy_balance_rel.abs() < 1e-9, "{} {integrator}", kind.name);
        }
    }
}

/// What is released is the source over time and the volume of the region, wherever its edge cuts cells; and regions that overlap
/// release both.
#[test]
fn regions_release_by_their_volume_and_their_table() {
    let table = "heat_W_per_m3 = { times_s = [0, 1000, 3000], values = [0, 600, 0] }";
    // The integral of the table (J/m3).
    let heat = 600.0 * 1500.0;
    let shells = Domain::Radial { symmetry: Symmetry::Spherical, inner: 0.2, outer: 1.0 };
    let bodies = [
        (Domain::Line { length: 1.0 }, "x_min_m = 0.23\nx_max_m = 0.61", 0.38, 0.05),
        (
            Domain::Rectangle { width: 1.0, height: 0.8 },
            "circle = { x_m = 0.43, y_m = 0.37, radius_m = 0.3 }",
            PI * 0.09,
            0.05,
        ),
        (shells, "x_min_m = 0.33\nx_max_m = 0.71", 4.0 / 3.0 * PI * (0.71f64.powi(3) - 0.33f64.powi(3)), 0.05),
        (
            Domain::Ring { outer_radius: 2.0, sector: Sector::Whole },
            "circle = { x_m = 0.3, y_m = -0.4, radius_m = 0.77 }",
            PI * 0.77 * 0.77,
            0.1,
        ),
    ];
    for (domain, shape, volume, spacing) in bodies {
        let mut sketch = Sketch::new(domain, spacing).with("integrator = \"heun\"\nstep_s = 40");
        sketch.materials = vec![("sand", sand(SHARP))];
        (sketch.duration_s, sketch.outputs) = (4000.0, 4);
        sketch.regions = vec![format!("{table}\n{shape}"), format!("heat_W_per_m3 = -100\n{shape}")];
        let result = sketch.run(methods().iter().find(|kind| kind.name == "sph").expect("a method"));
        // Trapezoids over steps that end where the table bends are exact; cells that a circle cuts have exact shares.
        let found = released(&result) / (heat * volume);
        assert!((found - 1.0).abs() < 1e-9, "{domain:?}: {found}");
        let taken = through(&result, "region_2").last().copied().expect("a row");
        assert!((taken / (-100.0 * 4000.0 * volume) - 1.0).abs() < 1e-9, "{domain:?}: {taken}");
        assert!(result.record.energy_balance_rel.abs() < 1e-9, "{domain:?}");
    }
}

/// What is dug releases no more.
#[test]
fn dug_ground_takes_its_source_with_it() {
    for kind in even() {
        let mut sketch = Sketch::new(Domain::Ring { outer_radius: 2.0, sector: Sector::Whole }, 0.1)
            .wall("outer", "temperature_c = 10");
        sketch.materials = vec![("sand", sand(SHARP))];
        sketch.excavation = "radius_m = 0.75\nstart_s = 20000\ntemperature_c = 10".into();
        sketch.regions = vec!["heat_W_per_m3 = 50\ncircle = { x_m = 0, y_m = 0, radius_m = 0.5 }".into()];
        (sketch.initial_c, sketch.duration_s, sketch.outputs) = (10.0, 40_000.0, 4);
        let result = sketch.run(kind);
        let expected = 50.0 * 20_000.0 * PI * 0.25;
        assert!((released(&result) / expected - 1.0).abs() < 1e-9, "{}: {}", kind.name, released(&result) / expected);
        assert!(result.record.energy_balance_rel.abs() < 1e-9, "{}", kind.name);
    }
}

#[test]
fn sources_that_nothing_can_release_are_refused() {
    let liquid = Sketch::new(Domain::Rectangle { width: 1.0, height: 1.0 }, 0.05);
    let text = |line: &str, heat: &str| {
        let mut sketch = liquid.clone().with(line);
        sketch.regions = vec![format!("{heat}\nx_min_m = 0\nx_max_m = 0.5\ny_min_m = 0\ny_max_m = 1")];
        sketch.text("pd")
    };
    let message = |line: &str, heat: &str| match Scene::read(&text(line, heat), "own", "own.toml", &[], methods()) {
        Ok(_) => String::new(),
        Err(problems) => problems.to_string(),
    };
    assert_eq!(message("", "heat_W_per_m3 = 3"), "");
    let flags = message("scheme = \"flags\"", "heat_W_per_m3 = 3");
    assert!(flags.contains("scheme = \"flags\" cannot be combined with \"heat\" of a region"), "{flags}");
    let closed = message("", "impermeable = true\nheat_W_per_m3 = 3");
    assert!(closed.contains("own.toml:") && closed.contains("heat_W_per_m3"), "{closed}");
    let word = message("", "heat_W_per_m3 = \"much\"");
    assert!(word.contains("heat_W_per_m3") && word.contains("much"), "{word}");
}

/// All methods find that hydration thaws as much of the frozen wall, and that it freezes again.
#[test]
fn a_lining_thaws_the_wall_behind_it_for_a_time() {
    let mut most = Vec::new();
    for kind in even() {
        let result =
            march::run(&bundled("lining-hydration", &[]), kind.name, None, &Options::default()).expect("a run");
        assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
        // 115.956 MJ/m3, as trapezoids of the table, in the lining; steps take the source at their start.
        let expected = 115.956e6 * PI * (3.5 * 3.5 - 9.0);
        assert!((released(&result) / expected - 1.0).abs() < 1e-3, "{}: {}", kind.name, released(&result) / expected);
        let radii: Vec<f64> = result.front.iter().map(|row| row.front_m).collect();
        let greatest = radii.iter().copied().fold(0.0, f64::max);
        let last = radii.last().copied().expect("a row");
        assert!(greatest > 3.6 && last < 3.53, "{}: {greatest} {last}", kind.name);
        most.push(greatest);
    }
    // A cell of 0.025 m.
    assert!(most.iter().all(|other| (other - most[0]).abs() < 0.025), "{most:?}");
}
