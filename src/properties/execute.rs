//! The jobs of a study, each on one thread.

use std::cell::Cell;
use std::error::Error;

use frazil_edpd::properties::{diffusion, halves};
use frazil_studies::campaign::{Campaign, Meter, Task};
use frazil_studies::failure::Failure;
use frazil_studies::parallel;
use serde::{Deserialize, Serialize};

use super::plan::{Job, Measurement, celsius};
use super::request::PropertiesRequest;

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

/// Steps of particles that a core makes in a second.
const PACE: f64 = 1.1e6;

/// About how long (s) the jobs will take that are not known.
pub fn seconds(jobs: &[Job], campaign: &Campaign<'_>, threads: usize) -> f64 {
    let open = jobs.iter().filter(|job| campaign.known::<Finding>(&job.key()).is_none());
    seconds_of(open.map(Job::particle_steps).sum(), threads)
}

/// About how long (s) so many steps of particles take.
pub fn seconds_of(particle_steps: u64, threads: usize) -> f64 {
    particle_steps as f64 / PACE / threads.min(parallel::cores()).max(1) as f64
}

/// How far a study is, in words.
pub(super) fn words(particle_steps: f64) -> String {
    format!("{:.0} million particle steps", particle_steps * 1e-6)
}

/// Runs all jobs that are not known. What they find does not depend on how many run at once.
pub fn jobs(request: &PropertiesRequest, jobs: &[Job], campaign: &Campaign<'_>) -> Result<Vec<Finding>, Failure> {
    // All steps of particles cost the same: density and reach are.
    let prices: Vec<f64> = jobs.iter().map(|job| job.particle_steps() as f64).collect();
    let meter = Meter::new(request.quiet, prices.iter().sum());
    let found = campaign.side_by_side(&prices, |k| {
        let key = jobs[k].key();
        let known = campaign.known(&key).inspect(|_| meter.skip(prices[k]));
        known.or_else(|| campaign.make(&key, || run(&jobs[k], &meter.task(prices[k]), campaign)))
    });
    meter.finish();
    Ok(found?.into_iter().flatten().collect())
}

/// Why a job has no finding.
fn failed(job: &Job, cause: impl Into<Box<dyn Error + Send + Sync>>) -> Failure {
    let (word, kelvin) = (job.measurement.word(), celsius(&job.row));
    Failure::of(format!("{word} at {kelvin} degC, seed {}", job.seed), cause)
}

/// One job; nothing if it was told to stop.
fn run(job: &Job, task: &Task<'_>, campaign: &Campaign<'_>) -> Result<Option<Finding>, Failure> {
    let mut fluid = job.fluid().map_err(|error| failed(job, error))?;
    let particles = job.particles();
    let made = Cell::new(0);
    let watch = |steps: u64| {
        made.set(made.get() + steps * particles);
        task.at(made.get() as f64 / job.particle_steps() as f64, words);
        !campaign.is_interrupted()
    };
    let found = match job.measurement {
        Measurement::Diffusion => {
            let found = diffusion::measure(&mut fluid, job.span, &watch).map_err(|error| failed(job, error))?;
            found.map(|found| (found.diffusivity, found.curve))
        }
        Measurement::Halves(push) => {
            let found = halves::measure(&mut fluid, push, job.expected, job.span, &watch)
                .map_err(|error| failed(job, error))?;
            found.map(|found| (found.diffusivity, found.profile))
        }
    };
    let temperature = fluid.totals().internal_temperature;
    Ok(found.map(|(value, curve)| Finding { value, curve, temperature }))
}
