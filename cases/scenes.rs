//! The scenes that come with the program.

/// A scene by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BundledScene {
    /// Short name, as the command line takes it.
    pub name: &'static str,
    /// Text of its file.
    pub text: &'static str,
}

macro_rules! bundled {
    ($($name:literal),* $(,)?) => {
        &[$(BundledScene { name: $name, text: include_str!(concat!("scenes/", $name, ".toml")) }),*]
    };
}

/// All bundled scenes.
pub fn all() -> &'static [BundledScene] {
    const ALL: &[BundledScene] = bundled![
        "stefan-water",
        "stefan-water-mushy",
        "stefan-unit",
        "stefan-dpd-1",
        "stefan-dpd-2",
        "stefan-dpd-3",
        "stefan-dpd-4",
        "soil-column",
        "soil-column-printed",
        "frozen-wall-sand",
        "frozen-wall-clay",
    ];
    ALL
}

/// The bundled scene of this name.
pub fn find(name: &str) -> Option<&'static BundledScene> {
    all().iter().find(|scene| scene.name == name)
}
