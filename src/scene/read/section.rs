//! A cursor over one table of a scene file.

mod changes;
mod expected;
mod files;
mod lists;
mod pipes;
mod tables;
mod unknown;

use std::ops::RangeInclusive;

use frazil_record::{is_hidden, quoted};

use super::formulas::Run;
use super::problem::{Log, Noted, Place, Problem, Read};
use super::range::{Range, one_of, unfit};
use super::schema::Shape;
use super::tree::{Entry, Node};
use crate::units::Units;

pub use changes::{Change, Spot};
pub use lists::Duration;
pub(super) use pipes::Names;
pub use tables::Along;

/// What texts and names are, which go into messages, figures, tables and pages.
const VISIBLE: &str = "of one line, without invisible characters";

/// The name of a key. A quantity is given as `("spacing", "m")`: it is written `spacing_m` in SI scenes and
/// `spacing` in scenes without units. A pure number or a word is given as `"horizon_ratio"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    base: &'static str,
    unit: &'static str,
}

impl Key {
    /// The key as a scene of these units writes it.
    pub fn written(&self, units: Units) -> String {
        if self.unit.is_empty() || units != Units::Si {
            self.base.to_owned()
        } else {
            format!("{}_{}", self.base, self.unit)
        }
    }
}

impl From<&'static str> for Key {
    fn from(base: &'static str) -> Self {
        Key { base, unit: "" }
    }
}

impl From<(&'static str, &'static str)> for Key {
    fn from((base, unit): (&'static str, &'static str)) -> Self {
        Key { base, unit }
    }
}

/// A key that the reader has asked for.
struct Asked {
    key: String,
    base: &'static str,
    /// Whether it is a quantity, so that a foreign suffix is a wrong unit and not a misspelling.
    quantity: bool,
}

/// A cursor over one table of a scene file: it hands out checked values and collects problems.
///
/// Each kind of value comes in three forms: `number` (required), `number_or` (with a default) and
/// `optional_number`. A value that is not allowed becomes a problem of the file and counts as absent, so that
/// reading goes on and all problems are reported at once. What is required is [`Noted`] where it could not be had, which
/// only a recorded problem gives. Whatever the reader never asked for is an unknown key; that is reported when the section is
/// dropped.
///
/// ```
/// # use frazil_scene::{Range, Section};
/// # #[derive(Clone)]
/// # enum Influence { Constant, Triangular }
/// fn read(section: &mut Section<'_>) -> (f64, Influence) {
///     let ratio = section.number_or("horizon_ratio", 3.0, Range::between(1.0, 12.0));
///     let influence = section.choice_or(
///         "influence",
///         &[("constant", Influence::Constant), ("triangular", Influence::Triangular)],
///         Influence::Constant,
///     );
///     (ratio, influence)
/// }
/// ```
pub struct Section<'a> {
    path: String,
    place: Place,
    entries: &'a [Entry],
    units: Units,
    /// Least and greatest temperature that the scene names, once it is known.
    temperatures: Option<(f64, f64)>,
    /// Where and when formulas are evaluated.
    run: Run,
    log: &'a Log,
    asked: Vec<Asked>,
    refused: Vec<String>,
    /// Names that are free, as those of materials.
    names: Vec<String>,
    missing: Vec<Missing>,
    abandoned: bool,
}

/// A key that ought to be there, which has been recorded.
struct Missing {
    /// Keys any of which would have done.
    instead: Vec<String>,
    /// Number of the problem.
    problem: usize,
}

impl<'a> Section<'a> {
    pub(super) fn root(entries: &'a [Entry], log: &'a Log) -> Self {
        Section::new(String::new(), Place::File, entries, Units::Si, log)
    }

    fn new(path: String, place: Place, entries: &'a [Entry], units: Units, log: &'a Log) -> Self {
        Section {
            path,
            place,
            entries,
            units,
            temperatures: None,
            run: Run::default(),
            log,
            asked: Vec::new(),
            refused: Vec::new(),
            names: Vec::new(),
            missing: Vec::new(),
            abandoned: false,
        }
    }

    pub(super) fn set_units(&mut self, units: Units) {
        self.units = units;
    }

    pub(super) fn set_temperatures(&mut self, range: Option<(f64, f64)>) {
        self.temperatures = range;
    }

    /// Least and greatest temperature that the scene names, as far as it is known.
    pub fn temperatures(&self) -> Option<(f64, f64)> {
        self.temperatures
    }

    /// Path of the section, as `method.pd`; empty for the whole file.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Units of the scene.
    pub fn units(&self) -> Units {
        self.units
    }

