//! Figures of liquids that move: phases over time, and what is averaged across a stream.

use frazil_record::{PhaseRow, RunResult, SectionRow, StreamRow};

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Stroke};
use crate::sheet::{WIDTH, framed, sheet};
use crate::style::{BLUE, INK, LONG, ORANGE, method_style, number};
use crate::words::{DOTS, Words, reference_stroke};

const HEIGHT: f64 = 640.0;

/// A kind of share, and how it is drawn.
type Share = (&'static str, Stroke, fn(&PhaseRow) -> f64);

/// Shares of liquid, freezing and solid particles.
pub(crate) fn phases(rows: &[PhaseRow], words: &Words) -> Canvas {
    let shares: [Share; 3] = [
        ("liquid", Stroke { colour: ORANGE, width: 2.4, dash: &[] }, |row| row.liquid),
        ("freezing", Stroke { colour: INK, width: 2.4, dash: &[3.0, 4.0] }, |row| row.mushy),
        ("solid", Stroke { colour: BLUE, width: 2.4, dash: LONG }, |row| row.solid),
    ];
    let entries = shares.map(|(name, stroke, _)| Entry::line(name, stroke));
    let times = || rows.iter().map(|row| words.time(row.time_s));
    let x = Axis::linear(words.time_label.as_str(), times().chain([0.0]));
    let y = Axis::linear("share of particles (1)", [0.0, 1.0].into_iter());
    let names = (&*words.name("Phases over time"), &*words.heading);
    let (mut canvas, frame) = framed(HEIGHT, names, &entries, 6.0, (x, y));
    for (_, stroke, share) in shares {
        frame.curve(&mut canvas, times().zip(rows.iter().map(share)), stroke);
    }
    canvas
}

/// Velocity and density across a stream, one above the other.
pub(crate) fn stream(result: &RunResult, words: &Words) -> Canvas {
    let rows: &[StreamRow] = &result.stream;
    let stroke = method_style(&words.method).stroke(2.2);
    let mut entries = vec![Entry::line("measured", stroke)];
    let greatest = result.record.stream.map(|stream| stream.greatest_speed_m_per_s);
    if let Some(greatest) = greatest {
        entries.push(Entry::line(format!("parabola of {}", number(greatest, 4)), reference_stroke()));
    }
    let names = (&*words.name("Velocity and density across the stream"), &*words.heading);
    let (mut canvas, top) = sheet(HEIGHT, names, &entries, 6.0);
    let split = 0.55 * HEIGHT;
    let places = || rows.iter().map(|row| words.length(row.y_m));
    let height = rows.last().map_or(1.0, |row| row.y_m) + rows.first().map_or(0.0, |row| row.y_m);
    let x = |label: String| Axis::linear(label, [0.0, words.length(height)].into_iter());
    let speeds = rows.iter().map(|row| row.speed_m_per_s).chain([0.0]).chain(greatest);
    let speed_label = if words.length_unit.is_some() { "velocity (m/s)" } else { "velocity (dimensionless)" };
    let above = Frame::inside((0.0, top), (WIDTH, split), x(String::new()), Axis::linear(speed_label, speeds));
    let densities = rows.iter().map(|row| row.density_rel).chain([0.0, 1.0]);
    let density = Axis::linear("density over its mean (1)", densities);
    let below = Frame::inside((0.0, split + 10.0), (WIDTH, HEIGHT), x(words.length_label("y")), density);
    let mut frames = [above, below];
    align(&mut frames);
    frames.iter().for_each(|frame| frame.draw(&mut canvas));
    let [above, below] = frames;
    if let Some(greatest) = greatest {
        let parabola = (0..=100).map(|k| f64::from(k) / 100.0).map(|part| {
            let across = 2.0 * part - 1.0;
            (words.length(part * height), greatest * (1.0 - across * across))
        });
        above.curve(&mut canvas, parabola, reference_stroke());
    }
    above.curve(&mut canvas, places().zip(rows.iter().map(|row| row.speed_m_per_s)), stroke);
    below.curve(&mut canvas, places().zip(rows.iter().map(|row| row.density_rel)), stroke);
    canvas
}

/// Temperatures across the sections of a stream: further downstream is darker.
pub(crate) fn sections(rows: &[SectionRow], words: &Words) -> Canvas {
    let groups: Vec<&[SectionRow]> = rows.chunk_by(|a, b| a.x_m == b.x_m).collect();
    let base = method_style(&words.method).colour;
    let stroke_at = |k: usize| {
        let age = if groups.len() > 1 { k as f64 / (groups.len() - 1) as f64 } else { 1.0 };
        Stroke::whole(base.tint((1.0 - age) * 0.6), 2.4)
    };
    let mut entries: Vec<Entry> = groups
        .iter()
        .enumerate()
        .map(|(k, group)| Entry::line(format!("x = {}", number(words.length(group[0].x_m), 4)), stroke_at(k)))
        .collect();
    if rows.iter().any(|row| row.temperature_ref_c.is_some()) {
        entries.push(Entry::line("reference", DOTS));
    }
    let x = Axis::linear(words.length_label("y"), rows.iter().map(|row| words.length(row.y_m)).chain([0.0]));
    let temperatures = rows.iter().flat_map(|row| [Some(row.temperature_c), row.temperature_ref_c]).flatten();
    let y = Axis::linear(words.temperature_label.as_str(), temperatures);
    let names = (&*words.name("Temperatures across the stream"), &*words.heading);
    let (mut canvas, frame) = framed(HEIGHT, names, &entries, 6.0, (x, y));
    for (k, group) in groups.iter().enumerate() {
        let places = || group.iter().map(|row| words.length(row.y_m));
        frame.curve(&mut canvas, places().zip(group.iter().map(|row| row.temperature_c)), stroke_at(k));
        let reference = group.iter().filter_map(|row| Some((words.length(row.y_m), row.temperature_ref_c?)));
        frame.curve(&mut canvas, reference, DOTS);
    }
    canvas
}
