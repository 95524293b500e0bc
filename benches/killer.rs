//! Whether runs outlive what ends them: commands of `tests/baseline.csv` killed at random moments, gone on with until they are
//! done, and compared with the same command left alone.
//!
//! `cargo bench --bench killer` kills a hundred times, half of them by SIGKILL and half by SIGINT; `-- --kills 1000 --seed 2
//! --minutes 20 --only edpd` as often as asked, no longer, and only commands with a word; `--program FILE` those of another build;
//! `-- --checkpoints 100000` damages the bytes of checkpoints instead, `-- --disks 200` fills small file systems that it mounts,
//! and `-- --soak 500` makes so many runs in one process, eight at once, in five rounds, and watches its memory
//! (under `MALLOC_ARENA_MAX=1` where the C library is glibc, whose arenas keep what threads have freed).
//! Exit code 1 says that an end differs from that of the run left alone, or that something was left behind.

#![allow(clippy::print_stdout)]

#[path = "../tests/commands.rs"]
mod commands;
mod gathered;

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use clap::Parser;
use commands::{Single, damaged, single};
use frazil_core::particles::Particles;
use frazil_simulation::march::{self, Checkpoints, Going, Options};
use gathered::gather;
use rand::rngs::StdRng;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use xxhash_rust::xxh3::xxh3_64;

/// Wall time of a command beyond which it is not taken: a kill costs a run.
const LONGEST: Duration = Duration::from_secs(6);

/// Exit code of a command that was asked to end before it was done.
const INTERRUPTED: i32 = 2;

/// Kills of one run at most, before it is left to come to its end.
const MOST_KILLS: usize = 4;

/// Studies, beside the runs of the baseline.
const STUDIES: [&str; 3] = [
    "run stefan-water --method edpd --seeds 4",
    "run stefan-water --method pd --fields --frames",
    "stability stefan-unit --methods pd --values 1 --grid 3",
];

/// What a command leaves: hashes of its files by their names, records without what the clock decides.
type Left = BTreeMap<PathBuf, u64>;

