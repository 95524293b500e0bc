//! Level sets of a field of a plane body: where it is less than a level, and the contour between.
//!
//! The field is linear in each of the triangles between four neighbouring particles and their mean, and goes on linearly from the
//! outermost particles to straight walls half a spacing away, but for mirrors: areas and contours of a linear field are exact, those of others wrong by
//! the square of the spacing. Beside curved walls, where not all four are there, nothing is counted.

use frazil_core::boundary::condition::Condition;
use frazil_core::memory::{HeapSize, total};
use frazil_core::particles::Particles;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;
use glam::DVec2;

use super::observer::Setup;
use super::sampler::{Sample, Sampler};

/// A field over the particles of a plane.
pub(super) struct LevelSet {
    /// Nodes in either direction: cells of the lattice, and one on each wall.
    columns: usize,
    rows: usize,
    /// Coordinates of nodes (m).
    x: Vec<f64>,
    y: Vec<f64>,
    /// Values of nodes, row by row; NaN where there is none.
    values: Vec<f64>,
    /// Whether the sides towards less and greater x and y are mirrors, across which the field is even.
    mirrors: [[bool; 2]; 2],
    /// Of particles off the lattice that stay, what the cells are read from.
    samples: Vec<Sample>,
}

/// What a level parts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Parted {
    /// Area where the field is less (m2).
    pub(super) below: f64,
    /// Area where it is not (m2).
    pub(super) above: f64,
    /// Length of the contour (m).
    pub(super) length: f64,
}

impl LevelSet {
    pub(super) fn over(setup: &Setup<'_>) -> Self {
        let (particles, lattice) = (setup.particles, &setup.particles.lattice);
        let stays = particles.cloud().is_some() && !particles.move_about();
        let samples = if stays { setup.sampler().samples(&lattice.positions()) } else { Vec::new() };
        LevelSet { samples, ..LevelSet::over_lattice(lattice, mirrors(setup.scene)) }
    }

    fn over_lattice(lattice: &Lattice, mirrors: [[bool; 2]; 2]) -> Self {
        let nodes = |first: f64, count: usize| -> Vec<f64> {
            let inner = (0..count).map(|k| k as f64 + 0.5);
            [0.0].into_iter().chain(inner).chain([count as f64]).map(|k| first + k * lattice.spacing).collect()
        };
        let (x, y) = (nodes(lattice.corner.x, lattice.columns), nodes(lattice.corner.y, lattice.rows));
        let (columns, rows) = (x.len(), y.len());
        LevelSet { columns, rows, x, y, values: vec![f64::NAN; columns * rows], mirrors, samples: Vec::new() }
    }

    /// Takes the values of a field.
    pub(super) fn read(&mut self, particles: &Particles, value: impl Fn(usize) -> f64) {
        let lattice = &particles.lattice;
        let moved = particles.move_about().then(|| Sampler::free(particles).samples(&lattice.positions()));
        match moved {
            Some(samples) => self.fill(lattice, |i| samples[i].of(&value)),
            None if self.samples.is_empty() => self.fill(lattice, value),
            None => {
                let samples = std::mem::take(&mut self.samples);
                self.fill(lattice, |i| samples[i].of(&value));
                self.samples = samples;
            }
        }
    }

    /// Takes the value of each cell of the lattice.
    fn fill(&mut self, lattice: &Lattice, value: impl Fn(usize) -> f64) {
        for row in 0..lattice.rows {
            let (first, end) = lattice.span(row);
            for column in first..end {
                let i = lattice.start(row) + column - first;
                let at = (row + 1) * self.columns + column + 1;
                self.values[at] = value(i);
            }
        }
        // From the outermost cells on to the walls.
        let (columns, rows) = (self.columns, self.rows);
        for row in 1..rows - 1 {
            self.go_on(row * columns, 1, columns, self.mirrors[0]);
        }
        for column in 0..columns {
            self.go_on(column, columns, rows, self.mirrors[1]);
        }
    }

    /// Fills the first and the last of a row of nodes.
    fn go_on(&mut self, first: usize, step: usize, count: usize, mirrors: [bool; 2]) {
        let last = first + (count - 1) * step;
        let ends = [(first, first + step, first + 2 * step), (last, last - step, last - 2 * step)];
        for ((end, near, next), is_mirror) in ends.into_iter().zip(mirrors) {
            // Of a single cell, the next one is the other end.
            let next = if count > 3 && !is_mirror { next } else { near };
            self.values[end] = 1.5 * self.values[near] - 0.5 * self.values[next];
        }
    }

    /// What a level parts; shows each straight piece of the contour by its ends.
    pub(super) fn part(&self, level: f64, mut piece: impl FnMut(DVec2, DVec2)) -> Parted {
        let mut parted = Parted::default();
        for row in 0..self.rows - 1 {
            let [lower, upper] = [row, row + 1].map(|row| &self.values[row * self.columns..][..self.columns]);
            let height = self.y[row + 1] - self.y[row];
            for (column, (lower, upper)) in lower.windows(2).zip(upper.windows(2)).enumerate() {
                let values = [lower[0], lower[1], upper[1], upper[0]];
                if values.iter().any(|value| value.is_nan()) {
                    continue;
                }
                let area = (self.x[column + 1] - self.x[column]) * height;
                match values.iter().filter(|value| **value < level).count() {
                    0 => parted.above += area,
                    4 => parted.below += area,
                    _ => {
                        let share = self.share_below((column, row), values.map(|value| value - level), &mut |a, b| {
                            parted.length += a.distance(b);
                            piece(a, b);
                        });
                        parted.below += share * area;
                        parted.above += (1.0 - share) * area;
                    }
                }
            }
        }
        parted
    }

