//! `frazil status`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use crate::status;

#[derive(Debug, Args)]
pub struct StatusArguments {
    /// A folder of results.
    folder: PathBuf,
}

impl StatusArguments {
    /// Prints the progress of the runs in the folder.
    pub fn answer(self) -> Result<Verdict, Failure> {
        status::status(&self.folder)
    }
}
