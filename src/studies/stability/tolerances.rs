//! Unsaturated water: its steps are implicit and have no bound to go beyond, so a study sweeps their tolerance.

use std::path::Path;

use frazil_plots::canvas::{Canvas, Formats};
use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection, Table};
use frazil_plots::stability::{MapCell, MapColumn, MapPanel, StabilityFigure, Upward, stability};
use frazil_plots::style::{method_title, number, percent};
use frazil_record::{Outcome, Record};
use frazil_scene::Scene;
use frazil_simulation::march::{self, BALANCE_TOLERANCE, Options, RANGE_TOLERANCE};
use serde::{Deserialize, Serialize};

use super::axis::Axis;
use super::cell::{SEED, class_word, wall_data};
use super::plan::Job;
use super::request::StabilityRequest;
use crate::campaign::{self, Campaign};
use crate::failure::Failure;
use crate::machine::Machine;
use crate::output::{make_folder, write_rows};
use crate::parts::{Override, Parts};
use crate::words;

/// Tolerances that are tried, over the scene's own.
const RATIOS: [f64; 6] = [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0];

/// The least and the greatest tolerance that scenes take.
const ALLOWED: (f64, f64) = (1e-9, 1.0);

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    record: Record,
    /// Water taken up at the end.
    taken: Option<f64>,
}

/// A run of a job with a tolerance, or why there is none.
pub struct Cell {
    job: Job,
    ratio: f64,
    tolerance: f64,
    found: Result<Finding, String>,
}

impl Cell {
    fn class(&self) -> &'static str {
        self.found.as_ref().map_or("refused", |found| class_word(found.record.outcome))
    }

    fn taken(&self) -> Option<f64> {
        self.found.as_ref().ok().filter(|found| found.record.outcome == Outcome::Ok)?.taken
    }

    fn is_of(&self, job: &Job) -> bool {
        self.job == *job
    }

    fn value(&self) -> String {
        self.job.value.map_or("own".into(), |value| number(value, 3))
    }
}

/// Runs all jobs with all tolerances; nothing of those that an interruption kept from being made.
///
/// # Errors
/// Where findings cannot be kept.
pub fn cells(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    jobs: &[Job],
    campaign: &Campaign<'_>,
) -> Result<Vec<Cell>, Failure> {
    let ratios: &[f64] = if request.steps.is_empty() { &RATIOS } else { &request.steps };
    let tasks: Vec<(&Job, f64)> = jobs.iter().flat_map(|job| ratios.iter().map(move |ratio| (job, *ratio))).collect();
    let work = |k: usize| cell(request, parts, tasks[k].0, tasks[k].1, campaign);
    Ok(campaign.side_by_side(&vec![1.0; tasks.len()], work)?.into_iter().flatten().flatten().collect())
}

/// One cell; none where the tolerance is none that scenes take.
fn cell(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    job: &Job,
    ratio: f64,
    campaign: &Campaign<'_>,
) -> Option<Option<Cell>> {
    let refused = |reason: String| {
        let (job, tolerance) = (job.clone(), f64::NAN);
        Some(Some(Cell { job, ratio, tolerance, found: Err(reason) }))
    };
    let own = match (parts.scene_at)(&job.scene, &job.overrides) {
        Ok(scene) => scene.method(job.method).and_then(|settings| settings.numerics.integrator.tolerance()),
        Err(failure) => return refused(failure.to_string()),
    };
    let Some(own) = own else { return refused("its steps are not adaptive".into()) };
    let tolerance: f64 = format!("{:.3e}", own * ratio).parse().unwrap_or(own * ratio);
    if tolerance < ALLOWED.0 || tolerance > ALLOWED.1 {
        return Some(None);
    }
    let changes: Vec<Override> = changes(job, tolerance);
    let scene = match (parts.scene_at)(&job.scene, &changes) {
        Ok(scene) => scene,
        Err(failure) => return refused(failure.to_string()),
    };
    let key = campaign::key("tolerance", &scene, job.method, SEED);
    let found = match campaign.known::<Finding>(&key) {
        Some(found) => Ok(found),
        None if campaign.is_stopped() => return None,
        None => run(request, parts, &scene, job.method, campaign),
    };
    match &found {
        Ok(Finding { record: Record { outcome: Outcome::Interrupted, .. }, .. }) => return None,
        // Another time it may not run out of time.
        Ok(Finding { record: Record { outcome: Outcome::TimedOut, .. }, .. }) | Err(_) => {}
        Ok(finding) => campaign.keep(&key, finding),
    }
    Some(Some(Cell { job: job.clone(), ratio, tolerance, found }))
}

fn changes(job: &Job, tolerance: f64) -> Vec<Override> {
    let own = (format!("method.{}.tolerance", job.method), format!("{tolerance}"));
    job.overrides.iter().cloned().chain([own]).collect()
}

