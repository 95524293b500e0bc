//! One step of a fluid.

use frazil_core::noise::StepNoise;
use rayon::prelude::*;

use super::coefficients::PairConstants;
use super::matter::Matter;
use super::pairs::StepConstants;
use super::particle::{Look, Particle};
use super::scan::{LANES, widened};
use super::slabs::act_in_turn;
use super::{Drive, Fluid, FluidError, SKIN};

/// Particles that a task kicks and moves.
const TASK: usize = 2048;

/// What a pass over some particles adds up.
#[derive(Debug, Clone, Copy, Default)]
pub struct PassSums {
    /// Kinetic energy that kicks bring.
    gained: f64,
    /// Energy that the drive brings.
    driven: f64,
    /// Particles that come to rest, less those that are let go.
    stopped: f64,
    /// The farthest way gone since the last sorting, squared.
    farthest: f64,
}

impl PassSums {
    /// One for each task of a pass over so many particles.
    pub fn of_tasks(count: usize) -> Vec<PassSums> {
        vec![PassSums::default(); count.div_ceil(TASK)]
    }

    fn and(self, other: &PassSums) -> PassSums {
        PassSums {
            gained: self.gained + other.gained,
            driven: self.driven + other.driven,
            stopped: self.stopped + other.stopped,
            farthest: farther(self.farthest, other.farthest),
        }
    }
}

