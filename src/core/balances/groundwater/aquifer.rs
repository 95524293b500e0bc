//! One material as water sees it.

use crate::physics::curved::Curved;
use crate::physics::material::Pores;
use crate::physics::potential::PotentialLaw;
use crate::physics::thermal::Thermal;

/// Temperature of a particle by its enthalpy, fast.
#[derive(Debug, Clone)]
pub(super) enum Warmth {
    /// Straight pieces.
    Exact(Box<Thermal>),
    /// A table of the temperature above the freezing point, by the enthalpy from there.
    Table { table: Curved, freezing_point: f64, zero_enthalpy: f64 },
}

impl Warmth {
    pub(super) fn new(thermal: &Thermal) -> Self {
        if thermal.curve.is_kinked() {
            return Warmth::Exact(Box::new(thermal.clone()));
        }
        let (freezing_point, zero_enthalpy) = (thermal.curve.freezing_point(), thermal.zero_enthalpy);
        Warmth::Table { table: Curved::of_temperature(&thermal.curve), freezing_point, zero_enthalpy }
    }

    #[inline]
    pub(super) fn at(&self, enthalpy: f64) -> f64 {
        match self {
            Warmth::Exact(thermal) => thermal.curve.temperature(enthalpy + thermal.zero_enthalpy),
            Warmth::Table { table, freezing_point, zero_enthalpy } => {
                freezing_point + table.potential(enthalpy + zero_enthalpy)
            }
        }
    }
}

/// One material as water sees it.
#[derive(Debug, Clone)]
pub(super) struct Aquifer {
    pub(super) warmth: Warmth,
    pub(super) thermal: Thermal,
    pub(super) pores: Pores,
    /// Hydraulic conductivity of thawed ground (m2/(Pa s)).
    pub(super) open: f64,
    /// Whether it freezes at one temperature, which then does not tell how much is frozen.
    pub(super) by_enthalpy: bool,
}

impl Aquifer {
    /// Unfrozen fraction of a particle of this enthalpy (J/m3) and temperature.
    #[inline]
    pub(super) fn unfrozen(&self, enthalpy: f64, temperature: f64) -> f64 {
        // The temperature is known already, but says nothing of ground that freezes at one.
        match self.by_enthalpy {
            true => 1.0 - self.thermal.frozen_fraction(enthalpy),
            false => self.thermal.curve.unfrozen_fraction(temperature),
        }
    }

    /// Water that freezing of all pores would push aside (by volume).
    pub(super) fn expansion(&self) -> f64 {
        self.pores.porosity * (1.0 - self.pores.ice_density / self.pores.water_density)
    }
}
