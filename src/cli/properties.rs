//! `frazil properties`.

use std::path::PathBuf;

use clap::Args;
use frazil_edpd::calibration::Constants;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{MustBe, Threads, number, sized};
use crate::properties::{PropertiesRequest, Rows, properties};

/// The default, 13 temperatures of water and 5 seeds, takes 1.8e9 particle steps: some 15 minutes
/// on two idle cores, less with more cores. Finished jobs are stored, so a stopped study is resumed by the same
/// command.
#[derive(Debug, Args)]
pub struct PropertiesArguments {
    /// A bundled fluid (water), or a TOML or CSV file, as for calibrate.
    #[arg(default_value = "water")]
    fluid: String,
    /// Temperatures of the fluid's rows, in degrees Celsius; by default rows at least 10 K apart, from the coldest on.
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_hyphen_values = true, value_parser = finite)]
    temperatures_c: Vec<f64>,
    /// All rows of the fluid.
    #[arg(long, conflicts_with = "temperatures_c")]
    all_rows: bool,
    /// Runs of each measurement.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    seeds: u16,
    /// Height of the periodic boxes: squares for displacements, two thirds as wide for flow and heat. The driving is scaled
    /// so that profiles are as high as in the paper's boxes, times with the square of the height.
    #[arg(long = "box", value_name = "L", default_value = "20", value_parser = sized)]
    height: f64,
    /// Sampling time over the default; confidence intervals decrease with its root.
    #[arg(long, value_name = "X", default_value = "1", value_parser = effort)]
    effort: f64,
    /// Boxes and steps of the paper: 30 x 30 with 280000 steps, 20 x 30 with 220000. The default rows take some 16 hours on
    /// two idle cores.
    #[arg(long, conflicts_with_all = ["height", "effort"])]
    paper: bool,
    /// Time step.
    #[arg(long, value_name = "X", default_value = "0.007", value_parser = sized)]
    step: f64,
    /// Friction coefficient of a pair, gamma.
    #[arg(long, value_name = "X", default_value = "8", value_parser = sized)]
    gamma: f64,
    /// Cut-off radius of all forces and of heat exchange.
    #[arg(long, value_name = "R", default_value = "1.96", value_parser = sized)]
    cutoff: f64,
    /// Checks instead that a fluid at equilibrium conserves energy and momentum and has one temperature: 100000 steps of 1500 particles in
    /// two and three dimensions, with the time step and with three times the time step.
    #[arg(long, conflicts_with_all = ["temperatures_c", "all_rows", "seeds", "height", "paper"])]
    equilibrium: bool,
    #[command(flatten)]
    threads: Threads,
    /// Folder for the results; by default out/properties-FLUID. Finished jobs in it are not repeated.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints only errors on standard error.
    #[arg(long)]
    quiet: bool,
}

impl PropertiesArguments {
    /// Measures the fluid.
    pub fn answer(self) -> Result<Verdict, Failure> {
        properties(&PropertiesRequest {
            fluid: self.fluid,
            constants: Constants {
                friction: self.gamma,
                conservative_cutoff: self.cutoff,
                dissipative_cutoff: self.cutoff,
                thermal_cutoff: self.cutoff,
                ..Constants::paper()
            },
            reference_temperature: 300.0,
            rows: match (self.all_rows, self.temperatures_c.is_empty()) {
                (true, _) => Rows::All,
                (false, true) => Rows::Apart(10.0),
                (false, false) => Rows::Given(self.temperatures_c),
            },
            seeds: self.seeds.into(),
            height: self.height,
            effort: self.effort,
            step: self.step,
            paper: self.paper,
            equilibrium: self.equilibrium,
            threads: self.threads.count(),
            out: self.out,
            quiet: self.quiet,
        })
    }
}

fn finite(text: &str) -> Result<f64, MustBe> {
    number(text, f64::is_finite, "a number")
}

fn effort(text: &str) -> Result<f64, MustBe> {
    number(text, |number| (1e-3..=1e3).contains(&number), "a number between 0.001 and 1000")
}
