//! Reading study files: what they say, and the layouts that follow from it, with all problems of both at once.

use std::path::Path;

use frazil_core::space::domain::Domain;
use frazil_scene::method::MethodKind;
use frazil_scene::names;
use frazil_scene::{Change, Problem, Problems, Range, Read, Section, Spot, Units, read_section};
use frazil_studies::failure::Failure;
use frazil_studies::input;
use frazil_studies::parts::{Override, Parts};

use super::answers::DAY;
use super::boreholes::{self, Borehole};
use super::goals::{Critical, Design, Deviation, Search, Sensitivity};
use super::refusals::Refusals;
use super::soils;
use super::strata::{self, Stratum};
use super::study::Study;
use super::variants::{Ground, Layout, Role, Undrilled, changed, deviating, drilled, number_of, pair};
use crate::file::Kind;

/// Most layouts of a study.
const MOST: usize = 10_000;

/// Every section of a study.
const SECTIONS: &str = "strata = [{ design = {} }]\nlayouts = [{ boreholes = [{ inclination_deg = 0 }, { surveyed_m = [] }] }]\n\
                        design = {}\nsearch = { goal = \"energy\" }\ncritical = {}\nsensitivity = {}\ndeviation = {}\n";

/// What is no study.
#[derive(Debug, thiserror::Error)]
enum NoStudy {
    #[error("\"{0}\" is a scene, not a layout study: frazil run {0}")]
    Scene(String),
    #[error("\"{asked}\" is neither a file nor a bundled study; those are {}", known.join(", "))]
    Unknown { asked: String, known: Vec<&'static str> },
}

/// Reads a study given by a bundled name or a path.
///
/// # Errors
/// Where there is no such file, or with all problems of it.
pub fn study<'a>(argument: &str, overrides: &[Override], parts: &Parts<'a>) -> Result<Study<'a>, Failure> {
    if let Some(bundled) = frazil_cases::studies::find(argument) {
        return parse(bundled.text, bundled.name, Path::new(&format!("{argument}.toml")), overrides, parts);
    }
    let path = Path::new(argument);
    if frazil_cases::scenes::find(argument).is_some() {
        return Err(Failure::request(NoStudy::Scene(argument.to_owned())));
    }
    if !path.exists() && path.extension().is_none() && path.components().count() == 1 {
        let known = frazil_cases::studies::all().iter().map(|study| study.name).collect();
        return Err(Failure::request(NoStudy::Unknown { asked: argument.to_owned(), known }));
    }
    let text = input::text(path)?;
    let name = path.file_stem().map_or_else(|| "study".into(), |stem| stem.to_string_lossy().into_owned());
    parse(&text, &name, path, overrides, parts)
}

/// Reads a study from the text of its file, whose place says where a scene given by a path lies.
///
/// # Errors
/// With all problems of the file and of the scenes of its layouts.
pub fn parse<'a>(
    text: &str,
    name: &str,
    path: &Path,
    overrides: &[Override],
    parts: &Parts<'a>,
) -> Result<Study<'a>, Failure> {
    let file = path.display().to_string();
    if Kind::of(text) == Some(Kind::Scene) {
        return Err(Failure::request(NoStudy::Scene(file)));
    }
    Ok(read_section(text, &file, Units::Si, |root| {
        root.know(SECTIONS, |root| drop(File::read(root, &[])));
        let mut file = File::read(root, parts.methods);
        let scene = base(root, &file, path, parts)?;
        let (set, strata) = (std::mem::take(&mut file.set), std::mem::take(&mut file.strata));
        let ground = Ground { parts: *parts, scene, set, strata, asked: overrides.to_vec() };
        let layouts = file.layouts(root, &ground)?;
        Ok(Study {
            name: names::of(name),
            title: file.title?,
            source: file.source,
            method: file.method,
            depth: file.depth,
            shaft_radius: file.shaft_radius,
            design: file.design,
            layouts,
            search: file.search,
            critical: file.critical,
            error: None,
            ground,
        })
    })?)
}

/// Name or path of the scene that layouts change, which must be a ring with pipes.
fn base(root: &mut Section<'_>, file: &File, path: &Path, parts: &Parts<'_>) -> Read<String> {
    let mut scene = file.scene.clone()?;
    if frazil_cases::scenes::find(&scene).is_none()
        && let Some(folder) = path.parent()
        && (scene.ends_with(".toml") || folder.join(&scene).exists())
    {
        scene = folder.join(&scene).to_string_lossy().into_owned();
    }
    match (parts.scene_at)(&scene, &[]) {
        Ok(base) if matches!(base.domain, Domain::Ring { .. }) && !base.rings.is_empty() => Ok(scene),
        Ok(_) => Err(root.problem("scene", format!("found \"{scene}\", must be a ring with pipes"))),
        Err(failure) => Err(root.problem("scene", failure.to_string())),
    }
}

