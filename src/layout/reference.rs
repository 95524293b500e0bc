//! Layouts beside reference tables: which table, whether it is about the layout, and how far both lie apart.

use std::f64::consts::PI;

use frazil_cases::layouts::{self, Gap, HEAT_ERROR, LENGTH_ERROR, RADIUS_ERROR, Section, TEMPERATURE_ERROR, WallDay};
use frazil_plots::page::{Block, Table};
use frazil_record::LinkRow;
use frazil_scene::Scene;
use frazil_scene::method::acting_radius;
use frazil_studies::failure::Failure;
use glam::DVec2;
use serde::Serialize;

use super::answers::{DAY, Day, Kept};
use super::found::{Compared, Found};
use super::study::Study;
use super::variants::Layout;
use crate::Overrides;

/// Degrees within which a gap lies where a table has it; they are a tenth of those between gaps of a hundred pipes.
const SAME_ANGLE: f64 = 0.36;

/// The table that a layout names. One that is about another problem is refused, unless overrides of the command made it so.
///
/// # Errors
/// Where it is, or there is no such table.
pub(super) fn table(
    study: &Study<'_>,
    layout: &Layout,
    method: &str,
    set: &Overrides,
) -> Result<Option<Compared>, Failure> {
    let Some(name) = &layout.reference else { return Ok(None) };
    let of = |scene: &Scene| layouts::by_name(name, scene, one_particle(scene, method));
    match of(&layout.scene) {
        Ok(found) => Ok(Some(Compared::With(found))),
        Err(difference) if set.is_empty() => Err(Failure::of("reference", difference)),
        Err(difference) => {
            let mut own = vec![("domain.ring.sector".to_owned(), "whole".to_owned())];
            own.extend(layout.overrides.iter().filter(|one| !set.contains(one)).cloned());
            of(&(study.ground.parts.scene_at)(&study.ground.scene, &own)?)
                .map_err(|difference| Failure::of("reference", difference))?;
            Ok(Some(Compared::Set(difference.to_string())))
        }
    }
}

/// Radius (m) as which pipes of one particle act, where a scene has such.
fn one_particle(scene: &Scene, method: &str) -> Option<f64> {
    let settings = scene.method(method).filter(|_| scene.rings.iter().any(|ring| ring.one_particle))?;
    Some(acting_radius(settings))
}

/// Radius (m) as which the pipes of the first ring act.
pub(super) fn effective_radius(scene: &Scene, method: &str) -> f64 {
    let ring = scene.rings.first();
    let single = ring.filter(|ring| ring.one_particle).and_then(|_| one_particle(scene, method));
    single.or(ring.map(|ring| ring.pipe_radius)).unwrap_or(0.0)
}

/// A number beside that of a table: a row of `reference.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ReferenceRow<'a> {
    layout: &'a str,
    table: &'a str,
    /// Day; none for gaps, whose day is what is told.
    day: Option<f64>,
    quantity: String,
    /// Of gaps the mean over all that are alike.
    found: Option<f64>,
    /// Least and greatest of them.
    found_least: Option<f64>,
    found_greatest: Option<f64>,
    reference: f64,
    difference: Option<f64>,
    difference_percent: Option<f64>,
    reference_error: Option<f64>,
}

/// All numbers of a layout that its table knows.
pub(super) fn rows<'a>(one: &'a Found<'_>) -> Vec<ReferenceRow<'a>> {
    let Some(Compared::With(table)) = &one.reference else { return Vec::new() };
    let (scene, kept) = (&one.layout.scene, &one.pair.fine);
    let row = |day: Option<f64>, quantity: &str, found: Option<f64>, reference: f64, error: Option<f64>| ReferenceRow {
        layout: &one.layout.name,
        table: &table.name,
        day,
        quantity: quantity.to_owned(),
        found,
        found_least: None,
        found_greatest: None,
        reference,
        difference: found.map(|found| found - reference),
        difference_percent: found.filter(|_| reference != 0.0).map(|found| 100.0 * (found / reference - 1.0)),
        reference_error: error,
    };
    let mut rows = Vec::new();
    for closure in &table.closures {
        let days = closing(scene, kept, closure.gap);
        let all: Option<Vec<f64>> = days.iter().map(|(day, _)| *day).collect();
        let weight: usize = days.iter().map(|(_, weight)| weight).sum();
        let mean = all.filter(|all| !all.is_empty()).map(|all| {
            all.iter().zip(&days).map(|(day, (_, weight))| day * *weight as f64).sum::<f64>() / weight as f64
        });
        let extreme = |pick: fn(f64, f64) -> f64| mean.and(days.iter().filter_map(|(day, _)| *day).reduce(pick));
        let own = row(None, &format!("closure_{}_days", closure.gap.name()), mean, closure.day, closure.error);
        rows.push(ReferenceRow { found_least: extreme(f64::min), found_greatest: extreme(f64::max), ..own });
    }
    let end = kept.walls.last().map_or(0.0, |row| row.time_s);
    for known in table.days.iter().filter(|known| known.day * DAY <= end * (1.0 + 1e-12)) {
        let own = Day::at(scene, kept, known.day * DAY);
        for (quantity, found, reference, error) in quantities(scene, &own, known) {
            let Some(reference) = reference else { continue };
            rows.push(row(Some(known.day), quantity, found, reference, Some(error)));
        }
    }
    rows
}

