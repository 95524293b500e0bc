//! The runs of a study: columns side by side, each along its own steps.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use frazil_record::Outcome;
use frazil_simulation::plan::Bounds;

use super::axis::Axis;
use super::cell::{self, Finding, Probe};
use super::plan::Job;
use super::request::StabilityRequest;
use super::search::{self, Ladder, climb, grid};
use super::super_steps;
use crate::campaign::Campaign;
use crate::failure::Failure;
use crate::parallel;
use crate::parts::Override;
use crate::parts::Parts;
use crate::progress::{self, Reporter};

/// Ends of a map, in theoretical bounds.
pub const RANGE: (f64, f64) = (0.25, 4.0);

/// A column that was worked on.
pub struct Mapped {
    /// What was asked.
    pub job: Job,
    /// What was found, or why there is nothing.
    pub found: Result<Column, String>,
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
    let study = Study {
        request,
        parts,
        campaign,
        bounds: Mutex::new(HashMap::new()),
        reporter: Reporter::new(request.quiet),
        tally: Mutex::new(Tally::of(&jobs)),
    };
    if !request.quiet {
        progress::forewarn("stability", study.seconds(&jobs));
    }
    let found = campaign.side_by_side(&early_ones_first(&jobs), |k| study.column(&jobs[k]));
    study.reporter.finish();
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

/// Prices by which the middle column of every kind comes first, so that the time of all can be told early.
fn early_ones_first(jobs: &[Job]) -> Vec<f64> {
    let mut prices = vec![0.0; jobs.len()];
    by_kind(jobs).values().for_each(|same| prices[same[same.len() / 2]] = 1.0);
    prices
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
    reporter: Reporter,
    tally: Mutex<Tally>,
}

impl Study<'_> {
    /// About how long (s) the columns will take that are not known, from the first steps of the middle one of each
    /// kind; kinds whose steps do not tell are not in it.
    fn seconds(&self, jobs: &[Job]) -> Option<f64> {
        let kinds: Vec<Vec<usize>> = by_kind(jobs).into_values().collect();
        let of_kind = |k: usize| {
            let open = kinds[k].iter().filter(|job| !self.is_known(&jobs[**job])).count();
            let middle = &jobs[kinds[k][kinds[k].len() / 2]];
            let probe = if open > 0 { self.probe(middle).ok()? } else { return Some(0.0) };
            let steps = self.steps(middle.axis, &probe);
            let seeds = probe.noisy().then_some(self.request.seeds);
            let (bisect, most) = (self.request.steps.is_empty(), self.request.time_limit_s);
            Some(open as f64 * search::seconds(&steps, bisect, seeds, probe.seconds()?, most))
        };
        let all: f64 = parallel::in_order(kinds.len(), self.request.threads, of_kind).into_iter().flatten().sum();
        Some(all / self.request.threads.clamp(1, jobs.len().max(1)) as f64)
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

    /// One column; no answer if the study stops.
    fn column(&self, job: &Job) -> Option<Result<Column, String>> {
        let began = Instant::now();
        let mut fresh = false;
        let found = match self.probe(job) {
            Ok(probe) => {
                let steps = self.steps(job.axis, &probe);
                let seeds = probe.noisy().then_some(self.request.seeds);
                let mut run = |ratio: f64, seed: u64| self.run(&probe, ratio, seed, &mut fresh);
                let ladder = climb(&steps, self.request.steps.is_empty(), seeds, &mut run)?;
                Ok(Column { probe, ladder })
            }
            Err(reason) => Err(reason),
        };
        self.tell(job, fresh.then(|| began.elapsed().as_secs_f64()));
        Some(found)
    }

    /// The scene of a column. Bounds are found once for all columns whose particles are the same.
    fn probe(&self, job: &Job) -> Result<Probe, String> {
        let scene = (self.parts.scene_at)(&job.scene, &job.overrides).map_err(|failure| failure.to_string())?;
        let of_time = |key: &str| key.ends_with(".integrator") || key.ends_with(".stages");
        let particles = job.overrides.iter().filter(|(key, _)| !of_time(key)).cloned().collect();
        let key = (job.scene.clone(), job.method, particles);
        let known = self.bounds.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        let probe = Probe::new(self.parts, scene, job.method, known).map_err(|refused| refused.reason)?;
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
    fn run(&self, probe: &Probe, ratio: f64, seed: u64, fresh: &mut bool) -> Option<Finding> {
        if self.campaign.is_stopped() {
            return None;
        }
        let key = probe.key(ratio, seed);
        if let Some(finding) = self.campaign.known(&key) {
            return Some(finding);
        }
        *fresh = true;
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

    fn tell(&self, job: &Job, seconds: Option<f64>) {
        let mut tally = self.tally.lock().unwrap_or_else(PoisonError::into_inner);
        tally.add(job, seconds);
        let (done, all) = tally.counts();
        let left = tally.seconds_left(self.request.threads).filter(|_| done < all);
        self.reporter.at(done as f64 / all as f64, || {
            let left = left.map_or_else(String::new, progress::left);
            format!("{done} of {all} columns{left}")
        });
    }
}

/// How many columns of each kind are done, and in what time.
struct Tally {
    kinds: BTreeMap<(String, &'static str, Axis), Progress>,
}

#[derive(Default)]
struct Progress {
    all: usize,
    done: usize,
    timed: usize,
    seconds: f64,
}

impl Tally {
    fn of(jobs: &[Job]) -> Tally {
        let mut kinds = BTreeMap::new();
        for job in jobs {
            kinds.entry(kind(job)).or_insert_with(Progress::default).all += 1;
        }
        Tally { kinds }
    }

    /// Takes down a column, with its time if any of its runs was made.
    fn add(&mut self, job: &Job, seconds: Option<f64>) {
        let progress = self.kinds.entry(kind(job)).or_default();
        progress.done += 1;
        if let Some(seconds) = seconds {
            progress.timed += 1;
            progress.seconds += seconds;
        }
    }

    fn counts(&self) -> (usize, usize) {
        self.kinds.values().fold((0, 0), |sum, kind| (sum.0 + kind.done, sum.1 + kind.all))
    }

    /// Time left from the mean of each kind; untold as long as a kind has not been seen.
    fn seconds_left(&self, workers: usize) -> Option<f64> {
        let mut sum = 0.0;
        for kind in self.kinds.values().filter(|kind| kind.done < kind.all) {
            if kind.timed == 0 {
                return None;
            }
            sum += kind.seconds / kind.timed as f64 * (kind.all - kind.done) as f64;
        }
        Some(sum / workers.max(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(method: &'static str, axis: Axis) -> Job {
        Job { scene: "s".into(), method, axis, value: None, overrides: Vec::new() }
    }

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

    #[test]
    fn the_time_left_is_told_once_every_kind_has_been_seen() {
        let jobs = [("pd", Axis::Stefan), ("pd", Axis::Capacity), ("edpd", Axis::Noise), ("edpd", Axis::Noise)]
            .map(|(method, axis)| job(method, axis));
        assert_eq!(early_ones_first(&jobs), [0.0, 1.0, 0.0, 1.0]);
        let mut tally = Tally::of(&jobs);
        tally.add(&jobs[1], Some(2.0));
        assert_eq!(tally.seconds_left(2), None);
        // A column that was known says nothing about time.
        tally.add(&jobs[3], None);
        assert_eq!(tally.seconds_left(2), None);
        tally.add(&jobs[2], Some(10.0));
        assert_eq!(tally.seconds_left(2), Some(1.0));
        assert_eq!(tally.counts(), (3, 4));
    }
}
