//! A balance and a passenger, one after the other.

use crate::kernels::flows::PairFlows;
use crate::ledger::Ledger;
use crate::memory::{HeapSize, total};
use crate::particles::Particles;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::Balance;
use crate::solvers::passenger::Interval;
use crate::solvers::solver::{Solver, SolverReport};
use crate::solvers::step::{Clock, StepError};

/// Steps of the passenger within one of the other that nobody waits for: the other has become faster by a hundred times in one step.
const ENDLESS: f64 = 1e5;

/// Whether the two share their steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coupling {
    /// The passenger makes as many steps as it needs, up to a thousand, within each step of the other.
    Sequential,
    /// Both make the same steps: the other's are no longer than the passenger's.
    Full,
}

impl Coupling {
    /// Both with the words of the file.
    pub const WORDS: [(&str, Coupling); 2] = [("sequential", Coupling::Sequential), ("full", Coupling::Full)];
}

/// Steps of the solute within one of water: whoever asks for a step gets it within a time.
const MOST_WITHIN: f64 = 1000.0;

/// Advances water, and then the solute that it has carried meanwhile: water does not see the solute, so nothing is lost by the
/// order but what the steps themselves cost.
pub struct Transport {
    water: Box<dyn Solver>,
    solute: Box<dyn Solver>,
    flows: PairFlows,
    coupling: Coupling,
    /// Share of the solute's bound that its explicit steps take.
    fraction: f64,
    /// Water contents of all particles where they carry nothing: what their own contents count from.
    saturated: Vec<f64>,
    /// Water contents at the start and at the end of a step.
    contents: [Vec<f64>; 2],
    steps: u64,
}

impl Transport {
    /// Water and a solute that rides on it. `saturated` are the water contents from which the contents of particles count.
    pub fn new(
        mut water: Box<dyn Solver>,
        solute: Box<dyn Solver>,
        flows: PairFlows,
        saturated: Vec<f64>,
        (coupling, fraction): (Coupling, f64),
    ) -> Self {
        water.keep_stages();
        let column = || vec![0.0; saturated.len()];
        Transport { water, solute, flows, coupling, fraction, contents: [column(), column()], saturated, steps: 0 }
    }

    /// Longest step (s) that the solute makes now.
    fn longest(&self) -> f64 {
        let bound = self.solute.report().bound.step;
        self.solute.wanted_step().min(self.fraction * bound)
    }

    /// Water contents of the particles.
    fn hold(&mut self, enthalpy: &[f64], end: usize) {
        for (content, (held, saturated)) in self.contents[end].iter_mut().zip(enthalpy.iter().zip(&self.saturated)) {
            *content = held + saturated;
        }
    }

    /// Advances the solute over what water has just done.
    fn follow(&mut self, particles: &mut Particles, clock: &Clock, made: f64) -> Result<(), StepError> {
        let Transport { water, solute, flows, contents, .. } = self;
        let stages = water.stages().iter();
        let flows = flows.take(stages.map(|stage| (stage.share, stage.time, &stage.state[..])));
        let [before, after] = &*contents;
        let interval = Interval { start: clock.time, step: made, flows, contents: (before, after) };
        if let Some(passenger) = solute.balance_mut().and_then(|balance| balance.passenger_mut()) {
            passenger.take(&interval);
        }
        std::mem::swap(&mut particles.enthalpy, &mut particles.solute);
        let end = clock.time + made;
        let (mut time, mut turned) = (clock.time, true);
        let mut made_all = Ok(());
        while time < end {
            let count = ((end - time) / self.longest() * (1.0 - 1e-12)).ceil().max(1.0);
            let step = (end - time) / count;
            if !count.is_finite() || count > ENDLESS || time + step <= time {
                made_all = Err(StepError::Passenger { step: made, needed: count, bound: self.solute.report().bound });
                break;
            }
            let own = Clock { time, step, index: self.steps, turned };
            match self.solute.make_step(particles, &own) {
                Ok(step) => time = if count == 1.0 && step == own.step { end } else { time + step },
                Err(error) => {
                    made_all = Err(error);
                    break;
                }
            }
            (self.steps, turned) = (self.steps + 1, false);
        }
        std::mem::swap(&mut particles.enthalpy, &mut particles.solute);
        made_all
    }
}

impl Solver for Transport {
    fn report(&self) -> SolverReport {
        let SolverReport { work, .. } = self.solute.report();
        let own = self.water.report();
        let work = frazil_record::Work { evaluations: own.work.evaluations + work.evaluations, ..own.work };
        // The solute is known at the ends of steps alone.
        SolverReport { is_dense: false, work, ..own }
    }

    fn make_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        self.hold(&particles.enthalpy, 0);
        let within = match self.coupling {
            Coupling::Sequential => MOST_WITHIN,
            Coupling::Full => 1.0,
        };
        let step = clock.step.min(within * self.longest());
        let clock = Clock { step, ..*clock };
        let made = self.water.make_step(particles, &clock)?;
        self.hold(&particles.enthalpy, 1);
        self.follow(particles, &clock, made)?;
        Ok(made)
    }

    fn ledger(&self) -> &Ledger {
        self.water.ledger()
    }

    fn wanted_step(&self) -> f64 {
        self.water.wanted_step()
    }

    fn publish(&mut self, particles: &mut Particles) {
        let Particles { solute, concentration, .. } = particles;
        if let Some(passenger) = self.solute.balance_mut().and_then(|balance| balance.passenger_mut()) {
            passenger.potentials(solute, concentration);
        }
    }

    fn balance(&self) -> Option<&dyn Balance> {
        self.water.balance()
    }

    fn balance_mut(&mut self) -> Option<&mut dyn Balance> {
        self.water.balance_mut()
    }

    fn passenger(&self) -> Option<&dyn Solver> {
        Some(self.solute.as_ref())
    }
}

impl Saved for Transport {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.water.pass(pass);
        self.solute.pass(pass);
        pass.all(&mut [&mut self.flows, &mut self.steps]);
    }
}

impl HeapSize for Transport {
    fn heap_size(&self) -> usize {
        let columns = total(&[&self.saturated, &self.contents]);
        self.water.heap_size() + self.solute.heap_size() + self.flows.heap_size() + columns
    }
}
