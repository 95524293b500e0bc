//! The random part of the exchange of heat between particles at rest.
//!
//! It is in single precision, which noise cannot be told from more by; both ends of a pair take the same number, so heat is
//! conserved all the same.

use std::sync::Arc;

use frazil_core::kernels::runs::{Run, both};
use frazil_core::kernels::term::{PairTerm, PairView};
use frazil_core::memory::HeapSize;
use frazil_core::noise::{StepNoise, pair_of};
use frazil_core::physics::latent_heat::Fields;
use frazil_core::solvers::assembly::Assembly;
use frazil_core::solvers::step::Clock;

/// The random part of the heat exchange.
#[derive(Debug, Clone)]
pub(crate) struct RandomFlux {
    seed: u64,
    /// Temperature of absolute zero on the scale of the scene.
    absolute_zero: f64,
    /// 2 k_B over the volume of a particle (J/K per m^d).
    twice_boltzmann_per_volume: f64,
    /// The same by particle and ghost, where they store different heat; empty where all are alike.
    by_particle: Arc<[f64]>,
    noise: StepNoise,
    /// Length of the step (s).
    step: f64,
    /// Roots of absolute temperatures, by particle and ghost.
    roots: Vec<f32>,
    /// Conductivities (W/mK), likewise.
    conductivities: Vec<f32>,
}

impl RandomFlux {
    /// Noise of the particles of an assembly that store `capacity` k_B each.
    pub(crate) fn new(assembly: &Assembly, capacity: f64) -> Self {
        let parts = &assembly.parts;
        let materials = &parts.materials;
        let volume = parts.volumes.of(0);
        let boltzmann = materials.thermals[0].curve.unfrozen_capacity() * volume / capacity;
        let count = parts.positions.len();
        let own = |i: usize| 2.0 * materials.of(i).curve.unfrozen_capacity() / capacity;
        let ghosts = parts.ghosts.model.iter().map(|model| *model as usize);
        let alike = !materials.mixed();
        let total = count + parts.ghosts.len();
        RandomFlux {
            seed: assembly.seed,
            absolute_zero: assembly.absolute_zero,
            twice_boltzmann_per_volume: 2.0 * boltzmann / volume,
            by_particle: if alike { Arc::new([]) } else { (0..count).chain(ghosts).map(own).collect() },
            noise: StepNoise::new(assembly.seed, 0),
            step: 0.0,
            roots: vec![0.0; total],
            conductivities: vec![0.0; total],
        }
    }

    /// Root of the variance (W2/m6) over conductivity and both absolute temperatures of a pair of some weight.
    #[inline(always)]
    fn amplitude(&self, twice_boltzmann: f64, weight: f64) -> f32 {
        (twice_boltzmann / self.step * weight).max(0.0).sqrt() as f32
    }
}

/// Conductivity that a pair conducts with: the integral mean between its two temperatures, what it conducts over their
/// difference. Equal temperatures leave it open between the two ends' own.
#[inline(always)]
fn mean_conductivity(a: f32, b: f32, conducted: f32, difference: f32) -> f32 {
    // Plain comparisons, which become one instruction each.
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    let mean = conducted / difference;
    let mean = if mean > low { mean } else { low };
    let mean = if mean < high { mean } else { high };
    if difference == 0.0 { 0.5 * (a + b) } else { mean }
}

impl HeapSize for RandomFlux {
    fn heap_size(&self) -> usize {
        let columns = (self.roots.capacity() + self.conductivities.capacity()) * size_of::<f32>();
        size_of_val(&*self.by_particle) + columns
    }
}

impl PairTerm for RandomFlux {
    const ACTIVE: bool = true;

    fn begin(&mut self, fields: &Fields, clock: &Clock) {
        self.noise = StepNoise::new(self.seed, clock.index);
        self.step = clock.step;
        for (root, temperature) in self.roots.iter_mut().zip(&fields.temperature) {
            *root = ((temperature - self.absolute_zero).max(0.0) as f32).sqrt();
        }
        for (own, conductivity) in self.conductivities.iter_mut().zip(&fields.conductivity) {
            *own = *conductivity as f32;
        }
    }

    #[inline(always)]
    fn add(&self, pair: &PairView<'_>) -> f64 {
        let (i, j) = pair.indices;
        let temperature = &pair.fields.temperature;
        let between = pair.between.map(|(least, greatest)| (least as f32, greatest as f32));
        let (a, b) = between.unwrap_or((self.conductivities[i], self.conductivities[j]));
        let mean = mean_conductivity(a, b, pair.conducted as f32, (temperature[j] - temperature[i]) as f32);
        // Between particles that store different heat, the noise of the one that stores less: a light one beside a heavy one
        // stays as quiet as among its like.
        let twice_boltzmann = match self.by_particle.is_empty() {
            true => self.twice_boltzmann_per_volume,
            false => self.by_particle[i].min(self.by_particle[j]),
        };
        let number = self.noise.antisymmetric(pair.names.0, pair.names.1, pair.stream);
        let roots = self.roots[i] * self.roots[j];
        f64::from(self.amplitude(twice_boltzmann, pair.weight) * roots * mean.sqrt() * number)
    }

