//! A solution that a formula prescribes as the reference.

use super::super::range::temperatures;
use super::super::section::Section;
use super::{Around, Kind};
use crate::scene::ReferenceChoice;

pub(super) const KIND: Kind = Kind {
    word: "formula",
    // In SI scenes and in those without units.
    keys: &["temperature_c", "temperature"],
    sketch: "temperature_c = {}\n",
    read,
};

fn read(section: &mut Section<'_>, around: &Around<'_>) -> ReferenceChoice {
    if around.of_water {
        section.problem("kind", "found \"formula\" in a scene of balance = \"water\", must be of heat");
    }
    let allowed = temperatures(section.units().absolute_zero());
    section.formula_of_all(("temperature", "c"), allowed).map_or(ReferenceChoice::Auto, ReferenceChoice::Formula)
}
