//! The page of a study: maps first, the numbers under each.

use std::path::Path;

use frazil_plots::canvas::Formats;
use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection, Table};
use frazil_plots::style::{method_title, number, percent};
use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_simulation::march::{BALANCE_TOLERANCE, RANGE_TOLERANCE, SETBACK_TOLERANCE};

use super::axis::Axis;
use super::cell::class_word;
use super::execute::Mapped;
use super::request::StabilityRequest;
use super::search::{Cell, Edge};
use super::{figures, super_steps};
use crate::failure::Failure;
use crate::figures::Figures;
use crate::machine::Machine;
use crate::output::make_folder;
use crate::parallel;
use crate::parts::Parts;
use crate::words::{self, capital, length_words};

/// A map with its boundaries, or a table of super-steps, lies in this folder beside the page under the scene's name.
fn file(axis: Axis) -> String {
    format!("stability_{}", axis.word())
}

/// Cells within the stated step that refute it. Up to its bound explicit Euler must be exact. RKL2 promises stability
/// alone: it may overshoot, but where no longer step is exact either, it is not stable.
pub fn broken_promises(mapped: &Mapped) -> impl Iterator<Item = &Cell> {
    mapped.found.iter().flat_map(|column| {
        let kept = !column.probe.monotone() && column.ladder.last_exact.low.is_some_and(|step| step >= 1.0);
        let broken =
            move |cell: &&Cell| cell.ratio <= 1.0 && !kept && !matches!(cell.class, Outcome::Ok | Outcome::TimedOut);
        column.ladder.cells.iter().filter(broken)
    })
}

/// Writes the figures and the page.
pub fn write(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    machine: &Machine,
    folder: &Path,
    columns: &[Mapped],
) -> Result<(), Failure> {
    let mut page = Page {
        title: "Stability of the methods".into(),
        lead: vec![
            format!("Within tolerance means here: {}.", tolerance()),
            "Each cell is one run, with the time step over the step bound (row sums of the weights) on the vertical \
             axis and one parameter of the scene on the horizontal axis. Up to the bound every run must be within \
             tolerance. Above the linear stability limit none can be; between the two it depends on the scene. Tables \
             and files call such a run, and such a step, exact: stable within tolerance, but not free of \
             discretisation errors."
                .into(),
        ],
        command: request.command_line.clone(),
        fairness: facts(request),
        machine: machine.facts(Fact::new("Concurrent columns", request.threads.to_string())),
        ..Page::default()
    };
    let mut figures = Figures::default();
    for name in &request.scenes {
        let own: Vec<&Mapped> = columns.iter().filter(|mapped| mapped.job.scene == *name).collect();
        // Columns have values of their own in place of the scene's.
        let scene = (parts.scene_at)(name, &request.overrides)?;
        page.answers.extend(answer(&scene, &own));
        page.scenes.extend(section(folder, &scene, &own, &mut figures)?);
    }
    figures.write(Formats::ALL, parallel::cores())?;
    Ok(page::write(&page, &folder.join("report.html"))?)
}

/// How far the steps of each method go on a scene, over all its maps; none where no column has a boundary.
fn answer(scene: &Scene, columns: &[&Mapped]) -> Option<String> {
    let mut methods: Vec<&str> = Vec::new();
    for mapped in columns {
        if !methods.contains(&mapped.job.method) {
            methods.push(mapped.job.method);
        }
    }
    let said = |method: &&str| {
        let own = columns.iter().filter(|mapped| mapped.job.method == *method && mapped.job.axis != Axis::Stages);
        let ladders = own.filter_map(|mapped| Some(&mapped.found.as_ref().ok()?.ladder));
        let steps = ladders.filter_map(|ladder| ladder.last_exact.middle().or(ladder.last_exact.low));
        let (least, most) =
            steps.fold((f64::INFINITY, 0.0f64), |(least, most), step| (least.min(step), most.max(step)));
        let range = if most > least { format!("{} to {}", number(least, 3), number(most, 3)) } else { number(most, 3) };
        (most > 0.0).then(|| format!("{} {range}", method_title(method)))
    };
    let told: Vec<String> = methods.iter().filter_map(said).collect();
    let broken = columns.iter().flat_map(|mapped| broken_promises(mapped)).count();
    let stated = match broken {
        0 => "no run refutes a stated step".to_owned(),
        1 => "one run refutes the step that its method states".to_owned(),
        _ => format!("{broken} runs refute the steps that their methods state"),
    };
    let longest = format!("Longest step within tolerance over the bound, on all maps: {}", told.join("; "));
    (!told.is_empty()).then(|| format!("{}: {stated}. {longest}.", scene.title))
}

