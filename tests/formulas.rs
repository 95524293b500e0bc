//! Formulas in place of numbers and tables.

use std::f64::consts::{PI, TAU};

use frazil::registry::methods;
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};

use crate::sketch::{Sketch, even, steady_material, water, without_noise};

/// A wall that swings by a formula, and by a table so fine that the two differ by less than rounding of nine digits.
#[test]
fn walls_follow_a_formula_as_a_fine_table() {
    const ROWS: usize = 20_000;
    let end = 1e5;
    let wall = |t: f64| -10.0 + 15.0 * (TAU * t / 4e4).sin();
    let times: Vec<f64> = (0..=ROWS).map(|k| end * k as f64 / ROWS as f64).collect();
    let values: Vec<f64> = times.iter().map(|time| wall(*time)).collect();
    // Straight between rows: an eighth of the square of their distance times the curvature.
    let apart = 0.125 * (end / ROWS as f64).powi(2) * 15.0 * (TAU / 4e4).powi(2);
    for kind in methods() {
        let temperatures = |line: String| {
            let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.05)
                .with(without_noise(kind))
                .wall("left", format!("temperature_c = {line}"));
            sketch.materials = vec![("ground", steady_material())];
            sketch.duration_s = end;
            let result = sketch.run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
            result.profiles.iter().map(|row| row.temperature_c).collect::<Vec<_>>()
        };
        let own = temperatures("{ formula = \"-10 + 15*sin(2*pi*t/4e4)\" }".into());
        let table = temperatures(format!("{{ times_s = {times:?}, values = {values:?} }}"));
        let worst = own.iter().zip(&table).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst <= apart, "{}: {worst}, at most {apart}", kind.name);
    }
}

/// Bodies of all kinds start by a formula, whose coordinates have the names of the body.
#[test]
fn bodies_start_by_a_formula() {
    let wave = |x: f64, y: f64| 10.0 + 5.0 * (PI * x / 2.0).cos() + 0.5 * y;
    let shells = Domain::Radial { symmetry: Symmetry::Spherical, inner: 0.5, outer: 1.0 };
    for (domain, formula, tilts) in [
        (Domain::Line { length: 1.0 }, "10 + 5*cos(pi*x/2)", 0.0),
        (Domain::Rectangle { width: 1.0, height: 0.5 }, "10 + 5*cos(pi*x/2) + y/2", 1.0),
        (shells, "10 + 5*cos(pi*r/2)", 0.0),
        (Domain::Axial { inner: 0.0, outer: 1.0, height: 0.5 }, "10 + 5*cos(pi*r/2) + z/2", 1.0),
    ] {
        for kind in even() {
            let mut sketch = Sketch::new(domain, 0.05);
            sketch.materials = vec![("ground", steady_material())];
            sketch.initial_along = format!("{{ formula = \"{formula}\" }}");
            let plan = sketch.plan(kind);
            plan.particles.visit(|i, place| {
                let own = plan.particles.materials.of(i).temperature(plan.particles.enthalpy[i]);
                // The mean over a cell differs by the curvature times the square of its side over 24, in shells also by one
                // or two twelfths of the slope over the radius, which is at most the greatest curvature.
                let of_shells = if domain.symmetry().is_some() { 2.0 / 12.0 } else { 0.0 };
                let apart = 1.01 * 0.05_f64.powi(2) * 5.0 * (PI / 2.0).powi(2) * (1.0 / 24.0 + of_shells);
                let expected = wave(place.x, tilts * place.y);
                assert!((own - expected).abs() < apart, "{} {domain:?}: {own} {expected}", kind.name);
            });
        }
    }
}

/// The part of a square above a line is the frozen one, each cut cell by its share.
#[test]
fn latent_heat_of_a_formula_is_that_of_the_parts_of_cells() {
    for kind in even() {
        let mut sketch = Sketch::new(Domain::Rectangle { width: 1.0, height: 1.0 }, 0.1);
        sketch.materials =
            vec![("water", water("law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 334000"))];
        sketch.initial_along = "{ formula = \"1.01 - x - y\" }".into();
        let plan = sketch.plan(kind);
        let frozen = plan.particles.integral(|i| plan.particles.frozen_fraction(i));
        // Cells are taken in sixteen parts by their middles: of the ten on the diagonal six of them lie above the line. What
        // these parts are warmer or colder than the line, a tenth of a degree, melts or freezes so much of their water.
        let sensible = 10.0 * 0.01 * 4182.0 * 0.1 / 334_000.0;
        assert!((frozen - (45.0 + 10.0 * 6.0 / 16.0) * 0.01).abs() < sensible, "{}: {frozen}", kind.name);
    }
}

