//! Coefficients of the forces and heats of pairs, from positions and temperatures, in vectors.
//!
//! Conservative forces and their potential are in double precision, because the energy balance takes their difference from
//! step to step. Friction, noise and heat are in single precision: both ends receive opposite impulses and heats, and the noise
//! is computed from the rounded friction, so that they balance. Displacements are not divided by distances, which would have to
//! be as exact as the energy balance: impulses are given over the distance and multiplied by its square.

use frazil_core::noise::StepNoise;

use super::power::raise;
use super::scan::MOST;

/// Pairs that a desk has room for: those found, and the rest of a vector.
pub const ROOM: usize = AT_ONCE + MOST + VECTOR;

/// Pairs after which those at hand are worked on.
pub const AT_ONCE: usize = 128;

/// Pairs in a vector, or more.
const VECTOR: usize = 8;

/// Square of the least distance: pairs that are closer act as at this one.
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

/// Pairs by column: their input, and the coefficients.
#[derive(Debug, Clone)]
pub struct PairColumns<const D: usize> {
    /// Displacement from the partner to the particle.
    pub displacements: [[f64; ROOM]; D],
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
    /// Bits of the names of both ends.
    pub names: [[f32; ROOM]; 2],
    /// Conservative force over the distance.
    pub forces: [f64; ROOM],
    /// Impulse of friction over the distance, by the relative velocity along the displacement times the distance.
    pub friction_impulses: [f64; ROOM],
    /// Impulse of noise over the distance.
    pub noise_impulses: [f64; ROOM],
    /// Inverse masses times the square of the distance.
    pub inertias: [f64; ROOM],
    /// Heat that the particle takes.
    pub heats: [f64; ROOM],
    /// Squares of the weight of the conservative force.
    squared_weights: [f64; ROOM],
    distances: [f32; ROOM],
    inverse_distances: [f32; ROOM],
    /// Random numbers of the force and of heat.
    random: [[f32; ROOM]; 2],
    /// Impulses of friction and noise, and heats, in single precision.
    single: [[f32; ROOM]; 3],
}

impl<const D: usize> Default for PairColumns<D> {
    fn default() -> Self {
        PairColumns {
            displacements: [[0.0; ROOM]; D],
            exponents: [0.0; ROOM],
            temperatures: [[1.0; ROOM]; 2],
            differences: [0.0; ROOM],
            mobilities: [0.0; ROOM],
            conductions: [0.0; ROOM],
            names: [[0.0; ROOM]; 2],
            forces: [0.0; ROOM],
            friction_impulses: [0.0; ROOM],
            noise_impulses: [0.0; ROOM],
            inertias: [0.0; ROOM],
            heats: [0.0; ROOM],
            squared_weights: [0.0; ROOM],
            distances: [0.0; ROOM],
            inverse_distances: [0.0; ROOM],
            random: [[0.0; ROOM]; 2],
            single: [[0.0; ROOM]; 3],
        }
    }
}

impl<const D: usize> PairColumns<D> {
    /// Computes the coefficients of the first `count` pairs; returns their potential. The conductivities of `UNEVEN` pairs differ.
    #[inline(always)]
    pub fn evaluate<const UNEVEN: bool>(&mut self, constants: &PairConstants, count: usize) -> f64 {
        let count = count.min(ROOM);
        // Whole vectors, the last one filled up with pairs out of reach.
        let whole = count.next_multiple_of(VECTOR).min(ROOM);
        self.displacements[0][count..whole].fill(constants.far);
        self.conservative_forces(constants, whole);
        self.random_numbers(&constants.noise, whole);
        self.friction_and_heat::<UNEVEN>(constants, whole);
        for (wide, single) in
            [&mut self.friction_impulses, &mut self.noise_impulses, &mut self.heats].into_iter().zip(&self.single)
        {
            for k in 0..whole {
                wide[k] = f64::from(single[k]);
            }
        }
        let mut sums = [0.0; VECTOR];
        for weights in self.squared_weights[..whole].as_chunks::<VECTOR>().0 {
            for lane in 0..VECTOR {
                sums[lane] += weights[lane];
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
                square = self.displacements[axis][k].mul_add(self.displacements[axis][k], square);
            }
            // A root and a division in single precision and Newton's step, which squares the error, take less time than in double.
            let guess = f64::from(1.0 / (square as f32).sqrt());
            let inverse_distance = guess.mul_add((0.5 * square * guess).mul_add(-guess, 0.5), guess);
            let distance = square * inverse_distance;
            let near = distance.mul_add(-conservative, 1.0).max(0.0);
            self.forces[k] = constants.repulsion * near * inverse_distance;
            self.squared_weights[k] = near * near;
            self.inertias[k] = f64::from(self.mobilities[k]) * square;
            self.distances[k] = distance as f32;
            self.inverse_distances[k] = inverse_distance as f32;
        }
    }

    /// Random numbers.
    #[inline(always)]
    fn random_numbers(&mut self, noise: &StepNoise, whole: usize) {
        for k in 0..whole {
            let [me, other] = self.names.each_ref().map(|names| u64::from(names[k].to_bits()));
            (self.random[0][k], self.random[1][k]) = noise.two(me << 32 | other);
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
