//! Methods against each other on the same scenes: error against run time.
//!
//! A comparison goes one way: a plan of runs, the runs themselves, what they say (analysis), and then tables,
//! figures and one page. Files are written as results arrive, each whole.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use frazil_cases::Truth;
use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::reference::Reference;

use crate::failure::{Failure, Verdict, answer, complain};
use crate::machine::Machine;
use crate::output::Folder;
use crate::progress::{clock, forewarn};
use crate::{interrupt, load, registry};

pub mod analysis;
pub mod curve;
pub mod execute;
pub mod figures;
pub mod measured;
pub mod plan;
pub mod reference;
pub mod report;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod turns;
pub mod vary;
pub mod verdict;

/// Wall time that is spent on one scene unless told otherwise (s).
const BUDGET: f64 = 45.0;

/// What is to be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareRequest {
    /// Scenes, by path or bundled name.
    pub scenes: Vec<String>,
    /// Methods; all that a scene has settings for if empty.
    pub methods: Vec<String>,
    /// Number of spacings.
    pub levels: usize,
    /// Folder for the results.
    pub out: Option<PathBuf>,
    /// Timed repetitions of each run; by its length if absent.
    pub repeats: Option<usize>,
    /// Seeds of each stochastic run; ten, or what the time allows, if absent.
    pub seeds: Option<usize>,
    /// Threads of each timed run.
    pub threads: usize,
    /// Wall time for one scene (s).
    pub budget_s: Option<f64>,
    /// What is varied beside the spacing, in place of times and settings.
    pub vary: Option<vary::Vary>,
    /// Settings of the methods.
    pub settings: Vec<plan::Variant>,
    /// Pairs of key path and value that override every scene.
    pub overrides: load::Overrides,
    /// Whether smaller scenes that give the same answer are to be run instead.
    pub reduce: bool,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}

impl CompareRequest {
    /// Wall time for one scene (s).
    pub fn budget(&self) -> f64 {
        self.budget_s.unwrap_or(BUDGET)
    }

    /// Says that all scenes together take long, if they may.
    fn forewarn(&self) {
        if !self.quiet {
            let each = clock(self.budget());
            let what = format!("compare, at most {each} for each scene");
            forewarn(&what, Some(self.budget() * self.scenes.len() as f64));
        }
    }
}

/// Reads a scene by name or path with overrides.
pub type SceneAt<'a> = dyn Fn(&str, &[(String, String)]) -> Result<Scene, String> + 'a;
/// The reference of a scene that needs no run, and why it is not the one that the scene names.
pub type ReferenceFor<'a> = dyn Fn(&Scene) -> Result<Truth, String> + 'a;
/// Makes one run.
pub type Run<'a> =
    dyn Fn(&Scene, &str, Option<&Arc<dyn Reference>>, &Options<'_>) -> Result<RunResult, Refused> + Sync + 'a;

/// The rest of the program as a comparison sees it; tests put made-up parts in their place.
pub struct Parts<'a> {
    /// Reads scenes.
    pub scene_at: &'a SceneAt<'a>,
    /// Knows references.
    pub reference_for: &'a ReferenceFor<'a>,
    /// Makes runs.
    pub run: &'a Run<'a>,
    /// The methods.
    pub methods: &'a [&'static MethodKind],
    /// Set to stop.
    pub interrupt: &'a AtomicBool,
}

/// Compares.
pub fn compare(request: &CompareRequest) -> Result<Verdict, Failure> {
    let parts = Parts {
        scene_at: &|name, overrides| {
            let all = [request.overrides.as_slice(), overrides].concat();
            load::scene(name, &all).map_err(|failure| failure.to_string())
        },
        reference_for: &frazil_cases::truth,
        run: if request.reduce { &frazil_simulation::reduce::run } else { &frazil_simulation::march::run },
        methods: registry::methods(),
        interrupt: interrupt::watch(),
    };
    match &request.vary {
        Some(wanted) => vary::vary(request, wanted, &parts),
        None => compare_with(request, &parts),
    }
}

/// Compares with given parts.
pub fn compare_with(request: &CompareRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join("compare"));
    // Every scene is read under every method and setting before the first run, so that a misspelt word costs no time.
    for name in &request.scenes {
        let scene = (parts.scene_at)(name, &[]).map_err(Failure::Request)?;
        plan::check(request, parts, name, &scene).map_err(Failure::Request)?;
    }
    request.forewarn();
    let folder = Folder::make(&path)?;
    let machine = Machine::now();
    let mut finished = Vec::new();
    let mut broken = false;
    for name in &request.scenes {
        let say = |text: &str| {
            if !request.quiet {
                complain(text);
            }
        };
        let written = |runs: &execute::SceneRuns| tables::write_comparison(folder.path(), &finished, runs);
        match execute::scene(request, parts, name, &say, &written) {
            Ok(runs) => {
                let study = analysis::Study::of(runs);
                if !request.quiet {
                    answer(&verdict::text(&study))?;
                }
                finished.push(study);
            }
            Err(execute::Stop::Scene(reason)) => {
                complain(&format!("{name}: {reason}"));
                broken = true;
            }
            Err(execute::Stop::Files(failure)) => return Err(failure),
        }
        tables::write_all(folder.path(), &finished)?;
        report::write(request, &machine, folder.path(), &finished)?;
        if parts.interrupt.load(Ordering::Relaxed) {
            return Ok(Verdict::Broken);
        }
    }
    if finished.is_empty() {
        folder.take_back();
    } else if !request.quiet {
        complain(&format!("written: {}", path.join("report.html").display()));
    }
    Ok(if broken { Verdict::Broken } else { Verdict::Done })
}
