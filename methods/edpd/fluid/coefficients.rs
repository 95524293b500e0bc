//! Coefficients of the forces and heats of pairs, from positions and temperatures, in vectors.
//!
//! Conservative forces and their potential are in double precision, because the energy balance takes their difference from
//! step to step. Friction, noise and heat are in single precision: both ends receive opposite impulses and heats, and the noise
//! is computed from the rounded friction, so that they balance. Displacements are not divided by distances, which would have to
//! be as exact as the energy balance: impulses are given over the distance and multiplied by its square.
//!
//! Loops are short, so that several vectors are on their way at once. All but the one that rounds read and write numbers of one
//! width: so a compiler knows that columns do not overlap, and takes the widest vectors.

use frazil_core::noise::StepNoise;

use super::power::raise;
use super::scan::NOTED;

/// Pairs that a desk has room for: those at hand, those noted of one particle, and the rest of a vector.
pub const ROOM: usize = AT_ONCE + NOTED + VECTOR;

/// Pairs after which those at hand are worked on.
pub const AT_ONCE: usize = 128;

/// Pairs in a vector of single precision.
const VECTOR: usize = 16;

/// Pairs in a vector of double precision.
const WIDE_VECTOR: usize = 8;

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
#[repr(align(64))]
pub struct PairColumns<const D: usize> {
    /// Displacement from the partner to the particle.
    pub displacements: [[f64; ROOM]; D],
    /// Exponents of the dissipative weight, then that weight.
    pub weights: [f32; ROOM],
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
    /// Squares of the distance.
    pub squares: [f64; ROOM],
    /// Impulse of friction over the distance, by the relative velocity along the displacement times the distance.
    pub friction_impulses: [f32; ROOM],
    /// Impulse of noise over the distance.
    pub noise_impulses: [f32; ROOM],
    /// Heat that the particle takes.
    pub heats: [f32; ROOM],
    /// One over the distance.
    inverses: [f64; ROOM],
    /// Squares of the weight of the conservative force.
    squared_weights: [f64; ROOM],
    distances: [f32; ROOM],
    inverse_distances: [f32; ROOM],
    /// Random numbers of the force and of heat.
    random: [[f32; ROOM]; 2],
}

impl<const D: usize> Default for PairColumns<D> {
    fn default() -> Self {
        PairColumns {
            displacements: [[0.0; ROOM]; D],
            weights: [0.0; ROOM],
            temperatures: [[1.0; ROOM]; 2],
            differences: [0.0; ROOM],
            mobilities: [0.0; ROOM],
            conductions: [0.0; ROOM],
            names: [[0.0; ROOM]; 2],
            forces: [0.0; ROOM],
            friction_impulses: [0.0; ROOM],
            noise_impulses: [0.0; ROOM],
            squares: [0.0; ROOM],
            inverses: [0.0; ROOM],
            heats: [0.0; ROOM],
            squared_weights: [0.0; ROOM],
            distances: [0.0; ROOM],
            inverse_distances: [0.0; ROOM],
            random: [[0.0; ROOM]; 2],
        }
    }
}

impl<const D: usize> PairColumns<D> {
    /// Computes the coefficients of the first `count` pairs; returns their potential. The conductivities of `UNEVEN` pairs differ.
    #[inline(always)]
    pub fn evaluate<const UNEVEN: bool>(&mut self, constants: &PairConstants, count: usize) -> f64 {
        let count = count.min(ROOM);
        // Whole vectors, the last one filled up with pairs out of reach.
        let whole = (count.div_ceil(VECTOR) * VECTOR).min(ROOM);
        self.displacements[0][count..whole].fill(constants.far);
        let squares = self.conservative_forces(constants, whole);
        self.random_numbers(&constants.noise, whole);
        self.dissipative_weights(constants, whole);
        self.friction(constants, whole);
        self.heat::<UNEVEN>(constants, whole);
        squares * 0.5 * constants.repulsion / constants.inverse_cutoffs[0]
    }

    /// Distances and conservative forces; returns the sum of the squares of their weights.
    #[inline(always)]
    fn conservative_forces(&mut self, constants: &PairConstants, whole: usize) -> f64 {
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
            self.squares[k] = square;
            self.inverses[k] = inverse_distance;
        }
        for k in 0..whole {
            self.distances[k] = (self.squares[k] * self.inverses[k]) as f32;
            self.inverse_distances[k] = self.inverses[k] as f32;
        }
        let mut sums = [0.0; WIDE_VECTOR];
        for weights in self.squared_weights[..whole].as_chunks::<WIDE_VECTOR>().0 {
            for lane in 0..WIDE_VECTOR {
                sums[lane] += weights[lane];
            }
        }
        sums.iter().sum()
    }

    /// Random numbers.
    #[inline(always)]
    fn random_numbers(&mut self, noise: &StepNoise, whole: usize) {
        let [mine, theirs] = self.names.each_ref().map(|names| &names[..whole]);
        let [of_force, of_heat] = self.random.each_mut().map(|random| &mut random[..whole]);
        for k in 0..whole {
            let pair = u64::from(mine[k].to_bits()) << 32 | u64::from(theirs[k].to_bits());
            (of_force[k], of_heat[k]) = noise.two(pair);
        }
    }

    /// Dissipative weights, in place of their exponents.
    #[inline(always)]
    fn dissipative_weights(&mut self, constants: &PairConstants, whole: usize) {
        let dissipative = constants.inverse_cutoffs[1] as f32;
        for k in 0..whole {
            let near = self.distances[k].mul_add(-dissipative, 1.0).max(0.0);
            self.weights[k] = raise(near, self.weights[k]);
        }
    }

    /// Friction and its noise.
    #[inline(always)]
    fn friction(&mut self, constants: &PairConstants, whole: usize) {
        let friction = constants.friction as f32;
        for k in 0..whole {
            let inverse_distance = self.inverse_distances[k];
            let (a, b) = (self.temperatures[0][k], self.temperatures[1][k]);
            let sum = a + b;
            // Ends at rest take no impulse, whatever it is.
            let mobility = if self.mobilities[k] > 0.0 { self.mobilities[k] } else { 1.0 };
            let lost = friction * self.weights[k] * mobility;
            // One over c, less one; of it and of one division come `1 - c`, which would lose its digits as a difference,
            // and `(1 - c)/mu` over the sum of temperatures.
            let lost = lost * lost.mul_add(0.5, 1.0);
            let heavy = mobility * sum;
            let slowed_over = lost / (heavy * (1.0 + lost));
            let slowed = slowed_over * heavy;
            self.friction_impulses[k] = -(slowed_over * sum) * (inverse_distance * inverse_distance);
            let variance = 2.0 * (a * b) * slowed_over * (2.0 - slowed);
            self.noise_impulses[k] = variance.sqrt() * (inverse_distance * self.random[0][k]);
        }
    }

    /// Heat.
    #[inline(always)]
    fn heat<const UNEVEN: bool>(&mut self, constants: &PairConstants, whole: usize) {
        let thermal = constants.inverse_cutoffs[2] as f32;
        let heat_noise = (0.5 * constants.conductance).sqrt() as f32;
        for k in 0..whole {
            let sum = self.temperatures[0][k] + self.temperatures[1][k];
            // Noise of heat, whose square is twice what is conducted.
            let warm = heat_noise * sum * self.distances[k].mul_add(-thermal, 1.0).max(0.0);
            let warm = if UNEVEN { warm * self.conductions[k].sqrt() } else { warm };
            self.heats[k] = warm * (0.5 * warm).mul_add(self.differences[k], self.random[1][k]);
        }
    }
}
