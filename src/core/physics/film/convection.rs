//! A film with a coefficient.

use std::ops::Bound;

use super::law::FilmLaw;

/// Newton's law of cooling: the strength is the coefficient (W/m2K).
#[derive(Debug)]
pub struct Convection;

impl FilmLaw for Convection {
    const KEY: (&'static str, &'static str) = ("coefficient", "W_per_m2_K");
    const RANGE: (Bound<f64>, Bound<f64>) = (Bound::Included(0.0), Bound::Unbounded);
    const IS_LINEAR: bool = true;
    const NAME: &'static str = "film coefficient";
    const UNIT: &'static str = "W/m²K";

    fn coefficient(strength: f64, _ambient: f64, _wall: f64) -> f64 {
        strength
    }

    fn steepness(strength: f64, _ambient: f64, _wall: f64) -> f64 {
        strength
    }
}
