//! Scenes whose liquid particles move.

use frazil::registry;
use frazil_edpd::calibration::Constants;
use frazil_edpd::fluid::{Fluid, Parameters, Undriven};
use frazil_record::{Outcome, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};

use crate::counting::most;

fn scene(text: &str, overrides: &[(&str, &str)]) -> Scene {
    let overrides: Vec<(String, String)> =
        overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Scene::read(text, "test", "test.toml", &overrides, registry::methods())
        .unwrap_or_else(|problems| unreachable!("{problems}"))
}

fn run(scene: &Scene, threads: usize, seed: u64) -> RunResult {
    let reference = frazil_cases::truth(scene).ok().and_then(|truth| truth.reference).map(std::sync::Arc::from);
    let options = Options { threads, seed, ..Options::default() };
    march::run(scene, "edpd", reference.as_ref(), &options).unwrap_or_else(|refused| unreachable!("{refused}"))
}

fn bundled(name: &str) -> &'static str {
    frazil_cases::scenes::find(name).map_or("", |scene| scene.text)
}

const SHORT: [(&str, &str); 5] = [
    ("domain.rectangle.height", "40"),
    ("time.duration", "14"),
    ("time.profiles", "[14]"),
    ("watch.profile_length", "30"),
    ("method.edpd.motion", "true"),
];

#[test]
fn a_liquid_freezes_from_a_wall_and_keeps_its_energy() {
    let result = run(&scene(bundled("stefan-dpd-2"), &SHORT), 1, 1);
    assert_eq!(result.record.outcome, Outcome::Ok, "{:?}", result.record.cause);
    // Walls, motion and heat together, over 750 steps: rounding.
    assert!(result.record.energy_balance_rel.abs() < 1e-12, "{:e}", result.record.energy_balance_rel);
    let last = result.front.last().expect("a front");
    let error = last.front_m / last.front_ref_m.expect("a reference") - 1.0;
    // Six spacings of ice: four single seeds lie within 3 %; a particle more or less in a row of 24 is 0.7 %.

    assert!(error.abs() < 0.06, "{error}");
    // Nothing but noise leaves the range of the data: six standard deviations of a particle of 0.3 % of its temperature.
    let noise = 6.0 * 0.95 / 1e5f64.sqrt() / 0.1;
    assert!(result.record.bounds_violation_rel.expect("a range") < noise);
}

#[test]
fn threads_and_reruns_give_the_same_bits() {
    let scene = scene(
        bundled("solidification-square"),
        &[("time.duration", "0.4"), ("time.profiles", "[0.4]"), ("watch.front_from", "0.2")],
    );
    let hash = |threads, seed| run(&scene, threads, seed).record.state_hash;
    let one = hash(1, 1);
    for threads in [1, 2, 3, 4] {
        assert_eq!(hash(threads, 1), one, "{threads} threads");
    }
    assert_ne!(hash(1, 2), one);
}

const LIQUID: &str = r#"
title = "A liquid between walls"
source = "none"
units = "dpd"

[domain.rectangle]
width = 24
height = 10

[time]
duration = 24
outputs = 48

[materials.liquid]
density = 4
frozen = { conductivity = 1600000, heat_capacity = 1e5 }
unfrozen = { conductivity = 1600000, heat_capacity = 1e5 }
freezing = { law = "none", temperature = 0.5 }

[initial]
temperature = 1.1

[walls.left]
condition = "symmetry"

[walls.right]
condition = "symmetry"

[walls.bottom]
temperature = 1

[walls.top]
temperature = 1.2

[method.edpd]
spacing = 0.5
motion = true
"#;

#[test]
fn walls_let_heat_through_as_a_wall_at_their_temperature() {
    // Steps that are bound by motion, and by conduction, where particles exchange less well close to walls.
    for (conductivity, limit) in [(1.6e6, "oscillation"), (6.4e6, "conduction")] {
        let text = LIQUID.replace("1600000", &conductivity.to_string());
        let duration = 24.0 * 1.6e6 / conductivity;
        let result = run(&scene(&text, &[("time.duration", &duration.to_string())]), 1, 3);
        assert!(result.record.step_limit.contains(limit), "{}", result.record.step_limit);
        let index = |name| result.budget_names.iter().position(|known| known == name).expect("the wall");
        // The slowest part of the profile decays in a tenth of the time.
        let row = |time: f64| result.budget.iter().find(|row| row.time_s >= time - 1e-9).expect("a row");
        let passed = |wall| row(duration).in_j[index(wall)] - row(0.5 * duration).in_j[index(wall)];
        let rate = 0.5 * (passed("top") - passed("bottom")) / (0.5 * duration);
        // Conductivity times difference over height, by 24 lengths of wall: a jump of temperature at the walls of 0.1 lengths
        // would take 2 % from it; the liquid conducts 0.995 to 1.002 of the mean field; six seeds differ by 0.25 %.
        let expected = conductivity * 0.2 / 10.0 * 24.0;
        assert!((rate / expected - 1.0).abs() < 0.02, "{rate} {expected}");
        let row = result.profiles.first().expect("a profile");
        // Half a layer from the wall: the mean of 48 particles has a standard deviation of 0.0005; where conduction binds, those
        // within 0.35 lengths, which exchange less well, lag by 0.001 (mean of four seeds of a longer wall).
        assert!((row.temperature_c - 1.0 - 0.02 * row.along_m).abs() < 0.0025, "{row:?}");
    }
}

