//! What a fluid has in all.

use super::Fluid;
use super::matter::Matter;

/// Sums over all particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Totals<const D: usize> {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Internal energy above that at the reference temperature.
    pub heat: f64,
    /// Potential of the conservative forces.
    pub potential: f64,
    /// Momentum.
    pub momentum: [f64; D],
    /// Kinetic temperature, against the mean velocity.
    pub kinetic_temperature: f64,
    /// Harmonic mean of the internal temperatures: what the kinetic one tends to.
    pub internal_temperature: f64,
}

impl<const D: usize, M: Matter> Fluid<D, M> {
    /// Sums over all particles.
    pub fn totals(&self) -> Totals<D> {
        let count = self.particles.len() as f64;
        let mut momentum = [0.0; D];
        let (mut kinetic, mut heat, mut inverse, mut moving) = (0.0, 0.0, 0.0, 0.0);
        for particle in &self.particles {
            kinetic += particle.kinetic();
            heat += particle.heat;
            inverse += 1.0 / self.temperature(particle);
            if particle.mobility > 0.0 {
                moving += 1.0;
                for axis in 0..D {
                    momentum[axis] += particle.velocity[axis] / particle.mobility;
                }
            }
        }
        let drift: f64 = momentum.iter().map(|p| p * p).sum::<f64>() / f64::max(moving, 1.0);
        Totals {
            kinetic,
            // What is still to be given back is no heat.
            heat: heat - self.gained,
            potential: self.potential,
            momentum,
            // One degree of freedom in each direction is the mean velocity's.
            kinetic_temperature: (2.0 * kinetic - drift) / (D as f64 * f64::max(moving - 1.0, 1.0)),
            internal_temperature: count / inverse,
        }
    }
}
