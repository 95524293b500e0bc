//! A particle that moves.

use frazil_core::saved::{Pass, Saved};

/// One particle. All of it lies together: a pair reads and writes both ends whole.
#[derive(Debug, Clone, Copy)]
pub struct Particle<const D: usize> {
    /// Place in the box, up to half the skin outside of it between two sortings.
    pub position: [f64; D],
    /// Velocity.
    pub velocity: [f64; D],
    /// Conservative force.
    pub force: [f64; D],
    /// Internal energy above that at the reference temperature of the fluid: differences stay exact.
    pub heat: f64,
    /// Inverse mass: 1, or 0 for a particle at rest.
    pub mobility: f64,
    /// Times that it has left the box through each pair of sides.
    pub turns: [i32; D],
    /// Name, the same through all sortings.
    pub name: u32,
}

impl<const D: usize> Saved for Particle<D> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let Particle { position, velocity, force, heat, mobility, turns, name } = self;
        pass.all(&mut [position, velocity, force, heat, mobility, turns, name]);
    }
}

/// What the pairs of a step read of a particle, and do not change.
#[derive(Debug, Clone, Copy)]
pub struct Look<const D: usize, S> {
    /// Place.
    pub position: [f64; D],
    /// Temperature before the pairs of this step.
    pub temperature: f64,
    /// One over it.
    pub coldness: f64,
    /// Half of the exponent of the dissipative weight at that temperature.
    pub half_exponent: f32,
    /// Inverse mass.
    pub mobility: f32,
    /// What its name brings to the random numbers of its pairs.
    pub share: u64,
    /// What else its state means to pairs.
    pub seen: S,
    /// Name.
    pub name: u32,
}

impl<const D: usize> Particle<D> {
    /// Kinetic energy.
    pub fn kinetic(&self) -> f64 {
        if self.mobility > 0.0 { 0.5 * self.velocity.iter().map(|v| v * v).sum::<f64>() / self.mobility } else { 0.0 }
    }
}
