//! One material as water sees it.

use crate::memory::HeapSize;
use crate::physics::curved::Curved;
use crate::physics::material::Pores;
use crate::physics::potential::Law;
use crate::physics::thermal::Thermal;

/// Particles whose temperatures are looked up at once.
const AT_ONCE: usize = 256;

/// One material as water sees it.
#[derive(Debug, Clone)]
pub(super) struct Aquifer {
    pub(super) thermal: Thermal,
    pub(super) pores: Pores,
    /// Hydraulic conductivity of thawed ground (m2/(Pa s)).
    pub(super) open: f64,
    /// Whether it freezes at one temperature, which then does not tell how much is frozen.
    by_enthalpy: bool,
    /// The temperature above the freezing point by the enthalpy from there, in a table, where it does not go in straight pieces.
    table: Option<Law>,
}

impl HeapSize for Aquifer {
    fn heap_size(&self) -> usize {
        self.table.as_ref().map_or(0, HeapSize::heap_size)
    }
}

impl Aquifer {
    /// A material, with pores through which open ground conducts water (m2/(Pa s)), that freezes at one temperature or not.
    pub(super) fn new(thermal: &Thermal, pores: Pores, open: f64, by_enthalpy: bool) -> Self {
        let table = (!thermal.curve.is_kinked()).then(|| Law::Curved(Curved::of_temperature(&thermal.curve)));
        Aquifer { thermal: thermal.clone(), pores, open, by_enthalpy, table }
    }

    /// Temperatures of particles of these enthalpies (J/m3).
    pub(super) fn fill_temperatures(&self, enthalpy: &[f64], temperatures: &mut [f64]) {
        let Some(table) = &self.table else { return self.thermal.fill_temperatures(enthalpy, temperatures) };
        let (freezing_point, zero_enthalpy) = (self.thermal.curve.freezing_point(), self.thermal.zero_enthalpy);
        let mut absolute = [0.0; AT_ONCE];
        for (enthalpy, temperatures) in enthalpy.chunks(AT_ONCE).zip(temperatures.chunks_mut(AT_ONCE)) {
            let absolute = &mut absolute[..enthalpy.len()];
            for (absolute, enthalpy) in absolute.iter_mut().zip(enthalpy) {
                *absolute = enthalpy + zero_enthalpy;
            }
            table.fill(absolute, temperatures);
            for temperature in temperatures {
                *temperature += freezing_point;
            }
        }
    }

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
