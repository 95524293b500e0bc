//! Fluids of eDPD particles that move: conservative, dissipative and random forces, and heat, between pairs.
//!
//! A step is half a kick by the conservative forces, a drift, one pass over all pairs in reach, which gives the new forces
//! and lets friction, noise and heat act pair by pair ([`pairs`]), and the other half of the kick. Friction meets velocities
//! that lack half a kick, so kicks and drifts gain energy, by the second order in the step; what they gain is taken back
//! from the heat of all moving particles in the next step, and told ([`Fluid::given_back`]). So energy and momentum are
//! kept to rounding; and the same start, constants and seed give the same bits on any number of threads. Rejected: a second
//! pass for friction, after the kick, which gains less and costs half a step more.

mod apart;
mod coefficients;
mod error;
mod lanes;
pub mod matter;
mod meeting;
pub mod pairs;
pub mod parameters;
pub mod particle;
pub mod power;
mod quad;
mod scan;
mod slabs;
pub mod sorting;
mod start;
mod step;
mod totals;
pub mod walls;

use std::sync::Arc;

use frazil_core::memory;
use frazil_core::saved::{Pass, Saved};
use rayon::ThreadPool;

pub use error::FluidError;
pub use matter::{ConstantCapacity, Matter};
pub use parameters::{Exponent, Parameters};
pub use particle::{Look, Particle};
pub use totals::Totals;
pub use walls::{Behind, WallState, Walls};

use pairs::Desk;
use sorting::CellGrid;
use step::PassSums;

/// Width of cells beyond the reach of pairs, over the reach: particles are sorted less often, and more are looked at in vain.
const SKIN: f64 = 0.15;

/// What acts on particles from outside.
pub trait Drive<const D: usize>: Sync {
    /// Whether it brings energy, which is then booked ([`Fluid::driven`]).
    const WORKS: bool = true;

    /// Acts for a time on a particle: before it drifts.
    #[inline(always)]
    fn act(&self, _particle: &mut Particle<D>, _time: f64) {}

    /// Keeps a particle in that has drifted for a time. It must keep the kinetic energy.
    #[inline(always)]
    fn confine(&self, _particle: &mut Particle<D>, _time: f64) {}
}

/// Nothing acts.
#[derive(Debug, Clone, Copy)]
pub struct Undriven;

impl<const D: usize> Drive<D> for Undriven {
    const WORKS: bool = false;
}

/// A fluid in a periodic box, in parts of which there may be walls.
pub struct Fluid<const D: usize, M: Matter = ConstantCapacity> {
    parameters: Parameters,
    matter: M,
    seed: u64,
    pool: Option<Arc<ThreadPool>>,
    grid: CellGrid<D>,
    particles: Vec<Particle<D>>,
    sorted: Vec<Particle<D>>,
    /// What pairs read of them.
    looks: Vec<Look<D, M::Seen>>,
    walls: Option<Walls<D>>,
    /// Direction across whose periodic sides no heat goes.
    shut: Option<usize>,
    /// Places in single precision, by direction, and some more.
    places: [Vec<f32>; D],
    /// The first particle of each cell.
    starts: Vec<u32>,
    desks: Vec<Desk<D>>,
    /// Places at the last sorting.
    origins: Vec<[f64; D]>,
    /// Potential at the last step.
    potential: f64,
    /// Energy that the last step gained by kicks and drifts, to be given back.
    gained: f64,
    /// All such energy so far.
    pub given_back: f64,
    /// Energy that the drive has brought so far.
    pub driven: f64,
    /// Particles that move, at least 1.
    moving: f64,
    /// What the last pass over all particles told, by task.
    sums: Vec<PassSums>,
    /// Steps made.
    pub steps: u64,
    /// Times that particles were sorted.
    pub sortings: u64,
}

impl<const D: usize> Fluid<D> {
    /// A fluid of even density in a box, at a temperature: particles near the points of a lattice, with the velocities of
    /// that temperature and no momentum together.
    ///
    /// # Errors
    /// Constants that mean nothing, and a box smaller than three times the reach of pairs.
    pub fn new(
        parameters: Parameters,
        lengths: [f64; D],
        temperature: f64,
        seed: u64,
        pool: Option<Arc<ThreadPool>>,
    ) -> Result<Self, FluidError> {
        parameters.check()?;
        if !(temperature > 0.0 && temperature.is_finite()) {
            return Err(FluidError::NotPositive("temperature", temperature));
        }
        let volume: f64 = lengths.iter().product();
        let count = affordable((parameters.density * volume).round())?;
        let particles = start::placed(&lengths, count, temperature, seed);
        let matter = ConstantCapacity { reference: temperature, heat_capacity: parameters.heat_capacity };
        Fluid::assembled(parameters, lengths, matter, particles, None, None, seed, pool)
    }
}

/// What is held for each particle while a liquid is made and cut at its walls (bytes), rounded down.
const BYTES: f64 = 700.0;

/// That many particles, if there is memory for them.
fn affordable(count: f64) -> Result<usize, FluidError> {
    let needed = BYTES * count;
    match memory::allowed() {
        Some(allowed) if needed > allowed.each() => Err(FluidError::Large { count, needed, allowed }),
        _ => Ok(count as usize),
    }
}

