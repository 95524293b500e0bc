//! The exponential curve of Gardner.

use super::shape::{InScenes, RetentionCurve};
use super::van_genuchten::positive;
use crate::physics::freezing_curve::shape::{Given, Parameter, Refusal};

/// `Se = Kr = exp(-a psi)` (Gardner 1958 for the conductivity): the soil under which flow is linear, as closed forms have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gardner {
    /// Inverse of the capillary length (1/m).
    pub alpha: f64,
}

impl InScenes for Gardner {
    const WORD: &'static str = "gardner";
    const PARAMETERS: &'static [Parameter] = &[positive("alpha", "per_m", 1e4)];

    fn new(given: &Given) -> Result<Self, Refusal> {
        Ok(Gardner { alpha: given.values[0][0] })
    }
}

impl RetentionCurve for Gardner {
    fn saturation(&self, suction: f64) -> f64 {
        libm::exp(-self.alpha * suction)
    }

    fn deficit(&self, suction: f64) -> f64 {
        -libm::expm1(-self.alpha * suction)
    }

    fn suction(&self, deficit: f64) -> f64 {
        -libm::log1p(-deficit) / self.alpha
    }

    fn release(&self, suction: f64) -> f64 {
        self.alpha * self.saturation(suction)
    }

    fn relative_conductivity(&self, suction: f64) -> f64 {
        self.saturation(suction)
    }

    fn bends(&self) -> Vec<f64> {
        vec![1.0 / self.alpha]
    }
}
