//! What instruments have measured as the reference: tables beside the scene, with the standard deviation of each value.

use super::super::range::{Range, plain, temperatures};
use super::super::section::{Key, Section};
use super::super::watch::{MOST_PLACES, few, inside};
use super::{Around, Kind};
use crate::measured::{Event, Measured, MeasuredPoint, Quantity};
use crate::scene::{ReferenceChoice, Scene};

pub(super) const KIND: Kind = Kind {
    word: "measured",
    keys: &["source", "front", "probes", "events"],
    sketch: "front = {}\nprobes = {}\nevents = {}\n",
    read,
};

/// Relative rounding by which an instant may lie after the end.
const AT_THE_END: f64 = 1e-12;

fn read(section: &mut Section<'_>, around: &Around<'_>) -> ReferenceChoice {
    let source = section.text("source");
    section.at_least_one(&["front".into(), "probes".into(), "events".into()]);
    let mut points = Vec::new();
    if let Some(mut table) = section.optional_section("front") {
        points.extend(of_file(&mut table, Deviation::Of(("sd", "m").into()), front));
    }
    if let Some(mut table) = section.optional_section("probes") {
        let of_water = around.of_water;
        let sd = if of_water { Deviation::Of("sd".into()) } else { Deviation::Of(("sd", "K").into()) };
        points.extend(of_file(&mut table, sd, |row| probe(row, around)));
    }
    if let Some(mut table) = section.optional_section("events") {
        points.extend(of_file(&mut table, Deviation::Time, event));
    }
    source.map_or(ReferenceChoice::Auto, |source| ReferenceChoice::Measured(Measured { source, points }))
}

/// What a row says, without its standard deviation.
type Value = (Quantity, f64, f64);

fn front(row: &mut Section<'_>) -> Option<Value> {
    let time = row.duration("time", Range::NOT_NEGATIVE);
    let front = row.number(("front", "m"), Range::NOT_NEGATIVE);
    Some((Quantity::Front, time.ok()?.seconds, front.ok()?))
}

fn probe(row: &mut Section<'_>, around: &Around<'_>) -> Option<Value> {
    let time = row.duration("time", Range::POSITIVE);
    let x = row.number(("x", "m"), Range::ANY);
    let plane = around.domain.is_some_and(|domain| domain.dimension() > 1);
    let y = if plane { row.number(("y", "m"), Range::ANY) } else { Ok(0.0) };
    let value = match around.of_water {
        true => row.fraction("saturation"),
        false => row.number(("temperature", "c"), temperatures(row.units().absolute_zero())),
    };
    let (x, y) = (x.ok()?, y.ok()?);
    if let Some(domain) = around.domain.filter(|domain| !inside(domain, x, y)) {
        let place = if domain.dimension() > 1 { format!("{}, {}", plain(x), plain(y)) } else { plain(x) };
        row.problem(("x", "m"), format!("found [{place}], must lie inside the domain"));
        return None;
    }
    Some((Quantity::Probe { x, y }, time.ok()?.seconds, value.ok()?))
}

fn event(row: &mut Section<'_>) -> Option<Value> {
    let event = row.choice("event", &Event::ALL.map(|event| (event.name(), event)));
    let time = row.duration("time", Range::POSITIVE).ok()?.seconds;
    Some((Quantity::Event(event.ok()?), time, time))
}

/// The standard deviation of a value: a column, or a key beside the file for rows that have none.
#[derive(Clone, Copy)]
enum Deviation {
    /// A quantity.
    Of(Key),
    /// A time, in any of its units.
    Time,
}

impl Deviation {
    /// Its base, under which it is found wherever it is.
    const BASE: &'static str = "sd";

    /// Whether a section has one, and which.
    fn given(self, section: &mut Section<'_>) -> (bool, Option<f64>) {
        match self {
            Deviation::Of(key) => (section.has(key), section.optional_number(key, Range::POSITIVE)),
            Deviation::Time => {
                let duration = section.optional_duration(Self::BASE, Range::POSITIVE);
                (section.has_time(Self::BASE), duration.map(|duration| duration.seconds))
            }
        }
    }

    fn written(self, section: &Section<'_>) -> String {
        match self {
            Deviation::Of(key) => key.written(section.units()),
            Deviation::Time => section.time_key(Self::BASE),
        }
    }
}

/// The points of a file.
fn of_file(
    table: &mut Section<'_>,
    sd: Deviation,
    mut read: impl FnMut(&mut Section<'_>) -> Option<Value>,
) -> Vec<MeasuredPoint> {
    let (is_given, of_all) = sd.given(table);
    let Ok((name, text)) = table.file("file") else { return Vec::new() };
    let mut taken = false;
    let points = table.rows(&text, &name, |row| {
        let (own, value) = sd.given(row);
        let value = if own { value } else { of_all };
        taken |= !own;
        if !own && !is_given {
            let key = sd.written(row);
            row.note(&key, format!("missing, must be a column, or a key beside \"{name}\" in the scene"));
        }
        let (quantity, time, measured) = read(row)?;
        Some(MeasuredPoint { quantity, time, value: measured, sd: value? })
    });
    let Ok(mut points) = points else { return Vec::new() };
    if is_given && !taken {
        let key = sd.written(table);
        table.note(&key, format!("has no effect, every row of \"{name}\" has its own"));
    }
    points.sort_by(|a, b| a.time.total_cmp(&b.time));
    points
}

/// Leaves out what was measured after the end of the run, and watches the instants and places of the rest.
pub(super) fn settle(root: &mut Section<'_>, scene: &mut Scene, mut measured: Measured) -> Measured {
    let end = scene.duration * (1.0 + AT_THE_END);
    let late = measured.points.extract_if(.., |point| point.time > end).count();
    let unit = scene.time_unit;
    let said = format!("{} {}", plain(scene.duration / unit.seconds()), unit.symbol());
    if measured.points.is_empty() && late > 0 {
        root.problem(
            "reference",
            format!("found no measured point before the end of the run at {said}, must have one"),
        );
    } else if late > 0 {
        scene.remarks.push(format!("reference: {late} measured points left out, after the end of the run at {said}"));
    }
    let mut missing = |asked: bool, key: &str, what: &str| {
        if asked {
            root.problem("reference", format!("\"{key}\" has no effect, {what}"));
        }
    };
    let of = |wanted: &dyn Fn(Quantity) -> bool| measured.points.iter().any(|point| wanted(point.quantity));
    missing(
        of(&|quantity| quantity == Quantity::Front) && !scene.has_front(),
        "front",
        "the scene has no plane or round front",
    );
    let closes = |quantity| {
        let closures = [Event::Closure, Event::FirstClosure, Event::LastClosure];
        matches!(quantity, Quantity::Event(event) if closures.contains(&event))
    };
    missing(of(&closes) && scene.rings.is_empty(), "events", "gaps close between freeze pipes alone");
    let thaws = |quantity| quantity == Quantity::Event(Event::Thaw);
    let steady = |quantity| quantity == Quantity::Event(Event::Steady);
    missing(of(&steady) && !scene.has_front(), "events", "the scene has no plane or round front to become steady");
    missing(of(&thaws) && scene.flow.is_none(), "events", "\"thawed\" needs groundwater flow");
    let places = measured.places();
    if places.len() > MOST_PLACES {
        root.problem("reference", format!("probes: {} of places", few(places.len())));
    }
    let known = scene.watch.probes.clone();
    scene.watch.probes.extend(places.into_iter().filter(|place| !known.contains(place)));
    scene.watch.measured = measured.instants();
    measured
}
