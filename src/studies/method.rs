//! Methods that are asked for by name.

use frazil_scene::Scene;
use frazil_scene::method::MethodKind;

use crate::failure::Failure;

/// A method that cannot be had.
#[derive(Debug, thiserror::Error)]
enum NoMethod {
    #[error("--method {asked}: the scene \"{scene}\" has settings for {}", had.join(", "))]
    Unset { asked: String, scene: String, had: Vec<&'static str> },
    #[error("--methods {asked}: there are {}", known.join(", "))]
    Unknown { asked: String, known: Vec<&'static str> },
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
