//! `frazil rerun`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MemoryLimit, command_line, threads};
use crate::rerun::{RerunRequest, rerun};

#[derive(Debug, Args)]
pub struct RerunArguments {
    /// The record.json of a run, or its folder.
    record: PathBuf,
    /// Threads; by default one for each core. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
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
            threads: threads(self.threads),
            command_line: command_line(),
            quiet: self.quiet,
        })
    }
}
