//! Pipes that take or give a known heat: line sources in the ground.

use std::f64::consts::{PI, TAU};

use frazil_cases::exact::line_sink::LineSink;
use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::{Outcome, RunResult};
use frazil_studies::answers::numbers::numbers;

use crate::sketch::{Sketch, even, sand, steady_material, through};

const DAY: f64 = 86_400.0;

/// A pipe in the middle of a ring of sand, at 8 degC at the start and at its outer wall.
fn one_pipe(sector: Sector, outer_radius: f64, heat: &str) -> Sketch {
    let mut sketch = Sketch::new(Domain::Ring { outer_radius, sector }, 0.1).wall("outer", "temperature_c = 8");
    sketch.materials = vec![("sand", sand(SAND))];
    sketch.initial_c = 8.0;
    sketch.pipes = vec![format!("count = 1\nring_radius_m = 0\npipe_radius_m = 0.054\nheat_W_per_m = {heat}")];
    sketch
}

/// 0.2 of its volume is water.
const SAND: &str = "law = \"isothermal\", latent_heat_J_per_kg = 32000, temperature_c = 0";

/// The same sand, for the solution beside a line.
fn material() -> Material {
    let phase = |conductivity: f64, heat_capacity: f64| Phase { conductivity, heat_capacity };
    Material {
        name: "sand".into(),
        density: 2090.0,
        frozen: phase(2.56, 1088.4),
        unfrozen: phase(1.86, 1465.1),
        freezing_point: 0.0,
        latent_heat: 32_000.0,
        law: FreezingLaw::Isothermal,
        mixing: Mixing::Arithmetic,
        pores: None,
        soil: None,
    }
}

/// The last value of a column of a table.
fn last(result: &RunResult, file: &str, column: &str) -> f64 {
    let table = result.tables.iter().find(|table| table.file == file).expect("a table");
    let at = table.columns.iter().position(|own| own.name == column).expect("a column");
    table.rows.last().expect("rows")[at].expect("a value")
}

/// The front around a line that takes 80 W/m (Paterson 1952), by the area that is frozen, and the temperature of the ground at the
/// pipe's radius. Ground at the outer wall changes by less than 1e-4 K in these twenty days. A front stands to a fiftieth of
/// a spacing where it should: one that could enter cells only as a whole would stand 0.07 behind. The wall's temperature
/// follows the logarithm of a tenth of a spacing.
#[test]
fn the_front_around_a_line_is_that_of_the_exact_solution() {
    let exact = LineSink::new(&material(), 8.0, 80.0);
    let end = 20.0 * DAY;
    for kind in even() {
        for spacing_m in [0.1, 0.05] {
            let mut sketch = one_pipe(Sector::Quarter, 6.0, "-80");
            sketch.pipes[0] = sketch.pipes[0].replace("0.054", "0.01");
            (sketch.spacing_m, sketch.duration_s, sketch.outputs) = (spacing_m, end, 4);
            sketch.watch = "regions = [{ circle = { x_m = 0, y_m = 0, radius_m = 2 } }]".into();
            let result = sketch.run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
            let area = 4.0 * last(&result, "regions.csv", "frozen_fraction") * last(&result, "regions.csv", "area_m2");
            let behind = exact.front(end) - (area / PI).sqrt();
            let colder = exact.frozen_temperature(0.01, end) - last(&result, "pipes.csv", "wall_c");
            let known = 80.0 / (TAU * 2.56) * (exact.front(end) / (exact.front(end) - 0.1 * spacing_m)).ln();
            eprintln!("{} {spacing_m}: front {behind:.4} m behind, wall {colder:.3} K colder", kind.name);
            assert!(behind.abs() < 0.02 * spacing_m, "{} {spacing_m}: {behind} m", kind.name);
            assert!(colder.abs() < known, "{} {spacing_m}: {colder} K of {known}", kind.name);
        }
    }
}

/// At rest the walls of a row of pipes of radius r, s apart, stand `q / (2 pi k) (pi h/s - ln(2 pi r/s))` below walls at a distance h
/// (`rows::a_row_at_rest_takes_what_line_sinks_take`, read the other way).
#[test]
fn walls_of_a_row_at_rest_have_the_temperature_of_line_sinks() {
    let exact = 10.0 - 100.0 / (2.0 * PI * 2.0) * (PI * 1.5 - (2.0 * PI * 0.05).ln());
    for kind in even() {
        let mut sketch = crate::rows::row(2, false, 0.1).with("integrator = \"implicit\"\ntolerance = 0.001");
        sketch.pipes[0] = sketch.pipes[0].replace("temperature_c = -20", "heat_W_per_m = -100");
        sketch.materials = vec![("ground", steady_material())];
        (sketch.duration_s, sketch.outputs) = (1e7, 10);
        let result = sketch.run(kind);
        assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
        for column in ["wall_c", "coldest_c", "warmest_c"] {
            let wall = last(&result, "pipes.csv", column);
            assert!((wall - exact).abs() < 5e-4 * (10.0 - exact), "{}: {column} {wall}, not {exact}", kind.name);
        }
        let scene = sketch.scene(kind);
        let found = numbers(&scene, &result).into_iter().find(|number| number.name == "pipe_wall_c").expect("a number");
        assert_eq!(found.value, last(&result, "pipes.csv", "wall_c"), "{}", kind.name);
    }
}

