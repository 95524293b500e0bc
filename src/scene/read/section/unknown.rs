//! Keys that nobody asked for.

use std::collections::HashSet;

use super::super::problem::{KeyOf, Log, Problem};
use super::super::range::{all_of, one_of};
use super::super::tree::parse;
use super::{Missing, Section};
use crate::units::Units;

impl Section<'_> {
    /// Tells of keys that belong elsewhere in the file as `read` asks for them in an example that has all sections.
    pub fn know(&mut self, example: &'static str, read: fn(&mut Section<'_>)) {
        let units = self.units;
        self.log.know(move || {
            let log = Log::collecting();
            let entries = parse(example).unwrap_or_default();
            let mut root = Section::root(&entries, &log);
            root.set_units(units);
            read(&mut root);
            drop(root);
            log.into_asked().into()
        });
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
        let mut here: Vec<&str> = Vec::new();
        for asked in &self.asked {
            if !here.contains(&asked.key.as_str()) {
                here.push(&asked.key);
            }
        }
        if key.len() > LONGEST || self.log.next() > MANY {
            return ("unknown key".to_owned(), Vec::new());
        }
        if let Some(meant) = nearest(key, HERE, here.iter().copied(), |known| known) {
            return (format!("unknown key, did you mean \"{meant}\"?"), vec![meant.to_owned()]);
        }
        let known = all_of(here);
        // What is refused here has its reason once it is spelt so.
        if let Some(meant) = nearest(key, HERE, self.refused.iter(), |known| known) {
            return (format!("unknown key, did you mean \"{meant}\"? Known here: {known}"), Vec::new());
        }
        let every = self.log.every_key();
        let elsewhere = every.iter().filter(|known| known.section != section_of(&self.path));
        let message = match nearest(key, ELSEWHERE, elsewhere, |known| known.written(self.units)) {
            Some(known_there) => {
                let place = match known_there.section.as_str() {
                    "" => "the top of the file".to_owned(),
                    section => format!("\"{section}\""),
                };
                match known_there.written(self.units) {
                    same if same == key => format!("unknown key here, it belongs to {place}; known here: {known}"),
                    other => format!("unknown key, did you mean \"{other}\" of {place}? Known here: {known}"),
                }
            }
            None => format!("unknown key, known here: {known}"),
        };
        (message, Vec::new())
    }
}

/// A key that is longer than any there is, and those of a file that has so many problems, are not searched for: none is near, or
/// nobody reads it.
const LONGEST: usize = 100;
const MANY: usize = 1000;

/// One letter in so many may be wrong in a key of this section, and in one of another: there are many of them.
const HERE: usize = 3;
const ELSEWHERE: usize = 5;

/// The key that is nearest to what was written, if one is near.
fn nearest<'k, K: Copy>(
    written: &str,
    letters: usize,
    keys: impl Iterator<Item = K>,
    name: impl Fn(K) -> &'k str,
) -> Option<K> {
    keys.map(|key| (strsim::damerau_levenshtein(written, name(key)), key))
        .filter(|(distance, key)| *distance <= (written.len().max(name(*key).len()) / letters).max(1))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, key)| key)
}

/// The path of a section without names that are free and numbers of lists.
pub(super) fn section_of(path: &str) -> String {
    let free = |(at, part): &(usize, &str)| {
        part.parse::<usize>().is_ok() || (*at == 1 && (path.starts_with("materials.") || path.starts_with("walls.")))
    };
    let kept: Vec<&str> = path.split('.').enumerate().filter(|part| !free(part)).map(|(_, part)| part).collect();
    kept.join(".")
}

impl Drop for Section<'_> {
    fn drop(&mut self) {
        self.log.collect(|| {
            let asked = self.asked.iter().map(|asked| (asked.key.as_str(), asked.base));
            let keys = asked.chain(self.refused.iter().map(|key| (key.as_str(), key.as_str())));
            let section = section_of(&self.path);
            keys.map(|(key, base)| KeyOf { key: key.to_owned(), base: base.to_owned(), section: section.clone() })
                .collect()
        });
        let mut missing = std::mem::take(&mut self.missing);
        if self.abandoned && missing.is_empty() {
            return;
        }
        let known = self.asked.iter().map(|asked| &asked.key).chain(&self.refused).chain(&self.names);
        let known: HashSet<&str> = known.map(String::as_str).collect();
        for entry in self.entries.iter().filter(|entry| !known.contains(entry.key.as_str())) {
            let (message, meant) = self.unknown(&entry.key);
            // A misspelt key is one mistake, not two: it is not missing as well.
            let is_meant = |missing: &mut Missing| missing.instead.iter().any(|key| meant.contains(key));
            let misspelt: Vec<usize> = missing.extract_if(.., is_meant).map(|missing| missing.problem).collect();
            if !self.abandoned || !misspelt.is_empty() {
                self.log.replace(&misspelt, Problem::new(&entry.place, self.join(&entry.key), message));
            }
        }
    }
}
