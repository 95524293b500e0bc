//! Runge-Kutta-Legendre of second order.

use frazil_record::Work;

use crate::ledger::{Hermite, Ledger};
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::parts::first_stage;
use crate::saved::{Pass, Saved};
use crate::solvers::assessment::{Assessment, MadeStep, room};
use crate::solvers::balance::{Balance, BalanceFacts, Stage, StageColumns, Update};
use crate::solvers::control::{Control, EnthalpyRange, Judgement};
use crate::solvers::sharp::just_before;
use crate::solvers::solver::{Solver, SolverReport};
use crate::solvers::step::{Bound, Clock, StepError};

/// Growth of the steps of a fixed chain, from one step to the next: modes that a step cannot resolve have decayed by
/// the time it is taken.
pub const GROWTH: f64 = 1.15;

/// How far, over the range of the data, a controlled step may leave it.
const EXCESS: f64 = 1e-3;

/// Share of Euler's bound at which controlled steps start.
const START: f64 = 0.9;

/// Where steps end at a kink, over the time to it: not a little before, from where another step would be needed.
const BEYOND: f64 = 1.001;

/// Half height of the stable region, by stages: an ellipse over its whole length is stable up to here from three stages on.
const HALF_HEIGHT: f64 = 0.37;

/// How far a long step must reach for each evaluation, over a step of Euler, to be worth its error: no step reaches farther beside water
/// that carries heat faster.
const WORTH: f64 = 1.25;

/// Estimated error of a step of Euler, over that of a long step, from which it is too much: as many more of them are made.
const OF_EULER: f64 = 10.0;

/// Rate of the first stage, over the first of all weights.
const FIRST: f64 = 1.0 / 3.0;

/// Coefficients of a stage, as they are in chains of any number of stages.
#[derive(Debug, Clone, Copy)]
struct Coefficients {
    /// Of the states one stage and two stages back.
    mu: f64,
    nu: f64,
    /// Of the rate at the start of the step, over that of the rate one stage back.
    by_first: f64,
}

impl Coefficients {
    /// Adds those that are not yet among those from the second stage on, up to the last of so many.
    fn reach(found: &mut Vec<Self>, stages: usize) {
        let b = |j: usize| {
            let j = j as f64;
            if j < 2.0 { FIRST } else { (j * j + j - 2.0) / (2.0 * j * (j + 1.0)) }
        };
        let of = |j: usize| {
            let k = j as f64;
            let (mu, nu) = ((2.0 * k - 1.0) / k * b(j) / b(j - 1), -(k - 1.0) / k * b(j) / b(j - 2));
            Coefficients { mu, nu, by_first: -(1.0 - b(j - 1)) }
        };
        found.extend((found.len() + 2..=stages).map(of));
    }
}

/// Runge-Kutta-Legendre of second order (Meyer, Balsara and Aslam 2014): s stages reach (s^2 + s - 2) / 4 Euler
/// steps. Stable, but not monotone: a full step right after a jump leaves the range of the data, so steps grow from
/// Euler's: by a fixed factor, or as the estimated error allows. Beside water that carries heat too fast for stages, those by error are
/// Euler's own, or Heun's.
pub struct Rkl2 {
    balance: Box<dyn Balance>,
    ledger: Ledger,
    pace: Pace,
    /// Of all stages that a chain has had.
    coefficients: Vec<Coefficients>,
    /// State two stages back and one stage back.
    older: Vec<f64>,
    old: Vec<f64>,
    /// Rate at the start of the step, and the time at which it holds for the present state.
    first_rate: Vec<f64>,
    first_holds_at: Option<f64>,
    /// Rate at the end of a controlled step.
    last_rate: Vec<f64>,
    /// What parts of it are judged by.
    found: Vec<Assessment>,
    last_step: f64,
    patches: Patches,
    work: Work,
}

/// Rates (W) and heats (J) of patches.
struct Patches {
    older: Vec<f64>,
    old: Vec<f64>,
    first: Vec<f64>,
    rate: Vec<f64>,
    last: Vec<f64>,
}

