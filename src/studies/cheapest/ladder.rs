//! Runs of one method, from coarse to fine, as few as tell at which spacing it reaches an error, and at what cost.

use std::iter;
use std::sync::Arc;

use frazil_core::physics::material::Material;
use frazil_core::statistics::median;
use frazil_record::{Outcome, RunResult};
use frazil_scene::method::MethodKind;
use frazil_scene::{Front, Scene, spacing_at_most};
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::measure;
use frazil_simulation::reference::Reference;
use serde::{Deserialize, Serialize};

use super::estimate::Estimate;
use super::request::CheapestRequest;
use crate::campaign::{self, Campaign};
use crate::compare::plan::spacing_override;
use crate::compare::reference::{LocalReference, judge_alike};
use crate::ensemble::runs::Headline;
use crate::failure::Failure;
use crate::machine;
use crate::parts::Parts;
use crate::progress::clock;
use crate::words::length_words;

/// Spacing of the first run, over the scene's own.
const COARSEST: f64 = 8.0;
/// Runs that show an order.
const RUNGS: usize = 3;
/// How much more exact than the error that is asked for the finest run is to be, to stand for the truth.
const FINER: f64 = 4.0;
/// Share of the budget, and time (s), from which on a run is long: then it is made only if it is needed.
const LONG: f64 = 0.05;
const LONG_S: f64 = 1.0;
/// Ratio of spacings from which on two runs tell of an order.
const APART: f64 = 1.5;
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
    /// What it left.
    pub result: RunResult,
    /// The same with another seed, where there is noise.
    second: Option<RunResult>,
}

/// Why a method does not reach an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Short {
    /// It would take too long.
    #[error("a run at {spacing} takes about {}, and the budget is {}; promised so far: {:.2} %", clock(*forecast_s), clock(*budget_s), 100.0 * promised)]
    TooLong { spacing: String, forecast_s: f64, budget_s: f64, promised: f64 },
    /// Noise alone is greater.
    #[error("noise alone is {:.2} % of one run; the mean of {seeds} seeds would do", 100.0 * noise)]
    Noise { noise: f64, seeds: u64 },
    /// Ever finer runs do not come nearer to each other.
    #[error("ever finer runs come no nearer to each other; promised so far: {:.2} %", 100.0 * promised)]
    Stalled { promised: f64 },
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
    /// Errors that are promised of them.
    pub promised: Vec<f64>,
    /// Observed order.
    pub order: f64,
    /// The one that is cheapest, or why there is none.
    pub chosen: Result<usize, Short>,
}

impl Reached {
    /// Of a method that the scene does not take.
    pub fn refused(failure: &Failure) -> Reached {
        let chosen = Err(Short::Unknown(failure.to_string()));
        Reached { rungs: Vec::new(), promised: Vec::new(), order: f64::NAN, chosen }
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
    headline: Option<Headline>,
    rungs: Vec<Rung>,
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
        let (headline, base) = (request.measure, base.clone());
        Ladder { request, parts, campaign, kind, own, base, headline, rungs: Vec::new(), spent_s: 0.0 }
    }

    /// Makes the runs.
    ///
    /// # Errors
    /// Where the scene does not take the method at its own spacing, or a run is refused there.
    pub fn climb(mut self, headline: &mut Option<Headline>) -> Result<Reached, Failure> {
        self.headline = *headline;
        let chosen = match self.begin()? {
            Some(short) => Err(short),
            None => self.choose()?,
        };
        *headline = headline.or(self.headline);
        let (promised, order) = self.promised().map_or((Vec::new(), f64::NAN), |(promised, order)| (promised, order));
        Ok(Reached { rungs: self.rungs, promised, order, chosen })
    }

