//! Reading scene files: every check that needs no particles, and all problems of a file at once.

mod body;
mod cracks;
mod excavation;
mod flow;
mod ground;
mod numerics;
mod porous;
mod problem;
mod range;
mod regions;
mod section;
mod shells;
mod stream;
#[cfg(test)]
mod tests;
mod tree;
mod watch;

use std::cell::RefCell;

use super::{Scene, Temperatures, Units};
use crate::method::MethodKind;
use problem::Place;

pub use problem::{Problem, Problems};
pub use range::Range;
pub use section::{Duration, Key, Section};

impl Scene {
    /// Reads a scene from the text of its file.
    ///
    /// `name` becomes the scene's short name, `file` stands in messages, `overrides` are the pairs of key path and
    /// value of `--set`, and `methods` are the methods whose sections may occur. A value of `--set` that is no TOML
    /// is taken as text, so that words need no quotes.
    pub fn read(
        text: &str,
        name: &str,
        file: &str,
        overrides: &[(String, String)],
        methods: &[&'static MethodKind],
    ) -> Result<Scene, Problems> {
        let mut entries = tree::parse(text).map_err(|problems| Problems::new(file, problems))?;
        let log = RefCell::new(Vec::new());
        for (key, value) in overrides {
            if let Err(problem) = tree::set(&mut entries, key, value) {
                log.borrow_mut().push(problem);
            }
        }
        let scene = read_root(Section::root(&entries, &log), name, hash(text, overrides), methods);
        let problems = log.into_inner();
        match scene {
            Some(scene) if problems.is_empty() => Ok(scene),
            None if problems.is_empty() => {
                // Every way to `None` records a problem; an empty list would be read as success.
                Err(Problems::new(file, vec![Problem::new(&Place::File, "", "cannot be read as a scene")]))
            }
            _ => Err(Problems::new(file, problems)),
        }
    }
}

/// Reads a text of keys that is no whole scene, such as a method's own settings, with the same messages.
///
/// ```
/// use frazil_core::scene::{Range, Units, read_section};
/// let read = |text| read_section(text, "pd.toml", Units::Si, |pd| pd.number_or("horizon_ratio", 3.0, Range::POSITIVE));
/// assert_eq!(read("horizon_ratio = 4"), Ok(4.0));
/// let problems = read("horizn_ratio = 4").map_err(|problems| problems.to_string());
/// assert_eq!(problems, Err("pd.toml:1: horizn_ratio: unknown key, did you mean \"horizon_ratio\"?".to_owned()));
/// ```
pub fn read_section<T>(
    text: &str,
    file: &str,
    units: Units,
    read: impl FnOnce(&mut Section<'_>) -> T,
) -> Result<T, Problems> {
    let entries = tree::parse(text).map_err(|problems| Problems::new(file, problems))?;
    let log = RefCell::new(Vec::new());
    let mut section = Section::root(&entries, &log);
    section.set_units(units);
    let value = read(&mut section);
    // Unknown and missing keys are found here.
    drop(section);
    let problems = log.into_inner();
    if problems.is_empty() { Ok(value) } else { Err(Problems::new(file, problems)) }
}

/// The same physics and numerics have the same hash only if file and overrides are the same to the letter.
fn hash(text: &str, overrides: &[(String, String)]) -> String {
    let mut effective = text.to_owned();
    for (key, value) in overrides {
        effective.push_str(&format!("\n{key}={value}"));
    }
    format!("{:016x}", xxhash_rust::xxh3::xxh3_64(effective.as_bytes()))
}

fn read_root(mut root: Section<'_>, name: &str, hash: String, kinds: &[&'static MethodKind]) -> Option<Scene> {
    let all_units = [Units::Si, Units::Dpd, Units::Dimensionless].map(|units| (units.name(), units));
    let units = root.choice_or("units", &all_units, Units::Si);
    root.set_units(units);
    let title = root.text("title");
    let source = root.text("source");
    let domain = body::domain(&mut root);
    let mut time = watch::time(&mut root);

    let mut material_section = root.section("materials");
    let found = material_section.as_mut().map(ground::materials).unwrap_or_default();
    let names: Vec<String> = found.iter().map(|(name, _)| name.clone()).collect();
    let regions = match &mut material_section {
        Some(section) => regions::regions(&mut root, section, domain.as_ref(), &names),
        None => {
            root.sections("regions").iter_mut().for_each(Section::abandon);
            Vec::new()
        }
    };
    drop(material_section);
    let complete = found.iter().all(|(_, material)| material.is_some());
    let materials: Vec<_> = found.into_iter().filter_map(|(_, material)| material).collect();

    let initial_temperature = root
        .section("initial")
        .and_then(|mut section| section.number(("temperature", "c"), range::temperatures(units.absolute_zero())));
    let mut wall_section = root.section("walls");
    let (walls, wall_parts) =
        wall_section.as_mut().map(|section| body::walls(section, domain.as_ref())).unwrap_or_default();
    let rings = body::pipes(&mut root, domain.as_ref());
    let excavation = excavation::excavation(&mut root, domain.as_ref(), &rings);
    let cracks = cracks::cracks(&mut root, domain.as_ref());
    let watch = watch::watch(&mut root, domain.as_ref(), time.as_mut());
    let surfaces = watch.as_ref().is_some_and(|watch| !watch.surfaces.is_empty());
    let beside = flow::Beside { cracks: !cracks.is_empty(), surfaces, excavation: excavation.is_some() };
    let flow = flow::flow(&mut root, domain.as_ref(), if complete { &materials } else { &[] }, &beside);
    let stream = stream::stream(&mut root, domain.as_ref(), &walls, time.as_ref().map(|time| &time.duration));
    let reference = watch::reference(&mut root, domain.as_ref());
    if let (Some(section), Some(domain)) = (&mut wall_section, &domain) {
        body::exact_walls(section, domain, &walls, (&materials, &regions), &reference);
    }
    drop(wall_section);
    let setup = numerics::Setup {
        domain: domain.as_ref(),
        // The checks of combinations would speak of the wrong materials if some were missing.
        materials: if complete { &materials } else { &[] },
        walls: &walls,
        cracks: &cracks,
        surfaces,
        flow: flow.is_some(),
    };
    let data = Temperatures { regions: &regions, rings: &rings, stream: stream.as_ref() };
    let parts = wall_parts.iter().map(|part| &part.condition);
    let conditions = walls.iter().map(|wall| &wall.condition).chain(parts);
    let conditions = conditions.chain(excavation.iter().map(|shaft| &shaft.condition));
    root.set_temperatures(initial_temperature.map(|initial| data.range(initial, conditions)));
    let methods = numerics::methods(&mut root, &setup, kinds);
    let time = time?;
    let scene = Scene {
        name: name.to_owned(),
        title: title?,
        source: source?,
        units,
        time_unit: time.duration.unit,
        domain: domain?,
        duration: time.duration.seconds,
        materials,
        regions,
        cracks,
        initial_temperature: initial_temperature?,
        walls,
        wall_parts,
        rings,
        excavation,
        flow,
        stream,
        watch: watch?,
        reference,
        methods,
        hash,
        remarks: time.remarks,
    };
    ground::latent_heats(&mut root, &scene.materials, scene.temperature_range());
    Some(scene)
}
