//! Reference tables shipped with the program, by name, and whether they are about a scene.

use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use crate::shaft::{SHAFT_CASES, ShaftTable};
use crate::{Unfit, column, corner, seepage, shells, wetting};

/// Names of all tables, as a scene file asks for them.
pub fn names() -> impl Iterator<Item = &'static str> {
    let shafts = SHAFT_CASES.iter().map(|case| case.name);
    [column::NAME]
        .into_iter()
        .chain(shafts)
        .chain(shells::names())
        .chain([seepage::NAME, corner::NAME])
        .chain(wetting::names())
}

/// The table of the given name.
///
/// # Errors
///
/// If there is none, or it is not about the physics of the scene.
pub fn by_name(name: &str, scene: &Scene) -> Result<Box<dyn Reference>, Unfit> {
    let about = |differences: Vec<String>| Unfit::unless_same(name, differences);
    let uneven = [
        (!scene.random.is_even(), "the ground does not vary at random there"),
        (!scene.conducts_alike(), "the ground conducts alike in all directions there"),
        (scene.initial_profile.is_some(), "the start does not vary in place there"),
    ];
    let uneven: Vec<String> = uneven.iter().filter(|row| row.0).map(|row| row.1.to_owned()).collect();
    if !uneven.is_empty() && names().any(|known| known == name) {
        return Err(Unfit::another(name, uneven));
    }
    if name == seepage::NAME {
        about(seepage::differences(scene))?;
        return Ok(Box::new(seepage::Inclusion::of_law(scene.materials[0].mixing)?));
    }
    if name == corner::NAME {
        return Ok(Box::new(corner::Corner::of_scene(scene)?));
    }
    if name == column::NAME {
        about(column::differences(scene))?;
        return Ok(Box::new(column::ColumnTable::bundled()?));
    }
    if let Some(found) = wetting::by_name(name, scene) {
        return found;
    }
    if let Some(found) = shells::by_name(name, scene) {
        return found;
    }
    let unknown = || Unfit::Unknown { name: name.into(), known: names().collect() };
    let case = SHAFT_CASES.iter().find(|case| case.name == name).ok_or_else(unknown)?;
    about(case.differences(scene))?;
    Ok(Box::new(ShaftTable::bundled(case)?))
}
