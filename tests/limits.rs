//! Memory and time are known before they are taken: by the built program, whatever a scene says.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use tempfile::TempDir;

/// Longest that a check may take: its own 2 s, what it waits for a machine that is busy with other tests, and what that takes to start it.
const PATIENCE: Duration = Duration::from_secs(12);

/// Address space (KiB) of a program that is to find out by itself what it may take.
const ROOM: &str = "3000000";

fn frazil(folder: &Path, arguments: &str) -> Output {
    let limited = format!("ulimit -v {ROOM}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limited, env!("CARGO_BIN_EXE_frazil")]).args(arguments.split_whitespace());
    command.current_dir(folder).output().expect("the program starts")
}

fn said(output: &Output) -> String {
    [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).concat()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn is_empty(folder: &Path) -> bool {
    fs::read_dir(folder).expect("the folder").next().is_none()
}

/// A check ended soon, by itself, and without a forecast that is no number.
fn assert_ended(what: &str, output: &Output, took: Duration) {
    let said = said(output);
    assert!(matches!(output.status.code(), Some(0..=2)), "{what}: {:?}\n{said}", output.status);
    assert!(took < PATIENCE, "{what}: {took:?}");
    let numbers =
        said.lines().filter(|line| ["  time ", "  step", "  memory "].iter().any(|key| line.starts_with(key)));
    for line in numbers {
        let odd = line.split(|c: char| !c.is_alphanumeric()).any(|word| ["inf", "NaN"].contains(&word));
        assert!(!odd, "{what}: {line}");
    }
}

fn check(folder: &Path, arguments: &str) -> Output {
    let began = Instant::now();
    let output = frazil(folder, &format!("check --threads 1 {arguments}"));
    assert_ended(arguments, &output, began.elapsed());
    output
}

/// Numbers of bundled scenes by many powers of ten, and scenes without some of their keys.
#[test]
fn a_check_ends_soon_whatever_a_scene_says() {
    let folder = folder();
    let scenes: Vec<&str> = frazil_cases::scenes::all().iter().map(|scene| scene.text).collect();
    let mut random = StdRng::seed_from_u64(5);
    for case in 0..60 {
        let mut lines: Vec<String> = scenes[random.random_range(0..scenes.len())].lines().map(str::to_owned).collect();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..lines.len());
            let key = lines[at].split_once(" = ").map(|(key, value)| (key.to_owned(), value.parse::<f64>()));
            lines[at] = match key {
                Some((key, Ok(value))) if random.random_bool(0.9) => {
                    format!("{key} = {}", value * 10f64.powi(random.random_range(-20..20)))
                }
                _ if lines[at].contains(" = ") => String::new(),
                _ => continue,
            };
        }
        let file = format!("case-{case}.toml");
        fs::write(folder.path().join(&file), lines.join("\n")).expect("written");
        check(folder.path(), &file);
    }
}

/// Scenes whose plan takes long: by a solute that needs a step for each grain of time, by rows of a list of many pairs, by all pairs.
#[test]
fn what_cannot_be_planned_soon_is_counted_and_the_others_are_planned() {
    let folder = folder();
    for slow in [
        "stefan-water --method pd --method local --set domain.line.length_m=4000 --set method.pd.search=all-pairs --set time.profiles_h=[1] \
         --set method.local.spacing_m=4",
        "stefan-unit --method pd --method local --set method.pd.search=all-pairs --set method.pd.spacing=1e-6",
    ] {
        let output = check(folder.path(), slow);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let (first, second) = said.split_once("\nlocal\n").expect("both methods");
        assert!(first.contains("  memory       at least ") && first.contains("  not planned  "), "{said}");
        assert!(second.contains("  steps        "), "{said}");
    }
}

