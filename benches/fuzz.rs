//! A million scenes and studies that nobody wrote: none may panic, abort, take more than 5 s, or end `ok` with a number that is
//! none. `cargo bench --bench fuzz -- [CASES] [SEED] [FIRST]`; what is found is printed with the file that does it. Cases are made
//! by a process of its own, with 4 GiB of memory, that is started again behind a case that ends it.

#![allow(clippy::print_stdout)]

#[path = "../tests/fuzzed.rs"]
mod fuzzed;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use fuzzed::{End, Pool};

/// Names the file in which the process that makes cases says where it stands.
const STATE: &str = "FRAZIL_FUZZ_STATE";
/// Memory of that process (KiB).
const MEMORY: &str = "4194304";
/// A case that takes longer is ended.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).filter_map(|argument| argument.parse::<u64>().ok());
    let (cases, seed) = (numbers.next().unwrap_or(1_000_000), numbers.next().unwrap_or(1));
    let first = numbers.next().unwrap_or(0);
    match std::env::var(STATE) {
        Ok(state) => {
            make(Path::new(&state), seed, first, first + cases);
            ExitCode::SUCCESS
        }
        Err(_) => watch(seed, first, first + cases),
    }
}

/// Makes cases, and leaves the number of the present one and how the others ended.
fn make(state: &Path, seed: u64, first: u64, end: u64) {
    fuzzed::keep_places();
    let pool = Pool::new();
    let mut ends: BTreeMap<String, u64> = BTreeMap::new();
    let file = fs::File::create(state).expect("a file");
    let tell = |case: u64, ends: &BTreeMap<String, u64>| {
        use std::os::unix::fs::FileExt;
        let counts: Vec<String> = ends.iter().map(|(end, count)| format!("{end}={count}")).collect();
        file.write_all_at(format!("{case} {}\n", counts.join(" ")).as_bytes(), 0).expect("written");
    };
    for case in first..end {
        tell(case, &ends);
        let end = match pool.case(seed, case) {
            Ok(end) => end_words(end),
            Err(found) => {
                println!("=== case {case} of seed {seed}: {}\n{}", found.what, found.text);
                "found".into()
            }
        };
        *ends.entry(end).or_default() += 1;
    }
    tell(end, &ends);
}

fn end_words(end: End) -> String {
    format!("{end:?}").to_lowercase()
}

/// Watches over the process that makes cases.
fn watch(seed: u64, first: u64, end: u64) -> ExitCode {
    let folder = tempfile::tempdir().expect("a folder");
    let state = folder.path().join("state");
    let program = std::env::current_exe().expect("a name");
    let began = Instant::now();
    let mut ends: BTreeMap<String, u64> = BTreeMap::new();
    let mut next = first;
    while next < end {
        fs::write(&state, format!("{next}\n")).expect("written");
        let limited = format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"");
        let mut child = Command::new("sh")
            .args(["-c", &limited])
            .arg(&program)
            .args([end - next, seed, next].map(|number| number.to_string()))
            .env(STATE, &state)
            .spawn()
            .expect("a process");
        let (mut seen, mut since) = (next, Instant::now());
        let status = loop {
            std::thread::sleep(Duration::from_millis(100));
            if let Some(status) = child.try_wait().expect("a process") {
                break Some(status);
            }
            let case = stand(&state).0;
            if case != seen {
                (seen, since) = (case, Instant::now());
            } else if since.elapsed() > PATIENCE {
                child.kill().and_then(|()| child.wait()).expect("ended");
                break None;
            }
        };
        let (case, counts) = stand(&state);
        for (end, count) in counts {
            *ends.entry(end).or_default() += count;
        }
        if case < end {
            let what = status.map_or("takes too long".into(), |status| format!("ends the process: {status}"));
            println!("=== case {case} of seed {seed}: {what}\n{}", Pool::new().text(seed, case).0);
            *ends.entry("found".into()).or_default() += 1;
        }
        next = (case + 1).max(next + 1);
    }
    let found = ends.get("found").copied().unwrap_or(0);
    let counts: Vec<String> = ends.iter().map(|(end, count)| format!("{end} {count}")).collect();
    println!("{} cases of seed {seed} in {:.0} s: {}", end - first, began.elapsed().as_secs_f64(), counts.join(", "));
    if found == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The case at hand, and how those before it ended.
fn stand(state: &Path) -> (u64, Vec<(String, u64)>) {
    let text = fs::read_to_string(state).unwrap_or_default();
    let mut words = text.lines().next().unwrap_or_default().split_whitespace();
    let case = words.next().and_then(|word| word.parse().ok()).unwrap_or(0);
    let count = |word: &str| word.split_once('=').and_then(|(end, count)| Some((end.to_owned(), count.parse().ok()?)));
    (case, words.filter_map(count).collect())
}
