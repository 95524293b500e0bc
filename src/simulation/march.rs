//! The time loop: from a scene and a method to a [`RunResult`].

pub(crate) mod guard;
pub(crate) mod instants;
mod leave;
mod stopwatch;
mod verdict;

use std::iter::Peekable;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use std::vec::IntoIter;

use frazil_core::ledger::Ledger;
use frazil_core::memory::Memory;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_core::solvers::solver::Solver;
use frazil_core::solvers::step::{Bound, Clock, StepError};
use frazil_record::{Outcome, RunResult};
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;

use crate::checkpoint::{self, Header, Kept, identity};
use crate::observers::Observers;
use crate::observers::observer::{Fractions, Moment, Setup, View};
use crate::observers::readings::Readings;
use crate::plan::refusals::holdable;
use crate::plan::{Plan, build, settings_of};
use crate::reference::Reference;

use guard::{Absurd, Guard};
use instants::{next_turn, stops};
use leave::Course;
use stopwatch::{Elapsed, Stopwatch};

pub use crate::checkpoint::{Checkpoints, Going, Standing, standing};
pub use crate::refused::Refused;
pub use instants::outputs;
pub use verdict::{BALANCE_TOLERANCE, RANGE_TOLERANCE, SETBACK_TOLERANCE};

/// What is told the state at an output and its time (s).
pub type EachOutput<'a> = dyn Fn(&Particles, f64) + Sync + 'a;

/// How a run is to be made; nothing here changes a digit of its result, but the seed.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Threads.
    pub threads: usize,
    /// Seed of the noise and of jittered or random placement.
    pub seed: u64,
    /// Set from outside to stop at the next step.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called when the run is prepared, before its first step.
    pub prepared: Option<&'a (dyn Fn() + Sync)>,
    /// Called now and then (about ten times a second at most).
    pub progress: Option<&'a (dyn Fn(&Progress) + Sync)>,
    /// Give up after this wall time (s) with the outcome `timed_out`.
    pub time_limit_s: Option<f64>,
    /// Whether temperature fields are kept at the profile instants.
    pub fields: bool,
    /// Called with the state at the start and at every output, and its time (s).
    pub each_output: Option<&'a EachOutput<'a>>,
    /// Where the run is kept while it goes on, if it is.
    pub checkpoints: Option<&'a Checkpoints<'a>>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options {
            threads: 1,
            seed: 1,
            interrupt: None,
            prepared: None,
            progress: None,
            time_limit_s: None,
            fields: false,
            each_output: None,
            checkpoints: None,
        }
    }
}

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time (s).
    pub time_s: f64,
    /// End of the run (s).
    pub duration_s: f64,
    /// Steps made.
    pub steps: u64,
    /// Wall time since the first step (s).
    pub elapsed_s: f64,
}

/// Steps between two looks at the whole state for non-finite or absurd values. The first steps, in which walls jump,
/// are looked at more closely: after the 1st, 2nd, 4th, 8th ...
pub(crate) const GUARD_STEPS: u64 = 64;

/// Steps between two looks at the clock, where steps are short.
const LOOK: u64 = 16;

/// Looks into a step in which a gap between pipes closes, where states between steps are known.
const LOOKS: u32 = 8;

/// Part of the time until a gap closes, at the rate at which it does, that an adaptive step may take, and part of the time since the
/// start that it may always take: the error of a step does not see that fronts are about to meet.
const NEARER: f64 = 0.25;
const NEAREST: f64 = 0.002;

/// A run on its way.
struct Simulation<'a> {
    scene: &'a Scene,
    settings: &'a MethodSettings,
    options: &'a Options<'a>,
    particles: Particles,
    method: Box<dyn Solver>,
    bound: Bound,
    /// The longest step that will be made (s), and that was made.
    step: f64,
    longest: f64,
    clock: Clock,
    /// When walls or pipes may jump next (s).
    turn: f64,
    /// Whether states within steps are known, and room for one.
    dense: bool,
    between: Vec<f64>,
    /// Instants that steps land on, and how many of them they have landed on.
    stops: Vec<f64>,
    landed: usize,
    /// Outputs to come.
    pending: Peekable<IntoIter<f64>>,
    observers: Observers,
    guard: Guard,
    observation: Elapsed,
    /// Wall and CPU time (s) of the steps before the run was gone on with, and since.
    before: Elapsed,
    solve: Stopwatch,
    began: Instant,
    last_progress: Instant,
    last_checkpoint: Instant,
}

