//! Files that a key of a section names, and their rows, which are read as sections are.

use frazil_record::quoted;

use super::super::problem::{Log, Place, Read};
use super::super::rows::rows;
use super::super::tree::Entry;
use super::Section;
use crate::units::Units;

impl<'a> Section<'a> {
    /// A row of a table, whose columns are keys.
    pub(in super::super) fn row(entries: &'a [Entry], place: Place, units: Units, log: &'a Log) -> Self {
        Section::new(String::new(), place, entries, units, log)
    }

    /// The name and the text of a file beside the scene.
    pub(in super::super) fn file(&mut self, key: &'static str) -> Read<(String, String)> {
        let name = self.text(key)?;
        match self.log.text_of(&name) {
            Ok(text) => Ok((name, text)),
            Err(reason) => {
                Err(self.problem(key, format!("found {}, must be a file beside the scene: {reason}", quoted(&name))))
            }
        }
    }

    /// What the rows of a file beside the scene give, each read as a section ([`rows`]).
    pub(in super::super) fn rows<T>(
        &mut self,
        text: &str,
        file: &str,
        read: impl FnMut(&mut Section<'_>) -> Option<T>,
    ) -> Read<Vec<T>> {
        rows(text, file, self.units, self.log, read)
    }
}
