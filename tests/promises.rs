//! What `frazil cheapest` promises is what finer runs and references find.

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

use frazil_simulation::march::{self, Options};
use frazil_simulation::{measure, predict};
use frazil_studies::compare::reference::{LocalReference, judge_alike};
use frazil_studies::ensemble::runs::Headline;

type Row = HashMap<String, String>;

/// The rows of the runs that were chosen.
fn chosen(command: &str, out: &Path) -> Vec<Row> {
    let mut process = Command::new(env!("CARGO_BIN_EXE_frazil"));
    let words = ["cheapest"].into_iter().chain(command.split_whitespace()).chain(["--quiet", "--out"]);
    let output = process.args(words).arg(out).output().expect("the program starts");
    assert!(output.status.code().is_some_and(|code| code < 2), "{command}: {output:?}");
    let rows = csv::Reader::from_path(out.join("cheapest.csv")).expect("a table").into_deserialize::<Row>();
    rows.map(|row| row.expect("a row")).filter(|row| row["chosen"] == "true").collect()
}

fn number(row: &Row, name: &str) -> Option<f64> {
    row[name].parse().ok()
}

/// What a run at some spacing differs from one at a quarter of it.
fn found(row: &Row) -> Option<f64> {
    let (method, spacing) = (row["method"].as_str(), number(row, "spacing_m")?);
    let run = |spacing: f64| {
        let scene =
            frazil::load::scene(&row["scene"], &[(format!("method.{method}.spacing_m"), spacing.to_string())]).ok()?;
        let reference = frazil_cases::truth(&scene).ok()?.reference.map(Into::into);
        if predict::forecast(&scene, method, None, 1, 1).ok()?.seconds().is_some_and(|seconds| seconds > LONGEST_S) {
            return None;
        }
        let options = Options { time_limit_s: Some(2.0 * LONGEST_S), ..Options::default() };
        let result = march::run(&scene, method, reference.as_ref(), &options).ok()?;
        Some((scene, result)).filter(|(_, result)| result.record.outcome == frazil_record::Outcome::Ok)
    };
    let ((mut scene, coarse), (_, fine)) = (run(spacing)?, run(0.25 * spacing)?);
    let truth = LocalReference::new(&scene, fine);
    judge_alike(&mut scene, spacing, &truth);
    let headline = Headline::ALL.into_iter().find(|headline| headline.name() == row["measure"])?;
    headline.of(&measure::errors(&scene, spacing, &coarse, &truth)).map(f64::abs)
}

/// Time (s) of the longest run that a promise is held against.
const LONGEST_S: f64 = 90.0;
/// What a promise does not count in: differences of two runs are told to a twentieth, however they are measured.
const ALMOST: f64 = 1.05;

#[test]
fn what_is_promised_is_kept_against_the_closed_form() {
    let folder = tempfile::tempdir().expect("a folder");
    for error in ["5%", "1%"] {
        let rows = chosen(&format!("stefan-water --error {error} --methods local,sph,pd"), &folder.path().join(error));
        assert_eq!(rows.len(), 3, "{error}: {rows:?}");
        for row in rows {
            let [asked, promised, found] =
                ["error", "promised_error", "error_against_reference"].map(|name| number(&row, name).expect(name));
            assert!(found <= promised && promised <= asked, "{row:?}");
        }
    }
}

/// Each promise on a scene beside a run four times finer, and each forecast beside the time that the run took. What the program
/// promises of one scene, `cargo test --release --test frazil promises::kept_on_copper_sphere -- --ignored --nocapture` measures, and of
/// all, in a quarter of an hour each, `cargo test --release --test frazil promises -- --ignored --nocapture --test-threads 1`.
fn promises_on(scene: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut broken, mut held, mut late, mut told) = (0, 0, 0, 0);
    // Several errors may lead to the same run.
    let mut finer: HashMap<[String; 2], Option<f64>> = HashMap::new();
    for error in ["5%", "2%", "1%", "0.5%"] {
        for row in chosen(&format!("{scene} --error {error} --budget-s 60"), folder.path()) {
            let [spacing, promised, took] =
                ["spacing_m", "promised_error", "cpu_s"].map(|name| number(&row, name).expect(name));
            let forecast = number(&row, "forecast_cpu_s");
            let run = ["method", "spacing_m"].map(|name| row[name].clone());
            let found = *finer.entry(run).or_insert_with(|| found(&row));
            held += usize::from(found.is_some());
            broken += usize::from(found.is_some_and(|found| found > ALMOST * promised));
            told += usize::from(forecast.is_some());
            late += usize::from(forecast.is_some_and(|forecast| !(0.5..=2.0).contains(&(forecast / took))));
            let percent = |error: f64| format!("{:.3} %", 100.0 * error);
            let found = found.map_or("takes too long".to_owned(), percent);
            let forecast = forecast.map_or("none".to_owned(), |forecast| format!("{forecast:.2e} s"));
            let (method, promised) = (&row["method"], percent(promised));
            eprintln!(
                "| {scene} | {error} | {method} | {spacing} m | {promised} | {found} | {forecast} | {took:.2e} s |"
            );
        }
    }
    eprintln!(
        "{scene}: {} of {held} promises kept; {} of {told} forecasts within a factor of 2",
        held - broken,
        told - late
    );
    assert!(held > 0 && 20 * broken <= held, "{broken} of {held} promises broken");
    assert!(20 * late <= told, "{late} of {told} forecasts off by more than 2");
}

#[test]
#[ignore = "minutes"]
fn kept_on_stefan_water() {
    promises_on("stefan-water");
}

#[test]
#[ignore = "minutes"]
fn kept_on_soil_column() {
    promises_on("soil-column");
}

#[test]
#[ignore = "minutes"]
fn kept_on_frozen_wall_sand() {
    promises_on("frozen-wall-sand");
}

#[test]
#[ignore = "minutes"]
fn kept_on_thawing_inclusion() {
    promises_on("thawing-inclusion");
}

#[test]
#[ignore = "minutes"]
fn kept_on_wetting_column() {
    promises_on("wetting-column");
}

#[test]
#[ignore = "minutes"]
fn kept_on_copper_sphere() {
    promises_on("copper-sphere");
}

#[test]
fn what_cannot_be_promised_is_refused() {
    let run = |words: &[&str]| {
        let folder = tempfile::tempdir().expect("a folder");
        let mut process = Command::new(env!("CARGO_BIN_EXE_frazil"));
        let output = process.args(words).arg("--out").arg(folder.path()).output().expect("the program starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, told) = run(&["run", "stefan-water", "--method", "pd", "--error", "0.00001%", "--budget-s", "1"]);
    assert!(code == Some(2) && told.contains("--error 1 · 10⁻⁵ %: pd does not reach it on the scene"), "{told}");
    for words in ["0%", "100%", "much"] {
        let (code, told) = run(&["cheapest", "stefan-water", "--error", words]);
        assert!(code == Some(2) && told.contains("an error above 0 and below 100 %, as 1% or 0.01"), "{told}");
    }
    let (code, told) = run(&["cheapest", "stefan-water", "--error", "1%", "--measure", "warmth"]);
    assert!(code == Some(2) && told.contains("one of front, closure"), "{told}");
    // A measure that the scene does not have.
    let (code, told) =
        run(&["cheapest", "stefan-water", "--error", "1%", "--methods", "local", "--measure", "closure", "--quiet"]);
    assert!(code == Some(1) && told.is_empty(), "{told}");
}
