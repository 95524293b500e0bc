//! `frazil stability`.

use std::path::PathBuf;

use clap::Args;
use frazil_studies::failure::{Failure, Verdict};
use frazil_studies::stability::axis::Axis;
use frazil_studies::stability::{StabilityRequest, stability};

use super::values::{MemoryLimit, MustBe, Threads, command_line, key_and_value, positive, positive_seconds};
use crate::parts::parts;

#[derive(Debug, Args)]
pub struct StabilityArguments {
    /// Scene files, or names of bundled scenes.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// The methods; by default all methods of a scene.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Parameters of the maps: stefan, conductivity, capacity, reach, disorder, noise, rkl2 (stages), of unsaturated water
    /// spacing, saturation, alpha, n, contrast; or own, the scene as it is. By default all applicable ones except own.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = axis)]
    axes: Vec<Axis>,
    /// Overrides a key of every scene; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Runs only these steps over the step bound, without boundaries; for unsaturated water, these tolerances over the scene's.
    #[arg(long, value_name = "RATIOS", value_delimiter = ',', value_parser = positive)]
    steps: Vec<f64>,
    /// Number of steps of a map, from a quarter of the bound to four times it.
    #[arg(long, value_name = "N", default_value_t = 13, value_parser = clap::value_parser!(u16).range(2..=200))]
    grid: u16,
    /// Number of columns of a map; odd, with the scene's own value in the middle.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = odd)]
    values: u16,
    /// Seeds of a noisy cell near a boundary.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=1000))]
    seeds: u16,
    /// Largest spacing over the scene's own, as far as the scene allows.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=16))]
    coarsen: u8,
    /// Wall time of one run, in seconds; a cell that needs more has timed out.
    #[arg(long, value_name = "S", default_value = "60", value_parser = positive_seconds)]
    time_limit_s: f64,
    #[command(flatten)]
    threads: Threads,
    /// Folder for the results; by default out/stability. Finished runs in it are not repeated.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints only errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    memory: MemoryLimit,
}

impl StabilityArguments {
    /// Maps the stability of the methods.
    pub fn answer(self) -> Result<Verdict, Failure> {
        self.memory.set();
        let request = StabilityRequest {
            scenes: self.scenes,
            methods: self.methods,
            axes: self.axes,
            overrides: self.set,
            steps: self.steps,
            grid: self.grid.into(),
            values: self.values.into(),
            seeds: self.seeds.into(),
            coarsen: self.coarsen.into(),
            time_limit_s: self.time_limit_s,
            threads: self.threads.count(),
            out: self.out,
            quiet: self.quiet,
            command_line: command_line(),
        };
        stability(&request, &parts(false))
    }
}

fn odd(text: &str) -> Result<u16, MustBe> {
    match text.parse::<u16>() {
        Ok(number) if number % 2 == 1 && number < 100 => Ok(number),
        _ => Err(MustBe("an odd number from 1 to 99".into())),
    }
}

fn axis(text: &str) -> Result<Axis, MustBe> {
    let words = || Axis::WORDS.map(|(word, _)| word).join(", ");
    Axis::of_word(text).ok_or_else(|| MustBe(format!("one of {}", words()).into()))
}
