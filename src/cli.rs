//! From what was typed to a checked request, and to the command that answers it: a file a command.

mod atlas;
mod calibrate;
mod cheapest;
mod check;
mod compare;
mod completions;
mod gallery;
mod layout;
mod list;
mod new;
mod properties;
mod rerun;
mod run;
mod schema;
mod show;
mod stability;
mod status;
mod sweep;
mod values;

use std::ffi::{OsStr, OsString};

use clap::{Parser, Subcommand};
use frazil_record::is_hidden;
use frazil_studies::failure::{Failure, Verdict, complain, exit_code};

/// Freezing problems solved with peridynamics, SPH, eDPD and a local baseline.
#[derive(Debug, Parser)]
#[command(name = "frazil", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Writes a commented scene to edit, or a copy of a bundled one.
    New(new::NewArguments),
    /// Runs a scene with one method and writes its record, time series and figures.
    Run(run::RunArguments),
    /// Repeats the run of a record and compares the final states.
    Rerun(rerun::RerunArguments),
    /// Compares methods on the same scenes: error against run time.
    Compare(compare::CompareArguments),
    /// Finds the fastest run of each method that reaches a given error.
    Cheapest(cheapest::CheapestArguments),
    /// Runs a scene at all combinations of values of any of its keys.
    Sweep(sweep::SweepArguments),
    /// Maps the outcome of runs over the time step and one parameter, with stability boundaries.
    Stability(stability::StabilityArguments),
    /// Checks a scene and plans a run: particles, memory, time step, run time.
    Check(check::CheckArguments),
    /// Prints the progress of the runs and studies in a folder.
    Status(status::StatusArguments),
    /// Compares layouts of freeze pipes: day of closure, weakest gap, thickness, load.
    Layout(layout::LayoutArguments),
    /// Computes the parameters of an eDPD fluid from the Schmidt and Prandtl numbers of a real one.
    Calibrate(calibrate::CalibrateArguments),
    /// Measures the fluid of `calibrate` with moving particles: diffusivities, Schmidt and
    /// Prandtl numbers, with 95 % confidence intervals over seeds.
    Properties(properties::PropertiesArguments),
    /// Compares every section, figure and table of the five papers with the results of the program.
    Atlas(atlas::AtlasArguments),
    /// Runs the bundled scenes and shows a picture, the error and the command of each.
    Gallery(gallery::GalleryArguments),
    /// Lists bundled scenes, studies and fluids, and the methods.
    List(list::ListArguments),
    /// Prints the file of a bundled scene, study or fluid.
    Show(show::ShowArguments),
    /// Prints the JSON Schema of scene files, for completion and checks in editors.
    Schema,
    /// Prints shell completions, or writes manual pages.
    Completions(completions::CompletionsArguments),
}

impl Command {
    fn answer(self) -> Result<Verdict, Failure> {
        match self {
            Command::New(arguments) => arguments.answer(),
            Command::Run(arguments) => arguments.answer(),
            Command::Rerun(arguments) => arguments.answer(),
            Command::Compare(arguments) => arguments.answer(),
            Command::Cheapest(arguments) => arguments.answer(),
            Command::Sweep(arguments) => arguments.answer(),
            Command::Stability(arguments) => arguments.answer(),
            Command::Check(arguments) => arguments.answer(),
            Command::Status(arguments) => arguments.answer(),
            Command::Layout(arguments) => arguments.answer(),
            Command::Calibrate(arguments) => arguments.answer(),
            Command::Properties(arguments) => arguments.answer(),
            Command::Atlas(arguments) => arguments.answer(),
            Command::Gallery(arguments) => arguments.answer(),
            Command::List(arguments) => arguments.answer(),
            Command::Show(arguments) => arguments.answer(),
            Command::Schema => schema::answer(),
            Command::Completions(arguments) => arguments.answer(),
        }
    }
}

/// Runs the program on its arguments, the first of which is its own name, and says with what code it ends.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let typed: Vec<OsString> = arguments.into_iter().collect();
    values::keep_typed(&typed);
    match Cli::try_parse_from(&typed) {
        Ok(cli) => exit_code(cli.command.answer()),
        Err(error) => {
            say(&error, &typed);
            if error.use_stderr() { 2 } else { 0 }
        }
    }
}

/// Prints help, or what was not understood: in colours, unless arguments come with colours of their own.
fn say(error: &clap::Error, typed: &[OsString]) {
    let text = error.render().to_string();
    if text.chars().any(|letter| letter != '\n' && is_hidden(letter)) || typed.iter().any(|own| has_hidden(own)) {
        complain(text.trim_end());
    } else {
        // Help that nobody reads to its end is still help.
        let _ = error.print();
    }
}

fn has_hidden(argument: &OsStr) -> bool {
    argument.to_string_lossy().chars().any(is_hidden)
}

/// Whether the program would understand its arguments, the first of which is its own name. Asking for help is understood.
///
/// # Errors
/// What it does not understand.
pub fn understood<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Result<(), clap::Error> {
    match Cli::try_parse_from(arguments) {
        Err(error) if error.use_stderr() => Err(error),
        _ => Ok(()),
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
}
