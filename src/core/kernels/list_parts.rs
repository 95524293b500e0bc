//! What the rows of a list are made from, and the bound of their step.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use crate::bonds::exchange::Exchange;
use crate::bonds::pair_list::PairList;
use crate::boundary::curved_wall::Rim;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::interface::{Chains, Way};
use crate::boundary::patch::{Boundary, Face};
use crate::boundary::pipe::Sink;
use crate::boundary::shells::Touch;
use crate::breakage::cuts::{Cuts, Cutting};
use crate::physics::latent_heat::Materials;
use crate::saved::{Pass, Saved};
use crate::solvers::step::Bound;
use crate::space::domain::Surface;
use crate::space::volumes::Volumes;
use crate::team::{Team, share};

/// Everything a list operator is made from.
#[derive(Clone)]
pub struct ListParts {
    /// Positions of particles (m).
    pub positions: Arc<[DVec2]>,
    /// Volumes of particles.
    pub volumes: Volumes,
    /// Spacing (m).
    pub spacing: f64,
    /// Materials.
    pub materials: Materials,
    /// How much better the ground of each particle conducts than its material; empty where all conducts as its material. Pairs and
    /// walls are those of even ground until rows are made of them.
    pub factors: Arc<[f64]>,
    /// Pairs.
    pub pairs: PairList,
    /// Those of several materials.
    pub chains: Chains,
    /// What cracks and shafts do to them.
    pub cuts: Cuts,
    /// Ghosts.
    pub ghosts: Ghosts,
    /// Walls.
    pub boundary: Boundary,
    /// Contacts with curved walls.
    pub rims: Vec<Rim>,
    /// Where walls touch a body of shells.
    pub touches: Vec<Touch>,
    /// Pipes.
    pub sinks: Vec<Sink>,
    /// How many rings of pipes there are.
    pub rings: usize,
    /// Surfaces through which heat is counted.
    pub surfaces: Vec<Surface>,
    /// Upwards, where gravity moves what pairs exchange.
    pub up: Option<DVec2>,
    /// How pairs exchange heat.
    pub exchange: Exchange,
    /// Threads, if more than one.
    pub team: Option<Team>,
    /// The bound of the step, where it is known from elsewhere.
    pub bound: Option<Bound>,
}

/// Particles that one task handles; fixed, so that results do not depend on the number of threads.
const TASK: usize = 2048;

/// Particles from which on threads share them: work on fewer is over before it is shared.
const MANY: usize = 8 * TASK;

impl Saved for ListParts {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        Cutting { cuts: &mut self.cuts, weights: &mut self.pairs.weights }.pass(pass);
    }
}

impl ListParts {
    /// Fills rows in tasks, each from a first particle on, side by side where there is a team and enough to do.
    #[inline(always)]
    pub(crate) fn in_tasks<R: Send>(&self, rows: &mut [R], fill: impl Fn(usize, &mut [R]) + Sync) {
        self.in_tasks_of(TASK, rows, fill);
    }

    /// The same in tasks of a length.
    #[inline(always)]
    pub(super) fn in_tasks_of<R: Send>(&self, length: usize, rows: &mut [R], fill: impl Fn(usize, &mut [R]) + Sync) {
        let task = |(number, rows): (usize, &mut [R])| fill(number * length, rows);
        share(self.team.as_ref().filter(|_| rows.len() > MANY), rows.chunks_mut(length).enumerate(), task);
    }

    /// Threads that share the particles.
    pub(super) fn threads(&self) -> usize {
        let shares = self.positions.len() > MANY;
        self.team.as_ref().filter(|_| shares).map_or(1, Team::threads)
    }

    /// Fills values of entries row by row, in tasks as [`ListParts::in_tasks`] has them.
    pub(crate) fn in_rows(&self, entries: &mut [f64], fill: impl Fn(usize, &mut [f64]) + Sync) {
        let (starts, count) = (&self.pairs.starts, self.positions.len());
        let (mut tasks, mut rest) = (Vec::with_capacity(count.div_ceil(TASK)), entries);
        for first in (0..count).step_by(TASK) {
            let rows = first..(first + TASK).min(count);
            let (task, more) = rest.split_at_mut(starts[rows.end] - starts[first]);
            tasks.push((rows, task));
            rest = more;
        }
        let one = |(rows, mut task): (Range<usize>, &mut [f64])| {
            for i in rows {
                let (row, more) = task.split_at_mut(starts[i + 1] - starts[i]);
                fill(i, row);
                task = more;
            }
        };
        share(self.team.as_ref().filter(|_| count > MANY), tasks.into_iter(), one);
    }

    /// Keeps some of the entries of the list, all of those among them whose weights change.
    pub(super) fn keep(&mut self, keeps: impl Fn(usize) -> bool) {
        let PairList { starts, partners, weights } = &mut self.pairs;
        let of_pair = &mut self.chains.of_pair;
        let mut kept = 0;
        let mut numbers = HashMap::new();
        let changing: HashSet<usize> = self.cuts.places().collect();
        for row in 0..self.positions.len() {
            let entries = starts[row]..starts[row + 1];
            starts[row] = kept;
            // The end of a row is the start of the next one, which is still to be read.
            for entry in entries.filter(|entry| keeps(*entry)) {
                (partners[kept], weights[kept]) = (partners[entry], weights[entry]);
                if let Some(chain) = of_pair.get(entry).copied() {
                    of_pair[kept] = chain;
                }
                if changing.contains(&entry) {
                    numbers.insert(entry, kept);
                }
                kept += 1;
            }
        }
        starts[self.positions.len()] = kept;
        partners.truncate(kept);
        partners.shrink_to_fit();
        weights.truncate(kept);
        weights.shrink_to_fit();
        of_pair.truncate(kept);
        of_pair.shrink_to_fit();
        self.cuts.renumber(&numbers);
    }

