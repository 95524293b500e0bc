//! The table and the page.

use std::path::Path;
use std::{fmt, fs};

use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection, Table};
use frazil_plots::style::number;
use frazil_studies::failure::Failure;
use frazil_studies::machine::Machine;
use frazil_studies::output::write_rows;
use serde::Serialize;

use super::item::{Atlas, Judged, Outcome, Paper};
use crate::process_runs::ManyRuns;

const TITLE: &str = "What the papers show, and what frazil finds";

const LEAD: &str = "Each row is something that a paper shows: where, its number if it prints one, what frazil finds, and an independent \
                    solution where there is one. A row is held to the reference, or to what is printed where there is none; bounds and \
                    differences have their reasons beside them. Pictures are of the same runs.";

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

/// How many rows stand how.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    all: usize,
    pass: usize,
    fail: usize,
    without_number: usize,
    missing: usize,
}

impl Counts {
    pub(super) fn of<'a, 'b: 'a>(judged: impl IntoIterator<Item = &'a Judged<'b>>) -> Self {
        let mut counts = Counts::default();
        for one in judged {
            counts.all += 1;
            *match one.outcome {
                Outcome::Agrees => &mut counts.pass,
                Outcome::Differs => &mut counts.fail,
                Outcome::NoNumber => &mut counts.without_number,
                Outcome::Missing(_) => &mut counts.missing,
            } += 1;
        }
        counts
    }

    /// Words of a row of a table, under `HEADS`.
    fn cells(&self) -> impl Iterator<Item = String> {
        [self.all, self.pass, self.fail, self.without_number, self.missing].map(|count| count.to_string()).into_iter()
    }

    const HEADS: [&'static str; 5] = ["rows", "pass", "fail", "without a number", "without their run"];
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Counts { all, pass, fail, without_number, missing } = self;
        write!(f, "{all} rows: {pass} pass, {fail} fail, {without_number} without a number (reason given)")?;
        if *missing > 0 { write!(f, ", {missing} without their run") } else { Ok(()) }
    }
}

