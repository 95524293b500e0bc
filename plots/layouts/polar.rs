//! Closure of every gap at its place around the ring.

use super::{DAY, LayoutView, backed, dashed_circle, day, wrapped};
use crate::axes::{Entry, legend, nice_step};
use crate::canvas::{Align, Canvas, Stroke, Text};
use crate::style::{GRID, INK, LABEL, Marker, REFERENCE, TICK, number};
use frazil_core::record::LinkRow;

/// Radius of the chart (px).
const RADIUS: f64 = 180.0;

/// Marks of gaps within a ring and between rings.
const MARKS: [(Marker, bool); 5] = [
    (Marker::Circle, false),
    (Marker::Square, true),
    (Marker::Triangle, false),
    (Marker::Diamond, true),
    (Marker::Wedge, false),
];

/// The rings that a gap lies between, as marks tell them.
fn rings(link: &LinkRow) -> String {
    let ring = |name: &str| name.split_once('.').map_or(name, |(ring, _)| ring).to_owned();
    let (a, b) = (ring(&link.from), ring(&link.to));
    if a == b { format!("ring {a}") } else { format!("rings {}–{}", a.clone().min(b.clone()), a.max(b)) }
}

/// Day on which each gap of a layout closed, outwards from the centre, at its angle; the median as a circle.
pub fn gaps_polar(layout: &LayoutView<'_>) -> Canvas {
    const WIDTH: f64 = 500.0;
    let links = &layout.result.links;
    let mut groups: Vec<String> = links.iter().map(rings).collect();
    groups.sort();
    groups.dedup();
    let mut canvas = Canvas::new(WIDTH, 620.0 + 1.5 * LABEL * groups.len().div_ceil(3) as f64, "");
    canvas.title = format!("Closure of the gaps around the ring: {}", layout.name);
    let lines = wrapped(&layout.name, LABEL, true, WIDTH - 48.0);
    for (k, line) in lines.iter().enumerate() {
        canvas.place(Text {
            at: (24.0, 28.0 + 1.25 * LABEL * k as f64),
            text: line.clone(),
            size: LABEL,
            align: Align::Start,
            bold: true,
            upward: false,
            colour: INK,
        });
    }
    let mut days: Vec<f64> = links.iter().filter_map(|link| Some(link.closure_s? / DAY)).collect();
    days.sort_by(f64::total_cmp);
    let end = layout.end_s() / DAY;
    let open = days.len() < links.len();
    let most = days.last().copied().unwrap_or(0.0).max(if open { end } else { 0.0 });
    let step = nice_step(if most > 0.0 { most / 4.0 } else { 0.25 });
    let high = (1.02 * most.max(step) / step).ceil() * step;
    let (cx, cy) = (0.5 * WIDTH, 96.0 + RADIUS);
    let spot = |day: f64, angle: f64| {
        let far = RADIUS * day / high;
        (cx + far * angle.cos(), cy - far * angle.sin())
    };
    let grid = Stroke::whole(GRID, 1.2);
    let ticks = (high / step).round() as usize;
    for k in 0..4 {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(k);
        canvas.line(vec![(cx, cy), spot(high, angle)], grid);
    }
    for k in 1..ticks {
        canvas.ring((cx, cy), RADIUS * k as f64 / ticks as f64, grid);
    }
    canvas.ring((cx, cy), RADIUS, Stroke::whole(INK, 1.3));
    let (side, middle) = (RADIUS + 16.0, 0.36 * TICK);
    canvas.text((cx + side, cy + middle), "x", TICK, Align::Start);
    canvas.text((cx, cy - side + 4.0), "y", TICK, Align::Middle);
    // The days stand on a ruler below, where no mark can cover them.
    let ruler = cy + RADIUS + 26.0;
    let ink = Stroke::whole(INK, 1.3);
    canvas.line(vec![(cx, ruler), (cx + RADIUS, ruler)], ink);
    for k in 0..=ticks {
        let x = cx + RADIUS * k as f64 / ticks as f64;
        canvas.line(vec![(x, ruler - 5.0), (x, ruler + 5.0)], ink);
        canvas.text((x, ruler + 1.5 * TICK), number(k as f64 * step, 3), TICK, Align::Middle);
    }
    canvas.text((cx - 12.0, ruler + middle), "day of closure", LABEL, Align::End);
    let below = ruler + 3.2 * TICK;
    let median = Stroke { colour: REFERENCE, width: 2.0, dash: &[8.0, 5.0] };
    let weakest = layout.weakest();
    if !days.is_empty() {
        dashed_circle(&mut canvas, (cx, cy), RADIUS * median_of(&days) / high, median);
    }
    for link in links {
        let group = groups.iter().position(|group| *group == rings(link)).unwrap_or(0);
        let (marker, hollow) = MARKS[group % MARKS.len()];
        let angle = link.y_m.atan2(link.x_m);
        match link.closure_s {
            Some(time) => canvas.marker(spot(time / DAY, angle), marker, 4.5, INK, hollow),
            None => canvas.cross(spot(high, angle), 6.0, Stroke::whole(INK, 2.4)),
        }
    }
    if let Some(gap) = weakest.filter(|gap| !gap.alike) {
        let angle = gap.link.y_m.atan2(gap.link.x_m);
        let (x, y) = spot(gap.link.closure_s.map_or(high, |time| time / DAY), angle);
        canvas.ring((x, y), 11.0, Stroke::whole(INK, 1.6));
        let (dx, dy) = (-44.0 * angle.cos(), 30.0 * angle.sin());
        backed(&mut canvas, (x + dx, y + dy + middle), &gap.name(), TICK);
    }
    let entries = entries(layout, &groups, &days, median);
    legend(&mut canvas, (24.0, below), WIDTH - 30.0, &entries);
    canvas
}

/// The middle one of sorted values, or the mean of the middle two.
fn median_of(sorted: &[f64]) -> f64 {
    0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2])
}

fn entries(layout: &LayoutView<'_>, groups: &[String], days: &[f64], median: Stroke) -> Vec<Entry> {
    let mark = |(k, group): (usize, &String)| {
        let (marker, hollow) = MARKS[k % MARKS.len()];
        Entry { text: group.clone(), stroke: None, marker: Some((marker, INK, hollow)) }
    };
    let mut entries: Vec<Entry> = groups.iter().enumerate().map(mark).collect();
    if !days.is_empty() {
        let text = format!("median {} d", day(DAY * median_of(days)));
        entries.push(Entry { text, stroke: Some(median), marker: None });
    }
    let note = |text: String| Entry { text, stroke: None, marker: None };
    match layout.weakest() {
        Some(gap) if gap.open > 0 => entries.push(note(format!("× at the rim: {} open at the end", gap.open))),
        Some(gap) if gap.alike => entries.push(note("all gaps alike".into())),
        Some(gap) => {
            let latest = gap.link.closure_s.unwrap_or(0.0);
            entries.push(note(format!("ringed: weakest, {}, {} d", gap.name(), day(latest))));
        }
        None => entries.push(note("no gaps watched".into())),
    }
    entries
}
