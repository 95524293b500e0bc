//! Water of a run: what the record says of it, and its tables.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Water of a run: `water` in `record.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WaterRecord {
    /// (in - asked for by freezing and thawing) / exchanged, the largest over all outputs.
    pub balance_rel: f64,
    /// (taken up by thawing - asked for) / exchanged at the end: what the next solutions would bring.
    pub owed_rel: f64,
    /// Solutions for the pressure.
    pub pressure_solutions: u64,
    /// Iterations of all solutions.
    pub pressure_iterations: u64,
    /// Wall time of all solutions (s).
    pub pressure_wall_s: f64,
    /// Times (s) of events: `thawed`, when the last particle passes the freezing point.
    pub events_s: BTreeMap<String, f64>,
    /// Errors against the reference: rms over the cut, the greatest over its instants, of temperatures over the range of
    /// the scene (`cut_temperature_rms_rel`) and of pressures over the range of the walls (`cut_pressure_rms_rel`); the
    /// greatest error of the ice fraction after a sixtieth of the run (`ice_fraction_max`); the relative error of the time of `thawed`.
    pub errors: BTreeMap<String, f64>,
}

/// One row of `water.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WaterRow {
    /// Time (s).
    pub time_s: f64,
    /// Ice (m3 by metre of each missing dimension).
    pub ice_m3: f64,
    /// Liquid water (m3).
    pub liquid_m3: f64,
    /// Ice over the ice of the scene at its start.
    pub ice_fraction: f64,
    /// The reference's.
    pub ice_fraction_ref: Option<f64>,
    /// Water that enters (m3/s).
    pub inflow_m3_per_s: f64,
    /// Water that leaves (m3/s).
    pub outflow_m3_per_s: f64,
    /// Heat in through walls, conducted and carried from the freezing point on (W).
    pub heat_in_w: f64,
    /// Coldest particle.
    pub least_temperature_c: f64,
    /// Water balance so far.
    pub balance_rel: f64,
}

/// One row of `cut.csv`: a point of the cut along x.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CutRow {
    /// Time (s).
    pub time_s: f64,
    /// Place (m).
    pub x_m: f64,
    /// Temperature.
    pub temperature_c: f64,
    /// The reference's.
    pub temperature_ref_c: Option<f64>,
    /// Frozen fraction.
    pub frozen_fraction: f64,
    /// Pressure (Pa).
    pub pressure_pa: f64,
    /// The reference's.
    pub pressure_ref_pa: Option<f64>,
    /// Darcy velocity along x (m/s).
    pub velocity_x_m_per_s: f64,
}

/// One row of `flow.csv`: a particle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FlowPoint {
    /// Time (s).
    pub time_s: f64,
    /// Place (m).
    pub x_m: f64,
    /// Place (m).
    pub y_m: f64,
    /// Temperature.
    pub temperature_c: f64,
    /// Frozen fraction.
    pub frozen_fraction: f64,
    /// Pressure (Pa).
    pub pressure_pa: f64,
    /// Darcy velocity (m/s).
    pub velocity_x_m_per_s: f64,
    /// Darcy velocity (m/s).
    pub velocity_y_m_per_s: f64,
}

/// Water of a run over time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WaterSeries {
    /// At all outputs.
    pub rows: Vec<WaterRow>,
    /// The cut at the profile instants.
    pub cut: Vec<CutRow>,
    /// All particles at the profile instants.
    pub maps: Vec<FlowPoint>,
}
