//! The scenes that come with the program.

use frazil_scene::{Files, Source};

/// A scene, study or fluid by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BundledScene {
    /// Short name, as the command line takes it.
    pub name: &'static str,
    /// Text of its file.
    pub text: &'static str,
    /// Files that it names, as name and text.
    pub files: &'static [(&'static str, &'static str)],
}

impl From<&BundledScene> for Source<'static> {
    fn from(scene: &BundledScene) -> Self {
        Source { text: scene.text, files: scene.held() }
    }
}

impl BundledScene {
    /// The files that it names.
    pub fn held(&self) -> Files {
        Files::held(self.files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())))
    }
}

/// A small scene to begin with, which says what each of its parts is.
pub const TEMPLATE: &str = include_str!("template.toml");

/// Files of a folder beside this one, by their names without ending, each with files that it names.
macro_rules! bundled {
    ($folder:literal: $($name:literal $(with [$($file:literal),*])?),* $(,)?) => {
        &[$($crate::scenes::BundledScene {
            name: $name,
            text: include_str!(concat!($folder, "/", $name, ".toml")),
            files: &[$($(($file, include_str!(concat!($folder, "/", $file)))),*)?],
        }),*]
    };
}
pub(crate) use bundled;

/// The scenes of the papers, with references: what is compared.
pub fn all() -> &'static [BundledScene] {
    bundled!["scenes":
        "stefan-water",
        "stefan-water-mushy",
        "stefan-unit",
        "stefan-dpd-1",
        "stefan-dpd-2",
        "stefan-dpd-3",
        "stefan-dpd-4",
        "solidification-square",
        "entry-channel",
        "freezing-channel-085",
        "freezing-channel-086",
        "freezing-channel-087",
        "freezing-channel-088",
        "freezing-channel-089",
        "freezing-channel-090",
        "soil-column",
        "soil-column-printed",
        "soil-column-measured" with ["soil-column-measured-events.csv"],
        "frozen-wall-sand",
        "frozen-wall-clay",
        "frozen-wall-seepage",
        "freezing-row",
        "lining-hydration",
        "manufactured-conduction",
        "manufactured-freezing",
        "cracked-plate",
        "thick-pipe-temperature",
        "thick-pipe-flux",
        "thick-pipe-convection",
        "copper-sphere",
        "freezing-annulus",
        "heated-hollow-cylinder",
        "ice-in-glass",
        "advective-column",
        "column-tracer",
        "column-tracer-pe1000",
        "wetting-column",
        "wetting-column-two-sided",
        "wetting-plane",
        "wetting-plane-closed",
        "absorption-column",
        "infiltration-column",
        "rain-on-dry-ground",
        "hillslope",
        "cracks-fixed",
        "cracks-growing",
        "inclusions-permeable",
        "inclusions-impermeable",
        "random-soil-wetting",
        "random-freezing-strip",
        "thawing-inclusion",
        "frozen-crack",
        "interfrost-th1" with ["interfrost-th1-front.csv"],
        "interfrost-th2-0",
        "interfrost-th2-3",
        "interfrost-th2-9",
        "interfrost-th2-9-codes" with ["interfrost-th2-9-codes-events.csv"],
        "interfrost-th2-15",
        "interfrost-th3-3",
        "interfrost-th3-6",
        "interfrost-th3-9",
        "interfrost-th3-15",
    ]
}

/// Scenes that drive physics and numerics to their edges; each says what must hold.
pub fn extreme() -> &'static [BundledScene] {
    bundled!["extreme":
        "stefan-number-1e-3",
        "stefan-number-1e-2",
        "stefan-number-10",
        "stefan-number-1e3",
        "interval-of-a-microkelvin",
        "no-latent-heat",
        "at-the-freezing-point",
        "conductivity-ratio-1e-4",
        "conductivity-ratio-1e4",
        "capacity-ratio-1e-3",
        "properties-apart",
        "largest-properties",
        "smallest-properties",
        "freeze-thaw-100",
        "jump-of-1000-K",
        "wall-ramp-1e5-K-per-s",
        "film-from-0-to-1e12",
        "a-million-steps",
        "one-particle",
        "two-particles",
        "one-particle-wide",
        "isolated-particles",
        "disorder-10",
        "disorder-30",
        "disorder-50",
        "random-cloud",
        "reach-of-1.5",
        "reach-of-8",
        "hot-pipe",
        "pipes-by-the-hour",
        "insulated-disc",
        "curved-wall-quench",
    ]
}

/// The bundled scene of this name, of either group.
pub fn find(name: &str) -> Option<&'static BundledScene> {
    all().iter().chain(extreme()).find(|scene| scene.name == name)
}
