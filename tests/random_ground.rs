//! Ground that varies at random in place: against what is known of it in one dimension, and what holds in any.

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::random_field::{Covariance, RandomField, Variation};
use frazil_record::Outcome;
use glam::DVec2;

use crate::sketch::{Sketch, advance, even, soil, steady_material, through, without_noise};

/// The factor of a smooth field, which spacings of a hundredth of a metre resolve.
fn smooth() -> Variation {
    Variation { log_deviation: 0.8, lengths: DVec2::splat(0.25), covariance: Covariance::Gaussian, seed: 5 }
}

/// The same as a scene says it.
const SMOOTH: &str = "{ log_deviation = 0.8, correlation_length_m = 0.25, covariance = \"gaussian\", seed = 5 }";

/// What a line of one metre conducts in series, by the factor along it.
fn in_series() -> f64 {
    const PIECES: usize = 20_000;
    let field = RandomField::new(&smooth());
    let place = |k: usize| DVec2::new((k as f64 + 0.5) / PIECES as f64, 0.0);
    PIECES as f64 / (0..PIECES).map(|k| 1.0 / field.at(place(k))).sum::<f64>()
}

/// A line of one metre between two temperatures, or two heads, whose conductivity varies.
fn line(of_water: bool, spacing_m: f64) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, spacing_m);
    sketch.random = format!("conductivity = {SMOOTH}");
    sketch.outputs = 100;
    if of_water {
        (sketch.of_water, sketch.initial_c, sketch.duration_s) = (true, 2.0, 1e6);
        sketch.materials = vec![("soil", soil())];
        return sketch.wall("left", "head_m = 3").wall("right", "head_m = 2").with("tolerance = 1e-6");
    }
    (sketch.initial_c, sketch.duration_s) = (0.0, 5e7);
    sketch.materials = vec![("steady", steady_material())];
    sketch.wall("left", "temperature_c = 10").wall("right", "temperature_c = 0").with("integrator = \"implicit\"")
}

/// What enters on the left at rest, over what even ground lets in: 20 W, or 1e-6 m3/s.
fn at_rest(sketch: &Sketch, kind: &'static frazil_scene::method::MethodKind, even: f64) -> f64 {
    let result = sketch.run(kind);
    assert_eq!(result.record.outcome, Outcome::Ok);
    let entered = through(&result, "left");
    let [before, last] = entered[entered.len() - 2..] else { unreachable!("100 outputs") };
    (last - before) / (sketch.duration_s / sketch.outputs as f64) / even
}

/// A steady flux meets what the places along it conduct in series, whatever flows: to a tenth of the square of the spacing over the
/// correlation length.
#[test]
fn a_line_conducts_the_harmonic_mean_of_its_factors() {
    let exact = in_series();
    for kind in even() {
        for (of_water, even) in [(false, 20.0), (true, 1e-6)] {
            // Errors of methods that reach far change their sign between these spacings.
            for spacing_m in [0.05, 0.025, 0.0125] {
                let error = at_rest(&line(of_water, spacing_m), kind, even) / exact - 1.0;
                eprintln!("{}, water {of_water}, {spacing_m} m: {error:.1e}", kind.name);
                assert!(error.abs() < 0.1 * (spacing_m / 0.25_f64).powi(2), "{} {spacing_m}: {error:e}", kind.name);
            }
        }
    }
}

/// A film before the ground and a flux through it see the same ground: the flux is the wall's, and the film is in series with it.
#[test]
fn films_and_fluxes_enter_ground_that_varies() {
    let exact = in_series();
    for kind in even() {
        let film = line(false, 0.01).wall("left", "coefficient_W_per_m2_K = 5\nambient_c = 10");
        let known = 10.0 / (1.0 / 5.0 + 0.5 / exact);
        let found = at_rest(&film, kind, known);
        eprintln!("{}: behind a film the flux is off by {:.1e}", kind.name, found - 1.0);
        assert!((found - 1.0).abs() < 5e-3, "{}: {found}", kind.name);
        let flux = line(false, 0.01).wall("left", "flux_W_per_m2 = 7");
        let found = at_rest(&flux, kind, 7.0);
        eprintln!("{}: a flux is off by {:.1e}", kind.name, found - 1.0);
        assert!((found - 1.0).abs() < 1e-9, "{}: {found}", kind.name);
    }
}

/// Groundwater through a permeability that varies: the same mean in series.
#[test]
fn groundwater_passes_the_harmonic_mean_of_its_factors() {
    let exact = in_series();
    for kind in even() {
        let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.01)
            .wall("left", "temperature_c = 5")
            .wall("right", "temperature_c = 5")
            .with("permeability_mean = \"harmonic\"");
        sketch.materials = vec![(
            "sand",
            "{ density_kg_per_m3 = 2090, frozen = { conductivity_W_per_m_K = 2, heat_capacity_J_per_kg_K = 1000 }, \
             unfrozen = { conductivity_W_per_m_K = 2, heat_capacity_J_per_kg_K = 1000 }, \
             freezing = { law = \"none\", temperature_c = 0 }, \
             groundwater = { porosity = 0.36, density_kg_per_m3 = 1000, heat_capacity_J_per_kg_K = 4190, \
             permeability_m2 = 1e-11 } }"
                .into(),
        )];
        sketch.initial_c = 5.0;
        sketch.random = format!("conductivity = {SMOOTH}\npermeability = {SMOOTH}");
        sketch.flow =
            "viscosity_Pa_s = 1e-3\nwalls.left = { pressure_Pa = 100 }\nwalls.right = { pressure_Pa = 0 }".into();
        let plan = sketch.plan(kind);
        let (_, velocity) = plan.method.water_fields().expect("water flows");
        let middle = velocity[50].x / (1e-11 / 1e-3 * 100.0);
        assert!((middle / exact - 1.0).abs() < 1e-2, "{}: {middle}, not {exact}", kind.name);
    }
}

