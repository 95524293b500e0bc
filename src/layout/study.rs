//! Study files: a scene, and what each layout changes of it.

use std::path::Path;

use frazil_core::scene::{Domain, PipeRing, Scene};
use glam::DVec2;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use serde::Deserialize;
use toml::{Table, Value};

use crate::failure::Failure;
use crate::load::{self, Overrides};

/// Most layouts of a study.
const MOST: usize = 10_000;

/// A study file as it stands.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    source: Option<String>,
    scene: String,
    method: Option<String>,
    #[serde(default)]
    set: Table,
    reference: Option<String>,
    depth_m: Option<f64>,
    shaft_radius_m: Option<f64>,
    design: Option<Design>,
    #[serde(default)]
    layouts: Vec<Entry>,
    #[serde(default)]
    sweep: Table,
    sensitivity: Option<Sensitivity>,
    deviation: Option<Deviation>,
    search: Option<Search>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    #[serde(default)]
    set: Table,
    #[serde(default)]
    boreholes: Vec<Borehole>,
    reference: Option<String>,
}

/// A borehole of the first ring that leaves the vertical.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct Borehole {
    pipe: usize,
    inclination_deg: f64,
    azimuth_deg: f64,
    depth_m: f64,
}

/// What a wall must come to.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Thickness on the interface plane (m).
    pub thickness_m: f64,
    /// Mean temperature of the wall.
    pub mean_temperature_c: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sensitivity {
    percent: f64,
    keys: Vec<String>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct Deviation {
    depth_m: f64,
    percent: f64,
    members: usize,
    seed: u64,
}

/// The least whole number of a key at which the wall closes in time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Search {
    /// The key, as `pipes.0.count`.
    pub key: String,
    /// The least value.
    pub from: i64,
    /// The greatest value.
    pub to: i64,
    /// Day by which the wall must have closed.
    pub closure_days: f64,
}

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

/// One layout.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name, one of its kind.
    pub name: String,
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

/// A study.
#[derive(Debug)]
pub struct Study {
    /// Short name: the file's stem or the bundled name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Where its parameters come from.
    pub source: String,
    /// Name or path of the scene.
    pub scene: String,
    /// Method, unless another is asked for.
    pub method: Option<String>,
    /// Frozen depth of the shaft (m), from which the load of the plant follows.
    pub depth: Option<f64>,
    /// Radius of the shaft (m), for sketches.
    pub shaft_radius: Option<f64>,
    /// What a wall must come to.
    pub design: Option<Design>,
    /// All layouts.
    pub layouts: Vec<Layout>,
    /// What is searched.
    pub search: Option<Search>,
    /// What all layouts change of the scene.
    set: Overrides,
}

impl Study {
    /// The layout with a value of the key that is searched.
    pub fn tried(&self, search: &Search, value: i64) -> Result<Layout, Failure> {
        let mut overrides = self.set.clone();
        overrides.push((search.key.clone(), value.to_string()));
        layout(&self.scene, format!("{} = {value}", search.key), Role::Tried, overrides)
    }
}

/// Fewest spacings between two pipes: with less, a gap has no middle of its own.
const FEWEST_SPACINGS: f64 = 2.0;

impl Layout {
    /// What cannot be meant, with the place that says so.
    pub fn check(&self, shaft_radius: Option<f64>, method: &str) -> Result<(), Failure> {
        let bad = |message: String| Err(Failure::Request(format!("layout \"{}\": {message}", self.name)));
        let freezing = self.scene.materials[0].freezing_point;
        let mut places: Vec<DVec2> = Vec::new();
        for (number, ring) in self.scene.rings.iter().enumerate() {
            let (coldest, _) = ring.temperature.range();
            if coldest >= freezing {
                return bad(format!(
                    "pipes.{number}.temperature_c: found {coldest}, must come below {freezing}, where the ground freezes"
                ));
            }
            places.extend(ring.numbers().map(|k| ring.place(k)));
            let Some(shaft) = shaft_radius else { continue };
            if let Some(inside) = ring.numbers().find(|k| ring.place(*k).length() <= shaft + ring.pipe_radius) {
                return bad(format!(
                    "pipe {}.{} stands {:.3} m from the centre, inside the shaft: shaft_radius_m is {shaft}",
                    number + 1,
                    inside + 1,
                    ring.place(inside).length()
                ));
            }
        }
        let spacing = self.scene.method(method).map_or(0.0, |settings| settings.numerics.spacing);
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

/// Reads a study given by a bundled name or a path.
pub fn read(argument: &str, overrides: &[(String, String)]) -> Result<Study, Failure> {
    let bundled = frazil_cases::studies::find(argument);
    let (text, name, file) = match bundled {
        Some(bundled) => (bundled.text.to_owned(), bundled.name.to_owned(), format!("{argument}.toml")),
        None => {
            let path = Path::new(argument);
            if !path.exists() && path.extension().is_none() && path.components().count() == 1 {
                let names: Vec<&str> = frazil_cases::studies::all().iter().map(|study| study.name).collect();
                return Err(Failure::Request(format!(
                    "\"{argument}\" is neither a file nor a bundled study; those are {}",
                    names.join(", ")
                )));
            }
            let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, "cannot be read", error))?;
            let name = path.file_stem().map_or_else(|| "study".into(), |stem| stem.to_string_lossy().into_owned());
            (text, name, argument.to_owned())
        }
    };
    parse(&text, name, &file, overrides)
}

