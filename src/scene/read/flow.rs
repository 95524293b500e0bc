//! Groundwater.

use glam::DVec2;

use super::body::{wall_named, wall_names};
use super::problem::{Noted, Read};
use super::range::Range;
use super::section::Section;
use frazil_core::balances::groundwater::ground::{Across, Flow, PressureWall, RelativePermeability};
use frazil_core::physics::material::Material;
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::wall::WallId;

const PERMEABILITY: (&str, &str) = ("permeability", "m2");
const VELOCITY: (&str, &str) = ("velocity", "m_per_day");
const DIRECTION: (&str, &str) = ("direction", "deg");

/// Seconds of a day.
const DAY: f64 = 86400.0;

/// Reads the section `flow`, if there is one and it is not refused; `materials` is empty where some could not be read.
pub(super) fn flow(
    root: &mut Section<'_>,
    domain: Option<&Domain>,
    materials: &[Material],
    refused: Option<Noted>,
) -> Read<Option<Flow>> {
    if !root.has("flow") {
        still(root, materials);
    }
    let Some(mut section) = root.optional_section("flow") else { return Ok(None) };
    if let Some(noted) = refused {
        section.abandon();
        return Err(noted);
    }
    carry(&mut section, materials);
    let viscosity = section.positive(("viscosity", "Pa_s"));
    let open = open(&mut section, domain, materials, viscosity);
    let freezes = materials.iter().any(Material::freezes);
    let (law, least) = match section.optional_section("relative_permeability") {
        Some(mut table) => relative_permeability(&mut table),
        None if freezes => {
            (Err(section.problem("relative_permeability", "missing, must be a table: the ground freezes")), 1.0)
        }
        None => (Ok(RelativePermeability::Impedance(0.0)), 1.0),
    };
    let density_change = section.flag_or("density_change", freezes);
    if density_change && !freezes && !materials.is_empty() {
        section.problem("density_change", "has no effect, no material freezes");
    }
    let crosses = matches!(domain, Some(Domain::Ring { .. }));
    let gravity = match domain {
        Some(Domain::Rectangle { .. }) => section.number_or(("gravity", "m_per_s2"), 0.0, Range::NOT_NEGATIVE),
        _ => {
            let level = if crosses { "the plan of a ring is horizontal" } else { "a line is horizontal" };
            section.refuse(("gravity", "m_per_s2"), level);
            0.0
        }
    };
    let cut = match domain {
        Some(Domain::Rectangle { height, .. }) => {
            section.optional_number(("cut_y", "m"), Range::within_body(0.0, *height))
        }
        _ => {
            section.refuse(("cut_y", "m"), if crosses { "a ring has rays" } else { "a line has no y" });
            None
        }
    };
    let (walls, across) = open?;
    Ok(Some(Flow {
        cut,
        viscosity: viscosity?,
        walls,
        across,
        relative_permeability: law?,
        least_relative_permeability: least,
        density_change,
        gravity,
    }))
}

/// Refuses permeabilities of ground in which no water flows.
fn still(root: &mut Section<'_>, materials: &[Material]) {
    let permeable = |material: &&Material| material.pores.is_some_and(|pores| pores.permeability.is_some());
    for material in materials.iter().filter(permeable) {
        let name = &material.name;
        root.problem(
            "materials",
            format!("has no effect, the scene has no section \"flow\" that moves water through \"{name}\""),
        );
    }
}

/// Refuses ground through which no water can flow.
fn carry(section: &mut Section<'_>, materials: &[Material]) {
    for material in materials {
        let missing = match material.pores {
            None => {
                "a table \"groundwater\", or porosity, water, ice and solid instead of density, frozen and unfrozen"
                    .to_owned()
            }
            Some(pores) if pores.permeability.is_none() => format!("\"{}_{}\"", PERMEABILITY.0, PERMEABILITY.1),
            Some(_) => continue,
        };
        section.section_problem(format!("water flows through \"{}\", which must have {missing}", material.name));
    }
}

