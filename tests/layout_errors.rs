//! `frazil layout --error`: a spacing whose answers are those of finer layouts, and what is said of it.

use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Output};

type Row = HashMap<String, String>;

fn layout(folder: &Path, words: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.args(["layout", "shaft-single-sand", "--method", "local", "--threads", "1", "--out", "out"]);
    command.args(["--set", "time.duration_days=25", "--set", "time.outputs=25", "--set", "time.profiles_days=[25]"]);
    command.args(words.split_whitespace()).current_dir(folder).output().expect("the program starts")
}

fn first_row(folder: &Path) -> Row {
    let mut reader = csv::Reader::from_path(folder.join("out/layouts.csv")).expect("a table");
    reader.deserialize().next().expect("a row").expect("a row")
}

fn number(row: &Row, key: &str) -> f64 {
    row[key].parse().unwrap_or_else(|_| unreachable!("{key}: {row:?}"))
}

/// The gap of this ring closes on day 15.40 at its narrowest (`a_ring_is_that_of_the_reference_under_each_method`).
#[test]
fn a_spacing_is_chosen_that_the_answers_ask_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = layout(folder.path(), "--error 20%");
    let (said, told) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{output:?}");
    assert!(told.contains("days of closure and thickness at the end at most"), "{told}");
    assert!(said.contains(", day to ") && said.contains(" and thickness at the end to "), "{said}");
    let row = first_row(folder.path());
    for key in ["closure_reached_rel", "thickness_reached_rel"] {
        let reached = number(&row, key);
        assert!((0.0..=0.2).contains(&reached), "{key}: {reached}");
    }
    assert!((number(&row, "closure_days") / 15.40 - 1.0).abs() < 0.2, "{row:?}");
    // Without it nothing is said, and the study's own spacing stands.
    let before = number(&row, "spacing_m");
    assert!(layout(folder.path(), "").status.success());
    let row = first_row(folder.path());
    assert!(row["closure_reached_rel"].is_empty() && number(&row, "spacing_m") < before, "{before} {row:?}");
}

#[test]
fn an_error_that_is_out_of_reach_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = layout(folder.path(), "--error 0.01% --budget-s 1");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("--error 0.01 %: layout \"") && told.contains("does not reach it with local: "), "{told}");
    assert!(!folder.path().join("out/layouts.csv").exists());
    for words in ["--error 1% --check", "--error 1% --shard 1/2", "--budget-s 5"] {
        assert_eq!(layout(folder.path(), words).status.code(), Some(2), "{words}");
    }
}

/// A wall that closes, or does not, at one of both spacings alone has no day with an error: that is said in words.
#[test]
fn a_wall_that_closes_at_one_of_both_spacings_alone_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = |duration: f64| {
        format!(
            "--set method.local.spacing_m=0.25 --set time.duration_days={duration} --set time.profiles_days=[{duration}]"
        )
    };
    assert!(layout(folder.path(), &words(25.0)).status.success());
    let row = first_row(folder.path());
    let (day, error) = (number(&row, "closure_days"), number(&row, "closure_error_days"));
    // Whichever of both is later has not closed between their days.
    let output = layout(folder.path(), &words(((day + 0.5 * error) * 10.0).round() / 10.0));
    let said = String::from_utf8_lossy(&output.stdout);
    let row = first_row(folder.path());
    assert!(row["closure_error_days"].is_empty(), "{row:?}");
    assert!(said.contains("closes on day 15.") && said.contains(", open at twice the spacing,"), "{said}");
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
    assert!(page.contains("open at twice the spacing"), "the page says nothing");
}
