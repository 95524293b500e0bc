//! What a freezing curve is: its formulas, and the keys that scenes give it by.

use std::ops::Bound;

use crate::physics::mixing::Mixing;

/// How the unfrozen fraction S follows the temperature below the freezing point.
///
/// Temperatures are given as `below`: kelvin above the freezing point, so never positive.
pub trait UnfrozenFraction {
    /// S at a temperature.
    fn unfrozen(&self, below: f64) -> f64;
    /// 1 - S, without cancellation near the freezing point.
    fn frozen(&self, below: f64) -> f64;
    /// Integral of S (K) from the freezing point down: of the sign of `below`.
    fn integral(&self, below: f64) -> f64;
    /// dS/dT (1/K), never negative.
    fn release(&self, below: f64) -> f64;
    /// Where nothing more freezes: S and its residue below are one number.
    fn end(&self) -> f64;
    /// Ends, from the freezing point down to [`UnfrozenFraction::end`], of the pieces on each of which a few hundred even
    /// steps follow S to rounding.
    fn pieces(&self) -> Vec<f64> {
        vec![self.end()]
    }
    /// Bytes of its tables.
    fn heap_size(&self) -> usize {
        0
    }
}

/// How scenes give a curve.
pub trait InScenes: Sized {
    /// The word of the law.
    const WORD: &'static str;
    /// Its keys.
    const PARAMETERS: &'static [Parameter];
    /// How partly frozen material conducts where a scene does not say.
    const MIXING: Mixing = Mixing::Arithmetic;
    /// Whether its formula has constants in SI, so that scenes in other units can not have it.
    const NEEDS_SI: bool = false;

    /// The curve of these values.
    ///
    /// # Errors
    ///
    /// What values that are allowed each for itself are not together.
    fn new(given: &Given) -> Result<Self, Refusal>;
}

/// A key of a curve in scenes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key, without its unit.
    pub name: &'static str,
    /// What it holds.
    pub quantity: Quantity,
}

/// What a key of a curve holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// Kelvin below the freezing point, to above absolute zero.
    Interval,
    /// A number.
    Number {
        /// Its unit as keys write it; empty for a pure number.
        unit: &'static str,
        /// Least and greatest.
        range: (Bound<f64>, Bound<f64>),
        /// What it is where a scene does not say; none where a scene must.
        default: Option<f64>,
    },
    /// A list of temperatures on the scale of the scene.
    Temperatures,
    /// A list of numbers from 0 to 1.
    Fractions,
    /// A list of numbers.
    Numbers {
        /// Its unit as keys write it; empty for pure numbers.
        unit: &'static str,
        /// Least and greatest.
        range: (Bound<f64>, Bound<f64>),
    },
}

impl Parameter {
    /// What never freezes, of the whole.
    pub const RESIDUAL_FRACTION: Parameter = Parameter {
        name: "residual_fraction",
        quantity: Quantity::Number {
            unit: "",
            range: (Bound::Included(0.0), Bound::Excluded(1.0)),
            default: Some(0.0),
        },
    };

    /// The key, and its unit as keys write it.
    pub fn key(&self) -> (&'static str, &'static str) {
        let unit = match self.quantity {
            Quantity::Interval => "K",
            Quantity::Number { unit, .. } | Quantity::Numbers { unit, .. } => unit,
            Quantity::Temperatures => "c",
            Quantity::Fractions => "",
        };
        (self.name, unit)
    }
}

/// The values of a curve in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// The freezing point, on the scale of the scene.
    pub freezing_point: f64,
    /// Absolute zero on that scale.
    pub absolute_zero: f64,
    /// Values in the order of the curve's parameters, what is no list alone in one.
    pub values: Vec<Vec<f64>>,
}

/// Why values are refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// Which of the curve's parameters.
    pub parameter: usize,
    /// Which of its values, if it is one of a list.
    pub value: Option<usize>,
    /// What was found, and what is allowed.
    pub message: String,
}
