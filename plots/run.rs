//! The figures of one run: front and profiles beside the reference.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use frazil_record::{CutRow, Field, MeanOver, ProfileRow, RunResult, WallRow};

use crate::PlotError;
use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Colour, Formats, Stroke};
use crate::sheet::{WIDTH, sheet};
use crate::style::{INK, LABEL, REFERENCE, method_style, method_title, number};
use crate::words::{DOTS, FigureOptions, Words, reference_entry, reference_stroke};
use crate::{flow_map, map, measured, moisture_map, moisture_profiles, rings, stream, table};

/// Draws every figure that a run has rows for and returns the files.
///
/// # Errors
///
/// If a picture cannot be encoded or written.
pub fn run_figures(
    result: &RunResult,
    folder: &Path,
    options: &FigureOptions,
    formats: Formats,
) -> Result<Vec<PathBuf>, PlotError> {
    let mut files = Vec::new();
    for (name, canvas) in drawings(result, options) {
        files.extend(canvas.write(folder, &name, formats)?);
    }
    Ok(files)
}

/// Names of figures without their endings, beside those of tables, and what others begin with before a time.
const NAMES: [&str; 13] = [
    "front",
    "measured",
    "profiles",
    "ice",
    "cut",
    "wall",
    "heat",
    "gaps",
    "phases",
    "stream",
    "sections",
    "random_conductivity",
    "random_permeability",
];
const AT_TIMES: [&str; 3] = ["map_", "concentration_", "pressure_"];

/// Whether a figure of a run may have this name, without its ending; those of tables have that of their table.
pub fn is_figure(name: &str) -> bool {
    let is_digit = |letter: char| letter.is_ascii_digit();
    let at_time = |begin: &str| name.strip_prefix(begin).is_some_and(|time| time.starts_with(is_digit));
    NAMES.contains(&name) || AT_TIMES.into_iter().any(at_time)
}

/// Every figure that a run has rows for, by its file name without ending.
pub fn drawings(result: &RunResult, options: &FigureOptions) -> Vec<(String, Canvas)> {
    let words = Words::of(result, options);
    let mut all: Vec<(String, Canvas)> = Vec::new();
    let mut add = |name: &str, has_rows: bool, draw: &dyn Fn() -> Canvas| {
        all.extend(has_rows.then(|| (name.into(), draw())));
    };
    add("front", result.front.iter().any(|row| row.front_m > 0.0), &|| front(result, &words));
    let moist = options.unsaturated.as_ref();
    add("profiles", !result.profiles.is_empty(), &|| match moist {
        Some(_) => moisture_profiles::draw(&result.profiles, &words),
        None => profiles(&result.profiles, &words),
    });
    if let Some(water) = &result.water {
        add("ice", water.rows.iter().any(|row| row.ice_fraction > 0.0), &|| flow_map::ice(&water.rows, &words));
        let rows: Vec<ProfileRow> = water.cut.iter().map(|row| cut_row(row, options.cut)).collect();
        add("cut", !rows.is_empty(), &|| profiles(&rows, &words));
    }
    let thick = |row: &WallRow| row.thickness_main_mean_m.or(row.thickness_interface_mean_m).is_some();
    add("wall", result.walls.iter().any(thick), &|| rings::wall(result, &words));
    add("heat", !result.walls.is_empty(), &|| rings::heat(result, &words));
    add("gaps", !result.gaps.is_empty(), &|| rings::gaps(result, &words));
    add("phases", !result.phases.is_empty(), &|| stream::phases(&result.phases, &words));
    add("stream", !result.stream.is_empty(), &|| stream::stream(result, &words));
    add("sections", !result.sections.is_empty(), &|| stream::sections(&result.sections, &words));
    let run = [(method_title(&words.method), result)];
    all.extend(measured::drawing(&run, options).map(|canvas| ("measured".into(), canvas)));
    all.extend(result.tables.iter().filter_map(|table| table::drawing(table, &words)));
    let ground = options.ground.iter();
    all.extend(ground.map(|(name, field)| (format!("random_{name}"), map::ground_map(name, field, &words))));
    for field in &result.fields {
        let time = number(words.time(field.time_s), 4).replace([' ', '·'], "").replace('−', "-");
        let map = match moist {
            Some(outlines) => moisture_map::saturation_map(field, outlines, &words),
            None => map::temperature_map(field, &options.plan, &words),
        };
        all.push((format!("map_{time}{}", words.time_symbol), map));
        let carried = moist.and_then(|outlines| moisture_map::concentration_map(field, outlines, &words));
        all.extend(carried.map(|canvas| (format!("concentration_{time}{}", words.time_symbol), canvas)));
        let mut points = result.water.iter().flat_map(|water| water.maps.chunk_by(|a, b| a.time_s == b.time_s));
        if let Some(points) = points.find(|points| points[0].time_s == field.time_s) {
            let drawn = flow_map::pressure_map(field, points, options, &words);
            all.extend(drawn.map(|canvas| (format!("pressure_{time}{}", words.time_symbol), canvas)));
        }
    }
    all
}

