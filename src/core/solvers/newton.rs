//! The nonlinear system of an implicit stage: `H - c F(H) = R`.
//!
//! F is a linear exchange of the potentials U(H), so the Newton matrix `I - c A diag(dU/dH)` is an M-matrix for every
//! state: it always has an inverse, and a particle inside its freezing interval (dU/dH = 0) is simply passive. Where
//! Newton's iteration turns in circles, because particles jump to and fro over the interval, the path of solutions is
//! followed from c = 0, at which `H = R` holds.

use crate::memory::HeapSize;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::{Balance, Tangent, TangentShape};
use crate::solvers::band::Band;
use crate::solvers::control::EnthalpyRange;
use crate::solvers::krylov::Krylov;
use crate::solvers::step::Clock;

/// Largest residual that is left, over the scale of a particle's enthalpy. It bounds how far a stage can leave the range of the
/// data, of which a billionth is allowed; heat is conserved whatever it is.
pub const RESIDUAL: f64 = 1e-10;

/// Iterations without halving the residual after which it is taken for rounding, and how large that may be: where latent
/// heat is a thousand times the sensible heat, residuals by the latter are a thousand roundings.
const MOST_STALLED: u32 = 2;
const ROUNDING: f64 = 1e-7;

/// Newton iterations before the path is followed instead.
const MOST_ITERATIONS: u32 = 40;

/// Iterations with whole steps where the exchange is steep, and least part of a step that is tried afterwards.
const WHOLE_STEPS: u32 = 3;
const LEAST_PART: f64 = 1e-3;

/// Shortest stretch of a path, over all of it.
const LEAST_STRETCH: f64 = 1e-5;

/// Half band width up to which systems are solved directly: there elimination costs less than a dozen products.
pub const WIDEST_BAND: usize = 32;

/// Largest relative residual of a linear solve, and what each asks beyond the fall of the nonlinear one.
const LOOSEST: f64 = 1e-2;

/// Solves stage after stage of one balance.
pub struct Newton {
    count: usize,
    residual: Vec<f64>,
    slopes: Vec<f64>,
    roots: Vec<f64>,
    change: Vec<f64>,
    scratch: Vec<f64>,
    right: Vec<f64>,
    diagonal: Vec<f64>,
    linear: Linear,
    /// State before the last step, where steps may be shortened; empty elsewhere.
    before: Vec<f64>,
    /// Largest row sum of the exchange (1/m2), for the preconditioner.
    row_sum: f64,
    /// Number of solves by their number of iterations.
    histogram: [u64; MOST_ITERATIONS as usize + 1],
    /// Solves, iterations, paths.
    pub solves: u64,
    /// Newton iterations.
    pub iterations: u64,
    /// Solves that followed the path.
    pub paths: u64,
    /// Products with the linearised exchange, and evaluations of the balance itself.
    pub evaluations: u64,
    /// Iterations of the linear solver; a direct solve counts as one.
    pub linear_iterations: u64,
    most: u32,
}

enum Linear {
    /// The exchange as a banded matrix, and the system made of it.
    Direct {
        exchange: Band,
        system: Band,
        probed: bool,
        is_constant: bool,
    },
    Iterative(Krylov),
}

/// What a stage solves: `H - weight F(H, time) = known`.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// Right side (J/m3).
    pub known: &'a [f64],
    /// Weight of the rates (s).
    pub weight: f64,
    /// When rates are taken.
    pub clock: Clock,
    /// What errors of enthalpies are measured by.
    pub range: &'a EnthalpyRange,
}

/// The iteration did not come to its end.
pub struct NotConverged;

impl Newton {
    /// A solver for `count` particles of a balance. Narrow bands are solved directly, all else by iteration.
    pub fn new(balance: &mut dyn Balance, count: usize, largest_slope: f64) -> Self {
        let column = || vec![0.0; count];
        let row_sum = 1.0 / (balance.step_bound() * largest_slope);
        let TangentShape { bandwidth: half, is_symmetric, is_constant, is_steep } = balance.tangent().shape();
        let linear = if half <= WIDEST_BAND {
            Linear::Direct {
                exchange: Band::new(count, half),
                system: Band::new(count, half),
                probed: false,
                is_constant,
            }
        } else {
            Linear::Iterative(Krylov::new(count, is_symmetric))
        };
        Newton {
            count,
            residual: column(),
            slopes: column(),
            roots: column(),
            change: column(),
            scratch: column(),
            right: column(),
            diagonal: column(),
            linear,
            before: if is_steep { column() } else { Vec::new() },
            row_sum,
            histogram: [0; MOST_ITERATIONS as usize + 1],
            solves: 0,
            iterations: 0,
            paths: 0,
            evaluations: 0,
            linear_iterations: 0,
            most: 0,
        }
    }

