//! Reading scene files: every check that needs no particles, and all problems of a file at once.

mod anisotropy;
mod body;
mod cracks;
mod every_key;
mod excavation;
mod flow;
mod formulas;
mod gravity;
mod ground;
mod known;
mod numerics;
mod pipes;
mod porous;
mod problem;
mod random;
mod range;
mod reference;
mod regions;
mod rows;
mod schema;
mod section;
mod shells;
mod size;
mod spacing;
mod stream;
#[cfg(test)]
mod tests;
mod tree;
mod watch;
mod water;

use frazil_core::boundary::condition::Condition;
use frazil_core::physics::material::Material;
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;

use crate::capability::{self, Feature, Place};
use crate::files::Source;
use crate::method::MethodKind;
use crate::names;
use crate::pipe_ring::PipeRing;
use crate::profile::{Profile, ProfileValues};
use crate::random::RandomGround;
use crate::region::{Region, Shape};
use crate::scene::{Scene, Temperatures, Wall, WallPart, Watch, has_flux};
use crate::solute::Solute;
use crate::stream::Stream;
use crate::units::Units;
use formulas::Run;
use problem::Log;
use section::Along;
use water::{Balance, Heads};

pub use known::soils;
pub use problem::{Noted, Problem, Problems, Read};
pub use range::Range;
pub use section::{Change, Duration, Key, Section, Spot};
pub use size::MOST_BYTES;
pub use spacing::at_most as spacing_at_most;

impl Scene {
    /// Reads a scene from the text of its file; a text alone has no files beside it ([`Source`]).
    ///
    /// `name` becomes the scene's short name as far as it can be one of a folder ([`names::of`]), `file` stands in messages, `overrides` are the pairs of key path and
    /// value of `--set`, and `methods` are the methods whose sections may occur. A value of `--set` that is no TOML
    /// is taken as text, so that words need no quotes.
    ///
    /// # Errors
    /// With all problems of the file and of what overrides it.
    pub fn read<'a>(
        source: impl Into<Source<'a>>,
        name: &str,
        file: &str,
        overrides: &[(String, String)],
        methods: &[&'static MethodKind],
    ) -> Result<Scene, Problems> {
        let Source { text, files } = source.into();
        let mut entries = tree::parse(text).map_err(|problems| Problems::new(file, problems))?;
        let (log, kinds) = (Log::beside(files), methods.to_vec());
        log.know(move || every_key::every_key(&kinds));
        for (key, value) in overrides {
            if let Err(problem) = tree::set(&mut entries, key, value) {
                log.record(problem);
            }
        }
        let folder = names::of(name);
        let scene = read_root(Section::root(&entries, &log), &folder, methods);
        let files = log.files_read();
        let mut scene = finished(scene, log, file)?;
        scene.hash = hash(text, overrides, &files);
        scene.files = files;
        if folder != name {
            scene.remarks.push(format!("its name is not one of a folder on every system: it is called \"{folder}\""));
        }
        Ok(scene)
    }
}

/// What a scene or a study says of itself before all else.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Heading {
    /// What it is called.
    pub title: String,
    /// Where its parameters come from.
    pub source: String,
}

/// Reads what a text of a scene or a study says of itself, and nothing else of it: whether it is one remains open.
///
/// # Errors
/// Where that is missing, or the text is no TOML.
pub fn heading(text: &str, file: &str) -> Result<Heading, Problems> {
    // Keys of the whole stand before the first section. What only looks like one, within a text, leaves half of that text behind,
    // which is no TOML.
    let begins = |line: &str| line.trim_start().starts_with('[');
    let head: usize = text.split_inclusive('\n').take_while(|line| !begins(line)).map(str::len).sum();
    let entries = tree::parse(&text[..head]).or_else(|_| tree::parse(text));
    let entries = entries.map_err(|problems| Problems::new(file, problems))?;
    let log = Log::default();
    let mut root = Section::root(&entries, &log);
    let (title, source) = (root.text("title"), root.text("source"));
    root.abandon();
    drop(root);
    finished(title.and_then(|title| Ok(Heading { title, source: source? })), log, file)
}

