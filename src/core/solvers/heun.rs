//! Heun's rule: the mean of the state and of two steps of Euler.

use frazil_record::Work;

use crate::ledger::Ledger;
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::Balance;
use crate::solvers::sharp::just_before;
use crate::solvers::solver::{Solver, SolverReport};
use crate::solvers::step::{Clock, StepError};

/// Heun's rule: of second order, and a mean of two states that each keep the range of the data, so it keeps it too (Shu and
/// Osher 1988).
pub struct Heun {
    balance: Box<dyn Balance>,
    ledger: Ledger,
    rate: Vec<f64>,
    start: Vec<f64>,
    patches: [Vec<f64>; 2],
    fraction: f64,
    steps: u64,
}

impl Heun {
    /// Steps of this fraction of the bound, for `count` particles.
    pub fn new(balance: Box<dyn Balance>, fraction: f64, count: usize) -> Self {
        let ledger = Ledger::new(balance.patches());
        let patches = std::array::from_fn(|_| vec![0.0; ledger.sources().len()]);
        Heun { balance, ledger, rate: vec![0.0; count], start: vec![0.0; count], patches, fraction, steps: 0 }
    }
}

impl Solver for Heun {
    fn report(&self) -> SolverReport {
        let facts = self.balance.facts();
        let work = Work { evaluations: 2 * self.steps, ..Work::default() };
        SolverReport { bound: facts.bound.clone(), pairs: facts.pairs, gentle_step: None, is_dense: false, work }
    }

    fn make_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let enthalpy = &mut particles.enthalpy;
        let step = self.balance.cut(clock.step);
        let Heun { balance, rate, start, patches: [first, second], .. } = self;
        start.copy_from_slice(enthalpy);
        balance.rates(enthalpy, &Clock { step, ..*clock }, rate, first);
        for (h, rate) in enthalpy.iter_mut().zip(rate.iter()) {
            *h += step * rate;
        }
        balance.rates(enthalpy, &Clock { step, time: just_before(clock.time, step), ..*clock }, rate, second);
        for ((h, start), rate) in enthalpy.iter_mut().zip(start).zip(rate) {
            *h = 0.5 * (*start + (*h + step * *rate));
        }
        for (patch, (first, second)) in self.patches[0].iter().zip(&self.patches[1]).enumerate() {
            self.ledger.book(patch, 0.5 * step * (first + second), step);
        }
        self.steps += 1;
        Ok(step)
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn wanted_step(&self) -> f64 {
        self.balance.wanted_step(self.fraction)
    }

    fn balance(&self) -> Option<&dyn Balance> {
        Some(self.balance.as_ref())
    }

    fn balance_mut(&mut self) -> Option<&mut dyn Balance> {
        Some(self.balance.as_mut())
    }
}

impl Saved for Heun {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.balance.pass(pass);
        pass.all(&mut [&mut self.ledger, &mut self.steps]);
    }
}

impl HeapSize for Heun {
    fn heap_size(&self) -> usize {
        self.balance.heap_size() + self.rate.heap_size() + self.start.heap_size()
    }
}