    #[inline(always)]
    fn give(&self, run: &Run, fields: &Fields, fluxes: &mut [f64]) {
        let count = fluxes.len();
        let amplitude = self.amplitude(self.twice_boltzmann_per_volume, run.weight);
        let (warm, cold) = both(&fields.temperature, run);
        let (roots, other_roots) = both(&self.roots, run);
        let (a, b) = both(&self.conductivities, run);
        let (warm, cold) = (&warm[..count], &cold[..count]);
        let (roots, other_roots) = (&roots[..count], &other_roots[..count]);
        let (a, b) = (&a[..count], &b[..count]);
        // Both names grow by one from pair to pair.
        let (names, next) = (pair_of(run.first, run.partner), pair_of(1, 1));
        for k in 0..count {
            let conducted = fluxes[k];
            let mean = mean_conductivity(a[k], b[k], conducted as f32, (cold[k] - warm[k]) as f32);
            let number = self.noise.one(names.wrapping_add(next.wrapping_mul(k as u64)));
            let random = amplitude * (roots[k] * other_roots[k]) * mean.sqrt() * number;
            fluxes[k] = run.weight * conducted + f64::from(random);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Particles of water, most of them freezing, in steps of a second.
    fn state(count: usize, seed: u64) -> (RandomFlux, Fields) {
        let noise = StepNoise::new(seed, 3);
        let unit = |i: usize, stream| 0.5 + f64::from(noise.antisymmetric(i as u32, u32::MAX, stream)) / 12f64.sqrt();
        let frozen: Vec<f64> = (0..count).map(|i| (3.0 * unit(i, 1) - 1.0).clamp(0.0, 1.0)).collect();
        let shift = |i: usize| match frozen[i] {
            1.0 => -10.0 * unit(i, 2),
            0.0 => 5.0 * unit(i, 2),
            _ => 0.0,
        };
        let temperature: Vec<f64> = (0..count).map(shift).collect();
        let potential = temperature.iter().map(|t| if *t < 0.0 { 2.14 * t } else { 0.6 * t }).collect();
        let conductivity: Vec<f64> = frozen.iter().map(|frozen| 0.6 + 1.54 * frozen).collect();
        let fields = Fields { potential, temperature, conductivity };
        let mut term = RandomFlux {
            seed,
            absolute_zero: -273.15,
            twice_boltzmann_per_volume: 0.08,
            by_particle: Arc::new([]),
            noise,
            step: 0.0,
            roots: vec![0.0; count],
            conductivities: vec![0.0; count],
        };
        term.begin(&fields, &Clock { time: 0.0, step: 1.0, index: 3, turned: false });
        (term, fields)
    }

    proptest! {
        /// Pairs of a run give what they give one by one, from either end, to the bit.
        #[test]
        fn a_run_is_its_pairs(count in 1_u32..200, apart in 1_u32..300, first in 0_u32..100, seed in 0_u64..1000) {
            let (term, fields) = state((first + apart + count) as usize, seed);
            let run = Run { first, partner: first + apart, count, weight: 7e5 };
            let conducted = |i: usize, j: usize| fields.potential[j] - fields.potential[i];
            let mut fluxes: Vec<f64> = (0..count).map(|k| {
                let (i, j) = ((first + k) as usize, (first + apart + k) as usize);
                conducted(i, j)
            }).collect();
            term.give(&run, &fields, &mut fluxes);
            for k in 0..count {
                let names = (first + k, first + apart + k);
                for (sign, (i, j)) in [(1.0, names), (-1.0, (names.1, names.0))] {
                    let indices = (i as usize, j as usize);
                    let conducted = conducted(indices.0, indices.1);
                    let (weight, stream) = (run.weight, 0);
                    let view = PairView { names: (i, j), stream, weight, conducted, between: None, indices, fields: &fields };
                    let alone = run.weight * conducted + term.add(&view);
                    prop_assert_eq!(sign * alone, fluxes[k as usize]);
                }
            }
        }
    }

    /// Fluctuation and dissipation: the variance of a pair's flux is 2 k_B K T_i T_j over the step, by the volume.
    #[test]
    fn noise_has_the_strength_of_conduction() {
        let (mut term, mut fields) = state(2, 1);
        fields.temperature = vec![-5.0, 3.0];
        fields.potential = vec![2.14 * -5.0, 0.6 * 3.0];
        fields.conductivity = vec![2.14, 0.6];
        let run = Run { first: 0, partner: 1, count: 1, weight: 7e5 };
        let conducted = fields.potential[1] - fields.potential[0];
        let (mut square, count) = (0.0, 40_000);
        for index in 0..count {
            term.begin(&fields, &Clock { time: 0.0, step: 2.0, index, turned: false });
            let mut flux = [conducted];
            term.give(&run, &fields, &mut flux);
            square += (flux[0] - run.weight * conducted).powi(2);
        }
        let expected = 0.08 / 2.0 * run.weight * conducted / 8.0 * (273.15 - 5.0) * (273.15 + 3.0);
        // Four standard errors of the mean square of a uniform number: sqrt(0.8 / n).
        let error = 4.0 * (0.8 / count as f64).sqrt();
        assert!((square / count as f64 / expected - 1.0).abs() < error, "{}", square / count as f64 / expected);
    }
}
