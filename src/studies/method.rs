//! The method under which a scene is run.

use frazil_scene::Scene;

use crate::failure::Failure;

/// The one named, else the first that the scene has.
///
/// # Errors
/// Where the scene has no settings for it.
pub fn asked(scene: &Scene, asked: Option<&str>) -> Result<&'static str, Failure> {
    let names: Vec<&'static str> = scene.methods.iter().map(|settings| settings.method).collect();
    let found = match asked {
        Some(asked) => names.iter().find(|name| **name == asked),
        None => names.first(),
    };
    found.copied().ok_or_else(|| {
        Failure::Request(format!(
            "--method {}: the scene \"{}\" has settings for {}",
            asked.unwrap_or_default(),
            scene.name,
            names.join(", ")
        ))
    })
}
