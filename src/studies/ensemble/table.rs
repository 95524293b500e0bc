//! Tables of series, and their means over the members of an ensemble.
//!
//! What a column is follows from its name and its cells: instants, places and words say which row it is; `_ref` is of the
//! reference; all other numbers have a mean, an interval and a standard deviation.

use std::collections::HashMap;
use std::io::Read;

use csv::StringRecord;
use frazil_core::statistics::{HalfWidths, moments};
use serde::de::DeserializeOwned;

use crate::output::cells;

/// Numbers that tell rows apart.
const KEYS: [&str; 9] = ["time_s", "y_m", "z_m", "r_m", "isotherm_c", "gap", "angle_deg", "multiplicity", "mean_over"];

/// The place along a profile. Of moving particles it is a mean over a layer of them, and differs between members.
pub const ALONG: &str = "along_m";

/// The place in series that have no profiles.
pub const PLACE: &str = "x_m";

/// Endings of the columns of a mean.
pub const INTERVAL: &str = "_interval";
/// Endings of the columns of a mean.
pub const DEVIATION: &str = "_sd";

/// How many members have a row.
const MEMBERS: &str = "members";

/// A series as text.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    columns: StringRecord,
    rows: Vec<StringRecord>,
}

/// What a column is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Tells rows apart.
    Key,
    /// The place along a profile.
    Place,
    /// Where that place is.
    Point,
    /// Known without any run.
    Reference,
    /// What runs give.
    Value,
}

impl Table {
    /// Reads CSV with a head.
    pub fn read(text: impl Read) -> Result<Table, csv::Error> {
        let mut reader = csv::Reader::from_reader(text);
        Ok(Table { columns: reader.headers()?.clone(), rows: reader.into_records().collect::<Result<_, _>>()? })
    }

    /// As CSV.
    pub fn write(&self, text: &mut dyn std::io::Write) -> std::io::Result<()> {
        let mut writer = cells::writer(text);
        writer.write_record(&self.columns).map_err(std::io::Error::other)?;
        for row in &self.rows {
            writer.write_record(row).map_err(std::io::Error::other)?;
        }
        writer.flush()
    }

    /// Rows by the names of their columns; columns that nobody asks for are passed over.
    pub fn typed<R: DeserializeOwned>(&self) -> Result<Vec<R>, csv::Error> {
        self.rows.iter().map(|row| row.deserialize(Some(&self.columns))).collect()
    }

    /// Names of the columns.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.columns.iter()
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Number of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// A cell as text.
    pub fn text(&self, row: usize, column: usize) -> &str {
        &self.rows[row][column]
    }

    /// A cell as a number; absent where there is none.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        self.text(row, column).parse().ok()
    }

    /// Puts numbers into a column, row by row.
    pub fn put(&mut self, column: usize, numbers: impl Iterator<Item = Option<f64>>) {
        for (row, number) in self.rows.iter_mut().zip(numbers) {
            *row = row
                .iter()
                .enumerate()
                .map(|(k, cell)| if k == column { cell_of(number) } else { cell.into() })
                .collect();
        }
    }

    /// What a column is.
    pub fn role(&self, column: usize) -> Role {
        let name = &self.columns[column];
        let is_text = |row: &StringRecord| !row[column].is_empty() && row[column].parse::<f64>().is_err();
        let has_along = self.column(ALONG).is_some();
        if name == if has_along { ALONG } else { PLACE } {
            Role::Place
        } else if has_along && matches!(name, "x_m" | "y_m") {
            Role::Point
        } else if KEYS.contains(&name) || self.rows.iter().any(is_text) {
            Role::Key
        } else if reference_of(name).is_some() {
            Role::Reference
        } else {
            Role::Value
        }
    }
}

/// The column that a column of the reference is of.
pub fn reference_of(name: &str) -> Option<String> {
    let (before, after) = name.split_once("_ref")?;
    (after.is_empty() || after.starts_with('_')).then(|| format!("{before}{after}"))
}

/// A number as series have it: the fewest digits that give it back.
fn cell_of(number: Option<f64>) -> String {
    number.map_or(String::new(), |number| format!("{number:?}"))
}

/// Why tables have no mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoMean {
    /// There are none.
    #[error("there are no members")]
    Empty,
    /// They are not of one kind.
    #[error("its columns differ between members")]
    Columns,
}

