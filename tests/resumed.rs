//! Comparisons that are killed and go on: what is finished is not run again, and the tables are those of one never stopped.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};

use crate::comparisons::SLAB;

type Row = BTreeMap<String, String>;

/// Time enough for everything, so that no decision hangs on it.
const SMALL: [&str; 9] = ["compare", "slab.toml", "--levels", "3", "--seeds", "6", "--budget-s", "600", "--repeats=3"];

/// A comparison of the slab: fine runs of its own are the reference, two methods are compared, and one needs an ensemble.
fn command(folder: &Path, arguments: &[&str]) -> Command {
    let slab = format!("{SLAB}[method.edpd]\nspacing_m = 0.0025\n");
    fs::write(folder.join("slab.toml"), slab).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.args(arguments).current_dir(folder);
    command
}

fn done(folder: &Path, arguments: &[&str]) -> Output {
    let output = command(folder, arguments).output().expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    output
}

/// How many runs are finished.
fn count(folder: &Path) -> usize {
    let journal = fs::read(folder.join("out/compare/runs.journal")).unwrap_or_default();
    journal.iter().filter(|byte| **byte == b'\n').count()
}

/// Keys of finished runs, in the order in which they were finished.
fn finished(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("out/compare/runs.journal")).unwrap_or_default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let key = |line: &str| {
        let (_, json) = line.split_once(' ').expect("a checksum");
        let entry: serde_json::Value = serde_json::from_str(json).expect("JSON");
        entry["key"].as_str().expect("a key").to_owned()
    };
    whole.lines().map(key).collect()
}

/// All tables of a comparison, without what the clock decides.
fn tables(folder: &Path) -> BTreeMap<String, Vec<Row>> {
    let timed = |table: &str, column: &str| match table {
        "comparison.csv" => {
            ["_median_s", "_min_s", "_iqr_s", "_low_s", "_high_s"].iter().any(|ending| column.ends_with(ending))
                || column == "peak_memory_bytes"
        }
        "equal_error.csv" => !["scene", "measure", "target", "method", "setting", "curve"].contains(&column),
        "equal_time.csv" => ["status", "error"].contains(&column),
        _ => false,
    };
    let read = |name: &str| {
        let mut reader = csv::Reader::from_path(folder.join("out/compare").join(name)).expect("a table");
        let rows = reader.deserialize().map(|row| row.expect("a row"));
        let kept = |row: Row| row.into_iter().filter(|(column, _)| !timed(name, column)).collect();
        (name.to_owned(), rows.map(kept).collect())
    };
    ["comparison.csv", "convergence.csv", "equal_error.csv", "equal_time.csv", "slab/local_best/front.csv"]
        .map(read)
        .into()
}

fn kill_after(mut child: Child, folder: &Path, runs: usize) {
    let began = Instant::now();
    while count(folder) < runs && began.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_micros(200));
    }
    // SIGKILL.
    child.kill().expect("it was running");
    assert!(!child.wait().expect("it ends").success());
}

#[test]
fn a_comparison_that_was_killed_goes_on_and_leaves_the_same_tables() {
    let (whole, killed) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    done(whole.path(), &SMALL);
    let all = finished(whole.path());
    // Runs for a reference, first runs with their seeds, repeated runs.
    let of = |purpose: &str| all.iter().filter(|key| key.split(' ').nth(1) == Some(purpose)).count();
    assert_eq!([of("reference"), of("first"), of("seed"), of("repeat")], [4, 6, 15, 18]);
    // In the first run for the reference, between them, among first runs, in an ensemble, among repeated runs.
    let mut in_time = 0;
    for runs in [0, 2, 6, 9, 14, 30] {
        let before = finished(killed.path());
        let child = command(killed.path(), &SMALL).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        kill_after(child.expect("the program starts"), killed.path(), runs);
        let after = finished(killed.path());
        assert_eq!(after[..before.len()], before, "what was finished stays");
        in_time += usize::from(after.len() < all.len());
    }
    assert!(in_time > 3, "it was killed too late");
    let known = finished(killed.path());
    let output = done(killed.path(), &SMALL);
    let said = String::from_utf8(output.stderr).expect("text");
    let words = format!("slab: {} of {} runs taken over, with their times\n", known.len(), all.len());
    assert!(said.contains(&words), "{words}{said}");
    let finally = finished(killed.path());
    assert_eq!(finally.iter().collect::<BTreeSet<_>>().len(), finally.len(), "a run was made again");
    assert_eq!(finally.iter().collect::<BTreeSet<_>>(), all.iter().collect::<BTreeSet<_>>());
    assert!(tables(killed.path()) == tables(whole.path()), "the tables differ");
    let page = fs::read_to_string(killed.path().join("out/compare/report.html")).expect("a page");
    assert!(page.contains("runs taken over, with their times, on this machine"), "the page says so");

    // All is known now, the times too: the same files to the last byte.
    let read = |name: &str| fs::read(killed.path().join("out/compare").join(name)).expect("a table");
    let names = ["comparison.csv", "equal_error.csv", "equal_time.csv", "convergence.csv"];
    let before = names.map(read);
    done(killed.path(), &SMALL);
    assert!(names.map(read) == before, "a time was taken again");
    assert_eq!(finished(killed.path()), finally);
    // More of the same finds what there is.
    done(killed.path(), &[&SMALL[..8], &["--repeats=4"]].concat());
    assert_eq!(finished(killed.path()).len(), finally.len() + 6);
}

