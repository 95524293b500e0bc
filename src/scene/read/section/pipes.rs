//! Values of a section that name pipes of one ring.

use std::fmt;

use super::super::problem::Read;
use super::super::range::Range;
use super::super::tree::{Item, Node};
use super::{Key, Section};
use crate::pipe_name::{NoPipeName, PipeName};

/// Names that the pipes of one ring have.
#[derive(Debug, Clone, Copy)]
pub(in crate::read) struct Names {
    /// Number of the ring, from 0.
    pub(in crate::read) ring: usize,
    /// Its pipes.
    pub(in crate::read) count: usize,
}

impl Names {
    pub(in crate::read) fn of(&self, pipe: usize) -> PipeName {
        PipeName { ring: self.ring, pipe }
    }

    /// Completes "must be ...".
    fn allowed(&self) -> String {
        let (first, last) = (self.of(0), self.of(self.count.saturating_sub(1)));
        if self.count == 1 { format!("\"{first}\"") } else { format!("a name, \"{first}\" to \"{last}\"") }
    }

    /// The pipe that a value names.
    fn read(&self, node: &Node) -> Result<usize, WrongPipe> {
        let old = match node {
            Node::Text(text) => match text.parse::<PipeName>() {
                Ok(PipeName { ring, pipe }) if ring == self.ring && pipe < self.count => return Ok(pipe),
                _ => None,
            },
            Node::Number(_, _, Some(old)) => usize::try_from(*old).ok().filter(|old| *old < self.count),
            _ => None,
        };
        Err(WrongPipe { found: node.found(), allowed: self.allowed(), old: old.map(|old| (old, self.of(old))) })
    }
}

/// A value that names no pipe of a ring.
#[derive(Debug, Clone, PartialEq, Eq)]
struct WrongPipe {
    found: String,
    allowed: String,
    /// The number of a pipe, as files had it that counted pipes of a ring from 0, and its name.
    old: Option<(usize, PipeName)>,
}

impl fmt::Display for WrongPipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found {}, must be {}", self.found, self.allowed)?;
        match &self.old {
            Some((old, name)) => write!(f, ", as in results: the former {old} is \"{name}\""),
            None => Ok(()),
        }
    }
}

impl Section<'_> {
    /// The name of a pipe, which must be there.
    pub fn pipe_name(&mut self, key: impl Into<Key>) -> Read<PipeName> {
        self.required(key.into(), "the name of a pipe, as \"1.10\"", |section, entry| {
            let name = match &entry.node {
                Node::Text(text) => text.parse(),
                _ => Err(NoPipeName),
            };
            name.map_err(|wrong| section.note(&entry.key, format!("found {}, {wrong}", entry.node.found())))
        })
    }

    /// A list of pipes of a ring, none twice; it may be absent.
    pub(in crate::read) fn optional_pipes(&mut self, key: impl Into<Key>, names: Names) -> Option<Vec<usize>> {
        self.optional(key.into(), |section, entry| {
            let Node::List(items) = &entry.node else {
                return Err(section.wrong(&entry.key, &entry.node, "a list of names of pipes"));
            };
            let mut found = Vec::with_capacity(items.len());
            let row = |(number, item)| section.pipe(&format!("{}.{number}", entry.key), item, names, &mut found);
            let rows: Vec<Read<usize>> = (1_usize..).zip(items).map(row).collect();
            rows.into_iter().collect()
        })
    }

    /// A list of pipes of a ring, none twice, each with two numbers, as `[["1.4", 0.1, 0.2]]`; it may be absent.
    pub(in crate::read) fn optional_pipe_points(
        &mut self,
        key: impl Into<Key>,
        names: Names,
    ) -> Option<Vec<(usize, [f64; 2])>> {
        self.optional(key.into(), |section, entry| {
            let Node::List(items) = &entry.node else {
                return Err(section.wrong(&entry.key, &entry.node, "a list of pipes, each with two numbers"));
            };
            let mut found = Vec::with_capacity(items.len());
            let row = |(number, item)| section.pipe_point(&format!("{}.{number}", entry.key), item, names, &mut found);
            let rows: Vec<Read<(usize, [f64; 2])>> = (1_usize..).zip(items).map(row).collect();
            rows.into_iter().collect()
        })
    }

    fn pipe_point(&mut self, path: &str, item: &Item, names: Names, found: &mut Vec<usize>) -> Read<(usize, [f64; 2])> {
        let row = match &item.node {
            Node::List(row) => row.as_slice(),
            _ => &[],
        };
        let [name, coordinates @ ..] = row else {
            return Err(self.note_at(&item.place, path, r#"must be a pipe with two numbers, as ["1.4", 0.1, 0.2]"#));
        };
        let pipe = self.pipe(&format!("{path}.1"), name, names, found);
        let point = <[f64; 2]>::try_from(self.check_items(path, 2, coordinates, Range::ANY)?).map_err(|point| {
            self.note_at(&item.place, path, format!("found {} coordinates, must be 2", point.len()))
        })?;
        Ok((pipe?, point))
    }

    /// The pipe that an element of a list names, put to those found already.
    fn pipe(&mut self, path: &str, item: &Item, names: Names, found: &mut Vec<usize>) -> Read<usize> {
        let pipe = names.read(&item.node).map_err(|wrong| self.note_at(&item.place, path, wrong.to_string()))?;
        if found.contains(&pipe) {
            return Err(self.note_at(&item.place, path, format!("found {} twice", item.node.found())));
        }
        found.push(pipe);
        Ok(pipe)
    }
}
