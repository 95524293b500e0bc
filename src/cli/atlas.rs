//! `frazil atlas`.

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::ManyRunsArguments;
use crate::atlas::atlas;

/// Finished runs are kept, so the same command resumes after an interrupt.
#[derive(Debug, Args)]
pub struct AtlasArguments {
    /// Papers by their keys, as nikolaev-2021; by default all of them.
    papers: Vec<String>,
    #[command(flatten)]
    runs: ManyRunsArguments,
}

impl AtlasArguments {
    /// Makes the runs that are missing, and the page.
    pub fn answer(self) -> Result<Verdict, Failure> {
        atlas(&self.runs.of(self.papers))
    }
}
