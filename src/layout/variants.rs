//! The layouts of a study: its scene, with what each changes of it, on the smallest part of the plan that holds all of it.

use std::collections::BTreeMap;

use frazil_core::boundary::pipe::PipeCondition;
use frazil_core::space::domain::Domain;
use frazil_scene::{Change, PipeName, PipeRing, Scene};
use frazil_simulation::closing::{DugTooEarly, in_time};
use frazil_studies::failure::Failure;
use frazil_studies::parts::Parts;
use glam::DVec2;
use toml::Value;

use super::boreholes::{self, Borehole, Misplaced, Moved};
use super::goals::{Deviation, Sensitivity};
use super::strata::Stratum;
use super::study::named;
use crate::{Overrides, file};

/// The key by which boreholes of a ring are out of their places.
fn moved_key(ring: usize) -> String {
    format!("pipes.{}.moved_m", ring + 1)
}

/// Fewest spacings between two pipes: with less, a gap has no middle of its own.
const FEWEST_SPACINGS: f64 = 2.0;

/// Fewest spacings between neighbours of a ring as it was designed: with less there is no run at twice the spacing, and nothing
/// says how wrong the answer is. In sand with pipes 1.2 m apart, days of closure at 2, 2.4 and 3 spacings are 29.5 without an
/// error, 25.1 +- 29.6 and 22.4 +- 19.4 (`frazil layout` with a sweep of method.local.spacing_m).
const FEWEST_ACROSS: f64 = 3.0;

/// What a layout is beside others.
#[derive(Debug, Clone, PartialEq)]
pub enum Role {
    /// One of those compared.
    Compared,
    /// The layout of this name with one key changed by a factor.
    Changed {
        /// Name of the layout.
        of: String,
        /// The key.
        key: String,
        /// The factor.
        factor: f64,
    },
    /// One that a search has tried.
    Tried,
    /// The layout of this name, its boreholes deviating by chance.
    Deviating {
        /// Name of the layout.
        of: String,
    },
}

/// One layout, in one stratum.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name, one of its kind.
    pub name: String,
    /// Name without the stratum, which the same layout has in all strata.
    pub shaft: String,
    /// Number of its stratum; none in a study without.
    pub stratum: Option<usize>,
    /// What it is beside others.
    pub role: Role,
    /// What it changes of the scene.
    pub overrides: Overrides,
    /// Why it needs the part of the plan that it is run on.
    pub sector: String,
    /// Its scene.
    pub scene: Scene,
    /// The table that it is compared with.
    pub reference: Option<String>,
}

impl Layout {
    /// How often the part that is run stands in the whole plan.
    pub fn images(&self) -> usize {
        match self.scene.domain {
            Domain::Ring { sector, .. } => sector.images(),
            _ => 1,
        }
    }

    /// Holds what a method would run against what can be meant.
    ///
    /// # Errors
    /// With the first thing that cannot be meant, and the name of the layout.
    pub fn check(&self, shaft_radius: Option<f64>, method: &str) -> Result<(), Failure> {
        self.fits(shaft_radius, method).map_err(|unfit| named(&self.name, unfit))
    }

