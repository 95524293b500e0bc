//! Where particles that move, and those behind walls, stand at the start: as in a liquid at rest, cut at the walls.
//!
//! A periodic box that holds body and walls is filled and left to itself until it is a liquid; what then lies beyond a wall
//! stays there for good. Its structure is the liquid's: particles placed at random conduct only 0.85 as well.

use std::sync::Arc;

use frazil_core::solvers::moving::Purpose;
use frazil_core::space::wall::WallId;
use rayon::ThreadPool;

use crate::fluid::{Behind, Fluid, FluidError, Parameters, Particle, Undriven};

/// Time that a new liquid is left to itself: several times what its structure needs, of the order of one over the friction
/// rate or the sound's way across a particle.
const SETTLING: f64 = 4.0;

/// Steps that it is left to itself where only the time of a step is asked for: nothing stands on top of another.
const TRIAL_STEPS: u64 = 20;

/// A body between walls or periodic sides.
#[derive(Debug, Clone, Copy)]
pub struct LiquidBody {
    /// Lengths.
    pub lengths: [f64; 2],
    /// Whether there are walls at both ends of each direction; periodic sides if not.
    pub walled: [bool; 2],
}

/// Particles of a body and behind its walls.
pub struct Placed {
    /// Those of the body first, by name.
    pub particles: Vec<Particle<2>>,
    /// Those behind walls, in order.
    pub behind: Vec<Behind<2>>,
    /// Lengths of the periodic box that holds all.
    pub lengths: [f64; 2],
}

/// Fills a body, at a temperature. Patches of particles behind walls are the sides of the walls.
///
/// # Errors
/// A box that is too small, and particles that crowd together before they rest.
pub fn fill(
    body: &LiquidBody,
    parameters: &Parameters,
    temperature: f64,
    seed: u64,
    pool: Option<Arc<ThreadPool>>,
    purpose: Purpose,
) -> Result<Placed, FluidError> {
    let thickness = parameters.reach();
    let margin = body.walled.map(|walled| if walled { thickness } else { 0.0 });
    let mut lengths = body.lengths;
    for axis in 0..2 {
        lengths[axis] += 2.0 * margin[axis];
    }
    let mut liquid = Fluid::new(parameters.clone(), lengths, temperature, seed, pool)?;
    let steps = (SETTLING / parameters.step).ceil() as u64;
    let steps = if purpose == Purpose::Trial { steps.min(TRIAL_STEPS) } else { steps };
    liquid.advance(steps, &Undriven)?;
    let mut particles = Vec::with_capacity(liquid.particles().len());
    let (mut outside, mut behind) = (Vec::new(), Vec::new());
    let mut all = liquid.particles().to_vec();
    all.sort_unstable_by_key(|particle| particle.name);
    for mut particle in all {
        particle.heat = 0.0;
        particle.force = [0.0; 2];
        particle.turns = [0; 2];
        // How far beyond its wall, by direction, and the mirror image.
        let (mut deepest, mut across, mut patch) = (0.0, 0, 0);
        let mut image = particle.position;
        for axis in 0..2 {
            particle.position[axis] = particle.position[axis].rem_euclid(lengths[axis]) - margin[axis];
            let place = particle.position[axis];
            image[axis] = place;
            if !body.walled[axis] {
                continue;
            }
            let (below, above) = (-place, place - body.lengths[axis]);
            if below.max(above) > 0.0 {
                image[axis] = if below > 0.0 { below } else { body.lengths[axis] - above };
                if below.max(above) > deepest {
                    (deepest, across) = (below.max(above), axis);
                    patch = WallId::ends(axis == 1)[usize::from(above > 0.0)].side();
                }
            }
        }
        if deepest > 0.0 {
            particle.velocity = [0.0; 2];
            particle.mobility = 0.0;
            outside.push(particle);
            behind.push(Behind { image, across, depth: deepest, patch: patch as u32 });
        } else {
            particles.push(particle);
        }
    }
    particles.append(&mut outside);
    for (name, particle) in particles.iter_mut().enumerate() {
        particle.name = name as u32;
    }
    Ok(Placed { particles, behind, lengths })
}
