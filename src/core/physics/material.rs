//! Materials: what frozen and unfrozen ground conduct and store, and how they freeze.

pub use crate::physics::freezing_curve::FreezingLaw;
pub use crate::physics::mixing::Mixing;
pub use crate::physics::retention::moisture::Soil;

/// One phase of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Thermal conductivity (W/mK).
    pub conductivity: f64,
    /// Heat capacity by mass (J/kgK).
    pub heat_capacity: f64,
}

/// What water finds in a saturated porous material. Heat needs none of it: the phases of the material hold all three
/// of solid, ice and water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pores {
    /// Volume of pores by volume, greater than 0 to 1.
    pub porosity: f64,
    /// Density of water (kg/m3).
    pub water_density: f64,
    /// Density of ice (kg/m3).
    pub ice_density: f64,
    /// Heat capacity of water by mass (J/kgK).
    pub water_heat_capacity: f64,
    /// Intrinsic permeability (m2), if water flows.
    pub permeability: Option<f64>,
}

/// A material with constant density.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in the scene.
    pub name: String,
    /// Density of both phases (kg/m3).
    pub density: f64,
    /// Frozen properties.
    pub frozen: Phase,
    /// Unfrozen properties.
    pub unfrozen: Phase,
    /// Freezing point: where freezing begins on cooling.
    pub freezing_point: f64,
    /// Latent heat by mass of material (J/kg).
    pub latent_heat: f64,
    /// Freezing curve.
    pub law: FreezingLaw,
    /// Conductivity of partly frozen material.
    pub mixing: Mixing,
    /// Its pores, where the scene gives it as solid, water and ice.
    pub pores: Option<Pores>,
    /// What unsaturated water finds in it, where it is given for water and not for heat; all of the above but the name then
    /// stands idle.
    pub soil: Option<Soil>,
}

impl Material {
    /// Whether it has latent heat.
    pub fn freezes(&self) -> bool {
        self.law != FreezingLaw::None
    }

    /// Whether all of it freezes at one temperature.
    pub fn is_sharp(&self) -> bool {
        self.law == FreezingLaw::Isothermal
    }

    /// Whether it freezes over an interval of temperatures.
    pub fn has_curve(&self) -> bool {
        matches!(self.law, FreezingLaw::Curve(_))
    }

    /// Volumetric heat capacity of the frozen phase (J/m3K).
    pub fn frozen_capacity(&self) -> f64 {
        self.density * self.frozen.heat_capacity
    }

    /// Volumetric heat capacity of the unfrozen phase (J/m3K).
    pub fn unfrozen_capacity(&self) -> f64 {
        self.density * self.unfrozen.heat_capacity
    }

    /// Latent heat by volume (J/m3).
    pub fn volumetric_latent_heat(&self) -> f64 {
        if self.freezes() { self.density * self.latent_heat } else { 0.0 }
    }
}
