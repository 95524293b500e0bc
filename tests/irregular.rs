//! Rows that a lattice's stencil does not know give the sweep what a list of all pairs gives.

use frazil_core::space::domain::{Domain, Sector};
use frazil_scene::method::MethodKind;

use crate::sketch::{Sketch, advance, even, sand, water};

const SHARP_WATER: &str = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 334000";
const WEIBULL_SAND: &str = "law = \"weibull\", temperature_c = 0, latent_heat_J_per_kg = 52875.8, width_K = 0.5";

/// A body of water and sand, in which all is in motion.
fn restless(domain: Domain, regions: &[&str]) -> Sketch {
    let spacing = if matches!(domain, Domain::Ring { .. }) { 0.15 } else { 0.025 };
    let mut sketch = Sketch::new(domain, spacing);
    sketch.duration_s = 1e8;
    sketch.materials = vec![("water", water(SHARP_WATER))];
    if !regions.is_empty() {
        sketch.materials.push(("sand", sand(WEIBULL_SAND)));
    }
    sketch.regions = regions.iter().map(|region| (*region).to_owned()).collect();
    let cold = match domain {
        Domain::Line { .. } => "x_min_m = 0\nx_max_m = 0.3",
        _ => "circle = { x_m = 0.4, y_m = 0.3, radius_m = 0.25 }",
    };
    sketch.regions.push(format!("temperature_c = -7\n{cold}"));
    sketch
}

fn walls(sketch: Sketch) -> Sketch {
    sketch
        .wall("left", "temperature_c = -20")
        .wall("right", "coefficient_W_per_m2_K = 20\nambient_c = -9")
        .wall("bottom", "flux_W_per_m2 = -40")
        .wall("top", "temperature_c = 2")
}

/// Bodies with interfaces, cracks and shafts inside, at walls and across them.
fn bodies() -> Vec<(&'static str, Sketch)> {
    let plate = Domain::Rectangle { width: 1.5, height: 1.25 };
    let quarter = Domain::Ring { outer_radius: 4.2, sector: Sector::Quarter };
    let inclusion = "material = \"sand\"\ncircle = { x_m = 0.74, y_m = 0.63, radius_m = 0.21 }";
    let layer = "material = \"sand\"\nx_min_m = 0\nx_max_m = 1.5\ny_min_m = 0.5\ny_max_m = 0.66";
    let crack = "from_m = [0.4, 0.3]\nto_m = [0.9, 0.41]";
    let growing = "from_m = [1.5, 0.9]\nto_m = [0.7, 0.72]\nspeed_m_per_s = 1e-5";
    let cracked = |mut sketch: Sketch, cracks: &[&str]| {
        sketch.cracks = cracks.iter().map(|crack| (*crack).to_owned()).collect();
        sketch
    };
    let piped = |mut sketch: Sketch| {
        let ring = "count = 8\nring_radius_m = 2.1\npipe_radius_m = 0.05\ntemperature_c = -20";
        sketch.pipes = vec![ring.to_owned()];
        sketch.wall("outer", "temperature_c = 1")
    };
    let dug = |mut sketch: Sketch| {
        sketch.excavation = "radius_m = 1.05\nstart_s = 40000\ncoefficient_W_per_m2_K = 20\nambient_c = 9".to_owned();
        sketch
    };
    let line = restless(Domain::Line { length: 2.0 }, &["material = \"sand\"\nx_min_m = 0.51\nx_max_m = 0.87"]);
    vec![
        ("an inclusion", walls(restless(plate, &[inclusion]))),
        ("a layer from wall to wall", walls(restless(plate, &[layer]))),
        ("layers on a line", line.wall("left", "temperature_c = -20")),
        (
            "a layer at the wall of a line",
            restless(Domain::Line { length: 2.0 }, &["material = \"sand\"\nx_min_m = 0\nx_max_m = 0.04"])
                .wall("left", "temperature_c = -20"),
        ),
        ("cracks", walls(cracked(restless(plate, &[]), &[crack, growing]))),
        ("cracks through an inclusion", walls(cracked(restless(plate, &[inclusion]), &[crack, growing]))),
        (
            "layers of a ring",
            piped(restless(
                quarter,
                &["material = \"sand\"\nx_min_m = 0\nx_max_m = 4.2\ny_min_m = 1.21\ny_max_m = 2.6"],
            )),
        ),
        ("a shaft", dug(piped(restless(quarter, &[])))),
        (
            "a shaft in layers",
            dug(piped(restless(
                quarter,
                &["material = \"sand\"\nx_min_m = 0\nx_max_m = 4.2\ny_min_m = 0.61\ny_max_m = 4.2"],
            ))),
        ),
        (
            "a shaft and a crack",
            cracked(dug(piped(restless(quarter, &[]))), &["from_m = [0.3, 0.2]\nto_m = [1.6, 1.1]"]),
        ),
    ]
}

/// Pairs that a sweep and a list share differ by rounding of their weights; over steps that reach sharp freezing points,
/// roundings of potentials do not grow, as steps keep the maximum principle.
fn difference(sketch: &Sketch, kind: &'static MethodKind, numerics: &str) -> (f64, f64) {
    const STEPS: u64 = 120;
    // A list knows no fronts inside particles.
    let sketch = sketch.clone().with(numerics).with("front = \"cell\"");
    let mut auto = sketch.plan(kind);
    let mut list = sketch.with("search = \"tree\"").plan(kind);
    assert!(auto.summary.used.iter().any(|used| used.contains("sweep")), "{:?}", auto.summary.used);
    assert!(list.summary.used.iter().all(|used| !used.contains("sweep")), "{:?}", list.summary.used);
    assert!((auto.bound.step / list.bound.step - 1.0).abs() < 0.3, "{} {}", auto.bound.step, list.bound.step);
    let implicit = numerics.contains("implicit");
    let longest = if implicit { 10.0 * auto.bound.step } else { auto.step };
    auto.step = longest.min(list.step);
    list.step = auto.step;
    let steps = if implicit { STEPS / 10 } else { STEPS };
    advance(&mut auto, steps);
    advance(&mut list, steps);
    let pairs = || auto.particles.enthalpy.iter().zip(&list.particles.enthalpy);
    let most = pairs().map(|(a, _)| a.abs()).fold(0.0, f64::max);
    let worst = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let heat = auto.method.ledger().heat().into_iter().zip(list.method.ledger().heat());
    let all = auto.method.ledger().heat().iter().map(|heat| heat.abs()).fold(0.0, f64::max);
    (worst / most, heat.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / all)
}

#[test]
fn a_sweep_with_irregular_rows_makes_the_steps_of_a_list() {
    for kind in even() {
        for (name, sketch) in bodies() {
            let (state, heat) = difference(&sketch, kind, "integrator = \"euler\"");
            // 120 steps of a few dozen roundings of 1e-16 each.
            assert!(state < 2e-12 && heat < 1e-11, "{name}, {}: state {state:e}, heat {heat:e}", kind.name);
        }
    }
}

#[test]
fn so_it_does_in_stages_and_implicit_steps() {
    for kind in even() {
        for (name, sketch) in bodies() {
            for numerics in ["integrator = \"rkl2\"\nstages = 5", "integrator = \"implicit\"\ntolerance = 1e-4"] {
                let (state, heat) = difference(&sketch, kind, numerics);
                let (most, through) = if numerics.contains("implicit") { (1e-6, 1e-5) } else { (2e-12, 1e-11) };
                assert!(state < most && heat < through, "{name}, {}, {numerics}: {state:e}, {heat:e}", kind.name);
            }
        }
    }
}
