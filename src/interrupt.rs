//! One interrupt (Ctrl-C) asks to stop; a second one ends the program at once.

use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The flag that an interrupt raises, once there is a handler.
pub fn asked() -> &'static AtomicBool {
    &INTERRUPTED
}

/// Sets the handler and gives the flag that it raises. Where none can be set, an interrupt ends the program as ever:
/// files are whole all the same.
pub fn watch() -> &'static AtomicBool {
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    &INTERRUPTED
}
