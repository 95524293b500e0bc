//! What a record says of where it comes from.

use frazil_record::Provenance;
use frazil_studies::failure::Failure;
use frazil_studies::machine;

use crate::load;
use crate::run::RunRequest;

/// Program and machine.
pub fn machine() -> Provenance {
    let commit = Some(env!("FRAZIL_COMMIT")).filter(|commit| !commit.is_empty());
    Provenance { commit: commit.map(Into::into), ..machine::provenance() }
}

/// Program, machine and what was asked for.
///
/// # Errors
/// Where the scene's file cannot be read any more.
pub fn of(request: &RunRequest) -> Result<Provenance, Failure> {
    Ok(with(request, load::source(&request.scene)?))
}

/// The same, of a scene whose name and text are known.
pub fn with(request: &RunRequest, (scene, scene_file): (String, String)) -> Provenance {
    Provenance {
        command: request.command_line.clone(),
        scene,
        scene_file,
        overrides: request.overrides.clone(),
        reduce: request.reduce,
        ..machine()
    }
}