#[derive(Debug, Parser)]
struct Asked {
    /// The build whose commands are killed.
    #[arg(long, default_value = env!("CARGO_BIN_EXE_frazil"))]
    program: String,
    /// Kills, each by SIGKILL or by SIGINT.
    #[arg(long, default_value_t = 100)]
    kills: usize,
    /// Commands that contain this word alone.
    #[arg(long, default_value = "")]
    only: String,
    /// Time after which no more are made.
    #[arg(long, default_value_t = f64::INFINITY)]
    minutes: f64,
    /// Checkpoints to damage.
    #[arg(long, default_value_t = 0)]
    checkpoints: usize,
    /// File systems to fill.
    #[arg(long, default_value_t = 0)]
    disks: usize,
    /// Runs to make in one process.
    #[arg(long, default_value_t = 0)]
    soak: usize,
    /// What moments, commands and bytes are drawn by.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Comes from cargo.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let asked = Asked::parse();
    let told = match (asked.disks, asked.checkpoints, asked.soak) {
        (0, 0, 0) => kill(&asked)?,
        (0, 0, _) => soak(&asked)?,
        (0, changes, _) => damage(changes, asked.seed)?,
        (..) => fill(&asked)?,
    };
    told.iter().take(20).for_each(|wrong| println!("{wrong}"));
    println!("{} wrong", told.len());
    Ok(if told.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Commands of the baseline and studies, of which some are asked for.
fn commands(only: &str) -> Vec<String> {
    let all = commands::all().into_iter().chain(STUDIES.map(str::to_owned));
    all.filter(|command| command.contains(only)).collect()
}

/// A command into a folder.
fn begin(program: &str, command: &str, out: &Path, more: &[&str]) -> Result<Child, Box<dyn Error>> {
    let mut process = Command::new(program);
    process.args(command.split_whitespace()).args(["--quiet", "--out"]).arg(out).args(more);
    Ok(process.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?)
}

/// Flags that make a command keep what it does often; studies always go on.
fn keeps(command: &str, random: &mut StdRng, resumes: bool) -> Vec<&'static str> {
    let threads = if random.random_range(0..2) == 0 { "1" } else { "2" };
    let mut flags = vec!["--threads", threads];
    // Cells of a map of stability are short.
    if !command.starts_with("stability") {
        flags.extend(["--checkpoint-s", "0.02"]);
    }
    if resumes && command.starts_with("run") && !command.contains("--seeds") {
        flags.push("--resume");
    }
    flags
}

/// Hashes of what a command has left.
fn left(out: &Path) -> Result<Left, Box<dyn Error>> {
    let mut files = Vec::new();
    gather(out, &mut files)?;
    let mut left = Left::new();
    for file in files {
        let name = file.strip_prefix(out)?.to_owned();
        let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let hash = match ending {
            "json" => record(&fs::read(&file)?).map_err(|error| format!("{}: {error}", file.display()))?,
            "csv" | "vtu" | "pvd" => xxh3_64(&fs::read(&file)?),
            // Pictures and pages tell times; that they are there is enough.
            _ => 0,
        };
        left.insert(name, hash);
    }
    Ok(left)
}

/// A record without what the clock decides.
fn record(bytes: &[u8]) -> Result<u64, Box<dyn Error>> {
    let mut record: serde_json::Value = serde_json::from_slice(bytes)?;
    without_times(&mut record);
    Ok(xxh3_64(record.to_string().as_bytes()))
}

fn without_times(value: &mut serde_json::Value) {
    const ENDINGS: [&str; 6] = ["wall_s", "cpu_s", "_bytes", "threads", "instruction_set", "taken_over"];
    match value {
        serde_json::Value::Object(fields) => {
            fields.retain(|name, _| !ENDINGS.iter().any(|ending| name.ends_with(ending)));
            fields.values_mut().for_each(without_times);
        }
        serde_json::Value::Array(parts) => parts.iter_mut().for_each(without_times),
        _ => {}
    }
}

/// Files that are there while a run goes on, and never after it.
fn is_left_over(name: &Path) -> bool {
    name.components().any(|part| {
        let part = part.as_os_str().to_string_lossy();
        part.starts_with('.') || part.contains("checkpoint")
    })
}

/// Kills runs at random moments until there were so many kills, and says what went wrong.
fn kill(Asked { program, kills, only, minutes, seed, .. }: &Asked) -> Result<Vec<String>, Box<dyn Error>> {
    let commands = commands(only);
    let slowest = Mutex::new((Duration::ZERO, String::new()));
    let (count, runs, number) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let (wrong, began) = (Mutex::new(Vec::new()), Instant::now());
    let work = || {
        while count.load(Ordering::Relaxed) < *kills && began.elapsed().as_secs_f64() < 60.0 * minutes {
            let mut random = StdRng::seed_from_u64(seed.wrapping_add(number.fetch_add(1, Ordering::Relaxed) as u64));
            let Some(command) = commands.choose(&mut random) else { return };
            match kill_one(program, command, &mut random) {
                Ok(Killed { kills, slowest: took }) => {
                    count.fetch_add(kills, Ordering::Relaxed);
                    runs.fetch_add(usize::from(kills > 0), Ordering::Relaxed);
                    let mut slowest = slowest.lock().unwrap_or_else(PoisonError::into_inner);
                    if took > slowest.0 {
                        *slowest = (took, command.clone());
                    }
                }
                Err(error) => {
                    eprintln!("{command}: {error}");
                    wrong.lock().unwrap_or_else(PoisonError::into_inner).push(format!("{command}: {error}"));
                }
            }
        }
    };
    std::thread::scope(|scope| {
        (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| {
            scope.spawn(work);
        });
    });
    let (took, slowest) = slowest.into_inner().unwrap_or_else(PoisonError::into_inner);
    let (count, runs, took) = (count.into_inner(), runs.into_inner(), took.as_secs_f64());
    println!("{count} kills of {runs} runs; after a SIGINT the slowest ended in {took:.2} s: {slowest}");
    Ok(wrong.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// How often a command was killed, and how long it took at most to end by itself after a SIGINT.
#[derive(Default)]
struct Killed {
    kills: usize,
    slowest: Duration,
}

impl Killed {
    /// Ends a process at once, or asks it to end.
    fn end(&mut self, mut process: Child, at_once: bool, code: Option<i32>) -> Result<(), Box<dyn Error>> {
        self.kills += 1;
        let began = Instant::now();
        if at_once {
            process.kill()?;
        } else {
            Command::new("kill").args(["-INT", &process.id().to_string()]).status()?;
        }
        let output = process.wait_with_output()?;
        if !at_once {
            self.slowest = self.slowest.max(began.elapsed());
            // Nothing listens yet in a process that has just begun, and a run may come to its end.
            let ended = output.status.code();
            if !(ended.is_none() || ended == Some(INTERRUPTED) || ended == code) {
                let told = String::from_utf8_lossy(&output.stderr).into_owned();
                return Err(format!("exit code {ended:?} after a SIGINT: {told}").into());
            }
        }
        Ok(())
    }
}

/// One command, left alone and killed.
fn kill_one(program: &str, command: &str, random: &mut StdRng) -> Result<Killed, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (alone, killed) = (folder.path().join("alone"), folder.path().join("killed"));
    let began = Instant::now();
    let code = begin(program, command, &alone, &keeps(command, random, false))?.wait()?.code();
    let took = began.elapsed();
    if took > LONGEST || !alone.is_dir() {
        return Ok(Killed::default());
    }
    let mut ends = Killed::default();
    loop {
        let mut process = begin(program, command, &killed, &keeps(command, random, ends.kills > 0))?;
        if ends.kills < MOST_KILLS {
            std::thread::sleep(took.mul_f64(random.random_range(0.0..1.1)));
            if process.try_wait()?.is_none() {
                ends.end(process, random.random_range(0..2) == 0, code)?;
                whole(&killed)?;
                continue;
            }
        }
        let output = process.wait_with_output()?;
        if output.status.code() != code {
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(format!("exit code {:?} after {} kills: {told}", output.status.code(), ends.kills).into());
        }
        break;
    }
    let kills = ends.kills;
    let (one, other) = (left(&alone)?, left(&killed)?);
    if let Some(over) = other.keys().find(|name| is_left_over(name)) {
        return Err(format!("{} was left behind after {kills} kills", over.display()).into());
    }
    if one != other {
        let differs = |name: &&PathBuf| one.get(*name) != other.get(*name);
        let names: Vec<_> = one.keys().chain(other.keys()).filter(differs).collect();
        return Err(format!("{names:?} differ after {kills} kills").into());
    }
    Ok(ends)
}

/// Whether all files of a killed run that have their names are whole.
fn whole(out: &Path) -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    if out.is_dir() {
        gather(out, &mut files)?;
    }
    for file in files.iter().filter(|file| !is_left_over(file.strip_prefix(out).unwrap_or(file))) {
        let torn = || format!("{} is torn", file.display());
        let bytes = if file.is_file() { fs::read(file)? } else { continue };
        let is_whole = match file.extension().and_then(|ending| ending.to_str()) {
            Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
            Some("csv" | "html") => bytes.ends_with(b"\n"),
            Some("svg") => bytes.trim_ascii_end().ends_with(b"</svg>"),
            Some("png") => bytes.ends_with(b"IEND\xaeB`\x82"),
            _ => true,
        };
        if !is_whole {
            return Err(torn().into());
        }
    }
    Ok(())
}

/// A run for checkpoints that are damaged: one of the shortest.
const SHORT: &str = "run stefan-unit --method pd";

/// Changes the bytes of checkpoints, and says what went wrong: a run must come to what it comes to without one.
fn damage(changes: usize, seed: u64) -> Result<Vec<String>, Box<dyn Error>> {
    let whole = make(&single(SHORT).ok_or(SHORT)?, &Options::default())?;
    let (next, wrong) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> Result<(), Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("run.checkpoint");
        let run = single(SHORT).ok_or(SHORT)?;
        let bytes = checkpoint(&run, folder.path())?;
        while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < changes) {
            let mut random = StdRng::seed_from_u64(seed.wrapping_add(number as u64));
            let other = damaged(&bytes, number, &mut random);
            fs::write(&path, &other)?;
            let kept = Checkpoints::new(folder.path(), Duration::MAX, (&String::new, Going::On), &|_: &str| {});
            let options = Options { checkpoints: Some(&kept), ..Options::default() };
            let hash = make(&run, &options);
            if hash.as_ref() != Ok(&whole) {
                let told = format!("change {number}: {hash:?} in place of {whole}");
                wrong.lock().unwrap_or_else(PoisonError::into_inner).push(told);
            }
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(|| work().map_err(|error| error.to_string()))).collect();
        let ended =
            |worker: ScopedJoinHandle<'_, Result<(), String>>| worker.join().map_err(|_| "a panic".to_owned())?;
        workers.into_iter().map(ended).collect::<Vec<_>>()
    })
    .into_iter()
    .collect::<Result<Vec<()>, String>>()?;
    println!("{changes} checkpoints with changed bytes");
    Ok(wrong.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// The hash of the states of a run.
fn make(run: &Single, options: &Options<'_>) -> Result<String, march::Refused> {
    Ok(march::run(&run.scene, &run.method, run.reference.as_ref(), options)?.record.state_hash)
}

/// A checkpoint from the middle of a run.
fn checkpoint(run: &Single, folder: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let (flag, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
    let see = |_: &Particles, _: f64| {
        if seen.fetch_add(1, Ordering::Relaxed) == 5 {
            flag.store(true, Ordering::Relaxed);
        }
    };
    let kept = Checkpoints::new(folder, Duration::MAX, (&String::new, Going::Anew), &|_: &str| {});
    let options =
        Options { interrupt: Some(&flag), each_output: Some(&see), checkpoints: Some(&kept), ..Options::default() };
    make(run, &options)?;
    Ok(fs::read(folder.join("run.checkpoint"))?)
}

/// Fills small file systems, and says what went wrong: a run that cannot write must say so, leave nothing torn, and come to its
/// end once there is room. Needs the right to mount.
fn fill(Asked { program, disks, only, seed, .. }: &Asked) -> Result<Vec<String>, Box<dyn Error>> {
    let commands = commands(only);
    let (mut wrong, mut full) = (Vec::new(), 0);
    let mut number = 0;
    while full < *disks {
        let mut random = StdRng::seed_from_u64(seed.wrapping_add(number));
        number += 1;
        let command = commands.choose(&mut random).ok_or("no commands")?;
        let kilobytes = (64.0 * 64f64.powf(random.random_range(0.0..1.0))).round() as u64;
        match fill_one(program, command, kilobytes, &mut random) {
            Ok(was_full) => full += usize::from(was_full),
            Err(error) => wrong.push(format!("{command} on {kilobytes} kB: {error}")),
        }
    }
    println!("{full} full disks");
    Ok(wrong)
}

/// A file system in memory, as long as it lives.
struct Disk(PathBuf);

impl Disk {
    fn new(path: &Path, kilobytes: u64) -> Result<Self, Box<dyn Error>> {
        fs::create_dir_all(path)?;
        mount(&["mount", "-t", "tmpfs", "-o", &format!("size={kilobytes}k"), "none"], path)?;
        Ok(Disk(path.to_owned()))
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = mount(&["umount"], &self.0);
    }
}

fn mount(command: &[&str], path: &Path) -> Result<(), Box<dyn Error>> {
    let output = Command::new(command[0]).args(&command[1..]).arg(path).output()?;
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned().into()) }
}

