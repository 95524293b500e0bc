//! `frazil check`.

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MemoryLimit, Threads, key_and_value};
use crate::check::{CheckRequest, check};
use crate::load;

#[derive(Debug, Args)]
pub struct CheckArguments {
    /// A scene file, or the name of a bundled scene.
    scene: String,
    /// A method; may be repeated. By default all methods of the scene.
    #[arg(long, value_name = "NAME")]
    method: Vec<String>,
    /// Overrides a key of the file; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Uses the discretisation printed in the scene's paper, where one is bundled; `--set` takes precedence.
    #[arg(long)]
    paper: bool,
    #[command(flatten)]
    threads: Threads,
    /// Plans the reduced scene with the same solution, if there is one.
    #[arg(long)]
    reduce: bool,
    /// Prints JSON: the scene, warnings, and for each method the numbers of its plan.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    memory: MemoryLimit,
}

impl CheckArguments {
    /// Checks the scene.
    pub fn answer(mut self) -> Result<Verdict, Failure> {
        self.memory.set();
        if self.paper {
            let (method, overrides) = load::paper(&self.scene, &self.method, self.set)?;
            (self.method, self.set) = (vec![method], overrides);
        }
        check(&CheckRequest {
            scene: self.scene,
            methods: self.method,
            overrides: self.set,
            threads: self.threads.count(),
            reduce: self.reduce,
            json: self.json,
        })
    }
}
