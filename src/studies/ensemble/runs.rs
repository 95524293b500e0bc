//! Runs that differ in their seed alone, and how wrong they and their mean are.
//!
//! Series are taken as the tables that runs leave, so that runs just made and runs found on disk give the same bits.

use std::collections::BTreeMap;
use std::io;

use frazil_core::statistics;
use frazil_record::WaterSeries;
use frazil_record::{Errors, Record, RunResult};
use frazil_scene::Scene;
use frazil_simulation::measure;
use frazil_simulation::reference::Reference;
use serde::de::DeserializeOwned;

use super::table::{NoMean, Table, mean};
use crate::output;
use crate::output::of_water::SaturationRow;

/// Series of a run, by the names of their files.
pub type Tables = BTreeMap<String, Table>;

/// The series that errors are taken of.
pub const JUDGED: [&str; 7] =
    ["front.csv", "frozen.csv", "profiles.csv", "measured.csv", "wall.csv", "gaps.csv", "cut.csv"];

/// The series of a run that errors are taken of, as it would write them.
fn judged(run: &RunResult) -> io::Result<Tables> {
    let mut tables = Tables::new();
    for (name, fill) in output::series(run) {
        if let Some(fill) = fill.filter(|_| JUDGED.contains(&name)) {
            let mut text = Vec::new();
            fill(&mut text)?;
            tables.insert(name.to_owned(), Table::read(&text[..]).map_err(io::Error::other)?);
        }
    }
    Ok(tables)
}

/// A series that is not what runs leave.
#[derive(Debug, thiserror::Error)]
pub enum BadSeries {
    /// It has no mean.
    #[error("{0}: {1}")]
    Mean(String, NoMean),
    /// Its cells are not those of its rows.
    #[error("{0}: {1}")]
    Cells(String, csv::Error),
}

/// Mean of each series over runs; rows that a run lacks are the mean of the others. `spacing` is that of the particles (m).
///
/// # Errors
/// Where the columns of a series differ between runs.
pub fn means(runs: &[Tables], spacing: Option<f64>) -> Result<Tables, BadSeries> {
    let mut names: Vec<&String> = runs.iter().flat_map(Tables::keys).collect();
    names.sort();
    names.dedup();
    let of = |name: &String| {
        let tables: Vec<&Table> = runs.iter().filter_map(|run| run.get(name)).collect();
        let mean = mean(&tables, spacing).map_err(|reason| BadSeries::Mean(name.clone(), reason))?;
        Ok((name.clone(), mean))
    };
    names.into_iter().map(of).collect()
}

/// A run, as far as errors are taken of it, from its record and its series.
///
/// # Errors
/// Where a series has other cells than runs leave.
pub fn result(record: Record, tables: &Tables) -> Result<RunResult, BadSeries> {
    let cut = typed(tables, "cut.csv")?;
    let profiles = match record.of_water {
        true => typed::<SaturationRow>(tables, "profiles.csv")?.into_iter().map(Into::into).collect(),
        false => typed(tables, "profiles.csv")?,
    };
    let water = (!cut.is_empty()).then(|| WaterSeries { cut, ..WaterSeries::default() });
    Ok(RunResult {
        front: typed(tables, "front.csv")?,
        frozen: typed(tables, "frozen.csv")?,
        profiles,
        measured: typed(tables, "measured.csv")?,
        walls: typed(tables, "wall.csv")?,
        gaps: typed(tables, "gaps.csv")?,
        water,
        ..RunResult::bare(record)
    })
}

fn typed<R: DeserializeOwned>(tables: &Tables, name: &str) -> Result<Vec<R>, BadSeries> {
    let typed = tables.get(name).map_or(Ok(Vec::new()), Table::typed);
    typed.map_err(|reason| BadSeries::Cells(name.to_owned(), reason))
}

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
    /// Effective saturation of unsaturated water at all profile points.
    Saturation,
    /// Concentration of what it carries at all profile points.
    Concentration,
}

impl Headline {
    /// In the order of preference.
    pub const ALL: [Headline; 6] = [
        Headline::Front,
        Headline::Closure,
        Headline::Volume,
        Headline::Temperature,
        Headline::Saturation,
        Headline::Concentration,
    ];