/// One frame of an animation of a scene (title, method, units), with colours between given temperatures.
pub fn frame(
    field: &Field,
    (heading, method, units): (&str, &str, &str),
    options: &FigureOptions,
    range: (f64, f64),
) -> Canvas {
    let words = Words::new((heading, method, units), 0.0, options);
    match &options.unsaturated {
        Some(outlines) => moisture_map::plain_map(field, outlines, &words),
        None => map::plain_map(field, &options.plan, &words, Some(range)),
    }
}

fn front(result: &RunResult, words: &Words) -> Canvas {
    let style = method_style(&words.method);
    let stroke = style.stroke(2.2);
    let points: Vec<_> = result.measured.iter().filter(|row| measured::is_of_front(row)).collect();
    // What is known at single instants is no curve.
    let referred = points.is_empty() && result.front.iter().any(|row| row.front_ref_m.is_some());
    let mut entries = vec![Entry::line(method_title(&words.method), stroke)];
    if referred {
        entries.push(reference_entry());
    }
    entries.extend((!points.is_empty()).then(measured::entry));
    let beside = Stroke { colour: INK, width: 1.6, dash: &[7.0, 4.0] };
    if let Some(row) = result.beside.first() {
        entries.push(Entry::line(row.solution.as_str(), beside));
    }
    let names = (&*words.name(words.front.0), &*words.heading);
    let (mut canvas, top) = sheet(720.0, names, &entries, 6.0);
    let times = || result.front.iter().map(|row| words.time(row.time_s)).chain([0.0]);
    let heights = result.front.iter().flat_map(|row| [Some(row.front_m), row.front_ref_m]).flatten();
    let bars = points.iter().map(|row| row.value_ref + row.value_ref_sd);
    let heights = heights.chain(result.beside.iter().map(|row| row.front_m)).chain(bars);
    let y = Axis::linear(words.length_label(words.front.1), heights.map(|height| words.length(height)));
    let split = if referred { 445.0 } else { 720.0 };
    let below = referred.then(|| {
        let errors: Vec<f64> = result.front.iter().filter_map(relative_error).collect();
        let mut sorted = errors.clone();
        sorted.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        // The first instants, when the front is thinner than a particle, would hide all others.
        let typical = sorted.get(sorted.len() * 9 / 10).map_or(0.01, |error| 1.3 * error.abs()).max(1e-6);
        let shown = errors.iter().map(|error| 100.0 * error.clamp(-typical, typical)).chain([0.0]);
        let y = Axis::linear(words.front.2, shown);
        Frame::inside((0.0, split + 14.0), (WIDTH, 720.0), Axis::linear(words.time_label.as_str(), times()), y)
    });
    let label = if referred { String::new() } else { words.time_label.clone() };
    let mut frames = vec![Frame::inside((0.0, top), (WIDTH, split), Axis::linear(label, times()), y)];
    frames.extend(below);
    align(&mut frames);
    let above = &frames[0];
    above.draw(&mut canvas);
    if referred {
        let rows = result.front.iter().filter_map(|row| Some((row.time_s, row.front_ref_m?)));
        above.curve(&mut canvas, rows.map(|(t, s)| (words.time(t), words.length(s))), reference_stroke());
    }
    let rows = result.beside.iter().map(|row| (words.time(row.time_s), words.length(row.front_m)));
    above.curve(&mut canvas, rows, beside);
    let rows = result.front.iter().map(|row| (words.time(row.time_s), words.length(row.front_m)));
    above.curve(&mut canvas, rows, stroke);
    measured::marks(&mut canvas, above, points.into_iter(), words.length(1.0), words);
    if let Some(below) = frames.get(1) {
        below.draw(&mut canvas);
        below.level(&mut canvas, 0.0, Stroke::whole(REFERENCE, 1.5));
        let rows = result.front.iter().filter_map(|row| Some((words.time(row.time_s), 100.0 * relative_error(row)?)));
        // Alone in its frame, it need not be told from others, and dashes would hide its bends.
        below.curve(&mut canvas, rows, Stroke::whole(style.colour, 2.2));
    }
    canvas
}

fn relative_error(row: &frazil_record::FrontRow) -> Option<f64> {
    row.front_ref_m.filter(|reference| *reference > 0.0).map(|reference| row.front_m / reference - 1.0)
}

/// A point of the cut through flowing water as one of a profile.
fn cut_row(row: &CutRow, y: f64) -> ProfileRow {
    ProfileRow {
        plane: format!("y={}", number(y, 4)),
        time_s: row.time_s,
        x_m: Some(row.x_m),
        temperature_c: row.temperature_c,
        temperature_ref_c: row.temperature_ref_c,
        frozen_fraction: row.frozen_fraction,
        concentration: None,
        concentration_ref: None,
        y_m: Some(y),
        along_m: row.x_m,
        mean_over: None,
    }
}

