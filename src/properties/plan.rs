//! Which jobs a study consists of: a measurement at a temperature with a seed each.

use std::error::Error;

use frazil_edpd::fluid::{Exponent, Fluid, Parameters};
use frazil_edpd::properties::Span;
use frazil_edpd::properties::halves::{Push, decay};
use frazil_studies::failure::Failure;
use xxhash_rust::xxh3::xxh3_64;

use super::request::{PropertiesRequest, Rows};
use crate::calibrate::{CalibratedRow, Calibration};

/// Absolute zero (degrees Celsius).
pub const ZERO: f64 = -273.15;

/// Height of the paper's boxes, at which its drives are meant.
pub const PAPER_HEIGHT: f64 = 30.0;

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measurement {
    /// Self-diffusivity.
    Diffusion,
    /// Viscosity, or thermal diffusivity.
    Halves(Push),
}

impl Measurement {
    /// Its result in the tables.
    pub fn word(self) -> &'static str {
        match self {
            Measurement::Diffusion => "diffusivity",
            Measurement::Halves(Push::Force(_)) => "viscosity",
            Measurement::Halves(Push::Heat(_)) => "thermal_diffusivity",
        }
    }
}

/// One job.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// What is measured.
    pub measurement: Measurement,
    /// The row of the calibrated fluid.
    pub row: CalibratedRow,
    /// The fluid at its temperature.
    pub parameters: Parameters,
    /// Lengths of the periodic box.
    pub lengths: [f64; 2],
    /// Steps.
    pub span: Span,
    /// What kinetic theory expects.
    pub expected: f64,
    /// Seed.
    pub seed: u64,
}

impl Job {
    /// The fluid at its start.
    ///
    /// # Errors
    /// Where its box is too small, or a constant out of range.
    pub fn fluid(&self) -> Result<Fluid<2>, Box<dyn Error + Send + Sync>> {
        Ok(Fluid::new(self.parameters.clone(), self.lengths, self.row.temperature, self.seed, None)?)
    }

    /// Number of particles.
    pub fn particles(&self) -> u64 {
        (self.parameters.density * self.lengths[0] * self.lengths[1]).round() as u64
    }

    /// What it costs: each particle's steps.
    pub fn particle_steps(&self) -> u64 {
        self.particles() * (self.span.settle + self.span.watch)
    }

    /// What tells it from all others.
    pub fn key(&self) -> String {
        let all = format!("{self:?}");
        let word = self.measurement.word();
        format!("{word} {} K seed {} {:016x}", self.row.temperature_k, self.seed, xxh3_64(all.as_bytes()))
    }
}

/// A temperature of a row (degrees Celsius).
pub fn celsius(row: &CalibratedRow) -> f64 {
    ((row.temperature_k + ZERO) * 1e9).round() / 1e9
}

/// A temperature was asked for that the fluid has no row of.
#[derive(Debug, thiserror::Error)]
#[error("--temperatures-c {temperature}: {fluid} has no row of that temperature; there are {}", known.join(", "))]
struct NoSuchRow {
    temperature: f64,
    fluid: String,
    known: Vec<String>,
}

/// The rows that are to be measured.
pub fn rows(request: &PropertiesRequest, table: &Calibration) -> Result<Vec<CalibratedRow>, Failure> {
    let mut rows: Vec<CalibratedRow> = Vec::new();
    match &request.rows {
        Rows::All => rows.clone_from(&table.rows),
        Rows::Apart(least) => {
            for row in &table.rows {
                if rows.last().is_none_or(|last| row.temperature_k - last.temperature_k >= least - 1e-6) {
                    rows.push(row.clone());
                }
            }
        }
        Rows::Given(temperatures) => {
            for temperature in temperatures {
                let near = |row: &&CalibratedRow| (celsius(row) - temperature).abs() < 1e-6;
                let Some(row) = table.rows.iter().find(near) else {
                    let known = table.rows.iter().map(|row| celsius(row).to_string()).collect();
                    let (temperature, fluid) = (*temperature, request.fluid.clone());
                    return Err(Failure::request(NoSuchRow { temperature, fluid, known }));
                };
                rows.push(row.clone());
            }
            rows.sort_by(|a, b| a.temperature_k.total_cmp(&b.temperature_k));
            rows.dedup_by(|a, b| a.temperature_k == b.temperature_k);
        }
    }
    Ok(rows)
}

