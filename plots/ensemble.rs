//! Figures of an ensemble: means with bands of their intervals, members as thin lines, references.

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Colour, Stroke};
use crate::run::aged;
use crate::sheet::{WIDTH, grown};
use crate::style::{BLUE, DASH_DOT, LONG, OLIVE, ORANGE, PURPLE, REFERENCE, SHORT, method_style, method_title};
use crate::words::{DOTS, reference_entry, reference_stroke};

/// How far bands, their edges and members are on their way from the colour of their curve to white.
const BAND: f64 = 0.68;
const EDGE: f64 = 0.3;
const THIN: f64 = 0.45;

/// A mean and half the width of its interval; zero where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Place along the axis.
    pub x: f64,
    /// Mean.
    pub mean: f64,
    /// Half width of the interval.
    pub half_width: f64,
}

/// How a curve looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// The n-th of curves that stand for different things.
    Kind(usize),
    /// The n-th of so many instants of the same thing.
    Instant(usize, usize),
}

/// A mean over the members.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Words of the legend.
    pub name: String,
    /// Its look.
    pub look: Look,
    /// The mean.
    pub points: Vec<Point>,
    /// The members; may be left out.
    pub members: Vec<Vec<(f64, f64)>>,
    /// The reference, where it is known.
    pub reference: Vec<(f64, f64)>,
}

/// Curves on the same axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Words of the axis to the right; none if the panel below has them.
    pub x_label: String,
    /// Words of the axis upwards.
    pub y_label: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Whether these are errors: around zero, and cut off where a tenth of them is far beyond the others.
    pub errors: bool,
}

/// Panels below each other.
#[derive(Debug, Clone, PartialEq)]
pub struct BandFigure {
    /// Title of the scene.
    pub heading: String,
    /// Method.
    pub method: String,
    /// Number of members.
    pub members: usize,
    /// The panels.
    pub panels: Vec<Panel>,
}

/// Looks of curves after the first, which has the colour of the method.
const LOOKS: [(Colour, &[f64]); 4] = [(BLUE, LONG), (ORANGE, SHORT), (PURPLE, DASH_DOT), (OLIVE, &[2.5, 3.5])];

fn stroke(method: &str, look: Look) -> Stroke {
    let own = method_style(method).colour;
    match look {
        // Darker than the method's own, so that a grey print tells it from the reference.
        Look::Kind(0) => Stroke::whole(own.shade(0.4), 2.4),
        Look::Kind(k) => {
            let (colour, dash) = LOOKS[(k - 1) % LOOKS.len()];
            Stroke { colour, width: 2.4, dash }
        }
        Look::Instant(k, count) => Stroke::whole(aged(own, k, count), 2.4),
    }
}

/// Draws an ensemble.
pub fn bands(figure: &BandFigure) -> Canvas {
    const EACH: f64 = 300.0;
    /// What a panel with words below it is higher by (px).
    const FOOT: f64 = 56.0;
    let heading = format!("{} — {}, {} members", figure.heading, method_title(&figure.method), figure.members);
    let height = |panel: &Panel| if panel.x_label.is_empty() { EACH } else { EACH + FOOT };
    let all = figure.panels.iter().map(height).sum::<f64>();
    let (mut canvas, mut at) = grown(&heading, &entries(figure), 6.0, |top| top + all);
    let mut frames: Vec<Frame> = Vec::new();
    for panel in &figure.panels {
        let all = || figure.panels.iter().filter(|other| panel.x_label.is_empty() || other.x_label == panel.x_label);
        let places = all().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points).map(|point| point.x);
        let x = Axis::linear(panel.x_label.as_str(), places.chain([0.0]));
        let next = at + height(panel);
        frames.push(Frame::inside((0.0, at), (WIDTH, next - 14.0), x, upwards(panel)));
        at = next;
    }
    align(&mut frames);
    for (frame, panel) in frames.iter().zip(&figure.panels) {
        draw(&mut canvas, frame, panel, &figure.method);
    }
    canvas
}

fn entries(figure: &BandFigure) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let curves = || figure.panels.iter().flat_map(|panel| &panel.curves);
    for curve in curves() {
        if !entries.iter().any(|entry| entry.text == curve.name) {
            entries.push(Entry::line(curve.name.as_str(), stroke(&figure.method, curve.look)));
        }
    }
    let Some(first) = curves().next() else { return entries };
    let colour = stroke(&figure.method, first.look).colour;
    if curves().flat_map(|curve| &curve.points).any(|point| point.half_width > 0.0) {
        entries.push(Entry::line("95 % interval of the mean", Stroke::whole(colour.tint(BAND), 12.0)));
    }
    if curves().any(|curve| !curve.members.is_empty()) {
        entries.push(Entry::line("members", Stroke::whole(colour.tint(THIN), 0.7)));
    }
    if let Some(curve) = curves().find(|curve| !curve.reference.is_empty()) {
        entries.push(match curve.look {
            Look::Kind(_) => reference_entry(),
            Look::Instant(..) => Entry::line("reference", DOTS),
        });
    }
    entries
}