/// What every command that makes or plans runs says where there is no memory for one, before it writes anything.
#[test]
fn a_run_that_does_not_fit_is_refused_with_what_would_fit() {
    let folder = folder();
    let fine = "--set method.pd.spacing_m=1e-5 --set method.pd.search=tree";
    for command in [
        format!("run stefan-water --method pd --memory 2MB {fine}"),
        format!("run stefan-water --method pd --quiet --memory 2MB {fine}"),
        format!("run stefan-water --method pd --memory 2MB --seeds 2 --threads 2 --set method.pd.layout=random {fine}"),
        format!("check stefan-water --method pd --memory 2MB {fine}"),
    ] {
        let output = frazil(folder.path(), &command);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        let shared = command.contains("--seeds");
        let share =
            if shared { "1.0 MB (--memory, shared by 2 at once: fewer --threads)" } else { "2.0 MB (--memory)" };
        assert!(said.contains(&format!("and a run may take {share}: set a spacing of at least ")), "{command}: {said}");
        assert!(is_empty(folder.path()), "{command}");
    }
    let output = frazil(folder.path(), "layout shaft-single-sand --memory 200kB");
    let refused = said(&output);
    assert_eq!(output.status.code(), Some(2), "{refused}");
    assert!(refused.starts_with("layout \"frozen-wall-sand\": a spacing of 0.1 makes "), "{refused}");
    assert!(is_empty(folder.path()));
    // What the message says, taken at its word, leads to a run that fits.
    let few = "--set time.outputs=20 --set method.pd.horizon_ratio=8 --set time.profiles_h=[10]";
    let mut parts = 40_000.0;
    for attempt in 0.. {
        let spacing = format!("--set method.pd.spacing_m={} --set method.pd.search=tree --memory 2MB", 0.4 / parts);
        let output = frazil(folder.path(), &format!("check stefan-water --method pd {few} {spacing}"));
        let said = said(&output);
        if output.status.success() {
            assert!((1..4).contains(&attempt), "{attempt} spacings were tried");
            break;
        }
        let fits = said
            .rsplit("a spacing of ")
            .next()
            .and_then(|rest| rest.split_whitespace().find_map(|word| word.parse::<f64>().ok()));
        let fits = fits.unwrap_or_else(|| unreachable!("a spacing: {said}"));
        assert!(fits > 0.4 / parts, "{said}");
        parts = (0.4 / fits).floor();
    }
}

/// What a run holds at its end is counted, and it holds no more than it may: the first limit that it is not refused with is enough for it.
#[test]
fn results_are_counted_before_they_are_there() {
    let folder = folder();
    let held = "--threads 1 --set time.outputs=100000 --set time.duration_h=0.01 --set time.profiles_h=[0.01]";
    let output = frazil(folder.path(), &format!("run stefan-water --method pd --memory 2MB {held}"));
    let refused = said(&output);
    assert_eq!(output.status.code(), Some(2), "{refused}");
    assert!(
        refused.contains("of it results, and may take 2.0 MB (--memory): fewer outputs and profiles need less"),
        "{refused}"
    );
    assert!(is_empty(folder.path()));
    let output = frazil(folder.path(), &format!("run stefan-water --method pd --memory 200MB --quiet {held}"));
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

/// Without `--memory` a process knows its own limits; where the system refuses all the same, the end has a word.
#[test]
fn no_scene_ends_the_process_by_its_size() {
    let folder = folder();
    for scene in [
        "stefan-dpd-1 --method edpd --set method.edpd.spacing=0.0125",
        "stefan-dpd-1 --method pd --set method.pd.spacing=0.0125 --set method.pd.search=tree",
        "stefan-dpd-1 --method local --set method.local.spacing=0.0125 --set time.outputs=100000",
        "stefan-water --method pd --set method.pd.spacing_m=1e-7 --set method.pd.horizon_ratio=12",
        "freezing-channel-085 --method edpd --set method.edpd.spacing=0.01",
        "frozen-wall-sand --method sph --set method.sph.spacing_m=0.001 --set method.sph.search=cells",
        "frozen-wall-sand --method pd --set watch.probes_m=[] --set time.outputs=100000 --set method.pd.spacing_m=0.02",
    ] {
        check(folder.path(), scene);
        // More than there is.
        check(folder.path(), &format!("{scene} --memory 100GB"));
    }
}

/// A run that nobody lives to see is begun with `--yes` alone.
#[test]
fn a_run_of_more_than_thirty_days_is_not_begun() {
    let folder = folder();
    let long = "--threads 1 --set time.duration_days=1e11 --set time.profiles_days=[1e11]";
    for command in [
        format!("run frozen-wall-sand --method local {long}"),
        format!("run frozen-wall-sand --method local --quiet {long}"),
        format!("run frozen-wall-sand --method edpd --seeds 2 {long}"),
        format!("layout shaft-single-sand --method local {long}"),
    ] {
        let output = frazil(folder.path(), &command);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains(" on this machine, more than 30 days; --yes starts it anyway; "), "{said}");
        assert!(said.contains("shorter by "), "{said}");
        assert!(is_empty(folder.path()), "{command}");
    }
}