/// Name, what was found, the table's and its error.
fn quantities(scene: &Scene, own: &Day, known: &WallDay) -> [(&'static str, Option<f64>, Option<f64>, f64); 12] {
    let pipes: f64 = scene.rings.iter().map(|ring| ring.count as f64 * PI * ring.pipe_radius * ring.pipe_radius).sum();
    let inner = |section: &Section| section.ends.map(|ends| ends.0);
    let outer = |section: &Section| section.ends.map(|ends| ends.1);
    [
        ("thickness_main_mean_m", own.thickness_main_mean_m, Some(known.main.length), LENGTH_ERROR),
        ("thickness_interface_mean_m", own.thickness_interface_mean_m, Some(known.interface.length), LENGTH_ERROR),
        ("inner_main_m", own.main_m.map(|ends| ends.0), inner(&known.main), RADIUS_ERROR),
        ("outer_main_m", own.main_m.map(|ends| ends.1), outer(&known.main), RADIUS_ERROR),
        ("inner_interface_m", own.interface_m.map(|ends| ends.0), inner(&known.interface), RADIUS_ERROR),
        ("outer_interface_m", own.interface_m.map(|ends| ends.1), outer(&known.interface), RADIUS_ERROR),
        ("mean_main_c", own.mean_main_c, known.main.mean, TEMPERATURE_ERROR),
        ("mean_interface_c", own.mean_interface_c, known.interface.mean, TEMPERATURE_ERROR),
        ("mean_c", own.mean_c, Some(known.mean), TEMPERATURE_ERROR),
        // Fronts are known to 1 cm on either side.
        ("area_m2", Some(own.area_m2 - pipes), Some(known.area), known.area * 2.0 * RADIUS_ERROR / known.main.length),
        (
            "heat_per_pipe_w_per_m",
            Some(own.heat_per_pipe_w_per_m),
            Some(known.heat_per_pipe),
            known.heat_per_pipe * HEAT_ERROR,
        ),
        ("energy_mj_per_m", Some(own.energy_mj_per_m), Some(known.energy), known.energy * HEAT_ERROR),
    ]
}

/// Days on which gaps of a kind close, and for how many each stands.
fn closing(scene: &Scene, kept: &Kept, gap: Gap) -> Vec<(Option<f64>, usize)> {
    if gap == Gap::Touch {
        return kept.gaps.iter().map(|gap| (gap.closure_s.map(|time| time / DAY), gap.multiplicity)).collect();
    }
    let days = |link: &LinkRow| match gap {
        Gap::CircleOuter | Gap::CircleInnerMain | Gap::CircleInnerInterface => link.closure_on_circle_s,
        _ => link.closure_s,
    };
    let alike = kept.links.iter().filter(|link| is_of(scene, link, gap));
    alike.map(|link| (days(link).map(|time| time / DAY), 1)).collect()
}

/// Whether two neighbours are the pipes of a gap of a kind.
fn is_of(scene: &Scene, link: &LinkRow, gap: Gap) -> bool {
    let first = scene.rings.first();
    let spacing = first.map_or(1.0, |ring| 2.0 * PI / ring.count as f64);
    let angle = first.map_or(0.0, |ring| ring.first_angle);
    // From the plane through a pipe of the first ring, in spacings: 0 to 1/2.
    let turns = (link.y_m.atan2(link.x_m) - angle) / spacing;
    let from_main = (turns - turns.round()).abs();
    let ring = |name: &str| name.split('.').next().and_then(|ring| ring.parse::<usize>().ok()).unwrap_or(0);
    let rings = (ring(&link.from), ring(&link.to));
    match gap {
        Gap::Touch | Gap::CircleOuter => rings == (1, 1),
        Gap::CircleInnerMain => rings == (2, 2) && from_main < 0.25,
        Gap::CircleInnerInterface => rings == (2, 2) && from_main > 0.25,
        Gap::Zigzag => rings.0 != rings.1,
        Gap::FromDownstream(degrees) => scene.flow.as_ref().and_then(|flow| flow.across).is_some_and(|across| {
            let own = across.direction.angle_to(DVec2::new(link.x_m, link.y_m)).to_degrees().abs();
            (own - degrees).abs() < SAME_ANGLE
        }),
    }
}

/// When each gap of a layout closes in its table (s); empty without one. What a table knows of the middle of an arc is another thing
/// than when the gap closes.
pub(super) fn of_links(one: &Found<'_>) -> Vec<Option<f64>> {
    let Some(Compared::With(table)) = &one.reference else { return Vec::new() };
    let of = |link: &LinkRow| {
        let tells = |gap: Gap| matches!(gap, Gap::Touch | Gap::Zigzag | Gap::FromDownstream(_));
        let mut closures = table.closures.iter().filter(|closure| tells(closure.gap));
        let known = closures.find(|closure| is_of(&one.layout.scene, link, closure.gap));
        known.map(|closure| closure.day * DAY)
    };
    one.pair.fine.links.iter().map(of).collect()
}

/// What the page says of layouts beside their tables: the greatest differences of each; none where no layout has a table.
pub(super) fn block(found: &[Found<'_>]) -> Option<Block> {
    let mut largest = Vec::new();
    let mut list = Vec::new();
    for one in found {
        if let Some(Compared::Set(difference)) = &one.reference {
            list.push(format!(
                "{}: not compared with its table, because --set changed the problem: {difference}.",
                one.layout.name
            ));
        }
        let rows = rows(one);
        if rows.is_empty() && matches!(&one.reference, Some(Compared::With(_))) {
            list.push(format!("{}: its table does not cover its pipe radius.", one.layout.name));
        }
        for row in rows.iter().filter(|row| row.day.is_none()) {
            largest.push(cells(row, row.quantity.clone(), 2));
        }
        let mut quantities: Vec<&str> =
            rows.iter().filter(|row| row.day.is_some()).map(|row| row.quantity.as_str()).collect();
        quantities.sort_unstable();
        quantities.dedup();
        for quantity in quantities {
            let of = rows.iter().filter(|row| row.quantity == quantity && row.difference.is_some());
            // Flows and heat are judged by their ratio, which is greatest elsewhere than the difference.
            let relative = quantity.contains("_per_m") || quantity == "area_m2";
            let off = |row: &ReferenceRow<'_>| {
                if relative { row.difference_percent } else { row.difference }.map_or(0.0, f64::abs)
            };
            if let Some(row) = of.max_by(|a, b| off(a).total_cmp(&off(b))) {
                let day = row.day.map_or(String::new(), |day| format!(" on day {day:.0}"));
                largest.push(cells(row, format!("{quantity}{day}"), if relative { 1 } else { 2 }));
            }
        }
    }
    if largest.is_empty() && list.is_empty() {
        return None;
    }
    let heads = [
        "layout",
        "quantity",
        "found",
        "least to greatest",
        "reference",
        "difference",
        "difference (%)",
        "reference known to",
    ];
    let tables = if largest.is_empty() {
        Vec::new()
    } else {
        vec![Table {
            caption: "Gaps of each kind, mean over all of it; of other quantities the day with the largest difference, for heat and \
                      area relative."
                .into(),
            heads: heads.map(String::from).into(),
            rows: largest,
            words: 2,
            csv: Some("reference.csv".into()),
        }]
    };
    Some(Block { heading: "Against the reference".into(), tables, list, ..Block::default() })
}

fn cells(row: &ReferenceRow<'_>, quantity: String, digits: usize) -> Vec<String> {
    let plain = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.digits$}"));
    let range = row.found_least.zip(row.found_greatest);
    vec![
        row.layout.to_owned(),
        quantity,
        row.found.map_or_else(|| "none".into(), |found| format!("{found:.digits$}")),
        range.map_or_else(String::new, |(least, greatest)| format!("{least:.digits$} to {greatest:.digits$}")),
        format!("{:.digits$}", row.reference),
        row.difference.map_or_else(String::new, |difference| format!("{difference:+.digits$}")),
        row.difference_percent.map_or_else(String::new, |percent| format!("{percent:+.2}")),
        plain(row.reference_error),
    ]
}
