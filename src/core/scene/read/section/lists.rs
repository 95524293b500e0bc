//! Values of a section that are more than one number: lists, points, times and tables in time.

use super::super::range::{Range, plain, unfit};
use super::super::tree::{Entry, Item, Node};
use super::{Asked, Key, Section};
use crate::scene::{Schedule, Series, TimeUnit, Units};

/// A time as it was given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Duration {
    /// In seconds.
    pub seconds: f64,
    /// The unit of its key.
    pub unit: TimeUnit,
}

/// What is wrong with a list of times that ends beyond its period.
fn beyond_period(end: f64, period: &Duration) -> Option<String> {
    let unit = period.unit;
    // Times in hours and a period in days may round differently.
    let within = end <= period.seconds * (1.0 + 1e-12);
    let (end, most) = (plain(end / unit.seconds()), plain(period.seconds / unit.seconds()));
    let message =
        format!("found an end at {end} {}, must end within the period, {most} {}", unit.symbol(), unit.symbol());
    (!within).then_some(message)
}

impl<'a> Section<'a> {
    /// A list of numbers that may be absent.
    pub fn optional_numbers(&mut self, key: impl Into<Key>, range: Range) -> Option<Vec<f64>> {
        let entry = self.ask(key.into())?;
        self.check_numbers(&entry.key, &entry.node, range)
    }

    /// A list of points with this many coordinates, or any number from one; it may be absent.
    pub fn optional_points(&mut self, key: impl Into<Key>, dimension: Option<usize>) -> Option<Vec<Vec<f64>>> {
        let entry = self.ask(key.into())?;
        let Node::List(items) = &entry.node else {
            self.wrong(&entry.key, &entry.node, "a list of points");
            return None;
        };
        let mut points = Vec::with_capacity(items.len());
        for (number, item) in (1..).zip(items) {
            let path = format!("{}.{number}", entry.key);
            let point = self.check_numbers_of(&path, item, Range::ANY)?;
            if point.is_empty() || dimension.is_some_and(|dimension| point.len() != dimension) {
                let allowed = dimension.map_or_else(|| "1 or 2".into(), |dimension| dimension.to_string());
                self.note_at(&item.place, &path, format!("found {} coordinates, must be {allowed}", point.len()));
                return None;
            }
            points.push(point);
        }
        Some(points)
    }

    /// A required point of the plane.
    pub fn point(&mut self, key: impl Into<Key>) -> Option<(f64, f64)> {
        let key = key.into();
        self.required(key, "a point, as [0.1, 0.2]", |section| {
            let entry = section.ask(key)?;
            let numbers = section.check_numbers(&entry.key, &entry.node, Range::ANY)?;
            if let [x, y] = numbers.as_slice() {
                return Some((*x, *y));
            }
            section.note(&entry.key, format!("found {} coordinates, must be 2", numbers.len()));
            None
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

    /// A required list of points.
    pub fn points(&mut self, key: impl Into<Key>, dimension: Option<usize>) -> Option<Vec<Vec<f64>>> {
        let key = key.into();
        self.required(key, "a list of points", |section| section.optional_points(key, dimension))
    }

    /// A required quantity that is constant or a table in time: `5` or `{ times_h = [0, 10], values = [5, -20] }`, which a
    /// `period_h` repeats.
    pub fn series(&mut self, key: impl Into<Key>, range: Range) -> Option<Series> {
        let key = key.into();
        self.required(key, "a number or a table in time", |section| section.optional_series(key, range))
    }

    /// A quantity that is constant or a table in time; it may be absent.
    pub fn optional_series(&mut self, key: impl Into<Key>, range: Range) -> Option<Series> {
        let entry = self.ask(key.into())?;
        let Node::Table(rows) = &entry.node else {
            return self.check_number(&entry.key, &entry.node, range).map(Series::Constant);
        };
        let mut table = self.child(&entry.key, entry.place.clone(), rows);
        let times = table.times("times");
        let values =
            table.required("values".into(), "a list of numbers", |table| table.optional_numbers("values", range));
        let period = table.optional_duration("period", Range::POSITIVE);
        let (times, values) = (times?, values?);
        if times.len() != values.len() {
            let message = format!("found {} values for {} times, must be as many", values.len(), times.len());
            table.problem("values", message);
            return None;
        }
        if times.is_empty() {
            table.problem("values", "found an empty list, must have at least one row");
            return None;
        }
        let rows: Vec<(f64, f64)> = times.into_iter().map(|time| time.seconds).zip(values).collect();
        let Some(period) = period else { return Some(Series::Table(rows)) };
        if let Some(message) = beyond_period(rows.last().map_or(0.0, |row| row.0), &period) {
            table.time_problem("times", message);
            return None;
        }
        Some(Series::Repeated { rows, period: period.seconds })
    }

    /// When something works, as intervals of time that may repeat: `on_h = [[0, 8], [12, 20]]`, `on_period_h = 24`. An
    /// interval of one instant begins there and never ends. Absent, it always works.
    pub fn optional_schedule(&mut self) -> Option<Schedule> {
        let found = self.ask_time("on");
        if found.is_none() {
            self.refuse_time("on_period", "only intervals of work repeat");
        }
        let (entry, unit) = found?;
        let period = self.optional_duration("on_period", Range::POSITIVE);
        let Node::List(items) = &entry.node else {
            self.wrong(&entry.key, &entry.node, "a list of intervals, as [[0, 8], [12, 20]]");
            return None;
        };
        if items.is_empty() {
            self.note(&entry.key, "found an empty list, must have at least one interval");
            return None;
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
                    "found {} instants, must be 2: when work begins and when it ends (or 1 in the last interval, for \
                     work without end that does not repeat)",
                    ends.len()
                )),
            };
            if let Some(message) = message {
                self.note_at(&item.place, &path, message);
                return None;
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
                self.note_at(&item.place, &path, message);
                return None;
            }
            on.push((from, to));
        }
        if let (Some(period), Some((_, end))) = (&period, on.last())
            && let Some(message) = beyond_period(*end, period)
        {
            self.note(&entry.key, message);
            return None;
        }
        Some(Schedule { on, period: period.map(|period| period.seconds) })
    }

