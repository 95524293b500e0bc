//! From what was typed to a checked request, and to the command that answers it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use frazil_edpd::calibration::Constants;
use frazil_scene::Setting;

use crate::calibrate::{CalibrateRequest, Conduction, calibrate};
use crate::campaign::Shard;
use crate::compare::Vary;
use crate::compare::variant::Variant;
use crate::compare::vary::RATIOS;
use crate::failure::{Failure, Verdict, exit_code};
use crate::parts::parts;
use crate::properties::{PropertiesRequest, Rows, properties};
use crate::stability::axis::Axis;
use crate::{check, compare, layout, list, load, parallel, run, stability};

/// Freezing by particles: peridynamics, SPH, eDPD and a local baseline on the same scenes.
#[derive(Debug, Parser)]
#[command(name = "frazil", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Runs a scene under one method and writes its record, series and figures.
    Run(RunArguments),
    /// Sets methods against each other on the same scenes: error against run time.
    Compare(CompareArguments),
    /// Maps where methods break: the outcome over the step and one parameter, with its boundaries.
    Stability(StabilityArguments),
    /// Checks a scene and prints what a run of it would do.
    Check(CheckArguments),
    /// Sets layouts of freeze pipes beside each other: the day the wall closes, its weakest gap, thickness, load.
    Layout(LayoutArguments),
    /// Finds the constants of an eDPD fluid from the Schmidt and Prandtl numbers of a real one.
    Calibrate(CalibrateArguments),
    /// Measures what the fluid that `calibrate` gives is really like, on moving particles: diffusivities, Schmidt and
    /// Prandtl numbers, with 95 % intervals over seeds.
    Properties(PropertiesArguments),
    /// Lists the bundled scenes, fluids and the methods.
    List,
}

#[derive(Debug, Args)]
struct RunArguments {
    /// A scene file, or the name of a bundled scene.
    scene: String,
    /// The method; by default the first one that the scene has settings for.
    #[arg(long, value_name = "NAME")]
    method: Option<String>,
    /// Overrides a key of the file, as in `method.pd.horizon_ratio=4`; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Takes the discretisation that the scene's paper prints, where one is bundled; `--set` goes over it.
    #[arg(long)]
    paper: bool,
    /// Threads; by default one for each core. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Seed of noise and of uneven placement; with --seeds that of the first member.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Runs an ensemble of N members whose seeds follow each other, side by side and each on one thread: means with
    /// intervals. Members that the folder holds already are not run again.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000), conflicts_with_all = ["reduce", "fields", "frames"])]
    seeds: Option<u16>,
    /// Folder for the results; by default out/SCENE/METHOD.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Runs the smaller scene that gives the same answer, if there is one.
    #[arg(long, conflicts_with_all = ["fields", "frames"])]
    reduce: bool,
    /// Writes the state of all particles at every output, for ParaView: fields.pvd and fields/*.vtu.
    #[arg(long)]
    fields: bool,
    /// Draws a temperature map at every output, for an animation: frames/*.png. Needs a plane.
    #[arg(long)]
    frames: bool,
    /// Says nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct LayoutArguments {
    /// A study file, or the name of a bundled study.
    study: String,
    /// The method; by default the study's, or the first that the scene has settings for.
    #[arg(long, value_name = "NAME")]
    method: Option<String>,
    /// Overrides a key of the scene of all layouts; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Layouts that run at once; by default one for each core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Runs the layouts K, K + N, K + 2 N, ... alone; the same command without it takes all over that the folder holds,
    /// and writes the tables.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Folder for the results; by default out/STUDY. Layouts that it holds already are not run again.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Says what would be run, on which part of the plan and why, and runs nothing.
    #[arg(long, conflicts_with_all = ["shard", "out", "frames"])]
    check: bool,
    /// Draws a temperature map of each layout at every output, for an animation: layouts/*/frames/*.png.
    #[arg(long)]
    frames: bool,
    /// Says nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct CheckArguments {
    /// A scene file, or the name of a bundled scene.
    scene: String,
    /// A method; may be repeated. By default all that the scene has settings for.
    #[arg(long, value_name = "NAME")]
    method: Vec<String>,
    /// Overrides a key of the file; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Takes the discretisation that the scene's paper prints, where one is bundled; `--set` goes over it.
    #[arg(long)]
    paper: bool,
    /// Threads of the run; by default one for each core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Plans the smaller scene that gives the same answer, if there is one.
    #[arg(long)]
    reduce: bool,
}