    /// The one of a name, as of options.
    pub fn named(name: &str) -> Option<Headline> {
        Headline::ALL.into_iter().find(|measure| measure.name() == name)
    }

    /// Names of all.
    pub fn names() -> String {
        Headline::ALL.map(Headline::name).join(", ")
    }

    /// Whether it is taken at all profile points.
    pub fn is_of_profiles(self) -> bool {
        matches!(self, Headline::Temperature | Headline::Saturation | Headline::Concentration)
    }

    /// Another norm of errors, which one that is low by chance does not share.
    pub fn second_of(self, errors: &Errors) -> Option<f64> {
        let others: &[Headline] = match self {
            Headline::Temperature | Headline::Saturation => &[Headline::Front],
            Headline::Concentration => &[Headline::Saturation],
            Headline::Front | Headline::Closure | Headline::Volume => &[Headline::Temperature, Headline::Saturation],
        };
        others.iter().find_map(|other| other.of(errors))
    }

    /// The error, signed where it has a sign.
    pub fn of(self, errors: &Errors) -> Option<f64> {
        match self {
            Headline::Front => errors.front_rms_rel,
            Headline::Closure => errors.events.get("closure_day").copied(),
            Headline::Volume => errors.frozen_volume_rms_rel,
            Headline::Temperature => errors.temperature_rms_rel,
            Headline::Saturation => errors.saturation_rms,
            Headline::Concentration => errors.concentration_rms_rel,
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
            Headline::Saturation => "rms error of the effective saturation",
            Headline::Concentration => "rms error of the concentration, over its range",
        }
    }

    /// One word for files.
    pub fn name(self) -> &'static str {
        match self {
            Headline::Front => "front",
            Headline::Closure => "closure",
            Headline::Volume => "volume",
            Headline::Temperature => "temperature",
            Headline::Saturation => "saturation",
            Headline::Concentration => "concentration",
        }
    }

    /// Relative errors of one run point by point, whose rms over the points is the headline error. A single
    /// number where the measure is one.
    pub fn points(self, scene: &Scene, spacing: f64, result: &RunResult, reference: &dyn Reference) -> Vec<f64> {
        match self {
            Headline::Front => {
                let window = measure::front::window(scene, spacing, &result.front, reference);
                window.iter().map(measure::front::Judged::error).collect()
            }
            Headline::Temperature | Headline::Saturation | Headline::Concentration => {
                // Saturations run from none to one; points of what a scene is not of say nothing.
                let (least, greatest) = match (self, &scene.solute) {
                    (Headline::Saturation, _) if scene.of_water => (0.0, 1.0),
                    (Headline::Temperature, _) if !scene.of_water => scene.temperature_range(),
                    (Headline::Concentration, Some(solute)) => solute.range(),
                    _ => return Vec::new(),
                };
                let points = match self {
                    Headline::Concentration => measure::concentration_points(scene, spacing, result, reference),
                    _ => measure::profile_points(scene, spacing, result, reference),
                };
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
    /// Takes runs together. Absent for fewer than two, and where their series differ in kind.
    pub fn of(scene: &Scene, spacing: f64, runs: &[RunResult], reference: Option<&dyn Reference>) -> Option<Self> {
        let first = runs.first().filter(|_| runs.len() > 1)?;
        let tables: Vec<Tables> = runs.iter().map(judged).collect::<Result<_, _>>().ok()?;
        let means = means(&tables, Some(spacing)).ok()?;
        let mean = result(first.record.clone(), &means).ok()?;
        let mean = reference.map(|truth| measure::errors(scene, spacing, &mean, truth)).unwrap_or_default();
        Some(EnsembleRuns::with_mean(scene, spacing, runs, mean, reference))
    }

    /// Takes runs together whose mean has these errors.
    pub fn with_mean(
        scene: &Scene,
        spacing: f64,
        runs: &[RunResult],
        mean: Errors,
        reference: Option<&dyn Reference>,
    ) -> Self {
        let points = Headline::ALL.map(|headline| match reference {
            Some(reference) => runs.iter().map(|run| headline.points(scene, spacing, run, reference)).collect(),
            None => Vec::new(),
        });
        EnsembleRuns { runs: runs.iter().map(|run| run.record.errors.clone()).collect(), mean, points: points.into() }
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
