//! Units of scenes.

/// Units of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// SI: keys carry their unit (`spacing_m`, `duration_h`, `temperature_c`).
    Si,
    /// Units of dissipative particle dynamics (k_B = 1): keys carry no unit.
    Dpd,
    /// No dimensions at all: keys carry no unit.
    Dimensionless,
}

impl Units {
    /// The temperature of absolute zero on the scale of the scene.
    pub fn absolute_zero(self) -> f64 {
        match self {
            Units::Si => -273.15,
            Units::Dpd | Units::Dimensionless => 0.0,
        }
    }

    /// The word used in files and records.
    pub fn name(self) -> &'static str {
        match self {
            Units::Si => "si",
            Units::Dpd => "dpd",
            Units::Dimensionless => "dimensionless",
        }
    }
}
