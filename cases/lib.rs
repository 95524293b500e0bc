//! Scenes and fluids by name, exact solutions and reference tables.

pub mod corner;
pub mod exact;
pub mod fluids;
pub mod groundwater;
pub mod layouts;
pub mod paper;
pub mod scenes;
pub mod seepage;
pub mod shells;
pub mod soils;
pub mod studies;
pub mod table;

use frazil_core::reference::Reference;
use frazil_core::scene::{ReferenceChoice, Scene};

/// The reference that a scene asks for and that needs no run: a closed form, a similarity solution or a table.
///
/// `None` means that the truth has to come from a run of the local method, or that the scene leaves the choice
/// open and nothing fits. An error says why what the scene asks for is not to be had.
pub fn reference_for(scene: &Scene) -> Result<Option<Box<dyn Reference>>, String> {
    match &scene.reference {
        ReferenceChoice::Exact if scene.flow.is_some() => Ok(Some(Box::new(exact::Advection::of_scene(scene)?))),
        ReferenceChoice::Exact => Ok(Some(Box::new(exact::HalfSpace::of_scene(scene)?))),
        ReferenceChoice::Table(name) => table::by_name(name, scene).map(Some),
        ReferenceChoice::Local => Ok(None),
        ReferenceChoice::Auto => Ok(match (exact::HalfSpace::of_scene(scene), exact::Advection::of_scene(scene)) {
            (Ok(solution), _) => Some(Box::new(solution)),
            (_, Ok(solution)) => Some(Box::new(solution)),
            (Err(_), Err(_)) => table::names().find_map(|name| table::by_name(name, scene).ok()),
        }),
    }
}

#[cfg(test)]
mod tests;
