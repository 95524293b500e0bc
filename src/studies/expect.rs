//! How long a run will take, before it starts.

use std::sync::Arc;

use frazil_core::space::lattice::Lattice;
use frazil_record::plain;
use frazil_scene::method::{MethodSettings, Stepper};
use frazil_scene::{Scene, StepChoice};
use frazil_simulation::march::Refused;
use frazil_simulation::predict::{self, Forecast, StepCount, Work};
use frazil_simulation::reference::Reference;

use crate::progress::LONG;

/// Time (s) of a particle's step, at most: of some fifty pairs of a list with means of conductivities and freezing curves, and with
/// noise of each.
const DEAREST: f64 = 2e-7;
const DEAREST_WITH_NOISE: f64 = 1e-6;

/// What a run will take, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// Time (s) on this machine.
    pub seconds: f64,
    /// What its steps are, what bounds them and what would make it shorter, in words.
    pub shorter: String,
}

/// What a run of a scene under a method takes on this machine, from its first steps; absent where it is plainly short,
/// which costs no trial, or where the steps do not tell.
///
/// # Errors
/// What the plan of the run refuses, its memory included.
pub fn run(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
) -> Result<Option<Expectation>, Refused> {
    if is_short(scene, method) {
        return Ok(None);
    }
    let forecast = predict::forecast(scene, method, reference, threads, 1)?;
    let told = forecast.seconds().zip(forecast.work);
    Ok(told.map(|(seconds, work)| Expectation { seconds, shorter: shorter(&forecast, &work) }))
}

/// What a run spends its time on, and what would make it shorter.
fn shorter(forecast: &Forecast, work: &Work) -> String {
    let summary = &forecast.summary;
    let lengths = match summary.steps {
        StepCount::Planned(_) => {
            format!("of at most {} s, limited by {},", plain(summary.step_s, 2), summary.step_limit)
        }
        StepCount::ByErrorControl { .. } => {
            format!("with error control, of several stages because {} limits an Euler step,", summary.step_limit)
        }
    };
    let steps = format!("{:.1e} steps {lengths} and {:.1e} particles", work.steps as f64, summary.particles as f64);
    let ways = summary.relaxed_by.iter().map(String::as_str).chain(["an earlier end"]);
    format!("{steps}; shorter by {}", ways.collect::<Vec<_>>().join(", or by "))
}

/// Whether particles and steps are so few that nothing need be tried. Water and motion make steps dearer by what only a
/// trial tells.
fn is_short(scene: &Scene, method: &str) -> bool {
    let moves = |settings: &MethodSettings| matches!(settings.discretisation.stepper, Stepper::Moving(_));
    let has_noise = |settings: &MethodSettings| settings.discretisation.fluctuation > 0.0;
    let settings = scene.method(method);
    let dearest = if settings.is_some_and(has_noise) { DEAREST_WITH_NOISE } else { DEAREST };
    scene.flow.is_none() && !settings.is_some_and(moves) && particle_steps(scene, method) * dearest < LONG
}

/// About how many steps of particles a run makes with explicit steps, without a plan: what runs of one kind take is in
/// proportion to it.
pub fn particle_steps(scene: &Scene, method: &str) -> f64 {
    let Some(settings) = scene.method(method) else { return 0.0 };
    let numerics = &settings.numerics;
    let diffusivities = scene.materials.iter().flat_map(|material| {
        [
            material.frozen.conductivity / material.frozen_capacity(),
            material.unfrozen.conductivity / material.unfrozen_capacity(),
        ]
    });
    // The bound of two neighbours in each direction; pairs of a longer reach are weaker. A pipe may halve it.
    let bound = numerics.spacing.powi(2)
        / (4.0
            * scene.domain.dimension() as f64
            * diffusivities.fold(f64::MIN_POSITIVE, f64::max)
            * scene.along.max_element());
    let step = match numerics.step {
        StepChoice::Fraction(fraction) => fraction * bound,
        StepChoice::Fixed(step) => step,
    };
    let steps = scene.duration / step + (scene.watch.outputs + scene.watch.profiles.len()) as f64;
    let particles = Lattice::new(&scene.domain, numerics.spacing).len() as f64;
    particles * steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundled;

    fn told(scene: &str, changes: &[(&str, &str)]) -> Option<Expectation> {
        let changes: Vec<(String, String)> =
            changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        run(&bundled::scene(scene, &changes).expect("a scene"), "local", None, 1).expect("a plan")
    }

    #[test]
    fn long_runs_are_known_before_they_start_and_short_ones_cost_no_trial() {
        assert_eq!(told("stefan-water", &[]), None);
        assert_eq!(told("frozen-wall-sand", &[]), None);
        // Some 1e11 steps of particles, of which a core makes less than 1e9 in a second.
        let long = told("frozen-wall-sand", &[("method.local.spacing_m", "0.02"), ("time.duration_days", "4000")]);
        assert!(long.as_ref().is_some_and(|long| long.seconds > 100.0), "{long:?}");
    }
}
