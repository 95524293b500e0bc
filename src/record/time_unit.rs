//! Units of the times that people speak of.

/// Unit in which people speak of the times of a scene; only figures and messages use it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds, or the scene's own dimensionless time.
    Second,
    /// Minutes.
    Minute,
    /// Hours.
    Hour,
    /// Days.
    Day,
    /// Years of 365.25 days.
    Year,
}

impl TimeUnit {
    /// All, from short to long.
    pub const ALL: [TimeUnit; 5] = [TimeUnit::Second, TimeUnit::Minute, TimeUnit::Hour, TimeUnit::Day, TimeUnit::Year];

    /// How names of keys and columns in this unit end.
    pub fn ending(self) -> &'static str {
        match self {
            TimeUnit::Second => "s",
            TimeUnit::Minute => "minutes",
            TimeUnit::Hour => "h",
            TimeUnit::Day => "days",
            TimeUnit::Year => "years",
        }
    }

    /// Seconds in one unit.
    pub fn seconds(self) -> f64 {
        match self {
            TimeUnit::Second => 1.0,
            TimeUnit::Minute => 60.0,
            TimeUnit::Hour => 3600.0,
            TimeUnit::Day => 86400.0,
            TimeUnit::Year => 31_557_600.0,
        }
    }

    /// Symbol for axis labels.
    pub fn symbol(self) -> &'static str {
        match self {
            TimeUnit::Second => "s",
            TimeUnit::Minute => "min",
            TimeUnit::Hour => "h",
            TimeUnit::Day => "d",
            TimeUnit::Year => "yr",
        }
    }
}
