//! Implicit steps: singly diagonally implicit Runge-Kutta of second order, with steps by error.

use frazil_record::Work;

use crate::ledger::{Hermite, Ledger};
use crate::memory::{HeapSize, total};
use crate::particles::Particles;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::{Balance, BalanceFacts};
use crate::solvers::control::{Control, EnthalpyRange, Judgement, taken_up};
use crate::solvers::newton::{Newton, NotConverged, RESIDUAL, Stage};
use crate::solvers::sharp::just_before;
use crate::solvers::solver::{KeptStage, Solver, SolverReport};
use crate::solvers::step::{Clock, StepError};

/// The diagonal of the scheme, 1 - 1/sqrt 2: L-stable and of second order (Alexander 1977).
const DIAGONAL: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Share of Euler's bound at which steps start: there the scheme keeps the maximum principle.
const START: f64 = 0.9;

/// Room (over the scale of enthalpies) that steps are given beyond it: what the residual of the stages
/// explains.
const SLACK: f64 = 5.0 * RESIDUAL;

/// Weights of the rates at 0, DIAGONAL and 1 by which the quadrature through all three differs from the step's own:
/// the estimated error of a step (s of the step's length).
fn error_weights() -> [f64; 3] {
    let g = DIAGONAL;
    let third = [(g / 2.0 - 1.0 / 6.0) / g, 1.0 / (6.0 * g * (1.0 - g)), (1.0 / 3.0 - g / 2.0) / (1.0 - g)];
    [third[0], third[1] - (1.0 - g), third[2] - g]
}

/// Two implicit stages of equal weight: `H1 = H + g h F(H1)`, `H2 = H + (1 - g) h F(H1) + g h F(H2)`, g = 1 - 1/sqrt 2.
///
/// The new state is put together from the rates of the stages, so heat is conserved to rounding whatever Newton's
/// iteration leaves. A step that would leave the range of the data is mixed with the backward Euler step, which never
/// does, as little as keeps the range.
pub struct Implicit {
    balance: Box<dyn Balance>,
    ledger: Ledger,
    control: Control,
    range: EnthalpyRange,
    newton: Newton,
    stage: Vec<f64>,
    known: Vec<f64>,
    next: Vec<f64>,
    /// State at the start of the last step, and its length (s).
    previous: Vec<f64>,
    last_step: f64,
    /// Rates: at the start of the step that is being made, at the start of the last one, of both stages, of the
    /// backward Euler step.
    rate: Vec<f64>,
    previous_rate: Vec<f64>,
    rates: [Vec<f64>; 2],
    euler_rate: Vec<f64>,
    /// Rates of patches: of both stages, of the backward Euler step; at the end of the last step and at its start; and
    /// the heat that it brought (J).
    patches: [Vec<f64>; 3],
    end_patches: Vec<f64>,
    start_patches: Vec<f64>,
    heat: Vec<f64>,
    turns: u64,
    rejected: u64,
    limited: u64,
    /// Whether the rates are not those of the present state.
    stale: bool,
    /// States of both stages and of the step of Euler beside them; empty where nobody asks.
    kept: Vec<KeptStage>,
}

impl Implicit {
    /// Steps whose estimated error is at most `tolerance` (see [`Control`]).
    pub fn new(
        mut balance: Box<dyn Balance>,
        tolerance: f64,
        range: EnthalpyRange,
        largest_slope: f64,
        count: usize,
    ) -> Self {
        let ledger = Ledger::new(balance.patches());
        let count_patches = ledger.sources().len();
        let patch = || vec![0.0; count_patches];
        let patches = std::array::from_fn(|_| patch());
        let newton = Newton::new(balance.as_mut(), count, largest_slope);
        let euler = balance.step_bound();
        let column = || vec![0.0; count];
        Implicit {
            balance,
            ledger,
            control: Control::new(tolerance, 3.0, START * euler),
            range,
            newton,
            stage: column(),
            known: column(),
            next: column(),
            previous: column(),
            last_step: 0.0,
            rate: column(),
            previous_rate: column(),
            rates: [column(), column()],
            euler_rate: Vec::new(),
            patches,
            end_patches: patch(),
            start_patches: patch(),
            heat: patch(),
            turns: 0,
            rejected: 0,
            limited: 0,
            stale: false,
            kept: Vec::new(),
        }
    }

