//! A particle that moves.

use frazil_core::saved::{Pass, Saved};

/// One particle. All of it lies together: a pair reads and writes both ends whole.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Particle<const D: usize> {
    /// Velocity.
    pub velocity: [f64; D],
    /// Internal energy above that at the reference temperature of the fluid: differences stay exact.
    pub heat: f64,
    /// Inverse mass: 1, or 0 for a particle at rest.
    pub mobility: f64,
    /// Conservative force.
    pub force: [f64; D],
    /// Place in the box, up to half the skin outside of it between two sortings.
    pub position: [f64; D],
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
#[repr(C)]
pub struct Look<const D: usize, S> {
    /// Place.
    pub position: [f64; D],
    /// One over the temperature before the pairs of this step.
    pub coldness: f64,
    /// That temperature, in single precision.
    pub single_temperature: f32,
    /// Half of the exponent of the dissipative weight at that temperature.
    pub half_exponent: f32,
    /// Inverse mass.
    pub mobility: f32,
    /// Name.
    pub name: u32,
    /// Temperature before the pairs of this step.
    pub temperature: f64,
    /// What else its state means to pairs.
    pub seen: S,
}

impl<const D: usize, S> Look<D, S> {
    /// Place and coldness, and what comes after them.
    #[inline(always)]
    pub fn wide(&self) -> &[f64; 4] {
        const { assert!(D == 2 || D == 3) }
        // SAFETY: `repr(C)`: `D + 1` numbers in double precision, and two in single precision after them, without gaps.
        unsafe { &*std::ptr::from_ref(self).cast() }
    }

    /// Temperature, half of the exponent, inverse mass, and the bits of the name.
    #[inline(always)]
    pub fn single(&self) -> &[f32; 4] {
        // SAFETY: `repr(C)`: three numbers in single precision and a name, without gaps; a number may have any bits.
        unsafe { &*(&raw const self.single_temperature).cast() }
    }
}

impl<const D: usize> Particle<D> {
    /// Velocity and heat, and what comes after them.
    #[inline(always)]
    pub fn motion(&mut self) -> &mut [f64; 4] {
        const { assert!(D == 2 || D == 3) }
        // SAFETY: `repr(C)`: these are `2 D + 2` numbers one after the other, from the first on.
        unsafe { &mut *std::ptr::from_mut(self).cast() }
    }

    /// Force, and what comes after it.
    #[inline(always)]
    pub fn pushed(&mut self) -> &mut [f64; 4] {
        const { assert!(D == 2 || D == 3) }
        // SAFETY: `repr(C)`: after velocity, heat and mobility there are `2 D` numbers one after the other.
        unsafe { &mut *std::ptr::from_mut(self).cast::<f64>().add(D + 2).cast() }
    }

    /// Kinetic energy.
    pub fn kinetic(&self) -> f64 {
        if self.mobility > 0.0 { 0.5 * self.velocity.iter().map(|v| v * v).sum::<f64>() / self.mobility } else { 0.0 }
    }
}
