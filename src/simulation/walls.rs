//! The walls of a scene.

use std::sync::Arc;

use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::patch::{Boundary, Dug, Patch, Side, WallTemperature};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::wall::{PatchId, WallId};
use frazil_scene::{Scene, WallPart};

use crate::reference::Reference;
use crate::refused::Refused;

/// The walls of a scene with these parts. `exact` is what walls that follow the exact solution ask. `mirrors` sets ghosts behind the
/// walls of a body of shells, which otherwise touch its outermost particles alone.
///
/// # Errors
/// A wall that follows an exact solution where there is none.
pub fn boundary(
    (scene, wall_parts): (&Scene, &[WallPart]),
    model: WallModel,
    exact: Option<Arc<dyn Reference>>,
    mirrors: bool,
) -> Result<Boundary, Refused> {
    let (axis_length, cold_at_end) = scene.freezing_direction().map_or((0.0, false), |d| (d.length, d.from_end));
    let whole = scene.walls.iter().map(|wall| (PatchId::Whole(wall.wall), &wall.condition));
    let parts = wall_parts.iter().enumerate();
    let parts = parts.map(|(k, part)| (PatchId::Part(part.wall, k), &part.condition));
    let face = scene.excavation.iter().map(|shaft| (PatchId::Face, &shaft.condition));
    let falls = |id: PatchId| {
        let pulls = scene.gravity.zip(id.wall());
        pulls.map_or(0.0, |(towards, wall)| -towards.outwards().dot(wall.outwards()))
    };
    let patches: Vec<Patch> = whole
        .chain(parts)
        .chain(face)
        .map(|(id, condition)| {
            let at_end = id.wall().is_some_and(WallId::is_at_end);
            let distance = if at_end == cold_at_end { 0.0 } else { axis_length };
            Patch {
                id,
                condition: condition.clone(),
                layers: matches!(model, WallModel::Naive | WallModel::InnerLayers),
                changes: *condition == Condition::Exact || condition.series().any(Series::changes),
                falls: falls(id),
                exact: exact
                    .clone()
                    .filter(|_| *condition == Condition::Exact)
                    .map(|exact| -> WallTemperature { Arc::new(move |time| exact.temperature(distance, time)) }),
            }
        })
        .collect();
    for patch in &patches {
        if patch.condition == Condition::Exact && patch.exact.as_ref().and_then(|exact| exact(1.0)).is_none() {
            return Err(Refused::NoExact(patch.id));
        }
    }
    let whole = |wall: WallId| patches.iter().position(|patch| patch.id == PatchId::Whole(wall));
    let side = |wall: WallId| match whole(wall) {
        None => Side::Mirror,
        Some(patch) if patches[patch].condition == Condition::Periodic => Side::Periodic,
        Some(patch) => Side::Wall(patch),
    };
    let (sides, curved) = match scene.domain {
        Domain::Line { .. } => ([side(WallId::Left), side(WallId::Right), Side::Mirror, Side::Mirror], None),
        Domain::Rectangle { .. } => {
            ([side(WallId::Left), side(WallId::Right), side(WallId::Bottom), side(WallId::Top)], None)
        }
        Domain::Ring { outer_radius, sector } => {
            let left = if sector == Sector::Quarter { Side::Mirror } else { Side::Curved };
            let bottom = if sector == Sector::Whole { Side::Curved } else { Side::Mirror };
            ([left, Side::Curved, bottom, Side::Curved], whole(WallId::Outer).map(|patch| (patch, outer_radius)))
        }
        Domain::Radial { inner, .. } | Domain::Axial { inner, .. } if mirrors => {
            let left = if inner > 0.0 { side(WallId::Inner) } else { Side::Curved };
            ([left, side(WallId::Outer), side(WallId::Bottom), side(WallId::Top)], None)
        }
        Domain::Radial { .. } | Domain::Axial { .. } => ([Side::Curved; 4], None),
    };
    let first = scene.walls.len();
    let parts = wall_parts.iter().enumerate();
    let parts = parts.map(|(k, part)| (part.wall, part.from, part.to, first + k)).collect();
    let patch = scene.walls.len() + wall_parts.len();
    let dug = scene.excavation.as_ref().map(|shaft| Dug { patch, radius: shaft.radius, start: shaft.start });
    let books_all = mirrors && scene.domain.symmetry().is_some();
    Ok(Boundary { parts, books_all, patches, sides, curved, dug })
}
