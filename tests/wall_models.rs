//! Walls as mirrors, as naive layers behind them and as inner layers: what must hold for each kind of condition, method and
//! body, and what differs.

use frazil_core::space::domain::Domain;
use frazil_core::space::symmetry::Symmetry;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{self, Options};
use frazil_simulation::plan;
use frazil_simulation::reduce::{self, Finding};

use crate::sketch::{Sketch, advance, rates, sand, water};

const MODELS: [&str; 3] = ["mirror", "naive", "inner-layers"];
const BODIES: [Domain; 6] = [
    Domain::Line { length: 0.4 },
    Domain::Rectangle { width: 0.4, height: 0.32 },
    Domain::Radial { symmetry: Symmetry::Axial, inner: 0.1, outer: 0.5 },
    Domain::Radial { symmetry: Symmetry::Spherical, inner: 0.0, outer: 0.4 },
    Domain::Axial { inner: 0.1, outer: 0.5, height: 0.32 },
    Domain::Axial { inner: 0.0, outer: 0.4, height: 0.32 },
];
const PLAIN: &str = "{ density_kg_per_m3 = 1, \
    frozen = { conductivity_W_per_m_K = 1, heat_capacity_J_per_kg_K = 1 }, \
    unfrozen = { conductivity_W_per_m_K = 1, heat_capacity_J_per_kg_K = 1 }, \
    freezing = { law = \"none\", temperature_c = 0 } }";

fn kinds() -> impl Iterator<Item = &'static MethodKind> {
    frazil::registry::methods().iter().copied().filter(|kind| !kind.stochastic)
}

/// Names of the walls of a body and their areas.
fn walls(domain: Domain) -> Vec<(&'static str, f64)> {
    match domain {
        Domain::Line { .. } => vec![("left", 1.0), ("right", 1.0)],
        Domain::Rectangle { width, height } => {
            vec![("left", height), ("right", height), ("bottom", width), ("top", width)]
        }
        Domain::Radial { symmetry, inner, outer } => {
            let both = [("inner", symmetry.area(inner)), ("outer", symmetry.area(outer))];
            both.into_iter().filter(|wall| wall.1 > 0.0).collect()
        }
        Domain::Axial { inner, outer, height } => {
            let round = |r: f64| Symmetry::Axial.area(r) * height;
            let flat = Symmetry::Axial.volume(inner, outer);
            let all = [("inner", round(inner)), ("outer", round(outer)), ("bottom", flat), ("top", flat)];
            all.into_iter().filter(|wall| wall.1 > 0.0).collect()
        }
        Domain::Ring { .. } => Vec::new(),
    }
}

/// The settings of a method that choose how pairs exchange and are counted.
fn settings(kind: &MethodKind, domain: Domain) -> Vec<&'static str> {
    let mut found = vec!["", "mean = \"harmonic\""];
    if kind.name != "local" {
        found.push("setting = \"paper\"\nscheme = \"enthalpy\"");
        if domain.symmetry().is_none() {
            found.push("layout = \"jittered\"\njitter_fraction = 0.3");
        }
    }
    found
}

/// A plain body at zero degrees with a model of its walls.
fn plain(domain: Domain, model: &str) -> Sketch {
    let mut sketch = Sketch::new(domain, 0.02).with(&format!("wall_model = \"{model}\""));
    sketch.materials = vec![("plain", PLAIN.to_owned())];
    sketch.initial_c = 0.0;
    sketch
}

/// A wall with the temperature of a body at rest, or surroundings of that temperature, changes nothing.
#[test]
fn a_body_at_rest_stays_so() {
    for kind in kinds() {
        for (domain, model) in BODIES.into_iter().flat_map(|body| MODELS.map(|model| (body, model))) {
            for numerics in settings(kind, domain) {
                let lines = ["temperature_c = 3", "coefficient_W_per_m2_K = 7\nambient_c = 3", "flux_W_per_m2 = 0"];
                for turn in 0..lines.len() {
                    let mut sketch = plain(domain, model).with(numerics);
                    for (k, (wall, _)) in walls(domain).into_iter().enumerate() {
                        sketch = sketch.wall(wall, lines[(k + turn) % lines.len()]);
                    }
                    let rates = rates(&mut sketch.plan(kind), |_, _| 3.0);
                    let largest = rates.into_iter().map(f64::abs).fold(0.0, f64::max);
                    // Rates of 3 over a step are 3e4; rounding of values and of the film's inverse.
                    assert!(largest < 1e-9, "{} {model} {numerics} {domain:?}: {largest:e}", kind.name);
                }
            }
        }
    }
}

