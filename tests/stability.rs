//! Maps of where methods break: their boundaries against theory, and that nothing but the study decides its files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

type Row = BTreeMap<String, String>;

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.arg("stability").args(arguments).arg("--quiet").current_dir(folder);
    command
}

fn stability(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the program starts")
}

fn rows(path: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| unreachable!("{column} of {row:?}"))
}

/// Fronts inside particles bound a step by where they are nearest, far below what a linear operator bears.
const WHOLE_CELLS: [&str; 6] =
    ["--set", "method.local.front=cell", "--set", "method.pd.front=cell", "--set", "method.sph.front=cell"];

/// On both scenes, under every method: exact up to the bound by row sums; lost for good within a tenth of the linear
/// stability limit. Noise is off, as it is in maps: it does not change the operator.
#[test]
fn exactness_ends_where_theory_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["stefan-water", "frozen-wall-sand", "--axes", "own", "--set", "method.edpd.noise=false"];
    let output = stability(folder.path(), &[&arguments[..], &WHOLE_CELLS].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let rows = rows(&folder.path().join("out/stability/boundaries.csv"));
    assert_eq!(rows.len(), 8);
    for row in rows {
        // The maximum principle is a theorem: no run below the bound may fail, but one just above it may.
        assert!(number(&row, "first_loss_low") >= 1.0, "{row:?}");
        // Below: bisection leaves two per cent. Above: a mode must grow a hundredfold within the run, ten frozen layers
        // decay two per cent slower than endless ones, and the stiffest particles may lie where nothing freezes.
        let ratio = number(&row, "last_exact_over_sharp");
        assert!((0.98..=1.10).contains(&ratio), "{ratio}: {row:?}");
        assert!(number(&row, "divergence_low") >= number(&row, "last_exact_low"), "{row:?}");
    }
}

/// For all stages: stable at the stated step, no exact run beyond the limit of the polynomial, no diverging one below.
#[test]
fn super_steps_are_stable_at_their_stated_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = stability(folder.path(), &[&["stefan-water", "--axes", "rkl2"][..], &WHOLE_CELLS].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let rows = rows(&folder.path().join("out/stability/rkl2.csv"));
    assert_eq!(rows.len(), 3 * 38);
    for row in rows {
        assert!(number(&row, "last_exact_low") >= 1.0, "{row:?}");
        assert!(row["class_at_stated"] != "diverged", "{row:?}");
        // Bisection leaves two per cent.
        assert!(number(&row, "last_exact_over_limit") < 1.02, "{row:?}");
        assert!(number(&row, "divergence_over_limit") > 0.98, "{row:?}");
    }
}

const SMALL: [&str; 9] =
    ["stefan-water", "--methods", "pd,edpd", "--axes", "stefan,noise", "--values", "3", "--grid", "5"];

fn tables(folder: &Path) -> [Vec<u8>; 2] {
    ["stability.csv", "boundaries.csv"].map(|name| fs::read(folder.join("out/stability").join(name)).expect("a table"))
}

#[test]
fn a_study_that_was_killed_goes_on_and_leaves_the_same_tables() {
    let (whole, killed) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let output = stability(whole.path(), &SMALL);
    assert!(output.status.success(), "{output:?}");
    let journal = killed.path().join("out/stability/runs.journal");
    let lines = || fs::read(&journal).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count());
    // Twice, further on each time.
    for enough in [20, 60] {
        let mut child = command(killed.path(), &SMALL).stderr(Stdio::null()).spawn().expect("the program starts");
        let began = Instant::now();
        while lines() < enough && began.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().expect("it was running");
        child.wait().expect("it ends");
        assert!(lines() >= enough);
        assert!(!killed.path().join("out/stability/stability.csv").exists(), "it was killed too late");
    }
    // A kill inside a write leaves half a line.
    let bytes = fs::read(&journal).expect("the journal");
    fs::write(&journal, &bytes[..bytes.len() - 7]).expect("written");
    let known = lines();
    let output = stability(killed.path(), &SMALL);
    assert!(output.status.success(), "{output:?}");
    assert!(lines() > known);
    assert!(tables(killed.path()) == tables(whole.path()), "the tables differ");
    // Everything is known now: nothing is run again.
    let all = lines();
    assert!(stability(killed.path(), &SMALL).status.success());
    assert_eq!(lines(), all);
    assert!(tables(killed.path()) == tables(whole.path()), "the tables differ");
}

