//! A cursor over one table of a scene file.

mod lists;
mod pipes;

use std::cell::RefCell;
use std::ops::RangeInclusive;

use super::problem::{Place, Problem};
use super::range::{Range, all_of, one_of, unfit};
use super::tree::{Entry, Node};
use crate::scene::Units;

pub use lists::Duration;
pub(super) use pipes::Names;

/// The name of a key. A quantity is given as `("spacing", "m")`: it is written `spacing_m` in SI scenes and
/// `spacing` in scenes without units. A pure number or a word is given as `"horizon_ratio"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
/// reading goes on and all problems are reported at once. Whatever the reader never asked for is an unknown key;
/// that and missing keys are reported when the section is dropped.
///
/// ```
/// # use frazil_core::scene::{Range, Section};
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
    log: &'a RefCell<Vec<Problem>>,
    asked: Vec<Asked>,
    refused: Vec<String>,
    missing: Vec<Missing>,
    abandoned: bool,
}

/// A key that ought to be there.
struct Missing {
    /// The key; empty for the section as a whole.
    key: String,
    /// Keys any of which would have done.
    instead: Vec<String>,
    message: String,
}

impl<'a> Section<'a> {
    pub(super) fn root(entries: &'a [Entry], log: &'a RefCell<Vec<Problem>>) -> Self {
        Section::new(String::new(), Place::File, entries, Units::Si, log)
    }

