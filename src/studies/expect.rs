//! How long a run will take, before it starts.

use std::sync::Arc;

use frazil_core::space::lattice::Lattice;
use frazil_scene::method::Stepper;
use frazil_scene::{Scene, StepChoice};
use frazil_simulation::predict;
use frazil_simulation::reference::Reference;

use crate::progress::LONG;

/// Time (s) of a particle's step, at most: noise of some fifty pairs, each from a list.
const DEAREST: f64 = 1e-6;

/// Time (s) that a run of a scene under a method takes on this machine, from its first steps; absent where it is plainly short,
/// which costs no trial, or where the steps do not tell.
pub fn seconds(scene: &Scene, method: &str, reference: Option<&Arc<dyn Reference>>, threads: usize) -> Option<f64> {
    if is_short(scene, method) {
        return None;
    }
    predict::forecast(scene, method, reference, threads, 1).ok()?.seconds()
}

/// Whether particles and steps are so few that nothing need be tried. Water and motion make steps dearer by what only a
/// trial tells.
fn is_short(scene: &Scene, method: &str) -> bool {
    let Some(settings) = scene.method(method) else { return true };
    if scene.flow.is_some() || matches!(settings.discretisation.stepper, Stepper::Moving(_)) {
        return false;
    }
    let numerics = &settings.numerics;
    let diffusivities = scene.materials.iter().flat_map(|material| {
        [
            material.frozen.conductivity / material.frozen_capacity(),
            material.unfrozen.conductivity / material.unfrozen_capacity(),
        ]
    });
    // The bound of two neighbours in each direction; pairs of a longer reach are weaker. A pipe may halve it.
    let bound = numerics.spacing.powi(2)
        / (4.0 * scene.domain.dimension() as f64 * diffusivities.fold(f64::MIN_POSITIVE, f64::max));
    let step = match numerics.step {
        StepChoice::Fraction(fraction) => fraction * bound,
        StepChoice::Fixed(step) => step,
    };
    let steps = scene.duration / step + (scene.watch.outputs + scene.watch.profiles.len()) as f64;
    let particles = Lattice::new(&scene.domain, numerics.spacing).len() as f64;
    particles * steps * DEAREST < LONG
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundled;

    fn told(scene: &str, changes: &[(&str, &str)]) -> Option<f64> {
        let changes: Vec<(String, String)> =
            changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        seconds(&bundled::scene(scene, &changes).expect("a scene"), "local", None, 1)
    }

    #[test]
    fn long_runs_are_known_before_they_start_and_short_ones_cost_no_trial() {
        assert_eq!(told("stefan-water", &[]), None);
        assert_eq!(told("frozen-wall-sand", &[]), None);
        // Some 1e11 steps of particles, of which a core makes less than 1e9 in a second.
        let long = told("frozen-wall-sand", &[("method.local.spacing_m", "0.02"), ("time.duration_days", "4000")]);
        assert!(long.is_some_and(|seconds| seconds > 100.0), "{long:?}");
    }
}