/// What comes out is what was asked for, to rounding, under all integrators, where pipes rest, and where the heat changes; the table
/// bends on a switch and within an interval, on which long steps land.
#[test]
fn the_heat_of_the_ledger_is_the_heat_of_the_scene() {
    let heats = [
        ("-80", "", -80.0 * 9.0),
        ("-80", "on_s = [[86400, 259200], [432000]]", -80.0 * (2.0 + 4.0)),
        ("{ times_days = [0, 2, 5], values = [0, -90, 30] }", "", -90.0 - 30.0 * 3.0 + 30.0 * 4.0),
        ("60", "", 60.0 * 9.0),
    ];
    for kind in even() {
        for integrator in ["euler", "rkl2", "implicit"] {
            for (heat, works, expected) in heats {
                let mut sketch = one_pipe(Sector::Whole, 2.0, heat).with(&format!("integrator = \"{integrator}\""));
                sketch.pipes[0] += &format!("\n{works}");
                sketch.duration_s = 9.0 * DAY;
                let result = sketch.run(kind);
                let what = format!("{} {integrator} {heat} {works}", kind.name);
                assert_eq!(result.record.outcome, Outcome::Ok, "{what}: {:?}", result.record.cause);
                assert!(result.record.energy_balance_rel.abs() < 1e-9, "{what}");
                let taken = *through(&result, "pipes").last().expect("rows") / DAY;
                // Explicit steps of Euler take the heat of their begin where it changes: to half a step of some hundred.
                let tolerance = if heat.starts_with('{') { 0.02 } else { 1e-9 };
                assert!((taken - expected).abs() < tolerance * 720.0, "{what}: {taken}, not {expected}");
            }
        }
    }
}

/// A pipe of a temperature and one of the heat that it takes leave the same ground.
#[test]
fn heat_that_a_cold_pipe_takes_leaves_the_same_ground() {
    for kind in even() {
        let mut cold = one_pipe(Sector::Quarter, 2.0, "-80").with("integrator = \"implicit\"\ntolerance = 0.001");
        cold.materials = vec![("ground", steady_material())];
        (cold.duration_s, cold.outputs) = (4e7, 2);
        let mut given = cold.clone();
        cold.pipes[0] = cold.pipes[0].replace("heat_W_per_m = -80", "temperature_c = -20");
        let cold = cold.run(kind);
        let [.., before, end] = &through(&cold, "pipes")[..] else { unreachable!("two rows") };
        let rate = 4.0 * (end - before) / 2e7;
        given.pipes[0] = given.pipes[0].replace("-80", &rate.to_string());
        let given = given.run(kind);
        let wall = last(&given, "pipes.csv", "wall_c");
        assert!((wall + 20.0).abs() < 0.01, "{}: {wall}", kind.name);
        let exact = -TAU * 2.0 * 28.0 / (2.0_f64 / 0.054).ln();
        assert!((rate / exact - 1.0).abs() < 0.01, "{}: {rate}, not {exact}", kind.name);
    }
}

/// A ring that takes what pipes at -20 degC took, step by step, closes on the same day: to a hundredth, because pipes that are to
/// take a heat have no temperature at which their own content could start: cooled by 20 K it is 0.4 % of the heat of its column.
#[test]
fn a_ring_of_the_same_heat_closes_on_the_same_day() {
    for kind in even() {
        let ring = |pipes: &str| {
            let mut sketch = one_pipe(Sector::Quarter, 6.0, "-80");
            sketch.pipes = vec![format!("count = 12\nring_radius_m = 2\npipe_radius_m = 0.054\n{pipes}")];
            (sketch.duration_s, sketch.outputs) = (25.0 * DAY, 400);
            sketch.run(kind)
        };
        let cold = ring("temperature_c = -20");
        let taken = through(&cold, "pipes");
        let step = 25.0 * DAY / 400.0;
        let (mut times, mut values, mut before) = (Vec::new(), Vec::new(), 0.0);
        for (k, taken) in taken.iter().enumerate() {
            times.push((k as f64 + 0.5) * step);
            // Three of the twelve stand in a quarter.
            values.push((taken - before) / step / 3.0);
            before = *taken;
        }
        let given = ring(&format!("heat_W_per_m = {{ times_s = {times:?}, values = {values:?} }}"));
        let [cold, given] = [cold, given].map(|result| result.gaps[0].closure_s.expect("closed"));
        eprintln!("{}: closed after {:.3} d, with the same heat {:.3} d", kind.name, cold / DAY, given / DAY);
        assert!((given / cold - 1.0).abs() < 0.01, "{}: {given} {cold}", kind.name);
    }
}