/// What a study file says before any scene is read.
struct File {
    title: Read<String>,
    source: String,
    scene: Read<String>,
    method: Option<String>,
    set: Vec<Change>,
    reference: Option<String>,
    depth: Option<f64>,
    shaft_radius: Option<f64>,
    design: Option<Design>,
    strata: Vec<Stratum>,
    entries: Vec<Entry>,
    sweep: Vec<Vec<Change>>,
    sensitivity: Option<Sensitivity>,
    deviation: Option<Deviation>,
    search: Option<Search>,
    critical: Option<Critical>,
}

/// A layout as the file has it.
struct Entry {
    name: String,
    set: Vec<Change>,
    boreholes: Vec<Borehole>,
    reference: Option<String>,
    /// Where its boreholes stand.
    drilled: Spot,
}

impl File {
    fn read(root: &mut Section<'_>, methods: &[&'static MethodKind]) -> File {
        let (title, source, scene) = (root.text("title"), root.text_or("source", ""), root.text("scene"));
        let methods: Vec<(&str, &str)> = methods.iter().map(|kind| (kind.name, kind.name)).collect();
        let method = root.optional_choice("method", &methods).map(str::to_owned);
        let (set, reference) = (soils::changes(root), root.optional_text("reference"));
        let depth = root.optional_number(("depth", "m"), Range::POSITIVE);
        let shaft_radius = root.optional_number(("shaft_radius", "m"), Range::POSITIVE);
        let (design, strata) = (Design::read(root), strata::read(root, depth));
        let (layered, deepest) = (root.has("strata"), strata.last().map(|last| last.to));
        let mut entries = Vec::new();
        for mut section in root.sections("layouts") {
            let entry = Entry {
                set: soils::changes(&mut section),
                boreholes: boreholes::read(&mut section, layered, deepest),
                reference: section.optional_text("reference"),
                drilled: section.spot("boreholes"),
                name: section.text("name").unwrap_or_default(),
            };
            entries.push(entry);
        }
        let sweep = root.swept("sweep");
        let sensitivity = root.optional_section("sensitivity").and_then(|mut own| Sensitivity::read(&mut own).ok());
        let deviation = root.optional_section("deviation").and_then(|mut own| Deviation::read(&mut own, layered).ok());
        let designed = root.has("design") || strata.iter().any(|own| own.design.is_some());
        let search = root.optional_section("search").and_then(|mut own| Search::read(&mut own, designed).ok());
        let critical = root.optional_section("critical").and_then(|mut own| Critical::read(&mut own).ok());
        File {
            title,
            source,
            scene,
            method,
            set,
            reference,
            depth,
            shaft_radius,
            design,
            strata,
            entries,
            sweep,
            sensitivity,
            deviation,
            search,
            critical,
        }
    }

    /// All layouts of the study: those that are compared, and what is varied of them.
    fn layouts(&self, root: &mut Section<'_>, ground: &Ground<'_>) -> Read<Vec<Layout>> {
        let mut refusals = Refusals::new();
        let compared = self.compared(root, ground, &mut refusals)?;
        if let (Some(search), Some(first)) = (&self.search, compared.first()) {
            let end = first.scene.duration / DAY;
            if search.last_day() > end {
                root.problem("search", format!("found day {}, but the runs end on day {end}", search.last_day()));
            }
        }
        for (key, spot) in self.sensitivity.iter().flat_map(|own| &own.keys) {
            if !compared.is_empty() && compared.iter().all(|one| number_of(ground, one, key).is_none()) {
                let old = if key.split('.').any(|part| part == "0") { ": lists count from 1" } else { "" };
                root.record(spot.problem(format!("the scene has no number \"{key}\"{old}")));
            }
        }
        let mut layouts = compared.clone();
        let mut take = |found: Result<Vec<Layout>, Undrilled>, of: &Layout, spot: Spot| match found {
            Ok(found) => layouts.extend(found),
            Err(reason) => told(&spot, &reason).for_each(|problem| refusals.add(problem, &of.name)),
        };
        for one in &compared {
            if let Some(sensitivity) = &self.sensitivity {
                take(changed(ground, one, sensitivity).map_err(Undrilled::from), one, root.spot("sensitivity"));
            }
            if let Some(deviation) = &self.deviation {
                take(deviating(ground, one, deviation), one, root.spot("deviation"));
            }
        }
        let mut names: Vec<&str> = layouts.iter().map(|layout| layout.name.as_str()).collect();
        names.sort_unstable();
        // Those without a name are told of as such.
        for twice in names.windows(2).filter(|pair| pair[0] == pair[1] && !pair[0].is_empty()) {
            root.problem("layouts", format!("two layouts have the name \"{}\"", twice[0]));
        }
        for (problem, layouts) in refusals.told() {
            let message = format!("{} ({layouts})", problem.message);
            root.record(Problem { message, ..problem });
        }
        Ok(layouts)
    }

    /// The layouts that are compared: each entry with all combinations of what is swept, in each stratum.
    fn compared(
        &self,
        root: &mut Section<'_>,
        ground: &Ground<'_>,
        refusals: &mut Refusals<Problem>,
    ) -> Read<Vec<Layout>> {
        let counts = [self.entries.len().max(1), ground.strata.len().max(1)];
        let counts = self.sweep.iter().map(Vec::len).chain(counts);
        let count = counts.fold(1, usize::saturating_mul);
        if count > MOST {
            return Err(root.problem("sweep", format!("found {count} layouts, must be at most {MOST}")));
        }
        let (combinations, scene) = (combinations(&self.sweep), root.spot("scene"));
        // A study without layouts is of its scene alone.
        let whole = [Entry::whole(&ground.scene, &scene)];
        let entries = if self.entries.is_empty() { &whole[..] } else { &self.entries };
        let mut found = Vec::new();
        for entry in entries {
            for (words, swept) in &combinations {
                let shaft = match (self.sweep.is_empty(), entries.len()) {
                    (true, _) => entry.name.clone(),
                    (false, 1) => words.clone(),
                    (false, _) => format!("{} {words}", entry.name),
                };
                for at in ground.places() {
                    match self.layout(ground, entry, swept, (&shaft, at), &scene) {
                        Ok(layout) => found.push(layout),
                        Err(problems) => {
                            let name = ground.name(&shaft, at);
                            problems.into_iter().for_each(|problem| refusals.add(problem, &name));
                        }
                    }
                }
            }
        }
        Ok(found)
    }

    /// A layout of a name in a stratum, or what refuses it.
    fn layout(
        &self,
        ground: &Ground<'_>,
        entry: &Entry,
        swept: &[&Change],
        (shaft, at): (&str, Option<usize>),
        scene: &Spot,
    ) -> Result<Layout, Vec<Problem>> {
        let own = || entry.set.iter().chain(swept.iter().copied());
        let layout = ground.layout(shaft, at, Role::Compared, own().map(pair).collect()).map_err(|failure| {
            let changes: Vec<&Change> = ground.changes(at).chain(own()).collect();
            located(failure, &changes, &ground.asked, scene)
        })?;
        let reference = entry.reference.clone().or_else(|| self.reference.clone());
        let layout = Layout { reference, ..layout };
        if entry.boreholes.is_empty() {
            return Ok(layout);
        }
        let drilled = drilled(ground, layout, &entry.boreholes);
        drilled.map_err(|reason| told(&entry.drilled, &reason).collect())
    }
}

