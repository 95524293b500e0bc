//! What a run found where and when something was measured, and how far it is off.

use std::collections::BTreeMap;

use frazil_record::{MeasuredErrors, MeasuredRow, RunResult};
use frazil_scene::{Measured, MeasuredPoint, Quantity, Scene};

use super::events;

/// Share of the duration by which two instants may differ and still be the same.
pub const SAME_INSTANT: f64 = 1e-9;

/// A row for each measured point. A mean of runs has no probes of its own: what its rows say already stays.
pub(super) fn rows(scene: &Scene, result: &RunResult, measured: &Measured) -> Vec<MeasuredRow> {
    let near = SAME_INSTANT * scene.duration;
    let events = events(scene, result);
    let compared = |point: &&MeasuredPoint| point.time > 0.0;
    let row = |(k, point): (usize, &MeasuredPoint)| {
        let MeasuredPoint { quantity, time, value: value_ref, sd: value_ref_sd } = *point;
        let is_then = |time_s: f64| (time_s - time).abs() <= near;
        let (name, place, value) = match quantity {
            Quantity::Front => {
                let row = at(&result.front, time - near, |row| row.time_s).find(|row| is_then(row.time_s));
                ("front_m".to_owned(), None, row.map(|row| row.front_m))
            }
            Quantity::Probe { x, y } => {
                let then = at(&result.probes, time - near, |row| row.time_s).take_while(|row| is_then(row.time_s));
                let mut here = then.filter(|row| (row.x_m, row.y_m) == (x, y));
                let name = if scene.of_water { "saturation" } else { "temperature_c" };
                (name.to_owned(), Some((x, y)), here.next().map(|row| row.temperature_c))
            }
            Quantity::Event(event) => (format!("{}_s", event.name()), None, events.get(event.name()).copied()),
        };
        let (x_m, y_m) = (place.map(|place| place.0), place.map(|place| place.1));
        let known = result.measured.get(k).filter(|row| row.quantity == name && row.time_s == time);
        let value = value.or(known.and_then(|row| row.value));
        MeasuredRow { quantity: name, time_s: time, x_m, y_m, value, value_ref, value_ref_sd }
    };
    measured.points.iter().filter(compared).enumerate().map(row).collect()
}

/// Rows from an instant (s) on, of rows in the order of time.
fn at<R>(rows: &[R], from: f64, time: impl Fn(&R) -> f64) -> impl Iterator<Item = &R> {
    rows[rows.partition_point(|row| time(row) < from)..].iter()
}

/// How far a run is off, by quantity.
pub fn deviations(rows: &[MeasuredRow]) -> BTreeMap<String, MeasuredErrors> {
    let mut groups: BTreeMap<String, Vec<&MeasuredRow>> = BTreeMap::new();
    for row in rows {
        groups.entry(row.group().to_owned()).or_default().push(row);
    }
    groups.into_iter().filter_map(|(quantity, rows)| Some((quantity, of_group(&rows)?))).collect()
}

/// The same of one quantity; absent where the run has none of its values, or one that is no number.
fn of_group(rows: &[&MeasuredRow]) -> Option<MeasuredErrors> {
    let found: Vec<(f64, f64)> = rows.iter().filter_map(|row| Some((row.difference()?, row.value_ref_sd))).collect();
    let count = found.len() as f64;
    let mean = |of: &dyn Fn(f64, f64) -> f64| found.iter().map(|(off, sd)| of(*off, *sd)).sum::<f64>() / count;
    let within = |deviations: f64| mean(&|off, sd| f64::from(off.abs() <= deviations * sd));
    let errors = MeasuredErrors {
        points: found.len(),
        missing: rows.len() - found.len(),
        rms: mean(&|off, _| off * off).sqrt(),
        max: found.iter().map(|(off, _)| off.abs()).fold(0.0, f64::max),
        mean: mean(&|off, _| off),
        sd_rms: mean(&|_, sd| sd * sd).sqrt(),
        rms_over_sd: mean(&|off, sd| (off / sd).powi(2)).sqrt(),
        within_sd: within(1.0),
        within_2sd: within(2.0),
    };
    errors.rms_over_sd.is_finite().then_some(errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn row(quantity: &str, value: Option<f64>, value_ref: f64, value_ref_sd: f64) -> MeasuredRow {
        MeasuredRow { quantity: quantity.into(), time_s: 1.0, x_m: None, y_m: None, value, value_ref, value_ref_sd }
    }

    proptest! {
        /// A run that is off by so many standard deviations everywhere says so, whatever the unit.
        #[test]
        fn a_shift_is_told_in_standard_deviations(
            shift in -5.0..5.0_f64,
            sd in 1e-6..1e3_f64,
            values in prop::collection::vec(-1e3..1e3_f64, 1..20),
        ) {
            let rows: Vec<MeasuredRow> =
                values.iter().map(|value| row("front_m", Some(value + shift * sd), *value, sd)).collect();
            let found = deviations(&rows)["front_m"];
            let rounding = 1e-12 * 2e3 / sd;
            prop_assert!((found.rms_over_sd - shift.abs()).abs() <= rounding + 1e-12);
            prop_assert!((found.mean / sd - shift).abs() <= rounding + 1e-12);
            prop_assert!((found.rms / sd - found.rms_over_sd).abs() <= 1e-9 * found.rms_over_sd + rounding);
            prop_assert!((found.sd_rms / sd - 1.0).abs() < 1e-12);
            prop_assert_eq!(found.points, rows.len());
            if (shift.abs() - 1.0).abs() > 1e-3 + rounding {
                prop_assert_eq!(found.within_sd, f64::from(shift.abs() < 1.0));
            }
        }
    }

    #[test]
    fn what_a_run_has_no_value_for_is_counted_apart() {
        let rows = [
            row("closure_day_s", None, 10.0, 1.0),
            row("closure_day_last_s", Some(13.0), 12.0, 2.0),
            row("temperature_c", None, 1.0, 0.1),
        ];
        let found = deviations(&rows);
        assert_eq!(found.len(), 1);
        let events = found["events_s"];
        assert_eq!((events.points, events.missing, events.rms, events.rms_over_sd), (1, 1, 1.0, 0.5));
    }
}
