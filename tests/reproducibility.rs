//! The same answer again: for any number of threads, for a rerun, and for noise that depends on its seed alone and
//! adds nothing on average.

use frazil::registry::methods;
use frazil_core::solvers::step::Clock;
use frazil_core::space::domain::Domain;
use frazil_core::statistics;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::Options;

use crate::sketch::{Sketch, advance, steady_material};

/// A freezing rectangle of 180 x 400 = 72 000 particles: more than four bands of 16 384 on the lattice, and more than
/// thirty tasks of 2048 on a list.
fn large() -> Sketch {
    let mut sketch = Sketch::new(Domain::Rectangle { width: 1.8, height: 4.0 }, 0.01)
        .wall("left", "temperature_c = -10")
        .wall("top", "coefficient_W_per_m2_K = 20\nambient_c = -15");
    sketch.initial_c = 0.5;
    sketch.duration_s = 1e7;
    sketch
}

fn hash_after(sketch: &Sketch, kind: &'static MethodKind, threads: usize, seed: u64, steps: u64) -> String {
    let mut plan = sketch.plan_with(kind, threads, seed);
    advance(&mut plan, steps);
    plan.particles.state_hash()
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    for kind in methods() {
        for numerics in [
            "",
            "search = \"tree\"",
            "mean = \"harmonic\"",
            "integrator = \"rkl2\"\nstages = 4",
            "front = \"sub-cell\"",
        ] {
            if kind.stochastic && (numerics.contains("rkl2") || numerics.contains("sub-cell")) {
                continue;
            }
            let sketch = large().with(numerics);
            let one = hash_after(&sketch, kind, 1, 1, 4);
            for threads in [1, 2, 3, 4] {
                let again = hash_after(&sketch, kind, threads, 1, 4);
                assert_eq!(again, one, "{} with {threads} threads {numerics}", kind.name);
            }
        }
    }
}

#[test]
fn a_rerun_leaves_the_same_record() {
    for kind in methods() {
        let mut sketch =
            Sketch::new(Domain::Rectangle { width: 0.8, height: 0.6 }, 0.05).wall("left", "temperature_c = -10");
        sketch.duration_s = 2e5;
        sketch.outputs = 4;
        let run = |threads: usize| sketch.run_with(kind, &Options { threads, seed: 7, ..Options::default() });
        let first = run(1);
        for threads in [1, 3] {
            let again = run(threads);
            assert_eq!(again.record.state_hash, first.record.state_hash, "{}", kind.name);
            assert_eq!((&again.front, &again.profiles), (&first.front, &first.profiles), "{}", kind.name);
            assert_eq!(again.budget, first.budget, "{}", kind.name);
        }
    }
}

#[test]
fn the_seed_matters_to_noise_and_to_placement_alone() {
    for kind in methods() {
        let sketch =
            Sketch::new(Domain::Rectangle { width: 0.8, height: 0.6 }, 0.1).wall("left", "temperature_c = -10");
        let same = |sketch: &Sketch| {
            let mut sketch = sketch.clone();
            sketch.duration_s = 1e7;
            hash_after(&sketch, kind, 1, 1, 5) == hash_after(&sketch, kind, 1, 2, 5)
        };
        assert_eq!(same(&sketch), !kind.stochastic, "{}", kind.name);
        if kind.stochastic {
            assert!(same(&sketch.clone().with("noise = false")), "{}", kind.name);
        }
        if !kind.lattice_only {
            assert!(!same(&sketch.with("layout = \"jittered\"\njitter_fraction = 0.2")), "{}", kind.name);
        }
    }
}

/// Heat capacity of one particle in units of the Boltzmann constant.
const CAPACITY_DPD: f64 = 1000.0;
/// Temperature of the body above absolute zero (K).
const ABSOLUTE: f64 = 300.0;

fn noisy(domain: Domain) -> Sketch {
    let mut sketch = Sketch::new(domain, 0.1).with(&format!("heat_capacity_dpd = {CAPACITY_DPD}"));
    sketch.materials = vec![("rock", steady_material())];
    sketch.initial_c = ABSOLUTE - 273.15;
    sketch.duration_s = 1e9;
    sketch
}

