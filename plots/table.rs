//! Figures of tables that say themselves what is in them: each column over time, one above the other.

use frazil_record::{Column, Role, Table, Unit};

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Stroke};
use crate::run::aged;
use crate::sheet::{WIDTH, sheet};
use crate::style::{method_style, number};
use crate::words::Words;

/// Height of one panel (px).
const PANEL: f64 = 300.0;
/// Dashes of curves, which tell them apart where colours do not.
const DASHES: [&[f64]; 4] = [&[], &[12.0, 5.0], &[3.0, 4.0], &[14.0, 4.0, 3.0, 4.0]];

/// The figure of a table by its name, if the table has a value.
pub(crate) fn drawing(table: &Table, words: &Words) -> Option<(String, Canvas)> {
    let has_value = |k: &usize| table.columns[*k].role != Role::Key && table.rows.iter().any(|row| row[*k].is_some());
    let panels: Vec<usize> = (0..table.columns.len()).filter(has_value).collect();
    if panels.is_empty() {
        return None;
    }
    // The time tells instants apart, other keys curves.
    let keys: Vec<usize> = (1..table.columns.len()).filter(|k| table.columns[*k].role == Role::Key).collect();
    let curve_of = |row: &[Option<f64>]| keys.iter().map(|k| row[*k]).collect::<Vec<_>>();
    let mut curves: Vec<Vec<Option<f64>>> = Vec::new();
    for row in &table.rows {
        let own = curve_of(row);
        if !curves.contains(&own) {
            curves.push(own);
        }
    }
    let colour = method_style(&words.method).colour;
    let stroke =
        |k: usize| Stroke { colour: aged(colour, k, curves.len()), width: 2.2, dash: DASHES[k % DASHES.len()] };
    let entry = |(k, values): (usize, &Vec<Option<f64>>)| {
        let parts = keys.iter().zip(values).map(|(key, value)| named(&table.columns[*key], *value, words));
        Entry::line(parts.collect::<Vec<_>>().join(", "), stroke(k))
    };
    let entries: Vec<Entry> = if keys.is_empty() { Vec::new() } else { curves.iter().enumerate().map(entry).collect() };
    let heading = words.name(&table.title);
    let (mut canvas, top) = sheet(110.0 + PANEL * panels.len() as f64, (&heading, &heading), &entries, 6.0);
    let each = (canvas.height - top) / panels.len() as f64;
    let times = || table.rows.iter().filter_map(|row| row[0]).map(|time| words.time(time)).chain([0.0]);
    let panel = |(place, k): (usize, &usize)| {
        let values = || table.rows.iter().filter_map(|row| row[*k]);
        let (scale, label) = axis(&table.columns[*k], values(), words);
        let x = if place + 1 == panels.len() { words.time_label.clone() } else { String::new() };
        let y = Axis::linear(label, values().map(|value| scale * value).chain([0.0]));
        let (above, below) = (top + each * place as f64, top + each * (place + 1) as f64 - 8.0);
        (Frame::inside((0.0, above), (WIDTH, below), Axis::linear(x, times()), y), scale)
    };
    let (mut frames, scales): (Vec<Frame>, Vec<f64>) = panels.iter().enumerate().map(panel).unzip();
    align(&mut frames);
    for ((frame, scale), k) in frames.iter().zip(&scales).zip(&panels) {
        frame.draw(&mut canvas);
        for (number, curve) in curves.iter().enumerate() {
            let own = table.rows.iter().filter(|row| curve_of(row) == *curve);
            let points = own.filter_map(|row| Some((words.time(row[0]?), *scale * row[*k]?)));
            frame.curve(&mut canvas, points, stroke(number));
        }
    }
    let stem = table.file.trim_end_matches(".csv");
    Some((stem.into(), canvas))
}

/// What values of a column are multiplied by on an axis, and its label.
fn axis(column: &Column, values: impl Iterator<Item = f64>, words: &Words) -> (f64, String) {
    let greatest = values.fold(0.0, |greatest, value| f64::max(greatest, value.abs()));
    let (scale, unit) = match column.unit {
        Unit::One => (1.0, "1"),
        _ if words.length_unit.is_none() => (1.0, "dimensionless"),
        Unit::Second => (words.time(1.0), words.time_symbol),
        Unit::Metre if greatest < 0.2 => (1e3, "mm"),
        Unit::Metre => (1.0, "m"),
        Unit::SquareMetre => (1.0, "m²"),
        Unit::CubicMetre => (1.0, "m³"),
        Unit::JoulePerMetre => (1e-6, "MJ/m"),
        Unit::JoulePerCubicMetre => (1e-6, "MJ/m³"),
        Unit::WattPerMetre => (1.0, "W/m"),
        Unit::Celsius => (1.0, "°C"),
    };
    (scale, format!("{} ({unit})", column.doc))
}

/// What a number of a key is called beside its curve.
fn named(column: &Column, value: Option<f64>, words: &Words) -> String {
    let value = value.map_or("none".into(), |value| number(value, 4));
    let unit = if column.unit == Unit::Celsius { words.degree } else { "" };
    format!("{} {value}{unit}", column.doc)
}
