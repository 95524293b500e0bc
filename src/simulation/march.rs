//! The time loop: from a scene and a method to a [`RunResult`].

pub(crate) mod guard;
pub(crate) mod instants;

pub use crate::refused::Refused;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::measure::attach;
use crate::plan::{Plan, build, settings_of};
use crate::reference::Reference;
use crate::terms::fluctuation;
use crate::watch::Watches;
use crate::water::WaterWatch;
use frazil_core::ledger::Ledger;
use frazil_core::particles::Particles;
use frazil_core::physics::uptake::Uptake;
use frazil_core::solvers::method::Method;
use frazil_core::solvers::step::Clock;
use frazil_record::{Errors, Outcome, Record, RunResult};
use frazil_scene::Scene;
use frazil_scene::settings::MethodSettings;

use guard::Guard;
pub use instants::outputs;
use instants::{next_turn, stops};

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
    /// Called now and then (about ten times a second at most).
    pub progress: Option<&'a (dyn Fn(&Progress) + Sync)>,
    /// Give up after this wall time (s) with the outcome `timed_out`.
    pub time_limit_s: Option<f64>,
    /// Whether temperature fields are kept at the profile instants.
    pub fields: bool,
    /// Called with the state at the start and at every output, and its time (s).
    pub each_output: Option<&'a EachOutput<'a>>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options {
            threads: 1,
            seed: 1,
            interrupt: None,
            progress: None,
            time_limit_s: None,
            fields: false,
            each_output: None,
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

/// Looks into a step in which a gap between pipes closes, where states between steps are known.
const LOOKS: u32 = 8;

/// Runs a scene under one method. Errors are taken against `reference`, if there is one.
pub fn run(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    options: &Options<'_>,
) -> Result<RunResult, Refused> {
    let threads = options.threads;
    let setup = Stopwatch::start(threads);
    let settings = settings_of(scene, method)?;
    let plan = build(scene, settings, reference, options.threads, options.seed)?;
    let mut watches = Watches::new(scene, &plan.particles, &plan.pipe_extents, options.fields);
    let mut water = WaterWatch::new(scene, &plan.particles, plan.method.as_ref(), options.fields);
    let setup = setup.stop();
    let Plan { mut particles, mut method, step, bound, summary, pipe_extents } = plan;
    let mut guard = Guard::new(scene, &particles, &pipe_extents);
    let solve = Stopwatch::start(threads);
    let began = Instant::now();
    let mut last_progress = began;
    let mut clock = Clock { time: 0.0, step: 0.0, index: 0, turned: true };
    let mut longest: f64 = 0.0;
    let mut stop: Option<(Outcome, String)> = None;
    watches.begin(&particles);
    watches.look(&particles, 0.0);
    let show = |particles: &Particles, time: f64| {
        if let Some(see) = options.each_output {
            see(particles, time);
        }
    };
    show(&particles, 0.0);
    let dense = method.is_dense();
    let outputs = outputs(scene);
    let mut pending = outputs.iter().copied().peekable();
    let mut turn = f64::NEG_INFINITY;
    let mut observation = Elapsed::default();
    let mut between = vec![0.0; if dense { particles.len() } else { 0 }];
    'run: for instant in stops(scene, &outputs, dense) {
        while clock.time < instant {
            let allowed = step.min(method.wanted_step());
            clock.turned = clock.time >= turn || clock.index == 0;
            if clock.turned {
                turn = next_turn(scene, clock.time, dense);
                particles.shaft =
                    scene.excavation.as_ref().filter(|shaft| clock.time >= shaft.start).map(|shaft| shaft.radius);
            }
            let landing = instant.min(turn);
            let count = ((landing - clock.time) / allowed * (1.0 - 1e-12)).ceil().max(1.0);
            clock.step = (landing - clock.time) / count;
            let made = match method.advance(&mut particles, &clock) {
                Ok(made) => made,
                Err(error) => {
                    stop = Some((Outcome::Diverged, error.reason));
                    break 'run;
                }
            };
            longest = longest.max(made);
            clock.index += 1;
            let before = clock.time;
            let now = if count == 1.0 && made == clock.step { landing } else { before + made };
            clock.time = now;
            if dense && (pending.peek().is_some_and(|time| *time < now) || watches.closes(&particles)) {
                let seen = Stopwatch::start(threads);
                type See<'a> = &'a mut dyn FnMut(&mut dyn Method, &Particles, &Ledger);
                let mut at = |method: &mut dyn Method, time: f64, particles: &mut Particles, see: See<'_>| {
                    let ledger = method.between(particles, (time - before) / made, &mut between);
                    std::mem::swap(&mut particles.enthalpy, &mut between);
                    see(method, particles, &ledger);
                    std::mem::swap(&mut particles.enthalpy, &mut between);
                };
                while let Some(time) = pending.next_if(|time| *time < now) {
                    at(method.as_mut(), time, &mut particles, &mut |method, particles, ledger| {
                        watches.output(scene, particles, ledger, time, false);
                        watches.surfaces(scene, &method.across(&particles.enthalpy, time), time);
                        show(particles, time);
                    });
                }
                if watches.closes(&particles) {
                    for part in 1..LOOKS {
                        let time = before + made * part as f64 / LOOKS as f64;
                        at(method.as_mut(), time, &mut particles, &mut |_, particles, _| watches.look(particles, time));
                    }
                }
                observation.add(&seen);
            }
            if watches.due(now) {
                method.publish(&mut particles);
                watches.look(&particles, now);
            }
            if dense || clock.index.is_multiple_of(GUARD_STEPS) || clock.index.is_power_of_two() {
                method.publish(&mut particles);
                if let Err(cause) = guard.look(&particles, &clock, &bound) {
                    stop = Some((Outcome::Diverged, cause));
                    break 'run;
                }
            }
            if dense || clock.index.is_multiple_of(16) {
                let elapsed = Instant::now();
                if let Some(progress) = options.progress
                    && elapsed - last_progress > Duration::from_millis(100)
                {
                    last_progress = elapsed;
                    progress(&Progress {
                        time_s: now,
                        duration_s: scene.duration,
                        steps: clock.index,
                        elapsed_s: (elapsed - began).as_secs_f64(),
                    });
                }
                if options.time_limit_s.is_some_and(|limit| (elapsed - began).as_secs_f64() > limit) {
                    stop = Some((Outcome::TimedOut, format!("the time allowed ran out at {now:.6} s")));
                    break 'run;
                }
            }
            if options.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                stop = Some((Outcome::Interrupted, format!("interrupted at {now:.6} s of {} s", scene.duration)));
                break 'run;
            }
        }
        method.publish(&mut particles);
        if let Err(cause) = guard.look(&particles, &clock, &bound) {
            stop = Some((Outcome::Diverged, cause));
            break 'run;
        }
        if pending.next_if(|time| *time <= instant).is_some() {
            let seen = Stopwatch::start(threads);
            watches.output(scene, &particles, method.ledger(), instant, true);
            watches.surfaces(scene, &method.across(&particles.enthalpy, instant), instant);
            show(&particles, instant);
            if let Some(water) = &mut water {
                water.output(scene, &particles, method.as_ref(), instant, options.fields);
            }
            observation.add(&seen);
        }
    }
    let mut solve = solve.stop();
    solve.0 -= observation.wall;
    solve.1 -= observation.cpu;
    let gaps = watches.gap_rows();
    let balance = watches.budget.iter().map(|row| row.balance_rel).fold(0.0, larger_magnitude);
    let noise = noise(scene, settings, &particles);
    let setback = watches.one_way.setback();
    let (outcome, cause) = match stop {
        Some((outcome, cause)) => (outcome, Some(cause)),
        None => judge(settings.numerics.uptake, balance, guard.violation(), setback, noise),
    };
    let (stream, mut sections) = watches.stream(&particles);
    let work = method.work();
    let record = Record {
        frazil_version: env!("CARGO_PKG_VERSION").to_string(),
        scene: scene.name.clone(),
        title: scene.title.clone(),
        scene_hash: scene.hash.clone(),
        method: settings.method.to_string(),
        settings: settings.values(),
        units: scene.units.name().to_string(),
        particles: summary.particles,
        pairs: summary.pairs,
        steps: clock.index,
        pair_evaluations: summary.pairs * work.evaluations,
        particle_updates: summary.particles * work.evaluations,
        work,
        step_s: longest,
        step_bound_s: bound.step,
        step_limit: bound.cause.clone(),
        threads: options.threads,
        seed: options.seed,
        setup_wall_s: setup.0,
        setup_cpu_s: setup.1,
        solve_wall_s: solve.0,
        solve_cpu_s: solve.1,
        observation_wall_s: observation.wall,
        observation_cpu_s: observation.cpu,
        peak_memory_bytes: peak_memory(),
        outcome,
        cause,
        energy_balance_rel: balance,
        bounds_violation_rel: guard.violation(),
        setback_rel: setback,
        errors: Errors::default(),
        reference: None,
        reduced_from: None,
        water: water.as_mut().map(|water| water.judge(scene, reference.map(|reference| reference.as_ref()))),
        stream: crate::stream::judge(scene, &stream, &mut sections),
        wall: watches.wall_record(),
        spared: summary.spared,
        differences: summary.differences,
        remarks: scene.remarks.clone(),
        state_hash: particles.state_hash(),
    };
    let (links, planes) = watches.wall();
    let mut result = RunResult {
        record,
        front: watches.front,
        start: watches.start,
        beside: Vec::new(),
        frozen: watches.frozen,
        phases: watches.phases,
        stream,
        sections,
        surfaces: watches.surfaces,
        profiles: watches.profiles,
        probes: watches.probe_rows,
        budget_names: method.ledger().names().to_vec(),
        budget: watches.budget,
        walls: watches.walls,
        gaps,
        links,
        planes,
        fields: watches.fields,
        water: water.map(|water| water.series),
    };
    if let Some(reference) = reference {
        attach(scene, particles.lattice.spacing, &mut result, reference.as_ref());
    }
    Ok(result)
}

