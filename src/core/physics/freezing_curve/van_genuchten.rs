//! The retention curve of a soil as its freezing curve.

use std::ops::Bound;

use super::shape::{Given, InScenes, Parameter, Quantity, Refusal, UnfrozenFraction};
use crate::memory::HeapSize;
use crate::physics::integral::Integral;

/// Latent heat of fusion of water (J/kg) over the acceleration of gravity (m/s2): metres of suction by the logarithm of the
/// temperature. It belongs to water, whatever the latent heat of the material is counted by.
const SUCTION: f64 = 334_000.0 / 9.81;

/// Of the absolute freezing point: where nothing more freezes. From 0 degC that is 137 K, where supercooled water is a glass.
const COLDEST: f64 = 0.5;

/// Of the suction at which the curve bends: from there on it is followed in pieces, each twice as deep as the last.
const FIRST_PIECE: f64 = 1.0 / 64.0;

/// Steps of a piece of the integral.
const STEPS: usize = 256;

/// `S = r + (1 - r) (1 + (a psi)^n)^-(1 - 1/n)` (van Genuchten 1980) at the suction `psi = L/g ln(Tf/T)` (m).
///
/// That is the Clapeyron equation of water beside ice at the pressure of the air, integrated from the freezing point at a
/// constant latent heat (Kurylyk and Watanabe 2013), in kelvin; in its linear form, `L/g (Tf - T)/Tf`, the suction would be 4 %
/// less at -20 degC.
#[derive(Debug, Clone, PartialEq)]
pub struct VanGenuchten {
    /// Inverse of the suction of air entry (1/m).
    alpha: f64,
    /// Exponent n, greater than 1.
    exponent: f64,
    /// Residual unfrozen fraction r.
    residual: f64,
    /// Freezing point (K).
    freezing_point: f64,
    integral: Integral,
}

impl VanGenuchten {
    /// `(a psi)^n`.
    fn scaled_suction(&self, below: f64) -> f64 {
        let below = below.max(self.end());
        libm::pow(-self.alpha * SUCTION * libm::log1p(below / self.freezing_point), self.exponent)
    }

    /// Logarithm of the part of the water that can freeze which has not.
    fn log_free(&self, scaled: f64) -> f64 {
        (1.0 / self.exponent - 1.0) * libm::log1p(scaled)
    }
}

impl InScenes for VanGenuchten {
    const WORD: &'static str = "van-genuchten";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            name: "alpha",
            quantity: Quantity::Number {
                unit: "per_m",
                range: (Bound::Excluded(0.0), Bound::Included(1e4)),
                default: None,
            },
        },
        Parameter {
            name: "n",
            quantity: Quantity::Number {
                unit: "",
                range: (Bound::Excluded(1.0), Bound::Included(20.0)),
                default: None,
            },
        },
        Parameter::RESIDUAL_FRACTION,
    ];
    const NEEDS_SI: bool = true;

    fn new(given: &Given) -> Result<Self, Refusal> {
        let freezing_point = given.freezing_point - given.absolute_zero;
        let (alpha, exponent, residual) = (given.values[0][0], given.values[1][0], given.values[2][0]);
        let integral = Integral::new(|_| 1.0, &[-1.0], 1);
        let mut curve = VanGenuchten { alpha, exponent, residual, freezing_point, integral };
        curve.integral = Integral::new(|below| curve.unfrozen(below), &curve.pieces(), STEPS);
        Ok(curve)
    }
}

impl UnfrozenFraction for VanGenuchten {
    fn unfrozen(&self, below: f64) -> f64 {
        self.residual + (1.0 - self.residual) * libm::exp(self.log_free(self.scaled_suction(below)))
    }

    fn frozen(&self, below: f64) -> f64 {
        -(1.0 - self.residual) * libm::expm1(self.log_free(self.scaled_suction(below)))
    }

    fn integral(&self, below: f64) -> f64 {
        self.integral.at(below)
    }

    fn release(&self, below: f64) -> f64 {
        if below >= 0.0 || below <= self.end() {
            return 0.0;
        }
        let scaled = self.scaled_suction(below);
        // x^n / (1 + x^n), of which neither overflows.
        let share = 1.0 / (1.0 + 1.0 / scaled);
        let by_suction = (self.exponent - 1.0) * share / -libm::log1p(below / self.freezing_point);
        (1.0 - self.residual) * libm::exp(self.log_free(scaled)) * by_suction / (self.freezing_point + below)
    }

