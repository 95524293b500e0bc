//! The similarity solution of conduction with a freezing curve in a half space.
//!
//! With `eta = x / sqrt(t)` the equation `C(T) T_t = (k(T) T_x)_x` becomes
//! `q' + (eta / 2) C(T) T' = 0`, `q = k(T) T'`: an initial-value problem in `eta` whose flux at the wall is found
//! by shooting. Where the curve has a kink the last step before it is taken with `T` as the independent variable
//! (Henon 1982), so that no step straddles one.

mod medium;
mod shooting;

use frazil_core::physics::material::Material;

use super::Unsolved;
use super::functions::erfc_ratio;
use medium::Medium;
use shooting::{Shooting, TrajectoryPoint, along_eta, step};

/// Greatest mismatch of the far temperature, over the range, that shooting may leave.
const MISMATCH: f64 = 1e-9;

/// The solution for one material, wall temperature and initial temperature.
#[derive(Debug, Clone)]
pub struct Similarity {
    medium: Medium,
    wall: f64,
    initial: f64,
    /// Frozen fraction of the untouched body.
    initial_frozen: f64,
    nodes: Vec<TrajectoryPoint>,
    /// Diffusivity beyond the last node (m2/s).
    tail_diffusivity: f64,
    /// Integral of the frozen fraction less its value at infinity, over the half space (m/s^1/2).
    frozen: f64,
}

impl Similarity {
    /// The solution for a material from the temperatures of wall and start.
    ///
    /// # Errors
    ///
    /// If the curve of the material is of another kind or too narrow, or nothing happens between these temperatures.
    pub fn new(material: &Material, wall: f64, initial: f64) -> Result<Self, Unsolved> {
        if !wall.is_finite() || !initial.is_finite() || wall == initial {
            return Err(Unsolved::Unchanged { wall, initial });
        }
        let medium = Medium::new(material).ok_or_else(|| Unsolved::UnknownCurve(material.name.clone()))?;
        // Seen from the wall, so that a body at the freezing point itself counts as what it is about to become.
        let last_part = medium.part(initial, wall);
        let initial_frozen = medium.properties(last_part, initial).frozen_fraction;
        let shooting = Shooting::new(&medium, wall, initial, initial_frozen);
        let flux = shooting.wall_flux()?;
        let mut nodes = Vec::new();
        let excess = shooting.integrate(flux, Some(&mut nodes))?;
        let last = nodes.last().ok_or(Unsolved::NoEnd)?;
        if excess.abs() > MISMATCH * (initial - wall).abs() {
            return Err(Unsolved::Missed { material: material.name.clone(), initial });
        }
        let tail_diffusivity = medium.properties(last.part, last.temperature).diffusivity();
        let frozen = last.frozen;
        Ok(Similarity { medium, wall, initial, initial_frozen, nodes, tail_diffusivity, frozen })
    }

    /// Temperature at a distance `x` (m) from the wall at time `t` (s).
    pub fn temperature(&self, x: f64, t: f64) -> f64 {
        if x <= 0.0 {
            return self.wall;
        }
        if t <= 0.0 {
            return self.initial;
        }
        self.at(x / t.sqrt())
    }

    /// Frozen length (m) that the wall has added by time `t` (s): the integral of the frozen fraction over the
    /// half space less its initial value. Negative where the wall thaws.
    pub fn front(&self, t: f64) -> f64 {
        self.frozen * t.max(0.0).sqrt()
    }

    /// Integral of the frozen fraction (m) over the first `length` (m) of the half space, which the wall is taken
    /// not to have reached through, at time `t` (s).
    pub fn frozen_length(&self, length: f64, t: f64) -> f64 {
        (self.initial_frozen * length + self.front(t)).max(0.0)
    }

    /// Temperature at `eta = x / sqrt(t)`: one step from the node before it, which is as good as the nodes.
    fn at(&self, eta: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.eta <= eta);
        let node = self.nodes[after.saturating_sub(1)];
        if after >= self.nodes.len() {
            let scale = 2.0 * self.tail_diffusivity.sqrt();
            return self.initial + (node.temperature - self.initial) * erfc_ratio(eta / scale, node.eta / scale);
        }
        let state = [node.temperature, node.flux, node.frozen];
        let (state, _) = step(node.eta, state, eta - node.eta, |eta, state| {
            along_eta(&self.medium, node.part, self.initial_frozen, eta, state)
        });
        state[0]
    }
}

#[cfg(test)]
pub(crate) mod tests;
