//! From the Schmidt and Prandtl numbers of a real fluid to the constants of an eDPD fluid (Ng et al. 2017, section 3).
//!
//! Everything is in DPD units: the mass of a particle, k_B and the reference temperature are 1. Friction acts with the
//! weight `w_D = (1 - r/rc)^s`, and `[f]` stands for the integral of `f` over the disc or ball of radius `rc`. Kinetic
//! theory then gives viscosity and self-diffusivity in closed form; a smaller exponent `s` is a more viscous fluid. It
//! neglects the conservative force and takes particles as independent, so it is a design formula, not a measurement.

mod fit;
mod scales;

use std::f64::consts::PI;

pub use fit::{Polynomial, least_squares};
pub use scales::{BOLTZMANN, RealFluid, Scales};

/// `[r^power (1 - r/cutoff)^exponent]` in the plane (`dimension` 2) or in space (3), exact.
///
/// Exponents must be above -1, or there is no such integral.
pub fn moment(dimension: usize, cutoff: f64, exponent: f64, power: usize) -> f64 {
    let surface = if dimension == 2 { 2.0 * PI } else { 4.0 * PI };
    // The beta function of n and exponent + 1 for a whole n.
    let n = dimension + power;
    let beta = (1..n).fold(1.0 / (exponent + n as f64), |beta, k| beta * k as f64 / (exponent + k as f64));
    surface * cutoff.powi(n as i32) * beta
}

/// What of a fluid does not depend on its temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// 2 or 3.
    pub dimension: usize,
    /// Particles by volume.
    pub density: f64,
    /// Friction coefficient of a pair, gamma.
    pub friction: f64,
    /// Cut-off radius of the conservative force.
    pub conservative_cutoff: f64,
    /// Cut-off radius of friction and random force.
    pub dissipative_cutoff: f64,
    /// Cut-off radius of the exchange of heat.
    pub thermal_cutoff: f64,
    /// Heat capacity of a particle.
    pub heat_capacity: f64,
}

/// Repulsion of a pair over temperature, times the density, for water at a cut-off of 1 in space (Groot and Warren 1997).
const REPULSION: f64 = 75.0;

impl Constants {
    /// Those of Ng et al. 2017 in the plane: density 4, friction 8, cut-offs 1.96, heat capacity 1e5.
    pub fn paper() -> Self {
        Constants {
            dimension: 2,
            density: 4.0,
            friction: 8.0,
            conservative_cutoff: 1.96,
            dissipative_cutoff: 1.96,
            thermal_cutoff: 1.96,
            heat_capacity: 1e5,
        }
    }

    /// Rate at which friction takes a particle's velocity away, `w_0 = gamma rho [w_D] / d` (eq 11). An explicit step must
    /// stay below 2 over it.
    pub fn friction_rate(&self, exponent: f64) -> f64 {
        let volume = moment(self.dimension, self.dissipative_cutoff, exponent, 0);
        self.friction * self.density * volume / self.dimension as f64
    }

    /// Self-diffusivity `T / w_0` (eqs 11, 13).
    pub fn diffusivity(&self, exponent: f64, temperature: f64) -> f64 {
        temperature / self.friction_rate(exponent)
    }

    /// Kinematic viscosity `gamma rho [r^2 w_D] / (2 d (d + 2)) + T / (2 w_0)` (eqs 10, 12).
    pub fn viscosity(&self, exponent: f64, temperature: f64) -> f64 {
        let d = self.dimension as f64;
        let spread = moment(self.dimension, self.dissipative_cutoff, exponent, 2);
        self.friction * self.density * spread / (2.0 * d * (d + 2.0)) + 0.5 * self.diffusivity(exponent, temperature)
    }

    /// Schmidt number, viscosity over self-diffusivity (eq 14). It falls with the exponent, from infinity at -1 to 1/2.
    pub fn schmidt(&self, exponent: f64, temperature: f64) -> f64 {
        self.viscosity(exponent, temperature) / self.diffusivity(exponent, temperature)
    }

