//! Particles at rest behind walls, and the temperatures that make a wall of them.
//!
//! A particle behind a wall has the temperature of the wall. What it exchanges with a particle of the body is that of the wall,
//! which is nearer: the pair conducts better by the distance between both over that of the body's particle from the wall, both
//! across the wall (as velocities at walls after Morris et al. 1997). So a straight profile is exact, and conduction never takes
//! a particle beyond the temperature of the wall. Particles nearer than `e` cut-off radii, the least that a step allows
//! (`Walls::least`), exchange as at that distance, too little; in return all see the wall `e^2` radii nearer than it is, by which
//! the mean field of a straight profile has no jump at the wall (0.98 to 1.07 `e^2`, for `e` from 0.1 to 0.21). Rejected: the potential `2 U(wall) - U(image)` (Ng et al. 2017, section 4.1, with temperatures), fitted to the
//! particles around the mirror image: beside a jump of the wall's temperature, particles with few neighbours were taken out of
//! the range of the data by a fifth of it.
//!
//! What particles behind walls receive has left the body through the wall.

use frazil_core::saved::{Pass, Saved};

use super::matter::Matter;
use super::particle::{Look, Particle};

/// Mean distance from a wall of what a particle at the wall exchanges heat with behind it, over the cut-off radius, in a plane that
/// is evenly filled: the weights are `(1 - r/rc)^2`.
const CENTRE: f64 = 8.0 / (10.0 * std::f64::consts::PI);

/// `alpha dt/rc^2` that one unit of a particle's heat exchanged in a step corresponds to: half of the limit of stability, in the
/// mean field.
const UNIT: f64 = 0.05;

/// Part of its heat that a particle with so many neighbours may exchange in a step, in the mean field.
///
/// 2 is the limit of stability for one particle, and what particles of a liquid exchange scatters about the mean field by about one
/// over the root of their neighbours: this leaves room for 4.5 times that. With a dozen neighbours it is 0.88; with 1.1,
/// one particle in 17 600 left the range of the data by nine standard deviations once in 26 000 steps, and with 1.3 some did so by
/// thirty in every run of 2400 steps.
pub fn most_exchanged(neighbours: f64) -> f64 {
    2.0 / (1.0 + 4.5 / neighbours.sqrt())
}

/// Least distance from a wall, over the cut-off radius, however short a step is: nearer, few pairs would count too much.
const LEAST: f64 = 0.1;

/// What a part of the walls holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WallState {
    /// A temperature.
    Held(f64),
    /// No heat crosses.
    Insulated,
}

/// A particle behind a wall.
#[derive(Debug, Clone, Copy)]
pub struct Behind<const D: usize> {
    /// Where its mirror image stands in the body.
    pub image: [f64; D],
    /// The direction across the wall.
    pub across: usize,
    /// Its distance from the wall.
    pub depth: f64,
    /// The part of the walls that it belongs to.
    pub patch: u32,
}

/// All particles behind walls.
#[derive(Debug, Clone)]
pub struct Walls<const D: usize> {
    /// Name of the first of them; all others have smaller ones.
    pub first: u32,
    /// By name, from the first on.
    pub behind: Vec<Behind<D>>,
    /// By patch.
    pub faces: Vec<WallState>,
    /// Heat that has come through each patch in the last step.
    pub received: Vec<f64>,
    /// Cut-off radius of heat.
    cutoff: f64,
    /// Largest diffusivity of the body.
    diffusivity: f64,
    /// Part of its heat that a particle may exchange in a step.
    most: f64,
    /// Least distance of particles from walls that the pairs of this step reckon with.
    nearest: f64,
    /// How much nearer a wall is seen than it is.
    shift: f64,
    /// Where they stand since the last sorting.
    at: Vec<u32>,
}

impl<const D: usize> Saved for Walls<D> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        // Faces are set at every step.
        pass.all(&mut [&mut self.received, &mut self.at]);
    }
}

impl<const D: usize> Walls<D> {
    /// Walls of these particles, all patches insulated at first, of a body with a cut-off radius of heat, a largest
    /// diffusivity, and so many neighbours of a particle.
    pub fn new(
        first: u32,
        behind: Vec<Behind<D>>,
        patches: usize,
        (cutoff, diffusivity, neighbours): (f64, f64, f64),
    ) -> Self {
        Walls {
            cutoff,
            diffusivity,
            most: most_exchanged(neighbours),
            nearest: cutoff,
            shift: 0.0,
            first,
            faces: vec![WallState::Insulated; patches],
            received: vec![0.0; patches],
            at: vec![0; behind.len()],
            behind,
        }
    }

    /// Bytes that they hold on the heap.
    pub fn heap_size(&self) -> usize {
        self.behind.capacity() * size_of::<Behind<D>>() + 4 * self.at.capacity() + 8 * self.received.capacity()
    }

    /// Notes where they stand.
    pub fn find(&mut self, particles: &[Particle<D>]) {
        for (i, particle) in particles.iter().enumerate() {
            if particle.name >= self.first {
                self.at[(particle.name - self.first) as usize] = i as u32;
            }
        }
    }

    /// Least distance of particles from walls that pairs reckon with in a step, over the cut-off radius.
    ///
    /// At the wall, half of the partners exchange as in the liquid, and the other half by [`CENTRE`] over `e - e^2` better (see
    /// [`Walls::closeness`]).
    fn least(&self, step: f64) -> f64 {
        let exchanged = self.diffusivity * step / (self.cutoff * self.cutoff * UNIT);
        let product = CENTRE / (2.0 * self.most / exchanged - 1.0);
        let least = if (0.0..0.25).contains(&product) { 0.5 - (0.25 - product).sqrt() } else { 0.5 };
        least.max(LEAST)
    }

    /// Lets the pairs of a step see them at the temperatures of the walls.
    pub fn show<M: Matter>(&mut self, matter: &M, looks: &mut [Look<D, M::Seen>], step: f64) {
        let least = self.least(step);
        self.nearest = least * self.cutoff;
        self.shift = least * self.nearest;
        for (i, behind) in self.at.iter().zip(&self.behind) {
            if let WallState::Held(temperature) = self.faces[behind.patch as usize] {
                let look = &mut looks[*i as usize];
                (look.temperature, look.coldness) = (temperature, 1.0 / temperature);
                look.single_temperature = temperature as f32;
                look.seen = matter.see_at(temperature);
            }
        }
    }

    /// By how much the pair of a particle of the body with the one behind a wall of a name conducts better for the wall between
    /// them, from their displacement.
    #[inline(always)]
    pub fn closeness(&self, name: u32, displacement: impl Fn(usize) -> f64) -> f64 {
        let behind = &self.behind[(name - self.first) as usize];
        match self.faces[behind.patch as usize] {
            WallState::Held(_) => {
                let apart = displacement(behind.across).abs();
                apart / ((apart - behind.depth).max(self.nearest) - self.shift)
            }
            WallState::Insulated => 0.0,
        }
    }

    /// Takes what they have received in a step.
    pub fn collect(&mut self, particles: &mut [Particle<D>]) {
        self.received.fill(0.0);
        for (i, behind) in self.at.iter().zip(&self.behind) {
            self.received[behind.patch as usize] += std::mem::take(&mut particles[*i as usize].heat);
        }
    }
}
