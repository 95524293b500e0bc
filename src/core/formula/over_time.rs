//! A formula of time alone, over one run.

use super::sampled::{OF_ONE, places};
use super::{Extremes, Formula, TIME};

/// Times over a run at which a formula may turn: with more of them, samples do not resolve it.
pub const MOST_TURNS: usize = OF_ONE / 10;

/// Change between two samples, over the greatest magnitude, that is one of rounding.
const ROUNDING: f64 = 1e-12;

/// Pieces of the time from 0 on for an integral.
const PIECES: usize = 2000;

/// A formula of time alone, over one run.
#[derive(Debug, Clone, PartialEq)]
pub struct OverTime {
    formula: Formula,
    /// What its values are multiplied by.
    factor: f64,
    /// Least and greatest value, without the factor.
    range: (f64, f64),
    /// Times (s) at which it begins to rise, to fall or to rest.
    turns: Vec<f64>,
}

impl OverTime {
    /// The formula until the end (s) of a run, over which it has these extremes; none where it turns more than [`MOST_TURNS`]
    /// times.
    pub fn new(formula: Formula, extremes: &Extremes, end: f64) -> Option<Self> {
        let range = (extremes.least.value, extremes.greatest.value);
        let noise = ROUNDING * range.1.abs().max(range.0.abs());
        let samples: Vec<(f64, f64)> = places(0.0, end, OF_ONE).map(|time| (time, of_time(&formula, time))).collect();
        let way = |pair: &[(f64, f64)]| {
            let change = pair[1].1 - pair[0].1;
            if change.abs() <= noise { 0.0 } else { change.signum() }
        };
        let turn = |three: &[(f64, f64)]| (way(&three[..2]) != way(&three[1..])).then_some(three[1].0);
        let turns: Vec<f64> = samples.windows(3).filter_map(turn).collect();
        (turns.len() <= MOST_TURNS).then_some(OverTime { formula, factor: 1.0, range, turns })
    }

    /// Value at time `t` (s).
    pub fn at(&self, t: f64) -> f64 {
        self.factor * of_time(&self.formula, t)
    }

    /// Least and greatest value over the run.
    pub fn range(&self) -> (f64, f64) {
        let ends = (self.factor * self.range.0, self.factor * self.range.1);
        (ends.0.min(ends.1), ends.0.max(ends.1))
    }

    /// The formula, without the factor.
    pub fn text(&self) -> &str {
        self.formula.text()
    }

    /// The first instant after `t` (s) at which it begins to rise, to fall or to rest, to the distance of samples.
    pub fn next_turn(&self, t: f64) -> Option<f64> {
        self.turns.get(self.turns.partition_point(|turn| *turn <= t)).copied()
    }

    /// Integral over time from 0 to `t` (s), by Simpson's rule.
    pub fn integral(&self, t: f64) -> f64 {
        let width = t / PIECES as f64;
        let piece = |k: usize| {
            let [from, middle, to] = [0.0, 0.5, 1.0].map(|share| self.at(width * (k as f64 + share)));
            width * (from + 4.0 * middle + to) / 6.0
        };
        (0..PIECES).map(piece).sum()
    }

    /// The formula times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        OverTime { factor: factor * self.factor, ..self.clone() }
    }
}

fn of_time(formula: &Formula, t: f64) -> f64 {
    let mut at = [0.0; 3];
    at[TIME] = t;
    formula.at(&at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn over(text: &str, end: f64) -> Option<OverTime> {
        let formula = Formula::read(text, &[("t", TIME)]).expect("a formula");
        let extremes = formula.extremes(([0.0; 3], [0.0, 0.0, end]), |_| true).expect("finite");
        OverTime::new(formula, &extremes, end)
    }

    #[test]
    fn turns_are_where_it_begins_to_rise_fall_or_rest() {
        let turns = |text: &str| over(text, 10.0).expect("few turns").turns;
        let near = |text: &str, expected: &[f64]| {
            let found = turns(text);
            let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 5e-3);
            assert!(close && found.len() == expected.len(), "{text}: {found:?}");
        };
        near("3", &[]);
        near("sin(t)^2 + cos(t)^2", &[]);
        near("exp(-t)", &[]);
        near("cos(t)", &[PI, TAU, 3.0 * PI]);
        near("max(0, sin(t))", &[0.5 * PI, PI, TAU, 2.5 * PI, 3.0 * PI]);
        // A pulse that a long step would pass over.
        near("exp(-((t - 4)/0.01)^2)", &[3.95, 4.0, 4.05]);
        let over = over("cos(t)", 10.0).expect("few turns");
        assert_eq!([0.0, 4.0, 10.0].map(|t| over.next_turn(t).map(f64::round)), [Some(3.0), Some(6.0), None]);
    }

    #[test]
    fn a_wave_that_samples_do_not_resolve_is_refused() {
        assert!(over("sin(2*pi*t)", 400.0).is_some());
        for waves in [1000.0, 5000.0, 10_000.0, 1e6] {
            assert!(over("sin(2*pi*t)", waves).is_none(), "{waves}");
        }
    }

    #[test]
    fn integrals_and_factors_are_those_of_the_formula() {
        let own = over("3 + 2*sin(t)", 10.0).expect("few turns");
        let exact = |t: f64| 3.0 * t + 2.0 - 2.0 * t.cos();
        for t in [0.0, 0.3, 2.0, 10.0] {
            assert!((own.integral(t) - exact(t)).abs() < 1e-11, "{t}");
        }
        let turned = own.scaled(-2.0);
        assert_eq!((turned.at(1.0), turned.integral(2.0)), (-2.0 * own.at(1.0), -2.0 * own.integral(2.0)));
        assert!((turned.range().0 + 10.0).abs() < 1e-12 && (turned.range().1 + 2.0).abs() < 1e-12);
    }
}
