//! What a calibrated eDPD fluid is really like: diffusivities, Schmidt and Prandtl numbers, measured on moving particles.
//!
//! A study goes one way: the fluid is calibrated, jobs are laid out, one for each measurement, temperature and seed, and run
//! as a campaign; tables and figures are made of what they found.

use std::path::Path;

use frazil_studies::campaign::{Campaign, Shard};
use frazil_studies::failure::{Failure, Verdict, answer, complain};
use frazil_studies::output::{Folder, Owner};
use frazil_studies::progress::forewarn;

use crate::calibrate::{self, CalibrateRequest, Calibrated, Conduction};
use crate::interrupt;

pub mod equilibrium;
pub mod execute;
pub mod figures;
pub mod plan;
pub mod report;
mod request;
pub mod tables;

pub use request::{PropertiesRequest, Rows};

/// Measures.
pub fn properties(request: &PropertiesRequest) -> Result<Verdict, Failure> {
    let calibration = CalibrateRequest {
        fluid: request.fluid.clone(),
        constants: request.constants,
        reference_temperature: request.reference_temperature,
        conduction: Conduction::Fluid,
        from: None,
        to: None,
        out: None,
    };
    let calibrated = calibrate::solve(&calibration)?;
    let name = format!("properties-{}", calibrated.fluid.name);
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join(name));
    if request.equilibrium {
        return equilibrium::equilibrium(request, &calibrated, &path);
    }
    let rows = plan::rows(request, &calibrated.table)?;
    // Every box is tried before the first job, so that a bad one costs no time.
    let jobs = plan::jobs(request, &calibrated.table, &rows)?;
    measure(request, &calibrated, &jobs, &path)
}

fn measure(
    request: &PropertiesRequest,
    calibrated: &Calibrated<'_>,
    jobs: &[plan::Job],
    path: &Path,
) -> Result<Verdict, Failure> {
    let folder = Folder::make(path, Owner::Alone)?;
    let campaign = Campaign::open(path, Shard::WHOLE, request.threads, interrupt::watch())?;
    if !request.quiet {
        forewarn("properties", Some(execute::seconds(jobs, &campaign, request.threads)));
    }
    let found = execute::jobs(request, jobs, &campaign)?;
    if campaign.is_interrupted() {
        complain("interrupted: the same command resumes from here");
        return Ok(Verdict::Broken);
    }
    let rows = tables::rows(calibrated, jobs, &found);
    tables::write(folder.path(), &rows, jobs, &found)?;
    figures::write(folder.path(), &calibrated.fluid.title, &rows, jobs, &found)?;
    answer(&report::report(request, calibrated, &rows, jobs, &found, folder.path()))?;
    Ok(Verdict::Done)
}
