//! How most figures begin: a title and a legend, over frames of one width.

use crate::axes::{Axis, Entry, Frame, legend};
use crate::canvas::{Align, Canvas, text_width};
use crate::style::TITLE;

/// Width of all figures but maps (px).
pub(crate) const WIDTH: f64 = 1000.0;

/// Left margin of titles and legends (px).
pub(crate) const MARGIN: f64 = 24.0;

/// Where legends begin (px).
const LEGEND: f64 = 46.0;

/// Writes the title of a drawing.
pub(crate) fn title(canvas: &mut Canvas, text: &str) {
    let width = canvas.width;
    title_at(canvas, (0.0, 0.0), width, text);
}

/// Writes the title of a part of a drawing, smaller where it is too long.
pub(crate) fn title_at(canvas: &mut Canvas, (left, top): (f64, f64), width: f64, text: &str) {
    let mut size = TITLE;
    while text_width(text, size, true) > width - 2.0 * MARGIN && size > 12.0 {
        size -= 0.5;
    }
    canvas.bold((left + MARGIN, top + 34.0), text, size, Align::Start);
}

/// A drawing of a height (px) with its title and legend, and where these end with a gap (px) below them. `names` are what it
/// shows, for those who cannot see it, and its title.
pub(crate) fn sheet(height: f64, names: (&str, &str), entries: &[Entry], gap: f64) -> (Canvas, f64) {
    let mut canvas = Canvas::new(WIDTH, height, names.0);
    title(&mut canvas, names.1);
    let top = LEGEND + legend(&mut canvas, (MARGIN, LEGEND), 950.0, entries) + gap;
    (canvas, top)
}

/// The same with one frame below, which is drawn.
pub(crate) fn framed(
    height: f64,
    names: (&str, &str),
    entries: &[Entry],
    gap: f64,
    (x, y): (Axis, Axis),
) -> (Canvas, Frame) {
    let (mut canvas, top) = sheet(height, names, entries, gap);
    let frame = Frame::inside((0.0, top), (WIDTH, height), x, y);
    frame.draw(&mut canvas);
    (canvas, frame)
}

/// A drawing as high as `height` says of where title and legend end with a gap (px) below them.
pub(crate) fn grown(heading: &str, entries: &[Entry], gap: f64, height: impl FnOnce(f64) -> f64) -> (Canvas, f64) {
    // A legend takes as much room wherever it is drawn.
    let top = LEGEND + gap + legend(&mut Canvas::new(WIDTH, 0.0, ""), (MARGIN, LEGEND), 950.0, entries);
    (sheet(height(top).ceil(), (heading, heading), entries, gap).0, top)
}
