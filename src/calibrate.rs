//! Constants of an eDPD fluid from the Schmidt and Prandtl numbers of a real one.

mod fluid;
mod table;
mod words;

use std::path::PathBuf;

use frazil_edpd::calibration::{Constants, Scales};
use frazil_plots::calibration::{CalibrationFigure, FitCurve, calibration};
use frazil_plots::canvas::Formats;
use frazil_studies::failure::{Failure, Verdict, answer};
use frazil_studies::output::{Folder, Owner, write_rows, write_whole};

use fluid::Row;
use table::Fit;

pub use fluid::{Fluid, Row as FluidRow};
pub use table::{Calibration, Conduction, Row as CalibratedRow};

/// What is to be calibrated.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrateRequest {
    /// Fluid, by path or bundled name.
    pub fluid: String,
    /// What of the DPD fluid does not depend on temperature.
    pub constants: Constants,
    /// Temperature that is 1 in DPD units (K).
    pub reference_temperature: f64,
    /// Where the exchange of heat comes from.
    pub conduction: Conduction,
    /// Rows colder than this are left out (K).
    pub from: Option<f64>,
    /// Rows warmer than this are left out (K).
    pub to: Option<f64>,
    /// Folder for the results.
    pub out: Option<PathBuf>,
}

/// A fluid with everything that follows from it.
pub struct Calibrated<'a> {
    request: &'a CalibrateRequest,
    /// What the real one has at each temperature.
    pub fluid: Fluid,
    scales: Option<Scales>,
    /// What the eDPD fluid has, by the same rows.
    pub table: Calibration,
}

/// No row of a fluid lies within what was asked for.
#[derive(Debug, thiserror::Error)]
#[error("no row of {0} is left")]
struct NoRowLeft(String);

/// Solves for the fluid.
///
/// # Errors
/// Where the fluid cannot be read, or no row of it is left.
pub fn solve(request: &CalibrateRequest) -> Result<Calibrated<'_>, Failure> {
    let (constants, reference) = (&request.constants, request.reference_temperature);
    let inside = |row: &Row| {
        request.from.is_none_or(|from| row.temperature >= from) && request.to.is_none_or(|to| row.temperature <= to)
    };
    let mut fluid = fluid::load(&request.fluid, &|row| if inside(row) { unreachable_by(request, row) } else { None })?;
    fluid.rows.retain(inside);
    if fluid.rows.is_empty() {
        let limit = |flag: &str, limit: Option<f64>| limit.map_or(String::new(), |limit| format!("{flag} {limit}"));
        let flags = [limit("--from-k", request.from), limit("--to-k", request.to)];
        let flags = flags.iter().filter(|flag| !flag.is_empty()).cloned().collect::<Vec<_>>().join(" ");
        return Err(Failure::of(flags, NoRowLeft(request.fluid.clone())));
    }
    let scales = fluid.material.as_ref().map(|material| Scales::new(constants, material, reference));
    let table = table::solve(&fluid, constants, reference, request.conduction, scales.as_ref());
    Ok(Calibrated { request, fluid, scales, table })
}

/// Calibrates a fluid: prints the table, and writes it with a figure and keys for scenes.
pub fn calibrate(request: &CalibrateRequest) -> Result<Verdict, Failure> {
    let calibrated = solve(request)?;
    let folder = Folder::make(request.out.as_deref().unwrap_or("out/calibrate".as_ref()), Owner::Alone)?;
    write_rows(&folder.path().join("calibration.csv"), &calibrated.table.rows)?;
    let keys = words::keys(&calibrated);
    write_whole(&folder.path().join("calibration.toml"), |writer| writer.write_all(keys.as_bytes()))?;
    calibration(&figure(&calibrated)).write(folder.path(), "calibration", Formats::ALL)?;
    answer(&words::report(&calibrated, folder.path()))?;
    Ok(Verdict::Done)
}

/// Why a Schmidt number is not to be had, if it is not.
fn unreachable_by(request: &CalibrateRequest, row: &Row) -> Option<String> {
    let constants = &request.constants;
    let temperature = row.temperature / request.reference_temperature;
    let Some(cutoff) = constants.critical_cutoff(row.schmidt, temperature) else {
        return Some(format!("found a Schmidt number of {}, must be greater than 0.5", row.schmidt));
    };
    let exponent = constants.exponent(row.schmidt, temperature)?;
    // A cut-off given as the critical one may round to either side of it.
    (cutoff > constants.dissipative_cutoff * (1.0 + 1e-12)).then(|| {
        format!(
            "found a Schmidt number of {}, must be at most {:.2} at {:.2} K with cut-off {} and friction {}, or the exponent \
             is negative ({exponent:.4}); a cut-off of {:.4} would do",
            row.schmidt,
            constants.schmidt(0.0, temperature),
            row.temperature,
            constants.dissipative_cutoff,
            constants.friction,
            (cutoff * 1e4).ceil() / 1e4
        )
    })
}

fn figure(calibrated: &Calibrated<'_>) -> CalibrationFigure {
    let (constants, table) = (&calibrated.request.constants, &calibrated.table);
    let ends = table.rows.first().zip(table.rows.last()).map_or((1.0, 1.0), |(a, b)| (a.temperature, b.temperature));
    let curve = |fit: &Fit| FitCurve {
        label: format!("{} fit", fit.name),
        samples: (0..=200)
            .map(|k| ends.0 + (ends.1 - ends.0) * f64::from(k) / 200.0)
            .map(|at| (at, fit.polynomial.at(at)))
            .map(|(at, exponent)| (at, exponent, table::schmidt(constants, exponent, at)))
            .collect(),
        errors: table
            .rows
            .iter()
            .map(|row| {
                let number = if fit.name == "cubic" { row.schmidt_cubic } else { row.schmidt_quadratic };
                (row.temperature, number.unwrap_or(f64::INFINITY) / row.schmidt - 1.0)
            })
            .collect(),
    };
    CalibrationFigure {
        title: format!(
            "{}: eDPD in {} dimensions, density {}, friction {}, cut-off {}",
            calibrated.fluid.title,
            constants.dimension,
            constants.density,
            constants.friction,
            constants.dissipative_cutoff
        ),
        points: table.rows.iter().map(|row| (row.temperature, row.exponent, row.schmidt)).collect(),
        fits: table.fits.iter().map(curve).collect(),
    }
}
