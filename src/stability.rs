//! Where each method breaks: maps of the outcome over the step and one parameter, and their boundaries.
//!
//! A study goes one way: columns of maps from scenes and axes, runs along the step of each column, tables, figures and
//! one page. Runs are taken down in a journal as they end; everything else is made from it, so a study that was killed
//! goes on where it stood and leaves the same files.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use frazil_simulation::march::Refused;

use crate::failure::{Failure, Verdict, complain};
use crate::journal::{self, Journal};
use crate::machine::Machine;
use crate::output::Folder;
use crate::{interrupt, load};
use axis::{Axis, Override};

pub mod axis;
pub mod cell;
pub mod execute;
pub mod figures;
pub mod plan;
pub mod report;
pub mod search;
pub mod super_steps;
pub mod tables;

/// What is to be mapped.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityRequest {
    /// Scenes, by path or bundled name.
    pub scenes: Vec<String>,
    /// Methods; all that a scene has settings for if empty.
    pub methods: Vec<String>,
    /// Axes; all that mean something if empty.
    pub axes: Vec<Axis>,
    /// Overrides of every scene.
    pub overrides: Vec<Override>,
    /// Steps over the bound to run, without a search for boundaries; a map and its boundaries if empty.
    pub steps: Vec<f64>,
    /// Steps of a map between a quarter of the bound and four times it.
    pub grid: usize,
    /// Columns of a map.
    pub values: usize,
    /// Runs of a noisy cell near a boundary.
    pub seeds: usize,
    /// Spacing over the scene's own.
    pub coarsen: u32,
    /// Wall time of one run (s).
    pub time_limit_s: f64,
    /// Columns that are worked on side by side.
    pub threads: usize,
    /// Folder for the results; `out/stability` if absent.
    pub out: Option<PathBuf>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}

/// Maps.
pub fn stability(request: &StabilityRequest) -> Result<Verdict, Failure> {
    let mut jobs = Vec::new();
    // Every scene is read and every column laid out before the first run, so that a misspelt name costs no time.
    for name in &request.scenes {
        let scene = load::scene(name, &request.overrides)?;
        jobs.extend(plan::jobs(request, name, &scene)?);
    }
    if jobs.is_empty() {
        return Err(Failure::Request("none of the axes means anything to these scenes and methods".into()));
    }
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join("stability"));
    let folder = Folder::make(&path)?;
    let machine = Machine::now();
    let journal = Journal::open(&path.join("runs.journal"), &journal::stamp())?;
    let stop = interrupt::watch();
    let columns = execute::columns(request, jobs, &journal, stop)?;
    if stop.load(Ordering::Relaxed) {
        complain("interrupted: the same command goes on from here");
        return Ok(Verdict::Broken);
    }
    tables::write(request, folder.path(), &columns)?;
    report::write(request, &machine, folder.path(), &columns)?;
    if !request.quiet {
        complain(&format!("written: {}", path.join("report.html").display()));
    }
    Ok(verdict(&columns))
}

/// A map is a measurement, whatever it shows; but a step within the bound that is not exact refutes the bound.
fn verdict(columns: &[execute::Mapped]) -> Verdict {
    if columns.iter().all(|column| column.found.is_err()) {
        return Verdict::Broken;
    }
    if columns.iter().any(|column| report::broken_promises(column).next().is_some()) {
        return Verdict::CheckFailed;
    }
    Verdict::Done
}

/// A problem of a method's name, in words.
fn unknown_method(name: &str, known: &[&str]) -> Refused {
    Refused { reason: format!("--methods {name}: there are {}", known.join(", ")) }
}
