//! The paths of water: the pairs that conduct heat, with ghosts folded into the particles that they mirror.
//!
//! A ghost behind a closed wall holds the pressure of its image: the pair with it is one more path to the image. A ghost
//! behind a wall of given pressure holds twice that pressure less its image's: the pair with it is an opening, through
//! which water enters or leaves. Behind the curved wall of a ring the pressure is that of water which nothing disturbs: each
//! pair that the wall cuts is an opening.

use glam::DVec2;

use crate::balances::groundwater::diagonals::Diagonals;
use crate::balances::groundwater::error::GroundwaterError;
use crate::balances::groundwater::ground::Flow;
use crate::balances::groundwater::numerics::Conduction;
use crate::bonds::pair_list::PairList;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::patch::{Boundary, Face};
use crate::memory::{HeapSize, total};
use crate::space::random_field::between;
use crate::space::wall::PatchId;

/// Walls that a body can have.
pub const MOST_WALLS: usize = 4;

/// Distance of two arms, over their length, up to which they are the same but for rounding of places.
const SAME_ARM: f64 = 1e-9;

/// No path: an opening whose image is its own particle.
pub const NONE: u32 = u32::MAX;

/// A pair across a wall of given pressure. The ghost holds `sign p_image + sum of multiples p_wall`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// The particle.
    pub particle: u32,
    /// What the ghost mirrors; the particle itself where it mirrors nothing.
    pub image: u32,
    /// The path from particle to image, or [`NONE`].
    pub path: u32,
    /// The wall: index into the scene's pressure walls.
    pub wall: u8,
    /// Weight by volume (m^-2).
    pub weight: f64,
    /// Sign with which the ghost follows its image; 0 where it does not.
    pub sign: f64,
    /// How often each wall's pressure counts.
    pub multiples: [f64; MOST_WALLS],
    /// From particle to ghost (m).
    pub arm: DVec2,
}

/// A pair that a curved wall cuts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WayOut {
    /// The particle.
    pub particle: u32,
    /// Weight by volume (m^-2).
    pub weight: f64,
    /// From the particle to the place behind the wall (m).
    pub way: DVec2,
}

/// A path on a diagonal whose vector is not the diagonal's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OddArm {
    /// The particle that sees it so.
    pub from: u32,
    /// The other end.
    pub to: u32,
    /// Its place in the columns that both directions share.
    pub slot: u32,
    /// What its vector is more (m).
    pub more: DVec2,
}

/// Paths in compressed rows, in both directions, with partners in order. What both directions share stands in columns by
/// slot.
#[derive(Debug, Clone, Default)]
pub struct Network {
    /// Start of each particle's paths, and the end of the last.
    pub starts: Vec<usize>,
    /// The first of each particle's paths to a later particle.
    pub laters: Vec<usize>,
    /// The particle at the other end.
    pub partners: Vec<u32>,
    /// Place in the columns that both directions share.
    pub slots: Vec<u32>,
    /// Places of those columns.
    pub places: usize,
    /// How they are ordered, on a lattice; otherwise by the earlier particle.
    pub diagonals: Option<Diagonals>,
    /// Weight by volume (m^-2) with which the path conducts water, by slot.
    pub weights: Vec<f64>,
    /// Least conductance of heat by volume (W/m3K), by slot; odd images behind walls of given temperature count
    /// against.
    pub least_conductances: Vec<f64>,
    /// Weight (m^-2) of the images alone that follow their particles, by slot; empty where conduction is not corrected.
    pub even_weights: Vec<f64>,
    /// Mean vector of the path (m), a way over a closed wall as it is seen from this end; empty on diagonals.
    pub arms: Vec<DVec2>,
    /// Vector (m) of the paths of each diagonal, from the earlier particle.
    pub reaches: Vec<DVec2>,
    /// Arms on diagonals that are not their diagonal's.
    pub odd_arms: Vec<OddArm>,
    /// Particles, on diagonals, with a path whose span is not the vector of its diagonal.
    pub aside: Vec<u32>,
    /// The part of the mean vector (m) that both ends see alike, from the earlier particle, by slot.
    pub spans: Vec<DVec2>,
    /// Pairs across walls of given pressure, by particle.
    pub openings: Vec<Opening>,
    /// Patch of the boundary of each pressure wall.
    pub patches: Vec<usize>,
    /// Particles that conduct heat across each patch: particle and patch.
    pub beside: Vec<(u32, u8)>,
}