    /// Whether a key is there, whatever its value.
    pub fn has(&self, key: impl Into<Key>) -> bool {
        let written = key.into().written(self.units);
        self.entries.iter().any(|entry| entry.key == written)
    }

    /// Whether the value of a key comes from the command line.
    pub(super) fn is_set(&self, key: &'static str) -> bool {
        self.find(key).is_some_and(|entry| matches!(entry.place, Place::Set(_)))
    }

    /// Records a problem of a key, or of the section itself where the key is not there.
    pub fn problem(&mut self, key: impl Into<Key>, message: impl Into<String>) -> Noted {
        let written = key.into().written(self.units);
        self.note(&written, message)
    }

    /// Records a problem of the section as a whole.
    pub fn section_problem(&mut self, message: impl Into<String>) -> Noted {
        self.log.record(Problem::new(&self.place, self.path.clone(), message))
    }

    /// Refuses a key that has no effect here, with the reason.
    pub fn refuse(&mut self, key: impl Into<Key>, reason: &str) {
        let written = key.into().written(self.units);
        if self.find(&written).is_some() {
            self.note(&written, format!("has no effect, {reason}"));
        }
        self.refused.push(written);
    }

    /// Passes over a key that has no effect here and is no mistake.
    pub(super) fn pass_over(&mut self, key: &'static str) {
        self.refused.push(key.to_owned());
    }

    /// Refuses a key that has another name now.
    pub fn renamed(&mut self, old: &'static str, new: &str, reason: &str) {
        if self.has(old) {
            self.note(old, format!("is called \"{new}\" now: {reason}"));
        }
        self.refused.push(old.to_owned());
    }

    /// Requires exactly one of several keys and says which: its index. The caller then reads it.
    pub fn only_one(&mut self, keys: &[Key]) -> Read<usize> {
        let written: Vec<String> = keys.iter().map(|key| key.written(self.units)).collect();
        let found: Vec<usize> = (0..keys.len()).filter(|index| self.ask(keys[*index]).is_some()).collect();
        let Some((first, rest)) = found.split_first() else { return Err(self.miss("", written)) };
        for other in rest {
            let message = format!("found beside \"{}\", must be only one of them", written[*first]);
            self.note(&written[*other], message);
        }
        Ok(*first)
    }

    /// Requires any of several keys, which the caller then reads.
    pub fn at_least_one(&mut self, keys: &[Key]) {
        if !keys.iter().any(|key| self.has(*key)) {
            self.miss("", keys.iter().map(|key| key.written(self.units)).collect());
        }
    }

    /// Gives up on the section after a problem that leaves its other keys without meaning: those that nobody asked for are not
    /// reported. What was recorded stays.
    pub fn abandon(&mut self) {
        self.abandoned = true;
    }

    /// A required number.
    pub fn number(&mut self, key: impl Into<Key>, range: Range) -> Read<f64> {
        let key = self.expect(key, || Shape::Number(range));
        self.required(key, &range.to_string(), |section, entry| section.check_number(entry, range))
    }

    /// A number with a default.
    pub fn number_or(&mut self, key: impl Into<Key>, default: f64, range: Range) -> f64 {
        self.optional_number(key, range).unwrap_or(default)
    }

    /// A number that may be absent.
    pub fn optional_number(&mut self, key: impl Into<Key>, range: Range) -> Option<f64> {
        let key = self.expect(key, || Shape::Number(range));
        self.optional(key, |section, entry| section.check_number(entry, range))
    }

    /// A required number greater than zero.
    pub fn positive(&mut self, key: impl Into<Key>) -> Read<f64> {
        self.number(key, Range::POSITIVE)
    }

    /// A required number from 0 to 1.
    pub fn fraction(&mut self, key: impl Into<Key>) -> Read<f64> {
        self.number(key, Range::FRACTION)
    }

    /// A required integer.
    pub fn integer(&mut self, key: impl Into<Key>, range: RangeInclusive<usize>) -> Read<usize> {
        let key = self.expect(key, || Shape::Integer(range.clone()));
        self.required(key, &integers(&range), |section, entry| section.check_integer(entry, &range))
    }

    /// An integer with a default.
    pub fn integer_or(&mut self, key: impl Into<Key>, default: usize, range: RangeInclusive<usize>) -> usize {
        let key = self.expect(key, || Shape::Integer(range.clone()));
        self.optional(key, |section, entry| section.check_integer(entry, &range)).unwrap_or(default)
    }

    /// A required text that is not empty.
    pub fn text(&mut self, key: impl Into<Key>) -> Read<String> {
        let key = self.expect(key, || Shape::Text);
        self.required(key, "a text", Self::check_text)
    }

