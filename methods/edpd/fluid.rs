//! Fluids of eDPD particles that move: conservative, dissipative and random forces, and heat, between pairs.
//!
//! A step is half a kick by the conservative forces, a drift, one pass over all pairs in reach, which gives the new forces
//! and lets friction, noise and heat act pair by pair ([`pairs`]), and the other half of the kick. Friction meets velocities
//! that lack half a kick, so kicks and drifts gain energy, by the second order in the step; what they gain is taken back
//! from the heat of all moving particles in the next step, and told ([`Fluid::given_back`]). So energy and momentum are
//! kept to rounding; and the same start, constants and seed give the same bits on any number of threads. Rejected: a second
//! pass for friction, after the kick, which gains less and costs half a step more.

pub mod matter;
pub mod pairs;
pub mod parameters;
pub mod particle;
pub mod power;
mod scan;
pub mod sorting;
mod state;
pub mod walls;

use std::sync::Arc;

use frazil_core::noise::StepNoise;
use rand::{SeedableRng, rngs::StdRng};
use rand_distr::{Distribution, StandardNormal};
use rayon::ThreadPool;
use rayon::prelude::*;

pub use matter::{Matter, Plain};
pub use parameters::{Exponent, Parameters};
pub use particle::{Look, Particle};
pub use walls::{Behind, Face, Walls};

use pairs::{Desk, Frame, Part, act};
use scan::LANES;
use sorting::Grid;

/// Width of cells beyond the reach of pairs, over the reach: particles are sorted less often, and more are looked at in vain.
const SKIN: f64 = 0.15;

/// Particles that a task kicks and moves.
const TASK: usize = 2048;

/// What acts on particles from outside.
pub trait Drive<const D: usize>: Sync {
    /// Whether it brings energy, which is then booked ([`Fluid::driven`]).
    const WORKS: bool = true;

    /// Acts for a time on a particle: before it drifts.
    fn act(&self, particle: &mut Particle<D>, time: f64);

    /// Keeps a particle in that has drifted for a time. It must keep the kinetic energy.
    #[inline(always)]
    fn confine(&self, _particle: &mut Particle<D>, _time: f64) {}
}

/// Nothing acts.
#[derive(Debug, Clone, Copy)]
pub struct Undriven;

impl<const D: usize> Drive<D> for Undriven {
    const WORKS: bool = false;

    #[inline(always)]
    fn act(&self, _particle: &mut Particle<D>, _time: f64) {}
}

/// Sums over all particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Totals<const D: usize> {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Internal energy above that at the reference temperature.
    pub heat: f64,
    /// Potential of the conservative forces.
    pub potential: f64,
    /// Momentum.
    pub momentum: [f64; D],
    /// Kinetic temperature, against the mean velocity.
    pub kinetic_temperature: f64,
    /// Harmonic mean of the internal temperatures: what the kinetic one tends to.
    pub internal_temperature: f64,
}

