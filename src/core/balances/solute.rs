//! A solute that water carries through the ground.
//!
//! By its volume particle i holds `M = (theta + s) C`: the water content theta and what the grains hold, s, times the
//! concentration C in the water. It gains from each entry of its row in a list of pairs what diffusion brings and what water
//! carries, `dM_i/dt = sum_k [w_k D (C_j - C_i) + F_k C_k] - decay M_i`, with the weights w of the pairs and the water F that another
//! balance has made of them. As `sum_k F_k = d theta_i/dt`, an even concentration stays even whatever water does.
//!
//! Images behind a wall of given concentration are twice that less what they mirror; behind all others they are what they
//! mirror. Water that enters through a wall has its concentration, or none; water that leaves has the particle's. No solute
//! crosses curved walls, and walls that touch a body of shells.

mod advance;
pub mod advection;
mod dispersion;
mod image;
mod limit;

mod pairs;
#[cfg(test)]
mod tests;
mod walls;

use crate::balances::row::Row;
use crate::balances::solute::advection::Advection;
use crate::balances::solute::image::Image;
use crate::balances::solute::pairs::{Pairs, Sums};
use crate::balances::solute::walls::Walls;
use crate::kernels::list_parts::ListParts;
use crate::ledger::Source;
use crate::memory::{HeapSize, total};
use crate::physics::solute_material::SoluteMaterial;
use crate::saved::{Pass, Saved};
use crate::series::Series;
use crate::solvers::balance::BalanceFacts;
use crate::solvers::passenger::{Interval, Passenger};
use crate::solvers::sharp::just_before;
use crate::solvers::step::{Bound, Clock};
use crate::space::wall::PatchId;

/// What a solute is made from.
pub struct SoluteParts {
    /// Particles, pairs and walls.
    pub list: ListParts,
    /// What each material does to the solute, in the order of the list's.
    pub materials: Vec<SoluteMaterial>,
    /// What enters through each patch of the list; none where no solute crosses but what water takes out.
    pub walls: Vec<Option<Entering>>,
    /// Which concentration water carries.
    pub advection: Advection,
}

/// A solute beyond a wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Entering {
    /// Its concentration.
    pub concentration: Series,
    /// Whether it diffuses through the wall too, and not only comes with water.
    pub diffuses: bool,
}

/// Why parts make no solute.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SoluteError {
    /// Concentrations for another number of walls.
    #[error("concentrations of {found} walls are given, and the body has {allowed}")]
    Walls {
        /// How many are given.
        found: usize,
        /// How many there are.
        allowed: usize,
    },
    /// A particle has a material that is not described.
    #[error("a particle has material {found}, and {allowed} materials are described")]
    Materials {
        /// The material, from 0.
        found: usize,
        /// How many are described.
        allowed: usize,
    },
    /// A wall that is a mirror to all pairs.
    #[error("wall {0} has a concentration, and nothing crosses it")]
    Closed(PatchId),
}

/// The balance of a solute. Its contents stand where others have enthalpies, and concentrations where those have
/// potentials; walls take and give it by volume, like the contents.
///
/// Water is given interval by interval ([`Passenger`]); steps lie within one, and the bound of the step is that of the
/// interval. Solvers that keep rates from one step to the next are to be told of a new one by their clock, as when walls turn.
pub struct Solute {
    list: ListParts,
    materials: Vec<SoluteMaterial>,
    images: Vec<Image>,
    walls: Walls,
    pairs: Pairs,
    /// The interval: when it begins and how long it is (s), and water contents at both ends.
    start: f64,
    step: f64,
    contents: [Vec<f64>; 2],
    /// When the last step began, as far as rates were asked for (s).
    began: f64,
    /// Concentrations of particles and ghosts, or small changes of them.
    concentrations: Vec<f64>,
    changes: Vec<f64>,
    /// What particles hold for a concentration of one, at the last time.
    holds: Vec<f64>,
    rows: Vec<Row>,
    limits: Vec<(f64, f64)>,
    limited: Vec<bool>,
    rate: Vec<f64>,
    decays: bool,
    facts: BalanceFacts,
}

impl Solute {
    /// A solute in water that stands still, with these water contents.
    pub fn new(parts: SoluteParts, contents: &[f64]) -> Result<Self, SoluteError> {
        let SoluteParts { list, materials, walls: entering, advection } = parts;
        let (count, patches) = (list.positions.len(), &list.boundary.patches);
        if entering.len() != patches.len() {
            return Err(SoluteError::Walls { found: entering.len(), allowed: patches.len() });
        }
        let last = (0..count).map(|i| list.materials.index(i)).max().unwrap_or(0);
        if last >= materials.len() {
            return Err(SoluteError::Materials { found: last, allowed: materials.len() });
        }
        let is_closed = |patch: usize| !(list.boundary.books_all || patches[patch].lets_heat_through());
        if let Some(closed) = (0..patches.len()).find(|patch| entering[*patch].is_some() && is_closed(*patch)) {
            return Err(SoluteError::Closed(patches[closed].id));
        }
        let held: Vec<bool> = entering.iter().map(|own| own.as_ref().is_some_and(|own| own.diffuses)).collect();
        let images = Image::all(&list, &held);
        let walls = Walls::new(&list, entering, held, &images);
        let pairs = Pairs::new(&list, &materials, advection, &walls.mouths, &images);
        let decays = materials.iter().any(|material| material.decay > 0.0);
        let sources = patches.iter().map(|patch| Source::Patch(patch.id));
        let sources = sources.chain(decays.then_some(Source::Decay)).collect();
        let bound = Bound::strict(f64::INFINITY, "");
        let facts = BalanceFacts { patches: sources, pairs: list.pair_count(), surfaces: 0, bound, turning: 0.0 };
        let mut solute = Solute {
            concentrations: vec![0.0; count + list.ghosts.len()],
            changes: vec![0.0; count + list.ghosts.len()],
            holds: vec![0.0; count],
            limits: vec![(1.0, 1.0); count],
            limited: vec![false; count],
            rows: vec![Row::default(); count],
            rate: vec![0.0; count],
            start: 0.0,
            step: 0.0,
            began: 0.0,
            contents: [contents.to_vec(), contents.to_vec()],
            list,
            materials,
            images,
            walls,
            pairs,
            decays,
            facts,
        };
        solute.follow();
        Ok(solute)
    }

