//! Layouts of freeze pipes beside each other: when the wall closes, how thick and cold it is, and at what load.
//!
//! A study goes one way: layouts, each a scene; their runs, each whole in a folder of its own and kept by a campaign; then
//! tables, figures and one page of what is kept. So layouts known before, from other shards and just run are the same.

use std::path::{Path, PathBuf};

pub use dug::beside_open;

use crate::campaign::{Campaign, Shard};
use crate::failure::{Failure, Verdict, answer, complain};
use crate::machine::Machine;
use crate::output::Folder;
use crate::progress::forewarn;
use crate::{interrupt, load, output, parallel};

mod ahead;
pub mod answers;
pub mod around;
pub mod boreholes;
mod check;
pub mod critical;
pub mod doubts;
mod dug;
pub mod execute;
pub mod formula;
pub mod horizons;
mod methods;
pub mod reference;
pub mod report;
pub mod search;
pub mod shaft;
pub(crate) mod soils;
pub mod study;
pub mod tables;
pub mod variants;

use ahead::Ahead;
use answers::Answers;
use execute::{Pair, Work};
use reference::Compared;
use variants::Layout;

/// What is to be studied.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutRequest {
    /// Study, by path or bundled name.
    pub study: String,
    /// Method; the study's, or the first of the scene, if absent.
    pub method: Option<String>,
    /// Pairs of key path and value that override the scene of all layouts.
    pub overrides: Vec<(String, String)>,
    /// Layouts that run at once.
    pub threads: usize,
    /// Which part of the layouts is to be run.
    pub shard: Shard,
    /// Whether only to say what would be run.
    pub check: bool,
    /// Whether to draw frames of an animation.
    pub frames: bool,
    /// Folder for the results; `out/<study>` if absent.
    pub out: Option<PathBuf>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}

/// A layout and what is known of it.
pub struct Found<'a> {
    /// The layout.
    pub layout: &'a Layout,
    /// Its runs.
    pub pair: Pair,
    /// What they say.
    pub fine: Answers,
    /// The same at twice the spacing.
    pub coarse: Option<Answers>,
    /// What it is compared with.
    pub reference: Option<Compared>,
}

