//! `frazil new`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use crate::templates;

#[derive(Debug, Args)]
pub struct NewArguments {
    /// The file; by default scene.toml, or the bundled name. Existing files are not overwritten.
    file: Option<PathBuf>,
    /// A bundled scene, study or fluid to copy, instead of a small commented scene.
    #[arg(long, value_name = "NAME")]
    like: Option<String>,
}

impl NewArguments {
    /// Writes the file.
    pub fn answer(self) -> Result<Verdict, Failure> {
        templates::new(self.file.as_deref(), self.like.as_deref())
    }
}
