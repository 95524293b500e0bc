//! The runs of a sweep: read, priced and made side by side.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_simulation::march::{Options, Progress};
use frazil_simulation::predict;
use frazil_simulation::reference::Reference;
use serde::{Deserialize, Serialize};

use super::SweepRequest;
use crate::answers::numbers::{Number, numbers};
use crate::campaign::{self, Campaign, Meter};
use crate::expect;
use crate::failure::{Failure, Verdict};
use crate::method;
use crate::parts::{Override, Parts};
use crate::progress;

/// Time of the step of a particle (s) where the first steps tell none.
const SHORTEST: f64 = 1e-9;

/// A run that is to be made.
pub struct Job {
    /// Values of the keys, in their order.
    pub values: Vec<String>,
    /// Method.
    pub method: &'static str,
    scene: Scene,
    reference: Option<Arc<dyn Reference>>,
}

/// A run and its result.
pub struct SweptRun {
    /// Values of the keys, in their order.
    pub values: Vec<String>,
    /// Method.
    pub method: &'static str,
    /// Result.
    pub finding: Finding,
}

/// What a sweep keeps of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// How it ended; absent if it was refused.
    pub outcome: Option<Outcome>,
    /// Why, if not `ok`.
    pub cause: Option<String>,
    /// Particles.
    pub particles: u64,
    /// Steps.
    pub steps: u64,
    /// CPU time of preparation and steps (s).
    pub cpu_s: f64,
    /// Heat balance, or that of the water.
    pub balance_rel: f64,
    /// Its results; none of a run that broke off.
    pub numbers: Vec<Number>,
    /// Hash of the final enthalpies.
    pub state_hash: String,
}

/// All combinations of the values, the last key changing first, each under all methods; and the scene as its file has it.
///
/// # Errors
/// Where the scene cannot be read at one of them, with its values.
pub fn jobs(request: &SweepRequest, parts: &Parts<'_>) -> Result<(Scene, Vec<Job>), Failure> {
    method::check(&request.methods, parts.methods)?;
    let own = (parts.scene_at)(&request.scene, &request.overrides)?;
    let mut combinations: Vec<Vec<String>> = vec![Vec::new()];
    for varied in &request.keys {
        let longer = |before: &Vec<String>| {
            let with = |value: &String| before.iter().chain([value]).cloned().collect();
            varied.values.iter().map(with).collect::<Vec<Vec<String>>>()
        };
        combinations = combinations.iter().flat_map(longer).collect();
    }
    let mut jobs = Vec::new();
    for values in combinations {
        let own = request.keys.iter().zip(&values).map(|(varied, value)| (varied.key.clone(), value.clone()));
        let overrides: Vec<Override> = request.overrides.iter().cloned().chain(own).collect();
        let scene = (parts.scene_at)(&request.scene, &overrides)?;
        let of = || request.keys.iter().zip(&values).map(|(varied, value)| format!("{}={value}", varied.key));
        let truth = (parts.reference_for)(&scene);
        let truth = truth.map_err(|reason| Failure::of(of().collect::<Vec<_>>().join(", "), reason))?;
        let reference: Option<Arc<dyn Reference>> = truth.reference.map(Arc::from);
        let asked: Vec<Option<&str>> = match &request.methods[..] {
            [] => vec![None],
            names => names.iter().map(|name| Some(name.as_str())).collect(),
        };
        for name in asked {
            let method = method::asked(&scene, name)?;
            jobs.push(Job { values: values.clone(), method, scene: scene.clone(), reference: reference.clone() });
        }
    }
    Ok((own, jobs))
}

