//! A drawing as PNG, put to paper by plotters.
//!
//! It is drawn at four times its size and averaged down to twice: the backend knows whole pixels only and leaves stairs along
//! thick and slanted edges, which the mean of four pixels removes.

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoTextStyle, RGBColor, ShapeStyle, TextStyle};

use crate::PlotError;
use crate::canvas::{Align, Canvas, Colour, Item, Spot, Stroke, Text};
use crate::style;

/// Pixels of the backend to one of the drawing.
const SCALE: f64 = 4.0;

/// The height of a line of Noto Sans over its size: the backend scales letters by it and puts the base line half of it below the
/// point of a text.
const LINE_HEIGHT: f64 = 1.362;

impl Canvas {
    /// The drawing as a PNG of twice its size.
    ///
    /// # Errors
    ///
    /// If the built-in font is refused or the picture cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        style::register()?;
        let (width, height) = size(self);
        let mut pixels = vec![0; 3 * width as usize * height as usize];
        draw(self, &mut BitMapBackend::with_buffer(&mut pixels, (width, height)))?;
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
    let font = font(LARGE * LINE_HEIGHT, bold);
    font.font.box_size(&in_built_in_font(text)).map_or(fallback, |(width, _)| f64::from(width) * size / LARGE)
}

fn font(size: f64, bold: bool) -> TextStyle<'static> {
    let weight = if bold { FontStyle::Bold } else { FontStyle::Normal };
    (style::FONT, size, weight).into_text_style(&(1, 1))
}

/// A text in letters that the built-in font has: it lacks the raised minus sign, which a macron resembles.
pub(crate) fn in_built_in_font(text: &str) -> String {
    text.replace('⁻', "ˉ")
}

fn size(canvas: &Canvas) -> (u32, u32) {
    ((canvas.width * SCALE).round() as u32, (canvas.height * SCALE).round() as u32)
}

fn spot((x, y): Spot) -> (i32, i32) {
    ((x * SCALE).round() as i32, (y * SCALE).round() as i32)
}

fn draw(canvas: &Canvas, backend: &mut BitMapBackend<'_>) -> Result<(), PlotError> {
    backend.ensure_prepared().map_err(failed)?;
    let (width, height) = size(canvas);
    backend.draw_rect((0, 0), (width as i32, height as i32), &filled(Colour::WHITE), true).map_err(failed)?;
    let radius = |radius: f64| (radius * SCALE).round() as u32;
    for item in &canvas.items {
        match item {
            Item::Line { points, stroke } => {
                for piece in dashes(points, stroke.dash) {
                    line(&piece, stroke, backend)?;
                }
            }
            Item::Area { ring, fill } => {
                let mut points: Vec<_> = ring.iter().map(|point| spot(*point)).collect();
                points.dedup();
                if points.len() > 2 {
                    area(&points, &filled(*fill), backend)?;
                }
            }
            Item::Disc { at, radius: own, fill } => {
                backend.draw_circle(spot(*at), radius(*own), &filled(*fill), true).map_err(failed)?;
            }
            Item::Circle { at, radius: own, stroke } => {
                backend.draw_circle(spot(*at), radius(*own), &stroked(stroke), false).map_err(failed)?;
            }
            Item::Text(own) => text(own, backend)?,
        }
    }
    backend.present().map_err(failed)
}

fn stroked(stroke: &Stroke) -> ShapeStyle {
    // Polygons of the backend hold both their ends.
    let width = (stroke.width * SCALE - 1.0).round().max(1.0) as u32;
    ShapeStyle { stroke_width: width, filled: false, ..filled(stroke.colour) }
}

/// A line, drawn piece by piece with discs at the joints: the backend would turn a thick one into one polygon, which overlaps
/// itself in narrow bends and is notched there.
fn line(points: &[Spot], stroke: &Stroke, backend: &mut BitMapBackend<'_>) -> Result<(), PlotError> {
    // Over very short pieces whole pixels would set the direction of the line.
    const LEAST: i32 = 6;
    let style = stroked(stroke);
    let mut path: Vec<(i32, i32)> = Vec::with_capacity(points.len());
    for point in points.iter().map(|point| spot(*point)) {
        if path.last().is_none_or(|last| (last.0 - point.0).abs().max((last.1 - point.1).abs()) >= LEAST) {
            path.push(point);
        }
    }
    if let (Some(last), Some(kept)) = (points.last(), path.len().checked_sub(1)) {
        let last = spot(*last);
        match kept {
            0 => path.push(last),
            _ => path[kept] = last,
        }
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

fn text(text: &Text, backend: &mut BitMapBackend<'_>) -> Result<(), PlotError> {
    let colour = tone(style::INK);
    let mut style = font(text.size * SCALE * LINE_HEIGHT, text.bold).color(&colour);
    let h_pos = match text.align {
        Align::Start => HPos::Left,
        Align::Middle => HPos::Center,
        Align::End => HPos::Right,
    };
    style.pos = Pos { h_pos, v_pos: VPos::Top };
    let (x, y) = text.at;
    let base = 0.5 * LINE_HEIGHT * text.size;
    let at = if text.upward { (x - base, y) } else { (x, y - base) };
    if text.upward {
        style = style.transform(FontTransform::Rotate270);
    }
    backend.draw_text(&in_built_in_font(&text.text), &style, spot(at)).map_err(failed)
}

/// Fills a polygon row by row, as pixels lie in memory: the backend would go through a wide one column by column.
fn area(points: &[(i32, i32)], style: &ShapeStyle, backend: &mut BitMapBackend<'_>) -> Result<(), PlotError> {
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
