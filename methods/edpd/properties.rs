//! What a fluid of moving particles is like, measured: how particles spread, how it flows, how it conducts.
//!
//! All in DPD units, in the plane. Measurements are those of Ng et al. 2017, sections 3.1 and 3.2: mean square displacement,
//! periodic Poiseuille flow (Backer et al. 2005) and periodic heat conduction. Each takes a fluid at the temperature of
//! interest, lets it settle, and watches it for a number of steps.

pub mod diffusion;
pub mod equilibrium;
pub mod halves;
pub mod verlet;

use crate::fluid::{Drive, Fluid, FluidError};

/// Steps of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// Steps before anything is measured.
    pub settle: u64,
    /// Steps that are watched.
    pub watch: u64,
}

/// Told of steps as they are made; says whether to go on.
pub type GoOn<'a> = &'a dyn Fn(u64) -> bool;

/// Steps between two looks at whether to go on.
const CHUNK: u64 = 50;

/// Makes steps; false if it was told not to go on.
fn advance<const D: usize>(
    fluid: &mut Fluid<D>,
    steps: u64,
    drive: &impl Drive<D>,
    watch: GoOn<'_>,
) -> Result<bool, FluidError> {
    let mut left = steps;
    while left > 0 {
        let now = left.min(CHUNK);
        fluid.advance(now, drive)?;
        left -= now;
        if !watch(now) {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests;
