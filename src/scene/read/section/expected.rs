//! What the reader says of values before it has seen them, for the schema.

use super::super::problem::KeyOf;
use super::super::schema::Shape;
use super::unknown::section_of;
use super::{Key, Section};
use crate::units::Units;

impl Section<'_> {
    /// Takes note of what the value of a key may be, where that is collected.
    pub(super) fn expect(&mut self, key: impl Into<Key>, shape: impl FnOnce() -> Shape) -> Key {
        let key = key.into();
        self.log.expect(|| (self.key_of(key), shape()));
        key
    }

    pub(super) fn key_of(&self, key: Key) -> KeyOf {
        KeyOf { key: key.written(Units::Si), base: key.base.to_owned(), section: section_of(&self.path) }
    }
}
