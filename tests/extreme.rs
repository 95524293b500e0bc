//! The scenes that drive physics and numerics to their edges, under every method that can represent them.

use frazil::registry::methods;
use frazil_cases::scenes;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, RunResult};
use frazil_scene::method::MethodKind;
use frazil_scene::{Arrangement, Scene, Units};
use frazil_simulation::march::{self, Options};
use frazil_simulation::plan;

use crate::sketch::{Sketch, advance, even};

/// Keys of a method's section with their values.
type Keys = &'static [(&'static str, &'static str)];

/// The integrators that every scene runs under: a name, and keys of the method's section with their values.
const INTEGRATORS: &[(&str, Keys)] = &[
    ("explicit Euler", &[("integrator", "euler")]),
    ("rkl2", &[("integrator", "\"rkl2\"")]),
    ("implicit", &[("integrator", "\"implicit\"")]),
];

/// What the balance may miss of the heat exchanged. It is rounding alone: sums over particles lose some 1e-14. A lattice that is
/// all but steady would repeat the same rounding in each of a million steps (1.6e-11 in stefan-number-1e-3 under `local`) if
/// contents were not summed with what it loses.
const BALANCE: f64 = 1e-12;

/// How far temperatures may leave the data, over their range. A monotone step cannot leave them at all but by the
/// rounding of enthalpies, which holds up to a million times the range in scenes that the reader takes.
const BOUNDS: f64 = 1e-9;

/// The same where steps are stabilised: they are made again, shorter, where they leave the data by a thousandth.
const STABILISED_BOUNDS: f64 = 1e-3;

/// A bundled scene with keys of a method's section set.
fn read(name: &str, method: &str, keys: &[(&str, &str)]) -> Scene {
    let overrides: Vec<(String, String)> =
        keys.iter().map(|(key, value)| (format!("method.{method}.{key}"), (*value).to_owned())).collect();
    frazil::load::scene(name, &overrides).unwrap_or_else(|failure| unreachable!("{name}: {failure}"))
}

fn run_scene(scene: &Scene, method: &str) -> RunResult {
    let reference = frazil::run::reference(scene).unwrap_or_else(|failure| unreachable!("{failure}"));
    march::run(scene, method, reference.as_ref(), &Options::default())
        .unwrap_or_else(|refused| unreachable!("{} {method}: {refused}", scene.name))
}

/// Runs a scene under each deterministic method and integrator.
fn each_run(name: &str, mut judge: impl FnMut(&str, &Scene, &RunResult, Keys)) {
    let mut count = 0;
    for (integrator, keys) in INTEGRATORS {
        for kind in methods().iter().filter(|kind| !kind.stochastic) {
            let scene = frazil::load::scene(name, &[]).unwrap_or_else(|failure| unreachable!("{name}: {failure}"));
            if scene.method(kind.name).is_some() {
                let scene = read(name, kind.name, keys);
                let run = format!("{name}, {}, {integrator}", kind.name);
                judge(&run, &scene, &run_scene(&scene, kind.name), keys);
                count += 1;
            }
        }
    }
    assert!(count > 0, "{name} has no method");
}

/// What steps may miss beside what the spacing does, over the size of a number: as much as they were allowed.
fn by_steps(scene: &Scene, result: &RunResult) -> f64 {
    let settings = scene.method(&result.record.method).expect("a section");
    settings.numerics.integrator.tolerance().unwrap_or(0.0)
}

/// Every number that a run leaves.
fn numbers(result: &RunResult) -> Vec<f64> {
    let record = &result.record;
    let mut numbers = vec![record.energy_balance_rel, record.step_s, record.step_bound_s];
    numbers.extend(record.bounds_violation_rel);
    numbers.extend(result.front.iter().map(|row| row.front_m));
    numbers.extend(result.profiles.iter().flat_map(|row| [row.temperature_c, row.frozen_fraction]));
    numbers.extend(result.probes.iter().map(|row| row.temperature_c));
    numbers.extend(result.budget.iter().flat_map(|row| row.in_j.iter().copied().chain([row.stored_j])));
    numbers.extend(
        result.walls.iter().flat_map(|row| row.thickness_main_mean_m.into_iter().chain([row.heat_per_pipe_w_per_m])),
    );
    numbers
}