/// The greater of two ways; one that is no number is farther than any.
#[inline(always)]
fn farther(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

impl<const D: usize, M: Matter> Fluid<D, M> {
    /// Half a kick and a drift, all pairs, the other half of the kick.
    pub(super) fn step<W: Drive<D>>(&mut self, step: f64, drive: &W) -> Result<(), FluidError> {
        let first = self.kick_and_drift(step, drive);
        self.sort_if_far(step, first.farthest)?;
        self.meet(step);
        if let Some(walls) = &mut self.walls {
            walls.collect(&mut self.particles);
        }
        let second = self.kick_and_settle(step);
        self.book(&first, &second);
        Ok(())
    }

    /// Half a kick, the drive and a drift; moving particles give back what the last step gained.
    fn kick_and_drift<W: Drive<D>>(&mut self, step: f64, drive: &W) -> PassSums {
        let share = self.gained / self.moving;
        self.pass(|_, particle, origin, sums| {
            sums.gained += kick(particle, 0.5 * step * particle.mobility);
            let before = if W::WORKS { particle.kinetic() + particle.heat } else { 0.0 };
            drive.act(particle, step);
            if W::WORKS {
                sums.driven += particle.kinetic() + particle.heat - before;
            }
            for axis in 0..D {
                particle.position[axis] += step * particle.velocity[axis];
            }
            drive.confine(particle, step);
            let mut square = 0.0;
            for axis in 0..D {
                let way = particle.position[axis] - origin[axis];
                square += way * way;
            }
            sums.farthest = farther(square, sums.farthest);
            particle.force = [0.0; D];
            particle.heat -= share * particle.mobility;
        })
    }

    /// The other half of the kick; particles that have frozen come to rest, and those that have thawed are let go.
    fn kick_and_settle(&mut self, step: f64) -> PassSums {
        let behind_walls = self.first_behind_walls();
        self.pass(|matter, particle, _, sums| {
            sums.gained += kick(particle, 0.5 * step * particle.mobility);
            if M::UNEVEN && particle.name < behind_walls {
                sums.stopped += settle(matter, particle);
            }
        })
    }

    /// Lets something come over all particles, and over their places at the last sorting, in tasks of fixed size: so the sum of
    /// what it tells does not depend on the number of threads.
    fn pass(&mut self, each: impl Fn(&M, &mut Particle<D>, &[f64; D], &mut PassSums) + Sync) -> PassSums {
        let Fluid { matter, particles, origins, sums, .. } = self;
        let task = |((particles, origins), told): ((&mut [Particle<D>], &[[f64; D]]), &mut PassSums)| {
            let mut sums = PassSums::default();
            for (particle, origin) in particles.iter_mut().zip(origins) {
                each(matter, particle, origin, &mut sums);
            }
            *told = sums;
        };
        if self.pool.is_some() {
            particles.par_chunks_mut(TASK).zip(origins.par_chunks(TASK)).zip(&mut *sums).for_each(task);
        } else {
            particles.chunks_mut(TASK).zip(origins.chunks(TASK)).zip(&mut *sums).for_each(task);
        }
        sums.iter().fold(PassSums::default(), PassSums::and)
    }

    /// Sorts once a particle has gone half of the skin.
    fn sort_if_far(&mut self, step: f64, farthest: f64) -> Result<(), FluidError> {
        let reach = self.parameters.reach();
        if farthest.is_nan() || farthest > reach.powi(2) {
            return Err(FluidError::TooLong { number: self.steps, way: farthest.sqrt(), step });
        }
        if farthest > (0.5 * SKIN * reach).powi(2) {
            self.sort();
        }
        Ok(())
    }

    pub(super) fn sort(&mut self) {
        let Fluid { grid, particles, sorted, starts, origins, walls, .. } = self;
        grid.sort(particles, sorted, starts);
        origins.clear();
        origins.extend(particles.iter().map(|particle| particle.position));
        if let Some(walls) = walls {
            walls.find(particles);
        }
        self.sortings += 1;
    }

    /// Lets all pairs act for a time.
    pub(super) fn meet(&mut self, time: f64) {
        let noise = StepNoise::new(self.seed, self.steps);
        self.look(time);
        let parameters = &self.parameters;
        let frame = StepConstants {
            looks: &self.looks,
            matter: &self.matter,
            shut: self.shut,
            places: self.places.each_ref().map(|places| &places[..]),
            grid: &self.grid,
            starts: &self.starts,
            walls: self.walls.as_ref(),
            reach: widened(parameters.reach(), self.grid.lengths.iter().copied().fold(0.0, f64::max)),
            constants: PairConstants {
                far: 2.0 * parameters.reach(),
                inverse_cutoffs: [
                    1.0 / parameters.conservative_cutoff,
                    1.0 / parameters.dissipative_cutoff,
                    1.0 / parameters.thermal_cutoff,
                ],
                repulsion: parameters.repulsion,
                friction: parameters.friction * time,
                conductance: parameters.heat_capacity * parameters.heat_capacity * parameters.heat_friction * time,
                noise,
            },
        };
        act_in_turn(&frame, self.pool.is_some(), &mut self.desks, &mut self.particles);
    }

    /// Shows pairs all particles as they are before the pairs act for a time.
    fn look(&mut self, time: f64) {
        let Fluid { parameters, matter, particles, looks, places, walls, .. } = self;
        let parallel = self.pool.is_some();
        let look = |particle: &Particle<D>| {
            let temperature = matter.temperature(particle.heat);
            Look {
                position: particle.position,
                coldness: 1.0 / temperature,
                single_temperature: temperature as f32,
                half_exponent: (0.5 * parameters.exponent.at(temperature)) as f32,
                mobility: particle.mobility as f32,
                name: particle.name,
                temperature,
                seen: matter.see(particle.heat, particle.mobility > 0.0),
            }
        };
        if parallel {
            particles.par_iter().with_min_len(TASK).map(look).collect_into_vec(looks);
        } else {
            looks.clear();
            looks.extend(particles.iter().map(look));
        }
        for (axis, places) in places.iter_mut().enumerate() {
            places.resize(particles.len() + LANES, 0.0);
            let set = |(place, particle): (&mut f32, &Particle<D>)| *place = particle.position[axis] as f32;
            if parallel {
                places.par_iter_mut().zip(particles.par_iter().with_min_len(TASK)).for_each(set);
            } else {
                places.iter_mut().zip(&*particles).for_each(set);
            }
        }
        if let Some(walls) = walls {
            walls.show(matter, looks, time);
        }
    }

    /// Takes down what a step has brought; what it gained is to be given back in the next.
    fn book(&mut self, first: &PassSums, second: &PassSums) {
        let potential = self.pair_potential();
        self.given_back += self.gained;
        self.gained = first.gained + second.gained + potential - self.potential;
        self.potential = potential;
        self.driven += first.driven;
        self.moving = (self.moving - second.stopped).max(1.0);
        self.steps += 1;
    }

    /// Potential of all pairs that have just acted.
    pub(super) fn pair_potential(&self) -> f64 {
        self.desks.iter().map(|desk| desk.potential).sum()
    }

    /// Name of the first particle behind walls.
    fn first_behind_walls(&self) -> u32 {
        self.walls.as_ref().map_or(u32::MAX, |walls| walls.first)
    }
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