#[test]
fn tables_do_not_depend_on_threads_and_cells_are_made_again_by_their_command() {
    let folders = ["1", "3"].map(|threads| {
        let folder = tempfile::tempdir().expect("a folder");
        let output = stability(folder.path(), &[&SMALL[..], &["--threads", threads]].concat());
        assert!(output.status.success(), "{output:?}");
        folder
    });
    assert!(tables(folders[0].path()) == tables(folders[1].path()), "the tables differ");
    let cells = rows(&folders[0].path().join("out/stability/stability.csv"));
    let columns: Vec<String> =
        ["step_s", "steps", "class", "cause", "violation_rel", "setback_rel"].map(Into::into).into();
    let chosen = cells.iter().filter(|cell| cell["class"] != "exact" && cell["seeds"] == "1").step_by(9);
    let mut count = 0;
    for cell in chosen {
        let folder = tempfile::tempdir().expect("a folder");
        let words: Vec<&str> = cell["command"].split(' ').skip(2).collect();
        let output = stability(folder.path(), &words);
        assert!(output.status.code().is_some_and(|code| code < 2), "{output:?}");
        let again = rows(&folder.path().join("out/stability/stability.csv"));
        assert_eq!(again.len(), 1, "{}", cell["command"]);
        for column in &columns {
            assert_eq!(again[0][column], cell[column], "{column} of {}", cell["command"]);
        }
        count += 1;
    }
    assert!(count > 1, "{count}");
}

#[test]
fn a_refuted_bound_fails_the_check_and_refused_columns_are_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    // Apparent capacity steps over its interval within the bound.
    let apparent = "--set method.local.scheme=apparent-capacity --set method.local.interval_K=0.1 --steps 0.9";
    let arguments: Vec<&str> =
        ["stefan-water", "--methods", "local", "--axes", "own"].into_iter().chain(apparent.split(' ')).collect();
    let output = stability(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let out = folder.path().join("out/stability");
    assert_eq!(rows(&out.join("stability.csv"))[0]["class"], "phase_skipped");
    assert!(fs::read_to_string(out.join("report.html")).expect("the page").contains("skipped the freezing interval"));
    // A horizon of eight spacings cannot be doubled.
    let output = stability(
        folder.path(),
        &["stefan-water", "--methods", "pd", "--axes", "reach", "--set", "method.pd.horizon_ratio=8", "--steps", "1"],
    );
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let refused: Vec<Row> =
        rows(&out.join("boundaries.csv")).into_iter().filter(|row| !row["refused"].is_empty()).collect();
    assert_eq!(refused.len(), 1);
    assert!(refused[0]["refused"].contains("must be between 1 and 12"), "{refused:?}");
}

/// The page prints what the scene says, and not what one of its columns made of it; and it says first what it calls exact.
#[test]
fn the_page_has_the_scenes_own_values_and_states_its_tolerance_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["stefan-water", "--axes", "stefan", "--methods", "local", "--values", "3", "--grid", "2"];
    let output = stability(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let page = fs::read_to_string(folder.path().join("out/stability/report.html")).expect("a page");
    assert!(page.contains("latent heat 334000") || page.contains("latent heat 3.34e5"), "the scene has 334 kJ/kg");
    assert!(!page.contains("1336000") && !page.contains("83500"), "values of columns");
    let tolerance = page.find("of the heat exchanged at every output").expect("the tolerance");
    // What the document says before its first use of the word.
    let body = page.find("<body").expect("a body");
    let exact = body + page[body..].find("exact").expect("the word");
    assert!(tolerance < exact, "{tolerance} and {exact}");
}

/// A column that water wets: steps that follow a tolerance end well with the scene's own, in soils around its own.
#[test]
fn tolerances_of_unsaturated_water_are_swept() {
    let folder = tempfile::tempdir().expect("a folder");
    let column = "title = \"Column\"\nsource = \"none\"\nbalance = \"water\"\n\
                  domain.line.length_m = 0.1\ntime = { duration_days = 5, outputs = 10 }\n\
                  initial.saturation = 0\nwalls = { left.saturation = 1, right.condition = \"symmetry\" }\n\
                  reference.kind = \"none\"\nmethod.local.spacing_m = 0.005\n[materials.soil]\n\
                  retention = { law = \"van-genuchten\", alpha_per_m = 1, n = 1.53 }\n\
                  residual_water_content = 0.186\nsaturated_water_content = 0.363\nconductivity_m_per_s = 1e-9\n";
    fs::write(folder.path().join("column.toml"), column).expect("written");
    let axes = ["column.toml", "--axes", "saturation,n", "--values", "3", "--steps", "1,100", "--coarsen", "1"];
    let output = stability(folder.path(), &axes);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let rows = rows(&folder.path().join("out/stability/stability.csv"));
    assert_eq!(rows.len(), 2 * 3 * 2);
    for row in &rows {
        assert_eq!(row["class"], "exact", "{row:?}");
        assert!(number(row, "water_taken_up_rel").abs() < 0.1, "{row:?}");
        assert!(row["command"].contains("--set method.local.tolerance="), "{row:?}");
    }
    let both = stability(folder.path(), &["column.toml", "stefan-water", "--axes", "own"]);
    assert!(String::from_utf8_lossy(&both.stderr).contains("use a separate study for each"), "{both:?}");
}