#[derive(Debug, Args)]
struct CompareArguments {
    /// Scene files, or names of bundled scenes.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// The methods; by default all that a scene has settings for.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Number of spacings, each half the one before.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=8))]
    levels: u8,
    /// Folder for the results; by default out/compare.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Timed repetitions of each run; by default seven of short runs and fewer of long ones.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: Option<u16>,
    /// Seeds of each stochastic run; by default ten, or at least five where time is short.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    seeds: Option<u16>,
    /// Threads of each run.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Wall time for one scene, in seconds; 45 by default. Runs that would not fit are left out and listed.
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    budget_s: Option<f64>,
    /// Varies the spacing and one key of the methods together, as in `spacing,horizon_ratio`, and gives errors with their
    /// signs in place of times.
    #[arg(long, value_name = "spacing,KEY", value_parser = varied)]
    vary: Option<String>,
    /// Values of the varied key; by default from two thirds of the scene's own to eight thirds.
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
    /// Runs smaller scenes that give the same answer, where there are any.
    #[arg(long)]
    reduce: bool,
    /// Says nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct StabilityArguments {
    /// Scene files, or names of bundled scenes.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// The methods; by default all that a scene has settings for.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Parameters of the maps: stefan, conductivity, capacity, reach, disorder, noise, rkl2 (stages); or own, the scene
    /// as it is. By default all but the last that mean anything to a scene and a method.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = axis)]
    axes: Vec<Axis>,
    /// Overrides a key of every scene; may be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,
    /// Runs these steps over the bound alone, and looks for no boundary.
    #[arg(long, value_name = "RATIOS", value_delimiter = ',', value_parser = positive)]
    steps: Vec<f64>,
    /// Number of steps of a map, from a quarter of the bound to four times it.
    #[arg(long, value_name = "N", default_value_t = 13, value_parser = clap::value_parser!(u16).range(2..=200))]
    grid: u16,
    /// Number of columns of a map; odd, so that the scene's own value stands in the middle.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = odd)]
    values: u16,
    /// Seeds of a noisy cell near a boundary.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=1000))]
    seeds: u16,
    /// Largest spacing over the scene's own; as much of it is taken as the scene allows.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=16))]
    coarsen: u8,
    /// Wall time of one run, in seconds; a cell that needs more has timed out.
    #[arg(long, value_name = "S", default_value = "60", value_parser = positive_seconds)]
    time_limit_s: f64,
    /// Columns that are worked on side by side; by default one for each core. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder for the results; by default out/stability. Runs that a study there has made already are not made again.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Says nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct CalibrateArguments {
    /// A bundled fluid (water), or a TOML or CSV file.
    #[arg(default_value = "water")]
    fluid: String,
    /// Dimensions of space, 2 or 3.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: u8,
    /// Particles by volume, in DPD units as all that has no unit in its name.
    #[arg(long, value_name = "N", default_value = "4", value_parser = sized)]
    number_density: f64,
    /// Friction of a pair, gamma.
    #[arg(long, value_name = "X", default_value = "8", value_parser = sized)]
    gamma: f64,
    /// Cut-off radius of all forces and of the exchange of heat.
    #[arg(long, value_name = "R", default_value = "1.96", value_parser = sized)]
    cutoff: f64,
    /// Cut-off radius of the conservative force alone.
    #[arg(long, value_name = "R", value_parser = sized)]
    conservative_cutoff: Option<f64>,
    /// Cut-off radius of friction and random force alone.
    #[arg(long, value_name = "R", value_parser = sized)]
    dissipative_cutoff: Option<f64>,
    /// Cut-off radius of the exchange of heat alone.
    #[arg(long, value_name = "R", value_parser = sized)]
    thermal_cutoff: Option<f64>,
    /// Heat capacity of a particle in k_B.
    #[arg(long, value_name = "X", default_value = "1e5", value_parser = sized)]
    heat_capacity: f64,
    /// Temperature that is 1 in DPD units, in K.
    #[arg(long, value_name = "K", default_value = "300", value_parser = sized)]
    reference_temperature_k: f64,
    /// One Prandtl number in place of those of the fluid.
    #[arg(long, value_name = "X", value_parser = sized, conflicts_with = "diffusivity")]
    prandtl: Option<f64>,
    /// One thermal diffusivity in place of Prandtl numbers.
    #[arg(long, value_name = "X", value_parser = sized)]
    diffusivity: Option<f64>,
    /// Leaves out rows that are colder, in K.
    #[arg(long, value_name = "K", value_parser = positive)]
    from_k: Option<f64>,
    /// Leaves out rows that are warmer, in K.
    #[arg(long, value_name = "K", value_parser = positive)]
    to_k: Option<f64>,
    /// Folder for the results; by default out/calibrate.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// At the defaults, 13 temperatures of water and 5 seeds, it makes 1.8 thousand million steps of particles: some 15 minutes
/// on two idle cores, less with more of them. Finished jobs are taken down, so a study that was stopped goes on when it is
/// started again.
#[derive(Debug, Args)]
struct PropertiesArguments {
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
    /// Height of the periodic boxes: squares for displacements, two thirds as wide for flow and heat. The drives are scaled
    /// so that profiles are as high as in the paper's boxes, times with the square of the height.
    #[arg(long = "box", value_name = "L", default_value = "20", value_parser = sized)]
    height: f64,
    /// Times that are watched, over the default ones; intervals shrink with the root of it.
    #[arg(long, value_name = "X", default_value = "1", value_parser = effort)]
    effort: f64,
    /// Boxes and steps of the paper: 30 x 30 with 280000 steps, 20 x 30 with 220000. At the default rows some 16 hours on
    /// two idle cores.
    #[arg(long, conflicts_with_all = ["height", "effort"])]
    paper: bool,
    /// Time step.
    #[arg(long, value_name = "X", default_value = "0.007", value_parser = sized)]
    step: f64,
    /// Friction of a pair, gamma.
    #[arg(long, value_name = "X", default_value = "8", value_parser = sized)]
    gamma: f64,
    /// Cut-off radius of all forces and of the exchange of heat.
    #[arg(long, value_name = "R", default_value = "1.96", value_parser = sized)]
    cutoff: f64,
    /// Checks instead that a fluid left alone keeps energy, momentum and one temperature: 100000 steps of 1500 particles in the
    /// plane and in space, at the step and at three times the step.
    #[arg(long, conflicts_with_all = ["temperatures_c", "all_rows", "seeds", "height", "paper"])]
    equilibrium: bool,
    /// Jobs side by side; by default one for each core. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder for the results; by default out/properties-FLUID. Jobs that a study there has made already are not made again.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Says nothing but errors on standard error.
    #[arg(long)]
    quiet: bool,
}

/// Runs the program on its arguments, the first of which is its own name.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    match Cli::try_parse_from(arguments) {
        Ok(cli) => exit_code(dispatch(cli.command)),
        Err(error) => {
            // Help that nobody reads to its end is still help.
            let _ = error.print();
            if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
        }
    }
}

