//! `frazil sweep`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};
use frazil_studies::sweep::{NoKey, SweepRequest, VariedKey, sweep};

use super::values::{StudyRuns, Threads, command_line, key_and_value};
use crate::parts::parts;

/// Finished runs in the folder are not repeated, so a sweep that was stopped, or has more values, makes only the missing ones.
#[derive(Debug, Args)]
pub struct SweepArguments {
    /// A scene file, or the name of a bundled scene.
    scene: String,
    /// A key with its values, as in `initial.temperature_c=1,2,3` or `initial.temperature_c=1..3:5` (five values from 1 to 3);
    /// may be repeated for all combinations. The first key is the horizontal axis of the figures.
    #[arg(long, value_name = "KEY=VALUES", value_parser = varied, required = true)]
    vary: Vec<VariedKey>,
    /// The methods; by default the first method of the scene.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Overrides a key of the scene in all runs; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    threads: Threads,
    /// Seed of noise and of irregular layouts.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the results; by default out/sweep/SCENE.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    runs: StudyRuns,
}

impl SweepArguments {
    /// Runs the scene at all combinations of the values.
    pub fn answer(self) -> Result<Verdict, Failure> {
        let checkpoints = self.runs.begin();
        let request = SweepRequest {
            scene: self.scene,
            keys: self.vary,
            methods: self.methods,
            overrides: self.set,
            threads: self.threads.count(),
            seed: self.seed,
            out: self.out,
            checkpoints,
            quiet: self.runs.quiet,
            command_line: command_line(),
        };
        sweep(&request, &parts(false))
    }
}

fn varied(text: &str) -> Result<VariedKey, NoKey> {
    VariedKey::read(text)
}
