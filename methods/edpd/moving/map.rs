//! Units of a scene and of its particles.

use frazil_record::plain;
use frazil_scene::Units;

use super::Motion;

/// Temperature (K) that is 1 in DPD units.
const DEGREE: f64 = 300.0;

/// Thermal diffusivity of the liquid in DPD units, where the scene has other units and names none.
const DIFFUSIVITY: f64 = 1.1;

/// How lengths, times and temperatures of a scene become those of the particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DpdUnits {
    /// Length (m) of one DPD unit.
    pub length: f64,
    /// Time (s) of one DPD unit.
    pub time: f64,
    /// Absolute zero on the scale of the scene.
    pub zero: f64,
    /// Degrees of the scene in one DPD unit of temperature.
    pub degree: f64,
}

impl DpdUnits {
    /// The map of a scene whose particles stand `spacing` (m) apart and whose liquid has a thermal diffusivity (m2/s).
    pub fn new(units: Units, spacing: f64, motion: &Motion, diffusivity: f64) -> Self {
        let length = spacing * motion.number_density.sqrt();
        let (time, degree) = match units {
            Units::Dpd => (length * length, 1.0),
            Units::Si | Units::Dimensionless => {
                let degree = if units == Units::Si { DEGREE } else { 1.0 };
                (motion.diffusivity.unwrap_or(DIFFUSIVITY) * length * length / diffusivity, degree)
            }
        };
        DpdUnits { length, time, zero: units.absolute_zero(), degree }
    }

    /// A temperature of the scene in DPD units.
    pub fn temperature(&self, temperature: f64) -> f64 {
        (temperature - self.zero) / self.degree
    }

    /// In words, for the report.
    pub fn words(&self, units: Units) -> String {
        let (length, time, degree) = match units {
            Units::Si => (" m", " s", " K"),
            Units::Dpd | Units::Dimensionless => ("", "", ""),
        };
        format!(
            "scales: one DPD length is {}{length}, one DPD time {}{time}, a temperature of 1 is {}{degree}",
            plain(self.length, 7),
            plain(self.time, 7),
            self.degree
        )
    }
}