    /// A required time, given in seconds, hours or days (`duration_s`, `duration_h`, `duration_days`).
    pub fn duration(&mut self, base: &'static str, range: Range) -> Option<Duration> {
        let found = self.ask_time(base);
        if found.is_none() {
            self.missing_time(base);
        }
        let (entry, unit) = found?;
        self.check_duration(entry, unit, range)
    }

    /// A time that may be absent.
    pub fn optional_duration(&mut self, base: &'static str, range: Range) -> Option<Duration> {
        let (entry, unit) = self.ask_time(base)?;
        self.check_duration(entry, unit, range)
    }

    /// A required list of times, none negative, strictly increasing.
    pub fn times(&mut self, base: &'static str) -> Option<Vec<Duration>> {
        let found = self.ask_time(base);
        if found.is_none() {
            self.missing_time(base);
        }
        let (entry, unit) = found?;
        self.check_times(entry, unit)
    }

    /// A list of times that may be absent.
    pub fn optional_times(&mut self, base: &'static str) -> Option<Vec<Duration>> {
        let (entry, unit) = self.ask_time(base)?;
        self.check_times(entry, unit)
    }

    /// The key of a time as it is written in this section, for messages.
    pub fn time_key(&self, base: &'static str) -> String {
        let keys = self.time_keys(base);
        let written = keys.iter().find(|(key, _)| self.find(key).is_some());
        written.or(keys.first()).map_or_else(|| base.to_owned(), |(key, _)| key.clone())
    }

    /// Records a problem of a time.
    pub fn time_problem(&mut self, base: &'static str, message: impl Into<String>) {
        let key = self.time_key(base);
        self.note(&key, message);
    }

    fn time_keys(&self, base: &'static str) -> Vec<(String, TimeUnit)> {
        if self.units == Units::Si {
            [("s", TimeUnit::Second), ("h", TimeUnit::Hour), ("days", TimeUnit::Day)]
                .map(|(suffix, unit)| (format!("{base}_{suffix}"), unit))
                .to_vec()
        } else {
            vec![(base.to_owned(), TimeUnit::Second)]
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

    fn missing_time(&mut self, base: &'static str) {
        let keys = self.time_keys(base).into_iter().map(|(key, _)| key).collect();
        self.miss(base, keys);
    }

    fn check_duration(&mut self, entry: &Entry, unit: TimeUnit, range: Range) -> Option<Duration> {
        let value = self.check_number(&entry.key, &entry.node, range)?;
        self.seconds(&entry.key, value, unit)
    }

    fn seconds(&mut self, key: &str, value: f64, unit: TimeUnit) -> Option<Duration> {
        let seconds = value * unit.seconds();
        if seconds.is_finite() {
            return Some(Duration { seconds, unit });
        }
        self.note(key, format!("found {}, must be a finite number of seconds", plain(value)));
        None
    }

    fn check_times(&mut self, entry: &Entry, unit: TimeUnit) -> Option<Vec<Duration>> {
        let times = self.check_numbers(&entry.key, &entry.node, Range::NOT_NEGATIVE)?;
        if let Some(pair) = times.windows(2).find(|pair| pair[0] >= pair[1]) {
            let message = format!("found {} after {}, must increase strictly", plain(pair[1]), plain(pair[0]));
            self.note(&entry.key, message);
            return None;
        }
        times.into_iter().map(|time| self.seconds(&entry.key, time, unit)).collect()
    }

    fn check_numbers(&mut self, key: &str, node: &Node, range: Range) -> Option<Vec<f64>> {
        let Node::List(items) = node else {
            self.wrong(key, node, "a list of numbers");
            return None;
        };
        self.check_items(key, 1, items, range)
    }

    /// Elements of a list that are numbers, counted from `first`.
    pub(super) fn check_items(&mut self, key: &str, first: usize, items: &[Item], range: Range) -> Option<Vec<f64>> {
        let mut numbers = Vec::with_capacity(items.len());
        for (number, item) in (first..).zip(items) {
            match &item.node {
                Node::Number(_, value, _) if range.contains(*value) && unfit(*value).is_none() => numbers.push(*value),
                other => {
                    let allowed = match other {
                        Node::Number(_, value, _) => unfit(*value).map_or_else(|| range.to_string(), str::to_owned),
                        _ => "a number".into(),
                    };
                    let message = format!("found {}, must be {allowed}", other.found());
                    self.note_at(&item.place, &format!("{key}.{number}"), message);
                }
            }
        }
        (numbers.len() == items.len()).then_some(numbers)
    }

    fn check_numbers_of(&mut self, key: &str, item: &Item, range: Range) -> Option<Vec<f64>> {
        if matches!(item.node, Node::List(_)) {
            return self.check_numbers(key, &item.node, range);
        }
        self.note_at(&item.place, key, format!("found {}, must be a list of numbers", item.node.found()));
        None
    }
}
