//! Measured points as the reference: what a run says of them, whatever way it is asked for.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use frazil_record::{MeasuredErrors, MeasuredRow, Record};

/// A plane that freezes from its left side, whose points are the text between the files.
fn scene(reference: &str) -> String {
    format!(
        r#"
title = "A tank that freezes from one side"
source = "made up"
[domain.rectangle]
width_m = 0.2
height_m = 0.1
[time]
duration_h = 10
outputs = 7
[materials.water]
density_kg_per_m3 = 1000
frozen = {{ conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }}
unfrozen = {{ conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }}
freezing = {{ law = "isothermal", temperature_c = 0, latent_heat_J_per_kg = 334000 }}
[initial]
temperature_c = 4
[walls.left]
temperature_c = -20
[walls.right]
temperature_c = 4
[walls.bottom]
condition = "symmetry"
[walls.top]
condition = "symmetry"
[method.pd]
spacing_m = 0.005
[method.local]
spacing_m = 0.005
[method.edpd]
spacing_m = 0.005
[reference]
{reference}
"#
    )
}

const MEASURED: &str = r#"
kind = "measured"
source = "a made-up logger"
front = { file = "front.csv", sd_m = 0.001 }
probes = { file = "data/probes.csv" }
"#;

const FRONT: &str = "time_h,front_m\n0,0\n1,0.03\n3.3,0.05\n9,0.09\n";
const PROBES: &str = "# two thermometers\ntime_h,x_m,y_m,temperature_c,sd_K\n1,0.02,0.05,-5,0.1\n5.5,0.02,0.05,-15,0.1\n8,0.15,0.02,3,0.2\n";

/// A folder with the scene, its front and its probes.
fn folder(front: &str, probes: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    fs::create_dir(folder.path().join("data")).expect("a folder");
    write("tank.toml", &scene(MEASURED));
    write("front.csv", front);
    write("data/probes.csv", probes);
    folder
}

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frazil")).args(arguments).current_dir(folder).output().expect("the program starts")
}

