//! Where the runs stand that a folder holds.

use std::path::{Path, PathBuf};

use frazil_record::Record;
use frazil_simulation::march;
use frazil_studies::campaign::count_of_findings;
use frazil_studies::failure::{Failure, Verdict, answer};
use frazil_studies::output::{DEEPEST, is_locked, record_in};

use crate::run;

/// Tells where each run in a folder and those in it stands.
///
/// # Errors
/// A folder that cannot be read, or that holds no run.
pub fn status(folder: &Path) -> Result<Verdict, Failure> {
    let mut lines = Vec::new();
    look(folder, 0, &mut lines)?;
    if lines.is_empty() {
        return Err(Failure::request(NoRun(folder.to_owned())));
    }
    answer(&lines.join("\n"))?;
    Ok(Verdict::Done)
}

/// A folder holds no results.
#[derive(Debug, thiserror::Error)]
#[error("{}: contains no run and no study", .0.display())]
struct NoRun(PathBuf);

/// Adds a line for each run in a folder and those in it.
fn look(folder: &Path, depth: usize, lines: &mut Vec<String>) -> Result<(), Failure> {
    let unreadable = |error| Failure::file(folder, "cannot be read", error);
    let mut entries = std::fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(unreadable)?;
    entries.sort_by_key(|entry| entry.file_name());
    let is_running = is_locked(folder);
    let mut say = |words: String| lines.push(format!("{}: {words}", folder.display()));
    if let Some(standing) = march::standing(folder).map_err(unreadable)? {
        let state = if is_running { "running, last kept" } else { "stopped" };
        say(format!("{} with {}: {state} at {}", standing.scene, standing.method, run::words(&standing)));
    } else if is_running {
        say("running".into());
    } else if let Some(record) = record_in(folder) {
        say(ended(&record));
    }
    match count_of_findings(folder) {
        0 => {}
        findings => say(format!("a study, {findings} runs done")),
    }
    for entry in entries {
        if depth < DEEPEST && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            look(&entry.path(), depth + 1, lines)?;
        }
    }
    Ok(())
}

/// A run that has come to its end.
fn ended(record: &Record) -> String {
    let Record { scene, method, outcome, steps, .. } = record;
    let cause = record.cause.as_ref().map_or_else(String::new, |cause| format!(": {cause}"));
    format!("{scene} with {method}: ended, {}{cause} ({steps} steps)", outcome.name())
}
