//! Files, each whole or not at all.

pub mod cells;
pub mod of_water;

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use frazil_plots::run::is_figure;
use frazil_record::{BudgetRow, Record, RunResult, Table, UNFINISHED};
use frazil_simulation::observers::tables;
use serde::Serialize;

use crate::failure::Failure;
use crate::{fields, parallel};

/// Writes a file beside its place and moves it there when it is whole.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    frazil_record::write_whole(path, fill).map_err(|error| Failure::file(path, "cannot be written", error))
}

/// Makes a folder and those above it.
///
/// # Errors
/// Where it cannot be made.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(|error| Failure::file(path, "cannot be made a folder", error))
}

/// Writes JSON for people: indented, with a last line break.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    write_whole(path, |writer| {
        serde_json::to_writer_pretty(&mut *writer, value)?;
        writer.write_all(b"\n")
    })
}

/// Writes rows as CSV under the names of their fields.
pub fn write_rows<R: Serialize>(path: &Path, rows: &[R]) -> Result<(), Failure> {
    write_whole(path, |writer| fill_rows(writer, rows))
}

/// Writes rows of two kinds as CSV, those of the one beside those of the other.
pub fn write_beside<L: Serialize, R: Serialize>(path: &Path, left: &[L], right: &[R]) -> Result<(), Failure> {
    write_whole(path, |writer| {
        let cells = |fill: &dyn Fn(&mut dyn Write) -> io::Result<()>| -> io::Result<Vec<csv::StringRecord>> {
            let mut text = Vec::new();
            fill(&mut text)?;
            let records = csv::ReaderBuilder::new().has_headers(false).from_reader(&text[..]).into_records();
            records.collect::<Result<_, _>>().map_err(io::Error::other)
        };
        let left = cells(&|writer| fill_rows(writer, left))?;
        let right = cells(&|writer| fill_rows(writer, right))?;
        let mut csv = cells::writer(writer);
        for (own, other) in left.iter().zip(&right) {
            csv.write_record(own.iter().chain(other)).map_err(io::Error::other)?;
        }
        csv.flush()
    })
}

fn fill_rows<R: Serialize>(writer: &mut dyn Write, rows: &[R]) -> io::Result<()> {
    let mut csv = cells::writer(writer);
    for row in rows {
        csv.serialize(row).map_err(io::Error::other)?;
    }
    csv.flush()
}

/// Folders that were made for results; those still empty can be taken back.
pub struct Folder {
    path: PathBuf,
    made: Vec<PathBuf>,
    /// The folder itself, locked: the lock ends with whoever holds it, however that ends.
    _lock: Option<File>,
}

/// Who may write into a folder at the same time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// Nobody else.
    Alone,
    /// Others that work on other parts of the same study.
    WithOthers,
}

/// Another run writes into a folder.
#[derive(Debug, thiserror::Error)]
#[error("another run is writing into it")]
struct Locked;

