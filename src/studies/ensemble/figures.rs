//! From tables of means to figures: series over time, and profiles at their instants.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use frazil_plots::PlotError;
use frazil_plots::canvas::Formats;
use frazil_plots::ensemble::{BandFigure, Curve, Look, Panel, Point, bands};
use frazil_plots::style::number;
use frazil_scene::{Scene, Units};

use super::Study;
use super::table::{ALONG, INTERVAL, PLACE, Role, Table, reference_of};
use crate::figures::Figures;

/// Instants of rows.
const TIME: &str = "time_s";

/// The place across, where series have two.
const HEIGHT: &str = "y_m";

/// Most curves that one panel can show.
const MOST_CURVES: usize = 6;

/// Most curves of a panel that is not confused by thin lines of members.
const MOST_WITH_MEMBERS: usize = 3;

/// Endings of column names, longest first, and the units that they stand for.
const UNITS: [(&str, &str); 15] = [
    ("_w_per_m2", "W/m²"),
    ("_m3_per_s", "m³/s"),
    ("_w_per_m", "W/m"),
    ("_m_per_s", "m/s"),
    ("_m3", "m³"),
    ("_m2", "m²"),
    ("_pa", "Pa"),
    ("_deg", "degrees"),
    ("_kg", "kg"),
    ("_rel", ""),
    ("_m", "m"),
    ("_c", "°C"),
    ("_s", "s"),
    ("_j", "J"),
    ("_w", "W"),
];

/// Draws every series that has a figure.
pub fn draw(study: &Study, scene: &Scene, folder: &Path, formats: Formats, threads: usize) -> Result<(), PlotError> {
    let mut figures = Figures::default();
    for (name, means) in &study.means {
        let members: Vec<&Table> = study.members.iter().filter_map(|member| member.get(name)).collect();
        let panels = Series { means, members: &members, scene }.panels();
        if panels.is_empty() {
            continue;
        }
        let figure = BandFigure {
            heading: study.record.title.clone(),
            method: study.record.method.clone(),
            members: study.record.averaged,
            panels,
        };
        figures.add(folder, name.trim_end_matches(".csv"), bands(&figure));
    }
    figures.write(formats, threads)
}

/// A table of means with those of the members.
struct Series<'a> {
    means: &'a Table,
    members: &'a [&'a Table],
    scene: &'a Scene,
}

/// A number of a run, as its columns stand in the table of means.
struct Quantity<'a> {
    name: &'a str,
    words: String,
    unit: &'static str,
    column: usize,
    interval: usize,
    reference: Option<usize>,
}

impl<'a> Series<'a> {
    fn panels(&self) -> Vec<Panel> {
        let quantities = self.quantities();
        let has = |name: &str| self.means.column(name).is_some();
        match (has(TIME), has(PLACE), has(HEIGHT)) {
            (true, ..) if has(ALONG) => self.profiles(ALONG, TIME, &quantities),
            (true, true, false) => self.profiles(PLACE, TIME, &quantities),
            (false, _, true) => self.profiles(HEIGHT, PLACE, &quantities),
            (true, ..) => self.over_time(&quantities),
            (false, ..) => Vec::new(),
        }
    }