impl HeapSize for Network {
    fn heap_size(&self) -> usize {
        let rows = total(&[&self.starts, &self.laters, &self.partners, &self.slots]);
        let openings = self.openings.capacity() * size_of::<Opening>();
        let arms = self.odd_arms.capacity() * size_of::<OddArm>() + total(&[&self.arms, &self.reaches, &self.aside]);
        let weights = arms + total(&[&self.weights, &self.least_conductances, &self.even_weights, &self.spans]);
        let places = self.diagonals.as_ref().map_or(0, |diagonals| diagonals.places.heap_size());
        rows + weights + openings + places + total(&[&self.patches, &self.beside])
    }
}

/// One contribution to a path while rows are gathered.
#[derive(Clone, Copy)]
struct Part {
    partner: u32,
    water: f64,
    heat: f64,
    arm: DVec2,
}

/// Weights of paths (m^-2) as each end says them.
#[derive(Default)]
struct EndWeights {
    water: Vec<f64>,
    heat: Vec<f64>,
    even: Vec<f64>,
}

/// What paths are made of.
pub struct NetworkParts<'a> {
    /// Places of particles (m).
    pub positions: &'a [DVec2],
    /// Their pairs.
    pub pairs: &'a PairList,
    /// Those that a curved wall cuts.
    pub ways_out: &'a [WayOut],
    /// What stands behind walls.
    pub ghosts: &'a Ghosts,
    /// Walls.
    pub boundary: &'a Boundary,
    /// Walls at the start.
    pub faces: &'a [Face],
    /// What drives the water.
    pub flow: &'a Flow,
    /// Conduction beside it.
    pub conduction: Conduction,
    /// Least conductivity of each particle's material (W/mK).
    pub least_conductivities: &'a [f64],
    /// How much better the ground of each particle conducts heat than its material; empty where all conducts as its material.
    pub factors: &'a [f64],
}

/// Walls as ghosts mirror them.
struct Mirrors<'a> {
    ghosts: &'a Ghosts,
    boundary: &'a Boundary,
    faces: &'a [Face],
    flow: &'a Flow,
}

impl Network {
    /// The paths of a list of pairs.
    ///
    /// # Errors
    /// Walls for water that the body has not, ghosts that mirror several particles, pairs in one direction only.
    pub fn new(parts: &NetworkParts<'_>) -> Result<Self, GroundwaterError> {
        let NetworkParts {
            positions,
            pairs,
            ways_out,
            ghosts,
            boundary,
            faces,
            flow,
            conduction,
            least_conductivities,
            factors,
        } = *parts;
        let mirrors = Mirrors { ghosts, boundary, faces, flow };
        let mut network = Network { starts: vec![0], patches: mirrors.patches()?, ..Network::default() };
        let (mut row, mut weights) = (Vec::new(), EndWeights::default());
        for i in 0..positions.len() {
            row.clear();
            let first_opening = network.openings.len();
            network.gather(i, positions, pairs, &mirrors, &mut row)?;
            network.merge(i, &mut row, first_opening, &mut weights);
        }
        network.let_out(positions, ways_out, flow);
        network.beside.sort_unstable();
        network.beside.dedup();
        network.pair_up(positions)?;
        network.weights = network.by_slot(&weights.water);
        network.straighten();
        let mut conductances = network.by_slot(&weights.heat);
        network.each_path(|i, j, slot| conductances[slot] *= least_conductivities[i].min(least_conductivities[j]));
        if !factors.is_empty() {
            network.each_path(|i, j, slot| conductances[slot] *= between(factors[i], factors[j]));
        }
        network.least_conductances = conductances;
        if conduction == Conduction::Corrected {
            network.even_weights = network.by_slot(&weights.even);
        }
        Ok(network)
    }

