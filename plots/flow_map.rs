//! Figures of flowing water: maps of the pressure with arrows along the flow, and ice over time.

use frazil_record::{Field, FlowPoint, WaterRow};

use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Align, Canvas};
use crate::ground_plan::arrow;
use crate::map::{Look, draw_in, notes_at};
use crate::sheet::framed;
use crate::style::{LABEL, method_style, method_title, number};
use crate::words::{FigureOptions, Words, reference_entry, reference_stroke};

/// Distance between arrows, and length of that of the fastest water (px).
const BETWEEN: f64 = 52.0;
const LONGEST: f64 = 40.0;

/// Arrows below this share of the longest are left out.
const LEAST: f64 = 0.02;

/// The map of pressures of an instant. Ice, in which freezing makes pressures that move no water, is left white; colours lie
/// between the pressures of walls.
pub(crate) fn pressure_map(
    field: &Field,
    points: &[FlowPoint],
    options: &FigureOptions,
    words: &Words,
) -> Option<Canvas> {
    let walls = options.pressures;
    let (nx, ny) = (field.nx, field.ny);
    let mut pressures = vec![f64::NAN; nx * ny];
    let mut velocities = vec![(0.0, 0.0); nx * ny];
    for point in points {
        let place = |at: f64, from: f64| ((at - from) / field.spacing_m).round();
        let (column, row) = (place(point.x_m, field.x0_m), place(point.y_m, field.y0_m));
        if column >= 0.0 && row >= 0.0 && (column as usize) < nx && (row as usize) < ny {
            let cell = row as usize * nx + column as usize;
            if point.frozen_fraction < 0.5 {
                pressures[cell] = point.pressure_pa.clamp(walls.0, walls.1);
            }
            velocities[cell] = (point.velocity_x_m_per_s, point.velocity_y_m_per_s);
        }
    }
    let fastest = velocities.iter().map(|(x, y)| f64::hypot(*x, *y)).fold(0.0, f64::max);
    if walls.1 <= walls.0 || fastest <= 0.0 {
        return None;
    }
    let shown = Field { temperature_c: pressures, temperature_ref_c: Vec::new(), ..field.clone() };
    let look = Look {
        heading: format!("{}, {}", words.heading, words.instant(field.time_s)),
        kind: "Pressure",
        label: "pressure (Pa)".into(),
        range: Some(walls),
        // One scale of colours.
        zero: Some(walls.0 - 0.12 * (walls.1 - walls.0)),
    };
    let (mut canvas, frame) = draw_in(&shown, words, &look);
    let cell = (frame.right - frame.left) / nx as f64;
    let stride = (BETWEEN / cell).ceil().max(1.0) as usize;
    for row in (stride.min(ny) / 2..ny).step_by(stride) {
        for column in (stride.min(nx) / 2..nx).step_by(stride) {
            let (x, y) = velocities[row * nx + column];
            let share = f64::hypot(x, y) / fastest;
            if share >= LEAST {
                let at = |first: f64, index: usize| first + index as f64 * field.spacing_m;
                let middle = frame.spot(at(field.x0_m, column), at(field.y0_m, row));
                let arm = (LONGEST * x / fastest, -LONGEST * y / fastest);
                arrow(&mut canvas, (middle.0 - 0.5 * arm.0, middle.1 - 0.5 * arm.1), arm);
            }
        }
    }
    options.plan.draw(&mut canvas, &frame, field.time_s);
    let undisturbed = options.plan.water.as_ref().map(|water| water.words(field.time_s));
    note(&mut canvas, &frame, fastest, undisturbed);
    Some(canvas)
}

/// Says how fast the longest arrow is, under the map, and how fast water is that nothing disturbs.
fn note(canvas: &mut Canvas, frame: &Frame, fastest: f64, undisturbed: Option<String>) {
    let y = notes_at(frame);
    arrow(canvas, (frame.left, y - 0.34 * LABEL), (LONGEST, 0.0));
    let of_all = undisturbed.map_or(String::new(), |words| format!(", undisturbed {words}"));
    let words = format!("{} µm/s{of_all}", number(1e6 * fastest, 2));
    canvas.text((frame.left + LONGEST + 8.0, y), words, LABEL, Align::Start);
}

/// Ice over time, beside the reference's.
pub(crate) fn ice(rows: &[WaterRow], words: &Words) -> Canvas {
    let stroke = method_style(&words.method).stroke(2.2);
    let mut entries = vec![Entry::line(method_title(&words.method), stroke)];
    let reference = || rows.iter().filter_map(|row| Some((words.time(row.time_s), row.ice_fraction_ref?)));
    if reference().next().is_some() {
        entries.push(reference_entry());
    }
    let own = || rows.iter().map(|row| (words.time(row.time_s), row.ice_fraction));
    let x = Axis::linear(words.time_label.as_str(), own().map(|point| point.0));
    let y = Axis::linear("ice over that of the start (1)", own().chain(reference()).map(|point| point.1).chain([0.0]));
    let names = (&*words.name("Ice over time"), &*words.heading);
    let (mut canvas, frame) = framed(640.0, names, &entries, 6.0, (x, y));
    frame.curve(&mut canvas, reference(), reference_stroke());
    frame.curve(&mut canvas, own(), stroke);
    canvas
}
