//! `frazil run`.

use std::path::PathBuf;

use clap::Args;
use frazil_plots::canvas::Formats;
use frazil_studies::cheapest::CheapestRequest;
use frazil_studies::ensemble::runs::Headline;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{
    BetweenCheckpoints, MemoryLimit, Threads, between_checkpoints, command_line, error, key_and_value, measure,
    positive_seconds,
};
use crate::run::RunRequest;
use crate::seeds::ensemble;
use crate::{load, run};

#[derive(Debug, Args)]
pub struct RunArguments {
    /// A scene file, or the name of a bundled scene.
    scene: String,
    /// The method; by default the first method of the scene.
    #[arg(long, value_name = "NAME")]
    method: Option<String>,
    /// Overrides a key of the file, as in `method.pd.horizon_ratio=4`; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Uses the discretisation printed in the scene's paper, where one is bundled; `--set` takes precedence.
    #[arg(long)]
    paper: bool,
    /// Chooses the spacing with this promised error, such as 1% or 0.01, from coarse runs, prints it, and refuses an error that it
    /// cannot promise.
    #[arg(long, value_name = "ERROR", value_parser = error, conflicts_with_all = ["paper", "seeds", "reduce"])]
    error: Option<f64>,
    /// Quantity of the error: front, closure, volume (frozen), temperature, saturation or concentration; by default the first that the
    /// scene has.
    #[arg(long, value_name = "NAME", value_parser = measure, requires = "error")]
    measure: Option<Headline>,
    /// Wall time, in seconds, for the coarse runs that determine the spacing.
    #[arg(long, value_name = "S", default_value = "120", value_parser = positive_seconds, requires = "error")]
    budget_s: f64,
    #[command(flatten)]
    threads: Threads,
    /// Seed of noise and of irregular layouts; with --seeds that of the first member.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Runs an ensemble of N members with consecutive seeds, concurrently and each on one thread: means with
    /// confidence intervals. Finished members in the folder are not run again.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000), conflicts_with_all = ["reduce", "fields", "frames"])]
    seeds: Option<u16>,
    /// Folder for the results; by default out/SCENE/METHOD.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Runs the reduced scene with the same solution, if there is one.
    #[arg(long, conflicts_with_all = ["fields", "frames"])]
    reduce: bool,
    /// Writes the state of all particles at every output, for ParaView: fields.pvd and fields/*.vtu.
    #[arg(long)]
    fields: bool,
    /// Draws a temperature map at every output, frames/*.png, and a moving PNG of all, movie.png. Needs a plane.
    #[arg(long)]
    frames: bool,
    /// Also draws each figure as PNG, beside its SVG.
    #[arg(long)]
    png: bool,
    /// Also writes each figure as PDF, with text as text, for papers.
    #[arg(long)]
    pdf: bool,
    /// Wall time in seconds between two checkpoints, from which a killed run can be resumed; 0 for none.
    #[arg(long, value_name = "S", default_value = "60", value_parser = between_checkpoints)]
    checkpoint_s: BetweenCheckpoints,
    /// Resumes from the last checkpoint in the folder, with the same bits as an uninterrupted run; from the start if there is
    /// none.
    #[arg(long)]
    resume: bool,
    /// Prints JSON instead of text: the outcome, the folder, results, errors and the record; of an ensemble, its record.
    #[arg(long)]
    json: bool,
    /// Prints only errors.
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    #[command(flatten)]
    memory: MemoryLimit,
    /// Starts even if the run takes longer than 30 days.
    #[arg(long)]
    yes: bool,
}

impl RunArguments {
    /// Runs the scene, or an ensemble of it.
    pub fn answer(mut self) -> Result<Verdict, Failure> {
        self.memory.set();
        if self.paper {
            let (method, overrides) = load::paper(&self.scene, self.method.as_slice(), self.set)?;
            (self.method, self.set) = (Some(method), overrides);
        }
        let mut estimated = None;
        if let Some(error) = self.error {
            let request = CheapestRequest {
                methods: self.method.iter().cloned().collect(),
                scene: self.scene.clone(),
                error,
                measure: self.measure,
                overrides: self.set.clone(),
                threads: 1,
                budget_s: self.budget_s,
                out: None,
                quiet: self.quiet,
                command_line: command_line(),
            };
            let settled = run::for_error(&request)?;
            self.set.push(settled.spacing);
            estimated = Some(settled.estimated);
        }
        let request = RunRequest {
            scene: self.scene,
            method: self.method,
            overrides: self.set,
            threads: self.threads.count(),
            seed: self.seed,
            out: self.out,
            reduce: self.reduce,
            estimated,
            fields: self.fields,
            frames: self.frames,
            formats: Formats { png: self.png, pdf: self.pdf },
            checkpoints: self.checkpoint_s.0,
            resume: self.resume,
            quiet: self.quiet,
            json: self.json,
            yes: self.yes,
            command_line: command_line(),
        };
        match self.seeds {
            Some(seeds) => ensemble(&request, seeds.into()),
            None => run::run(&request),
        }
    }
}
