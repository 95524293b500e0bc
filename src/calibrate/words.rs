//! What the calibration says, and the keys that a scene can take.

use std::path::Path;

use frazil_edpd::calibration::Polynomial;

use super::Calibrated;
use super::table::{Fit, Row};

/// Inverse compressibility of water over that of an ideal gas of its molecules, to which Groot and Warren 1997 fit their
/// repulsion.
const MOLECULAR_STIFFNESS: f64 = 15.9835;

/// The answer of the command.
pub fn report(calibrated: &Calibrated<'_>, folder: &Path) -> String {
    let (request, fluid) = (calibrated.request, &calibrated.fluid);
    let constants = &request.constants;
    let mut text = format!("{}: {}", fluid.name, fluid.title);
    if let Some(source) = &fluid.source {
        text.push_str(&format!(" ({source})"));
    }
    text.push_str(&format!(
        "\n  {} dimensions, number density {}, friction {}, heat capacity {}; a temperature of 1 is {} K\n  \
         cut-offs {} (conservative), {} (dissipative), {} (thermal)\n\n",
        constants.dimension,
        constants.density,
        constants.friction,
        constants.heat_capacity,
        request.reference_temperature,
        constants.conservative_cutoff,
        constants.dissipative_cutoff,
        constants.thermal_cutoff
    ));
    text.push_str(&rows(calibrated));
    text.push('\n');
    text.push_str(&limits(calibrated));
    text.push_str(&fits(&calibrated.table.fits, calibrated.table.rows.len()));
    text.push_str(&scales(calibrated));
    text.push_str(&format!("\n  results       {}\n", folder.display()));
    text
}

fn rows(calibrated: &Calibrated<'_>) -> String {
    let fits = &calibrated.table.fits;
    let mut text = format!(
        "  {:>8} {:>8} {:>10} {:>8} {:>10} {:>9} {:>8} {:>8} {:>11}",
        "T (K)", "T", "Sc", "s", "D", "nu", "Pr", "alpha", "kappa"
    );
    for fit in fits {
        text.push_str(&format!(" {:>10} {:>8}", fit.name, "error"));
    }
    text.push('\n');
    let or_dash = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or("-".into(), text);
    for row in &calibrated.table.rows {
        text.push_str(&format!(
            "  {:>8.2} {:>8.4} {:>10.2} {:>8.4} {:>10.6} {:>9.4} {:>8} {:>8} {:>11}",
            row.temperature_k,
            row.temperature,
            row.schmidt,
            row.exponent,
            row.diffusivity,
            row.viscosity,
            or_dash(row.prandtl, &|value| format!("{value:.4}")),
            or_dash(row.thermal_diffusivity, &|value| format!("{value:.4}")),
            or_dash(row.heat_friction, &|value| format!("{value:.5e}")),
        ));
        for (exponent, schmidt) in
            [(row.exponent_quadratic, row.schmidt_quadratic), (row.exponent_cubic, row.schmidt_cubic)]
        {
            let Some(exponent) = exponent else { continue };
            let error = or_dash(schmidt, &|schmidt| format!("{:.2} %", 100.0 * (schmidt / row.schmidt - 1.0)));
            text.push_str(&format!(" {exponent:>10.4} {error:>8}"));
        }
        text.push('\n');
    }
    text
}

/// The critical cut-off, the limit of explicit steps and the repulsion.
fn limits(calibrated: &Calibrated<'_>) -> String {
    let (constants, rows) = (&calibrated.request.constants, &calibrated.table.rows);
    let critical = rows
        .iter()
        .filter_map(|row| Some((constants.critical_cutoff(row.schmidt, row.temperature)?, row)))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let mut text = String::new();
    if let Some((cutoff, row)) = critical {
        text.push_str(&format!(
            "  critical      cut-off {cutoff:.4} of friction, where s = 0 at {:.2} K: a smaller one cannot reach Sc = {}\n",
            row.temperature_k, row.schmidt
        ));
    }
    if let Some(row) = rows.iter().max_by(|a, b| a.friction_rate.total_cmp(&b.friction_rate)) {
        text.push_str(&format!(
            "  steps         greatest relaxation rate by friction {:.4} ({:.2} K): explicit steps must stay below 2 over it, \
             {:.5}\n",
            row.friction_rate,
            row.temperature_k,
            2.0 / row.friction_rate
        ));
    }
    let repulsion = constants.printed_repulsion(1.0);
    text.push_str(&format!(
        "  repulsion     75 T / rho = {repulsion} makes the fluid {:.2} times as stiff as an ideal gas (mean field); {:.5} \
         would make it {MOLECULAR_STIFFNESS} times, the value fitted by Groot and Warren\n",
        constants.stiffness(repulsion, 1.0),
        constants.repulsion(MOLECULAR_STIFFNESS, 1.0)
    ));
    text
}

fn fits(fits: &[Fit], rows: usize) -> String {
    let mut text = String::new();
    for fit in fits {
        let ((apart, at), (off, there)) = (fit.exponent_error, fit.schmidt_error);
        text.push_str(&format!(
            "  {:<13} s = {}; R2 = {:.5}; largest error {apart:+.4} of s ({at:.2} K), {} of Sc ({there:.2} K){}\n",
            fit.name,
            polynomial(&fit.polynomial),
            fit.determination,
            if off.is_finite() { format!("{:+.2} %", 100.0 * off) } else { "infinite".into() },
            if fit.negative > 0 { format!("; negative at {} of {rows} rows", fit.negative) } else { String::new() }
        ));
    }
    text
}

