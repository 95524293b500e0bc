//! How a command ends.

use std::error::Error;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use frazil_plots::PlotError;
use frazil_record::{Outcome, shown, shown_lines};
use frazil_scene::Problems;
use frazil_simulation::march::Refused;
use serde::Serialize;

/// The end of a command that did what it was asked, the better ones first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// All is well.
    Done,
    /// The results are there, but a check on them failed.
    CheckFailed,
    /// Results are there, but not to their end.
    Broken,
}

impl Verdict {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Done => "done",
            Verdict::CheckFailed => "check_failed",
            Verdict::Broken => "broken",
        }
    }

    /// A run that went to its end but against its own checks has failed a check; one that did not get there is broken.
    pub fn of(outcome: Outcome) -> Verdict {
        match outcome {
            Outcome::Ok => Verdict::Done,
            Outcome::Oscillating | Outcome::EnergyDrift | Outcome::PhaseSkipped => Verdict::CheckFailed,
            Outcome::Diverged | Outcome::TimedOut | Outcome::Interrupted => Verdict::Broken,
        }
    }

    /// That of the worst of several runs.
    pub fn worst(outcomes: impl Iterator<Item = Outcome>) -> Verdict {
        outcomes.map(Verdict::of).max().unwrap_or(Verdict::Done)
    }
}

/// Why a command could not do what it was asked.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A scene or a study is bad.
    #[error(transparent)]
    Scene(#[from] Problems),
    /// The run was refused.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// A name or an option means nothing here.
    #[error(transparent)]
    Request(Box<dyn Error + Send + Sync>),
    /// Something failed of one thing among several.
    #[error("{of}: {cause}")]
    Of {
        /// Of what, in words.
        of: String,
        /// Why it failed.
        cause: Box<dyn Error + Send + Sync>,
    },
    /// A file could not be read or written.
    #[error("{}: {action}: {source}", shown(&path.display().to_string()))]
    File {
        /// The file.
        path: PathBuf,
        /// What was tried, as "cannot be read".
        action: &'static str,
        /// Why it failed.
        source: io::Error,
    },
    /// Standard output could not be written.
    #[error("standard output: {0}")]
    Output(io::Error),
}

impl Failure {
    /// What a command was asked for and cannot do.
    pub fn request(error: impl Error + Send + Sync + 'static) -> Self {
        Failure::Request(Box::new(error))
    }

    /// What failed of one thing among several.
    pub fn of(of: impl Display, cause: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Failure::Of { of: of.to_string(), cause: cause.into() }
    }

    /// A failure on a file.
    pub fn file(path: &Path, action: &'static str, source: io::Error) -> Self {
        Failure::File { path: path.to_owned(), action, source }
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        match error {
            PlotError::Write { path, source } => Failure::file(&path, "cannot be written", source),
            other => Failure::request(other),
        }
    }
}

/// Reports a failure on standard error, and says with what code the program ends.
pub fn exit_code(result: Result<Verdict, Failure>) -> u8 {
    match result {
        Ok(Verdict::Done) => 0,
        Ok(Verdict::CheckFailed) => 1,
        Ok(Verdict::Broken) => 2,
        // Whoever reads has seen enough.
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => 0,
        Err(failure) => {
            complain(&failure.to_string());
            2
        }
    }
}

/// Says something on standard error, where what is hidden in texts of a user is seen; a closed one is no reason to stop.
pub fn complain(text: &str) {
    use io::Write;
    let _ = writeln!(io::stderr(), "{}", shown_lines(text));
}

/// Writes the answer to standard output as JSON, for programs: one document with a last line break.
///
/// # Errors
/// Where it cannot be written.
pub fn answer_json(value: &impl Serialize) -> Result<(), Failure> {
    use io::Write;
    let mut out = io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, value).map_err(|error| Failure::Output(error.into()))?;
    out.write_all(b"\n").and_then(|()| out.flush()).map_err(Failure::Output)
}

/// Writes the answer to standard output, where what is hidden in texts of a user is seen.
///
/// # Errors
/// Where it cannot be written.
pub fn answer(text: &str) -> Result<(), Failure> {
    use io::Write;
    let mut out = io::stdout().lock();
    out.write_all(shown_lines(text).as_bytes()).and_then(|()| out.flush()).map_err(Failure::Output)
}
