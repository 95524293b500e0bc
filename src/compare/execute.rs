//! The runs of one scene: a first one each, ensembles, then repeated runs in shuffled rounds.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use frazil_core::march::Options;
use frazil_core::record::Outcome;
use frazil_core::reference::Reference;
use frazil_core::scene::Scene;
use frazil_core::statistics;
use frazil_plots::style::{duration, percent};
use rand::SeedableRng;
use rand::seq::SliceRandom;

use super::measured::{Measured, Timing};
use super::plan::{Configuration, configurations};
use super::reference::local_reference;
use super::{CompareRequest, Parts};
use crate::ensemble::runs::{EnsembleRuns, Headline};
use crate::failure::Failure;
use crate::parallel;

/// Fewest seeds for which an ensemble says anything.
pub const FEWEST_SEEDS: usize = 5;
/// Seeds of a published point.
pub const SEEDS: usize = 10;
/// Most repeated runs of a configuration whose times scatter.
const MOST_REPEATS: usize = 15;
/// Scatter (interquartile range over median) above which runs are repeated further.
const SCATTER: f64 = 0.05;
/// Runs shorter than this are too short to tell how cost grows with resolution (s).
const SHORT: f64 = 0.02;

/// Why a scene, or the whole comparison, ends early.
pub enum Stop {
    /// This scene cannot be compared.
    Scene(String),
    /// Results cannot be written.
    Files(Failure),
}

/// All runs of one scene.
pub struct SceneRuns {
    /// The scene as its file gives it.
    pub scene: Scene,
    /// What came of each configuration, from coarse to fine.
    pub measured: Vec<Measured>,
    /// The reference's own relative error, if there is a reference.
    pub reference_error: Option<f64>,
    /// What the reference is, in words.
    pub reference_words: String,
    /// Order of the repeated runs, as a list of rounds.
    pub rounds: usize,
    /// Wall time spent (s).
    pub spent: f64,
}

/// Compares one scene. `say` tells the user where it stands; `written` stores what is there so far.
pub fn scene(
    request: &CompareRequest,
    parts: &Parts<'_>,
    name: &str,
    say: &dyn Fn(&str),
    written: &dyn Fn(&SceneRuns) -> Result<(), Failure>,
) -> Result<SceneRuns, Stop> {
    let base = (parts.scene_at)(name, &[]).map_err(Stop::Scene)?;
    let plan = configurations(request, parts, name, &base).map_err(Stop::Scene)?;
    say(&format!(
        "{}: {} configurations, at most about {} for them",
        base.name,
        plan.len(),
        duration(request.budget())
    ));
    let finest = plan.iter().map(|one| one.spacing).fold(f64::INFINITY, f64::min);
    let reference = truth(request, parts, name, &base, finest, say)?;
    let info = reference.as_ref().map(|reference| reference.describe());
    let reference_words = info.as_ref().map_or("none: errors are not known".into(), |info| {
        format!("{}, {}; its own error is about {}", info.kind, info.source, percent(info.error_estimate_rel, 2))
    });
    let mut runs = SceneRuns {
        measured: plan.iter().map(Measured::planned).collect(),
        scene: base,
        reference_error: info.map(|info| info.error_estimate_rel),
        reference_words,
        rounds: 0,
        spent: 0.0,
    };
    let work = Work { request, parts, plan: &plan, reference: reference.as_ref(), started: Instant::now(), say };
    work.first_runs(&mut runs, written)?;
    work.repeated_runs(&mut runs);
    runs.spent = work.started.elapsed().as_secs_f64();
    written(&runs).map_err(Stop::Files)?;
    Ok(runs)
}

/// The reference of a scene: a closed form or a table or, where there is none, fine local runs.
pub fn truth(
    request: &CompareRequest,
    parts: &Parts<'_>,
    name: &str,
    base: &Scene,
    finest: f64,
    say: &dyn Fn(&str),
) -> Result<Option<Arc<dyn Reference>>, Stop> {
    if let Some(closed) = (parts.reference_for)(base).map_err(Stop::Scene)? {
        return Ok(Some(Arc::from(closed)));
    }
    Ok(match local_reference(parts, name, base, finest, request.budget(), say) {
        Ok(reference) => Some(Arc::new(reference)),
        Err(reason) => {
            say(&format!("{}: no reference: {reason}", base.name));
            None
        }
    })
}

struct Work<'a> {
    request: &'a CompareRequest,
    parts: &'a Parts<'a>,
    plan: &'a [Configuration],
    reference: Option<&'a Arc<dyn Reference>>,
    started: Instant,
    say: &'a dyn Fn(&str),
}

