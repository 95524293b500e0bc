//! `frazil layout`.

use std::path::PathBuf;

use clap::Args;
use frazil_layouts::{LayoutRequest, layout};
use frazil_plots::canvas::Formats;
use frazil_studies::campaign::Shard;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MustBe, StudyRuns, Threads, command_line, error, key_and_value, positive_seconds};
use crate::parts::parts;

#[derive(Debug, Args)]
pub struct LayoutArguments {
    /// A study file, or the name of a bundled study.
    study: String,
    /// The method; by default that of the study, or the first method of the scene.
    #[arg(long, value_name = "NAME")]
    method: Option<String>,
    /// Overrides a key of the scene of all layouts; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Chooses the spacing at which the day of closure and the final thickness of all layouts have this promised error, such as 1% or 0.01, from
    /// coarse runs, and prints the error that each reached.
    #[arg(long, value_name = "ERROR", value_parser = error, conflicts_with_all = ["shard", "check"])]
    error: Option<f64>,
    /// Wall time, in seconds, for the coarse runs of each layout that determine the spacing.
    #[arg(long, value_name = "S", default_value = "120", value_parser = positive_seconds, requires = "error")]
    budget_s: f64,
    #[command(flatten)]
    threads: Threads,
    /// Runs only the layouts K, K + N, K + 2 N, ...; the same command without it reuses all results in the folder
    /// and writes the tables.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Folder for the results; by default out/STUDY. Finished layouts in it are not run again.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints the layouts, the part of the plan that is simulated and why, and the expected time; runs nothing.
    #[arg(long, conflicts_with_all = ["shard", "out", "frames", "png", "pdf"])]
    check: bool,
    /// Draws a temperature map of each layout at every output, for an animation: layouts/*/frames/*.png.
    #[arg(long)]
    frames: bool,
    /// Also draws the figures of each layout as PNG, beside its SVG; those of the study always are.
    #[arg(long)]
    png: bool,
    /// Also writes the figures of each layout as PDF; those of the study always are.
    #[arg(long)]
    pdf: bool,
    #[command(flatten)]
    runs: StudyRuns,
    /// Starts even if the run takes longer than 30 days.
    #[arg(long)]
    yes: bool,
}

impl LayoutArguments {
    /// Compares the layouts.
    pub fn answer(self) -> Result<Verdict, Failure> {
        let checkpoints = self.runs.begin();
        let request = LayoutRequest {
            study: self.study,
            method: self.method,
            overrides: self.set,
            threads: self.threads.count(),
            error: self.error,
            budget_s: self.budget_s,
            shard: self.shard.unwrap_or(Shard::WHOLE),
            check: self.check,
            frames: self.frames,
            formats: Formats { png: self.png, pdf: self.pdf },
            out: self.out,
            checkpoints,
            quiet: self.runs.quiet,
            yes: self.yes,
            command_line: command_line(),
        };
        layout(&request, &parts(false))
    }
}

fn shard(text: &str) -> Result<Shard, MustBe> {
    let parts: Option<(usize, usize)> =
        text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((k, count)) if k >= 1 && k <= count => Ok(Shard { number: k - 1, count }),
        _ => Err(MustBe("K/N, as 3/16".into())),
    }
}