#[test]
fn a_formula_has_the_range_and_the_turns_of_its_run() {
    let scene = |formula: &str| {
        let sketch = Sketch { duration_s: 1e5, ..Sketch::new(Domain::Line { length: 1.0 }, 0.1) };
        sketch.wall("left", format!("temperature_c = {{ formula = \"{formula}\" }}")).scene(methods()[0])
    };
    let swings = scene("-10 + 15*sin(2*pi*t/4e4)");
    let range = swings.temperature_range();
    assert!((range.0 + 25.0).abs() < 1e-9 && (range.1 - 5.0).abs() < 1e-9, "{range:?}");
    // Ten seconds are between samples.
    let turns = [0.0, 2e4, 4e4, 6e4, 8e4].map(|time| swings.next_bend(time));
    for (turn, expected) in turns.into_iter().zip([1e4, 3e4, 5e4, 7e4, 9e4]) {
        assert!(turn.is_some_and(|turn| (turn - expected).abs() <= 20.0), "{turn:?} {expected}");
    }
    assert_eq!(swings.next_bend(9.5e4), None);
    // Data that pull one way all the time are watched for setbacks; those that come back are not.
    let is_watched = |formula: &str| {
        let result = march::run(&scene(formula), methods()[0].name, None, &Options::default()).expect("a run");
        result.record.setback_rel.is_some()
    };
    assert!(is_watched("-20 + 20*exp(-t/1e4)") && is_watched("-5"));
    assert!(!is_watched("-10 + 15*sin(2*pi*t/4e4)") && !is_watched("-5 + t/1e5"));
}

/// A formula of the time alone is the same for all particles of a region.
#[test]
fn a_source_by_the_time_alone_is_a_series() {
    let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.1);
    sketch.regions = vec!["heat_W_per_m3 = { formula = \"5*exp(-t/1e3)\" }\nx_min_m = 0\nx_max_m = 1".into()];
    let scene = sketch.scene(methods()[0]);
    let heat = scene.regions[0].heat.as_ref().expect("heat");
    assert!(matches!(heat, frazil_core::balances::heated::Power::Even(Series::Formula(_))), "{heat:?}");
    assert!(scene.has_flux() && scene.has_heat_sources());
}

