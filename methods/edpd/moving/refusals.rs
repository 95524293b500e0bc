//! What moving particles cannot represent.

use frazil_core::boundary::condition::Condition;
use frazil_scene::Scene;

/// Refuses a scene that has what moving particles cannot represent.
///
/// # Errors
/// What it is, by key.
pub fn refuse(scene: &Scene) -> Result<(), String> {
    let problems = [
        (scene.materials.len() > 1, "more than one material"),
        (!scene.cracks.is_empty(), "cracks"),
        (!scene.rings.is_empty(), "freeze pipes"),
        (scene.flow.is_some(), "groundwater"),
        (!scene.watch.surfaces.is_empty(), "heat through surfaces"),
    ];
    if let Some((_, what)) = problems.into_iter().find(|problem| problem.0) {
        return Err(format!("motion = true knows no {what}: the liquid itself moves"));
    }
    let whole = scene.walls.iter().map(|wall| (wall.wall, &wall.condition));
    for (name, condition) in whole.chain(scene.wall_parts.iter().map(|part| (part.wall, &part.condition))) {
        let kind = match condition {
            Condition::Symmetry | Condition::Temperature(_) => continue,
            Condition::Flux(_) => "a flux",
            Condition::Film { .. } => "a film",
            Condition::Exact => "an exact solution",
        };
        return Err(format!(
            "the wall \"{}\" has {kind}, but walls of moving particles have a temperature or none: motion = true needs \
             \"temperature\" or condition = \"symmetry\"",
            name
        ));
    }
    Ok(())
}
