//! Statistics of numbers whose answers are known.

use super::order::{cost_at_error, error_at_cost, observed_order};
use super::*;

#[test]
fn quartiles_of_small_samples() {
    assert_eq!(quartiles(&[4.0, 1.0, 3.0, 2.0, 5.0]), Some([2.0, 3.0, 4.0]));
    assert_eq!(quartiles(&[1.0, 2.0]), Some([1.25, 1.5, 1.75]));
    assert_eq!(median(&[]), None);
}

#[test]
fn the_interval_of_a_median_has_exact_coverage() {
    // Ranks and coverage from the binomial distribution.
    let rows = [(5, 1, 0.9375), (6, 1, 0.968_75), (9, 2, 0.960_937_5), (15, 4, 0.964_843_75), (1, 1, 0.0)];
    for (count, rank, coverage) in rows {
        let values: Vec<f64> = (1..=count).rev().map(f64::from).collect();
        let found = median_interval(&values).expect("members");
        assert!((found.coverage - coverage).abs() < 1e-12, "{count}: {found:?}");
        let expected = Interval { low: f64::from(rank), high: f64::from(count + 1 - rank) };
        assert_eq!(found.interval, expected, "{count}");
        assert_eq!(found.is_confident(), count >= 6);
    }
    // Many members: the normal approximation puts the ranks at n/2 -+ 0.98 sqrt(n).
    let values: Vec<f64> = (1..=10_000).map(f64::from).collect();
    let found = median_interval(&values).expect("members").interval;
    assert!((found.half_width() - 98.0).abs() < 2.0, "{found:?}");
}

#[test]
fn student_t_matches_printed_tables() {
    // Three decimals are printed; for one and two degrees there are closed forms.
    let rows = [(3.0, 3.182), (4.0, 2.776), (5.0, 2.571), (9.0, 2.262), (14.0, 2.145), (29.0, 2.045), (1e6, 1.960)];
    for (freedom, printed) in rows {
        let own = student_t(freedom).expect("enough freedom");
        assert!((own - printed).abs() < 6e-4, "{freedom}: {own}");
    }
    let cauchy = (std::f64::consts::PI * 0.475).tan();
    assert!((student_t(1.0).expect("one") / cauchy - 1.0).abs() < 1e-10);
    let two = 0.95 * (2.0 / (1.0 - 0.95_f64 * 0.95)).sqrt();
    assert!((student_t(2.0).expect("two") / two - 1.0).abs() < 1e-10);
    assert_eq!(student_t(0.0), None);
}

#[test]
fn the_mean_of_five_seeds() {
    let found = mean(&[1.0, 2.0, 3.0, 4.0, 5.0]).expect("seeds");
    assert_eq!((found.count, found.mean, found.variance), (5, 3.0, 2.5));
    // 2.776 sqrt(2.5/5).
    assert!((found.interval.expect("interval").half_width() - 1.963).abs() < 1e-3);
    assert_eq!(mean(&[1.0]).and_then(|found| found.interval), None);
    let widths = HalfWidths::up_to(5);
    let half = widths.of(2.5, 5).expect("five seeds");
    assert_eq!(found.interval, Some(Interval::around(3.0, half)));
    assert_eq!((widths.of(2.5, 1), widths.of(2.5, 6)), (None, None));
    let found = geometric_mean(&[1.0, 10.0, 100.0]).expect("positive");
    assert!((found.mean - 10.0).abs() < 1e-12);
    let ends = found.interval.expect("interval");
    assert!((ends.low * ends.high - 100.0).abs() < 1e-9, "symmetric in the logarithm");
    assert_eq!(geometric_mean(&[1.0, -1.0]), None);
}

#[test]
fn the_estimate_of_the_bias_has_no_bias_of_its_own() {
    // Every sample of three from a fair coin of +-1 around a bias of one half: the mean of the estimates over
    // all of them must be a quarter exactly, whatever the noise.
    let (bias, mut sum) = (0.5, 0.0);
    let mut naive = 0.0;
    for bits in 0..8_u32 {
        let runs: Vec<Vec<f64>> =
            (0..3).map(|run| vec![bias + if bits >> run & 1 == 1 { 1.0 } else { -1.0 }]).collect();
        let found = ensemble(&runs).expect("three runs");
        sum += found.bias_squared / 8.0;
        naive += found.mean_rms * found.mean_rms / 8.0;
    }
    assert!((sum - bias * bias).abs() < 1e-14, "{sum}");
    assert!(naive > 2.0 * bias * bias, "the square of the mean is too large: {naive}");
    assert_eq!(ensemble(&[vec![1.0]]), None);
    assert_eq!(ensemble(&[vec![1.0], vec![]]), None);
}

