//! `frazil cheapest`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::cheapest::{CheapestRequest, cheapest};
use frazil_studies::ensemble::runs::Headline;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MemoryLimit, command_line, error, key_and_value, measure, positive_seconds};
use crate::parts::parts;

#[derive(Debug, Args)]
pub struct CheapestArguments {
    /// A scene file, or the name of a bundled scene.
    scene: String,
    /// The requested relative error, such as 1% or 0.01.
    #[arg(long, value_name = "ERROR", value_parser = error)]
    error: f64,
    /// Quantity of the error: front, closure, volume (frozen), temperature, saturation or concentration; by default the first that the scene has.
    #[arg(long, value_name = "NAME", value_parser = measure)]
    measure: Option<Headline>,
    /// The methods; by default all methods of the scene.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Overrides a key of the scene; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Threads of each run.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Wall time for all runs of one method, in seconds.
    #[arg(long, value_name = "S", default_value = "120", value_parser = positive_seconds)]
    budget_s: f64,
    /// Folder for the results; by default out/cheapest/SCENE. Finished runs in it are not repeated.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints only the answer and errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    memory: MemoryLimit,
}

impl CheapestArguments {
    /// Finds the cheapest run under each method.
    pub fn answer(self) -> Result<Verdict, Failure> {
        self.memory.set();
        let request = CheapestRequest {
            scene: self.scene,
            methods: self.methods,
            error: self.error,
            measure: self.measure,
            overrides: self.set,
            threads: self.threads.into(),
            budget_s: self.budget_s,
            out: self.out,
            quiet: self.quiet,
            command_line: command_line(),
        };
        cheapest(&request, &parts(false))
    }
}
