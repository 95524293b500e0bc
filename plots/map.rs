//! Temperature maps: bands of equal temperature, isotherms, and the front heavy.

use contour::ContourBuilder;
use frazil_record::Field;

use crate::axes::{Axis, Frame, nice_step};
use crate::canvas::{Align, Canvas, Colour, Spot, Stroke, text_width};
use crate::ground_plan::GroundPlan;
use crate::sheet::title;
use crate::style::{INK, LABEL, TICK, number};
use crate::words::Words;

/// Longest side of the grid that is contoured; finer fields are thinned, which keeps the SVG small.
const GRID: usize = 240;

/// Most rings of an isotherm that is drawn however small they are: a ring of pipes has some forty.
const MOST_RINGS: usize = 60;

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
        let first = (low / step).floor() as i64;
        let last = ((high / step).ceil() as i64).max(first + 1);
        let mut edges: Vec<f64> = (first..=last).map(|k| k as f64 * step).collect();
        let is_turn = |zero: &f64| *zero > edges[0] && *zero < edges[edges.len() - 1];
        if let Some(zero) = look.zero.filter(is_turn) {
            // The colour turns exactly where the ground freezes.
            edges.push(zero);
            edges.sort_by(f64::total_cmp);
            edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * step);
        }
        let bands: Vec<Colour> = edges.windows(2).map(|band| colours.at(0.5 * (band[0] + band[1]))).collect();
        grid.paint_bands(&mut canvas, &frame, &edges[1..edges.len() - 1], &bands);
        let isotherm = isotherm_step(high - low);
        for k in (low / isotherm).ceil() as i64..=(high / isotherm).floor() as i64 {
            let level = k as f64 * isotherm;
            // At the ends of the range a line would follow the rounding of what is even.
            let inside = (level - low).min(high - level) > 1e-6 * (high - low);
            let is_apart = look.zero.is_none_or(|zero| (level - zero).abs() > 0.2 * isotherm);
            if inside && is_apart && !grid.is_noise(level, &frame) {
                grid.draw_level(&mut canvas, &frame, &grid.values, level, Stroke::whole(INK, 0.9));
            }
        }
        let front = Stroke::whole(INK, FRONT_WIDTH);
        let frozen = crosses(&grid.frozen);
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

/// A regular grid of values, with a margin of one cell, and where the body is.
pub(crate) struct Grid {
    nx: usize,
    ny: usize,
    x0: f64,
    y0: f64,
    spacing: f64,
    pub(crate) values: Vec<f64>,
    /// Frozen fractions; empty if the field has none.
    frozen: Vec<f64>,
    /// One inside the body and zero outside, smoothed; empty if the body fills the grid.
    body: Vec<f64>,
}

impl Grid {
    pub(crate) fn thinned(field: &Field) -> Grid {
        let stride = field.nx.max(field.ny).div_ceil(GRID).max(1);
        let (nx, ny) = (field.nx.div_ceil(stride) + 2, field.ny.div_ceil(stride) + 2);
        // The margin repeats the cells beside it, so that bands and isotherms reach the walls.
        let source = |k: usize, count: usize| (k.max(1) - 1).min(count.div_ceil(stride) - 1) * stride;
        let taken = |from: &[f64]| -> Vec<f64> {
            (0..ny)
                .flat_map(|j| (0..nx).map(move |i| (i, j)))
                .filter_map(|(i, j)| from.get(source(j, field.ny) * field.nx + source(i, field.nx)).copied())
                .collect()
        };
        let mut values = taken(&field.temperature_c);
        let mut frozen = taken(&field.frozen_fraction);
        frozen.truncate(if frozen.len() == values.len() { frozen.len() } else { 0 });
        let mut body: Vec<f64> = values.iter().map(|value| f64::from(u8::from(value.is_finite()))).collect();
        if body.iter().all(|share| *share > 0.0) {
            body.clear();
        } else {
            // Values are carried a little beyond the body and covered up along a smooth edge: no stairs.
            for _ in 0..4 {
                values = spread(&values, nx, ny);
                frozen = spread(&frozen, nx, ny);
            }
            for _ in 0..3 {
                body = smooth(&body, nx, ny);
            }
        }
        // A sharp front passes from one to zero within one cell. The mean over three puts the level 1/2 where the
        // frozen volume has it, and without steps; a body of a cell or two would vanish in it.
        let even = smooth(&frozen, nx, ny);
        if crosses(&even) {
            frozen = even;
        }
        let spacing = field.spacing_m * stride as f64;
        Grid { nx, ny, x0: field.x0_m - spacing, y0: field.y0_m - spacing, spacing, values, frozen, body }
    }

