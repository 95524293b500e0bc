//! Materials.

use super::known::known;
use super::porous::{self, is_porous};
use super::problem::{Noted, Read};
use super::range::{Range, one_of, plain, temperatures};
use super::section::{Key, Section};
use super::water::soil;
use crate::units::Units;
use frazil_core::physics::freezing_curve::shape::{Given, Parameter, Quantity, Refusal};
use frazil_core::physics::freezing_curve::{CURVES, CurveKind, FreezingCurve, FreezingLaw};
use frazil_core::physics::material::{Material, Mixing, Phase};

/// Most materials of a scene: particles name theirs by a byte.
const MOST: usize = 255;

/// How far apart conductivities, and heats, of the two phases may be: of the sixteen digits of a number ten are left
/// for the smaller.
const MOST_APART: f64 = 1e6;

/// Stefan number, heat of cooling to the coldest or of warming to the warmest temperature over latent heat, up to which fronts
/// inside particles are worth their steps (see docs/theory/heat.md).
const SLOW_FRONT: f64 = 2.0;

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

/// Whether temperatures of this range, or fluxes, freeze or thaw a material that freezes at one temperature, and none that they
/// freeze has a Stefan number above that of slow fronts.
pub(super) fn has_slow_fronts(materials: &[Material], (coldest, warmest): (f64, f64), heated: bool) -> bool {
    let reached = |material: &&Material| {
        let within = coldest <= material.freezing_point && material.freezing_point <= warmest && coldest < warmest;
        material.is_sharp() && (within || heated)
    };
    let is_slow = |material: &Material| {
        let cooling = material.frozen.heat_capacity * (material.freezing_point - coldest);
        let warming = material.unfrozen.heat_capacity * (warmest - material.freezing_point);
        cooling.max(warming) <= SLOW_FRONT * material.latent_heat
    };
    let mut found = materials.iter().filter(reached).peekable();
    found.peek().is_some() && found.all(is_slow)
}

/// Reads all materials; one that has a problem keeps its place, for its name.
pub(super) fn materials(section: &mut Section<'_>, water: bool) -> Vec<(String, Read<Material>)> {
    let mut tables = section.named_sections();
    if tables.len() > MOST {
        section.section_problem(format!("found {} materials, must be at most {MOST}", tables.len()));
        tables.iter_mut().for_each(|(_, table)| table.abandon());
        return Vec::new();
    }
    let found: Vec<_> = tables
        .into_iter()
        .map(|(name, mut table)| {
            let material = if water { soil(&name, &mut table) } else { material(&name, &mut table) };
            (name, material)
        })
        .collect();
    if found.is_empty() {
        section.section_problem("missing, must have at least one material, as [materials.water]");
    }
    found
}

