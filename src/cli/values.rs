//! Values of options, as several commands take them.

use std::borrow::Cow;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use clap::Args;
use frazil_core::memory;
use frazil_record::shown;
use frazil_studies::ensemble::runs::Headline;
use frazil_studies::parallel;

use crate::process_runs::ManyRuns;

/// The arguments of the program. Those of the process are others where another program runs it.
static TYPED: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// Keeps the arguments of the program, the first of which is its own name.
pub fn keep_typed(arguments: &[OsString]) {
    *TYPED.lock().unwrap_or_else(PoisonError::into_inner) = arguments.to_vec();
}

/// The command as it was typed, for a page of results, on which what is hidden is seen.
pub fn command_line() -> String {
    let typed = TYPED.lock().unwrap_or_else(PoisonError::into_inner);
    let words = typed.iter().map(|argument| shown(&argument.to_string_lossy()).into_owned());
    words.collect::<Vec<_>>().join(" ")
}

/// The threads of a command that takes all cores unless asked for less.
#[derive(Debug, Args)]
pub struct Threads {
    /// Threads, or concurrent runs of a study; by default one for each core. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Threads {
    /// How many.
    pub fn count(&self) -> usize {
        self.threads.map_or_else(parallel::cores, usize::from)
    }
}

/// What commands have alike that make many runs of the program.
#[derive(Debug, Args)]
pub struct ManyRunsArguments {
    #[command(flatten)]
    threads: Threads,
    /// Folder for the results; by default the folder of the name of the command in out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints only errors and the result.
    #[arg(long)]
    quiet: bool,
}

impl ManyRunsArguments {
    /// The request, of what is chosen.
    pub fn of(self, chosen: Vec<String>) -> ManyRuns {
        let (threads, command_line) = (self.threads.count(), command_line());
        ManyRuns { chosen, out: self.out, threads, command_line, quiet: self.quiet }
    }
}

/// What a value of an option must be.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("must be {0}")]
pub struct MustBe(pub Cow<'static, str>);

/// A number that passes a test.
pub fn number(text: &str, test: impl Fn(f64) -> bool, must_be: &'static str) -> Result<f64, MustBe> {
    text.parse().ok().filter(|number| test(*number)).ok_or(MustBe(must_be.into()))
}

/// A key path and a value.
pub fn key_and_value(text: &str) -> Result<(String, String), MustBe> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err(MustBe("KEY=VALUE, as time.outputs=20".into())),
    }
}

/// Time between two checkpoints; none where there are to be none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BetweenCheckpoints(pub Option<Duration>);

/// The same, from seconds.
pub fn between_checkpoints(text: &str) -> Result<BetweenCheckpoints, MustBe> {
    let seconds = number(text, |number| number >= 0.0, "a number of seconds, 0 or more")?;
    let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    Ok(BetweenCheckpoints((seconds > 0.0).then_some(time)))
}

/// An error as a share or in percent.
pub fn error(text: &str) -> Result<f64, MustBe> {
    let (digits, scale) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 0.01));
    let shares = |error: f64| error > 0.0 && scale * error < 1.0;
    Ok(scale * number(digits.trim_end(), shares, "an error above 0 and below 100 %, as 1% or 0.01")?)
}

/// What an error is of.
pub fn measure(text: &str) -> Result<Headline, MustBe> {
    Headline::named(text).ok_or_else(|| MustBe(format!("one of {}", Headline::names()).into()))
}

/// Seconds.
pub fn positive_seconds(text: &str) -> Result<f64, MustBe> {
    number(text, is_positive, "a number of seconds greater than 0")
}

/// How the runs of a study are made.
#[derive(Debug, Args)]
pub struct StudyRuns {
    /// Wall time in seconds between two checkpoints of each run, from which a stopped study is resumed; 0 for none.
    #[arg(long, value_name = "S", default_value = "60", value_parser = between_checkpoints)]
    checkpoint_s: BetweenCheckpoints,
    /// Prints only errors.
    #[arg(long)]
    pub quiet: bool,
    #[command(flatten)]
    memory: MemoryLimit,
}

impl StudyRuns {
    /// Holds the runs to their memory; says how far apart their checkpoints are.
    pub fn begin(&self) -> Option<Duration> {
        self.memory.set();
        self.checkpoint_s.0
    }
}

/// What runs may hold, of every command that makes or plans some.
#[derive(Debug, Args)]
pub struct MemoryLimit {
    /// Memory limit of all concurrent runs together, such as 500MB or 4GB; by default four fifths of the free memory.
    #[arg(long, value_name = "SIZE", value_parser = size)]
    memory: Option<u64>,
}

impl MemoryLimit {
    /// Holds the runs of this process to it.
    pub fn set(&self) {
        if let Some(bytes) = self.memory {
            memory::ask(bytes);
        }
    }
}

/// Bytes.
fn size(text: &str) -> Result<u64, MustBe> {
    const UNITS: [(&str, f64); 4] = [("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("TB", 1e12)];
    let found =
        UNITS.iter().find_map(|(unit, bytes)| Some(bytes * text.strip_suffix(unit)?.trim().parse::<f64>().ok()?));
    match found {
        Some(bytes) if (1.0..=1e18).contains(&bytes) => Ok(bytes as u64),
        _ => Err(MustBe("a number with kB, MB, GB or TB, as 500MB or 4GB".into())),
    }
}

/// A number greater than 0.
pub fn positive(text: &str) -> Result<f64, MustBe> {
    number(text, is_positive, "a number greater than 0")
}

fn is_positive(number: f64) -> bool {
    number.is_finite() && number > 0.0
}

/// A constant of a fluid: products of several of them must stay numbers.
pub fn sized(text: &str) -> Result<f64, MustBe> {
    number(text, |number| (1e-12..=1e12).contains(&number), "a number between 1e-12 and 1e12")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_has_a_decimal_unit() {
        for (text, bytes) in [("500MB", 500_000_000), ("4GB", 4_000_000_000), ("0.5 GB", 500_000_000), ("1kB", 1000)] {
            assert_eq!(size(text), Ok(bytes));
        }
        for text in ["", "4", "GB", "-1GB", "0MB", "infGB", "NaNMB", "1e300TB", "4gb", "4GiB"] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_value_may_contain_an_equals_sign() {
        assert_eq!(key_and_value("title = a=b"), Ok(("title".into(), "a=b".into())));
        assert!(key_and_value("title").is_err());
        assert!(key_and_value("=3").is_err());
    }
}