/// How far noise alone may take temperatures out of the range of the data, over that range: eight standard deviations
/// of one particle at the warmest datum, in the material and phase that fluctuates most ([`crate::terms::fluctuation`]). A
/// normal variable stays within 6.5 over a billion looks; steps up to the bound do not add to it (3.3 at most on
/// `stefan-water`, for 0.05 of the bound as for the whole). Beside walls of moving particles it is twice that: what is seen
/// there is fitted to few neighbours, whose own noise it mirrors (12 at most over the 26 000 steps of `entry-channel`). It is
/// never more than [`MOST_NOISE`].
fn noise(scene: &Scene, settings: &MethodSettings, particles: &Particles) -> f64 {
    let (low, high) = scene.temperature_range();
    let own = settings.discretisation.fluctuation * (high - scene.units.absolute_zero());
    let deviation = particles.materials.laws().map(|law| own * fluctuation(law)).fold(0.0, f64::max);
    let deviations = if particles.move_about() { 16.0 } else { 8.0 };
    if deviation > 0.0 { (deviations * deviation / (high - low)).min(MOST_NOISE) } else { 0.0 }
}

/// Part of the range of the data by which noise may take temperatures out of it. With more, a particle in the middle of the
/// data could be anywhere in them and beyond: noise would no longer be small beside what it is noise of.
const MOST_NOISE: f64 = 0.5;

