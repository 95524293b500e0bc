//! What goes wrong, as exceptions.

use frazil_studies::failure::Failure;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    frazil,
    SceneError,
    PyValueError,
    "A scene or a study that cannot be read, or what was asked of it that it does not have: the program's whole message."
);
pyo3::create_exception!(
    frazil,
    RunError,
    PyRuntimeError,
    "A run that was refused before its first step, or results that could not be written: the program's whole message."
);

/// What a failure is to whoever called. A file that cannot be read is one that was asked for.
pub fn raised(failure: &Failure) -> PyErr {
    let message = failure.to_string();
    match failure {
        Failure::Scene(_) | Failure::Request(_) => SceneError::new_err(message),
        Failure::File { action: "cannot be read", .. } => SceneError::new_err(message),
        Failure::Of { cause, .. } if cause.downcast_ref::<Failure>().is_some_and(is_asked) => {
            SceneError::new_err(message)
        }
        _ => RunError::new_err(message),
    }
}

fn is_asked(failure: &Failure) -> bool {
    matches!(failure, Failure::Scene(_) | Failure::Request(_))
}
