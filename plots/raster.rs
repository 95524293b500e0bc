//! A drawing as PNG. It is drawn at four times its size and averaged down to twice, which smooths all edges.

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoTextStyle, RGBColor, TextStyle};

use crate::PlotError;
use crate::canvas::{Align, Canvas, Colour, Item, Spot, Stroke, Text};
use crate::style;

const FINE: f64 = 4.0;

/// Height of a line of Noto Sans over its nominal size; the rasteriser scales by the former.
const LINE_HEIGHT: f64 = 1.362;

pub(crate) fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    // Measured large, because the font layer rounds to whole pixels.
    const LARGE: f64 = 200.0;
    let fallback = 0.55 * size * text.chars().count() as f64;
    if style::register().is_err() {
        return fallback;
    }
    let font = font(LARGE, bold);
    font.font.box_size(text).map_or(fallback, |(width, _)| f64::from(width) * size / LARGE)
}

fn font(size: f64, bold: bool) -> TextStyle<'static> {
    let weight = if bold { FontStyle::Bold } else { FontStyle::Normal };
    (style::FONT, size * LINE_HEIGHT, weight).into_text_style(&(1, 1))
}

pub(crate) fn render(canvas: &Canvas) -> Result<Vec<u8>, PlotError> {
    style::register()?;
    let (width, height) = ((canvas.width * FINE) as usize, (canvas.height * FINE) as usize);
    let mut page = Page { width, height, pixels: vec![255; width * height * 3] };
    for item in &canvas.items {
        match item {
            Item::Line { points, stroke } => page.line(points, stroke),
            Item::Area { rings, fill, opacity } => {
                let rings: Vec<Vec<Spot>> =
                    rings.iter().map(|ring| ring.iter().map(|&(x, y)| (x * FINE, y * FINE)).collect()).collect();
                page.fill(&rings, *fill, *opacity);
            }
            Item::Text(text) => page.text(text)?,
        }
    }
    page.encode()
}

