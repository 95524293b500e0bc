//! Magnitudes of signed errors on logarithmic axes: marks say the sign.

use crate::axes::{Axis, Entry};
use crate::canvas::{Canvas, Stroke};
use crate::sheet::framed;
use crate::style::{MARKERS, Marker, REFERENCE};
use crate::sweep::ramp;

/// Errors along which one parameter changes.
#[derive(Debug, Clone, PartialEq)]
pub struct SignedCurve {
    /// Words of the legend.
    pub label: String,
    /// Parameter and signed error.
    pub points: Vec<(f64, f64)>,
}

/// What a figure of signed errors shows.
#[derive(Debug, Clone, PartialEq)]
pub struct SignedFigure {
    /// Title.
    pub title: String,
    /// Name and unit of the parameter.
    pub x_label: String,
    /// Name of the error.
    pub y_label: String,
    /// Curves.
    pub curves: Vec<SignedCurve>,
}

/// Draws magnitudes: filled marks where the error is positive, hollow ones where it is negative. Where the sign changes
/// between two points the line is broken.
pub fn signed(figure: &SignedFigure) -> Canvas {
    let count = figure.curves.len();
    let look = |k: usize| (MARKERS[k % MARKERS.len()], ramp(k, count));
    let mut entries: Vec<Entry> = figure
        .curves
        .iter()
        .enumerate()
        .map(|(k, curve)| Entry::both(curve.label.as_str(), Stroke::whole(look(k).1, 2.0), look(k).0, false))
        .collect();
    for (text, hollow) in [("filled: too high", false), ("hollow: too low", true)] {
        entries.push(Entry::mark(text, Marker::Circle, REFERENCE, hollow));
    }
    let points = || figure.curves.iter().flat_map(|curve| &curve.points).filter(|point| point.1 != 0.0);
    let x = Axis::log(figure.x_label.as_str(), points().map(|point| point.0));
    let y = Axis::log_percent(figure.y_label.as_str(), points().map(|point| point.1.abs()));
    let (mut canvas, frame) = framed(680.0, (&figure.title, &figure.title), &entries, 8.0, (x, y));
    for (k, curve) in figure.curves.iter().enumerate() {
        let (marker, colour) = look(k);
        let mut seen: Vec<(f64, f64)> = curve.points.iter().copied().filter(|point| point.1 != 0.0).collect();
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        for piece in seen.chunk_by(|a, b| (a.1 > 0.0) == (b.1 > 0.0)) {
            frame.curve(&mut canvas, piece.iter().map(|point| (point.0, point.1.abs())), Stroke::whole(colour, 2.0));
        }
        for (x, error) in seen {
            canvas.marker(frame.spot(x, error.abs()), marker, 6.0, colour, error < 0.0);
        }
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_sign_breaks_the_line_and_hollows_the_mark() {
        let figure = |last: f64| SignedFigure {
            title: "t".into(),
            x_label: "x".into(),
            y_label: "y".into(),
            curves: vec![SignedCurve { label: "c".into(), points: vec![(1.0, 0.1), (2.0, 0.2), (4.0, last)] }],
        };
        let (same, turned) = (signed(&figure(0.4)), signed(&figure(-0.4)));
        assert!(same.svg().len() != turned.svg().len());
        assert_eq!(same.items.len() + 1, turned.items.len(), "a disc within the hollow mark, and the same lines");
    }
}
