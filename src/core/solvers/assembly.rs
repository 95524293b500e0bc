//! Particles, neighbours and walls, ready for a method with its own time steps.

use std::sync::Arc;

use crate::balances::heated::{HeatSource, Heated};
use crate::kernels::enthalpy_rows::ListBalance;
use crate::kernels::list_parts::ListParts;
use crate::kernels::term::PairTerm;
use crate::physics::latent_heat::{LatentHeatScheme, Mushy, scheme};
use crate::solvers::euler::Euler;
use crate::solvers::solver::Solver;

/// Particles, neighbours and walls on a list, ready for a method's own step.
pub struct Assembly {
    /// The parts of a list operator.
    pub parts: ListParts,
    /// Heat that is released inside the body.
    pub sources: Vec<HeatSource>,
    /// Enthalpies at the start (see [`crate::particles::Particles::start`]).
    pub start: Arc<[f64]>,
    /// Latent heat.
    pub latent_heat_scheme: LatentHeatScheme,
    /// Conductivity inside the freezing interval.
    pub mushy: Mushy,
    /// Absolute zero on the scale of the temperatures.
    pub absolute_zero: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Assembly {
    /// Steps of Euler with a term beside conduction.
    pub fn into_solver<T: PairTerm>(self, term: T) -> Box<dyn Solver> {
        let count = self.parts.positions.len();
        let scheme = scheme(self.latent_heat_scheme, self.mushy, &self.parts.materials, &self.start, count);
        let balance = Box::new(ListBalance::new(self.parts, term, scheme));
        Box::new(Euler::new(Heated::or_bare(balance, self.sources), 1.0))
    }
}