#[test]
fn runs_that_reach_a_target() {
    let found = Ensemble { count: 5, run_rms: 0.0, mean_rms: 0.0, variance: 4.0, bias_squared: 1.0 };
    assert_eq!(found.runs_for(2.0_f64.sqrt()).map(|runs| (runs * 1e9).round() / 1e9), Some(4.0));
    assert_eq!(found.runs_for(0.9), None);
    assert_eq!(found.bias(), Some(1.0));
    assert_eq!(Ensemble { bias_squared: -1.0, ..found }.bias(), None);
}

#[test]
fn welch_agrees_with_its_closed_form_for_equal_samples() {
    let (first, second) = ([1.0, 2.0, 3.0], [2.0, 3.0, 4.0]);
    let found = welch(&first, &second).expect("enough");
    assert!((found.freedom - 4.0).abs() < 1e-12 && (found.difference + 1.0).abs() < 1e-15);
    // 2.776 sqrt(2/3).
    assert!((found.interval.half_width() - 2.2669).abs() < 1e-3);
    assert!(!found.is_resolved());
    assert!(welch(&[1.0, 1.0], &[2.0, 2.0]).is_some_and(|found| found.is_resolved()));
    assert_eq!(welch(&[1.0], &second), None);
}

#[test]
fn few_failures_leave_much_open() {
    let found = |failures, trials| wilson(failures, trials).expect("trials").interval;
    // Without a failure the upper end is z^2 / (n + z^2).
    for (trials, upper) in [(5, 0.4345), (10, 0.2775), (20, 0.1611)] {
        let none = found(0, trials);
        assert!(none.low == 0.0 && (none.high - upper).abs() < 5e-5, "{trials}: {none:?}");
        let all = found(trials, trials);
        assert!(all.high == 1.0 && (all.low - (1.0 - upper)).abs() < 5e-5, "{trials}: {all:?}");
    }
    // Four digits as printed by Newcombe (1998, table I, method 3).
    for (failures, trials, low, high) in [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (1, 29, 0.0061, 0.1718)]
    {
        let some = found(failures, trials);
        assert!((some.low - low).abs() < 6e-5 && (some.high - high).abs() < 6e-5, "{failures}/{trials}: {some:?}");
    }
    assert_eq!(wilson(0, 0), None);
    assert_eq!(wilson(3, 2), None);
}

#[test]
fn an_order_is_quoted_only_where_there_is_one() {
    let spacings = [0.08, 0.04, 0.02, 0.01];
    let errors = spacings.map(|h| -3.0 * h * h);
    let found = observed_order(&spacings, &errors).expect("clean second order");
    assert!((found.order - 2.0).abs() < 1e-12 && found.r_squared > 1.0 - 1e-12);
    assert!(found.interval.half_width() < 1e-6);
    assert_eq!(observed_order(&spacings, &[0.1, 0.05, -0.01, 0.02]), None, "changes sign");
    assert_eq!(observed_order(&spacings, &[0.1, 0.01, 0.05, 0.02]), None, "scatters");
    assert_eq!(observed_order(&spacings[..2], &errors[..2]), None, "two points always lie on a line");
    assert_eq!(observed_order(&spacings, &[0.1, 0.05, 0.0, 0.02]), None, "vanishes");
}

#[test]
fn costs_are_read_along_a_line_of_equal_error() {
    let front = [(0.1, 1.0), (0.01, 100.0), (0.001, 1000.0)];
    let cost = |target: f64| cost_at_error(&front, target);
    assert!((cost(0.031_622_776_601_683_79).expect("inside") - 10.0).abs() < 1e-9);
    assert_eq!(cost(0.01), Some(100.0));
    assert_eq!((cost(0.2), cost(0.0005), cost(f64::NAN)), (None, None, None));
    assert!((error_at_cost(&front, 10.0).expect("inside") - 0.031_622_776_6).abs() < 1e-9);
    assert_eq!(cost_at_error(&[(0.1, 0.0)], 0.1), None);
}

#[test]
fn the_noise_floor_matches_simulated_medians() {
    // Ratios of medians of seven, simulated: 0.75 %, 4.8 % and 13.5 % at these variations; the formula for
    // the error of a median is good to a few per cent for seven.
    for (variation, simulated) in [(0.006, 0.0075), (0.036, 0.048), (0.1, 0.135)] {
        let own = noise_floor(variation, 7);
        assert!((own / simulated - 1.0).abs() < 0.05, "{variation}: {own}");
    }
}
