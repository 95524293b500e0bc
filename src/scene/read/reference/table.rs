//! A bundled table as the reference, by its name.

use super::Kind;
use crate::scene::ReferenceChoice;

pub(super) const KIND: Kind = Kind {
    word: "table",
    keys: &["table"],
    sketch: "",
    read: |section, _| section.text("table").map_or(ReferenceChoice::Auto, ReferenceChoice::Table),
};
