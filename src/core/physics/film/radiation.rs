//! Thermal radiation between a grey wall and black surroundings.

use std::ops::Bound;

use super::law::FilmLaw;

/// Stefan-Boltzmann constant (W/m2K4), exact in SI since 2019.
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// Absolute zero (degC).
const ABSOLUTE_ZERO: f64 = -273.15;

/// Absolute temperature of a wall; a step that leaves the numbers may take it below zero before it is noticed.
fn kelvin(wall: f64) -> f64 {
    (wall - ABSOLUTE_ZERO).max(0.0)
}

/// `e s (Ta^4 - Tw^4)` in kelvin: the strength is the emissivity e.
#[derive(Debug)]
pub struct Radiation;

impl FilmLaw for Radiation {
    const KEY: (&'static str, &'static str) = ("emissivity", "");
    const RANGE: (Bound<f64>, Bound<f64>) = (Bound::Included(0.0), Bound::Included(1.0));
    const NEEDS_SI: bool = true;
    const NAME: &'static str = "emissivity";
    const UNIT: &'static str = "";

    fn coefficient(strength: f64, ambient: f64, wall: f64) -> f64 {
        let (ambient, wall) = (ambient - ABSOLUTE_ZERO, kelvin(wall));
        strength * STEFAN_BOLTZMANN * (ambient * ambient + wall * wall) * (ambient + wall)
    }

    fn steepness(strength: f64, _ambient: f64, wall: f64) -> f64 {
        4.0 * strength * STEFAN_BOLTZMANN * kelvin(wall).powi(3)
    }
}