/// Runs layouts and sets them beside each other.
pub fn layout(request: &LayoutRequest) -> Result<Verdict, Failure> {
    let study = study::read(&request.study, &request.overrides)?;
    let Some(first) = study.layouts.first() else { return Ok(Verdict::Done) };
    let all = request.method.as_deref() == Some(methods::ALL);
    let asked = request.method.as_deref().filter(|_| !all).or(study.method.as_deref());
    let method = load::method(&first.scene, asked)?;
    let mut references = Vec::new();
    for layout in &study.layouts {
        layout.check(study.shaft_radius, method)?;
        references.push(reference::table(&study, layout, method, &request.overrides)?);
    }
    if let Some(wanted) = &study.search {
        search::check(&study, wanted, method)?;
    }
    if let Some(wanted) = &study.critical {
        critical::check(&study, wanted, method)?;
    }
    for doubt in doubts::of(&study) {
        complain(&format!("warning: {doubt}"));
    }
    // Under all methods, one is that of the tables and figures, and the others stand beside it.
    let others = first.scene.methods.iter().map(|settings| settings.method).filter(|other| all && *other != method);
    let methods: Vec<&'static str> = std::iter::once(method).chain(others).collect();
    if request.check {
        check::print(&study, &methods, request.threads)?;
        return Ok(Verdict::Done);
    }
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join(&study.name));
    let folder = Folder::make(&path)?;
    let campaign = Campaign::open(&path, request.shard, request.threads, interrupt::watch())?;
    let machine = Machine::now();
    let work_of = |method: &'static str, beside: bool| Work {
        study: &study,
        method,
        beside,
        folder: if beside { path.join("methods").join(method) } else { path.clone() },
        campaign: &campaign,
        threads: request.threads,
        shard: request.shard,
        frames: request.frames,
        quiet: request.quiet,
        machine: machine.clone(),
    };
    let works: Vec<Work<'_>> = methods.iter().map(|own| work_of(own, *own != method)).collect();
    if !request.quiet {
        let ahead = if works[0].is_last() { ahead::open(&works[0])? } else { Ahead::default() };
        complain(check::heading(&study, &methods, &ahead).trim_end());
        let named: f64 = works.iter().filter_map(Work::seconds).sum();
        forewarn(&study.name, Some(named + ahead.wall_s));
    }
    let mut made = Some(0);
    for work in &works {
        made = match work.make() {
            Ok(made) => made,
            Err(failure) => {
                folder.take_back();
                return Err(failure);
            }
        };
        if made.is_none() {
            break;
        }
    }
    let work = &works[0];
    let known = |k: usize| {
        let layout = &study.layouts[k];
        let pair = work.kept(layout)?;
        let design = study.design_of(layout);
        let fine = Answers::of(&layout.scene, &pair.fine, design);
        let coarse = pair.coarse.as_ref().map(|kept| Answers::of(&layout.scene, kept, design));
        Some(Found { layout, pair, fine, coarse, reference: references[k].clone() })
    };
    let found: Vec<Found<'_>> =
        parallel::in_order(study.layouts.len(), request.threads, known).into_iter().flatten().collect();
    let beside = if all { methods::beside(&study, &works) } else { Vec::new() };
    let others = beside.iter().map(|one| works.len() - one.said.len()).sum::<usize>();
    let missing = study.layouts.len() - found.len();
    if made.is_none() {
        complain(&format!("interrupted: the same command runs the other {} layouts", missing + others));
        return Ok(Verdict::Broken);
    }
    if missing + others > 0 {
        if !request.quiet {
            answer(&format!(
                "{} of {} layouts are left to other shards\n",
                missing + others,
                study.layouts.len() * works.len()
            ))?;
        }
        return Ok(Verdict::Done);
    }
    let mut tried = Vec::new();
    if let Some(search) = &study.search {
        match search::search(&study, search, work)? {
            Some(values) => tried = values,
            None => {
                complain("interrupted: the same command goes on with the search");
                return Ok(Verdict::Broken);
            }
        }
        write_rows(&path, "search.csv", &tried)?;
    }
    let mut critical = None;
    if let Some(wanted) = &study.critical {
        let Some(outcome) = critical::seek(&study, wanted, work)? else {
            complain("interrupted: the same command goes on with the halving");
            return Ok(Verdict::Broken);
        };
        write_rows(&path, "critical.csv", &outcome.found)?;
        write_rows(&path, "critical_tried.csv", &outcome.tried)?;
        critical = Some(critical::block(wanted, &outcome, work)?);
    }
    tables::write(&path, &study, method, &found)?;
    if all {
        methods::write(&path, &beside)?;
    }
    report::write(request, &study, work, report::Told { found: &found, tried: &tried, beside: &beside, critical })?;
    found.iter().filter_map(dug::warning).for_each(|warning| complain(&format!("WARNING: {warning}")));
    if !request.quiet {
        answer(&tables::summary(&study, method, &found, &path))?;
        for words in beside.iter().filter_map(methods::Beside::words) {
            answer(&format!("  {words}\n"))?;
        }
        if let Some(search) = &study.search {
            answer(&format!("  {}\n", search::words(search, &tried)))?;
        }
    }
    let bad = found.iter().map(|one| Verdict::of(one.fine.outcome));
    Ok(bad.fold(Verdict::Done, |worst, own| match (worst, own) {
        (Verdict::Broken, _) | (_, Verdict::Broken) => Verdict::Broken,
        (Verdict::CheckFailed, _) | (_, Verdict::CheckFailed) => Verdict::CheckFailed,
        _ => Verdict::Done,
    }))
}

/// Writes rows as a table.
fn write_rows<R: serde::Serialize>(folder: &Path, name: &str, rows: &[R]) -> Result<(), Failure> {
    output::write_rows(&folder.join(name), rows)
}
