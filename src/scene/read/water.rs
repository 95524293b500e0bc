//! Scenes of unsaturated water: soils, and what heads and saturations are on the scale of heads.

use super::ground::{parameters, refused};
use super::problem::Read;
use super::range::{Range, plain};
use super::section::{Along, Key, Section};
use frazil_core::balances::solute::advection::Advection;
use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};
use frazil_core::physics::retention::moisture::Soil;
use frazil_core::physics::retention::scale::{DRIEST, place};
use frazil_core::physics::retention::{RETENTIONS, Retention};
use frazil_core::physics::solute_material::{SoluteMaterial, Tortuosity};
use frazil_core::series::Series;
use frazil_core::solvers::transport::Coupling;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::PatchId;

use super::problem::Noted;
use crate::settings::{Numerics, Setting};
use crate::solute::{Solute, SoluteNumerics, SoluteWall};

const HEAD: (&str, &str) = ("head", "m");
const SATURATION: &str = "saturation";
pub(super) const CONCENTRATION: &str = "concentration";
const FLUX: (&str, &str) = ("water_flux", "m_per_s");
const RAIN: (&str, &str) = ("rain", "m_per_s");
const RAIN_BY_DAY: (&str, &str) = ("rain", "mm_per_day");
const PONDING: (&str, &str) = ("ponding", "m");

/// All keys of rain.
pub(super) const RAINS: [(&str, &str); 2] = [RAIN, RAIN_BY_DAY];

/// A millimetre a day (m/s).
const MILLIMETRE_A_DAY: f64 = 1e-3 / 86_400.0;

/// Specific storage (1/m) where a scene does not say: a little more than that of the water in the pores.
const STORAGE: f64 = 1e-6;

/// What a scene is of, and how it says what is at its walls and at its start.
pub(super) enum Balance {
    /// Heat: by temperatures.
    Heat,
    /// Unsaturated water, by heads and saturations.
    Water(Heads),
}

impl Balance {
    /// The solute of a scene, if there is one; none in a scene of heat.
    pub(super) fn solute(
        self,
        root: &mut Section<'_>,
        materials: &[Material],
        initial: Option<f64>,
    ) -> Read<Option<Solute>> {
        match self {
            Balance::Heat => Ok(None),
            Balance::Water(heads) => heads.solute(root, materials, initial),
        }
    }
}

/// What saturations are as heads, and which heads there are.
pub(super) struct Heads {
    /// The soils of the scene, as far as they could be read.
    soils: Vec<(String, Soil)>,
    /// Walls of given concentration, as far as they have been read.
    walls: Vec<SoluteWall>,
    /// Concentrations at the start of regions.
    regions: Vec<Option<f64>>,
}

impl Heads {
    /// The heads of soils.
    pub(super) fn new(materials: &[Material]) -> Self {
        let soil = |material: &Material| Some((material.name.clone(), material.soil.clone()?));
        Heads { soils: materials.iter().filter_map(soil).collect(), walls: Vec::new(), regions: Vec::new() }
    }

    /// The place of a head (m), if all soils have it.
    fn of_head(&self, section: &mut Section<'_>, head: f64) -> Read<f64> {
        let driest = |(name, soil): &(String, Soil)| {
            let Retention::Table(table) = &soil.retention else { return None };
            Some((name.clone(), -table.driest())).filter(|(_, driest)| head < *driest)
        };
        if let Some((name, driest)) = self.soils.iter().find_map(driest) {
            let message = format!(
                "found {}, but \"{name}\" is dry at a head of {}: must be at least that, or saturation = 0",
                plain(head),
                plain(driest)
            );
            return Err(section.problem(HEAD, message));
        }
        Ok(place(head))
    }

    /// The place of a saturation, which all soils must have at one head.
    fn of_saturation(&self, section: &mut Section<'_>, saturation: f64) -> Read<f64> {
        let Some(((_, first), others)) = self.soils.split_first() else { return Ok(0.0) };
        let differs = |other: &&(String, Soil)| !other.1.curves_like(first);
        if let (Some((name, _)), true) = (others.iter().find(differs), saturation > 0.0 && saturation < 1.0) {
            let message = format!(
                "found {}, which \"{name}\" has at another head than \"{}\": give the head, head_m",
                plain(saturation),
                self.soils[0].0
            );
            return Err(section.problem(SATURATION, message));
        }
        Ok(first.place_of(saturation))
    }

