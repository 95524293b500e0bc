//! Regions of any shape, with materials and starts of their own: heat is conserved, nothing leaves the range of the data,
//! mirrors are mirrors, and the threads do not matter.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::Outcome;
use frazil_scene::method::MethodKind;
use frazil_simulation::plan;

use crate::sketch::{Sketch, advance, sand, steady_material, water, without_noise};

const SHAPES: [&str; 4] = [
    "x_min_m = 0.13\nx_max_m = 0.52\ny_min_m = 0.08\ny_max_m = 0.33",
    "circle = { x_m = 0.44, y_m = 0.31, radius_m = 0.234 }",
    "polygon = { points_m = [[0.11, 0.07], [0.83, 0.21], [0.4, 0.55], [0.37, 0.24]] }",
    "ellipse = { x_m = 0.44, y_m = 0.33, half_axes_m = [0.3, 0.12], angle_deg = 25 }",
];
/// Their areas; the polygon by the shoelace formula.
const AREAS: [f64; 4] = [0.39 * 0.25, PI * 0.234 * 0.234, 0.114_75, PI * 0.3 * 0.12];
const BODY: Domain = Domain::Rectangle { width: 0.9, height: 0.7 };
const WEIBULL: &str = "law = \"weibull\", width_K = 0.5, latent_heat_J_per_kg = 50000, temperature_c = 0";

/// All ways to step a method: on the lattice and on a list, with each scheme and integrator.
fn numerics(kind: &MethodKind) -> Vec<&'static str> {
    let mut found = vec!["", "search = \"tree\"", "mean = \"harmonic\"", "scheme = \"flags\"\nmean = \"arithmetic\""];
    found.push("mean = \"harmonic\"\nmushy = false");
    if !kind.lattice_only {
        found.push("layout = \"jittered\"\njitter_fraction = 0.3");
    }
    if !kind.stochastic {
        found.extend(["integrator = \"rkl2\"", "integrator = \"rkl2\"\nstages = 5", "integrator = \"implicit\""]);
        found.push("integrator = \"implicit\"\nsearch = \"tree\"");
    }
    found
}

/// A body at 3 degC with one region that starts frozen.
fn sketch(kind: &MethodKind, shape: &str, numerics: &str) -> Sketch {
    let mut sketch = Sketch::new(BODY, 0.05).with(numerics).with(without_noise(kind));
    sketch.regions = vec![format!("temperature_c = -7\n{shape}")];
    sketch.duration_s = 2e5;
    sketch.outputs = 3;
    sketch
}

#[test]
fn particles_hold_the_heat_of_the_shape() {
    for kind in methods() {
        for (shape, area) in SHAPES.iter().zip(AREAS) {
            for spacing in [0.1, 0.05, 0.025] {
                let mut sketch = sketch(kind, shape, "");
                sketch.spacing_m = spacing;
                let particles = sketch.plan(kind).particles;
                let held = particles.integral(|i| particles.enthalpy[i]);
                let each = particles.materials.of(0).enthalpy(-7.0);
                // Shares below 1e-9 of some hundred cells count as none.
                assert!((held / (each * area) - 1.0).abs() < 1e-8, "{} {shape}: {}", kind.name, held / (each * area));
            }
        }
    }
}

#[test]
fn heat_is_conserved_and_stays_in_the_range() {
    for kind in methods() {
        for numerics in numerics(kind) {
            for (shape, law) in SHAPES.iter().zip(["isothermal", "weibull", "two", "two"]) {
                let mut sketch = sketch(kind, shape, numerics).wall("left", "temperature_c = -4");
                if law == "weibull" && !numerics.contains("flags") {
                    sketch.materials[0].1 = water(WEIBULL);
                }
                if law == "two" {
                    let sharp = "law = \"isothermal\", latent_heat_J_per_kg = 50000, temperature_c = -0.3";
                    sketch.materials.push(("sand", sand(sharp)));
                    sketch.regions[0] = format!("material = \"sand\"\n{}", sketch.regions[0]);
                }
                let record = sketch.run(kind).record;
                let name = format!("{} {numerics} {shape}", kind.name);
                assert_eq!(record.outcome, Outcome::Ok, "{name}: {:?}", record.cause);
                // Rounding of some thousand steps, and of enthalpies of 1e8 J/m3 under flags; measured below 1e-12.
                assert!(record.energy_balance_rel.abs() < 1e-10, "{name}: {}", record.energy_balance_rel);
                // The slack of integrators by error is 1e-3 of the range.
                let violation = record.bounds_violation_rel.expect("a range");
                let slack = if numerics.contains("rkl2") { 2e-3 } else { 1e-9 };
                assert!(violation < slack, "{name}: {violation}");
            }
        }
    }
}