/// Makes all runs that are not known. What they find does not depend on how many are made at once.
///
/// # Errors
/// Where a result cannot be kept.
pub fn runs(
    request: &SweepRequest,
    parts: &Parts<'_>,
    jobs: Vec<Job>,
    campaign: &Campaign<'_>,
) -> Result<Vec<SweptRun>, Failure> {
    let key = |job: &Job| campaign::key("sweep", &job.scene, job.method, request.seed);
    let prices = prices(request, &jobs, |job| campaign.known::<Finding>(&key(job)).is_some());
    let all: f64 = prices.iter().sum();
    if !request.quiet {
        progress::forewarn("sweep", Some(all / request.threads.clamp(1, jobs.len().max(1)) as f64));
    }
    let (meter, done) = (Meter::new(request.quiet, all.max(f64::MIN_POSITIVE)), AtomicUsize::new(0));
    let found = campaign.side_by_side(&prices, |k| {
        let key = key(&jobs[k]);
        let words = |_| format!("{} of {} runs", done.load(Ordering::Relaxed), jobs.len());
        if let Some(finding) = campaign.known(&key) {
            done.fetch_add(1, Ordering::Relaxed);
            meter.skip(prices[k]);
            return Some(finding);
        }
        let task = meter.task(prices[k]);
        let at = |progress: &Progress| task.at(progress.time_s / progress.duration_s, words);
        let finding = campaign.on_its_way(&key, |checkpoints| {
            let interrupt = Some(campaign.stop());
            let (threads, seed, progress) = (1, request.seed, Some(&at as &(dyn Fn(&Progress) + Sync)));
            let options = Options { threads, seed, interrupt, progress, checkpoints, ..Options::default() };
            one(parts, &jobs[k], &options)
        })?;
        // Another time there may be more memory.
        if finding.outcome.is_some() {
            campaign.keep(&key, &finding);
        }
        done.fetch_add(1, Ordering::Relaxed);
        task.at(1.0, words);
        Some(finding)
    });
    meter.finish();
    let swept = |(job, finding): (Job, Option<Finding>)| {
        Some(SweptRun { values: job.values, method: job.method, finding: finding? })
    };
    Ok(jobs.into_iter().zip(found?).filter_map(swept).collect())
}

/// About how long each run takes (s): in proportion to its particles and steps, and as the largest of its method tells by its first
/// steps. What is known takes no time.
fn prices(request: &SweepRequest, jobs: &[Job], is_known: impl Fn(&Job) -> bool) -> Vec<f64> {
    let size = |job: &Job| if is_known(job) { 0.0 } else { expect::particle_steps(&job.scene, job.method) };
    let mut prices: Vec<f64> = jobs.iter().map(size).collect();
    let mut largest: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, job) in jobs.iter().enumerate() {
        let own = largest.entry(job.method).or_insert(k);
        if prices[k] > prices[*own] {
            *own = k;
        }
    }
    let seconds = |k: usize| {
        let job = &jobs[k];
        let forecast = predict::forecast(&job.scene, job.method, job.reference.as_ref(), 1, request.seed).ok()?;
        Some(forecast.seconds()? / prices[k])
    };
    let by_method: BTreeMap<&str, f64> = largest
        .into_iter()
        .filter(|(_, k)| prices[*k] > 0.0)
        .filter_map(|(method, k)| Some((method, seconds(k)?)))
        .collect();
    for (price, job) in prices.iter_mut().zip(jobs) {
        *price *= by_method.get(job.method).copied().unwrap_or(SHORTEST);
    }
    prices
}

/// One run; nothing if it was interrupted.
fn one(parts: &Parts<'_>, job: &Job, options: &Options<'_>) -> Option<Finding> {
    let result = match (parts.run)(&job.scene, job.method, job.reference.as_ref(), options) {
        Ok(result) => result,
        Err(refused) => return Some(Finding { cause: Some(refused.to_string()), ..Finding::default() }),
    };
    let record = &result.record;
    if record.outcome == Outcome::Interrupted {
        return None;
    }
    let is_whole = Verdict::of(record.outcome) != Verdict::Broken;
    Some(Finding {
        outcome: Some(record.outcome),
        cause: record.cause.clone(),
        particles: record.particles,
        steps: record.steps,
        cpu_s: record.setup_cpu_s + record.solve_cpu_s,
        balance_rel: record.energy_balance_rel,
        numbers: if is_whole { numbers(&job.scene, &result) } else { Vec::new() },
        state_hash: record.state_hash.clone(),
    })
}

/// Names and labels of the numbers of all runs, in the order of the first run that has them.
pub fn columns(runs: &[SweptRun]) -> Vec<(String, String)> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut columns: Vec<(String, String)> = Vec::new();
    for number in runs.iter().flat_map(|run| &run.finding.numbers) {
        places.entry(&number.name).or_insert_with(|| {
            columns.push((number.name.clone(), number.label.clone()));
            columns.len() - 1
        });
    }
    // Errors last, also where only later runs have some number.
    columns.sort_by_key(|(name, _)| name.starts_with("error_"));
    columns
}

impl SweptRun {
    /// Its number of a name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.finding.numbers.iter().find(|number| number.name == name).map(|number| number.value)
    }
}