/// Why a run stopped before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
enum Stop {
    #[error(transparent)]
    Step(#[from] StepError),
    #[error(transparent)]
    Absurd(#[from] Absurd),
    /// At a time (s).
    #[error("the time limit was reached at {0:.6} s")]
    TimedOut(f64),
    /// At a time (s) of a duration.
    #[error("interrupted at {0:.6} s of {1} s")]
    Interrupted(f64, f64),
}

impl Stop {
    fn outcome(&self) -> Outcome {
        match self {
            Stop::Step(_) | Stop::Absurd(_) => Outcome::Diverged,
            Stop::TimedOut(_) => Outcome::TimedOut,
            Stop::Interrupted(..) => Outcome::Interrupted,
        }
    }
}

/// Runs a scene under one method. Errors are taken against `reference`, if there is one.
///
/// # Errors
/// What the plan of the run refuses.
pub fn run(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    options: &Options<'_>,
) -> Result<RunResult, Refused> {
    let setup = Stopwatch::start(options.threads);
    let settings = settings_of(scene, method)?;
    let found = |kept| checkpoint::found(kept, || identity(kept, scene, settings, (options.seed, options.fields)));
    let kept = options.checkpoints.map(found).transpose()?.flatten();
    let plan = build(scene, settings, reference, options.threads, options.seed)?;
    let (particles, method, pipes) = (&plan.particles, plan.method.as_ref(), &plan.pipes[..]);
    let (maps, readings) = (options.fields, Readings::default());
    let observers = Observers::new(&Setup { scene, particles, method, pipes, maps, reference, readings });
    holdable(scene, settings.method, Memory { observers: observers.held_at_the_end(), ..plan.summary.memory })?;
    let setup = setup.stop();
    let guard = Guard::new(scene, &plan.particles, &plan.pipes);
    let (began, dense) = (Instant::now(), plan.method.report().is_dense);
    let Plan { particles, method, step, bound, summary, .. } = plan;
    let outputs = outputs(scene);
    let stops = stops(scene, &outputs, dense);
    let mut simulation = Simulation {
        scene,
        settings,
        options,
        between: vec![0.0; if dense { particles.len() } else { 0 }],
        particles,
        method,
        bound,
        step,
        longest: 0.0,
        clock: Clock { time: 0.0, step: 0.0, index: 0, turned: true },
        turn: f64::NEG_INFINITY,
        dense,
        stops,
        landed: 0,
        pending: outputs.into_iter().peekable(),
        observers,
        guard,
        observation: Elapsed::default(),
        before: Elapsed::default(),
        solve: Stopwatch::start(options.threads),
        began,
        last_progress: began,
        last_checkpoint: began,
    };
    if let Some(tell) = options.prepared {
        tell();
    }
    match &kept {
        Some(kept) => simulation.go_on_from(kept)?,
        None => simulation.begin(),
    }
    let stopped = simulation.march().err();
    let solve = simulation.solved();
    Ok(simulation.leave(Course { stopped, setup, solve, summary }, reference))
}

impl Simulation<'_> {
    /// Shows the state at the start.
    fn begin(&mut self) {
        self.method.publish(&mut self.particles);
        self.observe(0.0, Moment::Start, None);
    }

    /// The time loop: from instant to instant on which steps land.
    fn march(&mut self) -> Result<(), Stop> {
        while let Some(instant) = self.stops.get(self.landed).copied() {
            while self.clock.time < instant {
                let before = self.clock.time;
                let made = self.advance(instant)?;
                if self.dense {
                    self.look_back(before, made);
                }
                self.look()?;
                self.have_patience()?;
            }
            self.arrive(instant)?;
            self.landed += 1;
        }
        Ok(())
    }

    /// Wall and CPU time (s) of the steps, without what observing them took.
    fn solved(&self) -> (f64, f64) {
        let (wall, cpu) = self.solve.stop();
        (self.before.wall + wall - self.observation.wall, self.before.cpu + cpu - self.observation.cpu)
    }

    /// The longest step (s): an adaptive one is short where a gap is about to close.
    fn longest_step(&self) -> f64 {
        let allowed = self.step.min(self.method.wanted_step());
        if self.settings.numerics.integrator.tolerance().is_none() {
            return allowed;
        }
        allowed.min((NEARER * self.observers.until_closure()).max(NEAREST * self.clock.time))
    }

    /// One step towards an instant; its length (s).
    fn advance(&mut self, instant: f64) -> Result<f64, Stop> {
        let allowed = self.longest_step();
        let clock = &mut self.clock;
        clock.turned = clock.time >= self.turn || clock.index == 0;
        if clock.turned {
            self.turn = next_turn(self.scene, clock.time, self.dense);
            let dug = self.scene.excavation.as_ref().filter(|shaft| clock.time >= shaft.start);
            self.particles.shaft = dug.map(|shaft| shaft.radius);
        }
        let landing = instant.min(self.turn);
        let count = ((landing - clock.time) / allowed * (1.0 - 1e-12)).ceil().max(1.0);
        clock.step = (landing - clock.time) / count;
        let made = self.method.advance(&mut self.particles, clock)?;
        self.longest = self.longest.max(made);
        clock.index += 1;
        clock.time = if count == 1.0 && made == clock.step { landing } else { clock.time + made };
        Ok(made)
    }

    /// Takes outputs that the last step passed over, and looks into it where a gap closes in it: in the order of their times.
    fn look_back(&mut self, before: f64, made: f64) {
        let now = self.clock.time;
        let has_closed = self.observers.has_closed(&self.particles, now);
        // Most steps of a line have nothing to show, and take no longer than to ask the clock.
        if !has_closed && self.pending.peek().is_none_or(|time| *time >= now) {
            return;
        }
        let seen = Stopwatch::start(self.options.threads);
        let looks = if has_closed { 1..LOOKS } else { 1..1 };
        let mut looks = looks.map(|part| before + made * part as f64 / LOOKS as f64).peekable();
        while let Some(time) = self.pending.next_if(|time| *time < now) {
            while let Some(within) = looks.next_if(|within| *within < time) {
                self.observe_within(within, Moment::Within, (before, made));
            }
            self.observe_within(time, Moment::Output { landed: false }, (before, made));
        }
        for within in looks {
            self.observe_within(within, Moment::Within, (before, made));
        }
        self.observation.add(&seen);
    }

    /// Shows observers the state at a time (s) within the last step, given by its start and length (s).
    fn observe_within(&mut self, time: f64, moment: Moment, (before, made): (f64, f64)) {
        let ledger = self.method.between(&self.particles, (time - before) / made, &mut self.between);
        std::mem::swap(&mut self.particles.enthalpy, &mut self.between);
        self.observe(time, moment, Some(&ledger));
        std::mem::swap(&mut self.particles.enthalpy, &mut self.between);
    }

    /// Shows observers the state of the particles, at a time (s) and with a ledger that may be another than that of the last step.
    fn observe(&mut self, time: f64, moment: Moment, ledger: Option<&Ledger>) {
        let is_output = matches!(moment, Moment::Output { .. });
        let across = if is_output { self.method.across(&self.particles.enthalpy, time) } else { Vec::new() };
        let (scene, particles, method) = (self.scene, &self.particles, self.method.as_ref());
        let (ledger, fractions) = (ledger.unwrap_or(method.ledger()), Fractions::default());
        self.observers.observe(View { scene, particles, method, ledger, across: &across, time, moment, fractions });
        if let Some(see) = self.options.each_output.filter(|_| is_output || moment == Moment::Start) {
            see(&self.particles, time);
        }
    }

    /// Looks at the state where it is time to: for what is observed between outputs, and for values that are absurd.
    fn look(&mut self) -> Result<(), Stop> {
        let Clock { time, index, .. } = self.clock;
        if self.observers.are_due(time) {
            let seen = Stopwatch::start(self.options.threads);
            self.method.publish(&mut self.particles);
            self.observe(time, Moment::Between, None);
            self.observation.add(&seen);
        }
        if self.dense || index.is_multiple_of(GUARD_STEPS) || index.is_power_of_two() {
            self.method.publish(&mut self.particles);
            self.watch()?;
        }
        Ok(())
    }

    /// Looks for values that are absurd.
    fn watch(&mut self) -> Result<(), Stop> {
        let team = self.method.balance().and_then(|balance| balance.team());
        Ok(self.guard.look(team, &self.particles, &self.clock, &self.bound)?)
    }

    /// Tells how far the run has come, and stops it where it takes too long or is asked to.
    fn have_patience(&mut self) -> Result<(), Stop> {
        let (now, index) = (self.clock.time, self.clock.index);
        if self.dense || index.is_multiple_of(LOOK) {
            let time = Instant::now();
            let elapsed_s = self.before.wall + (time - self.began).as_secs_f64();
            if let Some(progress) = self.options.progress
                && time - self.last_progress > Duration::from_millis(100)
            {
                self.last_progress = time;
                progress(&Progress { time_s: now, duration_s: self.scene.duration, steps: index, elapsed_s });
            }
            if self.options.time_limit_s.is_some_and(|limit| elapsed_s > limit) {
                return Err(Stop::TimedOut(now));
            }
        }
        let is_interrupted = self.options.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed));
        self.keep(is_interrupted);
        if is_interrupted {
            return Err(Stop::Interrupted(now, self.scene.duration));
        }
        Ok(())
    }

    /// Takes the output at an instant on which a step has landed.
    fn arrive(&mut self, instant: f64) -> Result<(), Stop> {
        self.method.publish(&mut self.particles);
        self.watch()?;
        if self.pending.next_if(|time| *time <= instant).is_some() {
            let seen = Stopwatch::start(self.options.threads);
            self.observe(instant, Moment::Output { landed: true }, None);
            self.observation.add(&seen);
        }
        Ok(())
    }
}

