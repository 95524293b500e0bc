//! What a study of properties is asked for.

use std::path::PathBuf;

use frazil_edpd::calibration::Constants;

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
