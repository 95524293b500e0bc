//! Measured properties of a fluid: curves by temperature, and numbers over temperature beside what they should be.

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Colour, Stroke};
use crate::sheet::{WIDTH, framed, sheet};
use crate::style::{BLUE, GREEN, INK, MARKERS, Marker, ORANGE, PURPLE, REFERENCE, SKY};

/// What was measured, and the line that goes with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Words of the legend.
    pub label: String,
    /// Measured points.
    pub points: Vec<(f64, f64)>,
    /// Fit or theory.
    pub line: Vec<(f64, f64)>,
}

/// Points and lines.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvesFigure {
    /// Title.
    pub title: String,
    /// What the lines are.
    pub line_label: String,
    /// Labels of both axes.
    pub axes: (String, String),
    /// Curves.
    pub curves: Vec<Measured>,
}

/// A number with the ends of its interval, if it has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Place on the axis.
    pub at: f64,
    /// Mean.
    pub mean: f64,
    /// Ends of the interval.
    pub ends: Option<(f64, f64)>,
}

/// Numbers of one kind in the lower frame, in per cent.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviations {
    /// Words of the legend.
    pub label: String,
    /// Numbers.
    pub points: Vec<Estimate>,
}

/// A number over temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberFigure {
    /// Title.
    pub title: String,
    /// Name of the number.
    pub label: String,
    /// Whether its axis is logarithmic.
    pub log: bool,
    /// What it should be.
    pub target: Vec<(f64, f64)>,
    /// What it is.
    pub points: Vec<Estimate>,
    /// What is too much or too little, below.
    pub deviations: Vec<Deviations>,
}

const COLOURS: [Colour; 5] = [BLUE, ORANGE, GREEN, PURPLE, SKY];

const TEMPERATURE: &str = "temperature over the reference temperature";

/// Draws points with the lines that go with them.
pub fn curves(figure: &CurvesFigure) -> Canvas {
    let looks = || figure.curves.iter().zip(COLOURS.iter().zip(&MARKERS).cycle());
    let mut entries: Vec<Entry> =
        looks().map(|(curve, (colour, marker))| Entry::mark(curve.label.as_str(), *marker, *colour, true)).collect();
    entries.push(Entry::line(figure.line_label.as_str(), Stroke::whole(REFERENCE, 2.2)));
    let all = || figure.curves.iter().flat_map(|curve| curve.points.iter().chain(&curve.line));
    let x = Axis::linear(figure.axes.0.as_str(), all().map(|point| point.0));
    let y = Axis::linear(figure.axes.1.as_str(), all().map(|point| point.1));
    let (mut canvas, frame) = framed(680.0, (&figure.title, &figure.title), &entries, 10.0, (x, y));
    for (curve, _) in looks() {
        frame.curve(&mut canvas, curve.line.iter().copied(), Stroke::whole(REFERENCE, 2.2));
    }
    for (curve, (colour, marker)) in looks() {
        for (x, y) in curve.points.iter().filter(|point| point.0.is_finite() && point.1.is_finite()) {
            canvas.marker(frame.spot(*x, *y), *marker, 4.5, *colour, true);
        }
    }
    canvas
}

/// Draws a number over temperature, and what it is too much below.
pub fn numbers(figure: &NumberFigure) -> Canvas {
    let target = Stroke::whole(REFERENCE, 3.0);
    let mut entries = vec![
        Entry::line("target, and theory", target),
        Entry::both("measured, with 95 % interval", Stroke::whole(INK, 1.5), Marker::Circle, true),
    ];
    let looks = || figure.deviations.iter().zip(COLOURS.iter().zip(&MARKERS).skip(1).cycle());
    for (kind, (colour, marker)) in looks() {
        entries.push(Entry::both(kind.label.as_str(), Stroke::whole(*colour, 1.5), *marker, true));
    }
    let (mut canvas, top) = sheet(860.0, (&figure.title, &figure.title), &entries, 10.0);
    let values = |points: &[Estimate]| -> Vec<f64> {
        points
            .iter()
            .flat_map(|point| [Some(point.mean), point.ends.map(|e| e.0), point.ends.map(|e| e.1)])
            .flatten()
            .collect()
    };
    let above = values(&figure.points).into_iter().chain(figure.target.iter().map(|point| point.1));
    let y =
        if figure.log { Axis::log(figure.label.as_str(), above) } else { Axis::linear(figure.label.as_str(), above) };
    let off = figure.deviations.iter().flat_map(|kind| values(&kind.points)).chain([0.0]);
    let deviation = Axis::linear("deviation (%)", off);
    let places = || figure.target.iter().map(|point| point.0).chain(figure.points.iter().map(|point| point.at));
    let middle = top + 0.55 * (860.0 - top - 60.0);
    let mut frames = [
        Frame::inside((0.0, top), (WIDTH, middle - 18.0), Axis::linear("", places()), y),
        Frame::inside((0.0, middle), (WIDTH, 860.0), Axis::linear(TEMPERATURE, places()), deviation),
    ];
    align(&mut frames);
    frames.iter().for_each(|frame| frame.draw(&mut canvas));
    frames[0].curve(&mut canvas, figure.target.iter().copied(), target);
    estimates(&mut canvas, &frames[0], &figure.points, 0.0, INK, Marker::Circle);
    frames[1].level(&mut canvas, 0.0, Stroke::whole(REFERENCE, 1.5));
    let count = figure.deviations.len() as f64;
    for (k, (kind, (colour, marker))) in looks().enumerate() {
        // Side by side, or one would hide the other.
        let shift = 9.0 * (k as f64 - 0.5 * (count - 1.0));
        estimates(&mut canvas, &frames[1], &kind.points, shift, *colour, *marker);
    }
    canvas
}

fn estimates(canvas: &mut Canvas, frame: &Frame, points: &[Estimate], shift: f64, colour: Colour, marker: Marker) {
    for point in points {
        let (x, y) = frame.spot(point.at, point.mean);
        if let Some((low, high)) = point.ends {
            // A log axis has no place for what is not positive.
            let low = if frame.y.log { low.max(frame.y.low) } else { low };
            let (from, to) = (frame.spot(point.at, low).1, frame.spot(point.at, high).1);
            let stroke = Stroke::whole(colour, 1.5);
            canvas.line(vec![(x + shift, from), (x + shift, to)], stroke);
            for end in [from, to] {
                canvas.line(vec![(x + shift - 4.0, end), (x + shift + 4.0, end)], stroke);
            }
        }
        canvas.marker((x + shift, y), marker, 4.5, colour, true);
    }
}
