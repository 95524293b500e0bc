//! Self-diffusivity from the mean square displacement (Ng et al. 2017, eqs 16 and 17).

use frazil_core::statistics::order::line;

use super::{GoOn, Span, advance};
use crate::fluid::{Fluid, FluidError, Undriven};

/// Instants of a measurement but the first.
pub const INSTANTS: usize = 100;

/// Least and greatest lag whose displacements the slope is fitted to, over the time that is watched. Earlier the fluid
/// remembers, and in the plane momentum still spreads through the box; later there are few beginnings to average over.
pub const LATE: (f64, f64) = (0.2, 0.5);

/// How particles spread.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffusion {
    /// Lag, and mean square displacement within it, over all particles and beginnings.
    pub curve: Vec<(f64, f64)>,
    /// Self-diffusivity: the slope of the late part over twice the dimension.
    pub diffusivity: f64,
}

/// Measures a fluid; `None` if it was told to stop.
///
/// Every instant is the beginning of as many displacements as follow it: the mean over beginnings has less noise than
/// displacements from one alone, at no cost in steps.
///
/// # Errors
/// Those of the fluid's steps.
pub fn measure<const D: usize>(
    fluid: &mut Fluid<D>,
    span: Span,
    watch: GoOn<'_>,
) -> Result<Option<Diffusion>, FluidError> {
    if !advance(fluid, span.settle, &Undriven, watch)? {
        return Ok(None);
    }
    let every = (span.watch / INSTANTS as u64).max(1);
    let mut instants = vec![unwrapped(fluid)];
    for _ in 0..INSTANTS {
        if !advance(fluid, every, &Undriven, watch)? {
            return Ok(None);
        }
        instants.push(unwrapped(fluid));
    }
    let apart = every as f64 * fluid.parameters().step;
    let curve: Vec<(f64, f64)> =
        (1..=INSTANTS / 2).map(|lag| (lag as f64 * apart, displacement(&instants, lag))).collect();
    let late = |lag: f64| lag >= LATE.0 * INSTANTS as f64 * apart * (1.0 - 1e-9);
    let (lags, squares): (Vec<f64>, Vec<f64>) = curve.iter().copied().filter(|point| late(point.0)).unzip();
    let slope = line(&lags, &squares).ok_or(FluidError::NoNumbers)?.slope;
    Ok(Some(Diffusion { diffusivity: slope / (2.0 * D as f64), curve }))
}

/// Places by name, as if the box had no sides.
fn unwrapped<const D: usize>(fluid: &Fluid<D>) -> Vec<[f64; D]> {
    let mut places = vec![[0.0; D]; fluid.particles().len()];
    for particle in fluid.particles() {
        for axis in 0..D {
            places[particle.name as usize][axis] =
                particle.position[axis] + f64::from(particle.turns[axis]) * fluid.lengths()[axis];
        }
    }
    places
}

/// Mean square of how far particles move in a number of instants, over all beginnings.
fn displacement<const D: usize>(instants: &[Vec<[f64; D]>], lag: usize) -> f64 {
    let mut sum = 0.0;
    for (from, to) in instants.iter().zip(&instants[lag..]) {
        for (a, b) in from.iter().zip(to) {
            for axis in 0..D {
                sum += (b[axis] - a[axis]).powi(2);
            }
        }
    }
    sum / ((instants.len() - lag) * instants[0].len()) as f64
}
