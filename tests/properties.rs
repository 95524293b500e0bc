//! Measured properties of eDPD fluids, through the built program: files, going on after a kill, bad input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.arg("properties").args(arguments).args(["--quiet", "--out", "out"]).current_dir(folder);
    command
}

fn properties(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the program starts")
}

/// Six jobs of a second or less.
const SMALL: [&str; 9] = ["water", "--temperatures-c", "25", "--seeds", "2", "--box", "12", "--effort", "0.05"];

const TABLES: [&str; 5] = ["properties.csv", "members.csv", "msd.csv", "velocity.csv", "temperature.csv"];

fn tables(folder: &Path) -> Vec<Vec<u8>> {
    TABLES.iter().map(|name| fs::read(folder.join("out").join(name)).expect("a table")).collect()
}

/// Numbers by the names of their columns, row by row.
fn rows(folder: &Path, name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let path = folder.join("out").join(name);
    let mut reader = csv::Reader::from_path(&path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

#[test]
fn a_study_that_was_killed_goes_on_and_leaves_the_same_tables() {
    let (whole, killed) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let output = properties(whole.path(), &[&SMALL[..], &["--threads", "2"]].concat());
    assert!(output.status.success(), "{output:?}");
    let journal = killed.path().join("out/runs.journal");
    let lines = || fs::read(&journal).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count());
    let arguments = [&SMALL[..], &["--threads", "1"]].concat();
    let mut child = command(killed.path(), &arguments).stdout(Stdio::null()).spawn().expect("the program starts");
    let began = Instant::now();
    while lines() < 2 && began.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("it was running");
    child.wait().expect("it ends");
    assert!(lines() >= 2 && !killed.path().join("out/properties.csv").exists(), "it was killed too late");
    let before = lines();
    let again = properties(killed.path(), &arguments);
    assert!(again.status.success() && lines() == 6 && before < 6, "{again:?}");
    assert!(tables(whole.path()) == tables(killed.path()));
    assert_eq!(output.stdout, again.stdout);

    let table = rows(whole.path(), "properties.csv");
    let members = rows(whole.path(), "members.csv");
    assert_eq!((table.len(), members.len()), (1, 6));
    let number = |column: &str| table[0][column].parse::<f64>().expect("a number");
    let members = |measurement: &str| -> Vec<f64> {
        let own = members.iter().filter(|row| row["measurement"] == measurement);
        own.map(|row| row["value"].parse().expect("a number")).collect()
    };
    let (spread, flow, heat) = (members("diffusivity"), members("viscosity"), members("thermal_diffusivity"));
    // Rounding: Schmidt and Prandtl numbers are means of those of the seeds.
    let mean = |a: &[f64], b: &[f64]| 0.5 * (a[0] / b[0] + a[1] / b[1]);
    assert!((number("schmidt") / mean(&flow, &spread) - 1.0).abs() < 1e-14);
    assert!((number("prandtl") / mean(&flow, &heat) - 1.0).abs() < 1e-14);
    // Two seeds: an interval of 12.7 standard errors, half of their distance each.
    let half = 0.5 * (number("viscosity_high") - number("viscosity_low"));
    assert!((half / (12.706 * 0.5 * (flow[0] - flow[1]).abs()) - 1.0).abs() < 1e-4);
    assert_eq!((number("schmidt_target"), number("temperature_k")), (388.2, 298.15));
    // The force does work of some 1e-5 of the heat capacity for each particle; it is taken out.
    assert!(number("warming") < 1e-3);
    for name in ["msd", "velocity", "temperature", "schmidt", "prandtl"] {
        for ending in ["svg", "png"] {
            assert!(whole.path().join("out").join(format!("{name}.{ending}")).exists(), "{name}");
        }
    }
}

/// A row without a Prandtl number is measured without one.
#[test]
fn cold_rows_have_no_prandtl_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["--temperatures-c", "-5", "--seeds", "1", "--box", "12", "--effort", "0.01"];
    let output = properties(folder.path(), &arguments);
    assert!(output.status.success(), "{output:?}");
    let table = rows(folder.path(), "properties.csv");
    assert_eq!((table[0]["prandtl"].as_str(), table[0]["schmidt_low"].as_str()), ("", ""));
    assert!(!folder.path().join("out/prandtl.svg").exists() && folder.path().join("out/schmidt.svg").exists());
}

/// Refused before any work, and nothing is written.
#[test]
fn bad_requests_are_refused_with_their_messages() {
    let folder = tempfile::tempdir().expect("a folder");
    let bad = include_str!("../cases/bad-fluids/temperatures.toml");
    fs::write(folder.path().join("bad.toml"), bad).expect("written");
    let all = "-20, -19, -18, -17, -16, -15, -14, -13, -12, -11, -10, -9, -8, -7, -6, -5, -4, -3, -2, -1, 0, 5, 10, 15, 20, 25, 30, \
               40, 50, 60, 70, 80, 90, 100";
    for (arguments, message) in [
        (
            &["--temperatures-c", "20,22"][..],
            format!("--temperatures-c 22: water has no row of that temperature; there are {all}"),
        ),
        (
            &["--box", "10"],
            "--box 10: a periodic box of length 6.666666666666667 is too small: it must be at least 6.762 long".into(),
        ),
        (&["wine"], "\"wine\" is neither a file nor a bundled fluid; those are water".into()),
        (&["bad.toml"], "bad.toml:".into()),
        (
            &["--cutoff", "1.9"],
            "water.toml:13: rows.1.schmidt: found a Schmidt number of 10355.66, must be at most".into(),
        ),
        (
            &["--temperatures-c", "warm"],
            "error: invalid value 'warm' for '--temperatures-c <LIST>': must be a number".into(),
        ),
        (
            &["--equilibrium", "--box", "20"],
            "error: the argument '--equilibrium' cannot be used with '--box <L>'".into(),
        ),
    ] {
        let output = properties(folder.path(), arguments);
        let found = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(found.starts_with(&message), "{found}");
        assert!(output.stdout.is_empty() && !folder.path().join("out").exists(), "{arguments:?}");
    }
}

/// Steps that are too long end with a message that says where.
#[test]
fn a_step_that_is_too_long_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["--temperatures-c", "25", "--seeds", "1", "--box", "12", "--effort", "0.05", "--step", "0.5"];
    let output = properties(folder.path(), &arguments);
    let found = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{found}");
    assert!(found.contains("25 degC, seed 1: step ") && found.contains("the time step 0.5 is too long"), "{found}");
}

/// Every column of every table is in the guide.
#[test]
fn every_column_is_in_the_guide() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(properties(folder.path(), &SMALL).status.success());
    let guide = crate::documents::guide();
    for name in TABLES {
        let text = fs::read_to_string(folder.path().join("out").join(name)).expect("a table");
        for column in text.lines().next().expect("names").split(',') {
            let ends = ["_low", "_high", "_theory"];
            let column = ends.iter().find_map(|end| column.strip_suffix(end)).unwrap_or(column);
            assert!(guide.contains(&format!("`{column}`")), "{name}: {column}");
        }
    }
}