    /// The state of a body or of a part of it.
    pub(super) fn state(&self, section: &mut Section<'_>) -> Read<f64> {
        match section.only_one(&[HEAD.into(), SATURATION.into()])? {
            0 => {
                let head = section.number(HEAD, Range::at_least(-DRIEST))?;
                self.of_head(section, head)
            }
            _ => {
                let saturation = section.number(SATURATION, Range::FRACTION)?;
                self.of_saturation(section, saturation)
            }
        }
    }

    /// The state of a body at the start, where heads may vary.
    pub(super) fn start(&self, section: &mut Section<'_>, domain: Option<&Domain>) -> Read<Along> {
        if section.only_one(&[HEAD.into(), SATURATION.into()])? != 0 {
            let saturation = section.number(SATURATION, Range::FRACTION)?;
            return self.of_saturation(section, saturation).map(Along::Even);
        }
        match section.number_along(HEAD, Range::at_least(-DRIEST), domain)? {
            Along::Even(head) => self.of_head(section, head).map(Along::Even),
            varied => {
                let heads = match &varied {
                    Along::Axis { rows, .. } => rows.iter().map(|row| row.1).collect(),
                    Along::Formula { range, .. } => vec![range.0, range.1],
                    Along::Even(_) => Vec::new(),
                };
                for head in heads {
                    self.of_head(section, head)?;
                }
                Ok(varied)
            }
        }
    }

    /// The same of a part that need not have any.
    pub(super) fn optional_state(&self, section: &mut Section<'_>) -> Option<f64> {
        let given = section.has(HEAD) || section.has(SATURATION);
        if !given {
            // Known to those who misspell them.
            section.optional_number(HEAD, Range::ANY);
            section.optional_number(SATURATION, Range::FRACTION);
            return None;
        }
        self.state(section).ok()
    }

    /// Keys that tell what happens to water at a wall.
    fn conditions() -> [Key; 6] {
        [HEAD.into(), SATURATION.into(), FLUX.into(), RAIN.into(), RAIN_BY_DAY.into(), "condition".into()]
    }

    /// What happens to water at a wall.
    pub(super) fn condition(&self, wall: &mut Section<'_>) -> Read<Condition> {
        let found = wall.only_one(&Self::conditions());
        if !matches!(found, Ok(3 | 4)) {
            wall.refuse(PONDING, "only walls with rain have a ponding depth");
        }
        match found? {
            0 => {
                let heads = wall.tabulated(HEAD, Range::at_least(-DRIEST))?;
                self.each(wall, &heads, Self::of_head).map(Condition::Temperature)
            }
            1 => {
                let saturations = wall.tabulated(SATURATION, Range::FRACTION)?;
                self.each(wall, &saturations, Self::of_saturation).map(Condition::Temperature)
            }
            2 => wall.series(FLUX, Range::ANY).map(Condition::Flux),
            3 => Self::runoff(wall, RAIN, 1.0),
            4 => Self::runoff(wall, RAIN_BY_DAY, MILLIMETRE_A_DAY),
            _ => {
                let seepage = Condition::Runoff { rain: Series::Constant(0.0), ponding: Series::Constant(0.0) };
                let words = [
                    ("symmetry", Condition::Symmetry),
                    ("free-drainage", Condition::FreeDrainage),
                    ("seepage", seepage),
                ];
                wall.choice("condition", &words)
            }
        }
    }

    /// Rain, in a unit (m/s), and how deep water stands at most.
    fn runoff(wall: &mut Section<'_>, key: (&'static str, &'static str), unit: f64) -> Read<Condition> {
        let rain = wall.tabulated(key, Range::NOT_NEGATIVE);
        let ponding = wall.number_or(PONDING, 0.0, Range::NOT_NEGATIVE);
        Ok(Condition::Runoff { rain: rain?.scaled(unit), ponding: Series::Constant(ponding) })
    }

    /// What happens to water at a part of a wall, and what is said there of a solute: what the wall has, where the part says
    /// nothing of its own.
    pub(super) fn part(
        &mut self,
        section: &mut Section<'_>,
        patch: PatchId,
        whole: &Read<Condition>,
    ) -> Read<Condition> {
        let says_condition = Self::conditions().iter().any(|key| section.has(*key));
        let solute_alone = section.has(CONCENTRATION) && !says_condition;
        let own = if solute_alone { whole.clone() } else { self.condition(section) };
        self.concentration(section, patch, &own);
        own
    }

