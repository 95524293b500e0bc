//! What is asked of a search for the cheapest run.

use std::path::PathBuf;

use crate::ensemble::runs::Headline;
use crate::parts::Override;

/// A search for the cheapest run that reaches an error.
#[derive(Debug, Clone)]
pub struct CheapestRequest {
    /// Name or path of the scene.
    pub scene: String,
    /// Methods; all that the scene has settings for if empty.
    pub methods: Vec<String>,
    /// Relative error.
    pub error: f64,
    /// Of what; of the first thing that the scene has if absent.
    pub measure: Option<Headline>,
    /// Pairs of key path and value that override the scene.
    pub overrides: Vec<Override>,
    /// Threads of each run.
    pub threads: usize,
    /// Wall time (s) that the runs of each method may take together.
    pub budget_s: f64,
    /// Folder for the results.
    pub out: Option<PathBuf>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}
