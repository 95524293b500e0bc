//! `frazil completions`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_complete::Shell;
use frazil_studies::failure::{Failure, Verdict};
use frazil_studies::output::make_folder;

use super::Cli;

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell whose completions are printed.
    #[arg(required_unless_present = "manual")]
    shell: Option<Shell>,
    /// A folder for manual pages of the program and of each command, instead of completions.
    #[arg(long, value_name = "FOLDER", conflicts_with = "shell")]
    manual: Option<PathBuf>,
}

impl CompletionsArguments {
    /// Prints completions, or writes manual pages.
    pub fn answer(self) -> Result<Verdict, Failure> {
        if let Some(folder) = &self.manual {
            make_folder(folder)?;
            let written = clap_mangen::generate_to(Cli::command(), folder);
            written.map_err(|error| Failure::file(folder, "cannot be written", error))?;
        }
        if let Some(shell) = self.shell {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "frazil", &mut text);
            let mut out = io::stdout().lock();
            out.write_all(&text).and_then(|()| out.flush()).map_err(Failure::Output)?;
        }
        Ok(Verdict::Done)
    }
}
