//! What a scene is measured against. A kind without keys is a line of the list, one with keys a file beside it.

mod formula;
mod measured;
mod table;

use frazil_core::space::domain::Domain;

use super::section::Section;
use crate::scene::{ReferenceChoice, Scene};

/// What of a scene its reference must know to be read.
pub(super) struct Around<'a> {
    pub(super) domain: Option<&'a Domain>,
    /// Whether the scene is of unsaturated water.
    pub(super) of_water: bool,
}

/// A kind of reference, as scene files ask for it.
pub(super) struct Kind {
    word: &'static str,
    /// Keys beside `kind` that it alone reads.
    keys: &'static [&'static str],
    /// Lines beside which the reader asks for all of them.
    sketch: &'static str,
    read: fn(&mut Section<'_>, &Around<'_>) -> ReferenceChoice,
}

impl Kind {
    const fn plain(word: &'static str, read: fn(&mut Section<'_>, &Around<'_>) -> ReferenceChoice) -> Self {
        Kind { word, keys: &[], sketch: "", read }
    }
}

const KINDS: [Kind; 7] = [
    Kind::plain("exact", exact),
    table::KIND,
    measured::KIND,
    formula::KIND,
    Kind::plain("local", |_, _| ReferenceChoice::Local),
    Kind::plain("auto", |_, _| ReferenceChoice::Auto),
    Kind::plain("none", |_, _| ReferenceChoice::None),
];

/// Sections for which the reader asks for all keys that references have.
pub(super) fn sketches() -> impl Iterator<Item = String> {
    KINDS.iter().map(|kind| format!("[reference]\nkind = \"{}\"\n{}", kind.word, kind.sketch))
}

pub(super) fn reference(root: &mut Section<'_>, around: &Around<'_>) -> ReferenceChoice {
    let Some(mut section) = root.optional_section("reference") else { return ReferenceChoice::Auto };
    let words: Vec<(&str, &Kind)> = KINDS.iter().map(|kind| (kind.word, kind)).collect();
    let Ok(asked) = section.choice("kind", &words) else {
        section.abandon();
        return ReferenceChoice::Auto;
    };
    for other in KINDS.iter().filter(|other| other.word != asked.word) {
        for key in other.keys.iter().filter(|key| !asked.keys.contains(key)) {
            if section.is_set("kind") {
                // Those of the file, which another kind stands in for.
                section.pass_over(key);
            } else {
                section.refuse(*key, &format!("only the kind \"{}\" uses one", other.word));
            }
        }
    }
    (asked.read)(&mut section, around)
}

fn exact(section: &mut Section<'_>, around: &Around<'_>) -> ReferenceChoice {
    let body = match around.domain {
        Some(Domain::Ring { .. }) => Some("a ring"),
        Some(domain) if domain.symmetry().is_some() => Some("a body of shells"),
        _ => None,
    };
    if let Some(body) = body {
        section.problem("kind", format!("found \"exact\", but {body} has no exact solution"));
    }
    ReferenceChoice::Exact
}

/// Takes what was measured into the scene: a run is looked at whenever and wherever a point was measured.
pub(super) fn settle(root: &mut Section<'_>, scene: &mut Scene) {
    if let ReferenceChoice::Measured(points) = &mut scene.reference {
        let points = std::mem::take(points);
        let settled = measured::settle(root, scene, points);
        scene.reference = ReferenceChoice::Measured(settled);
    }
}
