//! The pressure: what leaves each particle through its paths and openings is what it gives.
//!
//! The matrix is symmetric and positive. Conjugate gradients start from the last pressure, with a symmetric
//! Gauss-Seidel sweep as preconditioner, and are deflated: the body is cut into blocks, and the balance of every block
//! is met exactly in each iteration (Nicolaides 1987; Saad et al. 2000). Slow changes over the whole body are then not
//! left to the iteration, and no water is lost however early it ends.

mod coarse;

use glam::DVec2;

use self::coarse::Coarse;
use crate::balances::groundwater::diagonals::{Diagonals, sum};
use crate::balances::groundwater::error::GroundwaterError;
use crate::balances::groundwater::network::{NONE, Network, Opening};
use crate::bonds::exchange::Mean;
use crate::memory::{HeapSize, total};
use crate::saved::{Pass, Saved};

/// What remains of a particle's balance over the water that passes through it, in the root of the mean of squares. A hundred times as
/// much shows in no error of a scene, but bodies that are mirrored or turned are then no more the same to a millionth.
const TOLERANCE: f64 = 1e-7;

/// The same over what drives water, for the first solution and others before which none has passed.
const FIRST_TOLERANCE: f64 = 1e-11;
/// The same where hardly any water passed before, as far as numbers tell it from none.
const ROUNDING: f64 = 1e-15;

/// How steep the pressure counts at most, over its mean in open ground: that in the last gap of a ring of pipes, whose whole head is lost
/// over a tenth of its width. Ice itself may hold it a thousand times as steep, and lets no more water through when it thaws.
const STEEPEST: f64 = 10.0;

/// Iterations of one solution, beyond which there is none.
const MOST_ITERATIONS: usize = 10_000;

/// Pressure of all particles, and the solver.
#[derive(Debug, Clone)]
pub struct Pressure {
    /// Pressure (Pa).
    pub pressure: Vec<f64>,
    /// Conductance by volume (m/(Pa s m^2) times m: `weight K`) of each path, by slot.
    pub conductances: Vec<f64>,
    /// The same of each opening.
    pub mouths: Vec<f64>,
    /// Solutions so far.
    pub solutions: u64,
    /// Iterations of all solutions.
    pub iterations: u64,
    walls: Vec<f64>,
    diagonal: Vec<f64>,
    inverse: Vec<f64>,
    /// By slot.
    rest: Vec<f64>,
    right: Vec<f64>,
    coarse: Coarse,
    residual: Vec<f64>,
    swept: Vec<f64>,
    direction: Vec<f64>,
    /// A column of places, on diagonals.
    places: Vec<f64>,
    image: Vec<f64>,
}

impl Saved for Pressure {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [
            &mut self.pressure,
            &mut self.conductances,
            &mut self.mouths,
            &mut self.solutions,
            &mut self.iterations,
            &mut self.walls,
        ]);
    }
}

impl HeapSize for Pressure {
    fn heap_size(&self) -> usize {
        let columns = [
            &self.places,
            &self.pressure,
            &self.diagonal,
            &self.inverse,
            &self.right,
            &self.residual,
            &self.swept,
            &self.direction,
        ];
        let columns: usize = columns.iter().map(|column| column.heap_size()).sum();
        columns + total(&[&self.image, &self.conductances, &self.mouths, &self.rest, &self.coarse])
    }
}

impl Pressure {
    /// A solver for particles at these places.
    pub fn new(network: &Network, positions: &[DVec2]) -> Self {
        let (count, paths) = (network.len(), network.places);
        let padded = network.diagonals.as_ref().map_or(0, Diagonals::padded);
        Pressure {
            pressure: vec![0.0; count],
            conductances: vec![0.0; paths],
            mouths: vec![0.0; network.openings.len()],
            solutions: 0,
            iterations: 0,
            walls: Vec::new(),
            diagonal: vec![0.0; count],
            inverse: vec![0.0; count],
            rest: vec![0.0; paths],
            right: vec![0.0; count],
            coarse: Coarse::new(network, positions),
            residual: vec![0.0; count],
            swept: vec![0.0; count],
            direction: vec![0.0; count],
            places: vec![0.0; padded],
            image: vec![0.0; count],
        }
    }

    /// Solves for hydraulic conductivities (m2/(Pa s)) of particles, pressures (Pa) of walls, and the water that each
    /// particle takes up by volume (1/s), where `passing` passed through particles before (1/s by volume, root of the sum of
    /// squares).
    ///
    /// # Errors
    /// A pressure that is not found, or is no number.
    pub fn solve(
        &mut self,
        network: &Network,
        conductivity: &[f64],
        walls: &[f64],
        taken: Option<&[f64]>,
        passing: f64,
        mean: Mean,
    ) -> Result<(), GroundwaterError> {
        self.walls.clear();
        self.walls.extend_from_slice(walls);
        match mean {
            Mean::Harmonic => self.assemble(network, conductivity, walls, taken, |a, b| 2.0 * a * b / (a + b)),
            Mean::Arithmetic => self.assemble(network, conductivity, walls, taken, |a, b| 0.5 * (a + b)),
            Mean::Geometric => self.assemble(network, conductivity, walls, taken, |a, b| (a * b).sqrt()),
        }
        self.coarse.assemble(network, &self.diagonal, &self.rest);
        let norm = |column: &[f64]| dot(column, column).sqrt();
        let limit = match passing > 0.0 {
            true => (TOLERANCE * passing).max(ROUNDING * norm(&self.right)),
            false => FIRST_TOLERANCE * norm(&self.right),
        };
        // The balance of each block first.
        self.direction.copy_from_slice(&self.pressure);
        self.multiply(network);
        for ((residual, right), image) in self.residual.iter_mut().zip(&self.right).zip(&self.image) {
            *residual = right - image;
        }
        self.coarse.correct(&mut self.pressure, &mut self.residual);
        let (mut last, mut count) = (0.0, 0);
        while norm(&self.residual) > limit {
            if count == MOST_ITERATIONS {
                return Err(GroundwaterError::NotFound(MOST_ITERATIONS));
            }
            self.sweep(network);
            let swept = &self.swept;
            let product = dot(&self.residual, swept);
            let grow = if count == 0 { 0.0 } else { product / last };
            let direction = &mut self.direction;
            for (direction, swept) in direction.iter_mut().zip(swept) {
                *direction = grow * *direction + swept;
            }
            self.coarse.deflate(swept, direction);
            last = product;
            self.multiply(network);
            let direction = &self.direction;
            let length = product / dot(direction, &self.image);
            if !length.is_finite() {
                return Err(GroundwaterError::NotFinite);
            }
            for i in 0..self.pressure.len() {
                self.pressure[i] += length * direction[i];
                self.residual[i] -= length * self.image[i];
            }
            count += 1;
        }
        // Rounding of the sums over iterations.
        self.coarse.correct(&mut self.pressure, &mut self.residual);
        self.solutions += 1;
        self.iterations += count as u64;
        Ok(())
    }

