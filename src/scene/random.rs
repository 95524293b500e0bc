//! Ground that varies at random in place.

use frazil_core::space::random_field::Variation;

/// Which properties of the ground vary at random, around those of its materials.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RandomGround {
    /// The conductivity: of heat, frozen and unfrozen alike, or of unsaturated water.
    pub conductivity: Option<Variation>,
    /// The permeability to groundwater.
    pub permeability: Option<Variation>,
}

impl RandomGround {
    /// Whether none does.
    pub fn is_even(&self) -> bool {
        self.conductivity.is_none() && self.permeability.is_none()
    }

    /// Those that do, each with its name.
    pub fn variations(&self) -> impl Iterator<Item = (&'static str, &Variation)> {
        [("conductivity", &self.conductivity), ("permeability", &self.permeability)]
            .into_iter()
            .filter_map(|(name, variation)| Some((name, variation.as_ref()?)))
    }
}
