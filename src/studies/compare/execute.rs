//! The runs of one scene: a first one each, cheap ones first, ensembles, then repeated runs in shuffled rounds.

use std::sync::Arc;

use frazil_core::statistics;
use frazil_plots::style::{duration, percent};
use frazil_record::{Outcome, ReferenceInfo};
use frazil_scene::Scene;
use frazil_simulation::march::Options;
use frazil_simulation::reference::Reference;
use rand::SeedableRng;
use rand::seq::SliceRandom;

use super::group::alike;
use super::measured::{Measured, Status, Timing};
use super::plan::{Configuration, configurations};
use super::reference::{judge_alike, truth};
use super::request::CompareRequest;
use super::runner::{Clock, Count, Made, Purpose, Runner};
use super::turns::{self, FIRST_RUNS, Line, Turn};
use crate::ensemble::runs::{EnsembleRuns, Headline};
use crate::failure::Failure;
use crate::parallel;
use crate::parts::Parts;

/// Fewest seeds for which an ensemble says anything.
pub const FEWEST_SEEDS: usize = 5;
/// Seeds of a published point.
pub const SEEDS: usize = 10;
/// Most repeated runs of a configuration whose times scatter.
const MOST_REPEATS: usize = 15;
/// Scatter (interquartile range over median) above which runs are repeated further.
const SCATTER: f64 = 0.05;
/// Why a scene, or the whole comparison, ends early.
pub enum Stop {
    /// This scene cannot be compared.
    Scene(Failure),
    /// Results cannot be written.
    Files(Failure),
}

/// All runs of one scene.
#[derive(Clone)]
pub struct SceneRuns {
    /// The scene as its file gives it.
    pub scene: Scene,
    /// What came of each configuration, from coarse to fine.
    pub measured: Vec<Measured>,
    /// The reference, if there is one.
    pub reference: Option<ReferenceInfo>,
    /// What the reference is, in words.
    pub reference_words: String,
    /// Order of the repeated runs, as a list of rounds.
    pub rounds: usize,
    /// Wall time spent (s), with that of runs that were known before.
    pub spent: f64,
    /// How many runs there are.
    pub count: Count,
}

impl SceneRuns {
    /// What is known while runs are still to be made, timed by first runs where there are no others.
    pub fn so_far(&self) -> SceneRuns {
        let mut known = self.clone();
        known.measured.retain(|one| one.result.is_some() || one.unmade.is_some());
        known.measured.iter_mut().for_each(Measured::time_by_first_run);
        known
    }

    /// The reference's own error for a measure.
    pub fn reference_error(&self, headline: Headline) -> Option<f64> {
        self.reference.as_ref().map(|info| info.error_of(headline.name()))
    }
}

/// Compares one scene. `say` tells the user where it stands; `written` stores what is there so far.
pub fn scene(
    request: &CompareRequest,
    parts: &Parts<'_>,
    runner: &Runner<'_>,
    name: &str,
    say: &dyn Fn(&str),
    written: &dyn Fn(&SceneRuns) -> Result<(), Failure>,
) -> Result<SceneRuns, Stop> {
    let before = runner.counts();
    let mut base = request.scene(parts, name, &[]).map_err(Stop::Scene)?;
    let mut plan = configurations(request, parts, name, &base).map_err(Stop::Scene)?;
    say(&format!(
        "{}: {} configurations, at most about {} for them",
        base.name,
        plan.len(),
        duration(request.budget())
    ));
    let spacings = || plan.iter().map(|one| one.spacing);
    let (finest, coarsest) = (spacings().fold(f64::INFINITY, f64::min), spacings().fold(0.0, f64::max));
    let reference = truth(request, parts, runner, (name, &mut base), (finest, coarsest), say).map_err(Stop::Scene)?;
    if let Some(reference) = &reference {
        judge_alike(&mut base, coarsest, reference.as_ref());
    }
    for scene in plan.iter_mut().filter_map(|one| one.scene.as_mut().ok()) {
        scene.watch.front_from = base.watch.front_from;
        scene.remarks.clone_from(&base.remarks);
    }
    for remark in &base.remarks {
        say(&format!("{}: warning: {remark}", base.name));
    }
    let info = reference.as_ref().map(|reference| reference.describe());
    let mut runs = SceneRuns {
        measured: plan.iter().map(Measured::planned).collect(),
        scene: base,
        reference_words: words(info.as_ref()),
        reference: info,
        rounds: 0,
        spent: 0.0,
        count: Count::default(),
    };
    let work = Work { request, runner, plan: &plan, reference: reference.as_ref(), clock: Clock::start(), say };
    work.first_runs(&mut runs, written)?;
    work.repeated_runs(&mut runs, written)?;
    runs.spent = work.clock.elapsed();
    runs.count = runner.counts() - before;
    if runs.count.known > 0 {
        say(&format!("{}: {}", runs.scene.name, runs.count.words()));
    }
    written(&runs).map_err(Stop::Files)?;
    Ok(runs)
}

