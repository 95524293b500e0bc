//! Error against spacing, with slopes to compare by eye.

use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Align, Canvas, Stroke};
use crate::comparison::Look;
use crate::sheet::framed;
use crate::style::{REFERENCE, TICK};

/// The errors of one method and setting by spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderCurve {
    /// Method, which decides the look.
    pub method: String,
    /// Words of the legend.
    pub label: String,
    /// Whether it is drawn thin: the second curve of a method.
    pub second: bool,
    /// Spacing, error, and whether it is below ten times the error of the reference.
    pub points: Vec<(f64, f64, bool)>,
}

/// Draws error against spacing. `scale` turns spacings into the unit of `spacing_label`.
pub fn convergence(heading: &str, spacing_label: &str, scale: f64, error_label: &str, curves: &[OrderCurve]) -> Canvas {
    let entry = |curve: &OrderCurve| Look::of(&curve.method, curve.second).entry(&curve.label);
    let entries: Vec<Entry> = curves.iter().map(entry).collect();
    let points = || curves.iter().flat_map(|curve| &curve.points).filter(|point| point.1 > 0.0);
    let x = Axis::log(spacing_label, points().map(|point| scale * point.0));
    let y = Axis::log_percent(error_label, points().map(|point| point.1));
    let (mut canvas, frame) = framed(680.0, (heading, heading), &entries, 8.0, (x, y));
    triangles(&mut canvas, &frame);
    for curve in curves {
        let Look { style, width, radius } = Look::of(&curve.method, curve.second);
        frame.curve(&mut canvas, curve.points.iter().map(|point| (scale * point.0, point.1)), style.stroke(width));
        for (spacing, error, hollow) in curve.points.iter().filter(|point| point.1 > 0.0) {
            canvas.marker(frame.spot(scale * spacing, *error), style.marker, radius, style.colour, *hollow);
        }
    }
    canvas
}

/// Slopes of order one and two in the lower right corner, where converging curves do not go.
fn triangles(canvas: &mut Canvas, frame: &Frame) {
    let decades = (frame.x.high / frame.x.low).log10();
    let right = frame.x.high / 10f64.powf(0.07 * decades);
    let left = right / 10f64.powf(0.14 * decades);
    let rise = right / left;
    let bottom = frame.y.low * 10f64.powf(0.06 * (frame.y.high / frame.y.low).log10());
    let stroke = Stroke::whole(REFERENCE, 1.8);
    let corner = frame.spot(right, bottom);
    let start = frame.spot(left, bottom);
    for order in [1, 2] {
        let peak = frame.spot(right, (bottom * rise.powi(order)).min(frame.y.high));
        canvas.line(vec![start, peak], stroke);
        canvas.text((peak.0 + 6.0, peak.1 + 0.3 * TICK), order.to_string(), TICK, Align::Start);
    }
    let peak = frame.spot(right, (bottom * rise * rise).min(frame.y.high));
    canvas.line(vec![start, corner, peak], stroke);
    canvas.text((start.0 - 8.0, corner.1 - 2.0), "order", TICK - 2.0, Align::End);
}
