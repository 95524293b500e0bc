//! What `frazil cheapest` promises is what finer runs and references find.

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

use frazil_simulation::march::{self, Options};
use frazil_simulation::measure;
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
        let options = Options { time_limit_s: Some(300.0), ..Options::default() };
        let result = march::run(&scene, method, reference.as_ref(), &options).ok()?;
        Some((scene, result)).filter(|(_, result)| result.record.outcome == frazil_record::Outcome::Ok)
    };
    let ((mut scene, coarse), (_, fine)) = (run(spacing)?, run(0.25 * spacing)?);
    let truth = LocalReference::new(&scene, fine);
    judge_alike(&mut scene, spacing, &truth);
    let headline = Headline::ALL.into_iter().find(|headline| headline.name() == row["measure"])?;
    headline.of(&measure::errors(&scene, spacing, &coarse, &truth)).map(f64::abs)
}

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

/// Minutes: `cargo test --release --test frazil promises -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn promises_are_kept_on_six_scenes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut all, mut kept, mut forecast, mut in_time) = (0, 0, 0, 0);
    for scene in
        ["stefan-water", "soil-column", "frozen-wall-sand", "thawing-inclusion", "wetting-column", "copper-sphere"]
    {
        for error in ["5%", "2%", "1%", "0.5%"] {
            let out = folder.path().join(scene).join(error);
            for row in chosen(&format!("{scene} --error {error} --budget-s 30"), &out) {
                let Some(found) = found(&row) else {
                    eprintln!("{scene} {error} {}: a run four times finer takes too long", row["method"]);
                    continue;
                };
                let promised = number(&row, "promised_error").expect("a promise");
                let cost = number(&row, "cpu_s").expect("a cost");
                let ratio = number(&row, "forecast_cpu_s").map(|forecast| forecast / cost);
                all += 1;
                kept += usize::from(found <= ALMOST * promised);
                forecast += usize::from(ratio.is_some());
                in_time += usize::from(ratio.is_some_and(|ratio| (0.5..=2.0).contains(&ratio)));
                eprintln!(
                    "{scene} {error} {}: promised {promised:.2e}, found {found:.2e}, forecast {ratio:.2?} of the time",
                    row["method"]
                );
            }
        }
    }
    eprintln!("{kept} of {all} promises kept; {in_time} of {forecast} forecasts within a factor of 2");
    assert!(kept as f64 >= 0.95 * f64::from(all), "{kept} of {all}");
}

#[test]
fn what_cannot_be_promised_is_refused() {
    let run = |words: &[&str]| {
        let folder = tempfile::tempdir().expect("a folder");
        let mut process = Command::new(env!("CARGO_BIN_EXE_frazil"));
        let output = process.args(words).arg("--out").arg(folder.path()).output().expect("the program starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, told) = run(&["run", "stefan-water", "--method", "pd", "--error", "0.001%", "--budget-s", "1"]);
    assert!(code == Some(2) && told.contains("--error 0.001 %: pd does not reach it on the scene"), "{told}");
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
