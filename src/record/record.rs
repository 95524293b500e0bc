//! The record of a run: what was asked, how it went, and how wrong it is.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{MeasuredErrors, Provenance, StreamRecord, WallRecord, WaterRecord, Work};

/// A setting as it stands in a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Yes or no.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A word.
    Text(String),
}

/// How a run ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// As it should.
    Ok,
    /// Temperatures left the range of the data, or the front went back, without growing further.
    Oscillating,
    /// The heat balance does not close.
    EnergyDrift,
    /// Particles jumped over the latent interval.
    PhaseSkipped,
    /// Non-finite, or beyond ten times the range of the data.
    Diverged,
    /// The time allowed ran out.
    TimedOut,
    /// Stopped by the user; what nothing says more of has not come to its end.
    #[default]
    Interrupted,
}

impl Outcome {
    /// The word used in records.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Ok => "ok",
            Outcome::Oscillating => "oscillating",
            Outcome::EnergyDrift => "energy_drift",
            Outcome::PhaseSkipped => "phase_skipped",
            Outcome::Diverged => "diverged",
            Outcome::TimedOut => "timed_out",
            Outcome::Interrupted => "interrupted",
        }
    }
}

/// Errors against the reference; a measure that does not apply is absent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Rms of the temperature error at all profile points over the range of the scene's temperatures; where a flux drives
    /// them, over that of the reference at these points as well.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub temperature_rms_rel: Option<f64>,
    /// Signed mean of the temperature error at all profile points over the range of the scene's temperatures.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub temperature_mean_rel: Option<f64>,
    /// Rms of the temperature error over the greatest magnitude of the reference (depends on the zero of the scale).
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub temperature_rms_over_max_abs: Option<f64>,
    /// Greatest temperature error over the range of the scene's temperatures.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub temperature_max_rel: Option<f64>,
    /// Rms of the error of the effective saturation at all profile points, of unsaturated water.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub saturation_rms: Option<f64>,
    /// Mean magnitude of the same.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub saturation_mean_abs: Option<f64>,
    /// Rms of the error of the concentration at all profile points, over the range of the scene's concentrations.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub concentration_rms_rel: Option<f64>,
    /// Mean magnitude of the same.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub concentration_mean_abs_rel: Option<f64>,
    /// Rms over the window of the error of the front, over how far the reference's has come since the start.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub front_rms_rel: Option<f64>,
    /// Signed error of the front at the end, over how far the reference's has come: positive where it has come too far.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub front_last_rel: Option<f64>,
    /// Signed relative error of the front constant fitted over the window.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub front_constant_rel: Option<f64>,
    /// Rms over the window of the relative error of the frozen area of a ring; of other bodies, of the error of the frozen
    /// volume over the greatest change of the reference's since the start.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub frozen_volume_rms_rel: Option<f64>,
    /// Rms relative error of the wall thickness on the plane through a pipe, once closed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub thickness_main_rms_rel: Option<f64>,
    /// Rms relative error of the wall thickness on the plane between pipes, once closed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub thickness_interface_rms_rel: Option<f64>,
    /// Signed relative error of the time of each named event.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub events: BTreeMap<String, f64>,
}

/// The error that was estimated of a run from others of the same method, and what it is made of, all relative and in the terms of one
/// measure. A part that could not be measured is absent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EstimatedError {
    /// The measure: `front`, `closure`, `volume`, `temperature`, `saturation` or `concentration`.
    pub measure: String,
    /// Error that was asked for.
    pub asked_rel: f64,
    /// Error that is promised, all that counts in it.
    pub promised_rel: f64,
    /// That of the spacing, by coarser runs; of steps, too, where they shrink with the spacing.
    pub space_rel: f64,
    /// That of the steps, by the same run with finer ones.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub time_rel: Option<f64>,
    /// What fronts felt where they are and at the centres of particles make of it; in the error of the spacing as far as it is one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub front_rel: Option<f64>,
    /// Standard deviation of one run between seeds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub noise_rel: Option<f64>,
}

/// Where the truth came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceInfo {
    /// `exact`, `similarity`, `table`, `measured` or `local`.
    pub kind: String,
    /// Paper, file or spacings.
    pub source: String,
    /// Estimated relative error of the reference itself: of the measure by which its scene is known, and of all others that
    /// `errors` does not name.
    pub error_estimate_rel: f64,
    /// Estimated error of the reference by measure, in the terms of that measure: `front`, `closure`, `volume`,
    /// `temperature`, `thickness`; of measured points also `thaw` and `saturation`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub errors: BTreeMap<String, f64>,
}

