//! What the papers show, row by row.

/// The file of all rows.
pub const TEXT: &str = include_str!("atlas.toml");
