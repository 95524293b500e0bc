//! The same layouts under several methods: how far their answers lie apart.

use super::view::wrapped;
use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Align, Canvas, Stroke, text_width};
use crate::sheet::{MARGIN, WIDTH, grown};
use crate::style::{GRID, LABEL, TICK, method_style};

/// A number and what the spacing still changes of it.
pub type Answer = (f64, Option<f64>);

/// What a method says of a layout.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodView {
    /// The method.
    pub method: String,
    /// Day of closure, thickness (m), mean temperature, load (W/m); absent where there is none.
    pub answers: [Option<Answer>; 4],
}

/// A layout and what each method says of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodsView {
    /// Name of the layout.
    pub layout: String,
    /// Methods that ran.
    pub methods: Vec<MethodView>,
}

/// What stands below the panels.
const LABELS: [&str; 4] = ["wall closed (d)", "thickness (m)", "mean (°C)", "load (W/m)"];

/// Answers of the methods, a row for each layout, with bars as wide as what the spacing still changes.
pub fn methods(layouts: &[MethodsView]) -> Canvas {
    let mut names: Vec<&str> = Vec::new();
    for view in layouts.iter().flat_map(|layout| &layout.methods) {
        if !names.contains(&view.method.as_str()) {
            names.push(&view.method);
        }
    }
    let mut entries: Vec<Entry> = names
        .iter()
        .map(|name| {
            let style = method_style(name);
            Entry::mark(*name, style.marker, style.colour, false)
        })
        .collect();
    entries.push(Entry::note("bars: change from twice the spacing"));
    if layouts.iter().flat_map(|layout| &layout.methods).any(|view| view.answers[0].is_none()) {
        entries.push(Entry::note("× at the rim: not closed"));
    }
    let row = (14.0 * names.len() as f64 + 16.0).max(3.0 * TICK);
    let foot = 2.2 * TICK + 1.4 * LABEL;
    let rows = row * layouts.len().max(1) as f64;
    let heading = "The same layouts under several methods";
    let (mut canvas, top) = grown(heading, &entries, 8.0, |top| top + rows + foot);
    let bottom = top + rows;
    let lines: Vec<Vec<String>> = layouts.iter().map(|layout| wrapped(&layout.layout, TICK, true, 180.0)).collect();
    let left = MARGIN + 14.0 + lines.iter().flatten().map(|line| text_width(line, TICK, true)).fold(60.0, f64::max);
    for (k, lines) in lines.iter().enumerate() {
        let first = top + (k as f64 + 0.5) * row + 0.36 * TICK - 0.6 * TICK * (lines.len() - 1) as f64;
        for (line, text) in lines.iter().enumerate() {
            canvas.bold((MARGIN, first + 1.2 * TICK * line as f64), text.as_str(), TICK, Align::Start);
        }
    }
    let width = (WIDTH - left - 12.0) / LABELS.len() as f64;
    for (panel, label) in LABELS.iter().enumerate() {
        let answers = || layouts.iter().flat_map(|layout| &layout.methods).filter_map(|view| view.answers[panel]);
        let x = spread(
            label,
            answers().flat_map(|(value, error)| [value - error.unwrap_or(0.0), value + error.unwrap_or(0.0)]),
        );
        let from = left + width * panel as f64;
        let frame = Frame { left: from + 14.0, top, right: from + width - 14.0, bottom, x, y: Axis::columns("", &[]) };
        frame.draw(&mut canvas);
        for (k, layout) in layouts.iter().enumerate() {
            let y = |place: usize| {
                top + k as f64 * row + 0.5 * (row - 14.0 * (names.len() - 1) as f64) + 14.0 * place as f64
            };
            if k > 0 {
                let line = top + k as f64 * row;
                canvas.line(vec![(frame.left, line), (frame.right, line)], Stroke::whole(GRID, 1.2));
            }
            for view in &layout.methods {
                let style = method_style(&view.method);
                let y = y(names.iter().position(|name| *name == view.method).unwrap_or(0));
                let Some((value, error)) = view.answers[panel] else {
                    canvas.cross((frame.right - 9.0, y), 5.0, Stroke::whole(style.colour, 2.2));
                    continue;
                };
                let at = |value: f64| frame.spot(value, 0.0).0;
                if let Some(error) = error {
                    canvas.line(vec![(at(value - error), y), (at(value + error), y)], Stroke::whole(style.colour, 1.8));
                }
                canvas.marker((at(value), y), style.marker, 5.0, style.colour, false);
            }
        }
    }
    canvas
}

/// An axis that holds all values and not zero, for differences are to be seen; few ticks fit.
fn spread(label: &str, values: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |range, value| (range.0.min(value), range.1.max(value)));
    if low > high {
        return Axis::between_few(label, 0.0, 1.0);
    }
    let room = 0.06 * (high - low).max(0.02 * high.abs()).max(1e-9);
    Axis::between_few(label, low - room, high + room)
}
