//! A semi-discrete balance: the seam between what particles exchange and how time advances.

use crate::instruction_set::widest;
use crate::ledger::Source;
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::parts::{PART, in_parts};
use crate::saved::Saved;
use crate::solvers::kept::Kept;
use crate::solvers::passenger::Passenger;
use crate::solvers::solver::Water;
use crate::solvers::step::{Bound, Clock, StepError};
use crate::team::Team;

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

    /// Puts the next stage in the place of the oldest, by the rates (W/m3) one stage back.
    pub fn take(&self, team: Option<&Team>, columns: &mut StageColumns<'_>, rates: &[f64]) {
        let StageColumns { newest, start, first, .. } = *columns;
        let parts = columns.oldest.chunks_mut(PART).enumerate();
        in_parts(team, newest.len(), parts, |(number, oldest)| {
            let part = number * PART..number * PART + oldest.len();
            let [newest, start, first, rates] = [newest, start, first, rates].map(|column| &column[part.clone()]);
            take_widely(self, oldest, [newest, start, rates, first]);
        });
    }
}

widest!(take_widely, take, (stage: &Stage, oldest: &mut [f64], columns: [&[f64]; 4]));

/// Puts the next stage in the place of the oldest.
#[inline(always)]
fn take(stage: &Stage, oldest: &mut [f64], [newest, start, rates, first]: [&[f64]; 4]) {
    let (states, rates) = (newest.iter().zip(start), rates.iter().zip(first));
    for (out, ((newest, start), (rate, first))) in oldest.iter_mut().zip(states.zip(rates)) {
        *out =
            stage.newest * newest + stage.oldest * *out + stage.start * start + stage.rate * rate + stage.first * first;
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

/// What is advanced in one pass, evaluation and update together.
pub enum Update<'a, 'b> {
    /// A step of explicit Euler in place, as long as the clock says.
    Euler(&'a mut [f64]),
    /// A stage of a Runge-Kutta chain, its rate taken at the time of the clock.
    Stage(&'a Stage, &'a mut StageColumns<'b>),
}

/// What one evaluation gives.
pub struct Rates<'a> {
    /// Of each particle (W/m3).
    pub of_particles: &'a mut [f64],
    /// Heat in through each patch (W).
    pub patches: &'a mut [f64],
    /// Heat (W) through the surfaces that the scene names, towards greater coordinates; empty where nobody asks.
    pub surfaces: &'a mut [f64],
}

/// What a balance is.
#[derive(Debug, Clone, PartialEq)]
pub struct BalanceFacts {
    /// The patches: walls, then rings of pipes, then what else brings heat.
    pub patches: Vec<Source>,
    /// Pairs that one evaluation visits.
    pub pairs: u64,
    /// Surfaces through which heat is counted.
    pub surfaces: usize,
    /// Longest explicit step that keeps the maximum principle, by the row sums of the actual pairs.
    pub bound: Bound,
    /// Fastest rate (1/s) at which what is carried along turns patterns: the half height of the spectrum, which conduction
    /// alone leaves on the real axis.
    pub turning: f64,
}

/// `dX/dt` of all particles as a function of their contents and time, with what comes in through each patch.
pub trait Balance: HeapSize + Saved + Send {
    /// What it is; the bound follows what a companion does.
    fn facts(&self) -> &BalanceFacts;
    /// What brings heat: the patches of the facts, then what is released inside the body.
    fn patches(&self) -> Vec<Source> {
        self.facts().patches.clone()
    }
    /// Rates at a state, for a step as long as the clock says from its time on.
    fn rate(&mut self, enthalpy: &[f64], clock: &Clock, rates: &mut Rates<'_>);
    /// A step of Euler or a stage of a chain; `patches` takes the heat in through each patch (W).
    fn advance(&mut self, update: Update<'_, '_>, clock: &Clock, patches: &mut [f64]);
    /// A step of Euler as long as the clock says, with what rounding takes from contents kept in `kept` for the next.
    fn advance_keeping(&mut self, contents: &mut [f64], kept: &mut Kept, clock: &Clock, patches: &mut [f64]) {
        let mut rates = Rates { of_particles: kept.rates(contents.len()), patches, surfaces: &mut [] };
        self.rate(contents, clock, &mut rates);
        kept.add(contents, clock.step);
    }
    /// Time (s) after which, if the rates go on, a front next enters or leaves a particle: there rates have a kink. No less than a time
    /// within which it is asked for where none does, or where so many particles freeze that steps cannot end there.
    fn next_kink(&self, _enthalpy: &[f64], _rates: &[f64], _within: f64) -> f64 {
        f64::INFINITY
    }
    /// The same for small changes.
    fn tangent(&mut self) -> &mut dyn Tangent;
    /// Threads that share its steps, if those are worth sharing.
    fn team(&self) -> Option<&Team> {
        None
    }
    /// Another balance, which follows this one at once.
    fn companion(&self) -> Option<&dyn Companion> {
        None
    }
    /// The same, to be solved.
    fn companion_mut(&mut self) -> Option<&mut dyn Companion> {
        None
    }
    /// The same as what rides on another balance, if it does.
    fn passenger_mut(&mut self) -> Option<&mut dyn Passenger> {
        None
    }
}

/// How the linearised exchange is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TangentShape {
    /// Whether [`Tangent::act`] is a symmetric matrix.
    pub is_symmetric: bool,
    /// Whether it is the same for all states and times.
    pub is_constant: bool,
    /// Whether the exchange follows contents otherwise than by their potentials, so steeply in places that a whole step may lead
    /// away from the solution.
    pub is_steep: bool,
    /// Greatest distance in the numbering of particles over which it reaches.
    pub bandwidth: usize,
}

/// A balance around a state.
pub trait Tangent {
    /// How the exchange of small changes is built.
    fn shape(&mut self) -> TangentShape;
    /// Linearises at a state and time (s): `slopes` takes dU/dH (m2/s) of every particle, and [`Tangent::act`] stands for the
    /// exchange of small changes from now on.
    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]);
    /// Rates (W/m3) that small changes of the potentials (W/m) cause, by the last linearisation.
    fn act(&mut self, potentials: &[f64], rate: &mut [f64]);
    /// The largest slope dU/dH (m2/s) with which each particle can answer.
    fn steepest(&mut self) -> Vec<f64>;
    /// Takes changes of contents that the system linearised at a state wants into it; `slopes` are those of the linearisation,
    /// the weights that of the rates in the system (s) and the largest row sum of the exchange (1/m2).
    fn take(&self, state: &mut [f64], changes: &[f64], slopes: &[f64], weights: (f64, f64)) {
        let _ = (slopes, weights);
        state.iter_mut().zip(changes).for_each(|(state, change)| *state += change);
    }
}

/// A balance without a content of its own: it follows the state of another at once, is solved between its steps, and is
/// seen frozen within them.
pub trait Companion {
    /// Follows a state before a step, if it has changed enough; whether it has.
    fn begin(&mut self, enthalpy: &[f64], clock: &Clock) -> Result<bool, StepError>;
    /// Takes note of a step that was made (s).
    fn kept(&mut self, step: f64);
    /// How long (s) it may stay frozen from now on, as far as its last changes tell.
    fn lasts(&self) -> f64;
    /// Where water stands.
    fn water(&self, particles: &Particles) -> Water;
    /// Pressures (Pa) and Darcy velocities (m/s) of all particles.
    fn water_fields(&self) -> (Vec<f64>, Vec<glam::DVec2>);
}

impl dyn Balance + '_ {
    /// Rates (W/m3) of all particles at a state; `patches` takes the heat in through each patch (W).
    pub fn rates(&mut self, enthalpy: &[f64], clock: &Clock, rate: &mut [f64], patches: &mut [f64]) {
        self.rate(enthalpy, clock, &mut Rates { of_particles: rate, patches, surfaces: &mut [] });
    }

    /// The longest step (s) that keeps the maximum principle now.
    pub fn step_bound(&self) -> f64 {
        self.facts().bound.step
    }

    /// A step (s) that was chosen before a companion followed, cut to what the bound is since then.
    pub fn cut(&self, step: f64) -> f64 {
        if self.companion().is_some() { step.min(self.step_bound()) } else { step }
    }

    /// The longest step (s) that steps of a fraction of a moving bound would make now.
    pub fn wanted_step(&self, fraction: f64) -> f64 {
        if self.companion().is_some() { fraction * self.step_bound() } else { f64::INFINITY }
    }

    /// How long (s) what follows this balance may stay frozen.
    pub fn companion_lasts(&self) -> f64 {
        self.companion().map_or(f64::INFINITY, |companion| companion.lasts())
    }
}
