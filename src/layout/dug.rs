//! Shafts that are dug while the wall is kept frozen: what that does to it.

use frazil_core::record::WallRow;
use frazil_core::scene::Domain;
use frazil_plots::layouts::between;
use frazil_plots::page::{Block, Table};
use serde::Serialize;

use super::Found;
use super::answers::DAY;
use super::report::cell;

/// A row of `shaft.csv`. Thicknesses are those on the interface plane.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct DugRow<'a> {
    layout: &'a str,
    radius_m: f64,
    dug_days: f64,
    closure_days: Option<f64>,
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
    let series: Vec<(f64, f64)> = kept.walls.iter().map(|row| (row.time_s, row.thickness_interface_mean_m)).collect();
    let after = |row: &&WallRow| row.time_s > shaft.start;
    let thin = |a: &&WallRow, b: &&WallRow| a.thickness_interface_mean_m.total_cmp(&b.thickness_interface_mean_m);
    let least = kept.walls.iter().filter(after).min_by(thin)?;
    let door = kept.budget_names.iter().position(|name| name == "shaft")?;
    let images = sector.images() as f64;
    let [.., before, last] = &kept.budget[..] else { return None };
    let rate = images * (last.in_j[door] - before.in_j[door]) / (last.time_s - before.time_s.max(shaft.start));
    Some(DugRow {
        layout: &one.layout.name,
        radius_m: shaft.radius,
        dug_days: shaft.start / DAY,
        closure_days: one.fine.closure,
        thickness_before_m: between(&series, shaft.start).unwrap_or(0.0),
        thickness_least_m: least.thickness_interface_mean_m,
        thickness_least_days: least.time_s / DAY,
        thickness_end_m: kept.walls.last().map_or(0.0, |row| row.thickness_interface_mean_m),
        inner_end_m: one.fine.days.last().and_then(|day| day.inner_m),
        face_w_per_m2: rate / (std::f64::consts::TAU * shaft.radius),
        face_w_per_m: rate,
        face_mj_per_m: 1e-6 * images * last.in_j[door],
    })
}

/// A warning where a shaft is dug before the wall has closed.
pub(super) fn early(one: &Found<'_>) -> Option<String> {
    let found = row(one)?;
    let closes = match found.closure_days {
        Some(day) if day <= found.dug_days => return None,
        Some(day) => format!("closes on day {day:.2} only"),
        None => "does not close".to_owned(),
    };
    Some(format!("{}: the shaft is dug on day {}, but the wall {closes}.", found.layout, found.dug_days))
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
        "dug (day)",
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
            cell(row.closure_days, 2, "not closed"),
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
        caption: "Thickness on planes midway between the places of pipes, mean over the ring. Ground that is dug out counts no \
                  more; heat through the face is positive into the ground."
            .into(),
        heads: heads.map(String::from).into(),
        rows: rows.iter().map(cells).collect(),
        words: 1,
        csv: Some("shaft.csv".into()),
    };
    Some(Block { heading: "The shaft dug inside the wall".into(), tables: vec![table], ..Block::default() })
}
