//! Study files: a scene, and what each layout changes of it.

use std::path::Path;

use frazil_core::space::domain::Domain;
use serde::Deserialize;
use toml::Table;

use super::answers::DAY;
use super::boreholes::{Borehole, Deviation};
use super::critical::Critical;
use super::horizons::{self, Horizon};
use super::soils;
use super::variants::{Ground, Layout, Role, Sensitivity, changed, deviating, drilled, number_of};
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
    soil: Option<String>,
    #[serde(default)]
    set: Table,
    reference: Option<String>,
    depth_m: Option<f64>,
    shaft_radius_m: Option<f64>,
    design: Option<Design>,
    #[serde(default)]
    horizons: Vec<horizons::Entry>,
    #[serde(default)]
    layouts: Vec<Entry>,
    #[serde(default)]
    sweep: Table,
    sensitivity: Option<Sensitivity>,
    deviation: Option<Deviation>,
    search: Option<Search>,
    critical: Option<Critical>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    soil: Option<String>,
    #[serde(default)]
    set: Table,
    #[serde(default)]
    boreholes: Vec<Borehole>,
    reference: Option<String>,
}

/// What a wall must come to.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Thickness where the wall is weakest: frozen length on the least frozen way through it (m).
    pub thickness_m: f64,
    /// Mean temperature on that way.
    pub mean_temperature_c: f64,
}

/// What is searched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// The least whole number.
    #[default]
    Least,
    /// The value that takes the least energy.
    Energy,
}

/// The value of a key that is best of all at which the wall is in time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Search {
    /// The key, as `pipes.1.count`.
    pub key: String,
    /// The least value.
    pub from: f64,
    /// The greatest value.
    pub to: f64,
    /// What is best.
    #[serde(default)]
    pub goal: Goal,
    /// Day by which the wall must have closed.
    pub closure_days: Option<f64>,
    /// Day by which it must be as designed.
    pub design_days: Option<f64>,
    /// How near to the best value the search has to come.
    pub within: Option<f64>,
}

impl Search {
    /// The last of the days that are asked for.
    pub fn last_day(&self) -> f64 {
        self.closure_days.into_iter().chain(self.design_days).fold(0.0, f64::max)
    }

    /// How near to the best value the search has to come: a hundredth of the range, if nothing is said.
    pub fn within(&self) -> f64 {
        self.within.unwrap_or(0.01 * (self.to - self.from))
    }

    /// What cannot be meant.
    fn check(&self, designed: bool) -> Result<(), String> {
        let Search { from, to, goal, closure_days, design_days, within, .. } = self;
        let whole = *goal == Goal::Energy || (from.fract() == 0.0 && to.fract() == 0.0 && to - from <= MOST as f64);
        if !(from < to && from.is_finite() && to.is_finite() && whole) {
            let kind = if *goal == Goal::Least { ", both whole, by at most 10000" } else { "" };
            return Err(format!("search: found from {from}, to {to}: from must be below to{kind}"));
        }
        let days = [("closure_days", closure_days), ("design_days", design_days)];
        if let Some((key, day)) =
            days.iter().find_map(|(key, day)| Some((key, day.filter(|day| !day.is_finite() || *day <= 0.0)?)))
        {
            return Err(format!("search: {key}: found {day}, must be greater than 0"));
        }
        if closure_days.or(*design_days).is_none() {
            return Err("search: closure_days or design_days is missing".into());
        }
        if design_days.is_some() && !designed {
            return Err("search: design_days needs a design".into());
        }
        match within {
            Some(found) if *goal == Goal::Least => {
                Err(format!("search: within: found {found}, but the least whole number is exact"))
            }
            Some(found) if !(*found > 0.0 && *found < to - from) => {
                Err(format!("search: within: found {found}, must be greater than 0 and less than {}", to - from))
            }
            _ => Ok(()),
        }
    }
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
    /// Layers of ground, downwards.
    pub horizons: Vec<Horizon>,
    /// Radius of the shaft (m), for sketches.
    pub shaft_radius: Option<f64>,
    /// What a wall must come to.
    pub design: Option<Design>,
    /// All layouts.
    pub layouts: Vec<Layout>,
    /// What is searched.
    pub search: Option<Search>,
    /// What is sought of each layout.
    pub critical: Option<Critical>,
    /// What all layouts change.
    ground: Ground,
}

impl Study {
    /// A layout with another value of a key.
    pub fn changed(&self, of: &Layout, key: &str, value: &str) -> Result<Layout, Failure> {
        let own = vec![(key.to_owned(), value.to_owned())];
        self.ground.again(of, &format!(", {key} = {value}"), Role::Tried, &own)
    }

