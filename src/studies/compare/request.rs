//! What a comparison is asked for.

use std::path::PathBuf;
use std::time::Duration;

use frazil_scene::Scene;

use super::variant::Variant;
use crate::failure::Failure;
use crate::method;
use crate::parts::{Override, Parts};
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
    pub overrides: Vec<Override>,
    /// Whether smaller scenes that give the same answer are to be run instead.
    pub reduce: bool,
    /// Wall time between two checkpoints of a run; none if absent.
    pub checkpoints: Option<Duration>,
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

    /// A scene with the overrides of all and these.
    ///
    /// # Errors
    ///
    /// If it cannot be had.
    pub(super) fn scene(&self, parts: &Parts<'_>, name: &str, overrides: &[Override]) -> Result<Scene, Failure> {
        (parts.scene_at)(name, &[self.overrides.as_slice(), overrides].concat())
    }

    /// Holds the names of all scenes, of each of which a folder is made, against each other.
    ///
    /// # Errors
    ///
    /// If two are alike, or a scene cannot be had.
    pub(super) fn distinct(&self, parts: &Parts<'_>) -> Result<(), Failure> {
        let scenes = self.scenes.iter().map(|name| Ok(self.scene(parts, name, &[])?.name));
        method::distinct(&scenes.collect::<Result<Vec<String>, Failure>>()?)
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
