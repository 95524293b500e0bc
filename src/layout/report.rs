//! The page of a study: layouts beside each other, figures first.

use std::fs;

use frazil_core::space::domain::Domain;
use frazil_plots::ground_plan::WaterMark;
use frazil_plots::layouts::{LayoutView, PipeView, drawings};
use frazil_plots::page::{self, Block, Fact, Figure, Page, Table};
use frazil_plots::style::number;
use frazil_record::RunResult;

use super::answers::{DAY, Far};
use super::execute::Work;
use super::methods::Beside;
use super::search::{self, Tried};
use super::shaft::{ShaftRow, shafts};
use super::study::{Design, Search, Study};
use super::variants::Role;
use super::{Found, LayoutRequest, dug, reference, tables};
use crate::failure::Failure;
use crate::parallel;

/// Layouts of which each has its own figures on the page; of more, they lie in the folders.
const SHOWN: usize = 6;

/// What a page tells of.
pub(super) struct Told<'a> {
    /// All layouts.
    pub(super) found: &'a [Found<'a>],
    /// What a search has tried.
    pub(super) tried: &'a [Tried],
    /// Layouts under all methods.
    pub(super) beside: &'a [Beside<'a>],
    /// What has been sought of each layout.
    pub(super) critical: Option<Block>,
}

/// Writes figures and page.
pub(super) fn write(
    request: &LayoutRequest,
    study: &Study,
    work: &Work<'_>,
    Told { found, tried, beside, critical }: Told<'_>,
) -> Result<(), Failure> {
    let compared: Vec<&Found<'_>> = found.iter().filter(|one| one.layout.role == Role::Compared).collect();
    let mut page = Page {
        title: study.title.clone(),
        lead: vec![format!(
            "{} of freeze pipes under the method {}, from the scene {}. A gap is closed once ground between two pipes is frozen \
             with its latent heat released; the wall once a closed loop of such gaps runs around the centre.",
            counted(compared.len(), study.horizons.len()),
            work.method,
            study.scene
        )],
        command: request.command_line.clone(),
        machine: work.machine.facts(Fact::new("Layouts at once", work.threads.to_string())),
        ..Page::default()
    };
    page.opening.extend(over_depth(study, work, found)?);
    let runs: Vec<RunResult> = compared.iter().map(|one| one.pair.fine.run()).collect();
    let views: Vec<LayoutView<'_>> = compared.iter().zip(&runs).map(|(one, run)| view(study, one, run)).collect();
    let freezing = compared.first().map_or(0.0, |one| one.layout.scene.materials[0].freezing_point);
    let (mut first, mut figures) = (Vec::new(), Vec::new());
    let drawings = drawings(&views, freezing);
    let draw = |k: usize| Some(drawings[k].canvas.write(&work.folder, &drawings[k].stem));
    for written in parallel::in_order(drawings.len(), work.threads, draw) {
        written.transpose()?;
    }
    for drawing in drawings {
        if !drawing.together && views.len() > SHOWN {
            continue;
        }
        let own = if figures.is_empty() && first.is_empty() { &mut first } else { &mut figures };
        own.push(Figure::new(&drawing.canvas, drawing.caption, drawing.stem));
    }
    let near = compared.iter().flat_map(|one| [dug::warning(one), opened(one), near(one)]).flatten().collect();
    let tables = vec![overview(study, work.method, &compared)];
    page.opening.push(Block { list: near, figures: first, tables, ..Block::default() });
    page.opening.push(Block { figures, ..Block::default() });
    page.opening.extend(dug::block(found));
    page.opening.extend(reference::block(found));
    page.opening.extend(critical);
    if compared.len() <= SHOWN {
        page.opening.push(Block {
            heading: "Temperatures".into(),
            figures: compared.iter().flat_map(|one| maps(work, one)).collect(),
            ..Block::default()
        });
    }
    if compared.len() > SHOWN {
        page.opening.push(Block {
            text: vec![
                "Charts of the gaps (gaps_*) are files beside this page; maps lie in the folder of each layout.".into(),
            ],
            ..Block::default()
        });
    }
    page.opening.extend(methods_block(work, beside)?);
    page.opening.extend(what_if(study, found));
    page.opening.extend(study.search.as_ref().map(|search| searched(search, tried)));
    let list = assumptions(study, &compared);
    page.opening.push(Block { heading: "Assumptions".into(), list, ..Block::default() });
    Ok(page::write(&page, &work.folder.join("report.html"))?)
}

