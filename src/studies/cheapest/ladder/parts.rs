//! What the error of a run is made of, as far as runs that differ in one thing alone tell it.

use frazil_record::{EstimatedError, Outcome};
use frazil_scene::method::MethodSettings;
use frazil_scene::{Front, StepChoice, Units};

use super::{Ladder, NOISE, Reached};
use crate::ensemble::runs::Headline;
use crate::failure::Failure;
use crate::parts::Override;

/// Share of a tolerance with which a run is made again.
const TIGHTER: f64 = 0.1;
/// The error of steps by error over what the two differ by: it falls at least with the root of the tolerance.
const OF_TIGHTER: f64 = 1.462_475;
/// Share of steps by the bound, or of fixed ones, with which a run is made again.
const SHORTER: f64 = 0.5;
/// Their error over what the two differ by: it falls at least with the step.
const OF_SHORTER: f64 = 2.0;
/// Time of such a run over that of the run that is there.
const COST: f64 = 2.0;

/// The same run with finer steps: the key that makes them, and the error of the steps over what both runs differ by.
struct Finer {
    key: Override,
    whole: f64,
}

impl Ladder<'_> {
    /// Whether a smaller spacing leaves the steps as they are: it shortens those alone that follow the bound.
    pub(super) fn steps_stand_alone(&self) -> bool {
        self.settings().is_some_and(|own| {
            own.numerics.integrator.tolerance().is_some() || matches!(own.numerics.step, StepChoice::Fixed(_))
        })
    }

    /// The part of all promises that no smaller spacing makes smaller.
    pub(super) fn steps_alone(&self) -> f64 {
        self.steps.filter(|_| self.steps_stand_alone()).unwrap_or(0.0)
    }

    fn settings(&self) -> Option<&MethodSettings> {
        self.base.method(self.kind.name)
    }

    /// Measures the error of the steps of a run, where the scene takes finer ones and there is time for them.
    pub(super) fn measure_steps(&mut self, rung: usize) -> Result<(), Failure> {
        let Some(Finer { key, whole }) = self.settings().map(|own| finer(own, self.base.units)) else { return Ok(()) };
        self.steps = self.beside(rung, key, COST)?.map(|apart| whole * apart);
        Ok(())
    }

    /// What the error of a run is made of.
    ///
    /// # Errors
    /// Where a run by which a part is measured is refused for anything but the key that it changes.
    pub fn parts_of(&mut self, rung: usize, reached: &Reached) -> Result<EstimatedError, Failure> {
        if self.steps.is_none() {
            self.measure_steps(rung)?;
        }
        let noise = self.noise();
        let promised = reached.promised[rung];
        let without_noise = (promised.powi(2) - (NOISE * noise.unwrap_or(0.0)).powi(2)).max(0.0).sqrt();
        Ok(EstimatedError {
            measure: reached.headline.map_or("", Headline::name).to_owned(),
            asked_rel: self.request.error,
            promised_rel: promised,
            space_rel: (without_noise - self.steps_alone()).max(0.0),
            time_rel: self.steps,
            front_rel: self.front_part(rung)?,
            noise_rel: noise,
        })
    }

    /// What fronts that are felt at the centres of particles and where they are make of a run.
    fn front_part(&mut self, rung: usize) -> Result<Option<f64>, Failure> {
        let Some(own) = self.settings() else { return Ok(None) };
        let other = if own.numerics.front == Front::SubCell { Front::Cell } else { Front::SubCell };
        let word = Front::WORDS.iter().find(|(_, front)| *front == other).map_or("", |(word, _)| word);
        let key = (format!("method.{}.front", self.kind.name), format!("\"{word}\""));
        self.beside(rung, key, 1.0)
    }

    /// What a run differs from the same with one key changed, which takes `cost` times as long; none where the scene does not take
    /// the key or the run does not come to its end.
    fn beside(&mut self, rung: usize, key: Override, cost: f64) -> Result<Option<f64>, Failure> {
        let (spacing, cost_s) = (self.rungs[rung].spacing, self.rungs[rung].cost_s);
        if self.spent_s + cost * cost_s > self.request.budget_s {
            return Ok(None);
        }
        let Ok(scene) = self.scene_at(spacing, Some(key)) else { return Ok(None) };
        let Some(other) = self.known_or_made(&scene, spacing, None)? else { return Ok(None) };
        let is_whole = other.result.record.outcome == Outcome::Ok;
        let apart = || self.difference(&self.rungs[rung].result, &other.result);
        Ok(if is_whole { apart() } else { None })
    }
}

/// How steps are made finer.
fn finer(own: &MethodSettings, units: Units) -> Finer {
    let key = |name: &str, value: f64| (format!("method.{}.{name}", own.method), format!("{value}"));
    if let Some(tolerance) = own.numerics.integrator.tolerance() {
        return Finer { key: key("tolerance", TIGHTER * tolerance), whole: OF_TIGHTER };
    }
    let shorter = match own.numerics.step {
        StepChoice::Fraction(fraction) => key("step_fraction", SHORTER * fraction),
        StepChoice::Fixed(step) => key(if units == Units::Si { "step_s" } else { "step" }, SHORTER * step),
    };
    Finer { key: shorter, whole: OF_SHORTER }
}