    /// Concentration of a particle that holds so much of the solute, at a time (s) within the interval.
    pub fn concentration(&self, particle: usize, content: f64, time: f64) -> f64 {
        concentration(content, self.holding(particle, self.share(time)))
    }

    /// The same of all particles.
    pub fn concentrations(&self, contents: &[f64], time: f64, concentrations: &mut [f64]) {
        let share = self.share(time);
        for (i, (found, content)) in concentrations.iter_mut().zip(contents).enumerate() {
            *found = concentration(*content, self.holding(i, share));
        }
    }

    /// Content of a particle of this concentration, at a time (s) within the interval.
    pub fn content(&self, particle: usize, concentration: f64, time: f64) -> f64 {
        concentration * self.holding(particle, self.share(time))
    }

    /// How much of the interval is over at a time (s).
    fn share(&self, time: f64) -> f64 {
        if self.step > 0.0 { ((time - self.start) / self.step).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// What a particle holds for a concentration of one.
    #[inline]
    fn holding(&self, particle: usize, share: f64) -> f64 {
        let [first, last] = [&self.contents[0], &self.contents[1]].map(|contents| contents[particle]);
        first + share * (last - first) + self.material(particle).sorption
    }

    #[inline]
    fn material(&self, particle: usize) -> &SoluteMaterial {
        &self.materials[self.list.materials.index(particle)]
    }

    /// The time (s) of the state that rates are asked for: rates at the end of a step are asked for just before it, for walls
    /// that jump there.
    fn state_time(&mut self, clock: &Clock) -> f64 {
        if clock.time == just_before(self.began, clock.step) {
            return self.began + clock.step;
        }
        self.began = clock.time;
        clock.time
    }

    /// Pairs, the bound and the turning of new water.
    fn follow(&mut self) {
        let Solute { list, materials, images, walls, pairs, contents: [first, last], facts, .. } = self;
        pairs.follow(list, materials, images, walls, |i| 0.5 * (first[i] + last[i]));
        let material = |i: usize| &materials[list.materials.index(i)];
        let least = |i: usize| (first[i].min(last[i]) + material(i).sorption, material(i).decay);
        let Sums { greatest: (rate, particle), turning } = pairs.sums(list, walls, least);
        let at = list.positions[particle];
        let cause = format!("solute of particle {particle} at ({:.6}, {:.6}) m", at.x, at.y);
        facts.bound = Bound::strict(if rate > 0.0 { 1.0 / rate } else { f64::INFINITY }, cause);
        facts.turning = turning;
    }
}

/// Nothing is dissolved where there is nothing to hold it.
#[inline]
fn concentration(content: f64, holds: f64) -> f64 {
    if holds > 0.0 { content / holds } else { 0.0 }
}

impl Passenger for Solute {
    fn take(&mut self, interval: &Interval<'_>) {
        (self.start, self.step) = (interval.start, interval.step);
        self.pairs.flows.copy_from_slice(interval.flows);
        self.contents[0].copy_from_slice(interval.contents.0);
        self.contents[1].copy_from_slice(interval.contents.1);
        self.follow();
    }

    fn potentials(&self, contents: &[f64], potentials: &mut [f64]) {
        self.concentrations(contents, self.start + self.step, potentials);
    }
}

impl Saved for Solute {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.list.pass(pass);
        // The interval that was made last: the next one brings its own water.
        pass.all(&mut [
            &mut self.start,
            &mut self.step,
            &mut self.began,
            &mut self.contents,
            &mut self.facts.bound.step,
            &mut self.facts.turning,
        ]);
    }
}

impl HeapSize for Solute {
    fn heap_size(&self) -> usize {
        let ghosts = self.images.capacity() * size_of::<Image>();
        let rows = self.rows.capacity() * size_of::<Row>();
        let columns = total(&[&self.contents, &self.concentrations, &self.changes, &self.holds, &self.rate]);
        let parts = &self.list;
        let pairs = total(&[&parts.pairs.starts, &parts.pairs.partners, &parts.pairs.weights]);
        let list = pairs + parts.cuts.heap_size() + parts.ghosts.heap_size();
        ghosts
            + rows
            + columns
            + list
            + self.walls.heap_size()
            + self.pairs.heap_size()
            + total(&[&self.limits, &self.limited])
    }
}