/// A fluid in a periodic box, in parts of which there may be walls.
pub struct Fluid<const D: usize, M: Matter = Plain> {
    parameters: Parameters,
    matter: M,
    seed: u64,
    pool: Option<Arc<ThreadPool>>,
    grid: Grid<D>,
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
    /// Kinetic energy that kicks bring, the farthest way gone, squared, and energy that the drive brings; then kinetic
    /// energy that kicks bring and particles that came to rest, by task.
    work: Vec<[f64; 3]>,
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
    ) -> Result<Self, String> {
        if let Some(problem) = parameters.problem() {
            return Err(problem);
        }
        if !(temperature > 0.0 && temperature.is_finite()) {
            return Err(format!("temperature: found {temperature}, must be above 0"));
        }
        let volume: f64 = lengths.iter().product();
        let count = (parameters.density * volume).round() as usize;
        let particles = placed(&lengths, count, temperature, seed);
        let matter = Plain { reference: temperature, heat_capacity: parameters.heat_capacity };
        Fluid::assembled(parameters, lengths, matter, particles, None, None, seed, pool)
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
    ) -> Result<Self, String> {
        let grid = Grid::new(lengths, parameters.reach() * (1.0 + SKIN))?;
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
            work: vec![[0.0; 3]; count.div_ceil(TASK)],
            steps: 0,
            sortings: 0,
            parameters,
        };
        fluid.in_pool(|fluid| {
            fluid.sort();
            // Forces at the start, without friction, noise and heat: a frame of no time.
            fluid.meet(0.0);
            fluid.potential = fluid.desks.iter().map(|desk| desk.potential).sum();
            Ok::<(), String>(())
        })?;
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
    pub fn held(&self) -> usize {
        fn of<T>(column: &Vec<T>) -> usize {
            column.capacity() * size_of::<T>()
        }
        let places: usize = self.places.iter().map(of).sum();
        let walls = self.walls.as_ref().map_or(0, Walls::held);
        let particles = of(&self.particles) + of(&self.sorted) + of(&self.looks) + of(&self.origins);
        particles + of(&self.starts) + places + of(&self.desks) + of(&self.work) + walls
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
    pub fn faces(&mut self) -> &mut [Face] {
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
    pub fn advance(&mut self, steps: u64, drive: &impl Drive<D>) -> Result<(), String> {
        self.in_pool(|fluid| (0..steps).try_for_each(|_| fluid.step(fluid.parameters.step, drive)))
    }

    /// Makes a step of another length than that of the constants.
    ///
    /// # Errors
    /// As [`Fluid::advance`].
    pub fn advance_by(&mut self, step: f64, drive: &impl Drive<D>) -> Result<(), String> {
        self.in_pool(|fluid| fluid.step(step, drive))
    }

    fn step<W: Drive<D>>(&mut self, step: f64, drive: &W) -> Result<(), String> {
        let share = self.gained / self.moving;
        self.given_back += self.gained;
        let first = |((particles, origins), work): Task<'_, D>| {
            let (mut most, mut gained, mut driven) = (0.0, 0.0, 0.0);
            for (particle, origin) in particles.iter_mut().zip(origins) {
                let half = 0.5 * step * particle.mobility;
                let mut moved = 0.0;
                gained += kick(particle, half);
                let before = if W::WORKS { particle.kinetic() + particle.heat } else { 0.0 };
                drive.act(particle, step);
                if W::WORKS {
                    driven += particle.kinetic() + particle.heat - before;
                }
                for axis in 0..D {
                    particle.position[axis] += step * particle.velocity[axis];
                }
                drive.confine(particle, step);
                for axis in 0..D {
                    let way = particle.position[axis] - origin[axis];
                    moved += way * way;
                }
                particle.force = [0.0; D];
                particle.heat -= share * particle.mobility;
                // A place that is no number is farther than any.
                most = if moved <= most { most } else { moved };
            }
            *work = [gained, most, driven];
        };
        if self.pool.is_some() {
            let tasks = self.particles.par_chunks_mut(TASK).zip(self.origins.par_chunks(TASK)).zip(&mut self.work);
            tasks.for_each(first);
        } else {
            self.particles.chunks_mut(TASK).zip(self.origins.chunks(TASK)).zip(&mut self.work).for_each(first);
        }
        let most = self.work.iter().fold(0.0, |most, work| if work[1] <= most { most } else { work[1] });
        let mut gained: f64 = self.work.iter().map(|work| work[0]).sum();
        self.driven += self.work.iter().map(|work| work[2]).sum::<f64>();
        let skin = SKIN * self.parameters.reach();
        if most > (0.5 * skin).powi(2) || most.is_nan() {
            if !most.is_finite() || most > self.parameters.reach().powi(2) {
                return Err(format!(
                    "step {}: a particle moved by {:.3} within a few steps, farther than pairs reach: the time step {} is \
                     too long",
                    self.steps,
                    most.sqrt(),
                    step
                ));
            }
            self.sort();
        }
        self.meet(step);
        if let Some(walls) = &mut self.walls {
            walls.collect(&mut self.particles);
        }
        let (matter, fluid) = (&self.matter, self.walls.as_ref().map_or(u32::MAX, |walls| walls.first));
        let last = |(particles, work): (&mut [Particle<D>], &mut [f64; 3])| {
            let (mut gained, mut stopped) = (0.0, 0.0);
            for particle in particles {
                gained += kick(particle, 0.5 * step * particle.mobility);
                if M::UNEVEN && particle.name < fluid {
                    stopped += settle(matter, particle);
                }
            }
            *work = [gained, 0.0, stopped];
        };
        if self.pool.is_some() {
            self.particles.par_chunks_mut(TASK).zip(&mut self.work).for_each(last);
        } else {
            self.particles.chunks_mut(TASK).zip(&mut self.work).for_each(last);
        }
        gained += self.work.iter().map(|work| work[0]).sum::<f64>();
        if M::UNEVEN {
            let stopped: f64 = self.work.iter().map(|work| work[2]).sum();
            self.moving = (self.moving - stopped).max(1.0);
        }
        let potential: f64 = self.desks.iter().map(|desk| desk.potential).sum();
        self.gained = gained + potential - self.potential;
        self.potential = potential;
        self.steps += 1;
        Ok(())
    }

    fn sort(&mut self) {
        let Fluid { grid, particles, sorted, starts, origins, walls, .. } = self;
        grid.sort(particles, sorted, starts);
        origins.clear();
        origins.extend(particles.iter().map(|particle| particle.position));
        if let Some(walls) = walls {
            walls.list(grid, particles, starts, self.parameters.thermal_cutoff + 0.5 * SKIN * self.parameters.reach());
        }
        self.sortings += 1;
    }

    /// Lets all pairs act for a time.
    fn meet(&mut self, time: f64) {
        let (parameters, matter) = (&self.parameters, &self.matter);
        let capacity = parameters.heat_capacity;
        let look = |particle: &Particle<D>| {
            let temperature = matter.temperature(particle.heat);
            Look {
                position: particle.position,
                temperature,
                exponent: parameters.exponent.at(temperature),
                mobility: particle.mobility,
                seen: matter.see(particle.heat, particle.mobility > 0.0),
                name: particle.name,
            }
        };
        if self.pool.is_some() {
            self.particles.par_iter().with_min_len(TASK).map(look).collect_into_vec(&mut self.looks);
        } else {
            self.looks.clear();
            self.looks.extend(self.particles.iter().map(look));
        }
        let count = self.particles.len();
        for (axis, places) in self.places.iter_mut().enumerate() {
            places.resize(count + LANES, 0.0);
            let particles = self.particles.par_iter().with_min_len(TASK);
            if self.pool.is_some() {
                let places = places[..count].par_iter_mut();
                places.zip(particles).for_each(|(place, particle)| *place = particle.position[axis] as f32);
            } else {
                let places = places.iter_mut();
                places.zip(&self.particles).for_each(|(place, particle)| *place = particle.position[axis] as f32);
            }
        }
        if let Some(walls) = &mut self.walls {
            walls.show(matter, &self.grid, &mut self.looks, parameters.thermal_cutoff, self.pool.is_some());
        }
        let frame = Frame {
            looks: &self.looks,
            matter,
            shut: self.shut,
            places: self.places.each_ref().map(|places| &places[..]),
            grid: &self.grid,
            starts: &self.starts,
            apart: self.walls.as_ref().map_or(u32::MAX, |walls| walls.first),
            reach: scan::widened(parameters.reach(), self.grid.lengths.iter().copied().fold(0.0, f64::max)),
            inverse_cutoffs: [
                1.0 / parameters.conservative_cutoff,
                1.0 / parameters.dissipative_cutoff,
                1.0 / parameters.thermal_cutoff,
            ],
            repulsion: parameters.repulsion,
            friction: parameters.friction * time,
            conductance: capacity * capacity * parameters.heat_friction * time,
            noise: StepNoise::new(self.seed, self.steps),
        };
        let parallel = self.pool.is_some();
        let (desks, particles) = (&mut self.desks[..], &mut self.particles[..]);
        twos(&frame, parallel, 0, desks, (0, particles));
        // Those of odd number; the last one's next is the first.
        let count = desks.len();
        let (first, rest) = particles.split_at_mut(frame.count(0..1));
        let (middle, last) = rest.split_at_mut(rest.len() - frame.count(count - 1..count));
        let (middle_desks, last_desks) = desks[1..].split_at_mut(count - 2);
        let begins = (first.len(), first.len() + middle.len());
        let wrapped = || act(&frame, count - 1, &mut last_desks[0], (begins.1, last), (0, first));
        let inside = || {
            if count > 2 {
                twos(&frame, parallel, 1, middle_desks, (begins.0, middle));
            }
        };
        both(parallel, wrapped, inside);
    }

    /// Sums over all particles.
    pub fn totals(&self) -> Totals<D> {
        let count = self.particles.len() as f64;
        let mut momentum = [0.0; D];
        let (mut kinetic, mut heat, mut inverse, mut moving) = (0.0, 0.0, 0.0, 0.0);
        for particle in &self.particles {
            kinetic += particle.kinetic();
            heat += particle.heat;
            inverse += 1.0 / self.temperature(particle);
            if particle.mobility > 0.0 {
                moving += 1.0;
                for axis in 0..D {
                    momentum[axis] += particle.velocity[axis] / particle.mobility;
                }
            }
        }
        let drift: f64 = momentum.iter().map(|p| p * p).sum::<f64>() / f64::max(moving, 1.0);
        Totals {
            kinetic,
            // What is still to be given back is no heat.
            heat: heat - self.gained,
            potential: self.potential,
            momentum,
            // One degree of freedom in each direction is the mean velocity's.
            kinetic_temperature: (2.0 * kinetic - drift) / (D as f64 * f64::max(moving - 1.0, 1.0)),
            internal_temperature: count / inverse,
        }
    }
}

