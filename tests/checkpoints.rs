//! Runs that are stopped and go on from a checkpoint leave what runs that were never stopped leave, to the last bit.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use frazil::registry::methods;
use frazil_core::particles::Particles;
use frazil_record::{Outcome, RunResult};
use frazil_simulation::march::{self, Checkpoints, Going, Options, Refused};
use frazil_studies::output::is_locked;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use crate::commands::{self, Single, damaged, single};

/// What a run has left, without what the clock decides.
fn left(mut result: RunResult) -> String {
    let record = &mut result.record;
    for time in [
        &mut record.setup_wall_s,
        &mut record.setup_cpu_s,
        &mut record.solve_wall_s,
        &mut record.solve_cpu_s,
        &mut record.observation_wall_s,
        &mut record.observation_cpu_s,
    ] {
        *time = 0.0;
    }
    (record.peak_memory_bytes, record.threads) = (None, 1);
    record.instruction_set.clear();
    if let Some(water) = &mut record.water {
        water.pressure_wall_s = 0.0;
    }
    serde_json::to_string(&result).expect("JSON")
}

/// Runs with checkpoints in a folder, and stops right after this output if one is given.
fn kept(
    run: &Single,
    folder: &Path,
    (every, going): (Duration, Going),
    (threads, stop): (usize, Option<usize>),
) -> Result<RunResult, Refused> {
    let (flag, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
    let see = |_: &Particles, _: f64| {
        if Some(seen.fetch_add(1, Ordering::Relaxed)) == stop {
            flag.store(true, Ordering::Relaxed);
        }
    };
    let tell = |text: &str| eprintln!("{text}");
    let checkpoints = Checkpoints::new(folder, every, (&|| "this build".into(), going), &tell);
    let options = Options {
        threads,
        interrupt: Some(&flag),
        each_output: Some(&see),
        fields: true,
        checkpoints: Some(&checkpoints),
        ..Options::default()
    };
    march::run(&run.scene, &run.method, run.reference.as_ref(), &options)
}

/// Stops a run at some output, goes on from the last checkpoint or the one before it, and stops and goes on once more.
fn stop_and_go_on(command: &str, run: &Single, random: &mut StdRng) {
    let whole = Options { fields: true, ..Options::default() };
    let whole = left(march::run(&run.scene, &run.method, run.reference.as_ref(), &whole).expect(command));
    let folder = tempfile::tempdir().expect("a folder");
    let outputs = march::outputs(&run.scene).len();
    let every = Duration::from_micros(random.random_range(200..20_000));
    let (mut going, mut stops) = (Going::Anew, 2);
    loop {
        let stop = (stops > 0).then(|| random.random_range(0..outputs));
        let threads = random.random_range(1..=3);
        let result = kept(run, folder.path(), (every, going), (threads, stop)).expect("a run");
        if result.record.outcome != Outcome::Interrupted {
            assert!(left(result) == whole, "{command}: differs after {} stops", 2 - stops);
            return;
        }
        if random.random_range(0..2) == 0 {
            fs::remove_file(folder.path().join("run.checkpoint")).expect("a checkpoint");
        }
        (going, stops) = (Going::On, stops - 1);
    }
}

/// Commands of the baseline, as many at once as there are processors.
fn all_of(commands: &[String]) {
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(command) = commands.get(next.fetch_add(1, Ordering::Relaxed)) {
            let Some(run) = single(command) else { continue };
            // Each has a seed of its own, so that one alone can be looked at.
            let seed = command.bytes().fold(1u64, |seed, byte| seed.wrapping_mul(31).wrapping_add(byte.into()));
            stop_and_go_on(command, &run, &mut StdRng::seed_from_u64(seed));
        }
    };
    std::thread::scope(|scope| {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        workers.into_iter().for_each(|worker| worker.join().expect("no differences"));
    });
}

/// Runs of all methods with what keeps something of its own: schemes, fronts inside particles, implicit steps, RKL2, cracks that
/// grow, shafts, groundwater, solutes, rain, walls of pipes, noise, motion.
const SOME: [&str; 18] = [
    "run stefan-water --method edpd",
    "run stefan-unit --method pd",
    "run soil-column --method edpd",
    "run cracks-growing --method sph",
    "run hillslope --method local",
    "run rain-on-dry-ground --method pd",
    "run column-tracer --method local",
    "run infiltration-column --method pd",
    "run thawing-inclusion --method local",
    "run interfrost-th3-3 --method sph",
    "run frozen-wall-sand --method local",
    "run disorder-30 --method sph",
    "run freeze-thaw-100 --method pd",
    "run ice-in-glass --method local",
    "run curved-wall-quench --method pd",
    "run thick-pipe-convection --method pd",
    "run random-freezing-strip --method local",
    "run copper-sphere --method pd",
];

/// The same of scenes that take long in the baseline.
const SHORTER: [&str; 4] = [
    "run entry-channel --method edpd --set time.duration=2 --set stream.average_from=1",
    "run frozen-crack --method pd --set time.duration_s=20",
    "run inclusions-permeable --method sph --set method.sph.spacing_m=0.004",
    "run frozen-wall-seepage --method pd --set time.duration_days=0.5",
];

#[test]
fn runs_that_are_stopped_go_on_to_the_same_bits() {
    let all = commands::all();
    // The first of each: overrides make it short.
    let found = SOME.iter().map(|some| all.iter().find(|command| command.starts_with(some)).expect(some).clone());
    all_of(&found.chain(SHORTER.map(str::to_owned)).collect::<Vec<_>>());
}