    /// Gathers what the pairs of a particle add to its paths, and its openings.
    fn gather(
        &mut self,
        i: usize,
        positions: &[DVec2],
        pairs: &PairList,
        mirrors: &Mirrors<'_>,
        row: &mut Vec<Part>,
    ) -> Result<(), GroundwaterError> {
        let count = positions.len();
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            let (partner, weight) = (pairs.partners[k], pairs.weights[k]);
            let Some(ghost) = (partner as usize).checked_sub(count) else {
                let arm = positions[partner as usize] - positions[i];
                row.push(Part { partner, water: weight, heat: weight, arm });
                continue;
            };
            let chain = Chain::of(ghost, count, mirrors)?;
            let arm = mirrors.ghosts.position[ghost] - positions[i];
            let water = if chain.wall.is_some() { 0.0 } else { weight };
            row.push(Part { partner: chain.image, water, heat: chain.heat * weight, arm });
            if let Some(wall) = chain.wall {
                self.openings.push(Opening {
                    particle: i as u32,
                    image: chain.image,
                    path: NONE,
                    wall: wall as u8,
                    weight,
                    sign: chain.sign,
                    multiples: chain.multiples,
                    arm,
                });
            }
            if let Some(patch) = mirrors.ghosts.pays[ghost] {
                self.beside.push((i as u32, patch));
            }
        }
        Ok(())
    }

    /// Makes paths of what has been gathered for a particle, one for each partner, and joins its openings to them.
    fn merge(&mut self, i: usize, row: &mut [Part], first_opening: usize, weights: &mut EndWeights) {
        row.sort_by_key(|part| part.partner);
        for group in row.chunk_by(|a, b| a.partner == b.partner) {
            let partner = group[0].partner;
            if partner as usize == i {
                continue;
            }
            let water: f64 = group.iter().map(|part| part.water).sum();
            let arm: DVec2 = group.iter().map(|part| part.water * part.arm).sum();
            self.partners.push(partner);
            self.arms.push(if water > 0.0 { arm / water } else { DVec2::ZERO });
            weights.water.push(water);
            weights.heat.push(group.iter().map(|part| part.heat).sum());
            weights.even.push(group.iter().map(|part| part.heat.max(0.0)).sum());
        }
        let start = self.starts[i];
        for opening in &mut self.openings[first_opening..] {
            if let Ok(place) = self.partners[start..].binary_search(&opening.image) {
                opening.path = (start + place) as u32;
            }
        }
        self.starts.push(self.partners.len());
    }

    /// Opens the pairs that a curved wall cuts to water that nothing disturbs behind it.
    fn let_out(&mut self, positions: &[DVec2], ways_out: &[WayOut], flow: &Flow) {
        let Some((across, patch)) = flow.across.as_ref().zip(self.patches.first().copied()) else { return };
        for out in ways_out {
            let mut multiples = [0.0; MOST_WALLS];
            multiples[0] = across.share(positions[out.particle as usize] + out.way);
            self.openings.push(Opening {
                particle: out.particle,
                image: out.particle,
                path: NONE,
                wall: 0,
                weight: out.weight,
                sign: 0.0,
                multiples,
                arm: out.way,
            });
            self.beside.push((out.particle, patch as u8));
        }
    }

    /// Gives both directions of each path one slot.
    fn pair_up(&mut self, positions: &[DVec2]) -> Result<(), GroundwaterError> {
        let count = self.starts.len() - 1;
        self.diagonals = Diagonals::of(&self.starts, &self.partners, positions);
        self.places = self.diagonals.as_ref().map_or(self.partners.len() / 2, Diagonals::slots);
        self.slots = vec![NONE; self.partners.len()];
        self.spans = vec![DVec2::ZERO; self.places];
        let mut next = 0;
        for i in 0..count {
            let row = self.starts[i]..self.starts[i + 1];
            self.laters.push(row.start + self.partners[row.clone()].partition_point(|j| (*j as usize) < i));
            for k in self.laters[i]..row.end {
                let j = self.partners[k] as usize;
                let back = &self.partners[self.starts[j]..self.starts[j + 1]];
                let Ok(place) = back.binary_search(&(i as u32)) else {
                    return Err(GroundwaterError::OneWay);
                };
                let twin = self.starts[j] + place;
                let slot = self.diagonals.as_ref().map_or(next, |diagonals| diagonals.slot(i, j));
                next += 1;
                (self.slots[k], self.slots[twin]) = (slot as u32, slot as u32);
                self.spans[slot] = 0.5 * (self.arms[k] - self.arms[twin]);
            }
        }
        if self.slots.contains(&NONE) {
            return Err(GroundwaterError::OneWay);
        }
        if let Some(diagonals) = &mut self.diagonals {
            let length = |slots: &[DVec2]| slots.iter().map(|span| span.length()).fold(0.0, f64::max);
            let lengths: Vec<f64> = self.spans.chunks(diagonals.stride).map(length).collect();
            let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
            diagonals.nearest = (0..lengths.len()).filter(|number| lengths[*number] < 1.1 * shortest).collect();
        }
        Ok(())
    }

    /// On diagonals, keeps of all arms what those of a diagonal have alike, and the others.
    pub(super) fn straighten(&mut self) {
        let Some(diagonals) = &self.diagonals else { return };
        let diagonal = |slot: u32| slot as usize / diagonals.stride;
        let is_same = |a: DVec2, b: DVec2| a.distance(b) <= SAME_ARM * a.length();
        self.reaches = vec![DVec2::ZERO; diagonals.offsets.len()];
        for i in 0..self.len() {
            for k in self.laters[i]..self.starts[i + 1] {
                let (arm, slot) = (self.arms[k], self.slots[k]);
                let reach = &mut self.reaches[diagonal(slot)];
                // Both ends see it alike.
                if *reach == DVec2::ZERO && is_same(arm, self.spans[slot as usize]) {
                    *reach = arm;
                }
            }
        }
        for i in 0..self.len() {
            for k in self.starts[i]..self.starts[i + 1] {
                let (arm, slot) = (self.arms[k], self.slots[k]);
                let reach = self.reaches[diagonal(slot)];
                // What no water passes has no part in any sum.
                if self.weights[slot as usize] == 0.0 {
                    continue;
                }
                if !is_same(self.spans[slot as usize], reach) {
                    self.aside.push(i as u32);
                }
                let reach = if k < self.laters[i] { -reach } else { reach };
                if !is_same(arm, reach) {
                    self.odd_arms.push(OddArm { from: i as u32, to: self.partners[k], slot, more: arm - reach });
                }
            }
        }
        self.aside.dedup();
        self.arms = Vec::new();
    }

    /// What the earlier particle of each path says of it, by slot.
    fn by_slot(&self, values: &[f64]) -> Vec<f64> {
        let mut column = vec![0.0; self.places];
        for i in 0..self.len() {
            for k in self.laters[i]..self.starts[i + 1] {
                column[self.slots[k] as usize] = values[k];
            }
        }
        column
    }

    /// All partners of a particle, with slots and whether they are later ones.
    #[inline]
    pub fn paths(&self, particle: usize) -> impl Iterator<Item = (usize, usize, bool)> + '_ {
        let (range, later) = (self.starts[particle]..self.starts[particle + 1], self.laters[particle]);
        range.map(move |k| (self.partners[k] as usize, self.slots[k] as usize, k >= later))
    }

    /// Does something to every path once, by its earlier and its later end and its slot, in the order of the earlier ends.
    #[inline(always)]
    pub fn each_path(&self, mut one: impl FnMut(usize, usize, usize)) {
        for i in 0..self.len() {
            for k in self.laters[i]..self.starts[i + 1] {
                one(i, self.partners[k] as usize, self.slots[k] as usize);
            }
        }
    }

    /// Which particles water can reach from walls of given pressure.
    pub fn reached(&self) -> Vec<bool> {
        let mut reached = vec![false; self.len()];
        let mut next: Vec<usize> = self.openings.iter().map(|opening| opening.particle as usize).collect();
        while let Some(i) = next.pop() {
            if !std::mem::replace(&mut reached[i], true) {
                next.extend(self.paths(i).filter(|(_, slot, _)| self.weights[*slot] > 0.0).map(|(j, ..)| j));
            }
        }
        reached
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What a ghost holds, through all its mirrors.
struct Chain {
    image: u32,
    wall: Option<usize>,
    sign: f64,
    multiples: [f64; MOST_WALLS],
    heat: f64,
}

impl Mirrors<'_> {
    /// Patches of the walls for water.
    fn patches(&self) -> Result<Vec<usize>, GroundwaterError> {
        let walls = self.flow.walls.iter().map(|wall| wall.wall);
        walls.map(|wall| self.boundary.whole(wall).ok_or(GroundwaterError::NoWall(wall))).collect()
    }

    /// The wall for water at a patch.
    fn wall(&self, patch: usize) -> Option<usize> {
        self.flow.walls.iter().position(|wall| PatchId::Whole(wall.wall) == self.boundary.patches[patch].id)
    }
}