fn section(
    folder: &Path,
    scene: &Scene,
    columns: &[&Mapped],
    figures: &mut Figures,
) -> Result<Option<SceneSection>, Failure> {
    if columns.iter().all(|mapped| mapped.found.is_err()) {
        return Ok(None);
    }
    let own = folder.join(&scene.name);
    make_folder(&own)?;
    let mut blocks = Vec::new();
    for axis in Axis::WORDS.map(|(_, axis)| axis) {
        let along: Vec<&Mapped> = columns.iter().copied().filter(|mapped| mapped.job.axis == axis).collect();
        if along.is_empty() {
            continue;
        }
        let heading = capital(axis.label());
        let title = format!("{}: {}", scene.title, axis.label());
        let (canvas, caption, tables) = if axis == Axis::Stages {
            let caption = "Steps of RKL2 over the stated one, which is (s² + s − 2)/4 Euler bounds for s stages.";
            (figures::stages(&title, &along), caption, vec![stages_table(&along)])
        } else {
            let caption = "If the two triangles of a column coincide, all larger steps are out of tolerance. A column \
                           without cells was refused.";
            let tables = [Some(boundary_table(&along)), noise_table(&along)];
            (figures::map(&title, axis, &along), caption, tables.into_iter().flatten().collect())
        };
        let mut block = Block { heading, tables, list: refusals(&along), ..Block::default() };
        if let Some(canvas) = canvas {
            block.figures.push(Figure::new(&canvas, caption, format!("{}/{}", scene.name, file(axis))));
            figures.add(&own, file(axis), canvas);
        }
        blocks.push(block);
    }
    blocks.push(promises(columns));
    let parameters = words::parameters(scene).into_iter().filter(|fact| fact.name != "Duration");
    Ok(Some(SceneSection {
        name: scene.name.clone(),
        title: scene.title.clone(),
        source: scene.source.clone(),
        parameters: parameters.collect(),
        blocks,
        ..SceneSection::default()
    }))
}

fn value(mapped: &Mapped) -> String {
    mapped.job.value.map_or("own".into(), |value| number(value, 3))
}

/// A boundary as a number, or on which side of all steps it lies.
fn edge(edge: Edge, scale: f64) -> String {
    match (edge.middle(), edge.low, edge.high) {
        (Some(middle), ..) => number(middle / scale, 3),
        (None, Some(low), None) => format!("above {}", number(low / scale, 3)),
        (None, None, Some(high)) => format!("below {}", number(high / scale, 3)),
        (None, ..) => String::new(),
    }
}

fn boundary_table(columns: &[&Mapped]) -> Table {
    let rows = columns.iter().filter_map(|mapped| {
        let column = mapped.found.as_ref().ok()?;
        let (ladder, sharp) = (&column.ladder, column.probe.sharp_over_bound());
        Some(vec![
            method_title(mapped.job.method),
            value(mapped),
            column.probe.spacing().map_or(String::new(), |spacing| length_words(column.probe.scene.units, spacing)),
            number(column.probe.stated_s, 4),
            number(sharp, 4),
            edge(ladder.first_loss, 1.0),
            edge(ladder.last_exact, 1.0),
            edge(ladder.last_exact, sharp),
            edge(ladder.divergence, 1.0),
        ])
    });
    let heads = [
        "method",
        "value",
        "spacing",
        "bound (s)",
        "sharp / bound",
        "first loss / bound",
        "last exact / bound",
        "last exact / sharp",
        "divergence / bound",
    ];
    Table {
        caption: "Boundaries, each enclosed within 2 % of the step. First loss: below it every run is within \
                  tolerance. Last exact: above it none is. Sharp: two over the largest decay rate of the linear \
                  operator."
            .into(),
        heads: heads.map(Into::into).into(),
        rows: rows.collect(),
        words: 1,
        csv: Some("boundaries.csv".into()),
    }
}

/// Shares of failed seeds, where there are several; none elsewhere.
fn noise_table(columns: &[&Mapped]) -> Option<Table> {
    let mut rows = Vec::new();
    for mapped in columns {
        let Ok(column) = &mapped.found else { continue };
        for cell in column.ladder.cells.iter().filter(|cell| cell.seeds > 1) {
            let Some(share) = cell.share() else { continue };
            rows.push(vec![
                method_title(mapped.job.method),
                value(mapped),
                number(cell.ratio, 3),
                class_word(cell.class).replace('_', " "),
                format!("{} of {}", cell.failures, cell.seeds),
                format!("{} to {}", percent(share.interval.low, 2), percent(share.interval.high, 2)),
            ]);
        }
    }
    (!rows.is_empty()).then(|| Table {
        caption: "Noisy cells: seeds that were not within tolerance, and the 95 % confidence interval of their \
                  fraction (Wilson)."
            .into(),
        heads: ["method", "value", "step / bound", "class", "failed", "interval"].map(Into::into).into(),
        rows,
        words: 1,
        csv: Some("stability.csv".into()),
    })
}

