//! What a comparison answers, in the terminal: who reaches which error in what time.

use std::fmt::Write;

use frazil_plots::style::{duration, percent};

use super::analysis::{AtError, Comparison, Reached, Study, TARGETS};

/// The answers of a scene, a table for each measure.
pub fn text(study: &Study) -> String {
    let mut text = String::new();
    for comparison in &study.comparisons {
        table(&mut text, study, comparison);
    }
    if study.comparisons.is_empty() {
        let _ = writeln!(text, "{}: without a reference there are no errors to compare", study.name());
    }
    text
}

fn table(text: &mut String, study: &Study, comparison: &Comparison) {
    let known = study
        .runs
        .reference_error(comparison.headline)
        .map_or(String::new(), |error| format!(", with a reference accurate to {}", percent(error, 2)));
    let _ = writeln!(
        text,
        "{}: time to an {}{known}",
        study.name(),
        comparison.headline.label().trim_start_matches("rms ")
    );
    let mut rows = vec![vec![String::new()]];
    rows[0].extend(TARGETS.map(|target| percent(target, 2)));
    for (k, curve) in comparison.curves.iter().enumerate() {
        let mut row = vec![curve.label()];
        row.extend(TARGETS.map(|target| comparison.at(target, k).map_or(String::new(), cell)));
        rows.push(row);
    }
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..=TARGETS.len()).map(width).collect();
    for row in &rows {
        let mut line = format!("  {:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(line, "  {cell:>width$}");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

/// A time, what it is worth, and whether it can be told from that of the baseline.
fn cell(entry: &AtError) -> String {
    let bound = entry.error_at_most.map_or(String::new(), |error| format!(" ({})", percent(error, 2)));
    match entry.time {
        Reached::At(time) => duration(time),
        Reached::Within(time) => format!("at most {}{bound}", duration(time)),
        Reached::Untold(time) => format!("perhaps {}{bound}", duration(time)),
        Reached::LeftOut => "left out".into(),
        Reached::Not => "not reached".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_is_said_with_the_error_that_is_known_for_sure() {
        let entry = |time, error_at_most| AtError {
            target: 0.01,
            curve: 0,
            time,
            error_at_most,
            interval: None,
            speed_up: None,
        };
        assert_eq!(cell(&entry(Reached::At(0.25), None)), duration(0.25));
        let bound = cell(&entry(Reached::Within(0.25), Some(0.005)));
        assert_eq!(bound, format!("at most {} ({})", duration(0.25), percent(0.005, 2)));
        assert!(cell(&entry(Reached::Untold(0.25), Some(0.02))).starts_with("perhaps"));
        assert_eq!(cell(&entry(Reached::LeftOut, None)), "left out");
    }
}
