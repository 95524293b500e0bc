//! The page of a comparison: figures first, the numbers under each.

mod numbers;
mod words;

use std::path::Path;

use frazil_plots::comparison::work_precision_panels;
use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection};
use frazil_plots::run::drawings;
use frazil_scene::names;

use super::analysis::{self, Study};
use super::curve::Clock;
use super::figures::{Cost, order_figure, work_figure};
use super::request::CompareRequest;
use crate::failure::Failure;
use crate::figure_options;
use crate::machine::Machine;
use crate::output::{make_folder, write_run};
use numbers::{
    ensembles, equal_error_table, equal_time_table, failures, gates, order_table, overall, run_table, settings,
};
use words::{fairness, parameters};

/// Writes the figures and the page of the finished scenes.
pub fn write(request: &CompareRequest, machine: &Machine, folder: &Path, studies: &[Study]) -> Result<(), Failure> {
    if studies.is_empty() {
        return Ok(());
    }
    let mut page = Page {
        title: "Error against run time".into(),
        lead: vec![
            "Each point is one method at one resolution: how wrong it is, and how long it takes. Read along a line of \
             equal error; nearer to the lower left corner is better."
                .into(),
        ],
        command: request.command_line.clone(),
        fairness: fairness(request, studies),
        machine: machine.facts(Fact::new("Threads of a timed run", request.threads.to_string())),
        ..Page::default()
    };
    let overview: Vec<_> = studies
        .iter()
        .filter_map(|study| Some(work_figure(study, study.comparisons.first()?, Cost::Time(study.clock))))
        .collect();
    if !overview.is_empty() {
        work_precision_panels(&overview).write(folder, "work_precision")?;
    }
    if studies.len() > 1 {
        page.summary.push(overall(studies));
    }
    for study in studies {
        page.scenes.push(section(folder, study)?);
    }
    Ok(page::write(&page, &folder.join("report.html"))?)
}

fn section(folder: &Path, study: &Study) -> Result<SceneSection, Failure> {
    let name = study.name().to_owned();
    let own = folder.join(&name);
    make_folder(&own)?;
    let mut blocks = Vec::new();
    for (k, comparison) in study.comparisons.iter().enumerate() {
        let word = comparison.headline.name();
        let mut costs = vec![(Cost::Time(study.clock), format!("work_precision_{word}"))];
        let other = if study.clock == Clock::Wall { Clock::Cpu } else { Clock::Wall };
        costs.push((
            Cost::Time(other),
            format!("work_precision_{word}_{}", if other == Clock::Cpu { "cpu" } else { "wall" }),
        ));
        costs.push((Cost::Updates, format!("work_precision_{word}_updates")));
        let mut block =
            Block { heading: format!("Error against cost: {}", comparison.headline.label()), ..Block::default() };
        for (place, (cost, file)) in costs.into_iter().enumerate() {
            let canvas = work_precision_panels(&[work_figure(study, comparison, cost)]);
            canvas.write(&own, &file)?;
            // The second measure is shown by the clock that counts; its other figures lie beside the page.
            if k == 0 || place == 0 {
                block.figures.push(Figure::new(&canvas, caption(study, cost), format!("{name}/{file}")));
            }
        }
        block.tables.push(equal_error_table(comparison));
        block.tables.push(equal_time_table(comparison));
        blocks.push(block);
        let file = format!("convergence_{word}");
        let canvas = order_figure(study, comparison);
        canvas.write(&own, &file)?;
        let caption = "Error against particle spacing. Hollow points lie below ten times the error of the \
                       reference: how far below their true error lies is not known.";
        blocks.push(Block {
            heading: format!("Convergence: {}", comparison.headline.label()),
            figures: vec![Figure::new(&canvas, caption, format!("{name}/{file}"))],
            tables: vec![order_table(study.runs.scene.units, comparison)],
            ..Block::default()
        });
    }
    blocks.extend(ensembles(study));
    blocks.push(run_table(study));
    blocks.extend(finest_runs(&own, study)?);
    blocks.push(gates(study));
    blocks.extend(failures(study));
    blocks.push(settings(study));
    Ok(SceneSection {
        title: study.runs.scene.title.clone(),
        source: study.runs.scene.source.clone(),
        parameters: parameters(study),
        name,
        blocks,
    })
}

fn caption(study: &Study, cost: Cost) -> String {
    let bars = "Bars upward: 95 % interval of the median, or the range where fewer than six runs were timed; bars \
                sideways: 95 % interval over seeds. Ringed points may be low by luck and are not read off.";
    match cost {
        Cost::Updates => "The same errors against particle updates, which no machine and no load changes.".into(),
        Cost::Time(clock) if clock == study.clock => format!("{bars} Setup is part of the time."),
        Cost::Time(Clock::Cpu) => "The same errors against the CPU time of the process.".into(),
        Cost::Time(Clock::Wall) => "The same errors against wall time, on a machine that was not quiet.".into(),
    }
}

fn finest_runs(folder: &Path, study: &Study) -> Result<Vec<Block>, Failure> {
    let scene = &study.runs.scene;
    let mut blocks = Vec::new();
    for same in analysis::group(&study.runs.measured) {
        let Some((one, result)) =
            same.iter().rev().find_map(|one| Some((one, one.result.as_ref().filter(|_| one.is_ok())?)))
        else {
            continue;
        };
        let key = names::of(&format!("{}_{}", one.method, one.setting.name.replace('=', "-")));
        let own = folder.join(&key);
        make_folder(&own)?;
        write_run(&own, result)?;
        let all = drawings(result, &figure_options::of_run(scene, &result.fields));
        let last_map = all.iter().rposition(|(file, _)| file.starts_with("map_"));
        let mut block = Block { heading: format!("{} at {}", one.label(), one.spacing_words()), ..Block::default() };
        for (k, (file, canvas)) in all.iter().enumerate() {
            canvas.write(&own, file)?;
            if !file.starts_with("map_") || last_map == Some(k) {
                block.figures.push(Figure::new(canvas, canvas.title.clone(), format!("{}/{key}/{file}", study.name())));
            }
        }
        if !block.figures.is_empty() {
            blocks.push(block);
        }
    }
    Ok(blocks)
}
