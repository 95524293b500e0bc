//! How fast errors fall with spacing and with step.

use frazil::registry::methods;
use frazil_core::bonds::stencil::Stencil;
use frazil_core::space::domain::Domain;
use frazil_core::statistics::order::observed_order;
use frazil_scene::method::MethodKind;
use frazil_simulation::plan;

use crate::references;
use crate::sketch::{Sketch, advance, steady_material, without_noise};

/// Spacings that halve, in metres. The front is 0.0875 m deep at the end; the window begins at 5.4 h, where it is more
/// than four of the coarsest spacings away from the wall, so that all levels are judged over the same instants.
const SPACINGS: [f64; 4] = [0.016, 0.008, 0.004, 0.002];

#[test]
fn fronts_converge_at_first_order_or_better() {
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let errors = SPACINGS.map(|spacing| {
            let key = format!("method.{}.spacing_m", kind.name);
            let front = format!("method.{}.front", kind.name);
            let set = [
                (key.as_str(), spacing.to_string()),
                (front.as_str(), "\"cell\"".to_owned()),
                ("watch.front_from_h", "5.4".to_owned()),
            ];
            let set: Vec<(&str, &str)> = set.iter().map(|(key, value)| (*key, value.as_str())).collect();
            references::errors("stefan-water", kind.name, &set).front_rms_rel.expect("a front")
        });
        let order = observed_order(&SPACINGS, &errors);
        eprintln!("fronts, {}: {errors:.6?}, {order:?}", kind.name);
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{}: {errors:?}", kind.name);
        // Fronts that move through particles are first order; 0.9 leaves room for their staircase.
        assert!(order.is_some_and(|order| order.order >= 0.9), "{}: {errors:?}", kind.name);
    }
}

/// With the front where the frozen fraction says, nothing is of first order any more: the staircase is gone.
#[test]
fn fronts_inside_particles_converge_at_second_order() {
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let spacings = [0.008, 0.004, 0.002];
        let errors = spacings.map(|spacing| {
            let (key, spacing) = (format!("method.{}.spacing_m", kind.name), spacing.to_string());
            references::errors("stefan-water", kind.name, &[(&key, &spacing)]).temperature_rms_rel.expect("profiles")
        });
        let order = observed_order(&spacings, &errors);
        eprintln!("fronts inside particles, {}: {errors:.6?}, {order:?}", kind.name);
        // Second order, less what three levels leave uncertain.
        assert!(order.is_some_and(|order| order.order >= 1.8), "{}: {errors:?}", kind.name);
    }
}

const LENGTH: f64 = 0.1;
/// Diffusivity of the material (m2/s).
const DIFFUSIVITY: f64 = 1e-6;
/// Heat capacity by volume (J/m3K).
const CAPACITY: f64 = 2e6;

/// An insulated body of constant properties at 0 degC, `parts` particles across.
fn insulated(domain: Domain, parts: usize) -> Sketch {
    let mut sketch = Sketch::new(domain, LENGTH / parts as f64);
    sketch.materials = vec![("rock", steady_material())];
    sketch.initial_c = 0.0;
    sketch.duration_s = 1e6;
    sketch
}

/// Amplitude of the cosine wave that a body holds after `time`, started at one, in `steps` steps (or as many as the
/// plan's own step needs).
fn amplitude(sketch: &Sketch, kind: &'static MethodKind, time: f64, steps: Option<u64>) -> f64 {
    let mut plan = sketch.plan(kind);
    let wave: Vec<f64> = (0..plan.particles.len())
        .map(|i| {
            let place = plan.particles.position(i) * (std::f64::consts::PI / LENGTH);
            place.x.cos() * if plan.particles.lattice.dimension == 2 { place.y.cos() } else { 1.0 }
        })
        .collect();
    for (enthalpy, wave) in plan.particles.enthalpy.iter_mut().zip(&wave) {
        *enthalpy = CAPACITY * wave;
    }
    let steps = steps.unwrap_or((time / plan.step).ceil() as u64);
    plan.step = time / steps as f64;
    advance(&mut plan, steps);
    // The wave is a mode of every lattice between mirrors: what is left of it is its own projection.
    let projection = |values: &[f64]| values.iter().zip(&wave).map(|(a, b)| a * b).sum::<f64>();
    projection(&plan.particles.enthalpy) / CAPACITY / projection(&wave)
}

