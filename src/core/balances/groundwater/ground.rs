//! Groundwater of a scene: what drives it and how ice holds it up.

use glam::DVec2;

use crate::series::Series;
use crate::space::wall::WallId;

/// Groundwater that flows through all of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// Dynamic viscosity of water (Pa s).
    pub viscosity: f64,
    /// Walls of given pressure; no water crosses the others.
    pub walls: Vec<PressureWall>,
    /// In a ring, where water comes from afar and goes: the pressure of its outer wall is that of the point farthest
    /// upstream, and falls evenly to the negative of it downstream.
    pub across: Option<Across>,
    /// How ice holds water up.
    pub relative_permeability: RelativePermeability,
    /// Relative permeability that the coldest ground keeps.
    pub least_relative_permeability: f64,
    /// Whether water that freezes pushes other water aside, by the difference of densities (Nikolaev et al. 2021, eq 6).
    pub density_change: bool,
    /// Acceleration down y (m/s2); 0 where pressures are those of one level.
    pub gravity: f64,
    /// Height (m) of the cut along x that is kept beside profiles.
    pub cut: Option<f64>,
}

/// Groundwater that crosses a ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Across {
    /// Where it flows to, of length 1.
    pub direction: DVec2,
    /// Outer radius (m).
    pub radius: f64,
}

impl Across {
    /// Share of the outer wall's pressure at a place, beyond it also.
    pub fn share(&self, place: DVec2) -> f64 {
        -place.dot(self.direction) / self.radius
    }
}

/// A wall through which water enters or leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureWall {
    /// A side of a box; in a ring the outer one.
    pub wall: WallId,
    /// Pressure along it (Pa).
    pub pressure: Series,
}

/// Relative permeability by the unfrozen fraction `S` of the water in the pores.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RelativePermeability {
    /// `10^(-n impedance (1 - S))`, with the porosity n (Nikolaev et al. 2021, eq 5).
    Impedance(f64),
    /// `S^exponent`.
    Power(f64),
}

impl RelativePermeability {
    /// The relative permeability where `unfrozen` of the water in pores of this porosity is unfrozen.
    pub fn at(&self, unfrozen: f64, porosity: f64) -> f64 {
        match *self {
            RelativePermeability::Impedance(impedance) => 10f64.powf(-porosity * impedance * (1.0 - unfrozen)),
            RelativePermeability::Power(exponent) => unfrozen.powf(exponent),
        }
    }
}

impl Flow {
    /// Least and greatest pressure that walls hold at any time (Pa).
    pub fn pressures(&self) -> (f64, f64) {
        let ranges = self.walls.iter().map(|wall| wall.pressure.range());
        let (least, most) =
            ranges.fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| (all.0.min(one.0), all.1.max(one.1)));
        if self.across.is_some() { (least.min(-most), most.max(-least)) } else { (least, most) }
    }
}
