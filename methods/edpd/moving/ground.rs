//! Heat of moving particles as the enthalpy of the scene's material.

use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::physics::latent_heat::Mushy;
use frazil_core::physics::thermal::Thermal;

use crate::fluid::Matter;

/// Difference of temperatures (DPD units) below which a pair's conductivity is that of its ends, not of the way between.
const LEVEL: f64 = 1e-9;

/// The scene's material in DPD units.
pub struct SceneMatter {
    thermal: Thermal,
    /// Enthalpy (J/m3) by heat.
    per_heat: f64,
    /// Absolute zero on the scale of the scene.
    zero: f64,
    /// Degrees of the scene in one unit of temperature.
    degree: f64,
    /// Conductivity of the liquid (W/mK).
    conductivity: f64,
    exchange: Exchange,
    mushy: Mushy,
}

/// What pairs see of a particle.
#[derive(Debug, Clone, Copy)]
pub struct SeenState {
    /// Conduction potential over the conductivity of the liquid (DPD units of temperature), from the scene's start.
    level: f64,
    /// Conductivity over that of the liquid.
    conductivity: f64,
}

impl SceneMatter {
    /// The material, `per_heat` (J/m3) of enthalpy by heat, the scale of temperature (zero and degree), how pairs
    /// exchange.
    pub fn new(
        thermal: Thermal,
        per_heat: f64,
        (zero, degree): (f64, f64),
        (exchange, mushy): (Exchange, Mushy),
    ) -> Self {
        let conductivity = thermal.curve.mixed_conductivity(1.0);
        SceneMatter { thermal, per_heat, zero, degree, conductivity, exchange, mushy }
    }

    /// Heat at a temperature of the scene.
    pub fn heat(&self, temperature: f64) -> f64 {
        self.thermal.enthalpy(temperature) / self.per_heat
    }

    /// Enthalpy (J/m3) from the scene's start, by heat.
    pub fn per_heat(&self) -> f64 {
        self.per_heat
    }
}

impl Matter for SceneMatter {
    type Seen = SeenState;
    const UNEVEN: bool = true;

    #[inline]
    fn temperature(&self, heat: f64) -> f64 {
        (self.thermal.temperature(heat * self.per_heat) - self.zero) / self.degree
    }

    #[inline]
    fn see(&self, heat: f64, moves: bool) -> SeenState {
        let enthalpy = heat * self.per_heat;
        let frozen = self.thermal.frozen_fraction(enthalpy);
        let frozen = match self.mushy {
            Mushy::Fraction => frozen,
            Mushy::LastPhase => f64::from(u8::from(!moves)),
            Mushy::Mean if frozen > 0.0 && frozen < 1.0 => 0.5,
            Mushy::Mean => frozen,
        };
        SeenState {
            level: self.thermal.law.potential(enthalpy) / (self.conductivity * self.degree),
            conductivity: self.thermal.curve.mixed_conductivity(1.0 - frozen) / self.conductivity,
        }
    }

    #[inline]
    fn between(&self, [(a, warm), (b, cold)]: [(SeenState, f64); 2]) -> f64 {
        let (one, other) = (a.conductivity, b.conductivity);
        match self.exchange {
            Exchange::Potential => {
                let difference = warm - cold;
                if difference.abs() > LEVEL { ((a.level - b.level) / difference).max(0.0) } else { 0.5 * (one + other) }
            }
            Exchange::Mean(Mean::Harmonic) => 2.0 * one * other / (one + other),
            Exchange::Mean(Mean::Arithmetic) => 0.5 * (one + other),
            Exchange::Mean(Mean::Geometric) => (one * other).sqrt(),
            Exchange::Upstream if warm > cold => one,
            Exchange::Upstream => other,
        }
    }

    #[inline]
    fn is_frozen(&self, heat: f64) -> bool {
        self.thermal.frozen_fraction(heat * self.per_heat) >= 1.0
    }

    #[inline]
    fn is_liquid(&self, heat: f64) -> bool {
        self.thermal.frozen_fraction(heat * self.per_heat) <= 0.0
    }

    fn see_at(&self, temperature: f64) -> SeenState {
        let on_scale = temperature * self.degree + self.zero;
        SeenState {
            level: self.thermal.potential_at(on_scale) / (self.conductivity * self.degree),
            conductivity: self.thermal.curve.conductivity(on_scale) / self.conductivity,
        }
    }
}
