//! `frazil list`.

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use crate::list::list;

#[derive(Debug, Args)]
pub struct ListArguments {
    /// Prints JSON: an array of objects with kind, name, title and source.
    #[arg(long)]
    json: bool,
}

impl ListArguments {
    /// Lists what there is.
    pub fn answer(self) -> Result<Verdict, Failure> {
        list(self.json)
    }
}