impl Chain {
    fn of(mut ghost: usize, count: usize, mirrors: &Mirrors<'_>) -> Result<Self, GroundwaterError> {
        let mut chain = Chain { image: 0, wall: None, sign: 1.0, multiples: [0.0; MOST_WALLS], heat: 1.0 };
        loop {
            if let Some(patch) = mirrors.ghosts.patch[ghost] {
                chain.heat *= -mirrors.faces[patch as usize].stiffness();
                if let Some(wall) = mirrors.wall(patch as usize) {
                    chain.wall = chain.wall.or(Some(wall));
                    chain.multiples[wall] += 2.0 * chain.sign;
                    chain.sign = -chain.sign;
                }
            }
            let original = mirrors.ghosts.original(ghost).ok_or(GroundwaterError::FittedWall)?;
            match (original as usize).checked_sub(count) {
                Some(parent) => ghost = parent,
                None => {
                    chain.image = original;
                    return Ok(chain);
                }
            }
        }
    }
}

impl Opening {
    /// The part of the ghost's pressure (Pa) that walls hold.
    #[inline]
    pub fn wall_part(&self, walls: &[f64]) -> f64 {
        self.multiples.iter().zip(walls).map(|(multiple, pressure)| multiple * pressure).sum()
    }
}

#[cfg(test)]
pub(super) mod tests;
