//! What is wrong with a scene file, in words and with its place.

use std::cell::RefCell;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use frazil_record::{brief, shown, shown_lines};

use super::schema::Shape;
use crate::files::Files;
use crate::units::Units;

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
    /// The file beside the scene that it is a problem of, as the scene calls it; its keys are columns.
    pub beside: Option<String>,
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
        Problem { key: key.into(), line, set, beside: None, message: message.into() }
    }
}

/// All problems of one scene file, in the order of its lines; those of files beside it, and then of `--set`, come last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problems {
    /// Name of the file as messages show it.
    pub file: String,
    /// The problems; never empty.
    pub problems: Vec<Problem>,
}

/// Problems that are told; of more, their number.
const TOLD: usize = 100;

impl Problems {
    pub(super) fn new(file: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by(|a, b| {
            let order = |problem: &Problem| (problem.set.is_some(), problem.beside.clone(), problem.line);
            order(a).cmp(&order(b))
        });
        problems.dedup();
        Problems { file: file.to_owned(), problems }
    }
}

/// Proof that a problem of the file has been recorded, which nothing else gives. What the reader must have and could not read is
/// this instead, so no value is lost without a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Noted(());

/// A value that the file must have, or the proof that its problem has been recorded.
pub type Read<T> = Result<T, Noted>;

/// A key and the section that it belongs to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct KeyOf {
    /// As an SI scene has it.
    pub(super) key: String,
    /// As a scene without units has it.
    pub(super) base: String,
    /// Path of the section without names and numbers.
    pub(super) section: String,
}

impl KeyOf {
    pub(super) fn written(&self, units: Units) -> &str {
        if units == Units::Si { &self.key } else { &self.base }
    }
}

/// All keys that a file may have, once they are asked for.
type KnownKeys = Box<dyn Fn() -> Arc<[KeyOf]>>;

/// The problems of a file so far. They are only ever added to, or replaced by others that say more.
#[derive(Default)]
pub(super) struct Log {
    problems: RefCell<Vec<Option<Problem>>>,
    /// All keys that the file may have, and where.
    known: RefCell<Option<KnownKeys>>,
    /// All keys that are read, where they are collected.
    asked: Option<RefCell<Vec<KeyOf>>>,
    /// What values of them may be, in the same case.
    shapes: RefCell<Vec<(KeyOf, Shape)>>,
    /// Files that the scene may name.
    files: Files,
    /// Those that were read, as name and text.
    read: RefCell<Vec<(String, String)>>,
}

impl Log {
    /// Says where all keys that the file may have are known from, once one is found that nobody asked for.
    pub(super) fn know(&self, known: impl Fn() -> Arc<[KeyOf]> + 'static) {
        *self.known.borrow_mut() = Some(Box::new(known));
    }

    /// One of a scene that may name these files.
    pub(super) fn beside(files: Files) -> Self {
        Log { files, ..Log::default() }
    }

    /// The text of a file that the scene names, or why it cannot be had.
    pub(super) fn text_of(&self, name: &str) -> Result<String, String> {
        let text = self.files.text(name)?;
        let mut read = self.read.borrow_mut();
        if !read.iter().any(|(known, _)| known == name) {
            read.push((name.to_owned(), text.clone()));
        }
        Ok(text)
    }

    /// Files that were read so far, as name and text.
    pub(super) fn files_read(&self) -> Vec<(String, String)> {
        self.read.borrow().clone()
    }

    /// Whether one of the problems is of a key that is none of these.
    pub(super) fn is_about_others(&self, keys: &[String]) -> bool {
        self.problems.borrow().iter().flatten().any(|problem| !keys.contains(&problem.key))
    }

    /// One that collects keys and knows of none.
    pub(super) fn collecting() -> Self {
        Log { asked: Some(RefCell::default()), ..Log::default() }
    }

    /// All keys that the file may have, and where.
    pub(super) fn every_key(&self) -> Arc<[KeyOf]> {
        self.known.borrow().as_ref().map_or_else(|| Arc::new([]) as Arc<[KeyOf]>, |known| known())
    }

    /// Takes note of keys that a section has been read for.
    pub(super) fn collect(&self, keys: impl FnOnce() -> Vec<KeyOf>) {
        if let Some(asked) = &self.asked {
            asked.borrow_mut().extend(keys());
        }
    }

    /// Takes note of what the value of a key may be.
    pub(super) fn expect(&self, expected: impl FnOnce() -> (KeyOf, Shape)) {
        if self.asked.is_some() {
            self.shapes.borrow_mut().push(expected());
        }
    }

    pub(super) fn into_shapes(self) -> Vec<(KeyOf, Shape)> {
        self.shapes.into_inner()
    }

    pub(super) fn into_asked(self) -> Vec<KeyOf> {
        self.asked.map(RefCell::into_inner).unwrap_or_default()
    }

    pub(super) fn record(&self, problem: Problem) -> Noted {
        self.problems.borrow_mut().push(Some(problem));
        Noted(())
    }

    /// Number of the problem that is recorded next.
    pub(super) fn next(&self) -> usize {
        self.problems.borrow().len()
    }

    /// Records a problem in place of others, by their numbers.
    pub(super) fn replace(&self, others: &[usize], problem: Problem) -> Noted {
        let mut problems = self.problems.borrow_mut();
        for number in others {
            problems[*number] = None;
        }
        problems.push(Some(problem));
        Noted(())
    }

    pub(super) fn into_problems(self) -> Vec<Problem> {
        self.problems.into_inner().into_iter().flatten().collect()
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let own = shown(&self.file);
        for (index, problem) in self.problems.iter().take(TOLD).enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            let beside = problem.beside.as_ref().map(|beside| Path::new(&self.file).with_file_name(beside));
            let file = beside.map_or(own.clone(), |beside| shown(&beside.to_string_lossy()).into_owned().into());
            match (&problem.set, problem.line) {
                (Some(set), _) => {
                    write!(f, "--set {}: ", brief(set))?;
                    // The option already names the key.
                    if set.split('=').next() == Some(problem.key.as_str()) {
                        write!(f, "{}", shown_lines(&problem.message))?;
                        continue;
                    }
                }
                (None, Some(line)) => write!(f, "{file}:{line}: ")?,
                (None, None) => write!(f, "{file}: ")?,
            }
            if !problem.key.is_empty() {
                write!(f, "{}: ", brief(&problem.key))?;
            }
            write!(f, "{}", shown_lines(&problem.message))?;
        }
        match self.problems.len().saturating_sub(TOLD) {
            0 => Ok(()),
            more => write!(f, "\n{own}: {more} more problems"),
        }
    }
}

impl std::error::Error for Problems {}