impl Folder {
    /// Makes a folder and those above it, before a run whose results would have no place, and keeps others out of it. What a run
    /// left unfinished there that was killed is removed.
    ///
    /// # Errors
    /// A folder that cannot be made, or that another run writes into.
    pub fn make(path: &Path, owner: Owner) -> Result<Self, Failure> {
        let missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = path.ancestors().take_while(missing).map(Path::to_owned).collect();
        make_folder(path)?;
        let mut lock = lock(path, owner);
        // Whoever asks where a run stands holds the folder for a moment.
        for _ in 0..TRIES {
            if lock.is_ok() {
                break;
            }
            std::thread::sleep(BETWEEN_TRIES);
            lock = self::lock(path, owner);
        }
        let lock = lock?;
        // Better now than after hours.
        tempfile::Builder::new()
            .prefix(UNFINISHED)
            .tempfile_in(path)
            .map_err(|error| Failure::file(path, "cannot be written into", error))?;
        if lock.is_some() && owner == Owner::Alone {
            sweep(path, DEEPEST)?;
        }
        Ok(Folder { path: path.to_owned(), made, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes back what was made and is still empty.
    pub fn take_back(&self) {
        for folder in &self.made {
            if fs::remove_dir(folder).is_err() {
                return;
            }
        }
    }
}

/// How often a locked folder is tried again, and how long after.
const TRIES: usize = 10;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

/// Locks a folder; nothing where the system cannot lock folders.
fn lock(path: &Path, owner: Owner) -> Result<Option<File>, Failure> {
    let Ok(folder) = File::open(path) else { return Ok(None) };
    let tried = match owner {
        Owner::Alone => folder.try_lock(),
        Owner::WithOthers => folder.try_lock_shared(),
    };
    match tried {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(Failure::of(path.display(), Locked)),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Whether a run writes into a folder.
pub fn is_locked(path: &Path) -> bool {
    lock(path, Owner::Alone).is_err()
}

/// How deep folders of results lie in each other.
pub const DEEPEST: usize = 4;

/// Removes what runs left unfinished in a folder and those in it, but for those that another run writes into.
fn sweep(folder: &Path, depth: usize) -> Result<(), Failure> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for entry in entries.flatten() {
        let (path, Ok(kind)) = (entry.path(), entry.file_type()) else { continue };
        let is_unfinished = entry.file_name().to_string_lossy().starts_with(UNFINISHED);
        let removed = match (is_unfinished, kind.is_dir()) {
            (true, true) => fs::remove_dir_all(&path),
            (true, false) => fs::remove_file(&path),
            (false, true) if depth > 0 && !is_locked(&path) => {
                sweep(&path, depth - 1)?;
                Ok(())
            }
            (false, _) => Ok(()),
        };
        removed.map_err(|error| Failure::file(&path, "cannot be removed", error))?;
    }
    Ok(())
}

/// Writes a series as CSV.
pub type Fill<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + Sync + 'a>;

/// Every series that runs may have, by the name of its file; one without rows has no file.
pub fn series(result: &RunResult) -> Vec<(&'static str, Option<Fill<'_>>)> {
    let water = result.water.as_ref();
    let of = |file: &'static str| (file, result.tables.iter().find(|table| table.file == file).and_then(fill_table));
    let known = vec![
        ("front.csv", rows(&result.front)),
        ("front_beside.csv", rows(&result.beside)),
        ("frozen.csv", rows(&result.frozen)),
        ("phases.csv", rows(&result.phases)),
        ("stream.csv", rows(&result.stream)),
        ("sections.csv", rows(&result.sections)),
        ("measured.csv", rows(&result.measured)),
        ("surfaces.csv", rows(&result.surfaces)),
        ("profiles.csv", rows(&result.profiles)),
        ("probes.csv", rows(&result.probes)),
        ("wall.csv", rows(&result.walls)),
        ("gaps.csv", rows(&result.gaps)),
        ("links.csv", rows(&result.links)),
        ("planes.csv", rows(&result.planes)),
        ("front_lines.csv", rows(&result.front_lines)),
        ("water.csv", water.and_then(|water| rows(&water.rows))),
        ("cut.csv", water.and_then(|water| rows(&water.cut))),
        ("flow.csv", water.and_then(|water| rows(&water.maps))),
        ("budget.csv", budget(&result.budget_names, &result.budget, ("stored_j", "j"))),
    ];
    let mut all: Vec<_> = known.into_iter().chain(tables().map(of)).collect();
    if result.record.of_water {
        for (name, fill) in of_water::series(result) {
            all.retain(|(other, _)| *other != name);
            all.push((name, fill));
        }
    }
    all
}

/// Writes the series of a run that have rows, and last its record: where that is, everything is. Files of an
/// earlier run that this one does not replace are removed, so that a folder never mixes two runs.
pub fn write_run(folder: &Path, result: &RunResult) -> Result<(), Failure> {
    write_run_and(folder, result, || Ok(()))
}

/// The same, with more files before the record.
pub fn write_run_and(
    folder: &Path,
    result: &RunResult,
    more: impl FnOnce() -> Result<(), Failure>,
) -> Result<(), Failure> {
    clear(folder)?;
    more()?;
    let series = series(result);
    let write = |k: usize| {
        let (name, fill) = &series[k];
        let path = folder.join(name);
        Some(fill.as_ref().map_or_else(|| remove(&path), |fill| write_whole(&path, fill)))
    };
    // Side by side, as each waits for the disk.
    parallel::in_order(series.len(), parallel::cores(), write).into_iter().flatten().collect::<Result<(), _>>()?;
    write_json(&folder.join(RECORD), &result.record)
}

/// The record of a run.
pub const RECORD: &str = "record.json";

/// The record of an ensemble.
pub const ENSEMBLE: &str = "ensemble.json";

/// The record of the run that a folder holds, if it holds one.
pub fn record_in(folder: &Path) -> Option<Record> {
    serde_json::from_str(&fs::read_to_string(folder.join(RECORD)).ok()?).ok()
}

/// Whether a folder holds the run of a record, whole.
pub fn holds(folder: &Path, record: &Record) -> bool {
    record_in(folder).is_some_and(|found| found == *record)
}

/// Takes back the word of earlier runs that a folder holds results of theirs; removes their figures, states and frames.
pub fn clear(folder: &Path) -> Result<(), Failure> {
    remove(&folder.join(RECORD))?;
    remove(&folder.join(ENSEMBLE))?;
    let nothing = RunResult::default();
    let tables = series(&nothing);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = |part: Option<&std::ffi::OsStr>| part.and_then(std::ffi::OsStr::to_str).map(str::to_owned);
        let (Some(stem), Some(ending)) = (name(path.file_stem()), name(path.extension())) else { continue };
        let of_table = || tables.iter().any(|(table, _)| table.strip_suffix(".csv") == Some(&stem));
        if ["svg", "png", "pdf"].contains(&ending.as_str()) && (is_figure(&stem) || of_table()) {
            remove(&path)?;
        }
    }
    for name in fields::NAMES {
        let path = folder.join(name);
        if path.is_dir() {
            fs::remove_dir_all(&path).map_err(|error| Failure::file(&path, "cannot be removed", error))?;
        } else {
            remove(&path)?;
        }
    }
    Ok(())
}

/// Removes a file, if it is there.
pub fn remove(path: &Path) -> Result<(), Failure> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Failure::file(path, "cannot be removed", error)),
        _ => Ok(()),
    }
}