fn parse(text: &str, name: String, file: &str, overrides: &[(String, String)]) -> Result<Study, Failure> {
    let read: File = toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        Failure::Request(format!("{file}:{line}: {}", error.message()))
    })?;
    let bad = |message: String| Failure::Request(format!("{file}: {message}"));
    for (key, value) in [("depth_m", read.depth_m), ("shaft_radius_m", read.shaft_radius_m)] {
        if let Some(found) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(bad(format!("{key}: found {found}, must be greater than 0")));
        }
    }
    if let Some(Search { from, to, closure_days, .. }) = &read.search
        && !(from < to && to - from <= MOST as i64 && *closure_days > 0.0)
    {
        return Err(bad(format!(
            "search: found from {from}, to {to}, closure_days {closure_days}: from must be below to, by at most {MOST}, and the \
             day above 0"
        )));
    }
    let base = load::scene(&read.scene, &[])?;
    if !matches!(base.domain, Domain::Ring { .. }) || base.rings.is_empty() {
        return Err(bad(format!("scene: found \"{}\", must be a ring with pipes", read.scene)));
    }
    let mut compared = Vec::new();
    let whole = Entry { name: read.scene.clone(), set: Table::new(), boreholes: Vec::new(), reference: None };
    let entries = if read.layouts.is_empty() { vec![whole] } else { read.layouts };
    let combinations = combinations(&read.sweep).map_err(&bad)?;
    if entries.len() * combinations.len() > MOST {
        return Err(bad(format!(
            "sweep: found {} layouts, must be at most {MOST}",
            entries.len() * combinations.len()
        )));
    }
    for entry in &entries {
        for (words, swept) in &combinations {
            let mut own = literals(&read.set);
            own.extend(literals(&entry.set));
            own.extend(swept.iter().cloned());
            own.extend(overrides.iter().cloned());
            let name = match (read.sweep.is_empty(), entries.len()) {
                (true, _) => entry.name.clone(),
                (false, 1) => words.clone(),
                (false, _) => format!("{} {words}", entry.name),
            };
            let mut layout = layout(&read.scene, name, Role::Compared, own)?;
            if !entry.boreholes.is_empty() {
                let moved = boreholes(&entry.boreholes, &layout).map_err(&bad)?;
                layout.overrides.push(moved);
                layout = self::layout(&read.scene, layout.name, Role::Compared, layout.overrides)?;
            }
            layout.reference = entry.reference.clone().or_else(|| read.reference.clone());
            compared.push(layout);
        }
    }
    let mut layouts = compared.clone();
    for first in &compared {
        if let Some(sensitivity) = &read.sensitivity {
            layouts.extend(changed(&read.scene, first, sensitivity).map_err(|failure| match failure {
                Failure::Request(message) => bad(message),
                other => other,
            })?);
        }
        // Boreholes that are known do not deviate by chance.
        let known = first.scene.rings.first().is_some_and(|ring| !ring.moved.is_empty());
        if let Some(deviation) = read.deviation.as_ref().filter(|_| !known) {
            layouts.extend(deviating(&read.scene, first, deviation, &bad)?);
        }
    }
    let mut names: Vec<&str> = layouts.iter().map(|layout| layout.name.as_str()).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(bad(format!("layouts: two have the name \"{}\"", twice[0])));
    }
    Ok(Study {
        name,
        title: read.title,
        source: read.source.unwrap_or_default(),
        scene: read.scene,
        method: read.method,
        depth: read.depth_m,
        shaft_radius: read.shaft_radius_m,
        design: read.design,
        layouts,
        set: literals(&read.set).into_iter().chain(overrides.iter().cloned()).collect(),
        search: read.search,
    })
}

/// Keys and values of a table as overrides of a scene.
fn literals(table: &Table) -> Overrides {
    table.iter().map(|(key, value)| (key.clone(), value.to_string())).collect()
}

