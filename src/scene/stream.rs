//! A liquid that is driven along x.

/// What drives a liquid along x, between walls below and above.
#[derive(Debug, Clone, PartialEq)]
pub struct Stream {
    /// Acceleration along x (m/s2).
    pub acceleration: f64,
    /// Greatest velocity (m/s) of the parabola across that the liquid starts with.
    pub start_speed: f64,
    /// Where it acts (m along x); everywhere if absent.
    pub pump: Option<(f64, f64)>,
    /// Where the liquid is set to a temperature (m along x), and which.
    pub reset: Option<((f64, f64), f64)>,
    /// Where temperatures across the stream are kept (m along x).
    pub sections: Vec<f64>,
    /// From when on, and until when, velocities and temperatures are averaged (s).
    pub average: (f64, f64),
}

impl Stream {
    /// Whether the acceleration acts everywhere.
    pub fn is_even(&self) -> bool {
        self.pump.is_none()
    }
}