impl Entry {
    /// What stands for the scene alone.
    fn whole(scene: &str, spot: &Spot) -> Entry {
        let (name, drilled) = (scene.to_owned(), spot.clone());
        Entry { name, set: Vec::new(), boreholes: Vec::new(), reference: None, drilled }
    }
}

/// Why a layout is refused, at a place of the file.
fn told(spot: &Spot, reason: &Undrilled) -> impl Iterator<Item = Problem> {
    reason.to_string().lines().map(|line| spot.problem(line)).collect::<Vec<_>>().into_iter()
}

/// What refuses the scene of a layout, each at the place of the file that has brought it in, or that of the scene.
fn located(failure: Failure, changes: &[&Change], asked: &[Override], scene: &Spot) -> Vec<Problem> {
    let Failure::Scene(Problems { file, problems }) = failure else { return vec![scene.problem(failure.to_string())] };
    let at = |problem: Problem| {
        let is = |(key, value): &Override| problem.set.as_deref() == Some(format!("{key}={value}").as_str());
        match changes.iter().rev().find(|change| is(&pair(change))) {
            Some(change) if change.key == problem.key => change.spot.problem(problem.message),
            Some(change) => change.spot.problem(format!("{}: {}", problem.key, problem.message)),
            None if asked.iter().any(is) => problem,
            None => scene.problem(Problems { file: file.clone(), problems: vec![problem] }.to_string()),
        }
    };
    problems.into_iter().map(at).collect()
}

