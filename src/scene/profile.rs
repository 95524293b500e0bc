//! A start that varies in place.

use frazil_core::formula::{Formula, X, Y};
use frazil_core::physics::retention::scale::place;
use frazil_core::series::Series;
use glam::DVec2;

use crate::Scene;
use crate::region::{Cell, Shape};

/// Parts in which a cell takes the values of a profile: latent heat is resolved to so many of them. Along two axes they are as
/// many in all.
const SLICES: usize = 16;

/// Temperatures, or heads (m) of unsaturated water, at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Values by place.
    pub values: ProfileValues,
    /// Whether they are heads, which the scene has on its own scale of them.
    pub of_heads: bool,
}

/// Values of a profile by place.
#[derive(Debug, Clone, PartialEq)]
pub enum ProfileValues {
    /// By one coordinate (m).
    Axis {
        /// Whether it is y; else it is x, in bodies of shells the radius.
        along_y: bool,
        /// Values by it: linear between its rows, constant beyond them.
        series: Series,
    },
    /// By a formula.
    Formula {
        /// The formula.
        formula: Formula,
        /// Least and greatest value over the body.
        range: (f64, f64),
    },
}

impl ProfileValues {
    fn at(&self, place: DVec2) -> f64 {
        match self {
            ProfileValues::Axis { along_y, series } => series.at(place[usize::from(*along_y)]),
            ProfileValues::Formula { formula, .. } => formula.at(&[place.x, place.y, 0.0]),
        }
    }

    fn range(&self) -> (f64, f64) {
        match self {
            ProfileValues::Axis { series, .. } => series.range(),
            ProfileValues::Formula { range, .. } => *range,
        }
    }
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

    /// Whether it varies along y, or along x.
    pub fn varies_along(&self, y: bool) -> bool {
        match &self.values {
            ProfileValues::Axis { along_y, .. } => *along_y == y,
            ProfileValues::Formula { formula, .. } => formula.uses(if y { Y } else { X }),
        }
    }
}

impl Scene {
    /// States at which a cell starts where no region tells another, with the share of its volume that each has.
    pub fn initial_in(&self, cell: &Cell) -> Vec<(f64, f64)> {
        let Some(profile) = &self.initial_profile else { return vec![(self.initial_temperature, 1.0)] };
        let varies = [false, true].map(|y| profile.varies_along(y));
        let slices = if varies == [true; 2] { SLICES.isqrt() } else { SLICES };
        let counts = varies.map(|varies| if varies { slices } else { 1 });
        let ends = |axis: usize, k: usize| {
            let (low, size) = (cell.low[axis], cell.high[axis] - cell.low[axis]);
            let end = |k: usize| low + size * k as f64 / counts[axis] as f64;
            if counts[axis] == 1 { (low, cell.high[axis]) } else { (end(k), end(k + 1)) }
        };
        let part = |k: usize| {
            let (x, y) = (ends(0, k / counts[1]), ends(1, k % counts[1]));
            let part = Cell { low: DVec2::new(x.0, y.0), high: DVec2::new(x.1, y.1) };
            let state = profile.state(profile.values.at(0.5 * (part.low + part.high)));
            (state, self.share_of(&Shape::Box(part), cell))
        };
        (0..counts[0] * counts[1]).map(part).collect()
    }
}