    /// The same without a name.
    ///
    /// # Errors
    /// With the first thing that cannot be meant.
    pub fn fits(&self, shaft_radius: Option<f64>, method: &str) -> Result<(), UnfitLayout> {
        in_time(&self.scene)?;
        let freezing = self.scene.materials[0].freezing_point;
        let mut places: Vec<DVec2> = Vec::new();
        for (number, ring) in self.scene.rings.iter().enumerate() {
            match &ring.condition {
                PipeCondition::Temperature(series) | PipeCondition::Film { brine: series, .. } => {
                    let (coldest, _) = series.range();
                    if coldest >= freezing {
                        return Err(UnfitLayout::Warm { ring: number + 1, coldest, freezing });
                    }
                }
                PipeCondition::Heat(series) => {
                    let (least, _) = series.range();
                    if least >= 0.0 {
                        return Err(UnfitLayout::Heating { ring: number + 1, least });
                    }
                }
            }
            places.extend(ring.numbers().map(|k| ring.place(k)));
            let Some(shaft) = shaft_radius else { continue };
            if let Some(inside) = ring.numbers().find(|k| ring.place(*k).length() <= shaft + ring.pipe_radius) {
                let (pipe, distance) = (PipeName { ring: number, pipe: inside }, ring.place(inside).length());
                return Err(UnfitLayout::InShaft { pipe, distance, shaft });
            }
        }
        let spacing = self.scene.method(method).map_or(0.0, |settings| settings.numerics.spacing);
        let method = method.to_owned();
        let rings = self.scene.rings.iter().filter(|ring| ring.count > 1);
        let chord = |ring: &PipeRing| 2.0 * ring.ring_radius * (std::f64::consts::PI / ring.count as f64).sin();
        let across = rings.map(chord).fold(0.0, f64::max);
        if across > 0.0 && FEWEST_ACROSS * spacing > across * (1.0 + 1e-9) {
            return Err(UnfitLayout::FewAcross { method, spacing, across });
        }
        let places = &places[..];
        let others = |k: usize| places[..k].iter().map(move |place| place.distance(places[k]));
        let apart = (0..places.len()).flat_map(others).fold(f64::INFINITY, f64::min);
        if FEWEST_SPACINGS * spacing > apart {
            return Err(UnfitLayout::FewBetween { method, spacing, apart });
        }
        Ok(())
    }
}

/// What cannot be meant of a layout; lengths in m, temperatures on the scale of the scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnfitLayout {
    /// The shaft is dug before it can be, as far as the scene alone tells.
    #[error(transparent)]
    DugEarly(#[from] DugTooEarly),
    /// Pipes never freeze the ground.
    #[error("pipes.{ring}.temperature_c: found {coldest}, must come below {freezing}, where the ground freezes")]
    Warm {
        /// Number of the ring, from 1.
        ring: usize,
        /// Coldest temperature of its pipes.
        coldest: f64,
        /// Freezing point of the ground.
        freezing: f64,
    },
    /// Pipes take no heat.
    #[error("pipes.{ring}.heat_W_per_m: found {least}, must come below 0, where pipes take heat")]
    Heating {
        /// Number of the ring, from 1.
        ring: usize,
        /// Least heat that the ground receives from a pipe (W/m).
        least: f64,
    },
    /// A pipe stands in the shaft.
    #[error("pipe {pipe} stands {distance:.3} m from the centre, inside the shaft: shaft_radius_m is {shaft}")]
    InShaft {
        /// The pipe.
        pipe: PipeName,
        /// Its distance from the centre.
        distance: f64,
        /// Radius of the shaft.
        shaft: f64,
    },
    /// There are too few spacings between neighbours of a ring.
    #[error(
        "method.{method}.spacing_m: found {spacing}, must be at most {:.4}: pipes stand {across:.4} m apart, and with less than \
         {FEWEST_ACROSS} spacings between them the error cannot be estimated",
        across / FEWEST_ACROSS
    )]
    FewAcross {
        /// The method.
        method: String,
        /// Its spacing.
        spacing: f64,
        /// Distance of neighbours in their places.
        across: f64,
    },
    /// There are too few spacings between two pipes.
    #[error(
        "method.{method}.spacing_m: found {spacing}, must be at most {:.4}: two pipes stand {apart:.4} m apart",
        apart / FEWEST_SPACINGS
    )]
    FewBetween {
        /// The method.
        method: String,
        /// Its spacing.
        spacing: f64,
        /// Distance of the two.
        apart: f64,
    },
}

/// The scene that all layouts change, and what else is changed of it in each stratum.
pub(super) struct Ground<'a> {
    pub(super) parts: Parts<'a>,
    /// Name or path of the scene.
    pub(super) scene: String,
    pub(super) set: Vec<Change>,
    /// Layers of ground, downwards.
    pub(super) strata: Vec<Stratum>,
    /// What was asked for beside the file.
    pub(super) asked: Overrides,
}

