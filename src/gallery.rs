//! All bundled scenes at a glance: a picture, a result and a command of each.

use std::fs;
use std::path::Path;

use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection};
use frazil_plots::style::method_title;
use frazil_record::{Outcome, Record};
use frazil_scene::heading;
use frazil_studies::answers::errors;
use frazil_studies::failure::{Failure, Verdict, answer};
use frazil_studies::machine::Machine;
use frazil_studies::output::{self, write_whole};
use frazil_studies::progress::clock;

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
        let command = format!("run {}", bundled.name);
        let (picture, record) = (None, None);
        shown.push(Shown { name: bundled.name, title: own.title, source: own.source, command, picture, record });
    }
    if !kept.make(&shown.iter().map(|one| (one.name, one.command.as_str())).collect::<Vec<_>>())? {
        return Ok(Verdict::Broken);
    }
    for one in &mut shown {
        let path = kept.path(one.name);
        one.record = output::record_in(&path);
        one.picture = telling(&path);
    }
    write(request, &folder, &shown)?;
    let lacking = shown.iter().filter(|one| one.record.is_none()).count();
    answer(&format!("{} scenes, {lacking} without a run\n  results: {}\n", shown.len(), folder.display()))?;
    Ok(if lacking > 0 { Verdict::CheckFailed } else { Verdict::Done })
}

/// The figure of a run that shows most of it: of those at several times the last.
fn telling(folder: &Path) -> Option<(String, String)> {
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
    let name = TELLING.iter().find_map(|begin| names.iter().rev().find(|name| name.starts_with(begin)))?;
    Some((name.clone(), fs::read_to_string(folder.join(format!("{name}.svg"))).ok()?))
}

/// What a run found, in a line.
fn words(record: &Record) -> String {
    let method = method_title(&record.method);
    let time = clock(record.setup_wall_s + record.solve_wall_s);
    let error = errors(&record.errors, record.water.as_ref());
    let error = error.first().map_or(String::new(), |(title, value)| format!("; {title} {value}"));
    let outcome =
        if record.outcome == Outcome::Ok { String::new() } else { format!("; outcome {}", record.outcome.name()) };
    format!("{method}, {} particles, {} steps, {time}{error}{outcome}", record.particles, record.steps)
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
