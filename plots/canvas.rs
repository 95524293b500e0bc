//! A drawing as a list of lines, areas and texts, in pixels from the upper left corner.

use std::path::{Path, PathBuf};

use frazil_record::write_whole;

use crate::style::Marker;
use crate::{PlotError, style};

pub use crate::png::text_width;

/// A point of a drawing (px).
pub type Spot = (f64, f64);

/// Red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// White.
    pub const WHITE: Colour = Colour(255, 255, 255);

    /// This share of the way to white.
    pub fn tint(self, share: f64) -> Colour {
        let tone = |channel: u8| (f64::from(channel) + share * (255.0 - f64::from(channel))) as u8;
        Colour(tone(self.0), tone(self.1), tone(self.2))
    }

    /// This share of the way to black.
    pub fn shade(self, share: f64) -> Colour {
        let tone = |channel: u8| ((1.0 - share) * f64::from(channel)) as u8;
        Colour(tone(self.0), tone(self.1), tone(self.2))
    }

    /// Lightness in a grey print, 0 to 1.
    pub fn lightness(self) -> f64 {
        (0.299 * f64::from(self.0) + 0.587 * f64::from(self.1) + 0.114 * f64::from(self.2)) / 255.0
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub colour: Colour,
    /// Width (px).
    pub width: f64,
    /// Dashes (px on, px off, ...); empty for a whole line.
    pub dash: &'static [f64],
}

impl Stroke {
    /// A whole line.
    pub fn whole(colour: Colour, width: f64) -> Stroke {
        Stroke { colour, width, dash: &[] }
    }
}

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// It begins there.
    Start,
    /// It is centred there.
    Middle,
    /// It ends there.
    End,
}

/// A text in ink and its place; the point lies on its base line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    pub(crate) at: Spot,
    pub(crate) text: String,
    pub(crate) size: f64,
    pub(crate) align: Align,
    pub(crate) bold: bool,
    /// Whether it runs upwards.
    pub(crate) upward: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Item {
    Line { points: Vec<Spot>, stroke: Stroke },
    Area { ring: Vec<Spot>, fill: Colour },
    Disc { at: Spot, radius: f64, fill: Colour },
    Circle { at: Spot, radius: f64, stroke: Stroke },
    Text(Text),
}

impl Item {
    /// The same, moved to the right (px).
    fn moved(self, by: f64) -> Item {
        let spot = |(x, y): Spot| (x + by, y);
        match self {
            Item::Line { points, stroke } => Item::Line { points: points.into_iter().map(spot).collect(), stroke },
            Item::Area { ring, fill } => Item::Area { ring: ring.into_iter().map(spot).collect(), fill },
            Item::Disc { at, radius, fill } => Item::Disc { at: spot(at), radius, fill },
            Item::Circle { at, radius, stroke } => Item::Circle { at: spot(at), radius, stroke },
            Item::Text(text) => Item::Text(Text { at: spot(text.at), ..text }),
        }
    }
}

/// As what drawings are written beside SVG.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Formats {
    /// PNG, which takes some hundredths of a second each.
    pub png: bool,
    /// PDF, which takes some milliseconds.
    pub pdf: bool,
}

impl Formats {
    /// SVG alone, which costs next to nothing.
    pub const SVG: Formats = Formats { png: false, pdf: false };
    /// SVG, PNG and PDF.
    pub const ALL: Formats = Formats { png: true, pdf: true };
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    /// Width (px).
    pub width: f64,
    /// Height (px).
    pub height: f64,
    /// What the drawing shows, for readers who cannot see it.
    pub title: String,
    pub(crate) items: Vec<Item>,
}

impl Canvas {
    /// An empty white drawing.
    pub fn new(width: f64, height: f64, title: &str) -> Canvas {
        Canvas { width, height, title: title.into(), items: Vec::new() }
    }

    /// Drawings in a row.
    pub fn beside(panels: &[Canvas]) -> Canvas {
        let height = panels.iter().map(|panel| panel.height).fold(0.0, f64::max);
        let mut whole = Canvas::new(0.0, height, panels.first().map_or("", |panel| &panel.title));
        for panel in panels {
            let by = whole.width;
            whole.items.extend(panel.items.iter().cloned().map(|item| item.moved(by)));
            whole.width += panel.width;
        }
        whole
    }

    /// A line through points.
    pub fn line(&mut self, points: Vec<Spot>, stroke: Stroke) {
        if points.len() > 1 {
            self.items.push(Item::Line { points, stroke });
        }
    }

    /// An area inside a ring.
    pub fn area(&mut self, ring: Vec<Spot>, fill: Colour) {
        if ring.len() > 2 {
            self.items.push(Item::Area { ring, fill });
        }
    }