fn larger_magnitude(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// Heat not accounted for, over that exchanged, up to which a run is `ok`.
pub const BALANCE_TOLERANCE: f64 = 1e-3;
/// How far temperatures of a run that is `ok` may leave the range of the data, over that range.
pub const RANGE_TOLERANCE: f64 = 0.01;
/// How far what can only go one way may go back in a run that is `ok`, over the greatest before.
pub const SETBACK_TOLERANCE: f64 = 0.01;

/// How a run that came to its end is to be called. Balances that rounding explains lie below 1e-10; a lost latent
/// heat shows as more than a thousandth.
fn judge(
    uptake: Uptake,
    balance: f64,
    violation: Option<f64>,
    setback: Option<f64>,
    noise: f64,
) -> (Outcome, Option<String>) {
    if balance.abs() > BALANCE_TOLERANCE {
        let cause = format!("the heat balance misses {:.3e} of the heat exchanged", balance);
        return match uptake {
            Uptake::ApparentCapacity { .. } => {
                (Outcome::PhaseSkipped, Some(format!("{cause}: particles stepped over the freezing interval")))
            }
            Uptake::Enthalpy | Uptake::Flags => (Outcome::EnergyDrift, Some(cause)),
        };
    }
    if let Some(violation) = violation.filter(|violation| *violation > RANGE_TOLERANCE + noise) {
        let mut cause = format!("temperatures left the range of the data by {:.2} % of it", 100.0 * violation);
        if noise > 0.0 {
            cause.push_str(&format!(
                ": noise may do so by {:.2} %, eight standard deviations of one particle or half of the range; particles \
                 that store more heat fluctuate less",
                100.0 * noise
            ));
        }
        return (Outcome::Oscillating, Some(cause));
    }
    // Noise may push a front or a flow back for a moment.
    if let Some(setback) = setback.filter(|setback| *setback > SETBACK_TOLERANCE && noise == 0.0) {
        let cause = format!(
            "the front, or the heat through the coldest or warmest pipes, went back by {:.2} %",
            100.0 * setback
        );
        return (Outcome::Oscillating, Some(cause));
    }
    (Outcome::Ok, None)
}

/// Wall and CPU time together.
struct Stopwatch {
    wall: Instant,
    cpu: Cpu,
}

/// CPU time of whom: a run on one thread is that thread's alone, so that runs side by side are not booked to each other.
enum Cpu {
    Thread(cpu_time::ThreadTime),
    Process(cpu_time::ProcessTime),
}

impl Stopwatch {
    fn start(threads: usize) -> Self {
        let cpu = match threads {
            0 | 1 => Cpu::Thread(cpu_time::ThreadTime::now()),
            _ => Cpu::Process(cpu_time::ProcessTime::now()),
        };
        Stopwatch { wall: Instant::now(), cpu }
    }

    fn stop(&self) -> (f64, f64) {
        let cpu = match &self.cpu {
            Cpu::Thread(time) => time.elapsed(),
            Cpu::Process(time) => time.elapsed(),
        };
        (self.wall.elapsed().as_secs_f64(), cpu.as_secs_f64())
    }
}

/// Wall and CPU time of many stretches (s).
#[derive(Default)]
struct Elapsed {
    wall: f64,
    cpu: f64,
}

impl Elapsed {
    fn add(&mut self, stretch: &Stopwatch) {
        let (wall, cpu) = stretch.stop();
        self.wall += wall;
        self.cpu += cpu;
    }
}

/// Greatest resident memory of the process so far (bytes), where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}
