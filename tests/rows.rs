//! Straight rows of freeze pipes in a rectangle.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, RunResult};
use frazil_scene::Scene;

use crate::sketch::{Sketch, even, steady_material, thicknesses, through};

/// A row of pipes 1 m apart, of which so many are in the plan; insulated at its ends, which are half-way to the next pipes.
pub fn row(count: usize, upright: bool, spacing_m: f64) -> Sketch {
    let (along, across) = (count as f64, 3.0);
    let size = if upright { (across, along) } else { (along, across) };
    let place = |along: f64| if upright { format!("[1.5, {along}]") } else { format!("[{along}, 1.5]") };
    let ends = format!("from_m = {}\nto_m = {}", place(0.5), place(along - 0.5));
    let mut sketch = Sketch::new(Domain::Rectangle { width: size.0, height: size.1 }, spacing_m);
    sketch.pipes = vec![format!("count = {count}\n{ends}\npipe_radius_m = 0.05\ntemperature_c = -20")];
    for wall in if upright { ["left", "right"] } else { ["bottom", "top"] } {
        sketch = sketch.wall(wall, "temperature_c = 10");
    }
    (sketch.initial_c, sketch.duration_s) = (10.0, 30.0 * 86_400.0);
    sketch
}

fn closures(result: &RunResult) -> Vec<f64> {
    result.gaps.iter().map(|gap| gap.closure_s.expect("closed")).collect()
}

/// At rest a row of pipes of radius r, s apart, takes `2 pi k (T - T_pipe) / (pi h/s - ln(2 pi r/s))` each from walls at a distance h:
/// the potential of a row of line sinks, `ln(2 cosh(2 pi y/s) - 2 cos(2 pi x/s))`, is even along walls to `exp(-2 pi h/s)`, 1e-4 here.
#[test]
fn a_row_at_rest_takes_what_line_sinks_take() {
    let exact = 2.0 * PI * 2.0 * 30.0 / (PI * 1.5 - (2.0 * PI * 0.05).ln());
    for kind in even() {
        let errors = [0.1, 0.05].map(|spacing_m| {
            let mut sketch = row(2, false, spacing_m).with("integrator = \"implicit\"\ntolerance = 0.001");
            sketch.materials = vec![("ground", steady_material())];
            // Ten times the slowest decay, (2 h)^2 / (pi^2 alpha).
            (sketch.duration_s, sketch.outputs) = (1e7, 10);
            let result = sketch.run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
            let last = result.walls.last().expect("a wall").heat_per_pipe_w_per_m;
            let taken = through(&result, "pipes");
            let step = (taken[taken.len() - 1] - taken[taken.len() - 2]) / 1e6 / 2.0;
            assert!((last + step).abs() < 1e-3 * last.abs(), "{}: {last} {step}", kind.name);
            last / exact - 1.0
        });
        eprintln!("{}: heat of a row off by {:.2e}, {:.2e}", kind.name, errors[0], errors[1]);
        assert!(errors.iter().all(|error| error.abs() < 5e-4), "{}: {errors:?}", kind.name);
    }
}

/// All gaps of an endless row close at once, however much of it is run and whichever way it lies.
#[test]
fn gaps_of_an_endless_row_close_at_once() {
    for kind in even() {
        let two = row(2, false, 0.1).run(kind);
        let four = row(4, false, 0.1).run(kind);
        let upright = row(4, true, 0.1).run(kind);
        let first = closures(&two)[0];
        assert!(first > 86_400.0, "{}: {first}", kind.name);
        for closure in closures(&four).into_iter().chain(closures(&upright)) {
            assert!((closure / first - 1.0).abs() < 1e-9, "{}: {closure} {first}", kind.name);
        }
        let along: Vec<f64> = four.gaps.iter().map(|gap| gap.along_m.expect("a row")).collect();
        assert!(
            along.iter().zip([0.5, 1.5, 2.5]).all(|(along, expected)| (along - expected).abs() < 1e-9),
            "{along:?}"
        );
        // The wall is as thick between pipes as nothing before it closes, and thinner than through them.
        for row in &four.walls {
            let [main, between] = thicknesses(row);
            assert!(between <= main + 1e-9 && (row.time_s < 0.9 * first) <= (between < 0.05), "{}: {row:?}", kind.name);
        }
        let end = four.walls.last().expect("a wall");
        assert!(thicknesses(end)[1] > 0.3, "{}: {end:?}", kind.name);
        assert!(four.record.energy_balance_rel.abs() < 1e-9, "{}", four.record.energy_balance_rel);
    }
}