impl<const D: usize, M: Matter> Fluid<D, M> {
    /// A fluid of these particles, named from zero on without gaps, with walls, if any, and a direction across whose
    /// periodic sides no heat goes, if any.
    ///
    /// # Errors
    /// A box smaller than three times the reach of pairs.
    #[expect(clippy::too_many_arguments, reason = "the parts of a fluid, each given once")]
    pub fn assembled(
        parameters: Parameters,
        lengths: [f64; D],
        matter: M,
        particles: Vec<Particle<D>>,
        walls: Option<Walls<D>>,
        shut: Option<usize>,
        seed: u64,
        pool: Option<Arc<ThreadPool>>,
    ) -> Result<Self, FluidError> {
        let grid = CellGrid::new(lengths, parameters.reach() * (1.0 + SKIN))?;
        let slabs = grid.slabs();
        let count = particles.len();
        let moving = particles.iter().map(|particle| particle.mobility).sum::<f64>().max(1.0);
        let mut fluid = Fluid {
            matter,
            walls,
            shut,
            seed,
            pool,
            grid,
            sorted: particles.clone(),
            looks: Vec::with_capacity(particles.len()),
            particles,
            places: [(); D].map(|()| Vec::new()),
            starts: Vec::new(),
            desks: vec![Desk::default(); slabs],
            origins: Vec::new(),
            potential: 0.0,
            gained: 0.0,
            given_back: 0.0,
            driven: 0.0,
            moving,
            sums: PassSums::of_tasks(count),
            steps: 0,
            sortings: 0,
            parameters,
        };
        fluid.in_pool(|fluid| {
            fluid.sort();
            // Forces at the start, without friction, noise and heat: a frame of no time.
            fluid.meet(0.0);
            fluid.potential = fluid.pair_potential();
        });
        Ok(fluid)
    }

    /// Works on the fluid's own threads.
    fn in_pool<T: Send>(&mut self, work: impl FnOnce(&mut Self) -> T + Send) -> T {
        match self.pool.clone() {
            Some(pool) => pool.install(|| work(self)),
            None => work(self),
        }
    }

    /// The constants.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// All particles, in the order of the last sorting.
    pub fn particles(&self) -> &[Particle<D>] {
        &self.particles
    }

    /// Lengths of the box.
    pub fn lengths(&self) -> &[f64; D] {
        &self.grid.lengths
    }

    /// Temperature of a particle.
    pub fn temperature(&self, particle: &Particle<D>) -> f64 {
        self.matter.temperature(particle.heat)
    }

    /// Energy that kicks and drifts of the last step have gained, to be given back in the next.
    pub fn owed(&self) -> f64 {
        self.gained
    }

    /// Bytes that it holds on the heap.
    pub fn heap_size(&self) -> usize {
        fn of<T>(column: &Vec<T>) -> usize {
            column.capacity() * size_of::<T>()
        }
        let places: usize = self.places.iter().map(of).sum();
        let walls = self.walls.as_ref().map_or(0, Walls::heap_size);
        let particles = of(&self.particles) + of(&self.sorted) + of(&self.looks) + of(&self.origins);
        particles + of(&self.starts) + places + of(&self.desks) + of(&self.sums) + walls
    }

    /// What heat means.
    pub fn matter(&self) -> &M {
        &self.matter
    }

    /// The walls.
    pub fn walls(&self) -> Option<&Walls<D>> {
        self.walls.as_ref()
    }

    /// What the parts of the walls hold, to be set.
    pub fn faces(&mut self) -> &mut [WallState] {
        self.walls.as_mut().map_or(&mut [], |walls| &mut walls.faces)
    }

    /// Lets a change come over all particles; they stay where they are.
    pub fn change(&mut self, change: impl Fn(&mut Particle<D>)) {
        self.particles.iter_mut().for_each(change);
        self.moving = self.particles.iter().map(|particle| particle.mobility).sum::<f64>().max(1.0);
    }

    /// Pairs that met at the last step: all within reach, and a few in a million beyond.
    pub fn pairs(&self) -> u64 {
        self.desks.iter().map(|desk| desk.met).sum()
    }

    /// Makes steps.
    ///
    /// # Errors
    /// Particles that crowd together or leave the numbers: the step was too long.
    pub fn advance(&mut self, steps: u64, drive: &impl Drive<D>) -> Result<(), FluidError> {
        self.in_pool(|fluid| (0..steps).try_for_each(|_| fluid.step(fluid.parameters.step, drive)))
    }

    /// Makes a step of another length than that of the constants.
    ///
    /// # Errors
    /// As [`Fluid::advance`].
    pub fn advance_by(&mut self, step: f64, drive: &impl Drive<D>) -> Result<(), FluidError> {
        self.in_pool(|fluid| fluid.step(step, drive))
    }
}

impl<const D: usize, M: Matter> Saved for Fluid<D, M> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        // In the order of the last sorting, which decides in which order pairs act.
        self.particles.iter_mut().for_each(|particle| particle.pass(pass));
        self.origins.iter_mut().for_each(|origin| origin.pass(pass));
        if let Some(walls) = &mut self.walls {
            walls.pass(pass);
        }
        pass.all(&mut [
            &mut self.starts,
            &mut self.potential,
            &mut self.gained,
            &mut self.given_back,
            &mut self.driven,
            &mut self.moving,
            &mut self.steps,
            &mut self.sortings,
        ]);
    }
}

#[cfg(test)]
mod tests;
