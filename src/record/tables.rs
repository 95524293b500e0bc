//! Tables that runs of every kind may leave.

use serde::{Deserialize, Serialize};

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
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
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
    /// Temperature; of unsaturated water its effective saturation.
    pub temperature_c: f64,
    /// The reference's.
    pub temperature_ref_c: Option<f64>,
    /// Frozen fraction.
    pub frozen_fraction: f64,
    /// Concentration of the solute, where water carries one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub concentration: Option<f64>,
    /// The reference's.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub concentration_ref: Option<f64>,
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
    /// Temperature; of unsaturated water its effective saturation.
    pub temperature_c: f64,
    /// Concentration of the solute, where water carries one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub concentration: Option<f64>,
}

/// One row of `budget.csv`: the heat balance at an output, per metre (squared) of the missing dimensions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BudgetRow {
    /// Time (s).
    pub time_s: f64,
    /// Change of stored heat since the start (J).
    pub stored_j: f64,
    /// Heat in through each wall and pipe ring so far (J), in the order of [`crate::RunResult::budget_names`].
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

/// A temperature field on a regular grid; NaN outside the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    #[serde(with = "holes")]
    pub temperature_c: Vec<f64>,
    /// Frozen fractions in the same order: their level 1/2 is the front, where the temperature is flat.
    #[serde(with = "holes")]
    pub frozen_fraction: Vec<f64>,
    /// Concentrations of a solute in the same order; empty where there is none.
    #[serde(with = "holes", default)]
    pub concentration: Vec<f64>,
    /// Temperatures of the reference in the same order; empty where it knows none.
    #[serde(with = "holes")]
    pub temperature_ref_c: Vec<f64>,
}

/// Numbers of which some are none: JSON knows none that is not finite.
mod holes {
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(numbers: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(numbers.iter().map(|number| number.is_finite().then_some(*number)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let numbers = Vec::<Option<f64>>::deserialize(from)?;
        Ok(numbers.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }
}
