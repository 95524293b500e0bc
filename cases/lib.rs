//! Scenes and fluids by name, exact solutions and reference tables.

pub mod atlas;
pub mod column;
pub mod corner;
pub mod exact;
pub mod fluids;
pub mod formula;
pub mod groundwater;
pub mod layouts;
pub mod measured;
pub mod paper;
pub mod scenes;
pub mod seepage;
pub mod shaft;
pub mod shells;
pub mod soils;
pub mod studies;
pub mod table;
pub mod tables;
mod unfit;
pub mod unsaturated;
pub mod wetting;

use frazil_core::boundary::condition::Condition;
use frazil_scene::{ReferenceChoice, Scene};
use frazil_simulation::reference::{Reference, Truth};

use exact::Unsolved;
pub use unfit::{BadTable, Unfit};

/// Why what a scene asks for is not to be had.
#[derive(Debug, thiserror::Error)]
pub enum NoReference {
    /// It has no exact solution.
    #[error(transparent)]
    Solution(#[from] Unsolved),
    /// Its table is not one of it.
    #[error(transparent)]
    Table(#[from] Unfit),
}

/// The reference that a scene asks for and that needs no run. Where the scene is not what its table or closed form is about,
/// as where a key of it has been changed, whatever else fits stands in and it says so.
///
/// # Errors
///
/// If what the scene asks for is not to be had at all.
pub fn truth(scene: &Scene) -> Result<Truth, NoReference> {
    let found = |reference| Ok(Truth { reference, instead: None });
    let instead = |reason: NoReference| {
        let reference = fitting(scene);
        let stands_in = reference.as_ref().map_or("none that needs no run of its own fits".to_owned(), |reference| {
            let info = reference.describe();
            format!("in its place: {}, {}", info.kind, info.source)
        });
        Ok(Truth { reference, instead: Some(format!("another reference than the scene's: {reason}; {stands_in}")) })
    };
    match &scene.reference {
        ReferenceChoice::None | ReferenceChoice::Local => found(None),
        ReferenceChoice::Auto => found(fitting(scene)),
        ReferenceChoice::Measured(points) => found(Some(Box::new(measured::Points::of_scene(scene, points)))),
        ReferenceChoice::Formula(formula) => found(Some(Box::new(formula::Prescribed::of_scene(scene, formula)))),
        ReferenceChoice::Exact => match exact_solution(scene) {
            Ok(solution) => found(Some(solution)),
            // A wall that follows the solution cannot be without it.
            Err(reason) if scene.walls.iter().any(|wall| wall.condition == Condition::Exact) => Err(reason.into()),
            Err(reason) => instead(reason.into()),
        },
        ReferenceChoice::Table(name) => match tables::by_name(name, scene) {
            Ok(table) => found(Some(table)),
            Err(reason @ Unfit::Another { .. }) => instead(reason.into()),
            Err(reason) => Err(reason.into()),
        },
    }
}

/// The closed form of a scene, or why it has none.
fn exact_solution(scene: &Scene) -> Result<Box<dyn Reference>, Unsolved> {
    if !scene.random.is_even() {
        return Err(Unsolved::Body("a scene whose ground varies at random"));
    }
    // Along x it conducts as its material.
    if !scene.conducts_alike() && scene.freezing_direction().is_none_or(|direction| direction.along_y) {
        return Err(Unsolved::Body("a scene whose ground conducts by direction"));
    }
    if scene.initial_profile.is_some() {
        return Err(Unsolved::Body("a scene whose start varies in place"));
    }
    if scene.of_water {
        return wetting::exact_solution(scene);
    }
    Ok(match scene.flow {
        Some(_) => Box::new(exact::OgataBanks::of_scene(scene)?),
        None => Box::new(exact::HalfSpace::of_scene(scene)?),
    })
}

/// The first closed form or table that is about a scene.
fn fitting(scene: &Scene) -> Option<Box<dyn Reference>> {
    exact_solution(scene).ok().or_else(|| tables::names().find_map(|name| tables::by_name(name, scene).ok()))
}

#[cfg(test)]
mod tests;
