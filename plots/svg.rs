//! A drawing as SVG: one element for lines that follow each other in one stroke, whatever their dashes.
//!
//! Places are whole tenths of a pixel, which are finer than any screen, and each of a path is told from the one before it: most take
//! two digits.

use std::fmt::{self, Write};

use crate::canvas::{Align, Canvas, Colour, Item, Spot, Stroke, Text};
use crate::style;

/// Units of the file to a pixel of the drawing.
const SCALE: f64 = 10.0;

impl Canvas {
    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        let mut svg = Svg { out: String::new(), stroke: None };
        // Writing into a string cannot fail.
        let _ = svg.draw(self);
        svg.out
    }
}

/// A file in the making.
struct Svg {
    out: String,
    /// How the path is drawn to which lines are being added.
    stroke: Option<Stroke>,
}

impl Svg {
    fn draw(&mut self, canvas: &Canvas) -> fmt::Result {
        let (width, height) = unit((canvas.width, canvas.height));
        writeln!(
            self.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{}\" height=\"{}\" role=\"img\" \
             fill=\"none\" stroke-linejoin=\"round\" font-family=\"{}\">\n<title>{}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>",
            canvas.width,
            canvas.height,
            style::FONT,
            Escaped(&canvas.title),
            Colour::WHITE
        )?;
        for item in &canvas.items {
            if !matches!(item, Item::Line { .. }) {
                self.end_of_lines(None);
            }
            match item {
                Item::Line { points, stroke } => self.line(points, *stroke)?,
                Item::Area { ring, fill } => self.area(ring, *fill)?,
                Item::Disc { at, radius, fill } => {
                    self.circle(*at, *radius)?;
                    writeln!(self.out, " fill=\"{fill}\"/>")?;
                }
                Item::Circle { at, radius, stroke } => {
                    self.circle(*at, *radius)?;
                    self.stroke(stroke)?;
                    self.out.push_str("/>\n");
                }
                Item::Text(text) => self.text(text)?,
            }
        }
        self.end_of_lines(None);
        self.out.push_str("</svg>\n");
        Ok(())
    }

    /// Adds a line to the path, or begins another where it is drawn in another way.
    fn line(&mut self, points: &[Spot], stroke: Stroke) -> fmt::Result {
        if self.stroke != Some(stroke) {
            self.end_of_lines(Some(stroke));
            self.out.push_str("<path");
            self.stroke(&stroke)?;
            self.out.push_str(" d=\"");
        }
        self.path(&bends(points))
    }

    /// Ends the path that is open, if one is.
    fn end_of_lines(&mut self, next: Option<Stroke>) {
        if std::mem::replace(&mut self.stroke, next).is_some() {
            self.out.push_str("\"/>\n");
        }
    }

    fn area(&mut self, ring: &[Spot], fill: Colour) -> fmt::Result {
        let corners = bends(ring);
        if corners.len() > 2 {
            write!(self.out, "<path fill=\"{fill}\" d=\"")?;
            self.path(&corners)?;
            self.out.push_str("z\"/>\n");
        }
        Ok(())
    }

    /// A circle that is left open for how it is drawn.
    fn circle(&mut self, at: Spot, radius: f64) -> fmt::Result {
        let (x, y) = unit(at);
        write!(self.out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"", (radius * SCALE).round())
    }

    fn stroke(&mut self, stroke: &Stroke) -> fmt::Result {
        write!(self.out, " stroke=\"{}\" stroke-width=\"{}\"", stroke.colour, (stroke.width * SCALE).round().max(1.0))?;
        if let Some((first, rest)) = stroke.dash.split_first() {
            write!(self.out, " stroke-dasharray=\"{}", first * SCALE)?;
            rest.iter().try_for_each(|length| write!(self.out, " {}", length * SCALE))?;
            self.out.push('"');
        }
        Ok(())
    }

    /// Moves to the first of some points, and goes through the others.
    fn path(&mut self, points: &[(i64, i64)]) -> fmt::Result {
        let Some(((x, y), rest)) = points.split_first() else { return Ok(()) };
        write!(self.out, "M{x} {y}")?;
        let mut from = (*x, *y);
        let mut command = 'M';
        for to in rest {
            let by = (to.0 - from.0, to.1 - from.1);
            let next = match by {
                (_, 0) => 'h',
                (0, _) => 'v',
                _ => 'l',
            };
            if next != command {
                self.out.push(next);
            }
            match next {
                'h' => self.number(by.0, next == command)?,
                'v' => self.number(by.1, next == command)?,
                _ => {
                    self.number(by.0, next == command)?;
                    self.number(by.1, true)?;
                }
            }
            (from, command) = (*to, next);
        }
        Ok(())
    }

    /// A number, apart from the one before it: its sign is apart enough.
    fn number(&mut self, value: i64, follows: bool) -> fmt::Result {
        if follows && value >= 0 {
            self.out.push(' ');
        }
        write!(self.out, "{value}")
    }

    fn text(&mut self, text: &Text) -> fmt::Result {
        let (x, y) = unit(text.at);
        let align = match text.align {
            Align::Start => "",
            Align::Middle => " text-anchor=\"middle\"",
            Align::End => " text-anchor=\"end\"",
        };
        let weight = if text.bold { " font-weight=\"bold\"" } else { "" };
        write!(self.out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"{align}{weight}", text.size * SCALE)?;
        if text.upward {
            write!(self.out, " transform=\"rotate(270 {x} {y})\"")?;
        }
        writeln!(self.out, " fill=\"{}\">{}</text>", style::INK, Escaped(&text.text))
    }
}

