//! Solutions in a half space, from material properties alone and independent of the engine's own curves.

pub mod advection;
mod functions;
pub mod line_sink;
pub mod neumann;
pub mod similarity;
pub mod unsaturated;
mod unsolved;

use frazil_core::boundary::condition::Condition;
use frazil_core::physics::material::FreezingLaw;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::ReferenceInfo;
use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use crate::table::wall_temperature;

pub use advection::OgataBanks;
pub use neumann::Neumann;
pub use similarity::Similarity;
pub use unsolved::Unsolved;

/// Greatest change of temperature that the half space may show at the far wall of a finite body by the end of
/// the run, over the range of temperatures, before the two count as different problems.
const FAR_WALL_TOLERANCE: f64 = 1e-3;

/// Estimated relative error of [`Neumann`]: a root to the last bits and library error functions.
const NEUMANN_ERROR: f64 = 1e-13;

/// Estimated relative error of [`Similarity`]: where its far tail is cut. A tenfold change of its tolerance moves
/// fronts and fluxes by less than 1e-12.
const SIMILARITY_ERROR: f64 = 1e-10;

/// A solution in a half space.
#[derive(Debug, Clone)]
enum Solution {
    /// All latent heat at one temperature, or none.
    Neumann(Neumann),
    /// A freezing curve.
    Similarity(Box<Similarity>),
}

impl Solution {
    /// Temperature at a distance `x` (m) from the wall at time `t` (s).
    fn temperature(&self, x: f64, t: f64) -> f64 {
        match self {
            Solution::Neumann(neumann) => neumann.temperature(x, t),
            Solution::Similarity(similarity) => similarity.temperature(x, t),
        }
    }
}

/// The half-space solution of a scene, cut off at the length of its body.
#[derive(Debug, Clone)]
pub struct HalfSpace {
    solution: Solution,
    /// Extent of the body along the freezing direction (m).
    length: f64,
    name: String,
}

impl HalfSpace {
    /// The solution that a scene asks for.
    ///
    /// # Errors
    ///
    /// If it has none. The scene must be a single material in a line or rectangle without pipes, held at one constant temperature
    /// at one end and insulated at the sides. The far end may be insulated or held at the initial temperature, as
    /// long as the half space itself changes by less than a thousandth of the range of temperatures there until
    /// the end of the run; or it may follow the exact solution.
    pub fn of_scene(scene: &Scene) -> Result<Self, Unsolved> {
        let unsolved = [
            (scene.flow.is_some(), "a freezing half space with flowing water"),
            (!scene.rings.is_empty(), "a scene with freeze pipes"),
            (scene.has_uneven_start(), "a scene whose regions start at temperatures of their own"),
            (!scene.cracks.is_empty(), "a scene with cracks"),
            (!scene.impermeable.is_empty(), "a scene with impermeable parts"),
            (scene.has_heat_sources(), "a scene whose regions release heat"),
            (!scene.is_uniform(), "a scene with several materials"),
        ];
        if let Some((_, body)) = unsolved.iter().find(|(found, _)| *found) {
            return Err(Unsolved::Body(body));
        }
        let material = scene.materials.first().ok_or(Unsolved::NoMaterial)?;
        let (near_name, far, length) = direction(scene)?;
        let wall = wall_temperature(scene, near_name).ok_or(Unsolved::WallChanges(near_name))?;
        let initial = scene.initial_temperature;
        let solution = match material.law {
            FreezingLaw::None | FreezingLaw::Isothermal => Solution::Neumann(Neumann::new(material, wall, initial)?),
            FreezingLaw::Curve(_) => Solution::Similarity(Box::new(Similarity::new(material, wall, initial)?)),
        };
        if !matches!(far, Some(Condition::Exact)) {
            let change = ((solution.temperature(length, scene.duration) - initial) / (initial - wall)).abs();
            if change >= FAR_WALL_TOLERANCE {
                return Err(Unsolved::FarWallFelt { length, change, limit: FAR_WALL_TOLERANCE });
            }
        }
        Ok(HalfSpace { solution, length, name: material.name.clone() })
    }
}

impl Reference for HalfSpace {
    fn describe(&self) -> ReferenceInfo {
        let (kind, source, error) = match self.solution {
            Solution::Neumann(_) => ("exact", "Neumann solution", NEUMANN_ERROR),
            Solution::Similarity(_) => ("similarity", "similarity solution in x/sqrt(t)", SIMILARITY_ERROR),
        };
        ReferenceInfo::new(kind, format!("{source} in a half space of {}", self.name), error)
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        Some(self.solution.temperature(x, t))
    }

    fn front(&self, t: f64) -> Option<f64> {
        match &self.solution {
            Solution::Neumann(neumann) => {
                let front = neumann.front(t)?;
                Some(if neumann.is_thawing() { (self.length - front).max(0.0) } else { front })
            }
            Solution::Similarity(similarity) => Some(similarity.frozen_length(self.length, t)),
        }
    }
}

/// Name of the wall where freezing or thawing begins, the condition opposite and the distance between them (m).
fn direction(scene: &Scene) -> Result<(WallId, Option<&Condition>, f64), Unsolved> {
    let pairs: &[(WallId, WallId, f64)] = match scene.domain {
        Domain::Line { length } => &[(WallId::Left, WallId::Right, length)],
        Domain::Rectangle { width, height } => {
            &[(WallId::Left, WallId::Right, width), (WallId::Bottom, WallId::Top, height)]
        }
        Domain::Ring { .. } => return Err(Unsolved::Body("a ring")),
        Domain::Radial { .. } | Domain::Axial { .. } => return Err(Unsolved::Body("a body of shells")),
    };
    if !scene.wall_parts.is_empty() {
        return Err(Unsolved::Body("a body whose walls are in parts"));
    }
    let initial = scene.initial_temperature;
    let is_still = |wall: WallId| match scene.wall(wall) {
        None | Some(Condition::Symmetry | Condition::Periodic) => true,
        Some(Condition::Temperature(series)) => series.constant() == Some(initial),
        Some(Condition::Exact) => true,
        Some(Condition::Flux(_) | Condition::Film { .. } | Condition::Runoff { .. } | Condition::FreeDrainage) => false,
    };
    let mut driving = pairs
        .iter()
        .flat_map(|&(first, second, length)| [(first, second, length), (second, first, length)])
        .filter(|&(near, _, _)| !is_still(near));
    let (near, far, length) = driving.next().ok_or(Unsolved::NothingDrives)?;
    if let Some((other, _, _)) = driving.next() {
        return Err(Unsolved::TwoDrive(near, other));
    }
    for wall in &scene.walls {
        let is_side = wall.wall != near && wall.wall != far;
        if is_side && !scene.is_closed(wall.wall) {
            return Err(Unsolved::NotInsulated(wall.wall));
        }
    }
    Ok((near, scene.wall(far), length))
}
