//! Sweeps: a scene run at all combinations of values of some of its keys.
//!
//! Whatever key can be set can be varied, so a sweep has no list of parameters of its own. All scenes are read before the first
//! run starts; runs are findings of a campaign, so a sweep that was stopped goes on, and one with more values makes only the
//! new runs.

mod execute;
mod keys;
mod report;
mod tables;

use std::path::{Path, PathBuf};
use std::time::Duration;

use frazil_record::Outcome;

use crate::campaign::{Campaign, Shard};
use crate::failure::{Failure, Verdict, answer, complain};
use crate::machine::Machine;
use crate::output::{Folder, Owner};
use crate::parts::{Override, Parts};
pub use keys::{NoKey, VariedKey};

/// Runs of a sweep at most: more are a mistake in a list of values.
pub const MOST_RUNS: usize = 10_000;

/// What is to be run.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRequest {
    /// Scene, by path or bundled name.
    pub scene: String,
    /// Keys that are varied, each with its values; the first is the horizontal axis of the figures.
    pub keys: Vec<VariedKey>,
    /// Methods; the first of the scene if empty.
    pub methods: Vec<String>,
    /// Overrides of the scene, before the values.
    pub overrides: Vec<Override>,
    /// Concurrent runs.
    pub threads: usize,
    /// Seed of all runs.
    pub seed: u64,
    /// Folder for the results; `out/sweep/SCENE` if absent.
    pub out: Option<PathBuf>,
    /// Wall time between two checkpoints of each run; none if absent.
    pub checkpoints: Option<Duration>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}

/// What cannot be swept.
#[derive(Debug, thiserror::Error)]
enum NoSweep {
    #[error("--vary {0}: the key is varied twice")]
    Twice(String),
    #[error("--vary: found {0} runs, must be at most {MOST_RUNS}")]
    Many(usize),
}

/// Runs all combinations and writes the table, the figures and the page.
///
/// # Errors
/// Where the scene cannot be read at one of the combinations, or a file cannot be written.
pub fn sweep(request: &SweepRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let count = request.keys.iter().map(|key| key.values.len()).try_fold(1usize, |all, own| all.checked_mul(own));
    let count = count.and_then(|count| count.checked_mul(request.methods.len().max(1))).unwrap_or(usize::MAX);
    if count > MOST_RUNS {
        return Err(Failure::request(NoSweep::Many(count)));
    }
    for (k, key) in request.keys.iter().enumerate() {
        if request.keys[..k].iter().any(|other| other.key == key.key) {
            return Err(Failure::request(NoSweep::Twice(key.key.clone())));
        }
    }
    let (own, jobs) = execute::jobs(request, parts)?;
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join("sweep").join(&own.name));
    let folder = Folder::make(&path, Owner::Alone)?;
    let campaign = Campaign::open(folder.path(), Shard::WHOLE, request.threads, parts.interrupt)?
        .with_checkpoints(request.checkpoints);
    let runs = execute::runs(request, parts, jobs, &campaign)?;
    if campaign.is_interrupted() {
        complain("interrupted: the same command resumes from here");
        return Ok(Verdict::Broken);
    }
    tables::write(request, folder.path(), &runs)?;
    report::write(request, &Machine::now(), folder.path(), &own, &runs)?;
    if !request.quiet {
        let said: Vec<String> = report::answers(request, &runs).into_iter().map(|line| format!("  {line}\n")).collect();
        answer(&format!("{}: {} runs\n{}", own.name, runs.len(), said.concat()))?;
        complain(&format!("written: {}", path.join("report.html").display()));
    }
    // A run that was refused or broke off is a result of a sweep; one that none came of is not.
    let outcomes = || runs.iter().map(|run| run.finding.outcome);
    Ok(match outcomes().any(|outcome| outcome.is_some_and(|outcome| Verdict::of(outcome) != Verdict::Broken)) {
        false => Verdict::Broken,
        true if outcomes().all(|outcome| outcome == Some(Outcome::Ok)) => Verdict::Done,
        true => Verdict::CheckFailed,
    })
}
