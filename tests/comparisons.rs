//! What a comparison says: of errors that runs reach, of runs that the time did not suffice for, of scenes that were varied.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use frazil::registry::methods;
use frazil_record::{Record, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};

type Row = BTreeMap<String, String>;

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.args(arguments).current_dir(folder).output().expect("the program starts")
}

fn rows(folder: &Path, name: &str) -> Vec<Row> {
    let path = folder.join("out/compare").join(name);
    let mut reader = csv::Reader::from_path(&path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &Row, column: &str) -> Option<f64> {
    row[column].parse().ok()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn record(path: &Path) -> Record {
    let text = fs::read_to_string(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    serde_json::from_str(&text).expect("a record")
}

/// In closure and in temperature: a finished run whose error is below a target fills the cells of its method from there on,
/// with a time that is no longer than its own, and with the error that is known for sure.
#[test]
fn every_cell_that_a_finished_run_reaches_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut arguments =
        vec!["compare", "frozen-wall-sand", "--methods", "local,pd,sph", "--levels", "3", "--repeats", "3"];
    // The time allowed is not what this is about.
    arguments.extend(["--budget-s", "300"]);
    let spacings = ["local", "pd", "sph"].map(|method| format!("method.{method}.spacing_m=0.2"));
    spacings.iter().for_each(|set| arguments.extend(["--set", set]));
    let output = frazil(folder.path(), &arguments);
    assert!(output.status.success(), "{output:?}");
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("time to an error of the time of closure, with a reference accurate to 0.2 %"), "{told}");
    assert!(told.lines().any(|line| line.contains("local best") && line.contains("at most")), "{told}");
    let runs = rows(folder.path(), "comparison.csv");
    let cells = rows(folder.path(), "equal_error.csv");
    assert_eq!((runs.len(), cells.len()), (9, 2 * 6 * 3));
    let mut reached = 0;
    for cell in &cells {
        let measure = cell["measure"].as_str();
        let column = if measure == "closure" { "closure_day_rel" } else { "temperature_rms_rel" };
        let target = number(cell, "target").expect("a target");
        let own = |run: &&Row| run["method"] == cell["method"] && run["setting"] == cell["setting"];
        let below = |run: &&Row| number(run, column).is_some_and(|error| error.abs() <= target);
        let quickest =
            runs.iter().filter(own).filter(below).filter_map(|run| number(run, "total_wall_median_s")).reduce(f64::min);
        let status = cell["status"].as_str();
        match quickest {
            Some(_) => assert!(["reached", "at most", "not told"].contains(&status), "{cell:?}"),
            None => assert!(["reached", "not reached"].contains(&status), "{cell:?}"),
        }
        let bound = number(cell, "error_at_most");
        match status {
            "at most" => assert!(bound.is_some_and(|bound| bound <= target), "{cell:?}"),
            "not told" => assert!(bound.is_some_and(|bound| bound > target), "{cell:?}"),
            _ => assert_eq!(bound, None, "{cell:?}"),
        }
        reached += usize::from(status == "reached" || status == "at most");
        assert!(status == "not reached" || number(cell, "time_s").is_some(), "{cell:?}");
    }
    // Three coarse spacings get as far as 2 % of closure and 0.5 % of temperature.
    assert!(reached >= 12, "{reached}");
    // Each measure has an error of its own: 0.031 of 15.398 d, and 0.03 of 35 K.
    for run in &runs {
        assert!((number(run, "reference_error_closure_rel").expect("known") - 0.031 / 15.398).abs() < 1e-9);
        assert!((number(run, "reference_error_temperature_rel").expect("known") - 0.03 / 35.0).abs() < 1e-9);
    }
}

/// A misspelt word costs no run, and leaves no folder.
#[test]
fn what_no_scene_takes_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    for (flag, value, wanted) in [
        ("--also", "foo=1", "--also foo=1: no method of scene `stefan-unit` takes it"),
        ("--also", "mean=hormonic", "must be \"harmonic\", \"arithmetic\" or \"geometric\""),
        ("--also", "horizon_ratio=1e9", "--also horizon_ratio=1e9: no method"),
        ("--methods", "local,pdd", "--methods pdd: there are local"),
        ("--set", "time.durations=1", "unknown key, did you mean"),
        ("--settings", "worst", "must be \"best\" or \"paper\""),
    ] {
        let output = frazil(folder.path(), &["compare", "stefan-water", "stefan-unit", flag, value]);
        assert_eq!(output.status.code(), Some(2), "{flag} {value}: {output:?}");
        let said = said(&output);
        let wanted = wanted.replace("stefan-unit", "stefan-water");
        assert!(said.contains(&wanted), "{flag} {value}: {said}");
        assert!(!said.contains("configurations"), "{said}");
    }
    // Settings beside each other have no place where errors keep their signs.
    let vary = ["compare", "stefan-unit", "--vary", "spacing,horizon_ratio", "--also", "mean=harmonic"];
    assert_eq!(frazil(folder.path(), &vary).status.code(), Some(2));
    assert_eq!(frazil(folder.path(), &[&vary[..4], &["--methods", "pdd"]].concat()).status.code(), Some(2));
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
    // What one of the methods takes is taken.
    let arguments = ["compare", "stefan-unit", "--methods", "local,pd", "--levels", "1", "--also", "horizon_ratio=4"];
    let output = frazil(folder.path(), &arguments);
    assert!(output.status.success(), "{output:?}");
}

