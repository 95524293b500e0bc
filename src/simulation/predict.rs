//! What a run will take: its memory and steps counted, its time from a trial of its real steps.
//!
//! The trial makes the first steps of the planned run on a plan of its own, and its outputs and looks besides, for some
//! milliseconds, fewer of a short run. What each takes is multiplied by how often the run will do it.

use std::cell::Cell;
use std::fmt;
use std::sync::Arc;
use std::time::Instant;

use frazil_core::memory::Memory;
use frazil_core::solvers::moving::Purpose;
use frazil_core::solvers::rkl2::{GROWTH, Rkl2};
use frazil_core::solvers::step::{Bound, Clock};
use frazil_core::statistics::median;
use frazil_scene::Scene;
use frazil_scene::settings::IntegratorChoice;

use crate::march::guard::Guard;
use crate::march::instants::{next_turn, outputs};
use crate::march::{GUARD_STEPS, Refused};
use crate::observers::Observers;
use crate::observers::observer::{Cadence, Fractions, Moment, Setup, View};
use crate::observers::readings::Readings;
use crate::plan::refusals::{Counted, affordable, count, holdable};
use crate::plan::steps::MOST_STAGES;
use crate::plan::{Plan, PlanSummary, build_for, settings_of};
use crate::predict::course::{Course, Lengths};
use crate::reference::Reference;

mod course;

/// How many steps a run makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepCount {
    /// Known before the first: lengths follow from the bound and the outputs.
    Planned(u64),
    /// Lengths follow from the error of each step; estimated, where that is possible, from a trial of the first ones.
    ByErrorControl {
        /// All steps, as far as a trial can tell.
        estimate: Option<u64>,
        /// Steps of the trial.
        trial: u64,
    },
}

impl StepCount {
    /// The number, if there is one.
    pub fn number(self) -> Option<u64> {
        match self {
            StepCount::Planned(steps) => Some(steps),
            StepCount::ByErrorControl { estimate, .. } => estimate,
        }
    }
}

impl fmt::Display for StepCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StepCount::Planned(steps) => write!(f, "{steps}"),
            StepCount::ByErrorControl { estimate: Some(steps), trial } => {
                write!(f, "by error control; about {steps}, estimated from a trial of the first {trial} steps")
            }
            StepCount::ByErrorControl { estimate: None, trial } => {
                write!(f, "by error control; not known after a trial of the first {trial} steps")
            }
        }
    }
}

/// Steps of a run of a scene whose longest step is `step` (s), exactly as the time loop makes them: shortened to land
/// on outputs, and growing from `gentle` (s) where the method asks for it.
pub fn planned_steps(scene: &Scene, step: f64, gentle: Option<f64>) -> u64 {
    let (mut time, mut made) = (0.0, 0u64);
    for output in outputs(scene) {
        while time < output {
            let instant = output.min(next_turn(scene, time, false));
            let allowed = gentle.map_or(step, |first| step.min(first * GROWTH.powi(made.min(1000) as i32)));
            let count = ((instant - time) / allowed * (1.0 - 1e-12)).ceil().max(1.0);
            if allowed == step {
                // From here to the instant all steps are alike.
                made += count as u64;
                time = instant;
            } else {
                made += 1;
                time = if count == 1.0 { instant } else { time + (instant - time) / count };
            }
        }
    }
    made
}

/// How often a run does what takes time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Work {
    /// Steps.
    pub steps: u64,
    /// Outputs.
    pub outputs: u64,
    /// Outputs that keep profiles and maps.
    pub profiles: u64,
    /// Looks at gaps between pipes, at most.
    pub looks: u64,
    /// Looks at the range of the whole state.
    pub guards: u64,
}

impl Work {
    /// The work of a run of so many steps. `looks` tells whether there are gaps to look at.
    pub fn of(scene: &Scene, steps: u64, looks: bool) -> Self {
        let outputs = outputs(scene).len() as u64;
        // At 1, 2, 4 ... up to the period, then at its multiples; and at outputs.
        let early = u64::from(steps.min(GUARD_STEPS - 1).checked_ilog2().map_or(0, |power| power + 1));
        let guards = early + steps / GUARD_STEPS + outputs;
        let most = (1.0 / Cadence::SHARE) as u64 + 1;
        Work {
            steps,
            outputs,
            profiles: scene.watch.profiles.len() as u64,
            looks: if looks { steps.min(most) + 1 } else { 0 },
            guards,
        }
    }
}

/// What each kind of work takes once (s).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Cost {
    /// A step.
    pub step: f64,
    /// An output without profiles.
    pub output: f64,
    /// Profiles and maps of one instant.
    pub profile: f64,
    /// A look at all gaps.
    pub look: f64,
    /// A look at the range of the whole state.
    pub guard: f64,
}

