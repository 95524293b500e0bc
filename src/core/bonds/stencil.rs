//! A pair weight on a lattice: a fixed table of offsets, no neighbour list.
//!
//! Ground may conduct better along one axis than along the other. Its weights are those of an ellipse, so that the longer way is seen
//! as far as the shorter one; what then lacks in the second moment of one direction is given to the nearest pairs along it. So weights
//! stay positive at any ratio, a particle stays nearer to its neighbour than to the neighbour's image, and nearest neighbours become the
//! five-point operator of both conductivities.

use std::f64::consts::PI;

use glam::DVec2;

use crate::bonds::weight::{Normalisation, PairWeight};
use crate::memory::HeapSize;

/// Relative tolerance on a reach that falls on a shell of the lattice: the shell belongs to the neighbourhood.
pub const SHELL_TOLERANCE: f64 = 1e-6;

/// How far pairs reach at least (cells) along the axis in which ground conducts worse. Those that reach no farther are those of
/// nearest neighbours, and stay so.
const LEAST_REACH: f64 = 1.5;

/// How far pairs of a weight reach at most (m) in ground that conducts `along` x and y by these factors.
pub fn longest_reach(weight: &dyn PairWeight, along: DVec2) -> f64 {
    weight.reach() * (along.max_element() / along.min_element()).powf(0.25)
}

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
    /// Conductivity along x and along y, over that of the material.
    along: DVec2,
}

impl HeapSize for Stencil {
    fn heap_size(&self) -> usize {
        self.weights.heap_size()
    }
}

impl Stencil {
    /// The stencil of a pair weight at a spacing (m).
    pub fn new(weight: &dyn PairWeight, normalisation: Normalisation, spacing: f64, dimension: usize) -> Self {
        let stencil = Self::stretched(weight, spacing, dimension, 1.0);
        match normalisation {
            Normalisation::DiscreteMoment => {
                let scale = 1.0 / stencil.moment(spacing);
                stencil.scaled(scale).trim()
            }
            Normalisation::Nominal => stencil.trim(),
        }
    }

    /// The stencil in a plane of ground that conducts `along` x and y by these factors.
    pub fn directed(weight: &dyn PairWeight, normalisation: Normalisation, spacing: f64, along: DVec2) -> Self {
        if along == DVec2::ONE {
            return Self::new(weight, normalisation, spacing, 2);
        }
        let most = (weight.reach() / (LEAST_REACH * spacing)).powi(2).max(1.0);
        let stretch = (along.y / along.x).sqrt().clamp(1.0 / most, most);
        let stencil = Self::stretched(weight, spacing, 2, stretch);
        // As exact as the same weights are in even ground.
        let acts = match normalisation {
            Normalisation::DiscreteMoment => 1.0,
            Normalisation::Nominal => Self::stretched(weight, spacing, 2, 1.0).moment(spacing),
        };
        let (wanted, found) = (acts * along, stencil.moments(spacing));
        let scale = (wanted / found).min_element();
        let lacks = (wanted - scale * found).max(DVec2::ZERO) / (spacing * spacing);
        let mut stencil = Stencil { along, ..stencil.scaled(scale) };
        let row = stencil.reach + 1;
        stencil.weights[1] += lacks.x;
        stencil.weights[row] += lacks.y;
        stencil.trim()
    }

    /// Says how much better than the material the weights conduct, which they do already.
    pub fn acting(self, along: DVec2) -> Self {
        Stencil { along, ..self }
    }

    /// Weights by distances of which those along x count for the root of `stretch` times as much, and those along y for as many times
    /// less.
    fn stretched(weight: &dyn PairWeight, spacing: f64, dimension: usize, stretch: f64) -> Self {
        let longest = weight.reach() * stretch.max(1.0 / stretch).sqrt();
        let reach = (longest / spacing * (1.0 + SHELL_TOLERANCE)).floor().max(1.0) as usize;
        let rows = if dimension == 1 { 0 } else { reach };
        let volume = spacing.powi(dimension as i32);
        let limit = weight.reach() * (1.0 + SHELL_TOLERANCE);
        let weights = vec![0.0; (rows + 1) * (reach + 1)];
        let mut stencil = Stencil { dimension, reach, weights, disc: false, along: DVec2::ONE };
        for row in 0..=rows {
            for column in 0..=reach {
                let square = stretch * (column * column) as f64 + (row * row) as f64 / stretch;
                let distance = square.sqrt() * spacing;
                if column + row > 0 && distance <= limit {
                    stencil.weights[row * (reach + 1) + column] = volume * weight.weight(distance);
                }
            }
        }
        stencil
    }