/// All combinations of the values of a sweep, with the words that tell them apart.
fn combinations(sweep: &[Vec<Change>]) -> Vec<(String, Vec<&Change>)> {
    sweep.iter().fold(vec![(String::new(), Vec::new())], |found, values| {
        let mut next = Vec::with_capacity(found.len() * values.len());
        for (words, changes) in &found {
            for change in values {
                let gap = if words.is_empty() { "" } else { ", " };
                let words = format!("{words}{gap}{} = {}", change.key, change.value);
                next.push((words, [&changes[..], &[change]].concat()));
            }
        }
        next
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundled;

    fn study(text: &str) -> Result<Study<'static>, Failure> {
        parse(text, "s", Path::new("s.toml"), &[], &bundled::parts())
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
        let rings_of = |found: Study<'_>| found.layouts[0].scene.rings.clone();
        let found = rings_of(one.expect("a study"));
        assert_eq!((found[0].moved.len(), &found[1].moved[..]), (0, &[(2, glam::DVec2::new(0.1, 0.2))][..]));
        let refused = |borehole: &str| leaning(borehole).map_or_else(|failure| failure.to_string(), |_| String::new());
        let found = refused("{ pipe = \"3.1\", inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        let whom = "(layout \"a\")";
        assert_eq!(
            found,
            format!("s.toml:7: layouts.1.boreholes: found pipe 3.1, must be of a ring from 1 to 2 {whom}")
        );
        let found = refused("{ pipe = \"2.5\", inclination_deg = 0, azimuth_deg = 0, depth_m = 9 }");
        assert_eq!(found, format!("s.toml:7: layouts.1.boreholes: found pipe 2.5, must be at most 2.4 {whom}"));
        // The pipe of the inner ring on the x axis goes out to that of the outer one.
        let found = refused("{ pipe = \"2.1\", surveyed_m = [[0, 0, 0], [50, 1, 0]], depth_m = 50 }");
        let expected = "boreholes of pipes 1.1 and 2.1 intersect at a depth of 50.0 m: their axes are 0.0000 m apart, must be more than 0.084";
        assert_eq!(found, format!("s.toml:7: layouts.1.boreholes: {expected} {whom}"));
    }

    #[test]
    fn what_only_the_scene_tells_is_refused_with_file_line_and_key() {
        let refused = |text: &str| study(text).map_or_else(|failure| failure.to_string(), |_| String::new());
        let head = "title = \"t\"\nscene = \"frozen-wall-sand\"\n";
        let found = refused(&format!("{head}[[layouts]]\nname = \"a\"\n[[layouts]]\nname = \"a\""));
        assert_eq!(found, "s.toml:3: layouts: two layouts have the name \"a\"");
        let found = refused(&format!("{head}[sensitivity]\npercent = 20\nkeys = [\"pipes.1.colour\"]"));
        assert_eq!(found, "s.toml:5: sensitivity.keys.1: the scene has no number \"pipes.1.colour\"");
        // As older files have it, which count from 0.
        let found = refused(&format!("{head}[sensitivity]\npercent = 20\nkeys = [\"pipes.0.temperature_c\"]"));
        let expected = "the scene has no number \"pipes.0.temperature_c\": lists count from 1";
        assert_eq!(found, format!("s.toml:5: sensitivity.keys.1: {expected}"));
        let found = refused(&format!("{head}[sweep]\n\"pipes.0.count\" = [20, 25]"));
        let expected = "lists count from 1: what was \"pipes.0\" is \"pipes.1\"";
        let both = [(1, 20), (2, 25)].map(|(number, count)| {
            format!("s.toml:4: sweep.pipes.0.count.{number}: {expected} (layout \"pipes.0.count = {count}\")")
        });
        assert_eq!(found, both.join("\n"));
        let found = refused("title = \"t\"\nscene = \"stefan-water\"");
        assert_eq!(found, "s.toml:2: scene: found \"stefan-water\", must be a ring with pipes");
        let found =
            refused(&format!("{head}[search]\nkey = \"pipes.1.count\"\nfrom = 20\nto = 30\nclosure_days = 500"));
        assert_eq!(found, "s.toml:3: search: found day 500, but the runs end on day 60");
    }
}
