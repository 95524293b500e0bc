//! The table and the page.

use std::fs;
use std::path::Path;

use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection, Table};
use frazil_plots::style::number;
use frazil_studies::failure::Failure;
use frazil_studies::machine::Machine;
use frazil_studies::output::write_rows;
use serde::Serialize;

use super::item::{Atlas, Judged, Outcome, Paper};
use crate::process_runs::ManyRuns;

/// A row of `atlas.csv`.
#[derive(Debug, Serialize)]
struct CsvRow<'a> {
    paper: &'a str,
    place: &'a str,
    item: &'a str,
    command: String,
    quantity: &'a str,
    value: Option<f64>,
    printed: Option<f64>,
    reference: Option<f64>,
    within_rel: Option<f64>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    outcome: &'static str,
    why: String,
}

/// Writes both.
pub(super) fn write(
    request: &ManyRuns,
    folder: &Path,
    atlas: &Atlas,
    judged: &[Vec<Judged<'_>>],
) -> Result<(), Failure> {
    let papers = || atlas.papers.iter().zip(judged);
    let rows = papers().flat_map(|(paper, rows)| rows.iter().map(|one| csv_row(atlas, paper, one)));
    write_rows(&folder.join("atlas.csv"), &rows.collect::<Vec<_>>())?;
    let page = Page {
        title: "What the papers show, and what frazil finds".into(),
        answers: vec![format!("{}.", counts(judged.iter().flatten()))],
        lead: vec![
            "Each row is something that a paper shows: where, its number if it prints one, what frazil finds, and an independent \
             solution where there is one. A row is held to the reference, or to what is printed where there is none; bounds and \
             differences have their reasons beside them. Pictures are of the same runs."
                .into(),
        ],
        command: request.command_line.clone(),
        scenes: papers().map(|(paper, rows)| section(folder, atlas, paper, rows)).collect(),
        machine: Machine::now().facts(Fact::new("Threads of each run", request.threads.to_string())),
        ..Page::default()
    };
    Ok(page::write(&page, &folder.join("report.html"))?)
}

/// How many rows stand how.
pub(super) fn counts<'a, 'b: 'a>(judged: impl Iterator<Item = &'a Judged<'b>>) -> String {
    let (mut all, mut agree, mut differ, mut none, mut missing) = (0, 0, 0, 0, 0);
    for one in judged {
        all += 1;
        match one.outcome {
            Outcome::Agrees => agree += 1,
            Outcome::Differs => differ += 1,
            Outcome::NoNumber => none += 1,
            Outcome::Missing(_) => missing += 1,
        }
    }
    let lacks = if missing > 0 { format!(", {missing} without their run") } else { String::new() };
    format!("{all} rows: {agree} pass, {differ} fail, {none} without a number (reason given){lacks}")
}

fn command(atlas: &Atlas, one: &Judged<'_>) -> String {
    atlas.run_of(one.row).map_or(String::new(), |run| format!("frazil {}", run.command))
}

fn why(one: &Judged<'_>) -> String {
    match &one.outcome {
        Outcome::Missing(cause) => format!("{cause}. {}", one.row.why).trim_end().to_owned(),
        _ => one.row.why.clone(),
    }
}

fn csv_row<'a>(atlas: &Atlas, paper: &'a Paper, one: &'a Judged<'_>) -> CsvRow<'a> {
    CsvRow {
        paper: &paper.key,
        place: &one.row.place,
        item: &one.row.item,
        command: command(atlas, one),
        quantity: &one.row.quantity,
        value: one.value,
        printed: one.row.printed,
        reference: one.reference,
        within_rel: one.row.within,
        at_most: one.row.at_most,
        at_least: one.row.at_least,
        outcome: one.outcome.word(),
        why: why(one),
    }
}

/// What a paper shows: its figures, and its rows.
fn section(folder: &Path, atlas: &Atlas, paper: &Paper, rows: &[Judged<'_>]) -> SceneSection {
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| number(value, 4));
    let bound = |one: &Judged<'_>| {
        let row = one.row;
        let bounds = [
            row.within.map(|within| format!("within {} %", number(100.0 * within, 3))),
            row.at_most.map(|most| format!("at most {}", number(most, 3))),
            row.at_least.map(|least| format!("at least {}", number(least, 3))),
        ];
        bounds.into_iter().flatten().collect::<Vec<_>>().join(", ")
    };
    let cells = |one: &Judged<'_>| {
        vec![
            one.row.place.clone(),
            one.row.item.clone(),
            one.row.quantity.clone(),
            one.outcome.word().to_owned(),
            why(one),
            cell(one.value),
            cell(one.row.printed),
            cell(one.reference),
            bound(one),
        ]
    };
    let heads = ["where", "what", "quantity", "outcome", "why", "frazil", "printed", "reference", "bound"];
    let table = Table {
        caption: counts(rows.iter()) + ".",
        heads: heads.map(Into::into).into(),
        rows: rows.iter().map(cells).collect(),
        words: 5,
        csv: Some("atlas.csv".into()),
    };
    let named: Vec<&str> = rows.iter().filter_map(|one| one.row.run.as_deref()).collect();
    let mut figures = Vec::new();
    let mut commands: Vec<String> = Vec::new();
    for run in atlas.runs.iter().filter(|run| named.contains(&run.name.as_str())) {
        commands.push(format!("frazil {}", run.command));
        for name in &run.figures {
            let file = format!("runs/{}/{name}", run.name);
            if let Ok(svg) = fs::read_to_string(folder.join(format!("{file}.svg"))) {
                figures.push(Figure { svg, caption: format!("frazil {}", run.command), file });
            }
        }
    }
    let table = Block { tables: vec![table], ..Block::default() };
    let pictures = Block { heading: "Pictures".into(), figures, ..Block::default() };
    let runs = Block { heading: "Commands".into(), list: commands, folded: true, ..Block::default() };
    SceneSection {
        name: paper.key.clone(),
        title: paper.title.clone(),
        blocks: vec![table, pictures, runs],
        svg_alone: true,
        ..SceneSection::default()
    }
}