/// Brings a particle to rest once all of it is frozen, and lets it go once nothing of it is; returns how many came to rest.
#[inline(always)]
fn settle<const D: usize, M: Matter>(matter: &M, particle: &mut Particle<D>) -> f64 {
    if particle.mobility > 0.0 {
        if matter.is_frozen(particle.heat) {
            particle.heat += particle.kinetic();
            particle.velocity = [0.0; D];
            particle.mobility = 0.0;
            return 1.0;
        }
    } else if matter.is_liquid(particle.heat) {
        particle.mobility = 1.0;
        return -1.0;
    }
    0.0
}

/// Changes the velocity of a particle by its force, for a time over its mass; returns the kinetic energy that this brings.
#[inline(always)]
fn kick<const D: usize>(particle: &mut Particle<D>, time: f64) -> f64 {
    let mut work = 0.0;
    for axis in 0..D {
        let change = time * particle.force[axis];
        work += change * (particle.velocity[axis] + 0.5 * change);
        particle.velocity[axis] += change;
    }
    if particle.mobility > 0.0 { work / particle.mobility } else { 0.0 }
}

/// Particles that are kicked and moved together, their places at the last sorting, and what is told of them.
type Task<'a, const D: usize> = ((&'a mut [Particle<D>], &'a [[f64; D]]), &'a mut [f64; 3]);

