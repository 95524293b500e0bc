//! A start that varies along an axis of the body.

use frazil_core::physics::retention::scale::place;
use frazil_core::series::Series;

use crate::Scene;
use crate::region::{Cell, Shape};

/// Slices in which a cell takes the values of a profile: latent heat is resolved to so many parts of it.
const SLICES: usize = 16;

/// Temperatures, or heads (m) of unsaturated water, at the start by a coordinate (m).
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Whether the coordinate is y; else it is x, in bodies of shells the radius.
    pub along_y: bool,
    /// Values by the coordinate: linear between its rows, constant beyond them.
    pub values: Series,
    /// Whether they are heads, which the scene has on its own scale of them.
    pub of_heads: bool,
}

impl Profile {
    fn state(&self, value: f64) -> f64 {
        if self.of_heads { place(value) } else { value }
    }

    /// Least and greatest state.
    pub fn range(&self) -> (f64, f64) {
        let (least, greatest) = self.values.range();
        (self.state(least), self.state(greatest))
    }

    /// Points (m) between which it is straight.
    pub fn rows(&self) -> &[(f64, f64)] {
        match &self.values {
            Series::Table(rows) | Series::Repeated { rows, .. } => rows,
            Series::Constant(_) => &[],
        }
    }
}

impl Scene {
    /// States at which a cell starts where no region tells another, with the share of its volume that each has.
    pub fn initial_in(&self, cell: &Cell) -> Vec<(f64, f64)> {
        let Some(profile) = &self.initial_profile else { return vec![(self.initial_temperature, 1.0)] };
        let axis = usize::from(profile.along_y);
        let (low, size) = (cell.low[axis], cell.high[axis] - cell.low[axis]);
        let end = |k: usize| low + size * k as f64 / SLICES as f64;
        let slice = |k: usize| {
            let (mut from, mut to) = (cell.low, cell.high);
            (from[axis], to[axis]) = (end(k), end(k + 1));
            let state = profile.state(profile.values.at(0.5 * (end(k) + end(k + 1))));
            (state, self.share_of(&Shape::Box(Cell { low: from, high: to }), cell))
        };
        (0..SLICES).map(slice).collect()
    }
}
