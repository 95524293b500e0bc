//! A pair weight on a lattice: a fixed table of offsets, no neighbour list.

use crate::bonds::weight::{Normalisation, PairWeight};
use crate::memory::HeapSize;

/// Relative tolerance on a reach that falls on a shell of the lattice: the shell belongs to the neighbourhood.
pub const SHELL_TOLERANCE: f64 = 1e-6;

/// Weights by offset on a lattice, for the heat balance by volume:
/// `dH_i/dt = sum over offsets of w (U_j - U_i)`, w in m^-2.
#[derive(Debug, Clone)]
pub struct Stencil {
    /// Space dimensions.
    pub dimension: usize,
    /// Greatest offset in cells.
    pub reach: usize,
    /// Weight at offset (column, row), both 0..=reach, in that order: `weights[row * (reach + 1) + column]`. On a line there is
    /// one row.
    weights: Vec<f64>,
    disc: bool,
}

impl HeapSize for Stencil {
    fn heap_size(&self) -> usize {
        self.weights.heap_size()
    }
}

impl Stencil {
    /// The stencil of a pair weight at a spacing (m).
    pub fn new(weight: &dyn PairWeight, normalisation: Normalisation, spacing: f64, dimension: usize) -> Self {
        let reach = (weight.reach() / spacing * (1.0 + SHELL_TOLERANCE)).floor().max(1.0) as usize;
        let rows = if dimension == 1 { 0 } else { reach };
        let volume = spacing.powi(dimension as i32);
        let limit = weight.reach() * (1.0 + SHELL_TOLERANCE);
        let mut stencil = Stencil { dimension, reach, weights: vec![0.0; (rows + 1) * (reach + 1)], disc: false };
        for row in 0..=rows {
            for column in 0..=reach {
                let cells = (((column * column + row * row) as f64).sqrt(), column + row);
                let distance = cells.0 * spacing;
                if cells.1 > 0 && distance <= limit {
                    stencil.weights[row * (reach + 1) + column] = volume * weight.weight(distance);
                }
            }
        }
        if normalisation == Normalisation::DiscreteMoment {
            let scale = 1.0 / stencil.moment(spacing);
            stencil.weights.iter_mut().for_each(|weight| *weight *= scale);
        }
        stencil.trim()
    }

    /// Drops outer shells without weight.
    fn trim(self) -> Self {
        let used = self.offsets().map(|(column, row, _)| column.max(row)).max().unwrap_or(1).max(1);
        let rows = if self.dimension == 1 { 0 } else { used };
        let weights = (0..=rows).flat_map(|row| (0..=used).map(move |column| (column, row)));
        let disc = self.offsets().all(|(column, row, _)| column * column + row * row <= used * used);
        Stencil { weights: weights.map(|(c, r)| self.at(c, r)).collect(), reach: used, dimension: self.dimension, disc }
    }

    /// Greatest offset across.
    fn rows(&self) -> usize {
        if self.dimension == 1 { 0 } else { self.reach }
    }

    /// Weight at an offset in cells, both not negative.
    #[inline]
    pub fn at(&self, column: usize, row: usize) -> f64 {
        if column > self.reach || row > self.rows() { 0.0 } else { self.weights[row * (self.reach + 1) + column] }
    }

    /// Offsets of the first quadrant (axes included) with their weights.
    pub fn offsets(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..=self.rows())
            .flat_map(move |row| (0..=self.reach).map(move |column| (column, row, self.at(column, row))))
            .filter(|offset| offset.2 != 0.0)
    }

    /// Whether all weight lies within the disc of the stencil's reach.
    pub fn fits_disc(&self) -> bool {
        self.disc
    }

    /// How many offsets of the whole plane one of the first quadrant stands for.
    pub fn multiplicity(column: usize, row: usize) -> usize {
        (if column > 0 { 2 } else { 1 }) * (if row > 0 { 2 } else { 1 })
    }

    /// Weights on a line for states that do not vary across it: of each column distance from 1 to the reach, the sum
    /// over rows. Offsets in the particle's own column exchange nothing.
    pub fn collapsed(&self) -> Vec<f64> {
        let over_rows =
            |column| (0..=self.rows()).map(move |row| if row > 0 { 2.0 } else { 1.0 } * self.at(column, row));
        (1..=self.reach).map(|column| over_rows(column).sum()).collect()
    }

    /// Sum of all weights (m^-2).
    pub fn sum(&self) -> f64 {
        self.offsets().map(|(column, row, w)| Self::multiplicity(column, row) as f64 * w).sum()
    }

    /// Number of neighbours of a particle.
    pub fn neighbours(&self) -> usize {
        self.offsets().map(|(column, row, _)| Self::multiplicity(column, row)).sum()
    }

    /// Conductivity that the stencil acts with, over the true one: `sum w r^2 / (2 d)`.
    pub fn moment(&self, spacing: f64) -> f64 {
        self.offsets()
            .map(|(column, row, w)| {
                (Self::multiplicity(column, row) * (column * column + row * row)) as f64 * w * spacing * spacing
            })
            .sum::<f64>()
            / (2 * self.dimension) as f64
    }
}
