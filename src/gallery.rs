//! All bundled scenes at a glance: a picture, a result and a command of each.

use std::fs;
use std::path::Path;

use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection};
use frazil_plots::style::method_title;
use frazil_record::{Outcome, Record};
use frazil_scene::heading;
use frazil_simulation::reduce::{self, Finding};
use frazil_studies::answers::errors;
use frazil_studies::failure::{Failure, Verdict, answer};
use frazil_studies::machine::Machine;
use frazil_studies::output::{self, write_whole};
use frazil_studies::progress::clock;

use crate::load;
use crate::process_runs::ManyRuns;

/// A name that is that of no bundled scene.
#[derive(Debug, thiserror::Error)]
#[error("\"{0}\" is no bundled scene; frazil list shows all names")]
struct UnknownScene(String);

/// Figures of which the first that a run has is shown, by how their names begin.
const TELLING: [&str; 8] = ["map_", "concentration_", "front", "profiles", "stream", "phases", "ice", "wall"];

/// A scene in the gallery.
struct Shown {
    name: &'static str,
    title: String,
    source: String,
    command: String,
    /// Name of the picture, without its ending, and the picture.
    picture: Option<(String, String)>,
    record: Option<Record>,
}

/// Runs all scenes that are not there yet, each with its first method, and writes the page and its Markdown.
///
/// # Errors
/// Where a scene is not known, or a file cannot be written.
pub fn gallery(request: &ManyRuns) -> Result<Verdict, Failure> {
    let all = frazil_cases::scenes::all();
    if let Some(unknown) = request.chosen.iter().find(|name| all.iter().all(|scene| scene.name != **name)) {
        return Err(Failure::request(UnknownScene(unknown.clone())));
    }
    let wanted = |name: &str| request.chosen.is_empty() || request.chosen.iter().any(|asked| asked == name);
    let folder = request.out.clone().unwrap_or_else(|| "out/gallery".into());
    let kept = request.in_folder(&folder);
    let mut shown = Vec::new();
    for bundled in all.iter().filter(|scene| wanted(scene.name)) {
        let own = heading(bundled.text, bundled.name)?;
        let command = format!("run {}{}", bundled.name, if is_reduced(bundled.name)? { " --reduce" } else { "" });
        let (picture, record) = (None, None);
        shown.push(Shown { name: bundled.name, title: own.title, source: own.source, command, picture, record });
    }
    if !kept.make(&shown.iter().map(|one| (one.name, one.command.as_str())).collect::<Vec<_>>())? {
        return Ok(Verdict::Broken);
    }
    for one in &mut shown {
        let path = kept.path(one.name);
        one.record = output::record_in(&path);
        one.picture = telling(&path, one.record.as_ref());
    }
    write(request, &folder, &shown)?;
    let lacking = shown.iter().filter(|one| one.record.is_none()).count();
    answer(&format!("{} scenes, {lacking} without a run\n  results: {}\n", shown.len(), folder.display()))?;
    Ok(if lacking > 0 { Verdict::CheckFailed } else { Verdict::Done })
}

/// How many times as many particles as a smaller body with the same solution a scene has at least, where that is run in its place.
const SAVED: f64 = 10.0;

/// Whether a much smaller body has the solution of a scene under its first method.
fn is_reduced(name: &str) -> Result<bool, Failure> {
    let scene = load::scene(name, &[])?;
    let Some(method) = scene.methods.first() else { return Ok(false) };
    let found = reduce::find(&scene, method.method, None).map_err(Failure::request)?;
    Ok(matches!(found, Finding::Smaller(smaller) if smaller.saves() >= SAVED))
}

/// The figure of a run that shows most of it.
fn telling(folder: &Path, record: Option<&Record>) -> Option<(String, String)> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .ok()?
        .flatten()
        .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(".svg")?.to_owned()))
        .collect();
    // By the time in the name, where there is one.
    let time = |name: &String| -> f64 {
        let digits: String = name.chars().filter(|letter| letter.is_ascii_digit() || *letter == '.').collect();
        digits.parse().unwrap_or(0.0)
    };
    names.sort_by(|a, b| time(a).total_cmp(&time(b)));
    // Of several times one in the middle: at the end much has thawed, or is frozen.
    // Where the concentration is compared and no front is, a front may stand still.
    let compared = record
        .is_none_or(|record| record.errors.concentration_rms_rel.is_none() || record.errors.front_rms_rel.is_some());
    let name = TELLING.iter().filter(|begin| compared || **begin != "front").find_map(|begin| {
        let fitting: Vec<&String> = names.iter().filter(|name| name.starts_with(begin)).collect();
        fitting.get(fitting.len() / 2).copied()
    })?;
    Some((name.clone(), fs::read_to_string(folder.join(format!("{name}.svg"))).ok()?))
}

/// What a run found, in a line.
fn words(record: &Record) -> String {
    let method = method_title(&record.method);
    let time = clock(record.setup_wall_s + record.solve_wall_s);
    let errors = errors(&record.errors, record.water.as_ref());
    let errors: Vec<String> = errors.iter().map(|(title, value)| format!("{title} {value}")).collect();
    let errors = if errors.is_empty() { String::new() } else { format!("; {}", errors.join(", ")) };
    let outcome =
        if record.outcome == Outcome::Ok { String::new() } else { format!("; outcome {}", record.outcome.name()) };
    format!("{method}, {} particles, {} steps, {time}{errors}{outcome}", record.particles, record.steps)
}

fn write(request: &ManyRuns, folder: &Path, shown: &[Shown]) -> Result<(), Failure> {
    let block = |one: &Shown| {
        let figure = one.picture.as_ref().map(|(name, svg)| {
            let file = format!("runs/{}/{name}", one.name);
            Figure { svg: svg.clone(), caption: one.record.as_ref().map_or(String::new(), words), file }
        });
        Block {
            text: vec![format!("frazil {}", one.command)],
            figures: figure.into_iter().collect(),
            ..Block::default()
        }
    };
    let section = |one: &Shown| SceneSection {
        name: one.name.to_owned(),
        title: one.title.clone(),
        source: one.source.clone(),
        blocks: vec![block(one)],
        svg_alone: true,
        ..SceneSection::default()
    };
    let page = Page {
        title: "Bundled scenes".into(),
        lead: vec!["Each scene with its first method and default settings.".into()],
        command: request.command_line.clone(),
        scenes: shown.iter().map(section).collect(),
        machine: Machine::now().facts(Fact::new("Threads of each run", request.threads.to_string())),
        ..Page::default()
    };
    page::write(&page, &folder.join("report.html"))?;
    for one in shown {
        if let Some((_, svg)) = &one.picture {
            write_whole(&folder.join(format!("{}.svg", one.name)), |writer| writer.write_all(svg.as_bytes()))?;
        }
    }
    write_whole(&folder.join("README.md"), |writer| {
        writeln!(
            writer,
            "# Bundled scenes\n\nEach scene with its first method and default settings, as `frazil gallery` makes them."
        )?;
        for one in shown {
            writeln!(writer, "\n## {}\n\n`frazil {}`: {} ({}).", one.name, one.command, one.title, one.source)?;
            if let Some(record) = &one.record {
                writeln!(writer, "{}.", words(record))?;
            }
            if one.picture.is_some() {
                writeln!(writer, "\n![{}]({}.svg)", one.title, one.name)?;
            }
        }
        Ok(())
    })
}
