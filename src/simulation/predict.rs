//! What a run will take: its memory and steps counted, its time from a trial of its real steps.
//!
//! The trial makes the first steps of the planned run on a plan of its own, and its outputs and looks besides, for some
//! milliseconds, fewer of a short run. What each takes is multiplied by how often the run will do it.

use std::cell::OnceCell;
use std::fmt;
use std::sync::Arc;
use std::time::Instant;

use frazil_core::memory::Memory;
use frazil_core::solvers::moving::Purpose;
use frazil_core::solvers::rkl2::GROWTH;
use frazil_core::solvers::step::Clock;
use frazil_core::statistics::median;
use frazil_scene::Scene;

use crate::march::guard::Guard;
use crate::march::instants::{next_turn, outputs};
use crate::march::{GUARD_STEPS, Refused};
use crate::observers::Observers;
use crate::observers::observer::{Cadence, Moment, Setup, View};
use crate::plan::refusals::{Counted, affordable, count, holdable};
use crate::plan::{Plan, PlanSummary, build_for, settings_of};
use crate::reference::Reference;

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
                write!(f, "by error control; the first {trial} steps do not tell how many")
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

/// Steps to the end of a run of `duration` (s) whose first steps ended at `times` (s), if their lengths follow a power
/// of time, as steps of a given error do after a jump at the start.
pub fn extrapolated_steps(times: &[f64], duration: f64) -> Option<u64> {
    const FEWEST: usize = 16;
    if times.len() < FEWEST {
        return None;
    }
    if let Some(end) = times.iter().position(|time| *time >= duration) {
        return Some(end as u64 + 1);
    }
    // The later half: the first steps know the jump only.
    let late = &times[times.len() / 2..];
    let points: Vec<(f64, f64)> =
        late.windows(2).map(|pair| ((0.5 * (pair[0] + pair[1])).ln(), (pair[1] - pair[0]).ln())).collect();
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let spread: f64 = points.iter().map(|point| (point.0 - mean.0).powi(2)).sum();
    let slope = points.iter().map(|point| (point.0 - mean.0) * (point.1 - mean.1)).sum::<f64>() / spread;
    // Steps that shrink, or that grow faster than time itself, follow no such law.
    if !(-1e-3..0.95).contains(&slope) {
        return None;
    }
    let scale = (mean.1 - slope * mean.0).exp();
    let last = *times.last()?;
    let rest = (duration.powf(1.0 - slope) - last.powf(1.0 - slope)) / (scale * (1.0 - slope));
    Some((rest.ceil() as u64).saturating_add(times.len() as u64))
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
    /// Blocks at least, unless even the shortest says that they take [`SLOW`] times as long.
    blocks: usize,
}

/// Of steps.
const STEPS: Trial = Trial { longest: 0.03, blocks: 7 };
/// Of each other kind of work.
const BESIDES: Trial = Trial { longest: 0.004, blocks: 3 };
/// Length of a block that is timed as a whole (s): long against the clock, short against whatever interrupts.
const BLOCK: f64 = 0.1e-3;
/// How many times the longest time of a trial some work takes of which no more blocks are made.
const SLOW: f64 = 5.0;
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
    let plan = build_for(Purpose::Trial, scene, settings_of(scene, method)?, reference, threads, seed)?;
    // On one thread its own time does not count what others on the machine do meanwhile.
    let (began, own) = (Instant::now(), cpu_time::ThreadTime::now());
    let mut now = || if threads == 1 { own.elapsed().as_secs_f64() } else { began.elapsed().as_secs_f64() };
    let forecast = try_out(scene, plan, threads, &mut now);
    holdable(scene, method, forecast.summary.memory)?;
    Ok(forecast)
}

/// What can be counted of a run of a scene under a method without a plan; nothing where the scene says nothing of it.
pub fn counted(scene: &Scene, method: &str) -> Option<Counted> {
    let settings = scene.method(method)?;
    let stencil = settings.discretisation.stencil(settings.numerics.spacing, scene.domain.dimension());
    Some(count(scene, settings, &stencil))
}

/// Refuses a run that plainly does not fit into memory, without a plan.
///
/// # Errors
/// The spacing that it must have at least.
pub fn fits(scene: &Scene, method: &str) -> Result<(), Refused> {
    let settings = settings_of(scene, method)?;
    affordable(scene, settings, &settings.discretisation.stencil(settings.numerics.spacing, scene.domain.dimension()))
}