/// A flux brings just its heat, whatever the state of the body: to rounding in naive and inner layers, and in mirrors, whose
/// images are of single particles.
#[test]
fn a_flux_brings_its_heat() {
    for kind in kinds() {
        for (domain, model) in BODIES.into_iter().flat_map(|body| MODELS.map(|model| (body, model))) {
            for numerics in settings(kind, domain) {
                // Mirrors bring what the weights carry of a slope, which under printed constants and off the lattice is not
                // all of it.
                if model == "mirror" && (numerics.contains("paper") || numerics.contains("jittered")) {
                    continue;
                }
                let mut sketch = plain(domain, model).with(numerics);
                let mut heat = 0.0;
                for (k, (wall, area)) in walls(domain).into_iter().enumerate() {
                    let flux = [5.0, -2.0, 3.0, 4.0][k];
                    sketch = sketch.wall(wall, format!("flux_W_per_m2 = {flux}"));
                    heat += flux * area;
                }
                let mut plan = sketch.plan(kind);
                let rates = rates(&mut plan, |x, y| 40.0 * (9.0 * x + 7.0 * y).sin());
                let found = plan.particles.integral(|i| rates[i]);
                assert!(
                    (found / heat - 1.0).abs() < 1e-9,
                    "{} {model} {numerics} {domain:?}: {found} {heat}",
                    kind.name
                );
            }
        }
    }
}

/// No particle falls because another, or a wall, is warmer; and none takes the sum of weights below zero in a step.
#[test]
fn rates_rise_with_every_other_particle() {
    for kind in kinds() {
        for (domain, model) in BODIES.into_iter().flat_map(|body| ["naive", "inner-layers"].map(|model| (body, model)))
        {
            for numerics in ["", "setting = \"paper\"\nscheme = \"enthalpy\""] {
                if kind.name == "local" && !numerics.is_empty() {
                    continue;
                }
                let lines = ["temperature_c = 0", "coefficient_W_per_m2_K = 7\nambient_c = 0", "flux_W_per_m2 = 0"];
                for turn in 0..lines.len() {
                    let mut sketch = plain(domain, model).with(numerics).with("step_fraction = 1");
                    sketch.spacing_m = 0.04;
                    for (k, (wall, _)) in walls(domain).into_iter().enumerate() {
                        sketch = sketch.wall(wall, lines[(k + turn) % lines.len()]);
                    }
                    // Where pairs reach farther than the body is wide inside its layers, none is left free.
                    let scene = sketch.scene(kind);
                    let Ok(mut plan) = plan::build(&scene, &scene.methods[0], None, 1, 1) else { continue };
                    let count = plan.particles.len();
                    for pulse in 0..count {
                        plan.particles.enthalpy.fill(0.0);
                        plan.particles.enthalpy[pulse] = 1.0;
                        advance(&mut plan, 1);
                        let least = plan.particles.enthalpy.iter().copied().fold(f64::INFINITY, f64::min);
                        assert!(least >= -1e-14, "{} {model} {numerics} {domain:?} {pulse}: {least:e}", kind.name);
                    }
                }
            }
        }
    }
}

/// Heat that walls book is heat that is stored, the range of the data is kept, and threads do not matter, with walls that
/// change, phases and two materials, under every integrator.
#[test]
fn heat_is_booked_and_the_range_kept() {
    for kind in kinds() {
        for (domain, model) in BODIES.into_iter().flat_map(|body| MODELS.map(|model| (body, model))) {
            for numerics in ["", "integrator = \"implicit\"", "mean = \"harmonic\"", "scheme = \"flags\""] {
                let mut sketch = Sketch::new(domain, 0.02).with(&format!("wall_model = \"{model}\"")).with(numerics);
                sketch.duration_s = 40_000.0;
                sketch.outputs = 4;
                let lines = [
                    "coefficient_W_per_m2_K = 40\nambient_c = -30",
                    "temperature_c = { times_h = [0, 3], values = [3, 20] }",
                    "temperature_c = -5",
                ];
                for (k, (wall, _)) in walls(domain).into_iter().enumerate() {
                    sketch = sketch.wall(wall, lines[k % lines.len()]);
                }
                let run = sketch.run(kind);
                let what = format!("{} {model} {numerics} {domain:?}: {:?}", kind.name, run.record);
                assert!(run.record.energy_balance_rel.abs() < 1e-12, "{what}");
                assert!(run.record.bounds_violation_rel.is_some_and(|beyond| beyond <= 1e-9), "{what}");
                let threads = sketch.run_with(kind, &Options { threads: 3, ..Options::default() });
                assert_eq!(run.record.state_hash, threads.record.state_hash, "{what}");
            }
        }
    }
}

/// Two materials side by side: layers of each follow particles of their own kind.
#[test]
fn layers_of_two_materials_keep_heat_and_range() {
    for kind in kinds() {
        for model in MODELS {
            let law = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 50000";
            let mut sketch = Sketch::new(BODIES[1], 0.02).with(&format!("wall_model = \"{model}\""));
            sketch.materials = vec![("water", water(law)), ("sand", sand(law))];
            sketch.regions = vec!["material = \"sand\"\ny_min_m = 0.1\ny_max_m = 0.2".into()];
            sketch.regions[0].push_str("\nx_min_m = 0\nx_max_m = 0.4");
            sketch.duration_s = 40_000.0;
            sketch =
                sketch.wall("left", "coefficient_W_per_m2_K = 40\nambient_c = -30").wall("right", "temperature_c = -2");
            let record = sketch.run(kind).record;
            assert!(record.energy_balance_rel.abs() < 1e-12, "{} {model}: {record:?}", kind.name);
            assert!(
                record.bounds_violation_rel.is_some_and(|beyond| beyond <= 1e-9),
                "{} {model}: {record:?}",
                kind.name
            );
        }
    }
}

