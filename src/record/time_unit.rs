//! Units of the times that people speak of.

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
