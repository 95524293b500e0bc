//! Mean loads of days: what all pipes take, whatever outputs the run has, and whatever part of the plan is run.

use frazil_record::RunResult;
use frazil_simulation::march::{self, Options};
use frazil_simulation::observers::LOADS;

use crate::sketch::bundled;

const DAY: f64 = 86_400.0;

/// The ring in sand for some days, with overrides.
fn run(method: &str, days: &str, changes: &[(&str, &str)]) -> RunResult {
    let spacing = format!("method.{method}.spacing_m");
    let common = [("time.duration_days", days), ("time.profiles_days", "[]"), (spacing.as_str(), "0.2")];
    let scene = bundled("frozen-wall-sand", &[&common[..], changes].concat());
    march::run(&scene, method, None, &Options::default()).unwrap_or_else(|error| unreachable!("{error}"))
}

/// Ends of days (s), mean loads (W/m) and heat taken so far (J/m).
fn loads(result: &RunResult) -> Vec<[f64; 3]> {
    let table = result.tables.iter().find(|table| table.file == LOADS).expect("a table");
    table.rows.iter().map(|row| [0, 1, 2].map(|k| row[k].expect("a number"))).collect()
}

#[test]
fn loads_of_days_do_not_depend_on_outputs() {
    for method in ["local", "pd"] {
        let few = loads(&run(method, "6.5", &[("time.outputs", "2")]));
        let many = loads(&run(method, "6.5", &[("time.outputs", "91")]));
        assert_eq!((few.len(), many.len()), (6, 6));
        for (few, many) in few.iter().zip(&many) {
            // Steps land on outputs, so both are not the same steps.
            assert!((few[1] / many[1] - 1.0).abs() < 0.01, "{method}: {few:?} and {many:?}");
        }
        assert!(few.windows(2).all(|days| days[1][1] < days[0][1]), "{few:?}");
    }
}

#[test]
fn loads_of_days_add_up_to_the_heat_balance_in_any_part_of_the_plan() {
    let of = |sector: &str| run("local", "4", &[("time.outputs", "4"), ("domain.ring.sector", sector)]);
    let [quarter, whole] = ["\"quarter\"", "\"whole\""].map(of);
    let (mut sum, days) = (0.0, loads(&quarter));
    for (number, [end, load, taken]) in days.iter().enumerate() {
        assert_eq!(*end, (number + 1) as f64 * DAY);
        sum += load * DAY;
        assert!((sum / taken - 1.0).abs() < 1e-12);
        let pipes = whole.budget_names.iter().position(|name| name == "pipes").expect("pipes");
        let balance = -whole.budget[number].in_j[pipes];
        assert!((taken / balance - 1.0).abs() < 1e-9, "day {number}: {taken} and {balance}");
    }
    for (part, whole) in days.iter().zip(loads(&whole)) {
        assert!((part[1] / whole[1] - 1.0).abs() < 1e-9);
    }
}

/// A pipe that begins to cool later has its greatest load then, and runs of less than a day have none.
#[test]
fn a_late_start_has_its_load_on_its_day() {
    let late = loads(&run("local", "6", &[("pipes.1.on_days", "[[3]]"), ("time.outputs", "3")]));
    assert!(late[..3].iter().all(|day| day[1] == 0.0), "{late:?}");
    let greatest = late.iter().map(|day| day[1]).fold(0.0, f64::max);
    assert!(greatest > 0.0 && late[3][1] == greatest, "{late:?}");
    let short = run("local", "0.9", &[("time.outputs", "3")]);
    assert!(short.tables.iter().all(|table| table.file != LOADS));
}