    /// The layout with a value of the key that is searched, at each horizon.
    pub fn tried(&self, search: &Search, value: f64) -> Result<Vec<Layout>, Failure> {
        let name = format!("{} = {value}", search.key);
        let text = if search.goal == Goal::Least { format!("{value}") } else { format!("{value:?}") };
        let own = vec![(search.key.clone(), text)];
        self.ground.places().map(|at| self.ground.layout(&name, at, Role::Tried, &own)).collect()
    }

    /// Depth (m) over which a layout takes heat.
    pub fn depth_of(&self, layout: &Layout) -> Option<f64> {
        layout.horizon.map_or(self.depth, |at| self.horizons.get(at).map(Horizon::thickness))
    }

    /// What the wall of a layout must come to.
    pub fn design_of(&self, layout: &Layout) -> Option<Design> {
        layout.horizon.and_then(|at| self.horizons.get(at)?.design).or(self.design)
    }
}

/// Reads a study given by a bundled name or a path.
pub fn read(argument: &str, overrides: &[(String, String)]) -> Result<Study, Failure> {
    if let Some(bundled) = frazil_cases::studies::find(argument) {
        return parse(bundled.text, bundled.name, Path::new(&format!("{argument}.toml")), overrides);
    }
    let path = Path::new(argument);
    if frazil_cases::scenes::find(argument).is_some() {
        return Err(no_study(argument));
    }
    if !path.exists() && path.extension().is_none() && path.components().count() == 1 {
        let names: Vec<&str> = frazil_cases::studies::all().iter().map(|study| study.name).collect();
        return Err(Failure::Request(format!(
            "\"{argument}\" is neither a file nor a bundled study; those are {}",
            names.join(", ")
        )));
    }
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, "cannot be read", error))?;
    let name = path.file_stem().map_or_else(|| "study".into(), |stem| stem.to_string_lossy().into_owned());
    parse(&text, &name, path, overrides)
}

fn no_study(argument: &str) -> Failure {
    Failure::Request(format!(
        "\"{argument}\" is a scene and no study of layouts, which names one: frazil run {argument}"
    ))
}

/// Reads a study from the text of its file, whose place says where a scene given by a path lies.
pub fn parse(text: &str, name: &str, path: &Path, overrides: &[(String, String)]) -> Result<Study, Failure> {
    let file = path.display();
    let mut read: File = toml::from_str(text).map_err(|error| {
        if load::Kind::of(text) == Some(load::Kind::Scene) {
            return no_study(&file.to_string());
        }
        let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        Failure::Request(format!("{file}:{line}: {}", error.message()))
    })?;
    if frazil_cases::scenes::find(&read.scene).is_none()
        && let Some(folder) = path.parent()
        && (read.scene.ends_with(".toml") || folder.join(&read.scene).exists())
    {
        read.scene = folder.join(&read.scene).to_string_lossy().into_owned();
    }
    let bad = |message: String| Failure::Request(format!("{file}: {message}"));
    for (key, value) in [("depth_m", read.depth_m), ("shaft_radius_m", read.shaft_radius_m)] {
        if let Some(found) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(bad(format!("{key}: found {found}, must be greater than 0")));
        }
    }
    if let Some(search) = &read.search {
        let designed = read.design.is_some() || read.horizons.iter().any(horizons::Entry::is_designed);
        search.check(designed).map_err(&bad)?;
    }
    if let Some(critical) = &read.critical {
        critical.check().map_err(&bad)?;
    }
    let base = load::scene(&read.scene, &[])?;
    if !matches!(base.domain, Domain::Ring { .. }) || base.rings.is_empty() {
        return Err(bad(format!("scene: found \"{}\", must be a ring with pipes", read.scene)));
    }
    let horizons = horizons::read(&read.horizons, read.depth_m).map_err(&bad)?;
    let ground = Ground {
        scene: read.scene.clone(),
        set: soils::overrides(read.soil.as_ref()).map_err(&bad)?.into_iter().chain(literals(&read.set)).collect(),
        horizons: horizons.clone(),
        asked: overrides.to_vec(),
    };
    let mut compared = Vec::new();
    let whole =
        Entry { name: read.scene.clone(), soil: None, set: Table::new(), boreholes: Vec::new(), reference: None };
    let entries = if read.layouts.is_empty() { vec![whole] } else { read.layouts };
    let combinations = combinations(&read.sweep).map_err(&bad)?;
    let count = entries.len() * combinations.len() * horizons.len().max(1);
    if count > MOST {
        return Err(bad(format!("sweep: found {count} layouts, must be at most {MOST}")));
    }
    for entry in &entries {
        for (words, swept) in &combinations {
            let soil = soils::overrides(entry.soil.as_ref());
            let mut own = soil.map_err(|message| bad(format!("layout \"{}\": {message}", entry.name)))?;
            own.extend(literals(&entry.set));
            own.extend(swept.iter().cloned());
            let shaft = match (read.sweep.is_empty(), entries.len()) {
                (true, _) => entry.name.clone(),
                (false, 1) => words.clone(),
                (false, _) => format!("{} {words}", entry.name),
            };
            for at in ground.places() {
                let reference = entry.reference.clone().or_else(|| read.reference.clone());
                let layout = Layout { reference, ..ground.layout(&shaft, at, Role::Compared, &own)? };
                compared.push(match &entry.boreholes[..] {
                    [] => layout,
                    boreholes => drilled(&ground, layout, boreholes).map_err(|failure| match failure {
                        Failure::Request(message) => bad(message),
                        other => other,
                    })?,
                });
            }
        }
    }
    if let (Some(search), Some(first)) = (&read.search, compared.first()) {
        let end = first.scene.duration / DAY;
        if search.last_day() > end {
            return Err(bad(format!("search: found day {}, but the runs end on day {end}", search.last_day())));
        }
    }
    let mut layouts = compared.clone();
    if let Some(sensitivity) = &read.sensitivity {
        let unknown = |key: &&String| compared.iter().all(|one| number_of(&ground, one, key).is_none());
        if let Some(key) = sensitivity.keys.iter().find(unknown) {
            let old = if key.split('.').any(|part| part == "0") { ": lists count from 1" } else { "" };
            return Err(bad(format!("sensitivity: the scene has no number \"{key}\"{old}")));
        }
    }
    for first in &compared {
        if let Some(sensitivity) = &read.sensitivity {
            layouts.extend(changed(&ground, first, sensitivity).map_err(|failure| match failure {
                Failure::Request(message) => bad(message),
                other => other,
            })?);
        }
        if let Some(deviation) = &read.deviation {
            if let Some(key) = ground.leans(first) {
                return Err(bad(format!(
                    "deviation: beside layout \"{}\", whose boreholes are known ({key}): they do not deviate by chance, give \
                     them a study of their own",
                    first.name
                )));
            }
            layouts.extend(deviating(&ground, first, deviation, &bad)?);
        }
    }
    let mut names: Vec<&str> = layouts.iter().map(|layout| layout.name.as_str()).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(bad(format!("layouts: two have the name \"{}\"", twice[0])));
    }
    Ok(Study {
        name: name.to_owned(),
        title: read.title,
        source: read.source.unwrap_or_default(),
        scene: read.scene,
        method: read.method,
        depth: read.depth_m,
        horizons,
        shaft_radius: read.shaft_radius_m,
        design: read.design,
        layouts,
        ground,
        search: read.search,
        critical: read.critical,
    })
}

