//! What is wrong with a scene file, in words and with its place.

use std::fmt;

/// Where a value was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Place {
    /// Nowhere in particular: the file as a whole.
    File,
    /// A line of the file, counted from 1.
    Line(usize),
    /// An option of the command line, as `KEY=VALUE`.
    Set(String),
}

/// One problem of a scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Path of the key, as `--set` would name it; empty for the file as a whole.
    pub key: String,
    /// Line of the file, counted from 1; absent for what is missing altogether and for `--set`.
    pub line: Option<usize>,
    /// The `KEY=VALUE` of `--set` that brought the value in, if one did.
    pub set: Option<String>,
    /// What was found and what is allowed.
    pub message: String,
}

impl Problem {
    pub(super) fn new(place: &Place, key: impl Into<String>, message: impl Into<String>) -> Self {
        let (line, set) = match place {
            Place::File => (None, None),
            Place::Line(line) => (Some(*line), None),
            Place::Set(text) => (None, Some(text.clone())),
        };
        Problem { key: key.into(), line, set, message: message.into() }
    }
}

/// All problems of one scene file, in the order of its lines; those of `--set` come last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problems {
    /// Name of the file as messages show it.
    pub file: String,
    /// The problems; never empty.
    pub problems: Vec<Problem>,
}

impl Problems {
    pub(super) fn new(file: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| (problem.set.is_some(), problem.line));
        problems.dedup();
        Problems { file: file.to_owned(), problems }
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            match (&problem.set, problem.line) {
                (Some(set), _) => {
                    write!(f, "--set {set}: ")?;
                    // The option already names the key.
                    if set.split('=').next() == Some(problem.key.as_str()) {
                        write!(f, "{}", problem.message)?;
                        continue;
                    }
                }
                (None, Some(line)) => write!(f, "{}:{line}: ", self.file)?,
                (None, None) => write!(f, "{}: ", self.file)?,
            }
            if !problem.key.is_empty() {
                write!(f, "{}: ", problem.key)?;
            }
            write!(f, "{}", problem.message)?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}
