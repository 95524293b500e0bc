//! The program as studies see it.

use frazil_studies::parts::Parts;

use crate::{interrupt, load, registry};

/// Bundled scenes and those of files, their references, all methods; of scenes that can be `reduced`, smaller ones are run.
pub fn parts(reduced: bool) -> Parts<'static> {
    Parts {
        scene_at: &load::scene,
        reference_for: &|scene| frazil_cases::truth(scene).map_err(Into::into),
        run: if reduced { &frazil_simulation::reduce::run } else { &frazil_simulation::march::run },
        methods: registry::methods(),
        interrupt: interrupt::watch(),
    }
}
