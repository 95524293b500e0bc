//! The time loop: from a scene and a method to a [`RunResult`].

use std::sync::atomic::AtomicBool;

use crate::record::RunResult;
use crate::reference::Reference;
use crate::scene::Scene;

/// How a run is to be made; nothing here changes a digit of its result, but the seed.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Threads.
    pub threads: usize,
    /// Seed of the noise and of jittered or random placement.
    pub seed: u64,
    /// Set from outside to stop at the next step.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called now and then (about ten times a second at most).
    pub progress: Option<&'a (dyn Fn(&Progress) + Sync)>,
    /// Give up after this wall time (s) with the outcome `timed_out`.
    pub time_limit_s: Option<f64>,
    /// Whether temperature fields are kept at the profile instants.
    pub fields: bool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options { threads: 1, seed: 1, interrupt: None, progress: None, time_limit_s: None, fields: false }
    }
}

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time (s).
    pub time_s: f64,
    /// End of the run (s).
    pub duration_s: f64,
    /// Steps made.
    pub steps: u64,
    /// Wall time since the first step (s).
    pub elapsed_s: f64,
}

/// A run that was refused before its first step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct Refused {
    /// Why, in words that name the setting and what is allowed.
    pub reason: String,
}

/// Runs a scene under one method. Errors are taken against `reference`, if there is one.
pub fn run(
    _scene: &Scene,
    _method: &str,
    _reference: Option<&dyn Reference>,
    _options: &Options<'_>,
) -> Result<RunResult, Refused> {
    Err(Refused { reason: "the engine is not connected".into() })
}