/// An insulated body comes to the temperature of its mean heat.
#[test]
fn an_insulated_body_comes_to_its_mean() {
    for kind in methods() {
        for numerics in numerics(kind).into_iter().filter(|numerics| !numerics.contains("flags")) {
            let mut sketch = sketch(kind, SHAPES[1], numerics);
            sketch.materials[0].1 = steady_material();
            // Twenty times the slowest decay, of a cosine over 0.9 m.
            sketch.duration_s = 20.0 * (0.9f64 / PI).powi(2) / 1e-6;
            sketch.outputs = 1;
            sketch.watch = "probes_m = [[0.05, 0.05], [0.44, 0.31], [0.85, 0.6]]".to_owned();
            let particles = sketch.plan(kind).particles;
            let mean = 3.0 - 10.0 * AREAS[1] / (0.9 * 0.7);
            let held = particles.enthalpy.iter().sum::<f64>() / particles.len() as f64;
            let held = particles.materials.of(0).temperature(held);
            // Squares around moved particles do not tile the plane.
            let expected = if numerics.contains("jittered") { held } else { mean };
            assert!((held - expected).abs() < 1e-7 && (held - mean).abs() < 0.2, "{} {numerics}: {held}", kind.name);
            for probe in &sketch.run(kind).probes {
                let error = probe.temperature_c - expected;
                // exp(-20) of 10 K, and a tenth of the tolerance of steps by error.
                assert!(error.abs() < 1e-3, "{} {numerics}: {error}", kind.name);
            }
        }
    }
}

#[test]
fn a_mirrored_region_gives_the_mirrored_state() {
    let mirrored = [
        "x_min_m = 0.38\nx_max_m = 0.77\ny_min_m = 0.08\ny_max_m = 0.33",
        "circle = { x_m = 0.46, y_m = 0.31, radius_m = 0.234 }",
        "polygon = { points_m = [[0.79, 0.07], [0.07, 0.21], [0.5, 0.55], [0.53, 0.24]] }",
        "ellipse = { x_m = 0.46, y_m = 0.33, half_axes_m = [0.12, 0.3], angle_deg = 65 }",
    ];
    for kind in methods() {
        for numerics in ["", "search = \"tree\""] {
            for (shape, image) in SHAPES.iter().zip(mirrored) {
                let mut plans = [shape, &image].map(|shape| sketch(kind, shape, numerics).plan(kind));
                plans.iter_mut().for_each(|plan| advance(plan, 20));
                let [own, image] = plans.map(|plan| plan.particles.enthalpy);
                let scale = own.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
                for (k, h) in own.iter().enumerate() {
                    let (row, column) = (k / 18, k % 18);
                    let other = image[row * 18 + 17 - column];
                    // Rounding of shares (1e-15 of positions of 18 cells) and of twenty steps.
                    assert!((h - other).abs() < 1e-11 * scale, "{} {numerics} {shape}: {h} {other}", kind.name);
                }
            }
        }
    }
}

/// Nothing enters an ellipse that is impermeable.
#[test]
fn an_impermeable_ellipse_stays_as_it_starts() {
    for kind in methods() {
        let mut sketch = Sketch::new(BODY, 0.02).with(without_noise(kind)).wall("left", "temperature_c = -9");
        sketch.regions = vec![format!("impermeable = true\n{}", SHAPES[3])];
        (sketch.duration_s, sketch.outputs) = (5e4, 1);
        let scene = sketch.scene(kind);
        let mut plan = sketch.plan(kind);
        advance(&mut plan, 200);
        let inside = |i: &usize| scene.impermeable[0].contains(plan.particles.position(*i));
        let (within, outside): (Vec<usize>, Vec<usize>) = (0..plan.particles.len()).partition(inside);
        assert!(within.len() > 200 && within.iter().all(|i| plan.particles.enthalpy[*i] == 0.0), "{}", kind.name);
        assert!(outside.iter().any(|i| plan.particles.enthalpy[*i] != 0.0), "{}", kind.name);
    }
}