/// Reads a text of keys that is no whole scene, such as a method's own settings, with the same messages.
///
/// ```
/// use frazil_scene::{Range, Units, read_section};
/// let read = |text| read_section(text, "pd.toml", Units::Si, |pd| Ok(pd.number_or("horizon_ratio", 3.0, Range::POSITIVE)));
/// assert_eq!(read("horizon_ratio = 4"), Ok(4.0));
/// let problems = read("horizn_ratio = 4").map_err(|problems| problems.to_string());
/// assert_eq!(problems, Err("pd.toml:1: horizn_ratio: unknown key, did you mean \"horizon_ratio\"?".to_owned()));
/// ```
///
/// # Errors
/// With all problems of the text.
pub fn read_section<T>(
    text: &str,
    file: &str,
    units: Units,
    read: impl FnOnce(&mut Section<'_>) -> Read<T>,
) -> Result<T, Problems> {
    let entries = tree::parse(text).map_err(|problems| Problems::new(file, problems))?;
    let log = Log::default();
    let mut section = Section::root(&entries, &log);
    section.set_units(units);
    let value = read(&mut section);
    // Unknown and missing keys are found here.
    drop(section);
    finished(value, log, file)
}

/// Every key that a scene may have under these methods, as one in SI units writes it, behind the path of its section without names
/// and numbers, as `("walls", "temperature_c")`.
pub fn every_key(methods: &[&'static MethodKind]) -> Vec<(String, String)> {
    every_key::every_key(methods).iter().map(|known| (known.section.clone(), known.key.clone())).collect()
}

/// The JSON Schema (draft 7) of scene files under these methods, from what the reader asks for: keys, words, kinds and ranges of
/// values. What depends on more than one key, a schema does not know.
pub fn schema(methods: &[&'static MethodKind]) -> serde_json::Value {
    schema::schema(every_key::every_shape(methods), &every_key::every_key(methods))
}

/// What was read of a file without problems. What could not be read has left one: `Noted` says so.
fn finished<T>(read: Read<T>, log: Log, file: &str) -> Result<T, Problems> {
    let problems = log.into_problems();
    match read {
        Ok(value) if problems.is_empty() => Ok(value),
        _ => Err(Problems::new(file, problems)),
    }
}

/// The same physics and numerics have the same hash only if file, overrides and the files it names are the same to the letter.
fn hash(text: &str, overrides: &[(String, String)], files: &[(String, String)]) -> String {
    let mut effective = text.to_owned();
    for (key, value) in overrides {
        effective.push_str(&format!("\n{key}={value}"));
    }
    for (name, text) in files {
        effective.push_str(&format!("\n{name}:\n{text}"));
    }
    format!("{:016x}", xxhash_rust::xxh3::xxh3_64(effective.as_bytes()))
}

/// Materials, the regions that they fill with those that nothing enters, and what the scene is of.
type Filling = (Read<Vec<Material>>, (Vec<Region>, Vec<Shape>), Balance);

/// The materials, and the regions that they fill.
fn filling(root: &mut Section<'_>, body: Option<&Domain>, water: bool) -> Filling {
    let mut section = root.section("materials");
    let found = section.as_mut().map(|section| ground::materials(section, water)).unwrap_or_default();
    let names: Vec<String> = found.iter().map(|(name, _)| name.clone()).collect();
    let soils: Vec<Material> = found.iter().filter_map(|(_, material)| material.clone().ok()).collect();
    let mut balance = if water { Balance::Water(Heads::new(&soils)) } else { Balance::Heat };
    let regions = match &mut section {
        Ok(section) => regions::regions(root, section, body, &names, &mut balance),
        Err(_) => {
            root.sections("regions").iter_mut().for_each(Section::abandon);
            (Vec::new(), Vec::new())
        }
    };
    (found.into_iter().map(|(_, material)| material).collect(), regions, balance)
}

/// What a scene has been found to have beside its sections.
struct Asked {
    of_water: bool,
    /// Whether the water carries a solute.
    carries: bool,
    surfaces: bool,
    /// Whether there are parts that nothing enters.
    walled: bool,
    /// Whether the conductivity varies at random in place.
    varies: bool,
    /// Whether walls have parts.
    in_parts: bool,
    /// Whether regions release heat.
    heated: bool,
    /// Whether the start varies in place.
    slopes: bool,
    /// Whether the body repeats.
    repeats: bool,
}

impl Asked {
    fn of(
        (of_water, solute, watch): (bool, &Read<Option<Solute>>, &Read<Watch>),
        (random, initial, walls): (&RandomGround, &Initial, &[Wall]),
        (regions, impermeable, wall_parts): (&[Region], &[Shape], &[WallPart]),
    ) -> Self {
        let repeats = walls.iter().any(|wall| wall.condition == Condition::Periodic);
        let surfaces = watch.as_ref().is_ok_and(|watch| !watch.surfaces.is_empty());
        let slopes = initial.as_ref().is_ok_and(|initial| initial.1.is_some());
        let heated = regions.iter().any(|region| region.heat.is_some());
        let carries = matches!(solute, Ok(Some(_)));
        let (walled, varies) = (!impermeable.is_empty(), random.conductivity.is_some());
        Asked { of_water, carries, surfaces, walled, varies, in_parts: !wall_parts.is_empty(), heated, slopes, repeats }
    }
}

/// What a scene has that cannot be combined with everything.
fn features(root: &Section<'_>, domain: Option<&Domain>, materials: &[Material], asked: &Asked) -> Vec<Feature> {
    let own = [
        (asked.of_water, Feature::UnsaturatedWater),
        (asked.carries, Feature::Solute),
        (root.has("gravity"), Feature::Gravity),
        (root.has("flow"), Feature::Groundwater),
        (root.has("cracks") || asked.walled, Feature::Cracks),
        (root.has("anisotropy"), Feature::Anisotropy),
        (asked.varies, Feature::RandomConductivity),
        (root.has("excavation"), Feature::Excavation),
        (root.has("pipes"), Feature::Pipes),
        (asked.surfaces, Feature::Surfaces),
        (domain.is_some_and(|domain| domain.symmetry().is_some()), Feature::Shells),
        (matches!(domain, Some(Domain::Ring { .. })), Feature::Ring),
        (asked.repeats, Feature::PeriodicWalls),
        (asked.in_parts, Feature::WallParts),
        (asked.heated, Feature::HeatSources),
        (asked.slopes, Feature::InitialProfile),
    ];
    let own = own.into_iter().filter(|feature| feature.0).map(|feature| feature.1);
    own.chain(capability::of_materials(materials)).collect()
}

/// Says what of a scene excludes other parts of it; the last of these problems where one is of groundwater.
fn refuse(root: &mut Section<'_>, features: &[Feature]) -> Option<Noted> {
    let mut noted = None;
    for row in capability::exclusions(features) {
        if let Place::Scene(key) = row.asked.place() {
            let problem = root.problem(key, row.message());
            noted = (row.asked == Feature::Groundwater).then_some(problem).or(noted);
        }
    }
    noted
}

/// The units of a scene, which its sections are read in from now on.
fn units(root: &mut Section<'_>) -> Units {
    let all = [Units::Si, Units::Dpd, Units::Dimensionless].map(|units| (units.name(), units));
    let units = root.choice_or("units", &all, Units::Si);
    root.set_units(units);
    units
}

/// A start as one number, and how it varies, if it does.
type Initial = Read<(f64, Option<Profile>)>;

/// The temperature at the start, or the place of the head and the concentration of a solute.
fn initial(root: &mut Section<'_>, domain: Option<&Domain>, balance: &Balance) -> (Initial, Option<f64>) {
    let mut concentration = None;
    let state = root.section("initial").and_then(|mut section| match balance {
        Balance::Heat => {
            let range = range::temperatures(section.units().absolute_zero());
            section.number_along(("temperature", "c"), range, domain)
        }
        Balance::Water(heads) => {
            concentration = section.optional_number(water::CONCENTRATION, Range::NOT_NEGATIVE);
            heads.start(&mut section, domain)
        }
    });
    (state.map(|along| start(along, matches!(balance, Balance::Water(_)))), concentration)
}

/// What a start is as one number, and how it varies.
fn start(along: Along, of_heads: bool) -> (f64, Option<Profile>) {
    let values = match along {
        Along::Even(state) => return (state, None),
        Along::Axis { along_y, rows } => ProfileValues::Axis { along_y, series: Series::Table(rows) },
        Along::Formula { formula, range } => ProfileValues::Formula { formula, range },
    };
    let profile = Profile { values, of_heads };
    let (least, greatest) = profile.range();
    (0.5 * (least + greatest), Some(profile))
}

/// Least and greatest temperature that a scene names, as far as it could be read.
fn temperatures<'a>(
    initial: &Initial,
    (regions, rings, stream): (&[Region], &[PipeRing], &Read<Option<Stream>>),
    conditions: impl Iterator<Item = &'a Condition>,
) -> Option<(f64, f64)> {
    let (initial, profile) = initial.as_ref().ok()?;
    let stream = stream.as_ref().ok().and_then(Option::as_ref);
    Some(Temperatures { profile: profile.as_ref(), regions, rings, stream }.range(*initial, conditions))
}

/// Refuses what is observed of heat alone, in a scene of water.
fn only_of_heat(root: &mut Section<'_>, watch: &Watch) {
    let asked = [
        (!watch.isotherms.is_empty(), "isotherms_c"),
        (!watch.regions.is_empty(), "regions"),
        (watch.phases.is_some(), "phases"),
        (watch.corner_front, "corner_front"),
    ];
    for (_, key) in asked.into_iter().filter(|asked| asked.0) {
        root.problem(
            "watch",
            format!("\"{key}\" has no effect, water of balance = \"water\" neither freezes nor has a temperature"),
        );
    }
}

fn read_root(mut root: Section<'_>, name: &str, kinds: &[&'static MethodKind]) -> Read<Scene> {
    let units = units(&mut root);
    let (title, source) = (root.text("title"), root.text("source"));
    let domain = body::domain(&mut root);
    let body = domain.as_ref().ok();
    let mut time = watch::time(&mut root);
    let duration = time.as_ref().ok().map(|time| time.duration.seconds);
    root.set_run(Run { domain: body.copied(), duration });
    let of_water = root.choice_or("balance", &[("heat", false), ("water", true)], false);
    let (materials, (regions, impermeable), mut balance) = filling(&mut root, body, of_water);
    // The checks of combinations would speak of the wrong materials if some were missing.
    let known = materials.as_deref().unwrap_or_default();
    let (initial, initial_concentration) = initial(&mut root, body, &balance);
    let mut wall_section = root.section("walls");
    let (walls, wall_parts) =
        wall_section.as_mut().map(|section| body::walls(section, body, &mut balance)).unwrap_or_default();
    let rings = pipes::pipes(&mut root, body);
    let excavation = excavation::excavation(&mut root, body, &rings);
    let cracks = cracks::cracks(&mut root, body);
    let watch = watch::watch(&mut root, body, time.as_mut().map_err(|noted| *noted));
    watch.iter().filter(|_| of_water).for_each(|watch| only_of_heat(&mut root, watch));
    let solute = balance.solute(&mut root, known, initial_concentration);
    let (random, along) = (random::random(&mut root, body), anisotropy::anisotropy(&mut root, body));
    let asked =
        Asked::of((of_water, &solute, &watch), (&random, &initial, &walls), (&regions, &impermeable, &wall_parts));
    let features = &features(&root, body, known, &asked);
    let gravity = gravity::gravity(&mut root, &domain, (of_water, known), (&walls, &wall_parts));
    let refused = refuse(&mut root, features);
    let flow = flow::flow(&mut root, body, known, refused);
    let stream = stream::stream(&mut root, body, &walls, time.as_ref().ok().map(|time| &time.duration));
    let reference = reference::reference(&mut root, &reference::Around { domain: body, of_water });
    if let (Ok(section), Some(domain)) = (&mut wall_section, body) {
        body::exact_walls(section, domain, &walls, (known, &regions), &reference);
    }
    drop(wall_section);
    let parts = wall_parts.iter().map(|part| &part.condition);
    let own = || walls.iter().map(|wall| &wall.condition).chain(parts.clone());
    let brings_heat = own().any(Condition::brings_heat);
    let has_flux = asked.heated || has_flux(own(), &rings);
    let setup = numerics::Setup { domain: body, along, materials: known, brings_heat, has_flux, features };
    let conditions = own().chain(excavation.iter().flatten().map(|shaft| &shaft.condition));
    root.set_temperatures(temperatures(&initial, (&regions, &rings, &stream), conditions));
    let methods = numerics::methods(&mut root, &setup, kinds);
    let (time, (initial_temperature, initial_profile)) = (time?, initial?);
    let mut scene = Scene {
        name: name.to_owned(),
        title: title?,
        source: source?,
        units,
        time_unit: time.duration.unit,
        of_water,
        domain: domain?,
        duration: time.duration.seconds,
        along,
        materials: materials?,
        regions,
        cracks,
        impermeable,
        initial_temperature,
        initial_profile,
        walls,
        wall_parts,
        rings,
        excavation: excavation?,
        flow: flow?,
        gravity: gravity?,
        solute: solute?,
        random,
        stream: stream?,
        watch: watch?,
        reference,
        methods,
        files: Vec::new(),
        hash: String::new(),
        remarks: time.remarks,
    };
    reference::settle(&mut root, &mut scene);
    ground::latent_heats(&mut root, &scene.materials, scene.temperature_range());
    Ok(scene)
}
