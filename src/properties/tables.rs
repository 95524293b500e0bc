//! The numbers of a study as files: unrounded, a row each. In DPD units but for `_c` and `_k`.

use std::path::Path;

use frazil_core::statistics::{Mean, mean};
use frazil_edpd::properties::halves::Push;
use frazil_studies::failure::Failure;
use frazil_studies::output::write_rows;
use serde::Serialize;

use super::execute::Finding;
use super::plan::{Job, Measurement, celsius};
use crate::calibrate::{Calibrated, CalibratedRow};

/// One temperature in `properties.csv`: means over seeds, ends of their 95 % intervals, what theory and the fluid say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Temperature (degrees Celsius).
    pub temperature_c: f64,
    /// Temperature (K).
    pub temperature_k: f64,
    /// The same over the reference temperature.
    pub temperature: f64,
    /// Exponent of friction.
    pub exponent: f64,
    /// Runs of each measurement.
    pub seeds: usize,
    /// Self-diffusivity.
    pub diffusivity: f64,
    /// Lower end.
    pub diffusivity_low: Option<f64>,
    /// Upper end.
    pub diffusivity_high: Option<f64>,
    /// By eq 13.
    pub diffusivity_theory: f64,
    /// Kinematic viscosity.
    pub viscosity: f64,
    /// Lower end.
    pub viscosity_low: Option<f64>,
    /// Upper end.
    pub viscosity_high: Option<f64>,
    /// By eq 12.
    pub viscosity_theory: f64,
    /// Thermal diffusivity, where the fluid has a Prandtl number.
    pub thermal_diffusivity: Option<f64>,
    /// Lower end.
    pub thermal_diffusivity_low: Option<f64>,
    /// Upper end.
    pub thermal_diffusivity_high: Option<f64>,
    /// By eq 19.
    pub thermal_diffusivity_theory: Option<f64>,
    /// Viscosity over self-diffusivity.
    pub schmidt: f64,
    /// Lower end.
    pub schmidt_low: Option<f64>,
    /// Upper end.
    pub schmidt_high: Option<f64>,
    /// Standard deviation over seeds, over the mean.
    pub schmidt_scatter: Option<f64>,
    /// The real fluid's; that of theory as well, as the exponent is solved for it.
    pub schmidt_target: f64,
    /// Viscosity over thermal diffusivity.
    pub prandtl: Option<f64>,
    /// Lower end.
    pub prandtl_low: Option<f64>,
    /// Upper end.
    pub prandtl_high: Option<f64>,
    /// Standard deviation over seeds, over the mean.
    pub prandtl_scatter: Option<f64>,
    /// The real fluid's, and that of theory.
    pub prandtl_target: Option<f64>,
    /// Largest change of the fluid's temperature during any of the measurements, over its temperature.
    pub warming: f64,
}

#[derive(Debug, Clone, Serialize)]
struct MemberRow {
    temperature_c: f64,
    measurement: &'static str,
    seed: u64,
    value: f64,
    theory: f64,
    particles: u64,
    length_x: f64,
    length_y: f64,
    step: f64,
    steps_settled: u64,
    steps_watched: u64,
    temperature_end: f64,
}

#[derive(Debug, Clone, Serialize)]
struct DisplacementRow {
    temperature_c: f64,
    seed: u64,
    lag: f64,
    mean_square_displacement: f64,
}

#[derive(Debug, Clone, Serialize)]
struct VelocityRow {
    temperature_c: f64,
    seed: u64,
    y: f64,
    velocity: f64,
}

#[derive(Debug, Clone, Serialize)]
struct TemperatureRow {
    temperature_c: f64,
    seed: u64,
    y: f64,
    temperature: f64,
}

fn ends(mean: &Mean) -> (Option<f64>, Option<f64>) {
    (mean.interval.map(|ends| ends.low), mean.interval.map(|ends| ends.high))
}

fn scatter(mean: &Mean) -> Option<f64> {
    (mean.count > 1).then(|| mean.variance.sqrt() / mean.mean)
}

/// What the jobs say, by temperature.
pub fn rows(calibrated: &Calibrated<'_>, jobs: &[Job], found: &[Finding]) -> Vec<Row> {
    calibrated.table.rows.iter().filter_map(|row| own(row, jobs, found)).collect()
}

