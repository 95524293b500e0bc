//! Time integrators over an [`Operator`], and the methods that they make.

use crate::ledger::Ledger;
use crate::list_operator::{ListOperator, PairTerm};
use crate::memory::Held;
use crate::method::{Bound, Clock, Method, StepError};
use crate::operator::Operator;
use crate::particles::Particles;
use crate::uptake::LatentScheme;

/// Explicit Euler: at its bound it keeps the maximum principle.
pub struct Euler {
    operator: Box<dyn Operator>,
    ledger: Ledger,
    doors: Vec<f64>,
}

impl Euler {
    /// Euler steps of an operator.
    pub fn new(operator: Box<dyn Operator>) -> Self {
        let ledger = Ledger::new(operator.doors());
        let doors = vec![0.0; ledger.names().len()];
        Euler { operator, ledger, doors }
    }
}

impl Method for Euler {
    fn bound(&self) -> Bound {
        self.operator.bound()
    }

    fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<(), StepError> {
        self.operator.euler(&mut particles.enthalpy, clock.time, clock.step, &mut self.doors);
        for (door, rate) in self.doors.iter().enumerate() {
            self.ledger.book(door, rate * clock.step, clock.step);
        }
        Ok(())
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn pairs(&self) -> u64 {
        self.operator.pairs()
    }

    fn held(&self) -> usize {
        self.operator.held()
    }
}

/// Runge-Kutta-Legendre of second order (Meyer, Balsara and Aslam 2014): s stages reach (s^2 + s - 2) / 4 Euler
/// steps. Stable, but not monotone: a full step right after a jump leaves the range of the data, so its steps grow from
/// Euler's.
pub struct Rkl2 {
    operator: Box<dyn Operator>,
    ledger: Ledger,
    stages: usize,
    /// State and door heat: at the start, two stages back, one stage back.
    start: Vec<f64>,
    older: Vec<f64>,
    old: Vec<f64>,
    first_rate: Vec<f64>,
    rate: Vec<f64>,
    doors: [Vec<f64>; 4],
}

impl Rkl2 {
    /// Steps of `stages` stages for `count` particles.
    pub fn new(operator: Box<dyn Operator>, stages: usize, count: usize) -> Self {
        let ledger = Ledger::new(operator.doors());
        let doors = std::array::from_fn(|_| vec![0.0; ledger.names().len()]);
        let column = || vec![0.0; count];
        Rkl2 {
            operator,
            ledger,
            stages,
            start: column(),
            older: column(),
            old: column(),
            first_rate: column(),
            rate: column(),
            doors,
        }
    }

    /// How many Euler steps one step of `stages` stages reaches.
    pub fn reach(stages: usize) -> f64 {
        let s = stages as f64;
        (s * s + s - 2.0) / 4.0
    }
}

impl Method for Rkl2 {
    fn bound(&self) -> Bound {
        let euler = self.operator.bound();
        Bound { step: euler.step * Self::reach(self.stages), cause: euler.cause }
    }

    fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<(), StepError> {
        let (step, time) = (clock.step, clock.time);
        let state = &mut particles.enthalpy;
        let s = self.stages as f64;
        let w1 = 4.0 / (s * s + s - 2.0);
        let b = |j: usize| {
            let j = j as f64;
            if j < 2.0 { 1.0 / 3.0 } else { (j * j + j - 2.0) / (2.0 * j * (j + 1.0)) }
        };
        let [door_old, door_older, door_first, door_rate] = &mut self.doors;
        self.start.copy_from_slice(state);
        self.older.copy_from_slice(state);
        self.operator.rate(state, time, &mut self.first_rate, door_first);
        let first = b(1) * w1 * step;
        for (old, (start, rate)) in self.old.iter_mut().zip(self.start.iter().zip(&self.first_rate)) {
            *old = start + first * rate;
        }
        for (old, (older, rate)) in door_old.iter_mut().zip(door_older.iter_mut().zip(door_first.iter())) {
            *older = 0.0;
            *old = first * rate;
        }
        for j in 2..=self.stages {
            let k = j as f64;
            let mu = (2.0 * k - 1.0) / k * b(j) / b(j - 1);
            let nu = -(k - 1.0) / k * b(j) / b(j - 2);
            let (rest, by_rate) = (1.0 - mu - nu, mu * w1 * step);
            let by_first = -(1.0 - b(j - 1)) * by_rate;
            // Abscissa of the previous stage, for walls that change in time.
            let p = k - 1.0;
            let abscissa = if j == 2 { b(1) * w1 } else { (p * p + p - 2.0) / (s * s + s - 2.0) };
            self.operator.rate(&self.old, time + abscissa * step, &mut self.rate, door_rate);
            for i in 0..state.len() {
                let next = mu * self.old[i]
                    + nu * self.older[i]
                    + rest * self.start[i]
                    + by_rate * self.rate[i]
                    + by_first * self.first_rate[i];
                self.older[i] = self.old[i];
                self.old[i] = next;
            }
            for door in 0..door_old.len() {
                let next = mu * door_old[door]
                    + nu * door_older[door]
                    + by_rate * door_rate[door]
                    + by_first * door_first[door];
                door_older[door] = door_old[door];
                door_old[door] = next;
            }
        }
        state.copy_from_slice(&self.old);
        for (door, heat) in door_old.iter().enumerate() {
            self.ledger.book(door, *heat, step);
        }
        Ok(())
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn pairs(&self) -> u64 {
        self.operator.pairs()
    }

    fn held(&self) -> usize {
        let columns = [&self.start, &self.older, &self.old, &self.first_rate, &self.rate];
        self.operator.held() + columns.into_iter().map(Held::held).sum::<usize>()
    }

    fn gentle_step(&self) -> Option<f64> {
        Some(self.operator.bound().step)
    }

    fn evaluations_per_step(&self) -> u64 {
        self.stages as u64
    }
}

/// Explicit Euler over a list, with any latent-heat scheme and any term beside conduction.
pub struct SchemeEuler<T> {
    operator: ListOperator<T>,
    scheme: Box<dyn LatentScheme>,
    ledger: Ledger,
    rate: Vec<f64>,
    doors: Vec<f64>,
}

impl<T: PairTerm> SchemeEuler<T> {
    /// Euler steps of a list operator under a scheme, for `count` particles.
    pub fn new(operator: ListOperator<T>, scheme: Box<dyn LatentScheme>, count: usize) -> Self {
        let ledger = Ledger::new(operator.door_names());
        let doors = vec![0.0; ledger.names().len()];
        SchemeEuler { operator, scheme, ledger, rate: vec![0.0; count], doors }
    }
}

impl<T: PairTerm> Method for SchemeEuler<T> {
    fn bound(&self) -> Bound {
        self.operator.step_bound()
    }

    fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<(), StepError> {
        let enthalpy = &mut particles.enthalpy;
        self.operator.rate_of(self.scheme.as_ref(), enthalpy, clock, &mut self.rate, &mut self.doors);
        self.scheme.add(self.operator.materials(), enthalpy, &self.rate, clock.step);
        for (door, rate) in self.doors.iter().enumerate() {
            self.ledger.book(door, rate * clock.step, clock.step);
        }
        Ok(())
    }

    fn publish(&mut self, particles: &mut Particles) {
        self.scheme.publish(self.operator.materials(), &mut particles.enthalpy);
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn pairs(&self) -> u64 {
        self.operator.pair_count()
    }

    fn held(&self) -> usize {
        self.operator.held() + self.scheme.held() + self.rate.held()
    }
}
