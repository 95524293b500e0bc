//! Profiles of unsaturated water and, below, of what it carries.

use frazil_record::ProfileRow;

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Stroke};
use crate::run::{aged, by_plane, instants, place_label};
use crate::sheet::{WIDTH, sheet};
use crate::style::{LABEL, method_style};
use crate::words::{DOTS, Words};

/// Height of one frame, and what title, legend and the name of the axis take beside (px).
const EACH: f64 = 360.0;
const BESIDE: f64 = 130.0;

/// What a frame shows of rows: its name, the values, and those of the reference.
type Read = (&'static str, fn(&ProfileRow) -> Option<f64>, fn(&ProfileRow) -> Option<f64>);

const SATURATION: Read = ("effective saturation (1)", |row| Some(row.temperature_c), |row| row.temperature_ref_c);
const CONCENTRATION: Read = ("concentration (1)", |row| row.concentration, |row| row.concentration_ref);

pub(crate) fn draw(profiles: &[ProfileRow], words: &Words) -> Canvas {
    let carries = profiles.iter().any(|row| row.concentration.is_some());
    let reads: &[Read] = if carries { &[SATURATION, CONCENTRATION] } else { &[SATURATION] };
    let planes = by_plane(profiles);
    let instants = instants(profiles);
    let colour = method_style(&words.method).colour;
    let stroke_at = |k: usize| Stroke::whole(aged(colour, k, instants.len()), 2.4);
    let mut entries: Vec<Entry> =
        instants.iter().enumerate().map(|(k, time)| Entry::line(words.instant(*time), stroke_at(k))).collect();
    let known = |row: &ProfileRow| reads.iter().any(|read| read.2(row).is_some());
    if profiles.iter().any(known) {
        entries.push(Entry::line("reference", DOTS));
    }
    let count = planes.len() * reads.len();
    let what = if carries { "Profiles of saturation and concentration" } else { "Profiles of saturation" };
    let names = (&*words.name(what), &*words.heading);
    let (mut canvas, top) = sheet(BESIDE + EACH * count as f64, names, &entries, 10.0);
    let each = (canvas.height - top) / count as f64;
    let (scale, symbol) = words.along(profiles);
    let mut drawn = Vec::new();
    for (plane, rows) in &planes {
        for (number, read) in reads.iter().enumerate() {
            let above = top + each * drawn.len() as f64;
            // Frames of one plane share the name of their axis.
            let last = number + 1 == reads.len();
            let label = if last { place_label(plane, rows, words, symbol) } else { String::new() };
            let x = Axis::linear(label, rows.iter().map(|row| scale * row.along_m));
            let values = rows.iter().flat_map(|row| [read.1(row), read.2(row)]).flatten();
            let y = Axis::linear(read.0, values.chain([0.0, 1.0]));
            let below = above + each - if last { 0.9 * LABEL } else { 0.0 };
            drawn.push((Frame::inside((0.0, above), (WIDTH, below), x, y), rows, read));
        }
    }
    let mut frames: Vec<Frame> = drawn.iter().map(|(frame, ..)| frame.clone()).collect();
    align(&mut frames);
    for (frame, (_, rows, read)) in frames.iter().zip(&drawn) {
        frame.draw(&mut canvas);
        for (k, time) in instants.iter().enumerate() {
            let own = || rows.iter().filter(|row| row.time_s == *time);
            let points = own().filter_map(|row| Some((scale * row.along_m, read.1(row)?)));
            frame.curve(&mut canvas, points, stroke_at(k));
            let references = own().filter_map(|row| Some((scale * row.along_m, read.2(row)?)));
            frame.curve(&mut canvas, references, DOTS);
        }
    }
    canvas
}