/// How many layouts there are, in words.
fn counted(runs: usize, horizons: usize) -> String {
    let layouts = match runs / horizons.max(1) {
        1 => "One layout".to_owned(),
        count => format!("{count} layouts"),
    };
    if horizons > 0 { format!("{layouts} at {horizons} horizons each") } else { layouts }
}

/// What figures show of a layout.
fn view<'a>(study: &Study, one: &Found<'_>, run: &'a RunResult) -> LayoutView<'a> {
    let scene = &one.layout.scene;
    let mut pipes = Vec::new();
    let mut missing = Vec::new();
    for (number, ring) in scene.rings.iter().enumerate() {
        for k in 0..ring.count {
            let place = ring.place(k);
            if ring.missing.contains(&k) {
                missing.push((place.x, place.y));
            } else {
                let name = format!("{}.{}", number + 1, k + 1);
                pipes.push(PipeView { name, x_m: place.x, y_m: place.y, radius_m: ring.pipe_radius });
            }
        }
    }
    // A place that is missing in one ring may be filled by another.
    let filled = |x: f64, y: f64| pipes.iter().any(|pipe| (pipe.x_m - x).hypot(pipe.y_m - y) < pipe.radius_m);
    missing.retain(|(x, y)| !filled(*x, *y));
    LayoutView {
        name: one.layout.name.clone(),
        pipes,
        missing,
        outer_radius_m: match scene.domain {
            Domain::Ring { outer_radius, .. } => outer_radius,
            _ => 0.0,
        },
        shaft_radius_m: scene.excavation.as_ref().map(|shaft| shaft.radius).or(study.shaft_radius),
        dug_s: scene.excavation.as_ref().map(|shaft| shaft.start),
        water: WaterMark::of(scene),
        result: run,
        load: one.fine.load.clone(),
        axis: one.pair.fine.axis.clone(),
        weakest_plane: one.pair.fine.weakest_plane.clone(),
        closure_s: one.fine.closure.map(|day| day * DAY),
        standing: one.fine.standing.iter().map(|(from, to)| (from * DAY, to.map(|day| day * DAY))).collect(),
        design: one.fine.design.map(|day| day * DAY),
        design_left: one.fine.design_left.map(|day| day * DAY),
        reference: reference::of_links(one),
    }
}

/// The maps that stand in a layout's folder.
fn maps(work: &Work<'_>, one: &Found<'_>) -> Vec<Figure> {
    let folder = work.folder_of(one.layout);
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let instants = one.fine.days.iter().map(|day| day.day);
    let figure = |kind: &str, words: &str, day: f64| {
        let stem = format!("{kind}_{day}d");
        let svg = fs::read_to_string(folder.join(format!("{stem}.svg"))).ok()?;
        let caption = format!("{}, day {day}{words}.", one.layout.name);
        Some(Figure { svg, caption, file: format!("layouts/{name}/{stem}") })
    };
    let water = ": pressure and velocity of the water";
    instants.flat_map(|day| [figure("map", "", day), figure("pressure", water, day)]).flatten().collect()
}

