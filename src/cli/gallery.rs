//! `frazil gallery`.

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::ManyRunsArguments;
use crate::gallery::gallery;

/// Finished runs are kept, so the same command resumes after an interrupt.
#[derive(Debug, Args)]
pub struct GalleryArguments {
    /// Bundled scenes; by default all of them.
    scenes: Vec<String>,
    #[command(flatten)]
    runs: ManyRunsArguments,
}

impl GalleryArguments {
    /// Makes the runs that are missing, and the page.
    pub fn answer(self) -> Result<Verdict, Failure> {
        gallery(&self.runs.of(self.scenes))
    }
}