pub(super) fn material(name: &str, section: &mut Section<'_>) -> Read<Material> {
    if let Some(known) = known(name, section) {
        return known;
    }
    if is_porous(section) {
        let freezing = section.section("freezing").and_then(freezing);
        let freezes = !matches!(&freezing, Ok(freezing) if freezing.law == FreezingLaw::None);
        let porous = porous::porous(section, freezes);
        let (porous, freezing) = (porous?, freezing?);
        let whole = porous.whole(freezing.mixing);
        return Ok(Material {
            name: name.to_owned(),
            density: whole.density,
            frozen: whole.frozen,
            unfrozen: whole.unfrozen,
            freezing_point: freezing.point,
            // A scene says how much a kilogram of ice takes; here it counts by mass of the whole.
            latent_heat: freezing.latent_heat * whole.ice_share,
            law: freezing.law,
            mixing: freezing.mixing,
            pores: Some(porous.pores),
            soil: None,
        });
    }
    section.refuse(
        ("permeability", "m2"),
        "only a material given by porosity, solid, ice and water has it here; others have it in a table \"groundwater\"",
    );
    let density = section.positive(("density", "kg_per_m3"));
    let phase = |section: Section<'_>| phase(section, &density);
    let frozen = section.section("frozen").and_then(phase);
    let unfrozen = section.section("unfrozen").and_then(phase);
    let freezing = section.section("freezing").and_then(freezing);
    let groundwater = section.optional_section("groundwater").map(porous::groundwater);
    if let (Ok(frozen), Ok(unfrozen)) = (&frozen, &unfrozen) {
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
    let freezing = freezing?;
    Ok(Material {
        name: name.to_owned(),
        density: density?,
        frozen: frozen?,
        unfrozen: unfrozen?,
        freezing_point: freezing.point,
        latent_heat: freezing.latent_heat,
        law: freezing.law,
        mixing: freezing.mixing,
        pores: groundwater.transpose()?,
        soil: None,
    })
}

/// A phase of a material of a density (kg/m3). What the phase weighs itself counts in its heat capacity, which is by mass of the material.
fn phase(mut section: Section<'_>, density: &Read<f64>) -> Read<Phase> {
    let conductivity = section.positive(("conductivity", "W_per_m_K"));
    let heat_capacity = section.positive(("heat_capacity", "J_per_kg_K"));
    let own = section.optional_number(("density", "kg_per_m3"), Range::POSITIVE);
    let share = own.map_or(Ok(1.0), |own| density.map(|density| own / density));
    Ok(Phase { conductivity: conductivity?, heat_capacity: heat_capacity? * share? })
}

struct Freezing {
    point: f64,
    latent_heat: f64,
    law: FreezingLaw,
    mixing: Mixing,
}

/// A law as a scene names it.
#[derive(Clone, Copy)]
enum Law {
    None,
    Isothermal,
    Curve(&'static CurveKind),
}

fn freezing(mut section: Section<'_>) -> Read<Freezing> {
    const LATENT_HEAT: (&str, &str) = ("latent_heat", "J_per_kg");
    let curves = CURVES.iter().map(|kind| (kind.word, Law::Curve(kind)));
    let laws: Vec<(&str, Law)> =
        [("none", Law::None), ("isothermal", Law::Isothermal)].into_iter().chain(curves).collect();
    let coldest = section.units().absolute_zero();
    let law = section.choice("law", &laws);
    let point = section.number(("temperature", "c"), temperatures(coldest));
    let mixings = [("arithmetic", Mixing::Arithmetic), ("geometric", Mixing::Geometric)];
    let law = law.inspect_err(|_| {
        // Which of the other keys belong depends on the law.
        section.abandon();
    })?;
    let latent_heat = if matches!(law, Law::None) {
        section.refuse(LATENT_HEAT, "law \"none\" has no latent heat");
        section.refuse("mixing", "law \"none\" has no partly frozen state");
        Ok(0.0)
    } else {
        section.positive(LATENT_HEAT)
    };
    let mixing = match law {
        Law::None => Mixing::Arithmetic,
        Law::Isothermal => section.choice_or("mixing", &mixings, Mixing::Arithmetic),
        Law::Curve(kind) => section.choice_or("mixing", &mixings, kind.mixing),
    };
    let own: &[Parameter] = match law {
        Law::None | Law::Isothermal => &[],
        Law::Curve(kind) => kind.parameters,
    };
    let is_own = |key: Key| own.iter().any(|parameter| Key::from(parameter.key()) == key);
    let mut others: Vec<Key> =
        CURVES.iter().flat_map(|kind| kind.parameters).map(|parameter| parameter.key().into()).collect();
    others.sort_unstable();
    others.dedup();
    for key in others.into_iter().filter(|key| !is_own(*key)) {
        let having =
            CURVES.iter().filter(|kind| kind.parameters.iter().any(|parameter| Key::from(parameter.key()) == key));
        section.refuse(key, &format!("only with law = {}", one_of(having.map(|kind| kind.word))));
    }
    let law = match law {
        Law::None => Ok(FreezingLaw::None),
        Law::Isothermal => Ok(FreezingLaw::Isothermal),
        Law::Curve(kind) => curve(&mut section, kind, point).map(FreezingLaw::Curve),
    };
    Ok(Freezing { point: point?, latent_heat: latent_heat?, law: law?, mixing })
}

/// The curve of a kind by its keys.
fn curve(section: &mut Section<'_>, kind: &CurveKind, point: Read<f64>) -> Read<FreezingCurve> {
    if kind.needs_si && section.units() != Units::Si {
        let units = section.units().name();
        let message =
            format!("found \"{}\" beside units = \"{units}\", needs units = \"si\" for its constants", kind.word);
        section.problem("law", message);
    }
    let given = parameters(section, kind.parameters, point)?;
    (kind.make)(&given).map_err(|refusal| refused(section, kind.parameters, refusal))
}

/// The values of the keys of a curve.
pub(super) fn parameters(section: &mut Section<'_>, keys: &[Parameter], point: Read<f64>) -> Read<Given> {
    let values: Vec<Read<Vec<f64>>> = keys.iter().map(|parameter| values(section, parameter, point)).collect();
    let values = values.into_iter().collect::<Read<Vec<_>>>()?;
    Ok(Given { freezing_point: point?, absolute_zero: section.units().absolute_zero(), values })
}

/// Records why values are refused.
pub(super) fn refused(section: &mut Section<'_>, keys: &[Parameter], refusal: Refusal) -> Noted {
    let Refusal { parameter, value, message } = refusal;
    let key = keys[parameter].key();
    match value {
        Some(index) => section.item_problem(key, index, message),
        None => section.problem(key, message),
    }
}

/// The values of a key of a curve; one, if it is no list.
fn values(section: &mut Section<'_>, parameter: &Parameter, point: Read<f64>) -> Read<Vec<f64>> {
    let key = parameter.key();
    let coldest = section.units().absolute_zero();
    match parameter.quantity {
        Quantity::Interval => {
            let width = section.positive(key)?;
            if point? - width <= coldest {
                let message = format!("found {}, must end above absolute zero, {}", plain(width), plain(coldest));
                return Err(section.problem(key, message));
            }
            Ok(vec![width])
        }
        Quantity::Number { range: (low, high), default, .. } => {
            let range = Range::of(low, high);
            let value = match default {
                Some(default) => section.number_or(key, default, range),
                None => section.number(key, range)?,
            };
            Ok(vec![value])
        }
        Quantity::Temperatures => section.numbers(key, temperatures(coldest)),
        Quantity::Fractions => section.numbers(key, Range::FRACTION),
        Quantity::Numbers { range: (low, high), .. } => section.numbers(key, Range::of(low, high)),
    }
}
