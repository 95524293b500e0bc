//! Reference tables shipped with the program, by name, and whether they are about a scene.

use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use crate::shaft::{SHAFT_CASES, ShaftTable};
use crate::{column, corner, seepage, shells};

/// Names of all tables, as a scene file asks for them.
pub fn names() -> impl Iterator<Item = &'static str> {
    let shafts = SHAFT_CASES.iter().map(|case| case.name);
    [column::NAME].into_iter().chain(shafts).chain(shells::names()).chain([seepage::NAME, corner::NAME])
}

/// Why a table is not the reference of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Unfit {
    /// It is about another problem, in words.
    Another(String),
    /// There is none of this name, or it cannot be read.
    Broken(String),
}

impl From<String> for Unfit {
    fn from(reason: String) -> Self {
        Unfit::Broken(reason)
    }
}

/// The table of the given name, if it is about the physics of the scene; else the reason.
pub fn by_name(name: &str, scene: &Scene) -> Result<Box<dyn Reference>, Unfit> {
    let other = |differences: Vec<String>| {
        Unfit::Another(format!("the table '{name}' is about another problem: {}", differences.join("; ")))
    };
    let about = |differences: Vec<String>| if differences.is_empty() { Ok(()) } else { Err(other(differences)) };
    if name == seepage::NAME {
        about(seepage::differences(scene))?;
        return Ok(Box::new(seepage::Inclusion::of_law(scene.materials[0].mixing)?));
    }
    if name == corner::NAME {
        return Ok(Box::new(corner::Corner::of_scene(scene).map_err(other)?));
    }
    if name == column::NAME {
        about(column::differences(scene))?;
        return Ok(Box::new(column::ColumnTable::bundled()?));
    }
    if let Some(found) = shells::by_name(name, scene) {
        return found.map_err(other);
    }
    let case = SHAFT_CASES.iter().find(|case| case.name == name).ok_or_else(|| {
        let all: Vec<&str> = names().collect();
        format!("there is no reference table '{name}'; the tables are {}", all.join(", "))
    })?;
    about(case.differences(scene))?;
    Ok(Box::new(ShaftTable::bundled(case)?))
}
