//! What a retention curve is: its formulas, and the keys that scenes give it by.

use crate::physics::freezing_curve::shape::{Given, Parameter, Refusal};

/// How much water pores hold at a suction, and how well they conduct it then.
///
/// Suctions are in metres of water, never negative; the effective saturation Se is 1 for none.
pub trait RetentionCurve {
    /// Effective saturation at a suction.
    fn saturation(&self, suction: f64) -> f64;
    /// 1 - Se, without cancellation near saturation.
    fn deficit(&self, suction: f64) -> f64;
    /// Suction at a deficit of saturation: the inverse of [`RetentionCurve::deficit`]; where several suctions have it, the
    /// least; infinite at a deficit that none has.
    fn suction(&self, deficit: f64) -> f64;
    /// -dSe/dpsi (1/m), never negative.
    fn release(&self, suction: f64) -> f64;
    /// Conductivity over that of saturated ground.
    fn relative_conductivity(&self, suction: f64) -> f64;
    /// Suctions (m) at which the curve bends or has a kink, rising; at least one.
    fn bends(&self) -> Vec<f64>;
}

/// How scenes give a curve.
pub trait InScenes: Sized {
    /// The word of the law.
    const WORD: &'static str;
    /// Its keys.
    const PARAMETERS: &'static [Parameter];

    /// The curve of these values.
    ///
    /// # Errors
    ///
    /// What values that are allowed each for itself are not together.
    fn new(given: &Given) -> Result<Self, Refusal>;
}