/// One command on a small file system; whether that was full.
fn fill_one(program: &str, command: &str, kilobytes: u64, random: &mut StdRng) -> Result<bool, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (alone, out) = (folder.path().join("alone"), folder.path().join("disk"));
    let began = Instant::now();
    let code = begin(program, command, &alone, &keeps(command, random, false))?.wait()?.code();
    if began.elapsed() > LONGEST || !alone.is_dir() {
        return Ok(false);
    }
    let disk = Disk::new(&out, kilobytes)?;
    let small = out.join("run");
    let output = begin(program, command, &small, &keeps(command, random, false))?.wait_with_output()?;
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    if output.status.code() == code && !told.contains("cannot be written") {
        return Ok(false);
    }
    whole(&small)?;
    if !told.contains("No space left") {
        return Err(format!("exit code {:?} and no word of the disk: {told}", output.status.code()).into());
    }
    // A checkpoint that cannot be written does not end the run.
    if output.status.code() != Some(2) && !told.contains("checkpoint") {
        return Err(format!("exit code {:?}: {told}", output.status.code()).into());
    }
    mount(&["mount", "-o", "remount,size=64m"], &out)?;
    // A run that lacks nothing but figures is at its end, and draws them when it is made anew.
    let resumes = !told.contains("figures: ");
    let output = begin(program, command, &small, &keeps(command, random, resumes))?.wait_with_output()?;
    if output.status.code() != code {
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(format!("with room: exit code {:?}: {told}", output.status.code()).into());
    }
    let (one, other) = (left(&alone)?, left(&small)?);
    drop(disk);
    let differs = |name: &&PathBuf| one.get(*name) != other.get(*name);
    match one.keys().chain(other.keys()).find(differs) {
        Some(name) => Err(format!("with room: {} differs", name.display()).into()),
        None => Ok(true),
    }
}