#[test]
fn every_extreme_scene_says_what_must_hold() {
    assert!(scenes::extreme().len() >= 22);
    for scene in scenes::extreme() {
        assert!(scene.text.starts_with("# ") && scene.text.contains("\n# What must hold: "), "{}", scene.name);
        assert!(scenes::all().iter().all(|other| other.name != scene.name), "{}", scene.name);
    }
}

#[test]
fn extreme_scenes_stay_whole_under_every_method() {
    for bundled in scenes::extreme() {
        for (integrator, keys) in INTEGRATORS {
            for kind in methods() {
                let scene = read(bundled.name, kind.name, &[]);
                // A stochastic method makes its own steps.
                if scene.method(kind.name).is_none() || (kind.stochastic && !keys.is_empty()) {
                    continue;
                }
                let scene = read(bundled.name, kind.name, keys);
                let result = run_scene(&scene, kind.name);
                let (record, name) = (&result.record, format!("{}, {}, {integrator}", scene.name, kind.name));
                assert_eq!(record.outcome, Outcome::Ok, "{name}: {:?}", record.cause);
                assert!(numbers(&result).iter().all(|number| number.is_finite()), "{name}: {:?}", numbers(&result));
                assert!(record.energy_balance_rel.abs() <= BALANCE, "{name}: {:e}", record.energy_balance_rel);
                if !kind.stochastic && !scene.has_flux() {
                    let violation = record.bounds_violation_rel;
                    let allowed = if *integrator == "rkl2" { STABILISED_BOUNDS } else { BOUNDS };
                    assert!(violation.is_some_and(|found| found <= allowed), "{name}: {violation:?}");
                }
                assert!(record.work.newton_median <= 8, "{name}: {:?}", record.work);
            }
        }
    }
}

/// A method without a section in a scene cannot represent it, and says why before the first step.
#[test]
fn methods_without_a_section_are_refused() {
    let mut refused = 0;
    for bundled in scenes::extreme() {
        let scene = read(bundled.name, "", &[]);
        let first = scene.methods.first().expect("a method");
        for kind in methods().iter().filter(|kind| scene.method(kind.name).is_none()) {
            let spacing = if scene.units == Units::Si { "spacing_m" } else { "spacing" };
            let mut keys = vec![(spacing, first.numerics.spacing.to_string())];
            match first.numerics.arrangement {
                Arrangement::Lattice => {}
                Arrangement::Random => keys.push(("layout", "random".into())),
                Arrangement::Jittered { fraction } => {
                    keys.extend([("layout", "jittered".into()), ("jitter_fraction", fraction.to_string())]);
                }
            }
            let overrides: Vec<(String, String)> =
                keys.into_iter().map(|(key, value)| (format!("method.{}.{key}", kind.name), value)).collect();
            let found = Scene::read(bundled, bundled.name, bundled.name, &overrides, methods());
            let reason = found.err().map(|problems| problems.to_string()).unwrap_or_default();
            assert!(
                reason.contains("must ") || reason.contains("cannot be combined with"),
                "{} could run under {}: {reason}",
                bundled.name,
                kind.name
            );
            refused += 1;
        }
    }
    assert!(refused > 0);
}

/// Fronts inside particles keep the range beside a wall too, where images of frozen particles would warm one that is not a
/// millionth as cold.
#[test]
fn fronts_inside_particles_keep_the_range_of_phases_apart() {
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let scene = read("properties-apart", kind.name, &[("front", "sub-cell")]);
        let record = run_scene(&scene, kind.name).record;
        let violation = record.bounds_violation_rel;
        assert!(violation.is_some_and(|found| found <= BOUNDS), "{}: {violation:?}", kind.name);
    }
}

