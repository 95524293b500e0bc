//! The numbers of a study as files: unrounded, a row each.

use std::path::Path;

use serde::Serialize;

use super::axis::Axis;
use super::cell::class_word;
use super::execute::{Column, Mapped};
use super::request::StabilityRequest;
use super::search::Cell;
use super::super_steps;
use crate::failure::Failure;
use crate::output::write_rows;
use crate::parts::Override;

/// A cell in `stability.csv`.
#[derive(Debug, Clone, Serialize)]
struct CellRow {
    scene: String,
    method: &'static str,
    axis: &'static str,
    value: Option<f64>,
    step_over_bound: f64,
    step_s: f64,
    steps: u64,
    class: &'static str,
    cause: String,
    seeds: usize,
    failures: usize,
    failures_low: Option<f64>,
    failures_high: Option<f64>,
    violation_rel: Option<f64>,
    setback_rel: Option<f64>,
    energy_balance_rel: Option<f64>,
    command: String,
}

/// A column in `boundaries.csv`.
#[derive(Debug, Clone, Default, Serialize)]
struct BoundaryRow {
    scene: String,
    method: &'static str,
    axis: &'static str,
    value: Option<f64>,
    spacing_m: Option<f64>,
    particles: Option<u64>,
    bound_s: Option<f64>,
    bound_cause: String,
    sharp_s: Option<f64>,
    sharp_over_bound: Option<f64>,
    first_loss_low: Option<f64>,
    first_loss_high: Option<f64>,
    first_loss_over_bound: Option<f64>,
    last_exact_low: Option<f64>,
    last_exact_high: Option<f64>,
    last_exact_over_sharp: Option<f64>,
    divergence_low: Option<f64>,
    divergence_high: Option<f64>,
    divergence_over_sharp: Option<f64>,
    refused: String,
    command: String,
}

/// A number of stages in `rkl2.csv`.
#[derive(Debug, Clone, Default, Serialize)]
struct StagesRow {
    scene: String,
    method: &'static str,
    stages: Option<f64>,
    spacing_m: Option<f64>,
    stated_s: Option<f64>,
    stated_over_euler: Option<f64>,
    class_at_stated: &'static str,
    cause: String,
    limit_over_stated: Option<f64>,
    first_loss_low: Option<f64>,
    first_loss_high: Option<f64>,
    last_exact_low: Option<f64>,
    last_exact_high: Option<f64>,
    last_exact_over_limit: Option<f64>,
    divergence_low: Option<f64>,
    divergence_high: Option<f64>,
    divergence_over_limit: Option<f64>,
    refused: String,
    command: String,
}

/// Writes the three tables; one without a row is not there.
pub fn write(request: &StabilityRequest, folder: &Path, columns: &[Mapped]) -> Result<(), Failure> {
    let cells: Vec<CellRow> = columns
        .iter()
        .flat_map(|mapped| {
            let found = mapped.found.iter();
            found.flat_map(move |column| {
                column.ladder.cells.iter().map(move |cell| cell_row(request, mapped, column, cell))
            })
        })
        .collect();
    write_rows(&folder.join("stability.csv"), &cells)?;
    let (super_steps, euler): (Vec<&Mapped>, Vec<&Mapped>) =
        columns.iter().partition(|mapped| mapped.job.axis == Axis::Stages);
    if !euler.is_empty() {
        let rows: Vec<_> = euler.into_iter().map(|mapped| boundary_row(request, mapped)).collect();
        write_rows(&folder.join("boundaries.csv"), &rows)?;
    }
    if !super_steps.is_empty() {
        let rows: Vec<_> = super_steps.into_iter().map(|mapped| stages_row(request, mapped)).collect();
        write_rows(&folder.join("rkl2.csv"), &rows)?;
    }
    Ok(())
}

/// The command that runs a cell again, or all cells of a column if no step is given.
pub fn command(request: &StabilityRequest, mapped: &Mapped, ratio: Option<f64>) -> String {
    let set = |(key, value): &Override| format!(" --set {key}={value}");
    let overrides: String = mapped.job.overrides.iter().map(set).collect();
    let steps = ratio.map_or(String::new(), |ratio| format!(" --steps {ratio}"));
    let seeds = if mapped.found.as_ref().is_ok_and(|column| column.probe.noisy()) {
        format!(" --seeds {}", request.seeds)
    } else {
        String::new()
    };
    let method = mapped.job.method;
    format!("frazil stability {} --methods {method} --axes own --coarsen 1{overrides}{steps}{seeds}", mapped.job.scene)
}

