//! Particles at rest behind walls, and the temperatures that make a wall of them.
//!
//! A particle behind a wall is seen with the conduction potential `2 U(wall) - U(image)`, where its mirror image stands in
//! the body and `U` there is fitted to the particles around by moving least squares (after Ng et al. 2017, section 4.1,
//! who take temperatures: across a front the potential is the straighter of both). Behind an insulated wall it is that of
//! the image. What such particles receive has left the body through the wall.

use rayon::prelude::*;

use frazil_core::saved::{Pass, Saved};

use super::matter::Matter;
use super::particle::{Look, Particle};
use super::sorting::{AROUND, CellGrid};

/// Wall particles that a task sees to.
const TASK: usize = 256;

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
    /// Its mirror image in the body.
    pub image: [f64; D],
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
    /// Where they stand since the last sorting.
    at: Vec<u32>,
    /// Particles that may be near each image, one list after the other.
    near: Vec<u32>,
    starts: Vec<u32>,
    levels: Vec<f64>,
}

impl<const D: usize> Saved for Walls<D> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        // Faces are set at every step.
        pass.all(&mut [&mut self.received, &mut self.at, &mut self.near, &mut self.starts]);
    }
}

impl<const D: usize> Walls<D> {
    /// Walls of these particles, all patches insulated at first.
    pub fn new(first: u32, behind: Vec<Behind<D>>, patches: usize) -> Self {
        Walls {
            first,
            faces: vec![WallState::Insulated; patches],
            received: vec![0.0; patches],
            at: vec![0; behind.len()],
            near: Vec::new(),
            starts: Vec::new(),
            levels: vec![0.0; behind.len()],
            behind,
        }
    }

    /// Bytes that they hold on the heap.
    pub fn heap_size(&self) -> usize {
        self.behind.capacity() * size_of::<Behind<D>>()
            + 4 * (self.at.capacity() + self.near.capacity() + self.starts.capacity())
            + 8 * (self.levels.capacity() + self.received.capacity())
    }

    /// Lists the particles around all images, up to a distance.
    pub fn list(&mut self, grid: &CellGrid<D>, particles: &[Particle<D>], starts: &[u32], distance: f64) {
        for (i, particle) in particles.iter().enumerate() {
            if particle.name >= self.first {
                self.at[(particle.name - self.first) as usize] = i as u32;
            }
        }
        self.near.clear();
        self.starts.clear();
        self.starts.push(0);
        let square = distance * distance;
        let mut cells = [0; AROUND];
        for behind in &self.behind {
            let count = grid.around(&behind.image, &mut cells);
            for cell in &cells[..count] {
                for j in starts[*cell]..starts[*cell + 1] {
                    let other = &particles[j as usize];
                    if other.name < self.first && grid.square(&behind.image, &other.position) < square {
                        self.near.push(j);
                    }
                }
            }
            self.starts.push(self.near.len() as u32);
        }
    }

    /// Lets pairs see the particles behind walls as the walls want it.
    pub fn show<M: Matter>(
        &mut self,
        matter: &M,
        grid: &CellGrid<D>,
        looks: &mut [Look<D, M::Seen>],
        reach: f64,
        parallel: bool,
    ) {
        let Walls { behind, faces, at, near, starts, levels, .. } = self;
        let level = |k: usize| {
            let near = &near[starts[k] as usize..starts[k + 1] as usize];
            let fitted =
                fit(&behind[k].image, grid, near, looks, reach, |look| matter.level(look.seen, look.temperature));
            match (faces[behind[k].patch as usize], fitted) {
                (WallState::Insulated, fitted) => fitted.unwrap_or(0.0),
                (WallState::Held(temperature), fitted) => {
                    let wall = matter.level_at(temperature);
                    2.0 * wall - fitted.unwrap_or(wall)
                }
            }
        };
        if parallel {
            levels.par_iter_mut().with_min_len(TASK).enumerate().for_each(|(k, value)| *value = level(k));
        } else {
            levels.iter_mut().enumerate().for_each(|(k, value)| *value = level(k));
        }
        for (i, level) in at.iter().zip(levels.iter()) {
            let look = &mut looks[*i as usize];
            (look.temperature, look.seen) = matter.at_level(*level);
            look.coldness = 1.0 / look.temperature;
        }
    }

    /// Takes what the particles behind walls have received in a step.
    pub fn collect(&mut self, particles: &mut [Particle<D>]) {
        self.received.fill(0.0);
        for (i, behind) in self.at.iter().zip(&self.behind) {
            self.received[behind.patch as usize] += std::mem::take(&mut particles[*i as usize].heat);
        }
    }
}

/// The value at a place of the plane that fits values around best, by weights `(1 - r/reach)^2`; the weighted mean where
/// they are too few or lie in a row, none where there is none.
fn fit<const D: usize, S: Copy>(
    place: &[f64; D],
    grid: &CellGrid<D>,
    near: &[u32],
    looks: &[Look<D, S>],
    reach: f64,
    value: impl Fn(&Look<D, S>) -> f64,
) -> Option<f64> {
    // Sums of weights times products of (1, way): the upper left D + 1 rows and columns count.
    let mut matrix = [[0.0; 4]; 4];
    let mut right = [0.0; 4];
    for j in near {
        let look = &looks[*j as usize];
        let way = grid.way(&look.position, place);
        let distance = way.iter().map(|w| w * w).sum::<f64>().sqrt();
        let closeness = (1.0 - distance / reach).max(0.0);
        let weight = closeness * closeness;
        let mut base = [0.0; 4];
        base[0] = 1.0;
        base[1..=D].copy_from_slice(&way);
        let value = value(look);
        for row in 0..=D {
            for column in row..=D {
                matrix[row][column] += weight * base[row] * base[column];
            }
            right[row] += weight * base[row] * value;
        }
    }
    let sum = matrix[0][0];
    if sum <= 0.0 {
        return None;
    }
    let mean = right[0] / sum;
    // Gauss elimination from the last unknown up leaves the value at the place alone.
    for row in 0..=D {
        for column in 0..row {
            matrix[row][column] = matrix[column][row];
        }
    }
    let scale = sum * reach * reach;
    for pivot in (1..=D).rev() {
        if matrix[pivot][pivot] < 1e-3 * scale {
            return Some(mean);
        }
        for row in 0..pivot {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            for column in 0..pivot {
                matrix[row][column] -= factor * matrix[pivot][column];
            }
            right[row] -= factor * right[pivot];
        }
    }
    if matrix[0][0] < 1e-3 * sum { Some(mean) } else { Some(right[0] / matrix[0][0]) }
}
