//! One cell of a map: a run of a scene at a multiple of the theoretical bound of the step.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use frazil_core::boundary::condition::Condition;
use frazil_record::Outcome;
use frazil_scene::method::MethodSettings;
use frazil_scene::{IntegratorChoice, Scene, StepChoice};
use frazil_simulation::march::{self, Options, Refused};
use frazil_simulation::plan::{self, Bounds};
use frazil_simulation::predict;
use frazil_simulation::reference::Reference;
use serde::{Deserialize, Serialize};

use super::axis::stefan_number;
use crate::campaign;
use crate::parts::Parts;

/// Outputs of a cell, at which heat balance, front and flows are looked at: about as many.
const OUTPUTS: f64 = 120.0;

/// Layers of particles that a front must have room to freeze. The fastest mode of n layers decays by `cos^2(pi/(2n + 2))`
/// of that of endless ones: 2 % slower for ten.
const LAYERS: f64 = 10.0;

/// Fewest steps of RKL2: its steps grow from Euler's, and some must have their full length.
const FEWEST_SUPER_STEPS: f64 = 60.0;

/// What came of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// How it ended: the class of the cell.
    pub outcome: Outcome,
    /// Why, if not well.
    pub cause: Option<String>,
    /// Steps made.
    pub steps: u64,
    /// Longest step (s).
    pub step_s: f64,
    /// How far temperatures left the range of the data, over it.
    pub violation_rel: Option<f64>,
    /// How far what can only go one way went back.
    pub setback_rel: Option<f64>,
    /// Heat not accounted for over heat exchanged.
    pub energy_balance_rel: Option<f64>,
}

/// The word of a class: what an outcome means for a step.
pub fn class_word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Ok => "exact",
        other => other.name(),
    }
}

/// Name of a run of a scene under a method at a multiple of the stated bound.
pub fn key(scene: &Scene, method: &str, ratio: f64, seed: u64) -> String {
    campaign::key(&format!("cell at {ratio:?}"), scene, method, seed)
}

/// A column of a map: a scene under a method, ready to be run at any step.
pub struct Probe {
    /// The scene with its overrides.
    pub scene: Scene,
    /// Method.
    pub method: &'static str,
    /// The two theoretical bounds.
    pub bounds: Bounds,
    /// The bound that the method states (s): Gershgorin's, times the reach of a super-step.
    pub stated_s: f64,
    /// Particles.
    pub particles: u64,
    reference: Option<Arc<dyn Reference>>,
}

impl Probe {
    /// Prepares a column; refused if the scene has no plan under the method. `known` are bounds of the same particles.
    pub fn new(parts: &Parts<'_>, scene: Scene, method: &'static str, known: Option<Bounds>) -> Result<Probe, Refused> {
        let reference = wall_data(parts, &scene)?;
        let settings = plan::settings_of(&scene, method)?;
        if settings.numerics.integrator.tolerance().is_some() {
            return Err(Refused::NoBound(method));
        }
        let summary = plan::build(&scene, settings, reference.as_ref(), 1, SEED)?.summary;
        let bounds = match known {
            Some(bounds) => bounds,
            None => plan::bounds(&scene, settings, reference.as_ref(), SEED)?,
        };
        let (stated_s, particles) = (summary.step_bound_s, summary.particles);
        Ok(Probe { scene, method, bounds, stated_s, particles, reference })
    }

    /// The settings of the method.
    fn settings(&self) -> Option<&MethodSettings> {
        self.scene.method(self.method)
    }

    /// The linear stability limit of explicit Euler over Gershgorin's bound: where a step loses its stability, over the
    /// step that the method states.
    pub fn sharp_over_bound(&self) -> f64 {
        self.bounds.sharp_step / self.bounds.gershgorin.step
    }

    /// Whether steps promise the maximum principle up to the stated bound, and not stability alone.
    pub fn monotone(&self) -> bool {
        self.settings().is_some_and(|settings| settings.numerics.integrator.is_monotone())
    }

