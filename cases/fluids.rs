//! Fluids by name, which constants of eDPD are calibrated to.

use crate::scenes::{BundledScene, bundled};

/// All of them.
pub fn all() -> &'static [BundledScene] {
    bundled!["fluids": "water"]
}

/// The fluid of a name.
pub fn find(name: &str) -> Option<&'static BundledScene> {
    all().iter().find(|fluid| fluid.name == name)
}