/// How steps and stages are chosen.
enum Pace {
    /// This many stages, steps of their full reach.
    Fixed { stages: usize, steps: i32 },
    /// Steps by error, with as many stages as they need but no more than `most`.
    Controlled { most: usize, control: Control, range: EnthalpyRange },
}

impl Rkl2 {
    /// Steps of `stages` stages for `count` particles.
    pub fn fixed(balance: Box<dyn Balance>, stages: usize, count: usize) -> Self {
        Self::new(balance, count, |_| Pace::Fixed { stages, steps: 0 })
    }

    /// Steps whose estimated error is at most `tolerance` (see [`Control`]), of at most `most` stages.
    pub fn controlled(
        balance: Box<dyn Balance>,
        most: usize,
        tolerance: f64,
        range: EnthalpyRange,
        count: usize,
    ) -> Self {
        // The estimate is of third order in the step.
        let pace = |euler: f64| Pace::Controlled { most, control: Control::new(tolerance, 3.0, START * euler), range };
        Self::new(balance, count, pace)
    }

    fn new(balance: Box<dyn Balance>, count: usize, pace: impl FnOnce(f64) -> Pace) -> Self {
        let ledger = Ledger::new(balance.patches());
        let patch = || vec![0.0; ledger.sources().len()];
        let patches = Patches { older: patch(), old: patch(), first: patch(), rate: patch(), last: patch() };
        let pace = pace(balance.step_bound());
        let is_fixed = matches!(pace, Pace::Fixed { .. });
        let (last_rate, found) = if is_fixed { Default::default() } else { (vec![0.0; count], room(count)) };
        let column = || vec![0.0; count];
        Rkl2 {
            balance,
            ledger,
            pace,
            coefficients: Vec::new(),
            older: column(),
            old: column(),
            first_rate: column(),
            first_holds_at: None,
            last_rate,
            found,
            last_step: 0.0,
            patches,
            work: Work::default(),
        }
    }

    /// Most stages of a step by error.
    fn most(&self) -> usize {
        match self.pace {
            Pace::Fixed { stages, .. } => stages,
            Pace::Controlled { most, .. } => most,
        }
    }

    /// How many Euler steps one step of `stages` stages reaches.
    pub fn reach(stages: usize) -> f64 {
        let s = stages as f64;
        (s * s + s - 2.0) / 4.0
    }

    /// Least number of stages that reach `steps` Euler steps.
    pub fn stages_for(steps: f64) -> usize {
        let s = 0.5 * ((9.0 + 16.0 * steps).sqrt() - 1.0);
        (s * (1.0 - 1e-12)).ceil().max(3.0) as usize
    }

    /// The step of Euler (s) by which stages count: that which is linearly stable for steps by error, which see what grows all the
    /// same.
    fn of_euler(&self) -> f64 {
        let bound = &self.balance.facts().bound;
        match self.pace {
            Pace::Fixed { .. } => bound.step,
            Pace::Controlled { .. } => bound.linear_step(),
        }
    }

    /// Least number of stages in which a step (s) is stable.
    fn stages(&self, step: f64) -> usize {
        let by_turning = (step * self.balance.facts().turning / HALF_HEIGHT).ceil() as usize;
        Self::stages_for(step / self.of_euler()).max(by_turning)
    }

    /// The longest step (s) that is stable in so many stages.
    fn longest(&self, stages: usize) -> f64 {
        let by_turning = HALF_HEIGHT * stages as f64 / self.balance.facts().turning;
        (self.of_euler() * Self::reach(stages)).min(by_turning)
    }

    /// Whether water carries heat so fast that steps of Euler are cheaper than stages.
    fn is_outrun(&self) -> bool {
        let facts = self.balance.facts();
        HALF_HEIGHT < WORTH * facts.bound.step * facts.turning
    }

