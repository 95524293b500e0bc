//! The layout studies that come with the program.

use crate::scenes::{BundledScene, bundled};

/// All of them.
pub fn all() -> &'static [BundledScene] {
    bundled!["studies":
        "shaft-single-sand",
        "shaft-single-clay",
        "shaft-three-pipe",
        "shaft-four-pipe",
        "shaft-clay",
        "shaft-pipe-radius",
        "shaft-deviation",
        "shaft-strata",
        "shaft-failed-pipe",
        "shaft-excavation",
        "shaft-sensitivity",
        "shaft-sweep",
        "shaft-search",
        "shaft-energy",
        "shaft-seed",
        "shaft-groundwater",
        "shaft-seepage",
    ]
}

/// The study of a name.
pub fn find(name: &str) -> Option<&'static BundledScene> {
    all().iter().find(|study| study.name == name)
}
