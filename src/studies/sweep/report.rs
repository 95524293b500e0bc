//! The page of a sweep: each result over the first key, with its numbers below.

use std::path::Path;

use frazil_plots::canvas::{Canvas, Formats};
use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection, Table};
use frazil_plots::style::{method_title, number};
use frazil_plots::sweep::{Places, SweepCurve, SweepFigure, sweep};
use frazil_record::Outcome;
use frazil_scene::Scene;

use super::SweepRequest;
use super::execute::{SweptRun, columns};
use crate::failure::Failure;
use crate::figures::Figures;
use crate::machine::Machine;
use crate::parallel;
use crate::progress::clock;
use crate::words::{self, capital};

/// Curves that can be told from each other in one figure.
const MOST_CURVES: usize = 12;

/// Results whose range the page begins with; all are in its figures.
const MOST_ANSWERS: usize = 3;

/// Runs that differ in the first key alone.
struct Line<'a> {
    label: String,
    /// A run for each value of the first key.
    runs: Vec<&'a SweptRun>,
}

/// Writes the figures and the page.
///
/// # Errors
/// Where one cannot be written.
pub fn write(
    request: &SweepRequest,
    machine: &Machine,
    folder: &Path,
    scene: &Scene,
    runs: &[SweptRun],
) -> Result<(), Failure> {
    let lines = lines(request, runs);
    let mut figures = Figures::default();
    let (mut blocks, mut errors) = (Vec::new(), Vec::new());
    for (name, label) in columns(runs) {
        let table = table(request, &lines, (&name, &label));
        if name.starts_with("error_") {
            errors.push(table);
            continue;
        }
        let mut block = Block { heading: capital(&label), tables: vec![table], ..Block::default() };
        if lines.len() <= MOST_CURVES {
            let canvas = figure(request, scene, &lines, (&name, &label));
            block.figures.push(Figure::new(&canvas, "", name.clone()));
            figures.add(folder, name, canvas);
        } else {
            block.text.push(format!("{} curves are too many for a figure.", lines.len()));
        }
        blocks.push(block);
    }
    if !errors.is_empty() {
        blocks.push(Block { heading: "Errors against the reference".into(), tables: errors, ..Block::default() });
    }
    blocks.push(all(request, runs));
    let mut parameters = words::parameters(scene);
    parameters.push(Fact::new("Seed", request.seed.to_string()));
    let varied =
        request.keys.iter().map(|varied| Fact::new(format!("Varied: {}", varied.key), varied.values.join(", ")));
    parameters.extend(varied);
    let page = Page {
        title: format!("Sweep of {}", scene.name),
        lead: vec![format!(
            "{} runs of one scene: all combinations of the values of {}. Results are those at the end of a run.",
            runs.len(),
            request.keys.iter().map(|varied| varied.key.as_str()).collect::<Vec<_>>().join(", ")
        )],
        answers: answers(request, runs).into_iter().take(MOST_ANSWERS).collect(),
        command: request.command_line.clone(),
        machine: machine.facts(Fact::new("Concurrent runs", request.threads.to_string())),
        scenes: vec![SceneSection {
            name: scene.name.clone(),
            title: scene.title.clone(),
            source: scene.source.clone(),
            parameters,
            blocks,
            svg_alone: true,
        }],
        ..Page::default()
    };
    figures.write(Formats::SVG, parallel::cores())?;
    Ok(page::write(&page, &folder.join("report.html"))?)
}

/// The range of each result and where its ends are, a sentence each; and how many runs broke off.
pub fn answers(request: &SweepRequest, runs: &[SweptRun]) -> Vec<String> {
    let several = runs.iter().any(|run| run.method != runs[0].method);
    let at = |run: &SweptRun| {
        let own = request
            .keys
            .iter()
            .zip(&run.values)
            .map(|(varied, value)| format!("{} = {value}", varied.short(&request.keys)));
        let method = several.then(|| method_title(run.method));
        own.chain(method).collect::<Vec<_>>().join(", ")
    };
    let range = |(name, label): (String, String)| {
        let mut found: Vec<(f64, &SweptRun)> = runs.iter().filter_map(|run| Some((run.number(&name)?, run))).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (least, most) = (found.first()?, found.last()?);
        let missing = runs.len() - found.len();
        let missing = if missing > 0 { format!("; none in {missing} runs") } else { String::new() };
        Some(match least.0 < most.0 {
            true => format!(
                "{}: {} ({}) to {} ({}){missing}",
                capital(&label),
                number(least.0, 4),
                at(least.1),
                number(most.0, 4),
                at(most.1)
            ),
            false => format!("{}: {} in all runs{missing}", capital(&label), number(least.0, 4)),
        })
    };
    let bad = runs.iter().filter(|run| run.finding.outcome != Some(Outcome::Ok)).count();
    let bad = (bad > 0).then(|| format!("{bad} of {} runs did not end with the outcome ok", runs.len()));
    columns(runs).into_iter().filter(|(name, _)| !name.starts_with("error_")).filter_map(range).chain(bad).collect()
}

