//! What maps of a run say along lines of its own: around the ring from pipe to pipe, and outwards through the weakest gap.

use std::f64::consts::TAU;

use frazil_core::space::domain::{Domain, Sector};
use frazil_record::{Field, LinkRow, RunResult};
use frazil_scene::{PipeRing, Scene};
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Most samples around a ring.
const MOST: usize = 2000;

/// The wall at the instant of a map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Around {
    /// The instant (s).
    pub time_s: f64,
    /// Mean temperature on the axis plane, through the pipes of the first ring, outside them.
    pub mean_axis_c: Option<f64>,
}

/// Places along a line (degrees or m) and temperatures there.
pub type Line = Vec<(f64, f64)>;

/// What the maps of a run say.
pub(super) struct Mapped {
    /// At each map.
    pub(super) around: Vec<Around>,
    /// The axis plane at the last: degrees.
    pub(super) axis: Line,
    /// The plane through the weakest gap at the last: m from the centre.
    pub(super) weakest_plane: Line,
}

/// The wall at each map of a run, and lines through it at the last.
pub(super) fn around(scene: &Scene, result: &RunResult, weakest: Option<&LinkRow>) -> Mapped {
    let Domain::Ring { sector, .. } = scene.domain else {
        return Mapped { around: Vec::new(), axis: Vec::new(), weakest_plane: Vec::new() };
    };
    let axis = |field: &Field| scene.rings.first().map_or(Vec::new(), |ring| axis(&Map { field, sector }, ring));
    let one = |field: &Field| {
        let free: Vec<f64> = axis(field).iter().filter(|at| !at.inside).map(|at| at.temperature).collect();
        Around {
            time_s: field.time_s,
            mean_axis_c: (!free.is_empty()).then(|| free.iter().sum::<f64>() / free.len() as f64),
        }
    };
    let last = result.fields.last();
    let outwards = |field: &Field| {
        let gap = weakest?;
        Some(outwards(&Map { field, sector }, DVec2::new(gap.x_m, gap.y_m)))
    };
    Mapped {
        around: result.fields.iter().map(one).collect(),
        axis: last.map_or(Vec::new(), axis).iter().map(|at| (at.angle.to_degrees(), at.temperature)).collect(),
        weakest_plane: last.and_then(outwards).unwrap_or_default(),
    }
}

/// A map of a part of the plan.
struct Map<'a> {
    field: &'a Field,
    sector: Sector,
}

impl Map<'_> {
    /// A value at a place of the whole plan, linear between the cells around it; none beyond the map.
    fn at(&self, values: &[f64], place: DVec2) -> Option<f64> {
        let field = self.field;
        // Mirrors bring the place into the part that was run.
        let x = if self.sector == Sector::Quarter { place.x.abs() } else { place.x };
        let y = if self.sector == Sector::Whole { place.y } else { place.y.abs() };
        // Beside an edge of the map, that may be a mirror, its outermost cells hold.
        let along = |from: f64, count: usize| {
            let cells = (from / field.spacing_m).clamp(-0.5, count as f64 - 0.5);
            let inside = cells == from / field.spacing_m;
            let cells = cells.clamp(0.0, count as f64 - 1.0);
            let low = (cells.floor() as usize).min(count.saturating_sub(2));
            inside.then_some((low, (low + 1).min(count - 1), cells - low as f64))
        };
        let (left, right, p) = along(x - field.x0_m, field.nx)?;
        let (below, above, q) = along(y - field.y0_m, field.ny)?;
        let value = |column: usize, row: usize| values.get(row * field.nx + column).copied();
        let row = |row: usize| Some((1.0 - p) * value(left, row)? + p * value(right, row)?);
        Some((1.0 - q) * row(below)? + q * row(above)?).filter(|value| value.is_finite())
    }
}

/// A sample of the axis plane.
struct OnAxis {
    angle: f64,
    temperature: f64,
    /// Whether it lies in a pipe.
    inside: bool,
}