    /// What of a wall or a part of one is said of a solute: its concentration.
    pub(super) fn concentration(&mut self, section: &mut Section<'_>, patch: PatchId, condition: &Read<Condition>) {
        let nothing_enters = match condition {
            Ok(Condition::Symmetry) => Some("the wall is impermeable, so no solute crosses it"),
            Ok(Condition::Runoff { rain, .. }) if rain.constant() == Some(0.0) => {
                Some("no water enters at a seepage face, so no solute does")
            }
            _ => None,
        };
        if section.has(CONCENTRATION) {
            if let Some(why) = nothing_enters {
                section.problem(CONCENTRATION, why);
            }
            let own = section.series(CONCENTRATION, Range::NOT_NEGATIVE);
            self.walls.extend(own.map(|concentration| SoluteWall { patch, concentration }));
        } else if let (PatchId::Part(wall, _), None) = (patch, nothing_enters) {
            let whole = self.walls.iter().find(|other| other.patch == PatchId::Whole(wall));
            let own = whole.map(|whole| SoluteWall { patch, concentration: whole.concentration.clone() });
            self.walls.extend(own);
        }
    }

    /// The concentration at the start of a region, if it has one of its own.
    pub(super) fn solute_region(&mut self, section: &mut Section<'_>) {
        self.regions.push(section.optional_number(CONCENTRATION, Range::NOT_NEGATIVE));
    }

    /// The solute of a scene, if there is one: where soils say what they do to it.
    fn solute(
        self,
        root: &mut Section<'_>,
        materials: &[Material],
        initial: Option<f64>,
    ) -> Result<Option<Solute>, Noted> {
        let soils = materials.iter().filter_map(|material| Some((&material.name, material.soil.as_ref()?)));
        let (with, without): (Vec<_>, Vec<_>) = soils.partition(|(_, soil)| soil.solute.is_some());
        let regions = self.regions.iter().any(Option::is_some);
        let named = initial.is_some() || regions || !self.walls.is_empty();
        match (with.first(), without.first(), named) {
            (None, Some((name, _)), true) => Err(root.problem(
                "materials",
                format!("a concentration is given, but \"{name}\" has no table \"solute\""),
            )),
            (Some((one, _)), Some((other, _)), _) => Err(root.problem(
                "materials",
                format!("\"{one}\" has a table \"solute\" and \"{other}\" has none: all must have one, or none"),
            )),
            (Some((name, _)), None, false) => Err(root.problem(
                "materials",
                format!("the table \"solute\" of \"{name}\" has no effect, no concentration is given at the start or at a wall"),
            )),
            (Some(_), None, true) => {
                Ok(Some(Solute { initial: initial.unwrap_or(0.0), regions: self.regions, walls: self.walls }))
            }
            (None, ..) => Ok(None),
        }
    }