fn stages_table(columns: &[&Mapped]) -> Table {
    let rows = columns.iter().filter_map(|mapped| {
        let column = mapped.found.as_ref().ok()?;
        let ladder = &column.ladder;
        let limit = column.probe.sharp_over_bound() * super_steps::limit(mapped.job.value? as usize);
        let stated = ladder.cells.iter().find(|cell| cell.ratio == 1.0);
        Some(vec![
            method_title(mapped.job.method),
            value(mapped),
            number(column.probe.stated_s / column.probe.bounds.gershgorin.step, 4),
            stated.map_or(String::new(), |cell| class_word(cell.class).replace('_', " ")),
            number(limit, 4),
            edge(ladder.first_loss, 1.0),
            edge(ladder.last_exact, 1.0),
            edge(ladder.last_exact, limit),
            edge(ladder.divergence, limit),
        ])
    });
    let heads = [
        "method",
        "stages",
        "stated / Euler bound",
        "at the stated step",
        "limit / stated",
        "first loss / stated",
        "last exact / stated",
        "last exact / limit",
        "divergence / limit",
    ];
    Table {
        caption:
            "Limit: step at which the stability polynomial of the scheme leaves the unit interval, for the largest \
             decay rate. RKL2 is stable below it, but not monotone: a run may overshoot, and exceed the tolerance, \
             before."
                .into(),
        heads: heads.map(Into::into).into(),
        rows: rows.collect(),
        words: 1,
        csv: Some("rkl2.csv".into()),
    }
}

fn refusals(columns: &[&Mapped]) -> Vec<String> {
    let one = |mapped: &&Mapped| {
        let reason = mapped.found.as_ref().err()?;
        Some(format!("{} at {}: refused: {reason}", method_title(mapped.job.method), value(mapped)))
    };
    columns.iter().filter_map(one).collect()
}

fn promises(columns: &[&Mapped]) -> Block {
    let mut list = Vec::new();
    for mapped in columns {
        for cell in broken_promises(mapped) {
            list.push(format!(
                "{}, {} {}, step {} of the bound: {}: {}",
                method_title(mapped.job.method),
                mapped.job.axis.word(),
                value(mapped),
                number(cell.ratio, 3),
                class_word(cell.class).replace('_', " "),
                cell.finding.cause.as_deref().unwrap_or_default()
            ));
        }
    }
    let text =
        if list.is_empty() { vec!["No run contradicts the stated step of its method.".into()] } else { Vec::new() };
    Block { heading: "Stated steps that were refuted".into(), text, list, ..Block::default() }
}

/// What a run must keep to be called exact.
fn tolerance() -> String {
    format!(
        "temperatures within the range of the data to {} of it, the heat balance closed to {} of the heat exchanged at every \
         output, and no decrease of monotone quantities (the front of a body that is cooled from all sides, the heat \
         through its coldest pipes) by more than {}; noise may exceed the range by eight of its standard deviations",
        percent(RANGE_TOLERANCE, 2),
        percent(BALANCE_TOLERANCE, 2),
        percent(SETBACK_TOLERANCE, 2)
    )
}

fn facts(request: &StabilityRequest) -> Vec<Fact> {
    vec![
        Fact::new("Exact", format!("within tolerance: {}", tolerance())),
        Fact::new("Oscillating", "beyond these tolerances, but within ten ranges of the data"),
        Fact::new("Energy drift", format!("the heat balance error exceeds {}", percent(BALANCE_TOLERANCE, 2))),
        Fact::new("Phase skipped", "the same where a latent-heat scheme can step over the freezing interval"),
        Fact::new("Diverged", "a value that is not finite, or outside the data by more than ten ranges"),
        Fact::new("Timed out", format!("not finished after {} s", number(request.time_limit_s, 3))),
        Fact::new(
            "Runs",
            format!(
                "the scene's own duration in whole steps (at least 60 of RKL2), at up to {} times its spacing; one run \
                 of a deterministic cell",
                request.coarsen
            ),
        ),
        Fact::new(
            "Noise",
            format!(
                "off except on its own axis, with three seeds, and {} near a boundary; a cell fails if half of its \
                 seeds do",
                request.seeds
            ),
        ),
        Fact::new("Boundaries", "from the map by bisection until two steps are within 2 %"),
        Fact::new("Run again", "every row of the tables contains its command"),
    ]
}