    /// Whether runs differ by their seed, so that a cell needs several.
    pub fn noisy(&self) -> bool {
        self.settings().is_some_and(|settings| settings.discretisation.fluctuation > 0.0)
    }

    /// Particle spacing (m).
    pub fn spacing(&self) -> Option<f64> {
        self.settings().map(|settings| settings.numerics.spacing)
    }

    /// Name of a run: whatever decides its result.
    pub fn key(&self, ratio: f64, seed: u64) -> String {
        key(&self.scene, self.method, ratio, seed)
    }

    /// About how long (s) a run takes with steps of the stated bound, from its first steps; absent where they do not tell.
    pub fn seconds(&self) -> Option<f64> {
        predict::forecast(&self.timed(1.0), self.method, self.reference.as_ref(), 1, SEED).ok()?.seconds()
    }

    /// Runs the scene with steps of `ratio` times the stated bound.
    pub fn run(&self, ratio: f64, seed: u64, limit_s: f64, interrupt: &AtomicBool) -> Result<Finding, Refused> {
        let scene = self.timed(ratio);
        let options = Options { seed, interrupt: Some(interrupt), time_limit_s: Some(limit_s), ..Options::default() };
        let record = march::run(&scene, self.method, self.reference.as_ref(), &options)?.record;
        let finite = |value: &f64| value.is_finite();
        Ok(Finding {
            outcome: record.outcome,
            cause: record.cause,
            steps: record.steps,
            step_s: record.step_s,
            violation_rel: record.bounds_violation_rel.filter(finite),
            setback_rel: record.setback_rel.filter(finite),
            energy_balance_rel: Some(record.energy_balance_rel).filter(finite),
        })
    }

    /// The scene with this step and a duration of whole steps, an odd number of them between two outputs: what turns
    /// round from step to step then shows at every other output at least. Steps beyond the bound are none of a scene
    /// file's business, so they are set here.
    fn timed(&self, ratio: f64) -> Scene {
        let mut scene = self.scene.clone();
        let step = ratio * self.stated_s;
        let duration = scene.duration.max(self.time_to_freeze_layers().unwrap_or(0.0));
        let mut steps = (duration / step).round().max(1.0);
        for settings in scene.methods.iter_mut().filter(|settings| settings.method == self.method) {
            settings.numerics.step = StepChoice::Fraction(ratio);
            if matches!(settings.numerics.integrator, IntegratorChoice::Rkl2 { .. }) {
                steps = steps.max(FEWEST_SUPER_STEPS);
            }
        }
        let between = 2.0 * (0.5 * steps / OUTPUTS).floor() + 1.0;
        let outputs = (steps / between).round().max(1.0);
        scene.duration = outputs * between * step;
        scene.watch.outputs = outputs as usize;
        scene.watch.profiles = vec![scene.duration];
        scene.watch.probes.clear();
        scene.watch.front_from = None;
        scene
    }
}

impl Probe {
    /// Time (s) in which a plane front freezes (or thaws) enough layers of particles, by the quasi-steady solution
    /// `s^2 = 2 a Ste t`: an instability needs room to grow in.
    fn time_to_freeze_layers(&self) -> Option<f64> {
        let material = self.scene.materials.iter().find(|material| material.latent_heat > 0.0)?;
        let stefan = stefan_number(&self.scene, material).filter(|stefan| *stefan > 0.0)?;
        let diffusivity = material.frozen.conductivity / material.frozen_capacity();
        Some((LAYERS * self.spacing()?).powi(2) / (2.0 * diffusivity * stefan))
    }
}

/// Seed of placement, and of runs that need one only.
pub const SEED: u64 = 1;

/// The solution that walls take their temperature from; errors are not asked for, so other scenes need none.
pub fn wall_data(parts: &Parts<'_>, scene: &Scene) -> Result<Option<Arc<dyn Reference>>, Refused> {
    if !scene.walls.iter().any(|wall| wall.condition == Condition::Exact) {
        return Ok(None);
    }
    let known = (parts.reference_for)(scene).map_err(|error| Refused::Reference(error.to_string()))?;
    Ok(known.reference.map(Arc::from))
}