    fn end(&self) -> f64 {
        -COLDEST * self.freezing_point
    }

    fn pieces(&self) -> Vec<f64> {
        let bend = -self.freezing_point / (self.alpha * SUCTION);
        let falling = std::iter::successors(Some(FIRST_PIECE * bend), |end| Some(2.0 * end));
        falling.take_while(|end| *end > 0.75 * self.end()).chain([self.end()]).collect()
    }

    fn heap_size(&self) -> usize {
        self.integral.heap_size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(alpha: f64, n: f64, residual: f64) -> VanGenuchten {
        let values = vec![vec![alpha], vec![n], vec![residual]];
        VanGenuchten::new(&Given { freezing_point: -0.2, absolute_zero: -273.15, values }).expect("a curve")
    }

    /// Sand, loam and clay of van Genuchten 1980's kind, and exponents at both ends of what soils have.
    fn soils() -> Vec<VanGenuchten> {
        [(14.5, 2.68, 0.1), (3.6, 1.56, 0.18), (0.8, 1.09, 0.0), (2.0, 1.01, 0.0), (5.0, 12.0, 0.05)]
            .map(|(alpha, n, residual)| soil(alpha, n, residual))
            .into()
    }

    /// Depths below the freezing point on all scales (K).
    fn depths() -> impl Iterator<Item = f64> {
        (0..400).map(|k| -1e-7 * 1.055_f64.powi(k)).filter(|below| *below > -136.0)
    }

    #[test]
    fn the_curve_is_that_of_van_genuchten_at_the_suction_of_clapeyron() {
        let soil = soil(2.0, 1.5, 0.1);
        // At -10 degC, with the absolute freezing point 272.95 K.
        let suction = 334_000.0 / 9.81 * (272.95_f64 / 263.15).ln();
        let free = (1.0 + (2.0 * suction).powf(1.5)).powf(-1.0 / 3.0);
        assert!((soil.unfrozen(-9.8) - (0.1 + 0.9 * free)).abs() < 1e-14);
        assert_eq!(soil.unfrozen(0.0), 1.0);
    }

    #[test]
    fn it_falls_evenly_and_its_parts_belong_together() {
        for soil in soils() {
            let mut last = 1.0;
            for below in depths() {
                let unfrozen = soil.unfrozen(below);
                assert!(unfrozen <= last && unfrozen >= soil.residual, "{} at {below}", soil.alpha);
                last = unfrozen;
                assert!((unfrozen + soil.frozen(below) - 1.0).abs() < 4.0 * f64::EPSILON);
                let step = 1e-4 * below;
                // From the side without cancellation; the error of a central difference is of second order in the step.
                let slope = (soil.frozen(below + step) - soil.frozen(below - step)) / (-2.0 * step);
                let release = soil.release(below);
                // A millionth of 12^2, the square of the largest exponent, or rounding of the difference.
                let allowed = 2e-6 * release + 4.0 * f64::EPSILON * soil.frozen(below) / step.abs();
                assert!((slope - release).abs() <= allowed, "{} at {below}: {slope} {release}", soil.alpha);
            }
            assert_eq!(soil.unfrozen(f64::NEG_INFINITY), soil.unfrozen(soil.end()));
        }
    }

    /// Five-point Gauss quadrature on pieces of a thousandth of the depth, in the logarithm of the depth.
    #[test]
    fn the_table_is_the_integral() {
        let points = [
            (0.0, 128.0 / 225.0),
            (0.538_469_310_105_683, 0.478_628_670_499_366),
            (0.906_179_845_938_664, 0.236_926_885_056_189),
        ];
        for soil in soils() {
            // Above this depth S is 1 but for less than its share.
            let (mut top, mut sum) = (-1e-12, -1e-12);
            // In its first step, where S has no second derivative, what S falls by.
            let first = soil.pieces()[0] / STEPS as f64;
            let bent = -first * soil.frozen(first);
            while top > -130.0 {
                let end = top * 1.02;
                let (middle, half) = (0.5 * (top + end), 0.5 * (end - top));
                let pair = |x: f64| soil.unfrozen(middle + half * x) + soil.unfrozen(middle - half * x);
                sum += half * points.iter().map(|(x, w)| w * pair(*x) * if *x == 0.0 { 0.5 } else { 1.0 }).sum::<f64>();
                top = end;
                let own = soil.integral(top);
                assert!((own - sum).abs() < 1e-9 * sum.abs() + bent, "{} to {top}: {own} {sum}", soil.alpha);
            }
        }
    }
}
