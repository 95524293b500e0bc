//! Values of a section that are more than one number: lists, points and times.

use super::super::problem::{Noted, Read};
use super::super::range::{Range, plain};
use super::super::schema::Shape;
use super::super::tree::{Entry, Item, Node};
use super::{Asked, Key, Section, Spot};
use crate::TimeUnit;
use crate::units::Units;
use frazil_core::series::Schedule;
use glam::DVec2;

/// A time as it was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Duration {
    /// In seconds.
    pub seconds: f64,
    /// The unit of its key.
    pub unit: TimeUnit,
}

/// What is wrong with a list of times that ends beyond its period.
pub(super) fn beyond_period(end: f64, period: &Duration) -> Option<String> {
    let unit = period.unit;
    // Times in hours and a period in days may round differently.
    let within = end <= period.seconds * (1.0 + 1e-12);
    let (end, most) = (plain(end / unit.seconds()), plain(period.seconds / unit.seconds()));
    let message =
        format!("found an end at {end} {}, must end within the period, {most} {}", unit.symbol(), unit.symbol());
    (!within).then_some(message)
}

impl<'a> Section<'a> {
    /// The tables of a list of tables (`[[pipes]]`), or none.
    pub fn sections(&mut self, key: &'static str) -> Vec<Section<'a>> {
        let _ = self.expect(key, || Shape::Tables);
        let Some(entry) = self.ask(key.into()) else { return Vec::new() };
        let Node::List(items) = &entry.node else {
            self.wrong(&entry.key, &entry.node, &format!("a list of tables, as [[{key}]]"));
            return Vec::new();
        };
        let mut sections = Vec::with_capacity(items.len());
        for (number, item) in (1..).zip(items) {
            let path = format!("{}.{number}", entry.key);
            match &item.node {
                Node::Table(entries) => sections.push(self.child(&path, item.place.clone(), entries)),
                other => {
                    self.note_at(&item.place, &path, format!("found {}, must be a table", other.found()));
                }
            }
        }
        sections
    }

    /// A required list of numbers.
    pub fn numbers(&mut self, key: impl Into<Key>, range: Range) -> Read<Vec<f64>> {
        let key = self.expect(key, || Shape::Numbers(range));
        self.required(key, "a list of numbers", |section, entry| section.check_numbers(entry, range))
    }

    /// A list of numbers that may be absent.
    pub fn optional_numbers(&mut self, key: impl Into<Key>, range: Range) -> Option<Vec<f64>> {
        let key = self.expect(key, || Shape::Numbers(range));
        self.optional(key, |section, entry| section.check_numbers(entry, range))
    }

    /// The texts of a list, each with its place; none where the list is absent.
    pub fn texts(&mut self, key: impl Into<Key>) -> Vec<(String, Spot)> {
        let key = self.expect(key, || Shape::Texts);
        let found = self.optional(key, |section, entry| {
            let Node::List(items) = &entry.node else {
                return Err(section.wrong(&entry.key, &entry.node, "a list of texts"));
            };
            let texts = (1..).zip(items).map(|(number, item)| {
                let path = format!("{}.{number}", entry.key);
                match &item.node {
                    Node::Text(text) => Ok((text.clone(), section.spot_at(&item.place, &path))),
                    other => {
                        Err(section.note_at(&item.place, &path, format!("found {}, must be a text", other.found())))
                    }
                }
            });
            texts.collect::<Vec<_>>().into_iter().collect()
        });
        found.unwrap_or_default()
    }

    /// Records a problem of one value of a list, by its index.
    pub fn item_problem(&mut self, key: impl Into<Key>, index: usize, message: impl Into<String>) -> Noted {
        let written = key.into().written(self.units);
        match self.find(&written).map(|entry| &entry.node) {
            Some(Node::List(items)) if index < items.len() => {
                self.note_at(&items[index].place, &format!("{written}.{}", index + 1), message)
            }
            _ => self.note(&written, message),
        }
    }

    /// A list of points with this many coordinates, or any number from one; it may be absent.
    pub fn optional_points(&mut self, key: impl Into<Key>, dimension: Option<usize>) -> Option<Vec<Vec<f64>>> {
        let key = self.expect(key, || Shape::Points);
        self.optional(key, |section, entry| section.check_points(entry, dimension))
    }

    /// A required list of points.
    pub fn points(&mut self, key: impl Into<Key>, dimension: Option<usize>) -> Read<Vec<Vec<f64>>> {
        let key = self.expect(key, || Shape::Points);
        self.required(key, "a list of points", |section, entry| section.check_points(entry, dimension))
    }

    /// A required point of the plane.
    pub fn point(&mut self, key: impl Into<Key>) -> Read<(f64, f64)> {
        let key = self.expect(key, || Shape::Point);
        self.required(key, "a point, as [0.1, 0.2]", |section, entry| {
            let numbers = section.check_numbers(entry, Range::ANY)?;
            match numbers[..] {
                [x, y] => Ok((x, y)),
                _ => Err(section.note(&entry.key, format!("found {} coordinates, must be 2", numbers.len()))),
            }
        })
    }

    /// A required length, or one along each axis of a plane.
    pub fn along_axes(&mut self, key: impl Into<Key>, dimension: usize) -> Read<DVec2> {
        let key = self.expect(key, || Shape::Along);
        self.required(key, "a length, or in a plane one along each axis, as [0.2, 0.1]", |section, entry| {
            let Node::List(items) = &entry.node else {
                return section.check_number(entry, Range::POSITIVE).map(DVec2::splat);
            };
            match section.check_items(&entry.key, 1, items, Range::POSITIVE)?[..] {
                [x, y] if dimension == 2 => Ok(DVec2::new(x, y)),
                _ if dimension == 2 => {
                    Err(section.note(&entry.key, format!("found {} lengths, must be 2", items.len())))
                }
                _ => Err(section.wrong(&entry.key, &entry.node, "a number on a line")),
            }
        })
    }

    /// Refuses a time that has no effect here, with the reason.
    pub fn refuse_time(&mut self, base: &'static str, reason: &str) {
        for (key, _) in self.time_keys(base) {
            if self.find(&key).is_some() {
                self.note(&key, format!("has no effect, {reason}"));
            }
            self.refused.push(key);
        }
    }

    /// When something works, as intervals of time that may repeat: `on_h = [[0, 8], [12, 20]]`, `on_period_h = 24`. An
    /// interval of one instant begins there and never ends. Absent, it always works.
    pub fn optional_schedule(&mut self) -> Option<Schedule> {
        self.expect_time("on", || Shape::Schedule);
        let found = self.ask_time("on");
        if found.is_none() {
            self.refuse_time("on_period", "only operating times have a period");
        }
        let (entry, unit) = found?;
        self.check_schedule(entry, unit).ok()
    }

    /// A required time, given in seconds, hours or days (`duration_s`, `duration_h`, `duration_days`).
    pub fn duration(&mut self, base: &'static str, range: Range) -> Read<Duration> {
        self.expect_time(base, || Shape::Number(range));
        let (entry, unit) = self.required_time(base)?;
        self.check_duration(entry, unit, range)
    }

    /// A time that may be absent.
    pub fn optional_duration(&mut self, base: &'static str, range: Range) -> Option<Duration> {
        self.expect_time(base, || Shape::Number(range));
        let (entry, unit) = self.ask_time(base)?;
        self.check_duration(entry, unit, range).ok()
    }

    /// A required list of times, none negative, strictly increasing.
    pub fn times(&mut self, base: &'static str) -> Read<Vec<Duration>> {
        self.expect_time(base, || Shape::Numbers(Range::NOT_NEGATIVE));
        let (entry, unit) = self.required_time(base)?;
        self.check_times(entry, unit)
    }

    /// A list of times that may be absent.
    pub fn optional_times(&mut self, base: &'static str) -> Option<Vec<Duration>> {
        self.expect_time(base, || Shape::Numbers(Range::NOT_NEGATIVE));
        let (entry, unit) = self.ask_time(base)?;
        self.check_times(entry, unit).ok()
    }

    /// The key of a time as it is written in this section, for messages.
    pub fn time_key(&self, base: &'static str) -> String {
        let keys = self.time_keys(base);
        let written = keys.iter().find(|(key, _)| self.find(key).is_some());
        written.or(keys.first()).map_or_else(|| base.to_owned(), |(key, _)| key.clone())
    }

    /// Whether a time is there, in whatever unit.
    pub(in super::super) fn has_time(&self, base: &'static str) -> bool {
        self.time_keys(base).iter().any(|(key, _)| self.find(key).is_some())
    }

    /// Records a problem of a time.
    pub fn time_problem(&mut self, base: &'static str, message: impl Into<String>) -> Noted {
        let key = self.time_key(base);
        self.note(&key, message)
    }

    fn time_keys(&self, base: &'static str) -> Vec<(String, TimeUnit)> {
        if self.units == Units::Si {
            TimeUnit::ALL.map(|unit| (format!("{base}_{}", unit.ending()), unit)).to_vec()
        } else {
            vec![(base.to_owned(), TimeUnit::Second)]
        }
    }

    /// Takes note of what the value of a time may be, under each of its keys.
    fn expect_time(&mut self, base: &'static str, shape: impl Fn() -> Shape) {
        for unit in TimeUnit::ALL {
            self.expect((base, unit.ending()), &shape);
        }
    }

    fn ask_time(&mut self, base: &'static str) -> Option<(&'a Entry, TimeUnit)> {
        let keys = self.time_keys(base);
        let found: Vec<_> = keys.iter().filter_map(|(key, unit)| self.find(key).map(|entry| (entry, *unit))).collect();
        for (key, _) in keys {
            self.asked.push(Asked { key, base, quantity: true });
        }
        if let [(first, _), (second, _), ..] = found.as_slice() {
            let message = format!("found beside \"{}\", must be only one of them", first.key);
            self.note(&second.key, message);
        }
        found.first().copied()
    }

    fn required_time(&mut self, base: &'static str) -> Read<(&'a Entry, TimeUnit)> {
        let found = self.ask_time(base);
        found.ok_or_else(|| self.miss(base, self.time_keys(base).into_iter().map(|(key, _)| key).collect()))
    }

    fn check_duration(&mut self, entry: &Entry, unit: TimeUnit, range: Range) -> Read<Duration> {
        let value = self.check_number(entry, range)?;
        self.seconds(&entry.key, value, unit)
    }

    fn seconds(&mut self, key: &str, value: f64, unit: TimeUnit) -> Read<Duration> {
        let seconds = value * unit.seconds();
        if seconds.is_finite() {
            return Ok(Duration { seconds, unit });
        }
        Err(self.note(key, format!("found {}, must be a finite number of seconds", plain(value))))
    }

    fn check_times(&mut self, entry: &Entry, unit: TimeUnit) -> Read<Vec<Duration>> {
        let times = self.check_numbers(entry, Range::NOT_NEGATIVE)?;
        if let Some(pair) = times.windows(2).find(|pair| pair[0] >= pair[1]) {
            let message = format!("found {} after {}, must increase strictly", plain(pair[1]), plain(pair[0]));
            return Err(self.note(&entry.key, message));
        }
        times.into_iter().map(|time| self.seconds(&entry.key, time, unit)).collect()
    }

    fn check_schedule(&mut self, entry: &Entry, unit: TimeUnit) -> Read<Schedule> {
        let period = self.optional_duration("on_period", Range::POSITIVE);
        let Node::List(items) = &entry.node else {
            return Err(self.wrong(&entry.key, &entry.node, "a list of intervals, as [[0, 8], [12, 20]]"));
        };
        if items.is_empty() {
            return Err(self.note(&entry.key, "found an empty list, must have at least one interval"));
        }
        let mut on: Vec<(f64, f64)> = Vec::with_capacity(items.len());
        for (number, item) in (1..).zip(items) {
            let path = format!("{}.{number}", entry.key);
            let ends = self.check_numbers_of(&path, item, Range::NOT_NEGATIVE)?;
            let open = ends.len() == 1 && number == items.len() && period.is_none();
            let message = match ends.as_slice() {
                [_] if open => None,
                [from, to] if from < to => None,
                [from, to] => Some(format!("found {} after {}, must be later", plain(*to), plain(*from))),
                _ => Some(format!(
                    "found {} instants, must be 2: start and end of operation (or 1 in the last interval, for \
                     operation without end and period)",
                    ends.len()
                )),
            };
            if let Some(message) = message {
                return Err(self.note_at(&item.place, &path, message));
            }
            let from = self.seconds(&path, ends[0], unit)?.seconds;
            let to = match ends.get(1) {
                Some(to) => self.seconds(&path, *to, unit)?.seconds,
                None => f64::INFINITY,
            };
            if let Some((_, last)) = on.last()
                && from < *last
            {
                let last = plain(last / unit.seconds());
                let message = format!("found {}, must not begin before the last interval ends, {last}", plain(ends[0]));
                return Err(self.note_at(&item.place, &path, message));
            }
            on.push((from, to));
        }
        if let (Some(period), Some((_, end))) = (&period, on.last())
            && let Some(message) = beyond_period(*end, period)
        {
            return Err(self.note(&entry.key, message));
        }
        Ok(Schedule { on, period: period.map(|period| period.seconds) })
    }

    fn check_points(&mut self, entry: &Entry, dimension: Option<usize>) -> Read<Vec<Vec<f64>>> {
        let Node::List(items) = &entry.node else {
            return Err(self.wrong(&entry.key, &entry.node, "a list of points"));
        };
        let mut points = Vec::with_capacity(items.len());
        for (number, item) in (1..).zip(items) {
            let path = format!("{}.{number}", entry.key);
            let point = self.check_numbers_of(&path, item, Range::ANY)?;
            if point.is_empty() || dimension.is_some_and(|dimension| point.len() != dimension) {
                let allowed = dimension.map_or_else(|| "1 or 2".into(), |dimension| dimension.to_string());
                let message = format!("found {} coordinates, must be {allowed}", point.len());
                return Err(self.note_at(&item.place, &path, message));
            }
            points.push(point);
        }
        Ok(points)
    }

    fn check_numbers(&mut self, entry: &Entry, range: Range) -> Read<Vec<f64>> {
        match &entry.node {
            Node::List(items) => self.check_items(&entry.key, 1, items, range),
            other => Err(self.wrong(&entry.key, other, "a list of numbers")),
        }
    }

    /// Elements of a list that are numbers, counted from `first`; what is wrong with each is told.
    pub(super) fn check_items(&mut self, key: &str, first: usize, items: &[Item], range: Range) -> Read<Vec<f64>> {
        let numbers: Vec<Read<f64>> = (first..)
            .zip(items)
            .map(|(number, item)| self.check_number_at(&item.place, &format!("{key}.{number}"), &item.node, range))
            .collect();
        numbers.into_iter().collect()
    }

    fn check_numbers_of(&mut self, key: &str, item: &Item, range: Range) -> Read<Vec<f64>> {
        match &item.node {
            Node::List(items) => self.check_items(key, 1, items, range),
            other => Err(self.note_at(&item.place, key, format!("found {}, must be a list of numbers", other.found()))),
        }
    }
}
