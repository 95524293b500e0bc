//! The truth about a scene, wherever it comes from.

use frazil_record::ReferenceInfo;
use frazil_scene::Measured;

/// A plane of a pipe ring on which walls are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// Through the centre of the ring and a pipe.
    Main,
    /// Through the centre of the ring, half-way between two pipes.
    Interface,
}

/// A line through a body of two dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// Along x at a y (m), or along r at a height z.
    Across(f64),
    /// Along y at an x (m), or along z at a radius r.
    Up(f64),
}

impl Cut {
    /// A cut by its name in the series, as `z=0.4`.
    pub fn named(name: &str) -> Option<Self> {
        let (axis, at) = name.split_once('=')?;
        let at = at.parse().ok()?;
        match axis {
            "y" | "z" => Some(Cut::Across(at)),
            "x" | "r" => Some(Cut::Up(at)),
            _ => None,
        }
    }

    /// The point of it at a place along it (m).
    pub fn point(self, along: f64) -> (f64, f64) {
        match self {
            Cut::Across(y) => (along, y),
            Cut::Up(x) => (x, along),
        }
    }
}

/// A solution to compare with. What it does not know it answers with `None`.
pub trait Reference: Send + Sync {
    /// Kind, source and estimated error.
    fn describe(&self) -> ReferenceInfo;
    /// Temperature at a distance `x` (m) from the wall at which a plane front starts, at time `t` (s); of a radial body, at
    /// radius `x`. Of unsaturated water, here and below, the effective saturation.
    fn temperature(&self, _x: f64, _t: f64) -> Option<f64> {
        None
    }
    /// Temperature on a cut, at the place `x` (m) along it and time `t` (s).
    fn cut_temperature(&self, _cut: Cut, _x: f64, _t: f64) -> Option<f64> {
        None
    }
    /// Temperature at a point of a plane (m) and time `t` (s).
    fn point_temperature(&self, _x: f64, _y: f64, _t: f64) -> Option<f64> {
        None
    }
    /// Concentration of a solute at a distance `x` (m) from the wall at which a plane front starts, at time `t` (s).
    fn concentration(&self, _x: f64, _t: f64) -> Option<f64> {
        None
    }
    /// Concentration on a cut, at the place `x` (m) along it and time `t` (s).
    fn cut_concentration(&self, _cut: Cut, _x: f64, _t: f64) -> Option<f64> {
        None
    }
    /// Temperature on a plane of a ring at radius `r` (m) and time `t` (s).
    fn plane_temperature(&self, _plane: Plane, _r: f64, _t: f64) -> Option<f64> {
        None
    }
    /// Integral of the frozen fraction, or of the saturation of unsaturated water, along the freezing direction (m) at time `t`
    /// (s). At 0 it is that of the start, from
    /// which on a front is judged; who does not know it starts unfrozen.
    fn front(&self, _t: f64) -> Option<f64> {
        None
    }
    /// What another solution than this one solves, and its front (m) at time `t` (s): drawn beside, not judged by.
    fn beside(&self, _t: f64) -> Option<(&'static str, f64)> {
        None
    }
    /// Frozen volume (area in 2D, of the whole ring; of shells, all around the axis or centre) at time `t` (s).
    fn frozen_volume(&self, _t: f64) -> Option<f64> {
        None
    }
    /// Frozen length (m) on a plane of a ring at time `t` (s).
    fn thickness(&self, _plane: Plane, _t: f64) -> Option<f64> {
        None
    }
    /// Temperature and pressure (Pa) at `x` (m) on the cut of a scene with water, at time `t` (s).
    fn cut(&self, _x: f64, _t: f64) -> Option<(f64, Option<f64>)> {
        None
    }
    /// Ice over the ice at the start, in a scene with water, at time `t` (s).
    fn ice(&self, _t: f64) -> Option<f64> {
        None
    }
    /// Points that instruments measured, with which a run is compared where and when they were.
    fn measured(&self) -> Option<&Measured> {
        None
    }
    /// Time (s) of a named event.
    fn event(&self, _name: &str) -> Option<f64> {
        None
    }
}

/// What is known of a scene without a run of its own.
pub struct Truth {
    /// A closed form, a similarity solution or a table; the truth has to come from a run of the local method where there is
    /// none, unless none is asked for.
    pub reference: Option<Box<dyn Reference>>,
    /// Why it is not the one that the scene names, in words.
    pub instead: Option<String>,
}
