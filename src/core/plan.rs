//! From a scene to what its steps need.

use crate::march::Refused;
use crate::scene::Scene;

/// Particles, neighbours and walls, ready for a method's step.
pub struct Assembly {}

/// What a run of a scene under a method will do: the answer of `frazil check`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSummary {
    /// Particles.
    pub particles: u64,
    /// Pairs that one evaluation visits (each pair once).
    pub pairs: u64,
    /// Memory of columns, lists and ghosts (bytes).
    pub memory_bytes: u64,
    /// Step that will be made (s), before it is shortened to land on outputs.
    pub step_s: f64,
    /// Derived bound of the explicit step (s).
    pub step_bound_s: f64,
    /// What sets the bound.
    pub step_limit: String,
    /// Steps of the whole run.
    pub steps: u64,
    /// What the scene uses, in words.
    pub used: Vec<String>,
    /// What it is spared, in words.
    pub spared: Vec<String>,
    /// How the method differs from the scene, in words.
    pub differences: Vec<String>,
}

/// Plans a run without making a step.
pub fn summary(_scene: &Scene, _method: &str, _seed: u64) -> Result<PlanSummary, Refused> {
    Err(Refused { reason: "the engine is not connected".into() })
}
