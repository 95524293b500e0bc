//! Groundwater.

use super::body::wall_names;
use super::range::{Range, all_of};
use super::section::Section;
use crate::material::{FreezingLaw, Material};
use crate::scene::{Domain, Flow, PressureWall, RelativePermeability};

const PERMEABILITY: (&str, &str) = ("permeability", "m2");

/// Reads the section `flow`, if there is one; `materials` is empty where some could not be read. The
/// flags tell of cracks and of surfaces, which water does not know.
pub(super) fn flow(
    root: &mut Section<'_>,
    domain: Option<&Domain>,
    materials: &[Material],
    (cracks, surfaces): (bool, bool),
) -> Option<Flow> {
    if !root.has("flow") {
        for material in materials {
            if material.pores.is_some_and(|pores| pores.permeability.is_some()) {
                let message = format!(
                    "has no effect, the scene has no section \"flow\" that moves water through \"{}\"",
                    material.name
                );
                root.problem("materials", message);
            }
        }
    }
    let mut section = root.optional_section("flow")?;
    let beside = match domain {
        Some(Domain::Ring { .. }) => Some("in a ring: water needs straight walls to enter and leave by"),
        Some(Domain::Radial { .. } | Domain::Axial { .. }) => {
            Some("where particles are shells: water flows through a line or a rectangle")
        }
        _ if cracks => Some("beside \"cracks\", which would cut the ways of water too"),
        _ if surfaces => Some("beside \"watch.surfaces\", which count what is conducted and not what water carries"),
        _ => None,
    };
    if let Some(beside) = beside {
        section.section_problem(format!("must not be {beside}"));
        section.abandon();
        return None;
    }
    for material in materials {
        let missing = match material.pores {
            None => "porosity, water, ice and solid instead of density, frozen and unfrozen".to_owned(),
            Some(pores) if pores.permeability.is_none() => format!("\"{}_{}\"", PERMEABILITY.0, PERMEABILITY.1),
            Some(_) => continue,
        };
        section.section_problem(format!("water flows through \"{}\", which must have {missing}", material.name));
    }
    let viscosity = section.positive(("viscosity", "Pa_s"));
    let walls = walls(&mut section, domain);
    let freezes = materials.iter().any(|material| material.law != FreezingLaw::None);
    let (law, least) = match section.optional_section("relative_permeability") {
        Some(mut table) => relative_permeability(&mut table),
        None if freezes => {
            section.problem("relative_permeability", "missing, must be a table: the ground freezes");
            (None, 1.0)
        }
        None => (Some(RelativePermeability::Impedance(0.0)), 1.0),
    };
    let density_change = section.flag_or("density_change", freezes);
    if density_change && !freezes && !materials.is_empty() {
        section.problem("density_change", "has no effect, no material freezes");
    }
    let gravity = match domain {
        Some(Domain::Rectangle { .. }) => section.number_or(("gravity", "m_per_s2"), 0.0, Range::NOT_NEGATIVE),
        _ => {
            section.refuse(("gravity", "m_per_s2"), "a line lies level");
            0.0
        }
    };
    let cut = match domain {
        Some(Domain::Rectangle { height, .. }) => section.optional_number(("cut_y", "m"), Range::between(0.0, *height)),
        _ => {
            section.refuse(("cut_y", "m"), "a line has no y");
            None
        }
    };
    Some(Flow {
        cut,
        viscosity: viscosity?,
        walls,
        relative_permeability: law?,
        least_relative_permeability: least,
        density_change,
        gravity,
    })
}

fn walls(section: &mut Section<'_>, domain: Option<&Domain>) -> Vec<PressureWall> {
    let Some(mut table) = section.section("walls") else { return Vec::new() };
    let mut found = Vec::new();
    let mut open = 0;
    for (name, mut wall) in table.named_sections() {
        let pressure = wall.series(("pressure", "Pa"), Range::ANY);
        open += 1;
        let Some(domain) = domain else { continue };
        let names = wall_names(domain);
        match names.iter().find(|known| **known == name) {
            Some(name) => found.extend(pressure.map(|pressure| PressureWall { name, pressure })),
            None => {
                let names = all_of(names.iter().copied());
                wall.section_problem(format!("the domain has no such wall, it has {names}"));
            }
        }
    }
    if open == 0 {
        table.section_problem(
            "must have a wall of given pressure: in a closed box no water moves, and what freezing pushes aside has \
             nowhere to go",
        );
    }
    found
}

fn relative_permeability(table: &mut Section<'_>) -> (Option<RelativePermeability>, f64) {
    let law = match table.choice("law", &[("impedance", true), ("power", false)]) {
        Some(true) => {
            table.refuse("exponent", "only the law \"power\" has an exponent");
            table.number("impedance", Range::NOT_NEGATIVE).map(RelativePermeability::Impedance)
        }
        Some(false) => {
            table.refuse("impedance", "only the law \"impedance\" has an impedance");
            table.positive("exponent").map(RelativePermeability::Power)
        }
        None => {
            table.abandon();
            None
        }
    };
    // The pressures of a contrast beyond 1e12 would be lost in rounding.
    (law, table.number_or("least", 1e-6, Range::between(1e-12, 1.0)))
}