/// Layouts over their horizons, and what the shaft as a whole comes to.
fn over_depth(study: &Study, work: &Work<'_>, found: &[Found<'_>]) -> Result<Option<Block>, Failure> {
    let all = shafts(study, found);
    let compared: Vec<_> = all.iter().filter(|shaft| shaft.compared()).collect();
    if compared.is_empty() {
        return Ok(None);
    }
    let views: Vec<_> = compared.iter().map(|shaft| shaft.view(study)).collect();
    let drawing = frazil_plots::layouts::over_depth(&views);
    drawing.write(&work.folder, "depth")?;
    let caption = "Each horizon of the layouts; boreholes are read at the depth that stands in the table of horizons.";
    let figures = vec![Figure::new(&drawing, caption, "depth")];
    let heads =
        ["layout", "last to close", "wall closes (day)", "thinnest (m)", "warmest mean (°C)", "plant, greatest (kW)"];
    let heads = heads.into_iter().chain(["plant at the end (kW)", "energy (GJ)"]).map(String::from);
    let designed = study.layouts.iter().any(|layout| study.design_of(layout).is_some());
    let heads = heads.chain(designed.then(|| "as designed (day)".into())).collect();
    let row = |row: &ShaftRow<'_>| {
        let mut cells = vec![
            row.layout.to_owned(),
            row.weakest_horizon.to_owned(),
            stood(
                with_error(
                    row.closure_days,
                    row.closure_error_days,
                    2,
                    &format!("{} horizons open", row.open_horizons),
                ),
                row.reopened_days,
            ),
            format!("{:.2} in {}", row.thickness_weakest_m, row.thinnest_horizon),
            match row.warmest_horizon {
                Some(horizon) => format!("{} in {horizon}", cell(row.temperature_weakest_c, 2, "none")),
                None => "none".into(),
            },
            format!("{:.0}", row.plant_peak_kw),
            format!("{:.0}", row.plant_end_kw),
            format!("{:.0}", row.energy_gj),
        ];
        cells.extend(designed.then(|| designed_on(row.design_days, row.design_left_days)));
        cells
    };
    let rows: Vec<ShaftRow<'_>> = compared.iter().filter_map(|shaft| shaft.row(study, found)).collect();
    let shafts = Table {
        caption: "The shaft as a whole: closed once it is at all horizons; thickness and mean temperature where the wall is weakest; loads \
                  are sums over the layers. ± is the change from twice the spacing."
            .into(),
        heads,
        rows: rows.iter().map(row).collect(),
        words: 2,
        csv: Some("shafts.csv".into()),
    };
    let horizons = Table {
        caption: "Horizons.".into(),
        heads: ["horizon", "from (m)", "to (m)", "boreholes read at (m)"].map(String::from).into(),
        rows: study
            .horizons
            .iter()
            .map(|horizon| {
                let depths = [horizon.from, horizon.to, horizon.depth].map(|depth| depth.to_string());
                [vec![horizon.name.clone()], depths.into()].concat()
            })
            .collect(),
        words: 1,
        csv: None,
    };
    let heading = "The shaft over its depth".into();
    Ok(Some(Block { heading, figures, tables: vec![shafts, horizons], ..Block::default() }))
}

/// The same layouts under several methods.
fn methods_block(work: &Work<'_>, beside: &[Beside<'_>]) -> Result<Option<Block>, Failure> {
    if beside.is_empty() {
        return Ok(None);
    }
    let views: Vec<_> = beside.iter().map(Beside::view).collect();
    let drawing = frazil_plots::layouts::methods(&views);
    drawing.write(&work.folder, "methods")?;
    let caption = "Day of closure, thickness and mean temperature where the wall is weakest, and load at the end, as each method has them.";
    let figures = vec![Figure::new(&drawing, caption, "methods")];
    let heads = ["layout", "methods", "wall closes (day)", "thickness (m)", "mean temperature (°C)", "load (W/m)"];
    let row = |one: &Beside<'_>| {
        let all = one.answers();
        let names: Vec<&str> = all.iter().map(|(method, _)| *method).collect();
        let span = |k: usize, digits: usize| match one.range()[k] {
            Some((least, most)) => {
                let open = all.iter().filter(|(_, answers)| answers[k].is_none()).count();
                let open = if open > 0 { format!(", {open} not closed") } else { String::new() };
                format!("{least:.digits$} to {most:.digits$} ({:.digits$} apart{open})", most - least)
            }
            None => "none, or of one method".into(),
        };
        vec![one.layout.name.clone(), names.join(", "), span(0, 2), span(1, 2), span(2, 2), span(3, 0)]
    };
    let table = Table {
        caption: "How far the answers of the methods lie apart.".into(),
        heads: heads.map(String::from).into(),
        rows: beside.iter().map(row).collect(),
        words: 2,
        csv: Some("methods.csv".into()),
    };
    let refusals = beside.iter().flat_map(|one| {
        one.refusals().map(|(method, reason)| format!("{} does not run under {method}: {reason}.", one.layout.name))
    });
    let (heading, list) = ("Methods beside each other".into(), refusals.collect());
    Ok(Some(Block { heading, figures, tables: vec![table], list, ..Block::default() }))
}

