//! Values that are a number, a formula, or a table over time or along an axis, in the scene itself or in a file beside it.

use super::super::formulas::{Checked, Of, Run};
use super::super::problem::Read;
use super::super::range::{Range, plain};
use super::super::schema::Shape;
use super::super::tree::{Entry, Node};
use super::lists::beyond_period;
use super::{Key, Section};
use frazil_core::balances::heated::Power;
use frazil_core::formula::{Formula, TIME};
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;

/// Coordinates along which a value may vary.
const AXES: [(&str, &str); 2] = [("x", "m"), ("y", "m")];

/// Key of a file whose rows are a table.
const FILE: &str = "file";

/// Key of a formula in place of a table.
const FORMULA: &str = "formula";

/// A value of all of a body, or one that varies along an axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Along {
    /// The same everywhere.
    Even(f64),
    /// Coordinates (m, strictly increasing) along an axis and values.
    Axis {
        /// Whether along y; else along x.
        along_y: bool,
        /// Coordinates and values, two of them at least.
        rows: Vec<(f64, f64)>,
    },
    /// By a formula of the place.
    Formula {
        /// The formula.
        formula: Formula,
        /// Least and greatest value over the body.
        range: (f64, f64),
    },
}

impl<'a> Section<'a> {
    pub(in super::super) fn set_run(&mut self, run: Run) {
        self.run = run;
    }

    /// A required quantity that is constant, a table in time: `5`, `{ times_h = [0, 10], values = [5, -20] }`, which a
    /// `period_h` repeats, or `{ file = "brine.csv" }`, whose columns are a time and the key itself; or a formula of the time:
    /// `{ formula = "5 - t/3600" }`.
    pub fn series(&mut self, key: impl Into<Key>, range: Range) -> Read<Series> {
        let key = self.expect(key, || Shape::Series(range, true));
        self.required(key, "a number, a table in time or a formula", |section, entry| {
            match section.with_formula(entry) {
                Some(mut table) => {
                    let formula = table.formula(Of::Time, range)?;
                    table.over_time(formula)
                }
                None => section.check_series(entry, key, range),
            }
        })
    }

    /// A required quantity that is constant or a table in time, where no formula can be.
    pub fn tabulated(&mut self, key: impl Into<Key>, range: Range) -> Read<Series> {
        let key = self.expect(key, || Shape::Series(range, false));
        self.required(key, "a number or a table in time", |section, entry| match section.with_formula(entry) {
            Some(mut table) => {
                table.abandon();
                Err(table.problem(FORMULA, "found a formula, must be a table in time here, with times and values"))
            }
            None => section.check_series(entry, key, range),
        })
    }

    /// Heat that a part of the body releases, where it is given: a number, a table in time, or a formula of place and time.
    pub fn optional_power(&mut self, key: impl Into<Key>, range: Range) -> Option<Power> {
        let key = self.expect(key, || Shape::Series(range, true));
        self.optional(key, |section, entry| {
            let Some(mut table) = section.with_formula(entry) else {
                return section.check_series(entry, key, range).map(Power::Even);
            };
            let checked = table.formula(Of::PlaceAndTime, range)?;
            let by_time_alone = (0..TIME).all(|axis| !checked.0.uses(axis));
            if by_time_alone { table.over_time(checked).map(Power::Even) } else { Ok(Power::Formula(checked.0)) }
        })
    }

    /// A required formula of place and time: `{ formula = "5*x - t/3600" }`.
    pub fn formula_of_all(&mut self, key: impl Into<Key>, range: Range) -> Read<Formula> {
        let key = self.expect(key, || Shape::Formula);
        self.required(key, "a table with a formula", |section, entry| {
            section.check_section(entry)?.formula(Of::PlaceAndTime, range).map(|(formula, _)| formula)
        })
    }

    /// A required number, or a table along an axis of a body, in the same two ways, or a formula of the place.
    pub fn number_along(&mut self, key: impl Into<Key>, range: Range, domain: Option<&Domain>) -> Read<Along> {
        let key = self.expect(key, || Shape::AlongAxis(range));
        self.required(key, "a number, a table along x or y or a formula", |section, entry| {
            let Some(mut table) = section.with_formula(entry) else {
                return section.check_along(entry, key, range, domain);
            };
            let (formula, extremes) = table.formula(Of::Place, range)?;
            let range = extremes.map(|extremes| (extremes.least.value, extremes.greatest.value));
            Ok(Along::Formula { range: range.unwrap_or_default(), formula })
        })
    }

    /// The formula of this table.
    fn formula(&mut self, of: Of, range: Range) -> Read<Checked> {
        let text = self.text(FORMULA)?;
        self.run.read(&text, of, range).map_err(|message| self.problem(FORMULA, message))
    }

    /// The formula of this table as a series.
    fn over_time(&mut self, formula: Checked) -> Read<Series> {
        self.run.over_time(formula).map_err(|message| self.problem(FORMULA, message))
    }