    /// A series on the scale of heads.
    fn each(
        &self,
        wall: &mut Section<'_>,
        series: &Series,
        of: fn(&Self, &mut Section<'_>, f64) -> Read<f64>,
    ) -> Read<Series> {
        let mut rows = |rows: &[(f64, f64)]| -> Read<Vec<(f64, f64)>> {
            rows.iter().map(|(time, value)| Ok((*time, of(self, wall, *value)?))).collect()
        };
        Ok(match series {
            Series::Constant(value) => Series::Constant(rows(&[(0.0, *value)])?[0].1),
            Series::Table(table) => Series::Table(rows(table)?),
            Series::Repeated { rows: table, period } => Series::Repeated { rows: rows(table)?, period: *period },
            // None is read for them.
            Series::Formula(_) => series.clone(),
        })
    }
}

/// A soil.
pub(super) fn soil(name: &str, section: &mut Section<'_>) -> Read<Material> {
    let retention = section.section("retention").and_then(|mut section| retention(&mut section));
    let residual = section.number_or("residual_water_content", 0.0, Range::from_to_below(0.0, 1.0));
    let saturated = section.number("saturated_water_content", Range::above_to(0.0, 1.0));
    let conductivity = section.positive(("conductivity", "m_per_s"));
    let storage = section.number_or(("specific_storage", "per_m"), STORAGE, Range::between(1e-9, 1.0));
    let own = section.optional_section("solute");
    let solute = own.map(|mut section| solute_material(&mut section, saturated.unwrap_or(1.0))).transpose();
    let saturated = saturated?;
    if residual >= saturated {
        let message =
            format!("found {}, must be less than the saturated content, {}", plain(residual), plain(saturated));
        return Err(section.problem("residual_water_content", message));
    }
    let (retention, conductivity, solute) = (retention?, conductivity?, solute?);
    let soil = Soil { retention, residual, saturated, conductivity, storage, solute };
    let idle = Phase { conductivity: 1.0, heat_capacity: 1.0 };
    Ok(Material {
        name: name.to_owned(),
        density: 1.0,
        frozen: idle,
        unfrozen: idle,
        freezing_point: 0.0,
        latent_heat: 0.0,
        law: FreezingLaw::None,
        mixing: Mixing::Arithmetic,
        pores: None,
        soil: Some(soil),
    })
}

fn retention(section: &mut Section<'_>) -> Read<Retention> {
    let words: Vec<(&str, usize)> = RETENTIONS.iter().enumerate().map(|(k, kind)| (kind.word, k)).collect();
    let kind = section.choice("law", &words).inspect_err(|_| {
        // Which of the other keys belong depends on the law.
        section.abandon();
    })?;
    let kind = &RETENTIONS[kind];
    let given = parameters(section, kind.parameters, Ok(0.0))?;
    (kind.make)(&given).map_err(|refusal| refused(section, kind.parameters, refusal))
}

/// What a soil does to a solute.
fn solute_material(section: &mut Section<'_>, saturated: f64) -> Read<SoluteMaterial> {
    let diffusion = section.number(("diffusion", "m2_per_s"), Range::NOT_NEGATIVE);
    let words = [("none", Tortuosity::None), ("millington-quirk", Tortuosity::MillingtonQuirk { saturated })];
    let tortuosity = section.choice_or("tortuosity", &words, Tortuosity::None);
    let length = |section: &mut Section<'_>, name| section.number_or((name, "m"), 0.0, Range::NOT_NEGATIVE);
    let longitudinal_dispersivity = length(section, "longitudinal_dispersivity");
    let transverse_dispersivity = length(section, "transverse_dispersivity");
    if transverse_dispersivity > longitudinal_dispersivity {
        let (found, most) = (plain(transverse_dispersivity), plain(longitudinal_dispersivity));
        let message = format!("found {found}, must be at most the longitudinal one, {most}");
        section.problem(("transverse_dispersivity", "m"), message);
    }
    let density = section.number_or(("bulk_density", "kg_per_m3"), 0.0, Range::NOT_NEGATIVE);
    let coefficient = section.number_or(("distribution_coefficient", "m3_per_kg"), 0.0, Range::NOT_NEGATIVE);
    if (density > 0.0) != (coefficient > 0.0) {
        let message = "sorption needs both \"bulk_density_kg_per_m3\" and \"distribution_coefficient_m3_per_kg\"";
        section.section_problem(message);
    }
    let decay = section.number_or(("decay", "per_s"), 0.0, Range::NOT_NEGATIVE);
    Ok(SoluteMaterial {
        diffusion: diffusion?,
        tortuosity,
        longitudinal_dispersivity,
        transverse_dispersivity,
        sorption: density * coefficient,
        decay,
    })
}

/// Steps of a solute over their bound, where a scene does not say.
const FRACTION: f64 = 0.9;

/// Settings of a method as the paper of unsaturated water prints them: a bond conducts by the arithmetic mean of its ends, and
/// walls are layers of one value.
pub(super) fn printed(numerics: Numerics) -> Numerics {
    Numerics { exchange: Exchange::Mean(Mean::Arithmetic), walls: WallModel::Naive, ..numerics }
}

/// How a solute is computed.
pub(super) fn numerics(section: &mut Section<'_>, setting: Setting) -> SoluteNumerics {
    let usual = if setting == Setting::Paper { Advection::Paper } else { Advection::Limited };
    let advection = section.choice_or("advection", &Advection::WORDS, usual);
    let coupling = section.choice_or("coupling", &Coupling::WORDS, Coupling::Sequential);
    let fraction = section.number_or("solute_step_fraction", FRACTION, Range::above_to(0.0, 1.0));
    SoluteNumerics { advection, coupling, fraction }
}