/// Slabs of one parity, from one on: `desks` come in twos, whose first ones' slabs act, at once with all others.
fn twos<const D: usize, M: Matter>(
    frame: &Frame<'_, D, M>,
    parallel: bool,
    slab: usize,
    desks: &mut [Desk<D>],
    (begin, particles): Part<'_, D>,
) {
    if let [desk, _] = desks {
        let (own, next) = particles.split_at_mut(frame.count(slab..slab + 1));
        let begin_next = begin + own.len();
        return act(frame, slab, desk, (begin, own), (begin_next, next));
    }
    let half = (desks.len() / 4 * 2).max(2);
    let (desks, other_desks) = desks.split_at_mut(half);
    let (particles, other_particles) = particles.split_at_mut(frame.count(slab..slab + half));
    let other_begin = begin + particles.len();
    both(
        parallel,
        || twos(frame, parallel, slab, desks, (begin, particles)),
        || twos(frame, parallel, slab + half, other_desks, (other_begin, other_particles)),
    );
}

fn both(parallel: bool, a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    if parallel {
        rayon::join(a, b);
    } else {
        a();
        b();
    }
}

/// Particles near the points of a lattice that fits the box.
fn placed<const D: usize>(lengths: &[f64; D], count: usize, temperature: f64, seed: u64) -> Vec<Particle<D>> {
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

#[cfg(test)]
mod tests;
