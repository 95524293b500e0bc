//! What a run leaves behind: one record and the series beside it. Figures and studies read these, never particles.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::flow::series::{WaterRecord, WaterSeries};
use crate::method::Work;
use crate::stream::StreamRecord;

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Stopped by the user.
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

/// Where the truth came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceInfo {
    /// `exact`, `similarity`, `table` or `local`.
    pub kind: String,
    /// Paper, file or spacings.
    pub source: String,
    /// Estimated relative error of the reference itself: of the measure by which its scene is known, and of all others that
    /// `errors` does not name.
    pub error_estimate_rel: f64,
    /// Estimated error of the reference by measure, in the terms of that measure: `front`, `closure`, `volume`,
    /// `temperature`, `thickness`.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// (stored - in) / exchanged, the greatest over all outputs.
    pub energy_balance_rel: f64,
    /// How far temperatures left the range of the scene's data, over that range.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bounds_violation_rel: Option<f64>,
    /// How far the front went back, or heat flowed back through the coldest or warmest pipes, over the greatest before;
    /// absent where the data allow either way.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub setback_rel: Option<f64>,
    /// Errors against the reference.
    pub errors: Errors,
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
}

/// The frozen wall around the centre of a ring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WallRecord {
    /// Whether it stands closed at the end.
    pub closed: bool,
    /// When it first closed (s); absent if it never did.
    pub closure_s: Option<f64>,
    /// When it first opened again after that (s); absent if it did not.
    pub reopening_s: Option<f64>,
    /// From when to when it stood closed (s); without an end where it stands at the end of the run.
    pub standing_s: Vec<(f64, Option<f64>)>,
    /// Thickness at the end where it is weakest: frozen length on the least frozen way through it (m); 0 where it is open.
    pub thickness_m: f64,
    /// Mean temperature on that way; absent where the wall is open.
    pub mean_temperature_c: Option<f64>,
    /// The pipes between which it is weakest at the end, as `1.3`: the gap that the least frozen way crosses, or the widest open one.
    pub weakest_gap: Option<[String; 2]>,
    /// The pipes that were last to join all around; absent if they never did.
    pub last_gap: Option<[String; 2]>,
}

/// One row of `front.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrontRow {
    /// Time (s).
    pub time_s: f64,
    /// Integral of the frozen fraction along the freezing direction (m); of a radial body, the radius up to which, or
    /// from which on, the frozen volume fills it; of a rectangle that freezes from its corners, how far along diagonals.
    pub front_m: f64,
    /// The reference's.
    pub front_ref_m: Option<f64>,
}

/// What is frozen at the start of a run, from which on fronts and frozen volumes are judged.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Start {
    /// The front (m), where there is one.
    pub front_m: Option<f64>,
    /// The frozen volume (m3; m2 of a plane, m of a line).
    pub frozen_volume: f64,
}

/// One row of `front_beside.csv`: the front of another solution, which is drawn beside the reference and not judged by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BesideRow {
    /// Time (s).
    pub time_s: f64,
    /// Its front (m).
    pub front_m: f64,
    /// What it solves.
    pub solution: String,
}

/// One row of `frozen.csv`: a body of shells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrozenRow {
    /// Time (s).
    pub time_s: f64,
    /// Integral of the frozen fraction over the body (m3; m2 by length of the axis where the body is a line).
    pub frozen_volume: f64,
    /// The reference's.
    pub frozen_volume_ref: Option<f64>,
}

/// One row of `phases.csv`: shares of a volume whose particles are wholly liquid, freezing, wholly solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PhaseRow {
    /// Time (s).
    pub time_s: f64,
    /// Nothing of them frozen.
    pub liquid: f64,
    /// Part of them frozen.
    pub mushy: f64,
    /// All of them frozen.
    pub solid: f64,
}

/// One row of `stream.csv`: averages over a driven liquid, at a height.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StreamRow {
    /// Height (m).
    pub y_m: f64,
    /// Velocity along x (m/s).
    pub speed_m_per_s: f64,
    /// Density over that of the body evenly filled.
    pub density_rel: f64,
}

/// One row of `sections.csv`: averages across a driven liquid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SectionRow {
    /// Where the section is (m).
    pub x_m: f64,
    /// Height (m).
    pub y_m: f64,
    /// Temperature.
    pub temperature_c: f64,
    /// The reference's.
    pub temperature_ref_c: Option<f64>,
}

