//! Values of formulas all over a body and a run.

use super::{Coordinates, Formula};

/// Samples along each coordinate, where a formula uses one, two or three of them.
const SAMPLES: [usize; 3] = [10_000, 100, 21];

/// By the golden section, samples have no common distance, at which a wave could hide.
const UNEVEN: f64 = 0.618_033_988_749_894_9;

/// Moves from the best sample to an extreme: each halves its reach or is an improvement.
const MOST_MOVES: usize = 200;

/// A value of a formula and where it has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The value.
    pub value: f64,
    /// Where.
    pub at: Coordinates,
}

/// Least and greatest value of a formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// The least.
    pub least: Sample,
    /// The greatest.
    pub greatest: Sample,
}

/// Places of samples from one end to the other, both among them.
pub(super) fn places(low: f64, high: f64, count: usize) -> impl Iterator<Item = f64> + Clone {
    let place = move |k: usize| match k {
        0 => low,
        k if k == count => high,
        k => low + (high - low) * (k as f64 - 0.5 + (k as f64 * UNEVEN).fract()) / count as f64,
    };
    (0..=count).map(place)
}

/// Number of samples along a coordinate, where it is the only one.
pub(super) const OF_ONE: usize = SAMPLES[0];

impl Formula {
    /// Its least and greatest value over a box of coordinates where `inside` holds, from samples all over it and the way down and
    /// up from the least and the greatest of them. What is narrower than their distance may be missed, and
    /// what lies on a curved edge is found to that distance.
    ///
    /// # Errors
    /// With a value that is not finite.
    pub fn extremes(
        &self,
        (low, high): (Coordinates, Coordinates),
        inside: impl Fn(&Coordinates) -> bool,
    ) -> Result<Extremes, Sample> {
        let used: Vec<usize> = (0..low.len()).filter(|axis| self.uses(*axis)).collect();
        let count = SAMPLES[used.len().saturating_sub(1)];
        let along = |axis: usize| places(low[axis], high[axis], if used.contains(&axis) { count } else { 0 });
        let sample = |at: Coordinates| {
            let value = self.at(&at);
            if value.is_finite() { Ok(Sample { value, at }) } else { Err(Sample { value, at }) }
        };
        let mut found: Option<Extremes> = None;
        for x in along(0) {
            for y in along(1) {
                for at in along(2).map(|t| [x, y, t]).filter(|at| inside(at)) {
                    let own = sample(at)?;
                    let known = found.get_or_insert(Extremes { least: own, greatest: own });
                    known.least = if own.value < known.least.value { own } else { known.least };
                    known.greatest = if own.value > known.greatest.value { own } else { known.greatest };
                }
            }
        }
        let refined = |from: Sample, sign: f64| -> Result<Sample, Sample> {
            let mut best = from;
            let mut reach = 1.0 / count as f64;
            for _ in 0..MOST_MOVES {
                let before = best.value;
                for (axis, side) in used.iter().flat_map(|axis| [(*axis, -1.0), (*axis, 1.0)]) {
                    let mut at = best.at;
                    at[axis] = (at[axis] + side * reach * (high[axis] - low[axis])).clamp(low[axis], high[axis]);
                    if inside(&at) {
                        let own = sample(at)?;
                        best = if sign * own.value > sign * best.value { own } else { best };
                    }
                }
                if best.value == before {
                    reach *= 0.5;
                }
            }
            Ok(best)
        };
        match found {
            Some(found) => Ok(Extremes { least: refined(found.least, -1.0)?, greatest: refined(found.greatest, 1.0)? }),
            // No sample lies inside.
            None => sample(low).map(|own| Extremes { least: own, greatest: own }),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::formula::{Formula, TIME, X, Y};

    fn range(text: &str, high: [f64; 3]) -> Result<(f64, f64), f64> {
        let formula = Formula::read(text, &[("x", X), ("y", Y), ("t", TIME)]).expect("a formula");
        let found = formula.extremes(([0.0; 3], high), |at| at[X] + at[Y] <= 3.0);
        found.map(|found| (found.least.value, found.greatest.value)).map_err(|sample| sample.value)
    }

    /// To rounding, wherever samples lie: extremes are where nothing is nearer to them than the root of that.
    #[test]
    fn extremes_are_those_of_the_formula() {
        for (text, high, expected) in [
            ("7", [1.0; 3], (7.0, 7.0)),
            ("10 + 5*cos(pi*y/2)", [1.0, 2.0, 1.0], (5.0, 15.0)),
            ("-10 + 15*sin(2*pi*t/31557600)", [1.0, 1.0, 1e8], (-25.0, 5.0)),
            ("-10 + 15*sin(2*pi*t/31557600)", [1.0, 1.0, 31_557_600.0 / 12.0], (-10.0, -2.5)),
            ("sin(x)*cos(y)", [1.8, 1.0, 1.0], (0.0, 1.0)),
            ("x*y", [1.0, 2.0, 1.0], (0.0, 2.0)),
            ("exp(-t)*sin(x)*sin(y)", [1.5, 1.5, 3.0], (0.0, (1.5f64).sin().powi(2))),
        ] {
            let (least, greatest) = range(text, high).expect(text);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * expected.1.abs();
            assert!(close(least, expected.0) && close(greatest, expected.1), "{text}: {least} to {greatest}");
        }
    }

    #[test]
    fn values_that_are_not_finite_are_found() {
        for text in ["1/x", "ln(y)", "sqrt(x - 0.5)", "exp(1e4*t)", "0/0 + x"] {
            assert!(range(text, [1.0; 3]).is_err(), "{text}");
        }
    }
}
