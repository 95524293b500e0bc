//! What a material does to a solute.

/// How the pores slow molecular diffusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tortuosity {
    /// Not at all: the diffusion of the material is that of the wet ground, by its whole volume and whatever it holds.
    None,
    /// By the water content theta: `theta^(10/3) / saturated^2` (Millington and Quirk 1961), by the volume of the ground.
    MillingtonQuirk {
        /// Water content of the saturated material.
        saturated: f64,
    },
}

/// What a material does to a solute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoluteMaterial {
    /// Molecular diffusion (m2/s).
    pub diffusion: f64,
    /// How pores slow it.
    pub tortuosity: Tortuosity,
    /// Length (m) over which flowing water spreads the solute along itself.
    pub longitudinal_dispersivity: f64,
    /// The same across the flow (m).
    pub transverse_dispersivity: f64,
    /// What the grains hold for each concentration in the water, by volume: density of the dry ground times the
    /// coefficient of linear sorption.
    pub sorption: f64,
    /// Rate of decay (1/s), the same in water and on grains.
    pub decay: f64,
}

impl SoluteMaterial {
    /// Molecular diffusion (m2/s) by volume at a water content.
    pub(crate) fn molecular(&self, content: f64) -> f64 {
        match self.tortuosity {
            Tortuosity::None => self.diffusion,
            Tortuosity::MillingtonQuirk { saturated } => {
                self.diffusion * content.max(0.0).powf(10.0 / 3.0) / (saturated * saturated)
            }
        }
    }

    /// Whether flowing water spreads the solute.
    pub(crate) fn disperses(&self) -> bool {
        self.longitudinal_dispersivity > 0.0 || self.transverse_dispersivity > 0.0
    }
}
