//! Units of scenes and of the times that people speak of.

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

/// Unit in which people speak of the times of a scene; only figures and messages use it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds, or the scene's own dimensionless time.
    Second,
    /// Hours.
    Hour,
    /// Days.
    Day,
}

impl TimeUnit {
    /// Seconds in one unit.
    pub fn seconds(self) -> f64 {
        match self {
            TimeUnit::Second => 1.0,
            TimeUnit::Hour => 3600.0,
            TimeUnit::Day => 86400.0,
        }
    }

    /// Symbol for axis labels.
    pub fn symbol(self) -> &'static str {
        match self {
            TimeUnit::Second => "s",
            TimeUnit::Hour => "h",
            TimeUnit::Day => "d",
        }
    }
}
