//! Shafts that are dug inside a ring of pipes.

use std::f64::consts::TAU;
use std::sync::Mutex;

use frazil::registry::methods;
use frazil_core::particles::Particles;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_record::RunResult;
use frazil_simulation::march::Options;
use glam::DVec2;

use crate::sketch::{SHARP, Sketch, even, sand, steady_material, through};

const DAY: f64 = 86400.0;
const FILM: &str = "coefficient_W_per_m2_K = 20\nambient_c = -20";

/// A disc of radius 2 m in which a shaft of 0.75 m is there from the start.
fn dug_at_once(face: &str, sector: Sector, spacing_m: f64) -> Sketch {
    let mut sketch =
        Sketch::new(Domain::Ring { outer_radius: 2.0, sector }, spacing_m).wall("outer", "temperature_c = 10");
    sketch.initial_c = 10.0;
    sketch.excavation = format!("radius_m = 0.75\nstart_s = 0\n{face}");
    sketch
}

/// Six pipes on a circle of 1.5 m in sand, and a shaft of 1 m dug after 15 days, when the columns of ice reach into it.
fn ring(face: &str, sector: Sector) -> Sketch {
    let mut sketch = Sketch::new(Domain::Ring { outer_radius: 3.0, sector }, 0.1).wall("outer", "temperature_c = 10");
    sketch.initial_c = 10.0;
    sketch.materials = vec![("sand", sand(SHARP))];
    sketch.pipes = vec!["count = 6\nring_radius_m = 1.5\npipe_radius_m = 0.054\ntemperature_c = -20".into()];
    sketch.excavation =
        if face.is_empty() { String::new() } else { format!("radius_m = 1\nstart_s = 1296000\n{face}") };
    (sketch.duration_s, sketch.outputs) = (20.0 * DAY, 8);
    sketch
}

/// Heat that enters through the face at the end (W/m), for the part that was run.
fn rate(result: &RunResult) -> f64 {
    let heat = through(result, "shaft");
    let [.., before, last] = heat[..] else { unreachable!("two rows") };
    let [.., a, b] = &result.budget[..] else { unreachable!("two rows") };
    (last - before) / (b.time_s - a.time_s)
}

/// At rest film and ground are resistances in a row.
#[test]
fn a_face_passes_the_heat_of_a_cylinder() {
    for kind in even() {
        let face = [(FILM, 1.0 / (20.0 * 0.75)), ("temperature_c = -20", 0.0)];
        for (face, film) in face {
            let mut sketch =
                dug_at_once(face, Sector::Quarter, 0.05).with("integrator = \"implicit\"\ntolerance = 0.01");
            sketch.materials = vec![("ground", steady_material())];
            (sketch.duration_s, sketch.outputs) = (1.2e8, 20);
            let exact = TAU * 30.0 / ((2.0_f64 / 0.75).ln() / 2.0 + film);
            let found = -4.0 * rate(&sketch.run(kind));
            // Both walls are met to half a hundredth of the inner radius.
            assert!((found / exact - 1.0).abs() < 0.005, "{} {face}: {found} W/m, not {exact}", kind.name);
        }
    }
}

/// Freezing around a shaft that is there from the start is that of a body of shells.
#[test]
fn a_shaft_there_from_the_start_is_the_inner_wall_of_shells() {
    let with = |mut sketch: Sketch| {
        sketch.materials = vec![("sand", sand(SHARP))];
        (sketch.duration_s, sketch.outputs) = (10.0 * DAY, 10);
        sketch
    };
    let shells = Domain::Radial { symmetry: Symmetry::Axial, inner: 0.75, outer: 2.0 };
    let mut truth = Sketch::new(shells, 0.0125).wall("outer", "temperature_c = 10").wall("inner", FILM);
    truth.initial_c = 10.0;
    let local = methods().iter().copied().find(|kind| kind.name == "local").expect("local");
    let truth = with(truth).run(local);
    let exact = *through(&truth, "inner").last().expect("rows");
    for kind in even() {
        let error = |spacing: f64| {
            let result = with(dug_at_once(FILM, Sector::Quarter, spacing)).run(kind);
            let balance = result.record.energy_balance_rel;
            assert!(balance.abs() < 1e-9, "{}: {balance}", kind.name);
            (4.0 * *through(&result, "shaft").last().expect("rows") / exact - 1.0).abs()
        };
        let (coarse, fine) = (error(0.1), error(0.05));
        assert!(fine < 0.02 && fine < 0.7 * coarse, "{}: {coarse} at 0.1 m, {fine} at 0.05 m", kind.name);
    }
}