    /// The chain of stages of one step from `start`; the result is left in `old`.
    fn chain(&mut self, start: &[f64], clock: &Clock, stages: usize) {
        let Clock { time, step, .. } = *clock;
        let s = stages as f64;
        let w1 = 4.0 / (s * s + s - 2.0);
        self.begin(start, clock);
        Coefficients::reach(&mut self.coefficients, stages);
        let by_first = FIRST * w1 * step;
        let columns = [&mut self.older[..], &mut self.old[..]];
        first_stage(self.balance.team(), start, &self.first_rate, by_first, columns);
        let patches = &mut self.patches;
        patches.older.fill(0.0);
        for (old, rate) in patches.old.iter_mut().zip(&patches.first) {
            *old = by_first * rate;
        }
        for j in 2..=stages {
            let Coefficients { mu, nu, by_first } = self.coefficients[j - 2];
            let by_rate = mu * w1 * step;
            let stage =
                Stage { newest: mu, oldest: nu, start: 1.0 - mu - nu, rate: by_rate, first: by_first * by_rate };
            // Abscissa of the previous stage, for walls that change in time.
            let p = j as f64 - 1.0;
            let abscissa = if j == 2 { FIRST * w1 } else { (p * p + p - 2.0) / (s * s + s - 2.0) };
            let mut columns =
                StageColumns { newest: &self.old, oldest: &mut self.older, start, first: &self.first_rate };
            let clock = Clock { time: time + abscissa * step, ..*clock };
            self.balance.advance(Update::Stage(&stage, &mut columns), &clock, &mut patches.rate);
            std::mem::swap(&mut self.old, &mut self.older);
            for patch in 0..patches.old.len() {
                let next = mu * patches.old[patch]
                    + nu * patches.older[patch]
                    + by_rate * patches.rate[patch]
                    + stage.first * patches.first[patch];
                patches.older[patch] = patches.old[patch];
                patches.old[patch] = next;
            }
        }
        self.work.evaluations += stages as u64 - 1;
    }

    /// Fills the rates at the start of a step.
    fn begin(&mut self, start: &[f64], clock: &Clock) {
        if self.first_holds_at != Some(clock.time) {
            self.balance.rates(start, clock, &mut self.first_rate, &mut self.patches.first);
            self.work.evaluations += 1;
        }
    }

    /// Makes a step of Euler of at most `clock.step` from `start`, with the rates at its end; the result is left in `old`. Returns the
    /// step (s).
    fn euler(&mut self, start: &[f64], clock: &Clock) -> f64 {
        self.begin(start, clock);
        let step = self.balance.cut(clock.step);
        let Rkl2 { old, first_rate, patches, .. } = self;
        for (old, (start, rate)) in old.iter_mut().zip(start.iter().zip(first_rate.iter())) {
            *old = start + step * rate;
        }
        for (heat, first) in patches.old.iter_mut().zip(&patches.first) {
            *heat = step * first;
        }
        self.end(clock, step);
        step
    }

    /// Turns a step of Euler into one by Heun's rule, a mean of two steps of Euler, which keeps the range of the data.
    fn mend(&mut self, start: &[f64], clock: &Clock, step: f64) {
        let Rkl2 { old, last_rate, patches, .. } = self;
        for (old, (start, rate)) in old.iter_mut().zip(start.iter().zip(last_rate.iter())) {
            *old = 0.5 * (start + (*old + step * rate));
        }
        for ((heat, first), last) in patches.old.iter_mut().zip(&patches.first).zip(&patches.last) {
            *heat = 0.5 * step * (first + last);
        }
        self.end(clock, step);
    }

    /// Fills the rates at the end of a step (s), for one that may be longer.
    fn end(&mut self, clock: &Clock, step: f64) {
        let next = step.max(START * self.balance.step_bound());
        let end = Clock { time: just_before(clock.time, step), step: next, ..*clock };
        self.balance.rates(&self.old, &end, &mut self.last_rate, &mut self.patches.last);
        self.work.evaluations += 1;
    }