    /// A filled box.
    pub fn rectangle(&mut self, (x0, y0): Spot, (x1, y1): Spot, fill: Colour) {
        self.area(vec![(x0, y0), (x1, y0), (x1, y1), (x0, y1)], fill);
    }

    /// A text.
    pub fn text(&mut self, at: Spot, text: impl Into<String>, size: f64, align: Align) {
        self.items.push(Item::Text(Text { at, text: text.into(), size, align, bold: false, upward: false }));
    }

    /// A bold text.
    pub fn bold(&mut self, at: Spot, text: impl Into<String>, size: f64, align: Align) {
        self.items.push(Item::Text(Text { at, text: text.into(), size, align, bold: true, upward: false }));
    }

    /// The label of an axis that runs upwards around a point.
    pub fn upward(&mut self, at: Spot, text: impl Into<String>) {
        let (size, align) = (style::LABEL, Align::Middle);
        self.items.push(Item::Text(Text { at, text: text.into(), size, align, bold: false, upward: true }));
    }

    /// A marker: filled, or white with a coloured rim.
    pub fn marker(&mut self, at: Spot, marker: Marker, radius: f64, colour: Colour, hollow: bool) {
        const RIM: f64 = 1.8;
        let fill = if hollow { Colour::WHITE } else { colour };
        match marker_shape(at, marker, radius) {
            Some(mut shape) => {
                self.area(shape.clone(), fill);
                // The line is closed past its first corner, so that the corner is joined and not notched.
                shape.extend([shape[0], shape[1]]);
                self.line(shape, Stroke::whole(colour, RIM));
            }
            None => {
                self.items.push(Item::Disc { at, radius: radius + 0.5 * RIM, fill: colour });
                if hollow {
                    self.items.push(Item::Disc { at, radius: radius - 0.5 * RIM, fill });
                }
            }
        }
    }

    /// The rim of a box.
    pub fn outline(&mut self, (left, top): Spot, (right, bottom): Spot, stroke: Stroke) {
        self.line(vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], stroke);
    }

    /// A circle around a point.
    pub fn ring(&mut self, at: Spot, radius: f64, stroke: Stroke) {
        self.items.push(Item::Circle { at, radius, stroke });
    }

    /// A cross at a point.
    pub fn cross(&mut self, (x, y): Spot, radius: f64, stroke: Stroke) {
        self.line(vec![(x - radius, y - radius), (x + radius, y + radius)], stroke);
        self.line(vec![(x - radius, y + radius), (x + radius, y - radius)], stroke);
    }

    /// Writes `NAME.svg` and, where they are asked for, `NAME.png` and `NAME.pdf` into a folder, and returns what was written.
    ///
    /// # Errors
    ///
    /// If the picture cannot be encoded or written.
    pub fn write(&self, folder: &Path, name: &str, formats: Formats) -> Result<Vec<PathBuf>, PlotError> {
        let path = folder.join(format!("{name}.svg"));
        write(&path, self.svg().as_bytes())?;
        let mut paths = vec![path];
        let mut also = |ending: &str, bytes: Vec<u8>| {
            let path = folder.join(format!("{name}.{ending}"));
            write(&path, &bytes)?;
            paths.push(path);
            Ok::<(), PlotError>(())
        };
        if formats.png {
            also("png", self.png()?)?;
        }
        if formats.pdf {
            also("pdf", self.pdf()?)?;
        }
        Ok(paths)
    }
}

/// Writes a file whole.
///
/// # Errors
///
/// If it cannot be written.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), PlotError> {
    write_whole(path, |writer| writer.write_all(bytes)).map_err(|source| PlotError::Write { path: path.into(), source })
}

/// Width of the widest of some texts in the size of tick labels (px).
pub fn widest_tick<'a>(labels: impl Iterator<Item = &'a str>) -> f64 {
    labels.map(|label| text_width(label, style::TICK, false)).fold(0.0, f64::max)
}

/// Corners of a marker; a circle has none.
fn marker_shape((x, y): Spot, marker: Marker, r: f64) -> Option<Vec<Spot>> {
    match marker {
        Marker::Circle => None,
        Marker::Square => {
            let a = 0.88 * r;
            Some(vec![(x - a, y - a), (x + a, y - a), (x + a, y + a), (x - a, y + a)])
        }
        Marker::Triangle => Some(vec![(x, y - 1.2 * r), (x + 1.1 * r, y + 0.8 * r), (x - 1.1 * r, y + 0.8 * r)]),
        Marker::Wedge => Some(vec![(x, y + 1.2 * r), (x + 1.1 * r, y - 0.8 * r), (x - 1.1 * r, y - 0.8 * r)]),
        Marker::Diamond => Some(vec![(x, y - 1.25 * r), (x + 1.25 * r, y), (x, y + 1.25 * r), (x - 1.25 * r, y)]),
    }
}