impl ReferenceInfo {
    /// A reference that knows all measures equally well.
    pub fn new(kind: &str, source: impl Into<String>, error_estimate_rel: f64) -> Self {
        ReferenceInfo { kind: kind.into(), source: source.into(), error_estimate_rel, errors: BTreeMap::new() }
    }

    /// Its own error for a measure.
    pub fn error_of(&self, measure: &str) -> f64 {
        self.errors.get(measure).copied().unwrap_or(self.error_estimate_rel)
    }
}

/// The record of one run: `record.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the program.
    pub frazil_version: String,
    /// Name of the scene.
    pub scene: String,
    /// Title of the scene.
    pub title: String,
    /// Hash of the scene file as it was run.
    pub scene_hash: String,
    /// Name of the method.
    pub method: String,
    /// All settings after defaults, by key.
    pub settings: BTreeMap<String, Value>,
    /// Whether the run is of unsaturated water: what are temperatures of others are its effective saturations.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub of_water: bool,
    /// Units of the numbers: `si`, `dpd` or `dimensionless`.
    pub units: String,
    /// Number of particles.
    pub particles: u64,
    /// Pairs that one evaluation visits (each pair once).
    pub pairs: u64,
    /// Steps made.
    pub steps: u64,
    /// Pairs evaluated in all.
    pub pair_evaluations: u64,
    /// Particles updated in all.
    pub particle_updates: u64,
    /// What the steps cost, in units that do not depend on the machine.
    #[serde(default)]
    pub work: Work,
    /// Longest step made (s).
    pub step_s: f64,
    /// Derived bound of the explicit step (s).
    pub step_bound_s: f64,
    /// What sets the bound.
    pub step_limit: String,
    /// Threads.
    pub threads: usize,
    /// Instructions that its kernels used: `avx512`, `avx2` or `portable`. They change no digit of a result.
    #[serde(default)]
    pub instruction_set: String,
    /// Seed of the noise.
    pub seed: u64,
    /// Wall time of particle generation, neighbours and weights (s).
    pub setup_wall_s: f64,
    /// CPU time of the same (s).
    pub setup_cpu_s: f64,
    /// Wall time of all steps (s).
    pub solve_wall_s: f64,
    /// CPU time of the same (s).
    pub solve_cpu_s: f64,
    /// Wall time of what watches read off the particles meanwhile (s); not part of the solution.
    #[serde(default)]
    pub observation_wall_s: f64,
    /// CPU time of it (s).
    #[serde(default)]
    pub observation_cpu_s: f64,
    /// Greatest resident memory of the process so far (bytes).
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub peak_memory_bytes: Option<u64>,
    /// How the run ended.
    pub outcome: Outcome,
    /// Why, if not `ok`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub cause: Option<String>,
    /// (stored - in) / exchanged, the largest over all outputs.
    pub energy_balance_rel: f64,
    /// (taken up - in) / exchanged of a solute, the largest over all outputs.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub solute_balance_rel: Option<f64>,
    /// How far temperatures left the range of the scene's data, over that range.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bounds_violation_rel: Option<f64>,
    /// How far the front went back, or heat flowed back through the coldest or warmest pipes, over the greatest before;
    /// absent where the data allow either way.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub setback_rel: Option<f64>,
    /// Errors against the reference.
    pub errors: Errors,
    /// How far it is off what was measured, by quantity (`front_m`, `temperature_c`, `saturation`, `events_s`) and in its unit.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub measured: BTreeMap<String, MeasuredErrors>,
    /// The error that was estimated of it, where one was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub estimated_error: Option<EstimatedError>,
    /// The reference.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reference: Option<ReferenceInfo>,
    /// The body that the scene describes and why a smaller one was run for it; absent if it was run itself.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reduced_from: Option<String>,
    /// Water, where it flows.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub water: Option<WaterRecord>,
    /// What a driven liquid came to.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub stream: Option<StreamRecord>,
    /// What has become of the frozen wall, where it is watched.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub wall: Option<WallRecord>,
    /// What the scene did not need and was spared.
    pub spared: Vec<String>,
    /// How the method differs from the scene, in words.
    pub differences: Vec<String>,
    /// What of the scene was not taken as it stands, in words: another reference than the one it names, or instants after
    /// the end.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub remarks: Vec<String>,
    /// Hash of the final enthalpies, as 16 hexadecimal digits.
    pub state_hash: String,
    /// Where it comes from, of a run by itself: what `frazil rerun` makes it again from.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub provenance: Option<Provenance>,
}
