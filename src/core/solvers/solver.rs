//! How the state of all particles is advanced.

use frazil_record::Work;
use glam::DVec2;

use crate::ledger::Ledger;
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::saved::Saved;
use crate::solvers::balance::{Balance, Rates};
use crate::solvers::sharp::sharp_step;
use crate::solvers::step::{Bound, Clock, StepError};
use crate::space::wall::WallId;

/// What a solver is, and what it has done.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverReport {
    /// Longest stable step and its cause.
    pub bound: Bound,
    /// Pairs that one evaluation visits.
    pub pairs: u64,
    /// Length (s) from which steps of a fixed length grow after a jump, for solvers that are not monotone at their bound.
    pub gentle_step: Option<f64>,
    /// Whether states within the last step are known, so that steps need not land on outputs.
    pub is_dense: bool,
    /// What the steps so far have cost.
    pub work: Work,
}

/// A state that a step was made of.
#[derive(Debug, Clone, Default)]
pub struct KeptStage {
    /// Share of its rates in the step.
    pub share: f64,
    /// When its rates were taken (s).
    pub time: f64,
    /// The contents.
    pub state: Vec<f64>,
}

/// Makes steps: of a balance, or of its own. One indirect call a step.
pub trait Solver: HeapSize + Saved + Send {
    /// What it is, and what it has done.
    fn report(&self) -> SolverReport;
    /// Makes one step of at most `clock.step`, and returns the step that it made (s): shorter where errors are controlled
    /// and the whole step would have been too coarse.
    fn make_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError>;
    /// Heat that has come in through each patch so far.
    fn ledger(&self) -> &Ledger;
    /// Longest step (s) that it would make now, where it chooses for itself.
    fn wanted_step(&self) -> f64 {
        f64::INFINITY
    }
    /// Brings the shared columns up to date before they are observed, where it keeps others.
    fn publish(&mut self, _particles: &mut Particles) {}
    /// Enthalpies at `share` (0 to 1) of the last step, and the ledger there, where states within it are known.
    fn between(&self, _particles: &Particles, _share: f64, _enthalpy: &mut [f64]) -> Ledger {
        self.ledger().clone()
    }
    /// Keeps the states that steps are made of from now on, where it can.
    fn keep_stages(&mut self) {}
    /// The states that the last step was made of, where they are kept: its change is the mean of their rates by their shares.
    fn stages(&self) -> &[KeptStage] {
        &[]
    }
    /// What rides on its balance.
    fn passenger(&self) -> Option<&dyn Solver> {
        None
    }
    /// The balance that it advances, if it is one that others could advance.
    fn balance(&self) -> Option<&dyn Balance> {
        None
    }
    /// The same, to be evaluated.
    fn balance_mut(&mut self) -> Option<&mut dyn Balance> {
        None
    }
}

impl dyn Solver + '_ {
    /// Advances the particles by one step of at most `clock.step`: first what follows their state at once, then the state
    /// itself. Returns the step that was made (s).
    pub fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let Some(companion) = self.balance_mut().and_then(|balance| balance.companion_mut()) else {
            return self.make_step(particles, clock);
        };
        // Where what flows has changed, rates that were taken before do not hold any more.
        let turned = companion.begin(&particles.enthalpy, clock)? || clock.turned;
        let made = self.make_step(particles, &Clock { turned, ..*clock })?;
        if let Some(companion) = self.balance_mut().and_then(|balance| balance.companion_mut()) {
            companion.kept(made);
        }
        Ok(made)
    }

    /// Longest stable step and its cause.
    pub fn bound(&self) -> Bound {
        self.report().bound
    }

    /// Longest step (s) of explicit Euler that is stable at all, if every particle conducts as well as it ever can: the
    /// sharp limit that the bound stays below. Found by iteration, so asked for only where it is shown.
    pub fn sharp_step(&mut self) -> f64 {
        let bound = self.bound().step;
        self.balance_mut().map_or(bound, |balance| sharp_step(balance.tangent()))
    }

    /// Heat (W) through the surfaces that the scene names at a state and time (s), towards greater coordinates.
    pub fn across(&mut self, enthalpy: &[f64], time: f64) -> Vec<f64> {
        let Some(balance) = self.balance_mut() else { return Vec::new() };
        let (patches, surfaces) = (balance.patches().len(), balance.facts().surfaces);
        let mut across = vec![0.0; surfaces];
        if surfaces > 0 {
            let (mut of_particles, mut patches) = (vec![0.0; enthalpy.len()], vec![0.0; patches]);
            let clock = Clock { time, step: balance.step_bound(), index: 0, turned: false };
            let mut rates = Rates { of_particles: &mut of_particles, patches: &mut patches, surfaces: &mut across };
            balance.rate(enthalpy, &clock, &mut rates);
        }
        across
    }

    /// Where water stands, where it flows.
    pub fn water(&self, particles: &Particles) -> Option<Water> {
        Some(self.balance()?.companion()?.water(particles))
    }

    /// Pressures (Pa) and Darcy velocities (m/s) of all particles, where water flows.
    pub fn water_fields(&self) -> Option<(Vec<f64>, Vec<DVec2>)> {
        Some(self.balance()?.companion()?.water_fields())
    }
}

/// Where water stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Water {
    /// Names of the walls that it crosses.
    pub walls: Vec<WallId>,
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
