//! Where each method breaks: maps of the outcome over the step and one parameter, and their boundaries.
//!
//! A study goes one way: columns of maps from scenes and axes, runs along the step of each column, tables, figures and
//! one page, made of what the runs of a campaign found.

use std::path::Path;

use crate::campaign::{Campaign, Shard};
use crate::failure::{Failure, Verdict, complain};
use crate::machine::Machine;
use crate::method;
use crate::output::{Folder, Owner};
use crate::parts::Parts;

pub mod axis;
pub mod cell;
pub mod execute;
pub mod figures;
pub mod plan;
pub mod report;
mod request;
pub mod search;
pub mod super_steps;
pub mod tables;
pub mod tolerances;

pub use request::StabilityRequest;

/// No axis that was asked for means anything to what it was asked of.
#[derive(Debug, thiserror::Error)]
#[error("none of the axes applies to these scenes and methods")]
struct NoAxis;

/// Scenes that do not go into one study.
#[derive(Debug, thiserror::Error)]
#[error(
    "scenes of unsaturated water and of heat were asked for: their stability limits differ, use a separate study for each"
)]
struct Apart;

/// Maps.
///
/// # Errors
///
/// If a scene, method or axis is none, a run is refused, or a file cannot be written.
pub fn stability(request: &StabilityRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let (mut jobs, mut of_water, mut names) = (Vec::new(), Vec::new(), Vec::new());
    // Every scene is read and every column laid out before the first run, so that a misspelt name costs no time.
    for name in &request.scenes {
        let scene = (parts.scene_at)(name, &request.overrides)?;
        of_water.push(scene.of_water);
        jobs.extend(plan::jobs(request, parts, name, &scene)?);
        names.push(scene.name);
    }
    method::distinct(&names)?;
    let of_water = match of_water.contains(&true) {
        true if of_water.contains(&false) => return Err(Failure::request(Apart)),
        of_water => of_water,
    };
    if jobs.is_empty() {
        return Err(Failure::request(NoAxis));
    }
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join("stability"));
    let folder = Folder::make(&path, Owner::Alone)?;
    let machine = Machine::now();
    let campaign = Campaign::open(&path, Shard::WHOLE, request.threads, parts.interrupt)?;
    if of_water {
        return tolerances(request, parts, &jobs, (folder.path(), &machine, &campaign));
    }
    let columns = execute::columns(request, parts, jobs, &campaign)?;
    if campaign.is_interrupted() {
        complain("interrupted: the same command resumes from here");
        return Ok(Verdict::Broken);
    }
    tables::write(request, folder.path(), &columns)?;
    report::write(request, parts, &machine, folder.path(), &columns)?;
    if !request.quiet {
        complain(&format!("written: {}", path.join("report.html").display()));
    }
    Ok(verdict(&columns))
}

/// The same of unsaturated water, whose steps follow a tolerance.
fn tolerances(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    jobs: &[plan::Job],
    (folder, machine, campaign): (&Path, &Machine, &Campaign<'_>),
) -> Result<Verdict, Failure> {
    let cells = tolerances::cells(request, parts, jobs, campaign)?;
    if campaign.is_interrupted() {
        complain("interrupted: the same command resumes from here");
        return Ok(Verdict::Broken);
    }
    tolerances::write(request, parts, machine, folder, &cells)?;
    if !request.quiet {
        complain(&format!("written: {}", folder.join("report.html").display()));
    }
    Ok(if tolerances::is_good(&cells) { Verdict::Done } else { Verdict::CheckFailed })
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