/// Where water comes in and goes out: through walls of known pressure, or from afar across a ring.
fn open(
    section: &mut Section<'_>,
    domain: Option<&Domain>,
    materials: &[Material],
    viscosity: Read<f64>,
) -> Read<(Vec<PressureWall>, Option<Across>)> {
    let Some(Domain::Ring { outer_radius, sector }) = domain else {
        section.refuse(VELOCITY, "only the domain \"ring\" has an undisturbed velocity");
        section.refuse(DIRECTION, "only the domain \"ring\" has an undisturbed velocity");
        return Ok((walls(section, domain), None));
    };
    section.refuse("walls", "a ring has an undisturbed velocity, velocity_m_per_day");
    let (velocity, across) = across(section, *outer_radius, *sector)?;
    // Darcy's law in the first material; one without permeability has been told of.
    let Some(ground) = materials.first().and_then(|material| material.pores?.permeability) else {
        return Ok((Vec::new(), None));
    };
    let pressure = velocity.scaled(viscosity? * across.radius / (DAY * ground));
    Ok((vec![PressureWall { wall: WallId::Outer, pressure }], Some(across)))
}

/// Groundwater that crosses a ring: its velocity (m a day) far from what freezes, and its direction.
fn across(section: &mut Section<'_>, radius: f64, sector: Sector) -> Read<(Series, Across)> {
    let velocity = section.series(VELOCITY, Range::NOT_NEGATIVE);
    let degrees = section.number_or(DIRECTION, 0.0, Range::ANY);
    let along_x = degrees.rem_euclid(180.0) == 0.0;
    match sector {
        Sector::Quarter => {
            section.section_problem(
                "cannot be solved in a quarter, as water crosses its mirror planes: set domain.ring.sector = \"half\" or \
                 \"whole\"",
            );
        }
        Sector::Half if !along_x => {
            let message = format!(
                "found {degrees}, must be 0 or 180 in a half, whose mirror plane is the x axis: set domain.ring.sector = \
                 \"whole\""
            );
            section.problem(DIRECTION, message);
        }
        Sector::Half | Sector::Whole => {}
    }
    let direction = if along_x {
        DVec2::new(if degrees.rem_euclid(360.0) == 0.0 { 1.0 } else { -1.0 }, 0.0)
    } else {
        DVec2::from_angle(degrees.to_radians())
    };
    Ok((velocity?, Across { direction, radius }))
}

fn walls(section: &mut Section<'_>, domain: Option<&Domain>) -> Vec<PressureWall> {
    let Ok(mut table) = section.section("walls") else { return Vec::new() };
    let mut found = Vec::new();
    let mut open = 0;
    for (name, mut wall) in table.named_sections() {
        let pressure = wall.series(("pressure", "Pa"), Range::ANY);
        open += 1;
        let Some(domain) = domain else { continue };
        match wall_named(domain, &name) {
            Some(wall) => found.extend(pressure.map(|pressure| PressureWall { wall, pressure })),
            None => {
                wall.section_problem(format!("the domain has no such wall, it has {}", wall_names(domain)));
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

fn relative_permeability(table: &mut Section<'_>) -> (Read<RelativePermeability>, f64) {
    let law = match table.choice("law", &[("impedance", true), ("power", false)]) {
        Ok(true) => {
            table.refuse("exponent", "only the law \"power\" has an exponent");
            table.number("impedance", Range::NOT_NEGATIVE).map(RelativePermeability::Impedance)
        }
        Ok(false) => {
            table.refuse("impedance", "only the law \"impedance\" has an impedance");
            table.positive("exponent").map(RelativePermeability::Power)
        }
        Err(noted) => {
            table.abandon();
            Err(noted)
        }
    };
    // The pressures of a contrast beyond 1e12 would be lost in rounding.
    (law, table.number_or("least", 1e-6, Range::between(1e-12, 1.0)))
}
