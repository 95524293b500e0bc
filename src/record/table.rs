//! Tables over time that say themselves what is in them: files and figures are made of them without knowing them.

use serde::{Deserialize, Serialize};

/// A table over time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Its file; its figure has the same name but for the ending.
    pub file: String,
    /// What it is about, in words.
    pub title: String,
    /// Its columns, of which the first is the time.
    pub columns: Vec<Column>,
    /// Numbers by row, as many as there are columns; absent where there is no value.
    pub rows: Vec<Vec<Option<f64>>>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Its name, which ends in its unit.
    pub name: String,
    /// What is in it, in a few words: the label of its axis.
    pub doc: String,
    /// Its unit in scenes with units.
    pub unit: Unit,
    /// What its numbers are.
    pub role: Role,
}

/// Units of columns, where the scene has units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// s.
    Second,
    /// m.
    Metre,
    /// m2.
    SquareMetre,
    /// m3.
    CubicMetre,
    /// J/m.
    JoulePerMetre,
    /// J/m3.
    JoulePerCubicMetre,
    /// W/m.
    WattPerMetre,
    /// Degrees on the scale of the scene.
    Celsius,
    /// None.
    One,
}

/// What the numbers of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// They tell rows of one instant apart, and name a curve each.
    Key,
    /// A value that is as great in a part of a body that mirrors make whole as in all of it.
    Value,
    /// A sum over the body, to which its parts add up.
    Sum,
}

/// A column by its name, words, unit and role.
pub type Head = (&'static str, &'static str, Unit, Role);

impl Table {
    /// A table without rows, of the time (s) and other columns, with room for so many rows.
    pub fn over_time(file: &str, title: &str, columns: &[Head], rows: usize) -> Self {
        let time: Head = ("time_s", "time", Unit::Second, Role::Key);
        let column = |(name, doc, unit, role): &Head| Column {
            name: (*name).into(),
            doc: (*doc).into(),
            unit: *unit,
            role: *role,
        };
        let columns = [time].iter().chain(columns).map(column).collect();
        Table { file: file.into(), title: title.into(), columns, rows: Vec::with_capacity(rows) }
    }

    /// Multiplies what are sums over the body.
    pub fn scale_sums(&mut self, factor: f64) {
        for (k, _) in self.columns.iter().enumerate().filter(|(_, column)| column.role == Role::Sum) {
            self.rows.iter_mut().filter_map(|row| row[k].as_mut()).for_each(|sum| *sum *= factor);
        }
    }

    /// Bytes that it holds on the heap once all rows for which there is room are there.
    pub fn held_when_full(&self) -> usize {
        let row = size_of::<Vec<Option<f64>>>() + self.columns.len() * size_of::<Option<f64>>();
        self.rows.capacity() * row
    }
}
