//! Scenes as they are given: by a path, a bundled name or a dictionary.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use frazil::load;
use frazil_scene::{Problems, Scene};
use frazil_studies::failure::Failure;
use frazil_studies::parts::Override;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString};
use toml::{Table, Value};

use crate::errors::RunError;
use crate::value;

/// Letters of a name that is made of a title.
const LONGEST: usize = 60;

/// A scene or a study as it was given.
#[derive(Debug, Clone)]
pub enum Source {
    /// A path or a bundled name.
    Named(String),
    /// A dictionary.
    Table {
        /// Name made of its title.
        name: String,
        /// What it says.
        table: Table,
    },
}

impl Source {
    /// What was given.
    ///
    /// # Errors
    /// Where it is neither a path, a name nor a dictionary, or no dictionary of values that a file may have.
    pub fn of(given: &Bound<'_, PyAny>) -> PyResult<Source> {
        if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
            return Ok(Source::Named(given.extract::<PathBuf>()?.to_string_lossy().into_owned()));
        }
        let Ok(mapping) = given.cast::<PyMapping>() else {
            let kind = given.get_type().name()?;
            return Err(PyTypeError::new_err(format!("found {kind}, must be a path, a bundled name or a dictionary")));
        };
        let table = value::table(mapping, "", 0)?;
        let title = table.get("title").and_then(Value::as_str).unwrap_or_default();
        Ok(Source::Table { name: name_of(title), table })
    }

    /// What it is called in requests.
    pub fn name(&self) -> &str {
        match self {
            Source::Named(name) | Source::Table { name, .. } => name,
        }
    }

    /// Its text, as a file would have it, where it is a dictionary.
    ///
    /// # Errors
    /// Where TOML has no words for it.
    pub fn text(&self) -> PyResult<Option<String>> {
        match self {
            Source::Named(_) => Ok(None),
            Source::Table { table, .. } => {
                toml::to_string(table).map(Some).map_err(|error| RunError::new_err(error.to_string()))
            }
        }
    }
}

/// A name of letters, digits and hyphens.
fn name_of(title: &str) -> String {
    let words = title.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let mut name = words.collect::<Vec<_>>().join("-").to_ascii_lowercase();
    name.truncate(LONGEST);
    let name = name.trim_end_matches('-');
    if name.is_empty() { "scene".into() } else { name.into() }
}

/// Scenes as studies ask for them: dictionaries by their names, all others as the commands have them.
#[derive(Debug, Default)]
pub struct Scenes {
    texts: BTreeMap<String, String>,
}

impl Scenes {
    /// With those of some sources that are dictionaries.
    ///
    /// # Errors
    /// Where TOML has no words for one.
    pub fn of(sources: &[Source]) -> PyResult<Scenes> {
        let mut texts = BTreeMap::new();
        for source in sources {
            texts.extend(source.text()?.map(|text| (source.name().to_owned(), text)));
        }
        Ok(Scenes { texts })
    }

    /// A scene by what it is called in a request, with what it was read from.
    ///
    /// # Errors
    /// With what is wrong with it, by its keys.
    pub fn read(&self, name: &str, overrides: &[Override]) -> Result<(Scene, load::Origin), Failure> {
        match self.texts.get(name) {
            Some(text) => {
                // A dictionary lies in no folder: files that it names are looked for where Python works.
                let source = frazil_scene::Source { text, files: load::beside(Path::new("")) };
                let scene = load::text(source, (name, name), overrides).map_err(without_lines)?;
                Ok((scene, (name.to_owned(), text.clone())))
            }
            None => load::read(name, overrides),
        }
    }
}

/// Nobody has seen the lines of the text that a dictionary becomes.
fn without_lines(mut problems: Problems) -> Problems {
    let own = problems.problems.iter_mut().filter(|problem| problem.beside.is_none());
    own.for_each(|problem| problem.line = None);
    problems
}
