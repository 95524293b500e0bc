//! Temperature maps: bands of equal temperature, isotherms, and the freezing isotherm heavy.

use contour::ContourBuilder;
use frazil_core::record::Field;

use crate::axes::{Axis, Frame, nice_step};
use crate::canvas::{Align, Canvas, Colour, Spot, Stroke, Text};
use crate::run::{Words, title};
use crate::style::{INK, LABEL, TICK, number};

/// Longest side of the grid that is contoured; finer fields are thinned, which keeps the SVG small.
const GRID: usize = 240;

pub(crate) fn temperature_map(field: &Field, words: &Words) -> Canvas {
    let heading = format!("{}, {}", words.heading, words.instant(field.time_s));
    let (width, height) = (field.nx as f64 * field.spacing_m, field.ny as f64 * field.spacing_m);
    let side = (840.0 / width).min(700.0 / height);
    let (frame_width, frame_height) = (width * side, height * side);
    let canvas_width = (frame_width + 290.0).max(620.0);
    let mut canvas = Canvas::new(canvas_width, frame_height + 150.0, &format!("Temperature map: {heading}"));
    title(&mut canvas, &heading);
    let (x0, y0) = (field.x0_m - 0.5 * field.spacing_m, field.y0_m - 0.5 * field.spacing_m);
    let unit = if words.length_unit.is_some() { "m" } else { "dimensionless" };
    let frame = Frame {
        left: 90.0,
        top: 60.0,
        right: 90.0 + frame_width,
        bottom: 60.0 + frame_height,
        x: Axis::between(format!("x ({unit})"), x0, x0 + width),
        y: Axis::between(format!("y ({unit})"), y0, y0 + height),
    };
    frame.draw(&mut canvas);
    let grid = Grid::thinned(field);
    let present = || field.temperature_c.iter().copied().filter(|value| value.is_finite());
    let (low, high) = present().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), t| (lo.min(t), hi.max(t)));
    if low.is_finite() {
        let step = band_step(high - low);
        let colours = Ramp { low, high, zero: words.freezing_point };
        let first = (low / step).floor() as i64;
        let last = ((high / step).ceil() as i64).max(first + 1);
        let edges: Vec<f64> = (first..=last).map(|k| k as f64 * step).collect();
        for band in edges.windows(2) {
            let rings = grid.region(band[0], band[1], &frame);
            if !rings.is_empty() {
                canvas.area(rings, colours.at(0.5 * (band[0] + band[1])), 1.0);
            }
        }
        let isotherm = isotherm_step(high - low);
        for k in (low / isotherm).ceil() as i64..=(high / isotherm).floor() as i64 {
            let level = k as f64 * isotherm;
            if (level - words.freezing_point).abs() > 0.2 * isotherm {
                grid.draw_isotherm(&mut canvas, &frame, level, Stroke::whole(INK, 0.9));
            }
        }
        grid.draw_isotherm(&mut canvas, &frame, words.freezing_point, Stroke::whole(INK, 3.2));
        colour_bar(&mut canvas, &frame, &edges, &colours, isotherm, words);
    }
    let rim = [
        (frame.left, frame.top),
        (frame.right, frame.top),
        (frame.right, frame.bottom),
        (frame.left, frame.bottom),
        (frame.left, frame.top),
    ];
    canvas.line(rim.to_vec(), Stroke::whole(INK, 1.3));
    canvas
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
        let place = part.clamp(0.0, 1.0) * (ramp.len() - 1) as f64;
        let index = (place as usize).min(ramp.len() - 2);
        let (a, b, share) = (ramp[index], ramp[index + 1], place - index as f64);
        let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
        Colour(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
    }
}

fn colour_bar(canvas: &mut Canvas, frame: &Frame, edges: &[f64], colours: &Ramp, isotherm: f64, words: &Words) {
    let (left, right) = (frame.right + 30.0, frame.right + 56.0);
    let (low, high) = (edges[0], edges[edges.len() - 1]);
    let height = |value: f64| frame.bottom - (value - low) / (high - low) * (frame.bottom - frame.top);
    for band in edges.windows(2) {
        let colour = colours.at(0.5 * (band[0] + band[1]));
        canvas.rectangle((left, height(band[1])), (right, height(band[0]) + 0.5), colour);
    }
    let rim = [(left, frame.top), (right, frame.top), (right, frame.bottom), (left, frame.bottom), (left, frame.top)];
    canvas.line(rim.to_vec(), Stroke::whole(INK, 1.3));
    for k in (low / isotherm).ceil() as i64..=(high / isotherm + 1e-9).floor() as i64 {
        let level = k as f64 * isotherm;
        let py = height(level);
        canvas.line(vec![(left, py), (right, py)], Stroke::whole(INK, 0.9));
        canvas.text((right + 8.0, py + 0.36 * TICK), number(level, 4), TICK, Align::Start);
    }
    if words.freezing_point > low && words.freezing_point < high {
        let py = height(words.freezing_point);
        canvas.line(vec![(left - 4.0, py), (right + 4.0, py)], Stroke::whole(INK, 3.2));
    }
    canvas.place(Text {
        at: (right + 8.0 + 4.2 * TICK, 0.5 * (frame.top + frame.bottom)),
        text: words.temperature_label.clone(),
        size: LABEL,
        align: Align::Middle,
        bold: false,
        upward: true,
        colour: INK,
    });
}