    /// Paints bands between levels, of which there is one fewer than colours. Every level is a set of rings that
    /// cross no others; from the largest to the smallest, each is filled with what lies just inside it. No ring needs
    /// a hole then.
    pub(crate) fn paint_bands(&self, canvas: &mut Canvas, frame: &Frame, levels: &[f64], colours: &[Colour]) {
        canvas.rectangle((frame.left, frame.top), (frame.right, frame.bottom), colours[0]);
        let mut rings: Vec<(f64, Vec<Spot>, Colour)> = Vec::new();
        for (k, level) in levels.iter().enumerate() {
            for polygon in self.above(&self.values, *level, frame) {
                for (number, ring) in polygon.into_iter().enumerate() {
                    // The first ring of a polygon is its rim, all others are holes in it, which are colder.
                    let colour = if number == 0 { colours[k + 1] } else { colours[k] };
                    rings.push((enclosed(&ring), ring, colour));
                }
            }
        }
        rings.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, ring, colour) in rings {
            canvas.area(ring, colour);
        }
    }

    /// Polygons around the region at or above a level: each the rim, then its holes.
    fn above(&self, values: &[f64], level: f64, frame: &Frame) -> Vec<Vec<Vec<Spot>>> {
        let values: Vec<f64> = values.iter().map(|v| if v.is_finite() { *v } else { -1e6 }).collect();
        let builder = ContourBuilder::new(self.nx, self.ny, true);
        let Ok(contours) = builder.contours(&values, &[level]) else {
            return Vec::new();
        };
        contours
            .iter()
            .flat_map(|contour| &contour.geometry().0)
            .map(|polygon| {
                std::iter::once(polygon.exterior())
                    .chain(polygon.interiors())
                    .map(|ring| ring.coords().map(|coord| self.spot(coord.x, coord.y, frame)).collect())
                    .collect()
            })
            .collect()
    }

    /// Pixel of a point in the contour's coordinates, where the centre of the first cell is at one half.
    fn spot(&self, x: f64, y: f64, frame: &Frame) -> Spot {
        let at =
            |origin: f64, place: f64, low: f64, high: f64| (origin + (place - 0.5) * self.spacing).clamp(low, high);
        frame.spot(at(self.x0, x, frame.x.low, frame.x.high), at(self.y0, y, frame.y.low, frame.y.high))
    }

    /// Whether an isotherm follows the noise of single particles where all have about its temperature: most of its rings
    /// go around less than a block of three by three cells then.
    fn is_noise(&self, level: f64, frame: &Frame) -> bool {
        let across = self.spacing * (frame.right - frame.left) / (frame.x.high - frame.x.low);
        let up = self.spacing * (frame.bottom - frame.top) / (frame.y.high - frame.y.low);
        let block = 9.0 * (across * up).abs();
        let rings: Vec<f64> =
            self.above(&self.values, level, frame).iter().flatten().map(|ring| enclosed(ring)).collect();
        rings.len() > MOST_RINGS && 2 * rings.iter().filter(|area| **area < block).count() > rings.len()
    }

    /// A line of equal value inside the frame; the frame itself is none.
    pub(crate) fn draw_level(&self, canvas: &mut Canvas, frame: &Frame, values: &[f64], level: f64, stroke: Stroke) {
        let edge = |(x, y): &Spot| {
            (x - frame.left).abs() < 1e-6
                || (x - frame.right).abs() < 1e-6
                || (y - frame.top).abs() < 1e-6
                || (y - frame.bottom).abs() < 1e-6
        };
        for ring in self.above(values, level, frame).into_iter().flatten() {
            let mut piece: Vec<Spot> = Vec::new();
            for spot in ring {
                let ends = edge(&spot);
                if ends && piece.last().is_some_and(edge) {
                    piece.clear();
                }
                piece.push(spot);
                if ends && piece.len() > 1 {
                    canvas.line(std::mem::take(&mut piece), stroke);
                    piece.push(spot);
                }
            }
            canvas.line(piece, stroke);
        }
    }

    /// Covers what lies outside the body.
    pub(crate) fn cover_outside(&self, canvas: &mut Canvas, frame: &Frame) {
        let outside: Vec<f64> = self.body.iter().map(|share| 1.0 - share).collect();
        if !outside.is_empty() {
            for polygon in self.above(&outside, 0.5, frame) {
                canvas.area(cut_open(polygon), Colour::WHITE);
            }
            self.draw_level(canvas, frame, &outside, 0.5, Stroke::whole(INK, 1.3));
        }
    }
}

