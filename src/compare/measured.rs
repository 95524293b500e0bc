//! What the runs of one configuration have shown.

use frazil_core::record::{Errors, Outcome, Record, RunResult};
use frazil_core::scene::Units;

use super::plan::{Configuration, Variant};
use crate::ensemble::runs::EnsembleRuns;
use crate::words::length_words;

/// Times of one run (s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Setup by the wall clock.
    pub setup_wall: f64,
    /// Setup of the process.
    pub setup_cpu: f64,
    /// Steps by the wall clock.
    pub solve_wall: f64,
    /// Steps of the process.
    pub solve_cpu: f64,
}

impl Timing {
    /// Times of a run.
    pub fn of(record: &Record) -> Timing {
        Timing {
            setup_wall: record.setup_wall_s,
            setup_cpu: record.setup_cpu_s,
            solve_wall: record.solve_wall_s,
            solve_cpu: record.solve_cpu_s,
        }
    }

    /// Setup and steps by the wall clock.
    pub fn wall(&self) -> f64 {
        self.setup_wall + self.solve_wall
    }

    /// Setup and steps of the process.
    pub fn cpu(&self) -> f64 {
        self.setup_cpu + self.solve_cpu
    }
}

/// One configuration and what came of it.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Method.
    pub method: &'static str,
    /// Setting.
    pub setting: Variant,
    /// Number of the resolution.
    pub level: usize,
    /// Particle spacing (m).
    pub spacing: f64,
    /// Units of the scene.
    pub units: Units,
    /// The first run, if one was made.
    pub result: Option<RunResult>,
    /// Why there is none, or what else is to be said.
    pub note: Option<String>,
    /// Times of the repeated runs.
    pub timings: Vec<Timing>,
    /// Whether only the first run could be timed, which is not warm.
    pub cold: bool,
    /// Whether all repeated runs ended in the same state to the last bit.
    pub repeatable: bool,
    /// Runs with other seeds.
    pub ensemble: Option<EnsembleRuns>,
}

impl Measured {
    /// A configuration before its first run.
    pub fn planned(configuration: &Configuration) -> Measured {
        Measured {
            method: configuration.method,
            setting: configuration.setting.clone(),
            level: configuration.level,
            spacing: configuration.spacing,
            units: configuration.units,
            result: None,
            note: configuration.scene.as_ref().err().cloned(),
            timings: Vec::new(),
            cold: false,
            repeatable: true,
            ensemble: None,
        }
    }

    /// Method and setting in words.
    pub fn label(&self) -> String {
        format!("{} {}", frazil_plots::style::method_title(self.method), self.setting.name)
    }

    /// The spacing in words.
    pub fn spacing_words(&self) -> String {
        length_words(self.units, self.spacing)
    }

    /// How the run ended; `not_run` if there was none.
    pub fn outcome(&self) -> &'static str {
        self.result.as_ref().map_or("not_run", |result| result.record.outcome.name())
    }

    /// Whether the run ended as it should.
    pub fn is_ok(&self) -> bool {
        self.result.as_ref().is_some_and(|result| result.record.outcome == Outcome::Ok)
    }

    /// Errors of the first run, or of the mean where there are several seeds.
    pub fn errors(&self) -> Option<&Errors> {
        match &self.ensemble {
            Some(ensemble) => Some(&ensemble.mean),
            None => self.result.as_ref().map(|result| &result.record.errors),
        }
    }

    /// Why there is no good result, in words.
    pub fn trouble(&self) -> Option<String> {
        match &self.result {
            Some(result) if result.record.outcome == Outcome::Ok => None,
            Some(result) => Some(format!(
                "{}: {}",
                result.record.outcome.name().replace('_', " "),
                result.record.cause.as_deref().unwrap_or("no cause is given")
            )),
            None => Some(self.note.clone().unwrap_or_else(|| "not run".into())),
        }
    }
}
