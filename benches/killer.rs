//! Whether runs outlive what ends them: commands of `tests/baseline.csv` killed at random moments, gone on with until they are
//! done, and compared with the same command left alone.
//!
//! `cargo bench --bench killer` kills a hundred times; `-- --kills 1000 --seed 2 --minutes 20` as often as asked
//! and no longer, `--program FILE` another build;
//! `-- --checkpoints 100000` damages the bytes of checkpoints instead, `-- --disks 200` fills small file systems that it mounts,
//! and `-- --soak 500` makes so many runs in one process, eight at once, in five rounds, and watches its memory
//! (under `MALLOC_ARENA_MAX=1` where the C library is glibc, whose arenas keep what threads have freed).
//! Exit code 1 says that an end differs from that of the run left alone, or that something was left behind.

#![allow(clippy::print_stdout)]

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use frazil_core::particles::Particles;
use frazil_scene::Scene;
use frazil_simulation::march::{self, Checkpoints, Going, Options};
use frazil_simulation::reference::Reference;
use rand::rngs::StdRng;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use xxhash_rust::xxh3::xxh3_64;

/// Wall time of a command beyond which it is not taken: a kill costs a run.
const LONGEST: Duration = Duration::from_secs(6);

/// Kills of one run at most, before it is left to come to its end.
const MOST_KILLS: usize = 4;

/// Studies, beside the runs of the baseline.
const STUDIES: [&str; 2] =
    ["run stefan-water --method edpd --seeds 4", "stability stefan-unit --methods pd --values 1 --grid 3"];

/// What a command leaves: hashes of its files by their names, records without what the clock decides.
type Left = BTreeMap<PathBuf, u64>;

struct Asked {
    program: String,
    kills: usize,
    minutes: f64,
    checkpoints: usize,
    disks: usize,
    soak: usize,
    seed: u64,
}

