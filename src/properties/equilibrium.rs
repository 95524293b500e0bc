//! What a fluid that is left alone has to keep: its energy and momentum, and one temperature for motion and heat.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use frazil_edpd::fluid::{Fluid, Parameters};
use frazil_edpd::properties::equilibrium::{Equilibrium, SETTLE, gain, measure};
use serde::Serialize;

use super::PropertiesRequest;
use super::execute::{Meter, seconds_of};
use super::plan;
use crate::calibrate::Calibrated;
use crate::failure::{Failure, Verdict, answer, complain};
use crate::output::{Folder, write_rows};
use crate::progress::forewarn;
use crate::{interrupt, parallel};

/// Cut-off radius in space: as many partners as 1.96 gives in the plane.
const SPACE_CUTOFF: f64 = 1.58;

/// Steps that are watched.
const STEPS: f64 = 1e5;

/// Share by which kinetic and internal temperature may differ: noise of the mean and the error of the step stay well below.
const TEMPERATURES: f64 = 0.005;
/// Momentum that rounding may add up to.
const MOMENTUM: f64 = 1e-10;
/// Energy, over the kinetic energy, that rounding may add up to.
const ENERGY: f64 = 1e-9;

/// One run in `equilibrium.csv`.
#[derive(Debug, Clone, Serialize)]
struct Row {
    dimension: usize,
    step: f64,
    particles: usize,
    steps: u64,
    kinetic_over_internal: f64,
    kinetic_over_internal_error: f64,
    momentum: f64,
    drift_over_kinetic: f64,
    drift_over_total: f64,
}

/// Steps under the paper's integrator, and its lambdas: that of Groot and Warren (1997), and plain velocity Verlet.
const EXPLICIT: (f64, [f64; 2]) = (1500.0, [0.65, 0.5]);

/// One run in `explicit.csv`.
#[derive(Debug, Clone, Serialize)]
struct ExplicitRow {
    lambda: f64,
    step: f64,
    particles: usize,
    steps: u64,
    gain_by_time: f64,
    kinetic_over_internal: f64,
}

/// Runs the fluid in the plane and in space, at the step and at three times the step.
pub fn equilibrium(request: &PropertiesRequest, calibrated: &Calibrated<'_>, path: &Path) -> Result<Verdict, Failure> {
    let near = |row: &&crate::calibrate::CalibratedRow| (row.temperature - 1.0).abs();
    let table = &calibrated.table;
    let Some(row) = table.rows.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else {
        return Err(Failure::Request(format!("{}: no row", request.fluid)));
    };
    let own = plan::parameters(request, table, row);
    let steps = (STEPS * request.effort).round().max(1000.0) as u64;
    let jobs = [(2, 1.0), (2, 3.0), (3, 1.0), (3, 3.0)];
    let stop = interrupt::watch();
    let particles = 1500 * (SETTLE + steps) * jobs.len() as u64;
    if !request.quiet {
        forewarn("properties", Some(seconds_of(particles, request.threads.min(jobs.len()))));
    }
    let meter = Meter::new(request.quiet, particles, stop);
    let failed = Mutex::new(None);
    let run = |k: usize| {
        let (dimension, times) = jobs[k];
        let parameters = Parameters { step: own.step * times, ..own.clone() };
        let found = in_dimension(dimension, parameters, row.temperature, steps, &meter, stop);
        found.unwrap_or_else(|message| {
            let failure = Failure::Request(format!("{dimension}D, step {}: {message}", own.step * times));
            failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
            None
        })
    };
    let found = parallel::in_order(jobs.len(), request.threads, run);
    meter.finish();
    if let Some(failure) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(failure);
    }
    if stop.load(Ordering::Relaxed) {
        complain("interrupted");
        return Ok(Verdict::Broken);
    }
    let rows: Vec<Row> = found
        .into_iter()
        .zip(jobs)
        .filter_map(|(found, (dimension, times))| {
            let (particles, found) = found?;
            Some(Row {
                dimension,
                step: own.step * times,
                particles,
                steps,
                kinetic_over_internal: found.temperatures,
                kinetic_over_internal_error: found.temperatures_error,
                momentum: found.momentum,
                drift_over_kinetic: found.drift_kinetic,
                drift_over_total: found.drift_total,
            })
        })
        .collect();
    let explicit = explicit(request, &own, row.temperature, stop)?;
    if stop.load(Ordering::Relaxed) {
        complain("interrupted");
        return Ok(Verdict::Broken);
    }
    let folder = Folder::make(path)?;
    write_rows(&folder.path().join("equilibrium.csv"), &rows)?;
    write_rows(&folder.path().join("explicit.csv"), &explicit)?;
    answer(&report(&calibrated.fluid.name, row.temperature_k, &rows, &explicit, own.heat_capacity, folder.path()))?;
    let good = |row: &Row| {
        (row.kinetic_over_internal - 1.0).abs() <= TEMPERATURES
            && row.momentum <= MOMENTUM
            && row.drift_over_kinetic <= ENERGY
    };
    Ok(if rows.iter().all(good) { Verdict::Done } else { Verdict::CheckFailed })
}