/// What a reference is, in words.
fn words(info: Option<&ReferenceInfo>) -> String {
    let Some(info) = info else { return "none: no errors".into() };
    let of = |(measure, error): (&String, &f64)| format!("{} ({measure})", percent(*error, 2));
    let errors: Vec<String> = info.errors.iter().map(of).collect();
    let errors = if errors.is_empty() { percent(info.error_estimate_rel, 2) } else { errors.join(", ") };
    format!("{}, {}; its own error is about {errors}", info.kind, info.source)
}

struct Work<'a> {
    request: &'a CompareRequest,
    runner: &'a Runner<'a>,
    plan: &'a [Configuration],
    reference: Option<&'a Arc<dyn Reference>>,
    clock: Clock,
    say: &'a dyn Fn(&str),
}

impl Work<'_> {
    fn left(&self) -> f64 {
        self.request.budget() - self.clock.elapsed()
    }

    fn stopped(&self) -> bool {
        self.runner.is_stopped()
    }

    fn options(&self, seed: u64, threads: usize, fields: bool, limit: f64) -> Options<'static> {
        let time_limit_s = Some(limit.max(1.0));
        Options { threads, seed, time_limit_s, fields, ..Options::default() }
    }

    /// One run of each configuration, cheap ones first: it warms up, gives the error and tells the time.
    fn first_runs(
        &self,
        runs: &mut SceneRuns,
        written: &dyn Fn(&SceneRuns) -> Result<(), Failure>,
    ) -> Result<(), Stop> {
        let curves = self.curves();
        let growth = 2f64.powi(runs.scene.domain.dimension() as i32 + 2);
        let waits = |k: &usize| if self.plan[*k].scene.is_ok() { Turn::Waiting } else { Turn::Refused };
        let mut lines: Vec<Line> =
            curves.iter().map(|curve| Line { turns: curve.iter().map(waits).collect(), growth }).collect();
        let mut made = 0;
        while let Some((line, level, expected)) = turns::next(&lines) {
            let left = FIRST_RUNS * self.request.budget() - self.clock.elapsed();
            let k = curves[line][level];
            let why = if self.stopped() {
                Some((Status::Interrupted, "the comparison was stopped before it".to_owned()))
            } else if expected > left {
                Some((Status::LeftOut, self.too_long(expected, left)))
            } else {
                None
            };
            if let Some(why) = why {
                // Finer runs take longer still.
                for finer in lines[line].leave_out(level) {
                    runs.measured[curves[line][finer]].unmade = Some(why.clone());
                }
                continue;
            }
            let share = turns::allowed(&lines, expected, left);
            lines[line].turns[level] = self.first_run(k, share, &mut runs.measured[k]);
            if runs.measured[k].status() == Status::CutOff {
                let reason = format!("a coarser run was cut off after {}", duration(share));
                for finer in lines[line].leave_out(level) {
                    runs.measured[curves[line][finer]].unmade = Some((Status::LeftOut, reason.clone()));
                }
            }
            made += 1;
            self.tell(made, &runs.measured[k]);
            written(runs).map_err(Stop::Files)?;
        }
        self.tell_left_out(runs);
        Ok(())
    }

    /// Places in the plan of each method and setting, from coarse to fine.
    fn curves(&self) -> Vec<Vec<usize>> {
        let of = |k: usize| (self.plan[k].method, &self.plan[k].setting);
        alike(0..self.plan.len(), |a, b| of(*a) == of(*b))
    }

    /// The first run of a configuration, with its other seeds.
    fn first_run(&self, k: usize, share: f64, measured: &mut Measured) -> Turn {
        let one = &self.plan[k];
        let Ok(scene) = &one.scene else { return Turn::Refused };
        let began = self.clock.elapsed();
        let options = self.options(1, self.request.threads, true, share);
        match self.runner.run(Purpose::First, scene, one.method, self.reference, &options) {
            Ok(made) => {
                self.clock.add(made.earlier_s);
                let alone = Timing::of(&made.result.record).wall();
                measured.result = Some(made.result);
                if one.stochastic && measured.is_ok() {
                    self.ensemble(one, scene, measured, share - (self.clock.elapsed() - began));
                }
                Turn::Made(alone)
            }
            Err(refused) => {
                measured.unmade = Some((Status::Refused, refused.to_string()));
                Turn::Refused
            }
        }
    }

    fn too_long(&self, expected: f64, left: f64) -> String {
        format!(
            "about {} expected, {} left of {} for first runs",
            duration(expected),
            if left > 0.0 { duration(left) } else { "nothing".into() },
            duration(FIRST_RUNS * self.request.budget())
        )
    }

    /// Says what the time did not suffice for.
    fn tell_left_out(&self, runs: &SceneRuns) {
        let lacking: Vec<String> = (runs.measured.iter().filter(|one| one.status().is_lack_of_time()))
            .map(|one| format!("{} at {}", one.label(), one.spacing_words()))
            .collect();
        if !lacking.is_empty() && !self.stopped() {
            (self.say)(&format!(
                "{}: left out for lack of time: {} (--budget-s gives more)",
                runs.scene.name,
                lacking.join(", ")
            ));
        }
    }

    fn tell(&self, made: usize, measured: &Measured) {
        let head = format!("[{made}/{}] {}, {}", self.plan.len(), measured.label(), measured.spacing_words());
        let error = measured
            .errors()
            .and_then(|errors| Headline::ALL.iter().find_map(|headline| Some((headline, headline.of(errors)?))))
            .map_or(String::new(), |(headline, error)| format!("{} {}, ", headline.label(), percent(error.abs(), 2)));
        let rest = match (&measured.result, measured.trouble()) {
            (Some(result), None) => format!("{error}{}", duration(Timing::of(&result.record).wall())),
            (_, trouble) => trouble.unwrap_or_default(),
        };
        (self.say)(&format!("{head}: {rest}; at most {} left", duration(self.left().max(0.0))));
    }

    /// Runs with further seeds on all cores. Their times are not used: they share the machine.
    fn ensemble(&self, one: &Configuration, scene: &Scene, measured: &mut Measured, share: f64) {
        let Some(first) = measured.result.clone() else {
            return;
        };
        let workers = parallel::cores();
        let single = Timing::of(&first.record).wall().max(1e-4);
        let allowed = 1 + (share.max(0.0) / single * workers as f64) as usize;
        let wanted = self.request.seeds.unwrap_or(SEEDS.min(allowed));
        if wanted < FEWEST_SEEDS.min(self.request.seeds.unwrap_or(FEWEST_SEEDS)) {
            measured.note = Some(format!("one run only: the time does not allow {FEWEST_SEEDS} seeds"));
            return;
        }
        let (runner, reference) = (self.runner, self.reference);
        // The first run had seed 1. As many at once as there are cores, so that a machine that is busy with other work takes
        // fewer seeds and not more time.
        let mut all = vec![first];
        let began = self.clock.elapsed();
        let others: Vec<u64> = (2..=wanted as u64).collect();
        for (turn, seeds) in others.chunks(workers).enumerate() {
            let used = self.clock.elapsed() - began;
            let next = used / turn.max(1) as f64;
            if self.request.seeds.is_none() && turn > 0 && all.len() >= FEWEST_SEEDS && used + next > share {
                break;
            }
            let limits: Vec<_> = seeds.iter().map(|seed| self.options(*seed, 1, false, self.left())).collect();
            let run = |k: usize| runner.run(Purpose::Seed, scene, one.method, reference, &limits[k]).ok();
            let found: Vec<Made> = parallel::runs(limits.len(), workers, run).into_iter().flatten().collect();
            self.clock.add(found.iter().map(|made| made.earlier_s).fold(0.0, f64::max));
            all.extend(found.into_iter().map(|made| made.result));
        }
        let made = all.len();
        all.retain(|run| run.record.outcome == Outcome::Ok);
        if all.len() < made {
            measured.note = Some(format!("{} of {made} seeds ended well", all.len()));
        } else if made < wanted {
            measured.note = Some(format!("{made} of {wanted} seeds: the time did not suffice for more"));
        }
        if all.len() < made.min(wanted) && all.len() < 2 {
            return;
        }
        measured.ensemble = EnsembleRuns::of(scene, one.spacing, &all, reference.map(|reference| reference.as_ref()));
    }

    /// Timed runs. All configurations take turns in shuffled rounds, so that a slow minute of the machine hits all.
    fn repeated_runs(
        &self,
        runs: &mut SceneRuns,
        written: &dyn Fn(&SceneRuns) -> Result<(), Failure>,
    ) -> Result<(), Stop> {
        let timed: Vec<usize> = (0..self.plan.len()).filter(|k| runs.measured[*k].is_ok()).collect();
        let first = |k: usize, runs: &SceneRuns| {
            runs.measured[k].result.as_ref().map_or(0.0, |result| Timing::of(&result.record).wall())
        };
        let mut wanted: Vec<(usize, usize, f64)> = timed
            .iter()
            .map(|k| {
                let time = first(*k, runs);
                (*k, self.request.repeats.unwrap_or(usual_repeats(time)), time)
            })
            .collect();
        if self.request.repeats.is_none() {
            fit(&mut wanted, 0.9 * self.left());
        }
        let total: f64 = wanted.iter().map(|(_, count, time)| *count as f64 * time).sum();
        (self.say)(&format!("{}: repeated runs in shuffled rounds, about {}", runs.scene.name, duration(total)));
        // The order must not depend on the day, so that a second comparison is made in the same way.
        let mut random = rand::rngs::StdRng::seed_from_u64(20);
        let mut round = 0;
        loop {
            let mut turn: Vec<usize> = wanted.iter().filter(|(_, count, _)| *count > round).map(|(k, ..)| *k).collect();
            if self.request.repeats.is_none() && round < MOST_REPEATS {
                let scattered = |(k, count, time): &&(usize, usize, f64)| {
                    *count > 2
                        && *count <= round
                        && scatter(&runs.measured[*k].timings) > SCATTER
                        && *time < 0.5 * self.left()
                };
                turn.extend(wanted.iter().filter(scattered).map(|(k, ..)| *k));
            }
            if turn.is_empty() || self.stopped() {
                break;
            }
            turn.shuffle(&mut random);
            for k in turn {
                self.repeat(k, round, &mut runs.measured[k]);
            }
            round += 1;
            runs.rounds = round;
            written(runs).map_err(Stop::Files)?;
        }
        for k in timed {
            runs.measured[k].time_by_first_run();
        }
        Ok(())
    }

    fn repeat(&self, k: usize, round: usize, measured: &mut Measured) {
        let one = &self.plan[k];
        let Ok(scene) = &one.scene else {
            return;
        };
        let options = Options { time_limit_s: None, ..self.options(1, self.request.threads, false, 0.0) };
        // The reference goes along because walls may take their temperature from it; errors are not timed.
        if let Ok(Made { result, earlier_s }) =
            self.runner.run(Purpose::Repeat(round), scene, one.method, self.reference, &options)
            && result.record.outcome != Outcome::Interrupted
        {
            self.clock.add(earlier_s);
            let first = measured.result.as_ref().map(|first| &first.record.state_hash);
            measured.repeatable &= first == Some(&result.record.state_hash);
            measured.timings.push(Timing::of(&result.record));
        }
    }
}