    fn scaled(mut self, scale: f64) -> Self {
        self.weights.iter_mut().for_each(|weight| *weight *= scale);
        self
    }

    /// Drops outer shells without weight.
    fn trim(self) -> Self {
        let used = self.offsets().map(|(column, row, _)| column.max(row)).max().unwrap_or(1).max(1);
        let rows = if self.dimension == 1 { 0 } else { used };
        let weights = (0..=rows).flat_map(|row| (0..=used).map(move |column| (column, row)));
        let disc = self.offsets().all(|(column, row, _)| column * column + row * row <= used * used);
        Stencil { weights: weights.map(|(c, r)| self.at(c, r)).collect(), reach: used, disc, ..self }
    }

    /// Conductivity along x and along y, over that of the material.
    pub fn along(&self) -> DVec2 {
        self.along
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

    /// Weights on a line along x, or along y, for states that do not vary across it: of each distance from 1 to the reach, the sum
    /// over all offsets across. Offsets of no distance along the line exchange nothing.
    pub fn collapsed(&self, along_y: bool) -> Vec<f64> {
        let at = |along, across| if along_y { self.at(across, along) } else { self.at(along, across) };
        let over_all =
            |along| (0..=self.rows()).map(move |across| if across > 0 { 2.0 } else { 1.0 } * at(along, across));
        (1..=self.reach).map(|along| over_all(along).sum()).collect()
    }

    /// Sum of all weights (m^-2).
    pub fn sum(&self) -> f64 {
        self.offsets().map(|(column, row, w)| Self::multiplicity(column, row) as f64 * w).sum()
    }

    /// The largest rate (m^-2) at which pairs let a wave of potentials decay: `sum w (1 - cos kr)` over all offsets, at most twice the
    /// sum of weights. It is looked for among so many waves that it is known to 1 %, and no less is told.
    pub fn fastest_wave(&self) -> f64 {
        let waves = 16 * self.reach;
        // Of each offset, the cosines at wave numbers pi m / waves.
        let cosine = |offset: usize, m: usize| (PI * (offset * m) as f64 / waves as f64).cos();
        let by_wave = |of: &dyn Fn(usize) -> f64| (0..=waves).map(of).collect::<Vec<f64>>();
        let cosines: Vec<Vec<f64>> = (0..=self.reach).map(|offset| by_wave(&|m| cosine(offset, m))).collect();
        // Of each row, the sums along it.
        let along = |row: usize, m: usize| -> f64 {
            let one = |column| Self::multiplicity(column, row) as f64 * self.at(column, row) * cosines[column][m];
            (0..=self.reach).map(one).sum()
        };
        let sums: Vec<Vec<f64>> = (0..=self.rows()).map(|row| by_wave(&|m| along(row, m))).collect();
        let across = if self.dimension == 1 { 0 } else { waves };
        let turned = |m: usize, across: usize| -> f64 {
            sums.iter().zip(&cosines).map(|(sums, cosines)| sums[m] * cosines[across]).sum()
        };
        let least = (0..=across).flat_map(|across| (0..=waves).map(move |m| (m, across)));
        let least = least.map(|(m, across)| turned(m, across)).fold(f64::INFINITY, f64::min);
        // A trigonometric polynomial of degree n, looked at in N places of its period, is at most sec(pi n / N) times what is seen.
        let beyond = (PI / 32.0).cos().powi(self.dimension as i32);
        ((self.sum() - least) / beyond).min(2.0 * self.sum())
    }

    /// Number of neighbours of a particle.
    pub fn neighbours(&self) -> usize {
        self.offsets().map(|(column, row, _)| Self::multiplicity(column, row)).sum()
    }

    /// Conductivities along x and y that the stencil of a plane acts with, over that of the material: `sum w x^2 / 2`.
    fn moments(&self, spacing: f64) -> DVec2 {
        let one = |(column, row, w): (usize, usize, f64)| {
            let squares = DVec2::new((column * column) as f64, (row * row) as f64);
            Self::multiplicity(column, row) as f64 * w * squares
        };
        0.5 * spacing * spacing * self.offsets().map(one).sum::<DVec2>()
    }

    /// Conductivity that the stencil acts with, over the true one, on the mean of all directions: `sum w r^2 / (2 d)`.
    pub fn moment(&self, spacing: f64) -> f64 {
        self.offsets()
            .map(|(column, row, w)| {
                (Self::multiplicity(column, row) * (column * column + row * row)) as f64 * w * spacing * spacing
            })
            .sum::<f64>()
            / (2 * self.dimension) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bonds::weight::Disc;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn weights_of_ground_that_conducts_by_direction_have_both_moments_and_fall_along_both_axes(
            reach in prop_oneof![Just(1.0), 1.0..4.5f64],
            power in 0.0..3.0f64,
            log_ratio in -4.6..4.6f64,
            spacing in 0.01..10.0f64,
        ) {
            let along = DVec2::new(1.0, log_ratio.exp());
            let weight = Disc(reach * spacing, power);
            let stencil = Stencil::directed(&weight, Normalisation::DiscreteMoment, spacing, along);
            let error = (stencil.moments(spacing) / along - DVec2::ONE).abs().max_element();
            prop_assert!(error < 1e-12, "{error}");
            prop_assert!(stencil.offsets().all(|offset| offset.2 > 0.0));
            // What lies farther along one axis weighs no more: a wall's image of a neighbour never outweighs it.
            let falls = |near: f64, far: f64| far <= near * (1.0 + 1e-12);
            for (column, row) in (0..=stencil.reach).flat_map(|row| (0..=stencil.reach).map(move |column| (column, row))) {
                if column + row > 0 {
                    let own = stencil.at(column, row);
                    prop_assert!(falls(own, stencil.at(column + 1, row)) && falls(own, stencil.at(column, row + 1)));
                }
            }
            let turned = Stencil::directed(&weight, Normalisation::DiscreteMoment, spacing, DVec2::new(along.y, 1.0));
            prop_assert!(stencil.offsets().all(|(c, r, w)| (turned.at(r, c) / w - 1.0).abs() < 1e-9));
            let far = stencil.reach as f64 * spacing;
            prop_assert!(far <= longest_reach(&weight, along) * (1.0 + SHELL_TOLERANCE) || stencil.reach == 1);
        }
    }

    proptest! {
        /// No wave decays faster.
        #[test]
        fn the_fastest_wave_is_the_fastest(
            reach in 1.0..4.5f64,
            power in 0.0..3.0f64,
            log_ratio in -2.0..2.0f64,
            waves in prop::collection::vec((0.0..PI, 0.0..PI), 200),
        ) {
            let along = DVec2::new(1.0, log_ratio.exp());
            let stencil = Stencil::directed(&Disc(reach, power), Normalisation::DiscreteMoment, 1.0, along);
            let (fastest, sum) = (stencil.fastest_wave(), stencil.sum());
            let rate = |(kx, ky): (f64, f64)| -> f64 {
                let one = |(column, row, w): (usize, usize, f64)| {
                    let cosines = (column as f64 * kx).cos() * (row as f64 * ky).cos();
                    Stencil::multiplicity(column, row) as f64 * w * (1.0 - cosines)
                };
                stencil.offsets().map(one).sum()
            };
            let corners = [(PI, 0.0), (0.0, PI), (PI, PI)];
            let seen = waves.into_iter().chain(corners).map(rate).fold(0.0, f64::max);
            prop_assert!(seen <= fastest * (1.0 + 1e-12) && fastest <= 2.0 * sum, "{seen} {fastest} {sum}");
            // Waves on average decay by the sum.
            prop_assert!(fastest >= sum);
        }
    }

    #[test]
    fn the_fastest_wave_of_nearest_neighbours_is_twice_their_sum() {
        for dimension in [1, 2] {
            let stencil = Stencil::new(&Disc(1.0, 2.0), Normalisation::DiscreteMoment, 1.0, dimension);
            assert!((stencil.fastest_wave() / (2.0 * stencil.sum()) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn nearest_neighbours_stay_nearest_neighbours() {
        let stencil = Stencil::directed(&Disc(0.1, 2.0), Normalisation::DiscreteMoment, 0.1, DVec2::new(1.0, 5.0));
        let found: Vec<_> = stencil.offsets().collect();
        assert_eq!(found.iter().map(|(c, r, _)| (*c, *r)).collect::<Vec<_>>(), [(1, 0), (0, 1)]);
        assert!((found[0].2 - 100.0).abs() < 1e-10 && (found[1].2 - 500.0).abs() < 1e-10, "{found:?}");
    }
}
