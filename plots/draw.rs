//! A drawing put to paper by plotters: one way for the SVG and the PNG, so that both show the same.
//!
//! Backends know whole pixels only. The SVG is therefore drawn at ten times its size, and its view box brings it
//! back: tenths of a pixel are finer than any screen. The PNG is drawn at four times its size and averaged down to
//! twice: the bitmap backend leaves stairs along thick and slanted edges, and the mean of four pixels removes them.

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoTextStyle, RGBColor, ShapeStyle, TextStyle};

use crate::PlotError;
use crate::canvas::{Align, Canvas, Colour, Item, Spot, Stroke, Text};
use crate::style;

/// What differs between the backends.
struct Paper {
    /// Pixels of the backend to one of the drawing.
    scale: f64,
    /// Font size that the backend asks for to get letters of size one.
    font: f64,
    /// How far below the point of a text its base line comes to lie, in letters of size one.
    base: f64,
    /// Whether lines are drawn piece by piece with discs at the joints: the bitmap backend turns a thick line into
    /// one polygon, which overlaps itself in narrow bends and is notched there.
    pieces: bool,
    /// Whether letters come from the built-in font, rather than from those of the reader's machine.
    built_in: bool,
}

/// The height of a line of Noto Sans is 1.362 times its size. The bitmap backend scales by the former and puts the
/// base line half of it below the point.
const BITMAP: Paper = Paper { scale: 4.0, font: 1.362, base: 0.5 * 1.362, pieces: true, built_in: true };

/// The SVG backend divides sizes by 1.24 and moves texts that hang from their point by 0.76 of their size.
const SVG: Paper = Paper { scale: 10.0, font: 1.24, base: 0.76, pieces: false, built_in: false };

impl Canvas {
    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        let mut out = String::new();
        let (width, height) = SVG.size(self);
        // Writing into a string and without measuring any text cannot fail.
        let _ = SVG.draw(self, &mut SVGBackend::with_string(&mut out, (width, height)));
        // The backend knows one size only. The first tag is replaced by one that gives the size of the page and that of
        // the pixels, and how all lines and areas are drawn.
        let body = out.split_once('>').map_or("", |(_, body)| body);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{}\" height=\"{}\" \
         role=\"img\" stroke-linejoin=\"round\">\n<title>{}</title>{}",
            self.width,
            self.height,
            escaped(&self.title),
            // Most of the elements are opaque and say so.
            body.replace(" opacity=\"1\"", "")
        )
    }

    /// The drawing as a PNG of twice its size.
    ///
    /// # Errors
    ///
    /// If the built-in font is refused or the picture cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        style::register()?;
        let (width, height) = BITMAP.size(self);
        let mut pixels = vec![0; 3 * width as usize * height as usize];
        BITMAP.draw(self, &mut BitMapBackend::with_buffer(&mut pixels, (width, height)))?;
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, width / 2, height / 2);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&halved(&pixels, width as usize)).map_err(failed)?;
        writer.finish().map_err(failed)?;
        Ok(out)
    }
}

/// The means of two by two pixels of an image of a width.
fn halved(pixels: &[u8], width: usize) -> Vec<u8> {
    let row = 3 * width;
    let mut small = Vec::with_capacity(pixels.len() / 4);
    for rows in pixels.chunks_exact(2 * row) {
        let (upper, lower) = rows.split_at(row);
        for (upper, lower) in upper.chunks_exact(6).zip(lower.chunks_exact(6)) {
            for c in 0..3 {
                let sum = [upper[c], upper[c + 3], lower[c], lower[c + 3]].map(u16::from).iter().sum::<u16>();
                small.push(((sum + 2) / 4) as u8);
            }
        }
    }
    small
}

/// Width of a text (px).
pub fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    // Measured large, because the font layer rounds to whole pixels.
    const LARGE: f64 = 200.0;
    let fallback = 0.55 * size * text.chars().count() as f64;
    if style::register().is_err() {
        return fallback;
    }
    let font = font(LARGE * BITMAP.font, bold);
    font.font.box_size(&in_built_in_font(text)).map_or(fallback, |(width, _)| f64::from(width) * size / LARGE)
}

fn font(size: f64, bold: bool) -> TextStyle<'static> {
    let weight = if bold { FontStyle::Bold } else { FontStyle::Normal };
    (style::FONT, size, weight).into_text_style(&(1, 1))
}

/// A text in letters that the built-in font has: it lacks the raised minus sign, which a macron resembles.
fn in_built_in_font(text: &str) -> String {
    text.replace('⁻', "ˉ")
}

impl Paper {
    fn size(&self, canvas: &Canvas) -> (u32, u32) {
        ((canvas.width * self.scale).round() as u32, (canvas.height * self.scale).round() as u32)
    }

    fn spot(&self, (x, y): Spot) -> (i32, i32) {
        ((x * self.scale).round() as i32, (y * self.scale).round() as i32)
    }

    fn width(&self, width: f64) -> u32 {
        // Polygons of the bitmap backend hold both their ends.
        (width * self.scale - f64::from(u8::from(self.pieces))).round().max(1.0) as u32
    }

    fn radius(&self, radius: f64) -> u32 {
        (radius * self.scale).round() as u32
    }

