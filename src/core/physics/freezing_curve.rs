//! Freezing curves, a file each. A new one is its file here and its two lines below.

pub mod linear;
pub mod shape;
pub mod table;
pub mod van_genuchten;
pub mod weibull;

use crate::physics::mixing::Mixing;
use shape::{Given, InScenes, Parameter, Refusal, UnfrozenFraction};

/// How the unfrozen fraction follows the temperature.
#[derive(Debug, Clone, PartialEq)]
pub enum FreezingLaw {
    /// No phase change in the range of the scene: frozen and unfrozen properties meet at the freezing point.
    None,
    /// All at the freezing point.
    Isothermal,
    /// Over an interval of temperatures below it.
    Curve(FreezingCurve),
}

/// Makes the list of curves from their types: what a step asks of a curve is known where it is compiled.
macro_rules! curves {
    ($($file:ident::$curve:ident),* $(,)?) => {
        /// A material that freezes over an interval of temperatures, by one of the curves.
        #[derive(Debug, Clone, PartialEq)]
        #[expect(missing_docs, reason = "each curve says itself what it is")]
        pub enum FreezingCurve {
            $($curve($file::$curve)),*
        }

        /// All curves.
        pub const CURVES: &[CurveKind] = &[$(CurveKind {
            word: $file::$curve::WORD,
            parameters: $file::$curve::PARAMETERS,
            mixing: $file::$curve::MIXING,
            needs_si: $file::$curve::NEEDS_SI,
            make: |given| $file::$curve::new(given).map(FreezingCurve::$curve),
        }),*];

        impl UnfrozenFraction for FreezingCurve {
            #[inline]
            fn unfrozen(&self, below: f64) -> f64 {
                match self { $(FreezingCurve::$curve(curve) => curve.unfrozen(below)),* }
            }

            #[inline]
            fn frozen(&self, below: f64) -> f64 {
                match self { $(FreezingCurve::$curve(curve) => curve.frozen(below)),* }
            }

            #[inline]
            fn integral(&self, below: f64) -> f64 {
                match self { $(FreezingCurve::$curve(curve) => curve.integral(below)),* }
            }

            #[inline]
            fn release(&self, below: f64) -> f64 {
                match self { $(FreezingCurve::$curve(curve) => curve.release(below)),* }
            }

            #[inline]
            fn end(&self) -> f64 {
                match self { $(FreezingCurve::$curve(curve) => curve.end()),* }
            }

            fn pieces(&self) -> Vec<f64> {
                match self { $(FreezingCurve::$curve(curve) => curve.pieces()),* }
            }

            fn heap_size(&self) -> usize {
                match self { $(FreezingCurve::$curve(curve) => curve.heap_size()),* }
            }
        }

        $(impl From<$file::$curve> for FreezingLaw {
            fn from(curve: $file::$curve) -> Self {
                FreezingLaw::Curve(FreezingCurve::$curve(curve))
            }
        })*
    };
}

curves![linear::Linear, weibull::Weibull, van_genuchten::VanGenuchten, table::Table];

/// A kind of curve, as scenes name it.
#[derive(Debug, Clone, Copy)]
pub struct CurveKind {
    /// The word of the law.
    pub word: &'static str,
    /// Its keys.
    pub parameters: &'static [Parameter],
    /// How partly frozen material conducts where a scene does not say.
    pub mixing: Mixing,
    /// Whether scenes in other units than SI can not have it.
    pub needs_si: bool,
    /// The curve of these values.
    pub make: fn(&Given) -> Result<FreezingCurve, Refusal>,
}
