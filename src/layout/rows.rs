//! Rows of tables: as files, and as cells of pages.

use std::path::Path;

use frazil_record::{fixed, off_by};
use frazil_studies::failure::Failure;
use frazil_studies::output;
use serde::Serialize;

/// Writes rows as a table.
///
/// # Errors
/// Where the file cannot be written.
pub(super) fn write_rows<R: Serialize>(folder: &Path, name: &str, rows: &[R]) -> Result<(), Failure> {
    output::write_rows(&folder.join(name), rows)
}

/// A number, or what stands in its place.
pub(super) fn cell(value: Option<f64>, digits: usize, none: &str) -> String {
    value.map_or_else(|| none.to_owned(), |value| fixed(value, digits))
}

/// A change with its sign, if there is one.
pub(super) fn signed(value: Option<f64>, digits: usize) -> String {
    let signed = |value: f64| {
        let text = fixed(value, digits);
        if text.parse::<f64>().is_ok_and(|shown| shown > 0.0) { format!("+{text}") } else { text }
    };
    value.map_or_else(String::new, signed)
}

/// A number and how far off it may be.
pub(super) fn with_error(value: Option<f64>, error: Option<f64>, digits: usize, none: &str) -> String {
    let error = value.and(error).map_or(String::new(), |error| format!(" ± {}", off_by(error, digits)));
    format!("{}{error}", cell(value, digits, none))
}

/// When a wall closed, and that it opened again.
pub(super) fn stood(closed: String, reopened: Option<f64>) -> String {
    reopened.map_or_else(|| closed.clone(), |day| format!("{closed}, OPENS AGAIN on {day:.2}"))
}

/// When a wall was as designed, and when no more.
pub(super) fn designed_on(design: Option<f64>, left: Option<f64>) -> String {
    let from = cell(design, 1, "never");
    left.map_or_else(|| from.clone(), |day| format!("{from}, NO MORE from {day:.1}"))
}