    fn draw<DB: DrawingBackend<ErrorType: 'static>>(&self, canvas: &Canvas, backend: &mut DB) -> Result<(), PlotError> {
        backend.ensure_prepared().map_err(failed)?;
        let (width, height) = self.size(canvas);
        backend.draw_rect((0, 0), (width as i32, height as i32), &filled(Colour::WHITE), true).map_err(failed)?;
        for item in &canvas.items {
            match item {
                Item::Line { points, stroke } => {
                    for piece in dashes(points, stroke.dash) {
                        self.line(&piece, stroke, backend)?;
                    }
                }
                Item::Area { ring, fill } => {
                    let mut points: Vec<_> = ring.iter().map(|point| self.spot(*point)).collect();
                    points.dedup();
                    if points.len() > 2 && self.pieces {
                        area(&points, &filled(*fill), backend)?;
                    } else if points.len() > 2 {
                        backend.fill_polygon(points, &filled(*fill)).map_err(failed)?;
                    }
                }
                Item::Disc { at, radius, fill } => {
                    backend.draw_circle(self.spot(*at), self.radius(*radius), &filled(*fill), true).map_err(failed)?;
                }
                Item::Circle { at, radius, stroke } => {
                    backend
                        .draw_circle(self.spot(*at), self.radius(*radius), &self.stroke(stroke), false)
                        .map_err(failed)?;
                }
                Item::Text(text) => self.text(text, backend)?,
            }
        }
        backend.present().map_err(failed)
    }

    fn stroke(&self, stroke: &Stroke) -> ShapeStyle {
        ShapeStyle { stroke_width: self.width(stroke.width), filled: false, ..filled(stroke.colour) }
    }

    fn line<DB: DrawingBackend<ErrorType: 'static>>(
        &self,
        points: &[Spot],
        stroke: &Stroke,
        backend: &mut DB,
    ) -> Result<(), PlotError> {
        let style = self.stroke(stroke);
        let mut path: Vec<(i32, i32)> = Vec::with_capacity(points.len());
        // Over very short pieces whole pixels would set the direction of the line.
        let least = if self.pieces { 6 } else { 1 };
        for point in points.iter().map(|point| self.spot(*point)) {
            if path.last().is_none_or(|last| (last.0 - point.0).abs().max((last.1 - point.1).abs()) >= least) {
                path.push(point);
            }
        }
        if let (Some(last), Some(kept)) = (points.last(), path.len().checked_sub(1)) {
            let last = self.spot(*last);
            match kept {
                0 => path.push(last),
                _ => path[kept] = last,
            }
        }
        if !self.pieces {
            return backend.draw_path(path, &style).map_err(failed);
        }
        for pair in path.windows(2) {
            backend.draw_line(pair[0], pair[1], &style).map_err(failed)?;
        }
        if style.stroke_width > 4 {
            for joint in path.iter().skip(1).rev().skip(1) {
                backend.draw_circle(*joint, style.stroke_width / 2, &filled(stroke.colour), true).map_err(failed)?;
            }
        }
        Ok(())
    }

    fn text<DB: DrawingBackend<ErrorType: 'static>>(&self, text: &Text, backend: &mut DB) -> Result<(), PlotError> {
        let colour = tone(style::INK);
        let mut style = font(text.size * self.scale * self.font, text.bold).color(&colour);
        let h_pos = match text.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        style.pos = Pos { h_pos, v_pos: VPos::Top };
        let (x, y) = text.at;
        let base = self.base * text.size;
        let at = if text.upward { (x - base, y) } else { (x, y - base) };
        if text.upward {
            style = style.transform(FontTransform::Rotate270);
        }
        let letters = if self.built_in { in_built_in_font(&text.text) } else { text.text.clone() };
        backend.draw_text(&letters, &style, self.spot(at)).map_err(failed)
    }
}

/// Fills a polygon row by row, as pixels lie in memory: the bitmap backend would go through a wide one column by column.
fn area<DB: DrawingBackend<ErrorType: 'static>>(
    points: &[(i32, i32)],
    style: &ShapeStyle,
    backend: &mut DB,
) -> Result<(), PlotError> {
    let mut crossings = Vec::new();
    for (from, to) in points.iter().zip(points.iter().cycle().skip(1)) {
        let (low, high) = if from.1 < to.1 { (from, to) } else { (to, from) };
        let slope = f64::from(high.0 - low.0) / f64::from(high.1 - low.1);
        for row in low.1..high.1 {
            crossings.push((row, low.0 + (slope * f64::from(row - low.1)).round() as i32));
        }
    }
    crossings.sort_unstable();
    // A closed line crosses each row an even number of times.
    for ends in crossings.chunks_exact(2) {
        backend.draw_line((ends[0].1, ends[0].0), (ends[1].1, ends[1].0), style).map_err(failed)?;
    }
    Ok(())
}

fn failed(error: impl std::error::Error + Send + Sync + 'static) -> PlotError {
    PlotError::Encode(error.into())
}

fn tone(Colour(r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn filled(colour: Colour) -> ShapeStyle {
    ShapeStyle { color: tone(colour).to_rgba(), filled: true, stroke_width: 1 }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
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
