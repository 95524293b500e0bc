//! What one DPD unit of a material is in SI (Ng et al. 2017, section 2 and eq 26).

use super::Constants;

/// Boltzmann constant (J/K), exact by definition of the kelvin.
pub const BOLTZMANN: f64 = 1.380649e-23;

/// A material in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealFluid {
    /// Density (kg/m3).
    pub density: f64,
    /// Heat capacity (J/(kg K)).
    pub heat_capacity: f64,
}

/// DPD units of a material in SI.
///
/// A cube of the unit of length holds `rho` particles, and the heat capacity of a particle is `C_v` times k_B. The
/// material then fixes length and mass; the reference temperature fixes the energy, and with it a unit of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Unit of length (m).
    pub length: f64,
    /// Unit of mass: that of a particle (kg).
    pub mass: f64,
    /// Unit of temperature (K).
    pub temperature: f64,
    /// Unit of energy, k_B times that of temperature (J).
    pub energy: f64,
    /// Unit of time in which that energy moves that mass, `length sqrt(mass / energy)` (s).
    pub time: f64,
}

impl Scales {
    /// The units of a material whose particles have these constants, with the reference temperature in K.
    pub fn new(constants: &Constants, material: &RealFluid, temperature: f64) -> Scales {
        let mass = constants.heat_capacity * BOLTZMANN / material.heat_capacity;
        let length = (constants.density * mass / material.density).cbrt();
        let energy = BOLTZMANN * temperature;
        Scales { length, mass, temperature, energy, time: length * (mass / energy).sqrt() }
    }

    /// Latent heat of a particle in DPD units from that of the material (J/kg): eq 26 with the third power of the length,
    /// `(L / c) (C_v / T)`. It does not depend on k_B.
    pub fn latent_heat(&self, latent_heat: f64) -> f64 {
        self.mass * latent_heat / self.energy
    }

    /// Unit of time (s) in which a diffusivity or viscosity in DPD units is the material's own (m2/s).
    pub fn diffusive_time(&self, dpd: f64, material: f64) -> f64 {
        self.length * self.length * dpd / material
    }
}
