//! How steps are made, and how long they are.

use std::sync::Arc;

use frazil_core::kernels::lattice::LatticeBalance;
use frazil_core::kernels::lattice_parts::LatticeParts;
use frazil_core::physics::laws::Runs;
use frazil_core::physics::potential::Law;
use frazil_core::solvers::balance::Balance;
use frazil_core::solvers::control::EnthalpyRange;
use frazil_core::solvers::euler::Euler;
use frazil_core::solvers::heun::Heun;
use frazil_core::solvers::implicit::Implicit;
use frazil_core::solvers::rkl2::Rkl2;
use frazil_core::solvers::solver::{Solver, SolverReport};
use frazil_core::solvers::step::Bound;
use frazil_core::team::Team;
use frazil_scene::Scene;
use frazil_scene::settings::{IntegratorChoice, Numerics, StepChoice};
use rayon::ThreadPool;

use crate::refused::Refused;

/// Stages of one step by error: longer steps are rarely as exact as they are stable, and gain less and less.
pub(crate) const MOST_STAGES: usize = 99;

/// Steps of Euler from which on rounding is made up for: it takes from the heat balance up to 2e-17 of what was exchanged with
/// each (`stefan-number-1e-3`, 853,380 steps without: 1.6e-11), and beyond 1e-12 it would show.
const MANY_STEPS: f64 = 5e4;

/// Particles up to which that costs next to nothing: contents, rates and what is kept stay in the cache of a core. With a million it
/// doubles the time of a step, for twelfth digits of a run that takes minutes already.
const FEW_PARTICLES: usize = 1 << 16;

/// Steps of one run: more and time, which is as good as 16 digits, would stand still.
const MOST_STEPS: f64 = 1e15;

/// The balance on a lattice, with the laws of its materials.
pub(super) fn on_lattice(parts: LatticeParts) -> Box<dyn Balance> {
    if parts.materials.mixed() {
        let runs = Runs::new(&parts.materials, parts.lattice.len());
        return Box::new(LatticeBalance::new(parts, runs));
    }
    match parts.materials.thermals[0].law.clone() {
        Law::Straight(law) => Box::new(LatticeBalance::new(parts, law)),
        Law::Kinked(law) => Box::new(LatticeBalance::new(parts, law)),
        Law::Curved(law) => Box::new(LatticeBalance::new(parts, law)),
        Law::Tabulated(law) => Box::new(LatticeBalance::new(parts, law)),
        Law::Blended(_) => unreachable!("cells of one material"),
    }
}

/// The solver that settings ask for, for so many particles. A duration (s) is given where nothing but heat is added to contents.
pub(super) fn solver(
    numerics: &Numerics,
    balance: Box<dyn Balance>,
    range: EnthalpyRange,
    largest_slope: f64,
    (count, duration): (usize, Option<f64>),
) -> Box<dyn Solver> {
    let fraction = match numerics.step {
        StepChoice::Fraction(fraction) => fraction,
        StepChoice::Fixed(_) => 1.0,
    };
    match numerics.integrator {
        IntegratorChoice::Euler => {
            let steps = duration.map_or(0.0, |duration| duration / (fraction * balance.facts().bound.step));
            let make = if steps > MANY_STEPS && count <= FEW_PARTICLES {
                Euler::compensated
            } else {
                |balance, fraction, _| Euler::new(balance, fraction)
            };
            Box::new(make(balance, fraction, count))
        }
        IntegratorChoice::Heun => Box::new(Heun::new(balance, fraction, count)),
        IntegratorChoice::Rkl2 { stages } => Box::new(Rkl2::fixed(balance, stages, count)),
        IntegratorChoice::ControlledRkl2 { tolerance } => {
            Box::new(Rkl2::controlled(balance, MOST_STAGES, tolerance, range, count))
        }
        IntegratorChoice::Implicit { tolerance } => {
            Box::new(Implicit::new(balance, tolerance, range, largest_slope, count))
        }
    }
}

/// The report of a body, whose bound is its run where particles exchange nothing.
pub(super) fn limited(report: SolverReport, scene: &Scene) -> SolverReport {
    if report.bound.step.is_finite() {
        return report;
    }
    let bound = Bound::strict(scene.duration, "the run, as no particle exchanges anything");
    SolverReport { bound, ..report }
}

/// The longest step that a run will make (s); steps by error may be shorter.
pub(super) fn choose_step(numerics: &Numerics, bound: &Bound, scene: &Scene) -> Result<f64, Refused> {
    let by_error = numerics.integrator.tolerance().is_some();
    let step = match numerics.step {
        StepChoice::Fraction(_) if by_error => scene.duration,
        StepChoice::Fraction(fraction) => fraction * bound.step,
        StepChoice::Fixed(step) => {
            // A step equal to the bound to rounding is the bound.
            if !by_error && step > bound.step * (1.0 + 1e-12) {
                return Err(Refused::LongStep { step, bound: bound.clone() });
            }
            step
        }
    };
    let steps = scene.duration / step;
    if steps.is_nan() || steps > MOST_STEPS {
        return Err(Refused::ManySteps { steps, step, most: MOST_STEPS, cause: bound.cause.clone() });
    }
    Ok(step.min(scene.duration))
}

/// The threads of a run whose particles stay in their places, if they are more than one.
pub(super) fn team(threads: usize) -> Result<Option<Team>, Refused> {
    Team::new(threads).map_err(|error| Refused::Threads { threads, cause: error.to_string() })
}

pub(super) fn pool(threads: usize) -> Result<Option<Arc<ThreadPool>>, Refused> {
    if threads <= 1 {
        return Ok(None);
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map(|pool| Some(Arc::new(pool)))
        .map_err(|error| Refused::Threads { threads, cause: error.to_string() })
}
