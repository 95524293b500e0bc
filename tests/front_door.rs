//! A newcomer's first commands, and runs that are made again from their records.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use frazil_record::Record;

use crate::commands;

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frazil")).args(arguments).current_dir(folder).output().expect("the program starts")
}

fn said(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

fn record(path: &Path) -> Record {
    serde_json::from_slice(&fs::read(path).expect("a record")).expect("a record")
}

/// A scene of one's own, its error and its picture: three commands.
#[test]
fn a_newcomer_has_a_scene_an_error_and_a_picture_in_three_commands() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    assert!(frazil(own, &["new"]).status.success());
    let changed = fs::read_to_string(own.join("scene.toml"))
        .expect("a file")
        .replace("temperature_c = -15", "temperature_c = -12");
    fs::write(own.join("scene.toml"), changed).expect("written");
    assert!(frazil(own, &["check", "scene.toml"]).status.success());
    let output = frazil(own, &["run", "scene.toml", "--method", "pd"]);
    let (told, _) = said(&output);
    assert!(
        output.status.success() && told.contains("front error") && told.contains("exact, Neumann solution"),
        "{told}"
    );
    assert!(fs::read_to_string(own.join("out/scene/pd/front.svg")).is_ok_and(|figure| figure.contains("<svg")));
    for method in ["local", "sph", "edpd"] {
        assert!(frazil(own, &["run", "scene.toml", "--method", method, "--quiet"]).status.success(), "{method}");
    }
}

#[test]
fn what_is_bundled_is_shown_and_copied_and_no_file_is_written_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let all = frazil_cases::scenes::all().iter().chain(frazil_cases::studies::all()).chain(frazil_cases::fluids::all());
    for bundled in all {
        let (shown, _) = said(&frazil(own, &["show", bundled.name]));
        assert_eq!(shown, bundled.text, "{}", bundled.name);
    }
    assert!(frazil(own, &["new", "--like", "stefan-water"]).status.success());
    let copied = frazil(own, &["run", "stefan-water.toml", "--method", "local", "--quiet"]);
    assert!(copied.status.success(), "{copied:?}");
    let (_, told) = said(&frazil(own, &["new", "--like", "stefan-water"]));
    assert_eq!(
        told,
        "stefan-water.toml: there is a file of this name already; give another one: frazil new OTHER.toml --like stefan-water\n"
    );
    let (_, told) = said(&frazil(own, &["show", "stefan-wter"]));
    assert_eq!(
        told,
        "nothing of the name \"stefan-wter\" is bundled, did you mean \"stefan-water\" or \"stefan-water-mushy\" or \"stefan-unit\"?\n"
    );
}

#[test]
fn shells_complete_every_command_and_each_has_a_manual_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let (bash, _) = said(&frazil(own, &["completions", "bash"]));
    assert!(frazil(own, &["completions", "--manual", "man"]).status.success());
    for command in ["new", "run", "rerun", "compare", "cheapest", "sweep", "stability", "layout", "list", "show"] {
        assert!(bash.contains(&format!("frazil__subcmd__{command}")) || bash.contains(&format!("frazil__{command}")));
        assert!(own.join(format!("man/frazil-{command}.1")).is_file(), "{command}");
    }
}

/// Makes a run, and again from its record on one thread and on two; the command is there for what it says of a difference.
fn run_and_rerun(own: &Path, run: &[&str]) {
    let made = frazil(own, &[run, &["--quiet", "--out", "out"]].concat());
    assert!(made.status.code().is_some_and(|code| code < 2), "{run:?}: {made:?}");
    // Also once the file is gone.
    fs::write(own.join("own.toml"), "").expect("written");
    for threads in ["1", "2"] {
        let again = frazil(own, &["rerun", "out", "--threads", threads, "--out", "again"]);
        assert_eq!(again.status.code(), made.status.code(), "{run:?}: {again:?}");
        assert!(said(&again).0.contains("the same state: "), "{run:?}: {again:?}");
    }
}

#[test]
fn runs_are_made_again_from_their_records_to_the_same_bits() {
    let runs: [&[&str]; 6] = [
        &["stefan-water", "--method", "pd"],
        &["stefan-dpd-1", "--method", "edpd", "--seed", "3", "--set", "time.duration=5"],
        &["own.toml", "--method", "sph", "--set", "method.sph.spacing_m=0.004"],
        &["copper-sphere", "--method", "local"],
        // Its start, a wall, its source and its reference are formulas.
        &["manufactured-conduction", "--method", "sph", "--set", "method.sph.spacing_m=0.1"],
        &["soil-column-printed", "--method", "pd", "--reduce", "--set", "time.duration_h=2"],
    ];
    for run in runs {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("own.toml"), frazil_cases::scenes::all()[0].text).expect("written");
        run_and_rerun(folder.path(), &[&["run"], run].concat());
    }
}

