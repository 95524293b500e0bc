//! Tables of numbers, and what scenes are compared with them.

use frazil_core::boundary::condition::Condition;
use frazil_core::physics::material::Material;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;

use crate::BadTable;

/// Relative agreement of a scene's numbers with those of a table for the table to be about that scene.
const SAME: f64 = 1e-3;

/// Columns of numbers under a line of names; lines that start with `#` are comments.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberTable {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl NumberTable {
    /// Reads comma-separated text.
    ///
    /// # Errors
    ///
    /// If a cell is no number, or there are no rows.
    pub fn read(text: &str) -> Result<Self, BadTable> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
        let headers = reader.headers()?;
        let names: Vec<String> = headers.iter().map(str::to_owned).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for row in reader.records() {
            for ((column, name), field) in columns.iter_mut().zip(&names).zip(&row?) {
                let wrong = || BadTable::CellOfColumn { column: name.clone(), cell: field.into() };
                column.push(field.parse().map_err(|_| wrong())?);
            }
        }
        if columns.first().is_none_or(Vec::is_empty) {
            return Err(BadTable::NoRows);
        }
        Ok(NumberTable { names, columns })
    }

    /// The numbers of a column.
    ///
    /// # Errors
    ///
    /// If there is no such column.
    pub fn column(&self, name: &str) -> Result<&[f64], BadTable> {
        let index = self.names.iter().position(|own| own == name);
        index.map(|index| self.columns[index].as_slice()).ok_or_else(|| BadTable::NoColumn(name.into()))
    }

    /// Names of the columns, in order.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

/// Piecewise linear interpolation; `None` outside the range of `x`, which must increase.
pub(crate) fn interpolate(x: &[f64], y: &[f64], at: f64) -> Option<f64> {
    let after = x.partition_point(|&node| node <= at);
    if after == 0 {
        return None;
    }
    if after == x.len() {
        return (x[after - 1] == at).then(|| y[after - 1]);
    }
    let share = (at - x[after - 1]) / (x[after] - x[after - 1]);
    Some(y[after - 1] + share * (y[after] - y[after - 1]))
}

/// Interpolation of the square, which is nearly linear for a frozen length that grows with the root of time.
pub(crate) fn interpolate_square(x: &[f64], y: &[f64], at: f64) -> Option<f64> {
    let squares: Vec<f64> = y.iter().map(|value| value * value).collect();
    interpolate(x, &squares, at).map(f64::sqrt)
}

/// Notes a number of the scene that is not the table's.
pub(crate) fn compare(differences: &mut Vec<String>, what: &str, own: Option<f64>, expected: f64) {
    let is_same = own.is_some_and(|own| (own - expected).abs() <= SAME * expected.abs().max(1e-9));
    if !is_same {
        let own = own.map_or("something else".into(), |own| own.to_string());
        differences.push(format!("{what} is {expected} there and {own} here"));
    }
}

/// Notes what is not as in the table, in words.
pub(crate) fn note(differences: &mut Vec<String>, found: &[(bool, &str)]) {
    differences.extend(found.iter().filter(|(differs, _)| *differs).map(|(_, words)| (*words).to_owned()));
}

/// Notes numbers of a material by which it conducts and stores heat that are not the table's.
pub(crate) fn compare_material(
    differences: &mut Vec<String>,
    own: Option<&Material>,
    density: f64,
    [frozen, unfrozen]: [(f64, f64); 2],
) {
    let mut number = |what: &str, read: fn(&Material) -> f64, expected: f64| {
        compare(differences, what, own.map(read), expected);
    };
    number("the density", |own| own.density, density);
    number("the frozen conductivity", |own| own.frozen.conductivity, frozen.0);
    number("the frozen heat capacity", |own| own.frozen.heat_capacity, frozen.1);
    number("the unfrozen conductivity", |own| own.unfrozen.conductivity, unfrozen.0);
    number("the unfrozen heat capacity", |own| own.unfrozen.heat_capacity, unfrozen.1);
}

/// The constant temperature of a wall.
pub(crate) fn wall_temperature(scene: &Scene, wall: WallId) -> Option<f64> {
    match scene.wall(wall) {
        Some(Condition::Temperature(series)) => series.constant(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_table_says_what_is_wrong() {
        assert!(NumberTable::read("# a\nx,y\n1,two\n").is_err_and(|error| error.to_string().contains("'two'")));
        assert!(NumberTable::read("x,y\n").is_err());
        let table = NumberTable::read("# a\nx,y\n1,2\n").expect("table");
        assert!(table.column("z").is_err_and(|error| error.to_string().contains('z')));
    }
}