/// What changes of one key and deviating boreholes do.
fn what_if(study: &Study, found: &[Found<'_>]) -> Vec<Block> {
    let mut blocks = Vec::new();
    let changes: Vec<_> = found.iter().filter_map(|one| tables::change(found, one)).collect();
    if !changes.is_empty() {
        let row = |row: &tables::SensitivityRow<'_>| {
            vec![
                row.layout.to_owned(),
                row.key.to_owned(),
                format!("{:.2}", row.factor),
                cell(row.closure_days, 2, "not closed"),
                signed(row.closure_change_days, 2),
                signed(row.thickness_change_m, 2),
                signed(row.mean_temperature_change_k, 2),
                signed(row.energy_change_mj_per_m, 0),
            ]
        };
        let heads =
            ["layout", "key", "factor", "wall closes (day)", "closure (d)", "thickness (m)", "mean temperature (K)"];
        let heads = heads.into_iter().chain(["energy (MJ/m)"]).map(String::from).collect();
        let caption = "Changes against the layout itself; thickness and temperature where the wall is weakest, and energy, at the end.".into();
        let csv = Some("sensitivity.csv".into());
        let table = Table { caption, heads, rows: changes.iter().map(row).collect(), words: 2, csv };
        blocks.push(Block { heading: "Sensitivity".into(), tables: vec![table], ..Block::default() });
    }
    let spreads = tables::spreads(study, found);
    if !spreads.is_empty() {
        let row = |row: &tables::DeviationRow<'_>| {
            vec![
                row.layout.to_owned(),
                row.members.to_string(),
                if row.reopened > 0 {
                    format!("{}, {} OPEN AGAIN", row.closed, row.reopened)
                } else {
                    row.closed.to_string()
                },
                cell(row.closure_p05_days, 2, "not closed"),
                cell(row.closure_p50_days, 2, "not closed"),
                cell(row.closure_p95_days, 2, "not closed"),
            ]
        };
        let heads = ["layout", "members", "closed", "5 % close by (day)", "half close by (day)", "95 % close by (day)"];
        let heads = heads.map(String::from).into();
        let caption = "Boreholes that end anywhere in a circle around their places.".into();
        let csv = Some("deviation.csv".into());
        let table = Table { caption, heads, rows: spreads.iter().map(row).collect(), words: 1, csv };
        blocks.push(Block { heading: "Deviating boreholes".into(), tables: vec![table], ..Block::default() });
    }
    blocks
}

/// What a search has tried.
fn searched(search: &Search, tried: &[Tried]) -> Block {
    let row = |one: &Tried| {
        let in_time = if one.least { "the best" } else { "yes" };
        let words = if one.in_time { in_time } else { "no" };
        let mut cells = vec![
            number(one.value, 5),
            stood(cell(one.closure_days, 2, "not closed"), one.reopened_days),
            format!("{:.0}", one.energy_mj_per_m),
            words.to_owned(),
        ];
        if search.design_days.is_some() {
            cells.insert(2, designed_on(one.design_days, one.design_left_days));
        }
        cells
    };
    let energy = format!("energy to day {} (MJ/m)", search.last_day());
    let mut heads = vec![search.key.clone(), "wall closes (day)".into(), energy, "in time".into()];
    if search.design_days.is_some() {
        heads.insert(2, "as designed (day)".into());
    }
    let table = Table {
        caption: format!("{}.", search::words(search, tried)),
        heads,
        rows: tried.iter().map(row).collect(),
        words: 0,
        csv: Some("search.csv".into()),
    };
    Block { heading: "Search".into(), tables: vec![table], ..Block::default() }
}