    /// Makes a step of at most `clock.step` where water outruns stages: one of Euler, or, where its error is no longer small, by
    /// Heun's rule. Returns the step (s).
    fn walk(&mut self, particles: &Particles, clock: &Clock) -> f64 {
        let start = &particles.enthalpy;
        let step = self.euler(start, clock);
        let Assessment { error, size, .. } = self.assess(particles, step, false);
        let Pace::Controlled { control, .. } = &self.pace else { return step };
        if !control.is_small(OF_EULER * error, size) {
            self.mend(start, clock, step);
        }
        step
    }

    /// A step (s), or the time to just beyond the next kink of the rates, as far as they tell at a time (s), if that is less. Steps that
    /// end there are hardly ever made again: their error is that of smooth rates.
    fn to_kink(&self, state: &[f64], time: f64, step: f64) -> f64 {
        if self.first_holds_at != Some(time) {
            return step;
        }
        let next = self.balance.next_kink(state, &self.first_rate, step);
        step.min((BEYOND * next).max(START * self.balance.step_bound()))
    }

    /// Assesses a step (s) to `old` by its distance to the Hermite interpolant, and by the range of the data, if that is asked for.
    fn assess(&mut self, particles: &Particles, step: f64, by_range: bool) -> Assessment {
        let Rkl2 { balance, pace, old, first_rate, last_rate, found, .. } = self;
        let range = match pace {
            Pace::Controlled { range, .. } if by_range => Some(&*range),
            _ => None,
        };
        let Particles { enthalpy, start: started, volumes, .. } = particles;
        let made = MadeStep { columns: [enthalpy, old, first_rate, last_rate], step, started, volumes, range };
        made.assess(balance.team(), found)
    }

    /// Keeps a step (s) whose result is in `old`; returns it.
    fn keep(&mut self, state: &mut Vec<f64>, time: f64, step: f64) -> f64 {
        // The state of two stages back is not needed any more: its column keeps the start of the step.
        std::mem::swap(&mut self.older, state);
        std::mem::swap(&mut self.old, state);
        self.last_step = step;
        std::mem::swap(&mut self.first_rate, &mut self.last_rate);
        std::mem::swap(&mut self.patches.first, &mut self.patches.last);
        self.first_holds_at = Some(time + step);
        self.book(step);
        step
    }

    fn book(&mut self, step: f64) {
        for (patch, heat) in self.patches.old.iter().enumerate() {
            self.ledger.book(patch, *heat, step);
        }
    }
}

impl Solver for Rkl2 {
    fn report(&self) -> SolverReport {
        let BalanceFacts { bound, pairs, .. } = self.balance.facts();
        let (step, gentle_step) = match self.pace {
            Pace::Fixed { stages, .. } => (self.longest(stages), Some(bound.step)),
            Pace::Controlled { .. } => (bound.step, None),
        };
        SolverReport {
            bound: Bound { step, ..bound.clone() },
            pairs: *pairs,
            gentle_step,
            is_dense: gentle_step.is_none(),
            work: self.work,
        }
    }

