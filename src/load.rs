//! From what was typed to a scene and a method of it.

use std::path::Path;

use frazil_layouts::file::Kind;
use frazil_scene::{Files, Problems, Scene, Source};
use frazil_studies::failure::Failure;
use frazil_studies::input;
use frazil_studies::parts::Override;

use crate::registry;

/// What is no scene, or not one that is asked for.
#[derive(Debug, thiserror::Error)]
enum NoScene {
    #[error("\"{0}\" is a layout study, not a scene: frazil layout {0}")]
    Study(String),
    #[error("\"{asked}\" is neither a file nor a bundled scene{}", guess(near))]
    Unknown { asked: String, near: Vec<&'static str> },
    #[error("--paper: no printed discretisation is bundled for \"{asked}\", there are those of {}", known.join(", "))]
    Unprinted { asked: String, known: Vec<&'static str> },
    #[error("--paper: found --method {asked}, but the paper of \"{scene}\" prints a discretisation of {printed}")]
    OtherMethod { asked: String, scene: String, printed: String },
}

/// What may have been meant, at the end of a message.
pub(crate) fn guess(near: &[&str]) -> String {
    match near {
        [] => "; frazil list shows all names".into(),
        near => format!(", did you mean \"{}\"?", near.join("\" or \"")),
    }
}

/// What a scene was read from: its name and its text. The files that it names are with the scene.
pub type Origin = (String, String);

/// Reads a scene given by a bundled name or a path.
pub fn scene(argument: &str, overrides: &[Override]) -> Result<Scene, Failure> {
    Ok(read(argument, overrides)?.0)
}

/// The same, with what it was read from.
pub fn read(argument: &str, overrides: &[Override]) -> Result<(Scene, Origin), Failure> {
    if let Some(bundled) = frazil_cases::scenes::find(argument) {
        let scene = text(bundled, (bundled.name, &format!("{argument}.toml")), overrides)?;
        return Ok((scene, (bundled.name.to_owned(), bundled.text.to_owned())));
    }
    if frazil_cases::studies::find(argument).is_some() {
        return Err(Failure::request(NoScene::Study(argument.to_owned())));
    }
    let path = Path::new(argument);
    if !path.exists() && path.extension().is_none() && path.components().count() == 1 {
        return Err(Failure::request(NoScene::Unknown { asked: argument.to_owned(), near: near(argument) }));
    }
    let own = input::text(path)?;
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    let source = Source { text: &own, files: beside(path.parent().unwrap_or(Path::new(""))) };
    let scene = text(source, (&name, argument), overrides).map_err(|problems| match Kind::of(&own) {
        Some(Kind::Study) => Failure::request(NoScene::Study(argument.to_owned())),
        _ => problems.into(),
    })?;
    Ok((scene, (name, own)))
}

/// The files of a folder, as scenes in it may name them.
pub fn beside(folder: &Path) -> Files {
    let folder = folder.to_owned();
    Files::opened(move |name| input::text(&folder.join(name)).map_err(|failure| failure.to_string()))
}

/// Reads a scene from its text, of a name and from a file as messages show it.
///
/// # Errors
/// With all problems of it.
pub fn text<'a>(
    source: impl Into<Source<'a>>,
    (name, file): (&str, &str),
    overrides: &[Override],
) -> Result<Scene, Problems> {
    Scene::read(source, name, file, overrides, registry::methods())
}

/// What `--paper` stands for on a bundled scene: the method whose discretisation its paper prints, and overrides, with those
/// that were asked for behind them.
pub fn paper(scene: &str, asked: &[String], overrides: Vec<Override>) -> Result<(String, Vec<Override>), Failure> {
    let Some((method, printed)) = frazil_cases::paper::method(scene).zip(frazil_cases::paper::overrides(scene)) else {
        let known = frazil_cases::paper::all().iter().map(|printed| printed.name).collect();
        return Err(Failure::request(NoScene::Unprinted { asked: scene.to_owned(), known }));
    };
    if let Some(other) = asked.iter().find(|other| **other != method) {
        let (asked, scene) = (other.clone(), scene.to_owned());
        return Err(Failure::request(NoScene::OtherMethod { asked, scene, printed: method }));
    }
    Ok((method, [printed, overrides].concat()))
}

/// The bundled scenes whose names are most like one.
fn near(asked: &str) -> Vec<&'static str> {
    let scenes = frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme());
    nearest(asked, scenes.map(|scene| scene.name))
}

/// The names that are most like one, three at most.
pub(crate) fn nearest(asked: &str, names: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let mut near: Vec<(f64, &str)> =
        names.map(|name| (strsim::jaro_winkler(asked, name), name)).filter(|(likeness, _)| *likeness > 0.75).collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    near.into_iter().take(3).map(|(_, name)| name).collect()
}
