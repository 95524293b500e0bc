//! Rain on ground that may be full, and faces at which water seeps out.
//!
//! Water enters no faster than it rains, and the head at the wall rises no higher than water stands on it: either all rain
//! enters, or the head is the greatest and the rest runs off. Of both fluxes, that of the rain and that of the greatest head, the
//! lesser is the one. It falls as the ground gets wetter, so there is one flux for each state, whichever of both it is. A face
//! at which water seeps out has no rain and no head above that of air.

use crate::physics::curve::Curve;

/// Relative step of a place by which a conductivity is differentiated.
const STEP: f64 = 1e-6;

/// A wall with a greatest flux and a greatest head at one instant, by potentials relative to the initial state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Runoff {
    /// Rain: the greatest flux into the body (m/s).
    pub rain: f64,
    /// Potential (m2/s) of the greatest head.
    pub wall: f64,
    /// Its place on the scale of heads.
    pub place: f64,
    /// Depths of a ghost that water passes behind the wall: one to a mirror, and all of two to a layer of one value.
    pub through: f64,
    /// How much of gravity pulls into the body here: 1 at its top, -1 below it.
    pub falls: f64,
}

/// The flux into the body of the greatest head, times the depth it is over, and how that follows the potential of the particle.
struct Full {
    conducted: f64,
    slope: f64,
}

impl Runoff {
    /// Flux into the body (m/s) before a particle of this potential (relative, m2/s) at a depth (m).
    pub fn flux(&self, potential: f64, depth: f64, curve: &Curve, zero_potential: f64) -> f64 {
        self.rain.min(self.full(potential, depth, curve, zero_potential).conducted / depth)
    }

    /// How the flux follows the potential (1/m).
    pub fn slope(&self, potential: f64, depth: f64, curve: &Curve, zero_potential: f64) -> f64 {
        let Full { conducted, slope } = self.full(potential, depth, curve, zero_potential);
        if self.rain * depth < conducted { 0.0 } else { slope / depth }
    }

    /// The same where water follows a difference of heads by one conductivity (m/s): no gravity pulls there.
    pub fn flux_by_head(&self, inside: f64, conductivity: f64, depth: f64, curve: &Curve) -> f64 {
        self.rain.min(conductivity * (curve.driver(self.place) - inside) / depth)
    }

    /// Whether the greatest head holds before a particle of this head.
    pub fn is_full(&self, inside: f64, conductivity: f64, depth: f64, curve: &Curve) -> bool {
        self.flux_by_head(inside, conductivity, depth, curve) < self.rain
    }

    /// The upper end hands down water as along a pair, with a mean of the conductivities of both ends as far as their potentials
    /// even out what that leaves.
    fn full(&self, potential: f64, depth: f64, curve: &Curve, zero_potential: f64) -> Full {
        let plain = Full { conducted: self.wall - potential, slope: -1.0 };
        let Some(moisture) = curve.moisture().filter(|_| self.falls != 0.0) else { return plain };
        let place = moisture.place_of_potential(potential + zero_potential);
        let (own, wall) = (moisture.hydraulic_conductivity(place), moisture.hydraulic_conductivity(self.place));
        let height = self.falls.abs() * depth;
        let above = self.falls > 0.0;
        let upper = if above { wall } else { own };
        let rest = 0.5 * height * (wall - own) * self.falls.signum();
        let evens = (self.wall - potential).abs();
        let down = height * upper - rest.clamp(-evens, evens);
        let conducted = plain.conducted + self.falls.signum() * down;
        let by_own = if place < 0.0 {
            let step = STEP * (1.0 - place);
            let beside = place - step;
            let run = moisture.potential(place) - moisture.potential(beside);
            if run > 0.0 { (own - moisture.hydraulic_conductivity(beside)) / run } else { 0.0 }
        } else {
            0.0
        };
        let slope = match (rest.abs() <= evens, above) {
            (true, _) => -1.0 + self.falls.signum() * 0.5 * height * by_own,
            (false, true) => 0.0,
            (false, false) => -height * by_own,
        };
        Full { conducted, slope: slope.min(0.0) }
    }
}