/// A body of which nothing is open has no state to be computed.
#[test]
fn a_body_that_is_closed_in_everywhere_is_refused() {
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let mut sketch = Sketch::new(BODY, 0.02).with(without_noise(kind));
        sketch.regions = vec!["impermeable = true\ncircle = { x_m = 0.2, y_m = 0.2, radius_m = 9 }".to_owned()];
        let scene = sketch.scene(kind);
        let refused = plan::build(&scene, &scene.methods[0], None, 1, 1).err().map(|refused| refused.to_string());
        let said = "impermeable parts cover every particle at a spacing of 0.02: leave a part of the body open, or set a \
                    smaller spacing";
        assert_eq!(refused.as_deref(), Some(said), "{}", kind.name);
    }
}

/// Phases of a part of the body in which no particle stands have no shares.
#[test]
fn phases_are_watched_where_particles_are() {
    for kind in methods() {
        for (between, said) in [("[0.4, 0.5]", None), ("[0.401, 0.409]", Some("0.401 and 0.409 at a spacing of 0.02"))]
        {
            let mut sketch = Sketch::new(BODY, 0.02).with(without_noise(kind));
            sketch.watch = format!("phases = true\nphases_between_m = {between}\n");
            let scene = sketch.scene(kind);
            let refused = plan::build(&scene, &scene.methods[0], None, 1, 1).err().map(|refused| refused.to_string());
            assert_eq!(refused.is_some(), said.is_some(), "{} {refused:?}", kind.name);
            assert!(said.is_none_or(|said| refused.is_some_and(|refused| refused.contains(said))), "{}", kind.name);
        }
    }
}

#[test]
fn threads_do_not_matter() {
    for kind in methods() {
        for numerics in numerics(kind) {
            let mut sketch = Sketch::new(Domain::Rectangle { width: 1.8, height: 2.0 }, 0.01).with(numerics);
            sketch.regions = vec!["temperature_c = -7\ncircle = { x_m = 0.8, y_m = 1.1, radius_m = 0.5 }".to_owned()];
            let state = |threads: usize| {
                let mut plan = sketch.plan_with(kind, threads, 1);
                plan.step = plan.step.min(plan.method.wanted_step());
                advance(&mut plan, 2);
                plan.particles.state_hash()
            };
            let one = state(1);
            for threads in [2, 3] {
                assert_eq!(state(threads), one, "{} {numerics}", kind.name);
            }
        }
    }
}

/// Two half spaces at different temperatures: `T = (a + b)/2 + (b - a)/2 erf(x / sqrt(4 D t))`.
#[test]
fn a_step_of_temperature_spreads_by_its_closed_form_wherever_it_falls() {
    for kind in methods() {
        let rms = |spacing: f64, share: f64| {
            let place = 1.0 + share * spacing;
            let mut sketch = Sketch::new(Domain::Line { length: 2.0 }, spacing).with(without_noise(kind));
            sketch.materials[0].1 = steady_material();
            sketch.initial_c = 10.0;
            sketch.regions = vec![format!("temperature_c = 0\nx_min_m = 0\nx_max_m = {place}")];
            sketch.duration_s = 0.01 / 1e-6;
            let result = sketch.run(kind);
            let errors = result.profiles.iter().map(|row| {
                let exact = 5.0 + 5.0 * erf((row.along_m - place) / 0.2);
                (row.temperature_c - exact).powi(2)
            });
            (errors.sum::<f64>() / result.profiles.len() as f64).sqrt()
        };
        for share in [0.0, 0.15, 0.5, 0.8] {
            let (coarse, fine) = (rms(0.01, share), rms(0.005, share));
            // Heat and its first moment are those of the step: errors are of second order wherever the edge cuts.
            let order = (coarse / fine).log2();
            assert!(order > 1.8, "{} {share}: {coarse} {fine}", kind.name);
            assert!(fine < 1e-3, "{} {share}: {fine}", kind.name);
        }
    }
}

