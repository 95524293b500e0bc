//! Saturated porous materials: solid, ice and water put together to what heat meets.

use super::problem::Read;
use super::range::Range;
use super::section::Section;
use frazil_core::physics::material::{Mixing, Phase, Pores};

/// One of the three phases.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    density: f64,
    conductivity: f64,
    heat_capacity: f64,
}

/// A porous material as read, before its freezing law says how conductivities mix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Porous {
    pub(super) pores: Pores,
    water: Part,
    ice: Part,
    /// Absent where pores are all there is.
    solid: Option<Part>,
}

/// What heat meets of it.
pub(super) struct Whole {
    pub(super) density: f64,
    pub(super) frozen: Phase,
    pub(super) unfrozen: Phase,
    /// Ice in a unit of mass of the thawed material.
    pub(super) ice_share: f64,
}

/// Whether a material is given by its phases.
pub(super) fn is_porous(section: &Section<'_>) -> bool {
    ["porosity", "solid", "ice", "water"].iter().any(|key| section.has(*key))
}

/// Reads the phases. Where nothing freezes, ice is left out and stands for water.
pub(super) fn porous(section: &mut Section<'_>, freezes: bool) -> Read<Porous> {
    let reason = "a porous material has it from solid, ice and water";
    section.refuse(("density", "kg_per_m3"), reason);
    section.refuse("frozen", reason);
    section.refuse("unfrozen", reason);
    section.refuse("groundwater", reason);
    let porosity = section.number("porosity", Range::above_to(0.0, 1.0));
    let water = section.section("water").and_then(part);
    let ice = if freezes {
        section.section("ice").and_then(part)
    } else {
        section.refuse("ice", "law \"none\" has no ice");
        water
    };
    let solid = if porosity == Ok(1.0) {
        section.refuse("solid", "a material of porosity 1 has no solid");
        None
    } else {
        Some(section.section("solid").and_then(part))
    };
    let permeability = section.optional_number(("permeability", "m2"), Range::POSITIVE);
    let (water, ice) = (water?, ice?);
    let pores = Pores {
        porosity: porosity?,
        water_density: water.density,
        ice_density: ice.density,
        water_heat_capacity: water.heat_capacity,
        permeability,
    };
    Ok(Porous { pores, water, ice, solid: solid.transpose()? })
}

/// The water in a material that is given as a whole. Its ice has the density of water.
pub(super) fn groundwater(mut section: Section<'_>) -> Read<Pores> {
    let porosity = section.number("porosity", Range::above_to(0.0, 1.0));
    let density = section.positive(("density", "kg_per_m3"));
    let heat_capacity = section.positive(("heat_capacity", "J_per_kg_K"));
    let permeability = section.positive(("permeability", "m2"));
    Ok(Pores {
        porosity: porosity?,
        water_density: density?,
        ice_density: density?,
        water_heat_capacity: heat_capacity?,
        permeability: Some(permeability?),
    })
}

fn part(mut section: Section<'_>) -> Read<Part> {
    let density = section.positive(("density", "kg_per_m3"));
    let conductivity = section.positive(("conductivity", "W_per_m_K"));
    let heat_capacity = section.positive(("heat_capacity", "J_per_kg_K"));
    Ok(Part { density: density?, conductivity: conductivity?, heat_capacity: heat_capacity? })
}

impl Porous {
    /// The material with pores full of water or ice. Conductivities mix in the same way among phases as between the
    /// frozen and the unfrozen state, so that a partly frozen material mixes all three (Nikolaev et al. 2021, eqs 8, 12).
    pub(super) fn whole(&self, mixing: Mixing) -> Whole {
        let porosity = self.pores.porosity;
        let solid = self.solid.unwrap_or(self.water);
        let mixed = |full: &Part| mixing.conductivity(porosity, full.conductivity, solid.conductivity);
        let density = porosity * self.water.density + (1.0 - porosity) * solid.density;
        let phase = |full: &Part| {
            let capacity =
                porosity * full.density * full.heat_capacity + (1.0 - porosity) * solid.density * solid.heat_capacity;
            Phase { conductivity: mixed(full), heat_capacity: capacity / density }
        };
        let ice_share = porosity * self.ice.density / density;
        Whole { density, frozen: phase(&self.ice), unfrozen: phase(&self.water), ice_share }
    }
}