/// Temperatures around a ring. Between two pipes the line goes evenly from the distance of the one from the centre to that of
/// the other, so that it is the circle of an even ring and the way from pipe to pipe of any other.
fn axis(map: &Map<'_>, ring: &PipeRing) -> Vec<OnAxis> {
    let mut pipes: Vec<(f64, f64)> = ring
        .numbers()
        .map(|k| ring.place(k))
        .filter(|place| *place != DVec2::ZERO)
        .map(|place| (place.to_angle().rem_euclid(TAU), place.length()))
        .collect();
    pipes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (pipes.first().copied(), pipes.last().copied()) else { return Vec::new() };
    let radius = pipes.iter().map(|pipe| pipe.1).fold(0.0, f64::max);
    pipes.insert(0, (last.0 - TAU, last.1));
    pipes.push((first.0 + TAU, first.1));
    let count = ((TAU * radius / (0.5 * map.field.spacing_m)).ceil() as usize).clamp(8, MOST);
    let sample = |k: usize| {
        let angle = TAU * k as f64 / count as f64;
        let far = frazil_plots::layouts::between(&pipes, angle)?;
        let place = far * DVec2::from_angle(angle);
        let read = map.at(&map.field.temperature_c, place)?;
        let inside = ring.numbers().any(|k| ring.place(k).distance(place) < ring.pipe_radius);
        // Particles are coarser than pipes; a pipe that is off has the temperature of the ground.
        let pipe =
            ring.condition.temperature().filter(|_| ring.schedule.is_none()).map(|series| series.at(map.field.time_s));
        Some(OnAxis { angle, temperature: pipe.filter(|_| inside).unwrap_or(read), inside })
    };
    (0..=count).filter_map(sample).collect()
}

/// Temperatures outwards through a place, as far as the map reaches; none at the centre.
fn outwards(map: &Map<'_>, through: DVec2) -> Line {
    let Some(direction) = through.try_normalize() else { return Vec::new() };
    let far = |k: usize| 0.5 * map.field.spacing_m * k as f64;
    let read = |k: usize| Some((far(k), map.at(&map.field.temperature_c, far(k) * direction)));
    let reach = map.field.spacing_m * (map.field.nx + map.field.ny) as f64;
    let read = (0..).take_while(|k| far(*k) <= reach).filter_map(read);
    // Ground that was dug out has no temperature.
    read.filter_map(|(far, temperature)| Some((far, temperature?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field that is linear in the quarter is read exactly at any place, by mirrors too.
    #[test]
    fn maps_are_read_between_cells_and_in_mirrors() {
        let (n, spacing) = (40, 0.1);
        let centre = |k: usize| spacing * (k as f64 + 0.5);
        let cells = || (0..n * n).map(|k| DVec2::new(centre(k % n), centre(k / n)));
        let field = Field {
            time_s: 0.0,
            nx: n,
            ny: n,
            x0_m: 0.5 * spacing,
            y0_m: 0.5 * spacing,
            spacing_m: spacing,
            temperature_c: cells().map(|place| place.x + 2.0 * place.y).collect(),
            frozen_fraction: vec![0.0; n * n],
            concentration: Vec::new(),
            temperature_ref_c: Vec::new(),
        };
        let map = Map { field: &field, sector: Sector::Quarter };
        for place in [DVec2::new(1.234, 2.345), DVec2::new(-1.234, 2.345), DVec2::new(-1.234, -2.345)] {
            let value = map.at(&field.temperature_c, place).expect("inside");
            assert!((value - (1.234 + 2.0 * 2.345)).abs() < 1e-12, "{value}");
        }
        assert_eq!(map.at(&field.temperature_c, DVec2::new(4.01, 1.0)), None);
        let line = outwards(&map, DVec2::new(0.0, 0.5));
        assert!(line.iter().all(|(far, temperature)| (temperature - (2.0 * far).max(0.1)).abs() < 0.06), "{line:?}");
    }
}
