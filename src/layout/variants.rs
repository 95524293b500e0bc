//! The layouts of a study: its scene, with what each changes of it, on the smallest part of the plan that holds all of it.

use std::collections::BTreeMap;

use frazil_core::space::domain::Domain;
use frazil_scene::{PipeName, PipeRing, Scene};
use frazil_simulation::closing::dug_too_early;
use glam::DVec2;
use serde::Deserialize;
use toml::Value;

use super::boreholes::{self, Borehole, Deviation, Moved};
use super::horizons::Horizon;
use crate::failure::Failure;
use crate::load::{self, Overrides};

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

/// One layout, at one horizon.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name, one of its kind.
    pub name: String,
    /// Name without the horizon, which the same layout has at all horizons.
    pub shaft: String,
    /// Number of its horizon; none in a study without.
    pub horizon: Option<usize>,
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

    /// What cannot be meant, with the place that says so.
    pub fn check(&self, shaft_radius: Option<f64>, method: &str) -> Result<(), Failure> {
        let bad = |message: String| Err(Failure::Request(format!("layout \"{}\": {message}", self.name)));
        if let Some(reason) = dug_too_early(&self.scene) {
            return bad(reason);
        }
        let freezing = self.scene.materials[0].freezing_point;
        let mut places: Vec<DVec2> = Vec::new();
        for (number, ring) in self.scene.rings.iter().enumerate() {
            let (coldest, _) = ring.temperature.range();
            if coldest >= freezing {
                return bad(format!(
                    "pipes.{}.temperature_c: found {coldest}, must come below {freezing}, where the ground freezes",
                    number + 1
                ));
            }
            places.extend(ring.numbers().map(|k| ring.place(k)));
            let Some(shaft) = shaft_radius else { continue };
            if let Some(inside) = ring.numbers().find(|k| ring.place(*k).length() <= shaft + ring.pipe_radius) {
                return bad(format!(
                    "pipe {} stands {:.3} m from the centre, inside the shaft: shaft_radius_m is {shaft}",
                    PipeName { ring: number, pipe: inside },
                    ring.place(inside).length()
                ));
            }
        }
        let spacing = self.scene.method(method).map_or(0.0, |settings| settings.numerics.spacing);
        let rings = self.scene.rings.iter().filter(|ring| ring.count > 1);
        let chord = |ring: &PipeRing| 2.0 * ring.ring_radius * (std::f64::consts::PI / ring.count as f64).sin();
        let across = rings.map(chord).fold(0.0, f64::max);
        if across > 0.0 && FEWEST_ACROSS * spacing > across * (1.0 + 1e-9) {
            return bad(format!(
                "method.{method}.spacing_m: found {spacing}, must be at most {:.4}: pipes stand {across:.4} m apart, and with \
                 less than {FEWEST_ACROSS} spacings between them nothing says how wrong the answer is",
                across / FEWEST_ACROSS
            ));
        }
        let places = &places[..];
        let others = |k: usize| places[..k].iter().map(move |place| place.distance(places[k]));
        let least = (0..places.len()).flat_map(others).fold(f64::INFINITY, f64::min);
        if FEWEST_SPACINGS * spacing > least {
            return bad(format!(
                "method.{method}.spacing_m: found {spacing}, must be at most {:.4}: two pipes stand {least:.4} m apart",
                least / FEWEST_SPACINGS
            ));
        }
        Ok(())
    }
}

/// The scene that all layouts change, and what else is changed of it at each horizon.
#[derive(Debug)]
pub(super) struct Ground {
    pub(super) scene: String,
    pub(super) set: Overrides,
    pub(super) horizons: Vec<Horizon>,
    /// What was asked for beside the file.
    pub(super) asked: Overrides,
}

impl Ground {
    /// Numbers of the horizons, or none where there are none.
    pub(super) fn places(&self) -> impl Iterator<Item = Option<usize>> + use<> {
        let count = self.horizons.len();
        (0..count.max(1)).map(move |at| (count > 0).then_some(at))
    }