    /// Runs at halved spacings until the finest can stand for the truth of those that will do, or takes long.
    fn begin(&mut self) -> Result<Option<Short>, Failure> {
        let mut spacing = COARSEST * self.own;
        loop {
            if self.rungs.len() >= RUNGS {
                let exact =
                    self.promised().is_some_and(|(promised, _)| promised.last() <= Some(&(self.request.error / FINER)));
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
            if let (None, [coarse, fine]) = (self.headline, &self.rungs[..]) {
                let known = |headline: &Headline| self.difference(*headline, &coarse.result, &fine.result).is_some();
                self.headline = Headline::ALL.into_iter().find(known);
            }
            spacing *= 0.5;
        }
    }

    /// Runs at ever better spacings until the coarsest that reaches the error is known.
    fn choose(&mut self) -> Result<Result<usize, Short>, Failure> {
        for _ in 0..MOST_MORE {
            let Some((promised, order)) = self.promised() else {
                return Ok(Err(Short::Unknown("no two runs can be held against each other".into())));
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
                    let wanted =
                        Estimate { order, promised: promised.clone() }.spacing_for(spacings[finest], AIM * error);
                    wanted.clamp(FARTHEST * spacings[finest], spacings[finest] / APART)
                }
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
        let promised = self.promised().map_or(Vec::new(), |(promised, _)| promised);
        let good = promised.iter().position(|promised| *promised <= self.request.error);
        Ok(good.ok_or(Short::Stalled { promised: promised.last().copied().unwrap_or(f64::INFINITY) }))
    }

    /// Whether the budget has time for a run.
    fn has_time(&self, spacing: f64) -> bool {
        self.spent_s + self.forecast(spacing) <= self.request.budget_s
    }

    /// A run at a spacing.
    fn try_at(&mut self, spacing: f64) -> Result<Option<Short>, Failure> {
        let scene = self.scene_at(spacing)?;
        self.run(&scene, spacing)
    }

    fn scene_at(&self, spacing: f64) -> Result<Scene, Failure> {
        let own = spacing_override(self.base.units, self.kind.name, spacing);
        (self.parts.scene_at)(&self.request.scene, &[self.request.overrides.as_slice(), &[own]].concat())
    }

    /// Makes a run and takes it into the ladder.
    fn run(&mut self, scene: &Scene, spacing: f64) -> Result<Option<Short>, Failure> {
        let forecast_s = (self.rungs.len() >= 2).then(|| self.forecast(spacing));
        let study = format!("cheapest {} {}", self.request.threads, machine::identity());
        let key = campaign::key(&study, scene, self.kind.name, 1);
        let rung = match self.campaign.and_then(|campaign| campaign.known::<Rung>(&key)) {
            Some(known) => known,
            None => {
                let Some(rung) = self.make(scene, spacing, forecast_s)? else { return Ok(Some(Short::Interrupted)) };
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
        match rung.result.record.outcome {
            Outcome::Ok => {}
            Outcome::TimedOut => {
                let (budget_s, spacing) = (self.request.budget_s, length_words(self.base.units, spacing));
                let promised = self.promised().and_then(|(promised, _)| promised.last().copied()).unwrap_or(1.0);
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
        let mut costs = vec![cost(&result)];
        let second = if self.kind.stochastic { of_seed(2)? } else { None };
        while costs[0] < SHORT_S && (costs.len() as u64) < REPEATS {
            let Some(again) = of_seed(1)? else { return Ok(None) };
            costs.push(cost(&again));
        }
        let cost_s = median(&costs).unwrap_or(costs[0]);
        Ok(Some(Rung { spacing, forecast_s, cost_s, result, second }))
    }

    /// Time (s) of a run at a spacing, by the two runs that are nearest to it: between them it follows a power of the spacing; beyond
    /// them particle updates do, and time follows particle updates.
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
        let updates = |rung: &Rung| rung.result.record.particle_updates as f64;
        let each = (fine.cost_s - coarse.cost_s) / (updates(fine) - updates(coarse));
        let each = if each > 0.0 { each } else { fine.cost_s / updates(fine) };
        let wanted = along(updates(coarse), updates(fine));
        (fine.cost_s + each * (wanted - updates(fine))).max(each * wanted)
    }

    /// What a run differs from a finer one.
    fn difference(&self, headline: Headline, coarse: &RunResult, fine: &RunResult) -> Option<f64> {
        let truth = LocalReference::new(&self.base, fine.clone());
        let mut judged = self.base.clone();
        judge_alike(&mut judged, self.rungs.first()?.spacing, &truth);
        headline.of(&measure::errors(&judged, self.rungs.first()?.spacing, coarse, &truth)).map(f64::abs)
    }

    /// The order that the error of the spacing has: a sharp front that is felt at the centres of particles is of the first.
    fn formal_order(&self) -> f64 {
        let sharp = !self.base.of_water && self.base.materials.iter().any(Material::is_sharp);
        let front = self.base.method(self.kind.name).map(|own| own.numerics.front);
        // A closure is that of fronts that meet, at any angle to the lattice.
        let meets = self.headline == Some(Headline::Closure);
        if sharp && (meets || front != Some(Front::SubCell)) { 1.0 } else { 2.0 }
    }

    /// The noise of one run at the finest spacing.
    fn noise(&self) -> Option<f64> {
        let finest = self.rungs.last()?;
        let apart = self.difference(self.headline?, finest.second.as_ref()?, &finest.result)?;
        Some(apart / std::f64::consts::SQRT_2)
    }

    /// Errors that are promised of all runs, and the order: by those that are apart, and of the others by what they differ from
    /// the finest.
    fn promised(&self) -> Option<(Vec<f64>, f64)> {
        let headline = self.headline?;
        let mut apart: Vec<usize> = Vec::new();
        for k in (0..self.rungs.len()).rev() {
            if apart.last().is_none_or(|finer| self.rungs[k].spacing >= APART * self.rungs[*finer].spacing) {
                apart.push(k);
            }
        }
        apart.reverse();
        let between = |coarse: usize, fine: usize| {
            self.difference(headline, &self.rungs[coarse].result, &self.rungs[fine].result)
        };
        let differences: Option<Vec<f64>> = apart.windows(2).map(|pair| between(pair[0], pair[1])).collect();
        let spacings: Vec<f64> = apart.iter().map(|k| self.rungs[*k].spacing).collect();
        let estimate = Estimate::of(&spacings, &differences?, self.formal_order())?;
        let finest = self.rungs.len() - 1;
        let noise = NOISE * self.noise().unwrap_or(0.0);
        let promised = (0..self.rungs.len()).map(|k| match apart.iter().position(|own| *own == k) {
            Some(place) => Some(estimate.promised[place].hypot(noise)),
            None => Some((between(k, finest)? + estimate.promised.last()?).hypot(noise)),
        });
        Some((promised.collect::<Option<Vec<f64>>>()?, estimate.order))
    }
}

/// The spacing at which an error is to be expected, by two runs of which one is worse.
fn between((coarse, worse): (f64, f64), (fine, better): (f64, f64), error: f64) -> f64 {
    let order = (worse / better).ln() / (coarse / fine).ln();
    fine * (error / better).max(1.0).powf(1.0 / order)
}
