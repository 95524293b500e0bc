//! The liquid of a scene in the units of its particles.

use frazil_core::physics::curve::Curve;
use frazil_core::physics::thermal::Thermal;
use frazil_core::solvers::step::Bound;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_scene::{Numerics, Scene};

use super::ground::SceneMatter;
use super::map::DpdUnits;
use super::place::LiquidBody;
use super::refusals::MotionError;
use super::{Motion, limit};
use crate::fluid::Parameters;

/// A liquid and the body that it fills.
pub struct Liquid {
    /// The scene's material.
    pub thermal: Thermal,
    /// Its units.
    pub map: DpdUnits,
    /// The body.
    pub body: LiquidBody,
    /// Constants of its particles.
    pub parameters: Parameters,
    /// Those with which it comes to rest before the scene begins.
    pub settling: Parameters,
    /// The longest step.
    pub bound: Bound,
    /// Diffusivity of its best conducting phase.
    pub fastest: f64,
    /// Volume of a particle (m3, of missing dimensions by the metre).
    pub volume: f64,
}

impl Liquid {
    /// The liquid of a scene whose particles reach `cutoff_ratio` of their mean distances and hold heat with a `capacity`.
    ///
    /// # Errors
    /// A domain in which particles cannot move.
    pub fn of(
        scene: &Scene,
        numerics: &Numerics,
        motion: &Motion,
        (cutoff_ratio, capacity): (f64, f64),
    ) -> Result<Self, MotionError> {
        let (width, height) = match scene.domain {
            Domain::Line { length } => (length, None),
            Domain::Rectangle { width, height } => (width, Some(height)),
            Domain::Ring { .. } | Domain::Radial { .. } | Domain::Axial { .. } => {
                return Err(MotionError::Domain);
            }
        };
        let thermal = Thermal::new(Curve::new(&scene.materials[0]), scene.initial_temperature);
        let curve = &thermal.curve;
        let diffusivity = curve.mixed_conductivity(1.0) / curve.unfrozen_capacity();
        let map = DpdUnits::new(scene.units, numerics.spacing, motion, diffusivity);
        let diffusivity = diffusivity * map.time / map.length.powi(2);
        let (low, high) = scene.temperature_range();
        let range = (map.temperature(low), map.temperature(high));
        let mut parameters = parameters(motion, cutoff_ratio, capacity, range);
        parameters.heat_friction = parameters.constants(2).heat_friction(diffusivity);
        let bound = limit::bound(&parameters, &map, curve, range, diffusivity);
        parameters.step = limit::SETTLING_STEP.min(bound.step / map.time);
        let fastest = limit::fastest(curve, diffusivity);
        let settling = limit::settling(&parameters, &map, curve, range, diffusivity);
        let strip = height.map_or(motion.strip_width, |height| height / map.length);
        let walled = |along_y: bool| !WallId::ends(along_y).into_iter().all(|wall| scene.is_closed(wall));
        let body = LiquidBody {
            lengths: [width / map.length, strip],
            walled: [walled(false), height.is_some() && walled(true)],
        };
        let missing = if height.is_some() { 1.0 } else { strip * map.length };
        let volume = map.length.powi(2) / motion.number_density / missing;
        Ok(Liquid { thermal, map, body, parameters, settling, bound, fastest, volume })
    }

    /// What heat means to it.
    pub fn ground(&self, numerics: &Numerics) -> SceneMatter {
        let per_heat = self.thermal.curve.unfrozen_capacity() * self.map.degree / self.parameters.heat_capacity;
        let scale = (self.map.zero, self.map.degree);
        SceneMatter::new(self.thermal.clone(), per_heat, scale, (numerics.exchange, numerics.mushy))
    }
}

/// Constants of particles, but for what conducts heat and for the step.
fn parameters(motion: &Motion, cutoff_ratio: f64, capacity: f64, (low, high): (f64, f64)) -> Parameters {
    let cutoff = cutoff_ratio / motion.number_density.sqrt();
    Parameters {
        density: motion.number_density,
        repulsion: motion.repulsion * 0.5 * (low + high),
        friction: motion.friction,
        exponent: motion.exponent.clone(),
        conservative_cutoff: cutoff,
        dissipative_cutoff: cutoff,
        thermal_cutoff: cutoff,
        heat_capacity: capacity,
        heat_friction: 1.0,
        step: limit::SETTLING_STEP,
    }
}
