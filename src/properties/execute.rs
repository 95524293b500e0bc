//! The jobs of a study, side by side, each on one thread.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use frazil_edpd::properties::{diffusion, halves};
use serde::{Deserialize, Serialize};

use super::PropertiesRequest;
use super::plan::{Job, Measurement, celsius};
use crate::failure::Failure;
use crate::journal::Journal;
use crate::parallel;
use crate::progress::{Reporter, clock, countdown};

/// What a job found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Self-diffusivity, viscosity or thermal diffusivity.
    pub value: f64,
    /// Mean square displacement by lag; velocity or temperature by height.
    pub curve: Vec<(f64, f64)>,
    /// Internal temperature at the end.
    pub temperature: f64,
}

/// How much of a study is done, in steps of particles, and how long the rest will take.
pub struct Meter<'a> {
    reporter: Reporter,
    stop: &'a AtomicBool,
    began: Instant,
    all: u64,
    known: AtomicU64,
    made: AtomicU64,
}

impl<'a> Meter<'a> {
    /// For so many steps of particles.
    pub fn new(quiet: bool, all: u64, stop: &'a AtomicBool) -> Self {
        Meter {
            reporter: Reporter::new(quiet),
            stop,
            began: Instant::now(),
            all: all.max(1),
            known: AtomicU64::new(0),
            made: AtomicU64::new(0),
        }
    }

    /// Takes down what need not be made.
    pub fn skip(&self, particle_steps: u64) {
        self.known.fetch_add(particle_steps, Ordering::Relaxed);
    }

    /// Takes down what was made; says whether to go on.
    pub fn made(&self, particle_steps: u64) -> bool {
        let made = self.made.fetch_add(particle_steps, Ordering::Relaxed) + particle_steps;
        let known = self.known.load(Ordering::Relaxed);
        let share = (made + known) as f64 / self.all as f64;
        self.reporter.at(share.min(1.0), || {
            let gone = self.began.elapsed().as_secs_f64();
            // All steps of particles cost the same: density and reach are. Those that were known took no time.
            let left = countdown(gone, made as f64 / self.all.saturating_sub(known).max(1) as f64);
            format!("{:.0} million particle steps, {}{left}", (made + known) as f64 * 1e-6, clock(gone))
        });
        !self.stop.load(Ordering::Relaxed)
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.reporter.finish();
    }
}

/// Steps of particles that a core makes in a second, about: [`Meter`] measures how many it really makes.
const PACE: f64 = 1.1e6;

/// About how long (s) the jobs will take that the journal does not know.
pub fn seconds(jobs: &[Job], journal: &Journal<Finding>, threads: usize) -> f64 {
    let open = jobs.iter().filter(|job| journal.find(&job.key()).is_none());
    seconds_of(open.map(Job::particle_steps).sum(), threads)
}

/// About how long (s) so many steps of particles take.
pub fn seconds_of(particle_steps: u64, threads: usize) -> f64 {
    particle_steps as f64 / PACE / threads.min(parallel::cores()).max(1) as f64
}

/// Runs all jobs, or takes them from the journal; in their order. What they find does not depend on how many run at once.
pub fn jobs(
    request: &PropertiesRequest,
    jobs: &[Job],
    journal: &Journal<Finding>,
    stop: &AtomicBool,
) -> Result<Vec<Finding>, Failure> {
    let meter = Meter::new(request.quiet, jobs.iter().map(Job::particle_steps).sum(), stop);
    let failed = Mutex::new(None);
    // The longest first, so that none is left over at the end.
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|k| std::cmp::Reverse(jobs[*k].particle_steps()));
    let found = parallel::in_order(order.len(), request.threads, |k| {
        let job = &jobs[order[k]];
        if failed.lock().unwrap_or_else(PoisonError::into_inner).is_some() || stop.load(Ordering::Relaxed) {
            return None;
        }
        let key = job.key();
        if let Some(finding) = journal.find(&key) {
            meter.skip(job.particle_steps());
            return Some(finding);
        }
        let finding = run(job, &meter).and_then(|found| {
            if let Some(finding) = &found {
                journal.add(&key, finding)?;
            }
            Ok(found)
        });
        finding.unwrap_or_else(|failure| {
            failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
            None
        })
    });
    meter.finish();
    if let Some(failure) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(failure);
    }
    let mut sorted: Vec<(usize, Finding)> =
        order.into_iter().zip(found).filter_map(|(job, found)| Some((job, found?))).collect();
    sorted.sort_by_key(|(job, _)| *job);
    Ok(sorted.into_iter().map(|(_, found)| found).collect())
}

/// One job; nothing if it was told to stop.
fn run(job: &Job, meter: &Meter<'_>) -> Result<Option<Finding>, Failure> {
    let failure = |message| {
        let (word, kelvin) = (job.measurement.word(), celsius(&job.row));
        Failure::Request(format!("{word} at {kelvin} degC, seed {}: {message}", job.seed))
    };
    let mut fluid = job.fluid().map_err(failure)?;
    let particles = job.particles();
    // Numbers of steps are rounded up a little: nothing beyond what was promised is told.
    let left = Cell::new(job.particle_steps());
    let watch = |steps: u64| {
        let made = (steps * particles).min(left.get());
        left.set(left.get() - made);
        meter.made(made)
    };
    let found = match job.measurement {
        Measurement::Diffusion => {
            let found = diffusion::measure(&mut fluid, job.span, &watch).map_err(failure)?;
            found.map(|found| (found.diffusivity, found.curve))
        }
        Measurement::Halves(push) => {
            let found = halves::measure(&mut fluid, push, job.expected, job.span, &watch).map_err(failure)?;
            found.map(|found| (found.diffusivity, found.profile))
        }
    };
    let temperature = fluid.totals().internal_temperature;
    Ok(found.map(|(value, curve)| Finding { value, curve, temperature }))
}
