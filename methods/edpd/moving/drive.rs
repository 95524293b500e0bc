//! What acts on moving particles from outside: walls that send them back, a pump, a reset of temperature.

use frazil_scene::Stream;

use super::ground::SceneMatter;
use super::map::DpdUnits;
use super::place::LiquidBody;
use crate::fluid::{Drive, Particle};

/// Keeps particles between the walls of a body.
pub struct Confined(pub LiquidBody);

impl Drive<2> for Confined {
    const WORKS: bool = false;

    #[inline(always)]
    fn confine(&self, particle: &mut Particle<2>, time: f64) {
        let LiquidBody { lengths, walled } = &self.0;
        let beyond = |axis: usize| walled[axis] && !(0.0..=lengths[axis]).contains(&particle.position[axis]);
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
pub struct StreamDrive {
    /// The walls.
    confined: Confined,
    /// Acceleration along x.
    acceleration: f64,
    /// Where it acts.
    pump: (f64, f64),
    /// Where heat is reset, and to what.
    reset: Option<((f64, f64), f64)>,
    /// Name of the first particle behind a wall.
    walls_from: u32,
}

impl StreamDrive {
    /// What a stream does to particles of a ground, of which those from a name on stand behind walls.
    pub fn of(stream: &Stream, confined: Confined, map: &DpdUnits, ground: &SceneMatter, walls_from: u32) -> Self {
        let scaled = |(from, to): (f64, f64)| (from / map.length, to / map.length);
        StreamDrive {
            acceleration: stream.acceleration * map.time * map.time / map.length,
            pump: stream.pump.map_or((0.0, confined.0.lengths[0]), scaled),
            reset: stream.reset.map(|(range, temperature)| (scaled(range), ground.heat(temperature))),
            confined,
            walls_from,
        }
    }
}

impl Drive<2> for StreamDrive {
    #[inline(always)]
    fn act(&self, particle: &mut Particle<2>, time: f64) {
        if particle.name >= self.walls_from {
            return;
        }
        let length = self.confined.0.lengths[0];
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
