//! By how much of something, as of groundwater, layouts are kept open.

use super::curves::entry;
use super::view::look;
use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Canvas, Stroke};
use crate::sheet::grown;
use crate::style::REFERENCE;

/// Height of each of the two frames with its labels (px).
const EACH: f64 = 400.0;

/// A layout and what was tried of it.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalView {
    /// Name.
    pub name: String,
    /// Distance of its pipes (m).
    pub pipe_spacing_m: f64,
    /// What a balance of heat expects for the greatest value at which it closes.
    pub estimate: Option<f64>,
    /// Values, increasing, and the day on which the wall closed with each.
    pub tried: Vec<(f64, Option<f64>)>,
}

/// When walls close by the value, and a map of what closes by pipe spacing and value.
pub fn critical_map(layouts: &[CriticalView], key: &str) -> Canvas {
    let label = match key.rsplit('.').next().unwrap_or(key) {
        "velocity_m_per_day" => "Darcy velocity far from the pipes (m/day)".to_owned(),
        other => other.to_owned(),
    };
    let estimate = Stroke { dash: &[3.0, 4.0], ..Stroke::whole(REFERENCE, 2.0) };
    let mut entries: Vec<Entry> = layouts.iter().enumerate().map(|(k, layout)| entry(k, &layout.name)).collect();
    let estimates: Vec<(f64, f64)> =
        layouts.iter().filter_map(|layout| Some((layout.pipe_spacing_m, layout.estimate?))).collect();
    if !estimates.is_empty() {
        entries.push(Entry::line("what pipes can take, by a balance of heat", estimate));
    }
    entries.push(Entry::note("hollow marker: not closed"));
    let (mut canvas, top) = grown("What keeps the wall open", &entries, 8.0, |top| top + 2.0 * EACH);

    let values = || layouts.iter().flat_map(|layout| layout.tried.iter().map(|one| one.0));
    let days = || layouts.iter().flat_map(|layout| layout.tried.iter().filter_map(|one| one.1));
    let x = Axis::linear(label.as_str(), values());
    let y = Axis::linear("wall closes (d)", days().chain([0.0]));
    let frame = Frame::inside((0.0, top), (canvas.width, top + EACH - 14.0), x, y);
    frame.draw(&mut canvas);
    for (k, layout) in layouts.iter().enumerate() {
        let closed = || layout.tried.iter().filter_map(|(value, day)| Some((*value, (*day)?)));
        frame.curve(&mut canvas, closed(), look(k).stroke(2.4));
        for (value, day) in closed() {
            canvas.marker(frame.spot(value, day), look(k).marker, 6.5, look(k).colour, false);
        }
    }

    let x = Axis::linear("distance of pipes (m)", layouts.iter().map(|layout| layout.pipe_spacing_m));
    let y = Axis::linear(label.as_str(), values().chain(estimates.iter().map(|point| point.1)));
    let frame = Frame::inside((0.0, top + EACH), (canvas.width, canvas.height), x, y);
    frame.draw(&mut canvas);
    let mut line = estimates;
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    frame.curve(&mut canvas, line.iter().copied().filter(|point| point.1 <= frame.y.high), estimate);
    for (k, layout) in layouts.iter().enumerate() {
        for (value, day) in &layout.tried {
            let at = frame.spot(layout.pipe_spacing_m, *value);
            canvas.marker(at, look(k).marker, 6.5, look(k).colour, day.is_none());
        }
    }
    canvas
}
