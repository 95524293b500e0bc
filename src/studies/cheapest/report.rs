//! What a search for the cheapest run leaves: a table of all runs, a figure and a page.

use std::path::Path;

use frazil_plots::canvas::Formats;
use frazil_plots::comparison::{WorkCurve, WorkFigure, WorkPoint, work_precision_panels};
use frazil_plots::page::{self, Block, Fact, Figure, Page, Table};
use frazil_plots::style::{duration, method_title, number, percent};
use serde::Serialize;

use super::ladder::Rung;
use super::request::CheapestRequest;
use super::{Of, Study};
use crate::compare::plan::spacing_override;
use crate::ensemble::runs::Headline;
use crate::failure::Failure;
use crate::machine::Machine;
use crate::output::write_rows;
use crate::words::length_words;

/// A run in `cheapest.csv`.
#[derive(Debug, Clone, Serialize)]
struct Row {
    scene: String,
    measure: &'static str,
    error: f64,
    method: &'static str,
    spacing_m: f64,
    particles: u64,
    steps: u64,
    promised_error: Option<f64>,
    error_against_reference: Option<f64>,
    order: Option<f64>,
    forecast_cpu_s: Option<f64>,
    cpu_s: f64,
    chosen: bool,
    why_not: String,
    steps_error: Option<f64>,
    noise: Option<f64>,
    command: String,
}

/// Writes the table, the figure and the page.
pub fn write(request: &CheapestRequest, folder: &Path, study: &Study) -> Result<(), Failure> {
    let rows: Vec<Row> = study.all.iter().flat_map(|of| rows(request, study, of)).collect();
    write_rows(&folder.join("cheapest.csv"), &rows)?;
    let figure = work_precision_panels(&[figure(request, study)]);
    figure.write(folder, "cheapest", Formats::ALL)?;
    let label = study.headline.map_or("error", Headline::label);
    let block = Block {
        heading: format!("{} of {label}", percent(request.error, 3)),
        figures: vec![Figure::new(
            &figure,
            "Promised error of each run against its CPU time. The line is the requested error.",
            "cheapest",
        )],
        tables: vec![table(study)],
        ..Block::default()
    };
    let page = Page {
        title: format!("The cheapest run: {}", study.scene.title),
        answers: vec![answer(request, study)],
        lead: vec![
            "Errors are estimated from runs of the same method by Richardson extrapolation, with the factors of safety \
             of Roache: 1.25 if three spacings show an order of convergence, 3 otherwise."
                .into(),
        ],
        command: request.command_line.clone(),
        opening: vec![block],
        machine: Machine::now().facts(Fact::new("Threads of each run", request.threads.to_string())),
        ..Page::default()
    };
    Ok(page::write(&page, &folder.join("report.html"))?)
}

/// The methods in the order of their cost, and what keeps the others from it.
fn answer(request: &CheapestRequest, study: &Study) -> String {
    let label = study.headline.map_or("error", Headline::label).trim_start_matches("rms ");
    let least = study.all.first().and_then(Of::cost);
    let said = |of: &Of| {
        let name = method_title(of.kind.name);
        let Ok(chosen) = of.reached.chosen else { return format!("{name} does not reach it") };
        let rung = &of.reached.rungs[chosen];
        let ratio = least
            .filter(|least| *least < rung.cost_s)
            .map_or_else(String::new, |least| format!(", {} × as long", number(rung.cost_s / least, 2)));
        format!("{name} in {} at {}{ratio}", duration(rung.cost_s), length_words(study.scene.units, rung.spacing))
    };
    let all: Vec<String> = study.all.iter().map(said).collect();
    format!("{} of {label} or less: {}.", percent(request.error, 3), all.join("; "))
}

fn rows(request: &CheapestRequest, study: &Study, of: &Of) -> Vec<Row> {
    let row = |(number, rung): (usize, &Rung)| {
        let (key, value) = spacing_override(study.scene.units, of.kind.name, rung.spacing);
        let record = &rung.result.record;
        let chosen = of.reached.chosen.as_ref().is_ok_and(|chosen| *chosen == number);
        let is_last = number + 1 == of.reached.rungs.len();
        let why_not = of.reached.chosen.as_ref().err().filter(|_| is_last).map(ToString::to_string);
        Row {
            scene: study.scene.name.clone(),
            measure: study.headline.map_or("", Headline::name),
            error: request.error,
            method: of.kind.name,
            spacing_m: rung.spacing,
            particles: record.particles,
            steps: record.steps,
            promised_error: of.reached.promise(number),
            error_against_reference: study.headline.and_then(|headline| headline.of(&record.errors)),
            order: Some(of.reached.order).filter(|order| order.is_finite()),
            forecast_cpu_s: rung.forecast_s,
            cpu_s: rung.cost_s,
            chosen,
            why_not: why_not.unwrap_or_default(),
            steps_error: Some(of.reached.steps_alone).filter(|error| *error > 0.0),
            noise: of.reached.noise,
            command: format!("frazil run {} --method {} --set {key}={value}", request.scene, of.kind.name),
        }
    };
    of.reached.rungs.iter().enumerate().map(row).collect()
}

fn figure(request: &CheapestRequest, study: &Study) -> WorkFigure {
    let curve = |of: &Of| {
        let point = |(number, rung): (usize, &Rung)| WorkPoint {
            error: of.reached.promise(number),
            cost: Some(rung.cost_s),
            error_range: None,
            cost_range: None,
            hollow: false,
            ringed: false,
            on_front: true,
        };
        WorkCurve {
            method: of.kind.name.into(),
            label: method_title(of.kind.name),
            second: false,
            points: of.reached.rungs.iter().enumerate().map(point).collect(),
        }
    };
    WorkFigure {
        title: format!("{}: time to reach an error", study.scene.title),
        error_label: format!("promised {}", study.headline.map_or("error", Headline::label)),
        cost_label: "CPU time, setup and solve (s)".into(),
        marked: Some((request.error, "requested error")),
        curves: study.all.iter().map(curve).collect(),
    }
}

fn table(study: &Study) -> Table {
    let row = |of: &Of| {
        let name = method_title(of.kind.name);
        let Ok(chosen) = &of.reached.chosen else {
            let why = of.reached.chosen.as_ref().err().map(ToString::to_string).unwrap_or_default();
            return vec![name, format!("not reached: {why}")];
        };
        let rung = &of.reached.rungs[*chosen];
        let record = &rung.result.record;
        let against = study.headline.and_then(|headline| headline.of(&record.errors));
        vec![
            name,
            length_words(study.scene.units, rung.spacing),
            number(record.particles as f64, 6),
            number(record.steps as f64, 6),
            percent(of.reached.promised[*chosen], 2),
            against.map_or_else(|| "no reference".into(), |error| percent(error.abs(), 2)),
            number(of.reached.order, 2),
            rung.forecast_s.map_or_else(|| "none".into(), duration),
            duration(rung.cost_s),
        ]
    };
    Table {
        caption: "The fastest run of each method with the promised error, from finer runs of the method. For \
                  comparison: the error against the reference of the scene, which was not used, and the forecast of \
                  the time before the run."
            .into(),
        heads: [
            "method",
            "spacing",
            "particles",
            "steps",
            "promised",
            "against the reference",
            "order",
            "forecast",
            "CPU time",
        ]
        .map(String::from)
        .into(),
        rows: study.all.iter().map(row).collect(),
        words: 1,
        csv: Some("cheapest.csv".into()),
    }
}