    fn make_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        if clock.turned {
            self.first_holds_at = None;
        }
        if let Pace::Fixed { stages, steps } = &mut self.pace {
            let state = &mut particles.enthalpy;
            *steps = steps.saturating_add(1);
            let stages = *stages;
            let step =
                if self.balance.companion().is_some() { clock.step.min(self.longest(stages)) } else { clock.step };
            self.chain(state, &Clock { step, ..*clock }, stages);
            std::mem::swap(&mut self.old, state);
            self.book(step);
            return Ok(step);
        }
        if self.is_outrun() {
            let step = clock.step.min(START * self.balance.step_bound());
            let step = self.walk(particles, &Clock { step, ..*clock });
            return Ok(self.keep(&mut particles.enthalpy, clock.time, step));
        }
        let mut step = clock.step;
        if self.balance.companion().is_some() {
            step = step.min(self.longest(self.most()));
        }
        step = self.to_kink(&particles.enthalpy, clock.time, step);
        loop {
            let attempt = Clock { step, ..*clock };
            self.chain(&particles.enthalpy, &attempt, self.stages(step));
            self.first_holds_at = Some(clock.time);
            self.end(&attempt, step);
            let Assessment { error, size, excess } = self.assess(particles, step, true);
            let Pace::Controlled { control, .. } = &mut self.pace else { return Ok(step) };
            let leaves = excess > EXCESS;
            let judgement = if !error.is_finite() {
                if control.is_least(step) {
                    return Err(StepError::NotFinite(step));
                }
                control.again(step, 0.1)
            } else if leaves && !control.is_least(step) {
                control.again(step, 0.5)
            } else {
                control.judge(step, error, size)
            };
            if leaves && judgement == Judgement::Keep {
                // Heun's rule keeps the range of the data.
                step = self.euler(&particles.enthalpy, &attempt);
                self.mend(&particles.enthalpy, &attempt, step);
                self.work.limited_steps += 1;
            }
            match judgement {
                Judgement::Keep => return Ok(self.keep(&mut particles.enthalpy, clock.time, step)),
                Judgement::Again(shorter) => {
                    self.work.rejected_steps += 1;
                    step = shorter;
                }
            }
        }
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn wanted_step(&self) -> f64 {
        match &self.pace {
            Pace::Fixed { stages, steps } => {
                let grown = self.balance.step_bound() * GROWTH.powi((*steps).min(1000));
                let longest = self.balance.companion().map_or(f64::INFINITY, |_| self.longest(*stages));
                grown.min(longest).min(self.balance.companion_lasts())
            }
            Pace::Controlled { .. } if self.is_outrun() => {
                (START * self.balance.step_bound()).min(self.balance.companion_lasts())
            }
            Pace::Controlled { most, control, .. } => {
                control.next().min(self.longest(*most)).min(self.balance.companion_lasts())
            }
        }
    }

    fn between(&self, particles: &Particles, share: f64, enthalpy: &mut [f64]) -> Ledger {
        // A kept step has exchanged the columns of rates: the first now belong to its end.
        let (states, rates) = ((&self.older[..], &particles.enthalpy[..]), (&self.last_rate[..], &self.first_rate[..]));
        Hermite::at(share).fill(enthalpy, states, rates, self.last_step);
        self.ledger.between(share, self.last_step, &self.patches.old, &self.patches.last, &self.patches.first)
    }

    fn balance(&self) -> Option<&dyn Balance> {
        Some(self.balance.as_ref())
    }

    fn balance_mut(&mut self) -> Option<&mut dyn Balance> {
        Some(self.balance.as_mut())
    }
}

impl Saved for Rkl2 {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.balance.pass(pass);
        // Rates at the end of the last step are those at the start of the next.
        pass.all(&mut [
            &mut self.ledger,
            &mut self.first_rate,
            &mut self.first_holds_at,
            &mut self.patches.first,
            &mut self.work.evaluations,
            &mut self.work.rejected_steps,
            &mut self.work.limited_steps,
        ]);
        match &mut self.pace {
            Pace::Fixed { steps, .. } => steps.pass(pass),
            Pace::Controlled { control, .. } => control.pass(pass),
        }
    }
}

impl HeapSize for Rkl2 {
    fn heap_size(&self) -> usize {
        let columns = [&self.older, &self.old, &self.first_rate, &self.last_rate];
        let range = match &self.pace {
            Pace::Fixed { .. } => 0,
            Pace::Controlled { range, .. } => range.heap_size(),
        };
        let coefficients = self.coefficients.capacity() * size_of::<Coefficients>();
        let found = self.found.capacity() * size_of::<Assessment>();
        self.balance.heap_size()
            + range
            + coefficients
            + found
            + columns.into_iter().map(HeapSize::heap_size).sum::<usize>()
    }
}
