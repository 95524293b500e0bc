//! Error against cost: the work-precision diagram.

use crate::axes::{Axis, Entry, Frame, legend};
use crate::canvas::{Align, Canvas, Stroke};
use crate::sheet::{MARGIN, title_at};
use crate::style::{GRID, LABEL, Marker, MethodStyle, REFERENCE, method_style};

/// One setting of one method at one resolution.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkPoint {
    /// Relative error; absent for a run that failed.
    pub error: Option<f64>,
    /// Cost (s, or a number of operations); absent for a run that was not made.
    pub cost: Option<f64>,
    /// Interval of the error.
    pub error_range: Option<(f64, f64)>,
    /// Interval (or range) of the cost.
    pub cost_range: Option<(f64, f64)>,
    /// Whether the error is below ten times that of the reference.
    pub hollow: bool,
    /// Whether the error may be low by chance (a sign change in a finer run, or norms that disagree).
    pub ringed: bool,
    /// Whether the point lies on the method's lower left envelope.
    pub on_front: bool,
}

/// The points of one method and setting, from coarse to fine.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkCurve {
    /// Method, which decides the look.
    pub method: String,
    /// Words of the legend.
    pub label: String,
    /// Whether it is drawn thin: the second curve of a method.
    pub second: bool,
    /// Points.
    pub points: Vec<WorkPoint>,
}

/// What a work-precision diagram shows.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkFigure {
    /// Title.
    pub title: String,
    /// Name of the error measure.
    pub error_label: String,
    /// Name and unit of the cost.
    pub cost_label: String,
    /// An error that is marked, and what it is.
    pub marked: Option<(f64, &'static str)>,
    /// Curves.
    pub curves: Vec<WorkCurve>,
}

/// Draws diagrams, two to a row.
pub fn work_precision_panels(figures: &[WorkFigure]) -> Canvas {
    const SIZE: (f64, f64) = (1000.0, 680.0);
    let columns = figures.len().clamp(1, 2);
    let rows = figures.len().div_ceil(columns).max(1);
    let title = figures.first().map_or("Error against cost", |figure| figure.title.as_str());
    let mut canvas = Canvas::new(SIZE.0 * columns as f64, SIZE.1 * rows as f64, title);
    for (k, figure) in figures.iter().enumerate() {
        panel(&mut canvas, figure, (SIZE.0 * (k % columns) as f64, SIZE.1 * (k / columns) as f64), SIZE);
    }
    canvas
}

fn panel(canvas: &mut Canvas, figure: &WorkFigure, (left, top): (f64, f64), (width, height): (f64, f64)) {
    title_at(canvas, (left, top), width, &figure.title);
    let entry = |curve: &WorkCurve| Look::of(&curve.method, curve.second).entry(&curve.label);
    let mut entries: Vec<Entry> = figure.curves.iter().map(entry).collect();
    let points = || figure.curves.iter().flat_map(|curve| &curve.points);
    entries.extend(notes(points));
    let below = top + 46.0 + legend(canvas, (left + MARGIN, top + 46.0), width - 2.0 * MARGIN, &entries) + 8.0;
    let errors = points().filter_map(|point| point.error);
    let ranges = points().filter_map(|point| point.error_range).flat_map(|(low, high)| [low, high]);
    // A point of zero error by luck must not stretch the axis over many decades.
    let floor =
        points().filter_map(|point| point.error).filter(|error| *error > 0.0).fold(f64::INFINITY, f64::min) / 3.0;
    let x = Axis::log_percent(figure.error_label.as_str(), errors.chain(ranges.filter(|value| *value >= floor)));
    let costs = points().filter_map(|point| point.cost);
    let y = Axis::log(figure.cost_label.as_str(), costs);
    let frame = Frame::inside((left, below), (left + width, top + height), x, y);
    frame.draw(canvas);
    let within = |(error, _): &(f64, &str)| *error > frame.x.low && *error < frame.x.high;
    if let Some((error, words)) = figure.marked.filter(within) {
        let (x, _) = frame.spot(error, frame.y.low);
        canvas
            .line(vec![(x, frame.top), (x, frame.bottom)], Stroke { colour: REFERENCE, width: 1.6, dash: &[3.0, 4.0] });
        // What is as exact as the reference is dear: below nothing stands in the way.
        let at = (x + 6.0, frame.bottom - 10.0);
        canvas.text(at, words, LABEL - 2.0, Align::Start);
    }
    for curve in &figure.curves {
        draw_curve(canvas, &frame, curve);
    }
}