    /// A layout at a horizon.
    pub(super) fn layout(
        &self,
        shaft: &str,
        at: Option<usize>,
        role: Role,
        own: &Overrides,
    ) -> Result<Layout, Failure> {
        let horizon = at.and_then(|at| self.horizons.get(at));
        let name = horizon.map_or_else(|| shaft.to_owned(), |horizon| format!("{shaft}, {}", horizon.name));
        let mut overrides = self.set.clone();
        overrides.extend(horizon.iter().flat_map(|horizon| horizon.set.iter().cloned()));
        overrides.extend(own.iter().cloned());
        overrides.extend(self.asked.iter().cloned());
        Ok(Layout { shaft: shaft.to_owned(), horizon: at, ..layout(&self.scene, name, role, overrides)? })
    }

    /// A layout once more, with more overrides.
    pub(super) fn again(&self, of: &Layout, words: &str, role: Role, more: &Overrides) -> Result<Layout, Failure> {
        let mut overrides = of.overrides.clone();
        overrides.extend(more.iter().cloned());
        let read = layout(&self.scene, format!("{}{words}", of.name), role, overrides)?;
        Ok(Layout { shaft: format!("{}{words}", of.shaft), horizon: of.horizon, ..read })
    }

    /// Depth at which boreholes are read (m), and the greatest of all: those of the horizons, or what the study says.
    fn depths(&self, at: Option<usize>, otherwise: f64) -> (f64, f64) {
        let deepest = self.horizons.last().map_or(otherwise, |horizon| horizon.to);
        (at.and_then(|at| self.horizons.get(at)).map_or(otherwise, |horizon| horizon.depth), deepest)
    }

    /// The key by which pipes of a layout are out of their places as its file has it, if any are.
    pub(super) fn leans(&self, layout: &Layout) -> Option<String> {
        let keys = (0..layout.scene.rings.len()).map(moved_key);
        keys.into_iter().find(|key| load::value(&self.scene, &layout.overrides, key).is_some())
    }
}

/// Reads the scene of a layout on the smallest part of the plan that holds all of it.
fn layout(scene: &str, name: String, role: Role, overrides: Overrides) -> Result<Layout, Failure> {
    let at = |sector: &str| {
        let own = [("domain.ring.sector", sector), ("watch.frozen_wall", "true")];
        let mut all: Overrides = own.map(|(key, value)| (key.to_owned(), value.to_owned())).into();
        all.extend(overrides.iter().cloned());
        load::scene(scene, &all)
    };
    let named = |failure: Failure| Failure::Request(format!("layout \"{name}\": {failure}"));
    let whole = at("whole").map_err(named)?;
    // What the mirrors of a part would have to map is known of pipes alone.
    let other = if !whole.regions.is_empty() {
        Some("regions")
    } else if !whole.watch.probes.is_empty() {
        Some("points that are watched")
    } else {
        None
    };
    let (sector, scene) = match other {
        Some(what) => (format!("the whole plan: {what} need no image"), whole),
        None => match at("quarter") {
            Ok(quarter) => ("a quarter: both axes are mirror planes of all pipes".into(), quarter),
            Err(_) => match at("half") {
                Ok(half) => ("a half: the x axis is a mirror plane of all pipes".into(), half),
                Err(_) => ("the whole plan: no axis is a mirror plane of all pipes".into(), whole),
            },
        },
    };
    Ok(Layout { shaft: name.clone(), horizon: None, name, role, overrides, sector, scene, reference: None })
}

/// A layout with boreholes that leave the vertical, at their depth.
pub(super) fn drilled(ground: &Ground, layout: Layout, entries: &[Borehole]) -> Result<Layout, Failure> {
    let bad = |message: String| Failure::Request(format!("layout \"{}\": boreholes: {message}", layout.name));
    if let Some(key) = ground.leans(&layout) {
        return Err(bad(format!("beside {key}, must be one of them")));
    }
    let otherwise = match layout.horizon {
        Some(_) => boreholes::without_depth(entries).map(|()| 0.0),
        None => boreholes::depth(entries),
    };
    let (depth, deepest) = ground.depths(layout.horizon, otherwise.map_err(bad)?);
    let moved = boreholes::moved(entries, &layout.scene.rings, depth, deepest).map_err(bad)?;
    ground.again(&layout, "", Role::Compared, &as_moved(&moved))
}

