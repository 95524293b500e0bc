//! Strata: layers of ground through which the same shaft is sunk, each a plan of its own.

use frazil_scene::{Change, Range, Read, Section};

use super::goals::Design;
use super::soils;

/// Depths that differ by less (m) are the same.
pub(super) const SAME: f64 = 1e-6;

/// A layer of ground and what it changes of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Stratum {
    /// Name.
    pub name: String,
    /// Where the layer begins (m below the collar).
    pub from: f64,
    /// Where it ends (m below the collar).
    pub to: f64,
    /// Where boreholes are read (m below the collar).
    pub depth: f64,
    /// What a wall must come to here.
    pub design: Option<Design>,
    /// What it changes of the scene.
    pub set: Vec<Change>,
}

impl Stratum {
    /// Thickness of the layer (m).
    pub fn thickness(&self) -> f64 {
        self.to - self.from
    }
}

/// Reads the strata of a study, downwards, and holds them against its frozen depth (m).
pub(super) fn read(root: &mut Section<'_>, depth: Option<f64>) -> Vec<Stratum> {
    root.renamed("horizons", "strata", "a horizon is the reach of peridynamics");
    let sections = root.sections("strata");
    let count = sections.len();
    let mut found: Vec<Stratum> = Vec::with_capacity(count);
    for mut section in sections {
        let Ok(own) = stratum(&mut section) else { continue };
        if found.iter().any(|other| other.name == own.name) {
            section.problem("name", format!("found \"{}\" twice", own.name));
        }
        if let Some(above) = found.last().filter(|above| own.from < above.to - SAME) {
            let message =
                format!("found {}, must be at least {}, where \"{}\" above it ends", own.from, above.to, above.name);
            section.problem(("from", "m"), message);
        }
        found.push(own);
    }
    let all: f64 = found.iter().map(Stratum::thickness).sum();
    let whole = !found.is_empty() && found.len() == count;
    if let Some(depth) = depth.filter(|depth| whole && (depth - all).abs() > SAME) {
        let message = format!("found {depth}, must be {all}, the thickness of all strata, or be left out");
        root.problem(("depth", "m"), message);
    }
    found
}

fn stratum(section: &mut Section<'_>) -> Read<Stratum> {
    let name = section.text("name");
    let from = section.number(("from", "m"), Range::NOT_NEGATIVE);
    let to = section.number(("to", "m"), Range::above(from.unwrap_or(0.0)));
    let within = from.and_then(|from| Ok(Range::between(from, to?)));
    let depth = section.optional_number(("depth", "m"), within.unwrap_or(Range::NOT_NEGATIVE));
    let (design, set) = (Design::read(section), soils::changes(section));
    let to = to?;
    Ok(Stratum { name: name?, from: from?, to, depth: depth.unwrap_or(to), design, set })
}
