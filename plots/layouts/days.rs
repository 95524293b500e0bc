//! The plan of each layout day by day, for the page: what is frozen, which gaps are open, where the wall is weakest.
//!
//! The page draws it, so it holds numbers and outlines, no drawing. Numbers are single precision: they are read off a screen.

use std::fmt::Write;

use frazil_record::{FrontLineRow, LinkRow};
use serde::Serialize;

use super::plan::reach;
use super::view::{DAY, LayoutView, ROUNDING};

/// Days of all layouts together, and the fewest of one of many: a page stays below some hundred kB.
const DAYS: usize = 120;
const FEWEST: usize = 6;

/// Outlines are drawn to a part of the plan's radius: well below a pixel of a screen.
const UNITS: f64 = 1500.0;

/// Plans of layouts.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Days {
    /// The layouts.
    layouts: Vec<LayoutDays>,
}

/// A layout.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct LayoutDays {
    name: String,
    /// Radius of what is drawn (m).
    reach_m: f32,
    /// Unit of the outlines (m).
    unit_m: f32,
    /// Pipes: places and radii (m).
    pipes: Vec<[f32; 3]>,
    /// Places of pipes that are missing (m).
    missing: Vec<[f32; 2]>,
    /// Radius of the shaft (m).
    shaft_m: Option<f32>,
    gaps: Vec<Gap>,
    days: Vec<Instant>,
}

/// A gap between two neighbouring pipes.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Gap {
    name: String,
    /// Axes of both pipes (m).
    from: [f32; 2],
    to: [f32; 2],
    /// When it closed.
    closed_day: Option<f32>,
    /// How many others symmetry makes equal to it.
    alike: usize,
}

/// A layout at an instant.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Instant {
    day: f32,
    /// Whether a closed wall stands.
    closed: bool,
    /// Number of the weakest gap, or of the widest open one.
    weakest: Option<usize>,
    /// Frozen length on the least frozen way through the wall (m).
    thickness_m: Option<f32>,
    /// Mean temperature on it.
    mean_c: Option<f32>,
    /// Load of all pipes (W per metre of depth).
    load_w_per_m: Option<f32>,
    /// Outline of what is frozen, as the path of a drawing.
    ground: String,
}

/// Plans of layouts; none where no run has kept its front.
pub fn days(views: &[LayoutView<'_>]) -> Option<Days> {
    let most = (DAYS / views.len().max(1)).max(FEWEST);
    let known = views.iter().filter(|view| !view.result.front_lines.is_empty());
    let layouts: Vec<LayoutDays> = known.map(|view| layout(view, most)).collect();
    (!layouts.is_empty()).then_some(Days { layouts })
}

impl Days {
    /// As JSON that may stand within an element of a page: no letter of it ends one.
    pub(crate) fn json(&self) -> Result<String, crate::PlotError> {
        Ok(serde_json::to_string(self)?.replace('<', "\\u003c"))
    }
}

fn layout(view: &LayoutView<'_>, most: usize) -> LayoutDays {
    let lines = &view.result.front_lines;
    let times: Vec<&[FrontLineRow]> = lines.chunk_by(|a, b| a.time_s == b.time_s).collect();
    let frozen = lines.iter().map(|row| row.x_m.hypot(row.y_m)).fold(0.0, f64::max);
    let reach = frozen.max(reach(view));
    let unit = reach / UNITS;
    let place = |name: &str| {
        let pipe = view.pipes.iter().find(|pipe| pipe.name == name)?;
        Some([pipe.x_m as f32, pipe.y_m as f32])
    };
    let gap = |link: &LinkRow| Gap {
        name: format!("{}–{}", link.from, link.to),
        from: place(&link.from).unwrap_or_default(),
        to: place(&link.to).unwrap_or_default(),
        alike: view.result.links.iter().filter(|other| other.alike == link.alike && link.alike > 0).count().max(1) - 1,
        closed_day: link.closed_s().map(|time| (time / DAY) as f32),
    };
    let stride = times.len().div_ceil(most).max(1);
    // The last is among them.
    let seen = times.iter().rev().step_by(stride).rev();
    LayoutDays {
        name: view.name.clone(),
        reach_m: reach as f32,
        unit_m: unit as f32,
        pipes: view.pipes.iter().map(|pipe| [pipe.x_m as f32, pipe.y_m as f32, pipe.radius_m as f32]).collect(),
        missing: view.missing.iter().map(|(x, y)| [*x as f32, *y as f32]).collect(),
        shaft_m: view.shaft_radius_m.map(|radius| radius as f32),
        gaps: view.result.links.iter().map(gap).collect(),
        days: seen.map(|rows| instant(view, rows, unit)).collect(),
    }
}

fn instant(view: &LayoutView<'_>, rows: &[FrontLineRow], unit: f64) -> Instant {
    let time = rows[0].time_s;
    let is_now = |other: f64| (other - time).abs() <= ROUNDING * time;
    let wall = view.result.walls.iter().find(|row| is_now(row.time_s));
    let way = view.result.planes.iter().find(|row| row.plane == "weakest" && is_now(row.time_s));
    let number = |of: &frazil_record::PlaneRow| {
        let links = &view.result.links;
        links.iter().position(|link| (&link.from, &link.to) == (&of.from, &of.to))
    };
    Instant {
        day: (time / DAY) as f32,
        closed: wall.and_then(|wall| wall.closed).unwrap_or(false),
        weakest: way.and_then(number),
        thickness_m: wall.and_then(|wall| wall.thickness_weakest_m).map(|thickness| thickness as f32),
        mean_c: way.and_then(|way| way.mean_temperature_c).map(|mean| mean as f32),
        load_w_per_m: view.load_at(time).map(|load| load as f32),
        ground: outline(rows, unit),
    }
}

/// Lines as the path of a drawing, in whole units: a move to the first point of each, and steps to all others.
fn outline(rows: &[FrontLineRow], unit: f64) -> String {
    let mut path = String::new();
    for line in rows.chunk_by(|a, b| a.line == b.line) {
        let mut points: Vec<(i64, i64)> =
            line.iter().map(|row| ((row.x_m / unit).round() as i64, (row.y_m / unit).round() as i64)).collect();
        points.dedup();
        let _ = write!(path, "M{} {}", points[0].0, points[0].1);
        for (k, pair) in points.windows(2).enumerate() {
            let (x, y) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            // A letter and a sign part numbers as a space does.
            let before = if k == 0 {
                "l"
            } else if x < 0 {
                ""
            } else {
                " "
            };
            let between = if y < 0 { "" } else { " " };
            let _ = write!(path, "{before}{x}{between}{y}");
        }
        path.push('z');
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_is_drawn_in_steps() {
        let row = |line, x_m, y_m| FrontLineRow { time_s: 1.0, line, x_m, y_m };
        let rows = [row(1, 1.0, 2.0), row(1, 2.0, 1.0), row(1, 2.0, 1.001), row(1, -1.0, 4.0), row(2, -5.0, -5.0)];
        assert_eq!(outline(&rows, 0.5), "M2 4l2-2-6 6zM-10 -10z");
    }
}
