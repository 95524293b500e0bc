//! The figures of a study, like figures 3, 5, 6, 7 and 8 of Ng et al. 2017.

use std::path::Path;

use frazil_edpd::properties::halves::{Push, profile, tip};
use frazil_plots::canvas::Formats;
use frazil_plots::properties::{CurvesFigure, Deviations, Estimate, Measured, NumberFigure, curves, numbers};
use frazil_studies::failure::Failure;
use frazil_studies::figures::Figures;
use frazil_studies::parallel;

use super::execute::Finding;
use super::plan::{Job, Measurement, celsius};
use super::tables::Row;

/// Temperatures whose curves are shown: more would hide each other.
const SHOWN: usize = 5;

/// Draws all figures.
pub fn write(folder: &Path, title: &str, rows: &[Row], jobs: &[Job], found: &[Finding]) -> Result<(), Failure> {
    let mut figures = Figures::default();
    figures.add(folder, "msd", displacements(title, rows, jobs, found));
    figures.add(folder, "velocity", halves(title, "velocity", rows, jobs, found));
    if rows.iter().any(|row| row.thermal_diffusivity.is_some()) {
        figures.add(folder, "temperature", halves(title, "temperature", rows, jobs, found));
        figures.add(folder, "prandtl", prandtl(title, rows));
    }
    figures.add(folder, "schmidt", schmidt(title, rows));
    Ok(figures.write(Formats::ALL, parallel::cores())?)
}

/// Some of the rows, ends included.
fn some<'a>(rows: &[&'a Row], count: usize) -> Vec<&'a Row> {
    let last = rows.len().saturating_sub(1);
    let mut picked: Vec<&Row> = Vec::new();
    for k in 0..count {
        let row = rows[(k * last + (count - 1) / 2) / (count - 1).max(1)];
        if picked.last().is_none_or(|other| other.temperature_k < row.temperature_k) {
            picked.push(row);
        }
    }
    picked
}

/// Mean of the curves of all seeds of a measurement at a temperature, and its first job.
fn mean_curve<'a>(row: &Row, word: &str, jobs: &'a [Job], found: &[Finding]) -> Option<(&'a Job, Vec<(f64, f64)>)> {
    let mut own = jobs
        .iter()
        .zip(found)
        .filter(|(job, _)| job.row.temperature_k == row.temperature_k && job.measurement.word() == word);
    let (job, first) = own.next()?;
    let (mut curve, mut count) = (first.curve.clone(), 1.0);
    for (_, finding) in own {
        curve.iter_mut().zip(&finding.curve).for_each(|(sum, point)| sum.1 += point.1);
        count += 1.0;
    }
    curve.iter_mut().for_each(|point| point.1 /= count);
    Some((job, curve))
}

fn label(job: &Job) -> String {
    format!("{} °C", celsius(&job.row)).replace('-', "−")
}

fn displacements(title: &str, rows: &[Row], jobs: &[Job], found: &[Finding]) -> frazil_plots::canvas::Canvas {
    let all: Vec<&Row> = rows.iter().collect();
    let curve = |row: &&Row| {
        let (job, points) = mean_curve(row, "diffusivity", jobs, found)?;
        let last = points.last()?.0;
        Some(Measured {
            label: label(job),
            points: points.iter().step_by(2).map(|point| (point.0, 0.25 * point.1)).collect(),
            line: vec![(0.0, 0.0), (last, row.diffusivity_theory * last)],
        })
    };
    curves(&CurvesFigure {
        title: format!("{title}: mean square displacement over four"),
        line_label: "kinetic theory, eq 13".into(),
        axes: ("lag (DPD units of time)".into(), "MSD / 4 (DPD units of length²)".into()),
        curves: some(&all, SHOWN).iter().filter_map(curve).collect(),
    })
}