    /// Fills in how steep the pressure is at each particle, over the mean of all ground that water passes as it does its own: how
    /// much a change of a particle's permeability changes the flow around it. One everywhere where water stands.
    pub fn steepness(&mut self, network: &Network, permeability: &[f64], steepness: &mut [f64]) {
        let Pressure { pressure, rest, places, .. } = self;
        network.by_path(&network.weights, pressure, places, |weight, i, j| weight * (i - j).abs(), rest);
        network.sums([rest; 3], |[driven, ..], _| driven, steepness);
        let mean = dot(steepness, permeability) / permeability.iter().sum::<f64>();
        for steep in steepness {
            *steep = if mean > 0.0 { (*steep / mean).min(STEEPEST) } else { 1.0 };
        }
    }

    /// The part of a ghost's pressure (Pa) that walls held in the last solution.
    pub fn wall_parts(&self, opening: &Opening) -> f64 {
        opening.wall_part(&self.walls)
    }

    fn assemble(
        &mut self,
        network: &Network,
        conductivity: &[f64],
        walls: &[f64],
        taken: Option<&[f64]>,
        mean: impl Fn(f64, f64) -> f64,
    ) {
        let Pressure { diagonal, conductances, rest, right, places, .. } = self;
        let conductance = |weight: f64, i: f64, j: f64| if weight == 0.0 { 0.0 } else { weight * mean(i, j) };
        network.by_path(&network.weights, conductivity, places, conductance, conductances);
        network.sums([conductances; 3], |[conductance, ..], _| conductance, diagonal);
        for (rest, conductance) in rest.iter_mut().zip(conductances) {
            *rest = -*conductance;
        }
        for (i, right) in right.iter_mut().enumerate() {
            *right = taken.map_or(0.0, |taken| -taken[i]);
        }
        for (opening, mouth) in network.openings.iter().zip(&mut self.mouths) {
            let (i, j) = (opening.particle as usize, opening.image as usize);
            *mouth = opening.weight * mean(conductivity[i], conductivity[j]);
            self.diagonal[i] += *mouth;
            if opening.path == NONE {
                self.diagonal[i] -= opening.sign * *mouth;
            } else if i < j {
                // The other way is the opening of the image, with the same mouth.
                self.rest[network.slots[opening.path as usize] as usize] -= opening.sign * *mouth;
            }
            self.right[i] += *mouth * opening.wall_part(walls);
        }
        // A particle without any path stays as it is.
        for (diagonal, right) in self.diagonal.iter_mut().zip(&mut self.right).filter(|row| *row.0 <= 0.0) {
            (*diagonal, *right) = (1.0, 0.0);
        }
        for (inverse, diagonal) in self.inverse.iter_mut().zip(&self.diagonal) {
            *inverse = 1.0 / diagonal;
        }
    }

    /// The image of the direction.
    fn multiply(&mut self, network: &Network) {
        if let Some(diagonals) = &network.diagonals {
            let columns = [&self.diagonal[..], &self.rest, &self.direction];
            return diagonals.multiply(columns, &mut self.places, &mut self.image);
        }
        for i in 0..network.len() {
            let range = network.starts[i]..network.starts[i + 1];
            let paths = network.partners[range.clone()].iter().zip(&network.slots[range]);
            let rest: f64 = paths.map(|(j, slot)| self.rest[*slot as usize] * self.direction[*j as usize]).sum();
            self.image[i] = self.diagonal[i] * self.direction[i] + rest;
        }
    }

    /// Symmetric Gauss-Seidel: forward over the paths to earlier particles, back over those to later ones.
    fn sweep(&mut self, network: &Network) {
        if let Some(diagonals) = &network.diagonals {
            let columns = [&self.inverse[..], &self.rest, &self.residual];
            return diagonals.sweep(columns, &mut self.places, &mut self.swept);
        }
        let of = |paths: std::ops::Range<usize>, swept: &[f64]| -> f64 {
            let paths = network.partners[paths.clone()].iter().zip(&network.slots[paths]);
            paths.map(|(j, slot)| self.rest[*slot as usize] * swept[*j as usize]).sum()
        };
        for i in 0..network.len() {
            let earlier = of(network.starts[i]..network.laters[i], &self.swept);
            self.swept[i] = (self.residual[i] - earlier) * self.inverse[i];
        }
        for i in (0..network.len()).rev() {
            let later = of(network.laters[i]..network.starts[i + 1], &self.swept);
            self.swept[i] -= later * self.inverse[i];
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    sum(count, |i| a[i] * b[i])
}