impl Work<'_> {
    fn left(&self) -> f64 {
        self.request.budget() - self.started.elapsed().as_secs_f64()
    }

    fn stopped(&self) -> bool {
        self.parts.interrupt.load(Ordering::Relaxed)
    }

    fn options(&self, seed: u64, threads: usize, fields: bool) -> Options<'_> {
        let time_limit_s = Some(self.left().max(1.0));
        Options { threads, seed, interrupt: Some(self.parts.interrupt), time_limit_s, fields, ..Options::default() }
    }

    /// One run of each configuration, from coarse to fine: it warms up, gives the error and tells the time.
    fn first_runs(
        &self,
        runs: &mut SceneRuns,
        written: &dyn Fn(&SceneRuns) -> Result<(), Failure>,
    ) -> Result<(), Stop> {
        for (k, one) in self.plan.iter().enumerate() {
            let Ok(scene) = &one.scene else {
                continue;
            };
            if self.stopped() {
                runs.measured[k].note = Some("interrupted".into());
                continue;
            }
            let expected = self.expected(&runs.measured, k, scene);
            if expected > 0.5 * self.request.budget() || expected > self.left() {
                let budget = duration(self.request.budget());
                runs.measured[k].note =
                    Some(format!("skipped: about {} expected, of {budget} for the whole scene", duration(expected)));
                continue;
            }
            let options = self.options(1, self.request.threads, true);
            match (self.parts.run)(scene, one.method, self.reference, &options) {
                Ok(result) => runs.measured[k].result = Some(result),
                Err(refused) => runs.measured[k].note = Some(format!("refused: {refused}")),
            }
            if one.stochastic && runs.measured[k].is_ok() {
                self.ensemble(one, scene, &mut runs.measured[k]);
            }
            self.tell(k, &runs.measured[k]);
            written(runs).map_err(Stop::Files)?;
        }
        Ok(())
    }

    fn tell(&self, k: usize, measured: &Measured) {
        let head = format!("[{}/{}] {}, {}", k + 1, self.plan.len(), measured.label(), measured.spacing_words());
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

    /// Time of a run from those of the coarser ones: it grows by the ratio seen, or by what an explicit step makes
    /// of half the spacing.
    fn expected(&self, measured: &[Measured], k: usize, scene: &Scene) -> f64 {
        let one = &self.plan[k];
        let time = |level: usize| {
            let same =
                |other: &&Measured| other.method == one.method && other.setting == one.setting && other.level == level;
            let result = measured.iter().find(same)?.result.as_ref()?;
            Some(Timing::of(&result.record).wall())
        };
        let explicit = 2f64.powi(scene.domain.dimension() as i32 + 2);
        let Some(last) = one.level.checked_sub(1).and_then(time) else {
            // A coarser run that was skipped or refused says that this one would take longer still.
            let tried = measured.iter().any(|other| {
                other.method == one.method
                    && other.setting == one.setting
                    && other.level + 1 == one.level
                    && other.result.is_none()
                    && other.note.as_deref().is_some_and(|note| note.starts_with("skipped"))
            });
            return if tried { f64::INFINITY } else { 0.0 };
        };
        let before = one.level.checked_sub(2).and_then(time).filter(|before| *before > SHORT);
        last * before.map_or(explicit, |before| (last / before).clamp(2.0, 2.0 * explicit))
    }

    /// Runs with further seeds on all cores. Their times are not used: they share the machine.
    fn ensemble(&self, one: &Configuration, scene: &Scene, measured: &mut Measured) {
        let Some(first) = measured.result.clone() else {
            return;
        };
        let workers = parallel::cores();
        let single = Timing::of(&first.record).wall().max(1e-4);
        let allowed = (0.4 * self.left() / single * workers as f64) as usize;
        let wanted = self.request.seeds.unwrap_or(SEEDS.min(allowed));
        if wanted < FEWEST_SEEDS.min(self.request.seeds.unwrap_or(FEWEST_SEEDS)) {
            measured.note = Some(format!("one run only: the time does not allow {FEWEST_SEEDS} seeds"));
            return;
        }
        let (run, reference) = (self.parts.run, self.reference);
        // The first run had seed 1.
        let limits: Vec<_> = (2..=wanted).map(|seed| self.options(seed as u64, 1, false)).collect();
        let others = parallel::in_order(limits.len(), workers, |k| run(scene, one.method, reference, &limits[k]).ok());
        let mut all = vec![first];
        all.extend(others.into_iter().flatten());
        let made = all.len();
        all.retain(|run| run.record.outcome == Outcome::Ok);
        if all.len() < wanted {
            measured.note = Some(format!("{} of {wanted} seeds ended well", all.len()));
        }
        if all.len() < made.min(wanted) && all.len() < 2 {
            return;
        }
        measured.ensemble = EnsembleRuns::of(scene, one.spacing, &all, reference.map(|reference| reference.as_ref()));
    }

    /// Timed runs. All configurations take turns in shuffled rounds, so that a slow minute of the machine hits all.
    fn repeated_runs(&self, runs: &mut SceneRuns) {
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
                self.repeat(k, &mut runs.measured[k]);
            }
            round += 1;
        }
        runs.rounds = round;
        for k in timed {
            let measured = &mut runs.measured[k];
            if measured.timings.is_empty() {
                measured.cold = true;
                measured.timings.extend(measured.result.as_ref().map(|result| Timing::of(&result.record)));
            }
        }
    }

    fn repeat(&self, k: usize, measured: &mut Measured) {
        let one = &self.plan[k];
        let Ok(scene) = &one.scene else {
            return;
        };
        let options = Options { time_limit_s: None, ..self.options(1, self.request.threads, false) };
        // The reference goes along because walls may take their temperature from it; errors are not timed.
        if let Ok(result) = (self.parts.run)(scene, one.method, self.reference, &options)
            && result.record.outcome != Outcome::Interrupted
        {
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
