//! The runs of a study: columns side by side, each along its own steps.

use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use frazil_record::Outcome;
use frazil_simulation::plan::Bounds;

use super::axis::Axis;
use super::cell::{self, Finding, Probe};
use super::plan::Job;
use super::request::StabilityRequest;
use super::search::{self, Ladder, climb, grid};
use super::super_steps;
use crate::campaign::{Campaign, Meter};
use crate::failure::Failure;
use crate::parts::{Override, Parts};
use crate::progress;

/// Ends of a map, in theoretical bounds.
pub const RANGE: (f64, f64) = (0.25, 4.0);

/// A column that was worked on.
pub struct Mapped {
    /// What was asked.
    pub job: Job,
    /// What was found, or why there is nothing.
    pub found: Result<Column, Failure>,
}

/// What a column shows.
pub struct Column {
    /// The scene and its bounds.
    pub probe: Probe,
    /// Cells and boundaries.
    pub ladder: Ladder,
}

/// Works on all columns. What they show does not depend on how many are worked on at once.
pub fn columns(
    request: &StabilityRequest,
    parts: &Parts<'_>,
    jobs: Vec<Job>,
    campaign: &Campaign<'_>,
) -> Result<Vec<Mapped>, Failure> {
    let study = Study { request, parts, campaign, bounds: Mutex::new(HashMap::new()) };
    let seconds = if request.quiet { vec![None; jobs.len()] } else { study.seconds(&jobs)? };
    let told: Vec<f64> = seconds.iter().copied().flatten().filter(|seconds| *seconds > 0.0).collect();
    if !request.quiet {
        let workers = request.threads.clamp(1, jobs.len().max(1)) as f64;
        progress::forewarn("stability", Some(told.iter().sum::<f64>() / workers));
    }
    // What the first steps do not tell is taken to be like the others.
    let mean = if told.is_empty() { 1.0 } else { told.iter().sum::<f64>() / told.len() as f64 };
    let prices: Vec<f64> = seconds.into_iter().map(|seconds| seconds.unwrap_or(mean)).collect();
    let (meter, done) = (Meter::new(request.quiet, prices.iter().sum()), AtomicUsize::new(0));
    let found = campaign.side_by_side(&prices, |k| {
        let (found, was_made) = study.column(&jobs[k])?;
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        match was_made {
            true => meter.made(prices[k], |_| format!("{count} of {} columns", jobs.len())),
            false => meter.skip(prices[k]),
        }
        Some(found)
    });
    meter.finish();
    // A study that was stopped has gaps.
    Ok(jobs.into_iter().zip(found?).filter_map(|(job, found)| Some(Mapped { job, found: found? })).collect())
}

/// Largest ratio of two steps between the bound and the linear stability limit: an overshoot there may come and go
/// within a tenth of the step.
const FINE: f64 = 1.05;

/// Steps with finer ones between one and a little beyond `limit`.
fn refined(mut steps: Vec<f64>, limit: f64) -> Vec<f64> {
    let limit = limit * FINE;
    let count = (limit.ln() / FINE.ln()).ceil() as usize + 1;
    let apart = |fine: &f64| steps.iter().all(|step| (fine / step).ln().abs() > 0.3 * FINE.ln());
    let fine: Vec<f64> = grid(1.0, limit, count).into_iter().filter(apart).collect();
    steps.extend(fine);
    steps.sort_by(f64::total_cmp);
    steps
}

/// Numbers of the columns of each kind.
fn by_kind(jobs: &[Job]) -> BTreeMap<(String, &'static str, Axis), Vec<usize>> {
    let mut kinds: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (k, job) in jobs.iter().enumerate() {
        kinds.entry(kind(job)).or_default().push(k);
    }
    kinds
}

/// Columns of a kind take about the same time.
fn kind(job: &Job) -> (String, &'static str, Axis) {
    let axis = if matches!(job.axis, Axis::Stages | Axis::Noise | Axis::Reach) { job.axis } else { Axis::Own };
    (job.scene.clone(), job.method, axis)
}

/// What decides the bounds: scene, method, and overrides but those of the integrator.
type Particles = (String, &'static str, Vec<Override>);

struct Study<'a> {
    request: &'a StabilityRequest,
    parts: &'a Parts<'a>,
    campaign: &'a Campaign<'a>,
    bounds: Mutex<HashMap<Particles, Bounds>>,
}

