//! What moving particles cannot represent.

use frazil_core::boundary::condition::Condition;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;

use crate::fluid::FluidError;

/// Why the liquid of a scene cannot move.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The scene has what moving particles know nothing of.
    #[error("motion = true cannot be combined with {0}")]
    Unknown(&'static str),
    /// A wall with a condition that moving particles cannot meet.
    #[error(
        "the wall \"{wall}\" has {kind}, but with motion = true walls need \
         \"temperature\" or condition = \"symmetry\""
    )]
    Wall {
        /// Which one.
        wall: WallId,
        /// Its condition.
        kind: &'static str,
    },
    /// A domain in which particles cannot move.
    #[error("motion = true needs the domain \"line\" or \"rectangle\"")]
    Domain,
    /// Its particles make no fluid.
    #[error(transparent)]
    Fluid(#[from] FluidError),
}

/// Refuses a scene that has what moving particles cannot represent.
///
/// # Errors
/// What it is, by key.
pub fn refuse(scene: &Scene) -> Result<(), MotionError> {
    let problems = [
        (scene.materials.len() > 1, "more than one material"),
        (!scene.cracks.is_empty(), "cracks"),
        (!scene.impermeable.is_empty(), "impermeable parts"),
        (!scene.rings.is_empty(), "freeze pipes"),
        (scene.flow.is_some(), "groundwater"),
        (!scene.conducts_alike(), "an anisotropic conductivity"),
        (!scene.random.is_even(), "ground that varies at random"),
        (scene.has_heat_sources(), "regions that release heat"),
        (!scene.watch.surfaces.is_empty(), "heat through surfaces"),
    ];
    if let Some((_, what)) = problems.into_iter().find(|problem| problem.0) {
        return Err(MotionError::Unknown(what));
    }
    let whole = scene.walls.iter().map(|wall| (wall.wall, &wall.condition));
    for (wall, condition) in whole.chain(scene.wall_parts.iter().map(|part| (part.wall, &part.condition))) {
        let kind = match condition {
            Condition::Symmetry | Condition::Periodic | Condition::Temperature(_) => continue,
            Condition::Flux(_) => "a flux",
            Condition::Film { .. } => "a film",
            Condition::Runoff { .. } => "rain",
            Condition::FreeDrainage => "free drainage",
            Condition::Exact => "an exact solution",
        };
        return Err(MotionError::Wall { wall, kind });
    }
    Ok(())
}