    fn quantities(&self) -> Vec<Quantity<'a>> {
        let means = self.means;
        let quantity = |(column, name): (usize, &'a str)| {
            let interval = means.column(&format!("{name}{INTERVAL}"))?;
            let reference = means.columns().position(|other| reference_of(other).as_deref() == Some(name));
            let (stem, unit) = UNITS
                .iter()
                .find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *unit)))
                .filter(|(stem, _)| !stem.is_empty())
                .unwrap_or((name, ""));
            Some(Quantity { name, words: stem.replace('_', " "), unit, column, interval, reference })
        };
        // Balances are rounding.
        means.columns().enumerate().filter(|(_, name)| *name != "balance_rel").filter_map(quantity).collect()
    }

    fn si(&self) -> bool {
        self.scene.units == Units::Si
    }

    fn label(&self, words: &str, unit: &str) -> String {
        if !self.si() || unit.is_empty() { words.to_owned() } else { format!("{words} ({unit})") }
    }

    fn time(&self, seconds: f64) -> f64 {
        if self.si() { seconds / self.scene.time_unit.seconds() } else { seconds }
    }

    /// One panel for each unit, and one of errors below those with a reference.
    fn over_time(&self, quantities: &[Quantity<'_>]) -> Vec<Panel> {
        let Some(time) = self.means.column(TIME) else { return Vec::new() };
        let kinds = kinds(self.means, &[TIME]);
        let distinct = in_order(kinds.iter());
        let units = in_order(quantities.iter().map(|own| own.unit));
        let mut panels = Vec::new();
        for unit in units {
            let own: Vec<&Quantity<'_>> = quantities.iter().filter(|quantity| quantity.unit == unit).collect();
            let count = own.len() * distinct.len();
            if count > 4 * MOST_CURVES {
                continue;
            }
            let thin = count <= MOST_WITH_MEMBERS;
            let single = own.len() == 1;
            let mut curves = Vec::new();
            for quantity in &own {
                for kind in &distinct {
                    let name = match (kind.is_empty(), single) {
                        (true, _) => quantity.words.clone(),
                        (false, true) => (*kind).clone(),
                        (false, false) => format!("{}, {kind}", quantity.words),
                    };
                    let rows = || (0..self.means.len()).filter(|row| kinds[*row] == **kind);
                    let at = |row: usize| Some(self.time(self.means.number(row, time)?));
                    let members = if thin { self.lines(quantity.name, kind) } else { Vec::new() };
                    let reference = quantity.reference.map_or(Vec::new(), |column| {
                        rows().filter_map(|row| Some((at(row)?, self.means.number(row, column)?))).collect()
                    });
                    let points: Vec<Point> = rows().filter_map(|row| self.point(row, at(row)?, quantity)).collect();
                    // A wall that lets nothing through has no curve.
                    if points.iter().any(|point| point.mean != 0.0) {
                        curves.push(Curve { name, look: Look::Kind(curves.len()), points, members, reference });
                    }
                }
            }
            if curves.is_empty() || curves.len() > MOST_CURVES {
                continue;
            }
            let words = if single { own[0].words.as_str() } else { what(unit) };
            let errors: Vec<Curve> = curves.iter().filter_map(relative).collect();
            panels.push(Panel { x_label: String::new(), y_label: self.label(words, unit), curves, errors: false });
            if !errors.is_empty() {
                let y_label = format!("error of {} (%)", if single { words } else { "these" });
                panels.push(Panel { x_label: String::new(), y_label, curves: errors, errors: true });
            }
        }
        if let Some(last) = panels.last_mut() {
            last.x_label = if self.si() {
                format!("time ({})", self.scene.time_unit.symbol())
            } else {
                "time (dimensionless)".into()
            };
        }
        panels
    }

    /// One panel for each quantity on each plane along `along`, with a curve for each of `each` (an instant or a section),
    /// and its error where that is known.
    fn profiles(&self, along: &str, each: &str, quantities: &[Quantity<'_>]) -> Vec<Panel> {
        let Some(place) = self.means.column(along) else { return Vec::new() };
        let each_column = self.means.column(each);
        let planes = kinds(self.means, &[along, each]);
        let cut = |row: usize| each_column.map_or("", |column| self.means.text(row, column));
        let cuts = in_order((0..self.means.len()).map(cut));
        let mut panels = Vec::new();
        for plane in in_order(planes.iter()) {
            for quantity in quantities {
                let curve = |(k, own): (usize, &&str)| {
                    let rows = || (0..self.means.len()).filter(|row| planes[*row] == *plane && cut(*row) == *own);
                    let at = |row: usize| self.means.number(row, place);
                    let name = own.parse().map_or(quantity.words.clone(), |value| self.cut_words(each, value));
                    let reference = quantity.reference.map_or(Vec::new(), |column| {
                        rows().filter_map(|row| Some((at(row)?, self.means.number(row, column)?))).collect()
                    });
                    let points = rows().filter_map(|row| self.point(row, at(row)?, quantity)).collect();
                    Curve { name, look: Look::Instant(k, cuts.len()), points, members: Vec::new(), reference }
                };
                let curves: Vec<Curve> = cuts.iter().enumerate().map(curve).collect();
                let errors: Vec<Curve> = curves.iter().filter_map(absolute).collect();
                let y_label = self.label(&quantity.words, quantity.unit);
                panels.push(Panel { x_label: String::new(), y_label, curves, errors: false });
                if !errors.is_empty() {
                    let y_label = self.label(&format!("error of {}", quantity.words), quantity.unit);
                    panels.push(Panel { x_label: String::new(), y_label, curves: errors, errors: true });
                }
            }
            if let Some(last) = panels.last_mut() {
                let what = if along == HEIGHT { "height" } else { "distance" };
                let words = match plane.as_str() {
                    "line" | "" => what.to_owned(),
                    other => format!("{what}, {other}"),
                };
                last.x_label = self.label(&words, "m");
            }
        }
        panels
    }

    /// An instant or a section in words.
    fn cut_words(&self, each: &str, value: f64) -> String {
        let (name, value, unit) = match each {
            TIME => ("", self.time(value), self.scene.time_unit.symbol()),
            _ => ("x = ", value, "m"),
        };
        format!("{name}{} {}", number(value, 4), if self.si() { unit } else { "" }).trim_end().to_owned()
    }

    fn point(&self, row: usize, x: f64, quantity: &Quantity<'_>) -> Option<Point> {
        let mean = self.means.number(row, quantity.column)?;
        Some(Point { x, mean, half_width: self.means.number(row, quantity.interval).unwrap_or(0.0) })
    }

    /// A quantity of each member over time.
    fn lines(&self, name: &str, kind: &str) -> Vec<Vec<(f64, f64)>> {
        let line = |table: &&Table| {
            let (time, column) = table.column(TIME).zip(table.column(name))?;
            let kinds = kinds(table, &[TIME]);
            let rows = (0..table.len()).filter(|row| kinds[*row] == kind);
            Some(
                rows.filter_map(|row| Some((self.time(table.number(row, time)?), table.number(row, column)?)))
                    .collect(),
            )
        };
        self.members.iter().filter_map(line).collect()
    }
}

/// What tells curves of one quantity apart, row by row.
fn kinds(table: &Table, besides: &[&str]) -> Vec<String> {
    let keys: Vec<(usize, &str)> = table
        .columns()
        .enumerate()
        .filter(|(column, name)| !besides.contains(name) && matches!(table.role(*column), Role::Key | Role::Place))
        .collect();
    let words = |row: usize, (column, name): (usize, &str)| match table.number(row, column) {
        Some(value) => format!("{} = {}", name.split('_').next().unwrap_or(name), number(value, 4)),
        None => table.text(row, column).to_owned(),
    };
    (0..table.len()).map(|row| keys.iter().map(|key| words(row, *key)).collect::<Vec<_>>().join(", ")).collect()
}

/// What numbers of a unit have in common.
fn what(unit: &str) -> &'static str {
    match unit {
        "m" => "length",
        "m²" => "area",
        "m³" => "volume",
        "m³/s" => "flow",
        "m/s" => "velocity",
        "Pa" => "pressure",
        "°C" => "temperature",
        "J" => "heat",
        "W" | "W/m" | "W/m²" => "heat by time",
        "s" => "time",
        "kg" => "mass",
        _ => "value",
    }
}