/// A pipe that is missing leaves a gap of twice the width, which closes last.
#[test]
fn a_missing_pipe_leaves_the_last_gap() {
    for kind in even() {
        let mut sketch = row(5, false, 0.1);
        sketch.pipes[0] += "\nmissing = [\"1.3\"]";
        sketch.duration_s = 120.0 * 86_400.0;
        let result = sketch.run(kind);
        let wide =
            result.gaps.iter().find(|gap| (gap.from.as_str(), gap.to.as_str()) == ("1.2", "1.4")).expect("a gap");
        let others = result.gaps.iter().filter(|gap| gap.gap != wide.gap).filter_map(|gap| gap.closure_s);
        assert_eq!(result.gaps.len(), 3);
        assert!(others.clone().count() == 2, "{}", kind.name);
        assert!(others.fold(0.0, f64::max) < 0.5 * wide.closure_s.unwrap_or(f64::INFINITY), "{}", kind.name);
    }
}

/// Seepage that is strong enough keeps the gaps of a row open; without a difference of pressure they close as without water.
#[test]
fn seepage_keeps_gaps_open() {
    for kind in even() {
        let run = |pressure: f64| {
            // Fronts stay in cells beside water and not without.
            let mut sketch = row(2, false, 0.1).with("front = \"cell\"");
            sketch.materials[0].1 = sketch.materials[0].1.replacen(
                "{ ",
                "{ groundwater = { porosity = 0.4, permeability_m2 = 1e-11, density_kg_per_m3 = 1000, heat_capacity_J_per_kg_K = 4182 }, ",
                1,
            );
            sketch.flow = format!(
                "viscosity_Pa_s = 1.3e-3\nrelative_permeability = {{ law = \"power\", exponent = 7 }}\n\
                 walls.bottom = {{ pressure_Pa = {pressure} }}\nwalls.top = {{ pressure_Pa = 0 }}"
            );
            let result = sketch.run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
            assert!(result.record.energy_balance_rel.abs() < 1e-9, "{}", result.record.energy_balance_rel);
            result
        };
        let still = closures(&run(0.0))[0];
        let dry = closures(&row(2, false, 0.1).with("front = \"cell\"").run(kind))[0];
        // Steps beside water are other ones; a gap is read to a hundredth of its day.
        assert!((still / dry - 1.0).abs() < 0.01, "{}: {still} {dry}", kind.name);
        // 0.9 m a day through the ground.
        assert_eq!(run(4e3).gaps[0].closure_s, None, "{}", kind.name);
    }
}

#[test]
fn rows_that_cannot_stand_are_refused() {
    let message = |pipes: &str| {
        let mut sketch = row(2, false, 0.1);
        sketch.pipes = vec![format!("{pipes}\npipe_radius_m = 0.05\ntemperature_c = -20")];
        match Scene::read(sketch.text("pd").as_str(), "own", "own.toml", &[], methods()) {
            Ok(_) => String::new(),
            Err(problems) => problems.to_string(),
        }
    };
    assert_eq!(message("places_m = [[0.5, 1], [1.5, 2]]"), "");
    for (pipes, words) in [
        ("count = 4\nring_radius_m = 0.5", "a circle of pipes needs the domain \"ring\""),
        ("count = 1\nfrom_m = [0.5, 1]\nto_m = [1.5, 1]", "pipes.1.count: found 1, must be an integer between 2 and"),
        ("count = 3\nfrom_m = [0.5, 1]", "pipes.1.to_m: missing"),
        ("count = 3\nfrom_m = [0.5, 1]\nto_m = [1.98, 1]", "pipes.1.to_m: pipe 1.3 must lie inside the rectangle"),
        ("count = 30\nfrom_m = [0.5, 1]\nto_m = [1.5, 1]", "overlap"),
        (
            "count = 3\nfrom_m = [0.5, 1]\nto_m = [1.5, 1]\nring_radius_m = 1",
            "ring_radius_m: has no effect, the ends of a row are given",
        ),
        ("places_m = [[0.5, 1], [0.52, 1]]", "overlap"),
    ] {
        let found = message(pipes);
        assert!(found.contains(words), "{pipes}: {found}");
    }
}
