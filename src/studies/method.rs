//! Methods and scenes that are asked for by name.

use frazil_scene::method::MethodKind;
use frazil_scene::{Scene, names};

use crate::failure::Failure;

/// A method that cannot be had.
#[derive(Debug, thiserror::Error)]
enum NoMethod {
    #[error("--method {asked}: the scene \"{scene}\" has settings for {}", had.join(", "))]
    Unset { asked: String, scene: String, had: Vec<&'static str> },
    #[error("--methods {asked}: there are {}", known.join(", "))]
    Unknown { asked: String, known: Vec<&'static str> },
}

/// Scenes whose results would stand in one folder.
#[derive(Debug, thiserror::Error)]
#[error(
    "found scenes \"{0}\" and \"{1}\", must be scenes of different names: each has its results in a folder of its name"
)]
struct Alike(String, String);

/// Holds names of scenes against each other; those that differ in small and capital letters alone are one folder on some systems.
///
/// # Errors
/// Where two are alike.
pub fn distinct(names: &[String]) -> Result<(), Failure> {
    match names::alike(&names.iter().map(String::as_str).collect::<Vec<_>>()) {
        Some((one, other)) => Err(Failure::request(Alike(one.to_owned(), other.to_owned()))),
        None => Ok(()),
    }
}

/// The one named, else the first that the scene has.
///
/// # Errors
/// Where the scene has no settings for it.
pub fn asked(scene: &Scene, asked: Option<&str>) -> Result<&'static str, Failure> {
    let had: Vec<&'static str> = scene.methods.iter().map(|settings| settings.method).collect();
    let found = match asked {
        Some(asked) => had.iter().find(|name| **name == asked),
        None => had.first(),
    };
    found.copied().ok_or_else(|| {
        let asked = asked.unwrap_or_default().to_owned();
        Failure::request(NoMethod::Unset { asked, scene: scene.name.clone(), had })
    })
}

/// Holds names of methods against those that there are.
///
/// # Errors
/// With the first that is none.
pub fn check(asked: &[String], kinds: &[&MethodKind]) -> Result<(), Failure> {
    let known: Vec<&'static str> = kinds.iter().map(|kind| kind.name).collect();
    match asked.iter().find(|asked| !known.contains(&asked.as_str())) {
        Some(unknown) => Err(Failure::request(NoMethod::Unknown { asked: unknown.clone(), known })),
        None => Ok(()),
    }
}