/// Keys and values of a table as overrides of a scene.
pub(super) fn literals(table: &Table) -> Overrides {
    table.iter().map(|(key, value)| (key.clone(), value.to_string())).collect()
}

/// All combinations of the values of a sweep, with the words that tell them apart.
fn combinations(sweep: &Table) -> Result<Vec<(String, Overrides)>, String> {
    let mut found = vec![(String::new(), Overrides::new())];
    for (key, values) in sweep {
        let values = values.as_array().filter(|values| !values.is_empty());
        let values = values.ok_or_else(|| format!("sweep: {key}: must be a list of values"))?;
        found = found
            .iter()
            .flat_map(|(words, overrides)| {
                values.iter().map(move |value| {
                    let gap = if words.is_empty() { "" } else { ", " };
                    let mut overrides = overrides.clone();
                    overrides.push((key.clone(), value.to_string()));
                    (format!("{words}{gap}{key} = {value}"), overrides)
                })
            })
            .collect();
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(text: &str) -> Result<Study, String> {
        parse(text, "s", Path::new("s.toml"), &[]).map_err(|failure| failure.to_string())
    }

    #[test]
    fn sweeps_multiply_and_rings_run_on_the_smallest_part() {
        let text = "title = \"t\"\nscene = \"frozen-wall-sand\"\n[sweep]\n\"pipes.1.count\" = [20, 25]\n\
                    \"pipes.1.temperature_c\" = [-20, -30.5]";
        let found = study(text).expect("a study");
        let names: Vec<&str> = found.layouts.iter().map(|layout| layout.name.as_str()).collect();
        let expected = [
            "pipes.1.count = 20, pipes.1.temperature_c = -20",
            "pipes.1.count = 20, pipes.1.temperature_c = -30.5",
            "pipes.1.count = 25, pipes.1.temperature_c = -20",
            "pipes.1.count = 25, pipes.1.temperature_c = -30.5",
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
    fn boreholes_of_all_rings_lean() {
        let rings = "title = \"t\"\nscene = \"frozen-wall-sand\"\n[set]\npipes = [\
                     { count = 6, ring_radius_m = 5, pipe_radius_m = 0.054, temperature_c = -20 }, \
                     { count = 4, ring_radius_m = 4, pipe_radius_m = 0.03, temperature_c = -20 }]\n";
        let found = study(&format!("{rings}[deviation]\ndepth_m = 100\npercent = 0.3\nmembers = 2\nseed = 1"));
        let moved = |layout: &Layout| layout.scene.rings.iter().map(|ring| ring.moved.len()).collect::<Vec<_>>();
        assert_eq!(found.expect("a study").layouts.iter().map(moved).collect::<Vec<_>>(), [[0, 0], [6, 4], [6, 4]]);
        let leaning = |borehole: &str| study(&format!("{rings}[[layouts]]\nname = \"a\"\nboreholes = [{borehole}]"));
        let one = leaning("{ pipe = \"2.3\", surveyed_m = [[0, 0, 0], [200, 0.2, 0.4]], depth_m = 100 }");
        let rings_of = |found: Study| found.layouts[0].scene.rings.clone();
        let found = rings_of(one.expect("a study"));
        assert_eq!((found[0].moved.len(), &found[1].moved[..]), (0, &[(2, glam::DVec2::new(0.1, 0.2))][..]));
        let refused = |borehole: &str| leaning(borehole).map(|_| String::new()).unwrap_or_else(|message| message);
        let found = refused("{ pipe = \"3.1\", inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        assert_eq!(found, "s.toml: layout \"a\": boreholes: found pipe 3.1, must be of a ring from 1 to 2");
        let found = refused("{ pipe = \"2.5\", inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        assert_eq!(found, "s.toml: layout \"a\": boreholes: found pipe 2.5, must be at most 2.4");
        // As older files have it, which count from 0.
        let found = refused("{ ring = 1, pipe = 3, inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        let name = "the name of a pipe as results have it, of its ring and its number on it from 1, as \"1.10\"";
        assert_eq!(found, format!("s.toml:7: pipe: found 3, must be {name}: what was pipe 3 of ring 1 is \"2.4\""));
        let found = refused("{ pipe = 0, inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        assert_eq!(found, format!("s.toml:7: pipe: found 0, must be {name}: what was pipe 0 of ring 0 is \"1.1\""));
        let found = refused("{ ring = 1, pipe = \"2.1\", inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        assert_eq!(found, "s.toml:7: ring: found 1, must be left out: the name of the pipe has it");
        // The pipe of the inner ring on the x axis goes out to that of the outer one.
        let found = refused("{ pipe = \"2.1\", surveyed_m = [[0, 0, 0], [50, 1, 0]], depth_m = 50 }");
        let expected =
            "pipes 1.1 and 2.1 meet at a depth of 50.0 m: their axes are 0.0000 m apart, must be more than 0.084";
        assert_eq!(found, format!("s.toml: layout \"a\": boreholes: {expected}"));
    }

    #[test]
    fn bad_studies_are_refused_with_file_line_and_key() {
        let refused = |text: &str| study(text).map(|_| String::new()).unwrap_or_else(|message| message);
        let found = refused("title = \"t\"\nscene = \"frozen-wall-sand\"\nlayout = 3");
        assert!(found.starts_with("s.toml:3: unknown field `layout`, expected one of `title`"), "{found}");
        let head = "title = \"t\"\nscene = \"frozen-wall-sand\"\n";
        let found = refused(&format!("{head}[[layouts]]\nname = \"a\"\nset = {{ \"pipes.1.count\" = 0 }}"));
        assert_eq!(found, "layout \"a\": --set pipes.1.count=0: found 0, must be an integer between 1 and 1000");
        let found = refused(&format!("{head}[[layouts]]\nname = \"a\"\n[[layouts]]\nname = \"a\""));
        assert_eq!(found, "s.toml: layouts: two have the name \"a\"");
        let found = refused(&format!("{head}[sweep]\n\"pipes.1.count\" = 3"));
        assert_eq!(found, "s.toml: sweep: pipes.1.count: must be a list of values");
        let found = refused(&format!("{head}[sensitivity]\npercent = 20\nkeys = [\"pipes.1.colour\"]"));
        assert_eq!(found, "s.toml: sensitivity: the scene has no number \"pipes.1.colour\"");
        // As older files have it, which count from 0.
        let found = refused(&format!("{head}[sensitivity]\npercent = 20\nkeys = [\"pipes.0.temperature_c\"]"));
        assert_eq!(found, "s.toml: sensitivity: the scene has no number \"pipes.0.temperature_c\": lists count from 1");
        let found = refused(&format!("{head}[sweep]\n\"pipes.0.count\" = [20, 25]"));
        let expected = "lists count from 1: what was \"pipes.0\" is \"pipes.1\"";
        assert_eq!(found, format!("layout \"pipes.0.count = 20\": --set pipes.0.count=20: {expected}"));
        let found = refused("title = \"t\"\nscene = \"stefan-water\"");
        assert_eq!(found, "s.toml: scene: found \"stefan-water\", must be a ring with pipes");
    }
}