/// Entries that explain the marks which occur.
fn notes<'a, I: Iterator<Item = &'a WorkPoint>>(points: impl Fn() -> I) -> Vec<Entry> {
    let mut notes = Vec::new();
    if points().any(|point| point.hollow) {
        let text = "hollow: below 10 × error of the reference, a bound";
        notes.push(Entry::mark(text, Marker::Circle, REFERENCE, true));
    }
    if points().any(|point| point.ringed) {
        notes.push(Entry::note("ringed (○): perhaps low by chance"));
    }
    if points().any(|point| point.error.is_none() && point.cost.is_some()) {
        notes.push(Entry::note("× at the edge: failed, or cut off for lack of time"));
    }
    notes
}

/// How a curve of a method looks: its style, the width of its line and the radius of its markers (px).
pub(crate) struct Look {
    pub(crate) style: MethodStyle,
    pub(crate) width: f64,
    pub(crate) radius: f64,
}

impl Look {
    /// `second` is the second curve of a method, which is thin.
    pub(crate) fn of(method: &str, second: bool) -> Look {
        let (width, radius) = if second { (1.2, 4.5) } else { (2.4, 6.5) };
        Look { style: method_style(method), width, radius }
    }

    pub(crate) fn entry(&self, label: &str) -> Entry {
        Entry::both(label, self.style.stroke(self.width), self.style.marker, false)
    }
}

fn draw_curve(canvas: &mut Canvas, frame: &Frame, curve: &WorkCurve) {
    let Look { style, width, radius } = Look::of(&curve.method, curve.second);
    let seen = |point: &&WorkPoint| point.error.is_some_and(|error| error > 0.0) && point.cost.is_some();
    let spot = |point: &WorkPoint| Some((point.error?, point.cost?));
    // All points in their order, faintly; the envelope that is read at equal error, in full.
    frame.curve(canvas, curve.points.iter().filter(seen).filter_map(spot), Stroke::whole(GRID, 1.6));
    let mut front: Vec<(f64, f64)> = curve.points.iter().filter(|point| point.on_front).filter_map(spot).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    frame.curve(canvas, front, style.stroke(width));
    let whisker = Stroke::whole(style.colour, 1.4);
    for point in &curve.points {
        match (point.error.filter(|error| *error > 0.0), point.cost) {
            (Some(error), Some(cost)) => {
                let (x, y) = frame.spot(error, cost);
                if let Some((low, high)) = point.cost_range {
                    let (top, bottom) = (frame.spot(error, high).1, frame.spot(error, low).1);
                    bar(canvas, &[(x, top), (x, bottom)], (4.0, 0.0), whisker, top, bottom);
                }
                if let Some((low, high)) = point.error_range {
                    let (left, right) =
                        (frame.spot(low.max(frame.x.low), cost).0, frame.spot(high.min(frame.x.high), cost).0);
                    bar(canvas, &[(left, y), (right, y)], (0.0, 4.0), whisker, left, right);
                }
                canvas.marker((x, y), style.marker, radius, style.colour, point.hollow);
                if point.ringed {
                    canvas.ring((x, y), radius + 5.5, Stroke::whole(style.colour, 1.6));
                }
            }
            // No error worth the name: the run stands at the edge where errors are greatest.
            (None, Some(cost)) => {
                let y = frame.spot(frame.x.high, cost.clamp(frame.y.low, frame.y.high)).1;
                canvas.cross((frame.right, y), 7.0, Stroke::whole(style.colour, 3.0));
            }
            // Zero to the last bit lies beyond every logarithmic axis.
            _ => {}
        }
    }
}

/// A whisker with its two end strokes, left out where it would hide behind the marker.
fn bar(canvas: &mut Canvas, ends: &[(f64, f64); 2], (dx, dy): (f64, f64), stroke: Stroke, from: f64, to: f64) {
    if (to - from).abs() < 2.0 {
        return;
    }
    canvas.line(ends.to_vec(), stroke);
    for (x, y) in ends {
        canvas.line(vec![(x - dx, y - dy), (x + dx, y + dy)], stroke);
    }
}
