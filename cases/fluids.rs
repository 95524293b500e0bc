//! Fluids by name, which constants of eDPD are calibrated to.

/// The text of the file of a bundled fluid.
pub fn find(name: &str) -> Option<&'static str> {
    FLUIDS.iter().find(|(own, _)| *own == name).map(|(_, text)| *text)
}

/// Names of the bundled fluids.
pub fn names() -> impl Iterator<Item = &'static str> {
    FLUIDS.iter().map(|(name, _)| *name)
}

const FLUIDS: [(&str, &str); 1] = [("water", include_str!("fluids/water.toml"))];
