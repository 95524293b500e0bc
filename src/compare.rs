//! Methods against each other on the same scenes: error against run time.

use std::path::PathBuf;

use frazil_core::scene::Setting;

use crate::failure::{Failure, Verdict};

/// What is to be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareRequest {
    /// Scenes, by path or bundled name.
    pub scenes: Vec<String>,
    /// Methods; all that a scene has settings for if empty.
    pub methods: Vec<String>,
    /// Number of spacings.
    pub levels: usize,
    /// Folder for the results.
    pub out: Option<PathBuf>,
    /// Timed repetitions of each run.
    pub repeats: usize,
    /// Seeds of each stochastic run.
    pub seeds: usize,
    /// Threads of each run.
    pub threads: usize,
    /// Wall time that one run may take (s).
    pub budget_s: Option<f64>,
    /// Settings of the methods.
    pub settings: Vec<Setting>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
}

/// Compares.
pub fn compare(_request: &CompareRequest) -> Result<Verdict, Failure> {
    Err(Failure::Request("compare is not connected".into()))
}
