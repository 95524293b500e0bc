//! What a record says of where it comes from.

use frazil_record::Provenance;
use frazil_studies::machine;

use crate::load::Origin;
use crate::run::RunRequest;

/// Program and machine.
pub fn machine() -> Provenance {
    let commit = Some(env!("FRAZIL_COMMIT")).filter(|commit| !commit.is_empty());
    Provenance { commit: commit.map(Into::into), ..machine::provenance() }
}

/// Program, machine and what was asked for, of a scene by what it was read from and the files that it names.
pub fn of(request: &RunRequest, (scene, scene_file): Origin, files: &[(String, String)]) -> Provenance {
    Provenance {
        command: request.command_line.clone(),
        scene,
        scene_file,
        files: files.iter().cloned().collect(),
        overrides: request.overrides.clone(),
        reduce: request.reduce,
        ..machine()
    }
}