    fn new(path: String, place: Place, entries: &'a [Entry], units: Units, log: &'a RefCell<Vec<Problem>>) -> Self {
        Section {
            path,
            place,
            entries,
            units,
            temperatures: None,
            log,
            asked: Vec::new(),
            refused: Vec::new(),
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
    pub fn problem(&mut self, key: impl Into<Key>, message: impl Into<String>) {
        let written = key.into().written(self.units);
        self.note(&written, message);
    }

    /// Records a problem of the section as a whole.
    pub fn section_problem(&mut self, message: impl Into<String>) {
        self.log.borrow_mut().push(Problem::new(&self.place, self.path.clone(), message));
    }

    /// Refuses a key that has no effect here, with the reason.
    pub fn refuse(&mut self, key: impl Into<Key>, reason: &str) {
        let written = key.into().written(self.units);
        if self.find(&written).is_some() {
            self.note(&written, format!("has no effect, {reason}"));
        }
        self.refused.push(written);
    }

    /// Requires exactly one of several keys and says which: its index. The caller then reads it.
    pub fn only_one(&mut self, keys: &[Key]) -> Option<usize> {
        let written: Vec<String> = keys.iter().map(|key| key.written(self.units)).collect();
        let found: Vec<usize> = (0..keys.len()).filter(|index| self.ask(keys[*index]).is_some()).collect();
        match found.as_slice() {
            [] => self.miss("", written),
            [first, rest @ ..] => {
                for other in rest {
                    let message = format!("found beside \"{}\", must be only one of them", written[*first]);
                    self.note(&written[*other], message);
                }
            }
        }
        found.first().copied()
    }

    /// Gives up on the section after a problem that leaves its other keys without meaning: they are not reported.
    pub fn abandon(&mut self) {
        self.abandoned = true;
    }

    /// A required number.
    pub fn number(&mut self, key: impl Into<Key>, range: Range) -> Option<f64> {
        let key = key.into();
        let range_text = range.to_string();
        self.required(key, &range_text, |section| section.optional_number(key, range))
    }

    /// A number with a default.
    pub fn number_or(&mut self, key: impl Into<Key>, default: f64, range: Range) -> f64 {
        self.optional_number(key, range).unwrap_or(default)
    }

    /// A number that may be absent.
    pub fn optional_number(&mut self, key: impl Into<Key>, range: Range) -> Option<f64> {
        let entry = self.ask(key.into())?;
        self.check_number(&entry.key, &entry.node, range)
    }

    /// A required number greater than zero.
    pub fn positive(&mut self, key: impl Into<Key>) -> Option<f64> {
        self.number(key, Range::POSITIVE)
    }

    /// A required number from 0 to 1.
    pub fn fraction(&mut self, key: impl Into<Key>) -> Option<f64> {
        self.number(key, Range::FRACTION)
    }

    /// A required integer.
    pub fn integer(&mut self, key: impl Into<Key>, range: RangeInclusive<usize>) -> Option<usize> {
        let key = key.into();
        let allowed = integers(&range);
        self.required(key, &allowed, |section| section.optional_integer(key, range))
    }

    /// An integer with a default.
    pub fn integer_or(&mut self, key: impl Into<Key>, default: usize, range: RangeInclusive<usize>) -> usize {
        self.optional_integer(key, range).unwrap_or(default)
    }

    /// An integer that may be absent.
    pub fn optional_integer(&mut self, key: impl Into<Key>, range: RangeInclusive<usize>) -> Option<usize> {
        let entry = self.ask(key.into())?;
        if let Node::Number(_, _, Some(whole)) = &entry.node
            && let Ok(value) = usize::try_from(*whole)
            && range.contains(&value)
        {
            return Some(value);
        }
        self.wrong(&entry.key, &entry.node, &integers(&range));
        None
    }

    /// A required text that is not empty.
    pub fn text(&mut self, key: impl Into<Key>) -> Option<String> {
        let key = key.into();
        self.required(key, "a text", |section| section.optional_text(key))
    }

    /// A text with a default.
    pub fn text_or(&mut self, key: impl Into<Key>, default: &str) -> String {
        self.optional_text(key).unwrap_or_else(|| default.to_owned())
    }

    /// A text that may be absent.
    pub fn optional_text(&mut self, key: impl Into<Key>) -> Option<String> {
        let entry = self.ask(key.into())?;
        match &entry.node {
            Node::Text(text) if !text.trim().is_empty() => Some(text.clone()),
            other => {
                self.wrong(&entry.key, other, "a text that is not empty");
                None
            }
        }
    }

    /// A required word out of a list, with what each stands for.
    pub fn choice<T: Clone>(&mut self, key: impl Into<Key>, choices: &[(&str, T)]) -> Option<T> {
        let key = key.into();
        let allowed = one_of(choices.iter().map(|(word, _)| *word));
        self.required(key, &allowed, |section| section.optional_choice(key, choices))
    }

    /// A word out of a list, with a default.
    pub fn choice_or<T: Clone>(&mut self, key: impl Into<Key>, choices: &[(&str, T)], default: T) -> T {
        self.optional_choice(key, choices).unwrap_or(default)
    }

    /// A word out of a list, or none.
    pub fn optional_choice<T: Clone>(&mut self, key: impl Into<Key>, choices: &[(&str, T)]) -> Option<T> {
        let entry = self.ask(key.into())?;
        if let Node::Text(text) = &entry.node
            && let Some((_, meaning)) = choices.iter().find(|(word, _)| word == text)
        {
            return Some(meaning.clone());
        }
        self.wrong(&entry.key, &entry.node, &one_of(choices.iter().map(|(word, _)| *word)));
        None
    }

    /// A required `true` or `false`.
    pub fn flag(&mut self, key: impl Into<Key>) -> Option<bool> {
        let key = key.into();
        self.required(key, "true or false", |section| section.optional_flag(key))
    }

    /// `true` or `false`, with a default.
    pub fn flag_or(&mut self, key: impl Into<Key>, default: bool) -> bool {
        self.optional_flag(key).unwrap_or(default)
    }

    /// `true` or `false`, or neither.
    pub fn optional_flag(&mut self, key: impl Into<Key>) -> Option<bool> {
        let entry = self.ask(key.into())?;
        if let Node::Flag(flag) = entry.node {
            return Some(flag);
        }
        self.wrong(&entry.key, &entry.node, "true or false");
        None
    }

    /// `true`, `false` or a word, or none of them.
    pub fn optional_flag_or_word<T: Clone>(
        &mut self,
        key: impl Into<Key>,
        flags: [T; 2],
        (word, meaning): (&str, T),
    ) -> Option<T> {
        let entry = self.ask(key.into())?;
        let [yes, no] = flags;
        match &entry.node {
            Node::Flag(true) => return Some(yes),
            Node::Flag(false) => return Some(no),
            Node::Text(text) if text == word => return Some(meaning),
            _ => {}
        }
        self.wrong(&entry.key, &entry.node, &format!("true, false or \"{word}\""));
        None
    }

    /// A required table.
    pub fn section(&mut self, key: &'static str) -> Option<Section<'a>> {
        self.required(key.into(), "a table", |section| section.optional_section(key))
    }

    /// A table that may be absent.
    pub fn optional_section(&mut self, key: &'static str) -> Option<Section<'a>> {
        let entry = self.ask(key.into())?;
        match &entry.node {
            Node::Table(entries) => Some(self.child(&entry.key, entry.place.clone(), entries)),
            other => {
                self.wrong(&entry.key, other, "a table");
                None
            }
        }
    }

    /// The tables of a list of tables (`[[pipes]]`), or none.
    pub fn sections(&mut self, key: &'static str) -> Vec<Section<'a>> {
        let Some(entry) = self.ask(key.into()) else { return Vec::new() };
        let Node::List(items) = &entry.node else {
            self.wrong(&entry.key, &entry.node, &format!("a list of tables, as [[{key}]]"));
            return Vec::new();
        };
        let mut sections = Vec::with_capacity(items.len());
        for (number, item) in (1..).zip(items) {
            let path = format!("{}.{number}", entry.key);
            match &item.node {
                Node::Table(entries) => sections.push(self.child(&path, item.place.clone(), entries)),
                other => self.note_at(&item.place, &path, format!("found {}, must be a table", other.found())),
            }
        }
        sections
    }

    /// All tables of this section by their names, where the names are free.
    pub fn named_sections(&mut self) -> Vec<(String, Section<'a>)> {
        let mut sections = Vec::new();
        for entry in self.entries {
            self.refused.push(entry.key.clone());
            match &entry.node {
                Node::Table(entries) => {
                    sections.push((entry.key.clone(), self.child(&entry.key, entry.place.clone(), entries)));
                }
                other => self.wrong(&entry.key, other, "a table"),
            }
        }
        sections
    }

    fn child(&self, key: &str, place: Place, entries: &'a [Entry]) -> Section<'a> {
        let mut child = Section::new(self.join(key), place, entries, self.units, self.log);
        child.temperatures = self.temperatures;
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
    fn required<T>(&mut self, key: Key, allowed: &str, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        let written = key.written(self.units);
        if self.find(&written).is_none() {
            self.missing.push(Missing {
                instead: vec![written.clone()],
                key: written,
                message: format!("missing, must be {allowed}"),
            });
        }
        read(self)
    }

    fn miss(&mut self, key: &str, instead: Vec<String>) {
        let message = format!("missing, must be given as {}", one_of(instead.iter().map(String::as_str)));
        self.missing.push(Missing { key: key.to_owned(), instead, message });
    }

    fn check_number(&mut self, key: &str, node: &Node, range: Range) -> Option<f64> {
        match node {
            Node::Number(_, value, _) => {
                let unfit = unfit(*value).map(str::to_owned);
                let wrong = unfit.or((!range.contains(*value)).then(|| range.to_string()));
                if let Some(allowed) = &wrong {
                    self.wrong(key, node, allowed);
                }
                wrong.is_none().then_some(*value)
            }
            other => {
                self.wrong(key, other, "a number");
                None
            }
        }
    }

    fn wrong(&mut self, key: &str, found: &Node, allowed: &str) {
        self.note(key, format!("found {}, must be {allowed}", found.found()));
    }

    /// Records a problem of a key by its name in the file.
    pub(super) fn note(&mut self, written: &str, message: impl Into<String>) {
        let place = self.find(written).map_or_else(|| self.place.clone(), |entry| entry.place.clone());
        self.note_at(&place, written, message);
    }

    fn note_at(&mut self, place: &Place, written: &str, message: impl Into<String>) {
        self.log.borrow_mut().push(Problem::new(place, self.join(written), message));
    }

    /// What is wrong with a key that nobody asked for, and the keys that were meant.
    fn unknown(&self, key: &str) -> (String, Vec<String>) {
        let quantity = self
            .asked
            .iter()
            .filter(|asked| asked.quantity)
            .filter(|asked| key.strip_prefix(asked.base).is_some_and(|rest| rest.is_empty() || rest.starts_with('_')))
            .max_by_key(|asked| asked.base.len());
        if let Some(quantity) = quantity {
            let mut keys: Vec<String> =
                self.asked.iter().filter(|asked| asked.base == quantity.base).map(|asked| asked.key.clone()).collect();
            keys.dedup();
            let allowed = one_of(keys.iter().map(String::as_str));
            let message = match self.units {
                Units::Si => format!("unit missing or not known, must be {allowed}"),
                _ => format!("a scene in \"{}\" units has no units in its keys, must be {allowed}", self.units.name()),
            };
            return (message, keys);
        }
        let near = self
            .asked
            .iter()
            .map(|asked| (strsim::damerau_levenshtein(key, &asked.key), asked))
            .filter(|(distance, asked)| *distance <= (key.len().max(asked.key.len()) / 3).max(1))
            .min_by_key(|(distance, _)| *distance);
        if let Some((_, asked)) = near {
            let message = format!("unknown key, did you mean \"{}\"?", asked.key);
            return (message, vec![asked.key.clone()]);
        }
        let mut keys: Vec<&str> = Vec::new();
        for asked in &self.asked {
            if !keys.contains(&asked.key.as_str()) {
                keys.push(&asked.key);
            }
        }
        (format!("unknown key, known here: {}", all_of(keys)), Vec::new())
    }
}

impl Drop for Section<'_> {
    fn drop(&mut self) {
        if self.abandoned {
            return;
        }
        let mut missing = std::mem::take(&mut self.missing);
        for entry in self.entries {
            if self.asked.iter().any(|asked| asked.key == entry.key) || self.refused.contains(&entry.key) {
                continue;
            }
            let (message, meant) = self.unknown(&entry.key);
            // A misspelt key is one mistake, not two: it is not missing as well.
            missing.retain(|missing| !missing.instead.iter().any(|key| meant.contains(key)));
            self.note(&entry.key, message);
        }
        for Missing { key, message, .. } in missing {
            self.note(&key, message);
        }
    }
}

fn integers(range: &RangeInclusive<usize>) -> String {
    format!("an integer between {} and {}", range.start(), range.end())
}
