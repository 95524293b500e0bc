//! What pairs at hand do to each other, as far as it follows from places and temperatures alone: worked out in vectors.
//!
//! Conservative forces and their potential are in double precision, for the books of energy take their difference from
//! step to step. Friction, noise and heat are in single precision: what one end loses the other gains, whatever it is, and
//! friction and noise are made of the same number, so that they balance. Ways are not divided by distances, which would
//! have to be as exact as energy is kept: impulses come over the distance, and meet the square of it.

use frazil_core::noise::StepNoise;

use super::power::raise;
use super::scan::MOST;

/// Pairs that a desk has room for.
pub const ROOM: usize = AT_ONCE + MOST;

/// Pairs after which those at hand are worked on.
pub const AT_ONCE: usize = 128;

/// Pairs in a vector, or more.
const VECTOR: usize = 8;

/// Most pairs: none is nearer than the root of this.
const NEAREST: f64 = 1e-30;

/// The constants of a step that pairs act by.
#[derive(Debug)]
pub struct PairConstants {
    /// A distance beyond reach.
    pub far: f64,
    /// One over the cut-off radius of the conservative force, of friction, of heat.
    pub inverse_cutoffs: [f64; 3],
    /// Largest conservative force.
    pub repulsion: f64,
    /// Friction times the step.
    pub friction: f64,
    /// Square of the heat capacity, times the heat friction and the step.
    pub conductance: f64,
    /// Random numbers of the step.
    pub noise: StepNoise,
}

/// Pairs at hand, by column: what is put down of them, and what is worked out.
#[derive(Debug, Clone)]
pub struct PairColumns<const D: usize> {
    /// From the partner to the particle.
    pub ways: [[f64; ROOM]; D],
    /// Exponents of the dissipative weight.
    pub exponents: [f32; ROOM],
    /// Temperatures of both ends.
    pub temperatures: [[f32; ROOM]; 2],
    /// One over the particle's temperature, less that of its partner.
    pub differences: [f32; ROOM],
    /// Inverse masses of both ends together.
    pub mobilities: [f32; ROOM],
    /// Conduction over that of the reference state, where pairs differ.
    pub conductions: [f32; ROOM],
    /// Places in the sequence of random numbers.
    pub draws: [u64; ROOM],
    /// Conservative force over the distance.
    pub forces: [f64; ROOM],
    /// Impulse over the distance: by the velocity of one end against the other times the way, and that of noise.
    pub gains: [f64; ROOM],
    /// See `gains`.
    pub pushed: [f64; ROOM],
    /// Inverse masses times the square of the distance.
    pub inertias: [f64; ROOM],
    /// Heat that the particle takes.
    pub heats: [f64; ROOM],
    nears: [f64; ROOM],
    distances: [f32; ROOM],
    inverse_distances: [f32; ROOM],
    /// Random numbers of the force and of heat.
    random: [[f32; ROOM]; 2],
    /// Gains, pushes and heats before they are widened.
    single: [[f32; ROOM]; 3],
}

impl<const D: usize> Default for PairColumns<D> {
    fn default() -> Self {
        PairColumns {
            ways: [[0.0; ROOM]; D],
            exponents: [0.0; ROOM],
            temperatures: [[1.0; ROOM]; 2],
            differences: [0.0; ROOM],
            mobilities: [0.0; ROOM],
            conductions: [0.0; ROOM],
            draws: [0; ROOM],
            forces: [0.0; ROOM],
            gains: [0.0; ROOM],
            pushed: [0.0; ROOM],
            inertias: [0.0; ROOM],
            heats: [0.0; ROOM],
            nears: [0.0; ROOM],
            distances: [0.0; ROOM],
            inverse_distances: [0.0; ROOM],
            random: [[0.0; ROOM]; 2],
            single: [[0.0; ROOM]; 3],
        }
    }
}

