//! What a scene asks of the figures of its runs, as plain data: figures know no scenes.

use frazil_core::space::domain::Domain;
use frazil_plots::FigureOptions;
use frazil_plots::ground_plan::{GroundPlan, ShaftMark, WaterMark};
use frazil_record::Field;
use frazil_scene::Scene;

/// What a scene asks of its figures, maps of these fields among them.
pub fn of(scene: &Scene, maps: &[Field]) -> FigureOptions {
    FigureOptions {
        name: None,
        time_unit: scene.time_unit,
        freezing_point: scene.materials.first().map_or(0.0, |material| material.freezing_point),
        axes: scene.domain.axes(),
        pressures: scene.flow.as_ref().map_or((0.0, 0.0), |flow| flow.pressures()),
        cut: scene.flow.as_ref().and_then(|flow| flow.cut).unwrap_or(0.0),
        plan: plan(scene, maps),
    }
}

/// Pipes, shaft and water; nothing where the body is no plan of a shaft.
fn plan(scene: &Scene, maps: &[Field]) -> GroundPlan {
    let Domain::Ring { .. } = scene.domain else { return GroundPlan::default() };
    GroundPlan {
        pipes: scene.pipes().iter().map(|pipe| (pipe.x, pipe.y, pipe.radius)).collect(),
        shaft: scene.excavation.as_ref().map(|shaft| ShaftMark { radius: shaft.radius, dug: Some(shaft.start) }),
        water: water(scene, maps),
    }
}

/// The water that crosses the ring of a scene, at the start and at the instants of maps.
pub fn water(scene: &Scene, maps: &[Field]) -> Option<WaterMark> {
    let flow = scene.flow.as_ref()?;
    let across = flow.across?;
    let pressure = &flow.walls.first()?.pressure;
    let permeability = scene.materials.first()?.pores?.permeability?;
    // The outer wall holds the pressure that drives undisturbed water over a radius.
    let by_pressure = permeability / (flow.viscosity * across.radius);
    let mut times: Vec<f64> = [0.0].into_iter().chain(maps.iter().map(|field| field.time_s)).collect();
    times.sort_by(f64::total_cmp);
    let speeds = times.into_iter().map(|time| (time, pressure.at(time) * by_pressure)).collect();
    Some(WaterMark { speeds, direction: (across.direction.x, across.direction.y) })
}
