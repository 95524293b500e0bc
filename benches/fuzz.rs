//! Scenes, studies and fluids that nobody wrote, by the million: none may panic, abort, take more than 2 s or 1 GiB, be refused
//! without a place, or end `ok` with a number that is none. `cargo bench --bench fuzz -- --count 10000000 --seed 1 --minutes 60`;
//! what is found is printed with its cause, and the file that does it is kept. Cases are made by processes of their own, with 4 GiB
//! of memory each, that are started again behind a case that ends them.

#![allow(clippy::print_stdout)]

#[path = "../tests/counting.rs"]
mod counting;
#[path = "../tests/fuzzed.rs"]
mod fuzzed;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::Parser;
use fuzzed::{Finding, Pool};

/// Names the folder in which a process that makes cases says where it stands.
const STATE: &str = "FRAZIL_FUZZ_STATE";
/// Memory of such a process (KiB).
const MEMORY: &str = "4194304";
/// A case that takes longer is ended.
const PATIENCE: Duration = Duration::from_secs(60);
/// How a case ended that must not end so.
const FOUND: &str = "found";

#[derive(Debug, Parser)]
struct Arguments {
    /// Cases.
    #[arg(long, default_value_t = 1_000_000)]
    count: u64,
    /// What they are drawn by.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The first of them: a single one is made again with `--first N --count 1`.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Time after which no more are made.
    #[arg(long, default_value_t = f64::INFINITY)]
    minutes: f64,
    /// Processes side by side; one for each core if absent.
    #[arg(long)]
    threads: Option<u64>,
    /// Comes from cargo.
    #[arg(long, hide = true)]
    bench: bool,
}

/// How often cases ended in each way.
type Ends = BTreeMap<String, u64>;

fn main() -> ExitCode {
    let asked = Arguments::parse();
    match std::env::var(STATE) {
        Ok(state) => {
            make(Path::new(&state), &asked);
            ExitCode::SUCCESS
        }
        Err(_) => watch(&asked),
    }
}

/// Where the files are kept that do what they must not.
fn kept(seed: u64, number: u64, found: &Finding) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    let file = folder.join(format!("{seed}-{number}.toml"));
    fs::create_dir_all(&folder).and_then(|()| fs::write(&file, &found.text)).expect("written");
    println!("case {number} of seed {seed}: {} ({})", found.what, file.display());
}

/// Makes cases, and leaves the number of the present one and how the others ended.
fn make(folder: &Path, asked: &Arguments) {
    fuzzed::keep_places();
    let pool = Pool::new(folder);
    let mut ends = Ends::new();
    let file = fs::File::create(folder.join("state")).expect("a file");
    let tell = |number: u64, ends: &Ends| {
        use std::os::unix::fs::FileExt;
        let counts: Vec<String> = ends.iter().map(|(end, count)| format!("{end}={count}")).collect();
        file.write_all_at(format!("{number} {}\n", counts.join(" ")).as_bytes(), 0).expect("written");
    };
    let end = asked.first + asked.count;
    for number in asked.first..end {
        tell(number, &ends);
        let end = match pool.end(asked.seed, number) {
            Ok(end) => format!("{end:?}").to_lowercase(),
            Err(found) => {
                kept(asked.seed, number, &found);
                FOUND.into()
            }
        };
        *ends.entry(end).or_default() += 1;
    }
    tell(end, &ends);
}

/// Watches over processes that make a share of the cases each, and prints what came of all.
fn watch(asked: &Arguments) -> ExitCode {
    let began = Instant::now();
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u64);
    let threads = asked.threads.unwrap_or(cores).clamp(1, asked.count.max(1));
    let ends: Mutex<Ends> = Mutex::default();
    std::thread::scope(|scope| {
        for k in 0..threads {
            let from = asked.first + asked.count * k / threads;
            let to = asked.first + asked.count * (k + 1) / threads;
            let (ends, until) = (&ends, asked.minutes * 60.0);
            scope.spawn(move || {
                for (end, count) in share(asked.seed, from, to, || began.elapsed().as_secs_f64() > until) {
                    *ends.lock().expect("no panic").entry(end).or_default() += count;
                }
            });
        }
    });
    let ends = ends.into_inner().expect("no panic");
    let (all, seconds) = (ends.values().sum::<u64>(), began.elapsed().as_secs_f64());
    println!("\n{:<10} {:>10}", "end", "cases");
    for (end, count) in &ends {
        println!("{end:<10} {count:>10}");
    }
    println!("{:<10} {all:>10}  in {seconds:.0} s on {threads} cores, seed {}", "all", asked.seed);
    if ends.contains_key(FOUND) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Has the cases of a share made, as long as there is time.
fn share(seed: u64, first: u64, end: u64, late: impl Fn() -> bool) -> Ends {
    let folder = tempfile::tempdir().expect("a folder");
    let state = folder.path().join("state");
    let mut ends = Ends::new();
    let mut next = first;
    while next < end && !late() {
        fs::write(&state, format!("{next}\n")).expect("written");
        let mut child = process(folder.path(), seed, next, end - next);
        let (mut seen, mut since, mut in_time) = (next, Instant::now(), true);
        let ended = loop {
            std::thread::sleep(Duration::from_millis(100));
            if let Some(status) = child.try_wait().expect("a process") {
                break status.to_string();
            }
            let number = stand(&state).0;
            if number != seen {
                (seen, since) = (number, Instant::now());
            }
            in_time = !late();
            if !in_time || since.elapsed() > PATIENCE {
                child.kill().and_then(|()| child.wait()).expect("ended");
                break "takes too long".into();
            }
        };
        let (number, counts) = stand(&state);
        for (end, count) in counts {
            *ends.entry(end).or_default() += count;
        }
        if number < end && in_time {
            let what = format!("ends the process: {ended}");
            kept(seed, number, &Finding { what, text: Pool::new(folder.path()).case(seed, number).file() });
            *ends.entry(FOUND.into()).or_default() += 1;
        }
        next = (number + 1).max(next + 1);
    }
    ends
}

/// This program as one that makes cases.
fn process(folder: &Path, seed: u64, first: u64, count: u64) -> std::process::Child {
    let program: PathBuf = std::env::current_exe().expect("a name");
    let limited = format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"");
    let numbers = [("--seed", seed), ("--first", first), ("--count", count)];
    Command::new("sh")
        .args(["-c", &limited])
        .arg(&program)
        .args(numbers.iter().flat_map(|(flag, number)| [(*flag).to_owned(), number.to_string()]))
        .env(STATE, folder)
        .spawn()
        .expect("a process")
}

/// The case at hand, and how those before it ended.
fn stand(state: &Path) -> (u64, Vec<(String, u64)>) {
    let text = fs::read_to_string(state).unwrap_or_default();
    let mut words = text.lines().next().unwrap_or_default().split_whitespace();
    let case = words.next().and_then(|word| word.parse().ok()).unwrap_or(0);
    let count = |word: &str| word.split_once('=').and_then(|(end, count)| Some((end.to_owned(), count.parse().ok()?)));
    (case, words.filter_map(count).collect())
}