    /// Part of the area between four nodes, of which the first is given, in which the field is less than a level, by how far above it the
    /// nodes are; shows each piece of the contour.
    fn share_below(&self, (column, row): (usize, usize), above: [f64; 4], piece: &mut impl FnMut(DVec2, DVec2)) -> f64 {
        let nodes = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)];
        let mut corners = [(DVec2::ZERO, 0.0); 4];
        for (corner, ((x, y), above)) in corners.iter_mut().zip(nodes.into_iter().zip(above)) {
            *corner = (DVec2::new(self.x[x], self.y[y]), above);
        }
        let mean = above.iter().sum::<f64>() / 4.0;
        let centre = (corners[0].0 + 0.5 * (corners[2].0 - corners[0].0), mean);
        (0..4).fold(0.0, |share, k| {
            let (below, ends) = cut([corners[k], corners[(k + 1) % 4], centre]);
            if let Some((a, b)) = ends {
                piece(a, b);
            }
            share + 0.25 * below
        })
    }
}

/// Sides of the lattice of a scene that are mirrors.
fn mirrors(scene: &Scene) -> [[bool; 2]; 2] {
    let is_mirror = |wall| scene.is_closed(wall) && scene.wall(wall) != Some(&Condition::Periodic);
    let closed = |walls: [WallId; 2]| walls.map(is_mirror);
    match scene.domain {
        Domain::Ring { sector, .. } => [[sector == Sector::Quarter, false], [sector != Sector::Whole, false]],
        Domain::Axial { .. } => [closed([WallId::Inner, WallId::Outer]), closed(WallId::ends(true))],
        _ => [false, true].map(|along_y| closed(WallId::ends(along_y))),
    }
}

/// The share of a triangle in which a linear field is negative, and the line on which it passes zero.
fn cut(corners: [(DVec2, f64); 3]) -> (f64, Option<(DVec2, DVec2)>) {
    let negative = corners.iter().filter(|corner| corner.1 < 0.0).count();
    // The one corner that differs from the others.
    let alone = corners.iter().position(|corner| (corner.1 < 0.0) == (negative == 1));
    let Some(k) = alone.filter(|_| negative == 1 || negative == 2) else {
        return (f64::from(u8::from(negative == 3)), None);
    };
    let (own, others) = (corners[k], [corners[(k + 1) % 3], corners[(k + 2) % 3]]);
    let parts = others.map(|other| own.1 / (own.1 - other.1));
    let ends = others.map(|other| crossing(own, other));
    let tip = parts[0] * parts[1];
    (if negative == 1 { tip } else { 1.0 - tip }, Some((ends[0], ends[1])))
}

/// Where a linear field passes zero between two places, from the lower on: the same to the bit for all triangles beside an edge.
fn crossing(a: (DVec2, f64), b: (DVec2, f64)) -> DVec2 {
    let (low, high) = if a.1 < 0.0 { (a, b) } else { (b, a) };
    low.0.lerp(high.0, low.1 / (low.1 - high.1))
}

impl HeapSize for LevelSet {
    fn heap_size(&self) -> usize {
        total(&[&self.x, &self.y, &self.values, &self.samples])
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn field(spacing: f64, value: impl Fn(DVec2) -> f64) -> LevelSet {
        let lattice = Lattice::new(&Domain::Rectangle { width: 1.0, height: 0.8 }, spacing);
        let mut field = LevelSet::over_lattice(&lattice, [[false; 2]; 2]);
        field.fill(&lattice, |i| value(lattice.position(i)));
        field
    }

    #[test]
    fn a_linear_field_is_parted_exactly_as_far_as_the_walls() {
        // 2 x + y = 1 from (0.5, 0) to (0.1, 0.8).
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let parted = field(0.1, |place| 2.0 * place.x + place.y).part(1.0, |a, b| {
            (low, high) = (low.min(a.y).min(b.y), high.max(a.y).max(b.y));
            assert!((2.0 * a.x + a.y - 1.0).abs() < 1e-12);
        });
        // Sums of some hundred terms.
        assert!((parted.below - 0.24).abs() < 1e-12 && (parted.above - 0.56).abs() < 1e-12, "{parted:?}");
        assert!((parted.length - 0.8f64.hypot(0.4)).abs() < 1e-12, "{parted:?}");
        assert!(low.abs() < 1e-12 && (high - 0.8).abs() < 1e-12, "{low} {high}");
    }

    #[test]
    fn a_circle_is_found_with_the_square_of_the_spacing() {
        let (centre, radius) = (DVec2::new(0.47, 0.41), 0.3);
        let errors = [0.05, 0.025, 0.0125].map(|spacing| {
            let mut farthest: f64 = 0.0;
            let parted = field(spacing, |place| place.distance(centre)).part(radius, |a, b| {
                farthest = farthest.max((0.5 * (a + b)).distance(centre) - radius).max(radius - a.distance(centre));
            });
            [
                (parted.below / (PI * radius * radius) - 1.0).abs(),
                (parted.length / (2.0 * PI * radius) - 1.0).abs(),
                farthest,
            ]
        });
        for pair in errors.windows(2) {
            // Four times less at half the spacing, but for how the circle lies to the lattice.
            assert!((0..3).all(|k| pair[1][k] < pair[0][k] / 3.0), "{errors:?}");
        }
    }
}