/// What a command that goes well prints.
fn told(folder: &Path, arguments: &[&str]) -> String {
    let output = frazil(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn record(folder: &Path) -> Record {
    serde_json::from_slice(&fs::read(folder.join("record.json")).expect("a record")).expect("a record")
}

fn rows(folder: &Path) -> Vec<MeasuredRow> {
    let mut rows = csv::Reader::from_path(folder.join("measured.csv")).expect("measured.csv");
    rows.deserialize().collect::<Result<_, _>>().expect("rows")
}

/// Rows as the file of a key, with values so many standard deviations below the run's.
fn shifted(rows: &[MeasuredRow], quantity: &str, deviations: f64) -> String {
    let value = |row: &MeasuredRow| row.value.expect("a value") - deviations * row.value_ref_sd;
    let own = rows.iter().filter(|row| row.quantity == quantity);
    let line = |row: &MeasuredRow| match (row.x_m, row.y_m) {
        (Some(x), Some(y)) => format!("{},{x},{y},{:.12},{}\n", row.time_s, value(row), row.value_ref_sd),
        _ => format!("{},{:.12}\n", row.time_s, value(row)),
    };
    let head = if quantity == "front_m" { "time_s,front_m\n" } else { "time_s,x_m,y_m,temperature_c,sd_K\n" };
    own.fold(head.to_owned(), |text, row| text + &line(row))
}

/// Points that lie one and a half standard deviations below a run's own say just that of it, under every method and in a reduced
/// run; and what was measured decides no step.
#[test]
fn a_run_is_off_by_as_many_standard_deviations_as_its_points_were_moved() {
    let first = folder(FRONT, PROBES);
    for (method, more) in [("local", None), ("pd", None), ("edpd", None), ("pd", Some("--reduce"))] {
        let run = |own: &Path| {
            let arguments = ["run", "tank.toml", "--method", method, "--out", "out", "--quiet"];
            told(own, &arguments.into_iter().chain(more).collect::<Vec<_>>());
            own.join("out")
        };
        let found = run(first.path());
        let points = rows(&found);
        assert_eq!(points.len(), 6, "the row at the start is no point");
        let (front, probes) = (shifted(&points, "front_m", 1.5), shifted(&points, "temperature_c", 1.5));
        let moved = folder(&front, &probes);
        let again = run(moved.path());
        let (before, after) = (record(&found), record(&again));
        assert_eq!(before.state_hash, after.state_hash, "{method}");
        assert_ne!(before.scene_hash, after.scene_hash, "other points are another scene");
        for quantity in ["front_m", "temperature_c"] {
            let MeasuredErrors { points, missing, rms_over_sd, rms, mean, sd_rms, within_sd, within_2sd, .. } =
                after.measured[quantity];
            assert_eq!((points, missing, within_sd, within_2sd), (3, 0, 0.0, 1.0), "{method} {quantity}");
            assert!((rms_over_sd - 1.5).abs() < 1e-6, "{method} {quantity}: {rms_over_sd}");
            assert!((rms / sd_rms - 1.5).abs() < 1e-6 && mean > 0.0, "{method} {quantity}");
        }
        let front = after.errors.front_rms_rel.expect("an error of the front");
        let floor = after.reference.expect("a reference").errors["front"];
        assert!(front > 0.0 && floor > 0.0);
    }
}

#[test]
fn a_run_prints_draws_and_keeps_what_was_measured_and_is_made_again_without_the_files() {
    let folder = folder(FRONT, PROBES);
    let own = folder.path();
    let said = told(own, &["run", "tank.toml", "--method", "local", "--out", "first"]);
    for words in ["measured front", "measured temperature", "standard deviations of 1 mm", "measured, a made-up logger"]
    {
        assert!(said.contains(words), "{words} in\n{said}");
    }
    for figure in ["first/measured.svg", "first/front.svg"] {
        let drawn = fs::read_to_string(own.join(figure)).expect("a figure");
        assert!(drawn.contains("measured, ± one standard deviation"), "{figure}");
    }
    let kept = record(&own.join("first")).provenance.expect("provenance").files;
    assert_eq!(kept.keys().map(String::as_str).collect::<Vec<_>>(), ["data/probes.csv", "front.csv"]);
    for file in ["front.csv", "data/probes.csv", "tank.toml"] {
        fs::remove_file(own.join(file)).expect("removed");
    }
    assert!(told(own, &["rerun", "first", "--quiet"]).is_empty());
    let again = record(&own.join("out/rerun/tank/local"));
    assert_eq!(again.measured, record(&own.join("first")).measured);
    // A record from elsewhere writes nowhere but into its folder.
    let text = fs::read_to_string(own.join("first/record.json")).expect("a record");
    fs::write(own.join("other.json"), text.replace("\"front.csv\":", "\"../../front.csv\":")).expect("written");
    let refused = frazil(own, &["rerun", "other.json", "--out", "a/b"]);
    let words = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(words.contains("names the file \"../../front.csv\", which does not lie beside the scene"), "{words}");
    assert!(!own.join("front.csv").exists());
}

#[test]
fn another_kind_set_over_it_leaves_measured_points_alone() {
    let folder = folder(FRONT, PROBES);
    let set = ["run", "tank.toml", "--method", "local", "--quiet", "--out", "out", "--set", "reference.kind=none"];
    told(folder.path(), &set);
    let record = record(&folder.path().join("out"));
    assert!(record.measured.is_empty() && record.reference.is_none());
}

#[test]
fn points_after_the_end_are_left_out_with_a_warning() {
    let folder = folder(FRONT, PROBES);
    let output = frazil(folder.path(), &["run", "tank.toml", "--method", "local", "--set", "time.duration_h=4"]);
    let warned = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(warned.contains("reference: 3 measured points left out, after the end of the run at 4 h"), "{warned}");
    assert_eq!(record(&folder.path().join("out/tank/local")).measured["front_m"].points, 2);
}

#[test]
fn a_comparison_says_below_which_error_methods_cannot_be_ranked() {
    let folder = folder(FRONT, PROBES);
    let arguments =
        ["compare", "tank.toml", "--methods", "local,pd", "--levels", "2", "--repeats", "1", "--budget-s", "60"];
    told(folder.path(), &arguments);
    let out = folder.path().join("out/compare");
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    for words in ["Against what was measured", "errors that differ by less do not rank methods", "standard deviation"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(out.join("tank/measured.svg").is_file());
    let mut table = csv::Reader::from_path(out.join("comparison.csv")).expect("comparison.csv");
    let head = table.headers().expect("a head").clone();
    let at = |name: &str| head.iter().position(|own| own == name).expect("a column");
    for row in table.records().map(|row| row.expect("a row")) {
        let number = |name: &str| row[at(name)].parse::<f64>().expect("a number");
        let front = (0.001_f64 / 0.03).powi(2) + (0.001_f64 / 0.05).powi(2) + (0.001_f64 / 0.09).powi(2);
        assert!((number("reference_error_front_rel") - (front / 3.0).sqrt()).abs() < 1e-9);
        assert!(number("front_rms_rel") > 0.0 && number("temperature_rms_rel") > 0.0);
    }
}

/// Members of an ensemble are compared each, and so is their mean.
#[test]
fn an_ensemble_is_compared_with_what_was_measured() {
    let folder = folder(FRONT, PROBES);
    told(folder.path(), &["run", "tank.toml", "--method", "edpd", "--seeds", "3", "--quiet", "--out", "out"]);
    let out = folder.path().join("out");
    let text = fs::read_to_string(out.join("ensemble.json")).expect("a record");
    let ensemble: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(ensemble["errors"]["temperature_rms_rel"]["of_mean"].as_f64().is_some_and(|error| error > 0.0));
    let mean = csv::Reader::from_path(out.join("measured.csv")).expect("the mean").into_records().count();
    assert_eq!(mean, 6);
}

/// The bundled scenes against what is printed: the column becomes steady when the paper says, depths of thaw are met within some
/// tenths of a millimetre, and the ice of the frozen square is gone within the spread of the codes.
#[test]
fn bundled_scenes_meet_what_is_printed() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let found = |scene: &str, quantity: &str| {
        told(own, &["run", scene, "--method", "local", "--quiet", "--out", scene]);
        record(&own.join(scene)).measured[quantity]
    };
    let steady = found("soil-column-measured", "events_s");
    assert!(steady.points == 1 && steady.rms_over_sd < 1.0, "{steady:?}");
    let thaw = found("interfrost-th1", "front_m");
    assert!(thaw.points == 20 && thaw.rms < 3e-4, "{thaw:?}");
    let codes = found("interfrost-th2-9-codes", "events_s");
    assert!(codes.points == 1 && codes.rms_over_sd < 2.0, "{codes:?}");
}

#[test]
fn a_copy_of_a_bundled_scene_has_its_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = told(folder.path(), &["new", "--like", "interfrost-th1"]);
    assert!(said.contains("interfrost-th1.toml and interfrost-th1-front.csv are written"), "{said}");
    told(folder.path(), &["run", "interfrost-th1.toml", "--method", "local", "--quiet"]);
    let again = frazil(folder.path(), &["new", "other.toml", "--like", "interfrost-th1"]);
    assert!(String::from_utf8_lossy(&again.stderr).starts_with("interfrost-th1-front.csv: there is a file"));
    assert!(!folder.path().join("other.toml").exists());
}
