//! From columns to what figures show.

use frazil_plots::canvas::Canvas;
use frazil_plots::stability::{
    MapCell, MapColumn, MapPanel, StabilityFigure, StagesCurve, StagesPoint, Upward, stability, super_steps,
};
use frazil_plots::style::number;
use frazil_simulation::march::{BALANCE_TOLERANCE, RANGE_TOLERANCE};

use super::axis::Axis;
use super::execute::{Mapped, RANGE};
use super::super_steps::limit;

/// Methods in the order in which they occur.
fn methods(columns: &[&Mapped]) -> Vec<&'static str> {
    let mut methods = Vec::new();
    for column in columns {
        if !methods.contains(&column.job.method) {
            methods.push(column.job.method);
        }
    }
    methods
}

/// The maps of a scene along one axis; none if no column was found.
pub fn map(title: &str, axis: Axis, columns: &[&Mapped]) -> Option<Canvas> {
    let panel = |method: &&'static str| MapPanel {
        method: (*method).into(),
        columns: columns
            .iter()
            .filter(|mapped| mapped.job.method == *method)
            .map(|mapped| map_column(mapped))
            .collect(),
    };
    let figure = StabilityFigure {
        title: title.into(),
        axis: axis.label().into(),
        upward: Upward::Step,
        range: RANGE,
        range_tolerance: RANGE_TOLERANCE,
        balance_tolerance: BALANCE_TOLERANCE,
        panels: methods(columns).iter().map(panel).collect(),
    };
    columns.iter().any(|mapped| mapped.found.is_ok()).then(|| stability(&figure))
}

fn map_column(mapped: &Mapped) -> MapColumn {
    let name = mapped.job.value.map_or("own".into(), |value| number(value, 3));
    let Ok(column) = &mapped.found else { return MapColumn { name, ..MapColumn::default() } };
    let ladder = &column.ladder;
    let cells = ladder.cells.iter().filter(|cell| cell.mapped);
    MapColumn {
        name,
        cells: cells.map(|cell| MapCell { ratio: cell.ratio, class: cell.class, steps: None }).collect(),
        sharp: Some(column.probe.sharp_over_bound()),
        first_loss: ladder.first_loss.middle(),
        last_exact: ladder.last_exact.middle(),
        divergence: ladder.divergence.middle(),
    }
}

/// Boundaries of RKL2 over its stages; none if no column was found.
pub fn stages(title: &str, columns: &[&Mapped]) -> Option<Canvas> {
    let curve = |method: &&'static str| StagesCurve {
        method: (*method).into(),
        points: columns
            .iter()
            .filter(|mapped| mapped.job.method == *method)
            .filter_map(|mapped| {
                let (stages, column) = (mapped.job.value?, mapped.found.as_ref().ok()?);
                Some(StagesPoint {
                    stages,
                    last_exact: column.ladder.last_exact.middle(),
                    divergence: column.ladder.divergence.middle(),
                    limit: limit(stages as usize) * column.probe.sharp_over_bound(),
                })
            })
            .collect(),
    };
    let curves: Vec<StagesCurve> = methods(columns).iter().map(curve).collect();
    curves.iter().any(|curve| !curve.points.is_empty()).then(|| super_steps(title, &curves))
}