/// A fluid of some 1500 particles in a box of two or three dimensions.
fn in_dimension(
    dimension: usize,
    parameters: Parameters,
    temperature: f64,
    steps: u64,
    meter: &Meter,
    stop: &AtomicBool,
) -> Result<Option<(usize, Equilibrium)>, String> {
    if dimension == 2 {
        let height = (1500.0 / parameters.density).sqrt();
        return one(parameters, [height; 2], temperature, steps, meter, stop);
    }
    let reach = |cutoff: f64| cutoff * SPACE_CUTOFF / parameters.reach();
    let parameters = Parameters {
        conservative_cutoff: reach(parameters.conservative_cutoff),
        dissipative_cutoff: reach(parameters.dissipative_cutoff),
        thermal_cutoff: reach(parameters.thermal_cutoff),
        ..parameters
    };
    let height = (1500.0 / parameters.density).cbrt();
    one(parameters, [height; 3], temperature, steps, meter, stop)
}

/// The paper's integrator in the plane.
fn explicit(
    request: &PropertiesRequest,
    parameters: &Parameters,
    temperature: f64,
    stop: &AtomicBool,
) -> Result<Vec<ExplicitRow>, Failure> {
    let steps = (EXPLICIT.0 * request.effort).round().max(100.0) as u64;
    let height = (1500.0 / parameters.density).sqrt();
    let run = |k: usize| {
        let go_on = |_| !stop.load(Ordering::Relaxed);
        let found = Fluid::new(parameters.clone(), [height; 2], temperature, 1, None).and_then(|mut fluid| {
            let found = gain(&mut fluid, EXPLICIT.1[k], steps, &go_on)?;
            Ok(found.map(|found| (fluid.particles().len(), found)))
        });
        let found = found.map(|found| {
            found.map(|(particles, found)| ExplicitRow {
                lambda: EXPLICIT.1[k],
                step: parameters.step,
                particles,
                steps,
                gain_by_time: found.by_time,
                kinetic_over_internal: found.temperatures,
            })
        });
        found.transpose()
    };
    let found = parallel::in_order(EXPLICIT.1.len(), request.threads, run);
    found.into_iter().flatten().map(|row| row.map_err(Failure::Request)).collect()
}

fn one<const D: usize>(
    parameters: Parameters,
    lengths: [f64; D],
    temperature: f64,
    steps: u64,
    meter: &Meter<'_>,
    stop: &AtomicBool,
) -> Result<Option<(usize, Equilibrium)>, String> {
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let mut fluid = Fluid::new(parameters, lengths, temperature, 1, None)?;
    let count = fluid.particles().len();
    let found = measure(&mut fluid, steps, &|steps| meter.made(steps * count as u64))?;
    Ok(found.map(|found| (count, found)))
}

fn report(
    name: &str,
    kelvin: f64,
    rows: &[Row],
    explicit: &[ExplicitRow],
    heat_capacity: f64,
    folder: &Path,
) -> String {
    let mut text = format!("{name} left alone at {kelvin} K\n\n");
    text.push_str(&format!(
        "  {:>3} {:>8} {:>9} {:>8} {:>24} {:>10} {:>16} {:>16}\n",
        "", "step", "particles", "steps", "kinetic / internal T", "momentum", "drift / kinetic", "drift / total"
    ));
    for row in rows {
        let temperatures = format!("{:.5} ± {:.5}", row.kinetic_over_internal, row.kinetic_over_internal_error);
        text.push_str(&format!(
            "  {:>3} {:>8} {:>9} {:>8} {temperatures:>24} {:>10.1e} {:>16.1e} {:>16.1e}\n",
            format!("{}D", row.dimension),
            row.step,
            row.particles,
            row.steps,
            row.momentum,
            row.drift_over_kinetic,
            row.drift_over_total
        ));
    }
    text.push_str("\n  velocity Verlet, as the paper has it, in the plane\n\n");
    text.push_str(&format!(
        "  {:>8} {:>8} {:>8} {:>20} {:>24} {:>20}\n",
        "lambda", "step", "steps", "gain / particle time", "temperature / time", "kinetic / internal T"
    ));
    for row in explicit {
        text.push_str(&format!(
            "  {:>8} {:>8} {:>8} {:>20.3} {:>24.2e} {:>20.4}\n",
            row.lambda,
            row.step,
            row.steps,
            row.gain_by_time,
            row.gain_by_time / heat_capacity,
            row.kinetic_over_internal
        ));
    }
    text.push_str(&format!(
        "\n  bounds: temperatures within {} %, momentum {MOMENTUM:e}, drift {ENERGY:e} of the kinetic energy\n\n  results \
         {}\n",
        100.0 * TEMPERATURES,
        folder.display()
    ));
    text
}
