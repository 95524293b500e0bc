//! What a calibrated eDPD fluid is really like: diffusivities, Schmidt and Prandtl numbers, measured on moving particles.
//!
//! A study goes one way: the fluid is calibrated, jobs are laid out, one for each measurement, temperature and seed, and run
//! side by side; tables and figures are made of what they found. Finished jobs are taken down in a journal, so a study that
//! was killed goes on where it stood and leaves the same files.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use frazil_edpd::calibration::Constants;

use crate::calibrate::{self, CalibrateRequest, Calibrated, Conduction};
use crate::failure::{Failure, Verdict, answer, complain};
use crate::interrupt;
use crate::journal::{self, Journal};
use crate::output::Folder;
use crate::progress::forewarn;

pub mod equilibrium;
pub mod execute;
pub mod figures;
pub mod plan;
pub mod report;
pub mod tables;

/// Which rows of the fluid are measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Rows {
    /// Rows at least this far apart (K), from the coldest on.
    Apart(f64),
    /// All.
    All,
    /// Those of these temperatures (degrees Celsius).
    Given(Vec<f64>),
}

/// What is to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct PropertiesRequest {
    /// Fluid, by path or bundled name.
    pub fluid: String,
    /// What of the DPD fluid does not depend on temperature; in the plane.
    pub constants: Constants,
    /// Temperature that is 1 in DPD units (K).
    pub reference_temperature: f64,
    /// Rows of the fluid.
    pub rows: Rows,
    /// Runs of each measurement.
    pub seeds: u64,
    /// Height of the periodic boxes.
    pub height: f64,
    /// Times that are watched, over the default ones.
    pub effort: f64,
    /// Time step.
    pub step: f64,
    /// Boxes and numbers of steps of the paper.
    pub paper: bool,
    /// To check what a fluid left alone has to keep, and to measure nothing else.
    pub equilibrium: bool,
    /// Jobs that are worked on side by side.
    pub threads: usize,
    /// Folder for the results; `out/properties-FLUID` if absent.
    pub out: Option<PathBuf>,
    /// Whether to say nothing but errors on standard error.
    pub quiet: bool,
}

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
    let folder = Folder::make(path)?;
    let journal = Journal::open(&path.join("jobs.journal"), &journal::stamp())?;
    let stop = interrupt::watch();
    if !request.quiet {
        forewarn("properties", Some(execute::seconds(jobs, &journal, request.threads)));
    }
    let found = execute::jobs(request, jobs, &journal, stop)?;
    if stop.load(Ordering::Relaxed) {
        complain("interrupted: the same command goes on from here");
        return Ok(Verdict::Broken);
    }
    let rows = tables::rows(calibrated, jobs, &found);
    tables::write(folder.path(), &rows, jobs, &found)?;
    figures::write(folder.path(), &calibrated.fluid.title, &rows, jobs, &found)?;
    answer(&report::report(request, calibrated, &rows, jobs, &found, folder.path()))?;
    Ok(Verdict::Done)
}