/// A regular grid of values with the rings around its level sets.
struct Grid {
    nx: usize,
    ny: usize,
    x0: f64,
    y0: f64,
    spacing: f64,
    values: Vec<f64>,
}

impl Grid {
    fn thinned(field: &Field) -> Grid {
        let stride = field.nx.max(field.ny).div_ceil(GRID).max(1);
        let (nx, ny) = (field.nx.div_ceil(stride), field.ny.div_ceil(stride));
        let value = |i: usize, j: usize| field.temperature_c[j * stride * field.nx + i * stride];
        let values = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))).map(|(i, j)| value(i, j)).collect();
        Grid { nx, ny, x0: field.x0_m, y0: field.y0_m, spacing: field.spacing_m * stride as f64, values }
    }

    /// Rings around the cells whose value lies in a band, by even-odd: the region above the lower edge without
    /// the region above the upper one. Cells outside the body belong to neither.
    fn region(&self, low: f64, high: f64, frame: &Frame) -> Vec<Vec<Spot>> {
        let mut rings = self.above(low, frame);
        rings.extend(self.above(high, frame));
        rings
    }

    /// Rings around the region at or above a level.
    fn above(&self, level: f64, frame: &Frame) -> Vec<Vec<Spot>> {
        let outside = self.values.iter().copied().filter(|value| value.is_finite()).fold(f64::INFINITY, f64::min);
        // Outside the body counts as far below any level, so that every region ends there.
        let below = level.min(outside) - 1e6;
        let values: Vec<f64> = self.values.iter().map(|v| if v.is_finite() { *v } else { below }).collect();
        let builder = ContourBuilder::new(self.nx, self.ny, true);
        let Ok(contours) = builder.contours(&values, &[level]) else {
            return Vec::new();
        };
        let mut rings = Vec::new();
        for contour in contours {
            for polygon in &contour.geometry().0 {
                for ring in std::iter::once(polygon.exterior()).chain(polygon.interiors()) {
                    rings.push(ring.coords().map(|coord| self.spot(coord.x, coord.y, frame)).collect());
                }
            }
        }
        rings
    }

    /// Pixel of a point in the contour's coordinates, where the centre of the first cell is at one half.
    fn spot(&self, x: f64, y: f64, frame: &Frame) -> Spot {
        let at =
            |origin: f64, place: f64, low: f64, high: f64| (origin + (place - 0.5) * self.spacing).clamp(low, high);
        frame.spot(at(self.x0, x, frame.x.low, frame.x.high), at(self.y0, y, frame.y.low, frame.y.high))
    }

    /// An isotherm between cells that lie in the body; edges of the body are no isotherm.
    fn draw_isotherm(&self, canvas: &mut Canvas, frame: &Frame, level: f64, stroke: Stroke) {
        for ring in self.above(level, frame) {
            let mut piece: Vec<Spot> = Vec::new();
            for spot in ring {
                if self.inner(spot, frame) {
                    piece.push(spot);
                } else {
                    canvas.line(std::mem::take(&mut piece), stroke);
                }
            }
            canvas.line(piece, stroke);
        }
    }

    /// Whether all cells around a pixel are in the body, so that a contour there is a true one.
    fn inner(&self, (px, py): Spot, frame: &Frame) -> bool {
        let x = frame.x.low + (px - frame.left) / (frame.right - frame.left) * (frame.x.high - frame.x.low);
        let y = frame.y.low + (frame.bottom - py) / (frame.bottom - frame.top) * (frame.y.high - frame.y.low);
        let (i, j) = ((x - self.x0) / self.spacing, (y - self.y0) / self.spacing);
        if i < 0.0 || j < 0.0 || i > (self.nx - 1) as f64 || j > (self.ny - 1) as f64 {
            return false;
        }
        let (i0, j0) = (i as usize, j as usize);
        (i0..=(i0 + 1).min(self.nx - 1))
            .all(|i| (j0..=(j0 + 1).min(self.ny - 1)).all(|j| self.values[j * self.nx + i].is_finite()))
    }
}
