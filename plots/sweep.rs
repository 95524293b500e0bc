//! A result over a key that is varied: a curve for each combination of the others.

use crate::axes::{Axis, Entry};
use crate::canvas::{Canvas, Colour, Stroke};
use crate::sheet::framed;
use crate::style::MARKERS;

/// Ratio of the greatest to the least of positive values from which on an axis is logarithmic.
const DECADES: f64 = 100.0;

/// Values of the key along the horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Places {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Words, in columns.
    Words(Vec<String>),
}

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepCurve {
    /// Words of the legend.
    pub label: String,
    /// A value for each place, where there is one.
    pub values: Vec<Option<f64>>,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepFigure {
    /// Title.
    pub title: String,
    /// The key.
    pub x_label: String,
    /// Name and unit of the result.
    pub y_label: String,
    /// Values of the key.
    pub places: Places,
    /// Curves.
    pub curves: Vec<SweepCurve>,
}

/// The colour of a curve among others: from dark blue to light orange, which differ in a grey print too.
pub(crate) fn ramp(k: usize, count: usize) -> Colour {
    let share = k as f64 / (count.max(2) - 1) as f64;
    let mix = |from: f64, to: f64| (from + share * (to - from)).round() as u8;
    Colour(mix(11.0, 240.0), mix(60.0, 160.0), mix(140.0, 50.0))
}

/// An axis of numbers: logarithmic where positive values span decades.
fn axis(label: &str, values: &[f64]) -> Axis {
    let (least, most) = values.iter().fold((f64::INFINITY, 0.0f64), |(a, b), value| (a.min(*value), b.max(*value)));
    if least > 0.0 && most >= DECADES * least {
        Axis::log(label, values.iter().copied())
    } else {
        Axis::linear(label, values.iter().copied())
    }
}

/// Draws the curves.
pub fn sweep(figure: &SweepFigure) -> Canvas {
    let count = figure.curves.len();
    // Curves may lie on each other: later ones are finer, so that earlier ones are seen behind them.
    let fine = |k: usize| 1.0 - k as f64 / count.max(1) as f64;
    let look = |k: usize| (MARKERS[k % MARKERS.len()], Stroke::whole(ramp(k, count), 1.5 + 2.5 * fine(k)));
    let entry = |(k, curve): (usize, &SweepCurve)| Entry::both(curve.label.as_str(), look(k).1, look(k).0, false);
    let named = figure.curves.iter().any(|curve| !curve.label.is_empty());
    let entries: Vec<Entry> = figure.curves.iter().enumerate().filter(|_| named).map(entry).collect();
    let found: Vec<f64> = figure.curves.iter().flat_map(|curve| curve.values.iter().copied().flatten()).collect();
    let (x, places) = match &figure.places {
        Places::Numbers(numbers) => (axis(&figure.x_label, numbers), numbers.clone()),
        Places::Words(words) => {
            (Axis::columns(figure.x_label.as_str(), words), (0..words.len()).map(|k| k as f64 + 0.5).collect())
        }
    };
    let axes = (x, axis(&figure.y_label, &found));
    let (mut canvas, frame) = framed(620.0, (&figure.title, &figure.title), &entries, 8.0, axes);
    for (k, curve) in figure.curves.iter().enumerate() {
        let (marker, stroke) = look(k);
        let mut points: Vec<(f64, f64)> =
            places.iter().zip(&curve.values).map(|(place, value)| (*place, value.unwrap_or(f64::NAN))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        frame.curve(&mut canvas, points.iter().copied(), stroke);
        for (x, y) in points.into_iter().filter(|point| point.1.is_finite()) {
            canvas.marker(frame.spot(x, y), marker, 4.0 + 4.0 * fine(k), stroke.colour, false);
        }
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(places: Places, values: &[Option<f64>]) -> SweepFigure {
        SweepFigure {
            title: "t".into(),
            x_label: "x".into(),
            y_label: "y".into(),
            places,
            curves: vec![SweepCurve { label: "c".into(), values: values.to_vec() }],
        }
    }

    #[test]
    fn a_missing_value_breaks_the_curve_and_has_no_mark() {
        let places = || Places::Numbers(vec![1.0, 2.0, 3.0, 4.0, 5.0]);
        let whole = sweep(&figure(places(), &[Some(1.0), Some(2.0), Some(2.5), Some(3.0), Some(4.0)]));
        let broken = sweep(&figure(places(), &[Some(1.0), Some(2.0), None, Some(3.0), Some(4.0)]));
        assert_eq!(whole.items.len(), broken.items.len(), "a line more, a mark less");
        let empty = sweep(&figure(Places::Words(vec!["a".into(), "b".into()]), &[None, None]));
        assert!(empty.items.len() < broken.items.len());
    }

    #[test]
    fn values_over_decades_have_a_logarithmic_axis() {
        assert!(axis("y", &[1.0, 100.0]).log);
        assert!(!axis("y", &[1.0, 99.0]).log && !axis("y", &[0.0, 100.0]).log && !axis("y", &[-1.0, 100.0]).log);
    }
}
