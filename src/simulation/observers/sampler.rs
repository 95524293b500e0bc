//! Points of a body as weighted sums over its particles.

use frazil_core::boundary::patch::moving_least_squares;
use frazil_core::breakage::crack::Barriers;
use frazil_core::memory::HeapSize;
use frazil_core::neighbours::tree::Tree;
use frazil_core::neighbours::{NeighbourSearch, Period};
use frazil_core::particles::Particles;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::lattice::Lattice;
use frazil_scene::Scene;
use glam::DVec2;

/// A point read as a weighted sum over particles.
#[derive(Debug, Clone, Default)]
pub(super) struct Sample(pub(super) Vec<(u32, f64)>);

impl Sample {
    pub(super) fn of(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.0.iter().map(|(index, weight)| weight * value(*index as usize)).sum()
    }
}

impl HeapSize for Sample {
    fn heap_size(&self) -> usize {
        self.0.heap_size()
    }
}

/// Cells in each direction among which a point looks for a particle on its side of a barrier.
const FARTHEST: i64 = 4;

/// Turns points into samples: bilinear on a lattice, moving least squares elsewhere; of particles that no barrier parts from the
/// point, and within closed parts of the particles there.
pub(super) struct Sampler<'a> {
    pub(super) lattice: &'a Lattice,
    mirrors: (bool, bool),
    cloud: Option<&'a [DVec2]>,
    /// The scene whose barriers stand, at a time (s).
    parted: Option<(&'a Scene, f64)>,
}

impl<'a> Sampler<'a> {
    /// Of the particles of a scene as its cracks are at a time (s).
    pub(super) fn new(scene: &'a Scene, particles: &'a Particles, time: f64) -> Self {
        let mirrors = match scene.domain {
            Domain::Ring { sector, .. } => (sector == Sector::Quarter, sector != Sector::Whole),
            _ => (false, false),
        };
        let parted = scene.has_barriers().then_some((scene, time));
        Sampler { lattice: &particles.lattice, mirrors, cloud: particles.cloud(), parted }
    }

    /// Of a whole lattice with nothing in it that parts it.
    #[cfg(test)]
    pub(super) fn on(lattice: &'a Lattice) -> Self {
        Sampler { lattice, mirrors: (false, false), cloud: None, parted: None }
    }

    /// Of particles that move about, where they stand now.
    pub(super) fn free(particles: &'a Particles) -> Self {
        Sampler { lattice: &particles.lattice, mirrors: (false, false), cloud: particles.cloud(), parted: None }
    }

    /// What samples are to be taken from at a time (s), where those of the start no longer hold: particles move, or cracks open.
    pub(super) fn anew(scene: &'a Scene, particles: &'a Particles, time: f64) -> Option<Self> {
        if particles.move_about() {
            return Some(Sampler::free(particles));
        }
        (!scene.cracks.is_empty()).then(|| Sampler::new(scene, particles, time))
    }

    /// Where a particle is (m).
    pub(super) fn place(&self, particle: usize) -> DVec2 {
        self.cloud.map_or_else(|| self.lattice.position(particle), |places| places[particle])
    }

    /// Where particles are from which a point is read (m), as mirrors show them, with their weights; nothing parts them from it.
    pub(super) fn seen(&self, point: DVec2, sample: &Sample) -> Vec<(DVec2, f64)> {
        if self.cloud.is_some() {
            return sample.0.iter().map(|(index, weight)| (self.place(*index as usize), *weight)).collect();
        }
        let there = |(column, row, _): &(i64, i64, f64)| self.folded(*column, *row).is_some();
        let corners = self.corners(point).filter(there);
        corners.map(|(column, row, weight)| (self.lattice.centre(column, row), weight)).collect()
    }

    pub(super) fn sample(&self, place: DVec2) -> Sample {
        self.samples(&[place]).pop().unwrap_or_default()
    }

    /// Samples of many points, which share one search.
    pub(super) fn samples(&self, places: &[DVec2]) -> Vec<Sample> {
        match self.cloud {
            Some(positions) => self.fitted(positions, places),
            None => places.iter().map(|place| self.on_lattice(*place)).collect(),
        }
    }

    /// Adds particles that a point is read from, with its share of them times a length (m).
    pub(super) fn add(&self, place: DVec2, length: f64, lengths: &mut Vec<(u32, f64)>) {
        let from = lengths.len();
        match self.cloud.is_none() && self.parted.is_none() {
            true => self.bilinear(place, lengths),
            false => lengths.append(&mut self.sample(place).0),
        }
        lengths[from..].iter_mut().for_each(|entry| entry.1 *= length);
    }

    /// Of these places of particles, which lie on the side of a point.
    fn beside(&self, point: DVec2, places: &[DVec2]) -> Vec<bool> {
        let Some((scene, time)) = self.parted else { return vec![true; places.len()] };
        if scene.is_impermeable_at(point) {
            return places.iter().map(|place| scene.is_impermeable_at(*place)).collect();
        }
        let blocked = |from, to| scene.is_blocked(from, to);
        let barriers = Barriers::inside(&scene.cracks, &blocked, self.lattice.spacing);
        places.iter().map(|place| barriers.between(point, *place) > time).collect()
    }

