//! Axes: from numbers to pixels, with ticks that people can read.

use crate::canvas::{Align, Canvas, Colour, Spot, Stroke, text_width, widest_tick};
use crate::style::{GRID, INK, LABEL, Marker, TICK, number, power_of_ten};

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name and unit.
    pub label: String,
    /// Least value shown.
    pub low: f64,
    /// Greatest value shown.
    pub high: f64,
    /// Whether it is logarithmic.
    pub log: bool,
    ticks: Vec<(f64, String)>,
    fine: Vec<f64>,
}

impl Axis {
    /// A linear axis that holds all values with a little room, and zero if that is near.
    pub fn linear(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Axis {
        // Nothing but zeros say as little of a scale as nothing at all.
        let (low, high) = finite_range(values).filter(|range| *range != (0.0, 0.0)).unwrap_or((0.0, 1.0));
        let span = if high > low { high - low } else { high.abs().max(1e-9) };
        let low = if low >= 0.0 && low < 0.3 * span { 0.0 } else { low - 0.04 * span };
        Axis::between(label, low, if high <= 0.0 && high > -0.3 * span { 0.0 } else { high + 0.04 * span })
    }

    /// A linear axis with given ends.
    pub fn between(label: impl Into<String>, low: f64, high: f64) -> Axis {
        Axis::in_pieces(label, low, high, 6.0)
    }

    /// The same with half as many ticks, for a narrow frame.
    pub fn between_few(label: impl Into<String>, low: f64, high: f64) -> Axis {
        Axis::in_pieces(label, low, high, 3.0)
    }

    fn in_pieces(label: impl Into<String>, low: f64, high: f64, pieces: f64) -> Axis {
        let step = nice_step((high - low) / pieces);
        let places = (-step.log10().floor()).max(0.0) as usize;
        let ticks = ((low / step - 1e-6).ceil() as i64..=(high / step + 1e-6).floor() as i64)
            .map(|k| {
                let value = k as f64 * step;
                let text = if k == 0 {
                    "0".into()
                } else if value.abs() >= 1e6 || step < 1e-4 {
                    number(value, 3)
                } else {
                    format!("{value:.places$}").replace('-', "−")
                };
                (value, text)
            })
            .collect();
        Axis { label: label.into(), low, high, log: false, ticks, fine: Vec::new() }
    }

    /// A logarithmic axis with given ends and ticks.
    pub fn log_between(label: impl Into<String>, (low, high): (f64, f64), ticks: &[f64]) -> Axis {
        let ticks = ticks.iter().map(|value| (*value, number(*value, 3))).collect();
        Axis { label: label.into(), low, high, log: true, ticks, fine: Vec::new() }
    }

    /// An axis of named columns: column k reaches from k to k + 1.
    pub fn columns(label: impl Into<String>, names: &[String]) -> Axis {
        let ticks = names.iter().enumerate().map(|(k, name)| (k as f64 + 0.5, name.clone())).collect();
        let high = names.len().max(1) as f64;
        Axis { label: label.into(), low: 0.0, high, log: false, ticks, fine: Vec::new() }
    }

    /// A logarithmic axis that holds all positive values.
    pub fn log(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Axis {
        Axis::logarithmic(label, values, |value| {
            let decade = value.log10().round() as i32;
            let whole = (value / 10f64.powi(decade) - 1.0).abs() < 1e-9;
            if whole && !(-3..=4).contains(&decade) { power_of_ten(decade) } else { number(value, 2) }
        })
    }

    /// A logarithmic axis of fractions that are written as per cent.
    pub fn log_percent(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Axis {
        Axis::logarithmic(label, values, |value| {
            let decade = (100.0 * value).log10().round() as i32;
            let whole = (100.0 * value / 10f64.powi(decade) - 1.0).abs() < 1e-9;
            if whole && decade < -3 {
                format!("{} %", power_of_ten(decade))
            } else {
                format!("{} %", number(100.0 * value, 2))
            }
        })
    }

    fn logarithmic(label: impl Into<String>, values: impl Iterator<Item = f64>, text: impl Fn(f64) -> String) -> Axis {
        let (low, high) = finite_range(values.filter(|value| *value > 0.0)).unwrap_or((0.1, 10.0));
        // At least a decade and a half, or a cluster of points would fill the picture as if it were a trend.
        let room = (1.5 - (high / low).log10()).max(0.0) / 2.0 + 0.12;
        let (low, high) = (low / 10f64.powf(room), high * 10f64.powf(room));
        let decades = (high / low).log10();
        let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        let inside = |value: &f64| *value >= low * 0.9999 && *value <= high * 1.0001;
        let multiples: &[f64] = if decades < 2.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let stride = if decades > 9.0 { 2 } else { 1 };
        let ticks = (first..=last)
            .filter(|decade| decade % stride == 0)
            .flat_map(|decade| multiples.iter().map(move |m| m * 10f64.powi(decade)))
            .filter(inside)
            .map(|value| (value, text(value)))
            .collect();
        let fine = (first..=last)
            .flat_map(|decade| (1..10).map(move |m| f64::from(m) * 10f64.powi(decade)))
            .filter(inside)
            .collect();
        Axis { label: label.into(), low, high, log: true, ticks, fine }
    }

    /// Where a value stands between the ends, 0 to 1.
    pub fn place(&self, value: f64) -> f64 {
        if self.log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Labels of the ticks.
    pub fn tick_labels(&self) -> impl Iterator<Item = &str> {
        self.ticks.iter().map(|(_, text)| text.as_str())
    }
}

/// A box with two axes on a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Left edge (px).
    pub left: f64,
    /// Upper edge (px).
    pub top: f64,
    /// Right edge (px).
    pub right: f64,
    /// Lower edge (px).
    pub bottom: f64,
    /// Axis to the right.
    pub x: Axis,
    /// Axis upwards.
    pub y: Axis,
}

impl Frame {
    /// A frame inside a box, with room for its own labels.
    pub fn inside((left, top): Spot, (right, bottom): Spot, x: Axis, y: Axis) -> Frame {
        let room = widest_tick(y.tick_labels()) + TICK + 2.0 * LABEL;
        let below = if x.label.is_empty() { 8.0 } else { 2.2 * TICK + 1.2 * LABEL };
        Frame { left: left + room, top, right: right - 18.0, bottom: bottom - below, x, y }
    }

    /// Pixel of a point.
    pub fn spot(&self, x: f64, y: f64) -> Spot {
        (
            self.left + self.x.place(x) * (self.right - self.left),
            self.bottom - self.y.place(y) * (self.bottom - self.top),
        )
    }

    /// Grid, frame, ticks and labels. An axis without a label gets no tick labels either.
    pub fn draw(&self, canvas: &mut Canvas) {
        let grid = Stroke::whole(GRID, 1.0);
        let rim = Stroke::whole(INK, 1.3);
        let labelled = self.labelled();
        for (k, (value, text)) in self.x.ticks.iter().enumerate() {
            let (px, _) = self.spot(*value, self.y.low);
            canvas.line(vec![(px, self.top), (px, self.bottom)], grid);
            if !self.x.label.is_empty() && labelled(k) {
                canvas.text((px, self.bottom + 1.45 * TICK), text.as_str(), TICK, Align::Middle);
            }
        }
        for (value, text) in &self.y.ticks {
            let (_, py) = self.spot(self.x.low, *value);
            canvas.line(vec![(self.left, py), (self.right, py)], grid);
            canvas.text((self.left - 9.0, py + 0.36 * TICK), text.as_str(), TICK, Align::End);
        }
        for value in &self.x.fine {
            let (px, _) = self.spot(*value, self.y.low);
            canvas.line(vec![(px, self.bottom), (px, self.bottom - 4.0)], rim);
        }
        for value in &self.y.fine {
            let (_, py) = self.spot(self.x.low, *value);
            canvas.line(vec![(self.left, py), (self.left + 4.0, py)], rim);
        }
        canvas.outline((self.left, self.top), (self.right, self.bottom), rim);
        let middle = 0.5 * (self.left + self.right);
        canvas.text((middle, self.bottom + 2.0 * TICK + LABEL), self.x.label.as_str(), LABEL, Align::Middle);
        let across = self.left - widest_tick(self.y.tick_labels()) - 9.0 - 0.9 * LABEL;
        canvas.upward((across, 0.5 * (self.top + self.bottom)), self.y.label.as_str());
    }

    /// Which ticks of the axis to the right have labels: every one, or every second, fifth, tenth from zero on, so that no
    /// two labels touch.
    fn labelled(&self) -> impl Fn(usize) -> bool {
        let ticks = &self.x.ticks;
        let zero = ticks.iter().position(|(value, _)| *value == 0.0).unwrap_or(0);
        let clear = |stride: usize| {
            let shown: Vec<(f64, f64)> = ticks
                .iter()
                .enumerate()
                .filter(|(k, _)| k.abs_diff(zero) % stride == 0)
                .map(|(_, (value, text))| (self.spot(*value, self.y.low).0, 0.5 * text_width(text, TICK, false)))
                .collect();
            shown.windows(2).all(|pair| pair[1].0 - pair[0].0 >= pair[0].1 + pair[1].1 + 0.5 * TICK)
        };
        let stride = [1, 2, 5, 10, 20, 50, 100].into_iter().find(|stride| clear(*stride)).unwrap_or(usize::MAX);
        move |k| k.abs_diff(zero) % stride == 0
    }

    /// A line through data points, cut at the frame; a point that is no number breaks it.
    pub fn curve(&self, canvas: &mut Canvas, points: impl IntoIterator<Item = (f64, f64)>, stroke: Stroke) {
        let mut piece: Vec<Spot> = Vec::new();
        let mut last: Option<Spot> = None;
        for (x, y) in points {
            let usable = x.is_finite() && y.is_finite() && (!self.x.log || x > 0.0) && (!self.y.log || y > 0.0);
            let spot = usable.then(|| self.spot(x, y));
            match (last, spot) {
                (Some(from), Some(to)) => match self.clip(from, to) {
                    Some((a, b)) => {
                        if piece.last() != Some(&a) {
                            canvas.line(std::mem::take(&mut piece), stroke);
                            piece = vec![a];
                        }
                        piece.push(b);
                    }
                    None => canvas.line(std::mem::take(&mut piece), stroke),
                },
                _ => canvas.line(std::mem::take(&mut piece), stroke),
            }
            last = spot;
        }
        canvas.line(piece, stroke);
    }

    /// A line from edge to edge.
    pub fn level(&self, canvas: &mut Canvas, value: f64, stroke: Stroke) {
        self.curve(canvas, [(self.x.low, value), (self.x.high, value)], stroke);
    }

    /// The part of a segment inside the frame (Liang and Barsky).
    fn clip(&self, (x0, y0): Spot, (x1, y1): Spot) -> Option<(Spot, Spot)> {
        let (dx, dy) = (x1 - x0, y1 - y0);
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (p, q) in [(-dx, x0 - self.left), (dx, self.right - x0), (-dy, y0 - self.top), (dy, self.bottom - y0)] {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                from = from.max(q / p);
            } else {
                to = to.min(q / p);
            }
        }
        (from <= to).then_some(((x0 + from * dx, y0 + from * dy), (x0 + to * dx, y0 + to * dy)))
    }
}

/// Gives frames below each other one left edge.
pub fn align(frames: &mut [Frame]) {
    let left = frames.iter().map(|frame| frame.left).fold(0.0, f64::max);
    frames.iter_mut().for_each(|frame| frame.left = left);
}

/// What a legend says about one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The words.
    pub text: String,
    /// Its line, if it is one.
    pub stroke: Option<Stroke>,
    /// Its marker, colour, and whether it is hollow.
    pub marker: Option<(Marker, Colour, bool)>,
}

impl Entry {
    /// Words alone.
    pub fn note(text: impl Into<String>) -> Entry {
        Entry { text: text.into(), stroke: None, marker: None }
    }