/// Repetitions of a run by its length.
fn usual_repeats(time: f64) -> usize {
    match time {
        t if t < 10.0 => 7,
        t if t < 60.0 => 5,
        t if t < 600.0 => 3,
        _ => 1,
    }
}

/// Takes repetitions from the costliest configurations until all fit; the first run has to do for what gets none.
fn fit(wanted: &mut [(usize, usize, f64)], seconds: f64) {
    while wanted.iter().map(|(_, count, time)| *count as f64 * time).sum::<f64>() > seconds {
        let share = |entry: &(usize, usize, f64)| entry.1 as f64 * entry.2;
        match wanted.iter_mut().filter(|entry| entry.1 > 0).max_by(|a, b| share(a).total_cmp(&share(b))) {
            Some(entry) => entry.1 -= 1,
            None => return,
        }
    }
}

fn scatter(timings: &[Timing]) -> f64 {
    let walls: Vec<f64> = timings.iter().map(Timing::wall).collect();
    statistics::quartiles(&walls).map_or(0.0, |[low, middle, high]| (high - low) / middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costly_runs_give_up_their_repetitions_first() {
        let mut wanted = vec![(0, 7, 0.1), (1, 7, 4.0), (2, 7, 1.0)];
        fit(&mut wanted, 12.0);
        assert!(wanted.iter().map(|(_, n, t)| *n as f64 * t).sum::<f64>() <= 12.0);
        assert_eq!(wanted[0].1, 7);
        assert!(wanted[1].1 <= wanted[2].1);
        fit(&mut wanted, 0.0);
        assert!(wanted.iter().all(|entry| entry.1 == 0));
    }
}