    /// Solves both stages from `start`, and leaves the new state in `next`.
    fn stages(&mut self, start: &[f64], clock: &Clock) -> Result<(), NotConverged> {
        let Clock { time, step, .. } = *clock;
        let weight = DIAGONAL * step;
        let Implicit { balance, newton, range, stage, known, next, rates: [first, second], patches, kept, .. } = self;
        let [first_patches, second_patches, _] = patches;
        extrapolate(stage, start, &self.rate, weight);
        let system = Stage { known: start, weight, clock: Clock { time: time + weight, ..*clock }, range };
        newton.solve(balance.as_mut(), &system, stage, first, first_patches)?;
        keep_state(kept, 0, stage, time + weight);
        extrapolate(known, start, first, (1.0 - DIAGONAL) * step);
        extrapolate(stage, start, first, step);
        let clock = Clock { time: just_before(time, step), ..*clock };
        let system = Stage { known, weight, clock, range };
        newton.solve(balance.as_mut(), &system, stage, second, second_patches)?;
        keep_state(kept, 1, stage, clock.time);
        extrapolate(next, known, second, weight);
        Ok(())
    }

    /// Mixes the step in `next` with the backward Euler step, if it leaves the range; returns the share of the former.
    fn limit(&mut self, start: &[f64], clock: &Clock) -> Result<f64, NotConverged> {
        let Clock { time, step, .. } = *clock;
        if self.range.excess(&self.next) <= SLACK {
            return Ok(1.0);
        }
        self.euler_rate.resize(start.len(), 0.0);
        let Implicit { balance, newton, range, stage, next, euler_rate, patches, kept, .. } = self;
        stage.copy_from_slice(start);
        let clock = Clock { time: just_before(time, step), ..*clock };
        let system = Stage { known: start, weight: step, clock, range };
        newton.solve(balance.as_mut(), &system, stage, euler_rate, &mut patches[2])?;
        keep_state(kept, 2, stage, clock.time);
        extrapolate(stage, start, euler_rate, step);
        let share = range.share(stage, next, SLACK);
        for (next, euler) in next.iter_mut().zip(stage.iter()) {
            *next = euler + share * (*next - euler);
        }
        Ok(share)
    }

    /// Makes a step of explicit Euler, short enough to keep the range, where Newton's iteration finds none; its length (s).
    fn step_by_euler(&mut self, state: &mut [f64], clock: &Clock, step: f64) -> f64 {
        keep_state(&mut self.kept, 2, state, clock.time);
        self.euler_rate.clone_from(&self.rate);
        self.patches[2].clone_from(&self.end_patches);
        extrapolate(&mut self.next, state, &self.euler_rate, step);
        self.limited += 1;
        self.stale = true;
        self.keep(state, step, 0.0);
        step
    }

    /// Takes the step in `next`, of which `share` is of second order.
    fn keep(&mut self, state: &mut [f64], step: f64, share: f64) {
        std::mem::swap(&mut self.previous_rate, &mut self.rate);
        std::mem::swap(&mut self.start_patches, &mut self.end_patches);
        let [first, second, euler] = &self.patches;
        for patch in 0..first.len() {
            let high = (1.0 - DIAGONAL) * first[patch] + DIAGONAL * second[patch];
            let mix =
                |high: f64, low: &[f64]| if share < 1.0 { low[patch] + share * (high - low[patch]) } else { high };
            self.heat[patch] = step * mix(high, euler);
            self.end_patches[patch] = mix(second[patch], euler);
            self.ledger.book(patch, self.heat[patch], step);
        }
        std::mem::swap(&mut self.rate, &mut self.rates[1]);
        if share < 1.0 {
            for (rate, euler) in self.rate.iter_mut().zip(&self.euler_rate) {
                *rate = euler + share * (*rate - euler);
            }
        }
        let shares = [share * (1.0 - DIAGONAL), share * DIAGONAL, 1.0 - share];
        self.kept.iter_mut().zip(shares).for_each(|(kept, share)| kept.share = share);
        self.previous.copy_from_slice(state);
        state.copy_from_slice(&self.next);
        self.last_step = step;
    }

    /// Sum over particles, by their volumes, of the estimated error of a step, and of the magnitude of its result. `share` belongs to the
    /// second-order step, the rest to backward Euler.
    fn error(&self, step: f64, share: f64, volume: impl Fn(usize) -> f64) -> (f64, f64) {
        let weights = error_weights();
        let (last, [first, second]) = (&self.rate, &self.rates);
        let mut sums = (0.0, 0.0);
        for i in 0..last.len() {
            let high = weights[0] * last[i] + weights[1] * first[i] + weights[2] * second[i];
            let low = if share < 1.0 { 0.5 * (self.euler_rate[i] - last[i]) } else { 0.0 };
            sums.0 += volume(i) * (step * (share * high + (1.0 - share) * low)).abs();
            sums.1 += volume(i) * self.next[i].abs();
        }
        sums
    }
}

