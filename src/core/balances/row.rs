//! What the exchange beside water would do to a particle.

/// What the exchange would do to a particle, and what it may.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Row {
    /// Gain with all of the exchange (W/m3).
    pub gain: f64,
    /// What taking the exchange back would add and take (W/m3).
    pub up: f64,
    pub down: f64,
    /// Least and greatest enthalpy around (J/m3), of some partners where those of all are asked for only if need be.
    pub least: f64,
    pub most: f64,
}