/// Mean over the members that have a row, row by row, in the order of the rows. A number that one of these members lacks
/// has no mean: one over the others would not be that of the ensemble.
///
/// `layer` is the thickness of the layers that places are means over, if they are.
///
/// # Errors
/// Where there are no members, or their columns differ.
pub fn mean(members: &[&Table], layer: Option<f64>) -> Result<Table, NoMean> {
    let first = members.first().ok_or(NoMean::Empty)?;
    if members.iter().any(|member| member.columns != first.columns) {
        return Err(NoMean::Columns);
    }
    // A column is text if any member's is.
    let role = |column: usize| {
        let roles = members.iter().map(|member| member.role(column));
        roles.fold(first.role(column), |role, other| if other == Role::Key { other } else { role })
    };
    let roles: Vec<Role> = (0..first.columns.len()).map(role).collect();
    let mut columns = StringRecord::new();
    for (name, role) in first.columns.iter().zip(&roles) {
        columns.push_field(name);
        if *role == Role::Value {
            columns.push_field(&format!("{name}{INTERVAL}"));
            columns.push_field(&format!("{name}{DEVIATION}"));
        }
    }
    columns.push_field(MEMBERS);
    let widths = HalfWidths::up_to(members.len());
    let rows = aligned(members, &roles, layer)
        .into_iter()
        .map(|same| {
            let mut row = StringRecord::new();
            for (column, role) in roles.iter().enumerate() {
                let cells = || same.iter().map(|(member, row)| &members[*member].rows[*row][column]);
                let text = cells().next().unwrap_or_default();
                if *role == Role::Key || *role != Role::Value && cells().all(|cell| cell == text) {
                    row.push_field(text);
                    continue;
                }
                let numbers: Option<Vec<f64>> = cells().map(|cell| cell.parse().ok()).collect();
                let found = numbers.as_deref().and_then(moments);
                row.push_field(&cell_of(found.map(|(mean, _)| mean)));
                if *role == Role::Value {
                    let variance = found.map(|(_, variance)| variance).filter(|_| same.len() > 1);
                    row.push_field(&cell_of(variance.and_then(|variance| widths.of(variance, same.len()))));
                    row.push_field(&cell_of(variance.map(f64::sqrt)));
                }
            }
            row.push_field(&same.len().to_string());
            row
        })
        .collect();
    Ok(Table { columns, rows })
}

