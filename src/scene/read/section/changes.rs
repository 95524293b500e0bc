//! Values of a section that change a scene, and places that are told of later.

use super::super::problem::{Noted, Place, Problem};
use super::super::tree::{Entry, Node};
use super::{Key, Section};

/// A place in a file of which something may have to be said once its section has been read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spot {
    place: Place,
    key: String,
}

impl Spot {
    /// A problem of what stands there.
    pub fn problem(&self, message: impl Into<String>) -> Problem {
        Problem::new(&self.place, self.key.clone(), message)
    }
}

/// A value that a file gives to a key of a scene, as `--set` would.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// Path of the key, as `pipes.1.count`.
    pub key: String,
    /// The value as TOML.
    pub value: String,
    /// Where it stands.
    pub spot: Spot,
}

impl Section<'_> {
    /// Where a key stands, or the section where the key is not there.
    pub fn spot(&self, key: impl Into<Key>) -> Spot {
        let written = key.into().written(self.units);
        match self.find(&written) {
            Some(entry) => self.spot_at(&entry.place, &written),
            None => self.spot_at(&self.place, ""),
        }
    }

    pub(super) fn spot_at(&self, place: &Place, written: &str) -> Spot {
        Spot { place: place.clone(), key: self.join(written) }
    }

    /// Records a problem that something else has found.
    pub fn record(&mut self, problem: Problem) -> Noted {
        self.log.record(problem)
    }

    /// A table of values by paths of keys, in the order of these, so that a list goes before what is in it; empty where it is
    /// absent.
    pub fn changes(&mut self, key: &'static str) -> Vec<Change> {
        let change = |section: &mut Self, entry: &Entry, path: String| {
            Some(section.change(&entry.key, &entry.node, &entry.place, &path))
        };
        self.by_path(key, change)
    }

    /// A table of lists of such values; empty where it is absent.
    pub fn swept(&mut self, key: &'static str) -> Vec<Vec<Change>> {
        self.by_path(key, |section, entry, path| match &entry.node {
            Node::List(items) if !items.is_empty() => {
                let values = (1..).zip(items).map(|(number, item)| {
                    section.change(&entry.key, &item.node, &item.place, &format!("{path}.{number}"))
                });
                Some(values.collect())
            }
            other => {
                let found = if matches!(other, Node::List(_)) { "an empty list".to_owned() } else { other.found() };
                let message = format!("found {found}, must be a list of at least one value");
                section.note_at(&entry.place, &path, message);
                None
            }
        })
    }

    fn by_path<T>(&mut self, key: &'static str, read: impl Fn(&mut Self, &Entry, String) -> Option<T>) -> Vec<T> {
        let found = self.optional(key.into(), |section, table| match &table.node {
            Node::Table(entries) => {
                let mut entries: Vec<&Entry> = entries.iter().collect();
                entries.sort_by(|a, b| a.key.cmp(&b.key));
                let path = |entry: &Entry| format!("{key}.{}", entry.key);
                Ok(entries.into_iter().filter_map(|entry| read(section, entry, path(entry))).collect())
            }
            other => Err(section.wrong(&table.key, other, "a table of values by keys of the scene")),
        });
        found.unwrap_or_default()
    }

    fn change(&self, key: &str, node: &Node, place: &Place, path: &str) -> Change {
        Change { key: key.to_owned(), value: node.value().to_string(), spot: self.spot_at(place, path) }
    }
}
