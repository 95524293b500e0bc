//! Runs of one method, from coarse to fine, as few as tell at which spacing it reaches an error, and at what cost.

use std::iter;
use std::sync::Arc;

use frazil_core::statistics::median;
use frazil_plots::style::percent;
use frazil_record::{Outcome, RunResult};
use frazil_scene::method::MethodKind;
use frazil_scene::{Scene, spacing_at_most};
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::reference::Reference;
use serde::{Deserialize, Serialize};

use super::estimate::Estimate;
use super::request::CheapestRequest;
use crate::campaign::{self, Campaign};
use crate::compare::plan::spacing_override;
use crate::ensemble::runs::Headline;
use crate::failure::Failure;
use crate::machine;
use crate::parts::{Override, Parts};
use crate::progress::clock;
use crate::words::length_words;

mod errors;
mod parts;

use errors::{APART, Promised};
pub use errors::{Differ, Quantity};

/// Spacing of the first run, over the scene's own.
const COARSEST: f64 = 8.0;
/// Runs that show an order.
const RUNGS: usize = 3;
/// How much more exact than the error that is asked for the finest run is to be, to stand for the truth.
const FINER: f64 = 4.0;
/// Share of the budget, and time (s), from which on a run is long: then it is made only if it is needed.
const LONG: f64 = 0.05;
const LONG_S: f64 = 1.0;
/// Share of the error that is aimed at: what is chosen is checked, and a miss costs a run.
const AIM: f64 = 0.9;
/// The finest next spacing over the finest so far: estimates do not reach farther.
const FARTHEST: f64 = 0.25;
/// Standard deviations of the noise that a promise covers.
const NOISE: f64 = 2.0;
/// Ratio of spacings below which a run is not worth making beside another.
const NEAR: f64 = 1.12;
/// Runs after the first ones.
const MOST_MORE: usize = 8;
/// Runs that take less (s) are made again for their time.
const SHORT_S: f64 = 0.2;
/// How often.
const REPEATS: u64 = 5;

/// A run of a ladder.
#[derive(Clone, Serialize, Deserialize)]
pub struct Rung {
    /// Particle spacing (m).
    pub spacing: f64,
    /// Time (s) that was forecast for it, if it was.
    pub forecast_s: Option<f64>,
    /// Time (s) that it took: CPU time of setup and solve.
    pub cost_s: f64,
    /// That of the setup.
    setup_s: f64,
    /// What it left.
    pub result: RunResult,
    /// The same with another seed, where there is noise.
    second: Option<RunResult>,
}

/// Why a method does not reach an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Short {
    /// It would take too long.
    #[error("a run at {spacing} takes about {}, more than the budget of {}; promised so far: {}", clock(*forecast_s), clock(*budget_s), percent(*promised, 3))]
    TooLong {
        /// Spacing of the run, in words.
        spacing: String,
        /// Its time (s).
        forecast_s: f64,
        /// All that there is (s).
        budget_s: f64,
        /// The best promise so far.
        promised: f64,
    },
    /// Noise alone is greater.
    #[error("the noise of one run alone is {}; the mean of {seeds} seeds would be sufficient", percent(*noise, 3))]
    Noise {
        /// What a promise has of it.
        noise: f64,
        /// Runs whose mean has no more than the error.
        seeds: u64,
    },
    /// Steps that do not follow the spacing alone are worse.
    #[error("the error of its time steps alone is {}, independent of the spacing: set a smaller {key}", percent(*steps, 3))]
    Steps {
        /// Their error.
        steps: f64,
        /// What makes it smaller.
        key: &'static str,
    },
    /// Ever finer runs do not come nearer to each other.
    #[error("the differences between runs do not decrease; promised so far: {}", percent(*promised, 3))]
    Stalled {
        /// The best promise.
        promised: f64,
    },
    /// No two runs can be held against each other.
    #[error("{0}")]
    Unknown(String),
    /// The program is to stop.
    #[error("interrupted")]
    Interrupted,
}

/// What a method reaches.
pub struct Reached {
    /// Its runs, from coarse to fine.
    pub rungs: Vec<Rung>,
    /// Errors that are promised of them; infinite where a run is too coarse to say anything of what is promised.
    pub promised: Vec<f64>,
    /// Observed order.
    pub order: f64,
    /// The part of all promises that the steps make, where no smaller spacing makes it smaller.
    pub steps_alone: f64,
    /// The noise of one run.
    pub noise: Option<f64>,
    /// The headline that the errors are of.
    pub headline: Option<Headline>,
    /// The one that is cheapest, or why there is none.
    pub chosen: Result<usize, Short>,
}

impl Reached {
    /// What is promised of a run, if anything is.
    pub fn promise(&self, rung: usize) -> Option<f64> {
        self.promised.get(rung).copied().filter(|promised| promised.is_finite())
    }