fn polynomial(polynomial: &Polynomial) -> String {
    let mut text = String::new();
    for (power, coefficient) in polynomial.coefficients.iter().enumerate().rev() {
        let sign = match (text.is_empty(), *coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let variable = match power {
            0 => String::new(),
            1 => " T".into(),
            _ => format!(" T^{power}"),
        };
        text.push_str(&format!("{sign}{:.5}{variable}", coefficient.abs()));
    }
    text
}

fn scales(calibrated: &Calibrated<'_>) -> String {
    let Some(scales) = &calibrated.scales else {
        return "  units         unknown, as density and heat capacity of the fluid are\n".into();
    };
    let mut text = format!(
        "  units         length {:.5e} m, mass {:.5e} kg, temperature {} K, energy {:.5e} J\n  \
         time          {:.5e} s, of that energy and mass\n",
        scales.length, scales.mass, scales.temperature, scales.energy, scales.time
    );
    let times = calibrated.table.rows.iter().filter_map(|row| Some((row.time_unit_s?, row.temperature_k)));
    let least = times.clone().min_by(|a, b| a.0.total_cmp(&b.0));
    let most = times.max_by(|a, b| a.0.total_cmp(&b.0));
    if let (Some(least), Some(most)) = (least, most) {
        let first = format!("{:.5e} s ({:.2} K)", least.0, least.1);
        let rest = if most == least { String::new() } else { format!(" to {:.5e} s ({:.2} K)", most.0, most.1) };
        text.push_str(&format!("                {first}{rest}, of viscosity and diffusion\n"));
    }
    if let Some(freezing) = &calibrated.fluid.freezing {
        text.push_str(&format!(
            "  latent heat   {:.2}, freezing at {:.6}\n",
            scales.latent_heat(freezing.latent_heat),
            freezing.temperature / scales.temperature
        ));
    }
    text
}

/// Keys for scenes in DPD units.
pub fn keys(calibrated: &Calibrated<'_>) -> String {
    let (request, fluid, table) = (calibrated.request, &calibrated.fluid, &calibrated.table);
    let constants = &request.constants;
    let mut text = format!(
        "# {}, calibrated for eDPD in {} dimensions. For scenes with units = \"dpd\"; a temperature of 1 is {} K.\n",
        fluid.title, constants.dimension, request.reference_temperature
    );
    // The same everywhere, so that of a temperature of 1 has to do.
    let thermal = |value: fn(&Row) -> Option<f64>| table.between(1.0, value);
    let thermal = thermal(|row| row.thermal_diffusivity).zip(thermal(|row| row.heat_friction));
    let freezing = calibrated.scales.as_ref().zip(fluid.freezing.as_ref());
    if let Some(((diffusivity, _), (scales, freezing))) = thermal.zip(freezing) {
        let conductivity = constants.density * constants.heat_capacity * diffusivity;
        let (rho, heat) = (constants.density, constants.heat_capacity);
        text.push_str(&format!(
            "# Conductivities are density times heat capacity times thermal diffusivity, {diffusivity:.6} at a temperature of 1.\n\
             \n[materials.{}]\ndensity = {rho}\n\
             frozen = {{ conductivity = {:.1}, heat_capacity = {heat} }}\n\
             unfrozen = {{ conductivity = {conductivity:.1}, heat_capacity = {heat} }}\n\
             freezing = {{ law = \"isothermal\", temperature = {:.6}, latent_heat = {:.2} }}\n",
            bare(&fluid.name),
            conductivity * freezing.diffusivity_ratio,
            freezing.temperature / scales.temperature,
            scales.latent_heat(freezing.latent_heat)
        ));
    }
    text.push_str(&format!(
        "\n# Particles that move. The exponent of friction by straight lines between rows of temperature and exponent.\n\
         [fluid]\ndensity = {}\nrepulsion = {}\nfriction = {}\nconservative_cutoff = {}\ndissipative_cutoff = {}\n\
         thermal_cutoff = {}\nheat_capacity = {}\n",
        constants.density,
        constants.printed_repulsion(1.0),
        constants.friction,
        constants.conservative_cutoff,
        constants.dissipative_cutoff,
        constants.thermal_cutoff,
        constants.heat_capacity
    ));
    match thermal {
        Some((_, friction)) => text.push_str(&format!("heat_friction = {friction:.6e}\n")),
        None => {
            text.push_str("# No heat_friction: neither a Prandtl number nor a thermal diffusivity is known at 1.\n")
        }
    }
    text.push_str("exponent = [\n");
    for row in &table.rows {
        // A cut-off at its critical value may round to a hair below 0.
        text.push_str(&format!("    [{:.6}, {:.6}],\n", row.temperature, row.exponent.max(0.0)));
    }
    text.push_str("]\n");
    text
}

/// A name as a key that needs no quotes.
fn bare(name: &str) -> String {
    let name: String = name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    if name.is_empty() { "fluid".into() } else { name }
}
