//! Shafts that are dug while the wall is kept frozen: what that does to it.

use frazil_core::space::domain::Domain;
use frazil_plots::page::{Block, Table};
use frazil_record::{Record, WallRow};
use frazil_scene::Scene;
use serde::Serialize;

use super::answers::{DAY, Day};
use super::found::Found;
use super::rows::cell;

/// A row of `shaft.csv`. Thicknesses are those where the wall is weakest, 0 while it is open.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct DugRow<'a> {
    layout: &'a str,
    radius_m: f64,
    dug_days: f64,
    closure_days: Option<f64>,
    reopened_days: Option<f64>,
    /// Whether a closed wall stood when the shaft was dug and from then on to the end.
    closed_while_dug: bool,
    /// On the day of digging.
    thickness_before_m: f64,
    /// Least from the first output after it on.
    thickness_least_m: f64,
    thickness_least_days: f64,
    thickness_end_m: f64,
    /// Inner front at the end.
    inner_end_m: Option<f64>,
    /// Heat through the face over the last interval between outputs, by area of the face.
    face_w_per_m2: f64,
    /// The same by metre of depth, all around.
    face_w_per_m: f64,
    /// Heat through the face since the shaft was dug.
    face_mj_per_m: f64,
}

/// What digging did to a layout; none where no shaft is dug before the end.
pub(super) fn row<'a>(one: &'a Found<'_>) -> Option<DugRow<'a>> {
    let (scene, kept) = (&one.layout.scene, &one.pair.fine);
    let shaft = scene.excavation.as_ref()?;
    let Domain::Ring { sector, .. } = scene.domain else { return None };
    let thickness = |row: &WallRow| row.thickness_weakest_m.unwrap_or(0.0);
    let after = |row: &&WallRow| row.time_s > shaft.start;
    let thin = |a: &&WallRow, b: &&WallRow| thickness(a).total_cmp(&thickness(b));
    let least = kept.walls.iter().filter(after).min_by(thin)?;
    let patch = kept.budget_names.iter().position(|name| name == "shaft")?;
    let images = sector.images() as f64;
    let [.., before, last] = &kept.budget[..] else { return None };
    let rate = images * (last.in_j[patch] - before.in_j[patch]) / (last.time_s - before.time_s.max(shaft.start));
    Some(DugRow {
        layout: &one.layout.name,
        radius_m: shaft.radius,
        dug_days: shaft.start / DAY,
        closure_days: one.fine.closure,
        reopened_days: one.fine.reopening,
        closed_while_dug: beside_open(scene, &kept.record).is_none(),
        thickness_before_m: Day::at(scene, kept, shaft.start).thickness_weakest_m,
        thickness_least_m: thickness(least),
        thickness_least_days: least.time_s / DAY,
        thickness_end_m: kept.walls.last().map_or(0.0, thickness),
        inner_end_m: one.fine.days.last().and_then(|day| day.weakest_m).map(|ends| ends.0),
        face_w_per_m2: rate / (std::f64::consts::TAU * shaft.radius),
        face_w_per_m: rate,
        face_mj_per_m: 1e-6 * images * last.in_j[patch],
    })
}

/// What is wrong where a shaft is dug before the wall has closed, or the wall opens beside it; none where it is closed while the shaft
/// is there, or no shaft is dug before the end.
pub fn beside_open(scene: &Scene, record: &Record) -> Option<String> {
    let (shaft, wall) =
        (scene.excavation.as_ref().filter(|shaft| shaft.start < scene.duration)?, record.wall.as_ref()?);
    let day = |time: f64| format!("day {:.2}", time / DAY);
    let dug = format!("the shaft is excavated on {} ", day(shaft.start));
    let standing =
        wall.standing_s.iter().find(|(from, to)| *from <= shaft.start && to.is_none_or(|to| to > shaft.start));
    let next = wall.standing_s.iter().map(|period| period.0).find(|from| *from > shaft.start);
    match (standing, next, wall.closure_s) {
        (Some((_, None)), ..) => None,
        (Some((_, Some(to))), ..) => Some(format!("{dug}and the wall around it opens on {}", day(*to))),
        (None, _, None) => Some(format!("{dug}within a wall that does not close")),
        (None, Some(from), Some(_)) => Some(format!("{dug}within an open wall, which closes only on {}", day(from))),
        (None, None, Some(_)) => Some(format!("{dug}within a wall that has opened again")),
    }
}

/// The same of a layout.
pub(super) fn warning(one: &Found<'_>) -> Option<String> {
    let said = beside_open(&one.layout.scene, &one.pair.fine.record)?;
    Some(format!("{}: {said}.", one.layout.name))
}

/// The table of the page; none where no shaft is dug.
pub(super) fn block(found: &[Found<'_>]) -> Option<Block> {
    let rows: Vec<DugRow<'_>> = found.iter().filter_map(row).collect();
    if rows.is_empty() {
        return None;
    }
    let heads = [
        "layout",
        "radius (m)",
        "excavated (day)",
        "wall closes (day)",
        "thickness before (m)",
        "least after (m)",
        "on day",
        "at the end (m)",
        "inner front at the end (m)",
        "heat through the face at the end (W/m²)",
        "all around (W/m)",
    ];
    let cells = |row: &DugRow<'_>| {
        vec![
            row.layout.to_owned(),
            row.radius_m.to_string(),
            row.dug_days.to_string(),
            match (row.closed_while_dug, row.reopened_days) {
                (false, Some(opens)) => {
                    format!("{}, OPENS AGAIN on {opens:.2}", cell(row.closure_days, 2, "not closed"))
                }
                (false, None) => format!("{}, NOT IN TIME", cell(row.closure_days, 2, "not closed")),
                (true, _) => cell(row.closure_days, 2, "not closed"),
            },
            format!("{:.2}", row.thickness_before_m),
            format!("{:.2}", row.thickness_least_m),
            format!("{:.1}", row.thickness_least_days),
            format!("{:.2}", row.thickness_end_m),
            cell(row.inner_end_m, 2, "none"),
            format!("{:.1}", row.face_w_per_m2),
            format!("{:.0}", row.face_w_per_m),
        ]
    };
    let table = Table {
        caption: "Thickness at the weakest gap, 0 while the wall is open. Excavated ground is not included; heat through the \
                  face is positive into the ground."
            .into(),
        heads: heads.map(String::from).into(),
        rows: rows.iter().map(cells).collect(),
        words: 1,
        csv: Some("shaft.csv".into()),
    };
    Some(Block { heading: "Excavation of the shaft".into(), tables: vec![table], ..Block::default() })
}
