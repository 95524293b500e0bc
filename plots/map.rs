//! Temperature maps: bands of equal temperature, isotherms, and the front heavy.

use frazil_record::Field;

use crate::axes::{Axis, Frame, nice_step};
use crate::canvas::{Align, Canvas, Colour, Stroke, text_width};
use crate::grid::Grid;
use crate::ground_plan::GroundPlan;
use crate::sheet::title;
use crate::style::{INK, LABEL, TICK, number};
use crate::words::Words;

/// Width of the line of the front (px).
const FRONT_WIDTH: f64 = 3.2;

/// Height of the line of notes, which stands below the name of the axis (px).
const NOTES: f64 = 1.5 * LABEL;

/// Where that line is (px).
pub(crate) fn notes_at(frame: &Frame) -> f64 {
    frame.bottom + 2.0 * TICK + LABEL + NOTES
}

/// Least length of either side of a map (px).
const SHORTEST: f64 = 260.0;

/// What a map shows beside its field.
pub(crate) struct Look {
    pub heading: String,
    /// What it is a map of.
    pub kind: &'static str,
    /// Name and unit of the values.
    pub label: String,
    /// Ends of the colours; those of the field if absent.
    pub range: Option<(f64, f64)>,
    /// Where the colours turn; absent where all are warm.
    pub zero: Option<f64>,
}

/// The map of a run and, where the reference has one, beside it the reference and the difference.
pub(crate) fn temperature_map(field: &Field, plan: &GroundPlan, words: &Words) -> Canvas {
    let Some(Beside { reference, difference, range, most }) = Beside::of(field) else {
        return plain_map(field, plan, words, None);
    };
    let named = |name: &str| format!("{name}, {}", words.instant(field.time_s));
    let difference_look = Look {
        label: words.temperature_label.replace("temperature", "difference"),
        zero: Some(0.0),
        ..Look::temperatures(named("Difference"), words, Some((-most, most)))
    };
    Canvas::beside(&[
        plain_map(field, plan, words, Some(range)),
        draw_over(&reference, plan, words, &Look::temperatures(named("Reference"), words, Some(range))),
        draw_over(&difference, plan, words, &difference_look),
    ])
}

/// What a reference has beside a field.
pub(crate) struct Beside {
    /// The reference.
    pub(crate) reference: Field,
    /// What the field has more than it.
    pub(crate) difference: Field,
    /// Least and greatest value of both.
    range: (f64, f64),
    /// Greatest magnitude of the difference.
    pub(crate) most: f64,
}

impl Beside {
    /// Of a field whose reference is known.
    pub(crate) fn of(field: &Field) -> Option<Beside> {
        if field.temperature_ref_c.is_empty() {
            return None;
        }
        // What only one of both knows is not compared.
        let known = |pair: (&f64, &f64), value: f64| if (pair.0 + pair.1).is_finite() { value } else { f64::NAN };
        let pairs = || field.temperature_c.iter().zip(&field.temperature_ref_c);
        let range = extremes(field.temperature_c.iter().chain(&field.temperature_ref_c));
        let reference =
            Field { temperature_c: field.temperature_ref_c.clone(), frozen_fraction: Vec::new(), ..field.clone() };
        let difference =
            Field { temperature_c: pairs().map(|pair| known(pair, pair.0 - pair.1)).collect(), ..field.clone() };
        let (low, high) = extremes(&difference.temperature_c);
        // A difference of rounding is none.
        let most = low.abs().max(high.abs()).max(1e-9 * (range.1 - range.0));
        Some(Beside { reference, difference, range, most })
    }
}

/// A map without a reference, as the frames of an animation are, with colours between these ends or those of the field.
pub(crate) fn plain_map(field: &Field, plan: &GroundPlan, words: &Words, range: Option<(f64, f64)>) -> Canvas {
    let heading = format!("{}, {}", words.heading, words.instant(field.time_s));
    draw_over(field, plan, words, &Look::temperatures(heading, words, range))
}

impl Look {
    fn temperatures(heading: String, words: &Words, range: Option<(f64, f64)>) -> Look {
        Look { heading, kind: "Temperature", label: words.temperature_label.clone(), range, zero: words.freezing_point }
    }
}

/// The map of a property that varies at random, by its logarithm over what the materials have.
pub(crate) fn ground_map(name: &str, field: &Field, words: &Words) -> Canvas {
    let label = format!("ln of the {name} over its material's (1)");
    let look = Look { heading: words.heading.clone(), kind: "Ground", label, range: None, zero: Some(0.0) };
    draw_over(field, &GroundPlan::default(), words, &look)
}

