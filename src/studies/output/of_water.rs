//! Series of unsaturated water, in words of water: what rows of a run call temperature is its effective saturation, and what
//! they call heat is water.

use std::io::{self, Write};

use frazil_record::{MeanOver, ProbeRow, ProfileRow, RunResult, SurfaceRow};
use serde::{Deserialize, Serialize};

use super::{Fill, budget, cells};

/// The series of a run that have other words than those of heat, by the names of their files.
pub(super) fn series(result: &RunResult) -> Vec<(&'static str, Option<Fill<'_>>)> {
    vec![
        ("surfaces.csv", surfaces(&result.surfaces)),
        ("profiles.csv", profiles(&result.profiles)),
        ("probes.csv", probes(&result.probes)),
        ("budget.csv", budget(&result.budget_names, &result.budget, ("water_stored_m3", "m3"))),
    ]
}

/// Rows under a head.
fn fill<R: Serialize>(writer: &mut dyn Write, head: &[&str], rows: impl Iterator<Item = R>) -> io::Result<()> {
    let mut csv = cells::writer(writer);
    csv.write_record(head).map_err(io::Error::other)?;
    for row in rows {
        csv.serialize(row).map_err(io::Error::other)?;
    }
    csv.flush()
}

fn profiles(rows: &[ProfileRow]) -> Option<Fill<'_>> {
    // All rows of a table have the same columns, whether a reference knows all of their concentrations or not.
    let carries = rows.first()?.concentration.is_some();
    let solute: &[&str] = if carries { &["concentration", "concentration_ref"] } else { &[] };
    let head = [&["time_s", "x_m", "saturation", "saturation_ref"], solute, &["plane", "y_m", "along_m", "mean_over"]];
    let head = head.concat();
    let cells = move |row: &ProfileRow| {
        let solute = if carries { vec![row.concentration, row.concentration_ref] } else { Vec::new() };
        let water = (row.time_s, row.x_m, row.temperature_c, row.temperature_ref_c);
        (water, solute, row.plane.clone(), row.y_m, row.along_m, row.mean_over)
    };
    Some(Box::new(move |writer| fill(writer, &head, rows.iter().map(cells))))
}

fn probes(rows: &[ProbeRow]) -> Option<Fill<'_>> {
    let carries = rows.first()?.concentration.is_some();
    let solute: &[&str] = if carries { &["concentration"] } else { &[] };
    let head = [&["time_s", "x_m", "y_m", "saturation"], solute].concat();
    let cells = |row: &ProbeRow| {
        let solute: Vec<f64> = row.concentration.into_iter().collect();
        (row.time_s, row.x_m, row.y_m, row.temperature_c, solute)
    };
    Some(Box::new(move |writer| fill(writer, &head, rows.iter().map(cells))))
}

#[derive(Serialize)]
struct SurfaceOfWater {
    time_s: f64,
    surface: String,
    water_m3_per_s: f64,
    flux_m_per_s: f64,
}

fn surfaces(found: &[SurfaceRow]) -> Option<Fill<'_>> {
    if found.is_empty() {
        return None;
    }
    Some(Box::new(move |writer| {
        let of = |row: &SurfaceRow| {
            let (water_m3_per_s, flux_m_per_s) = (row.heat_w, row.flux_w_per_m2);
            SurfaceOfWater { time_s: row.time_s, surface: row.surface.clone(), water_m3_per_s, flux_m_per_s }
        };
        super::fill_rows(writer, &found.iter().map(of).collect::<Vec<_>>())
    }))
}

/// A row of `profiles.csv` of unsaturated water, as it is read again.
#[derive(Deserialize)]
pub struct SaturationRow {
    time_s: f64,
    x_m: Option<f64>,
    saturation: f64,
    saturation_ref: Option<f64>,
    #[serde(default)]
    concentration: Option<f64>,
    #[serde(default)]
    concentration_ref: Option<f64>,
    plane: String,
    y_m: Option<f64>,
    along_m: f64,
    mean_over: Option<MeanOver>,
}