    /// The bound of the step.
    pub(super) fn step_bound(&self) -> Bound {
        let first = &self.materials.thermals[0];
        let faces = || self.boundary.first_faces(&first.curve, first.zero_potential);
        self.bound.clone().unwrap_or_else(|| bound(self, &faces()))
    }

    /// Pairs, each once.
    pub fn pair_count(&self) -> u64 {
        let count = self.positions.len();
        let inner = self.pairs.partners.iter().filter(|j| (**j as usize) < count).count();
        (inner / 2 + self.pairs.partners.len() - inner) as u64
    }
}

/// The largest slope dU/dH (m2/s) of a particle. Pair means act with conductivities of either partner, so there it is the
/// largest of all over the least capacity.
pub(super) fn steepest(parts: &ListParts, particle: usize) -> f64 {
    let thermal = parts.materials.of(particle);
    match parts.exchange {
        Exchange::Potential => thermal.largest_slope,
        Exchange::Mean(_) | Exchange::Upstream => {
            let most =
                parts.materials.thermals.iter().map(|thermal| thermal.curve.most_conductive()).fold(0.0, f64::max);
            most / thermal.curve.least_capacity()
        }
    }
}

/// Row sums (m^-2) of all particles, with what walls and pipes add to them at most.
pub(super) fn row_sums(parts: &ListParts, faces: &[Face]) -> Vec<f64> {
    let count = parts.positions.len();
    let mirrored = parts.ghosts.mirrored(count, faces);
    // How a ghost falls when the particle rises: through any number of mirrors, or by its share in a fit.
    let falls = |ghost: usize, particle: u32| match mirrored[ghost] {
        Some((own, factor)) if own == particle => -factor,
        Some(_) => 0.0,
        None => parts.ghosts.own_share(ghost, particle, faces),
    };
    let thermals = &parts.materials.thermals;
    // How much more than within one material a pair follows its particle and its partner.
    let shares = |i: usize, k: usize| match parts.chains.of_pair(k, thermals).map(|way| way.greatest_shares()) {
        None => (1.0, 1.0),
        Some((near, far)) if i < parts.pairs.partners[k] as usize => (near, far),
        Some((near, far)) => (far, near),
    };
    let mut sums: Vec<f64> = (0..count)
        .map(|i| {
            let range = parts.pairs.starts[i]..parts.pairs.starts[i + 1];
            let own: f64 = range.clone().map(|k| parts.pairs.weights[k] * shares(i, k).0).sum();
            let mirrored: f64 = range
                .filter_map(|k| (parts.pairs.partners[k] as usize).checked_sub(count).map(|ghost| (k, ghost)))
                .map(|(k, ghost)| {
                    let falls = falls(ghost, i as u32);
                    match parts.chains.of_ghost(ghost, thermals).map(|way| way.greatest_shares()) {
                        None => parts.pairs.weights[k] * shares(i, k).1 * falls,
                        Some((_, far)) => parts.pairs.weights[k] * shares(i, k).1 * far * falls.max(0.0),
                    }
                })
                .sum();
            own + mirrored.max(0.0)
        })
        .collect();
    for (particle, growth) in parts.cuts.growing() {
        sums[*particle as usize] *= growth;
    }
    let from_wall = |way: Option<Way<'_>>| way.map_or(1.0, |way| way.greatest_shares().1);
    for (number, rim) in parts.rims.iter().enumerate() {
        for contact in &rim.contacts.contacts {
            let share = from_wall(parts.chains.of_rim(number, contact.particle as usize, thermals));
            sums[contact.particle as usize] += faces[rim.patch].holds() * contact.stiffness * share;
        }
    }
    for (number, touch) in parts.touches.iter().enumerate() {
        let share = from_wall(parts.chains.of_touch(number, thermals));
        sums[touch.particle as usize] += faces[touch.patch as usize].holds() * touch.area / touch.depth * share;
    }
    for sink in &parts.sinks {
        for (index, row_sum) in sink.row_sums(parts.spacing) {
            sums[index] += row_sum;
        }
    }
    sums
}

fn bound(parts: &ListParts, faces: &[Face]) -> Bound {
    let mut stiffest = (0.0, 0usize);
    for (i, sum) in row_sums(parts, faces).iter().enumerate() {
        let slope = steepest(parts, i);
        if sum * slope > stiffest.0 {
            stiffest = (sum * slope, i);
        }
    }
    let at = parts.positions[stiffest.1];
    let cause = format!("pair exchange of particle {} at ({:.6}, {:.6}) m", stiffest.1, at.x, at.y);
    Bound::strict(if stiffest.0 > 0.0 { 1.0 / stiffest.0 } else { f64::INFINITY }, cause)
}