impl Study<'_> {
    /// About how long (s) each column takes, from the first steps of one of its kind; zero of those that are known,
    /// and nothing where the steps do not tell.
    fn seconds(&self, jobs: &[Job]) -> Result<Vec<Option<f64>>, Failure> {
        let kinds: Vec<Vec<usize>> = by_kind(jobs).into_values().collect();
        let of_kind = |k: usize| {
            let open: Vec<usize> = kinds[k].iter().copied().filter(|job| !self.is_known(&jobs[*job])).collect();
            let middle = open.get(open.len() / 2)?;
            Some((self.seconds_of(&jobs[*middle]), open))
        };
        let mut seconds = vec![Some(0.0); jobs.len()];
        for (each, open) in self.campaign.side_by_side(&vec![0.0; kinds.len()], of_kind)?.into_iter().flatten() {
            open.into_iter().for_each(|job| seconds[job] = each);
        }
        Ok(seconds)
    }

    fn seconds_of(&self, job: &Job) -> Option<f64> {
        let probe = self.probe(job).ok()?;
        let steps = self.steps(job.axis, &probe);
        let seeds = probe.noisy().then_some(self.request.seeds);
        let (bisect, most) = (self.request.steps.is_empty(), self.request.time_limit_s);
        Some(search::seconds(&steps, bisect, seeds, probe.seconds()?, most))
    }

    /// Whether the ends of the map of a column are known, which are run at any limit of stability.
    fn is_known(&self, job: &Job) -> bool {
        let Ok(scene) = (self.parts.scene_at)(&job.scene, &job.overrides) else { return false };
        let steps = match (&self.request.steps[..], job.axis) {
            ([], Axis::Stages) => super_steps::grid(),
            ([], _) => grid(RANGE.0, RANGE.1, self.request.grid),
            (asked, _) => asked.to_vec(),
        };
        let is_known =
            |ratio: &f64| self.campaign.known::<Finding>(&cell::key(&scene, job.method, *ratio, cell::SEED)).is_some();
        steps.iter().all(is_known)
    }

    /// One column, and whether any of its runs was made; no answer if the study stops.
    fn column(&self, job: &Job) -> Option<(Result<Column, Failure>, bool)> {
        let mut was_made = false;
        let found = match self.probe(job) {
            Ok(probe) => {
                let steps = self.steps(job.axis, &probe);
                let seeds = probe.noisy().then_some(self.request.seeds);
                let mut run = |ratio: f64, seed: u64| self.run(&probe, ratio, seed, &mut was_made);
                let ladder = climb(&steps, self.request.steps.is_empty(), seeds, &mut run)?;
                Ok(Column { probe, ladder })
            }
            Err(failure) => Err(failure),
        };
        Some((found, was_made))
    }

    /// The scene of a column. Bounds are found once for all columns whose particles are the same.
    fn probe(&self, job: &Job) -> Result<Probe, Failure> {
        let scene = (self.parts.scene_at)(&job.scene, &job.overrides)?;
        let of_time = |key: &str| key.ends_with(".integrator") || key.ends_with(".stages");
        let particles = job.overrides.iter().filter(|(key, _)| !of_time(key)).cloned().collect();
        let key = (job.scene.clone(), job.method, particles);
        let known = self.bounds.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        let probe = Probe::new(self.parts, scene, job.method, known)?;
        self.bounds.lock().unwrap_or_else(PoisonError::into_inner).insert(key, probe.bounds.clone());
        Ok(probe)
    }

    /// The steps of a map: coarse over the whole range, fine where theory leaves it open whether a step is exact.
    fn steps(&self, axis: Axis, probe: &Probe) -> Vec<f64> {
        if !self.request.steps.is_empty() {
            let mut steps = self.request.steps.clone();
            steps.sort_by(f64::total_cmp);
            steps.dedup();
            return steps;
        }
        let coarse = match axis {
            Axis::Stages => super_steps::grid(),
            _ => grid(RANGE.0, RANGE.1, self.request.grid),
        };
        if probe.noisy() {
            // Noise blurs what fine steps would show, and its cells are dear.
            return coarse;
        }
        refined(coarse, probe.sharp_over_bound().clamp(1.0, RANGE.1 / FINE))
    }

    /// One run, or what is known of it.
    fn run(&self, probe: &Probe, ratio: f64, seed: u64, was_made: &mut bool) -> Option<Finding> {
        if self.campaign.is_stopped() {
            return None;
        }
        let key = probe.key(ratio, seed);
        if let Some(finding) = self.campaign.known(&key) {
            return Some(finding);
        }
        *was_made = true;
        let run = probe.run(ratio, seed, self.request.time_limit_s, self.campaign.stop());
        let finding = self.campaign.or_stop(run.map_err(Failure::from))?;
        match finding.outcome {
            Outcome::Interrupted => return None,
            // Another time it may not run out of time.
            Outcome::TimedOut => {}
            _ => self.campaign.keep(&key, &finding),
        }
        Some(finding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_fine_between_bound_and_limit_alone() {
        let steps = refined(grid(0.25, 4.0, 13), 1.675);
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]));
        for pair in steps.windows(2) {
            let inside = pair[0] >= 0.999 && pair[1] <= 1.05 * 1.675;
            // A coarse step may take the place of a fine one that is near it.
            assert!(pair[1] / pair[0] < if inside { FINE.powf(1.31) } else { 1.27 }, "{pair:?}");
        }
        assert_eq!(refined(vec![0.5, 1.0, 2.0], 1.0), [0.5, 1.0, FINE, 2.0]);
    }
}