struct Page {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Page {
    /// Fills rings by the even-odd rule, one scan line at a time.
    fn fill(&mut self, rings: &[Vec<Spot>], colour: Colour, opacity: f64) {
        let ys = rings.iter().flatten().map(|point| point.1);
        let (low, high) = ys.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), y| (lo.min(y), hi.max(y)));
        if low > high {
            return;
        }
        let first = low.floor().max(0.0) as usize;
        let last = (high.ceil().max(0.0) as usize).min(self.height);
        let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); last.saturating_sub(first)];
        for ring in rings {
            for (k, &(xa, ya)) in ring.iter().enumerate() {
                let (xb, yb) = ring[(k + 1) % ring.len()];
                let ((x0, y0), (x1, y1)) = if ya < yb { ((xa, ya), (xb, yb)) } else { ((xb, yb), (xa, ya)) };
                let from = ((y0 - 0.5).ceil().max(first as f64)) as usize;
                let to = ((y1 - 0.5).ceil().max(0.0) as usize).min(last);
                for row in from..to {
                    let y = row as f64 + 0.5;
                    crossings[row - first].push(x0 + (x1 - x0) * (y - y0) / (y1 - y0));
                }
            }
        }
        for (k, row) in crossings.iter_mut().enumerate() {
            row.sort_by(f64::total_cmp);
            for span in row.chunks_exact(2) {
                let from = ((span[0] - 0.5).ceil().max(0.0) as usize).min(self.width);
                let to = ((span[1] - 0.5).ceil().max(0.0) as usize).min(self.width);
                for x in from..to {
                    self.blend(x, first + k, colour, opacity);
                }
            }
        }
    }

    fn blend(&mut self, x: usize, y: usize, Colour(r, g, b): Colour, opacity: f64) {
        let at = (y * self.width + x) * 3;
        for (pixel, new) in self.pixels[at..at + 3].iter_mut().zip([r, g, b]) {
            *pixel = (f64::from(*pixel) * (1.0 - opacity) + f64::from(new) * opacity).round() as u8;
        }
    }

    fn line(&mut self, points: &[Spot], stroke: &Stroke) {
        let half = 0.5 * stroke.width * FINE;
        for piece in dashes(points, stroke.dash) {
            for (k, pair) in piece.windows(2).enumerate() {
                let ((x0, y0), (x1, y1)) = ((pair[0].0 * FINE, pair[0].1 * FINE), (pair[1].0 * FINE, pair[1].1 * FINE));
                let length = (x1 - x0).hypot(y1 - y0);
                if length > 0.0 {
                    let (nx, ny) = (-(y1 - y0) / length * half, (x1 - x0) / length * half);
                    let quad = vec![(x0 + nx, y0 + ny), (x1 + nx, y1 + ny), (x1 - nx, y1 - ny), (x0 - nx, y0 - ny)];
                    self.fill(&[quad], stroke.colour, 1.0);
                }
                if k > 0 && half > 2.0 {
                    self.disc((x0, y0), half, stroke.colour);
                }
            }
        }
    }

    fn disc(&mut self, (x, y): Spot, radius: f64, colour: Colour) {
        let corners = 12;
        let ring = (0..corners).map(|k| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(corners)).sin_cos();
            (x + radius * cos, y + radius * sin)
        });
        self.fill(&[ring.collect()], colour, 1.0);
    }

    fn text(&mut self, text: &Text) -> Result<(), PlotError> {
        let width = text_width(&text.text, text.size, text.bold) * FINE;
        let back = match text.align {
            Align::Start => 0.0,
            Align::Middle => 0.5 * width,
            Align::End => width,
        };
        // The font layer puts the base line half a line below the point that it is given.
        let drop = 0.5 * text.size * FINE * LINE_HEIGHT;
        let (x, y) = (text.at.0 * FINE, text.at.1 * FINE);
        let (x, y) = if text.upward { (x - drop, y + back) } else { (x - back, y - drop) };
        let Colour(r, g, b) = text.colour;
        let colour = RGBColor(r, g, b).to_rgba();
        let mut font = font(text.size * FINE, text.bold).color(&colour);
        font.pos = Pos { h_pos: HPos::Left, v_pos: VPos::Top };
        if text.upward {
            font = font.transform(FontTransform::Rotate270);
        }
        let size = (self.width as u32, self.height as u32);
        BitMapBackend::with_buffer(&mut self.pixels, size)
            .draw_text(&text.text, &font, (x.round() as i32, y.round() as i32))
            .map_err(|error| PlotError::Encode(error.to_string()))
    }

    fn encode(self) -> Result<Vec<u8>, PlotError> {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut small = Vec::with_capacity(width * height * 3);
        for y in 0..height {
            for x in 0..width {
                for channel in 0..3 {
                    let at = |dx: usize, dy: usize| {
                        u32::from(self.pixels[((2 * y + dy) * self.width + 2 * x + dx) * 3 + channel])
                    };
                    small.push(((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8);
                }
            }
        }
        let mut out = std::io::Cursor::new(Vec::new());
        image::write_buffer_with_format(
            &mut out,
            &small,
            width as u32,
            height as u32,
            image::ColorType::Rgb8,
            image::ImageOutputFormat::Png,
        )
        .map_err(|error| PlotError::Encode(error.to_string()))?;
        Ok(out.into_inner())
    }
}

/// Cuts a line into its dashes.
fn dashes(points: &[Spot], pattern: &[f64]) -> Vec<Vec<Spot>> {
    if pattern.is_empty() {
        return vec![points.to_vec()];
    }
    let (mut index, mut left, mut pieces) = (0, pattern[0], Vec::new());
    let mut piece = vec![points[0]];
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            if length <= left {
                left -= length;
                if index % 2 == 0 {
                    piece.push(to);
                }
                break;
            }
            let part = left / length;
            from = (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1));
            if index % 2 == 0 {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            index = (index + 1) % pattern.len();
            left = pattern[index];
        }
    }
    if piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}