#[test]
fn what_is_no_formula_is_refused() {
    let message = |domain: Domain, place: &str, table: &str| {
        let mut sketch = Sketch::new(domain, 0.1);
        let line = format!("temperature_c = {table}");
        match place {
            "start" => sketch.initial_along = table.into(),
            "heat" => sketch.regions = vec![format!("heat_W_per_m3 = {table}\nx_min_m = 0\nx_max_m = 1")],
            wall => sketch = sketch.wall(if wall == "outer" { "outer" } else { "left" }, line),
        }
        match Scene::read(sketch.text("pd").as_str(), "own", "own.toml", &[], methods()) {
            Ok(_) => String::new(),
            Err(problems) => problems.to_string(),
        }
    };
    let line = Domain::Line { length: 1.0 };
    let pipe = Domain::Radial { symmetry: Symmetry::Axial, inner: 0.5, outer: 1.0 };
    let ring = Domain::Ring { outer_radius: 1.0, sector: Sector::Whole };
    let functions = "sin, cos, tan, atan, sinh, cosh, tanh, exp, ln, sqrt, abs, erf, erfc, min, max";
    for (domain, place, table, words) in [
        (
            line,
            "start",
            "{ formula = \"10 + 5*cos(pi*y/2)\" }",
            format!(
                "initial.temperature_c.formula: \"10 + 5*cos(pi*y/2)\": found \"y\" in column 15, must be \"x\", \"pi\" or a \
                 function: {functions}"
            ),
        ),
        (pipe, "start", "{ formula = \"x\" }", "found \"x\" in column 1, must be \"r\", \"pi\" or a function".into()),
        (line, "left", "{ formula = \"5*x\" }", "found \"x\" in column 3, must be \"t\", \"pi\" or a function".into()),
        (line, "left", "{ formula = \"floor(t)\" }", "found \"floor\" in column 1, must be \"t\"".into()),
        (
            line,
            "left",
            "{ formula = \"5 + \" }",
            "walls.left.temperature_c.formula: \"5 + \": found the end in column".into(),
        ),
        (line, "start", "{ formula = \"1/x\" }", "found inf at x = 0, must be a finite number".into()),
        (line, "left", "{ formula = \"ln(1800 - t)\" }", "found NaN at t = 18".into()),
        (line, "start", "{ formula = \"-300*x\" }", "found -300 at x = 1, must be greater than -273.15".into()),
        (
            line,
            "left",
            "{ formula = \"t^2\" }",
            "found 12960000 at t = 3600, must be greater than -273.15 and at most 1".into(),
        ),
        (line, "left", "{ formula = \"sin(t*10)\" }", "found more than 1000 turns from rising to falling".into()),
        (line, "left", "{ formula = 3 }", "walls.left.temperature_c.formula: found 3, must be a text".into()),
        (line, "left", "{ formula = \"5\", values = [1] }", "walls.left.temperature_c.values: unknown key".into()),
        (line, "left", "{ formul = \"5\" }", "did you mean \"formula\"".into()),
        (line, "heat", "{ formula = \"t*z\" }", "found \"z\" in column 3, must be \"x\", \"t\", \"pi\"".into()),
        (line, "heat", "{ formula = \"t/x\" }", "at x = 0, t = 0, must be a finite number".into()),
        (ring, "start", "{ formula = \"x\" }", "a plan across the pipes lies at one depth".into()),
    ] {
        let found = message(domain, place, table);
        assert!(found.contains("own.toml:") && found.contains(&words), "{table}: {found}");
    }
    for (place, table) in [
        ("start", "{ formula = \"sqrt(x)\" }"),
        ("left", "{ formula = \"5*sin(2*pi*t/3600)\" }"),
        ("heat", "{ formula = \"3*x*t\" }"),
    ] {
        assert_eq!(message(line, place, table), "", "{table}");
    }
    assert_eq!(message(ring, "outer", "{ formula = \"sqrt(t)\" }"), "");
}

/// Where the program needs rows, it says so.
#[test]
fn formulas_are_refused_where_rows_are_needed() {
    let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.1);
    (sketch.of_water, sketch.initial_c) = (true, -1.0);
    sketch.materials = vec![("soil", crate::sketch::soil())];
    let message = |wall: &str| {
        let text = sketch.clone().wall("left", wall).text("pd");
        Scene::read(text.as_str(), "own", "own.toml", &[], methods())
            .map_or_else(|found| found.to_string(), |_| String::new())
    };
    for key in ["head_m", "saturation", "rain_m_per_s"] {
        let found = message(&format!("{key} = {{ formula = \"-t/1e4\" }}"));
        assert!(found.contains("own.toml:") && found.contains("must be a table in time here"), "{found}");
        assert_eq!(found.lines().count(), 1, "{found}");
    }
    assert_eq!(message("water_flux_m_per_s = { formula = \"1e-9*sin(t/1e3)\" }"), "");
}

#[test]
fn the_schema_has_formulas_where_scenes_may_have_them() {
    let schema = frazil_scene::schema(methods());
    let takes = |section: &str, key: &str| {
        let value = &schema["definitions"][section]["properties"][key];
        let value = if value.is_null() {
            &schema["definitions"][section]["additionalProperties"]["properties"][key]
        } else {
            value
        };
        assert!(!value.is_null(), "{section} {key}");
        value.to_string().contains("\"formula\"")
    };
    for (section, key) in [
        ("initial", "temperature_c"),
        ("initial", "head_m"),
        ("walls", "temperature_c"),
        ("regions", "heat_W_per_m3"),
        ("reference", "temperature_c"),
    ] {
        assert!(takes(section, key), "{section} {key}");
    }
    for (section, key) in [("walls", "head_m"), ("cracks", "length_m"), ("initial", "concentration")] {
        assert!(!takes(section, key), "{section} {key}");
    }
}