/// The error function by its series, which converges everywhere and loses few digits up to 4.
fn erf(x: f64) -> f64 {
    if x.abs() > 4.0 {
        return x.signum();
    }
    let (mut term, mut sum) = (x, x);
    for k in 1..120 {
        let k = k as f64;
        term *= -x * x / k;
        sum += term / (2.0 * k + 1.0);
    }
    2.0 / PI.sqrt() * sum
}

#[test]
fn a_region_of_a_ring_is_felt_in_every_sector_alike() {
    for kind in methods() {
        let held = |sector: Sector| {
            let mut sketch = Sketch::new(Domain::Ring { outer_radius: 1.0, sector }, 0.05);
            sketch.regions = vec!["temperature_c = -7\ncircle = { x_m = 0, y_m = 0, radius_m = 0.52 }".to_owned()];
            let particles = sketch.plan(kind).particles;
            particles.integral(|i| particles.enthalpy[i]) / particles.materials.of(0).enthalpy(-7.0)
        };
        for (sector, parts) in [(Sector::Quarter, 4.0), (Sector::Half, 2.0), (Sector::Whole, 1.0)] {
            let area = held(sector) * parts;
            assert!((area / (PI * 0.52 * 0.52) - 1.0).abs() < 1e-8, "{} {sector:?}: {area}", kind.name);
        }
    }
}

#[test]
fn a_volume_that_centres_miss_is_told() {
    let kind = methods().iter().find(|kind| kind.name == "pd").expect("a method");
    let said = |shape: &str| {
        // Under a mean, as the papers have it, a particle is of one material.
        let mut sketch = Sketch::new(BODY, 0.05).with("mean = \"harmonic\"");
        sketch.materials.push(("sand", sand("law = \"none\", temperature_c = 0")));
        sketch.regions = vec![format!("material = \"sand\"\n{shape}")];
        let told = sketch.plan(kind).summary.differences.into_iter();
        told.filter(|line| line.contains("region") && !line.contains("thick")).collect::<Vec<_>>()
    };
    let box_of = |from: f64, to: f64| format!("x_min_m = {from}\nx_max_m = {to}\ny_min_m = {from}\ny_max_m = {to}");
    assert_eq!(said(&box_of(0.1, 0.4)), Vec::<String>::new());
    // 5 x 5 particles in place of 4.6 x 4.6: 25 / 21.16.
    let more = "the material of region 0 fills 18.1 % more than the region: particles belong to it by their centres";
    assert_eq!(said(&box_of(0.12, 0.35)), [more]);
    let none = "region 0 contains no particle centre: its material is not represented";
    assert_eq!(said(&box_of(0.13, 0.17)), [none]);
    // A start alone needs no centre.
    let mut warm = Sketch::new(BODY, 0.05);
    warm.regions = vec![format!("temperature_c = -7\n{}", box_of(0.13, 0.17))];
    assert!(!warm.plan(kind).summary.differences.iter().any(|line| line.contains("region")));
    // Edges through the centres of particles: as many as there is room for, whichever way positions round.
    assert_eq!(said(&box_of(0.125, 0.375)), Vec::<String>::new());
}

/// Between outputs of an insulated body nothing is stored; what particles exchange is what the balance is over.
#[test]
fn an_insulated_body_keeps_its_heat() {
    for kind in methods() {
        for numerics in numerics(kind) {
            let result = sketch(kind, SHAPES[0], numerics).run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{} {numerics}: {:?}", kind.name, result.record.cause);
            for row in &result.budget {
                // Rounding of enthalpies of 3e8 J/m3 in 252 particles over some thousand steps.
                assert!(row.stored_j.abs() < 1e-10 * 3e8 * 0.9 * 0.7, "{}: {row:?}", kind.name);
                assert!(row.balance_rel.abs() < 1e-9, "{} {numerics}: {row:?}", kind.name);
            }
        }
    }
}