/// Writes the table and the page of a paper, or of several papers a page each and one that leads to them.
pub(super) fn write(
    request: &ManyRuns,
    folder: &Path,
    atlas: &Atlas,
    judged: &[Vec<Judged<'_>>],
) -> Result<(), Failure> {
    let papers = || atlas.papers.iter().zip(judged);
    let rows = papers().flat_map(|(paper, rows)| rows.iter().map(|one| csv_row(atlas, paper, one)));
    write_rows(&folder.join("atlas.csv"), &rows.collect::<Vec<_>>())?;
    let all = Page {
        title: TITLE.into(),
        answers: vec![format!("{}.", Counts::of(judged.iter().flatten()))],
        lead: vec![LEAD.into()],
        command: request.command_line.clone(),
        machine: Machine::now().facts(Fact::new("Threads of each run", request.threads.to_string())),
        ..Page::default()
    };
    if let [paper] = &atlas.papers[..] {
        let scenes = vec![section(folder, atlas, paper, &judged[0])];
        return Ok(page::write(&Page { scenes, ..all }, &folder.join("report.html"))?);
    }
    for (paper, rows) in papers() {
        let own = Page {
            answers: vec![format!("{}.", Counts::of(rows))],
            command: format!("frazil atlas {}", paper.key),
            opening: vec![Block { links: vec![Fact::new("All papers", "report.html")], ..Block::default() }],
            scenes: vec![section(folder, atlas, paper, rows)],
            ..all.clone()
        };
        page::write(&own, &folder.join(file(paper)))?;
    }
    let opening = vec![overview(atlas, judged), failing(atlas, judged)];
    Ok(page::write(&Page { opening, ..all }, &folder.join("report.html"))?)
}

/// The page of a paper among several.
fn file(paper: &Paper) -> String {
    format!("{}.html", paper.key)
}

/// All papers, with links to their pages.
fn overview(atlas: &Atlas, judged: &[Vec<Judged<'_>>]) -> Block {
    let papers = || atlas.papers.iter().zip(judged);
    let row = |(paper, rows): (&Paper, &Vec<Judged<'_>>)| {
        [paper.key.clone()].into_iter().chain(Counts::of(rows).cells()).collect()
    };
    let heads = ["paper"].into_iter().chain(Counts::HEADS);
    let table = Table {
        caption: "How the rows of each paper stand.".into(),
        heads: heads.map(Into::into).collect(),
        rows: papers().map(row).collect(),
        words: 1,
        csv: Some("atlas.csv".into()),
    };
    let link = |(paper, _): (&Paper, _)| Fact::new(format!("{}: {}", paper.key, paper.title), file(paper));
    Block {
        heading: "Papers".into(),
        text: vec!["Rows and pictures of each paper are on a page of its own.".into()],
        links: papers().map(link).collect(),
        tables: vec![table],
        ..Block::default()
    }
}

/// Rows that fail, or lack their run.
fn failing(atlas: &Atlas, judged: &[Vec<Judged<'_>>]) -> Block {
    let of_paper = |(paper, rows): (&Paper, &Vec<Judged<'_>>)| -> Vec<Vec<String>> {
        let fails = rows.iter().filter(|one| matches!(one.outcome, Outcome::Differs | Outcome::Missing(_)));
        fails.map(|one| [paper.key.clone()].into_iter().chain(cells(one)).collect()).collect()
    };
    let heads = ["paper"].into_iter().chain(HEADS);
    let table = Table {
        caption: "Rows that fail, with the reason as far as it is known.".into(),
        heads: heads.map(Into::into).collect(),
        rows: atlas.papers.iter().zip(judged).flat_map(of_paper).collect(),
        words: 6,
        csv: Some("atlas.csv".into()),
    };
    Block { heading: "Rows that fail".into(), tables: vec![table], ..Block::default() }
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

/// Heads of the cells of a row.
const HEADS: [&str; 9] = ["where", "what", "quantity", "outcome", "why", "frazil", "printed", "reference", "bound"];

/// What a row says.
fn cells(one: &Judged<'_>) -> [String; 9] {
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| number(value, 4));
    let row = one.row;
    let bounds = [
        row.within.map(|within| format!("within {} %", number(100.0 * within, 3))),
        row.at_most.map(|most| format!("at most {}", number(most, 3))),
        row.at_least.map(|least| format!("at least {}", number(least, 3))),
    ];
    [
        row.place.clone(),
        row.item.clone(),
        row.quantity.clone(),
        one.outcome.word().to_owned(),
        why(one),
        cell(one.value),
        cell(row.printed),
        cell(one.reference),
        bounds.into_iter().flatten().collect::<Vec<_>>().join(", "),
    ]
}

/// What a paper shows: its figures, and its rows.
fn section(folder: &Path, atlas: &Atlas, paper: &Paper, rows: &[Judged<'_>]) -> SceneSection {
    let table = Table {
        caption: format!("{}.", Counts::of(rows)),
        heads: HEADS.map(Into::into).into(),
        rows: rows.iter().map(|one| cells(one).into()).collect(),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_papers_have_pages_of_their_own_and_one_that_leads_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let request =
            ManyRuns { chosen: Vec::new(), out: None, threads: 1, command_line: "frazil atlas".into(), quiet: true };
        let mut atlas = Atlas::read().expect("it is read");
        let written = |atlas: &Atlas| -> String {
            let papers = atlas.papers.iter();
            let judged: Vec<Vec<Judged<'_>>> =
                papers.map(|paper| paper.rows.iter().map(|row| row.judge(folder.path())).collect()).collect();
            write(&request, folder.path(), atlas, &judged).expect("it is written");
            fs::read_to_string(folder.path().join("report.html")).expect("a page")
        };
        let all = written(&atlas);
        for paper in &atlas.papers {
            let link = format!("<a href=\"{0}.html\">{0}: ", paper.key);
            assert!(all.contains(&link), "{link}");
            let own = fs::read_to_string(folder.path().join(file(paper))).expect("a page");
            assert!(own.contains("<a href=\"report.html\">All papers</a>"), "{}", paper.key);
            assert!(own.contains(&format!("frazil atlas {}", paper.key)));
        }
        // No run has been made: each row with a number lacks it.
        assert!(all.contains("Rows that fail") && all.contains("without their run"));
        atlas.papers.truncate(1);
        let one = written(&atlas);
        assert!(!one.contains("All papers") && one.contains(&atlas.papers[0].rows[0].item));
    }
}
