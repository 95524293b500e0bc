//! All keys that a scene may have anywhere, as the reader itself asks for them.

use std::sync::{Arc, Mutex, PoisonError};

use super::problem::{KeyOf, Log};
use super::schema::Shape;
use super::section::Section;
use super::{read_root, reference, tree};
use crate::method::MethodKind;
use frazil_core::physics::freezing_curve::{CURVES, CurveKind};
use frazil_core::physics::retention::{RETENTIONS, RetentionKind};

/// Bodies, with a wall of each.
const BODIES: [(&str, &str); 5] = [
    ("line = { length_m = 1 }", "left"),
    ("rectangle = { width_m = 1, height_m = 1 }", "left"),
    ("ring = { outer_radius_m = 1, sector = \"whole\" }", "outer"),
    ("radial = { symmetry = \"axial\", inner_radius_m = 1, outer_radius_m = 2 }", "outer"),
    ("axial = { inner_radius_m = 1, outer_radius_m = 2, height_m = 1 }", "outer"),
];

/// Sections of every kind, each as empty as lets the reader ask for all of it.
const SECTIONS: &str = r#"
[materials.a]
groundwater = {}
[materials.b]
porosity = 0.5
solid = {}
water = {}
ice = {}
freezing = { law = "none" }
[time]
[initial]
temperature_c = {}
[walls.WALL]
temperature_c = {}
parts = [{}, { coefficient_W_per_m2_K = 1 }]
[[regions]]
[[regions]]
circle = {}
[[regions]]
ellipse = {}
[[regions]]
polygon = {}
[[pipes]]
count = 1
ring_radius_m = 0.1
pipe_radius_m = 0.1
temperature_c = 0
[[pipes]]
from_m = {}
[anisotropy]
[random.conductivity]
[random.permeability]
[watch]
[[watch.regions]]
[[watch.regions]]
circle = {}
[[watch.regions]]
ellipse = {}
[[watch.regions]]
polygon = {}
[stream]
reset_m = [0, 1]
"#;

/// Sections that exclude others.
const APART: [&str; 2] = [
    "[excavation]\n[[cracks]]\n[[cracks]]\nlength_m = {}\n[[watch.surfaces]]\n",
    "[flow]\nrelative_permeability = { law = \"power\" }\nwalls.WALL = {}\nwalls.right = {}\n",
];

/// Sections of a scene of unsaturated water.
const WATER: &str = r#"
balance = "water"
[initial]
head_m = {}
[gravity]
[walls.WALL]
concentration = {}
parts = [{}, { concentration = {} }]
[walls.right]
saturation = 1
[[regions]]
"#;

/// Words of a method beside which it has keys of its own.
const NUMERICS: &str = "layout = \"jittered\"\nscheme = \"apparent-capacity\"\nintegrator = \"rkl2\"\nmotion = true\n";

/// Names of methods, and all keys of scenes under them.
type KeysUnder = (Vec<&'static str>, Arc<[KeyOf]>);

/// Keys and where they belong, of a scene under these methods.
pub(super) fn every_key(kinds: &[&'static MethodKind]) -> Arc<[KeyOf]> {
    static KNOWN: Mutex<Vec<KeysUnder>> = Mutex::new(Vec::new());
    let names: Vec<&'static str> = kinds.iter().map(|kind| kind.name).collect();
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, keys)) = known.iter().find(|(other, _)| *other == names) {
        return keys.clone();
    }
    let keys: Arc<[KeyOf]> = asked_for(kinds).into();
    known.push((names, keys.clone()));
    keys
}

fn asked_for(kinds: &[&'static MethodKind]) -> Vec<KeyOf> {
    let mut found: Vec<KeyOf> = texts(kinds).iter().flat_map(|text| log_of(text, kinds).into_asked()).collect();
    found.sort();
    found.dedup();
    found
}

/// What values of all keys may be.
pub(super) fn every_shape(kinds: &[&'static MethodKind]) -> Vec<(KeyOf, Shape)> {
    shapes_of(&texts(kinds), kinds)
}

fn shapes_of(texts: &[String], kinds: &[&'static MethodKind]) -> Vec<(KeyOf, Shape)> {
    texts.iter().flat_map(|text| log_of(text, kinds).into_shapes()).collect()
}

/// Texts of scenes for which the reader asks for everything.
fn texts(kinds: &[&'static MethodKind]) -> Vec<String> {
    let mut texts = Vec::new();
    let methods: String = kinds.iter().map(|kind| format!("[method.{}]\n{NUMERICS}", kind.name)).collect();
    let curve = |kind: &CurveKind| {
        format!("[materials.{0}]\nfrozen = {{}}\nunfrozen = {{}}\nfreezing = {{ law = \"{0}\" }}\n", kind.word)
    };
    let curves: String = CURVES.iter().map(curve).collect();
    for (body, wall) in BODIES {
        for apart in APART {
            let text = format!("domain.{body}\n{SECTIONS}{curves}{apart}{methods}").replace("WALL", wall);
            texts.push(text);
        }
    }
    for reference in reference::sketches() {
        texts.extend(["", "balance = \"water\"\n"].map(|water| format!("{water}{reference}")));
    }
    let soil =
        |kind: &RetentionKind| format!("[materials.{0}]\nsolute = {{}}\nretention = {{ law = \"{0}\" }}\n", kind.word);
    let soils: String = RETENTIONS.iter().map(soil).collect();
    for (body, wall) in BODIES {
        let text = format!("domain.{body}\n{WATER}{soils}").replace("WALL", wall);
        texts.push(text);
    }
    texts
}

/// What the reader asks a text for.
fn log_of(text: &str, kinds: &[&'static MethodKind]) -> Log {
    let log = Log::collecting();
    if let Ok(entries) = tree::parse(text) {
        // Its problems are those of an empty file.
        let _ = read_root(Section::root(&entries, &log), "", kinds);
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::schema::schema;

    #[test]
    fn the_schema_is_of_bodies_of_every_size() {
        let of_size = |size: &str| {
            let sized = |text: &String| text.replace("_m = 1", &format!("_m = {size}")).replace("_m = 2", "_m = 2000");
            schema(shapes_of(&texts(&[]).iter().map(sized).collect::<Vec<_>>(), &[]), &every_key(&[]))
        };
        assert_eq!(of_size("1000"), of_size("1"));
    }
}
