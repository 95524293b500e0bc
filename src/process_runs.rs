//! Commands of the program, each in a process and a folder of its own, so that none can break another; finished ones are kept.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::Ordering;

use frazil_studies::campaign::program;
use frazil_studies::failure::{Failure, complain};
use frazil_studies::output::{make_folder, write_json};
use serde::{Deserialize, Serialize};

use crate::{interrupt, provenance};

/// The mark of a finished run.
const DONE: &str = "done.json";

/// What a folder holds once its run is done.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Done {
    command: String,
    version: String,
    commit: Option<String>,
}

impl Done {
    fn of(command: &str) -> Self {
        let (version, commit) = (env!("CARGO_PKG_VERSION").into(), provenance::machine().commit);
        Done { command: command.into(), version, commit }
    }
}

/// What is asked of a command that makes many runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ManyRuns {
    /// Names of what is chosen; everything if empty.
    pub chosen: Vec<String>,
    /// Folder for the results; one of the command if absent.
    pub out: Option<PathBuf>,
    /// Threads of each run.
    pub threads: usize,
    /// The command as it was typed.
    pub command_line: String,
    /// Whether to say nothing but errors and the result.
    pub quiet: bool,
}

impl ManyRuns {
    /// Runs in a folder of the folder for the results.
    pub fn in_folder(&self, folder: &Path) -> ProcessRuns {
        ProcessRuns { folder: folder.join("runs"), threads: self.threads, quiet: self.quiet }
    }
}

/// Runs in the folders of one folder.
#[derive(Debug)]
pub struct ProcessRuns {
    /// The folder.
    pub folder: PathBuf,
    /// Threads of each run.
    pub threads: usize,
    /// Whether to say nothing but errors.
    pub quiet: bool,
}

impl ProcessRuns {
    /// The folder of a run.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Whether a run of this name and command is there.
    pub fn has(&self, name: &str, command: &str) -> bool {
        is_done(command, &self.path(name))
    }

    /// Makes the runs, names and commands, that are not there yet from this program, and says whether all had their turn: not where an
    /// interrupt stopped them. A run that fails is told, and the others go on.
    ///
    /// # Errors
    /// Where a folder cannot be made, or no process started.
    pub fn make(&self, runs: &[(&str, &str)]) -> Result<bool, Failure> {
        for (number, (name, command)) in runs.iter().enumerate() {
            let path = self.path(name);
            if is_done(command, &path) {
                continue;
            }
            if !self.quiet {
                complain(&format!("{} of {}: frazil {command}", number + 1, runs.len()));
            }
            if !self.run(command, &path)? {
                complain("interrupted: the same command resumes from here");
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn run(&self, command: &str, path: &Path) -> Result<bool, Failure> {
        make_folder(path)?;
        let started = |error| Failure::file(path, "cannot be run into", error);
        let program = program().map_err(started)?;
        let own = ["--quiet", "--threads", &self.threads.to_string(), "--out"].map(String::from);
        // An interrupt is for both: the run ends itself, and says so by its code.
        let flag = interrupt::watch();
        let output = Command::new(program).args(command.split_whitespace()).args(own).arg(path).output();
        let output = output.map_err(started)?;
        if flag.load(Ordering::Relaxed) {
            return Ok(false);
        }
        if output.status.code().is_none_or(|code| code > 1) {
            complain(&format!("frazil {command}: {}", String::from_utf8_lossy(&output.stderr).trim_end()));
            return Ok(true);
        }
        write_json(&path.join(DONE), &Done::of(command))?;
        Ok(true)
    }
}

/// Whether a folder holds a run of this command by this program.
fn is_done(command: &str, path: &Path) -> bool {
    let text = fs::read_to_string(path.join(DONE)).ok();
    text.and_then(|text| serde_json::from_str::<Done>(&text).ok()).is_some_and(|done| done == Done::of(command))
}