/// Tries a plan by a clock (s).
fn try_out(scene: &Scene, plan: Plan, threads: usize, now: &mut dyn FnMut() -> f64) -> Forecast {
    let Plan { mut particles, mut method, step, bound, mut summary, pipe_extents: pipes } = plan;
    let setup =
        Setup { scene, particles: &particles, method: method.as_ref(), pipes: &pipes, maps: true, reference: None };
    let mut observers = Observers::new(&setup);
    summary.memory = Memory { observers: observers.held_at_the_end(), ..summary.memory };
    let looks = observers.are_due(0.0);
    let mut guard = Guard::new(scene, &particles, &pipes);
    let mut clock = Clock { time: 0.0, step, index: 0, turned: true };
    let mut failed = false;
    let mut times = Vec::new();
    let controlled = matches!(summary.steps, StepCount::ByErrorControl { .. });
    // How many steps there will be under error control is told by those of the trial, and the more the better.
    let planned = summary.steps.number().map(|steps| Work::of(scene, steps, looks));
    let times_of = |count: fn(&Work) -> u64| planned.as_ref().map(count);
    let stepped = timed(STEPS, times_of(|work| work.steps), now, &mut || {
        clock.step = step.min(method.wanted_step());
        match method.advance(&mut particles, &clock) {
            Ok(made) => clock.time += made,
            Err(_) => failed = true,
        }
        clock.index += 1;
        clock.turned = false;
        if controlled {
            times.push(clock.time);
        }
    });
    if let StepCount::ByErrorControl { estimate, trial } = &mut summary.steps {
        (*estimate, *trial) = (extrapolated_steps(&times, scene.duration), times.len() as u64);
    }
    method.publish(&mut particles);
    let mut cost = Cost { step: stepped.each, ..Cost::default() };
    cost.guard = {
        let look = &mut || failed |= guard.look(&particles, &clock, &bound).is_err();
        timed(BESIDES, times_of(|work| work.guards), now, look).each
    };
    if failed {
        // Of a state that has left the numbers nothing can be read, least of all soon.
        return Forecast { summary, work: None, cost, timed_steps: stepped.count, threads };
    }
    // No profile is wanted at the start, and one at each of its instants.
    let mut observe = |time: f64, moment: Moment| {
        let across = method.across(&particles.enthalpy, time);
        let (method, frozen) = (method.as_ref(), OnceCell::new());
        let (particles, ledger) = (&particles, method.ledger());
        observers.observe(&View { scene, particles, method, ledger, across: &across, time, moment, frozen });
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
    let work = summary.steps.number().map(|steps| Work::of(scene, steps, looks));
    Forecast { summary, work, cost, timed_steps: stepped.count, threads }
}

/// Repetitions of some work, and what one took.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timed {
    count: u64,
    each: f64,
}

/// Repeats some work that a run does so many times, as far as that is known, in blocks; the first time is for whatever happens
/// once and does not count. One repetition takes the median over blocks: a block that was interrupted says nothing about the work.
fn timed(trial: Trial, times: Option<u64>, now: &mut dyn FnMut() -> f64, work: &mut dyn FnMut()) -> Timed {
    let enough = |spent: f64, count: u64, blocks: &[f64]| {
        let shortest = blocks.iter().copied().fold(f64::INFINITY, f64::min);
        let all = times.map_or(f64::INFINITY, |times| spent / count as f64 * times as f64);
        shortest * count as f64 >= SLOW * trial.longest
            || blocks.len() >= trial.blocks && spent >= trial.longest.min(SHARE * all)
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
        if enough(end - began, count, &blocks) {
            return Timed { count, each: median(&blocks).unwrap_or(0.0) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

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

    #[test]
    fn the_first_time_and_interruptions_do_not_count() {
        let clock = Fake(Cell::new(0.0));
        let calls = Cell::new(0u32);
        let found = timed(STEPS, None, &mut || clock.0.get(), &mut || {
            calls.set(calls.get() + 1);
            clock.pass(match calls.get() {
                1 => 1.0,
                k if k % 10 == 0 => 4e-3,
                _ => 1e-3,
            });
        });
        assert!((found.each - 1e-3).abs() < 1e-12, "{found:?}");
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

    /// Steps of a given error after a jump: their ends are at `(k / scale)^(1 / (1 - slope))`.
    #[test]
    fn steps_that_grow_with_a_power_of_time_are_counted_from_their_start() {
        for (slope, duration) in [(0.0, 1e4), (0.5, 1e5), (0.75, 1e6)] {
            let end = |k: u64| (k as f64).powf(1.0 / (1.0 - slope));
            let all = (1..).find(|k| end(*k) >= duration).expect("an end");
            let times: Vec<f64> = (1..=40).map(end).collect();
            let found = extrapolated_steps(&times, duration).expect("a law") as f64;
            // A power between two ends is not quite that of the middle.
            assert!((found / all as f64 - 1.0).abs() < 0.02, "{slope}: {found} of {all}");
        }
        let even = |count: u64| (1..=count).map(|k| k as f64).collect::<Vec<_>>();
        assert_eq!(extrapolated_steps(&even(100), 60.0), Some(60));
        assert_eq!(extrapolated_steps(&even(5), 60.0), None);
        let doubling: Vec<f64> = (0..40).map(|k| 2f64.powi(k)).collect();
        assert_eq!(extrapolated_steps(&doubling, 1e30), None);
        let shrinking: Vec<f64> = (1..40).map(|k| 1.0 - 0.5f64.powi(k)).collect();
        assert_eq!(extrapolated_steps(&shrinking, 2.0), None);
    }

    #[test]
    fn what_is_not_known_is_said() {
        let open = |estimate| StepCount::ByErrorControl { estimate, trial: 40 }.to_string();
        assert_eq!(open(Some(900)), "by error control; about 900, estimated from a trial of the first 40 steps");
        assert_eq!(open(None), "by error control; the first 40 steps do not tell how many");
        assert_eq!(StepCount::Planned(12).to_string(), "12");
    }
}
