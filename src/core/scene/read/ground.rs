//! Materials.

use super::porous::{self, is_porous};
use super::range::{Range, plain, temperatures};
use super::section::Section;
use crate::material::{FreezingLaw, Material, Mixing, Phase};

/// How far apart conductivities, and heats, of the two phases may be: of the sixteen digits of a number ten are left
/// for the smaller.
const MOST_APART: f64 = 1e6;

/// Refuses latent heats beside which the heats of cooling by the temperatures of the scene would be lost in rounding.
pub(super) fn latent_heats(root: &mut Section<'_>, materials: &[Material], temperatures: (f64, f64)) {
    let range = temperatures.1 - temperatures.0;
    for material in materials.iter().filter(|_| range > 0.0) {
        let capacity = material.frozen.heat_capacity.min(material.unfrozen.heat_capacity);
        let most = MOST_APART * capacity * range;
        if material.latent_heat > most {
            let message = format!(
                "\"{}\" has a latent heat of {}, must have at most {}: {MOST_APART:.0e} times the heat of cooling from \
                 the warmest to the coldest temperature of the scene",
                material.name,
                plain(material.latent_heat),
                plain(most)
            );
            root.problem("materials", message);
        }
    }
}

/// Reads all materials; one that has a problem keeps its place, for its name.
pub(super) fn materials(section: &mut Section<'_>) -> Vec<(String, Option<Material>)> {
    let found: Vec<_> = section
        .named_sections()
        .into_iter()
        .map(|(name, mut table)| {
            let material = material(&name, &mut table);
            (name, material)
        })
        .collect();
    if found.is_empty() {
        section.section_problem("missing, must have at least one material, as [materials.water]");
    }
    found
}

fn material(name: &str, section: &mut Section<'_>) -> Option<Material> {
    if is_porous(section) {
        let freezing = section.section("freezing").and_then(freezing);
        let freezes = freezing.as_ref().is_none_or(|freezing| freezing.law != FreezingLaw::None);
        let porous = porous::porous(section, freezes);
        let (porous, freezing) = (porous?, freezing?);
        let whole = porous.whole(freezing.mixing);
        return Some(Material {
            name: name.to_owned(),
            density: whole.density,
            frozen: whole.frozen,
            unfrozen: whole.unfrozen,
            freezing_point: freezing.point,
            // A scene says how much a kilogram of ice takes; here it counts by mass of the whole.
            latent_heat: freezing.latent_heat * whole.ice_share,
            law: freezing.law,
            mixing: freezing.mixing,
            pores: Some(porous.pores()),
        });
    }
    section.refuse(
        ("permeability", "m2"),
        "only a material given by porosity, solid, ice and water has pores; others have it in a table \"groundwater\"",
    );
    let density = section.positive(("density", "kg_per_m3"));
    let frozen = section.section("frozen").and_then(phase);
    let unfrozen = section.section("unfrozen").and_then(phase);
    let freezing = section.section("freezing").and_then(freezing);
    let groundwater = section.optional_section("groundwater").map(porous::groundwater);
    if let (Some(frozen), Some(unfrozen)) = (&frozen, &unfrozen) {
        for (what, a, b) in [
            ("conductivities", frozen.conductivity, unfrozen.conductivity),
            ("heat capacities", frozen.heat_capacity, unfrozen.heat_capacity),
        ] {
            if a.max(b) > MOST_APART * a.min(b) {
                let (a, b) = (plain(a), plain(b));
                let message = format!("found {what} of {a} and {b}, must be within a factor of {MOST_APART:.0e}");
                section.problem("frozen", message);
            }
        }
    }
    let pores = match groundwater {
        Some(read) => Some(read?),
        None => None,
    };
    let freezing = freezing?;
    Some(Material {
        name: name.to_owned(),
        density: density?,
        frozen: frozen?,
        unfrozen: unfrozen?,
        freezing_point: freezing.point,
        latent_heat: freezing.latent_heat,
        law: freezing.law,
        mixing: freezing.mixing,
        pores,
    })
}

fn phase(mut section: Section<'_>) -> Option<Phase> {
    let conductivity = section.positive(("conductivity", "W_per_m_K"));
    let heat_capacity = section.positive(("heat_capacity", "J_per_kg_K"));
    Some(Phase { conductivity: conductivity?, heat_capacity: heat_capacity? })
}

struct Freezing {
    point: f64,
    latent_heat: f64,
    law: FreezingLaw,
    mixing: Mixing,
}

#[derive(Clone, Copy, PartialEq)]
enum Law {
    None,
    Isothermal,
    Linear,
    Weibull,
}

fn freezing(mut section: Section<'_>) -> Option<Freezing> {
    const LATENT_HEAT: (&str, &str) = ("latent_heat", "J_per_kg");
    const WIDTH: (&str, &str) = ("width", "K");
    let laws =
        [("none", Law::None), ("isothermal", Law::Isothermal), ("linear", Law::Linear), ("weibull", Law::Weibull)];
    let coldest = section.units().absolute_zero();
    let law = section.choice("law", &laws);
    let point = section.number(("temperature", "c"), temperatures(coldest));
    let mixings = [("arithmetic", Mixing::Arithmetic), ("geometric", Mixing::Geometric)];
    let Some(law) = law else {
        // Which of the other keys belong depends on the law.
        section.abandon();
        return None;
    };
    let latent_heat = if law == Law::None {
        section.refuse(LATENT_HEAT, "law \"none\" has no latent heat");
        section.refuse("mixing", "law \"none\" has no partly frozen state");
        Some(0.0)
    } else {
        section.positive(LATENT_HEAT)
    };
    let mixing = match law {
        Law::None => Mixing::Arithmetic,
        Law::Weibull => section.choice_or("mixing", &mixings, Mixing::Geometric),
        _ => section.choice_or("mixing", &mixings, Mixing::Arithmetic),
    };
    let width = if matches!(law, Law::Linear | Law::Weibull) {
        section.positive(WIDTH)
    } else {
        section.refuse(WIDTH, "only the laws \"linear\" and \"weibull\" have a width");
        None
    };
    if let (Some(point), Some(width)) = (point, width)
        && point - width <= coldest
    {
        let message = format!("found {}, must end above absolute zero, {}", plain(width), plain(coldest));
        section.problem(WIDTH, message);
    }
    if law != Law::Weibull {
        section.refuse("residual_fraction", "only the law \"weibull\" leaves a residue");
    }
    let law = match law {
        Law::None => FreezingLaw::None,
        Law::Isothermal => FreezingLaw::Isothermal,
        Law::Linear => FreezingLaw::Linear { width: width? },
        Law::Weibull => {
            let residual = section.number_or("residual_fraction", 0.0, Range::from_to_below(0.0, 1.0));
            FreezingLaw::Weibull { width: width?, residual }
        }
    };
    Some(Freezing { point: point?, latent_heat: latent_heat?, law, mixing })
}