/// All combinations of the values of a sweep, with the words that tell them apart.
fn combinations(sweep: &Table) -> Result<Vec<(String, Overrides)>, String> {
    let mut found = vec![(String::new(), Overrides::new())];
    for (key, values) in sweep {
        let values = values.as_array().filter(|values| !values.is_empty());
        let values = values.ok_or_else(|| format!("sweep: {key}: must be a list of values"))?;
        let short = key.rsplit('.').next().unwrap_or(key);
        found = found
            .iter()
            .flat_map(|(words, overrides)| {
                values.iter().map(move |value| {
                    let gap = if words.is_empty() { "" } else { ", " };
                    let mut overrides = overrides.clone();
                    overrides.push((key.clone(), value.to_string()));
                    (format!("{words}{gap}{short} = {value}"), overrides)
                })
            })
            .collect();
    }
    Ok(found)
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
        None => match (at("quarter"), at("half")) {
            (Ok(quarter), _) => ("a quarter: both axes are mirror planes of all pipes".into(), quarter),
            (_, Ok(half)) => ("a half: the x axis is a mirror plane of all pipes".into(), half),
            _ => ("the whole plan: no axis is a mirror plane of all pipes".into(), whole),
        },
    };
    Ok(Layout { name, role, overrides, sector, scene, reference: None })
}

/// The first ring with boreholes that leave the vertical, at their depth.
fn boreholes(boreholes: &[Borehole], layout: &Layout) -> Result<(String, String), String> {
    let count = layout.scene.rings.first().map_or(0, |ring| ring.count);
    let mut moved = Vec::new();
    for borehole in boreholes {
        let Borehole { pipe, inclination_deg, azimuth_deg, depth_m } = *borehole;
        if pipe >= count {
            return Err(format!(
                "layout \"{}\": boreholes: found pipe {pipe}, must be at most {}",
                layout.name,
                count - 1
            ));
        }
        let numbers = depth_m >= 0.0 && depth_m.is_finite() && azimuth_deg.is_finite();
        if !(numbers && (0.0..90.0).contains(&inclination_deg)) {
            let name = &layout.name;
            return Err(format!(
                "layout \"{name}\": boreholes: pipe {pipe}: found inclination_deg {inclination_deg}, depth_m {depth_m}: must \
                 be from 0 to below 90 and not below 0"
            ));
        }
        let (way, azimuth) = (depth_m * inclination_deg.to_radians().tan(), azimuth_deg.to_radians());
        moved.push((pipe, way * azimuth.cos(), way * azimuth.sin()));
    }
    Ok(as_moved(&moved))
}

fn as_moved(moved: &[(usize, f64, f64)]) -> (String, String) {
    let rows: Vec<String> = moved.iter().map(|(pipe, x, y)| format!("[{pipe}, {x:.17e}, {y:.17e}]")).collect();
    ("pipes.0.moved_m".into(), format!("[{}]", rows.join(", ")))
}

/// A layout with each key changed up and down.
fn changed(scene: &str, of: &Layout, sensitivity: &Sensitivity) -> Result<Vec<Layout>, Failure> {
    let Sensitivity { percent, keys } = sensitivity;
    if !(*percent > 0.0 && *percent < 100.0) {
        return Err(Failure::Request(format!("sensitivity: percent: found {percent}, must be above 0 and below 100")));
    }
    let mut found = Vec::new();
    for key in keys {
        let value = load::number(scene, &of.overrides, key)?;
        for factor in [1.0 - 0.01 * percent, 1.0 + 0.01 * percent] {
            let mut overrides = of.overrides.clone();
            overrides.push((key.clone(), format!("{:e}", value * factor)));
            let name = format!("{}, {key} x {factor}", of.name);
            found.push(layout(
                scene,
                name,
                Role::Changed { of: of.name.clone(), key: key.clone(), factor },
                overrides,
            )?);
        }
    }
    Ok(found)
}

/// Members of a layout whose boreholes end anywhere in a circle around their places, as likely in all of it.
fn deviating(
    scene: &str,
    of: &Layout,
    deviation: &Deviation,
    bad: &dyn Fn(String) -> Failure,
) -> Result<Vec<Layout>, Failure> {
    let Deviation { depth_m, percent, members, seed } = *deviation;
    let numbers = depth_m > 0.0 && percent > 0.0 && percent < 100.0 && depth_m.is_finite();
    if !(numbers && (2..=1000).contains(&members)) {
        return Err(bad(format!(
            "deviation: found depth_m {depth_m}, percent {percent}, members {members}: must be above 0, above 0 and below \
             100, 2 to 1000"
        )));
    }
    let Some(ring) = of.scene.rings.first() else { return Ok(Vec::new()) };
    let most = 0.01 * percent * depth_m;
    let mut random = StdRng::seed_from_u64(seed);
    (1..=members)
        .map(|member| {
            let draw = |_: usize| -> (f64, f64) {
                let way = most * random.random::<f64>().sqrt();
                let angle = std::f64::consts::TAU * random.random::<f64>();
                (way * angle.cos(), way * angle.sin())
            };
            let moved: Vec<(usize, f64, f64)> =
                (0..ring.count).map(draw).enumerate().map(|(k, (x, y))| (k, x, y)).collect();
            let mut overrides = of.overrides.clone();
            overrides.push(as_moved(&moved));
            let name = format!("{}, deviating {member}", of.name);
            layout(scene, name, Role::Deviating { of: of.name.clone() }, overrides)
        })
        .collect()
}

