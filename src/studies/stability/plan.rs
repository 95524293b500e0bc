//! Which columns a study consists of.

use frazil_scene::method::MethodKind;
use frazil_scene::{Scene, Units};
use frazil_simulation::plan;

use super::axis::Axis;
use super::request::StabilityRequest;
use crate::failure::Failure;
use crate::method;
use crate::parts::{Override, Parts};

/// One column of a map that is to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Scene, by path or bundled name.
    pub scene: String,
    /// Method.
    pub method: &'static str,
    /// Axis.
    pub axis: Axis,
    /// Where the column stands on the axis.
    pub value: Option<f64>,
    /// Everything that makes it out of the scene file, the spacing included.
    pub overrides: Vec<Override>,
}

/// All columns of a scene: by axis, then method, then value.
///
/// # Errors
/// Where a method is none.
pub fn jobs(request: &StabilityRequest, parts: &Parts<'_>, name: &str, scene: &Scene) -> Result<Vec<Job>, Failure> {
    method::check(&request.methods, parts.methods)?;
    let wanted: Vec<Axis> = if request.axes.is_empty() {
        Axis::WORDS.iter().map(|(_, axis)| *axis).filter(|axis| *axis != Axis::Own).collect()
    } else {
        request.axes.clone()
    };
    let asked = |kind: &&MethodKind| request.methods.is_empty() || request.methods.iter().any(|own| own == kind.name);
    let mut jobs = Vec::new();
    for axis in wanted {
        for kind in parts.methods.iter().copied().filter(asked) {
            let Some(settings) = scene.method(kind.name) else { continue };
            let spacing = spacing(request, parts, name, scene, kind.name);
            for column in axis.columns(scene, kind, settings, request.values) {
                let overrides = request.overrides.iter().chain(&spacing).chain(&column.overrides).cloned().collect();
                jobs.push(Job { scene: name.into(), method: kind.name, axis, value: column.value, overrides });
            }
        }
    }
    Ok(jobs)
}

/// The coarser spacing of a study, as far as the scene takes it: stability is a matter of steps and particles, and a
/// coarse lattice has as many modes of the shortest wave as it needs.
fn spacing(request: &StabilityRequest, parts: &Parts<'_>, name: &str, scene: &Scene, method: &str) -> Option<Override> {
    let own = scene.method(method)?.numerics.spacing;
    let key = if scene.units == Units::Si { "spacing_m" } else { "spacing" };
    (2..=request.coarsen).rev().find_map(|factor| {
        let spacing = (format!("method.{method}.{key}"), format!("{}", own * f64::from(factor)));
        let overrides: Vec<Override> = request.overrides.iter().chain([&spacing]).cloned().collect();
        let coarse = (parts.scene_at)(name, &overrides).ok()?;
        let reference = super::cell::wall_data(parts, &coarse).ok()?;
        plan::build(&coarse, coarse.method(method)?, reference.as_ref(), 1, super::cell::SEED).ok()?;
        Some(spacing)
    })
}
