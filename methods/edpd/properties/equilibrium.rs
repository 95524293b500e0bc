//! Whether a fluid that is left alone keeps what it has to keep.

use frazil_core::statistics::moments;

use super::verlet::Verlet;
use super::{GoOn, advance};
use crate::fluid::{Fluid, FluidError, Totals, Undriven};

/// Steps that energy and temperatures settle for: particles start near a lattice.
pub const SETTLE: u64 = 2000;

/// Samples of the temperatures.
const SAMPLES: u64 = 1000;

/// A fluid in equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equilibrium {
    /// Mean of the kinetic temperature over that of the internal one.
    pub temperatures: f64,
    /// Standard error of it, from independent samples.
    pub temperatures_error: f64,
    /// Largest component of the total momentum that occurred.
    pub momentum: f64,
    /// Largest change of the total energy that occurred, over the kinetic energy.
    pub drift_kinetic: f64,
    /// The same over the total energy with all heat from absolute zero on.
    pub drift_total: f64,
}

fn energy<const D: usize>(totals: &Totals<D>) -> f64 {
    totals.kinetic + totals.heat + totals.potential
}

/// Watches a fluid for a number of steps; `None` if it was told to stop.
///
/// # Errors
/// Those of the fluid's steps.
pub fn measure<const D: usize>(
    fluid: &mut Fluid<D>,
    steps: u64,
    watch: GoOn<'_>,
) -> Result<Option<Equilibrium>, FluidError> {
    if !advance(fluid, SETTLE, &Undriven, watch)? {
        return Ok(None);
    }
    let start = fluid.totals();
    let count = fluid.particles().len() as f64;
    let (mut momentum, mut drift) = (0.0, 0.0);
    let mut ratios = Vec::new();
    for _ in 0..SAMPLES {
        if !advance(fluid, (steps / SAMPLES).max(1), &Undriven, watch)? {
            return Ok(None);
        }
        let totals = fluid.totals();
        ratios.push(totals.kinetic_temperature / totals.internal_temperature);
        momentum = totals.momentum.iter().fold(momentum, |most, own| f64::max(most, own.abs()));
        drift = f64::max(drift, (energy(&totals) - energy(&start)).abs());
    }
    let (mean, variance) = moments(&ratios).unwrap_or((f64::NAN, f64::NAN));
    let whole = start.kinetic + start.potential + count * fluid.parameters().heat_capacity * start.internal_temperature;
    Ok(Some(Equilibrium {
        temperatures: mean,
        temperatures_error: (variance / SAMPLES as f64).sqrt(),
        momentum,
        drift_kinetic: drift / start.kinetic,
        drift_total: drift / whole,
    }))
}

/// What the paper's integrator gains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Energy that a particle gains by time.
    pub by_time: f64,
    /// Mean of the kinetic temperature over that of the internal one.
    pub temperatures: f64,
}

/// Lets a fluid settle, and goes on with velocity Verlet for a number of steps; `None` if
/// it was told to stop.
///
/// # Errors
/// Those of the fluid's steps.
pub fn gain(fluid: &mut Fluid<2>, lambda: f64, steps: u64, watch: GoOn<'_>) -> Result<Option<Gain>, FluidError> {
    if !advance(fluid, SETTLE, &Undriven, watch)? {
        return Ok(None);
    }
    let mut explicit = Verlet::from(fluid, lambda, 1);
    // It first settles to a kinetic temperature of its own.
    let settle = steps / 5;
    let (mut start, mut temperatures) = (explicit.energy(), 0.0);
    for step in 0..settle + steps {
        if step == settle {
            start = explicit.energy();
        }
        explicit.step();
        if step >= settle {
            temperatures += explicit.temperatures() / steps as f64;
        }
        if !watch(1) {
            return Ok(None);
        }
    }
    let time = fluid.particles().len() as f64 * steps as f64 * fluid.parameters().step;
    Ok(Some(Gain { by_time: (explicit.energy() - start) / time, temperatures }))
}