impl Saved for Simulation<'_> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.method.pass(pass);
        let mut left = self.pending.len();
        pass.all(&mut [
            &mut self.particles,
            &mut self.longest,
            &mut self.clock.time,
            &mut self.clock.step,
            &mut self.clock.index,
            &mut self.clock.turned,
            &mut self.turn,
            &mut self.landed,
            &mut left,
            &mut self.observers,
            &mut self.guard,
            &mut self.observation,
            &mut self.before,
        ]);
        while self.pending.len() > left {
            self.pending.next();
        }
    }
}

impl Simulation<'_> {
    /// Keeps the run, where it is to be kept and it is time to or it is about to end early.
    fn keep(&mut self, ends: bool) {
        let Some(kept) = self.options.checkpoints else { return };
        let looks = self.dense || self.clock.index.is_multiple_of(LOOK);
        if !(ends || looks && self.last_checkpoint.elapsed() >= kept.every) {
            return;
        }
        let seen = Stopwatch::start(self.options.threads);
        // What goes on from here counts its own time from nought.
        let before = std::mem::take(&mut self.before);
        let (wall, cpu) = self.solve.stop();
        self.before = Elapsed { wall: before.wall + wall, cpu: before.cpu + cpu };
        let mut pass = Pass::save();
        self.pass(&mut pass);
        self.before = before;
        let standing = Standing {
            scene: self.scene.name.clone(),
            method: self.settings.method.to_owned(),
            time_s: self.clock.time,
            duration_s: self.scene.duration,
            steps: self.clock.index,
            solve_wall_s: self.solved().0,
        };
        let identity = identity(kept, self.scene, self.settings, (self.options.seed, self.options.fields));
        let header = Header { identity, standing };
        kept.write(&header, &pass.into_bytes());
        self.observation.add(&seen);
        self.last_checkpoint = Instant::now();
    }

    /// Takes the state that a checkpoint keeps.
    ///
    /// # Errors
    /// Fields that are not those of this run.
    fn go_on_from(&mut self, kept: &Kept) -> Result<(), Refused> {
        let mut pass = Pass::load(kept.fields());
        self.pass(&mut pass);
        pass.end().map_err(|foreign| kept.foreign(foreign))
    }
}
