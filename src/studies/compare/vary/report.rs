//! Figures and page of a variation.

use std::path::Path;

use frazil_plots::canvas::Formats;
use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection, Table};
use frazil_plots::signed::{SignedCurve, SignedFigure, signed};
use frazil_plots::style::{method_title, number, percent};
use frazil_scene::Units;

use super::{Grid, Line, Measure, Run, warnings};
use crate::compare::request::CompareRequest;
use crate::failure::Failure;
use crate::figures::Figures;
use crate::machine::Machine;
use crate::output::make_folder;
use crate::parallel;
use crate::words;

/// Writes the figures and the page of the finished scenes.
pub fn write(request: &CompareRequest, machine: &Machine, folder: &Path, grids: &[Grid]) -> Result<(), Failure> {
    let mut page = Page {
        title: "Convergence in two parameters".into(),
        lead: vec![if grids.iter().any(|grid| grid.scene.of_water) {
            "Errors are signed: filled marks are too wet, too warm, or a front too far; hollow ones too dry, too cold, \
             or not far enough. Where a line changes from one to the other, its magnitude passes through zero, which \
             does not indicate convergence."
        } else {
            "Errors are signed: filled marks are too warm, or a front too far; hollow ones too cold, or not far \
             enough. Where a line changes from one to the other, its magnitude passes through zero, which does not \
             indicate convergence."
        }
        .into()],
        command: request.command_line.clone(),
        machine: machine.facts(Fact::new("Threads of a run", request.threads.to_string())),
        ..Page::default()
    };
    let mut figures = Figures::default();
    for grid in grids {
        page.scenes.push(section(folder, grid, &mut figures)?);
    }
    figures.write(Formats::ALL, parallel::cores())?;
    Ok(page::write(&page, &folder.join("report.html"))?)
}

fn section(folder: &Path, grid: &Grid, figures: &mut Figures) -> Result<SceneSection, Failure> {
    let name = grid.scene.name.clone();
    let own = folder.join(&name);
    make_folder(&own)?;
    let mut blocks = Vec::new();
    for method in grid.methods() {
        for measure in Measure::ALL {
            let known = |run: &&Run| run.method == method && measure.signed(run).is_some();
            if !grid.runs.iter().any(|run| known(&run)) {
                continue;
            }
            let mut block = Block {
                heading: format!("{}: signed error of the {}", method_title(method), measure.name()),
                tables: vec![table(grid, method, measure)],
                ..Block::default()
            };
            let (by_ratio, by_reach) = (grid.by_ratio(method), grid.by_reach(method));
            let ratio = |line: &Line<'_>| format!("{} {}", grid.key, number(line.fixed, 4));
            let reach = |line: &Line<'_>| format!("reach {}", words::length_words(grid.scene.units, line.fixed));
            let drawn = [
                (
                    "ratio",
                    "particle spacing",
                    "One line for each ratio: the reach decreases with the spacing.",
                    curves(&by_ratio, measure, ratio, |run| run.spacing),
                ),
                (
                    "reach",
                    grid.key.as_str(),
                    "One line for each reach: the ratio increases as the spacing decreases.",
                    curves(&by_reach, measure, reach, |run| run.ratio),
                ),
            ];
            for (word, label, caption, curves) in drawn {
                if curves.is_empty() {
                    continue;
                }
                let file = format!("vary_{method}_{}_{word}", measure.name());
                let unit = if word == "ratio" && grid.scene.units == Units::Si { " (m)" } else { "" };
                let canvas = signed(&SignedFigure {
                    title: format!("{}: {}, {}", grid.scene.title, measure.name(), method_title(method)),
                    x_label: format!("{label}{unit}"),
                    y_label: format!("magnitude of the error of the {}", measure.name()),
                    curves,
                });
                block.figures.push(Figure::new(&canvas, caption, format!("{name}/{file}")));
                figures.add(&own, file, canvas);
            }
            blocks.push(block);
        }
    }
    let list = warnings(grid);
    if !list.is_empty() {
        blocks.push(Block { heading: "Changes of sign".into(), list, ..Block::default() });
    }
    let mut parameters = words::parameters(&grid.scene);
    parameters.push(Fact::new("Reference", grid.reference.clone()));
    let (title, source) = (grid.scene.title.clone(), grid.scene.source.clone());
    Ok(SceneSection { title, source, parameters, name, blocks, ..SceneSection::default() })
}

fn curves(
    lines: &[Line<'_>],
    measure: Measure,
    label: impl Fn(&Line<'_>) -> String,
    place: impl Fn(&Run) -> f64,
) -> Vec<SignedCurve> {
    let curve = |line: &Line<'_>| SignedCurve {
        label: label(line),
        points: line.runs.iter().filter_map(|run| Some((place(run), measure.signed(run)?))).collect(),
    };
    lines.iter().map(curve).filter(|curve| !curve.points.is_empty()).collect()
}

/// Signed and rms errors, a row a ratio and a column a spacing.
fn table(grid: &Grid, method: &'static str, measure: Measure) -> Table {
    let lines = grid.by_ratio(method);
    let mut spacings: Vec<f64> = grid.runs.iter().filter(|run| run.method == method).map(|run| run.spacing).collect();
    spacings.dedup();
    let cell = |line: &Line<'_>, spacing: f64| {
        let run = line.runs.iter().find(|run| run.spacing == spacing);
        let signed = run.and_then(|run| measure.signed(run));
        match (signed, run.and_then(|run| measure.rms(run))) {
            (Some(signed), Some(rms)) => {
                let sign = if signed < 0.0 { "−" } else { "+" };
                format!("{sign}{} ({})", percent(signed.abs(), 3), percent(rms, 3))
            }
            _ => run.and_then(|run| run.note.clone()).unwrap_or_default(),
        }
    };
    let head = |spacing: &f64| words::length_words(grid.scene.units, *spacing);
    Table {
        caption: format!("Signed error of the {} (rms)", measure.name()),
        heads: [grid.key.clone()].into_iter().chain(spacings.iter().map(head)).collect(),
        rows: lines
            .iter()
            .map(|line| {
                let cells = spacings.iter().map(|spacing| cell(line, *spacing));
                [number(line.fixed, 4)].into_iter().chain(cells).collect()
            })
            .collect(),
        words: 1,
        csv: Some("vary.csv".into()),
    }
}
