//! How flowing water is computed.

use crate::bonds::exchange::Mean;

/// Which temperature the water of a pair carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advection {
    /// The mean of both ends, as exact as conduction; it overshoots where water outruns conduction.
    Central,
    /// That of the end that it comes from: keeps the range of the data and smears fronts.
    Upwind,
    /// The mean, with as much exchange beside it as the range of the data needs and conduction does not give.
    Blended,
    /// As blended, with the exchange taken back wherever temperatures stay within those around (Zalesak 1979).
    Limited,
    /// The mean, with the water of a pair from the Darcy velocities of both ends (Nikolaev et al. 2021, eqs 37, 45).
    Paper,
}

impl Advection {
    /// All of them with the words of the file.
    pub const WORDS: [(&str, Advection); 5] = [
        ("central", Advection::Central),
        ("upwind", Advection::Upwind),
        ("blended", Advection::Blended),
        ("limited", Advection::Limited),
        ("paper", Advection::Paper),
    ];
}

/// Conduction beside flowing water.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conduction {
    /// What pairs exchange.
    Plain,
    /// The same without what long pairs make of the bend of profiles, within the range of the data.
    Corrected,
}

impl Conduction {
    /// Both with the words of the file.
    pub const WORDS: [(&str, Conduction); 2] = [("plain", Conduction::Plain), ("corrected", Conduction::Corrected)];
}

/// How flowing water is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowNumerics {
    /// Which temperature water carries.
    pub advection: Advection,
    /// Permeability of a pair by those of its ends.
    pub mean: Mean,
    /// Change of relative permeabilities, summed over particles and over their number across the body, from which the
    /// pressure is solved for again.
    pub pressure_change: f64,
    /// Longest time (s) between two solutions for the pressure.
    pub pressure_interval: f64,
}