    /// Median and greatest number of iterations of a solve.
    pub fn median_and_most(&self) -> (u32, u32) {
        let mut below = 0;
        let median = self.histogram.iter().position(|count| {
            below += count;
            2 * below >= self.solves.max(1)
        });
        (median.unwrap_or(0) as u32, self.most)
    }

    /// Solves a stage from the guess in `state`, which takes the solution; `rate` and `patches` take what belongs to it.
    pub fn solve(
        &mut self,
        balance: &mut dyn Balance,
        stage: &Stage<'_>,
        state: &mut [f64],
        rate: &mut [f64],
        patches: &mut [f64],
    ) -> Result<(), NotConverged> {
        self.solves += 1;
        let mut iterations = self.iterations;
        let mut found = self.iterate(balance, stage, state, rate, patches);
        if found.is_err() {
            self.paths += 1;
            iterations = self.iterations;
            found = self.follow(balance, stage, state, rate, patches);
        }
        let taken = (self.iterations - iterations).min(u64::from(u32::MAX)) as u32;
        self.most = self.most.max(taken);
        self.histogram[taken.min(MOST_ITERATIONS) as usize] += 1;
        found
    }

    /// Follows the solutions of growing weights.
    fn follow(
        &mut self,
        balance: &mut dyn Balance,
        stage: &Stage<'_>,
        state: &mut [f64],
        rate: &mut [f64],
        patches: &mut [f64],
    ) -> Result<(), NotConverged> {
        state.copy_from_slice(stage.known);
        let mut kept = state.to_vec();
        let (mut reached, mut stretch): (f64, f64) = (0.0, 0.25);
        while reached < 1.0 {
            let next = (reached + stretch).min(1.0);
            let part = Stage { weight: next * stage.weight, ..*stage };
            match self.iterate(balance, &part, state, rate, patches) {
                Ok(()) => {
                    kept.copy_from_slice(state);
                    reached = next;
                    stretch *= 2.0;
                }
                Err(NotConverged) => {
                    state.copy_from_slice(&kept);
                    stretch *= 0.25;
                    if stretch < LEAST_STRETCH {
                        return Err(NotConverged);
                    }
                }
            }
        }
        Ok(())
    }

    fn iterate(
        &mut self,
        balance: &mut dyn Balance,
        stage: &Stage<'_>,
        state: &mut [f64],
        rate: &mut [f64],
        patches: &mut [f64],
    ) -> Result<(), NotConverged> {
        let (mut last, mut part) = (f64::INFINITY, 1.0);
        let (mut best, mut stalled) = (f64::INFINITY, 0);
        let mut iteration = 0;
        while iteration < MOST_ITERATIONS {
            balance.rates(state, &stage.clock, rate, patches);
            self.evaluations += 1;
            let mut worst: f64 = 0.0;
            for (i, residual) in self.residual.iter_mut().enumerate() {
                *residual = stage.known[i] - state[i] + stage.weight * rate[i];
                let relative = residual.abs() / stage.range.scale(i);
                // A plain comparison would let NaN pass.
                worst = if relative <= worst { worst } else { relative };
            }
            if worst <= RESIDUAL {
                return Ok(());
            }
            if !worst.is_finite() {
                return Err(NotConverged);
            }
            let shortens = !self.before.is_empty() && iteration > WHOLE_STEPS;
            if shortens && worst > last && part > LEAST_PART {
                part *= 0.5;
                self.change.iter_mut().for_each(|change| *change *= 0.5);
                state.copy_from_slice(&self.before);
                balance.tangent().take(state, &self.change, &self.slopes, (stage.weight, self.row_sum));
                continue;
            }
            (part, iteration) = (1.0, iteration + 1);
            stalled = if worst > 0.5 * best { stalled + 1 } else { 0 };
            best = best.min(worst);
            if stalled == MOST_STALLED && worst <= ROUNDING {
                return Ok(());
            }
            let fall = (worst / last).min(1.0);
            let relative = LOOSEST.min(fall * fall).max(0.1 * RESIDUAL / worst);
            last = worst;
            let tangent = balance.tangent();
            tangent.linearise(state, stage.clock.time, &mut self.slopes);
            self.iterations += 1;
            self.step(tangent, stage.weight, relative);
            if !self.before.is_empty() {
                self.before.copy_from_slice(state);
            }
            balance.tangent().take(state, &self.change, &self.slopes, (stage.weight, self.row_sum));
        }
        Err(NotConverged)
    }

