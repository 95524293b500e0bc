//! The pressure: what leaves each particle through its paths and openings is what it gives.
//!
//! The matrix is symmetric and positive. Conjugate gradients start from the last pressure, with a symmetric
//! Gauss-Seidel sweep as preconditioner, and are deflated: the body is cut into blocks, and the balance of every block
//! is met exactly in each iteration (Nicolaides 1987; Saad et al. 2000). Slow changes over the whole body are then not
//! left to the iteration, and no water is lost however early it ends.

mod coarse;

use glam::DVec2;

use self::coarse::Coarse;
use super::network::{NONE, Network, Opening};
use crate::memory::Held;
use crate::scene::Mean;

/// What remains of a particle's balance over the water that passes through it, in the root of the mean of squares.
const TOLERANCE: f64 = 1e-8;

/// The same over what walls drive, for the first solution, which knows of no water that passes.
const FIRST_TOLERANCE: f64 = 1e-11;

/// Iterations of one solution, beyond which there is none.
const MOST_ITERATIONS: usize = 10_000;

/// Pressure of all particles, and the solver.
#[derive(Debug, Clone)]
pub struct Pressure {
    /// Pressure (Pa).
    pub pressure: Vec<f64>,
    /// Conductance by volume (m/(Pa s m^2) times m: `weight K`) of each path.
    pub conductances: Vec<f64>,
    /// The same of each opening.
    pub mouths: Vec<f64>,
    /// Solutions so far.
    pub solutions: u64,
    /// Iterations of all solutions.
    pub iterations: u64,
    walls: Vec<f64>,
    diagonal: Vec<f64>,
    rest: Vec<f64>,
    right: Vec<f64>,
    coarse: Coarse,
    residual: Vec<f64>,
    swept: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl Held for Pressure {
    fn held(&self) -> usize {
        let columns = [&self.pressure, &self.diagonal, &self.right, &self.residual, &self.swept, &self.direction];
        let columns: usize = columns.iter().map(|column| column.held()).sum();
        let paths = self.conductances.held() + self.mouths.held() + self.rest.held();
        columns + self.image.held() + paths + self.coarse.held()
    }
}

impl Pressure {
    /// A solver for particles at these places.
    pub fn new(network: &Network, positions: &[DVec2]) -> Self {
        let (count, paths) = (network.len(), network.partners.len());
        Pressure {
            pressure: vec![0.0; count],
            conductances: vec![0.0; paths],
            mouths: vec![0.0; network.openings.len()],
            solutions: 0,
            iterations: 0,
            walls: Vec::new(),
            diagonal: vec![0.0; count],
            rest: vec![0.0; paths],
            right: vec![0.0; count],
            coarse: Coarse::new(network, positions),
            residual: vec![0.0; count],
            swept: vec![0.0; count],
            direction: vec![0.0; count],
            image: vec![0.0; count],
        }
    }