/// The colour of profile `k` of `count`: later ones are darker.
pub(crate) fn aged(colour: Colour, k: usize, count: usize) -> Colour {
    let age = if count > 1 { k as f64 / (count - 1) as f64 } else { 1.0 };
    colour.tint(0.55 * (1.0 - age))
}

/// Rows of profiles by their planes.
pub(crate) fn by_plane(profiles: &[ProfileRow]) -> BTreeMap<&str, Vec<&ProfileRow>> {
    let mut planes: BTreeMap<&str, Vec<&ProfileRow>> = BTreeMap::new();
    for row in profiles {
        planes.entry(row.plane.as_str()).or_default().push(row);
    }
    planes
}

/// Instants of profiles, in order.
pub(crate) fn instants(profiles: &[ProfileRow]) -> Vec<f64> {
    let mut instants: Vec<f64> = profiles.iter().map(|row| row.time_s).collect();
    instants.sort_by(f64::total_cmp);
    instants.dedup();
    instants
}

/// The name of the axis along a profile, whose unit has a symbol.
pub(crate) fn place_label(plane: &str, rows: &[&ProfileRow], words: &Words, symbol: &str) -> String {
    // Rays of a ring begin at its centre, those of a row on either side of it.
    let from = if rows.iter().any(|row| row.along_m < 0.0) { "row" } else { "centre" };
    match plane {
        "main" => format!("distance from the {from}, through a pipe ({symbol})"),
        "interface" => format!("distance from the {from}, between two pipes ({symbol})"),
        "radius" => format!("r ({symbol})"),
        _ => match plane.split_once('=') {
            Some((axis, at)) => {
                let along = match axis {
                    "z" => "r",
                    "r" => "z",
                    "y" => "x",
                    _ => "y",
                };
                let unit = if words.length_unit.is_some() { " m" } else { "" };
                format!("{along} at {axis} = {at}{unit} ({symbol})")
            }
            None => match rows.first().and_then(|row| row.mean_over) {
                Some(MeanOver::X) => format!("y, means over all x ({symbol})"),
                Some(MeanOver::Y) => format!("x, means over all y ({symbol})"),
                None => format!("x ({symbol})"),
            },
        },
    }
}

fn profiles(profiles: &[ProfileRow], words: &Words) -> Canvas {
    let planes = by_plane(profiles);
    let single = planes.len() == 1;
    let height = if single { 640.0 } else { 110.0 + 400.0 * planes.len() as f64 };
    let instants = instants(profiles);
    let base = method_style(&words.method);
    let stroke_at = |k: usize| Stroke::whole(aged(base.colour, k, instants.len()), 2.4);
    let mut entries: Vec<Entry> =
        instants.iter().enumerate().map(|(k, time)| Entry::line(words.instant(*time), stroke_at(k))).collect();
    if profiles.iter().any(|row| row.temperature_ref_c.is_some()) {
        entries.push(Entry::line("reference", DOTS));
    }
    let isotherm = Stroke::whole(REFERENCE, 1.6);
    let freezing = words.freezing_point.map(|point| format!("freezing point, {}{}", number(point, 3), words.degree));
    entries.extend(freezing.map(|freezing| Entry::line(freezing, isotherm)));
    let names = (&*words.name("Temperature profiles"), &*words.heading);
    let (mut canvas, mut top) = sheet(height, names, &entries, 10.0);
    const GAP: f64 = 0.9 * LABEL;
    let each = (height - top - GAP * (planes.len() - 1) as f64) / planes.len() as f64;
    let (scale, symbol) = words.along(profiles);
    for (plane, rows) in planes {
        let x_label = place_label(plane, &rows, words, symbol);
        let x = Axis::linear(x_label, rows.iter().map(|row| scale * row.along_m));
        let values = rows.iter().flat_map(|row| [Some(row.temperature_c), row.temperature_ref_c]).flatten();
        let y = Axis::linear(words.temperature_label.as_str(), values.chain(words.freezing_point));
        let frame = Frame::inside((0.0, top), (WIDTH, top + each), x, y);
        frame.draw(&mut canvas);
        if let Some(point) = words.freezing_point {
            frame.level(&mut canvas, point, isotherm);
        }
        for (k, time) in instants.iter().enumerate() {
            let rows: Vec<_> = rows.iter().filter(|row| row.time_s == *time).collect();
            frame.curve(&mut canvas, rows.iter().map(|row| (scale * row.along_m, row.temperature_c)), stroke_at(k));
            let references = rows.iter().filter_map(|row| Some((scale * row.along_m, row.temperature_ref_c?)));
            frame.curve(&mut canvas, references, DOTS);
        }
        top += each + GAP;
    }
    canvas
}