fn rows<R: Serialize + Sync>(rows: &[R]) -> Option<Fill<'_>> {
    if rows.is_empty() { None } else { Some(Box::new(move |writer| fill_rows(writer, rows))) }
}

fn fill_table(table: &Table) -> Option<Fill<'_>> {
    if table.rows.is_empty() {
        return None;
    }
    Some(Box::new(|writer| {
        let mut csv = cells::writer(writer);
        csv.write_record(table.columns.iter().map(|column| &column.name)).map_err(io::Error::other)?;
        table.rows.iter().try_for_each(|row| csv.serialize(row)).map_err(io::Error::other)?;
        csv.flush()
    }))
}

/// A balance, by the name of what is stored and the unit of what comes in.
fn budget<'a>(
    names: &'a [String],
    rows: &'a [BudgetRow],
    (stored, unit): (&'static str, &'static str),
) -> Option<Fill<'a>> {
    if rows.is_empty() {
        return None;
    }
    Some(Box::new(move |writer| {
        let mut csv = cells::writer(writer);
        let patches = names.iter().map(|name| format!("in_{name}_{unit}"));
        let head = ["time_s".into(), stored.into()].into_iter().chain(patches).chain(["balance_rel".into()]);
        csv.write_record(head).map_err(io::Error::other)?;
        for row in rows {
            let numbers = [row.time_s, row.stored_j].into_iter().chain(row.in_j.iter().copied());
            csv.serialize(numbers.chain([row.balance_rel]).collect::<Vec<f64>>()).map_err(io::Error::other)?;
        }
        csv.flush()
    }))
}

#[cfg(test)]
mod tests {
    use frazil_record::{FrontRow, ProfileRow, Record};

    use super::*;

    #[test]
    fn files_have_the_promised_columns() {
        let folder = tempfile::tempdir().expect("a folder");
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("the file");
        let front = [FrontRow { time_s: 1.0, front_m: 0.25, front_ref_m: None }];
        write_rows(&folder.path().join("front.csv"), &front).expect("written");
        assert_eq!(read("front.csv"), "time_s,front_m,front_ref_m\n1.0,0.25,\n");
        let profile = [ProfileRow {
            time_s: 1.0,
            x_m: Some(0.5),
            temperature_c: -2.0,
            temperature_ref_c: Some(-2.5),
            frozen_fraction: 1.0,
            concentration: None,
            concentration_ref: None,
            plane: "line".into(),
            y_m: None,
            along_m: 0.5,
            mean_over: None,
        }];
        write_rows(&folder.path().join("profiles.csv"), &profile).expect("written");
        assert_eq!(
            read("profiles.csv"),
            "time_s,x_m,temperature_c,temperature_ref_c,frozen_fraction,plane,y_m,along_m,mean_over\n1.0,0.5,-2.0,-2.5,1.0,line,,0.5,\n"
        );
        let budget = [BudgetRow { time_s: 1.0, stored_j: -3.0, in_j: vec![-4.0, 1.0], balance_rel: 0.0 }];
        let names = ["left".to_owned(), "right".to_owned()];
        let fill = super::budget(&names, &budget, ("stored_j", "j")).expect("rows");
        write_whole(&folder.path().join("budget.csv"), fill).expect("written");
        assert_eq!(read("budget.csv"), "time_s,stored_j,in_left_j,in_right_j,balance_rel\n1.0,-3.0,-4.0,1.0,0.0\n");
    }

    #[test]
    fn a_folder_never_mixes_two_runs() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("gaps.csv"), "of an earlier run").expect("written");
        let result = RunResult {
            front: vec![FrontRow { time_s: 1.0, front_m: 0.5, front_ref_m: Some(0.25) }],
            ..RunResult::bare(Record { method: "pd".into(), ..Record::default() })
        };
        write_run(folder.path(), &result).expect("written");
        let mut names: Vec<_> = fs::read_dir(folder.path())
            .expect("the folder")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        assert_eq!(names, ["front.csv", "record.json"]);
        let text = fs::read_to_string(folder.path().join("record.json")).expect("the record");
        let record: Record = serde_json::from_str(&text).expect("a record");
        assert_eq!(record, result.record);
    }

    #[test]
    fn folders_without_results_are_taken_back() {
        let folder = tempfile::tempdir().expect("a folder");
        Folder::make(&folder.path().join("out/scene"), Owner::Alone).expect("made").take_back();
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
    }
}
