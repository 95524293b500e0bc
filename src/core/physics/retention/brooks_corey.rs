//! The retention curve of Brooks and Corey.

use super::shape::{InScenes, RetentionCurve};
use super::van_genuchten::positive;
use crate::physics::freezing_curve::shape::{Given, Parameter, Refusal};

/// `Se = (psi_b / psi)^lambda` beyond the suction of air entry, `Kr = Se^(3 + 2/lambda)` (Brooks and Corey 1964, eqs 3 and 15).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrooksCorey {
    /// Suction of air entry (m).
    pub air_entry: f64,
    /// Index of the distribution of pore sizes, greater than 0.
    pub index: f64,
}

impl BrooksCorey {
    /// Logarithm of Se.
    fn log_saturation(&self, suction: f64) -> f64 {
        if suction <= self.air_entry { 0.0 } else { -self.index * libm::log(suction / self.air_entry) }
    }
}

impl InScenes for BrooksCorey {
    const WORD: &'static str = "brooks-corey";
    const PARAMETERS: &'static [Parameter] = &[positive("air_entry", "m", 1e6), positive("index", "", 100.0)];

    fn new(given: &Given) -> Result<Self, Refusal> {
        Ok(BrooksCorey { air_entry: given.values[0][0], index: given.values[1][0] })
    }
}

impl RetentionCurve for BrooksCorey {
    fn saturation(&self, suction: f64) -> f64 {
        libm::exp(self.log_saturation(suction))
    }

    fn deficit(&self, suction: f64) -> f64 {
        -libm::expm1(self.log_saturation(suction))
    }

    fn suction(&self, deficit: f64) -> f64 {
        if deficit <= 0.0 { 0.0 } else { self.air_entry * libm::exp(-libm::log1p(-deficit) / self.index) }
    }

    fn release(&self, suction: f64) -> f64 {
        if suction <= self.air_entry { 0.0 } else { self.index * self.saturation(suction) / suction }
    }

    fn relative_conductivity(&self, suction: f64) -> f64 {
        libm::exp((3.0 + 2.0 / self.index) * self.log_saturation(suction))
    }

    fn bends(&self) -> Vec<f64> {
        vec![self.air_entry]
    }
}
