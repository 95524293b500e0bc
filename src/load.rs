//! From what was typed to a scene and a method of it.

use std::fs;
use std::path::Path;

use frazil_scene::Scene;
use frazil_studies::failure::Failure;

use crate::registry;

/// Reads a scene given by a bundled name or a path.
pub fn scene(argument: &str, overrides: &[(String, String)]) -> Result<Scene, Failure> {
    if let Some(bundled) = frazil_cases::scenes::find(argument) {
        let file = format!("{argument}.toml");
        return Ok(Scene::read(bundled.text, bundled.name, &file, overrides, registry::methods())?);
    }
    if frazil_cases::studies::find(argument).is_some() {
        return Err(no_scene(argument));
    }
    let path = Path::new(argument);
    if !path.exists() && path.extension().is_none() && path.components().count() == 1 {
        return Err(Failure::Request(unknown_scene(argument)));
    }
    let text = fs::read_to_string(path).map_err(|error| Failure::file(path, "cannot be read", error))?;
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    Scene::read(&text, &name, argument, overrides, registry::methods()).map_err(|problems| match Kind::of(&text) {
        Some(Kind::Study) => no_scene(argument),
        _ => problems.into(),
    })
}

fn no_scene(argument: &str) -> Failure {
    Failure::Request(format!("\"{argument}\" is a study of layouts and no scene: frazil layout {argument}"))
}

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
        let table = text.parse::<toml::Table>().ok()?;
        let has = |key| table.contains_key(key);
        match (has("scene"), has("domain") || has("materials") || has("walls")) {
            (true, false) => Some(Kind::Study),
            (false, true) => Some(Kind::Scene),
            _ => None,
        }
    }
}

/// Pairs of key path and value that override a scene.
pub type Overrides = Vec<(String, String)>;

/// What `--paper` stands for on a bundled scene: the method whose discretisation its paper prints, and overrides, with those
/// that were asked for behind them.
pub fn paper(scene: &str, asked: &[String], overrides: Overrides) -> Result<(String, Overrides), Failure> {
    let Some((method, printed)) = frazil_cases::paper::method(scene).zip(frazil_cases::paper::overrides(scene)) else {
        let names: Vec<&str> = frazil_cases::paper::all().iter().map(|printed| printed.name).collect();
        return Err(Failure::Request(format!(
            "--paper: no printed discretisation is bundled for \"{scene}\", there are those of {}",
            names.join(", ")
        )));
    };
    if let Some(other) = asked.iter().find(|other| **other != method) {
        return Err(Failure::Request(format!(
            "--paper: found --method {other}, but the paper of \"{scene}\" prints a discretisation of {method}"
        )));
    }
    Ok((method, [printed, overrides].concat()))
}

/// The method to run: the one named, else the first that the scene has.
pub fn method(scene: &Scene, asked: Option<&str>) -> Result<&'static str, Failure> {
    let names: Vec<&'static str> = scene.methods.iter().map(|settings| settings.method).collect();
    let found = match asked {
        Some(asked) => names.iter().find(|name| **name == asked),
        None => names.first(),
    };
    found.copied().ok_or_else(|| {
        Failure::Request(format!(
            "--method {}: the scene \"{}\" has settings for {}",
            asked.unwrap_or_default(),
            scene.name,
            names.join(", ")
        ))
    })
}

fn unknown_scene(asked: &str) -> String {
    let mut near: Vec<(f64, &str)> = frazil_cases::scenes::all()
        .iter()
        .chain(frazil_cases::scenes::extreme())
        .map(|scene| (strsim::jaro_winkler(asked, scene.name), scene.name))
        .filter(|(likeness, _)| *likeness > 0.75)
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    let near: Vec<String> = near.iter().take(3).map(|(_, name)| format!("\"{name}\"")).collect();
    if near.is_empty() {
        format!("\"{asked}\" is neither a file nor a bundled scene; frazil list shows the scenes")
    } else {
        format!("\"{asked}\" is neither a file nor a bundled scene, did you mean {}?", near.join(" or "))
    }
}

/// What a scene's file has after overrides at a path, as `pipes.1.temperature_c`.
pub fn value(argument: &str, overrides: &[(String, String)], path: &str) -> Option<toml::Value> {
    // An override of a table holds all that is below it.
    let within = |(key, value): &(String, String)| {
        let rest = path.strip_prefix(key.as_str())?;
        let rest = rest.strip_prefix('.').or(rest.is_empty().then_some(""))?;
        // What is no TOML value is a word.
        let table = format!("value = {value}").parse::<toml::Table>().unwrap_or_default();
        Some(table.get("value").and_then(|value| below(value, rest)).cloned())
    };
    if let Some(found) = overrides.iter().rev().find_map(within) {
        return found;
    }
    let text = match frazil_cases::scenes::find(argument) {
        Some(bundled) => bundled.text.to_owned(),
        None => fs::read_to_string(argument).ok()?,
    };
    // Whatever is wrong with it, reading the scene has told.
    below(&toml::Value::Table(text.parse().ok()?), path).cloned()
}

/// What stands in a value at a path.
fn below<'a>(value: &'a toml::Value, path: &str) -> Option<&'a toml::Value> {
    path.split('.').filter(|part| !part.is_empty()).try_fold(value, |at, part| match at {
        toml::Value::Table(table) => table.get(part),
        toml::Value::Array(items) => items.get(part.parse::<usize>().ok()?.checked_sub(1)?),
        _ => None,
    })
}
