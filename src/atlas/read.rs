//! Numbers that runs have left in their files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;

/// A number, or where it is.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Number {
    /// The number.
    Stated(f64),
    /// In a record.
    Record(InRecord),
    /// In a table.
    Table(InTable),
}

/// A number of a record.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InRecord {
    /// Its place, as a JSON pointer.
    record: String,
    /// A factor, where it is shown in another unit.
    #[serde(default = "one")]
    times: f64,
}

/// A number of a table.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InTable {
    /// The file.
    table: String,
    /// The column.
    column: String,
    /// Texts of other columns, in the rows that count.
    #[serde(default, rename = "where")]
    only: BTreeMap<String, String>,
    /// A column and a number of it, between whose rows it is linear.
    #[serde(default)]
    at: Option<(String, f64)>,
    /// A column whose greatest value names the row.
    #[serde(default)]
    peak_of: Option<String>,
    /// Which of the rows; the last one unless said.
    #[serde(default)]
    take: Take,
    /// Where it is counted from, as the time at which walls are cooled.
    #[serde(default)]
    after: f64,
    /// A factor, where it is shown in another unit.
    #[serde(default = "one")]
    times: f64,
}

#[derive(Debug, Default, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Take {
    First,
    #[default]
    Last,
    Most,
    Least,
}

fn one() -> f64 {
    1.0
}

/// A number that is not to be had.
#[derive(Debug, thiserror::Error)]
pub(super) enum NotRead {
    #[error("{0} is not there: its run did not come to its end")]
    File(String),
    #[error("{0} has no {1}")]
    Value(String, String),
}

impl Number {
    /// Reads it in the folder of a run.
    pub(super) fn read(&self, folder: &Path) -> Result<f64, NotRead> {
        match self {
            Number::Stated(value) => Ok(*value),
            Number::Record(place) => place.read(folder),
            Number::Table(place) => place.read(folder),
        }
    }
}

impl InRecord {
    fn read(&self, folder: &Path) -> Result<f64, NotRead> {
        let file = "record.json";
        let text = fs::read_to_string(folder.join(file)).map_err(|_| NotRead::File(file.into()))?;
        let record: serde_json::Value = serde_json::from_str(&text).map_err(|_| NotRead::File(file.into()))?;
        let value = record.pointer(&self.record).and_then(serde_json::Value::as_f64);
        Ok(self.times * value.ok_or_else(|| NotRead::Value(file.into(), self.record.clone()))?)
    }
}

impl InTable {
    fn read(&self, folder: &Path) -> Result<f64, NotRead> {
        let lacks = |what: &str| NotRead::Value(self.table.clone(), what.to_owned());
        let mut reader =
            csv::Reader::from_path(folder.join(&self.table)).map_err(|_| NotRead::File(self.table.clone()))?;
        let heads = reader.headers().map_err(|_| NotRead::File(self.table.clone()))?.clone();
        let place = |name: &str| heads.iter().position(|head| head == name).ok_or_else(|| lacks(name));
        let along = self.at.as_ref().map(|at| &at.0).or(self.peak_of.as_ref());
        let (column, along) = (place(&self.column)?, along.map(|name| place(name)).transpose()?);
        let only: Vec<(usize, &String)> =
            self.only.iter().map(|(name, text)| Ok((place(name)?, text))).collect::<Result<_, _>>()?;
        // The number by which rows stand, and their value.
        let mut rows: Vec<(f64, f64)> = Vec::new();
        for row in reader.records().flatten() {
            let number = |k: usize| row.get(k).and_then(|cell| cell.parse::<f64>().ok());
            let counts = only.iter().all(|(k, text)| row.get(*k) == Some(text.as_str()));
            let by = along.map_or(Some(rows.len() as f64), number);
            if let Some(row) = by.zip(number(column)).filter(|_| counts) {
                rows.push(row);
            }
        }
        let value = match &self.at {
            Some((_, at)) => between(rows, *at),
            None if self.peak_of.is_some() => rows.iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|row| row.1),
            None => self.take.of(&rows),
        };
        Ok(self.times * (value.ok_or_else(|| lacks("row for it"))? - self.after))
    }
}

impl Take {
    fn of(self, rows: &[(f64, f64)]) -> Option<f64> {
        let values = rows.iter().map(|row| row.1);
        match self {
            Take::First => rows.first().map(|row| row.1),
            Take::Last => rows.last().map(|row| row.1),
            Take::Most => values.max_by(f64::total_cmp),
            Take::Least => values.min_by(f64::total_cmp),
        }
    }
}

/// Linear between the rows on both sides of a number; none beyond them.
fn between(mut rows: Vec<(f64, f64)>, at: f64) -> Option<f64> {
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    frazil_plots::layouts::between(&rows, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<f64, String> {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("record.json"), r#"{"errors": {"front": 0.25}}"#).expect("written");
        let table = "time_s,plane,x_m\n10,a,1\n20,a,3\n20,b,7\n30,a,\n";
        fs::write(folder.path().join("t.csv"), table).expect("written");
        let number: BTreeMap<String, Number> = toml::from_str(&format!("x = {text}")).expect("a number");
        number["x"].read(folder.path()).map_err(|cause| cause.to_string())
    }

    #[test]
    fn numbers_are_read_off_records_and_tables() {
        assert_eq!(read("3.5"), Ok(3.5));
        assert_eq!(read("{ record = \"/errors/front\", times = 100 }"), Ok(25.0));
        assert_eq!(read("{ table = \"t.csv\", column = \"x_m\" }"), Ok(7.0));
        assert_eq!(
            read("{ table = \"t.csv\", column = \"x_m\", where = { plane = \"a\" }, at = [\"time_s\", 15] }"),
            Ok(2.0)
        );
        assert_eq!(read("{ table = \"t.csv\", column = \"x_m\", take = \"least\" }"), Ok(1.0));
        assert_eq!(
            read("{ table = \"t.csv\", column = \"time_s\", peak_of = \"x_m\", after = 5, times = 2 }"),
            Ok(30.0)
        );
        assert_eq!(read("{ table = \"t.csv\", column = \"y_m\" }"), Err("t.csv has no y_m".into()));
        assert_eq!(read("{ record = \"/errors/back\" }"), Err("record.json has no /errors/back".into()));
        assert_eq!(
            read("{ table = \"u.csv\", column = \"y_m\" }"),
            Err("u.csv is not there: its run did not come to its end".into())
        );
    }
}
