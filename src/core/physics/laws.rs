//! Enthalpy to potential for whole rows of particles, whatever they are made of.

use std::sync::Arc;

use crate::physics::latent_heat::Materials;
use crate::physics::potential::{Kinked, Law, PotentialLaw};

/// The laws of all particles, numbered as these are.
pub trait Laws: Clone + Send + Sync + 'static {
    /// Potentials (W/m) of neighbouring particles, of which `first` is the first, from their enthalpies (J/m3).
    fn fill(&self, first: usize, enthalpy: &[f64], potentials: &mut [f64]);
    /// Potentials (W/m) of some particles, told by their places among them, from their enthalpies (J/m3).
    fn fill_some(&self, particle: impl Fn(usize) -> u32, enthalpy: &[f64], potentials: &mut [f64]);
    /// Potential (W/m) of one particle.
    fn potential_of(&self, particle: usize, enthalpy: f64) -> f64;
    /// Slope dU/dH (m2/s) of one particle.
    fn slope_of(&self, particle: usize, enthalpy: f64) -> f64;
    /// The law of all particles, where it is one of three straight pieces or less.
    #[inline(always)]
    fn pieces(&self) -> Option<Kinked> {
        None
    }
}

impl<L: PotentialLaw> Laws for L {
    #[inline(always)]
    fn fill(&self, _first: usize, enthalpy: &[f64], potentials: &mut [f64]) {
        PotentialLaw::fill(self, enthalpy, potentials);
    }

    #[inline(always)]
    fn fill_some(&self, _particle: impl Fn(usize) -> u32, enthalpy: &[f64], potentials: &mut [f64]) {
        PotentialLaw::fill(self, enthalpy, potentials);
    }

    #[inline(always)]
    fn potential_of(&self, _particle: usize, enthalpy: f64) -> f64 {
        self.potential(enthalpy)
    }

    #[inline(always)]
    fn slope_of(&self, _particle: usize, enthalpy: f64) -> f64 {
        self.slope(enthalpy)
    }

    #[inline(always)]
    fn pieces(&self) -> Option<Kinked> {
        PotentialLaw::pieces(self)
    }
}

/// Laws of several materials, in runs of neighbouring particles of one law.
#[derive(Debug, Clone)]
pub struct Runs {
    laws: Arc<[Law]>,
    /// One past the last particle of each run, and its law.
    runs: Arc<[(u32, u32)]>,
}

impl Runs {
    /// The runs of `count` particles.
    pub fn new(materials: &Materials, count: usize) -> Self {
        let mut runs: Vec<(u32, u32)> = Vec::new();
        for particle in 0..count {
            let law = materials.law(particle) as u32;
            match runs.last_mut() {
                Some(run) if run.1 == law => run.0 += 1,
                _ => runs.push((particle as u32 + 1, law)),
            }
        }
        Runs { laws: materials.laws().map(|thermal| thermal.law.clone()).collect(), runs: runs.into() }
    }

    fn run_of(&self, particle: usize) -> usize {
        self.runs.partition_point(|run| run.0 as usize <= particle)
    }

    fn law_of(&self, particle: usize) -> &Law {
        &self.laws[self.runs[self.run_of(particle)].1 as usize]
    }
}

impl Laws for Runs {
    #[inline(always)]
    fn fill(&self, first: usize, enthalpy: &[f64], potentials: &mut [f64]) {
        let mut done = 0;
        for (end, law) in &self.runs[self.run_of(first)..] {
            if done == enthalpy.len() {
                break;
            }
            let until = (*end as usize - first).min(enthalpy.len());
            let (from, into) = (&enthalpy[done..until], &mut potentials[done..until]);
            match &self.laws[*law as usize] {
                Law::Straight(law) => PotentialLaw::fill(law, from, into),
                Law::Kinked(law) => PotentialLaw::fill(law, from, into),
                Law::Curved(law) => PotentialLaw::fill(law, from, into),
                Law::Tabulated(law) => PotentialLaw::fill(law, from, into),
                Law::Blended(law) => {
                    for (potential, enthalpy) in into.iter_mut().zip(from) {
                        *potential = law.potential(*enthalpy);
                    }
                }
            }
            done = until;
        }
    }

    fn fill_some(&self, particle: impl Fn(usize) -> u32, enthalpy: &[f64], potentials: &mut [f64]) {
        // What stands for no particle has any law.
        let last = self.runs.last().map_or(0, |run| run.0 as usize - 1);
        for (at, (enthalpy, potential)) in enthalpy.iter().zip(potentials).enumerate() {
            *potential = self.potential_of((particle(at) as usize).min(last), *enthalpy);
        }
    }

    fn potential_of(&self, particle: usize, enthalpy: f64) -> f64 {
        self.law_of(particle).potential(enthalpy)
    }

    fn slope_of(&self, particle: usize, enthalpy: f64) -> f64 {
        self.law_of(particle).slope(enthalpy)
    }
}
