//! Fields on a regular grid: bands between levels, lines of equal value, and where the body is.

use contour::ContourBuilder;
use frazil_record::Field;

use crate::axes::Frame;
use crate::canvas::{Canvas, Colour, Spot, Stroke};
use crate::style::INK;

/// Longest side of the grid that is contoured; finer fields are thinned, which keeps the SVG small.
const GRID: usize = 240;

/// Most rings of an isotherm that is drawn however small they are: a ring of pipes has some forty.
const MOST_RINGS: usize = 60;

/// A regular grid of values, with a margin of one cell, and where the body is.
pub(crate) struct Grid {
    nx: usize,
    ny: usize,
    x0: f64,
    y0: f64,
    spacing: f64,
    pub(crate) values: Vec<f64>,
    /// Frozen fractions; empty if the field has none.
    pub(crate) frozen: Vec<f64>,
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

    /// Whether there is a front.
    pub(crate) fn has_front(&self) -> bool {
        crosses(&self.frozen)
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

    /// An isotherm, unless it follows the noise of single particles where all have about its temperature: most of its rings go around
    /// less than a block of three by three cells then.
    pub(crate) fn draw_isotherm(&self, canvas: &mut Canvas, frame: &Frame, level: f64, stroke: Stroke) {
        let rings = self.rings(&self.values, level, frame);
        if !self.are_noise(&rings, frame) {
            draw_rings(canvas, frame, rings, stroke);
        }
    }

    fn are_noise(&self, rings: &[Vec<Spot>], frame: &Frame) -> bool {
        let across = self.spacing * (frame.right - frame.left) / (frame.x.high - frame.x.low);
        let up = self.spacing * (frame.bottom - frame.top) / (frame.y.high - frame.y.low);
        let block = 9.0 * (across * up).abs();
        rings.len() > MOST_RINGS && 2 * rings.iter().filter(|ring| enclosed(ring) < block).count() > rings.len()
    }

    fn rings(&self, values: &[f64], level: f64, frame: &Frame) -> Vec<Vec<Spot>> {
        self.above(values, level, frame).into_iter().flatten().collect()
    }

    /// A line of equal value inside the frame.
    pub(crate) fn draw_level(&self, canvas: &mut Canvas, frame: &Frame, values: &[f64], level: f64, stroke: Stroke) {
        draw_rings(canvas, frame, self.rings(values, level, frame), stroke);
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

/// Draws rings inside the frame; the frame itself is none.
fn draw_rings(canvas: &mut Canvas, frame: &Frame, rings: Vec<Vec<Spot>>, stroke: Stroke) {
    let edge = |(x, y): &Spot| {
        (x - frame.left).abs() < 1e-6
            || (x - frame.right).abs() < 1e-6
            || (y - frame.top).abs() < 1e-6
            || (y - frame.bottom).abs() < 1e-6
    };
    for ring in rings {
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
    use crate::axes::Axis;

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
        let is_noise = |grid: Grid| grid.are_noise(&grid.rings(&grid.values, 0.0, &frame), &frame);
        assert!(!is_noise(grid(&cone)));
        assert!(!is_noise(grid(&|i, j| cone(i, j) + noise(i, j))));
        assert!(is_noise(grid(&noise)));
    }
}
