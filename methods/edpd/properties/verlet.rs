//! The integrator of the paper, for comparison: velocity Verlet with friction, noise and heat as explicit forces (Groot and
//! Warren 1997), in the plane.
//!
//! Velocities are guessed as `v + lambda dt f` for the friction of a new place, and corrected with the mean of old and new
//! forces; lambda = 1/2 is plain velocity Verlet. Heat follows eq 8 with the half that the energy of a pair needs. Nothing
//! gives back what a step gains: it shows how much that is. Written to be read, and slow.

use frazil_core::noise::{StepNoise, pair_of};

use crate::fluid::{ConstantCapacity, Fluid, Matter, Parameters, Particle};

/// A fluid under the paper's integrator.
#[derive(Debug, Clone)]
pub struct Verlet {
    parameters: Parameters,
    /// What heat means.
    matter: ConstantCapacity,
    lengths: [f64; 2],
    lambda: f64,
    seed: u64,
    steps: u64,
    particles: Vec<Particle<2>>,
    /// All forces of the last step.
    forces: Vec<[f64; 2]>,
    potential: f64,
}

impl Verlet {
    /// Goes on from a fluid.
    pub fn from(fluid: &Fluid<2>, lambda: f64, seed: u64) -> Self {
        let mut own = Verlet {
            parameters: fluid.parameters().clone(),
            matter: *fluid.matter(),
            lengths: *fluid.lengths(),
            lambda,
            seed,
            steps: 0,
            particles: fluid.particles().to_vec(),
            forces: vec![[0.0; 2]; fluid.particles().len()],
            potential: 0.0,
        };
        let velocities: Vec<[f64; 2]> = own.particles.iter().map(|particle| particle.velocity).collect();
        // Forces at the start; their heat would belong to the step before.
        let heats: Vec<f64> = own.particles.iter().map(|particle| particle.heat).collect();
        own.meet(&velocities);
        own.particles.iter_mut().zip(heats).for_each(|(particle, heat)| particle.heat = heat);
        own
    }

    /// Kinetic energy, heat and potential together.
    pub fn energy(&self) -> f64 {
        self.potential + self.particles.iter().map(|particle| particle.kinetic() + particle.heat).sum::<f64>()
    }

    /// Kinetic temperature over the harmonic mean of the internal ones.
    pub fn temperatures(&self) -> f64 {
        let count = self.particles.len() as f64;
        let kinetic: f64 = self.particles.iter().map(Particle::kinetic).sum();
        let inverse: f64 = self.particles.iter().map(|particle| 1.0 / self.temperature(particle)).sum();
        kinetic / (count - 1.0) * inverse / count
    }

    fn temperature(&self, particle: &Particle<2>) -> f64 {
        self.matter.temperature(particle.heat)
    }

    /// Makes a step.
    pub fn step(&mut self) {
        let step = self.parameters.step;
        let mut guesses = Vec::with_capacity(self.particles.len());
        for (particle, force) in self.particles.iter_mut().zip(&self.forces) {
            let mut guess = particle.velocity;
            for axis in 0..2 {
                let way = step * (particle.velocity[axis] + 0.5 * step * force[axis]);
                particle.position[axis] = (particle.position[axis] + way).rem_euclid(self.lengths[axis]);
                guess[axis] += self.lambda * step * force[axis];
            }
            guesses.push(guess);
        }
        let before = self.forces.clone();
        self.steps += 1;
        self.meet(&guesses);
        for ((particle, old), new) in self.particles.iter_mut().zip(&before).zip(&self.forces) {
            for axis in 0..2 {
                particle.velocity[axis] += 0.5 * step * (old[axis] + new[axis]);
            }
        }
    }

    /// Forces of all pairs, the heat that they exchange and make in a step, and their potential.
    fn meet(&mut self, velocities: &[[f64; 2]]) {
        let (parameters, step) = (self.parameters.clone(), self.parameters.step);
        let noise = StepNoise::new(self.seed, self.steps);
        let reach = parameters.reach();
        let cells = self.lengths.map(|length| ((length / reach) as usize).max(1));
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); cells[0] * cells[1]];
        let cell = |particle: &Particle<2>| {
            [0, 1].map(|axis| {
                let place = particle.position[axis].rem_euclid(self.lengths[axis]) / self.lengths[axis];
                ((place * cells[axis] as f64) as usize).min(cells[axis] - 1)
            })
        };
        for (k, particle) in self.particles.iter().enumerate() {
            let [x, y] = cell(particle);
            members[y * cells[0] + x].push(k);
        }
        let temperatures: Vec<f64> = self.particles.iter().map(|particle| self.temperature(particle)).collect();
        self.forces.iter_mut().for_each(|force| *force = [0.0; 2]);
        self.potential = 0.0;
        for i in 0..self.particles.len() {
            let [x, y] = cell(&self.particles[i]);
            for around in 0..9 {
                let other = [(x + cells[0] + around % 3 - 1) % cells[0], (y + cells[1] + around / 3 - 1) % cells[1]];
                for &j in members[other[1] * cells[0] + other[0]].iter().filter(|j| **j > i) {
                    let mut way = [0.0; 2];
                    for axis in 0..2 {
                        let plain = self.particles[i].position[axis] - self.particles[j].position[axis];
                        way[axis] = plain - self.lengths[axis] * (plain / self.lengths[axis]).round();
                    }
                    let distance = way[0].hypot(way[1]);
                    if distance >= reach || distance == 0.0 {
                        continue;
                    }
                    let way = way.map(|part| part / distance);
                    let speed: f64 = (0..2).map(|axis| way[axis] * (velocities[i][axis] - velocities[j][axis])).sum();
                    let (a, b) = (temperatures[i], temperatures[j]);
                    let names = (self.particles[i].name, self.particles[j].name);
                    let (push, heat) = noise.two(pair_of(names.0, names.1));
                    let (push, heat) = (f64::from(push), f64::from(heat));
                    let near = (1.0 - distance / parameters.conservative_cutoff).max(0.0);
                    self.potential += 0.5 * parameters.repulsion * parameters.conservative_cutoff * near * near;
                    let exponent = 0.5 * (parameters.exponent.at(a) + parameters.exponent.at(b));
                    let weight = (1.0 - distance / parameters.dissipative_cutoff).max(0.0).powf(exponent);
                    let square = 4.0 * parameters.friction * a * b / (a + b);
                    let random = (square * weight / step).sqrt() * push;
                    let force = parameters.repulsion * near - parameters.friction * weight * speed + random;
                    let made = weight * (parameters.friction * speed * speed - square) - random * speed;
                    let warm = (1.0 - distance / parameters.thermal_cutoff).max(0.0).powi(2);
                    let strength = (0.5 * parameters.heat_capacity * (a + b)).powi(2) * parameters.heat_friction * warm;
                    let sign = if names.0 < names.1 { 1.0 } else { -1.0 };
                    let passed = step * strength * (b - a) / (a * b) + (2.0 * strength * step).sqrt() * heat * sign;
                    for axis in 0..2 {
                        self.forces[i][axis] += force * way[axis];
                        self.forces[j][axis] -= force * way[axis];
                    }
                    self.particles[i].heat += 0.5 * step * made + passed;
                    self.particles[j].heat += 0.5 * step * made - passed;
                }
            }
        }
    }
}