/// Whether the program would understand its arguments, the first of which is its own name; if not, why. Asking for help
/// is understood.
pub fn understood<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Result<(), String> {
    match Cli::try_parse_from(arguments) {
        Err(error) if error.use_stderr() => Err(error.to_string()),
        _ => Ok(()),
    }
}

fn dispatch(command: Command) -> Result<Verdict, Failure> {
    match command {
        Command::Run(mut arguments) => {
            let request = run::RunRequest {
                overrides: if arguments.paper {
                    let (method, overrides) =
                        load::paper(&arguments.scene, arguments.method.as_slice(), arguments.set)?;
                    arguments.method = Some(method);
                    overrides
                } else {
                    arguments.set
                },
                scene: arguments.scene,
                method: arguments.method,
                threads: arguments.threads.map_or_else(parallel::cores, usize::from),
                seed: arguments.seed,
                out: arguments.out,
                reduce: arguments.reduce,
                fields: arguments.fields,
                frames: arguments.frames,
                quiet: arguments.quiet,
            };
            match arguments.seeds {
                Some(seeds) => run::ensemble(&request, seeds.into()),
                None => run::run(&request),
            }
        }
        Command::Compare(arguments) => {
            let request = compare::CompareRequest {
                scenes: arguments.scenes,
                methods: arguments.methods,
                levels: arguments.levels.into(),
                out: arguments.out,
                repeats: arguments.repeats.map(Into::into),
                seeds: arguments.seeds.map(Into::into),
                threads: arguments.threads.into(),
                budget_s: arguments.budget_s,
                vary: arguments.vary.map(|key| Vary { key, ratios: arguments.ratios }),
                settings: arguments
                    .settings
                    .into_iter()
                    .map(Variant::standard)
                    .chain(arguments.also.iter().map(|(key, value)| Variant::changed(key, value)))
                    .collect(),
                overrides: arguments.set,
                reduce: arguments.reduce,
                quiet: arguments.quiet,
                command_line: std::env::args().collect::<Vec<_>>().join(" "),
            };
            compare::compare(&request, &parts(request.reduce))
        }
        Command::Layout(arguments) => layout::layout(&layout::LayoutRequest {
            study: arguments.study,
            method: arguments.method,
            overrides: arguments.set,
            threads: arguments.threads.map_or_else(parallel::cores, usize::from),
            shard: arguments.shard.unwrap_or(Shard::WHOLE),
            check: arguments.check,
            frames: arguments.frames,
            out: arguments.out,
            quiet: arguments.quiet,
            command_line: std::env::args().collect::<Vec<_>>().join(" "),
        }),
        Command::Check(mut arguments) => check::check(&check::CheckRequest {
            overrides: if arguments.paper {
                let (method, overrides) = load::paper(&arguments.scene, &arguments.method, arguments.set)?;
                arguments.method = vec![method];
                overrides
            } else {
                arguments.set
            },
            scene: arguments.scene,
            methods: arguments.method,
            threads: arguments.threads.map_or_else(parallel::cores, usize::from),
            reduce: arguments.reduce,
        }),
        Command::Stability(arguments) => {
            let request = stability::StabilityRequest {
                scenes: arguments.scenes,
                methods: arguments.methods,
                axes: arguments.axes,
                overrides: arguments.set,
                steps: arguments.steps,
                grid: arguments.grid.into(),
                values: arguments.values.into(),
                seeds: arguments.seeds.into(),
                coarsen: arguments.coarsen.into(),
                time_limit_s: arguments.time_limit_s,
                threads: arguments.threads.map_or_else(parallel::cores, usize::from),
                out: arguments.out,
                quiet: arguments.quiet,
                command_line: std::env::args().collect::<Vec<_>>().join(" "),
            };
            stability::stability(&request, &parts(false))
        }
        Command::Calibrate(arguments) => calibrate(&CalibrateRequest {
            fluid: arguments.fluid,
            constants: Constants {
                dimension: arguments.dimension.into(),
                density: arguments.number_density,
                friction: arguments.gamma,
                conservative_cutoff: arguments.conservative_cutoff.unwrap_or(arguments.cutoff),
                dissipative_cutoff: arguments.dissipative_cutoff.unwrap_or(arguments.cutoff),
                thermal_cutoff: arguments.thermal_cutoff.unwrap_or(arguments.cutoff),
                heat_capacity: arguments.heat_capacity,
            },
            reference_temperature: arguments.reference_temperature_k,
            conduction: match (arguments.prandtl, arguments.diffusivity) {
                (Some(prandtl), _) => Conduction::Prandtl(prandtl),
                (None, Some(diffusivity)) => Conduction::Diffusivity(diffusivity),
                (None, None) => Conduction::Fluid,
            },
            from: arguments.from_k,
            to: arguments.to_k,
            out: arguments.out,
        }),
        Command::Properties(arguments) => properties(&PropertiesRequest {
            fluid: arguments.fluid,
            constants: Constants {
                friction: arguments.gamma,
                conservative_cutoff: arguments.cutoff,
                dissipative_cutoff: arguments.cutoff,
                thermal_cutoff: arguments.cutoff,
                ..Constants::paper()
            },
            reference_temperature: 300.0,
            rows: match (arguments.all_rows, arguments.temperatures_c.is_empty()) {
                (true, _) => Rows::All,
                (false, true) => Rows::Apart(10.0),
                (false, false) => Rows::Given(arguments.temperatures_c),
            },
            seeds: arguments.seeds.into(),
            height: arguments.height,
            effort: arguments.effort,
            step: arguments.step,
            paper: arguments.paper,
            equilibrium: arguments.equilibrium,
            threads: arguments.threads.map_or_else(parallel::cores, usize::from),
            out: arguments.out,
            quiet: arguments.quiet,
        }),
        Command::List => list::list(),
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    let parts: Option<(usize, usize)> =
        text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match parts {
        Some((k, count)) if k >= 1 && k <= count => Ok(Shard { number: k - 1, count }),
        _ => Err("must be K/N, as 3/16".into()),
    }
}

fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("must be KEY=VALUE, as time.outputs=20".into()),
    }
}

