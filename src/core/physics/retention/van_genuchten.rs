//! The retention curve of van Genuchten with the conductivity of Mualem.

use std::ops::Bound;

use super::shape::{InScenes, RetentionCurve};
use crate::physics::freezing_curve::shape::{Given, Parameter, Quantity, Refusal};

/// `Se = (1 + (a psi)^n)^-m`, `m = 1 - 1/n` (van Genuchten 1980, eq 3), and
/// `Kr = Se^l (1 - (1 - Se^(1/m))^m)^2` (eq 8, after Mualem 1976), with the connectivity l of pores.
///
/// Both are written by `x = Se^(1/m) = 1/(1 + (a psi)^n)`, so that neither end cancels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VanGenuchten {
    /// Inverse of the suction of air entry (1/m).
    pub alpha: f64,
    /// Exponent n, greater than 1.
    pub exponent: f64,
    /// Connectivity l.
    pub connectivity: f64,
}

/// A positive number of a unit.
pub(super) const fn positive(name: &'static str, unit: &'static str, most: f64) -> Parameter {
    let range = (Bound::Excluded(0.0), Bound::Included(most));
    Parameter { name, quantity: Quantity::Number { unit, range, default: None } }
}

impl VanGenuchten {
    fn m(&self) -> f64 {
        1.0 - 1.0 / self.exponent
    }

    /// `(a psi)^n`.
    fn scaled(&self, suction: f64) -> f64 {
        libm::pow(self.alpha * suction, self.exponent)
    }
}

impl InScenes for VanGenuchten {
    const WORD: &'static str = "van-genuchten";
    const PARAMETERS: &'static [Parameter] = &[
        positive("alpha", "per_m", 1e4),
        Parameter {
            name: "n",
            quantity: Quantity::Number {
                unit: "",
                range: (Bound::Excluded(1.0), Bound::Included(20.0)),
                default: None,
            },
        },
        Parameter {
            name: "connectivity",
            quantity: Quantity::Number {
                unit: "",
                range: (Bound::Included(0.0), Bound::Included(10.0)),
                default: Some(0.5),
            },
        },
    ];

    fn new(given: &Given) -> Result<Self, Refusal> {
        Ok(VanGenuchten { alpha: given.values[0][0], exponent: given.values[1][0], connectivity: given.values[2][0] })
    }
}

impl RetentionCurve for VanGenuchten {
    fn saturation(&self, suction: f64) -> f64 {
        libm::exp(-self.m() * libm::log1p(self.scaled(suction)))
    }

    fn deficit(&self, suction: f64) -> f64 {
        -libm::expm1(-self.m() * libm::log1p(self.scaled(suction)))
    }

    fn suction(&self, deficit: f64) -> f64 {
        // (a psi)^n = Se^(-1/m) - 1.
        let scaled = libm::expm1(-libm::log1p(-deficit) / self.m());
        libm::pow(scaled, 1.0 / self.exponent) / self.alpha
    }

    fn release(&self, suction: f64) -> f64 {
        if suction <= 0.0 {
            return 0.0;
        }
        // x^n / (1 + x^n), of which neither overflows.
        let share = 1.0 / (1.0 + 1.0 / self.scaled(suction));
        (self.exponent - 1.0) * self.saturation(suction) * share / suction
    }

    fn relative_conductivity(&self, suction: f64) -> f64 {
        // 1 - Se^(1/m) = scaled / (1 + scaled), whose logarithm is that of one less 1/(1 + scaled).
        let log = libm::log1p(self.scaled(suction));
        let bracket = -libm::expm1(self.m() * libm::log1p(-libm::exp(-log)));
        libm::exp(-self.connectivity * self.m() * log) * bracket * bracket
    }

    fn bends(&self) -> Vec<f64> {
        vec![1.0 / self.alpha]
    }
}
