//! Explicit Euler.

use frazil_record::Work;

use crate::ledger::Ledger;
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::{Balance, Update};
use crate::solvers::kept::Kept;
use crate::solvers::solver::{Solver, SolverReport};
use crate::solvers::step::{Clock, StepError};

/// Explicit Euler: at its bound it keeps the maximum principle.
pub struct Euler {
    balance: Box<dyn Balance>,
    ledger: Ledger,
    patches: Vec<f64>,
    fraction: f64,
    steps: u64,
    kept: Option<Kept>,
    /// Whether a companion follows the balance: asked for once.
    is_followed: bool,
}

impl Euler {
    /// Steps of this fraction of the bound.
    pub fn new(balance: Box<dyn Balance>, fraction: f64) -> Self {
        let ledger = Ledger::new(balance.patches());
        let patches = vec![0.0; ledger.sources().len()];
        let is_followed = balance.companion().is_some();
        Euler { balance, ledger, patches, fraction, steps: 0, kept: None, is_followed }
    }

    /// The same for so many particles and so many steps that rounding would show in the balance: what it takes from a step is
    /// kept for the next.
    pub fn compensated(balance: Box<dyn Balance>, fraction: f64, count: usize) -> Self {
        Euler { kept: Some(Kept::new(count)), ..Euler::new(balance, fraction) }
    }
}

impl Solver for Euler {
    fn report(&self) -> SolverReport {
        let facts = self.balance.facts();
        let work = Work { evaluations: self.steps, ..Work::default() };
        SolverReport { bound: facts.bound.clone(), pairs: facts.pairs, gentle_step: None, is_dense: false, work }
    }

    fn make_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let step = if self.is_followed { self.balance.cut(clock.step) } else { clock.step };
        let (contents, clock) = (&mut particles.enthalpy, Clock { step, ..*clock });
        match &mut self.kept {
            None => self.balance.advance(Update::Euler(contents), &clock, &mut self.patches),
            Some(kept) => self.balance.advance_keeping(contents, kept, &clock, &mut self.patches),
        }
        for (patch, rate) in self.patches.iter().enumerate() {
            self.ledger.book(patch, rate * step, step);
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

impl Saved for Euler {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.balance.pass(pass);
        pass.all(&mut [&mut self.ledger, &mut self.steps]);
        if let Some(kept) = &mut self.kept {
            kept.pass(pass);
        }
    }
}

impl HeapSize for Euler {
    fn heap_size(&self) -> usize {
        self.balance.heap_size() + self.kept.as_ref().map_or(0, HeapSize::heap_size)
    }
}