/// Whether frozen fractions lie on both sides of one half.
fn crosses(frozen: &[f64]) -> bool {
    let present = || frozen.iter().filter(|share| share.is_finite());
    present().any(|share| *share < 0.5) && present().any(|share| *share >= 0.5)
}

/// Area inside a ring (px2).
fn enclosed(ring: &[Spot]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    (0.5 * ring.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>()).abs()
}

/// One ring for a rim and its holes: each hole is joined to the rim by a cut where the two are nearest.
fn cut_open(polygon: Vec<Vec<Spot>>) -> Vec<Spot> {
    let mut rings = polygon.into_iter();
    let mut rim = rings.next().unwrap_or_default();
    for hole in rings {
        let distance = |a: &Spot, b: &Spot| (a.0 - b.0).hypot(a.1 - b.1);
        let pairs = (0..rim.len()).flat_map(|i| (0..hole.len()).map(move |j| (i, j)));
        let nearest = pairs.min_by(|a, b| distance(&rim[a.0], &hole[a.1]).total_cmp(&distance(&rim[b.0], &hole[b.1])));
        if let Some((i, j)) = nearest {
            let around: Vec<Spot> = hole[j..].iter().chain(&hole[..=j]).copied().chain([rim[i]]).collect();
            rim.splice(i + 1..i + 1, around);
        }
    }
    rim
}

/// The cells of the 3 by 3 block around a cell.
fn around(values: &[f64], nx: usize, ny: usize, i: usize, j: usize) -> impl Iterator<Item = f64> {
    let columns = i.saturating_sub(1)..=(i + 1).min(nx - 1);
    (j.saturating_sub(1)..=(j + 1).min(ny - 1))
        .flat_map(move |j| columns.clone().map(move |i| (i, j)))
        .map(move |(i, j)| values[j * nx + i])
}

/// Gives missing cells the mean of their present neighbours.
fn spread(values: &[f64], nx: usize, ny: usize) -> Vec<f64> {
    let cell = |k: usize| if values[k].is_finite() { values[k] } else { block_mean(values, nx, ny, k % nx, k / nx) };
    (0..values.len()).map(cell).collect()
}

/// Mean of the present values of a block; NaN if there are none.
fn block_mean(values: &[f64], nx: usize, ny: usize, i: usize, j: usize) -> f64 {
    let (sum, count) = around(values, nx, ny, i, j)
        .filter(|value| value.is_finite())
        .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Gives every cell the mean of its block.
fn smooth(values: &[f64], nx: usize, ny: usize) -> Vec<f64> {
    (0..values.len()).map(|k| block_mean(values, nx, ny, k % nx, k / nx)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hole_is_cut_open_without_a_change_of_area() {
        let square = |a: f64, b: f64| vec![(a, a), (b, a), (b, b), (a, b)];
        let mut hole = square(2.0, 4.0);
        hole.reverse();
        let ring = cut_open(vec![square(0.0, 10.0), hole]);
        assert_eq!(ring.len(), 4 + 5 + 1);
        assert!((enclosed(&ring) - 96.0).abs() < 1e-12);
    }

    #[test]
    fn noise_about_a_level_is_told_from_an_isotherm() {
        let grid = |at: &dyn Fn(usize, usize) -> f64| Grid {
            nx: 60,
            ny: 60,
            x0: 0.5,
            y0: 0.5,
            spacing: 1.0,
            values: (0..3600).map(|k| at(k % 60, k / 60)).collect(),
            frozen: Vec::new(),
            body: Vec::new(),
        };
        let noise =
            |i: usize, j: usize| ((12.9898 * i as f64 + 78.233 * j as f64).sin() * 43_758.545_3).rem_euclid(1.0) - 0.5;
        let cone = |i: usize, j: usize| (i as f64 - 30.5).hypot(j as f64 - 30.5) - 15.0;
        let side = || Axis::between("", 0.0, 60.0);
        let frame = Frame { left: 0.0, top: 0.0, right: 600.0, bottom: 600.0, x: side(), y: side() };
        assert!(!grid(&cone).is_noise(0.0, &frame));
        assert!(!grid(&|i, j| cone(i, j) + noise(i, j)).is_noise(0.0, &frame));
        assert!(grid(&noise).is_noise(0.0, &frame));
    }
}
