//! A driven liquid: what the record says of it, and its tables.

use serde::{Deserialize, Serialize};

/// What a stream came to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StreamRecord {
    /// Greatest velocity of the fitted parabola (m/s).
    pub greatest_speed_m_per_s: f64,
    /// Rms of the distance of velocities from the parabola over its greatest.
    pub speed_rms_rel: f64,
    /// Kinematic viscosity (m2/s), where the acceleration acts everywhere.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub kinematic_viscosity_m2_per_s: Option<f64>,
    /// Greatest difference of the density from its mean in the layers beside the walls, over the mean.
    pub wall_density_rel: f64,
    /// Rms of the temperature error over all sections over the range of the scene's temperatures.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub temperature_rms_rel: Option<f64>,
    /// Greatest temperature error in sections over that range.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub temperature_max_rel: Option<f64>,
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
