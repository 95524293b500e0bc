//! What a method may do instead of giving weights: make its own steps ([`Method`]).

use frazil_record::Work;

use crate::ledger::Ledger;
use crate::solvers::step::{Bound, Clock, StepError};

/// A method that owns its step: seam 1. One indirect call a step.
pub trait Method: Send {
    /// Longest stable step and its cause. It does not depend on the state.
    fn bound(&self) -> Bound;
    /// Longest step (s) of explicit Euler that is stable at all, if every particle conducts as well as it ever can: the
    /// sharp limit that [`Method::bound`] stays below. Found by iteration, so asked for only where it is shown.
    fn sharp_step(&mut self) -> f64;
    /// Advances the particles by one step of at most `clock.step`, and returns the step that it made (s): shorter
    /// where errors are controlled and the whole step would have been too coarse.
    fn advance(&mut self, particles: &mut crate::particles::Particles, clock: &Clock) -> Result<f64, StepError>;
    /// Brings the shared columns up to date before they are observed, for methods that keep others.
    fn publish(&mut self, _particles: &mut crate::particles::Particles) {}
    /// Heat that has come in through each wall and pipe so far.
    fn ledger(&self) -> &Ledger;
    /// Heat (W) through the surfaces that the scene names at a state and time (s), towards greater coordinates.
    fn across(&mut self, _enthalpy: &[f64], _time: f64) -> Vec<f64> {
        Vec::new()
    }
    /// Pairs that one evaluation visits.
    fn pairs(&self) -> u64;
    /// Bytes that the method holds on the heap; what particles hold is theirs.
    fn heap_size(&self) -> usize;
    /// Length (s) from which steps of a fixed length grow after a jump, for methods that are not monotone at their bound.
    fn gentle_step(&self) -> Option<f64> {
        None
    }
    /// Longest step (s) that the method would make now, where it chooses for itself.
    fn wanted_step(&self) -> f64 {
        f64::INFINITY
    }
    /// Whether states within the last step are known, so that steps need not land on outputs.
    fn is_dense(&self) -> bool {
        false
    }
    /// Enthalpies at `share` (0 to 1) of the last step, and the ledger there; only where [`Method::is_dense`] says so.
    fn between(&self, _particles: &crate::particles::Particles, _share: f64, _enthalpy: &mut [f64]) -> Ledger {
        self.ledger().clone()
    }
    /// Where water stands, for methods that move it.
    fn water(&self, _particles: &crate::particles::Particles) -> Option<Water> {
        None
    }
    /// Pressures (Pa) and Darcy velocities (m/s) of all particles, for methods that move water.
    fn water_fields(&self) -> Option<(Vec<f64>, Vec<glam::DVec2>)> {
        None
    }
    /// What the steps so far have cost.
    fn work(&self) -> Work;
}

/// Where water stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Water {
    /// Names of the walls that it crosses.
    pub walls: Vec<&'static str>,
    /// Inflow through each (m^d/s), negative where more leaves.
    pub inflow: Vec<f64>,
    /// All that enters (m^d/s).
    pub entering: f64,
    /// All that leaves (m^d/s).
    pub leaving: f64,
    /// (in - asked for by freezing and thawing) / exchanged, so far.
    pub balance: f64,
    /// (taken up by thawing - asked for) / exchanged, so far: what the next intervals have yet to bring.
    pub owed: f64,
    /// Ice (m^d).
    pub ice: f64,
    /// Liquid water (m^d).
    pub liquid: f64,
    /// Solutions for the pressure.
    pub solutions: u64,
    /// Iterations of all solutions.
    pub iterations: u64,
    /// Wall time of all solutions (s).
    pub seconds: f64,
}
