//! Scenes whose liquid particles move.
//!
//! The scene is mapped to DPD units: the mean distance of particles is the spacing, a temperature of 1 is 300 K, and time
//! is such that the liquid has the wanted thermal diffusivity; so Fourier and Stefan numbers are the scene's. Particles come
//! to rest when all of them is frozen and move again when nothing is. Walls are layers of particles at rest
//! ([`crate::fluid::walls`]); what drifts into them is sent back the way it came. Opposite sides that are both planes of
//! symmetry are joined to a period instead.

mod drive;
mod ground;
mod limit;
mod liquid;
mod map;
mod method;
mod patches;
mod place;
mod refusals;
mod settings;

use std::sync::Arc;

use frazil_core::solvers::moving::{ParticleSet, Purpose};
use frazil_core::solvers::solver::Solver;
use frazil_scene::method::MethodSettings;
use frazil_scene::region::Cell;
use frazil_scene::{Scene, Stream};
use glam::DVec2;
use rayon::ThreadPool;

use crate::fluid::{Exponent, Fluid, Particle, Walls};
use drive::{Confined, StreamDrive};
use ground::SceneMatter;
use liquid::Liquid;
use map::DpdUnits;
use method::MovingParticles;
use patches::WallPatches;
use place::{Placed, fill};

pub use refusals::MotionError;
pub use settings::{Motion, read};

/// Particles and method of a scene with motion.
///
/// # Errors
/// What the method cannot represent, by key.
pub fn build(
    scene: &Scene,
    settings: &MethodSettings,
    (motion, cutoff_ratio, capacity): (&Motion, f64, f64),
    pool: Option<Arc<ThreadPool>>,
    seed: u64,
    purpose: Purpose,
) -> Result<ParticleSet, MotionError> {
    let numerics = &settings.numerics;
    let liquid = Liquid::of(scene, numerics, motion, (cutoff_ratio, capacity))?;
    refusals::refuse(scene)?;
    let ground = liquid.ground(numerics);
    let (map, body) = (liquid.map, liquid.body);
    let start = map.temperature(scene.initial_temperature);
    let Placed { mut particles, mut behind, lengths } =
        fill(&body, &liquid.settling, start, seed, pool.clone(), purpose)?;
    let count = particles.len() - behind.len();
    if scene.has_uneven_start() {
        warm(scene, numerics.spacing, &map, &ground, &mut particles[..count]);
    }
    if let Some(stream) = &scene.stream {
        set_flowing(stream, &map, body.lengths[1], &mut particles[..count]);
    }
    let per_heat = ground.per_heat();
    let enthalpy = particles[..count].iter().map(|particle| particle.heat * per_heat).collect();
    let patches = WallPatches::of(scene, &body, &map, &mut behind);
    let walls = Walls::new(
        count as u32,
        behind,
        patches.ids.len(),
        (liquid.parameters.thermal_cutoff, liquid.fastest, liquid.parameters.heat_neighbours()),
    );
    let walls = body.walled.contains(&true).then_some(walls);
    let shut = scene.stream.as_ref().map(|_| 0);
    let fluid = Fluid::assembled(liquid.parameters, lengths, ground, particles, walls, shut, seed, pool)?;
    let differences = vec![map.words(scene.units), words(&fluid, count)];
    let confined = Confined(body);
    let (joule, bound) = (per_heat * liquid.volume, liquid.bound);
    let method: Box<dyn Solver> = match &scene.stream {
        None => Box::new(MovingParticles::new(fluid, confined, map, &patches, joule, bound)),
        Some(stream) => {
            let driven = StreamDrive::of(stream, confined, &map, fluid.matter(), count as u32);
            Box::new(MovingParticles::new(fluid, driven, map, &patches, joule, bound))
        }
    };
    Ok(ParticleSet { thermal: liquid.thermal, enthalpy, volume: liquid.volume, differences, method })
}

/// Gives particles the heat of the regions in which they start.
fn warm(scene: &Scene, spacing: f64, map: &DpdUnits, ground: &SceneMatter, particles: &mut [Particle<2>]) {
    for particle in particles {
        let place = DVec2::from_array(particle.position) * map.length;
        let parts = scene.starts_in(&Cell::around(place, spacing));
        particle.heat = parts.into_iter().map(|(temperature, share)| share * ground.heat(temperature)).sum();
    }
}

/// Lets particles start with the parabola of velocities of a stream between walls.
fn set_flowing(stream: &Stream, map: &DpdUnits, width: f64, particles: &mut [Particle<2>]) {
    let half = 0.5 * width;
    for particle in particles {
        let across = particle.position[1] / half - 1.0;
        particle.velocity[0] += stream.start_speed * map.time / map.length * (1.0 - across * across);
    }
}

fn words(fluid: &Fluid<2, SceneMatter>, count: usize) -> String {
    let behind = fluid.particles().len() - count;
    match &fluid.parameters().exponent {
        Exponent::Constant(value) => format!("{behind} particles behind walls; exponent of friction {value}"),
        Exponent::Table(rows) => {
            format!("{behind} particles behind walls; exponent of friction from a table of {} rows", rows.len())
        }
    }
}