/// Keeps a state, if any are kept.
fn keep_state(kept: &mut [KeptStage], number: usize, state: &[f64], time: f64) {
    if let Some(kept) = kept.get_mut(number) {
        kept.state.clear();
        kept.state.extend_from_slice(state);
        kept.time = time;
    }
}

/// `out = from + weight * rate`.
fn extrapolate(out: &mut [f64], from: &[f64], rate: &[f64], weight: f64) {
    for (out, (from, rate)) in out.iter_mut().zip(from.iter().zip(rate)) {
        *out = from + weight * rate;
    }
}

impl Solver for Implicit {
    fn report(&self) -> SolverReport {
        let BalanceFacts { bound, pairs, .. } = self.balance.facts();
        let (newton_median, newton_most) = self.newton.median_and_most();
        let work = Work {
            evaluations: self.turns + self.newton.evaluations,
            rejected_steps: self.rejected,
            limited_steps: self.limited,
            newton_solves: self.newton.solves,
            newton_iterations: self.newton.iterations,
            newton_median,
            newton_most,
            newton_paths: self.newton.paths,
            linear_iterations: self.newton.linear_iterations,
        };
        SolverReport { bound: bound.clone(), pairs: *pairs, gentle_step: None, is_dense: true, work }
    }

    fn make_step(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let (state, volumes) = (&mut particles.enthalpy, &particles.volumes);
        // Walls have jumped, what flows has changed, or the last step took its rates at its start.
        if clock.turned || std::mem::take(&mut self.stale) {
            self.turns += 1;
            self.balance.rates(state, clock, &mut self.rate, &mut self.end_patches);
        }
        let mut step = clock.step;
        loop {
            let attempt = Clock { step, ..*clock };
            let solved = self.stages(state, &attempt).and_then(|()| self.limit(state, &attempt));
            let judgement = match solved {
                Ok(share) => {
                    self.limited += u64::from(share < 1.0);
                    let (error, size) = match volumes.is_even() {
                        true => self.error(step, share, |_| 1.0),
                        false => self.error(step, share, |i| volumes.share(i)),
                    };
                    let size = taken_up(&self.next, &particles.start, size).max(self.range.floor());
                    (self.control.judge(step, error, size), share)
                }
                Err(NotConverged) if self.control.is_least(step) => {
                    return Ok(self.step_by_euler(state, clock, step.min(self.balance.step_bound())));
                }
                Err(NotConverged) => (self.control.again(step, 0.25), 1.0),
            };
            match judgement {
                (Judgement::Keep, share) => {
                    self.keep(state, step, share);
                    return Ok(step);
                }
                (Judgement::Again(shorter), _) => {
                    self.rejected += 1;
                    step = shorter;
                }
            }
        }
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn wanted_step(&self) -> f64 {
        self.control.next().min(self.balance.companion_lasts())
    }

    fn between(&self, particles: &Particles, share: f64, enthalpy: &mut [f64]) -> Ledger {
        let states = (&self.previous[..], &particles.enthalpy[..]);
        let rates = (&self.previous_rate[..], &self.rate[..]);
        Hermite::at(share).fill(enthalpy, states, rates, self.last_step);
        self.ledger.between(share, self.last_step, &self.heat, &self.start_patches, &self.end_patches)
    }

    fn keep_stages(&mut self) {
        self.kept = vec![KeptStage::default(); 3];
    }

    fn stages(&self) -> &[KeptStage] {
        &self.kept
    }

    fn balance(&self) -> Option<&dyn Balance> {
        Some(self.balance.as_ref())
    }

    fn balance_mut(&mut self) -> Option<&mut dyn Balance> {
        Some(self.balance.as_mut())
    }
}

impl Saved for Implicit {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.balance.pass(pass);
        pass.all(&mut [
            &mut self.ledger,
            &mut self.control,
            &mut self.newton,
            &mut self.rate,
            &mut self.end_patches,
            &mut self.turns,
            &mut self.rejected,
            &mut self.limited,
            &mut self.stale,
        ]);
    }
}

impl HeapSize for Implicit {
    fn heap_size(&self) -> usize {
        let columns = [&self.stage, &self.known, &self.next, &self.previous, &self.rate, &self.previous_rate];
        let columns: usize = columns.into_iter().map(HeapSize::heap_size).sum();
        self.balance.heap_size() + self.newton.heap_size() + columns + total(&[&self.rates, &self.euler_rate])
    }
}