/// Fronts follow the closed form to half a spacing, as far as a lattice can tell where a front is, and to what second order leaves: the
/// square of the spacing over the front.
#[test]
fn fronts_follow_the_closed_forms() {
    for name in
        ["stefan-number-1e-3", "stefan-number-1e-2", "stefan-number-10", "stefan-number-1e3", "at-the-freezing-point"]
    {
        each_run(name, |run, scene, result, _| {
            let spacing = scene.methods[0].numerics.spacing;
            let mut count = 0;
            for row in result.front.iter().filter(|row| scene.watch.front_from.is_none_or(|from| row.time_s >= from)) {
                let exact = row.front_ref_m.expect("a closed form");
                let second_order = (spacing / exact).powi(2).min(1.0);
                let allowed = 0.5 * spacing + (second_order + by_steps(scene, result)) * exact;
                assert!((row.front_m - exact).abs() <= allowed, "{run}: {} and {exact}", row.front_m);
                count += usize::from(exact > 4.0 * spacing);
            }
            assert!(count > 20, "{run}: the front came past four particles in {count} rows only");
        });
    }
}

/// An interval that is narrower than any temperature difference freezes as a sharp point does.
#[test]
fn a_microkelvin_is_sharp() {
    each_run("interval-of-a-microkelvin", |run, scene, result, keys| {
        let method = &result.record.method;
        // An interval knows no fronts inside particles.
        let mut sharp = vec![
            ("materials.water.freezing.law".to_owned(), "isothermal".to_owned()),
            (format!("method.{method}.front"), "cell".to_owned()),
        ];
        sharp.extend(keys.iter().map(|(key, value)| (format!("method.{method}.{key}"), (*value).to_owned())));
        let text = scenes::find("interval-of-a-microkelvin").expect("bundled").text.replace("width_K = 1e-6, ", "");
        let other = Scene::read(&text, "sharp", "sharp", &sharp, methods());
        let other = other.unwrap_or_else(|problems| unreachable!("{problems}"));
        let other = run_scene(&other, &result.record.method);
        let last = |result: &RunResult| result.front.last().map_or(0.0, |row| row.front_m);
        let (own, sharp) = (last(result), last(&other));
        // Potentials differ by a microkelvin of twenty kelvin; steps that end a freezing move it by no more than that.
        let allowed = 1e-5 + by_steps(scene, result);
        assert!(
            own > 4.0 * scene.methods[0].numerics.spacing && (own / sharp - 1.0).abs() < allowed,
            "{run}: {own} {sharp}"
        );
    });
}

#[test]
fn a_hundred_cycles_lose_no_heat_and_no_symmetry() {
    each_run("freeze-thaw-100", |run, scene, result, _| {
        let mut crossed = 0.0;
        let mut before = vec![0.0; result.budget_names.len()];
        for row in &result.budget {
            crossed += row.in_j.iter().zip(&before).map(|(now, before)| (now - before).abs()).sum::<f64>();
            before.clone_from(&row.in_j);
        }
        let last = result.budget.last().expect("an output");
        let net: f64 = last.in_j.iter().sum();
        assert!(crossed > 100.0 * last.stored_j.abs() && crossed > 1e8, "{run}: only {crossed} J crossed the walls");
        // What crosses is a sum of 1e5 steps, and so is what is stored: rounding of single steps is 1e-16 of it.
        assert!((net - last.stored_j).abs() <= 1e-12 * crossed, "{run}: {net} and {} of {crossed}", last.stored_j);
        let (low, high) = scene.temperature_range();
        let end: Vec<f64> =
            result.profiles.iter().filter(|row| row.time_s == scene.duration).map(|row| row.temperature_c).collect();
        assert!(end.len() > 10, "{run}");
        for (left, right) in end.iter().zip(end.iter().rev()) {
            // 1e5 steps that round differently on both sides: 1e5 eps is 2e-11 of the range.
            assert!((left - right).abs() <= 1e-10 * (high - low), "{run}: {left} and {right}");
        }
    });
}

#[test]
fn pipes_that_are_off_exchange_nothing() {
    each_run("pipes-by-the-hour", |run, _, result, _| {
        let pipes = result.budget_names.iter().position(|name| name == "pipes").expect("a ring");
        let mut before = 0.0;
        for (hour, row) in result.budget.iter().enumerate() {
            let taken = row.in_j[pipes] - before;
            before = row.in_j[pipes];
            assert!(if hour % 2 == 0 { taken < -1e3 } else { taken == 0.0 }, "{run}, hour {hour}: {taken} J");
        }
        assert_eq!(result.budget.len(), 48);
    });
}