fn signed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:+.digits$}"))
}

/// A number, or what stands in its place.
pub(super) fn cell(value: Option<f64>, digits: usize, none: &str) -> String {
    value.map_or_else(|| none.to_owned(), |value| format!("{value:.digits$}"))
}

/// When a wall closed, and that it opened again.
fn stood(closed: String, reopened: Option<f64>) -> String {
    reopened.map_or_else(|| closed.clone(), |day| format!("{closed}, OPENS AGAIN on {day:.2}"))
}

/// When a wall was as designed, and when no more.
fn designed_on(design: Option<f64>, left: Option<f64>) -> String {
    let from = cell(design, 1, "never");
    left.map_or_else(|| from.clone(), |day| format!("{from}, NO MORE from {day:.1}"))
}

/// A warning where a wall opens again.
fn opened(one: &Found<'_>) -> Option<String> {
    let opens = one.fine.reopening?;
    let ends = if one.fine.closed { "closed again at the end" } else { "open at the end" };
    Some(format!("{}: the wall OPENS AGAIN on day {opens:.2} and is {ends}.", one.layout.name))
}

/// A number and how far off it may be.
fn with_error(value: Option<f64>, error: Option<f64>, digits: usize, none: &str) -> String {
    let error = value.and(error).map_or(String::new(), |error| format!(" ± {error:.digits$}"));
    format!("{}{error}", cell(value, digits, none))
}

/// A row for each layout: what is asked first.
fn overview(study: &Study, method: &str, compared: &[&Found<'_>]) -> Table {
    let mut heads: Vec<String> = [
        "layout",
        "weakest gap",
        "pipes",
        "wall closes (day)",
        "first gap (day)",
        "thickness at the end (m)",
        "mean temperature there (°C)",
        "thickness, mean over the ring (m)",
        "all frozen ground, mean (°C)",
        "load, greatest (W/m)",
        "load at the end (W/m)",
        "energy (MJ/m)",
    ]
    .map(String::from)
    .into();
    let designs: Vec<Option<Design>> = compared.iter().map(|one| study.design_of(one.layout)).collect();
    let designed = designs.iter().flatten().next();
    if let Some(design) = designed {
        let alike = designs.iter().all(|own| own.as_ref() == Some(design));
        let words = format!("{} m at {} °C (day)", design.thickness_m, design.mean_temperature_c);
        heads.push(if alike { words } else { "as designed (day)".into() });
    }
    let single = |one: &&Found<'_>| one.layout.scene.rings.iter().any(|ring| ring.one_particle);
    let acting = compared.iter().any(single);
    if acting {
        heads.push("pipes act as (mm)".into());
    }
    if compared.iter().any(|one| study.depth_of(one.layout).is_some()) {
        heads.push("plant, greatest (kW)".into());
    }
    let row = |one: &&Found<'_>| {
        let (fine, coarse) = (&one.fine, one.coarse.as_ref());
        let (end, far) = (fine.days.last(), coarse.and_then(|coarse| coarse.days.last()));
        let off = |own: Option<f64>, other: Option<f64>| own.zip(other).map(|(own, other)| (own - other).abs());
        let thickness = end.map(|day| day.thickness_weakest_m);
        let mean = end.and_then(|day| day.temperature_weakest_c);
        let weakest = fine
            .weakest
            .as_ref()
            .map_or("none".into(), |link| format!("{} to {}, {:.2} m", link.from, link.to, link.distance_m));
        let mut cells = vec![
            one.layout.name.clone(),
            weakest,
            fine.pipes.to_string(),
            stood(with_error(fine.closure, tables::closure_error(one), 2, "not closed"), fine.reopening),
            cell(fine.first_gap, 2, "none"),
            with_error(thickness, off(thickness, far.map(|day| day.thickness_weakest_m)), 2, ""),
            with_error(mean, off(mean, far.and_then(|day| day.temperature_weakest_c)), 2, "open"),
            cell(end.map(|day| day.thickness_interface_mean_m), 2, ""),
            cell(end.and_then(|day| day.mean_c), 2, "none"),
            format!("{:.0}", fine.peak),
            cell(end.map(|day| day.heat_per_pipe_w_per_m * fine.pipes as f64), 0, ""),
            cell(end.map(|day| day.energy_mj_per_m), 0, ""),
        ];
        if designed.is_some() {
            cells.push(designed_on(fine.design, fine.design_left));
        }
        if acting {
            cells.push(format!("{:.3}", 1e3 * reference::effective_radius(&one.layout.scene, method)));
        }
        if let Some(depth) = study.depth_of(one.layout) {
            cells.push(format!("{:.0}", 1e-3 * depth * fine.peak));
        }
        cells
    };
    Table {
        caption:
            "± is the change from twice the spacing, not a bound. Thickness is the frozen length on the least frozen way through the wall, at the \
             weakest gap, 0 while it is open, and the mean temperature is that on this way; means over planes midway between pipes and of \
             all frozen ground stand beside them. Loads and energy by metre of depth, greatest after the first day."
                .into(),
        heads,
        rows: compared.iter().map(row).collect(),
        words: 2,
        csv: Some("layouts.csv".into()),
    }
}

