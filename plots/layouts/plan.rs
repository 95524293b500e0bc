//! Plans of layouts to one scale, and maps of their temperature.

use super::view::{LayoutView, backed, dashed_circle, day, wrapped};
use crate::axes::nice_step;
use crate::canvas::{Align, Canvas, Spot, Stroke};
use crate::ground_plan::{GroundPlan, LEAST, ShaftMark, arrow_around};
use crate::map::plain_map;
use crate::sheet::title;
use crate::style::{INK, Marker, REFERENCE, TICK, number};
use crate::words::{FigureOptions, Words};
use frazil_record::{Field, TimeUnit};

/// Sketches in a row, and in a figure.
const COLUMNS: usize = 3;
const MOST: usize = 6;

/// Side of a sketch (px), and what stands above and below it.
const SIDE: f64 = 300.0;
const HEAD: f64 = 2.6 * TICK;
const FOOT: f64 = 5.4 * TICK;

/// Plans of the layouts to one scale, six to a figure: pipes, missing pipes, and the weakest gap in bold.
pub fn sketches(layouts: &[LayoutView<'_>]) -> Vec<Canvas> {
    let reach = layouts.iter().map(reach).fold(0.0, f64::max);
    let reach = if reach > 0.0 { 1.06 * reach } else { 1.0 };
    layouts.chunks(MOST).map(|some| figure(some, reach)).collect()
}

/// How far from the centre anything is drawn (m).
pub(super) fn reach(layout: &LayoutView<'_>) -> f64 {
    let pipes = layout.pipes.iter().map(|pipe| pipe.x_m.hypot(pipe.y_m) + pipe.radius_m);
    let missing = layout.missing.iter().map(|(x, y)| x.hypot(*y));
    pipes.chain(missing).chain(layout.shaft_radius_m).filter(|far| far.is_finite()).fold(0.0, f64::max)
}

fn figure(layouts: &[LayoutView<'_>], reach: f64) -> Canvas {
    const GAP: f64 = 25.0;
    const TOP: f64 = 50.0;
    let rows = layouts.len().div_ceil(COLUMNS).max(1);
    let heading = "Layouts to scale";
    let mut canvas = Canvas::new(1000.0, TOP + rows as f64 * (HEAD + SIDE + FOOT), heading);
    title(&mut canvas, heading);
    for (k, layout) in layouts.iter().enumerate() {
        let left = GAP + (k % COLUMNS) as f64 * (SIDE + GAP);
        sketch(&mut canvas, layout, (left, TOP + (k / COLUMNS) as f64 * (HEAD + SIDE + FOOT)), reach);
    }
    canvas
}

fn sketch(canvas: &mut Canvas, layout: &LayoutView<'_>, (left, top): Spot, reach: f64) {
    let lines = wrapped(&layout.name, TICK, true, SIDE);
    for (k, line) in lines.iter().enumerate() {
        let y = top + HEAD - 10.0 - 1.2 * TICK * (lines.len() - 1 - k) as f64;
        canvas.bold((left, y), line.as_str(), TICK, Align::Start);
    }
    let scale = 0.5 * SIDE / reach;
    let (cx, cy) = (left + 0.5 * SIDE, top + HEAD + 0.5 * SIDE);
    let spot = |x: f64, y: f64| (cx + scale * x, cy - scale * y);
    if let Some(radius) = layout.shaft_radius_m {
        dashed_circle(canvas, (cx, cy), scale * radius, Stroke { colour: INK, width: 1.4, dash: &[7.0, 5.0] });
    }
    canvas.cross((cx, cy), 4.0, Stroke::whole(REFERENCE, 1.2));
    let place = |name: &str| layout.pipes.iter().find(|pipe| pipe.name == name).map(|pipe| spot(pipe.x_m, pipe.y_m));
    for link in &layout.result.links {
        if let (Some(from), Some(to)) = (place(&link.from), place(&link.to)) {
            canvas.line(vec![from, to], Stroke::whole(REFERENCE, 1.0));
        }
    }
    // Of gaps that are all alike, none is the weakest.
    if let Some(gap) = layout.weakest().filter(|gap| !gap.alike) {
        if let Some((from, to)) = place(&gap.link.from).zip(place(&gap.link.to)) {
            canvas.line(vec![from, to], Stroke::whole(INK, 4.5));
        }
        // The name stands inside the ring, where there is room, at the end of a line that leads to the gap.
        let (x, y) = (gap.link.x_m, gap.link.y_m);
        let (px, py) = spot(0.45 * x, 0.45 * y);
        canvas.line(vec![spot(x, y), (px, py)], Stroke::whole(INK, 1.0));
        backed(canvas, (px, py + 0.36 * TICK), &gap.name(), TICK);
    }
    for pipe in &layout.pipes {
        let radius = (scale * pipe.radius_m).max(LEAST);
        canvas.marker(spot(pipe.x_m, pipe.y_m), Marker::Circle, radius, INK, radius > 4.0);
    }
    for (x, y) in &layout.missing {
        canvas.cross(spot(*x, *y), 6.0, Stroke::whole(INK, 2.2));
    }
    if let Some(water) = &layout.water {
        // A ring leaves the corners of its square free.
        arrow_around(canvas, (left + 24.0, top + HEAD + 24.0), water.direction);
    }
    notes(canvas, layout, (left, top + HEAD + SIDE), scale);
}

/// What stands under a sketch: how many pipes, the weakest gap, and the scale.
fn notes(canvas: &mut Canvas, layout: &LayoutView<'_>, (left, top): Spot, scale: f64) {
    let mut count = format!("{} pipes", layout.pipes.len());
    if !layout.missing.is_empty() {
        count += &format!(", {} missing (×)", layout.missing.len());
    }
    if let Some(water) = &layout.water {
        count += &format!(", water {}", water.words(0.0));
    }
    canvas.text((left, top + 1.4 * TICK), count, TICK, Align::Start);
    let words = match layout.weakest() {
        Some(gap) if layout.closure_s.is_some() && !layout.closed() => format!("open again at {}", gap.name()),
        Some(gap) => match gap.link.closed_s() {
            Some(time) if gap.alike => format!("all gaps alike, closed after {} d", day(time)),
            Some(time) => format!("weakest {}, closed after {} d", gap.name(), day(time)),
            None if layout.open() == 1 => format!("{} does not close", gap.name()),
            None if gap.alike => "no gap closes".into(),
            None => format!("{} gaps do not close, widest {}", layout.open(), gap.name()),
        },
        None => "no gaps watched".into(),
    };
    canvas.text((left, top + 2.7 * TICK), words, TICK, Align::Start);
    let length = nice_step(40.0 / scale);
    let (right, y) = (left + scale * length, top + 4.0 * TICK - 5.0);
    let stroke = Stroke::whole(INK, 2.0);
    canvas.line(vec![(left, y), (right, y)], stroke);
    for x in [left, right] {
        canvas.line(vec![(x, y - 4.0), (x, y + 4.0)], stroke);
    }
    canvas.text((right + 8.0, top + 4.0 * TICK), format!("{} m", number(length, 2)), TICK, Align::Start);
}

/// Maps of the temperature of a layout at every instant that has one, by the day: the front heavy, pipes drawn in.
pub fn maps(layout: &LayoutView<'_>, freezing_c: f64) -> Vec<(String, Canvas)> {
    let options = FigureOptions {
        name: Some(layout.name.clone()),
        time_unit: TimeUnit::Day,
        freezing_point: Some(freezing_c),
        axes: ("x", "y"),
        pressures: (0.0, 0.0),
        cut: 0.0,
        plan: GroundPlan {
            pipes: layout.pipes.iter().map(|pipe| (pipe.x_m, pipe.y_m, pipe.radius_m)).collect(),
            shaft: layout.shaft_radius_m.map(|radius| ShaftMark { radius, dug: layout.dug_s }),
            water: layout.water.clone(),
        },
        unsaturated: None,
        ground: Vec::new(),
    };
    let mut words = Words::of(layout.result, &options);
    words.heading.clone_from(&layout.name);
    let fields = layout.result.fields.iter();
    let drawn = |field: &Field| (number(words.time(field.time_s), 4), plain_map(field, &options.plan, &words, None));
    fields.map(drawn).collect()
}