/// In equilibrium the temperature of one particle fluctuates with the variance T^2 / C_v (C_v in units of k_B).
///
/// Explicit steps of length h multiply a mode of rate a by 1 - a h and raise its variance by 1 / (1 - a h / 2): at a
/// hundredth of the bound by half a per cent. The longest wave of N particles decays in about (N / pi)^2 steps of the
/// bound, 26 in the line and 40 in the square: the line waits for it between two snapshots; in the square, where it
/// is one of 400 modes, the whole run does.
#[test]
fn temperatures_fluctuate_as_equilibrium_wants() {
    let line = (Domain::Line { length: 1.6 }, 2600, 200);
    let square = (Domain::Rectangle { width: 2.0, height: 2.0 }, 400, 40);
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        for (domain, between, snapshots) in [line, square] {
            let sketch = noisy(domain).with("step_fraction = 0.01");
            let mut plan = sketch.plan(kind);
            let particles = plan.particles.len() as f64;
            let mut index = 0;
            let mut snapshot = || {
                for _ in 0..between {
                    let clock = Clock { time: plan.step * index as f64, step: plan.step, index, turned: index == 0 };
                    plan.method.advance(&mut plan.particles, &clock).expect("a step");
                    index += 1;
                }
                let square = |i: usize| (plan.particles.temperature(i) - sketch.initial_c).powi(2);
                (0..plan.particles.len()).map(square).sum::<f64>() / particles
            };
            snapshot();
            let variances: Vec<f64> = (0..snapshots).map(|_| snapshot()).collect();
            let found = statistics::mean(&variances).expect("snapshots");
            let error = (found.variance / f64::from(snapshots)).sqrt();
            // The sum of all particles is kept, which takes one of as many degrees of freedom.
            let wanted = ABSOLUTE * ABSOLUTE / CAPACITY_DPD * (1.0 - 1.0 / particles);
            let name = format!("{} {domain:?}: variance {} +- {error}, must be {wanted}", kind.name, found.mean);
            eprintln!("{name}");
            assert!((found.mean - wanted).abs() < 4.0 * error, "{name}");
            let sum: f64 = plan.particles.enthalpy.iter().sum();
            let moved: f64 = plan.particles.enthalpy.iter().map(|enthalpy| enthalpy.abs()).sum();
            // Rounding of some 1e5 steps, each of which moves a tenth of `moved` (root of the step in decay times).
            assert!(sum.abs() < 1e-11 * moved, "{}: {sum:e} of {moved:e}", kind.name);
        }
    }
}

#[test]
fn noise_adds_nothing_on_average() {
    const SEEDS: u64 = 48;
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        let sketch =
            noisy(Domain::Line { length: 1.2 }).wall("left", "temperature_c = 7").wall("right", "temperature_c = 47");
        let profile = |seed: u64| {
            let mut plan = sketch.plan_with(kind, 1, seed);
            let count = plan.particles.len();
            // Steady state and fluctuations about it need (12 particles)^2 over a weight sum of some ten.
            advance(&mut plan, 1000);
            (0..count).map(|i| plan.particles.temperature(i)).collect::<Vec<_>>()
        };
        let profiles: Vec<Vec<f64>> = (1..=SEEDS).map(profile).collect();
        let mut total = Vec::new();
        for i in 0..12 {
            let wanted = 7.0 + 40.0 * (i as f64 + 0.5) / 12.0;
            let own: Vec<f64> = profiles.iter().map(|profile| profile[i] - wanted).collect();
            let mean = statistics::mean(&own).expect("seeds");
            let error = (mean.variance / SEEDS as f64).sqrt();
            assert!(mean.mean.abs() < 4.0 * error, "{} particle {i}: {} +- {error}", kind.name, mean.mean);
            total.push(mean.mean);
        }
        // Fluctuations of one particle are 9.5 K, so this could fail: the mean of all is known to 0.2 K or so.
        let mean = total.iter().sum::<f64>() / 12.0;
        let body: Vec<f64> = profiles.iter().map(|profile| profile.iter().sum::<f64>() / 12.0 - 27.0).collect();
        let spread = statistics::mean(&body).expect("seeds");
        let error = (spread.variance / SEEDS as f64).sqrt();
        eprintln!("{}: the body is {mean:.3} K off, {error:.3} K explained", kind.name);
        assert!(mean.abs() < 4.0 * error && error < 2.0, "{}: {mean} +- {error}", kind.name);
    }
}
