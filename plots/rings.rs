//! Figures of a ring of freeze pipes: its wall, its gaps and its heat.

use frazil_record::{GapRow, RunResult, WallRow};

use crate::axes::{Axis, Entry};
use crate::canvas::{Canvas, Stroke};
use crate::sheet::framed;
use crate::style::{INK, Marker, REFERENCE, method_style, method_title};
use crate::words::{Words, reference_entry, reference_stroke};

const LONG: &[f64] = &[10.0, 6.0];

/// Thickness of the frozen wall over time.
pub(crate) fn wall(result: &RunResult, words: &Words) -> Canvas {
    let colour = method_style(&words.method).colour;
    let main = Stroke::whole(colour, 2.4);
    let interface = Stroke { colour, width: 2.4, dash: LONG };
    let reference = reference_stroke();
    let mut entries = Vec::new();
    if result.walls.iter().any(|row| row.thickness_main_mean_m.is_some()) {
        entries.push(Entry::line("through a pipe", main));
    }
    if result.walls.iter().any(|row| row.thickness_interface_mean_m.is_some()) {
        entries.push(Entry::line("between two pipes", interface));
    }
    let referred = result.walls.iter().any(|row| row.thickness_main_mean_ref_m.is_some());
    if referred || result.walls.iter().any(|row| row.thickness_interface_mean_ref_m.is_some()) {
        entries.push(reference_entry());
    }
    let x = Axis::linear(words.time_label.as_str(), times(result, words));
    let values = result.walls.iter().flat_map(|row| {
        [
            row.thickness_main_mean_m,
            row.thickness_interface_mean_m,
            row.thickness_main_mean_ref_m,
            row.thickness_interface_mean_ref_m,
        ]
    });
    let label = if words.length_unit.is_some() { "wall thickness (m)" } else { "wall thickness (dimensionless)" };
    let y = Axis::linear(label, values.flatten().chain([0.0]));
    let names = (&*words.name("Wall thickness over time"), &*words.heading);
    let (mut canvas, frame) = framed(640.0, names, &entries, 8.0, (x, y));
    let mut draw = |value: &dyn Fn(&WallRow) -> Option<f64>, stroke: Stroke| {
        let rows = result.walls.iter().filter_map(|row| Some((words.time(row.time_s), value(row)?)));
        frame.curve(&mut canvas, rows, stroke);
    };
    draw(&|row| row.thickness_main_mean_ref_m, reference);
    draw(&|row| row.thickness_interface_mean_ref_m, Stroke { dash: LONG, ..reference });
    draw(&|row| row.thickness_main_mean_m, main);
    draw(&|row| row.thickness_interface_mean_m, interface);
    canvas
}

/// Heat taken by one pipe over time.
pub(crate) fn heat(result: &RunResult, words: &Words) -> Canvas {
    let x = Axis::linear(words.time_label.as_str(), times(result, words));
    let label = if words.length_unit.is_some() { "heat taken by one pipe (W/m)" } else { "heat taken by one pipe" };
    let heats = || result.walls.iter().map(|row| row.heat_per_pipe_w_per_m);
    let mut sorted: Vec<f64> = heats().collect();
    sorted.sort_by(f64::total_cmp);
    // The jump at the start is without bound; the axis follows the rest.
    let most = sorted.get(sorted.len() * 19 / 20).copied().unwrap_or(1.0);
    let y = Axis::linear(label, heats().map(|heat| heat.min(1.3 * most.abs())).chain([0.0]));
    let names = (&*words.name("Heat per pipe over time"), &*words.heading);
    let (mut canvas, frame) = framed(560.0, names, &[], 14.0, (x, y));
    let rows = result.walls.iter().map(|row| (words.time(row.time_s), row.heat_per_pipe_w_per_m));
    frame.curve(&mut canvas, rows, Stroke::whole(method_style(&words.method).colour, 2.4));
    canvas
}

/// When each gap closed, by its angle in a ring, or its place in a row.
pub(crate) fn gaps(result: &RunResult, words: &Words) -> Canvas {
    let style = method_style(&words.method);
    let mut entries = vec![Entry::mark(method_title(&words.method), style.marker, style.colour, false)];
    if result.gaps.iter().any(|gap| gap.closure_ref_s.is_some()) {
        entries.push(Entry::mark("reference", Marker::Square, REFERENCE, true));
    }
    if result.gaps.iter().any(|gap| gap.closure_s.is_none()) {
        entries.push(Entry::note("× at the upper edge: not closed"));
    }
    let in_ring = result.gaps.iter().all(|gap| gap.angle_deg.is_some());
    let place = |gap: &GapRow| if in_ring { gap.angle_deg } else { gap.along_m }.unwrap_or_default();
    let name = match in_ring {
        true => "angle of the middle of the gap (degrees)".to_owned(),
        false => words.length_label("middle of the gap along the row"),
    };
    let x = Axis::linear(name, result.gaps.iter().map(place));
    let closures = result.gaps.iter().flat_map(|gap| [gap.closure_s, gap.closure_ref_s]).flatten();
    let mut values: Vec<f64> = closures.map(|time| words.time(time)).collect();
    let (low, high) = values.iter().fold((f64::INFINITY, 0f64), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
    if values.is_empty() {
        values = vec![0.0, 1.0];
    } else {
        // Room of at least a tenth, so that round-off is not drawn as scatter.
        let middle = 0.5 * (low + high);
        values.extend([middle * 0.95, middle * 1.05]);
    }
    let unit = if words.time_symbol.is_empty() { "dimensionless" } else { words.time_symbol };
    let y = Axis::linear(format!("time of closure ({unit})"), values.into_iter());
    let names = (&*words.name("Closure of the gaps"), &*words.heading);
    let (mut canvas, frame) = framed(560.0, names, &entries, 8.0, (x, y));
    for gap in &result.gaps {
        if let Some(time) = gap.closure_ref_s {
            canvas.marker(frame.spot(place(gap), words.time(time)), Marker::Square, 8.0, REFERENCE, true);
        }
        match gap.closure_s {
            Some(time) => {
                canvas.marker(frame.spot(place(gap), words.time(time)), style.marker, 5.5, style.colour, false);
            }
            None => canvas.cross(frame.spot(place(gap), frame.y.high), 6.0, Stroke::whole(INK, 2.2)),
        }
    }
    canvas
}

fn times(result: &RunResult, words: &Words) -> impl Iterator<Item = f64> {
    result.walls.iter().map(|row| words.time(row.time_s)).chain([0.0])
}