/// Pipes of a ring that work.
pub fn working(rings: &[PipeRing]) -> usize {
    rings.iter().map(|ring| ring.numbers().count()).sum()
}

/// A number in TOML by its path, as `pipes.0.temperature_c`.
pub fn number(table: &Table, path: &str) -> Option<f64> {
    let mut at: Option<&Value> = None;
    for part in path.split('.') {
        at = match at {
            None => table.get(part),
            Some(Value::Table(table)) => table.get(part),
            Some(Value::Array(items)) => items.get(part.parse::<usize>().ok()?),
            _ => None,
        };
        at?;
    }
    match at? {
        Value::Float(found) => Some(*found),
        Value::Integer(found) => Some(*found as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(text: &str) -> Result<Study, String> {
        parse(text, "s".into(), "s.toml", &[]).map_err(|failure| failure.to_string())
    }

    #[test]
    fn sweeps_multiply_and_rings_run_on_the_smallest_part() {
        let text = "title = \"t\"\nscene = \"frozen-wall-sand\"\n[sweep]\n\"pipes.0.count\" = [20, 25]\n\
                    \"pipes.0.temperature_c\" = [-20, -30.5]";
        let found = study(text).expect("a study");
        let names: Vec<&str> = found.layouts.iter().map(|layout| layout.name.as_str()).collect();
        let expected = [
            "count = 20, temperature_c = -20",
            "count = 20, temperature_c = -30.5",
            "count = 25, temperature_c = -20",
            "count = 25, temperature_c = -30.5",
        ];
        assert_eq!(names, expected);
        assert!(found.layouts[0].sector.starts_with("a quarter"));
        assert!(found.layouts[2].sector.starts_with("a half"));
    }

    #[test]
    fn deviating_boreholes_stay_in_their_circle_and_need_the_whole_plan() {
        let text = "title = \"t\"\nscene = \"frozen-wall-sand\"\n[deviation]\ndepth_m = 100\npercent = 0.3\nmembers = 3\n\
                    seed = 1";
        let found = study(text).expect("a study");
        assert_eq!(found.layouts.len(), 4);
        for layout in &found.layouts[1..] {
            assert!(layout.sector.starts_with("the whole plan"), "{}", layout.sector);
            let ring = &layout.scene.rings[0];
            assert_eq!(ring.moved.len(), 26);
            assert!(ring.moved.iter().all(|(_, way)| way.length() <= 0.3));
        }
    }

    #[test]
    fn bad_studies_are_refused_with_file_line_and_key() {
        let refused = |text: &str| study(text).map(|_| String::new()).unwrap_or_else(|message| message);
        let found = refused("title = \"t\"\nscene = \"frozen-wall-sand\"\nlayout = 3");
        assert!(found.starts_with("s.toml:3: unknown field `layout`, expected one of `title`"), "{found}");
        let head = "title = \"t\"\nscene = \"frozen-wall-sand\"\n";
        let found = refused(&format!("{head}[[layouts]]\nname = \"a\"\nset = {{ \"pipes.0.count\" = 0 }}"));
        assert_eq!(found, "layout \"a\": --set pipes.0.count=0: found 0, must be an integer between 1 and 1000");
        let found = refused(&format!("{head}[[layouts]]\nname = \"a\"\n[[layouts]]\nname = \"a\""));
        assert_eq!(found, "s.toml: layouts: two have the name \"a\"");
        let found = refused(&format!("{head}[sweep]\n\"pipes.0.count\" = 3"));
        assert_eq!(found, "s.toml: sweep: pipes.0.count: must be a list of values");
        let found = refused(&format!("{head}[sensitivity]\npercent = 20\nkeys = [\"pipes.0.colour\"]"));
        assert_eq!(found, "s.toml: sensitivity: the scene has no number \"pipes.0.colour\"");
        let found = refused("title = \"t\"\nscene = \"stefan-water\"");
        assert_eq!(found, "s.toml: scene: found \"stefan-water\", must be a ring with pipes");
    }
}