impl Cost {
    /// Time of all steps (s).
    pub fn of_steps(&self, work: &Work) -> f64 {
        self.step * work.steps as f64
    }

    /// Time of everything beside the steps (s).
    pub fn beside(&self, work: &Work) -> f64 {
        self.output * work.outputs as f64
            + self.profile * work.profiles as f64
            + self.look * work.looks as f64
            + self.guard * work.guards as f64
    }
}

/// What a run will take.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// The plan; its memory includes the observers.
    pub summary: PlanSummary,
    /// The work, if the number of steps is known.
    pub work: Option<Work>,
    /// What it takes.
    pub cost: Cost,
    /// Steps of the trial that were timed.
    pub timed_steps: u64,
    /// Threads of run and trial.
    pub threads: usize,
}

impl Forecast {
    /// Time of the solution (s), on a machine as free as during the trial, if the number of steps is known.
    pub fn seconds(&self) -> Option<f64> {
        self.work.map(|work| self.cost.of_steps(&work) + self.cost.beside(&work))
    }
}

/// How long some work is tried.
#[derive(Debug, Clone, Copy)]
struct Trial {
    /// Time (s) after which it has told enough, however long the run takes.
    longest: f64,
    /// Blocks at least, unless even the shortest says that they take longer than `most`.
    blocks: usize,
    /// The longest that blocks that are wanted may take (s).
    most: f64,
    /// Whether all repetitions take the same.
    even: bool,
}

/// Of steps.
const STEPS: Trial = Trial { longest: 0.03, blocks: 7, most: 0.15, even: true };
/// Of steps by error, of which it takes some to tell how many there will be: as many on a slow machine, where the fewest have often
/// seen nothing but the jump at the start. Some are made twice, and before some the pressure of water is solved for.
const STEPS_BY_ERROR: Trial = Trial { blocks: 3 * course::FEWEST, most: 1.0, even: false, ..STEPS };
/// Of each other kind of work.
const BESIDES: Trial = Trial { longest: 0.004, blocks: 3, most: 0.02, even: true };
/// Length of a block that is timed as a whole (s): long against the clock, short against whatever interrupts.
const BLOCK: f64 = 0.1e-3;
/// Share of the time that a run takes of some work after which the trial of it has told enough: nobody waits longer to hear of a run
/// of milliseconds than for the run.
const SHARE: f64 = 0.005;

/// Plans a run, and tries it.
///
/// # Errors
/// What the plan of the run refuses.
pub fn forecast(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    seed: u64,
) -> Result<Forecast, Refused> {
    let settings = settings_of(scene, method)?;
    let plan = build_for(Purpose::Trial, scene, settings, reference, threads, seed)?;
    // On one thread its own time does not count what others on the machine do meanwhile.
    let (began, own) = (Instant::now(), cpu_time::ThreadTime::now());
    let mut now = || if threads == 1 { own.elapsed().as_secs_f64() } else { began.elapsed().as_secs_f64() };
    let forecast = try_out(scene, (plan, settings.numerics.integrator), threads, &mut now);
    holdable(scene, method, forecast.summary.memory)?;
    Ok(forecast)
}

/// What can be counted of a run of a scene under a method without a plan; nothing where the scene says nothing of it.
pub fn counted(scene: &Scene, method: &str) -> Option<Counted> {
    let settings = scene.method(method)?;
    let stencil = settings.stencil(settings.numerics.spacing, scene.domain.dimension());
    Some(count(scene, settings, &stencil))
}

/// Refuses a run that plainly does not fit into memory, without a plan.
///
/// # Errors
/// The spacing that it must have at least.
pub fn fits(scene: &Scene, method: &str) -> Result<(), Refused> {
    let settings = settings_of(scene, method)?;
    affordable(scene, settings, &settings.stencil(settings.numerics.spacing, scene.domain.dimension()))
}

