//! Retention curves, a file each, and what unsaturated ground makes of them. A new curve is its file here and its two lines
//! below.
//!
//! Water in ground is the heat of [`crate::physics::curve`] in other words: the pressure head is what a particle shares with its
//! neighbours, the water content is what it holds, the water between residual and saturated content is what it gives off as it
//! dries, and the conduction potential is the integral of the hydraulic conductivity (Kirchhoff).

pub mod answer;
pub mod brooks_corey;
pub mod conducting;
pub mod gardner;
pub mod moisture;
pub mod scale;
pub mod shape;
pub mod table;
pub mod tabulated;
pub mod van_genuchten;

use crate::physics::freezing_curve::shape::{Given, Parameter, Refusal};
use shape::{InScenes, RetentionCurve};

/// Makes the list of curves from their types: what a step asks of a curve is known where it is compiled.
macro_rules! curves {
    ($($file:ident::$curve:ident),* $(,)?) => {
        /// How the water content follows the suction, by one of the curves.
        #[derive(Debug, Clone, PartialEq)]
        #[expect(missing_docs, reason = "each curve says itself what it is")]
        pub enum Retention {
            $($curve($file::$curve)),*
        }

        /// All curves.
        pub const RETENTIONS: &[RetentionKind] = &[$(RetentionKind {
            word: $file::$curve::WORD,
            parameters: $file::$curve::PARAMETERS,
            make: |given| $file::$curve::new(given).map(Retention::$curve),
        }),*];

        impl RetentionCurve for Retention {
            fn saturation(&self, suction: f64) -> f64 {
                match self { $(Retention::$curve(curve) => curve.saturation(suction)),* }
            }

            fn deficit(&self, suction: f64) -> f64 {
                match self { $(Retention::$curve(curve) => curve.deficit(suction)),* }
            }

            fn suction(&self, deficit: f64) -> f64 {
                match self { $(Retention::$curve(curve) => curve.suction(deficit)),* }
            }

            fn release(&self, suction: f64) -> f64 {
                match self { $(Retention::$curve(curve) => curve.release(suction)),* }
            }

            fn relative_conductivity(&self, suction: f64) -> f64 {
                match self { $(Retention::$curve(curve) => curve.relative_conductivity(suction)),* }
            }

            fn bends(&self) -> Vec<f64> {
                match self { $(Retention::$curve(curve) => curve.bends()),* }
            }
        }

        $(impl From<$file::$curve> for Retention {
            fn from(curve: $file::$curve) -> Self {
                Retention::$curve(curve)
            }
        })*
    };
}

curves![van_genuchten::VanGenuchten, brooks_corey::BrooksCorey, gardner::Gardner, table::Table];

/// A kind of curve, as scenes name it.
#[derive(Debug, Clone, Copy)]
pub struct RetentionKind {
    /// The word of the law.
    pub word: &'static str,
    /// Its keys.
    pub parameters: &'static [Parameter],
    /// The curve of these values.
    pub make: fn(&Given) -> Result<Retention, Refusal>,
}
