//! A run with several seeds.

use std::sync::atomic::AtomicBool;

use frazil_studies::ensemble::{self, EnsembleRequest};
use frazil_studies::failure::{Failure, Verdict};

use crate::interrupt;
use crate::run::{Asked, RunRequest, asked, folder_of};

/// Runs `count` members of an ensemble, the first with the seed of the request.
///
/// # Errors
/// Where the scene cannot be run, members would be the same, or a file cannot be written.
pub fn ensemble(request: &RunRequest, count: usize) -> Result<Verdict, Failure> {
    ensemble_of(request, &asked(request)?.0, count, interrupt::watch())
}

/// The same of what is known of the request already, until it is interrupted.
///
/// # Errors
/// Where members would be the same, a run is refused, or a file cannot be written.
pub fn ensemble_of(
    request: &RunRequest,
    (scene, method, reference): &Asked,
    count: usize,
    interrupt: &AtomicBool,
) -> Result<Verdict, Failure> {
    let ensemble = EnsembleRequest {
        scene,
        method,
        reference: reference.as_ref(),
        seed: request.seed,
        count,
        threads: request.threads,
        out: &request.out.clone().unwrap_or_else(|| folder_of(scene, method)),
        checkpoints: request.checkpoints,
        formats: request.formats,
        quiet: request.quiet,
        json: request.json,
        yes: request.yes,
    };
    ensemble::ensemble(&ensemble, interrupt)
}