#[test]
fn smooth_conduction_is_of_second_order_in_space() {
    for kind in methods() {
        for (domain, levels) in [
            (Domain::Line { length: LENGTH }, [16, 32, 64]),
            (Domain::Rectangle { width: LENGTH, height: LENGTH }, [10, 20, 40]),
        ] {
            let dimension = domain.dimension() as f64;
            let time = 0.05 * LENGTH * LENGTH / DIFFUSIVITY;
            let rate = dimension * DIFFUSIVITY * (std::f64::consts::PI / LENGTH).powi(2);
            let errors = levels.map(|parts| {
                // A twentieth of the bound: the error of the steps is a few per cent of that of the spacing, and
                // falls with its square as well.
                let sketch = insulated(domain, parts).with(without_noise(kind)).with("step_fraction = 0.05");
                amplitude(&sketch, kind, time, None) - (-rate * time).exp()
            });
            let spacings = levels.map(|parts| LENGTH / parts as f64);
            let order = observed_order(&spacings, &errors);
            eprintln!("smooth, {} {dimension}D: {errors:?}, {order:?}", kind.name);
            // Terms of fourth order bend the line: (pi dx / L)^2 of ten particles is 0.1, of sixteen 0.04.
            let order = order.unwrap_or_else(|| unreachable!("{}: {errors:?}", kind.name)).order;
            assert!((order - 2.0).abs() < 0.1, "{} {dimension}D: order {order}, {errors:?}", kind.name);
        }
    }
}

#[test]
fn stabilised_and_implicit_steps_are_of_second_order_in_time() {
    const PARTS: usize = 32;
    // A tolerance of one takes every step as it comes.
    let integrators = [
        ("integrator = \"rkl2\"\nstages = 8", 12.0),
        ("integrator = \"rkl2\"\ntolerance = 1", 12.0),
        ("integrator = \"implicit\"\ntolerance = 1", 60.0),
    ];
    let kinds = || methods().iter().filter(|kind| !kind.stochastic);
    for (kind, (integrator, bounds)) in kinds().flat_map(|kind| integrators.map(|integrator| (kind, integrator))) {
        for (domain, dimension) in
            [(Domain::Line { length: LENGTH }, 1), (Domain::Rectangle { width: LENGTH, height: LENGTH }, 2)]
        {
            let sketch = insulated(domain, PARTS).with(integrator);
            let scene = sketch.scene(kind);
            let stencil = scene.methods[0].stencil(sketch.spacing_m, dimension);
            // The rate at which this lattice lets the wave decay, so that only the error of the steps is left.
            let phase = std::f64::consts::PI / PARTS as f64;
            let rate: f64 = stencil
                .offsets()
                .map(|(column, row, weight)| {
                    let wave = (phase * column as f64).cos() * (phase * row as f64).cos();
                    DIFFUSIVITY * Stencil::multiplicity(column, row) as f64 * weight * (1.0 - wave)
                })
                .sum();
            let bound = insulated(domain, PARTS).plan(kind).bound.step;
            let time = bounds * bound;
            let steps = [12, 24, 48];
            let errors = steps.map(|steps| amplitude(&sketch, kind, time, Some(steps)) - (-rate * time).exp());
            let order = observed_order(&steps.map(|steps| time / steps as f64), &errors);
            eprintln!("{integrator}, {} {dimension}D: {errors:?}, {order:?}", kind.name);
            let order = order.unwrap_or_else(|| unreachable!("{}: {errors:?}", kind.name)).order;
            // Terms of third order bend the line by the decay of the wave in one step, at most a fifth.
            assert!((order - 2.0).abs() < 0.1, "{} {dimension}D: order {order}, {errors:?}", kind.name);
        }
    }
}

#[test]
fn rkl2_finds_the_front_of_euler() {
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let front =
            |set: &[(&str, &str)]| references::errors("stefan-water", kind.name, set).front_rms_rel.expect("a front");
        let key = |name: &str| format!("method.{}.{name}", kind.name);
        // Of the fronts in the middle of cells, whose error is that of the spacing.
        let at = key("front");
        let cell = (at.as_str(), "\"cell\"");
        let euler = front(&[cell]);
        let rkl2 = front(&[cell, (&key("integrator"), "\"rkl2\""), (&key("stages"), "15")]);
        eprintln!("rkl2 and euler, {}: {rkl2:.6} and {euler:.6}", kind.name);
        assert!((rkl2 - euler).abs() < 0.1 * euler, "{}: {rkl2} and {euler}", kind.name);
    }
}

#[test]
fn a_step_above_the_bound_is_refused_with_its_cause() {
    for kind in methods() {
        for search in ["auto", "tree"] {
            let sketch = |step: f64| {
                Sketch::new(Domain::Rectangle { width: 0.8, height: 0.6 }, 0.1)
                    .with(&format!("search = \"{search}\""))
                    .with(&format!("step_s = {step}"))
                    .wall("left", "temperature_c = -10")
            };
            let mut allowed = sketch(1.0);
            allowed.duration_s = 1e7;
            let bound = allowed.plan(kind).bound;
            let plan = |step: f64| {
                let mut sketch = sketch(step);
                sketch.duration_s = 1e7;
                let scene = sketch.scene(kind);
                plan::build(&scene, &scene.methods[0], None, 1, 1).map(|plan| plan.step)
            };
            assert_eq!(plan(bound.step), Ok(bound.step), "{}", kind.name);
            let refused = plan(bound.step * 1.001).expect_err("a step that is too long").to_string();
            let number = format!("the stable bound of {:.6} s", bound.step);
            assert!(refused.contains(&number) && refused.contains(&bound.cause), "{}: {refused}", kind.name);
            assert!(bound.cause.contains("particle"), "{}: {}", kind.name, bound.cause);
        }
    }
}
