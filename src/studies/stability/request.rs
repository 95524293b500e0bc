//! What a study of stability is asked for.

use std::path::PathBuf;

use super::axis::Axis;
use crate::parts::Override;

/// What is to be mapped.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityRequest {
    /// Scenes, by path or bundled name.
    pub scenes: Vec<String>,
    /// Methods; all that a scene has settings for if empty.
    pub methods: Vec<String>,
    /// Axes; all that mean something if empty.
    pub axes: Vec<Axis>,
    /// Overrides of every scene.
    pub overrides: Vec<Override>,
    /// Steps over the bound to run, without a search for boundaries; a map and its boundaries if empty.
    pub steps: Vec<f64>,
    /// Steps of a map between a quarter of the bound and four times it.
    pub grid: usize,
    /// Columns of a map.
    pub values: usize,
    /// Runs of a noisy cell near a boundary.
    pub seeds: usize,
    /// Spacing over the scene's own.
    pub coarsen: u32,
    /// Wall time of one run (s).
    pub time_limit_s: f64,
    /// Columns that are worked on side by side.
    pub threads: usize,
    /// Folder for the results; `out/stability` if absent.
    pub out: Option<PathBuf>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}
