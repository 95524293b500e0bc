//! A solute of a scene of unsaturated water.

use frazil_core::balances::solute::advection::Advection;
use frazil_core::series::Series;
use frazil_core::solvers::transport::Coupling;
use frazil_core::space::wall::PatchId;

/// A solute that the water carries; concentrations are relative to one of reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Solute {
    /// Concentration at the start, where regions say nothing else.
    pub initial: f64,
    /// Concentrations at the start of regions that have one of their own, in the order of the regions.
    pub regions: Vec<Option<f64>>,
    /// Walls and parts of walls of given concentration.
    pub walls: Vec<SoluteWall>,
}

/// A wall of given concentration, or a part of one.
#[derive(Debug, Clone, PartialEq)]
pub struct SoluteWall {
    /// The wall, or its part by the number among those of the scene.
    pub patch: PatchId,
    /// The concentration.
    pub concentration: Series,
}

impl Solute {
    /// Least and greatest concentration that start and walls name, and that of water which brings none.
    pub fn range(&self) -> (f64, f64) {
        let starts = self.regions.iter().flatten().copied().chain([self.initial, 0.0]);
        let starts = starts.map(|concentration| (concentration, concentration));
        let all = starts.chain(self.walls.iter().map(|wall| wall.concentration.range()));
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |range, own| (range.0.min(own.0), range.1.max(own.1)))
    }
}

/// How a solute is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoluteNumerics {
    /// Which concentration water carries.
    pub advection: Advection,
    /// Whether it shares the steps of water.
    pub coupling: Coupling,
    /// Share of its bound that its explicit steps take.
    pub fraction: f64,
}
