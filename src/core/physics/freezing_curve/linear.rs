//! The unfrozen fraction falls evenly over an interval.

use super::shape::{Given, InScenes, Parameter, Quantity, Refusal, UnfrozenFraction};

/// `S = 1 + (T - Tf)/width`, at least 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// Width of the interval (K).
    pub width: f64,
}

impl InScenes for Linear {
    const WORD: &'static str = "linear";
    const PARAMETERS: &'static [Parameter] = &[Parameter { name: "width", quantity: Quantity::Interval }];

    fn new(given: &Given) -> Result<Self, Refusal> {
        Ok(Linear { width: given.values[0][0] })
    }
}

impl UnfrozenFraction for Linear {
    fn unfrozen(&self, below: f64) -> f64 {
        (1.0 + below / self.width).max(0.0)
    }

    fn frozen(&self, below: f64) -> f64 {
        (-below / self.width).min(1.0)
    }

    fn integral(&self, below: f64) -> f64 {
        let inside = below.max(-self.width);
        inside + inside * inside / (2.0 * self.width)
    }

    fn release(&self, below: f64) -> f64 {
        if below > -self.width { 1.0 / self.width } else { 0.0 }
    }

    fn end(&self) -> f64 {
        -self.width
    }
}