/// Until a shaft is dug, all is as without it.
#[test]
fn nothing_is_known_of_a_shaft_before_it_is_dug() {
    for kind in methods() {
        let run = |face: &str| ring(face, Sector::Quarter).with("search = \"tree\"\nstep_s = 600").run(kind);
        let (dug, whole) = (run("condition = \"symmetry\""), run(""));
        let until = |result: &RunResult, patch: &str| through(result, patch)[..6].to_vec();
        for patch in ["outer", "pipes"] {
            // Pairs that will be cut are summed apart from the others, which rounds differently.
            for (dug, whole) in until(&dug, patch).iter().zip(until(&whole, patch)) {
                assert!((dug - whole).abs() <= 1e-13 * whole.abs(), "{}: {patch} {dug} {whole}", kind.name);
            }
        }
        assert_eq!(until(&dug, "shaft"), [0.0; 6], "{}", kind.name);
        // What is dug out counts no more.
        assert_eq!(dug.walls[5].frozen_area_m2, whole.walls[5].frozen_area_m2, "{}", kind.name);
        assert!(dug.walls[6].frozen_area_m2 < whole.walls[6].frozen_area_m2, "{}", kind.name);
    }
}

/// No heat is lost, states stay in the range of the data whatever the steps, and the part of the plan does not matter.
#[test]
fn a_dug_shaft_keeps_heat_and_range_under_all_steps() {
    for kind in even() {
        for (face, low, high) in
            [("coefficient_W_per_m2_K = 10\nambient_c = 25", -20.0, 25.0), ("condition = \"symmetry\"", -20.0, 10.0)]
        {
            let taken = |sector: Sector, numerics: &str| {
                let range = Mutex::new((f64::INFINITY, f64::NEG_INFINITY));
                let see = |particles: &Particles, _: f64| {
                    let mut range = range.lock().expect("one thread");
                    // The particles that a pipe's heat is spread over may be colder than the pipe.
                    let pipes: Vec<DVec2> = (0..6).map(|k| 1.5 * DVec2::from_angle(TAU * k as f64 / 6.0)).collect();
                    for i in 0..particles.len() {
                        if pipes.iter().all(|pipe| particles.position(i).distance(*pipe) > 0.6) {
                            let value = particles.temperature(i);
                            *range = (range.0.min(value), range.1.max(value));
                        }
                    }
                };
                let options = Options { each_output: Some(&see), ..Options::default() };
                let result = ring(face, sector).with(numerics).run_with(kind, &options);
                let balance = result.record.energy_balance_rel;
                assert!(balance.abs() < 1e-9, "{} {face} {numerics}: {balance}", kind.name);
                let (least, most) = *range.lock().expect("one thread");
                let slack = if numerics.starts_with("step") { 1e-9 } else { 0.5 };
                assert!(
                    least >= low - slack && most <= high + slack,
                    "{} {face} {numerics}: {least} to {most}",
                    kind.name
                );
                let images = sector.images() as f64;
                ["pipes", "shaft"].map(|patch| images * *through(&result, patch).last().expect("rows"))
            };
            let euler = taken(Sector::Quarter, "step_s = 600");
            for (sector, numerics, allowed) in [
                (Sector::Whole, "step_s = 600", 1e-9),
                // Steps by error are allowed a thousandth each.
                (Sector::Quarter, "integrator = \"implicit\"", 0.01),
                (Sector::Quarter, "integrator = \"rkl2\"", 0.01),
            ] {
                let other = taken(sector, numerics);
                for (a, b) in euler.iter().zip(other) {
                    assert!(
                        (a - b).abs() <= allowed * euler[0].abs(),
                        "{} {face} {numerics}: {euler:?} {other:?}",
                        kind.name
                    );
                }
            }
        }
    }
}

/// Also where ground of two kinds freezes and some of it is dug out.
#[test]
fn frozen_fractions_of_all_particles_are_those_of_each() {
    let mut sketch = ring("condition = \"symmetry\"", Sector::Quarter);
    sketch.materials.push(("wet", sand(&SHARP.replace("52875.8", "105751.6"))));
    sketch.regions = vec!["material = \"wet\"\nx_min_m = 0.85\nx_max_m = 1.45\ny_min_m = 0\ny_max_m = 3".into()];
    // Fronts that are not where heat alone says, and cells that were dug out.
    let found = Mutex::new([0, 0]);
    let see = |particles: &Particles, _: f64| {
        let mut all = Vec::new();
        particles.front_fractions(&mut all);
        let mut found = found.lock().expect("one thread");
        for (i, fraction) in all.into_iter().enumerate() {
            assert_eq!(fraction, particles.front_fraction(i), "particle {i}");
            let is_other = fraction != particles.frozen_fraction(i);
            let are_found = [is_other, particles.is_gone(i)];
            found.iter_mut().zip(are_found).for_each(|(count, is_found)| *count += usize::from(is_found));
        }
    };
    let options = Options { each_output: Some(&see), ..Options::default() };
    let local = even().find(|kind| kind.name == "local").expect("a method");
    sketch.run_with(local, &options);
    assert!(found.into_inner().expect("one thread").iter().all(|count| *count > 100));
}
