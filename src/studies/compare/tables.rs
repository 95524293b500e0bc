//! The numbers of a comparison as files: unrounded, a row each.

use std::path::Path;

use frazil_core::statistics;
use frazil_record::Errors;
use serde::Serialize;

use super::analysis::{Comparison, Reached, Study};
use super::execute::SceneRuns;
use super::measured::{Measured, Timing};
use crate::ensemble::runs::Headline;
use crate::failure::Failure;
use crate::output::{write_beside, write_rows};

/// A configuration in `comparison.csv`.
#[derive(Debug, Clone, Serialize)]
struct Row {
    scene: String,
    method: String,
    setting: String,
    level: usize,
    spacing_m: f64,
    particles: Option<u64>,
    pairs: Option<u64>,
    steps: Option<u64>,
    pair_evaluations: Option<u64>,
    particle_updates: Option<u64>,
    step_s: Option<f64>,
    threads: Option<usize>,
    timed_runs: usize,
    warm: bool,
    setup_wall_median_s: Option<f64>,
    setup_cpu_median_s: Option<f64>,
    solve_wall_median_s: Option<f64>,
    solve_wall_min_s: Option<f64>,
    solve_wall_iqr_s: Option<f64>,
    solve_cpu_median_s: Option<f64>,
    solve_cpu_min_s: Option<f64>,
    total_wall_median_s: Option<f64>,
    total_wall_low_s: Option<f64>,
    total_wall_high_s: Option<f64>,
    total_wall_interval: &'static str,
    total_cpu_median_s: Option<f64>,
    peak_memory_bytes: Option<u64>,
    seeds: usize,
    temperature_rms_rel: Option<f64>,
    temperature_rms_over_max_abs: Option<f64>,
    temperature_max_rel: Option<f64>,
    front_rms_rel: Option<f64>,
    front_last_rel: Option<f64>,
    front_constant_rel: Option<f64>,
    frozen_volume_rms_rel: Option<f64>,
    thickness_main_rms_rel: Option<f64>,
    thickness_interface_rms_rel: Option<f64>,
    closure_day_rel: Option<f64>,
    closure_day_first_rel: Option<f64>,
    closure_day_last_rel: Option<f64>,
    run_front_rms_rel: Option<f64>,
    run_temperature_rms_rel: Option<f64>,
    energy_balance_rel: Option<f64>,
    bounds_violation_rel: Option<f64>,
    outcome: String,
    cause: String,
    repeatable: bool,
    state_hash: String,
    status: &'static str,
    reference_error_front_rel: Option<f64>,
    reference_error_closure_rel: Option<f64>,
    reference_error_volume_rel: Option<f64>,
    reference_error_temperature_rel: Option<f64>,
}