fn asked() -> Result<Asked, Box<dyn Error>> {
    let program = env!("CARGO_BIN_EXE_frazil").to_owned();
    let mut asked = Asked { program, kills: 100, minutes: f64::INFINITY, checkpoints: 0, disks: 0, soak: 0, seed: 1 };
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    while let Some(flag) = arguments.next() {
        let value = arguments.next().ok_or("every flag has a value")?;
        match flag.as_str() {
            "--program" => asked.program = value,
            "--minutes" => asked.minutes = value.parse()?,
            "--kills" => asked.kills = value.parse()?,
            "--checkpoints" => asked.checkpoints = value.parse()?,
            "--disks" => asked.disks = value.parse()?,
            "--soak" => asked.soak = value.parse()?,
            "--seed" => asked.seed = value.parse()?,
            other => return Err(format!("there is no flag {other}").into()),
        }
    }
    Ok(asked)
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let asked = asked()?;
    let told = match (asked.disks, asked.checkpoints, asked.soak) {
        (0, 0, 0) => kill(&asked)?,
        (0, 0, runs) => soak(runs)?,
        (0, changes, _) => damage(changes, asked.seed)?,
        (..) => fill(&asked)?,
    };
    told.iter().take(20).for_each(|wrong| println!("{wrong}"));
    println!("{} wrong", told.len());
    Ok(if told.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Commands of the baseline and studies.
fn commands() -> Result<Vec<String>, Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/baseline.csv");
    let rows = csv::Reader::from_path(path)?.into_records().collect::<Result<Vec<_>, _>>()?;
    Ok(rows.iter().map(|row| row[0].to_owned()).chain(STUDIES.map(str::to_owned)).collect())
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

/// All files in a folder and its folders.
fn gather(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            if fs::read_dir(&path)?.next().is_none() {
                files.push(path.clone());
            }
            gather(&path, files)?;
        } else {
            files.push(path);
        }
    }
    Ok(())
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
    const ENDINGS: [&str; 5] = ["wall_s", "cpu_s", "_bytes", "threads", "taken_over"];
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
fn kill(Asked { program, kills, minutes, seed, .. }: &Asked) -> Result<Vec<String>, Box<dyn Error>> {
    let commands = commands()?;
    let (count, runs, number) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let (wrong, began) = (Mutex::new(Vec::new()), Instant::now());
    let work = || {
        while count.load(Ordering::Relaxed) < *kills && began.elapsed().as_secs_f64() < 60.0 * minutes {
            let mut random = StdRng::seed_from_u64(seed.wrapping_add(number.fetch_add(1, Ordering::Relaxed) as u64));
            let Some(command) = commands.choose(&mut random) else { return };
            match kill_one(program, command, &mut random) {
                Ok(killed) => {
                    count.fetch_add(killed, Ordering::Relaxed);
                    runs.fetch_add(usize::from(killed > 0), Ordering::Relaxed);
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
    println!("{} kills of {} runs", count.into_inner(), runs.into_inner());
    Ok(wrong.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// One command, left alone and killed; how often it was killed.
fn kill_one(program: &str, command: &str, random: &mut StdRng) -> Result<usize, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (alone, killed) = (folder.path().join("alone"), folder.path().join("killed"));
    let began = Instant::now();
    let code = begin(program, command, &alone, &keeps(command, random, false))?.wait()?.code();
    let took = began.elapsed();
    if took > LONGEST || !alone.is_dir() {
        return Ok(0);
    }
    let mut kills = 0;
    loop {
        let mut process = begin(program, command, &killed, &keeps(command, random, kills > 0))?;
        if kills < MOST_KILLS {
            std::thread::sleep(took.mul_f64(random.random_range(0.0..1.1)));
            if process.try_wait()?.is_none() {
                process.kill()?;
                process.wait()?;
                kills += 1;
                whole(&killed)?;
                continue;
            }
        }
        let output = process.wait_with_output()?;
        if output.status.code() != code {
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(format!("exit code {:?} after {kills} kills: {told}", output.status.code()).into());
        }
        break;
    }
    let (one, other) = (left(&alone)?, left(&killed)?);
    if let Some(over) = other.keys().find(|name| is_left_over(name)) {
        return Err(format!("{} was left behind after {kills} kills", over.display()).into());
    }
    if one != other {
        let differs = |name: &&PathBuf| one.get(*name) != other.get(*name);
        let names: Vec<_> = one.keys().chain(other.keys()).filter(differs).collect();
        return Err(format!("{names:?} differ after {kills} kills").into());
    }
    Ok(kills)
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
const SHORT: &str = "stefan-unit";

/// Changes the bytes of checkpoints, and says what went wrong: a run must come to what it comes to without one.
fn damage(changes: usize, seed: u64) -> Result<Vec<String>, Box<dyn Error>> {
    let scene = frazil::load::scene(SHORT, &[])?;
    let reference = truth(&scene);
    let whole = march::run(&scene, "pd", reference.as_ref(), &Options::default())?.record.state_hash;
    let (next, wrong) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> Result<(), Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("run.checkpoint");
        let (bytes, reference) = (checkpoint(&scene, folder.path())?, truth(&scene));
        while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < changes) {
            let mut random = StdRng::seed_from_u64(seed.wrapping_add(number as u64));
            let mut other = bytes.clone();
            let (one, two) = (random.random_range(0..bytes.len()), random.random_range(0..bytes.len()));
            match number % 5 {
                0 => other[one] ^= 1 << random.random_range(0..8),
                1 => other.truncate(one),
                2 => other.swap(one, two),
                3 => other.extend_from_slice(&bytes[one..]),
                _ => other[one.min(two)..one.max(two)].fill(random.random()),
            }
            fs::write(&path, &other)?;
            let kept = Checkpoints::new(folder.path(), Duration::MAX, (String::new(), Going::On), &|_: &str| {});
            let options = Options { checkpoints: Some(&kept), ..Options::default() };
            let found = march::run(&scene, "pd", reference.as_ref(), &options);
            let hash = found.map(|result| result.record.state_hash);
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

/// What a scene is measured against, and what walls that follow an exact solution ask.
fn truth(scene: &Scene) -> Option<Arc<dyn Reference>> {
    frazil_cases::truth(scene).ok().and_then(|truth| truth.reference.map(Arc::from))
}

/// A checkpoint of the scene from the middle of its run.
fn checkpoint(scene: &Scene, folder: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let (flag, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
    let see = |_: &Particles, _: f64| {
        if seen.fetch_add(1, Ordering::Relaxed) == 5 {
            flag.store(true, Ordering::Relaxed);
        }
    };
    let kept = Checkpoints::new(folder, Duration::MAX, (String::new(), Going::Anew), &|_: &str| {});
    let options =
        Options { interrupt: Some(&flag), each_output: Some(&see), checkpoints: Some(&kept), ..Options::default() };
    march::run(scene, "pd", truth(scene).as_ref(), &options)?;
    Ok(fs::read(folder.join("run.checkpoint"))?)
}

/// Fills small file systems, and says what went wrong: a run that cannot write must say so, leave nothing torn, and come to its
/// end once there is room. Needs the right to mount.
fn fill(Asked { program, disks, seed, .. }: &Asked) -> Result<Vec<String>, Box<dyn Error>> {
    let commands = commands()?;
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
fn soak(runs: usize) -> Result<Vec<String>, Box<dyn Error>> {
    let commands: Vec<String> = commands()?.into_iter().filter(|command| single(command).is_some()).collect();
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
                        let hash = single(commands[number]).and_then(|(scene, method)| {
                            let reference = truth(&scene);
                            Some(
                                march::run(&scene, &method, reference.as_ref(), &Options::default())
                                    .ok()?
                                    .record
                                    .state_hash,
                            )
                        });
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

/// Scene and method of a command that runs one scene once.
fn single(command: &str) -> Option<(Scene, String)> {
    let words: Vec<&str> = command.strip_prefix("run ")?.split_whitespace().collect();
    let (name, mut method, mut overrides) = (words.first()?, None, Vec::new());
    for pair in words[1..].chunks(2) {
        match pair {
            ["--method", value] => method = Some((*value).to_owned()),
            ["--set", value] => overrides.push(value.split_once('=').map(|(key, value)| (key.into(), value.into()))?),
            _ => return None,
        }
    }
    Some((frazil::load::scene(name, &overrides).ok()?, method?))
}

/// Resident memory of the process (MB).
fn resident() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1024.0)
}
