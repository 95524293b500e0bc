//! Sweeps: all combinations of values, the same runs as by themselves, goes on where it stopped, and bad values before any work.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

type Row = BTreeMap<String, String>;

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frazil")).args(arguments).current_dir(folder).output().expect("the program starts")
}

fn rows(path: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

const SHORT: [&str; 6] =
    ["--set", "time.duration_h=2", "--set", "time.profiles_h=[2]", "--set", "watch.front_from_h=1"];

const SWEEP: [&str; 8] = [
    "sweep",
    "stefan-water",
    "--vary",
    "walls.left.temperature_c=-10,-20",
    "--vary",
    "initial.temperature_c=8..2:3",
    "--methods",
    "local,pd",
];

#[test]
fn a_sweep_has_the_runs_that_are_made_by_themselves() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let output = frazil(own, &[&SWEEP[..], &SHORT].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8(output.stdout).expect("text");
    assert!(said.starts_with("stefan-water: 12 runs\n  Front (m): 0.0"), "{said}");
    let out = own.join("out/sweep/stefan-water");
    let runs = rows(&out.join("sweep.csv"));
    let value = |row: &Row, key: &str| -> f64 { row[key].parse().expect("a number") };
    let values: Vec<(f64, f64, &str)> = runs
        .iter()
        .map(|row| {
            (value(row, "walls.left.temperature_c"), value(row, "initial.temperature_c"), row["method"].as_str())
        })
        .collect();
    let expected = [-10.0, -20.0].map(|wall| [8.0, 5.0, 2.0].map(|start| ["local", "pd"].map(|m| (wall, start, m))));
    assert_eq!(values, expected.as_flattened().as_flattened());
    // The colder the wall and the start, the further the front.
    let front = |wall: f64, start: f64, method: &str| {
        let place = values.iter().position(|one| *one == (wall, start, method)).expect("a run");
        value(&runs[place], "front_m")
    };
    for method in ["local", "pd"] {
        assert!(front(-20.0, 8.0, method) > front(-10.0, 8.0, method));
        assert!(front(-10.0, 2.0, method) > front(-10.0, 5.0, method));
    }
    let alone = [&["run", "stefan-water", "--method", "pd", "--json", "--out", "alone"][..], &SHORT].concat();
    let start = ["--set", "walls.left.temperature_c=-10", "--set", "initial.temperature_c=5"];
    let alone = frazil(own, &[&alone[..], &start].concat());
    let printed: serde_json::Value = serde_json::from_slice(&alone.stdout).expect("JSON");
    let same = runs.iter().find(|row| row["state_hash"] == printed["record"]["state_hash"].as_str().expect("a hash"));
    let same = same.expect("the run of its own is among them");
    for (name, value) in printed["results"].as_object().expect("results") {
        assert_eq!(same[name].parse().ok(), value.as_f64(), "{name}");
    }
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("<svg") && page.contains("sweep.csv") && page.contains("12 runs of one scene"));
}

#[test]
fn a_sweep_with_more_values_makes_only_the_new_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let sweep = |values: &str| {
        let vary = format!("initial.temperature_c={values}");
        let output =
            frazil(own, &[&["sweep", "stefan-water", "--vary", &vary, "--quiet", "--out", "o"][..], &SHORT].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let findings = fs::read_to_string(own.join("o/runs.journal")).expect("findings").lines().count();
        (findings, fs::read(own.join("o/sweep.csv")).expect("a table"))
    };
    assert_eq!(sweep("2,8").0, 2);
    let more = sweep("2,5,8");
    assert_eq!(more.0, 3);
    assert_eq!(sweep("2,5,8"), more, "nothing is made again, and the table is the same");
}

#[test]
fn bad_values_are_told_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let vary = "must be KEY=VALUE,VALUE,...";
    let cases: [(&[&str], &str); 7] = [
        (&["--vary", "initial.temperature_c"], vary),
        (&["--vary", "initial.temperature_c=1,1"], vary),
        (&["--vary", "initial.temperature_c=1,cold"], "--set initial.temperature_c=cold: found \"cold\""),
        (&["--vary", "initial.temperatur_c=1,2"], "--set initial.temperatur_c=1: unknown key"),
        (&["--vary", "time.outputs=1", "--vary", "time.outputs=2"], "the key is varied twice"),
        (
            &["--vary", "initial.temperature_c=1..2:9999", "--methods", "local,pd"],
            "found 19998 runs, must be at most 10000",
        ),
        (&["--vary", "initial.temperature_c=1,2", "--methods", "fem"], "--methods fem: there are "),
    ];
    for (arguments, words) in cases {
        let output = frazil(own, &[&["sweep", "stefan-water"], arguments].concat());
        let said = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
    assert_eq!(fs::read_dir(own).expect("the folder").count(), 0);
}

/// A run that breaks off is a result: the others are there, and the table says so.
#[test]
fn a_run_that_breaks_off_does_not_stop_the_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    // A step far above the bound, where explicit Euler diverges.
    let vary = ["--vary", "method.local.step_s=60,6000", "--set", "method.local.front=cell"];
    let base = ["sweep", "stefan-water", "--methods", "local", "--set", "method.local.spacing_m=0.02", "--out", "o"];
    let output = frazil(own, &[&base[..], &vary].concat());
    let said = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(1), "{said}");
    let runs = rows(&own.join("o/sweep.csv"));
    assert_eq!(runs[0]["outcome"], "ok");
    assert!(!runs[0]["front_m"].is_empty());
    assert!(runs[1]["outcome"] != "ok" && !runs[1]["cause"].is_empty() && runs[1]["front_m"].is_empty(), "{runs:?}");
}

#[test]
fn lists_and_plans_are_printed_as_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let json = |arguments: &[&str]| -> serde_json::Value {
        let output = frazil(folder.path(), arguments);
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| unreachable!("{error}: {output:?}"))
    };
    let listed = json(&["list", "--json"]);
    let text = String::from_utf8(frazil(folder.path(), &["list"]).stdout).expect("text");
    for row in listed.as_array().expect("rows") {
        let name = row["name"].as_str().expect("a name");
        assert!(text.contains(&format!("  {name} ")), "{name}");
    }
    let checked = json(&["check", "stefan-water", "--json"]);
    assert_eq!(checked["scene"], "stefan-water");
    let plans = checked["plans"].as_array().expect("plans");
    assert_eq!(plans.len(), 4);
    assert!(plans.iter().all(|plan| plan["state"] == "planned" && plan["particles"] == 200), "{plans:?}");
    let refused = json(&["check", "stefan-water", "--json", "--memory", "1kB"]);
    assert!(refused["plans"][0]["state"] == "refused" && refused["plans"][0]["cause"].is_string(), "{refused}");
    let ensemble = ["--set", "time.duration=14", "--set", "time.profiles=[7, 14]", "--set", "watch.front_from=5"];
    let ensemble =
        json(&[&["run", "stefan-dpd-1", "--method", "edpd", "--seeds", "2", "--json"][..], &ensemble].concat());
    assert_eq!(ensemble["members"].as_array().map(Vec::len), Some(2));
}