#[test]
fn what_decides_a_result_decides_what_is_taken_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["compare", "slab.toml", "--methods", "local", "--levels", "2", "--repeats", "1"];
    done(folder.path(), &arguments);
    let first = finished(folder.path()).len();
    assert_eq!(first, 4 + 2 + 2);
    // Another scene: nothing.
    let output = done(folder.path(), &[&arguments[..], &["--set", "initial.temperature_c=19"]].concat());
    assert!(!String::from_utf8_lossy(&output.stderr).contains("taken over"), "{output:?}");
    assert_eq!(finished(folder.path()).len(), 2 * first);
    // Another number of threads: the reference, as the times are others.
    let output = done(folder.path(), &[&arguments[..], &["--threads", "2"]].concat());
    assert!(String::from_utf8_lossy(&output.stderr).contains("4 of 8 runs taken over"), "{output:?}");
}

/// Errors that keep their signs are made of the same runs.
#[test]
fn a_variation_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["compare", "stefan-unit", "--methods", "pd", "--levels", "2", "--vary", "spacing,horizon_ratio"];
    done(folder.path(), &arguments);
    let table = fs::read(folder.path().join("out/compare/vary.csv")).expect("a table");
    let runs = finished(folder.path());
    assert_eq!(runs.len(), 10);
    let output = done(folder.path(), &arguments);
    assert!(String::from_utf8_lossy(&output.stderr).contains("10 of 10 runs taken over"), "{output:?}");
    assert_eq!(finished(folder.path()), runs);
    assert!(fs::read(folder.path().join("out/compare/vary.csv")).expect("a table") == table);
}

/// Whatever a run leaves is read back as it was, cells of maps without ground among it.
#[test]
fn whole_results_survive_being_kept() {
    let coarse = |method: &str, spacing: f64, days: f64| {
        vec![
            (format!("method.{method}.spacing_m"), format!("{spacing}")),
            ("time.duration_days".to_owned(), format!("{days}")),
            ("time.profiles_days".to_owned(), format!("[{days}]")),
        ]
    };
    for (name, method, overrides) in [
        ("frozen-wall-sand", "pd", coarse("pd", 0.2, 20.0)),
        ("frozen-wall-seepage", "local", coarse("local", 0.4, 5.0)),
        ("copper-sphere", "local", Vec::new()),
        ("advective-column", "local", Vec::new()),
    ] {
        let bundled = frazil_cases::scenes::find(name).expect("bundled");
        let scene = Scene::read(bundled, name, name, &overrides, frazil::registry::methods()).expect("a good scene");
        let reference = frazil::run::reference(&scene).unwrap_or_else(|failure| unreachable!("{failure}"));
        let options = Options { fields: true, ..Options::default() };
        let made = march::run(&scene, method, reference.as_ref(), &options).expect("a run");
        let text = serde_json::to_string(&made).expect("JSON");
        let read: RunResult = serde_json::from_str(&text).unwrap_or_else(|error| unreachable!("{name}: {error}"));
        // What is no number is not equal to itself: fields by their text, all else as it is.
        let text_of = |result: &RunResult| serde_json::to_string(&result.fields).expect("JSON");
        assert_eq!(text_of(&read), text_of(&made), "{name}");
        let bare = |result: RunResult| RunResult { fields: Vec::new(), ..result };
        assert!(bare(read) == bare(made), "{name}");
    }
}
