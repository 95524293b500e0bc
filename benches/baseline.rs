//! Whether runs still give what they gave, to the last bit: the commands of `tests/baseline.csv`, each with a hash of its states
//! and one of its tables.
//!
//! `cargo bench --bench baseline` names the commands that give something else now; `-- WORD ...` runs those alone that hold one of
//! the words, `-- --program FILE` asks another build. `-- --write` writes what they give now: say why in the same commit. Bits depend
//! on the mathematical library of the machine and on its instructions, so a table is compared with one that was written on the same
//! kind of machine. The greatest errors of balances and of the maximum principle are printed beside them.

#![allow(clippy::print_stdout)]

mod gathered;

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use xxhash_rust::xxh3::Xxh3;

/// A command and what it gave.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Row {
    command: String,
    states: String,
    tables: String,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let all = arguments.len();
    arguments.retain(|argument| argument != "--write");
    let write = arguments.len() < all;
    let mut program = env!("CARGO_BIN_EXE_frazil").to_owned();
    if let Some(at) = arguments.iter().position(|argument| argument == "--program") {
        let end = (at + 2).min(arguments.len());
        program = arguments.drain(at..end).nth(1).ok_or("--program needs a file")?;
    }
    let words = arguments;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/baseline.csv");
    let mut rows = csv::Reader::from_path(&path)?.deserialize().collect::<Result<Vec<Row>, _>>()?;
    let asked = |row: &Row| words.is_empty() || words.iter().any(|word| row.command.contains(word.as_str()));
    let numbers: Vec<usize> = (0..rows.len()).filter(|number| asked(&rows[*number])).collect();
    let given = run_all(&program, &numbers.iter().map(|number| rows[*number].command.as_str()).collect::<Vec<_>>())?;
    let mut others = 0;
    for (name, what) in BALANCES {
        println!("{what}, the ten greatest:");
        let of = |(number, given): (&usize, &Given)| Some((*given.balances.get(name)?, *number));
        let mut all: Vec<(f64, usize)> = numbers.iter().zip(&given).filter_map(of).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (error, number) in all.iter().take(10) {
            println!("  {error:.1e}  {}", rows[*number].command);
        }
    }
    for (number, Given { states, tables, .. }) in numbers.iter().zip(given) {
        let row = &mut rows[*number];
        let what = match (states == row.states, tables == row.tables) {
            (true, true) => continue,
            (true, false) => "other tables",
            (false, true) => "other states",
            (false, false) => "other states and tables",
        };
        println!("{what}: {}", row.command);
        others += 1;
        (row.states, row.tables) = (states, tables);
    }
    println!("{} commands, of which {others} give something else", numbers.len());
    if write {
        let mut writer = csv::Writer::from_path(&path)?;
        rows.iter().try_for_each(|row| writer.serialize(row))?;
        writer.flush()?;
        return Ok(ExitCode::SUCCESS);
    }
    Ok(if others == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// What a command has given.
#[derive(Clone, Default)]
struct Given {
    states: String,
    tables: String,
    /// Greatest errors of balances, by their names in records.
    balances: BTreeMap<&'static str, f64>,
}

/// What is conserved or bounded, by its name in a record.
const BALANCES: [(&str, &str); 3] = [
    ("energy_balance_rel", "heat or water not accounted for, over what was exchanged"),
    ("solute_balance_rel", "solute not accounted for"),
    ("bounds_violation_rel", "temperatures or heads out of the range of the data, over that range, without noise"),
];

/// What commands give, as many at once as the machine has processors.
fn run_all(program: &str, commands: &[&str]) -> Result<Vec<Given>, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (next, found) = (AtomicUsize::new(0), Mutex::new(vec![Given::default(); commands.len()]));
    let work = || {
        while let Some((number, command)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, *commands.get(k)?)))
        {
            let out = folder.path().join(number.to_string());
            // What cannot be run is a result too.
            let given = run(program, command, &out)
                .unwrap_or_else(|error| Given { states: error.to_string(), ..Given::default() });
            found.lock().unwrap_or_else(PoisonError::into_inner)[number] = given;
            fs::remove_dir_all(&out).ok();
        }
    };
    std::thread::scope(|scope| {
        (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| {
            scope.spawn(work);
        });
    });
    Ok(found.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Hashes of the states and of the tables that a command gives in a folder, and its greatest errors of balances.
fn run(program: &str, command: &str, out: &Path) -> Result<Given, Box<dyn Error>> {
    let mut process = Command::new(program);
    process.args(command.split_whitespace()).args(["--threads", "1", "--quiet", "--out"]).arg(out);
    let output = process.output()?;
    if !out.is_dir() {
        let told = String::from_utf8_lossy(&output.stderr);
        return Err(told.lines().next().unwrap_or_default().into());
    }
    let mut files = Vec::new();
    gathered::gather(out, &mut files)?;
    files.retain(|path| path.is_file());
    files.sort();
    let (mut states, mut tables) = (Xxh3::new(), Xxh3::new());
    let mut balances = BTreeMap::new();
    for file in &files {
        if file.ends_with("record.json") {
            let mut record: serde_json::Value = serde_json::from_slice(&fs::read(file)?)?;
            states.update(record["state_hash"].to_string().as_bytes());
            // An error is a result too.
            tables.update(record["errors"].to_string().as_bytes());
            // Noise leaves any range.
            if record["method"] == "edpd" {
                record["bounds_violation_rel"].take();
            }
            for (name, error) in BALANCES.iter().filter_map(|(name, _)| Some((*name, record[name].as_f64()?))) {
                let greatest: &mut f64 = balances.entry(name).or_default();
                *greatest = greatest.max(error.abs());
            }
        } else if file.extension().is_some_and(|extension| extension == "csv") {
            tables.update(file.strip_prefix(out)?.to_string_lossy().as_bytes());
            tables.update(&fs::read(file)?);
        }
    }
    let [states, tables] = [states, tables].map(|hash| format!("{:016x}", hash.digest()));
    Ok(Given { states, tables, balances })
}