fn positive_seconds(text: &str) -> Result<f64, String> {
    positive(text).map_err(|_| "must be a number of seconds greater than 0".into())
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("must be a number greater than 0".into()),
    }
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(|| "must be a number".into())
}

fn effort(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (1e-3..=1e3).contains(&number) => Ok(number),
        _ => Err("must be a number between 0.001 and 1000".into()),
    }
}

/// A constant of a fluid: products of several of them must stay numbers.
fn sized(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (1e-12..=1e12).contains(&number) => Ok(number),
        _ => Err("must be a number between 1e-12 and 1e12".into()),
    }
}

fn odd(text: &str) -> Result<u16, String> {
    match text.parse::<u16>() {
        Ok(number) if number % 2 == 1 && number < 100 => Ok(number),
        _ => Err("must be an odd number from 1 to 99".into()),
    }
}

fn varied(text: &str) -> Result<String, String> {
    match text.split_once(',') {
        Some(("spacing", key)) if RATIOS.contains(&key) => Ok(key.to_owned()),
        _ => Err(format!("must be \"spacing\" and, after a comma, one of {}", RATIOS.join(", "))),
    }
}

fn axis(text: &str) -> Result<Axis, String> {
    let words = || Axis::WORDS.map(|(word, _)| word).join(", ");
    Axis::of_word(text).ok_or_else(|| format!("must be one of {}", words()))
}

fn setting(text: &str) -> Result<Setting, String> {
    match text {
        "best" => Ok(Setting::Best),
        "paper" => Ok(Setting::Paper),
        _ => Err("must be \"best\" or \"paper\"".into()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_flags_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_value_may_contain_an_equals_sign() {
        assert_eq!(key_and_value("title = a=b"), Ok(("title".into(), "a=b".into())));
        assert!(key_and_value("title").is_err());
        assert!(key_and_value("=3").is_err());
    }
}
