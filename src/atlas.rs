//! Every section, figure and table of the papers beside what the program finds: one run for each, and a page.

mod item;
mod read;
mod report;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::Ordering;

use frazil_studies::failure::{Failure, Verdict, answer, complain};
use frazil_studies::output::{make_folder, write_json};
use serde::{Deserialize, Serialize};

use crate::{interrupt, provenance};
pub use item::UnknownPaper;
use item::{Atlas, Judged, Outcome, Run};

/// What is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AtlasRequest {
    /// Papers by their keys; all of them if empty.
    pub papers: Vec<String>,
    /// Folder for the results; `out/atlas` if absent.
    pub out: Option<PathBuf>,
    /// Threads of each run.
    pub threads: usize,
    /// The command as it was typed.
    pub command_line: String,
    /// Whether to say nothing but errors.
    pub quiet: bool,
}

/// What a folder holds once its run is done.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Done {
    command: String,
    version: String,
    commit: Option<String>,
}

/// The mark of a finished run.
const DONE: &str = "atlas.json";

/// Makes all runs that are not there yet, and writes the table and the page.
///
/// # Errors
/// Where a paper is not known, or a file cannot be written.
pub fn atlas(request: &AtlasRequest) -> Result<Verdict, Failure> {
    let atlas = Atlas::read()?.of_papers(&request.papers)?;
    let folder = request.out.clone().unwrap_or_else(|| "out/atlas".into());
    let runs: Vec<&Run> = atlas.runs_in_use().collect();
    for (number, run) in runs.iter().enumerate() {
        let path = folder.join("runs").join(&run.name);
        if is_done(run, &path) {
            continue;
        }
        if !request.quiet {
            complain(&format!("{} of {}: frazil {}", number + 1, runs.len(), run.command));
        }
        if !make(run, &path, request.threads)? {
            complain("interrupted: the same command goes on from here");
            return Ok(Verdict::Broken);
        }
    }
    let judged: Vec<Vec<Judged<'_>>> = atlas
        .papers
        .iter()
        .map(|paper| paper.rows.iter().map(|row| row.judge(&folder.join("runs"))).collect())
        .collect();
    report::write(request, &folder, &atlas, &judged)?;
    answer(&format!("{}\n  results: {}\n", report::counts(judged.iter().flatten()), folder.display()))?;
    let broken = judged.iter().flatten().any(|one| matches!(one.outcome, Outcome::Missing(_)));
    Ok(if broken { Verdict::CheckFailed } else { Verdict::Done })
}

fn mark(run: &Run) -> Done {
    Done {
        command: run.command.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        commit: provenance::machine().commit,
    }
}

/// Whether a folder holds a run of this command by this program.
fn is_done(run: &Run, path: &Path) -> bool {
    let text = fs::read_to_string(path.join(DONE)).ok();
    text.and_then(|text| serde_json::from_str::<Done>(&text).ok()).is_some_and(|done| done == mark(run))
}

/// Runs a command of the program in a process of its own, so that none can break another; whether it came to its end.
fn make(run: &Run, path: &Path, threads: usize) -> Result<bool, Failure> {
    make_folder(path)?;
    let program = std::env::current_exe().map_err(|error| Failure::file(path, "cannot be run into", error))?;
    let words = run.command.split_whitespace();
    let own = ["--quiet", "--threads", &threads.to_string(), "--out"].map(String::from);
    // An interrupt is for both: the run ends itself, and says so by its code.
    let flag = interrupt::watch();
    let output = Command::new(program).args(words).args(own).arg(path).output();
    let output = output.map_err(|error| Failure::file(path, "cannot be run into", error))?;
    if flag.load(Ordering::Relaxed) {
        return Ok(false);
    }
    if output.status.code().is_none_or(|code| code > 1) {
        // Its rows say what they lack; all others go on.
        complain(&format!("frazil {}: {}", run.command, String::from_utf8_lossy(&output.stderr).trim_end()));
        return Ok(true);
    }
    write_json(&path.join(DONE), &mark(run))?;
    Ok(true)
}
