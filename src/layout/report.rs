//! The page of a study: layouts beside each other, figures first.

use std::fs;

use frazil_core::space::domain::Domain;
use frazil_plots::canvas::Formats;
use frazil_plots::layouts::{self, LayoutView, PipeView, drawings};
use frazil_plots::page::{self, Block, Fact, Figure, Page, Table};
use frazil_plots::style::number;
use frazil_record::RunResult;
use frazil_studies::failure::Failure;
use frazil_studies::{figure_options, parallel};

use super::answers::{DAY, Far};
use super::execute::Work;
use super::found::Found;
use super::goals::Search;
use super::methods::Beside;
use super::rows::{cell, designed_on, stood};
use super::search::{self, Tried};
use super::study::Study;
use super::variants::Role;
use super::{dug, reference};

mod answer;
mod depth;
mod overview;
mod vary;

use answer::answers;
use depth::over_depth;
use overview::overview;
use vary::what_if;

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
    pub(super) critical: Vec<Block>,
}

/// Writes figures and page.
pub(super) fn write(command: &str, study: &Study<'_>, work: &Work<'_>, told: Told<'_>) -> Result<(), Failure> {
    let Told { found, tried, beside, .. } = told;
    let compared: Vec<&Found<'_>> = found.iter().filter(|one| one.layout.role == Role::Compared).collect();
    let mut page = Page {
        title: study.title.clone(),
        lead: vec![format!(
            "{} of freeze pipes under the method {}, from the scene {}. A gap is closed once ground between two pipes is frozen \
             with its latent heat released; the wall once a closed loop of such gaps runs around the centre.",
            counted(compared.len(), study.ground.strata.len()),
            work.method,
            study.ground.scene
        )],
        answers: answers(study, &told, &compared),
        command: command.to_owned(),
        machine: work.machine.facts(Fact::new("Layouts at once", work.threads.to_string())),
        ..Page::default()
    };
    page.opening.extend(over_depth(study, work, found)?);
    let run = |one: &&Found<'_>| RunResult { front_lines: one.pair.front_lines.clone(), ..one.pair.fine.run() };
    let runs: Vec<RunResult> = compared.iter().map(run).collect();
    let views: Vec<LayoutView<'_>> = compared.iter().zip(&runs).map(|(one, run)| view(study, one, run)).collect();
    page.plan = layouts::days(&views);
    let freezing = compared.first().map_or(0.0, |one| one.layout.scene.materials[0].freezing_point);
    let (mut first, mut figures) = (Vec::new(), Vec::new());
    let drawings = drawings(&views, freezing);
    let draw = |k: usize| Some(drawings[k].canvas.write(&work.folder, &drawings[k].stem, Formats::ALL));
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
    page.opening.extend(told.critical);
    if compared.len() <= SHOWN {
        page.opening.push(Block {
            heading: "Temperatures".into(),
            text: vec!["At the last instant; maps of the others lie in the folder of each layout.".into()],
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
fn counted(runs: usize, strata: usize) -> String {
    let layouts = match runs / strata.max(1) {
        1 => "One layout".to_owned(),
        count => format!("{count} layouts"),
    };
    if strata > 0 { format!("{layouts} in {strata} strata each") } else { layouts }
}

/// What figures show of a layout.
fn view<'a>(study: &Study<'_>, one: &Found<'_>, run: &'a RunResult) -> LayoutView<'a> {
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
        water: figure_options::water(scene, &run.fields),
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

/// The last maps that stand in a layout's folder: all of them would be most of the page.
fn maps(work: &Work<'_>, one: &Found<'_>) -> Vec<Figure> {
    let folder = work.folder_of(one.layout);
    let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let last = one.fine.days.last().map(|day| day.day);
    let figure = |kind: &str, words: &str, day: f64| {
        let stem = format!("{kind}_{day}d");
        let svg = fs::read_to_string(folder.join(format!("{stem}.svg"))).ok()?;
        let caption = format!("{}, day {day}{words}.", one.layout.name);
        Some(Figure { svg, caption, file: format!("layouts/{name}/{stem}") })
    };
    let water = ": pressure and velocity of the water";
    last.into_iter().flat_map(|day| [figure("map", "", day), figure("pressure", water, day)]).flatten().collect()
}

/// The same layouts under several methods.
fn methods_block(work: &Work<'_>, beside: &[Beside<'_>]) -> Result<Option<Block>, Failure> {
    if beside.is_empty() {
        return Ok(None);
    }
    let views: Vec<_> = beside.iter().map(Beside::view).collect();
    let drawing = layouts::methods(&views);
    drawing.write(&work.folder, "methods", Formats::ALL)?;
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

/// What a search has tried.
fn searched(search: &Search, tried: &[Tried]) -> Block {
    let row = |one: &Tried| {
        let in_time = if one.least { "the best" } else { "yes" };
        let words = if one.in_time { in_time } else { "no" };
        let mut cells = vec![
            number(one.value, 5),
            number(one.spacing_m, 3),
            stood(cell(one.closure_days, 2, "not closed"), one.reopened_days),
            format!("{:.0}", one.energy_mj_per_m),
            words.to_owned(),
        ];
        if search.design_days.is_some() {
            cells.insert(3, designed_on(one.design_days, one.design_left_days));
        }
        cells
    };
    let energy = format!("energy to day {} (MJ/m)", search.last_day());
    let mut heads =
        vec![search.key.clone(), "spacing (m)".into(), "wall closes (day)".into(), energy, "in time".into()];
    if search.design_days.is_some() {
        heads.insert(3, "as designed (day)".into());
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

/// A warning where a wall opens again.
fn opened(one: &Found<'_>) -> Option<String> {
    let opens = one.fine.reopening?;
    let ends = if one.fine.closed { "closed again at the end" } else { "open at the end" };
    Some(format!("{}: the wall OPENS AGAIN on day {opens:.2} and is {ends}.", one.layout.name))
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
fn assumptions(study: &Study<'_>, compared: &[&Found<'_>]) -> Vec<String> {
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
