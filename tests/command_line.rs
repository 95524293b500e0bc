//! The built program from outside: exit codes, what goes where, and that bad input writes nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use frazil_scene::Scene;
use frazil_studies::ensemble::runs::Headline;
use frazil_studies::stability::axis::Axis;

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frazil")).args(arguments).current_dir(folder).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("text")
}

#[test]
fn help_names_every_value_that_an_option_takes() {
    let folder = tempfile::tempdir().expect("a folder");
    let measures = Headline::ALL.map(Headline::name).to_vec();
    let axes = Axis::WORDS.map(|(word, _)| word).to_vec();
    for (command, option, values) in
        [("run", "--measure", &measures), ("cheapest", "--measure", &measures), ("stability", "--axes", &axes)]
    {
        let output = frazil(folder.path(), &[command, "--help"]);
        let help = text(&output.stdout).split(option).nth(1).expect("the option");
        let words = |text: &str| text.split(|c: char| !c.is_alphanumeric() && c != '_').map(String::from).collect();
        let told: BTreeSet<String> = words(help.split("\n      --").next().expect("its help"));
        for value in values {
            assert!(told.contains(*value), "{command} {option}: {value} is not in its help");
        }
    }
}

#[test]
fn bad_input_ends_with_2_says_why_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("bad.toml"), "title = 7\n").expect("written");
    for command in ["run", "check"] {
        let output = frazil(folder.path(), &[command, "bad.toml"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stdout.is_empty());
        assert!(text(&output.stderr).starts_with("bad.toml: source: missing, must be a text\n"), "{output:?}");
        assert!(text(&output.stderr).contains("bad.toml:1: title: found 7, must be a text that is not empty\n"));
    }
    for arguments in [
        &["run", "stefan-water", "--set", "method.pd.spacing_m=-1"][..],
        &["run", "stefan-water", "--set", "spacing"],
        &["run", "stefan-water", "--method", "fem"],
        &["run", "stefan-water", "--threads", "0"],
        &["run", "stefan-unit", "--paper"],
        &["run", "copper-sphere", "--paper", "--method", "sph"],
        &["check", "copper-sphere", "--paper", "--method", "local"],
        &["run", "missing.toml"],
        &["run", "."],
        &["run"],
        &["freeze"],
        &["compare"],
        &["compare", "stefan-water", "--settings", "worst"],
        &["compare", "stefan-water", "--budget-s", "nan"],
        &["sweep", "stefan-water"],
        &["sweep", "--vary", "time.outputs=1,2"],
        &["stability"],
        &["stability", "stefan-watre"],
        &["stability", "stefan-water", "--axes", "peclet"],
        &["stability", "stefan-water", "--methods", "fem"],
        &["stability", "stefan-water", "--methods", "local", "--axes", "noise"],
        &["stability", "stefan-water", "--steps", "0"],
        &["stability", "stefan-water", "--values", "4"],
        &["calibrate", "wine"],
        &["calibrate", "missing.csv"],
        &["calibrate", "--gamma", "0"],
        &["calibrate", "--dimension", "1"],
        &["calibrate", "--cutoff", "1.5"],
        &["calibrate", "--from-k", "400"],
        &["calibrate", "--prandtl", "7", "--diffusivity", "1.1"],
    ] {
        let output = frazil(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty() && output.stdout.is_empty(), "{arguments:?}");
    }
    let names: Vec<_> =
        fs::read_dir(folder.path()).expect("the folder").map(|entry| entry.expect("an entry").file_name()).collect();
    assert_eq!(names, ["bad.toml"]);
}

#[test]
fn messages_name_the_option_or_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = frazil(folder.path(), &["run", "stefan-water", "--set", "method.pd.spacing_m=-1"]);
    assert_eq!(text(&output.stderr), "--set method.pd.spacing_m=-1: found -1, must be greater than 0\n");
    let output = frazil(folder.path(), &["run", "stefan-water", "--method", "fem"]);
    assert_eq!(
        text(&output.stderr),
        "--method fem: the scene \"stefan-water\" has settings for local, pd, sph, edpd\n"
    );
    let output = frazil(folder.path(), &["run", "missing.toml"]);
    assert!(text(&output.stderr).starts_with("missing.toml: cannot be read: "));
}

#[test]
fn an_unknown_scene_suggests_the_nearest() {
    let output = frazil(Path::new("."), &["run", "stefan-watre"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("did you mean \"stefan-water\""), "{output:?}");
    let output = frazil(Path::new("."), &["check", "xyzzy"]);
    assert!(text(&output.stderr).contains("frazil list"), "{output:?}");
}

#[test]
fn list_shows_every_scene_and_method() {
    let output = frazil(Path::new("."), &["list"]);
    assert_eq!(output.status.code(), Some(0));
    let said = text(&output.stdout);
    let told = |name: &str, words: &str| {
        said.lines()
            .any(|line| line.strip_prefix("  ").and_then(|line| line.strip_prefix(name)).map(str::trim) == Some(words))
    };
    for scene in frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme()) {
        let name = scene.name;
        let read = Scene::read(scene, name, name, &[], frazil::registry::methods()).expect("a scene");
        assert!(told(name, &format!("{} ({})", read.title, read.source)), "{name}: {said}");
    }
    for study in frazil_cases::studies::all() {
        let name = study.name;
        let read = frazil_layouts::read::study(name, &[], &frazil::parts::parts(false)).expect("a study");
        assert!(told(name, &format!("{}, for layout", read.title)), "{name}: {said}");
    }
    for kind in frazil::registry::methods() {
        assert!(text(&output.stdout).contains(&format!("  {} ", kind.name)));
    }
    assert!(output.stderr.is_empty());
}

#[test]
fn help_and_version_go_to_standard_output() {
    for argument in ["--help", "--version"] {
        let output = frazil(Path::new("."), &[argument]);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains("frazil") && output.stderr.is_empty());
    }
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_is_no_failure() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_frazil"))
        .arg("list")
        .stdin(Stdio::piped())
        .stdout(closed_pipe())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdin.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}

/// The writing end of a pipe that nobody reads.
#[cfg(unix)]
fn closed_pipe() -> Stdio {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    writer.into()
}

/// Unless another folder is asked for, results go to `out/SCENE/METHOD`, so those of one method leave those of another alone.
#[test]
fn runs_under_two_methods_stand_beside_each_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |method: &str| {
        let output = frazil(folder.path(), &["run", "stefan-water", "--method", method]);
        assert!(output.status.success(), "{output:?}");
        text(&output.stdout).to_owned()
    };
    let files = |method: &str| {
        let path = folder.path().join("out/stefan-water").join(method);
        let entries = fs::read_dir(path).expect("the folder").map(|entry| entry.expect("an entry").path());
        entries.map(|path| (path.clone(), fs::read(path).expect("a file"))).collect::<BTreeMap<_, _>>()
    };
    assert!(run("local").contains("out/stefan-water/local"));
    let local = files("local");
    assert!(run("pd").contains("out/stefan-water/pd"));
    assert_eq!(files("local"), local);
    let of = |method: &str| {
        let text = fs::read_to_string(folder.path().join("out/stefan-water").join(method).join("record.json"));
        let record: serde_json::Value = serde_json::from_str(&text.expect("a record")).expect("JSON");
        record["method"].as_str().map(str::to_owned)
    };
    assert_eq!((of("local").as_deref(), of("pd").as_deref()), (Some("local"), Some("pd")));
    assert_eq!(fs::read_dir(folder.path().join("out/stefan-water")).expect("the folder").count(), 2);
}
