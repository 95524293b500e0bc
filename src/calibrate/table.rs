//! The calibrated fluid as rows over temperature, and polynomials beside its exponents.

use frazil_edpd::calibration::{Constants, Polynomial, Scales, least_squares};
use serde::Serialize;

use super::fluid::Fluid;

/// Where the exchange of heat comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Conduction {
    /// Prandtl numbers of the fluid's rows.
    Fluid,
    /// One Prandtl number.
    Prandtl(f64),
    /// One thermal diffusivity, in DPD units.
    Diffusivity(f64),
}

/// One temperature. In DPD units but for `_k` and `_s`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Temperature (K).
    pub temperature_k: f64,
    /// The same over the reference temperature.
    pub temperature: f64,
    /// Schmidt number that is wanted.
    pub schmidt: f64,
    /// Exponent that gives it.
    pub exponent: f64,
    /// Self-diffusivity.
    pub diffusivity: f64,
    /// Kinematic viscosity.
    pub viscosity: f64,
    /// Rate at which friction takes velocities away.
    pub friction_rate: f64,
    /// Prandtl number.
    pub prandtl: Option<f64>,
    /// Thermal diffusivity.
    pub thermal_diffusivity: Option<f64>,
    /// Mesoscopic heat friction, kappa.
    pub heat_friction: Option<f64>,
    /// Unit of time in which the fluid diffuses as the real one (s).
    pub time_unit_s: Option<f64>,
    /// Exponent by the quadratic.
    pub exponent_quadratic: Option<f64>,
    /// Schmidt number that it gives.
    pub schmidt_quadratic: Option<f64>,
    /// Exponent by the cubic.
    pub exponent_cubic: Option<f64>,
    /// Schmidt number that it gives.
    pub schmidt_cubic: Option<f64>,
}

/// A polynomial beside the exponents.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// What it is called.
    pub name: &'static str,
    /// Exponent over temperature.
    pub polynomial: Polynomial,
    /// Coefficient of determination.
    pub determination: f64,
    /// Largest difference of exponents, and the temperature (K) at which it is.
    pub exponent_error: (f64, f64),
    /// Largest relative error of the Schmidt number, and its temperature (K). Infinite where the exponent is -1 or less.
    pub schmidt_error: (f64, f64),
    /// Number of rows at which it is negative.
    pub negative: usize,
}

/// A calibrated fluid.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Rows by temperature.
    pub rows: Vec<Row>,
    /// Quadratic and cubic, where there are rows enough.
    pub fits: Vec<Fit>,
}

/// Schmidt number of an exponent, which a fit may put where there is none: infinite there.
pub fn schmidt(constants: &Constants, exponent: f64, temperature: f64) -> f64 {
    if exponent > -1.0 { constants.schmidt(exponent, temperature) } else { f64::INFINITY }
}

/// Solves for the exponents of a fluid, at all of whose Schmidt numbers there is one.
pub fn solve(
    fluid: &Fluid,
    constants: &Constants,
    reference: f64,
    conduction: Conduction,
    scales: Option<&Scales>,
) -> Calibration {
    let mut rows: Vec<Row> = Vec::with_capacity(fluid.rows.len());
    for own in &fluid.rows {
        let temperature = own.temperature / reference;
        let Some(exponent) = constants.exponent(own.schmidt, temperature) else { continue };
        let viscosity = constants.viscosity(exponent, temperature);
        let thermal_diffusivity = match conduction {
            Conduction::Fluid => own.prandtl.map(|prandtl| viscosity / prandtl),
            Conduction::Prandtl(prandtl) => Some(viscosity / prandtl),
            Conduction::Diffusivity(diffusivity) => Some(diffusivity),
        };
        rows.push(Row {
            temperature_k: own.temperature,
            temperature,
            schmidt: own.schmidt,
            exponent,
            diffusivity: constants.diffusivity(exponent, temperature),
            viscosity,
            friction_rate: constants.friction_rate(exponent),
            prandtl: thermal_diffusivity.map(|diffusivity| viscosity / diffusivity),
            thermal_diffusivity,
            heat_friction: thermal_diffusivity.map(|diffusivity| constants.heat_friction(diffusivity)),
            time_unit_s: scales.zip(own.viscosity).map(|(scales, real)| scales.diffusive_time(viscosity, real)),
            exponent_quadratic: None,
            schmidt_quadratic: None,
            exponent_cubic: None,
            schmidt_cubic: None,
        });
    }
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.temperature, row.exponent)).collect();
    let mut fits = Vec::new();
    for (name, degree) in [("quadratic", 2), ("cubic", 3)] {
        let Some(polynomial) = least_squares(&points, degree) else { continue };
        let (mut exponent_error, mut schmidt_error) = ((0.0, reference), (0.0, reference));
        for row in &mut rows {
            let exponent = polynomial.at(row.temperature);
            let number = schmidt(constants, exponent, row.temperature);
            let shown = number.is_finite().then_some(number);
            let (apart, off) = (exponent - row.exponent, number / row.schmidt - 1.0);
            if apart.abs() >= f64::abs(exponent_error.0) {
                exponent_error = (apart, row.temperature_k);
            }
            if off.abs() >= f64::abs(schmidt_error.0) {
                schmidt_error = (off, row.temperature_k);
            }
            if degree == 2 {
                (row.exponent_quadratic, row.schmidt_quadratic) = (Some(exponent), shown);
            } else {
                (row.exponent_cubic, row.schmidt_cubic) = (Some(exponent), shown);
            }
        }
        let determination = polynomial.determination(&points);
        let negative = rows.iter().filter(|row| polynomial.at(row.temperature) < 0.0).count();
        fits.push(Fit { name, polynomial, determination, exponent_error, schmidt_error, negative });
    }
    Calibration { rows, fits }
}

impl Calibration {
    /// What a row holds at a temperature in DPD units, by straight lines between rows that hold it.
    pub fn between(&self, temperature: f64, value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
        let known: Vec<(f64, f64)> = self.rows.iter().filter_map(|row| Some((row.temperature, value(row)?))).collect();
        let next = known.partition_point(|(own, _)| *own < temperature);
        let (after, before) = (known.get(next)?, next.checked_sub(1).and_then(|last| known.get(last)));
        match before {
            _ if after.0 == temperature => Some(after.1),
            Some(before) => Some(before.1 + (after.1 - before.1) * (temperature - before.0) / (after.0 - before.0)),
            None => None,
        }
    }
}