impl Ground<'_> {
    /// A stratum by its number.
    pub(super) fn stratum(&self, at: Option<usize>) -> Option<&Stratum> {
        self.strata.get(at?)
    }

    /// Numbers of the strata, or none where there are none.
    pub(super) fn places(&self) -> impl Iterator<Item = Option<usize>> + use<> {
        let count = self.strata.len();
        (0..count.max(1)).map(move |at| (count > 0).then_some(at))
    }

    /// What the file changes in a stratum for all layouts, in the order in which it is changed.
    pub(super) fn changes(&self, at: Option<usize>) -> impl Iterator<Item = &Change> {
        self.set.iter().chain(self.stratum(at).into_iter().flat_map(|stratum| &stratum.set))
    }

    /// Name of a layout in a stratum.
    pub(super) fn name(&self, shaft: &str, at: Option<usize>) -> String {
        self.stratum(at).map_or_else(|| shaft.to_owned(), |stratum| format!("{shaft}, {}", stratum.name))
    }

    /// A layout in a stratum.
    ///
    /// # Errors
    /// Where its scene is refused.
    pub(super) fn layout(&self, shaft: &str, at: Option<usize>, role: Role, own: Overrides) -> Result<Layout, Failure> {
        let mut overrides: Overrides = self.changes(at).map(pair).collect();
        overrides.extend(own);
        overrides.extend(self.asked.iter().cloned());
        Ok(Layout { shaft: shaft.to_owned(), stratum: at, ..layout(self, self.name(shaft, at), role, overrides)? })
    }

    /// A layout again, with more overrides.
    ///
    /// # Errors
    /// Where its scene is refused.
    pub(super) fn again(&self, of: &Layout, words: &str, role: Role, more: Overrides) -> Result<Layout, Failure> {
        let mut overrides = of.overrides.clone();
        overrides.extend(more);
        let read = layout(self, format!("{}{words}", of.name), role, overrides)?;
        Ok(Layout { shaft: format!("{}{words}", of.shaft), stratum: of.stratum, ..read })
    }

    /// Depth at which boreholes are read (m), and the greatest of all: those of the strata, or what the study says.
    fn depths(&self, at: Option<usize>, otherwise: f64) -> (f64, f64) {
        let deepest = self.strata.last().map_or(otherwise, |stratum| stratum.to);
        (self.stratum(at).map_or(otherwise, |stratum| stratum.depth), deepest)
    }

    /// The key by which pipes of a layout are out of their places as its file has it, if any are.
    pub(super) fn leans(&self, layout: &Layout) -> Option<String> {
        let keys = (0..layout.scene.rings.len()).map(moved_key);
        keys.into_iter().find(|key| file::value(&self.scene, &layout.overrides, key).is_some())
    }
}

/// A change as an override of a scene.
pub(super) fn pair(change: &Change) -> (String, String) {
    (change.key.clone(), change.value.clone())
}

/// Reads the scene of a layout on the smallest part of the plan that holds all of it.
fn layout(ground: &Ground<'_>, name: String, role: Role, overrides: Overrides) -> Result<Layout, Failure> {
    let at = |sector: &str| {
        let own = [("domain.ring.sector", sector), ("watch.frozen_wall", "true")];
        let mut all: Overrides = own.map(|(key, value)| (key.to_owned(), value.to_owned())).into();
        all.extend(overrides.iter().cloned());
        (ground.parts.scene_at)(&ground.scene, &all)
    };
    let whole = at("whole")?;
    // What the mirrors of a part would have to map is known of pipes alone.
    let other = if !whole.regions.is_empty() {
        Some("regions")
    } else if !whole.watch.probes.is_empty() {
        Some("points that are watched")
    } else {
        None
    };
    let (sector, scene) = match other {
        Some(what) => (format!("the whole plan: {what} need not be symmetric"), whole),
        None => match at("quarter") {
            Ok(quarter) => ("a quarter: both axes are mirror planes of all pipes".into(), quarter),
            Err(_) => match at("half") {
                Ok(half) => ("a half: the x axis is a mirror plane of all pipes".into(), half),
                Err(_) => ("the whole plan: no axis is a mirror plane of all pipes".into(), whole),
            },
        },
    };
    Ok(Layout { shaft: name.clone(), stratum: None, name, role, overrides, sector, scene, reference: None })
}