fn run(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    scene: &Scene,
    method: &str,
    campaign: &Campaign<'_>,
) -> Result<Finding, String> {
    let reference = wall_data(parts, scene).map_err(|refused| refused.to_string())?;
    let (interrupt, time_limit_s) = (Some(campaign.stop()), Some(request.time_limit_s));
    let options = Options { seed: SEED, interrupt, time_limit_s, ..Options::default() };
    let result = march::run(scene, method, reference.as_ref(), &options).map_err(|refused| refused.to_string())?;
    Ok(Finding { taken: result.budget.last().map(|row| row.stored_j), record: result.record })
}

/// A row of `stability.csv` of unsaturated water.
#[derive(Serialize)]
struct Row<'a> {
    scene: &'a str,
    method: &'a str,
    axis: &'a str,
    value: Option<f64>,
    tolerance: Option<f64>,
    class: &'a str,
    cause: &'a str,
    steps: Option<u64>,
    rejected_steps: Option<u64>,
    newton_iterations: Option<u64>,
    water_taken_up_rel: Option<f64>,
    violation_rel: Option<f64>,
    water_balance_rel: Option<f64>,
    solute_balance_rel: Option<f64>,
    command: String,
}

/// Water taken up, over that of the least tolerance of a column, less one.
fn beside_the_finest(cells: &[Cell], cell: &Cell) -> Option<f64> {
    let column = cells.iter().filter(|other| other.is_of(&cell.job) && other.taken().is_some());
    let finest = column.min_by(|a, b| a.tolerance.total_cmp(&b.tolerance))?.taken()?;
    (finest != 0.0).then_some(cell.taken()? / finest - 1.0)
}

/// Writes the table and the page.
///
/// # Errors
/// Where they cannot be written.
pub fn write(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    machine: &Machine,
    folder: &Path,
    cells: &[Cell],
) -> Result<(), Failure> {
    let row = |cell| Row::of(cells, cell);
    write_rows(&folder.join("stability.csv"), &cells.iter().map(row).collect::<Vec<_>>())?;
    let mut page = Page {
        title: "Robustness of implicit steps".into(),
        lead: vec![
            "Each cell is one run of unsaturated water: its outcome with a tolerance of the time steps, the number of \
             steps, and the difference of the water taken up from that with the smallest tolerance of its row."
                .into(),
        ],
        command: request.command_line.clone(),
        fairness: facts(request),
        machine: machine.facts(Fact::new("Concurrent runs", request.threads.to_string())),
        ..Page::default()
    };
    for name in &request.scenes {
        let scene = (parts.scene_at)(name, &request.overrides)?;
        let along = |axis: &Axis| cells.iter().any(|cell| cell.job.scene == *name && cell.job.axis == *axis);
        let axes = Axis::WORDS.map(|(_, axis)| axis).into_iter().filter(along);
        page.scenes.push(SceneSection {
            name: scene.name.clone(),
            title: scene.title.clone(),
            source: scene.source.clone(),
            parameters: words::parameters(&scene),
            blocks: axes.map(|axis| block(&scene, (name, axis), cells, folder)).collect::<Result<_, _>>()?,
            ..SceneSection::default()
        });
    }
    Ok(page::write(&page, &folder.join("report.html"))?)
}

impl<'a> Row<'a> {
    fn of(cells: &[Cell], cell: &'a Cell) -> Self {
        let record = cell.found.as_ref().ok().map(|found| &found.record);
        let cause = match &cell.found {
            Ok(found) => found.record.cause.as_deref().unwrap_or_default(),
            Err(reason) => reason,
        };
        let set = |(key, value): &Override| format!(" --set {key}={value}");
        let overrides: String = changes(&cell.job, cell.tolerance).iter().map(set).collect();
        Row {
            scene: &cell.job.scene,
            method: cell.job.method,
            axis: cell.job.axis.word(),
            value: cell.job.value,
            tolerance: Some(cell.tolerance).filter(|tolerance| tolerance.is_finite()),
            class: cell.class(),
            cause,
            steps: record.map(|record| record.steps),
            rejected_steps: record.map(|record| record.work.rejected_steps),
            newton_iterations: record.map(|record| record.work.newton_iterations),
            water_taken_up_rel: beside_the_finest(cells, cell),
            violation_rel: record.and_then(|record| record.bounds_violation_rel),
            water_balance_rel: record.map(|record| record.energy_balance_rel),
            solute_balance_rel: record.and_then(|record| record.solute_balance_rel),
            command: format!("frazil run {} --method {}{overrides}", cell.job.scene, cell.job.method),
        }
    }
}

/// What the classes mean.
fn facts(request: &StabilityRequest) -> Vec<Fact> {
    let exact = format!(
        "pressure heads within the range of the data to {} of it, on a logarithmic scale, and the water balance closed to {} of \
         the water exchanged at every output; not free of discretisation errors",
        percent(RANGE_TOLERANCE, 2),
        percent(BALANCE_TOLERANCE, 2)
    );
    vec![
        Fact::new("Exact", exact),
        Fact::new(
            "Diverged",
            "a value that is not finite, or outside the data by more than ten ranges, or a step without a solution",
        ),
        Fact::new("Timed out", format!("not finished after {} s", number(request.time_limit_s, 3))),
        Fact::new(
            "Runs",
            format!(
                "the scene itself, at up to {} times its spacing except on the axis of the spacing",
                request.coarsen
            ),
        ),
        Fact::new("Run again", "every row of the table contains its command"),
    ]
}