/// Minutes: `cargo test --release --test frazil all_runs_of_the_baseline -- --ignored`.
#[test]
#[ignore = "minutes"]
fn all_runs_of_the_baseline_go_on_to_the_same_bits() {
    all_of(&commands::all());
}

fn small() -> Single {
    single("run stefan-unit --method pd").expect("a run")
}

/// A checkpoint of another run is refused, and what differs is named; a study passes over it.
#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let often = Duration::ZERO;
    let stopped = kept(&small(), folder.path(), (often, Going::Anew), (1, Some(3))).expect("a run");
    assert_eq!(stopped.record.outcome, Outcome::Interrupted);
    for (command, difference) in [
        ("run stefan-unit --method sph", "its method is pd, that of this run is sph"),
        ("run stefan-unit --method pd --set time.outputs=7", "its scene is stefan-unit ("),
        ("run stefan-water --method pd", "its scene is stefan-unit ("),
    ] {
        let other = single(command).expect("a run");
        let refused = kept(&other, folder.path(), (often, Going::On), (1, None)).map(|_| ()).expect_err(command);
        let text = refused.to_string();
        assert!(text.contains("run.checkpoint: is of another run: ") && text.contains(difference), "{text}");
        let done = kept(&other, folder.path(), (Duration::MAX, Going::OnFromOwn), (1, None)).expect("a run");
        assert_eq!(done.record.outcome, Outcome::Ok, "{command}");
    }
}

/// What a run does with a file that is no longer what was written.
fn survives(run: &Single, folder: &Path, whole: &str, what: &str) {
    let result = kept(run, folder, (Duration::MAX, Going::On), (1, None)).expect(what);
    assert!(left(result) == whole, "{what}");
}

/// Whatever happens to the bytes of a checkpoint, it is noticed: the run goes on from the one before it, or begins anew. A hundred
/// changes here; a hundred thousand by `cargo bench --bench killer -- --checkpoints 100000`.
#[test]
fn damaged_checkpoints_are_never_taken() {
    let (run, folder) = (small(), tempfile::tempdir().expect("a folder"));
    let whole = left(kept(&run, folder.path(), (Duration::MAX, Going::Anew), (1, None)).expect("a run"));
    kept(&run, folder.path(), (Duration::ZERO, Going::Anew), (1, Some(5))).expect("a run");
    let path = folder.path().join("run.checkpoint");
    let bytes = fs::read(&path).expect("a checkpoint");
    let mut random = StdRng::seed_from_u64(1);
    for number in 0..100 {
        let other = damaged(&bytes, number, &mut random);
        fs::write(&path, &other).expect("written");
        survives(&run, folder.path(), &whole, &format!("change {number}"));
    }
    fs::remove_file(folder.path().join("run.checkpoint.before")).expect("one before");
    fs::write(&path, &bytes[1..]).expect("written");
    survives(&run, folder.path(), &whole, "no whole one");
}

/// A method's name is known to the registry, so that the list above cannot rot.
#[test]
fn the_runs_above_are_of_all_methods() {
    for kind in methods() {
        assert!(SOME.iter().any(|some| some.ends_with(kind.name)), "{}", kind.name);
    }
}

/// Files of a folder and those in it, by name.
fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry"));
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

/// Runs of everything that has figures of its own, one after the other into one folder: what is left is the last one's.
#[test]
fn a_folder_holds_the_files_of_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |command: &str, out: &str| {
        let words = command.split_whitespace().chain(["--quiet", "--threads", "1", "--out"]);
        let mut process = Command::new(env!("CARGO_BIN_EXE_frazil"));
        let output = process.args(words).arg(folder.path().join(out)).output().expect("the program starts");
        assert!(output.status.success(), "{command}: {output:?}");
    };
    for command in [
        "run wetting-plane --method local --set method.local.spacing_m=0.01 --set time.duration_days=6 --fields --frames",
        "run frozen-wall-sand --method local --set time.duration_days=2 --set method.local.spacing_m=0.2",
        "run thawing-inclusion --method local --set time.duration_s=1000",
        "run random-soil-wetting --method local --set method.local.spacing_m=0.002",
        "run entry-channel --method edpd --set time.duration=3 --set stream.average_from=1",
        "run stefan-water --method edpd --seeds 2 --set time.duration_h=0.5",
        "run stefan-unit --method pd",
    ] {
        run(command, "all");
    }
    run("run stefan-unit --method pd", "one");
    let mut all = names(&folder.path().join("all"));
    // Members of ensembles have folders of their own, which another ensemble may take over.
    all.retain(|name| !name.starts_with("seed-") && !name.ends_with(".journal"));
    assert_eq!(all, names(&folder.path().join("one")));
}

/// A second run into a folder is refused while the first one goes on, and not after it.
#[test]
fn one_run_at_a_time_writes_into_a_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = [
        "run",
        "frozen-wall-sand",
        "--method",
        "local",
        "--quiet",
        "--threads",
        "1",
        // Hours on any machine: it is stopped.
        "--set",
        "time.duration_days=40000000",
        "--out",
    ];
    let command = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
        command.args(words).arg(folder.path());
        command
    };
    let mut first = command(&words).spawn().expect("the program starts");
    let small = ["run", "stefan-unit", "--method", "pd", "--quiet", "--out"];
    while !is_locked(folder.path()) {
        assert!(first.try_wait().expect("a state").is_none(), "it is too short");
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = command(&small).output().expect("the program starts");
    let told = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(2), "{told}");
    assert!(told.contains("another run is writing into it"), "{told}");
    first.kill().expect("a kill");
    first.wait().expect("an end");
    let third = command(&small).output().expect("the program starts");
    assert!(third.status.success(), "{third:?}");
}