#[test]
fn walls_take_no_particle_beyond_their_temperatures() {
    let text = LIQUID.replace("temperature = 1.1", "temperature = 1").replace("temperature = 1.2", "temperature = 1");
    let text = text.replace("\n[walls.top]\n", "parts = [{ from = 12, to = 24, temperature = 2 }]\n\n[walls.top]\n");
    // Few neighbours, among which chance counts most.
    let few = [
        ("domain.rectangle.height", "6"),
        ("time.duration", "48"),
        ("method.edpd.cutoff_ratio", "2"),
        ("method.edpd.friction", "4.5"),
        ("method.edpd.exponent", "2"),
    ];
    // Steps that are bound by motion, and by conduction.
    for conductivity in ["5e5", "1600000"] {
        let result = run(&scene(&text.replace("1600000", conductivity), &few), 1, 1);
        // Six standard deviations of a particle at the warmer part: chance takes one of 577 particles beyond them in 2400 steps
        // once in some hundred runs, and data differ by 1.
        let noise = 6.0 * 2.0 / 1e5f64.sqrt();
        let found = result.record.bounds_violation_rel.expect("a range");
        assert!(found < noise, "{conductivity}: {found}");
    }
}

#[test]
fn a_driven_liquid_is_a_parabola_of_the_viscosity_of_theory() {
    let stream = "[stream]\nacceleration = 0.3\naverage_from = 6\n";
    let text = LIQUID.replace("[walls.left]", &format!("{stream}\n[walls.left]")).replace("1.2", "1");
    let text = text.replace("temperature = 1.1", "temperature = 1");
    let result = run(&scene(&text, &[]), 1, 5);
    let found = result.record.stream.expect("a stream");
    // Eq 12 of Ng et al. 2017 at s = 1.24: 6.9, by kinetic theory, which leaves out conservative forces: of the order of a tenth
    // (ten seeds would give it to 1 %).
    let s = 1.2153 + (1.0 - 298.15 / 300.0) / (15.0 / 300.0) * (1.5395 - 1.2153);
    let theory = Constants::paper().viscosity(s, 1.0);
    let viscosity = found.kinematic_viscosity_m2_per_s.expect("even");

    assert!((viscosity / theory - 1.0).abs() < 0.25, "{viscosity} {theory}");
    assert!(found.speed_rms_rel < 0.08, "{found:?}");
    assert!(found.wall_density_rel < 0.1, "{found:?}");
}

#[test]
fn what_motion_cannot_represent_is_refused() {
    let refused = |text: &str, overrides: &[(&str, &str)]| {
        let scene = scene(text, overrides);
        march::run(&scene, "edpd", None, &Options::default()).map(|_| String::new()).unwrap_or_else(|e| e.to_string())
    };
    let sand = refused(bundled("frozen-wall-sand"), &[("method.edpd.motion", "true")]);
    assert_eq!(sand, "motion = true needs the domain \"line\" or \"rectangle\"");
    let flux = refused(&LIQUID.replace("temperature = 1.2", "flux = 3"), &[]);
    assert!(flux.starts_with("the wall \"top\" has a flux, but with motion = true walls need"), "{flux}");
    let step = refused(LIQUID, &[("method.edpd.step", "0.1")]);
    assert!(step.starts_with("step_s = 0.1 is above the stable bound of 0.0"), "{step}");
    let small = refused(LIQUID, &[("domain.rectangle.width", "5")]);
    assert!(small.starts_with("a periodic box of length 5 is too small: it must be at least 6.762 long"), "{small}");
}

#[test]
fn a_step_takes_no_memory() {
    let mut fluid = Fluid::<2>::new(Parameters::water(), [24.0, 24.0], 1.0, 1, None).expect("a fluid");
    // Places have room.
    fluid.advance(200, &Undriven).expect("steps");
    let sortings = fluid.sortings;
    let (made, bytes) = most(|| fluid.advance(100, &Undriven));
    assert_eq!((made, bytes), (Ok(()), 0));
    assert!(fluid.sortings > sortings, "particles were sorted on the way");
}
