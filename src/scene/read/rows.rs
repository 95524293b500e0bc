//! Tables of files beside a scene, whose rows are read as sections are: a column is a key.

use super::problem::{Log, Place, Problem, Read};
use super::section::Section;
use super::tree::{Entry, Node};
use crate::units::Units;

/// Rows that a file may have.
const MOST_ROWS: usize = 100_000;

/// Reads the rows of comma-separated text under a line of names; lines that begin with `#` are comments, and an empty cell counts as
/// absent. `read` takes a row, and what it gives is kept where it gives something. Problems are recorded with the file's name, its line
/// and the column; then there are no rows.
///
/// Where a column is missing, or one too many, nothing is told of further rows, which would say the same.
pub(super) fn rows<T>(
    text: &str,
    file: &str,
    units: Units,
    log: &Log,
    mut read: impl FnMut(&mut Section<'_>) -> Option<T>,
) -> Read<Vec<T>> {
    let own = Log::default();
    let text = text.trim_start_matches('\u{feff}');
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let found = names(&mut reader, &own).map(|names| {
        let mut found = Vec::new();
        for (number, record) in reader.records().enumerate() {
            let record = match record {
                Ok(record) => record,
                Err(error) => {
                    own.record(Problem::new(&line_of(error.position()), "", uneven(&error)));
                    break;
                }
            };
            let place = line_of(record.position());
            if number == MOST_ROWS {
                own.record(Problem::new(
                    &place,
                    "",
                    format!("found more than {MOST_ROWS} rows, must be at most as many"),
                ));
                break;
            }
            let entries = entries(&names, &record, &place);
            let mut row = Section::row(&entries, place, units, &own);
            found.extend(read(&mut row));
            if number > 0 {
                // What is wrong with the columns has been said of the first row.
                row.abandon();
            }
            drop(row);
            if number == 0 && own.is_about_others(&names) {
                break;
            }
        }
        found
    });
    if found.as_ref().is_some_and(Vec::is_empty) && own.next() == 0 {
        own.record(Problem::new(&Place::File, "", "found no rows, must have one at least"));
    }
    let problems = own.into_problems().into_iter();
    match problems.map(|problem| log.record(Problem { beside: Some(file.to_owned()), ..problem })).last() {
        Some(noted) => Err(noted),
        None => Ok(found.unwrap_or_default()),
    }
}

/// The names of the columns, each once.
fn names(reader: &mut csv::Reader<&[u8]>, log: &Log) -> Option<Vec<String>> {
    let head = match reader.headers() {
        Ok(head) => head.clone(),
        Err(error) => {
            log.record(Problem::new(&line_of(error.position()), "", uneven(&error)));
            return None;
        }
    };
    let names: Vec<String> = head.iter().map(str::to_owned).collect();
    for (k, name) in names.iter().enumerate().filter(|(k, name)| names[..*k].contains(name)) {
        let message = format!("found twice, as columns {} and {}", 1 + place_of(&names, name), k + 1);
        log.record(Problem::new(&line_of(head.position()), name.as_str(), message));
    }
    (log.next() == 0).then_some(names)
}

fn place_of(names: &[String], name: &str) -> usize {
    names.iter().position(|own| own == name).unwrap_or_default()
}

/// Cells of a row that hold something, as keys with values.
fn entries(names: &[String], record: &csv::StringRecord, place: &Place) -> Vec<Entry> {
    let cell = |(name, cell): (&String, &str)| {
        let node = match cell.parse::<f64>() {
            Ok(number) => Node::Number(cell.to_owned(), number, cell.parse().ok()),
            Err(_) => Node::Text(cell.to_owned()),
        };
        (!cell.is_empty()).then(|| Entry { key: name.clone(), place: place.clone(), node })
    };
    names.iter().zip(record).filter_map(cell).collect()
}

fn line_of(position: Option<&csv::Position>) -> Place {
    position.map_or(Place::File, |position| Place::Line(position.line() as usize))
}

/// What is wrong with a row that is none, in words.
fn uneven(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("found a row of {len} cells, must be {expected_len} as in the line of names")
        }
        _ => format!("not a table of cells between commas: {error}"),
    }
}