/// Tries a plan by a clock (s).
fn try_out(
    scene: &Scene,
    (plan, integrator): (Plan, IntegratorChoice),
    threads: usize,
    now: &mut dyn FnMut() -> f64,
) -> Forecast {
    let Plan { mut particles, mut method, step, bound, mut summary, pipes } = plan;
    let (method_of, readings) = (method.as_ref(), Readings::default());
    let setup =
        Setup { scene, particles: &particles, method: method_of, pipes: &pipes, maps: true, reference: None, readings };
    let mut observers = Observers::new(&setup);
    summary.memory = Memory { observers: observers.held_at_the_end(), ..summary.memory };
    let looks = observers.are_due(0.0);
    let mut guard = Guard::new(scene, &particles, &pipes);
    let mut clock = Clock { time: 0.0, step, index: 0, turned: true };
    let mut failed = false;
    let mut times = Vec::new();
    let controlled = matches!(summary.steps, StepCount::ByErrorControl { .. });
    // How many steps there will be under error control is told by those of the trial, and the more the better.
    let trial = if controlled { STEPS_BY_ERROR } else { STEPS };
    let is_over = Cell::new(false);
    let stepped = timed_until(&is_over, trial, summary.steps.number(), now, &mut || {
        clock.step = step.min(method.wanted_step());
        match method.advance(&mut particles, &clock) {
            Ok(made) => clock.time += made,
            Err(_) => failed = true,
        }
        clock.index += 1;
        clock.turned = false;
        if controlled {
            times.push(clock.time);
            is_over.set(clock.time >= scene.duration);
        }
    });
    let mut cost = Cost { step: stepped.each, ..Cost::default() };
    if let StepCount::ByErrorControl { estimate, trial } = &mut summary.steps {
        let course = course(integrator, &bound, &times, scene.duration);
        (*estimate, *trial) = (course.map(|course| course.steps), times.len() as u64);
        cost.step *= course.map_or(1.0, |course| course.dearer);
    }
    let work = summary.steps.number().map(|steps| Work::of(scene, steps, looks));
    let times_of = |count: fn(&Work) -> u64| work.as_ref().map(count);
    method.publish(&mut particles);
    cost.guard = {
        let team = method.balance().and_then(|balance| balance.team());
        let look = &mut || failed |= guard.look(team, &particles, &clock, &bound).is_err();
        timed(BESIDES, times_of(|work| work.guards), now, look).each
    };
    if failed {
        // Of a state that has left the numbers nothing can be read, least of all soon.
        return Forecast { summary, work: None, cost, timed_steps: stepped.count, threads };
    }
    // No profile is wanted at the start, and one at each of its instants.
    let mut observe = |time: f64, moment: Moment| {
        let across = method.across(&particles.enthalpy, time);
        let (method, fractions) = (method.as_ref(), Fractions::default());
        let (particles, ledger) = (&particles, method.ledger());
        observers.observe(View { scene, particles, method, ledger, across: &across, time, moment, fractions });
    };
    let output = Moment::Output { landed: true };
    cost.output = timed(BESIDES, times_of(|work| work.outputs), now, &mut || observe(0.0, output)).each;
    if let Some(instant) = scene.watch.profiles.first() {
        let both = timed(BESIDES, times_of(|work| work.profiles), now, &mut || observe(*instant, output)).each;
        cost.profile = (both - cost.output).max(0.0);
    }
    if looks {
        cost.look = timed(BESIDES, times_of(|work| work.looks), now, &mut || observe(0.0, Moment::Within)).each;
    }
    Forecast { summary, work, cost, timed_steps: stepped.count, threads }
}

/// Steps by error of an integrator to the end of a run of `duration` (s), from those that ended at `times` (s).
fn course(integrator: IntegratorChoice, bound: &Bound, times: &[f64], duration: f64) -> Option<Course> {
    let lengths = match integrator {
        IntegratorChoice::ControlledRkl2 { .. } => Lengths {
            longest: bound.step * Rkl2::reach(MOST_STAGES),
            evaluations: &|step| Rkl2::stages_for(step / bound.step) as f64,
        },
        // What Newton's method takes is not told by the length of a step.
        _ => Lengths { longest: f64::INFINITY, evaluations: &|_| 1.0 },
    };
    lengths.course(times, duration)
}

/// Repetitions of some work, and what one took.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timed {
    count: u64,
    each: f64,
}

/// Repeats some work that a run does so many times, as far as that is known, in blocks; the first time is for whatever happens
/// once and does not count. One of even repetitions takes the median over blocks: a block that was interrupted says nothing about the
/// work. One of others takes their mean.
fn timed(trial: Trial, times: Option<u64>, now: &mut dyn FnMut() -> f64, work: &mut dyn FnMut()) -> Timed {
    timed_until(&Cell::new(false), trial, times, now, work)
}