/// Another latent heat is another problem than the table's: fine local runs take its place, and record and command say so.
#[test]
fn a_bundled_scene_can_be_varied() {
    let folder = tempfile::tempdir().expect("a folder");
    let heat = "materials.soil.freezing.latent_heat_J_per_kg=50000";
    let changed = ["--set", heat, "--set", "time.duration_h=20"];
    let arguments = ["compare", "soil-column", "--methods", "local", "--levels", "2", "--repeats", "1"];
    let output = frazil(folder.path(), &[&arguments[..], &changed].concat());
    assert!(output.status.success(), "{output:?}");
    let said_of = said(&output);
    assert!(said_of.contains("the latent heat is 33500 there and 50000 here"), "{said_of}");
    assert!(said_of.contains("time.profiles_h: 35, 60 skipped, after the end of the run at 20"), "{said_of}");
    let found = record(&folder.path().join("out/compare/soil-column/local_best/record.json"));
    assert_eq!(found.reference.map(|info| info.kind).as_deref(), Some("local"));
    assert!(found.remarks.iter().any(|remark| remark.contains("50000 here")), "{:?}", found.remarks);
    let page = fs::read_to_string(folder.path().join("out/compare/report.html")).expect("a page");
    assert!(page.contains("50000 here") && page.contains("35, 60 skipped"));

    // A run says it as well. Without the other end, a closed form stands in.
    let long = ["run", "soil-column", "--method", "local", "--set", "domain.line.length_m=4", "--out", "long"];
    let output = frazil(folder.path(), &long);
    assert!(output.status.success(), "{output:?}");
    assert!(
        said(&output).contains("the length is 0.2 there and 4 here; in its place: exact, Neumann"),
        "{}",
        said(&output)
    );
    let found = record(&folder.path().join("long/record.json"));
    assert_eq!(found.reference.map(|info| info.kind).as_deref(), Some("exact"));
    assert_eq!(found.remarks.len(), 1);

    // A kind can be set over the table of a file.
    for (kind, wanted) in [("none", None), ("auto", Some("table")), ("local", None)] {
        let set = format!("reference.kind={kind}");
        let output = frazil(folder.path(), &["run", "soil-column", "--method", "local", "--set", &set, "--out", kind]);
        assert!(output.status.success(), "{output:?}");
        let found = record(&folder.path().join(kind).join("record.json"));
        assert_eq!(found.reference.map(|info| info.kind).as_deref(), wanted, "{kind}");
        assert_eq!(found.remarks, Vec::<String>::new());
    }
    let output = frazil(folder.path(), &[&arguments[..], &["--set", "reference.kind=none"]].concat());
    assert!(output.status.success() && !said(&output).contains("for a reference"), "{output:?}");
}

/// The same of a copy of the file, without the command line.
#[test]
fn a_copy_of_a_bundled_scene_can_be_varied() {
    let folder = tempfile::tempdir().expect("a folder");
    let bundled = frazil_cases::scenes::find("soil-column").expect("bundled").text;
    let copy = bundled.replace("latent_heat_J_per_kg = 33500", "latent_heat_J_per_kg = 40000");
    let copy = copy.replace("duration_h = 60", "duration_h = 15");
    assert_ne!(copy, bundled);
    fs::write(folder.path().join("copy.toml"), copy).expect("written");
    let output = frazil(folder.path(), &["check", "copy.toml", "--method", "local"]);
    assert!(output.status.success(), "{output:?}");
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("warning: another reference than the scene's"), "{told}");
    assert!(told.contains("warning: time.profiles_h: 20, 35, 60 skipped"), "{told}");
}

