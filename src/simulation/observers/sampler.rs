//! Points of a body as weighted sums over its particles.

use frazil_core::boundary::patch::moving_least_squares;
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

/// Turns points into samples: bilinear on a lattice, moving least squares elsewhere.
pub(super) struct Sampler<'a> {
    pub(super) lattice: &'a Lattice,
    mirrors: (bool, bool),
    cloud: Option<&'a [DVec2]>,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(scene: &Scene, particles: &'a Particles) -> Self {
        let mirrors = match scene.domain {
            Domain::Ring { sector, .. } => (sector == Sector::Quarter, sector != Sector::Whole),
            _ => (false, false),
        };
        Sampler { lattice: &particles.lattice, mirrors, cloud: particles.cloud() }
    }

    /// Of particles that move about, where they stand now.
    pub(super) fn free(particles: &'a Particles) -> Self {
        Sampler { lattice: &particles.lattice, mirrors: (false, false), cloud: particles.cloud() }
    }

    pub(super) fn sample(&self, place: DVec2) -> Sample {
        self.samples(&[place]).pop().unwrap_or_default()
    }

    /// Samples of many points, which share one search.
    pub(super) fn samples(&self, places: &[DVec2]) -> Vec<Sample> {
        match self.cloud {
            Some(positions) => self.fitted(positions, places),
            None => places.iter().map(|place| self.bilinear(*place)).collect(),
        }
    }

    /// The four cells around a point, folded at mirror planes and clamped at walls.
    fn bilinear(&self, place: DVec2) -> Sample {
        let cells = self.lattice.to_cells(place);
        let base = cells.floor();
        let part = cells - base;
        let mut entries: Vec<(u32, f64)> = Vec::with_capacity(4);
        let mut missing = 0.0;
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let weight = (if dx == 1 { part.x } else { 1.0 - part.x }) * (if dy == 1 { part.y } else { 1.0 - part.y });
            if weight == 0.0 {
                continue;
            }
            let fold = |mirror: bool, cell: i64| if mirror && cell < 0 { -1 - cell } else { cell };
            let column = fold(self.mirrors.0, base.x as i64 + dx).clamp(0, self.lattice.columns as i64 - 1);
            let row = fold(self.mirrors.1, base.y as i64 + dy).clamp(0, self.lattice.rows as i64 - 1);
            match self.lattice.index(column, row) {
                Some(index) => entries.push((index as u32, weight)),
                None => missing += weight,
            }
        }
        if missing > 0.0 && missing < 1.0 {
            entries.iter_mut().for_each(|entry| entry.1 /= 1.0 - missing);
        }
        Sample(entries)
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
                let near: Vec<u32> = list.of(row).iter().filter_map(|j| j.checked_sub(count as u32)).collect();
                if near.len() <= self.lattice.dimension + 1 && near.len() < positions.len() {
                    few.push(*k);
                    continue;
                }
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
