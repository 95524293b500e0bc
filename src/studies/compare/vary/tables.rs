//! The runs of a variation as a file: unrounded, a row each.

use std::path::Path;

use serde::Serialize;

use super::{Grid, Measure, Run};
use crate::failure::Failure;
use crate::output::{write_beside, write_rows};

#[derive(Serialize)]
struct Row<'a> {
    scene: &'a str,
    method: &'a str,
    spacing_m: f64,
    key: &'a str,
    ratio: f64,
    reach_m: f64,
    particles: Option<u64>,
    steps: Option<u64>,
    temperature_signed_rel: Option<f64>,
    temperature_rms_rel: Option<f64>,
    front_signed_rel: Option<f64>,
    front_rms_rel: Option<f64>,
    note: &'a str,
}

impl<'a> Row<'a> {
    fn of(grid: &'a Grid, run: &'a Run) -> Self {
        let record = run.result.as_ref().map(|result| &result.record);
        Row {
            scene: &grid.scene.name,
            method: run.method,
            spacing_m: run.spacing,
            key: &grid.key,
            ratio: run.ratio,
            reach_m: run.reach(),
            particles: record.map(|record| record.particles),
            steps: record.map(|record| record.steps),
            temperature_signed_rel: Measure::Temperature.signed(run),
            temperature_rms_rel: Measure::Temperature.rms(run),
            front_signed_rel: Measure::Front.signed(run),
            front_rms_rel: Measure::Front.rms(run),
            note: run.note.as_deref().unwrap_or_default(),
        }
    }
}

/// Writes `vary.csv`.
pub fn write(folder: &Path, grids: &[Grid]) -> Result<(), Failure> {
    let rows: Vec<Row<'_>> = grids.iter().flat_map(|grid| grid.runs.iter().map(|run| Row::of(grid, run))).collect();
    let path = folder.join("vary.csv");
    if !grids.iter().any(|grid| grid.scene.of_water) {
        return write_rows(&path, &rows);
    }
    let of_water: Vec<OfWater> = grids.iter().flat_map(|grid| &grid.runs).map(OfWater::of).collect();
    write_beside(&path, &rows, &of_water)
}

/// What there is of scenes of unsaturated water beside what there is of all.
#[derive(Serialize)]
struct OfWater {
    saturation_signed: Option<f64>,
    saturation_rms: Option<f64>,
}

impl OfWater {
    fn of(run: &Run) -> Self {
        OfWater { saturation_signed: Measure::Saturation.signed(run), saturation_rms: Measure::Saturation.rms(run) }
    }
}