/// Every bundled scene under every method that runs it, those that take long cut short.
/// Minutes: `cargo test --release --test frazil every_bundled_scene_is_made_again -- --ignored`.
#[test]
#[ignore = "minutes"]
fn every_bundled_scene_is_made_again_from_its_record_to_the_same_bits() {
    let all: Vec<String> = commands::all().into_iter().filter(|command| command.starts_with("run ")).collect();
    for scene in frazil_cases::scenes::all() {
        assert!(all.iter().any(|command| command.starts_with(&format!("run {} ", scene.name))), "{}", scene.name);
    }
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(command) = all.get(next.fetch_add(1, Ordering::Relaxed)) {
            let folder = tempfile::tempdir().expect("a folder");
            run_and_rerun(folder.path(), &command.split_whitespace().collect::<Vec<_>>());
        }
    };
    std::thread::scope(|scope| {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        (0..workers).for_each(|_| drop(scope.spawn(work)));
    });
}

#[test]
fn another_state_is_told_with_what_may_have_made_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    assert!(frazil(own, &["run", "stefan-water", "--method", "local", "--quiet", "--out", "one"]).status.success());
    let path = own.join("one/record.json");
    let mut other = record(&path);
    other.state_hash = "0123456789abcdef".into();
    other.provenance.iter_mut().for_each(|provenance| provenance.compiler = "another".into());
    fs::write(&path, serde_json::to_string(&other).expect("JSON")).expect("written");
    let output = frazil(own, &["rerun", "one", "--quiet"]);
    let (told, _) = said(&output);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        told.starts_with("another state: 0123456789abcdef in the record, ")
            && told.contains("  compiler   another in the record, "),
        "{told}"
    );
    other.provenance = None;
    fs::write(&path, serde_json::to_string(&other).expect("JSON")).expect("written");
    let (_, told) = said(&frazil(own, &["rerun", "one/record.json"]));
    assert!(told.starts_with("one/record.json: does not hold the scene that was run"), "{told}");
}

#[test]
fn a_gallery_shows_each_scene_with_its_command_and_keeps_its_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path();
    let (told, complained) = said(&frazil(own, &["gallery", "stefan-unit", "copper-sphere", "--out", "g"]));
    assert!(told.starts_with("2 scenes, 0 without a run\n"), "{told}");
    assert!(complained.contains("1 of 2: frazil run ") && complained.contains("2 of 2: frazil run "), "{complained}");
    let page = fs::read_to_string(own.join("g/README.md")).expect("a page");
    for scene in ["stefan-unit", "copper-sphere"] {
        assert!(page.contains(&format!("`frazil run {scene}`")) && page.contains(&format!("({scene}.svg)")), "{page}");
        let picture = fs::read_to_string(own.join(format!("g/{scene}.svg"))).expect("a picture");
        let html = fs::read_to_string(own.join("g/report.html")).expect("a page");
        assert!(picture.starts_with("<svg") && html.contains(&format!("frazil run {scene}")));
    }
    let (_, complained) = said(&frazil(own, &["gallery", "stefan-unit", "copper-sphere", "--out", "g"]));
    assert_eq!(complained, "", "nothing is run again");
    let (_, complained) = said(&frazil(own, &["gallery", "stefan-unti"]));
    assert_eq!(complained, "\"stefan-unti\" is no bundled scene; frazil list shows all names\n");
}

#[test]
#[cfg(target_os = "linux")]
fn a_gallery_goes_on_while_another_program_is_installed() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::Stdio;

    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("frazil");
    fs::copy(env!("CARGO_BIN_EXE_frazil"), &program).expect("copied");
    let mut running = Command::new(&program)
        .args(["gallery", "stefan-unit", "copper-sphere", "--out", "g"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("started");
    let mut complained = BufReader::new(running.stderr.take().expect("a pipe"));
    let mut line = String::new();
    complained.read_line(&mut line).expect("a line");
    assert!(line.starts_with("1 of 2: frazil run "), "{line}");
    fs::remove_file(&program).expect("removed");
    let mut rest = String::new();
    complained.read_to_string(&mut rest).expect("read");
    let told = running.wait_with_output().expect("ended").stdout;
    assert!(told.starts_with(b"2 scenes, 0 without a run\n"), "{rest}");
}