/// Frozen soil that thaws from one end, in a body of a length.
fn thaw(length: f64, method: &str) -> Record {
    let text = r#"
title = "Thawing of frozen soil, two-phase Neumann"
source = "closed form"
[domain.line]
length_m = 6
[time]
duration_days = 60
[materials.silt]
density_kg_per_m3 = 1900
frozen = { conductivity_W_per_m_K = 2.4, heat_capacity_J_per_kg_K = 1000 }
unfrozen = { conductivity_W_per_m_K = 1.4, heat_capacity_J_per_kg_K = 1500 }
freezing = { law = "isothermal", temperature_c = -0.2, latent_heat_J_per_kg = 60000 }
[initial]
temperature_c = -4
[walls.left]
temperature_c = 12
[walls.right]
condition = "exact"
[method.local]
spacing_m = 0.05
front = "cell"
[method.pd]
spacing_m = 0.05
front = "cell"
[method.sph]
spacing_m = 0.05
front = "cell"
"#;
    let length = ("domain.line.length_m".to_owned(), format!("{length}"));
    let scene = Scene::read(text, "thaw", "thaw.toml", &[length], methods()).expect("a good scene");
    let reference = frazil::run::reference(&scene).unwrap_or_else(|failure| unreachable!("{failure}"));
    march::run(&scene, method, reference.as_ref(), &Options::default()).expect("a run").record
}

/// What has thawed does not depend on how much ice lies behind it, and so its error does not.
#[test]
fn the_error_of_a_thaw_does_not_depend_on_the_length_of_the_body() {
    for method in ["local", "pd", "sph"] {
        let short = thaw(6.0, method).errors;
        for length in [12.0, 24.0, 96.0] {
            let long = thaw(length, method).errors;
            for (name, of) in [
                ("rms", (|errors| errors.front_rms_rel) as fn(&frazil_record::Errors) -> Option<f64>),
                ("last", |errors| errors.front_last_rel),
                ("constant", |errors| errors.front_constant_rel),
            ] {
                let (short, long) = (of(&short).expect("known"), of(&long).expect("known"));
                // The far end takes its temperature from the closed form, which is 1e-4 of the range off at 6 m.
                assert!((short - long).abs() < 2e-4, "{method}, {name}: {short} at 6 m, {long} at {length} m");
            }
        }
        // A front across whole cells that has thawed 1 m across 20 particles is off by more than a thousandth under every method.
        assert!(short.front_rms_rel.is_some_and(|error| error > 1e-3), "{method}: {short:?}");
    }
}

/// A slab that freezes behind a film, for which no closed form is known.
pub const SLAB: &str = r#"
title = "Slab of food freezes from both sides in an air blast"
source = "made up"
[domain.line]
length_m = 0.05
[time]
duration_h = 4
outputs = 240
profiles_h = [0.5, 1, 2, 3]
[materials.tylose]
density_kg_per_m3 = 1000
frozen = { conductivity_W_per_m_K = 1.65, heat_capacity_J_per_kg_K = 1900 }
unfrozen = { conductivity_W_per_m_K = 0.55, heat_capacity_J_per_kg_K = 3710 }
freezing = { law = "isothermal", temperature_c = -0.6, latent_heat_J_per_kg = 209000 }
[initial]
temperature_c = 20
[walls.left]
coefficient_W_per_m2_K = 50
ambient_c = -35
[walls.right]
condition = "symmetry"
[method.local]
spacing_m = 0.001
"#;

/// Behind a film the front begins late and inside the first particle. What it does there does not rule the comparison; where
/// the scene says that it shall, a reference that does not converge names these outputs and the key.
#[test]
fn the_first_outputs_do_not_rule_a_comparison() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("slab.toml"), SLAB).expect("written");
    // So many outputs that dozens lie before the front has crossed a spacing.
    let arguments = ["compare", "slab.toml", "--levels", "2", "--repeats", "1", "--set", "time.outputs=2000"];
    let output = frazil(folder.path(), &arguments);
    assert!(output.status.success(), "{output:?}");
    for run in rows(folder.path(), "comparison.csv") {
        // With the first outputs it is 10 % and more. Without them, from four spacings on, a front that is known to the
        // half of one is off by an eighth at most, and by that over the number of spacings it comes on the way to fifty.
        let error = number(&run, "front_rms_rel").expect("an error");
        assert!(error < 0.125 / 4.0, "{run:?}");
    }
    let all = [&arguments[..], &["--set", "watch.front_from_h=0"]].concat();
    let output = frazil(folder.path(), &all);
    assert!(output.status.success(), "{output:?}");
    let said = said(&output);
    assert!(said.contains("not converged; the outputs up to") && said.contains("set watch.front_from_h = "), "{said}");
}

