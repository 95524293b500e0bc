//! Files to start from: a commented scene, and everything that is bundled.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use frazil_cases::scenes::BundledScene;
use frazil_studies::failure::{Failure, Verdict, answer};

use crate::load::{guess, nearest};

/// What is not to be had.
#[derive(Debug, thiserror::Error)]
enum NoFile {
    #[error("nothing of the name \"{0}\" is bundled{1}")]
    Unknown(String, String),
    #[error("{0}: there is a file of this name already; give another one: frazil new OTHER.toml{1}")]
    Exists(String, String),
}

/// What is bundled under a name, and how it is run.
struct Bundled {
    text: &'static str,
    /// Files that it names, as name and text.
    files: &'static [(&'static str, &'static str)],
    command: &'static str,
}

fn bundled(name: &str) -> Result<Bundled, Failure> {
    let own = |one: &BundledScene, command| Bundled { text: one.text, files: one.files, command };
    let scene = || frazil_cases::scenes::find(name).map(|scene| own(scene, "run"));
    let study = || frazil_cases::studies::find(name).map(|study| own(study, "layout"));
    let fluid = || frazil_cases::fluids::find(name).map(|fluid| own(fluid, "calibrate"));
    scene().or_else(study).or_else(fluid).ok_or_else(|| {
        let all = frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme());
        let all = all.chain(frazil_cases::studies::all()).chain(frazil_cases::fluids::all());
        let near = nearest(name, all.map(|one| one.name));
        Failure::request(NoFile::Unknown(name.to_owned(), guess(&near)))
    })
}

/// Prints what is bundled under a name.
///
/// # Errors
/// Where nothing is.
pub fn show(name: &str) -> Result<Verdict, Failure> {
    answer(bundled(name)?.text)?;
    Ok(Verdict::Done)
}

/// Writes a scene to change: a commented one, or a copy of what is bundled. No file is written over.
///
/// # Errors
/// Where nothing of the name is bundled, or the file is there or cannot be written.
pub fn new(file: Option<&Path>, like: Option<&str>) -> Result<Verdict, Failure> {
    let (text, files, command) = match like {
        None => (frazil_cases::scenes::TEMPLATE.to_owned(), [].as_slice(), "run"),
        Some(name) => {
            let Bundled { text, files, command } = bundled(name)?;
            (format!("# A copy of the bundled \"{name}\".\n{text}"), files, command)
        }
    };
    let own = || PathBuf::from(format!("{}.toml", like.unwrap_or("scene")));
    let path = file.map_or_else(own, Path::to_owned);
    let name = path.display().to_string();
    let beside = |file: &str| path.with_file_name(file);
    let all = files.iter().map(|(file, text)| (beside(file), *text)).chain([(path.clone(), text.as_str())]);
    let like_words = like.map_or(String::new(), |like| format!(" --like {like}"));
    for (path, text) in all {
        let made = OpenOptions::new().write(true).create_new(true).open(&path);
        let written = made.and_then(|mut file| file.write_all(text.as_bytes()));
        written.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => {
                Failure::request(NoFile::Exists(path.display().to_string(), like_words.clone()))
            }
            _ => Failure::file(&path, "cannot be written", error),
        })?;
    }
    let next = match (command, like) {
        ("run", None) => format!("frazil check {name}\n  frazil run {name} --method pd"),
        ("run", _) => format!("frazil check {name}\n  frazil run {name}"),
        (command, _) => format!("frazil {command} {name}"),
    };
    let also: String = files.iter().map(|(file, _)| format!(" and {}", beside(file).display())).collect();
    let are = if files.is_empty() { "is" } else { "are" };
    answer(&format!("{name}{also} {are} written. Next:\n  {next}\n"))?;
    Ok(Verdict::Done)
}
