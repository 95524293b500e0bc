//! What the heat of a particle means: temperature, conduction, and whether it is frozen to the spot.

/// The relation of heat to everything that pairs read of it.
pub trait Matter: Send + Sync {
    /// What pairs read beside temperature.
    type Seen: Copy + Send + Sync;
    /// Whether states differ in more than temperature: pairs conduct differently, and particles freeze to the spot.
    const UNEVEN: bool;

    /// Temperature of a particle that holds some heat.
    fn temperature(&self, heat: f64) -> f64;
    /// What pairs read of it; `moves` says whether it does.
    fn see(&self, heat: f64, moves: bool) -> Self::Seen;
    /// Conduction of a pair over that of the reference state, by what is seen of both ends and their temperatures.
    fn between(&self, ends: [(Self::Seen, f64); 2]) -> f64;
    /// Whether all of a particle is frozen.
    fn is_frozen(&self, _heat: f64) -> bool {
        false
    }
    /// Whether nothing of a particle is frozen.
    fn is_liquid(&self, _heat: f64) -> bool {
        true
    }
    /// What pairs read of a particle at a temperature.
    fn see_at(&self, temperature: f64) -> Self::Seen;
}

/// A liquid of one heat capacity and conductivity.
#[derive(Debug, Clone, Copy)]
pub struct ConstantCapacity {
    /// Temperature without heat.
    pub reference: f64,
    /// Heat capacity of a particle.
    pub heat_capacity: f64,
}

impl Matter for ConstantCapacity {
    type Seen = ();
    const UNEVEN: bool = false;

    #[inline(always)]
    fn temperature(&self, heat: f64) -> f64 {
        self.reference + heat / self.heat_capacity
    }

    #[inline(always)]
    fn see(&self, _heat: f64, _moves: bool) {}

    #[inline(always)]
    fn between(&self, _ends: [((), f64); 2]) -> f64 {
        1.0
    }

    fn see_at(&self, _temperature: f64) {}
}