/// A freezing rectangle in ground that varies by a factor of ten and more, rough at all scales.
fn rough() -> Sketch {
    let mut sketch = Sketch::new(Domain::Rectangle { width: 1.2, height: 0.8 }, 0.04)
        .wall("left", "temperature_c = -9")
        .wall("top", "coefficient_W_per_m2_K = 20\nambient_c = -5");
    sketch.random = "conductivity = { log_deviation = 1.2, correlation_length_m = [0.3, 0.1], seed = 3 }".into();
    (sketch.duration_s, sketch.outputs) = (2e5, 4);
    sketch
}

/// No step leaves the range of the data, and heat is what went in, under every method and integrator.
#[test]
fn heat_stays_within_the_data_and_is_conserved() {
    for kind in methods() {
        for numerics in ["", "mean = \"harmonic\"", "integrator = \"rkl2\"", "integrator = \"implicit\""] {
            if kind.stochastic && numerics.contains("integrator") {
                continue;
            }
            let mut sketch = rough().with(numerics).with(without_noise(kind));
            sketch.cracks = vec!["from_m = [0.5, 0.3]\nto_m = [0.9, 0.5]\nstart_s = 1e5".into()];
            let record = sketch.run(kind).record;
            assert_eq!(record.outcome, Outcome::Ok, "{} {numerics}: {:?}", kind.name, record.cause);
            assert!(record.energy_balance_rel.abs() < 1e-10, "{}: {:e}", kind.name, record.energy_balance_rel);
        }
        // The bound itself keeps the range.
        let mut plan = rough().with(without_noise(kind)).plan(kind);
        for _ in 0..20 {
            advance(&mut plan, 10);
            for i in 0..plan.particles.len() {
                let temperature = plan.particles.temperature(i);
                assert!((-9.0 - 1e-9..=3.0 + 1e-9).contains(&temperature), "{}: {temperature}", kind.name);
            }
        }
    }
}

/// Curved walls and pipes keep the range too: a disc with pipes, freezing from its rim.
#[test]
fn discs_and_pipes_stay_within_the_data() {
    for kind in even() {
        let mut sketch = Sketch::new(Domain::Ring { outer_radius: 4.0, sector: Sector::Half }, 0.2)
            .wall("outer", "temperature_c = -9");
        sketch.pipes = vec!["count = 8\nring_radius_m = 2.5\npipe_radius_m = 0.06\ntemperature_c = -20".into()];
        sketch.random = "conductivity = { log_deviation = 1.2, correlation_length_m = 0.8, seed = 3 }".into();
        let mut plan = sketch.plan(kind);
        for _ in 0..20 {
            advance(&mut plan, 20);
            // What a pipe's heat is spread over may be colder than the pipe.
            let under: Vec<u32> =
                plan.pipes.iter().flat_map(|pipe| pipe.extent.particles(&plan.particles.lattice)).collect();
            for i in (0..plan.particles.len()).filter(|i| !under.contains(&(*i as u32))) {
                let temperature = plan.particles.temperature(i);
                assert!((-20.0 - 1e-9..=3.0 + 1e-9).contains(&temperature), "{}: {temperature}", kind.name);
            }
        }
    }
}

#[test]
fn the_ground_is_the_same_on_any_number_of_threads() {
    for kind in methods() {
        let mut sketch = rough();
        sketch.spacing_m = 0.01;
        let hash = |threads: usize| {
            let mut plan = sketch.plan_with(kind, threads, 1);
            advance(&mut plan, 3);
            plan.particles.state_hash()
        };
        let one = hash(1);
        assert!([2, 3].into_iter().all(|threads| hash(threads) == one), "{}", kind.name);
    }
}

/// The factor of a place knows neither spacing nor layout nor method.
#[test]
fn the_ground_is_a_function_of_place() {
    let field = RandomField::new(&smooth());
    for kind in even() {
        for numerics in ["", "layout = \"random\""] {
            if kind.lattice_only && !numerics.is_empty() {
                continue;
            }
            let mut sketch = rough().with(numerics);
            sketch.random = format!("conductivity = {SMOOTH}");
            let particles = sketch.plan(kind).particles;
            particles.visit(|i, place| assert_eq!(particles.factors[i], field.at(place)));
        }
    }
}

/// Where particles are too far apart to see how the ground varies, that is said.
#[test]
fn correlation_lengths_below_two_spacings_are_told() {
    for kind in even() {
        for (length, told) in [(0.079, true), (0.081, false)] {
            let mut sketch = rough();
            sketch.random = format!("conductivity = {{ log_deviation = 1, correlation_length_m = [0.5, {length}] }}");
            let said = sketch.plan(kind).summary.differences.iter().any(|line| line.contains("do not resolve"));
            assert_eq!(said, told, "{} {length}", kind.name);
        }
    }
}

/// Ground that hardly varies is even ground, to what rounding makes of that.
#[test]
fn hardly_any_variation_changes_hardly_anything() {
    for kind in methods() {
        let state = |random: &str| {
            let mut sketch = rough().with("search = \"tree\"").with(without_noise(kind));
            sketch.random = random.to_owned();
            let mut plan = sketch.plan(kind);
            advance(&mut plan, 50);
            plan.particles.enthalpy
        };
        let even = state("");
        let varied = state("conductivity = { log_deviation = 1e-14, correlation_length_m = 0.3 }");
        let most = even.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
        for (a, b) in even.iter().zip(&varied) {
            assert!((a - b).abs() < 1e-10 * most, "{}: {a} {b}", kind.name);
        }
    }
}