/// Why a layout cannot have the boreholes that it is given.
#[derive(Debug, thiserror::Error)]
pub(super) enum Undrilled {
    /// The scene has pipes out of their places already.
    #[error("beside {0}, must be one of them")]
    Beside(String),
    /// They are to deviate by chance, and are known.
    #[error("beside known boreholes ({0}): they do not deviate at random, use a study of their own")]
    Known(String),
    /// They cannot stand there.
    #[error(transparent)]
    Misplaced(#[from] Misplaced),
    /// The scene is refused with pipes there.
    #[error(transparent)]
    Refused(#[from] Failure),
}

/// A layout with boreholes that leave the vertical, at their depth.
///
/// # Errors
/// Where they cannot stand there.
pub(super) fn drilled(ground: &Ground<'_>, layout: Layout, entries: &[Borehole]) -> Result<Layout, Undrilled> {
    if let Some(key) = ground.leans(&layout) {
        return Err(Undrilled::Beside(key));
    }
    let (depth, deepest) = ground.depths(layout.stratum, entries.iter().find_map(|own| own.depth).unwrap_or(0.0));
    let moved = boreholes::moved(entries, &layout.scene.rings, depth, deepest)?;
    Ok(ground.again(&layout, "", Role::Compared, as_moved(&moved))?)
}

fn as_moved(moved: &Moved) -> Overrides {
    let mut rings: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for (pipe, way) in moved {
        rings.entry(pipe.ring).or_default().push(format!("[\"{pipe}\", {:.17e}, {:.17e}]", way.x, way.y));
    }
    rings.into_iter().map(|(ring, rows)| (moved_key(ring), format!("[{}]", rows.join(", ")))).collect()
}

/// A number of the scene of a layout.
pub(super) fn number_of(ground: &Ground<'_>, layout: &Layout, key: &str) -> Option<f64> {
    match file::value(&ground.scene, &layout.overrides, key)? {
        Value::Float(found) => Some(found),
        Value::Integer(found) => Some(found as f64),
        _ => None,
    }
}

/// A layout with each key changed up and down; other strata may be of other soils, which have other keys.
///
/// # Errors
/// Where the scene of one is refused.
pub(super) fn changed(ground: &Ground<'_>, of: &Layout, sensitivity: &Sensitivity) -> Result<Vec<Layout>, Failure> {
    let Sensitivity { percent, keys } = sensitivity;
    let mut found = Vec::new();
    for (key, value) in keys.iter().filter_map(|(key, _)| Some((key, number_of(ground, of, key)?))) {
        for factor in [1.0 - 0.01 * percent, 1.0 + 0.01 * percent] {
            let role = Role::Changed { of: of.name.clone(), key: key.clone(), factor };
            let more = vec![(key.clone(), format!("{:e}", value * factor))];
            found.push(ground.again(of, &format!(", {key} x {factor}"), role, more)?);
        }
    }
    Ok(found)
}

/// Members of a layout whose boreholes end anywhere in a circle around their places, as likely in all of it. A member has the
/// same boreholes in all strata.
///
/// # Errors
/// Where boreholes are known already, or find no place.
pub(super) fn deviating(ground: &Ground<'_>, of: &Layout, deviation: &Deviation) -> Result<Vec<Layout>, Undrilled> {
    if let Some(key) = ground.leans(of) {
        return Err(Undrilled::Known(key));
    }
    let (depth, deepest) = ground.depths(of.stratum, deviation.depth.unwrap_or(0.0));
    let mut random = boreholes::chance(deviation.seed);
    (1..=deviation.members)
        .map(|member| {
            let slopes = boreholes::draw(&of.scene.rings, deviation.percent, &mut random, deepest)?;
            let moved: Moved = slopes.iter().map(|(number, slope)| (*number, *slope * depth)).collect();
            let role = Role::Deviating { of: of.name.clone() };
            Ok(ground.again(of, &format!(", deviating {member}"), role, as_moved(&moved))?)
        })
        .collect()
}

/// Pipes of a ring that work.
pub fn working(rings: &[PipeRing]) -> usize {
    rings.iter().map(|ring| ring.numbers().count()).sum()
}