    /// The change of enthalpies that the linearised system wants.
    fn step(&mut self, tangent: &mut dyn Tangent, weight: f64, relative: f64) {
        let Newton { residual, slopes, roots, change, scratch, right, diagonal, linear, .. } = self;
        match linear {
            Linear::Direct { exchange, system, probed, is_constant } => {
                if !*probed {
                    probe(tangent, exchange, change, scratch);
                    self.evaluations += 2 * exchange.half() as u64 + 1;
                    *probed = *is_constant;
                }
                let half = exchange.half();
                for i in 0..self.count {
                    let (from, into) = (exchange.row(i), system.row_mut(i));
                    for (offset, (into, from)) in into.iter_mut().zip(from).enumerate() {
                        let slope = slopes.get((i + offset).wrapping_sub(half)).copied().unwrap_or(0.0);
                        *into = f64::from(u8::from(offset == half)) - weight * from * slope;
                    }
                }
                change.copy_from_slice(residual);
                system.solve(change);
                self.linear_iterations += 1;
            }
            Linear::Iterative(krylov) => {
                for i in 0..self.count {
                    roots[i] = slopes[i].sqrt();
                    right[i] = roots[i] * residual[i];
                    diagonal[i] = 1.0 + weight * self.row_sum * slopes[i];
                }
                let mut products = 0;
                let roots = &*roots;
                let matrix = |vector: &[f64], out: &mut [f64]| {
                    for (scratch, (root, v)) in scratch.iter_mut().zip(roots.iter().zip(vector)) {
                        *scratch = root * v;
                    }
                    tangent.act(scratch, out);
                    for (out, (root, v)) in out.iter_mut().zip(roots.iter().zip(vector)) {
                        *out = v - weight * root * *out;
                    }
                    products += 1;
                };
                self.linear_iterations += krylov.solve(matrix, diagonal, right, change, relative);
                // `change` holds dU / root: on passive particles the enthalpy follows from its neighbours' potentials.
                for (scratch, (root, change)) in scratch.iter_mut().zip(roots.iter().zip(change.iter())) {
                    *scratch = root * change;
                }
                tangent.act(scratch, right);
                self.evaluations += products + 1;
                let largest = roots.iter().copied().fold(0.0, f64::max);
                for i in 0..self.count {
                    change[i] = if roots[i] > PASSIVE * largest {
                        change[i] / roots[i]
                    } else {
                        residual[i] + weight * right[i]
                    };
                }
            }
        }
    }
}

impl Saved for Newton {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [
            &mut self.histogram,
            &mut self.solves,
            &mut self.iterations,
            &mut self.paths,
            &mut self.evaluations,
            &mut self.linear_iterations,
            &mut self.most,
        ]);
        if let Linear::Direct { exchange, probed, .. } = &mut self.linear {
            probed.pass(pass);
            if *probed {
                exchange.pass(pass);
            }
        }
    }
}

impl HeapSize for Newton {
    fn heap_size(&self) -> usize {
        let columns =
            [&self.residual, &self.slopes, &self.roots, &self.change, &self.scratch, &self.right, &self.diagonal];
        let linear = match &self.linear {
            Linear::Direct { exchange, system, .. } => exchange.heap_size() + system.heap_size(),
            Linear::Iterative(krylov) => krylov.heap_size(),
        };
        columns.into_iter().map(HeapSize::heap_size).sum::<usize>() + self.before.heap_size() + linear
    }
}

/// Root of dU/dH, over the largest, below which a particle is passive.
const PASSIVE: f64 = 1e-8;

/// Finds the entries of the exchange by acting on columns of ones that are too far apart to meet.
fn probe(tangent: &mut dyn Tangent, exchange: &mut Band, ones: &mut [f64], image: &mut [f64]) {
    let (half, count) = (exchange.half(), exchange.len());
    let apart = 2 * half + 1;
    for first in 0..apart.min(count) {
        ones.fill(0.0);
        ones.iter_mut().skip(first).step_by(apart).for_each(|one| *one = 1.0);
        tangent.act(ones, image);
        for column in (first..count).step_by(apart) {
            for (row, image) in image.iter().enumerate().take(column + half + 1).skip(column.saturating_sub(half)) {
                exchange.row_mut(row)[column + half - row] = *image;
            }
        }
    }
}