    /// Of a method that the scene does not take.
    pub fn refused(failure: &Failure) -> Reached {
        let chosen = Err(Short::Unknown(failure.to_string()));
        let (rungs, promised, order) = (Vec::new(), Vec::new(), f64::NAN);
        Reached { rungs, promised, order, steps_alone: 0.0, noise: None, headline: None, chosen }
    }
}

/// A method on its way.
pub struct Ladder<'a> {
    request: &'a CheapestRequest,
    parts: &'a Parts<'a>,
    campaign: Option<&'a Campaign<'a>>,
    kind: &'static MethodKind,
    own: f64,
    base: Scene,
    coarsest: f64,
    most: f64,
    quantities: Vec<Quantity<'a>>,
    rungs: Vec<Rung>,
    /// Error of the steps, where it is measured.
    steps: Option<f64>,
    spent_s: f64,
}

impl<'a> Ladder<'a> {
    /// Of a method of a scene that has settings for it. Runs that a campaign knows are not made again.
    pub fn new(
        request: &'a CheapestRequest,
        parts: &'a Parts<'a>,
        campaign: Option<&'a Campaign<'a>>,
        (base, kind): (&Scene, &'static MethodKind),
    ) -> Self {
        let own = base.method(kind.name).or(base.methods.first()).map_or(f64::NAN, |own| own.numerics.spacing);
        let quantities = request.measure.map(Quantity::Headline).into_iter().collect();
        let (coarsest, base) = (COARSEST * own, base.clone());
        let (most, rungs, steps, spent_s) = (f64::INFINITY, Vec::new(), None, 0.0);
        Ladder { request, parts, campaign, kind, own, base, coarsest, most, quantities, rungs, steps, spent_s }
    }

    /// The same of other quantities, at no coarser spacing (m) than this.
    pub fn of(self, quantities: Vec<Quantity<'a>>, coarsest: f64) -> Self {
        Ladder { quantities, coarsest: self.coarsest.min(coarsest), most: coarsest, ..self }
    }

    /// Makes the runs.
    ///
    /// # Errors
    /// Where the scene does not take the method at its own spacing, or a run is refused there.
    pub fn climb(&mut self) -> Result<Reached, Failure> {
        let mut short = self.begin()?;
        if short.is_none() && self.steps_stand_alone() && !self.rungs.is_empty() {
            self.measure_steps(self.rungs.len() - 1)?;
            short = self.steps_too_long();
        }
        let chosen = match short {
            Some(short) => Err(short),
            None => self.choose()?,
        };
        let Promised { errors, order } = self.promised().unwrap_or(Promised { errors: Vec::new(), order: f64::NAN });
        let headline = self.quantities.iter().find_map(|quantity| match quantity {
            Quantity::Headline(headline) => Some(*headline),
            Quantity::Answer(_) => None,
        });
        Ok(Reached {
            rungs: self.rungs.clone(),
            promised: errors,
            order,
            steps_alone: self.steps_alone(),
            noise: self.noise(),
            headline,
            chosen,
        })
    }

    fn steps_too_long(&self) -> Option<Short> {
        let (steps, error) = (self.steps_alone(), self.request.error);
        let key = if self.base.method(self.kind.name)?.numerics.integrator.tolerance().is_some() {
            "tolerance"
        } else {
            "step"
        };
        (steps >= AIM * error).then_some(Short::Steps { steps, key })
    }

    /// Runs at halved spacings until the finest can stand for the truth of those that will do, or takes long.
    fn begin(&mut self) -> Result<Option<Short>, Failure> {
        let mut spacing = self.coarsest;
        loop {
            if self.rungs.len() >= RUNGS {
                let exact = self.promised().is_some_and(|all| all.errors.last() <= Some(&(self.request.error / FINER)));
                if exact
                    || !self.has_time(spacing)
                    || self.forecast(spacing) > (LONG * self.request.budget_s).max(LONG_S)
                {
                    return Ok(None);
                }
            }
            match self.try_at(spacing) {
                Ok(None) => {}
                // A scene may not go so coarse, or fail for it.
                Err(_) | Ok(Some(Short::Unknown(_))) if spacing > self.own && self.rungs.is_empty() => {}
                Err(_) | Ok(Some(Short::TooLong { .. } | Short::Unknown(_))) if self.rungs.len() >= RUNGS => {
                    return Ok(None);
                }
                other => return other,
            }
            self.find_headline();
            spacing *= 0.5;
        }
    }

    /// Runs at ever better spacings until the coarsest that reaches the error is known.
    fn choose(&mut self) -> Result<Result<usize, Short>, Failure> {
        for _ in 0..MOST_MORE {
            let Some(Promised { errors: promised, order }) = self.promised() else {
                return Ok(Err(Short::Unknown("there are no two runs to compare".into())));
            };
            if let Some(noise) = self.noise().map(|noise| NOISE * noise).filter(|noise| *noise > self.request.error) {
                let seeds = (noise / self.request.error).powi(2).ceil() as u64;
                return Ok(Err(Short::Noise { noise, seeds }));
            }
            let spacings: Vec<f64> = self.rungs.iter().map(|rung| rung.spacing).collect();
            let (finest, error) = (spacings.len() - 1, self.request.error);
            let good = promised.iter().position(|promised| *promised <= error);
            let wanted = match good {
                None => {
                    // A smaller spacing leaves the part of the steps as it is.
                    let steps = self.steps_alone();
                    let space = Estimate { order, safety: 1.0, promised: vec![promised[finest] - steps] };
                    let wanted = space.spacing_for(spacings[finest], AIM * error - steps);
                    wanted.clamp(FARTHEST * spacings[finest], spacings[finest] / APART)
                }
                Some(0) if 2.0 * spacings[0] > self.most => return Ok(Ok(0)),
                Some(0) => 2.0 * spacings[0],
                Some(good) => {
                    between((spacings[good - 1], promised[good - 1]), (spacings[good], promised[good]), AIM * error)
                }
            };
            let stalled = || Short::Stalled { promised: promised[finest] };
            let Some(spacing) = spacing_at_most(&self.base.domain, wanted) else { return Ok(good.ok_or_else(stalled)) };
            // Nothing that is worth a run lies between.
            let near = |own: &f64| (own / spacing).max(spacing / own) < NEAR;
            if spacings.iter().any(near) {
                return Ok(good.ok_or_else(stalled));
            }
            let forecast_s = self.forecast(spacing);
            if !self.has_time(spacing) {
                let (spacing, promised) = (length_words(self.base.units, spacing), promised[finest]);
                let short = Short::TooLong { spacing, forecast_s, budget_s: self.request.budget_s, promised };
                return Ok(good.ok_or(short));
            }
            match self.try_at(spacing) {
                Ok(None) => {}
                Ok(Some(Short::Interrupted)) => return Ok(Err(Short::Interrupted)),
                // Coarser ones are tried for what they are worth.
                Ok(Some(_)) | Err(_) if good.is_some() => return Ok(good.ok_or_else(stalled)),
                Ok(Some(short)) => return Ok(Err(short)),
                Err(failure) => return Err(failure),
            }
        }
        let promised = self.promised().map_or(Vec::new(), |all| all.errors);
        let good = promised.iter().position(|promised| *promised <= self.request.error);
        Ok(good.ok_or(Short::Stalled { promised: promised.last().copied().unwrap_or(f64::INFINITY) }))
    }

    /// Whether the budget has time for a run.
    fn has_time(&self, spacing: f64) -> bool {
        self.spent_s + self.forecast(spacing) <= self.request.budget_s
    }

    /// A run at a spacing.
    fn try_at(&mut self, spacing: f64) -> Result<Option<Short>, Failure> {
        let scene = self.scene_at(spacing, None)?;
        self.run(&scene, spacing)
    }

    fn scene_at(&self, spacing: f64, key: Option<Override>) -> Result<Scene, Failure> {
        let own = spacing_override(self.base.units, self.kind.name, spacing);
        let own: Vec<Override> = iter::once(own).chain(key).collect();
        (self.parts.scene_at)(&self.request.scene, &[self.request.overrides.as_slice(), &own].concat())
    }

    /// Makes a run and takes it into the ladder.
    fn run(&mut self, scene: &Scene, spacing: f64) -> Result<Option<Short>, Failure> {
        let forecast_s = (self.rungs.len() >= 2).then(|| self.forecast(spacing));
        let Some(rung) = self.known_or_made(scene, spacing, forecast_s)? else { return Ok(Some(Short::Interrupted)) };
        match rung.result.record.outcome {
            Outcome::Ok => {}
            Outcome::TimedOut => {
                let (budget_s, spacing) = (self.request.budget_s, length_words(self.base.units, spacing));
                let promised = self.promised().and_then(|all| all.errors.last().copied()).unwrap_or(1.0);
                let forecast_s = forecast_s.unwrap_or(self.request.budget_s);
                return Ok(Some(Short::TooLong { spacing, forecast_s, budget_s, promised }));
            }
            other => {
                return Ok(Some(Short::Unknown(format!(
                    "the run at {} ended {}",
                    length_words(self.base.units, spacing),
                    other.name()
                ))));
            }
        }
        let place = self.rungs.partition_point(|other| other.spacing > spacing);
        self.rungs.insert(place, rung);
        Ok(None)
    }

    /// A run that the campaign knows, or that is made; none if it was interrupted.
    fn known_or_made(&mut self, scene: &Scene, spacing: f64, forecast_s: Option<f64>) -> Result<Option<Rung>, Failure> {
        let study = format!("cheapest {} {}", self.request.threads, machine::identity());
        let key = campaign::key(&study, scene, self.kind.name, 1);
        let rung = match self.campaign.and_then(|campaign| campaign.known::<Rung>(&key)) {
            Some(known) => known,
            None => {
                let Some(rung) = self.make(scene, spacing, forecast_s)? else { return Ok(None) };
                // A run that ran out of time is made again where there is more.
                let is_whole = rung.result.record.outcome != Outcome::TimedOut;
                if let Some(campaign) = self.campaign.filter(|_| is_whole) {
                    campaign.keep(&key, &rung);
                }
                rung
            }
        };
        for result in iter::once(&rung.result).chain(&rung.second) {
            self.spent_s += result.record.setup_wall_s + result.record.solve_wall_s;
        }
        Ok(Some(rung))
    }

    fn make(&self, scene: &Scene, spacing: f64, forecast_s: Option<f64>) -> Result<Option<Rung>, Failure> {
        let known = (self.parts.reference_for)(scene).map_err(Failure::Request)?;
        let reference: Option<Arc<dyn Reference>> = known.reference.map(Arc::from);
        let of_seed = |seed: u64| -> Result<Option<RunResult>, Refused> {
            let options = Options {
                threads: self.request.threads,
                seed,
                interrupt: Some(self.parts.interrupt),
                time_limit_s: Some((self.request.budget_s - self.spent_s).max(1.0)),
                ..Options::default()
            };
            let result = (self.parts.run)(scene, self.kind.name, reference.as_ref(), &options)?;
            Ok(Some(result).filter(|result| result.record.outcome != Outcome::Interrupted))
        };
        let Some(result) = of_seed(1)? else { return Ok(None) };
        let cost = |result: &RunResult| result.record.setup_cpu_s + result.record.solve_cpu_s;
        let (mut costs, mut setups) = (vec![cost(&result)], vec![result.record.setup_cpu_s]);
        let second = if self.kind.stochastic { of_seed(2)? } else { None };
        while costs[0] < SHORT_S && (costs.len() as u64) < REPEATS {
            let Some(again) = of_seed(1)? else { return Ok(None) };
            costs.push(cost(&again));
            setups.push(again.record.setup_cpu_s);
        }
        let cost_s = median(&costs).unwrap_or(costs[0]);
        let setup_s = median(&setups).unwrap_or(setups[0]).min(cost_s);
        Ok(Some(Rung { spacing, forecast_s, cost_s, setup_s, result, second }))
    }

    /// Time (s) of a run at a spacing, by the two runs that are nearest to it: between them it follows a power of the spacing; beyond
    /// them particles and evaluations do. The setup and an evaluation take some time by themselves and some for each particle.
    fn forecast(&self, spacing: f64) -> f64 {
        let Some(last) = self.rungs.len().checked_sub(2) else { return 0.0 };
        let finer = self.rungs.partition_point(|rung| rung.spacing > spacing);
        let first = finer.saturating_sub(1).min(last);
        let (coarse, fine) = (&self.rungs[first], &self.rungs[first + 1]);
        let ratio = (coarse.spacing / fine.spacing).ln();
        let along = |coarse: f64, finer: f64| finer * (fine.spacing / spacing).powf((finer / coarse).ln() / ratio);
        if fine.spacing <= spacing && spacing <= coarse.spacing {
            return along(coarse.cost_s, fine.cost_s);
        }
        let evaluations = |rung: &Rung| rung.result.record.work.evaluations.max(1) as f64;
        let particles = |rung: &Rung| rung.result.record.particles as f64;
        let setup = |rung: &Rung| rung.setup_s;
        let one = |rung: &Rung| (rung.cost_s - rung.setup_s) / evaluations(rung);
        let wanted = along(particles(coarse), particles(fine));
        let at_wanted = |of: &dyn Fn(&Rung) -> f64| {
            let by_particle = (of(fine) - of(coarse)) / (particles(fine) - particles(coarse)).max(1.0);
            of(fine) + by_particle.clamp(0.0, of(fine) / particles(fine)) * (wanted - particles(fine))
        };
        at_wanted(&setup) + along(evaluations(coarse), evaluations(fine)) * at_wanted(&one)
    }
}

/// The spacing at which an error is to be expected, by two runs of which one is worse.
fn between((coarse, worse): (f64, f64), (fine, better): (f64, f64), error: f64) -> f64 {
    let order = (worse / better).ln() / (coarse / fine).ln();
    fine * (error / better).max(1.0).powf(1.0 / order)
}
