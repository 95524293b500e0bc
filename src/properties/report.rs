//! The answer of the command.

use std::path::Path;

use super::execute::Finding;
use super::plan::Job;
use super::request::PropertiesRequest;
use super::tables::Row;
use crate::calibrate::Calibrated;

/// A number over a reference, with half of its interval, in per cent of the reference.
fn share(value: Option<f64>, low: Option<f64>, high: Option<f64>, reference: Option<f64>) -> String {
    let Some((value, reference)) = value.zip(reference) else { return "-".into() };
    let half = low.zip(high).map_or(String::new(), |(low, high)| format!(" ±{:.1}", 50.0 * (high - low) / reference));
    format!("{:+.1}{half}", 100.0 * (value / reference - 1.0))
}

/// The table, and what it comes to.
pub fn report(
    request: &PropertiesRequest,
    calibrated: &Calibrated<'_>,
    rows: &[Row],
    jobs: &[Job],
    found: &[Finding],
    folder: &Path,
) -> String {
    let fluid = &calibrated.fluid;
    let mut text = format!("{}: {}; {} seeds, step {}\n", fluid.name, fluid.title, request.seeds, request.step);
    for word in ["diffusivity", "viscosity", "thermal_diffusivity"] {
        let mut own = jobs.iter().filter(|job| job.measurement.word() == word);
        let Some(job) = own.next() else { continue };
        let (least, most) = own.fold((job.span.settle, job.span.settle), |(least, most), job| {
            (least.min(job.span.settle), most.max(job.span.settle))
        });
        let settle = if least == most { least.to_string() } else { format!("{least} to {most}") };
        text.push_str(&format!(
            "  {word:<20} {:.2} x {:.2}, {} particles, {settle} steps to settle, {} watched\n",
            job.lengths[0],
            job.lengths[1],
            job.particles(),
            job.span.watch
        ));
    }
    text.push_str("\n  deviations in %, ± half of the 95 % interval: of diffusivities from theory (eqs 13, 12, 19), of Sc and Pr from the fluid's\n\n");
    let head = ["T (°C)", "T", "s", "D", "nu", "alpha", "Sc", "Sc", "Pr", "Pr"];
    let widths = [7, 8, 8, 13, 13, 13, 10, 14, 8, 13];
    let line = |cells: &[String]| {
        let cells: String = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        format!(" {cells}\n")
    };
    text.push_str(&line(&head.map(str::to_owned)));
    for row in rows {
        text.push_str(&line(&[
            format!("{}", row.temperature_c),
            format!("{:.4}", row.temperature),
            format!("{:.4}", row.exponent),
            share(Some(row.diffusivity), row.diffusivity_low, row.diffusivity_high, Some(row.diffusivity_theory)),
            share(Some(row.viscosity), row.viscosity_low, row.viscosity_high, Some(row.viscosity_theory)),
            share(
                row.thermal_diffusivity,
                row.thermal_diffusivity_low,
                row.thermal_diffusivity_high,
                row.thermal_diffusivity_theory,
            ),
            format!("{:.1}", row.schmidt),
            share(Some(row.schmidt), row.schmidt_low, row.schmidt_high, Some(row.schmidt_target)),
            row.prandtl.map_or("-".into(), |prandtl| format!("{prandtl:.3}")),
            share(row.prandtl, row.prandtl_low, row.prandtl_high, row.prandtl_target),
        ]));
    }
    text.push('\n');
    let off: Vec<f64> = rows.iter().map(|row| (row.schmidt / row.schmidt_target - 1.0).abs()).collect();
    text.push_str(&mean_and_worst("Sc", &off));
    let pairs = rows.iter().filter_map(|row| row.prandtl.zip(row.prandtl_target));
    let off: Vec<f64> = pairs.map(|(own, target)| (own / target - 1.0).abs()).collect();
    text.push_str(&mean_and_worst("Pr", &off));
    let scatters = |value: fn(&Row) -> Option<f64>| -> Vec<f64> { rows.iter().filter_map(value).collect() };
    for (name, scatters) in [("Sc", scatters(|row| row.schmidt_scatter)), ("Pr", scatters(|row| row.prandtl_scatter))] {
        if let Some(least) = scatters.iter().copied().reduce(f64::min) {
            let most = scatters.iter().copied().fold(0.0, f64::max);
            text.push_str(&format!(
                "  scatter       standard deviation of {name} over seeds {:.1} to {:.1} % of its mean\n",
                100.0 * least,
                100.0 * most
            ));
        }
    }
    let warming = jobs.iter().zip(found).map(|(job, found)| found.temperature / job.row.temperature - 1.0);
    let warming = warming.fold(0.0, |most: f64, own| if own.abs() > most.abs() { own } else { most });
    text.push_str(&format!("  temperature   changed by at most {:+.4} % during a measurement\n", 100.0 * warming));
    text.push_str(&format!("\n  results       {}\n", folder.display()));
    text
}

fn mean_and_worst(name: &str, off: &[f64]) -> String {
    if off.is_empty() {
        return String::new();
    }
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    let worst = off.iter().copied().fold(0.0, f64::max);
    format!(
        "  {name}            off by {:.1} % on average over {} temperatures, by {:.1} % at most\n",
        100.0 * mean,
        off.len(),
        100.0 * worst
    )
}
