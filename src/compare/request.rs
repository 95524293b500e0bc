//! What a comparison is asked for, and the parts of the program that it is given.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use frazil_cases::Truth;
use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::reference::Reference;

use super::variant::Variant;
use crate::load::Overrides;
use crate::progress::{clock, forewarn};

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
    pub vary: Option<Vary>,
    /// Settings of the methods.
    pub settings: Vec<Variant>,
    /// Pairs of key path and value that override every scene.
    pub overrides: Overrides,
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
    pub(super) fn forewarn(&self) {
        if !self.quiet {
            let each = clock(self.budget());
            let what = format!("compare, at most {each} for each scene");
            forewarn(&what, Some(self.budget() * self.scenes.len() as f64));
        }
    }
}

/// What is to be varied beside the spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct Vary {
    /// The key.
    pub key: String,
    /// Its values; by default around the scene's own.
    pub ratios: Vec<f64>,
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