/// Each measure of a bundled table is known as well as the table's comments say, over what its errors are relative to.
#[test]
fn every_measure_of_a_table_has_an_error_of_its_own() {
    for (scene, measure, wanted) in [
        ("frozen-wall-sand", "closure", 0.031 / 15.398),
        ("frozen-wall-sand", "temperature", 0.03 / 35.0),
        // Judged from the first day on, when it has come from 0.1 to 0.2249 m.
        ("freezing-annulus", "front", 2e-5 / 0.1249),
        // The heat that leaves cools the wall to -55.9 degC.
        ("freezing-annulus", "temperature", 0.07 / 63.9),
        ("ice-in-glass", "volume", 0.002),
        ("ice-in-glass", "temperature", 0.16 / 105.0),
        ("thawing-inclusion", "temperature", 0.035 / 20.0),
        ("copper-sphere", "temperature", 1e-9),
    ] {
        let loaded = frazil::load::scene(scene, &[]).unwrap_or_else(|failure| unreachable!("{failure}"));
        let reference = frazil::run::reference(&loaded).unwrap_or_else(|failure| unreachable!("{failure}"));
        let found = reference.expect("a table").describe().error_of(measure);
        assert!((found / wanted - 1.0).abs() < 0.05, "{scene}, {measure}: {found}, must be {wanted}");
    }
    // Lengths: two centimetres of walls of one to two and a half metres.
    let shaft = frazil::load::scene("frozen-wall-sand", &[]).unwrap_or_else(|failure| unreachable!("{failure}"));
    let info = frazil::run::reference(&shaft).ok().flatten().expect("a table").describe();
    assert!((0.02 / 2.5..0.02 / 0.5).contains(&info.error_of("thickness")), "{info:?}");
}

/// By default noise is smaller than what the discretisation is off by without it: in temperatures and in the front, on scenes in SI
/// units; the papers' heat capacity of a particle makes it larger.
#[test]
fn default_noise_is_below_the_error_of_the_discretisation() {
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        for name in ["stefan-water", "soil-column"] {
            let run = |key: &str, value: &str| {
                let bundled = frazil_cases::scenes::find(name).expect("a scene");
                let overrides = [(format!("method.{}.{key}", kind.name), value.to_owned())];
                let scene = Scene::read(bundled, name, name, &overrides, methods());
                let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
                let reference = frazil::run::reference(&scene).expect("a reference");
                let result = march::run(&scene, kind.name, reference.as_ref(), &Options::default());
                result.unwrap_or_else(|refused| unreachable!("{refused}"))
            };
            let rms = |squares: Vec<f64>| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
            let (quiet, noisy, papers) = (run("noise", "false"), run("noise", "true"), run("heat_capacity_dpd", "1e5"));
            let front = |one: &RunResult, other: &dyn Fn(usize) -> Option<f64>| {
                let from = one.front.len() / 4;
                let away = |k: usize| Some((one.front[k].front_m / other(k)? - 1.0).powi(2));
                rms((from..one.front.len()).filter_map(away).collect())
            };
            let off = front(&quiet, &|k| quiet.front[k].front_ref_m);
            let noise = front(&noisy, &|k| Some(quiet.front[k].front_m));
            eprintln!("{name}: front off by {off:.2e}, noise {noise:.2e}");
            assert!(noise < off, "{name}: front off by {off}, noise {noise}");
            let temperature = |one: &RunResult, other: &dyn Fn(usize) -> Option<f64>| {
                let away = |k: usize| Some((one.profiles[k].temperature_c - other(k)?).powi(2));
                rms((0..one.profiles.len()).filter_map(away).collect())
            };
            let noise = |run: &RunResult| temperature(run, &|k| Some(quiet.profiles[k].temperature_c));
            let (own, loud) = (noise(&noisy), noise(&papers));
            assert!(own > 0.0 && 10.0 * own < loud, "{name}: {own} and {loud}");
            let off = temperature(&quiet, &|k| quiet.profiles[k].temperature_ref_c);
            if off.is_finite() {
                eprintln!(
                    "{name}: temperatures off by {off:.2e} K, noise {own:.2e} K, {loud:.2e} K with the papers' value"
                );
                assert!(own < off && off < loud, "{name}: off by {off}, noise {own} and {loud}");
            }
        }
    }
}