    /// Bilinear among the particles on the side of a point, or the nearest one there.
    fn on_lattice(&self, place: DVec2) -> Sample {
        let mut whole = Sample(Vec::with_capacity(4));
        self.bilinear(place, &mut whole.0);
        if self.parted.is_none() {
            return whole;
        }
        let places: Vec<DVec2> = whole.0.iter().map(|entry| self.lattice.position(entry.0 as usize)).collect();
        let beside = self.beside(place, &places);
        if !beside.contains(&false) {
            return whole;
        }
        let own: Vec<(u32, f64)> =
            whole.0.iter().zip(&beside).filter(|(_, beside)| **beside).map(|(entry, _)| *entry).collect();
        let sum: f64 = own.iter().map(|entry| entry.1).sum();
        if sum > 0.0 {
            return Sample(own.into_iter().map(|(index, weight)| (index, weight / sum)).collect());
        }
        self.nearest(place).map_or(whole, |nearest| Sample(vec![(nearest, 1.0)]))
    }

    /// The nearest particle on the side of a point.
    fn nearest(&self, place: DVec2) -> Option<u32> {
        let base = self.lattice.to_cells(place).round();
        let near = (-FARTHEST..=FARTHEST).flat_map(|dy| (-FARTHEST..=FARTHEST).map(move |dx| (dx, dy)));
        let cells = near.filter_map(|(dx, dy)| self.lattice.index(base.x as i64 + dx, base.y as i64 + dy));
        let indices: Vec<usize> = cells.collect();
        let places: Vec<DVec2> = indices.iter().map(|index| self.lattice.position(*index)).collect();
        let beside = self.beside(place, &places).into_iter();
        let distances = indices.iter().zip(&places).map(|(index, other)| (*index as u32, (*other - place).length()));
        let own = distances.zip(beside).filter(|(_, beside)| *beside).map(|(entry, _)| entry);
        own.min_by(|a, b| a.1.total_cmp(&b.1)).map(|entry| entry.0)
    }

    /// Adds the four cells around a point, folded at mirror planes and clamped at walls.
    fn bilinear(&self, place: DVec2, entries: &mut Vec<(u32, f64)>) {
        let from = entries.len();
        let mut missing = 0.0;
        for (column, row, weight) in self.corners(place) {
            match self.folded(column, row) {
                Some(index) => entries.push((index as u32, weight)),
                None => missing += weight,
            }
        }
        if missing > 0.0 && missing < 1.0 {
            entries[from..].iter_mut().for_each(|entry| entry.1 /= 1.0 - missing);
        }
    }

    /// Columns and rows of the cells around a point, and their weights.
    fn corners(&self, place: DVec2) -> impl Iterator<Item = (i64, i64, f64)> + use<> {
        let cells = self.lattice.to_cells(place);
        let base = cells.floor();
        let part = cells - base;
        let corner = move |(dx, dy): (i64, i64)| {
            let weight = (if dx == 1 { part.x } else { 1.0 - part.x }) * (if dy == 1 { part.y } else { 1.0 - part.y });
            (base.x as i64 + dx, base.y as i64 + dy, weight)
        };
        [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().map(corner).filter(|corner| corner.2 != 0.0)
    }

    /// The particle of a cell, folded at mirror planes and clamped at walls.
    fn folded(&self, column: i64, row: i64) -> Option<usize> {
        let fold = |mirror: bool, cell: i64| if mirror && cell < 0 { -1 - cell } else { cell };
        let column = fold(self.mirrors.0, column).clamp(0, self.lattice.columns as i64 - 1);
        let row = fold(self.mirrors.1, row).clamp(0, self.lattice.rows as i64 - 1);
        self.lattice.index(column, row)
    }

    fn fitted(&self, positions: &[DVec2], places: &[DVec2]) -> Vec<Sample> {
        let mut found = vec![Sample::default(); places.len()];
        let mut open: Vec<usize> = (0..places.len()).collect();
        let mut range = 2.0 * self.lattice.spacing;
        while !open.is_empty() {
            let count = open.len();
            let points: Vec<DVec2> = open.iter().map(|k| places[*k]).chain(positions.iter().copied()).collect();
            let list = Tree.neighbours(&points, count, range, Period::NONE);
            let mut few = Vec::new();
            for (row, k) in open.iter().enumerate() {
                let all: Vec<u32> = list.of(row).iter().filter_map(|j| j.checked_sub(count as u32)).collect();
                let around: Vec<DVec2> = all.iter().map(|j| positions[*j as usize]).collect();
                let beside = self.beside(places[*k], &around);
                let near: Vec<u32> = all.iter().zip(&beside).filter(|(_, beside)| **beside).map(|(j, _)| *j).collect();
                if near.len() <= self.lattice.dimension + 1 && all.len() < positions.len() {
                    few.push(*k);
                    continue;
                }
                // Nothing may stand on the side of a point in a small closed part.
                let near = if near.is_empty() { all } else { near };
                let around: Vec<DVec2> = near.iter().map(|j| positions[*j as usize]).collect();
                let weights = moving_least_squares(places[*k], &around, 0.6 * range, self.lattice.dimension);
                found[*k] = Sample(near.into_iter().zip(weights).collect());
            }
            open = few;
            range *= 1.5;
        }
        found
    }
}
