//! Files of scenes and studies as they stand: which of both one is, and what it has at a key.

use std::path::Path;

use frazil_studies::input;
use frazil_studies::parts::Override;
use toml::{Table, Value};

/// What a file is, by the keys that only one kind has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A scene.
    Scene,
    /// A study of layouts.
    Study,
}

impl Kind {
    /// What a text is, if it is either.
    pub fn of(text: &str) -> Option<Kind> {
        let table = text.parse::<Table>().ok()?;
        let has = |key| table.contains_key(key);
        match (has("scene"), has("domain") || has("materials") || has("walls")) {
            (true, false) => Some(Kind::Study),
            (false, true) => Some(Kind::Scene),
            _ => None,
        }
    }
}

/// What a scene's file has after overrides at a path, as `pipes.1.temperature_c`.
pub(crate) fn value(argument: &str, overrides: &[Override], path: &str) -> Option<Value> {
    // An override of a table holds all that is below it.
    let within = |(key, value): &Override| {
        let rest = path.strip_prefix(key.as_str())?;
        let rest = rest.strip_prefix('.').or(rest.is_empty().then_some(""))?;
        // What is no TOML value is a word.
        let table = format!("value = {value}").parse::<Table>().unwrap_or_default();
        Some(table.get("value").and_then(|value| below(value, rest)).cloned())
    };
    if let Some(found) = overrides.iter().rev().find_map(within) {
        return found;
    }
    let text = match frazil_cases::scenes::find(argument) {
        Some(bundled) => bundled.text.to_owned(),
        None => input::text(Path::new(argument)).ok()?,
    };
    // Whatever is wrong with it, reading the scene has told.
    below(&Value::Table(text.parse().ok()?), path).cloned()
}

/// What stands in a value at a path.
fn below<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').filter(|part| !part.is_empty()).try_fold(value, |at, part| match at {
        Value::Table(table) => table.get(part),
        Value::Array(items) => items.get(part.parse::<usize>().ok()?.checked_sub(1)?),
        _ => None,
    })
}
