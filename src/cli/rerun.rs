//! `frazil rerun`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MemoryLimit, Threads, command_line};
use crate::rerun::{RerunRequest, rerun};

#[derive(Debug, Args)]
pub struct RerunArguments {
    /// The record.json of a run, or its folder.
    record: PathBuf,
    #[command(flatten)]
    threads: Threads,
    /// Folder for the results; by default out/rerun/SCENE.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints only errors and differences.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    memory: MemoryLimit,
}

impl RerunArguments {
    /// Runs it again.
    pub fn answer(self) -> Result<Verdict, Failure> {
        self.memory.set();
        rerun(&RerunRequest {
            record: self.record,
            out: self.out,
            threads: self.threads.count(),
            command_line: command_line(),
            quiet: self.quiet,
        })
    }
}
