//! `frazil show`.

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use crate::templates;

#[derive(Debug, Args)]
pub struct ShowArguments {
    /// The name of a bundled scene, study or fluid.
    name: String,
}

impl ShowArguments {
    /// Prints its file.
    pub fn answer(self) -> Result<Verdict, Failure> {
        templates::show(&self.name)
    }
}