/// Runs at once in one process.
const AT_ONCE: usize = 8;

/// How often each of them is made.
const ROUNDS: usize = 5;

/// What more the process may hold in the last round than in any of the rounds before it but the first: threads take memory at
/// different times, and which runs are at work together differs.
const MORE: f64 = 1.1;

/// Makes runs in this process, each of them several times, and says what went wrong.
fn soak(&Asked { soak: runs, ref only, .. }: &Asked) -> Result<Vec<String>, Box<dyn Error>> {
    let commands: Vec<String> = commands(only).into_iter().filter(|command| single(command).is_some()).collect();
    let count = (runs / ROUNDS).max(1);
    // Of all kinds, however few.
    let commands: Vec<&String> = (0..count).map(|number| &commands[number * commands.len() / count]).collect();
    let mut hashes = vec![None; count];
    let (mut wrong, mut peaks) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let (next, peak) = (AtomicUsize::new(0), Mutex::new(0.0f64));
        let found = Mutex::new(vec![None; count]);
        std::thread::scope(|scope| {
            (0..AT_ONCE).for_each(|_| {
                scope.spawn(|| {
                    while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < count)
                    {
                        let run = single(commands[number]);
                        let hash = run.and_then(|run| make(&run, &Options::default()).ok());
                        found.lock().unwrap_or_else(PoisonError::into_inner)[number] = hash;
                        let mut peak = peak.lock().unwrap_or_else(PoisonError::into_inner);
                        *peak = peak.max(resident().unwrap_or(0.0));
                    }
                });
            });
        });
        let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        wrong.extend(
            found
                .iter()
                .enumerate()
                .filter(|(_, hash)| hash.is_none())
                .map(|(number, _)| format!("{}: refused", commands[number])),
        );
        for (number, (before, now)) in hashes.iter_mut().zip(found).enumerate() {
            if before.as_ref().is_some_and(|before| *before != now) {
                wrong.push(format!("{}: another state", commands[number]));
            }
            *before = Some(now);
        }
        peaks.push(peak.into_inner().unwrap_or_else(PoisonError::into_inner));
        eprintln!("round {}: at most {:.0} MB", peaks.len(), peaks[peaks.len() - 1]);
    }
    let told: Vec<String> = peaks.iter().map(|peak| format!("{peak:.0}")).collect();
    println!("{} runs in {ROUNDS} rounds, of which each held at most (MB): {}", ROUNDS * count, told.join(", "));
    let earlier = peaks[1..ROUNDS - 1].iter().copied().fold(0.0, f64::max);
    if peaks[ROUNDS - 1] > MORE * earlier {
        wrong.push("memory grows".into());
    }
    Ok(wrong)
}

/// Resident memory of the process (MB).
fn resident() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1024.0)
}
