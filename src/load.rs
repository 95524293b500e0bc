//! From what was typed to a scene and a method of it.

use std::fs;
use std::path::Path;

use frazil_layouts::file::Kind;
use frazil_scene::Scene;
use frazil_studies::failure::Failure;
use frazil_studies::parts::Override;

use crate::registry;

/// Reads a scene given by a bundled name or a path.
pub fn scene(argument: &str, overrides: &[Override]) -> Result<Scene, Failure> {
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

/// What `--paper` stands for on a bundled scene: the method whose discretisation its paper prints, and overrides, with those
/// that were asked for behind them.
pub fn paper(scene: &str, asked: &[String], overrides: Vec<Override>) -> Result<(String, Vec<Override>), Failure> {
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