fn cell_row(request: &StabilityRequest, mapped: &Mapped, column: &Column, cell: &Cell) -> CellRow {
    let share = cell.share().filter(|_| cell.seeds > 1);
    CellRow {
        scene: column.probe.scene.name.clone(),
        method: mapped.job.method,
        axis: mapped.job.axis.word(),
        value: mapped.job.value,
        step_over_bound: cell.ratio,
        step_s: cell.finding.step_s,
        steps: cell.finding.steps,
        class: class_word(cell.class),
        cause: cell.finding.cause.clone().unwrap_or_default(),
        seeds: cell.seeds,
        failures: cell.failures,
        failures_low: share.map(|share| share.interval.low),
        failures_high: share.map(|share| share.interval.high),
        violation_rel: cell.finding.violation_rel,
        setback_rel: cell.finding.setback_rel,
        energy_balance_rel: cell.finding.energy_balance_rel,
        command: command(request, mapped, Some(cell.ratio)),
    }
}

fn boundary_row(request: &StabilityRequest, mapped: &Mapped) -> BoundaryRow {
    let row = BoundaryRow {
        scene: mapped.job.scene.clone(),
        method: mapped.job.method,
        axis: mapped.job.axis.word(),
        value: mapped.job.value,
        command: command(request, mapped, None),
        ..BoundaryRow::default()
    };
    let column = match &mapped.found {
        Ok(column) => column,
        Err(failure) => return BoundaryRow { refused: failure.to_string(), ..row },
    };
    let (probe, ladder) = (&column.probe, &column.ladder);
    let sharp = column.probe.sharp_over_bound();
    let (first, last, gone) = (ladder.first_loss, ladder.last_exact, ladder.divergence);
    BoundaryRow {
        scene: probe.scene.name.clone(),
        spacing_m: probe.spacing(),
        particles: Some(probe.particles),
        bound_s: Some(probe.stated_s),
        bound_cause: probe.bounds.gershgorin.cause.clone(),
        sharp_s: Some(probe.bounds.sharp_step),
        sharp_over_bound: Some(sharp),
        first_loss_low: first.low,
        first_loss_high: first.high,
        first_loss_over_bound: first.middle(),
        last_exact_low: last.low,
        last_exact_high: last.high,
        last_exact_over_sharp: last.middle().map(|step| step / sharp),
        divergence_low: gone.low,
        divergence_high: gone.high,
        divergence_over_sharp: gone.middle().map(|step| step / sharp),
        ..row
    }
}

fn stages_row(request: &StabilityRequest, mapped: &Mapped) -> StagesRow {
    let row = StagesRow {
        scene: mapped.job.scene.clone(),
        method: mapped.job.method,
        stages: mapped.job.value,
        command: command(request, mapped, None),
        ..StagesRow::default()
    };
    let column = match &mapped.found {
        Ok(column) => column,
        Err(failure) => return StagesRow { refused: failure.to_string(), ..row },
    };
    let probe = &column.probe;
    let stated = column.ladder.cells.iter().find(|cell| cell.ratio == 1.0);
    let limit =
        column.probe.sharp_over_bound() * mapped.job.value.map_or(1.0, |stages| super_steps::limit(stages as usize));
    let (first, last, gone) = (column.ladder.first_loss, column.ladder.last_exact, column.ladder.divergence);
    StagesRow {
        scene: probe.scene.name.clone(),
        spacing_m: probe.spacing(),
        stated_s: Some(probe.stated_s),
        stated_over_euler: Some(probe.stated_s / probe.bounds.gershgorin.step),
        class_at_stated: stated.map_or("", |cell| class_word(cell.class)),
        cause: stated.and_then(|cell| cell.finding.cause.clone()).unwrap_or_default(),
        limit_over_stated: Some(limit),
        first_loss_low: first.low,
        first_loss_high: first.high,
        last_exact_low: last.low,
        last_exact_high: last.high,
        last_exact_over_limit: last.middle().map(|step| step / limit),
        divergence_low: gone.low,
        divergence_high: gone.high,
        divergence_over_limit: gone.middle().map(|step| step / limit),
        ..row
    }
}
