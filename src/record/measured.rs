//! What instruments measured, beside what a run found at the same instants and places.

use serde::{Deserialize, Serialize};

/// One row of `measured.csv`: a measured value and the run's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredRow {
    /// What was measured, with its unit: `front_m`, `temperature_c`, `saturation`, or the time of an event, as `thawed_s`.
    pub quantity: String,
    /// When it was measured (s).
    pub time_s: f64,
    /// Place of a probe (m).
    pub x_m: Option<f64>,
    /// Place of a probe (m).
    pub y_m: Option<f64>,
    /// The run's; absent where it ended before, or the event did not come about.
    pub value: Option<f64>,
    /// The measured one.
    pub value_ref: f64,
    /// Its standard deviation.
    pub value_ref_sd: f64,
}

impl MeasuredRow {
    /// Under which quantity it is counted in the record: events together, others by their names.
    pub fn group(&self) -> &str {
        if self.is_event() { EVENTS } else { &self.quantity }
    }

    /// Whether it is the time of an event.
    pub fn is_event(&self) -> bool {
        self.quantity.ends_with("_s")
    }

    /// Whether it is what a probe reads.
    pub fn is_of_probe(&self) -> bool {
        self.x_m.is_some()
    }

    /// How far the run is off, in the unit of the quantity.
    pub fn difference(&self) -> Option<f64> {
        Some(self.value? - self.value_ref)
    }
}

/// The quantity under which events are counted.
const EVENTS: &str = "events_s";

/// How far a run is off what was measured, of one quantity and in its unit: `measured` in `record.json`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredErrors {
    /// Points that the run has a value for.
    pub points: usize,
    /// Points that it has none for.
    pub missing: usize,
    /// Rms of the differences.
    pub rms: f64,
    /// Largest magnitude of a difference.
    pub max: f64,
    /// Mean of the differences, positive where the run is above what was measured.
    pub mean: f64,
    /// Rms of the standard deviations: a run that is right is off by about as much.
    pub sd_rms: f64,
    /// Rms of the differences over their standard deviations: 1 where they are what the instrument explains (the root of chi squared
    /// by point).
    pub rms_over_sd: f64,
    /// Share of the points that are off by one standard deviation at most: about 0.68 where errors of the instrument are normal.
    pub within_sd: f64,
    /// Share of those that are off by two at most: about 0.95.
    pub within_2sd: f64,
}