/// The same, at the most until all of the work that a run does is over.
fn timed_until(
    is_over: &Cell<bool>,
    trial: Trial,
    times: Option<u64>,
    now: &mut dyn FnMut() -> f64,
    work: &mut dyn FnMut(),
) -> Timed {
    let enough = |spent: f64, count: u64, blocks: &[f64]| {
        let shortest = blocks.iter().copied().fold(f64::INFINITY, f64::min);
        let all = times.map_or(f64::INFINITY, |times| spent / count as f64 * times as f64);
        shortest * count as f64 >= trial.most || blocks.len() >= trial.blocks && spent >= trial.longest.min(SHARE * all)
    };
    work();
    let began = now();
    let (mut block, mut count, mut blocks) = (1u64, 0, Vec::new());
    loop {
        let start = now();
        (0..block).for_each(|_| work());
        let end = now();
        count += block;
        let took = end - start;
        if took < BLOCK && end - began < trial.longest {
            // Still too short to be timed well.
            blocks.clear();
            blocks.push(took / block as f64);
            block *= 2;
        } else {
            blocks.push(took / block as f64);
        }
        if is_over.get() || enough(end - began, count, &blocks) {
            let mean = (end - began) / count as f64;
            return Timed { count, each: if trial.even { median(&blocks).unwrap_or(mean) } else { mean } };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that only work moves.
    struct Fake(Cell<f64>);

    impl Fake {
        fn pass(&self, seconds: f64) {
            self.0.set(self.0.get() + seconds);
        }
    }

    #[test]
    fn work_is_repeated_until_its_time_is_well_known() {
        for each in [1e-7, 3e-5, 2e-3, 0.5] {
            let clock = Fake(Cell::new(0.0));
            let calls = Cell::new(0);
            let found = timed(STEPS, None, &mut || clock.0.get(), &mut || {
                calls.set(calls.get() + 1);
                clock.pass(each);
            });
            // Sums of some hundred thousand equal terms.
            assert!((found.each / each - 1.0).abs() < 1e-9, "{each}: {found:?}");
            // The first time does not count, and the trial stops within a block of its end.
            assert_eq!(found.count + 1, calls.get());
            assert!(found.count as f64 * each <= 0.03 + (2.0 * BLOCK).max(each), "{each}: {found:?}");
        }
    }

    /// What a trial finds of work that takes so long (s) the first time, the second and so on.
    fn tried(trial: Trial, took: impl Fn(u32) -> f64) -> Timed {
        let clock = Fake(Cell::new(0.0));
        let calls = Cell::new(0u32);
        timed(trial, None, &mut || clock.0.get(), &mut || {
            calls.set(calls.get() + 1);
            clock.pass(took(calls.get()));
        })
    }

    #[test]
    fn the_first_time_and_interruptions_do_not_count() {
        let found = tried(STEPS, |call| match call {
            1 => 1.0,
            k if k % 10 == 0 => 4e-3,
            _ => 1e-3,
        });
        assert!((found.each - 1e-3).abs() < 1e-12, "{found:?}");
    }

    /// Steps by error are not even: dear ones count as often as they come.
    #[test]
    fn steps_by_error_take_their_mean() {
        let found = tried(STEPS_BY_ERROR, |call| if call.is_multiple_of(4) { 9e-3 } else { 1e-3 });
        // A quarter of whole rounds of four.
        assert_eq!(found.count % 4, 0, "{found:?}");
        assert!((found.each - 3e-3).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_short_run_is_not_tried_for_longer_than_it_takes() {
        for (each, times) in [(1e-6, 1000), (1e-6, 1_000_000), (1e-6, 1_000_000_000), (1e-3, 10), (1.0, 3)] {
            let clock = Fake(Cell::new(0.0));
            let found = timed(STEPS, Some(times), &mut || clock.0.get(), &mut || clock.pass(each));
            assert!((found.each / each - 1.0).abs() < 1e-9, "{each}: {found:?}");
            // Blocks are as many repetitions as fill them; those before took as long as one of them.
            let block = (2.0 * BLOCK).max(each);
            let blocks = (STEPS.blocks + 1) as f64 * block;
            let least = blocks.max(SHARE * each * times as f64).min(STEPS.longest.max(each));
            let spent = found.count as f64 * each;
            assert!((0.4 * least..least + 2.0 * block).contains(&spent), "{each}, {times}: {spent} of {least}");
        }
    }

    #[test]
    fn the_time_of_a_run_is_the_sum_of_its_work() {
        let work = Work { steps: 1000, outputs: 10, profiles: 3, looks: 7, guards: 20 };
        let cost = Cost { step: 1e-3, output: 1e-2, profile: 0.1, look: 1e-4, guard: 1e-5 };
        assert!((cost.of_steps(&work) - 1.0).abs() < 1e-12);
        assert!((cost.beside(&work) - (0.1 + 0.3 + 7e-4 + 2e-4)).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_known_is_said() {
        let open = |estimate| StepCount::ByErrorControl { estimate, trial: 40 }.to_string();
        assert_eq!(open(Some(900)), "by error control; about 900, estimated from a trial of the first 40 steps");
        assert_eq!(open(None), "by error control; not known after a trial of the first 40 steps");
        assert_eq!(StepCount::Planned(12).to_string(), "12");
    }
}
