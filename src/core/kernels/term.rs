//! A term beside conduction.

use crate::kernels::runs::Run;
use crate::memory::HeapSize;
use crate::physics::latent_heat::Fields;
use crate::solvers::step::Clock;

/// A term beside conduction: eDPD's random heat flux. Off by type where it is [`Off`].
pub trait PairTerm: HeapSize + Clone + Send + Sync + 'static {
    /// Whether the term needs temperatures and conductivities of particles.
    const ACTIVE: bool;
    /// Prepares the term for a step from a state.
    fn begin(&mut self, fields: &Fields, clock: &Clock);
    /// What the term adds to `weight * conducted`, from partner to particle (W/m3).
    fn add(&self, pair: &PairView<'_>) -> f64;
    /// Turns what the pairs of a run conduct (W/m), from partner to particle, into all that they give the particle (W/m3).
    fn give(&self, run: &Run, fields: &Fields, fluxes: &mut [f64]);
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

    fn begin(&mut self, _fields: &Fields, _clock: &Clock) {}

    #[inline(always)]
    fn add(&self, _pair: &PairView<'_>) -> f64 {
        0.0
    }

    #[inline(always)]
    fn give(&self, run: &Run, _fields: &Fields, fluxes: &mut [f64]) {
        fluxes.iter_mut().for_each(|flux| *flux *= run.weight);
    }
}