fn halves(title: &str, what: &str, rows: &[Row], jobs: &[Job], found: &[Finding]) -> frazil_plots::canvas::Canvas {
    let word = if what == "velocity" { "viscosity" } else { "thermal_diffusivity" };
    let known: Vec<&Row> = rows.iter().filter(|row| word == "viscosity" || row.thermal_diffusivity.is_some()).collect();
    let curve = |row: &&Row| {
        let (job, points) = mean_curve(row, word, jobs, found)?;
        let Measurement::Halves(push) = job.measurement else { return None };
        let value = if matches!(push, Push::Force(_)) { Some(row.viscosity) } else { row.thermal_diffusivity };
        let height = job.lengths[1];
        let top = tip(push, height, job.parameters.heat_capacity, value?);
        let base = if matches!(push, Push::Force(_)) { 0.0 } else { job.row.temperature };
        let line = (0..=200).map(|k| f64::from(k) / 200.0).map(|place| (place * height, base + top * profile(place)));
        Some(Measured {
            label: label(job),
            points: points.iter().map(|point| (point.0, base + point.1)).collect(),
            line: line.collect(),
        })
    };
    let name = if what == "velocity" { "velocity (DPD units)" } else { "temperature over the reference temperature" };
    curves(&CurvesFigure {
        title: format!("{title}: {what} across a periodic box whose halves are driven against each other"),
        line_label: "parabolas of the mean fit".into(),
        axes: ("y (DPD units of length)".into(), name.into()),
        curves: some(&known, 3).iter().filter_map(curve).collect(),
    })
}

/// Deviation from a reference in per cent, with its interval.
fn deviation(at: f64, mean: f64, ends: Option<(f64, f64)>, reference: f64) -> Estimate {
    let off = |value: f64| 100.0 * (value / reference - 1.0);
    Estimate { at, mean: off(mean), ends: ends.map(|(low, high)| (off(low), off(high))) }
}

fn schmidt(title: &str, rows: &[Row]) -> frazil_plots::canvas::Canvas {
    let kind = |label: &str, point: fn(&Row) -> Estimate| Deviations {
        label: label.into(),
        points: rows.iter().map(point).collect(),
    };
    numbers(&NumberFigure {
        title: format!("{title}: Schmidt number of the eDPD fluid"),
        label: "Schmidt number".into(),
        log: true,
        target: rows.iter().map(|row| (row.temperature, row.schmidt_target)).collect(),
        points: rows
            .iter()
            .map(|row| Estimate { at: row.temperature, mean: row.schmidt, ends: row.schmidt_low.zip(row.schmidt_high) })
            .collect(),
        deviations: vec![
            kind("self-diffusivity from eq 13", |row| {
                deviation(
                    row.temperature,
                    row.diffusivity,
                    row.diffusivity_low.zip(row.diffusivity_high),
                    row.diffusivity_theory,
                )
            }),
            kind("viscosity from eq 12", |row| {
                deviation(
                    row.temperature,
                    row.viscosity,
                    row.viscosity_low.zip(row.viscosity_high),
                    row.viscosity_theory,
                )
            }),
            kind("Schmidt number from target", |row| {
                deviation(row.temperature, row.schmidt, row.schmidt_low.zip(row.schmidt_high), row.schmidt_target)
            }),
        ],
    })
}

fn prandtl(title: &str, rows: &[Row]) -> frazil_plots::canvas::Canvas {
    let known = || {
        rows.iter().filter_map(|row| {
            let ends = row.prandtl_low.zip(row.prandtl_high);
            Some((row, Estimate { at: row.temperature, mean: row.prandtl?, ends }, row.prandtl_target?))
        })
    };
    let heat = |row: &Row| {
        let ends = row.thermal_diffusivity_low.zip(row.thermal_diffusivity_high);
        Some(deviation(row.temperature, row.thermal_diffusivity?, ends, row.thermal_diffusivity_theory?))
    };
    numbers(&NumberFigure {
        title: format!("{title}: Prandtl number of the eDPD fluid"),
        label: "Prandtl number".into(),
        log: false,
        target: known().map(|(row, _, target)| (row.temperature, target)).collect(),
        points: known().map(|(_, estimate, _)| estimate).collect(),
        deviations: vec![
            Deviations {
                label: "thermal diffusivity from eq 19".into(),
                points: known().filter_map(|(row, ..)| heat(row)).collect(),
            },
            Deviations {
                label: "Prandtl number from target".into(),
                points: known().map(|(_, own, target)| deviation(own.at, own.mean, own.ends, target)).collect(),
            },
        ],
    })
}
