//! The two seams of the program: what a method must say ([`PairWeight`]) and what it may do instead ([`Method`]).

use frazil_record::Work;

use crate::ledger::Ledger;

/// Geometry of a pair: seam 2. A weight knows the distance of two particles and nothing of heat.
///
/// A scaled weight `w(r)` (m^-(d+2)) enters the heat balance of particle i as
/// `V_i dH_i/dt = sum_j V_i V_j w(r_ij) (U_j - U_i)`, so in the continuum `integral of w r^2 dV = 2 d`.
/// It must not be negative, and should not grow with distance: a mirror wall then keeps the maximum principle, for a
/// particle is nearer to its neighbour than to the neighbour's image. Corners of two walls see to themselves
/// ([`crate::corner`]).
pub trait PairWeight: Send + Sync {
    /// Distance (m) beyond which the weight is zero.
    fn reach(&self) -> f64;
    /// The weight at a distance (m) greater than zero.
    fn weight(&self, distance: f64) -> f64;
}

/// How weights are scaled to the wanted conductivity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normalisation {
    /// By the second moment of the actual neighbourhood: exact for quadratic fields on a lattice.
    DiscreteMoment,
    /// Not at all: the continuum constant, as the papers print it.
    Nominal,
}

/// Where a run stands in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Time at the start of the step (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
    /// Number of steps made before this one.
    pub index: u64,
    /// Whether walls or pipes may have jumped since the last step.
    pub turned: bool,
}

/// The explicit limit of a step, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Longest stable step (s).
    pub step: f64,
    /// What sets it, in words, with the particle.
    pub cause: String,
}

/// A step that could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct StepError {
    /// What went wrong, in words.
    pub reason: String,
}

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
    fn held(&self) -> usize;
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
    fn water(&self, _particles: &crate::particles::Particles) -> Option<crate::flow::Water> {
        None
    }
    /// Pressures (Pa) and Darcy velocities (m/s) of all particles, for methods that move water.
    fn water_fields(&self) -> Option<(Vec<f64>, Vec<glam::DVec2>)> {
        None
    }
    /// What the steps so far have cost.
    fn work(&self) -> Work;
}
