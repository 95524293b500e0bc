//! What the runs of one configuration have shown.

use frazil_record::{Errors, Outcome, Record, RunResult};
use frazil_scene::Units;

use super::plan::Configuration;
use super::variant::Variant;
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

/// What became of a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// A run that ended as it should.
    Done,
    /// No run was begun: it would not have fitted into the time allowed.
    LeftOut,
    /// A run that the time allowed cut off.
    CutOff,
    /// The user stopped the comparison before or during it.
    Interrupted,
    /// The scene cannot be had, or not be run, with these settings.
    Refused,
    /// A run that went wrong.
    Failed,
}

impl Status {
    /// The word of `comparison.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Status::Done => "done",
            Status::LeftOut => "left out",
            Status::CutOff => "cut off",
            Status::Interrupted => "interrupted",
            Status::Refused => "refused",
            Status::Failed => "failed",
        }
    }

    /// Whether it was the time that did not suffice, and not the method.
    pub fn is_lack_of_time(self) -> bool {
        matches!(self, Status::LeftOut | Status::CutOff | Status::Interrupted)
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
    /// What became of it where no run was made, and why.
    pub unmade: Option<(Status, String)>,
    /// What else is to be said of a run that was made.
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
            unmade: configuration.scene.as_ref().err().map(|failure| (Status::Refused, failure.to_string())),
            note: None,
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

    /// What became of it.
    pub fn status(&self) -> Status {
        match (&self.result, &self.unmade) {
            (Some(result), _) => match result.record.outcome {
                Outcome::Ok => Status::Done,
                Outcome::TimedOut => Status::CutOff,
                Outcome::Interrupted => Status::Interrupted,
                _ => Status::Failed,
            },
            (None, Some((status, _))) => *status,
            (None, None) => Status::LeftOut,
        }
    }

    /// Whether the run ended as it should.
    pub fn is_ok(&self) -> bool {
        self.result.as_ref().is_some_and(|result| result.record.outcome == Outcome::Ok)
    }

    /// Where no repeated run has been timed, the first one has to do if it ended well.
    pub fn time_by_first_run(&mut self) {
        if self.timings.is_empty() && self.is_ok() {
            self.cold = true;
            self.timings.extend(self.result.as_ref().map(|result| Timing::of(&result.record)));
        }
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
            None => Some(
                self.unmade
                    .as_ref()
                    .map_or("not run".into(), |(status, reason)| format!("{}: {reason}", status.name())),
            ),
        }
    }
}
