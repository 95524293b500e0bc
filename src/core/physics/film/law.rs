//! What an exchange of heat between a wall and its surroundings is.

use std::ops::Bound;

/// An exchange of heat whose flux follows the temperature of the wall.
///
/// Its flux into the wall is `coefficient (ambient - wall)`, which falls as the wall gets warmer. The coefficient is above 0 where
/// the strength is, and rises or falls with the temperature of the wall throughout.
pub trait FilmLaw {
    /// Key of its strength in scenes, and the unit of that.
    const KEY: (&'static str, &'static str);
    /// Least and greatest strength.
    const RANGE: (Bound<f64>, Bound<f64>);
    /// Whether the coefficient is the strength, whatever the temperatures.
    const IS_LINEAR: bool = false;
    /// Whether its formula has constants in SI, so that scenes in other units can not have it.
    const NEEDS_SI: bool = false;
    /// What it is called.
    const NAME: &'static str;
    /// The unit of its strength, for people.
    const UNIT: &'static str;

    /// Flux over the difference of temperatures (W/m2K), by the strength and the temperatures of surroundings and wall.
    fn coefficient(strength: f64, ambient: f64, wall: f64) -> f64;
    /// By how much the flux falls with the temperature of the wall (W/m2K).
    fn steepness(strength: f64, ambient: f64, wall: f64) -> f64;
}
