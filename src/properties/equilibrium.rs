//! What a fluid that is left alone has to keep: its energy and momentum, and one temperature for motion and heat.

use std::cell::Cell;
use std::path::Path;

use frazil_edpd::fluid::{Fluid, Parameters};
use frazil_edpd::properties::equilibrium::{SETTLE, gain, measure};
use frazil_studies::campaign::{Campaign, Meter, Shard};
use frazil_studies::failure::{Failure, Verdict, answer, complain};
use frazil_studies::output::{Folder, Owner, write_rows};
use frazil_studies::progress::forewarn;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use super::execute::{seconds_of, words};
use super::plan;
use super::request::PropertiesRequest;
use crate::calibrate::Calibrated;
use crate::interrupt;

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
#[derive(Debug, Clone, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Serialize, Deserialize)]
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
        return Err(Failure::of(&request.fluid, "no row"));
    };
    let own = plan::parameters(request, table, row);
    let steps = (STEPS * request.effort).round().max(1000.0) as u64;
    let jobs = [(2, 1.0), (2, 3.0), (3, 1.0), (3, 3.0)];
    let price = 1500 * (SETTLE + steps);
    if !request.quiet {
        forewarn("properties", Some(seconds_of(price * jobs.len() as u64, request.threads.min(jobs.len()))));
    }
    let folder = Folder::make(path, Owner::Alone)?;
    let campaign = Campaign::open(path, Shard::WHOLE, request.threads, interrupt::watch())?;
    let prices = [price as f64; 4];
    let meter = Meter::new(request.quiet, prices.iter().sum());
    let rows = campaign.side_by_side(&prices, |k| {
        let (dimension, times) = jobs[k];
        let parameters = Parameters { step: own.step * times, ..own.clone() };
        let key = key(&format!("equilibrium {dimension}D, {steps} steps"), &parameters, row.temperature);
        let known = campaign.known(&key).inspect(|_| meter.skip(prices[k]));
        known.or_else(|| {
            let (task, made) = (meter.task(prices[k]), Cell::new(0));
            let go_on = |more: u64| {
                made.set(made.get() + more);
                task.at(made.get() as f64 / (SETTLE + steps) as f64, words);
                !campaign.is_interrupted()
            };
            campaign.make(&key, || in_dimension(dimension, parameters, row.temperature, steps, &go_on))
        })
    });
    meter.finish();
    let (rows, explicit) = (rows?, explicit(request, &own, row.temperature, &campaign)?);
    if campaign.is_interrupted() {
        complain("interrupted: the same command resumes from here");
        return Ok(Verdict::Broken);
    }
    let (rows, explicit): (Vec<Row>, Vec<ExplicitRow>) =
        (rows.into_iter().flatten().collect(), explicit.into_iter().flatten().collect());
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

/// What tells a run from all others.
fn key(purpose: &str, parameters: &Parameters, temperature: f64) -> String {
    format!("{purpose} {:016x}", xxh3_64(format!("{parameters:?} {temperature:?}").as_bytes()))
}

/// A fluid of some 1500 particles in a box of two or three dimensions.
fn in_dimension(
    dimension: usize,
    parameters: Parameters,
    temperature: f64,
    steps: u64,
    go_on: &dyn Fn(u64) -> bool,
) -> Result<Option<Row>, Failure> {
    if dimension == 2 {
        let height = (1500.0 / parameters.density).sqrt();
        return one(parameters, [height; 2], temperature, steps, go_on);
    }
    let reach = |cutoff: f64| cutoff * SPACE_CUTOFF / parameters.reach();
    let parameters = Parameters {
        conservative_cutoff: reach(parameters.conservative_cutoff),
        dissipative_cutoff: reach(parameters.dissipative_cutoff),
        thermal_cutoff: reach(parameters.thermal_cutoff),
        ..parameters
    };
    let height = (1500.0 / parameters.density).cbrt();
    one(parameters, [height; 3], temperature, steps, go_on)
}

fn one<const D: usize>(
    parameters: Parameters,
    lengths: [f64; D],
    temperature: f64,
    steps: u64,
    go_on: &dyn Fn(u64) -> bool,
) -> Result<Option<Row>, Failure> {
    let step = parameters.step;
    let failure = |error| Failure::of(format!("{D}D, step {step}"), error);
    let mut fluid = Fluid::new(parameters, lengths, temperature, 1, None).map_err(failure)?;
    let found = measure(&mut fluid, steps, go_on).map_err(failure)?;
    Ok(found.map(|found| Row {
        dimension: D,
        step,
        particles: fluid.particles().len(),
        steps,
        kinetic_over_internal: found.temperatures,
        kinetic_over_internal_error: found.temperatures_error,
        momentum: found.momentum,
        drift_over_kinetic: found.drift_kinetic,
        drift_over_total: found.drift_total,
    }))
}

/// The paper's integrator in the plane.
fn explicit(
    request: &PropertiesRequest,
    parameters: &Parameters,
    temperature: f64,
    campaign: &Campaign<'_>,
) -> Result<Vec<Option<ExplicitRow>>, Failure> {
    let steps = (EXPLICIT.0 * request.effort).round().max(100.0) as u64;
    let height = (1500.0 / parameters.density).sqrt();
    campaign.side_by_side(&[0.0; EXPLICIT.1.len()], |k| {
        let lambda = EXPLICIT.1[k];
        let run = || {
            let go_on = |_| !campaign.is_interrupted();
            let found = Fluid::new(parameters.clone(), [height; 2], temperature, 1, None).and_then(|mut fluid| {
                let found = gain(&mut fluid, lambda, steps, &go_on)?;
                Ok(found.map(|found| ExplicitRow {
                    lambda,
                    step: parameters.step,
                    particles: fluid.particles().len(),
                    steps,
                    gain_by_time: found.by_time,
                    kinetic_over_internal: found.temperatures,
                }))
            });
            found.map_err(|error| Failure::Request(error.into()))
        };
        let key = key(&format!("explicit {lambda}, {steps} steps"), parameters, temperature);
        campaign.known(&key).or_else(|| campaign.make(&key, run))
    })
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
