//! Methods whose particles move: they place them, and make their own steps.

use crate::physics::thermal::Thermal;
use crate::solvers::solver::Solver;

/// Particles that move, at their start, and the method that moves them. [`Solver::publish`] fills their columns.
pub struct ParticleSet {
    /// Their material.
    pub thermal: Thermal,
    /// Enthalpy of each (J/m3), relative to the initial state.
    pub enthalpy: Vec<f64>,
    /// Volume of each (m^d).
    pub volume: f64,
    /// How the method differs from the scene, in words.
    pub differences: Vec<String>,
    /// The method.
    pub method: Box<dyn Solver>,
}

/// What a plan is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To be run.
    Run,
    /// To try what a step takes: particles that move need not have come to rest.
    Trial,
}
