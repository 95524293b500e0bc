//! Solutions that a source of heat makes, and how fast errors from them fall.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::statistics::order::observed_order;
use frazil_record::Outcome;
use frazil_simulation::march::{self, Options};

use crate::references;
use crate::sketch::{bundled, even, through};

/// Errors of temperatures over spacings that halve.
fn errors<const N: usize>(scene: &str, method: &str, spacings: [f64; N], set: &[(&str, &str)]) -> [f64; N] {
    spacings.map(|spacing| {
        let (key, spacing) = (format!("method.{method}.spacing_m"), spacing.to_string());
        let set = [set, &[(key.as_str(), spacing.as_str())]].concat();
        references::errors(scene, method, &set).temperature_rms_rel.expect("profiles")
    })
}

/// Terms of fourth order bend the line as much as in `order::smooth_conduction_is_of_second_order_in_space`. Steps are by the bound, so
/// that their error falls with the square of the spacing too.
fn is_of_second_order(scene: &str, method: &str, spacings: [f64; 3], set: &[(&str, &str)]) {
    let errors = errors(scene, method, spacings, set);
    let order = observed_order(&spacings, &errors);
    eprintln!("{scene}, {method}: {errors:?}, {order:?}");
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{method}: {errors:?}");
    assert!(order.is_some_and(|order| (order.order - 2.0).abs() < 0.1), "{method}: {errors:?}");
}

#[test]
fn conduction_in_a_plane_is_of_second_order() {
    for kind in methods() {
        let noise = format!("method.{}.noise", kind.name);
        let set = [("time.duration_s", "1e5"), (noise.as_str(), "false")];
        let set = if kind.stochastic { &set[..] } else { &set[..1] };
        is_of_second_order("manufactured-conduction", kind.name, [0.05, 0.025, 0.0125], set);
    }
}

#[test]
fn conduction_along_a_freezing_curve_is_of_second_order() {
    for kind in even() {
        let integrator = format!("method.{}.integrator", kind.name);
        let set = [("time.duration_s", "2e6"), (integrator.as_str(), "euler")];
        is_of_second_order("manufactured-freezing", kind.name, [0.05, 0.025, 0.0125], &set);
    }
}

/// Weights of the continuum, on a lattice, conduct as much too well or too badly as their second moment is off: by 1 % for this kernel
/// (`lattice_moments_and_limits_are_the_known_ones`), however fine the lattice is.
#[test]
fn only_weights_scaled_by_the_moment_converge() {
    let error = |normalisation: &str, spacing: &str| {
        let set = [
            ("time.duration_s", "1e5"),
            ("method.sph.normalisation", normalisation),
            ("method.sph.spacing_m", spacing),
        ];
        references::errors("manufactured-conduction", "sph", &set).temperature_rms_rel.expect("profiles")
    };
    let [moment, continuum] = ["discrete-moment", "continuum"].map(|word| [error(word, "0.05"), error(word, "0.025")]);
    // With the square of the spacing, and not at all.
    assert!((moment[0] / moment[1] - 4.0).abs() < 0.3, "{moment:?}");
    assert!((continuum[0] / continuum[1] - 1.0).abs() < 0.1 && continuum[1] > 5.0 * moment[1], "{continuum:?}");
}

/// With another integrator the same solution comes out: its steps are much longer, and its sources are those of the times between.
#[test]
fn long_steps_take_the_source_at_its_times() {
    for kind in even() {
        let integrator = format!("method.{}.integrator", kind.name);
        let error = |set: &[(&str, &str)]| errors("manufactured-freezing", kind.name, [0.05], set)[0];
        let euler = error(&[("time.duration_s", "2e6"), (&integrator, "euler")]);
        for (word, tolerance) in [("rkl2", "0.001"), ("implicit", "0.0001")] {
            let key = format!("method.{}.tolerance", kind.name);
            let other = error(&[("time.duration_s", "2e6"), (&integrator, word), (&key, tolerance)]);
            // The error of the spacing is the same; that of long steps is less than half of it.
            assert!((other / euler - 1.0).abs() < 0.5, "{} {word}: {other} {euler}", kind.name);
        }
    }
}

/// A source that is a hundredth too strong makes another solution: errors stay where the spacing is halved.
#[test]
fn another_source_is_not_of_this_solution() {
    for kind in even() {
        let own = bundled("manufactured-conduction", &[]);
        let formula = match &own.regions[0].heat {
            Some(frazil_core::balances::heated::Power::Formula(formula)) => formula.text().to_owned(),
            other => unreachable!("{other:?}"),
        };
        let stronger = format!("{{ formula = \"1.01*({formula})\" }}");
        let set = [("time.duration_s", "3e5"), ("regions.1.heat_W_per_m3", stronger.as_str())];
        let errors = errors("manufactured-conduction", kind.name, [0.05, 0.025], &set);
        assert!(errors[1] > 0.5 * errors[0], "{}: {errors:?}", kind.name);
    }
}

/// What is released is the integral of the source: the sum over cells by their centres is a midpoint rule in place, and the sum over
/// steps one of rectangles in time.
#[test]
fn what_is_released_is_the_integral_of_the_source() {
    // Of `12 pi cos(2 pi t/P) + exp(-t/P) ((16 - 8 x (2 - x)) (1 + cos(pi y)/2) + ...)` over the unit square, in which cosines over y
    // vanish and x (2 - x) has the mean 2/3, and over time to P/4.
    let (end, period) = (2.5e5, 1e6);
    let exact = 12.0 * PI * period / (2.0 * PI) + (16.0 - 16.0 / 3.0) * period * (1.0 - (-0.25_f64).exp());
    for kind in even() {
        let released = [0.1, 0.05].map(|spacing: f64| {
            let key = format!("method.{}.spacing_m", kind.name);
            let spacing = spacing.to_string();
            let scene = bundled("manufactured-conduction", &[("time.duration_s", "2.5e5"), (&key, &spacing)]);
            let result = march::run(&scene, kind.name, None, &Options::default()).expect("a run");
            assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
            assert!(result.record.energy_balance_rel.abs() < 1e-9, "{}", kind.name);
            through(&result, "region_1").last().copied().expect("a row") / exact - 1.0
        });
        // The midpoint rule of x (2 - x): 8/12 of the square of the spacing, over 32/3. Rectangles: half a step of the change, which
        // falls by its third in the time; a step is at most the tenth of a diffusion time of a cell.
        let allowed = |spacing: f64| spacing * spacing * (8.0 / 12.0 / (32.0 / 3.0) + 0.5 * 1e6 / end);
        assert!(released[0].abs() < allowed(0.1) && released[1].abs() < allowed(0.05), "{}: {released:?}", kind.name);
    }
}
