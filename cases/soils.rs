//! Soils by name, as materials of a scene.

/// A TOML table for each.
pub const TEXT: &str = include_str!("soils.toml");
