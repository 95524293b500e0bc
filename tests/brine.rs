//! Pipes with a film between brine and ground.

use std::f64::consts::TAU;

use frazil_core::space::domain::{Domain, Sector};
use frazil_record::RunResult;

use crate::sketch::{SHARP, Sketch, even, sand, steady_material};

/// A ring of radius 1 m with a pipe in its middle.
fn one_pipe(coefficient: &str) -> Sketch {
    let mut sketch = Sketch::new(Domain::Ring { outer_radius: 1.0, sector: Sector::Quarter }, 0.05)
        .wall("outer", "temperature_c = 10");
    sketch.initial_c = 10.0;
    sketch.pipes =
        vec![format!("count = 1\nring_radius_m = 0\npipe_radius_m = 0.054\ntemperature_c = -20\n{coefficient}")];
    sketch
}

/// Heat that the pipe has taken, and what it takes at the end (W/m).
fn taken(result: &RunResult) -> (f64, f64) {
    let rows = &result.budget;
    let pipes = result.budget_names.iter().position(|name| name == "pipes").expect("pipes");
    let [.., before, last] = &rows[..] else { unreachable!("two rows") };
    let rate = (last.in_j[pipes] - before.in_j[pipes]) / (last.time_s - before.time_s);
    (-4.0 * last.in_j[pipes], -4.0 * rate)
}

/// At rest the ground, the film and the pipe's radius are resistances in a row.
#[test]
fn a_film_is_a_resistance_of_its_own() {
    for kind in even() {
        for (coefficient, film) in [("", 0.0), ("coefficient_W_per_m2_K = 20", 1.0 / (20.0 * 0.054))] {
            let mut sketch = one_pipe(coefficient).with("integrator = \"implicit\"\ntolerance = 0.01");
            sketch.materials = vec![("ground", steady_material())];
            // Thirty times R^2 over the diffusivity.
            (sketch.duration_s, sketch.outputs) = (3e7, 20);
            let (_, rate) = taken(&sketch.run(kind));
            let exact = TAU * 30.0 / ((1.0_f64 / 0.054).ln() / 2.0 + film);
            // The curved wall of twenty particles is met to half a hundredth of the radius, a tenth of which is in the logarithm.
            assert!((rate / exact - 1.0).abs() < 0.01, "{} {coefficient}: {rate} W/m, not {exact}", kind.name);
        }
    }
}

/// Between no film and a film that holds all heat back, on both operators and for explicit and implicit steps.
#[test]
fn weaker_films_take_less_heat_whatever_the_steps() {
    for kind in even() {
        let run = |coefficient: &str, numerics: &str| {
            let mut sketch = one_pipe(coefficient).with(numerics).with("front = \"cell\"");
            sketch.materials = vec![("sand", sand(SHARP))];
            (sketch.duration_s, sketch.outputs) = (3.0 * 86400.0, 10);
            let result = sketch.run(kind);
            let balance = result.record.energy_balance_rel;
            assert!(balance.abs() < 1e-9, "{} {coefficient} {numerics}: {balance}", kind.name);
            taken(&result).0
        };
        let film = |coefficient: f64| format!("coefficient_W_per_m2_K = {coefficient}");
        // Steps by error leave more than what parts the weakest film from none.
        let euler = "integrator = \"euler\"";
        let heats = [&film(1e-3), &film(10.0), &film(100.0), &film(1e7), ""].map(|of| run(of, euler));
        assert!(heats.is_sorted(), "{}: {heats:?} J/m", kind.name);
        assert!((heats[3] / heats[4] - 1.0).abs() < 1e-4, "{}: {heats:?} J/m", kind.name);
        assert!(heats[0] < 1e-3 * heats[4], "{}: {heats:?} J/m", kind.name);
        for numerics in
            ["search = \"tree\"", "integrator = \"implicit\"", "integrator = \"implicit\"\nsearch = \"tree\""]
        {
            let other = run(&film(10.0), numerics);
            // Steps by error are allowed a thousandth each.
            assert!((other / heats[1] - 1.0).abs() < 5e-3, "{} {numerics}: {other}, not {}", kind.name, heats[1]);
        }
    }
}