#[test]
fn hot_pipes_thaw_the_ground() {
    each_run("hot-pipe", |run, _, result, _| {
        let heat = result.budget.last().expect("an output").in_j.iter().sum::<f64>();
        let thawed = result.profiles.iter().filter(|row| row.frozen_fraction == 0.0).count();
        assert!(heat > 1e5 && thawed > 0, "{run}: {heat} J came in, {thawed} points are thawed");
    });
}

#[test]
fn nothing_crosses_an_insulated_curve() {
    each_run("insulated-disc", |run, _, result, _| {
        let outer = result.budget_names.iter().position(|name| name == "outer").expect("the wall");
        assert!(result.budget.iter().all(|row| row.in_j[outer] == 0.0), "{run}");
        assert!(result.budget.last().is_some_and(|row| row.stored_j < -1e6), "{run}: the pipe took nothing");
    });
}

#[test]
fn one_particle_settles_between_its_walls() {
    each_run("one-particle", |run, scene, result, _| {
        let material = &scene.materials[0];
        // The mean of the walls' potentials, in the frozen phase.
        let potential = 0.5 * (-20.0 * material.frozen.conductivity + 5.0 * material.unfrozen.conductivity);
        let settled = potential / material.frozen.conductivity;
        let last = result.profiles.last().expect("a profile").temperature_c;
        let allowed = 1e-9 + by_steps(scene, result) * 25.0;
        assert!((last - settled).abs() < allowed, "{run}: {last}, must be {settled}");
    });
}

/// It exchanges nothing, so nothing limits its step but the run: no infinity stands in its record.
#[test]
fn a_particle_alone_is_limited_by_its_run() {
    for kind in even() {
        let record = Sketch::new(Domain::Axial { inner: 0.0, outer: 0.1, height: 0.1 }, 0.1).run(kind).record;
        assert_eq!((record.outcome, record.step_bound_s), (Outcome::Ok, 3600.0), "{}", kind.name);
    }
}

#[test]
fn particles_without_neighbours_keep_their_heat() {
    const STEPS: u64 = 200;
    let mut alone = 0;
    let scene = read("isolated-particles", "", &[]);
    let kinds = methods().iter().filter(|kind| scene.method(kind.name).is_some());
    for kind in kinds.collect::<Vec<&&'static MethodKind>>() {
        let settings = scene.method(kind.name).expect("a section");
        let mut plan = plan::build(&scene, settings, None, 1, 1).expect("a plan");
        let reach = settings.discretisation.weight.reach();
        let places: Vec<_> = (0..plan.particles.len()).map(|i| plan.particles.position(i)).collect();
        advance(&mut plan, STEPS);
        for (i, place) in places.iter().enumerate() {
            // An image behind a wall is twice as far as the wall.
            let to_wall = place.x.min(place.y).min(0.24 - place.x).min(0.24 - place.y);
            let far = |(j, other): (usize, &glam::DVec2)| i == j || (*other - *place).length() > reach;
            if to_wall > reach && places.iter().enumerate().all(far) {
                assert_eq!(plan.particles.enthalpy[i], 0.0, "{}: particle {i} at {place}", kind.name);
                alone += 1;
            }
        }
        assert!(plan.particles.enthalpy.iter().any(|enthalpy| *enthalpy < -1e4), "{}", kind.name);
    }
    assert!(alone > 0, "no particle is alone");
}

/// Largest and smallest properties make the same run in other units.
#[test]
fn properties_of_any_size_freeze_alike() {
    each_run("largest-properties", |run, scene, large, keys| {
        let method = &large.record.method;
        let small = run_scene(&read("smallest-properties", method, keys), method);
        let by_steps = by_steps(scene, large);
        assert_eq!(large.front.len(), small.front.len());
        for (large, small) in large.front.iter().zip(&small.front) {
            // Powers of ten are rounded, and their products again.
            let allowed = 1e-9 + by_steps * small.front_m;
            assert!((large.front_m - small.front_m).abs() < allowed, "{run}: {} {}", large.front_m, small.front_m);
        }
        assert!(large.front.last().is_some_and(|row| row.front_m > 0.3), "{run}");
    });
}
