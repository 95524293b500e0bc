//! The semi-discrete heat balance: the seam between what particles exchange and how time advances.

use crate::solvers::step::Bound;

/// Coefficients of one stage of a two-term Runge-Kutta chain:
/// `next = newest Y(j-1) + oldest Y(j-2) + start Y(0) + rate F(Y(j-1)) + first F(Y(0))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Of the state one stage back.
    pub newest: f64,
    /// Of the state two stages back.
    pub oldest: f64,
    /// Of the state at the start of the step.
    pub start: f64,
    /// Of the rate one stage back (s).
    pub rate: f64,
    /// Of the rate at the start of the step (s).
    pub first: f64,
}

impl Stage {
    /// All of a stage but its rate, by the states one and two stages back and at the start, and the rate at the start.
    #[inline(always)]
    pub fn without_rate(&self, (newest, oldest, start): (f64, f64, f64), first: f64) -> f64 {
        self.newest * newest + self.oldest * oldest + self.start * start + self.first * first
    }
}

/// States that a stage reads, and the one that it replaces.
pub struct StageColumns<'a> {
    /// One stage back.
    pub newest: &'a [f64],
    /// Two stages back; takes the new stage.
    pub oldest: &'a mut [f64],
    /// At the start of the step.
    pub start: &'a [f64],
    /// Rates at the start of the step (W/m3).
    pub first: &'a [f64],
}

/// `dH/dt` of all particles as a function of their enthalpies and time, with the heat through each patch.
pub trait Operator: Send {
    /// Rates (W/m3) of all particles at a state and time (s); `patches` takes the heat in through each patch (W).
    fn rate(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64], patches: &mut [f64]);
    /// One step of explicit Euler in place.
    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, patches: &mut [f64]);
    /// One stage of a Runge-Kutta chain, its rate taken at `time` (s).
    fn stage(&mut self, stage: &Stage, columns: &mut StageColumns<'_>, time: f64, patches: &mut [f64]);
    /// Linearises at a state and time: `slopes` takes dU/dH (m2/s) of every particle, and [`Operator::act`] stands for
    /// the exchange of small changes from now on.
    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]);
    /// Rates (W/m3) that small changes of the potentials (W/m) cause, by the last linearisation.
    fn act(&mut self, potentials: &[f64], rate: &mut [f64]);
    /// Whether [`Operator::act`] is a symmetric matrix.
    fn is_symmetric(&self) -> bool;
    /// Whether [`Operator::act`] is the same for all states and times.
    fn is_constant(&self) -> bool;
    /// Greatest distance in the numbering of particles over which [`Operator::act`] reaches.
    fn bandwidth(&self) -> usize;
    /// The largest slope dU/dH (m2/s) with which each particle can answer.
    fn steepest(&self) -> Vec<f64>;
    /// Longest explicit step that keeps the maximum principle, by the row sums of the actual pairs.
    fn bound(&self) -> Bound;
    /// Heat (W) through the surfaces that the scene names, towards greater coordinates. Only lists know surfaces.
    fn across(&mut self, _enthalpy: &[f64], _time: f64) -> Vec<f64> {
        Vec::new()
    }
    /// Names of the patches: walls, then pipe rings.
    fn patches(&self) -> Vec<String>;
    /// Pairs that one evaluation visits.
    fn pairs(&self) -> u64;
    /// Bytes that the operator holds on the heap; what particles hold is theirs.
    fn heap_size(&self) -> usize;
}