/// A point in units of the file.
fn unit((x, y): Spot) -> (i64, i64) {
    ((x * SCALE).round() as i64, (y * SCALE).round() as i64)
}

/// The points of a line in units of the file, without those that it passes within one unit all the same (Douglas and Peucker 1973).
fn bends(points: &[Spot]) -> Vec<(i64, i64)> {
    let mut all: Vec<(i64, i64)> = points.iter().map(|point| unit(*point)).collect();
    all.dedup();
    let mut kept = vec![false; all.len()];
    if let [first, .., last] = &mut kept[..] {
        (*first, *last) = (true, true);
    }
    let mut open = vec![(0, all.len().saturating_sub(1))];
    while let Some((from, to)) = open.pop() {
        let between = (from + 1..to).map(|k| (k, beside(all[from], all[to], all[k])));
        if let Some((bend, distance)) = between.max_by(|a, b| a.1.total_cmp(&b.1))
            && distance > 1.0
        {
            kept[bend] = true;
            open.extend([(from, bend), (bend, to)]);
        }
    }
    let mut line: Vec<(i64, i64)> = all.iter().zip(kept).filter_map(|(point, kept)| kept.then_some(*point)).collect();
    // A line must have two points to be one, however short.
    if let [only] = all[..] {
        line = vec![only, (only.0 + 1, only.1)];
    }
    line
}

/// Square of the distance of a point from the way between two others (square units).
fn beside(from: (i64, i64), to: (i64, i64), at: (i64, i64)) -> f64 {
    let (way, on) = ((to.0 - from.0, to.1 - from.1), (at.0 - from.0, at.1 - from.1));
    let length = (way.0 * way.0 + way.1 * way.1) as f64;
    let part = if length > 0.0 { ((way.0 * on.0 + way.1 * on.1) as f64 / length).clamp(0.0, 1.0) } else { 0.0 };
    let off = (on.0 as f64 - part * way.0 as f64, on.1 as f64 - part * way.1 as f64);
    off.0 * off.0 + off.1 * off.1
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// A text of which nothing is taken for an element.
struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|letter| match letter {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            letter => f.write_char(letter),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::INK;

    const DASHED: Stroke = Stroke { colour: INK, width: 2.0, dash: &[5.0, 4.5] };

    /// The elements of a drawing of 100 by 100 px behind its title and its paper.
    fn drawn(draw: impl Fn(&mut Canvas)) -> Vec<String> {
        let mut canvas = Canvas::new(100.0, 100.0, "a < b");
        draw(&mut canvas);
        canvas.svg().lines().skip(3).map(str::to_owned).collect()
    }

    #[test]
    fn lines_of_one_stroke_are_one_element_whatever_their_dashes() {
        let wave: Vec<Spot> = (0..100).map(|k| (f64::from(k), 50.0 + 40.0 * f64::from(k).sin())).collect();
        let rows = drawn(|canvas| {
            canvas.line(wave.clone(), DASHED);
            canvas.line(vec![(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (7.0, 9.0), (4.0, 8.0)], DASHED);
            canvas.line(vec![(0.0, 1.0), (2.0, 1.0)], Stroke::whole(INK, 1.0));
        });
        assert_eq!(rows.len(), 3, "{rows:?}");
        let dashed = "<path stroke=\"#222222\" stroke-width=\"20\" stroke-dasharray=\"50 45\" d=\"M0 500l10 ";
        assert!(rows[0].starts_with(dashed) && rows[0].ends_with("M0 0h100v50l-30 40-30-10\"/>"), "{}", rows[0]);
        assert_eq!(rows[1], "<path stroke=\"#222222\" stroke-width=\"10\" d=\"M0 10h20\"/>");
        assert_eq!(rows[2], "</svg>");
    }

    #[test]
    fn a_line_keeps_its_bends_and_nothing_between_them() {
        let straight: Vec<Spot> = (0..50).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        assert_eq!(bends(&straight), [(0, 0), (490, 980)]);
        let arc: Vec<Spot> =
            (0..=400).map(|k| f64::from(k) / 400.0).map(|a| (300.0 * a.cos(), 300.0 * a.sin())).collect();
        let kept = bends(&arc);
        assert!(kept.len() < 40, "{}", kept.len());
        let nearest = |at| kept.windows(2).map(|way| beside(way[0], way[1], at)).fold(f64::INFINITY, f64::min);
        assert!(arc.iter().all(|spot| nearest(unit(*spot)) <= 1.0));
        // There and back again is not the way from one to the other.
        assert_eq!(bends(&[(0.0, 0.0), (5.0, 0.0), (3.0, 0.0)]), [(0, 0), (50, 0), (30, 0)]);
        assert_eq!(bends(&[(1.0, 1.0), (1.0, 1.01)]), [(10, 10), (11, 10)]);
    }

    #[test]
    fn texts_are_escaped_and_stand_on_their_points() {
        let rows = drawn(|canvas| {
            canvas.text((1.0, 2.0), "5 < 6 & 7", 16.0, Align::End);
            canvas.upward((3.0, 4.0), "up");
        });
        assert_eq!(
            rows[0],
            "<text x=\"10\" y=\"20\" font-size=\"160\" text-anchor=\"end\" fill=\"#222222\">5 &lt; 6 &amp; 7</text>"
        );
        assert!(rows[1].contains(" transform=\"rotate(270 30 40)\""), "{}", rows[1]);
        assert!(Canvas::new(1.0, 1.0, "a < b").svg().contains("<title>a &lt; b</title>"));
    }
}