    /// Solves for hydraulic conductivities (m2/(Pa s)) of particles, pressures (Pa) of walls, and the water that each
    /// particle takes up by volume (1/s).
    pub fn solve(
        &mut self,
        network: &Network,
        conductivity: &[f64],
        walls: &[f64],
        taken: Option<&[f64]>,
        mean: Mean,
    ) -> Result<(), String> {
        self.walls.clear();
        self.walls.extend_from_slice(walls);
        match mean {
            Mean::Harmonic => self.assemble(network, conductivity, walls, taken, |a, b| 2.0 * a * b / (a + b)),
            Mean::Arithmetic => self.assemble(network, conductivity, walls, taken, |a, b| 0.5 * (a + b)),
            Mean::Geometric => self.assemble(network, conductivity, walls, taken, |a, b| (a * b).sqrt()),
        }
        self.coarse.assemble(network, &self.diagonal, &self.rest);
        let norm = |column: &[f64]| dot(column, column).sqrt();
        let limit =
            if self.solutions == 0 { FIRST_TOLERANCE * norm(&self.right) } else { TOLERANCE * self.passing(network) };
        // The balance of each block first.
        self.multiply(network, Column::Pressure);
        for ((residual, right), image) in self.residual.iter_mut().zip(&self.right).zip(&self.image) {
            *residual = right - image;
        }
        self.coarse.correct(&mut self.pressure, &mut self.residual);
        let (mut last, mut count) = (0.0, 0);
        while norm(&self.residual) > limit {
            if count == MOST_ITERATIONS {
                return Err(format!("the pressure was not found within {MOST_ITERATIONS} iterations"));
            }
            self.sweep(network);
            let product = dot(&self.residual, &self.swept);
            let grow = if count == 0 { 0.0 } else { product / last };
            for (direction, swept) in self.direction.iter_mut().zip(&self.swept) {
                *direction = grow * *direction + swept;
            }
            self.coarse.deflate(&self.swept, &mut self.direction);
            last = product;
            self.multiply(network, Column::Direction);
            let length = product / dot(&self.direction, &self.image);
            if !length.is_finite() {
                return Err("the pressure is not finite".into());
            }
            for i in 0..self.pressure.len() {
                self.pressure[i] += length * self.direction[i];
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
        for i in 0..network.len() {
            let own = conductivity[i];
            let mut sum = 0.0;
            for k in network.starts[i]..network.starts[i + 1] {
                let conductance = network.weights[k] * mean(own, conductivity[network.partners[k] as usize]);
                self.conductances[k] = conductance;
                self.rest[k] = -conductance;
                sum += conductance;
            }
            self.diagonal[i] = sum;
            self.right[i] = taken.map_or(0.0, |taken| -taken[i]);
        }
        for (opening, mouth) in network.openings.iter().zip(&mut self.mouths) {
            let (i, j) = (opening.particle as usize, opening.image as usize);
            *mouth = opening.weight * mean(conductivity[i], conductivity[j]);
            self.diagonal[i] += *mouth;
            if opening.path == NONE {
                self.diagonal[i] -= opening.sign * *mouth;
            } else {
                self.rest[opening.path as usize] -= opening.sign * *mouth;
            }
            self.right[i] += *mouth * opening.wall_part(walls);
        }
        // A particle without any path stays as it is.
        for (diagonal, right) in self.diagonal.iter_mut().zip(&mut self.right).filter(|row| *row.0 <= 0.0) {
            (*diagonal, *right) = (1.0, 0.0);
        }
    }

    /// Water that passes through particles by volume (1/s), in the root of the sum of squares.
    fn passing(&self, network: &Network) -> f64 {
        let through = |i: usize| {
            let own = self.pressure[i];
            let range = network.starts[i]..network.starts[i + 1];
            range.map(|k| self.conductances[k] * (own - self.pressure[network.partners[k] as usize]).abs()).sum::<f64>()
        };
        (0..network.len()).map(through).map(|flow| flow * flow).sum::<f64>().sqrt()
    }

    fn multiply(&mut self, network: &Network, column: Column) {
        let values = match column {
            Column::Pressure => &self.pressure,
            Column::Direction => &self.direction,
        };
        for i in 0..network.len() {
            let range = network.starts[i]..network.starts[i + 1];
            let rest = network.partners[range.clone()].iter().zip(&self.rest[range]);
            self.image[i] =
                self.diagonal[i] * values[i] + rest.map(|(j, rest)| rest * values[*j as usize]).sum::<f64>();
        }
    }

    /// Symmetric Gauss-Seidel: forward over the paths to earlier particles, back over those to later ones.
    fn sweep(&mut self, network: &Network) {
        for i in 0..network.len() {
            let range = network.starts[i]..network.starts[i + 1];
            let mut sum = self.residual[i];
            for (j, rest) in network.partners[range.clone()].iter().zip(&self.rest[range]) {
                if *j as usize > i {
                    break;
                }
                sum -= rest * self.swept[*j as usize];
            }
            self.swept[i] = sum / self.diagonal[i];
        }
        for i in (0..network.len()).rev() {
            let range = network.starts[i]..network.starts[i + 1];
            let mut sum = 0.0;
            for (j, rest) in network.partners[range.clone()].iter().zip(&self.rest[range]).rev() {
                if (*j as usize) < i {
                    break;
                }
                sum += rest * self.swept[*j as usize];
            }
            self.swept[i] -= sum / self.diagonal[i];
        }
    }
}

#[derive(Clone, Copy)]
enum Column {
    Pressure,
    Direction,
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