    /// The table that a key has, where it has a formula.
    fn with_formula(&mut self, entry: &'a Entry) -> Option<Section<'a>> {
        let Node::Table(entries) = &entry.node else { return None };
        let is_there = entries.iter().any(|entry| entry.key == FORMULA);
        is_there.then(|| self.child(&entry.key, entry.place.clone(), entries))
    }

    fn check_series(&mut self, entry: &'a Entry, key: Key, range: Range) -> Read<Series> {
        let Node::Table(rows) = &entry.node else {
            return self.check_number(entry, range).map(Series::Constant);
        };
        let mut table = self.child(&entry.key, entry.place.clone(), rows);
        let rows = if table.has(FILE) {
            table.refuse_time("times", "times are those of the file");
            table.values_of_file(
                |row| Some((row.duration("time", Range::NOT_NEGATIVE).ok()?.seconds, row.time_key("time"))),
                key,
                range,
            )
        } else {
            table.series_rows(range)
        };
        let period = table.optional_duration("period", Range::POSITIVE);
        let rows = rows?;
        let Some(period) = period else { return Ok(Series::Table(rows)) };
        if let Some(message) = beyond_period(rows.last().map_or(0.0, |row| row.0), &period) {
            return Err(if table.has(FILE) {
                table.problem(FILE, message)
            } else {
                table.time_problem("times", message)
            });
        }
        Ok(Series::Repeated { rows, period: period.seconds })
    }

    /// Times and values of a table in the scene itself.
    fn series_rows(&mut self, range: Range) -> Read<Vec<(f64, f64)>> {
        // Known to those who misspell them.
        self.optional_text(FILE);
        self.optional_text(FORMULA);
        let times = self.times("times");
        let values = self.numbers("values", range);
        let (times, values) = (times?, values?);
        if times.len() != values.len() {
            let message = format!("found {} values for {} times, must be as many", values.len(), times.len());
            return Err(self.problem("values", message));
        }
        if times.is_empty() {
            return Err(self.problem("values", "found an empty list, must have at least one row"));
        }
        Ok(times.into_iter().map(|time| time.seconds).zip(values).collect())
    }

    /// Rows of a file beside the scene: what `first` reads of each, which must increase, and the value of a key. `first` also says the
    /// name of its column.
    fn values_of_file(
        &mut self,
        mut first: impl FnMut(&mut Section<'_>) -> Option<(f64, String)>,
        key: Key,
        range: Range,
    ) -> Read<Vec<(f64, f64)>> {
        self.refuse("values", "values are those of the file");
        let (name, text) = self.file(FILE)?;
        let mut last = f64::NEG_INFINITY;
        self.rows(&text, &name, |row| {
            let (place, value) = (first(row), row.number(key, range));
            let (place, column) = place?;
            if place <= last {
                let found = row.find(&column).map_or_else(String::new, |cell| cell.node.found());
                row.note(&column, format!("found {found}, must be greater than in the row before"));
            }
            last = place;
            Some((place, value.ok()?))
        })
    }

    fn check_along(&mut self, entry: &'a Entry, key: Key, range: Range, domain: Option<&Domain>) -> Read<Along> {
        let Node::Table(rows) = &entry.node else {
            return self.check_number(entry, range).map(Along::Even);
        };
        let mut table = self.child(&entry.key, entry.place.clone(), rows);
        let flat = domain.is_some_and(|domain| domain.dimension() == 1);
        let (axis, rows) = if table.has(FILE) {
            AXES.iter().for_each(|axis| table.refuse(*axis, "places are those of the file"));
            let mut axis = 0;
            let rows = table.values_of_file(
                |row| {
                    axis = row.only_one(&AXES.map(Key::from)).ok()?;
                    if axis == 1 && flat {
                        row.problem(AXES[1], NO_Y);
                    }
                    let column = Key::from(AXES[axis]).written(row.units());
                    Some((row.number(AXES[axis], Range::ANY).ok()?, column))
                },
                key,
                range,
            );
            (axis, rows?)
        } else {
            table.along_rows(flat, range)?
        };
        if rows.len() < 2 {
            return Err(table.section_problem("found fewer than two places, must be two at least"));
        }
        Ok(Along::Axis { along_y: axis == 1, rows })
    }

    /// Axis, places and values of a table in the scene itself.
    fn along_rows(&mut self, flat: bool, range: Range) -> Read<(usize, Vec<(f64, f64)>)> {
        // Known to those who misspell them.
        self.optional_text(FILE);
        self.optional_text(FORMULA);
        let axis = self.only_one(&AXES.map(Key::from));
        let places = axis.and_then(|axis| self.numbers(AXES[axis], Range::ANY));
        let values = self.numbers("values", range);
        let (axis, places, values) = (axis?, places?, values?);
        if axis == 1 && flat {
            return Err(self.problem(AXES[1], NO_Y));
        }
        if let Some(pair) = places.windows(2).find(|pair| pair[0] >= pair[1]) {
            let message = format!("found {} after {}, must increase strictly", plain(pair[1]), plain(pair[0]));
            return Err(self.problem(AXES[axis], message));
        }
        if places.len() != values.len() {
            let message = format!("found {} values for {} places, must be as many", values.len(), places.len());
            return Err(self.problem("values", message));
        }
        Ok((axis, places.into_iter().zip(values).collect()))
    }
}

/// What is wrong with y in a body of one dimension.
const NO_Y: &str = "found in a body without y, must be along x";
