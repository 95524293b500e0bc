//! What turns bundled scenes into the discretisation that their paper prints: keys over the scene, one a line.

use crate::scenes::{BundledScene, bundled};

/// Scenes whose papers print a discretisation of their own, and the text of its keys.
pub fn all() -> &'static [BundledScene] {
    bundled!["paper":
        "stefan-water-mushy",
        "advective-column",
        "thawing-inclusion",
        "frozen-crack",
        "thick-pipe-temperature",
        "thick-pipe-flux",
        "thick-pipe-convection",
        "copper-sphere",
        "freezing-annulus",
        "heated-hollow-cylinder",
        "ice-in-glass",
    ]
}

/// The keys of the paper's discretisation of a bundled scene, each with its value, as overrides.
pub fn overrides(scene: &str) -> Option<Vec<(String, String)>> {
    let printed = all().iter().find(|printed| printed.name == scene)?;
    let lines = printed.text.lines().filter(|line| !line.starts_with('#'));
    let pair = |line: &str| line.split_once('=').map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()));
    Some(lines.filter_map(pair).collect())
}

/// The method that a paper's discretisation is one of: that of its keys.
pub fn method(scene: &str) -> Option<String> {
    let keys = overrides(scene)?;
    keys.iter().find_map(|(key, _)| key.strip_prefix("method.")?.split('.').next().map(str::to_owned))
}