/// Methods, values and tolerances of an axis: a map of how runs ended.
fn map(title: &str, axis: Axis, jobs: &[&Job], own: &[&Cell], ratios: &[f64]) -> Canvas {
    let half_way = 10f64.sqrt();
    let column = |job: &Job| {
        let of_job = own.iter().filter(|cell| cell.is_of(job));
        let ended = |cell: &&Cell| {
            let record = &cell.found.as_ref().ok()?.record;
            Some(MapCell { ratio: cell.ratio, class: record.outcome, steps: Some(record.steps) })
        };
        let mut cells: Vec<MapCell> = of_job.filter_map(ended).collect();
        cells.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        MapColumn { name: job.value.map_or("own".into(), |value| number(value, 3)), cells, ..MapColumn::default() }
    };
    let mut panels: Vec<MapPanel> = Vec::new();
    for job in jobs {
        match panels.iter_mut().find(|panel| panel.method == job.method) {
            Some(panel) => panel.columns.push(column(job)),
            None => panels.push(MapPanel { method: job.method.into(), columns: vec![column(job)] }),
        }
    }
    let ends = ratios.first().zip(ratios.last()).unwrap_or((&1.0, &1.0));
    stability(&StabilityFigure {
        title: title.into(),
        axis: axis.label().into(),
        upward: Upward::Tolerance,
        range: (ends.0 / half_way, ends.1 * half_way),
        range_tolerance: RANGE_TOLERANCE,
        balance_tolerance: BALANCE_TOLERANCE,
        panels,
    })
}

fn block(scene: &Scene, (name, axis): (&str, Axis), cells: &[Cell], folder: &Path) -> Result<Block, Failure> {
    let own: Vec<&Cell> = cells.iter().filter(|cell| cell.job.scene == name && cell.job.axis == axis).collect();
    let mut ratios: Vec<f64> = own.iter().map(|cell| cell.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    let mut jobs: Vec<&Job> = Vec::new();
    for cell in &own {
        if !jobs.contains(&&cell.job) {
            jobs.push(&cell.job);
        }
    }
    let said = |cell: &Cell| {
        let steps = cell.found.as_ref().map_or(0, |found| found.record.steps);
        let more = beside_the_finest(cells, cell).map_or(String::new(), |more| format!(", {}", percent(more, 2)));
        if steps > 0 { format!("{}: {steps} steps{more}", cell.class()) } else { cell.class().into() }
    };
    let row = |job: &&Job| {
        let of_job = |ratio: &f64| own.iter().find(|cell| cell.is_of(job) && cell.ratio == *ratio);
        let first = own.iter().find(|cell| cell.is_of(job)).map_or(String::new(), |cell| cell.value());
        let cells = ratios.iter().map(|ratio| of_job(ratio).map_or(String::new(), |cell| said(cell)));
        [method_title(job.method), first].into_iter().chain(cells).collect()
    };
    let head = |ratio: &f64| if *ratio == 1.0 { "own".into() } else { format!("{} × own", number(*ratio, 3)) };
    let heads = ratios.iter().map(head);
    let bad = own.iter().filter(|cell| cell.class() != class_word(Outcome::Ok));
    let told = bad.map(|cell| {
        let cause =
            cell.found.as_ref().map_or_else(Clone::clone, |found| found.record.cause.clone().unwrap_or_default());
        let (method, tolerance) = (method_title(cell.job.method), number(cell.tolerance, 3));
        format!("{method} at {}, tolerance {tolerance}: {}: {cause}", cell.value(), cell.class().replace('_', " "))
    });
    let (into, file) = (folder.join(&scene.name), format!("stability_{}", axis.word()));
    make_folder(&into)?;
    let canvas = map(&format!("{}: {}", scene.title, axis.label()), axis, &jobs, &own, &ratios);
    canvas.write(&into, &file, Formats::ALL)?;
    let caption = "Outcomes of the runs. Reasons for cells that are not within tolerance are listed below.";
    let figure = Figure::new(&canvas, caption, format!("{}/{file}", scene.name));
    Ok(Block {
        heading: axis.label().into(),
        list: told.collect(),
        figures: vec![figure],
        tables: vec![Table {
            caption: format!("By {}, and by the tolerance over the scene's own.", axis.label()),
            heads: ["method".into(), "value".into()].into_iter().chain(heads).collect(),
            rows: jobs.iter().map(row).collect(),
            words: 2,
            csv: Some("stability.csv".into()),
        }],
        ..Block::default()
    })
}

/// What a study comes to: the tolerance that a scene asks for itself must not break it.
pub fn is_good(cells: &[Cell]) -> bool {
    let own = cells.iter().filter(|cell| cell.ratio <= 1.0);
    let ended = |cell: &Cell| matches!(&cell.found, Ok(found) if !matches!(found.record.outcome, Outcome::Ok | Outcome::TimedOut));
    !own.into_iter().any(ended)
}
