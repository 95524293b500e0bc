//! Tables as columns: what runs and studies write as CSV, as bytes that arrays are made of.

use std::path::PathBuf;

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};

/// Columns of texts, also where those could be numbers, as names and hashes, or are all empty.
const TEXTS: [&str; 15] = [
    "scene",
    "method",
    "layout",
    "of",
    "stratum",
    "name",
    "state_hash",
    "scene_hash",
    "plane",
    "mean_over",
    "cause",
    "refused",
    "verdict",
    "status",
    "command",
];

/// Whether a column holds texts. Names of pipes look like numbers, but `1.10` is not `1.1`.
fn is_text(name: &str) -> bool {
    TEXTS.contains(&name) || matches!(name.rsplit('_').next(), Some("from" | "to"))
}

/// A column: its name, what its numbers are (`f8`, `i8`, `b1`, or `O` for texts), and those.
pub type Column<'py> = (String, &'static str, Bound<'py, PyAny>);

/// The columns of a text of CSV with a row of names.
///
/// # Errors
/// Where it is no such table.
pub fn of_text<'py>(py: Python<'py>, text: &[u8]) -> PyResult<Vec<Column<'py>>> {
    let wrong = |error: csv::Error| PyOSError::new_err(error.to_string());
    let mut reader = csv::Reader::from_reader(text);
    let names = reader.headers().map_err(wrong)?.clone();
    let records = reader.into_records().collect::<Result<Vec<_>, _>>().map_err(wrong)?;
    let column = |(k, name): (usize, &str)| {
        let cells: Vec<&str> = records.iter().map(|record| record.get(k).unwrap_or_default()).collect();
        let (kind, values) = column(py, name, &cells)?;
        Ok((name.to_owned(), kind, values))
    };
    names.iter().enumerate().map(column).collect()
}

/// What the cells of a column are.
fn column<'py>(py: Python<'py>, name: &str, cells: &[&str]) -> PyResult<(&'static str, Bound<'py, PyAny>)> {
    let bytes = |bytes: Vec<u8>| PyBytes::new(py, &bytes).into_any();
    if !is_text(name) {
        if let Some(numbers) = all(cells, |cell| cell.parse::<i64>().ok()) {
            return Ok(("i8", bytes(numbers.into_iter().flat_map(i64::to_ne_bytes).collect())));
        }
        let number = |cell: &str| if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() };
        if let Some(numbers) = all(cells, number) {
            return Ok(("f8", bytes(numbers.into_iter().flat_map(f64::to_ne_bytes).collect())));
        }
        if let Some(flags) = all(cells, |cell| cell.parse::<bool>().ok()) {
            return Ok(("b1", bytes(flags.into_iter().map(u8::from).collect())));
        }
    }
    // What would begin a formula elsewhere was given an apostrophe.
    let plain = |cell: &&str| match cell.strip_prefix('\'') {
        Some(rest) if rest.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) => rest.to_owned(),
        _ => (*cell).to_owned(),
    };
    Ok(("O", PyList::new(py, cells.iter().map(plain))?.into_any()))
}

/// All cells as one kind of value, if there are any and all are of it.
fn all<T>(cells: &[&str], read: impl Fn(&str) -> Option<T>) -> Option<Vec<T>> {
    cells.iter().map(|cell| read(cell)).collect()
}

/// The columns of a file of CSV.
#[pyfunction]
pub fn columns(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Column<'_>>> {
    of_text(py, &std::fs::read(path)?)
}