/// Rows that belong together, each as pairs of member and row. Where keys and places are the same in all members, these are the
/// rows of the same number. Else rows with the same keys are told apart by the layer that their place is in, if no layer has
/// two, or by their order.
fn aligned(members: &[&Table], roles: &[Role], layer: Option<f64>) -> Vec<Vec<(usize, usize)>> {
    let mut groups: HashMap<Vec<&str>, usize> = HashMap::new();
    let group_of: Vec<Vec<usize>> = members
        .iter()
        .map(|member| {
            let mut group = |row: usize| {
                let keys = (0..roles.len()).filter(|column| roles[*column] == Role::Key);
                let key: Vec<&str> = keys.map(|column| member.text(row, column)).collect();
                let next = groups.len();
                *groups.entry(key).or_insert(next)
            };
            (0..member.len()).map(&mut group).collect()
        })
        .collect();
    let place = roles.iter().position(|role| *role == Role::Place);
    let place_at = |member: usize, row: usize| place.map(|place| members[member].text(row, place));
    let same = |(member, groups): (usize, &Vec<usize>)| {
        *groups == group_of[0] && (0..groups.len()).all(|row| place_at(member, row) == place_at(0, row))
    };
    if group_of.iter().enumerate().all(same) {
        let row_of = |row: usize| (0..members.len()).map(|member| (member, row)).collect();
        return (0..group_of[0].len()).map(row_of).collect();
    }
    let layers = || -> Option<Vec<Vec<usize>>> {
        let (place, layer) = (place?, layer?);
        let places =
            |member: &Table| (0..member.len()).map(|row| member.number(row, place)).collect::<Option<Vec<_>>>();
        let all: Vec<Vec<f64>> = members.iter().map(|member| places(member)).collect::<Option<_>>()?;
        let found: Vec<Vec<usize>> =
            all.iter().map(|places| places.iter().map(|place| (place / layer).max(0.0) as usize).collect()).collect();
        let single = |(layers, groups): (&Vec<usize>, &Vec<usize>)| {
            let mut pairs: Vec<_> = groups.iter().zip(layers).collect();
            pairs.sort_unstable();
            pairs.windows(2).all(|pair| pair[0] != pair[1])
        };
        found.iter().zip(&group_of).all(single).then_some(found)
    };
    let order = |groups: &Vec<usize>| -> Vec<usize> {
        let mut seen: HashMap<usize, usize> = HashMap::new();
        let mut next = |group: &usize| {
            let count = seen.entry(*group).or_insert(0);
            *count += 1;
            *count - 1
        };
        groups.iter().map(&mut next).collect()
    };
    let place_of = layers().unwrap_or_else(|| group_of.iter().map(order).collect());
    let mut entries: Vec<(usize, usize, usize, usize)> = Vec::new();
    for (member, (groups, places)) in group_of.iter().zip(&place_of).enumerate() {
        entries
            .extend(groups.iter().zip(places).enumerate().map(|(row, (group, place))| (*group, *place, member, row)));
    }
    entries.sort_unstable();
    let same = entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    same.map(|same| same.iter().map(|(_, _, member, row)| (*member, *row)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_of(texts: &[&str], layer: Option<f64>) -> Result<String, NoMean> {
        let tables: Vec<Table> = texts.iter().map(|text| Table::read(text.as_bytes()).expect("a table")).collect();
        let mut text = Vec::new();
        mean(&tables.iter().collect::<Vec<_>>(), layer)?.write(&mut text).expect("written");
        Ok(String::from_utf8(text).expect("text"))
    }

    #[test]
    fn intervals_are_those_of_students_t() {
        let members = [1.0, 2.0, 3.0, 4.0, 5.0].map(|value| format!("time_s,front_m,front_ref_m\n1.0,{value:?},2.5\n"));
        let text = mean_of(&members.each_ref().map(String::as_str), None).expect("a mean");
        let table = Table::read(text.as_bytes()).expect("a table");
        let names: Vec<&str> = table.columns().collect();
        assert_eq!(names, ["time_s", "front_m", "front_m_interval", "front_m_sd", "front_ref_m", "members"]);
        let cell = |name: &str| table.number(0, table.column(name).expect("the column")).expect("a number");
        assert_eq!((cell("time_s"), cell("front_m"), cell("front_ref_m"), cell("members")), (1.0, 3.0, 2.5, 5.0));
        // The sample variance of 1 to 5 is 5/2; t of four degrees of freedom is printed as 2.776.
        assert!((cell("front_m_sd") - 2.5_f64.sqrt()).abs() < 1e-15);
        assert!((cell("front_m_interval") - 2.776 * 0.5_f64.sqrt()).abs() < 5e-4 * 0.5_f64.sqrt());
    }

    #[test]
    fn any_series_has_means_by_its_keys() {
        let text = mean_of(
            &[
                "time_s,liquid,surface\n1.0,0.25,r=1\n1.0,1.0,r=2\n",
                "time_s,liquid,surface\n1.0,2.0,r=2\n1.0,0.25,r=1\n2.0,7.5,r=1\n",
            ],
            None,
        );
        let expected = "time_s,liquid,liquid_interval,liquid_sd,surface,members\n\
                        1.0,0.25,0.0,0.0,r=1,2\n\
                        1.0,1.5,6.35310236808736,0.7071067811865476,r=2,2\n\
                        2.0,7.5,,,r=1,1\n";
        let found = text.expect("a mean");
        // t of one degree of freedom is 12.706; its last digits are not what this is about.
        let digits =
            |text: &str| text.lines().map(|line| line.chars().take(14).collect::<String>()).collect::<Vec<_>>();
        assert_eq!(digits(&found), digits(expected));
        assert!(found.contains("0.7071067811865476,r=2,2"));
    }

    #[test]
    fn a_number_that_a_member_lacks_has_no_mean() {
        let text = mean_of(&["gap,closure_s\n0,5.0\n1,7.0\n", "gap,closure_s\n0,\n1,9.0\n"], None).expect("a mean");
        assert!(text.contains("\n0,,,,2\n") && text.contains("\n1,8.0,"), "{text}");
        assert!(mean_of(&["a,b\n1,2\n", "a,c\n1,2\n"], None).is_err());
    }

    #[test]
    fn layers_of_moving_particles_meet_in_their_layer() {
        // The second member has nobody in the second layer.
        let members = [
            "time_s,x_m,temperature_c,plane\n1.0,0.4,1.0,line\n1.0,1.5,5.0,line\n1.0,2.5,9.0,line\n",
            "time_s,x_m,temperature_c,plane\n1.0,0.6,3.0,line\n1.0,2.7,11.0,line\n",
        ];
        let rows = |text: String| -> Vec<(f64, f64, f64)> {
            let table = Table::read(text.as_bytes()).expect("a table");
            let cell =
                |row: usize, name: &str| table.number(row, table.column(name).expect("a column")).expect("a number");
            (0..table.len()).map(|row| (cell(row, "x_m"), cell(row, "temperature_c"), cell(row, "members"))).collect()
        };
        let found = rows(mean_of(&members, Some(1.0)).expect("a mean"));
        assert_eq!(found, [(0.5, 2.0, 2.0), (1.5, 5.0, 1.0), (2.6, 10.0, 2.0)]);
        // Without layers the order has to do, and so it has where a layer holds two rows.
        let found = rows(mean_of(&members, None).expect("a mean"));
        assert_eq!(found, [(0.5, 2.0, 2.0), (2.1, 8.0, 2.0), (2.5, 9.0, 1.0)]);
        assert_eq!(rows(mean_of(&members, Some(2.0)).expect("a mean")), found);
    }

    #[test]
    fn columns_of_references_name_what_they_are_of() {
        for (name, of) in [
            ("front_ref_m", Some("front_m")),
            ("ice_fraction_ref", Some("ice_fraction")),
            ("frozen_volume", None),
            ("fraction_refrozen", None),
        ] {
            assert_eq!(reference_of(name).as_deref(), of);
        }
    }
}
