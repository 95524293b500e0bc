//! Where the particles of a fluid begin.

use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};

use super::particle::Particle;

/// Particles near the points of a lattice that fits the box, with the velocities of a temperature and no momentum together.
pub fn placed<const D: usize>(lengths: &[f64; D], count: usize, temperature: f64, seed: u64) -> Vec<Particle<D>> {
    let mut random = StdRng::seed_from_u64(seed);
    let volume: f64 = lengths.iter().product();
    let spacing = (volume / count.max(1) as f64).powf(1.0 / D as f64);
    let along = lengths.map(|length| (length / spacing).ceil().max(1.0) as usize);
    let points: usize = along.iter().product();
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let mut particles = Vec::with_capacity(count);
    for name in 0..count {
        // Of more points than particles some stay empty, evenly.
        let mut rest = name * points / count;
        let mut position = [0.0; D];
        let mut velocity = [0.0; D];
        for axis in 0..D {
            let cell = lengths[axis] / along[axis] as f64;
            position[axis] = ((rest % along[axis]) as f64 + 0.5 + 0.05 * normal()) * cell;
            rest /= along[axis];
            velocity[axis] = temperature.sqrt() * normal();
        }
        particles.push(Particle {
            position,
            velocity,
            force: [0.0; D],
            heat: 0.0,
            mobility: 1.0,
            turns: [0; D],
            name: name as u32,
        });
    }
    for axis in 0..D {
        let mean = particles.iter().map(|particle| particle.velocity[axis]).sum::<f64>() / count.max(1) as f64;
        for particle in &mut particles {
            particle.velocity[axis] -= mean;
        }
    }
    particles
}
