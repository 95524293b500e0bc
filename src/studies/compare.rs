//! Methods against each other on the same scenes: error against run time.
//!
//! A comparison goes one way: a plan of runs, the runs themselves, kept by a campaign, what they say (analysis), and then
//! tables, figures and one page. Files are written as results arrive, each whole.

use std::path::Path;

use crate::campaign::{Campaign, Shard};
use crate::failure::{Failure, Verdict, answer, complain};
use crate::machine::Machine;
use crate::output::{Folder, Owner};
use crate::parallel;
use crate::parts::Parts;

pub mod analysis;
pub mod curve;
pub mod execute;
pub mod figures;
pub mod group;
pub mod measured;
pub mod plan;
pub mod reference;
pub mod report;
mod request;
pub mod runner;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod turns;
pub mod variant;
pub mod vary;
pub mod verdict;

use report::Report;
pub use request::{CompareRequest, Vary};
use runner::Runner;

/// Compares.
///
/// # Errors
///
/// If a scene, method or setting is none, or a file cannot be written.
pub fn compare(request: &CompareRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    request.distinct(parts)?;
    match &request.vary {
        Some(wanted) => vary::vary(request, wanted, parts),
        None => by_time(request, parts),
    }
}

/// Error against run time.
fn by_time(request: &CompareRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join("compare"));
    // Every scene is read under every method and setting before the first run, so that a misspelt word costs no time.
    for name in &request.scenes {
        let scene = request.scene(parts, name, &[])?;
        plan::check(request, parts, name, &scene)?;
    }
    request.forewarn();
    let folder = Folder::make(&path, Owner::Alone)?;
    let machine = Machine::now();
    let campaign = Campaign::open(&path, Shard::WHOLE, parallel::cores(), parts.interrupt)?;
    let campaign = campaign.with_checkpoints(request.checkpoints);
    let runner = Runner::new(request, parts, &campaign);
    let mut report = Report::new(request, &machine, folder.path());
    let mut finished = Vec::new();
    let mut broken = false;
    for name in &request.scenes {
        let say = |text: &str| {
            if !request.quiet {
                complain(text);
            }
        };
        let written = |runs: &execute::SceneRuns| {
            tables::write_comparison(folder.path(), &finished, Some(runs))?;
            report.show(&finished, runs)
        };
        match execute::scene(request, parts, &runner, name, &say, &written) {
            Ok(runs) => {
                let study = analysis::Study::of(runs);
                if !request.quiet {
                    answer(&verdict::text(&study))?;
                }
                finished.push(study);
            }
            Err(execute::Stop::Scene(failure)) => {
                complain(&format!("{name}: {failure}"));
                broken = true;
            }
            Err(execute::Stop::Files(failure)) => return Err(failure),
        }
        campaign.check()?;
        tables::write_all(folder.path(), &finished)?;
        report.finish(&finished)?;
        if campaign.is_interrupted() {
            complain("interrupted: the same command resumes from here");
            return Ok(Verdict::Broken);
        }
    }
    if finished.is_empty() {
        folder.take_back();
    } else if !request.quiet {
        complain(&format!("written: {}", path.join("report.html").display()));
    }
    Ok(if broken { Verdict::Broken } else { Verdict::Done })
}