fn lines<'a>(request: &SweepRequest, runs: &'a [SweptRun]) -> Vec<Line<'a>> {
    let several = runs.iter().any(|run| run.method != runs[0].method);
    let mut lines: Vec<Line<'a>> = Vec::new();
    for run in runs {
        let others = request.keys.iter().zip(&run.values).skip(1);
        let others = others.map(|(varied, value)| format!("{} = {value}", varied.short(&request.keys)));
        let label = several.then(|| method_title(run.method)).into_iter().chain(others).collect::<Vec<_>>().join(", ");
        match lines.iter_mut().find(|line| line.label == label) {
            Some(line) => line.runs.push(run),
            None => lines.push(Line { label, runs: vec![run] }),
        }
    }
    lines
}

fn figure(request: &SweepRequest, scene: &Scene, lines: &[Line<'_>], (name, label): (&str, &str)) -> Canvas {
    let curve = |line: &Line<'_>| SweepCurve {
        label: line.label.clone(),
        values: line.runs.iter().map(|run| run.number(name)).collect(),
    };
    let first = &request.keys[0];
    sweep(&SweepFigure {
        title: format!("{}: {}", scene.title, label.split(" (").next().unwrap_or(label)),
        x_label: first.key.clone(),
        y_label: label.to_owned(),
        places: first.numbers().map_or_else(|| Places::Words(first.values.clone()), Places::Numbers),
        curves: lines.iter().map(curve).collect(),
    })
}

/// A result: a row for each value of the first key, a column for each combination of the others.
fn table(request: &SweepRequest, lines: &[Line<'_>], (name, label): (&str, &str)) -> Table {
    let first = &request.keys[0];
    let heads = lines.iter().map(|line| if line.label.is_empty() { label.to_owned() } else { line.label.clone() });
    let row = |(k, value): (usize, &String)| {
        let cell = |line: &Line<'_>| match line.runs.get(k) {
            Some(run) => run.number(name).map_or_else(|| outcome(run).to_owned(), |value| number(value, 4)),
            None => String::new(),
        };
        [value.clone()].into_iter().chain(lines.iter().map(cell)).collect()
    };
    Table {
        caption: capital(label),
        heads: [first.key.clone()].into_iter().chain(heads).collect(),
        rows: first.values.iter().enumerate().map(row).collect(),
        words: usize::from(first.numbers().is_none()),
        csv: Some("sweep.csv".into()),
    }
}

/// How a run ended, where it found nothing: a dash where it merely had no such number.
fn outcome(run: &SweptRun) -> &'static str {
    match run.finding.outcome {
        None => "refused",
        Some(Outcome::Ok) => "–",
        Some(other) => other.name(),
    }
}

/// All runs, their outcomes and their work.
fn all(request: &SweepRequest, runs: &[SweptRun]) -> Block {
    let keys = request.keys.iter().map(|varied| varied.key.clone());
    let heads = ["method", "outcome", "particles", "steps", "CPU time", "balance"].map(str::to_owned);
    let row = |run: &SweptRun| {
        let finding = &run.finding;
        let own = [
            method_title(run.method),
            finding.outcome.map_or("refused", |outcome| outcome.name()).to_owned(),
            finding.particles.to_string(),
            finding.steps.to_string(),
            clock(finding.cpu_s),
            number(finding.balance_rel, 2),
        ];
        run.values.iter().cloned().chain(own).collect()
    };
    let cause = |run: &SweptRun| Some(format!("{}: {}", run.values.join(", "), run.finding.cause.as_ref()?));
    Block {
        heading: "All runs".into(),
        tables: vec![Table {
            caption: "Outcome and work of each run".into(),
            heads: keys.chain(heads).collect(),
            rows: runs.iter().map(row).collect(),
            words: request.keys.len() + 2,
            csv: Some("sweep.csv".into()),
        }],
        list: runs.iter().filter_map(cause).collect(),
        folded: runs.len() > 20,
        ..Block::default()
    }
}