/// Least and greatest of the values that are there.
pub(crate) fn extremes<'a>(values: impl IntoIterator<Item = &'a f64>) -> (f64, f64) {
    let present = values.into_iter().filter(|value| value.is_finite());
    present.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

/// Part of the range of a map at either end of it that has no isotherms.
const ENDS: f64 = 0.02;

/// Part of a band by which bands are painted below their edges, and by which values may lie beyond all: an even body is often at an edge, where
/// rounding would decide the colour.
const EVEN: f64 = 1e-3;

/// A map with what stands in its plan.
pub(crate) fn draw_over(field: &Field, plan: &GroundPlan, words: &Words, look: &Look) -> Canvas {
    let (mut canvas, frame) = draw_in(field, words, look);
    plan.draw(&mut canvas, &frame, field.time_s);
    plan.note(&mut canvas, &frame, field.time_s);
    canvas
}

/// A map without anything in it, with its heading and what it is a map of, and the frame that it is in.
pub(crate) fn blank(field: &Field, words: &Words, heading: &str, kind: &str) -> (Canvas, Frame) {
    let (width, height) = (field.nx as f64 * field.spacing_m, field.ny as f64 * field.spacing_m);
    let side = (840.0 / width).min(700.0 / height);
    // Both directions have one scale, but for bodies so long that their labels would not fit beside them.
    let (frame_width, frame_height) = ((width * side).max(SHORTEST), (height * side).max(SHORTEST));
    let canvas_width = (frame_width + 250.0).max(620.0);
    let canvas_height = frame_height + 132.0 + NOTES;
    let mut canvas = Canvas::new(canvas_width, canvas_height, &format!("{kind} map: {heading}"));
    title(&mut canvas, heading);
    let (x0, y0) = (field.x0_m - 0.5 * field.spacing_m, field.y0_m - 0.5 * field.spacing_m);
    let unit = if words.length_unit.is_some() { "m" } else { "dimensionless" };
    let frame = Frame {
        left: 90.0,
        top: 60.0,
        right: 90.0 + frame_width,
        bottom: 60.0 + frame_height,
        x: Axis::between(format!("{} ({unit})", words.axes.0), x0, x0 + width),
        y: Axis::between(format!("{} ({unit})", words.axes.1), y0, y0 + height),
    };
    frame.draw(&mut canvas);
    (canvas, frame)
}

/// A map, and the frame that it is in.
pub(crate) fn draw_in(field: &Field, words: &Words, look: &Look) -> (Canvas, Frame) {
    let (mut canvas, frame) = blank(field, words, &look.heading, look.kind);
    let grid = Grid::thinned(field);
    let (low, high) = look.range.unwrap_or_else(|| extremes(&field.temperature_c));
    if low.is_finite() {
        let step = band_step(high - low);
        let colours = Ramp { low, high, zero: look.zero.unwrap_or(low) };
        let first = (low / step + EVEN).floor() as i64;
        let last = ((high / step - EVEN).ceil() as i64).max(first + 1);
        let mut edges: Vec<f64> = (first..=last).map(|k| k as f64 * step).collect();
        let is_turn = |zero: &f64| *zero > edges[0] && *zero < edges[edges.len() - 1];
        if let Some(zero) = look.zero.filter(is_turn) {
            // The colour turns exactly where the ground freezes.
            edges.push(zero);
            edges.sort_by(f64::total_cmp);
            edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * step);
        }
        let bands: Vec<Colour> = edges.windows(2).map(|band| colours.at(0.5 * (band[0] + band[1]))).collect();
        let levels: Vec<f64> = edges[1..edges.len() - 1].iter().map(|edge| edge - EVEN * step).collect();
        grid.paint_bands(&mut canvas, &frame, &levels, &bands);
        let isotherm = isotherm_step(high - low);
        for k in (low / isotherm).ceil() as i64..=(high / isotherm).floor() as i64 {
            let level = k as f64 * isotherm;
            // At the ends of the range a line would follow the rounding of what is even, or its noise.
            let inside = (level - low).min(high - level) > ENDS * (high - low);
            let is_apart = look.zero.is_none_or(|zero| (level - zero).abs() > 0.2 * isotherm);
            if inside && is_apart {
                grid.draw_isotherm(&mut canvas, &frame, level, Stroke::whole(INK, 0.9));
            }
        }
        let front = Stroke::whole(INK, FRONT_WIDTH);
        let frozen = grid.has_front();
        // The heavy line belongs to a temperature only where it is an isotherm.
        let is_isotherm = !frozen && look.label == words.temperature_label;
        let freezing_point = words.freezing_point.filter(|point| is_isotherm && look.zero == Some(*point));
        if frozen {
            grid.draw_level(&mut canvas, &frame, &grid.frozen, 0.5, front);
        } else if let Some(point) = freezing_point {
            grid.draw_level(&mut canvas, &frame, &grid.values, point, front);
        }
        grid.cover_outside(&mut canvas, &frame);
        colour_bar(&mut canvas, &frame, &edges, &colours, isotherm, freezing_point, look);
        match freezing_point {
            _ if frozen => front_note(&mut canvas, &frame, "front (half frozen)".into()),
            Some(point) => {
                front_note(&mut canvas, &frame, format!("{}{}, freezing point", number(point, 3), words.degree))
            }
            None => {}
        }
    }
    canvas.outline((frame.left, frame.top), (frame.right, frame.bottom), Stroke::whole(INK, 1.3));
    (canvas, frame)
}