impl<const D: usize> PairColumns<D> {
    /// Works out what the first `count` pairs do; returns their potential. `UNEVEN` pairs conduct each in its own way.
    #[inline(always)]
    pub fn evaluate<const UNEVEN: bool>(&mut self, constants: &PairConstants, count: usize) -> f64 {
        let count = count.min(ROOM);
        // Whole vectors, the last one filled up with pairs out of reach.
        let whole = count.next_multiple_of(VECTOR).min(ROOM);
        self.ways[0][count..whole].fill(constants.far);
        self.conservative_forces(constants, whole);
        self.random_numbers(&constants.noise, whole);
        self.friction_and_heat::<UNEVEN>(constants, whole);
        for (wide, single) in [&mut self.gains, &mut self.pushed, &mut self.heats].into_iter().zip(&self.single) {
            for k in 0..whole {
                wide[k] = f64::from(single[k]);
            }
        }
        let mut sums = [0.0; VECTOR];
        for nears in self.nears[..whole].as_chunks::<VECTOR>().0 {
            for lane in 0..VECTOR {
                sums[lane] += nears[lane];
            }
        }
        sums.iter().sum::<f64>() * 0.5 * constants.repulsion / constants.inverse_cutoffs[0]
    }

    /// Distances and conservative forces.
    #[inline(always)]
    fn conservative_forces(&mut self, constants: &PairConstants, whole: usize) {
        let conservative = constants.inverse_cutoffs[0];
        for k in 0..whole {
            let mut square = NEAREST;
            for axis in 0..D {
                square = self.ways[axis][k].mul_add(self.ways[axis][k], square);
            }
            // A root and a division in single precision and Newton's step, which squares the error, take less time than in double.
            let guess = f64::from(1.0 / (square as f32).sqrt());
            let inverse_distance = guess.mul_add((0.5 * square * guess).mul_add(-guess, 0.5), guess);
            let distance = square * inverse_distance;
            let near = distance.mul_add(-conservative, 1.0).max(0.0);
            self.forces[k] = constants.repulsion * near * inverse_distance;
            self.nears[k] = near * near;
            self.inertias[k] = f64::from(self.mobilities[k]) * square;
            self.distances[k] = distance as f32;
            self.inverse_distances[k] = inverse_distance as f32;
        }
    }

    /// Random numbers.
    #[inline(always)]
    fn random_numbers(&mut self, noise: &StepNoise, whole: usize) {
        for k in 0..whole {
            (self.random[0][k], self.random[1][k]) = noise.two_at(self.draws[k]);
        }
    }

    /// Friction, its noise, and heat.
    #[inline(always)]
    fn friction_and_heat<const UNEVEN: bool>(&mut self, constants: &PairConstants, whole: usize) {
        let [_, dissipative, thermal] = constants.inverse_cutoffs.map(|inverse| inverse as f32);
        let friction = constants.friction as f32;
        let heat_noise = (0.5 * constants.conductance).sqrt() as f32;
        for k in 0..whole {
            let (distance, inverse_distance) = (self.distances[k], self.inverse_distances[k]);
            let (a, b) = (self.temperatures[0][k], self.temperatures[1][k]);
            let sum = a + b;
            // Ends at rest take no impulse, whatever it is.
            let mobility = if self.mobilities[k] > 0.0 { self.mobilities[k] } else { 1.0 };
            let weight = distance.mul_add(-dissipative, 1.0).max(0.0);
            let lost = friction * raise(weight, self.exponents[k]) * mobility;
            // One over c, less one; of it and of one division come `1 - c`, which would lose its digits as a difference,
            // and `(1 - c)/mu` over the sum of temperatures.
            let lost = lost * lost.mul_add(0.5, 1.0);
            let heavy = mobility * sum;
            let slowed_over = lost / (heavy * (1.0 + lost));
            let slowed = slowed_over * heavy;
            self.single[0][k] = -(slowed_over * sum) * (inverse_distance * inverse_distance);
            let variance = 2.0 * (a * b) * slowed_over * (2.0 - slowed);
            self.single[1][k] = variance.sqrt() * (inverse_distance * self.random[0][k]);
            // Noise of heat, whose square is twice what is conducted.
            let warm = heat_noise * sum * distance.mul_add(-thermal, 1.0).max(0.0);
            let warm = if UNEVEN { warm * self.conductions[k].sqrt() } else { warm };
            self.single[2][k] = warm * (0.5 * warm).mul_add(self.differences[k], self.random[1][k]);
        }
    }
}