    /// The exponent that gives a Schmidt number (eq 15); `None` where none does, for numbers up to 1/2. It is negative, and
    /// friction would grow towards the cut-off, where the cut-off is below the [critical one](Self::critical_cutoff).
    pub fn exponent(&self, schmidt: f64, temperature: f64) -> Option<f64> {
        let logarithm = self.logarithm(schmidt, temperature)?;
        let d = self.dimension;
        // The product of s + k, each k up to d twice and d + 1 and d + 2 once, has this logarithm. In y = ln(s + 1) the
        // left side is convex and rises with slopes from 2 to 2 d + 2, so Newton's method needs no safeguard.
        let mut y = logarithm / (2 * d + 2) as f64;
        for _ in 0..100 {
            let (mut value, mut slope) = (-logarithm, 0.0);
            for k in 1..=d + 2 {
                let (count, sum) = (if k <= d { 2.0 } else { 1.0 }, y.exp() + (k - 1) as f64);
                value += count * sum.ln();
                slope += count * y.exp() / sum;
            }
            let change = value / slope;
            y -= change;
            if change.abs() <= 1e-15 * y.abs().max(1.0) {
                break;
            }
        }
        Some(y.exp_m1())
    }

    /// Cut-off radius of friction at which a Schmidt number takes the exponent 0 (eq 15 with s = 0); larger numbers need a
    /// larger one. `None` for numbers up to 1/2.
    pub fn critical_cutoff(&self, schmidt: f64, temperature: f64) -> Option<f64> {
        let d = self.dimension;
        let product = (1..=d + 2).map(|k| if k <= d { 2.0 } else { 1.0 } * (k as f64).ln()).sum::<f64>();
        let logarithm = self.logarithm(schmidt, temperature)?;
        Some(self.dissipative_cutoff * ((product - logarithm) / (2 * d + 2) as f64).exp())
    }

    /// Logarithm of what the product of all s + k in eq 15 has to be.
    fn logarithm(&self, schmidt: f64, temperature: f64) -> Option<f64> {
        if !(schmidt > 0.5 && schmidt.is_finite() && temperature > 0.0) {
            return None;
        }
        // At s = 0 that product is known, and Sc - 1/2 is in inverse proportion to it.
        let d = self.dimension;
        let product = (1..=d + 2).map(|k| if k <= d { 2.0 } else { 1.0 } * (k as f64).ln()).sum::<f64>();
        Some(product + ((self.schmidt(0.0, temperature) - 0.5) / (schmidt - 0.5)).ln())
    }

    /// Mesoscopic heat friction `kappa = 2 d alpha / (rho C_v [r^2 w_T])` of a thermal diffusivity, with
    /// `w_T = (1 - r/rc)^2` (eqs 19, 20).
    pub fn heat_friction(&self, thermal_diffusivity: f64) -> f64 {
        thermal_diffusivity / self.thermal_diffusivity(1.0)
    }

    /// Thermal diffusivity of a mesoscopic heat friction (eq 19).
    pub fn thermal_diffusivity(&self, heat_friction: f64) -> f64 {
        let spread = moment(self.dimension, self.thermal_cutoff, 2.0, 2);
        self.density * self.heat_capacity * heat_friction * spread / (2.0 * self.dimension as f64)
    }

    /// Repulsion of a pair that the paper takes for water at this temperature, `75 T / rho`.
    pub fn printed_repulsion(&self, temperature: f64) -> f64 {
        REPULSION * temperature / self.density
    }

    /// Inverse isothermal compressibility over that of an ideal gas, `1 + rho a [r w_C] / (d T)`: the derivative of the mean-field pressure
    /// `rho T + rho^2 a [r w_C] / (2 d)`, which neglects that particles avoid each other.
    pub fn stiffness(&self, repulsion: f64, temperature: f64) -> f64 {
        let push = moment(self.dimension, self.conservative_cutoff, 1.0, 1);
        1.0 + self.density * repulsion * push / (self.dimension as f64 * temperature)
    }

    /// Repulsion of a pair that gives this [stiffness](Self::stiffness).
    pub fn repulsion(&self, stiffness: f64, temperature: f64) -> f64 {
        (stiffness - 1.0) / (self.stiffness(1.0, temperature) - 1.0)
    }
}

#[cfg(test)]
mod tests;
