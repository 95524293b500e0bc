//! Settings that methods are compared under.

use frazil_scene::Setting;

/// One way of running a method: a standard setting, or the best one with a key changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variant {
    /// What it is called in tables and figures.
    pub name: String,
    /// The key of the method's section that it sets, and the value.
    key: (String, String),
}

impl Variant {
    /// A standard setting.
    pub fn standard(setting: Setting) -> Self {
        let word = match setting {
            Setting::Best => "best",
            Setting::Paper => "paper",
        };
        Variant { name: word.into(), key: ("setting".into(), word.into()) }
    }

    /// The best setting with one key changed.
    pub fn changed(key: &str, value: &str) -> Self {
        Variant { name: format!("{key}={value}"), key: (key.into(), value.into()) }
    }

    /// The key of the method's section that it sets, and the value.
    pub fn key(&self) -> &(String, String) {
        &self.key
    }

    /// Whether it is the best setting as it stands.
    pub fn is_best(&self) -> bool {
        *self == Variant::standard(Setting::Best)
    }
}
