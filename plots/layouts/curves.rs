//! Layouts over time and along radii, all in one figure.

use super::view::{DAY, LayoutView, between, day, fitted, look};
use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Align, Canvas, Stroke};
use crate::sheet::grown;
use crate::style::{LABEL, REFERENCE, number};

/// Height of a frame with its labels (px).
const HEIGHT: f64 = 520.0;

/// Thickness of the wall where it is weakest over time; nothing while it is open.
pub fn thickness(layouts: &[LayoutView<'_>]) -> Canvas {
    let series = |layout: &LayoutView<'_>| -> Vec<(f64, f64)> {
        let rows = layout.result.walls.iter().filter(|row| row.closed == Some(true));
        let closed = rows.filter_map(|row| Some((row.time_s, row.thickness_weakest_m?)));
        // It begins with nothing when it closes, and ends with nothing when it opens.
        let ends = layout.standing.iter().flat_map(|(from, to)| [Some(*from), *to]).flatten().map(|time| (time, 0.0));
        let mut all: Vec<(f64, f64)> = closed.chain(ends).collect();
        if layout.standing.is_empty() {
            all.push((layout.end_s(), 0.0));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    };
    let heading = "Thickness of the frozen wall where it is weakest";
    over_time(layouts, heading, "wall thickness (m)", &series, &weakest_name, false)
}

/// Mean temperature on the least frozen way through the wall over time.
pub fn mean_temperature(layouts: &[LayoutView<'_>]) -> Canvas {
    let series = |layout: &LayoutView<'_>| -> Vec<(f64, f64)> {
        let rows = layout.result.planes.iter().filter(|row| row.plane == "weakest");
        rows.filter_map(|row| Some((row.time_s, row.mean_temperature_c?))).collect()
    };
    let heading = "Mean temperature of the wall where it is weakest";
    over_time(layouts, heading, "mean temperature (°C)", &series, &weakest_name, false)
}

/// The name of a layout with that of the gap where it is weakest.
fn weakest_name(layout: &LayoutView<'_>) -> String {
    match layout.weakest() {
        Some(gap) if gap.alike => format!("{}, all gaps alike", layout.name),
        Some(gap) => format!("{}, {}", layout.name, gap.name()),
        None => layout.name.clone(),
    }
}

/// Load of all pipes of a layout over time.
pub fn load(layouts: &[LayoutView<'_>]) -> Canvas {
    let series = |layout: &LayoutView<'_>| layout.load.clone();
    let name = |layout: &LayoutView<'_>| layout.name.clone();
    over_time(layouts, "Load of all pipes by metre of depth", "load (W/m)", &series, &name, true)
}

/// One curve for each layout; its marker stands where the wall closes, or hollow at the end where it does not.
fn over_time(
    layouts: &[LayoutView<'_>],
    heading: &str,
    label: &str,
    series: &dyn Fn(&LayoutView<'_>) -> Vec<(f64, f64)>,
    name: &dyn Fn(&LayoutView<'_>) -> String,
    spiked: bool,
) -> Canvas {
    let curves: Vec<Vec<(f64, f64)>> = layouts.iter().map(series).collect();
    let mut entries: Vec<Entry> = layouts.iter().enumerate().map(|(k, layout)| entry(k, &name(layout))).collect();
    if layouts.iter().any(|layout| layout.closure_s.is_some()) {
        entries.push(Entry::note("marker: wall closed"));
    }
    if layouts.iter().any(|layout| layout.closure_s.is_none()) {
        entries.push(Entry::note("hollow marker at the end: not closed"));
    }
    if layouts.iter().any(|layout| layout.closure_s.is_some() && !layout.closed()) {
        entries.push(Entry::note("cross: opens again"));
    }
    let (mut canvas, top) = grown(heading, &entries, 8.0, |top| top + HEIGHT);
    let points = || curves.iter().flatten();
    let x = Axis::linear("time (d)", points().map(|(time, _)| time / DAY).chain([0.0]));
    let most = if spiked { without_spike(points().map(|(_, value)| *value)) } else { f64::INFINITY };
    let values = points().map(|(_, value)| value.min(most));
    let y = if spiked { Axis::linear(label, values.chain([0.0])) } else { Axis::linear(label, values) };
    let frame = Frame::inside((0.0, top), (canvas.width, canvas.height), x, y);
    frame.draw(&mut canvas);
    for (k, curve) in curves.iter().enumerate() {
        frame.curve(&mut canvas, curve.iter().map(|(time, value)| (time / DAY, *value)), look(k).stroke(2.4));
    }
    for (k, (curve, layout)) in curves.iter().zip(layouts).enumerate() {
        let mark = match layout.closure_s {
            Some(time) => between(curve, time).map(|value| (time, value)),
            None => curve.last().copied(),
        };
        // A mark beyond the frame would stand on its labels.
        if let Some((time, value)) = mark.filter(|(_, value)| *value >= frame.y.low && *value <= frame.y.high) {
            let at = frame.spot(time / DAY, value);
            canvas.marker(at, look(k).marker, 6.5, look(k).colour, layout.closure_s.is_none());
        }
        for time in layout.standing.iter().filter_map(|period| period.1) {
            let value = between(curve, time).unwrap_or(0.0).clamp(frame.y.low, frame.y.high);
            canvas.cross(frame.spot(time / DAY, value), 7.0, Stroke::whole(look(k).colour, 2.6));
        }
    }
    if points().next().is_none() {
        nothing(&mut canvas, &frame);
    }
    canvas
}

/// Temperature along the plane through a pipe and along that through the weakest gap, at the last instant of each layout.
pub fn planes(layouts: &[LayoutView<'_>], freezing_c: f64) -> Canvas {
    const EACH: f64 = 390.0;
    let last = |layout: &LayoutView<'_>| layout.result.profiles.iter().map(|row| row.time_s).max_by(f64::total_cmp);
    let named = |(k, layout): (usize, &LayoutView<'_>)| {
        let instant = last(layout).map_or_else(|| "no profile".into(), |time| format!("{} d", day(time)));
        let text = format!("{}, {instant}", fitted(&weakest_name(layout), LABEL, false, 420.0));
        Entry::line(text, look(k).stroke(2.4))
    };
    let mut entries: Vec<Entry> = layouts.iter().enumerate().map(named).collect();
    let isotherm = Stroke::whole(REFERENCE, 1.6);
    entries.push(Entry::line(format!("freezing point, {} °C", number(freezing_c, 3)), isotherm));
    let heading = "Temperature along the planes of the wall";
    let (mut canvas, mut top) = grown(heading, &entries, 8.0, |top| top + 2.0 * EACH);
    for (main, label) in [
        (true, "distance from the centre, through a pipe (m)"),
        (false, "distance from the centre, through the weakest gap (m)"),
    ] {
        let rows = |layout: &LayoutView<'_>| -> Vec<(f64, f64)> {
            if !main {
                return layout.weakest_plane.clone();
            }
            let time = last(layout);
            let rows = layout.result.profiles.iter().filter(|row| row.plane == "main" && Some(row.time_s) == time);
            rows.map(|row| (row.along_m, row.temperature_c)).collect()
        };
        let curves: Vec<Vec<(f64, f64)>> = layouts.iter().map(rows).collect();
        let points = || curves.iter().flatten();
        let x = Axis::linear(label, points().map(|(x, _)| *x));
        let y = Axis::linear("temperature (°C)", points().map(|(_, value)| *value).chain([freezing_c]));
        let frame = Frame::inside((0.0, top), (canvas.width, top + EACH - 14.0), x, y);
        frame.draw(&mut canvas);
        frame.level(&mut canvas, freezing_c, isotherm);
        for (k, curve) in curves.iter().enumerate() {
            frame.curve(&mut canvas, curve.iter().copied(), look(k).stroke(2.4));
        }
        if points().next().is_none() {
            nothing(&mut canvas, &frame);
        }
        top += EACH;
    }
    canvas
}

/// Temperature around the ring, through the pipes of the first ring, at the last instant of each layout.
pub fn axis(layouts: &[LayoutView<'_>], freezing_c: f64) -> Canvas {
    let named = |(k, layout): (usize, &LayoutView<'_>)| Entry { marker: None, ..entry(k, &layout.name) };
    let mut entries: Vec<Entry> = layouts.iter().enumerate().map(named).collect();
    let isotherm = Stroke::whole(REFERENCE, 1.6);
    entries.push(Entry::line(format!("freezing point, {} °C", number(freezing_c, 3)), isotherm));
    let heading = "Temperature around the ring, from pipe to pipe";
    let (mut canvas, top) = grown(heading, &entries, 8.0, |top| top + 390.0);
    let points = || layouts.iter().flat_map(|layout| &layout.axis);
    let x = Axis::between("angle from the x axis (°)", 0.0, 360.0);
    let y = Axis::linear("temperature (°C)", points().map(|(_, value)| *value).chain([freezing_c]));
    let frame = Frame::inside((0.0, top), (canvas.width, canvas.height), x, y);
    frame.draw(&mut canvas);
    frame.level(&mut canvas, freezing_c, isotherm);
    for (k, layout) in layouts.iter().enumerate() {
        frame.curve(&mut canvas, layout.axis.iter().copied(), look(k).stroke(2.0));
    }
    canvas
}

/// The k-th layout in a legend.
pub(super) fn entry(k: usize, name: &str) -> Entry {
    Entry::both(fitted(name, LABEL, false, 520.0), look(k).stroke(2.4), look(k).marker, false)
}

/// The jump at the start is without bound; the axis follows the rest.
fn without_spike(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() * 19 / 20).map_or(1.0, |most| 1.3 * most.abs())
}

fn nothing(canvas: &mut Canvas, frame: &Frame) {
    let at = (0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom));
    canvas.text(at, "no values", LABEL, Align::Middle);
}
