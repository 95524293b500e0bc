//! Materials by name.

use std::sync::LazyLock;

use toml::{Table, Value};

use super::ground::material;
use super::problem::{Log, Read};
use super::section::Section;
use super::tree;
use crate::units::Units;
use frazil_core::physics::material::Material;

/// A table of each, by kind.
static KNOWN: LazyLock<Table> = LazyLock::new(|| include_str!("../known_materials.toml").parse().unwrap_or_default());

/// Kinds of materials, which are the keys that name one.
const KINDS: [&str; 3] = ["soil", "rock", "metal"];

/// Keys of a material that has no name.
const OTHERS: [&str; 8] = ["frozen", "unfrozen", "freezing", "porosity", "solid", "water", "ice", "groundwater"];

/// Why they have no effect beside one.
const WHOLE: &str = "the name stands for the whole material";

/// Materials of a kind by name, as tables of a scene.
fn of_kind(kind: &str) -> impl Iterator<Item = (&'static String, &'static Value)> {
    KNOWN.get(kind).and_then(Value::as_table).into_iter().flatten()
}

/// The soils that come with the program, as materials of a scene.
pub fn soils() -> Table {
    of_kind("soil").map(|(word, material)| (word.clone(), material.clone())).collect()
}

/// The material that a section names, if it does.
pub(super) fn known(name: &str, section: &mut Section<'_>) -> Option<Read<Material>> {
    let mut named: Option<(&str, Read<&Value>)> = None;
    for kind in KINDS {
        let words: Vec<(&str, &Value)> = of_kind(kind).map(|(word, material)| (word.as_str(), material)).collect();
        if !section.has(kind) {
            // Keys that are not there are asked for all the same, by those who list them.
            let _ = section.optional_choice(kind, &words);
        } else if let Some((other, _)) = &named {
            let _ = section.optional_choice(kind, &words);
            section.problem(kind, format!("found beside \"{other}\", must be only one of them"));
        } else {
            named = Some((kind, section.choice(kind, &words)));
        }
    }
    let (kind, chosen) = named?;
    OTHERS.iter().for_each(|key| section.refuse(*key, WHOLE));
    section.refuse(("density", "kg_per_m3"), WHOLE);
    section.refuse(("permeability", "m2"), WHOLE);
    if section.units() != Units::Si {
        let units = section.units().name();
        let message = format!("found beside units = \"{units}\", needs units = \"si\" for its numbers");
        return Some(Err(section.problem(kind, message)));
    }
    Some(chosen.and_then(|table| read(name, table)))
}

/// A material from its table, in which there is nothing to find fault with.
fn read(name: &str, table: &Value) -> Read<Material> {
    let text = toml::to_string(table).unwrap_or_default();
    let (entries, log) = (tree::parse(&text).unwrap_or_default(), Log::default());
    material(name, &mut Section::root(&entries, &log))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_them_can_be_read() {
        for kind in KINDS {
            assert!(of_kind(kind).count() > 2, "{kind}");
            for (name, table) in of_kind(kind) {
                let material = read(name, table).unwrap_or_else(|_| unreachable!("{kind} {name}"));
                assert_eq!(material.freezes(), kind == "soil", "{name}");
            }
        }
    }
}