/// The direction over all of which a row of a profile is a mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeanOver {
    /// All x at one y.
    X,
    /// All y at one x.
    Y,
}

/// One row of `profiles.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProfileRow {
    /// Time (s).
    pub time_s: f64,
    /// Where the point is (m): x, or r of shells; absent of a mean over x.
    pub x_m: Option<f64>,
    /// Temperature.
    pub temperature_c: f64,
    /// The reference's.
    pub temperature_ref_c: Option<f64>,
    /// Frozen fraction.
    pub frozen_fraction: f64,
    /// `line` along the freezing direction, in a ring `main` (through a pipe) or `interface` (between two), of radial bodies
    /// `radius`, of cuts as `z=0.4`, where it is.
    pub plane: String,
    /// Where the point is (m): y, or z of shells; absent of a mean over y, and of bodies that have none.
    #[serde(default)]
    pub y_m: Option<f64>,
    /// Place along the profile (m): the coordinate along which it runs; in a ring, the distance from its centre.
    pub along_m: f64,
    /// Over what the row is a mean; absent for a point.
    #[serde(default)]
    pub mean_over: Option<MeanOver>,
}

/// One row of `probes.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProbeRow {
    /// Time (s).
    pub time_s: f64,
    /// Position (m).
    pub x_m: f64,
    /// Position (m).
    pub y_m: f64,
    /// Temperature.
    pub temperature_c: f64,
}

/// One row of `budget.csv`: the heat balance at an output, per metre (squared) of the missing dimensions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BudgetRow {
    /// Time (s).
    pub time_s: f64,
    /// Change of stored heat since the start (J).
    pub stored_j: f64,
    /// Heat in through each wall and pipe ring so far (J), in the order of [`RunResult::budget_names`].
    pub in_j: Vec<f64>,
    /// (stored - in) / exchanged.
    pub balance_rel: f64,
}

/// One row of `surfaces.csv`: heat through a surface at an output, the sum of what all pairs across it exchange.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceRow {
    /// Time (s).
    pub time_s: f64,
    /// The surface, as `r=0.3`.
    pub surface: String,
    /// Heat towards greater coordinates (W; by metre of each missing dimension).
    pub heat_w: f64,
    /// The same by area (W/m2).
    pub flux_w_per_m2: f64,
}

/// One row of `wall.csv`: the frozen wall of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WallRow {
    /// Time (s).
    pub time_s: f64,
    /// Frozen length on planes through a pipe, mean over the ring (m).
    pub thickness_main_mean_m: f64,
    /// The reference's.
    pub thickness_main_mean_ref_m: Option<f64>,
    /// Frozen length on planes between pipes, mean over the ring (m).
    pub thickness_interface_mean_m: f64,
    /// The reference's.
    pub thickness_interface_mean_ref_m: Option<f64>,
    /// Frozen area of the whole ring (m2).
    pub frozen_area_m2: f64,
    /// The reference's.
    pub frozen_area_ref_m2: Option<f64>,
    /// Heat taken by one pipe, mean over the ring (W/m).
    pub heat_per_pipe_w_per_m: f64,
    /// Whether a closed wall stands around the centre; absent where that is not watched.
    #[serde(default)]
    pub closed: Option<bool>,
    /// Thickness of the wall where it is weakest: frozen length on the least frozen way through it (m); 0 while it is open.
    #[serde(default)]
    pub thickness_weakest_m: Option<f64>,
}

/// One row of `gaps.csv`: when the gap between two neighbouring pipes closed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GapRow {
    /// Number of the gap, counted from the first pipe.
    pub gap: usize,
    /// The pipe before it, as `1.3`.
    #[serde(default)]
    pub from: String,
    /// The pipe after it.
    #[serde(default)]
    pub to: String,
    /// Angle of its middle (degrees).
    pub angle_deg: f64,
    /// How many gaps of the whole ring it stands for.
    pub multiplicity: usize,
    /// When the frozen bodies joined (s); absent if they did not.
    pub closure_s: Option<f64>,
    /// The reference's.
    pub closure_ref_s: Option<f64>,
}

/// One row of `links.csv`: two neighbouring pipes and when their frozen bodies joined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinkRow {
    /// One pipe, as `1.3`: ring and pipe, counted from 1.
    pub from: String,
    /// The other.
    pub to: String,
    /// Middle between them (m).
    pub x_m: f64,
    /// Middle between them (m).
    pub y_m: f64,
    /// Distance of their axes (m).
    pub distance_m: f64,
    /// When their frozen bodies joined (s); absent if they did not.
    pub closure_s: Option<f64>,
    /// When the middle of the arc between them was frozen (s), where both stand on a circle around the centre.
    #[serde(default)]
    pub closure_on_circle_s: Option<f64>,
}