/// A warning where the outer wall is too near.
fn near(one: &Found<'_>) -> Option<String> {
    let far = one.fine.far.filter(Far::matters)?;
    let said = if far.share > 0.0 {
        format!("{:.0} % of the heat that pipes took came through it", 100.0 * far.share)
    } else {
        format!("ground at it has gone {:.0} % of the way to the freezing point", 100.0 * far.cooled)
    };
    Some(format!(
        "{}: the outer wall is too near: {said} by the end, so load and thickness are off by more than some 1 %. A larger \
         domain.ring.outer_radius_m mends it.",
        one.layout.name
    ))
}

/// What holds for all layouts, and which part of the plan each was run on.
fn assumptions(study: &Study, compared: &[&Found<'_>]) -> Vec<String> {
    let single = |one: &&Found<'_>| one.layout.scene.rings.iter().any(|ring| ring.one_particle);
    let (some, all) = (compared.iter().any(single), compared.iter().all(single));
    let mut facts = Vec::new();
    if !all {
        facts.push("Pipes are circles of their true radius, held at the temperature of their outer wall.".to_owned());
    }
    if some {
        facts.push(
            "A pipe of one particle acts as a thin one, of a radius that method and spacing give: finer particles close later."
                .to_owned(),
        );
    }
    if !study.source.is_empty() {
        facts.insert(0, format!("Source: {}.", study.source));
    }
    for one in compared {
        facts.push(format!("{}: run on {}.", one.layout.name, one.layout.sector));
        if let Some((mean, heat)) = one.fine.formula {
            let end = one.fine.days.last();
            facts.push(format!(
                "{}: mean temperature {} °C and {} W/m a pipe at the end; the steady ring in closed form with the same fronts \
                 has {mean:.2} °C and {heat:.1} W/m.",
                one.layout.name,
                cell(end.and_then(|day| day.mean_c), 2, "none"),
                cell(end.map(|day| day.heat_per_pipe_w_per_m), 1, "none"),
            ));
        }
        if let Some(reason) = &one.pair.refused {
            facts.push(format!("{}: what the spacing changes is not known: {reason}.", one.layout.name));
        }
    }
    facts
}
