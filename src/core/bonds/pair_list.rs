//! Bonds of any particles, in compressed rows.

/// Pairs of particles (and ghosts behind them) with their weights, in compressed rows.
#[derive(Debug, Clone, Default)]
pub struct PairList {
    /// Start of each particle's pairs, and the end of the last.
    pub starts: Vec<usize>,
    /// Partner: a particle, or `count` + a ghost.
    pub partners: Vec<u32>,
    /// Weight by volume (m^-2).
    pub weights: Vec<f64>,
}