    /// A text with a default.
    pub fn text_or(&mut self, key: impl Into<Key>, default: &str) -> String {
        self.optional_text(key).unwrap_or_else(|| default.to_owned())
    }

    /// A text that may be absent.
    pub fn optional_text(&mut self, key: impl Into<Key>) -> Option<String> {
        let key = self.expect(key, || Shape::Text);
        self.optional(key, Self::check_text)
    }

    /// A required word out of a list, with what each stands for.
    pub fn choice<T: Clone>(&mut self, key: impl Into<Key>, choices: &[(&str, T)]) -> Read<T> {
        let key = self.expect(key, || Shape::words(choices));
        let allowed = one_of(choices.iter().map(|(word, _)| *word));
        self.required(key, &allowed, |section, entry| section.check_choice(entry, choices))
    }

    /// A word out of a list, with a default.
    pub fn choice_or<T: Clone>(&mut self, key: impl Into<Key>, choices: &[(&str, T)], default: T) -> T {
        self.optional_choice(key, choices).unwrap_or(default)
    }

    /// A word out of a list, or none.
    pub fn optional_choice<T: Clone>(&mut self, key: impl Into<Key>, choices: &[(&str, T)]) -> Option<T> {
        let key = self.expect(key, || Shape::words(choices));
        self.optional(key, |section, entry| section.check_choice(entry, choices))
    }

    /// A required `true` or `false`.
    pub fn flag(&mut self, key: impl Into<Key>) -> Read<bool> {
        let key = self.expect(key, || Shape::Flag);
        self.required(key, "true or false", Self::check_flag)
    }

    /// `true` or `false`, with a default.
    pub fn flag_or(&mut self, key: impl Into<Key>, default: bool) -> bool {
        let key = self.expect(key, || Shape::Flag);
        self.optional(key, Self::check_flag).unwrap_or(default)
    }

    /// `true`, `false` or a word, or none of them.
    pub fn optional_flag_or_word<T: Clone>(
        &mut self,
        key: impl Into<Key>,
        flags: [T; 2],
        (word, meaning): (&str, T),
    ) -> Option<T> {
        let key = self.expect(key, || Shape::FlagOr(word.to_owned()));
        let [yes, no] = flags;
        self.optional(key, |section, entry| match &entry.node {
            Node::Flag(true) => Ok(yes),
            Node::Flag(false) => Ok(no),
            Node::Text(text) if text == word => Ok(meaning),
            other => Err(section.wrong(&entry.key, other, &format!("true, false or \"{word}\""))),
        })
    }