fn band_step(span: f64) -> f64 {
    nice_step((span / 24.0).max(1e-9))
}

/// Five kelvin where that gives a readable number of lines.
fn isotherm_step(span: f64) -> f64 {
    if (8.0..=80.0).contains(&span) { 5.0 } else { nice_step((span / 8.0).max(1e-9)) }
}

/// Blue below the freezing point and warm above, lighter towards it, darkest at the cold end.
struct Ramp {
    low: f64,
    high: f64,
    zero: f64,
}

impl Ramp {
    fn at(&self, temperature: f64) -> Colour {
        const COLD: [Colour; 4] =
            [Colour(0xe4, 0xef, 0xf7), Colour(0x9c, 0xc6, 0xe3), Colour(0x3f, 0x86, 0xc0), Colour(0x0c, 0x2f, 0x6b)];
        const WARM: [Colour; 3] = [Colour(0xfd, 0xf1, 0xdd), Colour(0xf5, 0xc2, 0x7d), Colour(0xd9, 0x7a, 0x3a)];
        let (ramp, part): (&[Colour], f64) = if temperature < self.zero {
            (&COLD, (self.zero - temperature) / (self.zero - self.low).max(1e-12))
        } else {
            (&WARM, (temperature - self.zero) / (self.high - self.zero).max(1e-12))
        };
        along(ramp, part)
    }
}

/// The colour at a share of the way through colours.
pub(crate) fn along(ramp: &[Colour], part: f64) -> Colour {
    let place = part.clamp(0.0, 1.0) * (ramp.len() - 1) as f64;
    let index = (place as usize).min(ramp.len() - 2);
    let (a, b, share) = (ramp[index], ramp[index + 1], place - index as f64);
    let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    Colour(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

fn colour_bar(
    canvas: &mut Canvas,
    frame: &Frame,
    edges: &[f64],
    colours: &Ramp,
    isotherm: f64,
    freezing_point: Option<f64>,
    look: &Look,
) {
    let (left, right) = (frame.right + 30.0, frame.right + 56.0);
    let (low, high) = (edges[0], edges[edges.len() - 1]);
    let height = |value: f64| frame.bottom - (value - low) / (high - low) * (frame.bottom - frame.top);
    for band in edges.windows(2) {
        let colour = colours.at(0.5 * (band[0] + band[1]));
        canvas.rectangle((left, height(band[1])), (right, height(band[0]) + 0.5), colour);
    }
    canvas.outline((left, frame.top), (right, frame.bottom), Stroke::whole(INK, 1.3));
    for k in (low / isotherm).ceil() as i64..=(high / isotherm + 1e-9).floor() as i64 {
        let level = k as f64 * isotherm;
        let py = height(level);
        canvas.line(vec![(left, py), (right, py)], Stroke::whole(INK, 0.9));
        canvas.text((right + 8.0, py + 0.36 * TICK), number(level, 4), TICK, Align::Start);
    }
    if let Some(point) = freezing_point.filter(|point| *point > low && *point < high) {
        let py = height(point);
        canvas.line(vec![(left - 4.0, py), (right + 4.0, py)], Stroke::whole(INK, FRONT_WIDTH));
    }
    canvas.upward((right + 8.0 + 3.4 * TICK, 0.5 * (frame.top + frame.bottom)), look.label.as_str());
}

/// Says what the heavy line is, under the colour bar's side of the map.
fn front_note(canvas: &mut Canvas, frame: &Frame, text: String) {
    let y = notes_at(frame);
    let swatch = 44.0;
    let left = frame.right + 30.0 + 26.0 + 8.0 + 3.4 * TICK - swatch - 8.0 - text_width(&text, LABEL, false);
    canvas.line(vec![(left, y - 0.34 * LABEL), (left + swatch, y - 0.34 * LABEL)], Stroke::whole(INK, FRONT_WIDTH));
    canvas.text((left + swatch + 8.0, y), text, LABEL, Align::Start);
}