/// One row of `planes.csv`: a section of the frozen wall at an output.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PlaneRow {
    /// Time (s).
    pub time_s: f64,
    /// `main` through the first pipe of the first ring, `interface` between it and the next, `wall` for all frozen ground, `weakest` along the
    /// least frozen way through the wall.
    pub plane: String,
    /// Where the frozen wall begins (m from the centre); absent where nothing is frozen, and for all frozen ground.
    pub inner_m: Option<f64>,
    /// Where it ends (m from the centre).
    pub outer_m: Option<f64>,
    /// Mean temperature of what is frozen, on `main` with the pipes and on `wall` without them; absent where nothing is.
    pub mean_temperature_c: Option<f64>,
    /// On `weakest`, the pipes between which it is: the gap that the way crosses, or the widest open one.
    #[serde(default)]
    pub from: String,
    /// The other pipe.
    #[serde(default)]
    pub to: String,
}

/// A temperature field on a regular grid; NaN outside the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Time (s).
    pub time_s: f64,
    /// Columns.
    pub nx: usize,
    /// Rows.
    pub ny: usize,
    /// Centre of the first cell (m).
    pub x0_m: f64,
    /// Centre of the first cell (m).
    pub y0_m: f64,
    /// Cell size (m).
    pub spacing_m: f64,
    /// Temperatures, row by row from the lowest y.
    pub temperature_c: Vec<f64>,
    /// Frozen fractions in the same order: their level 1/2 is the front, where the temperature is flat.
    pub frozen_fraction: Vec<f64>,
    /// Temperatures of the reference in the same order; empty where it knows none.
    pub temperature_ref_c: Vec<f64>,
}

/// Everything one run leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct RunResult {
    /// The record.
    pub record: Record,
    /// Front over time; empty where no front is defined.
    pub front: Vec<FrontRow>,
    /// What was frozen at the start.
    pub start: Start,
    /// The front of a solution that is shown beside the reference; mostly empty.
    pub beside: Vec<BesideRow>,
    /// Frozen volume of a body of shells over time; empty elsewhere.
    pub frozen: Vec<FrozenRow>,
    /// Phases over time, where the scene asks for them.
    pub phases: Vec<PhaseRow>,
    /// Velocities across a driven liquid.
    pub stream: Vec<StreamRow>,
    /// Temperatures across it.
    pub sections: Vec<SectionRow>,
    /// Profiles.
    pub profiles: Vec<ProfileRow>,
    /// Probes.
    pub probes: Vec<ProbeRow>,
    /// Heat through surfaces; empty where the scene names none.
    pub surfaces: Vec<SurfaceRow>,
    /// Names of walls and pipe rings in the heat balance.
    pub budget_names: Vec<String>,
    /// Heat balance.
    pub budget: Vec<BudgetRow>,
    /// Frozen wall of a ring; empty elsewhere.
    pub walls: Vec<WallRow>,
    /// Gaps of a ring; empty elsewhere.
    pub gaps: Vec<GapRow>,
    /// Neighbouring pipes of all rings, where the scene asks for them; of the whole plan, also where a part of it is run.
    pub links: Vec<LinkRow>,
    /// Sections of the frozen wall, where the scene asks for them.
    pub planes: Vec<PlaneRow>,
    /// Temperature fields at the profile instants; empty on a line.
    pub fields: Vec<Field>,
    /// Water over time, where it flows.
    pub water: Option<WaterSeries>,
}

impl RunResult {
    /// A record without any series.
    pub fn bare(record: Record) -> Self {
        RunResult {
            record,
            front: Vec::new(),
            start: Start::default(),
            beside: Vec::new(),
            frozen: Vec::new(),
            phases: Vec::new(),
            stream: Vec::new(),
            sections: Vec::new(),
            profiles: Vec::new(),
            probes: Vec::new(),
            surfaces: Vec::new(),
            budget_names: Vec::new(),
            budget: Vec::new(),
            walls: Vec::new(),
            gaps: Vec::new(),
            links: Vec::new(),
            planes: Vec::new(),
            fields: Vec::new(),
            water: None,
        }
    }
}