/// Each once, in the order in which they come.
fn in_order<'a, T: AsRef<str> + ?Sized + 'a>(words: impl Iterator<Item = &'a T>) -> Vec<&'a T> {
    let mut seen: BTreeSet<&'a str> = BTreeSet::new();
    words.filter(|word: &&'a T| seen.insert((*word).as_ref())).collect()
}

/// Errors over the reference, in per cent; where that is positive.
fn relative(curve: &Curve) -> Option<Curve> {
    compared(curve, |value, expected| (expected > 0.0).then(|| (100.0 * (value / expected - 1.0), 100.0 / expected)))
}

/// Differences from the reference.
fn absolute(curve: &Curve) -> Option<Curve> {
    compared(curve, |value, expected| Some((value - expected, 1.0)))
}

/// A curve of errors, by what makes an error of a value and its reference, and a factor for its interval.
fn compared(curve: &Curve, error: impl Fn(f64, f64) -> Option<(f64, f64)>) -> Option<Curve> {
    let expected: BTreeMap<u64, f64> = curve.reference.iter().map(|(x, value)| (x.to_bits(), *value)).collect();
    let at = |x: f64, value: f64| error(value, *expected.get(&x.to_bits())?);
    let points: Vec<Point> = curve
        .points
        .iter()
        .filter_map(|point| {
            let (mean, factor) = at(point.x, point.mean)?;
            Some(Point { x: point.x, mean, half_width: factor * point.half_width })
        })
        .collect();
    let line = |line: &Vec<(f64, f64)>| line.iter().filter_map(|(x, value)| Some((*x, at(*x, *value)?.0))).collect();
    let members = curve.members.iter().map(line).collect();
    (!points.is_empty()).then(|| Curve { points, members, reference: Vec::new(), ..curve.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_of_values_at_the_same_place() {
        let point = |x: f64, mean: f64| Point { x, mean, half_width: 0.1 };
        let curve = Curve {
            name: "front".into(),
            look: Look::Kind(0),
            points: vec![point(0.0, 1.0), point(1.0, 1.1), point(2.0, 3.0)],
            members: vec![vec![(1.0, 2.0), (2.0, 4.0), (5.0, 1.0)]],
            reference: vec![(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)],
        };
        let relative = relative(&curve).expect("a reference");
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        assert_eq!(relative.points.len(), 2, "where the reference is zero nothing is relative to it");
        close(relative.points[0].mean, 10.0);
        close(relative.points[0].half_width, 10.0);
        close(relative.points[1].half_width, 5.0);
        assert_eq!(relative.members, [[(1.0, 100.0), (2.0, 100.0)]]);
        close(absolute(&curve).expect("a reference").points[2].mean, 1.0);
        assert_eq!(super::relative(&Curve { reference: Vec::new(), ..curve }), None);
    }
}