/// In the steady state heat enters at one wall, leaves at the other, and passes every surface in between, wherever the wall's
/// layers are.
#[test]
fn steady_heat_passes_every_surface() {
    for kind in kinds() {
        for model in MODELS {
            let mut sketch = plain(BODIES[2], model).with("integrator = \"implicit\"\ntolerance = 1e-3");
            sketch.watch = [0.11, 0.15, 0.3, 0.49].map(|r| format!("[[watch.surfaces]]\nr_m = {r}\n")).concat();
            sketch.duration_s = 10.0;
            let sketch = sketch.wall("inner", "flux_W_per_m2 = 5").wall("outer", "temperature_c = 0");
            let run = sketch.run(kind);
            let wanted = 5.0 * Symmetry::Axial.area(0.1);
            let last: Vec<f64> = run.surfaces.iter().rev().take(4).map(|row| row.heat_w).collect();
            for (k, heat) in last.iter().enumerate() {
                // Inside inner layers heat is still being handed out: only beyond them it has all come.
                let inside = model == "inner-layers" && (k == 3 || k == 2);
                assert!(inside || (heat / wanted - 1.0).abs() < 1e-6, "{} {model}: {last:?} {wanted}", kind.name);
            }
        }
    }
}

/// Layers shift a wall of known temperature: naive ones into the body's outside, inner ones into the body; both by a length
/// that shrinks with the spacing, so errors fall with its first power.
#[test]
fn layers_err_by_the_first_power_of_the_spacing() {
    let scene = |kind: &'static MethodKind, model: &str, finer: usize| {
        let mut sketch = plain(BODIES[0], model).with("integrator = \"implicit\"\ntolerance = 1e-6");
        sketch.spacing_m = 0.02 / finer as f64;
        sketch.duration_s = 3.0;
        let sketch =
            sketch.wall("left", "temperature_c = 1").wall("right", "coefficient_W_per_m2_K = 4\nambient_c = -1");
        let rows = sketch.run(kind).profiles;
        let first = (finer - 1) / 2;
        rows.iter().skip(first).step_by(finer).map(|row| row.temperature_c).collect::<Vec<f64>>()
    };
    for kind in kinds() {
        // In the steady state the profile is straight: 1 at the left wall, its slope s by 4 (-1 - T) = s at the right.
        let slope = -2.0 / (0.4 + 0.25);
        let error = |model: &str, finer: usize| {
            let values = scene(kind, model, finer);
            let middle = values.len() / 2;
            values[middle] - (1.0 + slope * (middle as f64 + 0.5) * 0.02)
        };
        assert!(error("mirror", 1).abs() < 1e-5, "{}", kind.name);
        for model in ["naive", "inner-layers"] {
            let (coarse, fine) = (error(model, 1), error(model, 3));
            let order = (coarse / fine).ln() / 3f64.ln();
            assert!((order - 1.0).abs() < 0.15, "{} {model}: {coarse} {fine} order {order}", kind.name);
            assert!(coarse.abs() > 1e-3, "{} {model}: {coarse}", kind.name);
        }
    }
}

#[test]
fn what_cannot_be_is_refused_with_the_reason() {
    let pd = kinds().find(|kind| kind.name == "pd").expect("pd");
    let refused = |sketch: &Sketch| {
        let scene = sketch.scene(pd);
        plan::build(&scene, &scene.methods[0], None, 1, 1).err().map(|refused| refused.to_string()).unwrap_or_default()
    };
    let mut thin = plain(Domain::Line { length: 0.12 }, "inner-layers").wall("left", "temperature_c = 1");
    assert_eq!(refused(&thin), "");
    thin = thin.wall("right", "temperature_c = 1");
    assert_eq!(
        refused(&thin),
        "wall_model = \"inner-layers\" holds the 3 outermost layers at each wall, which leaves no particle free"
    );
    let pipe = Domain::Radial { symmetry: Symmetry::Axial, inner: 0.05, outer: 0.45 };
    assert_eq!(
        refused(&plain(pipe, "naive").wall("inner", "temperature_c = 1")),
        "the layers of wall_model = \"naive\" behind the wall \"inner\" reach across the axis, to r = -0.010000 m: pairs \
         must reach at most the inner radius"
    );
    for (model, word) in [("inner-layers", "inner layers"), ("naive", "naive layers")] {
        let film = "coefficient_W_per_m2_K = 4\nambient_c = -1";
        let scene = plain(BODIES[0], model).wall("left", film).wall("right", film).scene(pd);
        let finding = reduce::find(&scene, "pd", None);
        assert!(matches!(&finding, Ok(Finding::Kept(reason)) if reason.contains(word)), "{finding:?}");
        assert!(march::run(&scene, "pd", None, &Options::default()).is_ok());
    }
}