fn as_moved(moved: &Moved) -> Overrides {
    let mut rings: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for (pipe, way) in moved {
        rings.entry(pipe.ring).or_default().push(format!("[\"{pipe}\", {:.17e}, {:.17e}]", way.x, way.y));
    }
    rings.into_iter().map(|(ring, rows)| (moved_key(ring), format!("[{}]", rows.join(", ")))).collect()
}

/// Keys that are changed up and down.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sensitivity {
    percent: f64,
    pub(super) keys: Vec<String>,
}

/// A number of the scene of a layout.
pub(super) fn number_of(ground: &Ground, layout: &Layout, key: &str) -> Option<f64> {
    match load::value(&ground.scene, &layout.overrides, key)? {
        Value::Float(found) => Some(found),
        Value::Integer(found) => Some(found as f64),
        _ => None,
    }
}

/// A layout with each key changed up and down; other horizons may be of other soils, which have other keys.
pub(super) fn changed(ground: &Ground, of: &Layout, sensitivity: &Sensitivity) -> Result<Vec<Layout>, Failure> {
    let Sensitivity { percent, keys } = sensitivity;
    if !(*percent > 0.0 && *percent < 100.0) {
        return Err(Failure::Request(format!("sensitivity: percent: found {percent}, must be above 0 and below 100")));
    }
    let mut found = Vec::new();
    for (key, value) in keys.iter().filter_map(|key| Some((key, number_of(ground, of, key)?))) {
        for factor in [1.0 - 0.01 * percent, 1.0 + 0.01 * percent] {
            let role = Role::Changed { of: of.name.clone(), key: key.clone(), factor };
            let more = vec![(key.clone(), format!("{:e}", value * factor))];
            found.push(ground.again(of, &format!(", {key} x {factor}"), role, &more)?);
        }
    }
    Ok(found)
}

/// Members of a layout whose boreholes end anywhere in a circle around their places, as likely in all of it. A member has the
/// same boreholes at all horizons.
pub(super) fn deviating(
    ground: &Ground,
    of: &Layout,
    deviation: &Deviation,
    bad: &dyn Fn(String) -> Failure,
) -> Result<Vec<Layout>, Failure> {
    let Deviation { depth_m, percent, members, seed } = *deviation;
    let otherwise = match (depth_m, of.horizon) {
        (Some(depth), None) => depth,
        (None, Some(_)) => 0.0,
        (None, None) => return Err(bad("deviation: depth_m is missing, of the horizon that is run".into())),
        (Some(depth), Some(_)) => {
            return Err(bad(format!(
                "deviation: depth_m: found {depth}, must be left out: boreholes are read at the depth of each horizon"
            )));
        }
    };
    let (depth, deepest) = ground.depths(of.horizon, otherwise);
    let numbers = deepest > 0.0 && percent > 0.0 && percent < 100.0 && deepest.is_finite();
    if !(numbers && (2..=1000).contains(&members)) {
        return Err(bad(format!(
            "deviation: found depth_m {deepest}, percent {percent}, members {members}: must be above 0, above 0 and below \
             100, 2 to 1000"
        )));
    }
    let mut random = boreholes::chance(seed);
    (1..=members)
        .map(|member| {
            let slopes = boreholes::draw(&of.scene.rings, percent, &mut random, deepest);
            let slopes = slopes.map_err(|message| bad(format!("deviation: {message}")))?;
            let moved: Moved = slopes.iter().map(|(number, slope)| (*number, *slope * depth)).collect();
            let role = Role::Deviating { of: of.name.clone() };
            ground.again(of, &format!(", deviating {member}"), role, &as_moved(&moved))
        })
        .collect()
}

/// Pipes of a ring that work.
pub fn working(rings: &[PipeRing]) -> usize {
    rings.iter().map(|ring| ring.numbers().count()).sum()
}
