//! What was measured, with bars of one standard deviation, and what runs found.

use frazil_record::{MeasuredRow, RunResult};

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Align, Canvas, Stroke};
use crate::sheet::{WIDTH, sheet};
use crate::style::{INK, LABEL, Marker, method_style, number};
use crate::words::{FigureOptions, Words};

/// Height of one panel (px).
const PANEL: f64 = 300.0;
/// Height of the place of a probe above its frame (px).
const CAPTION: f64 = 1.5 * LABEL;
/// Panels at most: of more probes, the first are drawn.
const MOST: usize = 6;
/// Width of the ends of a bar and radius of a point (px).
const END: f64 = 5.0;
const RADIUS: f64 = 4.0;

/// A run, and what it is called.
pub type Named<'a> = (String, &'a RunResult);

/// What is drawn in one frame.
struct Panel<'a> {
    label: String,
    /// Where it is of, above the frame; empty of what is of the whole body.
    place: String,
    /// What values are multiplied by.
    scale: f64,
    points: Vec<&'a MeasuredRow>,
    /// Times (s) and values of each run.
    curves: Vec<Vec<(f64, f64)>>,
}

/// The figure of what was measured beside runs of one scene, if there is anything that is drawn over time.
pub fn drawing(runs: &[Named<'_>], options: &FigureOptions) -> Option<Canvas> {
    let (_, first) = runs.first()?;
    let words = Words::of(first, options);
    let panels = panels(runs, &words);
    if panels.is_empty() {
        return None;
    }
    let stroke = |k: usize| {
        let alike = |(_, other): &&Named<'_>| other.record.method == runs[k].1.record.method;
        let thin = runs[..k].iter().any(|other| alike(&other));
        method_style(&runs[k].1.record.method).stroke(if thin { 1.2 } else { 2.2 })
    };
    let mut entries: Vec<Entry> = runs.iter().enumerate().map(|(k, (name, _))| Entry::line(name, stroke(k))).collect();
    entries.push(entry());
    let heading = options.name.as_ref().unwrap_or(&first.record.title);
    let heading = format!("Measured and computed: {heading}");
    let (mut canvas, top) = sheet(110.0 + PANEL * panels.len() as f64, (&heading, &heading), &entries, 6.0);
    let each = (canvas.height - top) / panels.len() as f64;
    let last = panels.len() - 1;
    let frame = |(place, panel): (usize, &Panel<'_>)| {
        let times = panel.points.iter().map(|row| row.time_s).chain(panel.curves.iter().flatten().map(|row| row.0));
        let measured =
            panel.points.iter().flat_map(|row| [row.value_ref - row.value_ref_sd, row.value_ref + row.value_ref_sd]);
        let values = measured.chain(panel.curves.iter().flatten().map(|row| row.1));
        let x = if place == last { words.time_label.clone() } else { String::new() };
        let x = Axis::linear(x, times.map(|time| words.time(time)).chain([0.0]));
        let y = Axis::linear(panel.label.as_str(), values.map(|value| panel.scale * value));
        let caption = if panel.place.is_empty() { 0.0 } else { CAPTION };
        let (above, below) = (top + each * place as f64 + caption, top + each * (place + 1) as f64 - 8.0);
        Frame::inside((0.0, above), (WIDTH, below), x, y)
    };
    let mut frames: Vec<Frame> = panels.iter().enumerate().map(frame).collect();
    align(&mut frames);
    for (frame, panel) in frames.iter().zip(&panels) {
        frame.draw(&mut canvas);
        canvas.text((frame.left, frame.top - 0.4 * LABEL), panel.place.as_str(), LABEL, Align::Start);
        for (k, curve) in panel.curves.iter().enumerate() {
            frame.curve(&mut canvas, curve.iter().map(|(t, value)| (words.time(*t), panel.scale * value)), stroke(k));
        }
        marks(&mut canvas, frame, panel.points.iter().copied(), panel.scale, &words);
    }
    Some(canvas)
}

/// The front, and the first probes.
fn panels<'a>(runs: &[Named<'a>], words: &Words) -> Vec<Panel<'a>> {
    let Some((_, first)) = runs.first() else { return Vec::new() };
    let mut panels = Vec::new();
    let of_front: Vec<&MeasuredRow> = first.measured.iter().filter(|row| is_of_front(row)).collect();
    if !of_front.is_empty() {
        let curve = |(_, run): &Named<'_>| run.front.iter().map(|row| (row.time_s, row.front_m)).collect();
        let (label, scale) = (words.length_label(words.front.1), words.length(1.0));
        let place = String::new();
        panels.push(Panel { label, place, scale, points: of_front, curves: runs.iter().map(curve).collect() });
    }
    let moist = first.record.of_water;
    let probes = || first.measured.iter().filter(|row| row.is_of_probe());
    let mut places: Vec<(Option<f64>, Option<f64>)> = Vec::new();
    for place in probes().map(|row| (row.x_m, row.y_m)) {
        if !places.contains(&place) {
            places.push(place);
        }
    }
    for place in places.into_iter().take(MOST - panels.len()) {
        let is_there = |x: f64, y: f64| (Some(x), Some(y)) == place;
        let curve = |(_, run): &Named<'_>| {
            let there = run.probes.iter().filter(|row| is_there(row.x_m, row.y_m));
            there.map(|row| (row.time_s, row.temperature_c)).collect()
        };
        panels.push(Panel {
            label: if moist { "saturation".into() } else { words.temperature_label.clone() },
            place: named(place, words),
            scale: 1.0,
            points: probes().filter(|row| (row.x_m, row.y_m) == place).collect(),
            curves: runs.iter().map(curve).collect(),
        });
    }
    panels
}

/// What the place of a probe is called.
fn named((x, y): (Option<f64>, Option<f64>), words: &Words) -> String {
    let unit = if words.length_unit.is_some() { " m" } else { "" };
    let place = [x.map(|x| (words.axes.0, x)), y.filter(|y| *y != 0.0).map(|y| (words.axes.1, y))];
    let place: Vec<String> =
        place.into_iter().flatten().map(|(axis, at)| format!("{axis} = {}{unit}", number(at, 3))).collect();
    place.join(", ")
}

/// Whether a measured value is of the front.
pub(crate) fn is_of_front(row: &MeasuredRow) -> bool {
    row.quantity == "front_m"
}

/// What the legend says of measured points.
pub(crate) fn entry() -> Entry {
    Entry::mark("measured, ± one standard deviation", Marker::Circle, INK, true)
}

/// Measured points with their bars in a frame whose values are multiplied by `scale`.
pub(crate) fn marks<'a>(
    canvas: &mut Canvas,
    frame: &Frame,
    rows: impl Iterator<Item = &'a MeasuredRow>,
    scale: f64,
    words: &Words,
) {
    let bar = Stroke::whole(INK, 1.4);
    for row in rows {
        let at = words.time(row.time_s);
        let spot = |value: f64| frame.spot(at, scale * value);
        let ends = [spot(row.value_ref - row.value_ref_sd), spot(row.value_ref + row.value_ref_sd)];
        canvas.line(ends.to_vec(), bar);
        for (x, y) in ends {
            canvas.line(vec![(x - END, y), (x + END, y)], bar);
        }
        canvas.marker(spot(row.value_ref), Marker::Circle, RADIUS, INK, true);
    }
}
