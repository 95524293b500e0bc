//! `frazil compare`.

use std::path::PathBuf;

use clap::Args;
use frazil_scene::Setting;
use frazil_studies::compare::variant::Variant;
use frazil_studies::compare::vary::RATIOS;
use frazil_studies::compare::{CompareRequest, Vary, compare};
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MustBe, StudyRuns, command_line, key_and_value, positive, positive_seconds};
use crate::parts::parts;

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Scene files, or names of bundled scenes.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// The methods; by default all methods of a scene.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Number of spacings, each half the one before.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=8))]
    levels: u8,
    /// Folder for the results; by default out/compare.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Timed repetitions of each run; by default seven for short runs and fewer for long ones.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: Option<u16>,
    /// Seeds of each stochastic run; by default ten, or at least five if time is short.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    seeds: Option<u16>,
    /// Threads of each run.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Wall time for one scene, in seconds; 45 by default. Runs that do not fit are left out and listed.
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    budget_s: Option<f64>,
    /// Varies the spacing and one key of the methods, as in `spacing,horizon_ratio`, and gives signed errors
    /// instead of times.
    #[arg(long, value_name = "spacing,KEY", value_parser = varied)]
    vary: Option<String>,
    /// Values of the varied key; by default from two thirds to eight thirds of the scene's own.
    #[arg(long, value_name = "VALUES", value_delimiter = ',', value_parser = positive, requires = "vary")]
    ratios: Vec<f64>,
    /// Settings of the methods: best, paper or both.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = setting, default_value = "best")]
    settings: Vec<Setting>,
    /// Also compares the best setting with a key of the methods' sections changed, as in `mean=harmonic`; may be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value, conflicts_with = "vary")]
    also: Vec<(String, String)>,
    /// Overrides a key of every scene, as in `time.duration_h=2`; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Runs reduced scenes with the same solution, where there are any.
    #[arg(long)]
    reduce: bool,
    #[command(flatten)]
    runs: StudyRuns,
}

impl CompareArguments {
    /// Compares the methods.
    pub fn answer(self) -> Result<Verdict, Failure> {
        let checkpoints = self.runs.begin();
        let also = self.also.iter().map(|(key, value)| Variant::changed(key, value));
        let request = CompareRequest {
            scenes: self.scenes,
            methods: self.methods,
            levels: self.levels.into(),
            out: self.out,
            repeats: self.repeats.map(Into::into),
            seeds: self.seeds.map(Into::into),
            threads: self.threads.into(),
            budget_s: self.budget_s,
            vary: self.vary.map(|key| Vary { key, ratios: self.ratios }),
            settings: self.settings.into_iter().map(Variant::standard).chain(also).collect(),
            overrides: self.set,
            reduce: self.reduce,
            checkpoints,
            quiet: self.runs.quiet,
            command_line: command_line(),
        };
        compare(&request, &parts(request.reduce))
    }
}

fn varied(text: &str) -> Result<String, MustBe> {
    match text.split_once(',') {
        Some(("spacing", key)) if RATIOS.contains(&key) => Ok(key.to_owned()),
        _ => Err(MustBe(format!("\"spacing\" and, after a comma, one of {}", RATIOS.join(", ")).into())),
    }
}

fn setting(text: &str) -> Result<Setting, MustBe> {
    match text {
        "best" => Ok(Setting::Best),
        "paper" => Ok(Setting::Paper),
        _ => Err(MustBe("\"best\" or \"paper\"".into())),
    }
}