    /// A line.
    pub fn line(text: impl Into<String>, stroke: Stroke) -> Entry {
        Entry { stroke: Some(stroke), ..Entry::note(text) }
    }

    /// A marker, filled or hollow.
    pub fn mark(text: impl Into<String>, marker: Marker, colour: Colour, hollow: bool) -> Entry {
        Entry { marker: Some((marker, colour, hollow)), ..Entry::note(text) }
    }

    /// A marker on a line.
    pub fn both(text: impl Into<String>, stroke: Stroke, marker: Marker, hollow: bool) -> Entry {
        Entry { stroke: Some(stroke), ..Entry::mark(text, marker, stroke.colour, hollow) }
    }
}

/// Draws a legend in rows from the upper left corner of a box and returns the height that it took (px).
pub fn legend(canvas: &mut Canvas, (left, top): Spot, width: f64, entries: &[Entry]) -> f64 {
    const SWATCH: f64 = 44.0;
    let row = 1.5 * LABEL;
    let (mut x, mut y) = (left, top + 0.75 * row);
    for entry in entries {
        let bare = entry.stroke.is_none() && entry.marker.is_none();
        let indent = if bare { 0.0 } else { SWATCH + 8.0 };
        let needed = indent + text_width(&entry.text, LABEL, false);
        if x > left && x + needed > left + width {
            (x, y) = (left, y + row);
        }
        let middle = y - 0.34 * LABEL;
        if let Some(stroke) = entry.stroke {
            canvas.line(vec![(x, middle), (x + SWATCH, middle)], stroke);
        }
        if let Some((marker, colour, hollow)) = entry.marker {
            canvas.marker((x + 0.5 * SWATCH, middle), marker, 6.0, colour, hollow);
        }
        canvas.text((x + indent, y), entry.text.as_str(), LABEL, Align::Start);
        x += needed + 30.0;
    }
    if entries.is_empty() { 0.0 } else { y - top + 0.5 * row }
}

fn finite_range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|value| value.is_finite()).fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((f64::min(low, value), f64::max(high, value))),
    })
}

