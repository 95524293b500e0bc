//! Where a record comes from: enough to make its run again.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What was run, by what and on what.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Date and time of day at which the run ended, in UTC.
    pub date: String,
    /// The command as it was typed.
    pub command: String,
    /// Commit of the sources that the program was built from, with `-dirty` where files had been changed; absent where it was built
    /// outside a repository.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub commit: Option<String>,
    /// The compiler and its version.
    pub compiler: String,
    /// How it compiled, and flags beyond those of the profile.
    pub compiled: String,
    /// Processor.
    pub processor: String,
    /// Cores that the program could use.
    pub cores: usize,
    /// Operating system.
    pub system: String,
    /// Name of the scene.
    pub scene: String,
    /// Text of the scene's file.
    pub scene_file: String,
    /// Files that it names, by their names, and their texts.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub files: BTreeMap<String, String>,
    /// Keys that were set over it, in their order.
    pub overrides: Vec<(String, String)>,
    /// Whether a smaller scene was to be run that gives the same answer.
    pub reduce: bool,
}
