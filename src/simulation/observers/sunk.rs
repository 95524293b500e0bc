//! Pipes in frozen ground: the field of a line around them, which particles hold smoothed.

use std::f64::consts::{PI, TAU};

use frazil_core::boundary::pipe::{PipeCondition, Sink};
use frazil_core::ledger::Ledger;
use frazil_core::particles::Particles;
use frazil_scene::Scene;
use glam::DVec2;

use super::pipe_walls::mean_wall_temperature;
use super::readings::SAME_PLACE;

/// A ring of pipes sunk into particles.
#[derive(Debug, Clone, Default)]
pub(super) struct Sunk {
    pub(super) pipes: Vec<Sink>,
    /// Particles that the heat of its pipes is spread over.
    pub(super) near: Vec<u32>,
}

/// Pipes of a ring in ground that is frozen around them. There the field of a pipe is that of a line sink,
/// `T = T_p + q/(2 pi k) ln(r/r_p)`, but particles hold a smoothed one, over the pipe too.
pub(super) struct FrozenIn<'a> {
    pipes: &'a [Sink],
    /// Radius of the pipes (m); 0 of single particles.
    radius: f64,
    /// Temperature of their walls.
    temperature: f64,
    /// Heat that one of them takes over the conductivity of the ground (K).
    heat: f64,
}

/// Rings that cool ground which is frozen as far as the heat of their pipes is spread.
pub(super) fn frozen_in<'a>(
    rings: &'a [Sunk],
    scene: &Scene,
    particles: &Particles,
    ledger: &Ledger,
    time: f64,
) -> Vec<FrozenIn<'a>> {
    let rings = rings.iter().zip(ledger.rings()).zip(&scene.rings);
    rings
        .filter_map(|((sunk, rate), ring)| {
            let first = *sunk.near.first()? as usize;
            if rate >= 0.0 || !sunk.near.iter().all(|i| particles.frozen_fraction(*i as usize) >= 1.0) {
                return None;
            }
            let share: f64 = sunk.pipes.iter().map(|pipe| pipe.share).sum();
            // The temperature inside the wall, and outside.
            let (inside, pipe) = match &ring.condition {
                PipeCondition::Temperature(series) => (series.at(time), series.at(time)),
                // Behind a film the wall is warmer than the brine.
                PipeCondition::Film { coefficient, brine } => {
                    let brine = brine.at(time);
                    (brine, brine - rate / share * (1.0 / (coefficient * TAU * ring.pipe_radius)))
                }
                PipeCondition::Heat(_) => {
                    let wall = mean_wall_temperature(&sunk.pipes, particles, time);
                    (wall, wall)
                }
            };
            let factor = particles.mean_factor(&sunk.near);
            let conductivity = factor * particles.materials.of(first).curve.conductivity(inside);
            let heat = -rate / share / conductivity;
            Some(FrozenIn { pipes: &sunk.pipes, radius: ring.pipe_radius, temperature: pipe, heat })
        })
        .collect()
}

impl FrozenIn<'_> {
    fn share(&self) -> f64 {
        self.pipes.iter().map(|pipe| pipe.share).sum()
    }

    /// Area of the pipes (m2), in the sector.
    pub(super) fn area(&self) -> f64 {
        self.share() * PI * self.radius * self.radius
    }

    /// By how much the integral of the temperature over all particles is greater than over the ground outside the pipes
    /// (K m2): what smoothing takes off the field, and what the field of a line has inside the pipes.
    pub(super) fn excess(&self) -> f64 {
        let smoothed: f64 = self.pipes.iter().map(|pipe| pipe.share * pipe.extent.smoothing).sum();
        let inside = self.area() * self.temperature - self.share() * 0.25 * self.heat * self.radius * self.radius;
        self.heat * smoothed + inside
    }

    /// Puts pipes and the field around them where readings at radii of a ray through their axes are smoothed.
    pub(super) fn sharpen(&self, direction: DVec2, radii: &[f64], temperature: &mut [f64]) {
        for pipe in self.pipes.iter().map(|pipe| pipe.extent).filter(|_| self.radius > 0.0) {
            let axis = pipe.centre.dot(direction);
            if axis <= 0.0 || pipe.centre.distance(axis * direction) > SAME_PLACE * axis {
                continue;
            }
            // Beyond the particles that the heat is spread over the field is that of a line.
            for side in [-1.0, 1.0] {
                let far = |radius: f64| side * (radius - axis) >= pipe.half_width;
                let edge = match side < 0.0 {
                    true => radii.iter().rposition(|radius| far(*radius)),
                    false => radii.iter().position(|radius| far(*radius)),
                };
                let Some(edge) = edge else { continue };
                let width = (radii[edge] - axis).abs();
                let slope = (temperature[edge] - self.temperature) / (width / self.radius).ln();
                for (radius, temperature) in radii.iter().zip(temperature.iter_mut()) {
                    let distance = side * (radius - axis);
                    if (0.0..width).contains(&distance) {
                        *temperature = self.temperature + slope * (distance / self.radius).ln().max(0.0);
                    }
                }
            }
        }
    }
}