impl Row {
    fn of(runs: &SceneRuns, one: &Measured) -> Row {
        let record = one.result.as_ref().map(|result| &result.record);
        let errors = one.errors();
        let event = |name: &str| errors.and_then(|errors| errors.events.get(name).copied());
        let times = |value: &dyn Fn(&Timing) -> f64| one.timings.iter().map(value).collect::<Vec<f64>>();
        let median = |value: &dyn Fn(&Timing) -> f64| statistics::median(&times(value));
        let least = |value: &dyn Fn(&Timing) -> f64| times(value).into_iter().reduce(f64::min);
        let interval = statistics::median_interval(&times(&Timing::wall));
        let over_runs = |value: fn(&Errors) -> Option<f64>| {
            let runs: Option<Vec<f64>> = one.ensemble.as_ref()?.runs.iter().map(value).collect();
            statistics::mean(&runs?).map(|mean| mean.mean)
        };
        Row {
            scene: runs.scene.name.clone(),
            method: one.method.into(),
            setting: one.setting.name.clone(),
            level: one.level,
            spacing_m: one.spacing,
            particles: record.map(|record| record.particles),
            pairs: record.map(|record| record.pairs),
            steps: record.map(|record| record.steps),
            pair_evaluations: record.map(|record| record.pair_evaluations),
            particle_updates: record.map(|record| record.particle_updates),
            step_s: record.map(|record| record.step_s),
            threads: record.map(|record| record.threads),
            timed_runs: one.timings.len(),
            warm: !one.cold,
            setup_wall_median_s: median(&|time| time.setup_wall),
            setup_cpu_median_s: median(&|time| time.setup_cpu),
            solve_wall_median_s: median(&|time| time.solve_wall),
            solve_wall_min_s: least(&|time| time.solve_wall),
            solve_wall_iqr_s: statistics::quartiles(&times(&|time| time.solve_wall)).map(|[low, _, high]| high - low),
            solve_cpu_median_s: median(&|time| time.solve_cpu),
            solve_cpu_min_s: least(&|time| time.solve_cpu),
            total_wall_median_s: median(&Timing::wall),
            total_wall_low_s: interval.map(|interval| interval.interval.low),
            total_wall_high_s: interval.map(|interval| interval.interval.high),
            total_wall_interval: match interval {
                Some(interval) if interval.is_confident() => "95 %",
                Some(_) => "range",
                None => "",
            },
            total_cpu_median_s: median(&Timing::cpu),
            peak_memory_bytes: record.and_then(|record| record.peak_memory_bytes),
            seeds: one.ensemble.as_ref().map_or(usize::from(record.is_some()), |ensemble| ensemble.runs.len()),
            temperature_rms_rel: errors.and_then(|errors| errors.temperature_rms_rel),
            temperature_rms_over_max_abs: errors.and_then(|errors| errors.temperature_rms_over_max_abs),
            temperature_max_rel: errors.and_then(|errors| errors.temperature_max_rel),
            front_rms_rel: errors.and_then(|errors| errors.front_rms_rel),
            front_last_rel: errors.and_then(|errors| errors.front_last_rel),
            front_constant_rel: errors.and_then(|errors| errors.front_constant_rel),
            frozen_volume_rms_rel: errors.and_then(|errors| errors.frozen_volume_rms_rel),
            thickness_main_rms_rel: errors.and_then(|errors| errors.thickness_main_rms_rel),
            thickness_interface_rms_rel: errors.and_then(|errors| errors.thickness_interface_rms_rel),
            closure_day_rel: event("closure_day"),
            closure_day_first_rel: event("closure_day_first"),
            closure_day_last_rel: event("closure_day_last"),
            run_front_rms_rel: over_runs(|errors| errors.front_rms_rel),
            run_temperature_rms_rel: over_runs(|errors| errors.temperature_rms_rel),
            energy_balance_rel: record.map(|record| record.energy_balance_rel),
            bounds_violation_rel: record.and_then(|record| record.bounds_violation_rel),
            outcome: one.outcome().into(),
            cause: record
                .and_then(|record| record.cause.clone())
                .or_else(|| one.unmade.as_ref().map(|(_, reason)| reason.clone()))
                .or_else(|| one.note.clone())
                .unwrap_or_default(),
            repeatable: one.repeatable,
            state_hash: record.map(|record| record.state_hash.clone()).unwrap_or_default(),
            status: one.status().name(),
            reference_error_front_rel: runs.reference_error(Headline::Front),
            reference_error_closure_rel: runs.reference_error(Headline::Closure),
            reference_error_volume_rel: runs.reference_error(Headline::Volume),
            reference_error_temperature_rel: runs.reference_error(Headline::Temperature),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
struct EqualErrorRow {
    scene: String,
    measure: &'static str,
    target: f64,
    method: String,
    setting: String,
    curve: String,
    status: &'static str,
    time_s: Option<f64>,
    time_low_s: Option<f64>,
    time_high_s: Option<f64>,
    baseline: String,
    speed_up: Option<f64>,
    speed_up_low: Option<f64>,
    speed_up_high: Option<f64>,
    verdict: &'static str,
    error_at_most: Option<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct EqualTimeRow {
    scene: String,
    measure: &'static str,
    time_s: f64,
    method: String,
    setting: String,
    curve: String,
    status: &'static str,
    error: Option<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct ConvergenceRow {
    scene: String,
    measure: &'static str,
    method: String,
    setting: String,
    curve: String,
    spacing_m: f64,
    error_signed: Option<f64>,
    error_low: Option<f64>,
    error_high: Option<f64>,
    below_reference: bool,
    perhaps_luck: bool,
    order: Option<f64>,
    order_low: Option<f64>,
    order_high: Option<f64>,
    r_squared: Option<f64>,
    status: &'static str,
    error_at_most: Option<f64>,
}

/// Writes `comparison.csv` from the finished scenes and one that may be under way.
///
/// # Errors
/// Where it cannot be written.
pub fn write_comparison(folder: &Path, finished: &[Study], current: Option<&SceneRuns>) -> Result<(), Failure> {
    let all = finished.iter().map(|study| &study.runs).chain(current);
    let all: Vec<(&SceneRuns, &Measured)> =
        all.flat_map(|runs| runs.measured.iter().map(move |one| (runs, one))).collect();
    let rows: Vec<Row> = all.iter().map(|(runs, one)| Row::of(runs, one)).collect();
    let path = folder.join("comparison.csv");
    if all.iter().any(|(runs, _)| runs.scene.of_water) {
        let of_water: Vec<_> = all.iter().map(|(runs, one)| ErrorsOfWater::of(runs, one)).collect();
        write_beside(&path, &rows, &of_water)
    } else {
        write_rows(&path, &rows)
    }
}

/// What `comparison.csv` has of scenes of unsaturated water beside what it has of all.
#[derive(Debug, Clone, Serialize)]
struct ErrorsOfWater {
    saturation_rms: Option<f64>,
    saturation_mean_abs: Option<f64>,
    concentration_rms_rel: Option<f64>,
    concentration_mean_abs_rel: Option<f64>,
    solute_balance_rel: Option<f64>,
    reference_error_saturation_rel: Option<f64>,
    reference_error_concentration_rel: Option<f64>,
}

impl ErrorsOfWater {
    fn of(runs: &SceneRuns, one: &Measured) -> ErrorsOfWater {
        let errors = one.errors();
        let of = |measure: fn(&Errors) -> Option<f64>| errors.and_then(measure);
        let reference = |headline| runs.reference_error(headline).filter(|_| runs.scene.of_water);
        ErrorsOfWater {
            saturation_rms: of(|errors| errors.saturation_rms),
            saturation_mean_abs: of(|errors| errors.saturation_mean_abs),
            concentration_rms_rel: of(|errors| errors.concentration_rms_rel),
            concentration_mean_abs_rel: of(|errors| errors.concentration_mean_abs_rel),
            solute_balance_rel: one.result.as_ref().and_then(|result| result.record.solute_balance_rel),
            reference_error_saturation_rel: reference(Headline::Saturation),
            reference_error_concentration_rel: reference(Headline::Concentration),
        }
    }
}

/// Writes every table of the finished scenes.
pub fn write_all(folder: &Path, studies: &[Study]) -> Result<(), Failure> {
    write_comparison(folder, studies, None)?;
    let pairs: Vec<(&Study, &Comparison)> =
        studies.iter().flat_map(|study| study.comparisons.iter().map(move |comparison| (study, comparison))).collect();
    let errors: Vec<_> = pairs.iter().flat_map(|(study, comparison)| equal_error(study.name(), comparison)).collect();
    write_rows(&folder.join("equal_error.csv"), &errors)?;
    let times: Vec<_> = pairs.iter().flat_map(|(study, comparison)| equal_time(study.name(), comparison)).collect();
    write_rows(&folder.join("equal_time.csv"), &times)?;
    let orders: Vec<_> = pairs.iter().flat_map(|(study, comparison)| convergence(study.name(), comparison)).collect();
    write_rows(&folder.join("convergence.csv"), &orders)
}

fn equal_error(scene: &str, comparison: &Comparison) -> Vec<EqualErrorRow> {
    let row = |entry: &super::analysis::AtError| {
        let curve = &comparison.curves[entry.curve];
        let (status, time_s) = status(entry.time);
        EqualErrorRow {
            scene: scene.into(),
            measure: comparison.headline.name(),
            target: entry.target,
            method: curve.method.into(),
            setting: curve.setting.name.clone(),
            curve: curve.label(),
            status,
            time_s,
            time_low_s: entry.interval.map(|interval| interval.low),
            time_high_s: entry.interval.map(|interval| interval.high),
            baseline: comparison.baseline.map(|base| comparison.curves[base].label()).unwrap_or_default(),
            speed_up: entry.speed_up.map(|speed_up| speed_up.ratio),
            speed_up_low: entry.speed_up.and_then(|speed_up| speed_up.interval).map(|interval| interval.low),
            speed_up_high: entry.speed_up.and_then(|speed_up| speed_up.interval).map(|interval| interval.high),
            verdict: match entry.speed_up {
                None => "",
                Some(speed_up) if !speed_up.resolved => "no difference",
                Some(speed_up) if speed_up.ratio > 1.0 => "faster",
                Some(_) => "slower",
            },
            error_at_most: entry.error_at_most,
        }
    };
    comparison.equal_error.iter().map(row).collect()
}

fn equal_time(scene: &str, comparison: &Comparison) -> Vec<EqualTimeRow> {
    let row = |(time, curve, reached): &(f64, usize, Reached)| {
        let curve = &comparison.curves[*curve];
        let (status, error) = status(*reached);
        EqualTimeRow {
            scene: scene.into(),
            measure: comparison.headline.name(),
            time_s: *time,
            method: curve.method.into(),
            setting: curve.setting.name.clone(),
            curve: curve.label(),
            status,
            error,
        }
    };
    comparison.equal_time.iter().map(row).collect()
}

fn status(reached: Reached) -> (&'static str, Option<f64>) {
    match reached {
        Reached::At(value) => ("reached", Some(value)),
        Reached::Within(value) => ("at most", Some(value)),
        Reached::Untold(value) => ("not told", Some(value)),
        Reached::LeftOut => ("left out", None),
        Reached::Not => ("not reached", None),
    }
}

fn convergence(scene: &str, comparison: &Comparison) -> Vec<ConvergenceRow> {
    let mut rows = Vec::new();
    for (curve, order) in comparison.curves.iter().zip(&comparison.orders) {
        rows.extend(curve.points.iter().map(|point| ConvergenceRow {
            scene: scene.into(),
            measure: comparison.headline.name(),
            method: curve.method.into(),
            setting: curve.setting.name.clone(),
            curve: curve.label(),
            spacing_m: point.spacing,
            error_signed: point.signed,
            error_low: point.error_interval.map(|interval| interval.low),
            error_high: point.error_interval.map(|interval| interval.high),
            below_reference: point.hollow,
            perhaps_luck: point.ringed,
            order: order.map(|order| order.order),
            order_low: order.map(|order| order.interval.low),
            order_high: order.map(|order| order.interval.high),
            r_squared: order.map(|order| order.r_squared),
            status: point.status.name(),
            error_at_most: point.at_most,
        }));
    }
    rows
}
