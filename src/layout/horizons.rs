//! Horizons: layers of ground through which the same shaft is sunk, each a plan of its own.

use serde::Deserialize;
use toml::Table;

use super::soils;
use super::study::{Design, literals};
use crate::load::Overrides;

/// Depths that differ by less (m) are the same.
pub(super) const SAME: f64 = 1e-6;

/// A horizon as a study file has it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Entry {
    name: String,
    from_m: f64,
    to_m: f64,
    depth_m: Option<f64>,
    design: Option<Design>,
    soil: Option<String>,
    #[serde(default)]
    set: Table,
}

impl Entry {
    /// Whether it has a design of its own.
    pub(super) fn is_designed(&self) -> bool {
        self.design.is_some()
    }
}

/// A layer of ground and what it changes of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
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
    pub set: Overrides,
}

impl Horizon {
    /// Thickness of the layer (m).
    pub fn thickness(&self) -> f64 {
        self.to - self.from
    }
}

/// Checks horizons against themselves and against the frozen depth of the study.
pub(super) fn read(entries: &[Entry], depth: Option<f64>) -> Result<Vec<Horizon>, String> {
    let mut found: Vec<Horizon> = Vec::new();
    for entry in entries {
        let Entry { name, from_m, to_m, depth_m, design, soil, set } = entry;
        let bad = |message: String| Err(format!("horizon \"{name}\": {message}"));
        if !(*from_m >= 0.0 && to_m > from_m && to_m.is_finite()) {
            return bad(format!("found from_m {from_m}, to_m {to_m}: must be 0 or more, and from above to below"));
        }
        let depth = depth_m.unwrap_or(*to_m);
        if !(depth >= *from_m && depth <= *to_m) {
            return bad(format!("depth_m: found {depth}, must lie in the layer, {from_m} to {to_m}"));
        }
        if found.iter().any(|other| other.name == *name) {
            return bad("found twice".into());
        }
        if let Some(above) = found.last()
            && *from_m < above.to - SAME
        {
            let Horizon { name: other, from, to, .. } = above;
            return if *to_m <= from + SAME {
                bad(format!(
                    "from_m: found {from_m}, must follow \"{other}\", which ends at {to}: horizons go downwards"
                ))
            } else {
                bad(format!("from_m: found {from_m}, overlaps \"{other}\", which ends at {to}"))
            };
        }
        let soil = soils::overrides(soil.as_ref());
        let mut changes = soil.map_err(|message| format!("horizon \"{name}\": {message}"))?;
        changes.extend(literals(set));
        let (name, set) = (name.clone(), changes);
        found.push(Horizon { name, from: *from_m, to: *to_m, depth, design: *design, set });
    }
    let all: f64 = found.iter().map(Horizon::thickness).sum();
    if let Some(depth) = depth.filter(|depth| !found.is_empty() && (depth - all).abs() > SAME) {
        return Err(format!("depth_m: found {depth}, must be {all}, the thickness of all horizons, or be left out"));
    }
    Ok(found)
}
