//! What acts on moving particles from outside: walls that send them back, a pump, a reset of temperature.

use crate::fluid::{Drive, Particle};

/// Keeps particles between walls.
pub struct Confined {
    /// Lengths of the body.
    pub lengths: [f64; 2],
    /// Whether there are walls at both ends of each direction.
    pub walled: [bool; 2],
}

impl Drive<2> for Confined {
    const WORKS: bool = false;

    #[inline(always)]
    fn act(&self, _particle: &mut Particle<2>, _time: f64) {}

    #[inline(always)]
    fn confine(&self, particle: &mut Particle<2>, time: f64) {
        let beyond = |axis: usize| self.walled[axis] && !(0.0..=self.lengths[axis]).contains(&particle.position[axis]);
        if (beyond(0) || beyond(1)) && particle.mobility > 0.0 {
            // Back the way that it came: no slip at the wall.
            for axis in 0..2 {
                particle.position[axis] -= time * particle.velocity[axis];
                particle.velocity[axis] = -particle.velocity[axis];
            }
        }
    }
}

/// Drives particles along x between walls, and sets some to a temperature.
pub struct Driven {
    /// The walls.
    pub confined: Confined,
    /// Acceleration along x.
    pub acceleration: f64,
    /// Where it acts.
    pub pump: (f64, f64),
    /// Where heat is reset, and to what.
    pub reset: Option<((f64, f64), f64)>,
    /// Name of the first particle behind a wall.
    pub walls_from: u32,
}

impl Drive<2> for Driven {
    #[inline(always)]
    fn act(&self, particle: &mut Particle<2>, time: f64) {
        if particle.name >= self.walls_from {
            return;
        }
        let length = self.confined.lengths[0];
        let x = particle.position[0].rem_euclid(length);
        if particle.mobility > 0.0 && x >= self.pump.0 && x <= self.pump.1 {
            particle.velocity[0] += self.acceleration * time;
        }
        if let Some(((from, to), heat)) = self.reset
            && x >= from
            && x <= to
        {
            particle.heat = heat;
        }
    }

    #[inline(always)]
    fn confine(&self, particle: &mut Particle<2>, time: f64) {
        self.confined.confine(particle, time);
    }
}
