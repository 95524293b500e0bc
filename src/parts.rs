//! The program as studies see it.

use std::sync::atomic::AtomicBool;

use frazil_studies::parts::Parts;

use crate::{interrupt, load, registry};

/// Bundled scenes and those of files, their references, all methods; of scenes that can be `reduced`, smaller ones are run.
pub fn parts(reduced: bool) -> Parts<'static> {
    parts_until(reduced, interrupt::watch())
}

/// The same for another program that runs this one and has interrupts of its own: studies stop once the flag is set.
pub fn parts_until(reduced: bool, interrupt: &AtomicBool) -> Parts<'_> {
    Parts {
        scene_at: &load::scene,
        reference_for: &|scene| frazil_cases::truth(scene).map_err(Into::into),
        run: if reduced { &frazil_simulation::reduce::run } else { &frazil_simulation::march::run },
        methods: registry::methods(),
        interrupt,
    }
}
