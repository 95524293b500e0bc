//! frazil from Python: the functions behind the commands, with their tables as bytes of arrays. What people call is the package
//! `frazil` beside it, which gives those names, units and words.

mod errors;
mod listed;
mod run;
mod source;
mod studies;
mod table;
mod value;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::errors::{RunError, SceneError};
    #[pymodule_export]
    use super::listed::{check, listed, read};
    #[pymodule_export]
    use super::run::{Run, run};
    #[pymodule_export]
    use super::studies::{cheapest, compare, ensemble, layout, stability, sweep};
    #[pymodule_export]
    use super::table::columns;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// Runs the program on its arguments, the first of which is its own name, and gives the code with which it ends.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| frazil::cli::main(arguments))
}