fn upwards(panel: &Panel) -> Axis {
    let points = || panel.curves.iter().flat_map(|curve| &curve.points);
    let ends = points().flat_map(|point| [point.mean - point.half_width, point.mean + point.half_width]);
    if !panel.errors {
        let lines = panel.curves.iter().flat_map(|curve| curve.members.iter().chain([&curve.reference]));
        return Axis::linear(panel.y_label.as_str(), ends.chain(lines.flatten().map(|(_, y)| *y)));
    }
    let mut sizes: Vec<f64> = ends.map(f64::abs).filter(|size| size.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    // The first instants, when a front is thinner than a particle, would hide all others.
    let most = sizes.get(sizes.len() * 9 / 10).map_or(0.01, |size| 1.6 * size).max(1e-9);
    let shown = points().flat_map(|point| [point.mean - point.half_width, point.mean + point.half_width]);
    Axis::linear(panel.y_label.as_str(), shown.map(|end| end.clamp(-most, most)).chain([0.0]))
}

fn draw(canvas: &mut Canvas, frame: &Frame, panel: &Panel, method: &str) {
    let look = |curve: &Curve| stroke(method, curve.look);
    for curve in &panel.curves {
        let band = look(curve).colour.tint(BAND);
        for points in curve.points.split(|point| !(point.mean.is_finite() && point.half_width.is_finite())) {
            let edge = |point: &Point, sign: f64| {
                let y = (point.mean + sign * point.half_width).clamp(frame.y.low, frame.y.high);
                frame.spot(point.x, y)
            };
            if points.iter().any(|point| point.half_width > 0.0) {
                let upper = points.iter().map(|point| edge(point, 1.0));
                let lower = points.iter().rev().map(|point| edge(point, -1.0));
                canvas.area(upper.chain(lower).collect(), band);
            }
        }
    }
    // Grid and ticks over the bands.
    frame.draw(canvas);
    if panel.errors {
        frame.level(canvas, 0.0, Stroke::whole(REFERENCE, 1.5));
    }
    for curve in &panel.curves {
        if matches!(curve.look, Look::Kind(_)) {
            frame.curve(canvas, curve.reference.iter().copied(), reference_stroke());
        }
        let thin = Stroke::whole(look(curve).colour.tint(THIN), 0.7);
        for member in &curve.members {
            frame.curve(canvas, member.iter().copied(), thin);
        }
        // Members, and bands of other curves, may cover a band; they do not cover its edges.
        for sign in [1.0, -1.0].into_iter().filter(|_| curve.points.iter().any(|point| point.half_width > 0.0)) {
            let edge = curve.points.iter().map(|point| (point.x, point.mean + sign * point.half_width));
            frame.curve(canvas, edge, Stroke::whole(look(curve).colour.tint(EDGE), 1.0));
        }
    }
    for curve in &panel.curves {
        frame.curve(canvas, curve.points.iter().map(|point| (point.x, point.mean)), look(curve));
    }
    for curve in panel.curves.iter().filter(|curve| matches!(curve.look, Look::Instant(..))) {
        frame.curve(canvas, curve.reference.iter().copied(), DOTS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Item;

    #[test]
    fn bands_and_members_stay_inside_their_frame() {
        let points = [(1.0, 1.0, 0.2), (2.0, 1.5, f64::NAN), (3.0, 90.0, 5.0), (4.0, 2.0, 0.1), (5.0, 2.0, 0.1)];
        let points = points.map(|(x, mean, half_width)| Point { x, mean, half_width }).to_vec();
        let members = vec![vec![(1.0, -900.0), (5.0, 900.0)]];
        let curve = Curve { name: "front".into(), look: Look::Kind(0), points, members, reference: Vec::new() };
        let panel = Panel { x_label: "time".into(), y_label: "error".into(), curves: vec![curve], errors: true };
        let figure = BandFigure { heading: "t".into(), method: "edpd".into(), members: 3, panels: vec![panel] };
        let canvas = bands(&figure);
        let mut areas = 0;
        for item in &canvas.items {
            if let Item::Area { ring, .. } = item {
                areas += 1;
                assert!(ring.iter().all(|(x, y)| (0.0..=1000.0).contains(x) && (46.0..=canvas.height).contains(y)));
            }
        }
        // A point without an interval of numbers parts the band; a point alone has no area.
        assert_eq!(areas, 1);
    }
}
