//! `frazil gallery`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{Threads, command_line};
use crate::gallery::{GalleryRequest, gallery};

/// Runs that are there already are not made again, so a gallery that was stopped goes on when it is started again.
#[derive(Debug, Args)]
pub struct GalleryArguments {
    /// Bundled scenes; by default all of them.
    scenes: Vec<String>,
    #[command(flatten)]
    threads: Threads,
    /// Folder for the results; by default out/gallery.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints only errors and the result.
    #[arg(long)]
    quiet: bool,
}

impl GalleryArguments {
    /// Shows the bundled scenes.
    pub fn answer(self) -> Result<Verdict, Failure> {
        gallery(&GalleryRequest {
            scenes: self.scenes,
            out: self.out,
            threads: self.threads.count(),
            command_line: command_line(),
            quiet: self.quiet,
        })
    }
}
