//! Time integrators over an [`Operator`], and the methods that they make.

use frazil_record::Work;

use crate::kernels::enthalpy_rows::Tangent;
use crate::kernels::rows::ListOperator;
use crate::kernels::term::PairTerm;
use crate::ledger::Ledger;
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::physics::latent_heat::SchemeState;
use crate::solvers::method::Method;
use crate::solvers::operator::Operator;
use crate::solvers::sharp::{sharp_step, stable_step};
use crate::solvers::step::{Bound, Clock, StepError};

/// Explicit Euler: at its bound it keeps the maximum principle.
pub struct Euler {
    operator: Box<dyn Operator>,
    ledger: Ledger,
    patches: Vec<f64>,
    steps: u64,
}

impl Euler {
    /// Euler steps of an operator.
    pub fn new(operator: Box<dyn Operator>) -> Self {
        let ledger = Ledger::new(operator.patches());
        let patches = vec![0.0; ledger.names().len()];
        Euler { operator, ledger, patches, steps: 0 }
    }
}

impl Method for Euler {
    fn bound(&self) -> Bound {
        self.operator.bound()
    }

    fn sharp_step(&mut self) -> f64 {
        sharp_step(self.operator.as_mut())
    }

    fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        self.operator.euler(&mut particles.enthalpy, clock.time, clock.step, &mut self.patches);
        for (patch, rate) in self.patches.iter().enumerate() {
            self.ledger.book(patch, rate * clock.step, clock.step);
        }
        self.steps += 1;
        Ok(clock.step)
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn across(&mut self, enthalpy: &[f64], time: f64) -> Vec<f64> {
        self.operator.across(enthalpy, time)
    }

    fn pairs(&self) -> u64 {
        self.operator.pairs()
    }

    fn heap_size(&self) -> usize {
        self.operator.heap_size()
    }

    fn work(&self) -> Work {
        Work { evaluations: self.steps, ..Work::default() }
    }
}

/// Explicit Euler over a list, with any latent-heat scheme and any term beside conduction.
pub struct SchemeEuler<T> {
    operator: ListOperator<T>,
    scheme: Box<dyn SchemeState>,
    ledger: Ledger,
    rate: Vec<f64>,
    patches: Vec<f64>,
    steps: u64,
}

impl<T: PairTerm> SchemeEuler<T> {
    /// Euler steps of a list operator under a scheme, for `count` particles.
    pub fn new(operator: ListOperator<T>, scheme: Box<dyn SchemeState>, count: usize) -> Self {
        let ledger = Ledger::new(operator.patch_names());
        let patches = vec![0.0; ledger.names().len()];
        SchemeEuler { operator, scheme, ledger, rate: vec![0.0; count], patches, steps: 0 }
    }
}

impl<T: PairTerm> Method for SchemeEuler<T> {
    fn bound(&self) -> Bound {
        self.operator.step_bound()
    }

    fn sharp_step(&mut self) -> f64 {
        let slopes = self.operator.steepest();
        let mut tangent = Tangent::default();
        let (state, time) = (vec![0.0; slopes.len()], 0.0);
        let mut unused = slopes.clone();
        self.operator.linearise(self.scheme.as_ref(), &state, time, &mut unused, &mut tangent);
        stable_step(&slopes, |potentials, rate| self.operator.act(&mut tangent, potentials, rate))
    }

    fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let enthalpy = &mut particles.enthalpy;
        self.operator.rate_of(self.scheme.as_ref(), enthalpy, clock, &mut self.rate, &mut self.patches);
        self.scheme.add(self.operator.materials(), enthalpy, &self.rate, clock.step);
        for (patch, rate) in self.patches.iter().enumerate() {
            self.ledger.book(patch, rate * clock.step, clock.step);
        }
        self.steps += 1;
        Ok(clock.step)
    }

    fn publish(&mut self, particles: &mut Particles) {
        self.scheme.publish(self.operator.materials(), &mut particles.enthalpy);
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn across(&mut self, enthalpy: &[f64], time: f64) -> Vec<f64> {
        self.operator.across(self.scheme.as_ref(), enthalpy, time, &mut self.rate, &mut self.patches)
    }

    fn pairs(&self) -> u64 {
        self.operator.pair_count()
    }

    fn work(&self) -> Work {
        Work { evaluations: self.steps, ..Work::default() }
    }

    fn heap_size(&self) -> usize {
        self.operator.heap_size() + self.scheme.heap_size() + self.rate.heap_size()
    }
}