fn own(row: &CalibratedRow, jobs: &[Job], found: &[Finding]) -> Option<Row> {
    let here = || jobs.iter().zip(found).filter(|(job, _)| job.row.temperature_k == row.temperature_k);
    let values = |word: &str| -> Vec<f64> {
        here().filter(|(job, _)| job.measurement.word() == word).map(|(_, found)| found.value).collect()
    };
    // In the order of seeds, all of them.
    let (particles, flows, heats) = (values("diffusivity"), values("viscosity"), values("thermal_diffusivity"));
    let over = |a: &[f64], b: &[f64]| mean(&a.iter().zip(b).map(|(a, b)| a / b).collect::<Vec<_>>());
    let (diffusivity, viscosity) = (mean(&particles)?, mean(&flows)?);
    let thermal = mean(&heats);
    let schmidt = over(&flows, &particles)?;
    let prandtl = over(&flows, &heats);
    let warmings = here().map(|(job, found)| (found.temperature / job.row.temperature - 1.0).abs());
    Some(Row {
        temperature_c: celsius(row),
        temperature_k: row.temperature_k,
        temperature: row.temperature,
        exponent: row.exponent,
        seeds: particles.len(),
        diffusivity: diffusivity.mean,
        diffusivity_low: ends(&diffusivity).0,
        diffusivity_high: ends(&diffusivity).1,
        diffusivity_theory: row.diffusivity,
        viscosity: viscosity.mean,
        viscosity_low: ends(&viscosity).0,
        viscosity_high: ends(&viscosity).1,
        viscosity_theory: row.viscosity,
        thermal_diffusivity: thermal.map(|mean| mean.mean),
        thermal_diffusivity_low: thermal.as_ref().and_then(|mean| ends(mean).0),
        thermal_diffusivity_high: thermal.as_ref().and_then(|mean| ends(mean).1),
        thermal_diffusivity_theory: row.thermal_diffusivity,
        schmidt: schmidt.mean,
        schmidt_low: ends(&schmidt).0,
        schmidt_high: ends(&schmidt).1,
        schmidt_scatter: scatter(&schmidt),
        schmidt_target: row.schmidt,
        prandtl: prandtl.map(|mean| mean.mean),
        prandtl_low: prandtl.as_ref().and_then(|mean| ends(mean).0),
        prandtl_high: prandtl.as_ref().and_then(|mean| ends(mean).1),
        prandtl_scatter: prandtl.as_ref().and_then(scatter),
        prandtl_target: row.prandtl,
        warming: warmings.fold(0.0, f64::max),
    })
}

/// Writes `properties.csv`, `members.csv`, `msd.csv`, `velocity.csv` and `temperature.csv`.
pub fn write(folder: &Path, rows: &[Row], jobs: &[Job], found: &[Finding]) -> Result<(), Failure> {
    write_rows(&folder.join("properties.csv"), rows)?;
    let members: Vec<MemberRow> = jobs.iter().zip(found).map(|(job, found)| member(job, found)).collect();
    write_rows(&folder.join("members.csv"), &members)?;
    let (mut displacements, mut velocities, mut temperatures) = (Vec::new(), Vec::new(), Vec::new());
    for (job, found) in jobs.iter().zip(found) {
        let (temperature_c, seed) = (celsius(&job.row), job.seed);
        for (at, value) in found.curve.iter().copied() {
            match job.measurement {
                Measurement::Diffusion => displacements.push(DisplacementRow {
                    temperature_c,
                    seed,
                    lag: at,
                    mean_square_displacement: value,
                }),
                Measurement::Halves(Push::Force(_)) => {
                    velocities.push(VelocityRow { temperature_c, seed, y: at, velocity: value });
                }
                Measurement::Halves(Push::Heat(_)) => {
                    let temperature = job.row.temperature + value;
                    temperatures.push(TemperatureRow { temperature_c, seed, y: at, temperature });
                }
            }
        }
    }
    write_rows(&folder.join("msd.csv"), &displacements)?;
    write_rows(&folder.join("velocity.csv"), &velocities)?;
    write_rows(&folder.join("temperature.csv"), &temperatures)
}

fn member(job: &Job, found: &Finding) -> MemberRow {
    MemberRow {
        temperature_c: celsius(&job.row),
        measurement: job.measurement.word(),
        seed: job.seed,
        value: found.value,
        theory: job.expected,
        particles: job.particles(),
        length_x: job.lengths[0],
        length_y: job.lengths[1],
        step: job.parameters.step,
        steps_settled: job.span.settle,
        steps_watched: job.span.watch,
        temperature_end: found.temperature,
    }
}
