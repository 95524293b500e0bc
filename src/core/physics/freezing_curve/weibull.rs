//! The curve of Nikolaev et al. 2021, eq 9.

use super::shape::{Given, InScenes, Parameter, Quantity, Refusal, UnfrozenFraction};
use crate::physics::mixing::Mixing;

const HALF_SQRT_PI: f64 = 0.886_226_925_452_758;

/// Widths below the freezing point at which the unfrozen fraction is its residual to the last bit: exp(-6.2^2) < 2^-55.
const TAIL_WIDTHS: f64 = 6.2;

/// `S = r + (1 - r) exp(-((T - Tf)/width)^2)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weibull {
    /// Width (K).
    pub width: f64,
    /// Residual unfrozen fraction r.
    pub residual: f64,
}

impl InScenes for Weibull {
    const WORD: &'static str = "weibull";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter { name: "width", quantity: Quantity::Interval }, Parameter::RESIDUAL_FRACTION];
    const MIXING: Mixing = Mixing::Geometric;

    fn new(given: &Given) -> Result<Self, Refusal> {
        Ok(Weibull { width: given.values[0][0], residual: given.values[1][0] })
    }
}

impl UnfrozenFraction for Weibull {
    fn unfrozen(&self, below: f64) -> f64 {
        self.residual + (1.0 - self.residual) * (-(below / self.width).powi(2)).exp()
    }

    fn frozen(&self, below: f64) -> f64 {
        -(1.0 - self.residual) * libm::expm1(-(below / self.width).powi(2))
    }

    fn integral(&self, below: f64) -> f64 {
        (1.0 - self.residual) * self.width * HALF_SQRT_PI * libm::erf(below / self.width) + self.residual * below
    }

    fn release(&self, below: f64) -> f64 {
        -2.0 * (1.0 - self.residual) * below / (self.width * self.width) * (-(below / self.width).powi(2)).exp()
    }

    fn end(&self) -> f64 {
        -TAIL_WIDTHS * self.width
    }
}
