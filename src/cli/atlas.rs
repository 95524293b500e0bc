//! `frazil atlas`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{Threads, command_line};
use crate::atlas::{AtlasRequest, atlas};

/// Runs that are there already are not made again, so an atlas that was stopped goes on when it is started again.
#[derive(Debug, Args)]
pub struct AtlasArguments {
    /// Papers by their keys, as nikolaev-2021; by default all of them.
    papers: Vec<String>,
    #[command(flatten)]
    threads: Threads,
    /// Folder for the results; by default out/atlas.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Says nothing but errors and the counts.
    #[arg(long)]
    quiet: bool,
}

impl AtlasArguments {
    /// Makes it.
    pub fn answer(self) -> Result<Verdict, Failure> {
        atlas(&AtlasRequest {
            papers: self.papers,
            out: self.out,
            threads: self.threads.count(),
            command_line: command_line(),
            quiet: self.quiet,
        })
    }
}