/// The least of 1, 2, 5 times a power of ten that is not below a length.
pub fn nice_step(length: f64) -> f64 {
    let decade = 10f64.powf(length.log10().floor());
    [1.0, 2.0, 5.0, 10.0].iter().map(|m| m * decade).find(|step| *step >= length * 0.999).unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_of_zeros_has_an_extent() {
        let axis = Axis::linear("thickness", [0.0, 0.0].into_iter());
        assert!(axis.high > axis.low && axis.place(0.0).is_finite());
        assert!(axis.tick_labels().count() < 20);
    }

    #[test]
    fn ticks_are_round_and_have_no_exponents() {
        let axis = Axis::linear("time (h)", [0.0, 0.5, 3.0].into_iter());
        assert_eq!(axis.tick_labels().next(), Some("0"));
        assert!(axis.tick_labels().all(|text| !text.contains('e')));
        let axis = Axis::log_percent("error", [1e-4, 3e-2].into_iter());
        let labels: Vec<_> = axis.tick_labels().collect();
        assert!(labels.contains(&"0.1 %") && labels.contains(&"1 %"), "{labels:?}");
        let axis = Axis::log("time (s)", [1e-6, 1e3].into_iter());
        assert!(axis.tick_labels().any(|text| text == "10⁻⁶"));
    }

    #[test]
    fn labels_do_not_touch_however_narrow_the_frame() {
        for width in [150.0, 220.0, 300.0, 500.0, 1000.0] {
            for high in [0.5, 12.0, 10_000.0, 200_000.0, 3e8] {
                for low in [0.0, -0.37 * high] {
                    let mut canvas = Canvas::new(width, 300.0, "t");
                    let axis = |label: &str, low: f64, high: f64| Axis::between(label, low, high);
                    let frame = Frame::inside((0.0, 0.0), (width, 300.0), axis("x", low, high), axis("", 0.0, 1.0));
                    frame.draw(&mut canvas);
                    let below = |item: &crate::canvas::Item| match item {
                        crate::canvas::Item::Text(text)
                            if text.at.1 > frame.bottom && text.align == Align::Middle && text.size == TICK =>
                        {
                            Some((text.at.0, 0.5 * text_width(&text.text, TICK, false)))
                        }
                        _ => None,
                    };
                    let labels: Vec<(f64, f64)> = canvas.items.iter().filter_map(below).collect();
                    assert!(!labels.is_empty());
                    for pair in labels.windows(2) {
                        assert!(pair[1].0 - pair[0].0 > pair[0].1 + pair[1].1, "{width} {high}: {labels:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn curves_stay_inside_their_frame() {
        let mut canvas = Canvas::new(400.0, 300.0, "t");
        let axis = |label: &str| Axis::between(label, 0.0, 1.0);
        let frame = Frame::inside((0.0, 0.0), (400.0, 300.0), axis("x"), axis("y"));
        frame.curve(
            &mut canvas,
            [(-1.0, 0.5), (0.5, 0.5), (0.5, 9.0), (0.6, f64::NAN), (0.7, 0.1)],
            Stroke::whole(INK, 1.0),
        );
        for item in &canvas.items {
            if let crate::canvas::Item::Line { points, .. } = item {
                for (x, y) in points {
                    assert!(*x >= frame.left - 1e-9 && *x <= frame.right + 1e-9);
                    assert!(*y >= frame.top - 1e-9 && *y <= frame.bottom + 1e-9);
                }
            }
        }
        assert_eq!(canvas.items.len(), 1);
    }
}