/// The fluid at the temperature of a row. Where that knows no exchange of heat, it is the one of the nearest row that does,
/// so that the heat of friction spreads.
pub fn parameters(request: &PropertiesRequest, table: &Calibration, row: &CalibratedRow) -> Parameters {
    let constants = &request.constants;
    let apart = |other: &&CalibratedRow| (other.temperature - row.temperature).abs();
    let known = table.rows.iter().filter(|other| other.heat_friction.is_some());
    let nearest = known.min_by(|a, b| apart(a).total_cmp(&apart(b)));
    Parameters {
        density: constants.density,
        repulsion: constants.printed_repulsion(row.temperature),
        friction: constants.friction,
        // A cut-off at its critical value may round to a hair below 0.
        exponent: Exponent::Table(table.rows.iter().map(|row| (row.temperature, row.exponent.max(0.0))).collect()),
        conservative_cutoff: constants.conservative_cutoff,
        dissipative_cutoff: constants.dissipative_cutoff,
        thermal_cutoff: constants.thermal_cutoff,
        heat_capacity: constants.heat_capacity,
        heat_friction: nearest.and_then(|row| row.heat_friction).unwrap_or(0.0),
        step: request.step,
    }
}

/// All jobs: by temperature, then measurement, then seed.
pub fn jobs(request: &PropertiesRequest, table: &Calibration, rows: &[CalibratedRow]) -> Result<Vec<Job>, Failure> {
    let height = if request.paper { PAPER_HEIGHT } else { request.height };
    // As high profiles in every box as in the paper's.
    let stronger = (PAPER_HEIGHT / height).powi(2);
    let mut jobs = Vec::new();
    for row in rows {
        let parameters = parameters(request, table, row);
        let heat =
            row.thermal_diffusivity.map(|expected| (Measurement::Halves(Push::Heat(100.0 * stronger)), expected));
        let force = (Measurement::Halves(Push::Force(0.2 * stronger)), row.viscosity);
        let all = [Some((Measurement::Diffusion, row.diffusivity)), Some(force), heat];
        for (measurement, expected) in all.into_iter().flatten() {
            let wide = if measurement == Measurement::Diffusion { height } else { height / 1.5 };
            for seed in 1..=request.seeds {
                jobs.push(Job {
                    measurement,
                    row: row.clone(),
                    parameters: parameters.clone(),
                    lengths: [wide, height],
                    span: span(request, measurement, height, expected),
                    expected,
                    seed,
                });
            }
        }
    }
    // Boxes are tried once for each measurement: no other temperature has other ones.
    for job in jobs.iter().filter(|job| job.seed == 1 && job.row == rows[0]) {
        job.fluid().map_err(|error| Failure::of(format!("--box {height}"), error))?;
    }
    Ok(jobs)
}

/// Steps of a measurement. The slowest wave of a box takes a time in proportion to the square of its height; a liquid as
/// viscous as the coldest needs some ten units of time to forget the lattice that it starts from.
fn span(request: &PropertiesRequest, measurement: Measurement, height: f64, expected: f64) -> Span {
    if request.paper {
        return match measurement {
            Measurement::Diffusion => Span { settle: 140_000, watch: 140_000 },
            Measurement::Halves(_) => Span { settle: 100_000, watch: 120_000 },
        };
    }
    let square = height * height;
    let (settle, watch) = match measurement {
        Measurement::Diffusion => (10.0, 0.125 * square),
        Measurement::Halves(Push::Force(_)) => (10.0 + 3.0 * decay(height, expected), 0.1 * square),
        Measurement::Halves(Push::Heat(_)) => (2.0 * decay(height, expected), 0.05 * square),
    };
    let steps = |time: f64| (time / request.step).ceil() as u64;
    Span { settle: steps(settle), watch: steps(watch * request.effort).next_multiple_of(100) }
}
