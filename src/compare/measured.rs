//! What the runs of one configuration have shown.

use frazil_core::record::{Errors, Outcome, Record, RunResult};
use frazil_core::reference::Reference;
use frazil_core::scene::{Scene, Units};
use frazil_core::{measure, statistics};

use super::plan::{Configuration, Variant};
use crate::words::length_words;

/// The error that a diagram shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Headline {
    /// Front over time.
    Front,
    /// Closure of the frozen wall.
    Closure,
    /// Frozen volume over time.
    Volume,
    /// Temperature at all profile points.
    Temperature,
}

impl Headline {
    /// In the order of preference.
    pub const ALL: [Headline; 4] = [Headline::Front, Headline::Closure, Headline::Volume, Headline::Temperature];

    /// The error, signed where it has a sign.
    pub fn of(self, errors: &Errors) -> Option<f64> {
        match self {
            Headline::Front => errors.front_rms_rel,
            Headline::Closure => errors.events.get("closure_day").copied(),
            Headline::Volume => errors.frozen_volume_rms_rel,
            Headline::Temperature => errors.temperature_rms_rel,
        }
    }

    /// The error with a sign, as far as one is known: an rms front error takes that of the last front.
    pub fn signed(self, errors: &Errors) -> Option<f64> {
        let error = self.of(errors)?;
        match self {
            Headline::Front => Some(error * errors.front_last_rel.map_or(1.0, f64::signum)),
            _ => Some(error),
        }
    }

    /// Words for axes and tables.
    pub fn label(self) -> &'static str {
        match self {
            Headline::Front => "rms error of the front",
            Headline::Closure => "error of the time of closure",
            Headline::Volume => "rms error of the frozen volume",
            Headline::Temperature => "rms error of the temperature, over its range",
        }
    }

    /// One word for files.
    pub fn name(self) -> &'static str {
        match self {
            Headline::Front => "front",
            Headline::Closure => "closure",
            Headline::Volume => "volume",
            Headline::Temperature => "temperature",
        }
    }

    /// Relative errors of one run point by point, whose rms over the points is the headline error. A single
    /// number where the measure is one.
    pub fn points(self, scene: &Scene, spacing: f64, result: &RunResult, reference: &dyn Reference) -> Vec<f64> {
        let relative = |own: f64, expected: Option<f64>| Some(own / expected.filter(|value| *value > 0.0)? - 1.0);
        match self {
            Headline::Front => result
                .front
                .iter()
                .filter(|row| row.time_s >= scene.watch.front_from)
                .filter_map(|row| relative(row.front_m, reference.front(row.time_s)))
                .collect(),
            Headline::Temperature => {
                let (least, greatest) = scene.temperature_range();
                let points = measure::profile_points(scene, spacing, result, reference);
                points.into_iter().map(|(own, expected)| (own - expected) / (greatest - least)).collect()
            }
            Headline::Closure | Headline::Volume => self.of(&result.record.errors).into_iter().collect(),
        }
    }
}

/// Several runs of a stochastic method that differ in their seed only.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsembleRuns {
    /// Errors of each run.
    pub runs: Vec<Errors>,
    /// Errors of the mean of the runs.
    pub mean: Errors,
    /// Relative errors by run and point, for each headline measure in the order of [`Headline::ALL`].
    pub points: Vec<Vec<Vec<f64>>>,
}

impl EnsembleRuns {
    /// Takes runs together. Absent for fewer than two.
    pub fn of(scene: &Scene, spacing: f64, runs: &[RunResult], reference: Option<&dyn Reference>) -> Option<Self> {
        let mut mean = runs.first().filter(|_| runs.len() > 1)?.clone();
        average(&mut mean, runs);
        let points = Headline::ALL.map(|headline| match reference {
            Some(reference) => runs.iter().map(|run| headline.points(scene, spacing, run, reference)).collect(),
            None => Vec::new(),
        });
        Some(EnsembleRuns {
            runs: runs.iter().map(|run| run.record.errors.clone()).collect(),
            mean: reference.map(|truth| measure::errors(scene, spacing, &mean, truth)).unwrap_or_default(),
            points: points.into(),
        })
    }

    /// Relative errors by run and point of a measure.
    pub fn points_of(&self, headline: Headline) -> &[Vec<f64>] {
        let index = Headline::ALL.iter().position(|other| *other == headline);
        index.and_then(|index| self.points.get(index)).map_or(&[], Vec::as_slice)
    }

    /// What the seeds say about systematic error and scatter.
    pub fn split(&self, headline: Headline) -> Option<statistics::Ensemble> {
        statistics::ensemble(self.points_of(headline))
    }
}

/// Replaces the series of a run by the mean of several, row by row.
fn average(mean: &mut RunResult, runs: &[RunResult]) {
    let count = runs.len() as f64;
    for (k, row) in mean.front.iter_mut().enumerate() {
        row.front_m = runs.iter().filter_map(|run| run.front.get(k)).map(|row| row.front_m).sum::<f64>() / count;
    }
    for (k, row) in mean.profiles.iter_mut().enumerate() {
        let of = |value: fn(&frazil_core::record::ProfileRow) -> f64| {
            runs.iter().filter_map(|run| run.profiles.get(k)).map(value).sum::<f64>() / count
        };
        row.temperature_c = of(|row| row.temperature_c);
        row.frozen_fraction = of(|row| row.frozen_fraction);
    }
    for (k, row) in mean.walls.iter_mut().enumerate() {
        let of = |value: fn(&frazil_core::record::WallRow) -> f64| {
            runs.iter().filter_map(|run| run.walls.get(k)).map(value).sum::<f64>() / count
        };
        row.thickness_main_m = of(|row| row.thickness_main_m);
        row.thickness_interface_m = of(|row| row.thickness_interface_m);
        row.frozen_area_m2 = of(|row| row.frozen_area_m2);
    }
    for (k, row) in mean.gaps.iter_mut().enumerate() {
        let closures: Option<Vec<f64>> = runs.iter().map(|run| run.gaps.get(k)?.closure_s).collect();
        row.closure_s = closures.map(|closures| closures.iter().sum::<f64>() / count);
    }
}

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
