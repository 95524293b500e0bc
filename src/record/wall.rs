//! The frozen wall of a ring: what the record says of it, and its tables.

use serde::{Deserialize, Serialize};

/// The frozen wall around the centre of a ring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WallRecord {
    /// Whether it stands closed at the end.
    pub closed: bool,
    /// When it first closed (s), by the mean of gaps that are alike; absent if it never did.
    pub closure_s: Option<f64>,
    /// When it first opened again after that (s); absent if it did not.
    pub reopening_s: Option<f64>,
    /// From when to when it stood closed (s); without an end where it stands at the end of the run. It does not stand while an output
    /// sees a gap open, whatever its mean.
    pub standing_s: Vec<(f64, Option<f64>)>,
    /// Thickness at the end where it is weakest: frozen length on the least frozen way through it (m); 0 where it is open.
    pub thickness_m: f64,
    /// Mean temperature on that way; absent where the wall is open.
    pub mean_temperature_c: Option<f64>,
    /// The pipes between which it is weakest at the end, as `1.3`: the gap that the least frozen way crosses, or the widest open one.
    pub weakest_gap: Option<[String; 2]>,
    /// The pipes that were last to join all around; absent if they never did.
    pub last_gap: Option<[String; 2]>,
    /// How many gaps symmetry makes equal to that one, itself counted; `closure_s` is their mean.
    #[serde(default)]
    pub last_gap_alike: usize,
    /// Root mean square by which their own times differ from it (s).
    #[serde(default)]
    pub last_gap_spread_s: Option<f64>,
}

/// One row of `wall.csv`: the frozen wall of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WallRow {
    /// Time (s).
    pub time_s: f64,
    /// Frozen length on planes through a pipe, mean over the ring (m); none where none of them is off the centre.
    pub thickness_main_mean_m: Option<f64>,
    /// The reference's.
    pub thickness_main_mean_ref_m: Option<f64>,
    /// Frozen length on planes between pipes, mean over the ring (m); none where there are no such planes.
    pub thickness_interface_mean_m: Option<f64>,
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
    /// Angle of its middle in a ring (degrees).
    pub angle_deg: Option<f64>,
    /// Distance of its middle from the first pipe along a row (m).
    #[serde(default)]
    pub along_m: Option<f64>,
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
    /// Kind of gap: the row, counted from 1, of the first of those that symmetry makes equal.
    #[serde(default)]
    pub alike: usize,
    /// Mean of `closure_s` over all gaps of its kind: what differs between them is how the lattice lies to them (s); absent before
    /// all have closed.
    #[serde(default)]
    pub closure_alike_s: Option<f64>,
}

impl LinkRow {
    /// When gaps of its kind closed (s), their mean.
    pub fn closed_s(&self) -> Option<f64> {
        // Rows of earlier versions have no kinds.
        if self.alike == 0 { self.closure_s } else { self.closure_alike_s }
    }
}

/// One row of `front_lines.csv`: a point of the lines on which half is frozen, at an output; of the whole plan, also where a part of it
/// is run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FrontLineRow {
    /// Time (s).
    pub time_s: f64,
    /// Number of its line at this time, counted from 1. Of a closed line the first point is the last again.
    pub line: usize,
    /// Its place (m).
    pub x_m: f64,
    /// Its place (m).
    pub y_m: f64,
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
