//! A term beside conduction.

use crate::memory::HeapSize;
use crate::physics::latent_heat::Fields;
use crate::solvers::step::Clock;

/// A term beside conduction: eDPD's random heat flux. Off by type where it is [`Off`].
pub trait PairTerm: HeapSize + Clone + Send + Sync + 'static {
    /// Whether the term needs temperatures and conductivities of particles.
    const ACTIVE: bool;
    /// Prepares the term for a step.
    fn begin(&mut self, clock: &Clock);
    /// What the term adds to `weight * conducted`, from partner to particle (W/m3).
    fn add(&self, pair: &PairView<'_>) -> f64;
}

/// A pair as a term sees it.
pub struct PairView<'a> {
    /// Noise names of particle and partner.
    pub names: (u32, u32),
    /// Tells images of one partner apart.
    pub stream: u32,
    /// Weight by volume (m^-2).
    pub weight: f64,
    /// Conducted potential difference (W/m).
    pub conducted: f64,
    /// Least and greatest conductivity (W/mK) of what lies between them, where that is of several materials.
    pub between: Option<(f64, f64)>,
    /// Particle and partner.
    pub indices: (usize, usize),
    /// State.
    pub fields: &'a Fields,
}

/// No term.
#[derive(Debug, Clone, Copy)]
pub struct Off;

impl HeapSize for Off {
    fn heap_size(&self) -> usize {
        0
    }
}

impl PairTerm for Off {
    const ACTIVE: bool = false;

    fn begin(&mut self, _clock: &Clock) {}

    #[inline(always)]
    fn add(&self, _pair: &PairView<'_>) -> f64 {
        0.0
    }
}