impl From<SaturationRow> for ProfileRow {
    fn from(row: SaturationRow) -> Self {
        ProfileRow {
            time_s: row.time_s,
            x_m: row.x_m,
            temperature_c: row.saturation,
            temperature_ref_c: row.saturation_ref,
            frozen_fraction: 1.0 - row.saturation,
            concentration: row.concentration,
            concentration_ref: row.concentration_ref,
            plane: row.plane,
            y_m: row.y_m,
            along_m: row.along_m,
            mean_over: row.mean_over,
        }
    }
}

#[cfg(test)]
mod tests {
    use frazil_record::{BudgetRow, Record};

    use super::*;
    use crate::ensemble::table::Table;
    use crate::output;

    fn wet(concentration: Option<f64>) -> RunResult {
        let profile = |x: f64, reference: Option<f64>| ProfileRow {
            time_s: 1.0,
            x_m: Some(x),
            temperature_c: 0.25,
            temperature_ref_c: Some(0.5),
            frozen_fraction: 0.75,
            concentration,
            concentration_ref: reference,
            plane: "line".into(),
            y_m: None,
            along_m: x,
            mean_over: None,
        };
        RunResult {
            profiles: vec![profile(0.5, None), profile(1.5, concentration)],
            probes: vec![ProbeRow { time_s: 1.0, x_m: 0.5, y_m: 0.0, temperature_c: 0.25, concentration }],
            surfaces: vec![SurfaceRow { time_s: 1.0, surface: "x=1".into(), heat_w: 2.0, flux_w_per_m2: 3.0 }],
            budget_names: vec!["left".into()],
            budget: vec![BudgetRow { time_s: 1.0, stored_j: 3.0, in_j: vec![4.0], balance_rel: -0.25 }],
            ..RunResult::bare(Record { of_water: true, ..Record::default() })
        }
    }

    fn text(result: &RunResult, name: &str) -> String {
        let found = output::series(result).into_iter().find(|(own, _)| *own == name);
        let fill = found.and_then(|(_, fill)| fill).expect("rows");
        let mut text = Vec::new();
        fill(&mut text).expect("written");
        String::from_utf8(text).expect("text")
    }

    #[test]
    fn series_of_water_are_in_words_of_water() {
        let result = wet(None);
        let profiles =
            "time_s,x_m,saturation,saturation_ref,plane,y_m,along_m,mean_over\n1.0,0.5,0.25,0.5,line,,0.5,\n";
        assert!(text(&result, "profiles.csv").starts_with(profiles), "{}", text(&result, "profiles.csv"));
        assert_eq!(text(&result, "probes.csv"), "time_s,x_m,y_m,saturation\n1.0,0.5,0.0,0.25\n");
        assert_eq!(text(&result, "surfaces.csv"), "time_s,surface,water_m3_per_s,flux_m_per_s\n1.0,x=1,2.0,3.0\n");
        let budget = "time_s,water_stored_m3,in_left_m3,balance_rel\n1.0,3.0,4.0,-0.25\n";
        assert_eq!(text(&result, "budget.csv"), budget);
    }

    #[test]
    fn profiles_of_a_solute_come_back_as_they_were() {
        let result = wet(Some(0.125));
        let profiles = text(&result, "profiles.csv");
        let head = "time_s,x_m,saturation,saturation_ref,concentration,concentration_ref,plane,y_m,along_m,mean_over\n";
        assert!(profiles.starts_with(head), "{profiles}");
        let table = Table::read(profiles.as_bytes()).expect("a table");
        let back: Vec<SaturationRow> = table.typed().expect("rows");
        assert_eq!(back.into_iter().map(ProfileRow::from).collect::<Vec<_>>(), result.profiles);
        assert_eq!(text(&result, "probes.csv"), "time_s,x_m,y_m,saturation,concentration\n1.0,0.5,0.0,0.25,0.125\n");
    }
}