    /// A required table.
    pub fn section(&mut self, key: &'static str) -> Read<Section<'a>> {
        let key = self.expect(key, || Shape::Table);
        self.required(key, "a table", Self::check_section)
    }

    /// A table that may be absent.
    pub fn optional_section(&mut self, key: &'static str) -> Option<Section<'a>> {
        let key = self.expect(key, || Shape::Table);
        self.optional(key, Self::check_section)
    }

    /// All tables of this section by their names, where the names are free.
    pub fn named_sections(&mut self) -> Vec<(String, Section<'a>)> {
        self.log.expect(|| (self.key_of("".into()), Shape::Named));
        let mut sections = Vec::new();
        for entry in self.entries {
            self.names.push(entry.key.clone());
            if entry.key.chars().any(is_hidden) {
                self.note(&entry.key, format!("found {}, must be a name {VISIBLE}", quoted(&entry.key)));
                continue;
            }
            match &entry.node {
                Node::Table(entries) => {
                    sections.push((entry.key.clone(), self.child(&entry.key, entry.place.clone(), entries)));
                }
                other => {
                    self.wrong(&entry.key, other, "a table");
                }
            }
        }
        sections
    }

    fn child(&self, key: &str, place: Place, entries: &'a [Entry]) -> Section<'a> {
        let mut child = Section::new(self.join(key), place, entries, self.units, self.log);
        child.temperatures = self.temperatures;
        child.run = self.run;
        child
    }

    fn join(&self, key: &str) -> String {
        match (self.path.as_str(), key) {
            (path, "") => path.to_owned(),
            ("", key) => key.to_owned(),
            (path, key) => format!("{path}.{key}"),
        }
    }

    fn find(&self, written: &str) -> Option<&'a Entry> {
        self.entries.iter().find(|entry| entry.key == written)
    }

    fn ask(&mut self, key: Key) -> Option<&'a Entry> {
        let written = key.written(self.units);
        let entry = self.find(&written);
        self.asked.push(Asked { key: written, base: key.base, quantity: !key.unit.is_empty() });
        entry
    }

    /// Reads a key that must be there; `allowed` completes "missing, must be ...".
    fn required<T>(&mut self, key: Key, allowed: &str, check: impl FnOnce(&mut Self, &'a Entry) -> Read<T>) -> Read<T> {
        match self.ask(key) {
            Some(entry) => check(self, entry),
            None => {
                let written = key.written(self.units);
                Err(self.missing(&written, vec![written.clone()], format!("missing, must be {allowed}")))
            }
        }
    }

    /// Reads a key that may be absent; a wrong value is recorded and counts as absent.
    fn optional<T>(&mut self, key: Key, check: impl FnOnce(&mut Self, &'a Entry) -> Read<T>) -> Option<T> {
        let entry = self.ask(key)?;
        check(self, entry).ok()
    }

    fn miss(&mut self, key: &str, instead: Vec<String>) -> Noted {
        let message = format!("missing, must be given as {}", one_of(instead.iter().map(String::as_str)));
        self.missing(key, instead, message)
    }

    /// Records that a key is missing, until a misspelt one says more.
    fn missing(&mut self, key: &str, instead: Vec<String>, message: String) -> Noted {
        self.missing.push(Missing { instead, problem: self.log.next() });
        self.note(key, message)
    }

    fn check_number(&mut self, entry: &Entry, range: Range) -> Read<f64> {
        self.check_number_at(&entry.place, &entry.key, &entry.node, range)
    }

    fn check_number_at(&mut self, place: &Place, key: &str, node: &Node, range: Range) -> Read<f64> {
        let allowed = match node {
            Node::Number(_, value, _) => match unfit(*value) {
                Some(allowed) => allowed.to_owned(),
                None if range.contains(*value) => return Ok(*value),
                None => range.to_string(),
            },
            _ => "a number".to_owned(),
        };
        Err(self.note_at(place, key, format!("found {}, must be {allowed}", node.found())))
    }

    fn check_integer(&mut self, entry: &Entry, range: &RangeInclusive<usize>) -> Read<usize> {
        match &entry.node {
            Node::Number(_, _, Some(whole)) => usize::try_from(*whole).ok().filter(|value| range.contains(value)),
            _ => None,
        }
        .ok_or_else(|| self.wrong(&entry.key, &entry.node, &integers(range)))
    }

    fn check_text(&mut self, entry: &Entry) -> Read<String> {
        match &entry.node {
            Node::Text(text) if text.chars().any(is_hidden) => {
                Err(self.wrong(&entry.key, &entry.node, &format!("a text {VISIBLE}")))
            }
            Node::Text(text) if !text.trim().is_empty() => Ok(text.clone()),
            other => Err(self.wrong(&entry.key, other, "a text that is not empty")),
        }
    }

    fn check_choice<T: Clone>(&mut self, entry: &Entry, choices: &[(&str, T)]) -> Read<T> {
        let found = match &entry.node {
            Node::Text(text) => choices.iter().find(|(word, _)| word == text),
            _ => None,
        };
        match found {
            Some((_, meaning)) => Ok(meaning.clone()),
            None => Err(self.wrong(&entry.key, &entry.node, &one_of(choices.iter().map(|(word, _)| *word)))),
        }
    }

    fn check_flag(&mut self, entry: &Entry) -> Read<bool> {
        match entry.node {
            Node::Flag(flag) => Ok(flag),
            _ => Err(self.wrong(&entry.key, &entry.node, "true or false")),
        }
    }

    fn check_section(&mut self, entry: &'a Entry) -> Read<Section<'a>> {
        match &entry.node {
            Node::Table(entries) => Ok(self.child(&entry.key, entry.place.clone(), entries)),
            other => Err(self.wrong(&entry.key, other, "a table")),
        }
    }

    fn wrong(&mut self, key: &str, found: &Node, allowed: &str) -> Noted {
        self.note(key, format!("found {}, must be {allowed}", found.found()))
    }

    /// Records a problem of a key by its name in the file.
    pub(super) fn note(&mut self, written: &str, message: impl Into<String>) -> Noted {
        let place = self.find(written).map_or_else(|| self.place.clone(), |entry| entry.place.clone());
        self.note_at(&place, written, message)
    }

    fn note_at(&mut self, place: &Place, written: &str, message: impl Into<String>) -> Noted {
        self.log.record(Problem::new(place, self.join(written), message))
    }
}

fn integers(range: &RangeInclusive<usize>) -> String {
    format!("an integer between {} and {}", range.start(), range.end())
}
