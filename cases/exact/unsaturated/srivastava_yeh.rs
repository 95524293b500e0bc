//! Infiltration toward a water table in a soil whose conductivity is an exponential of the head (Srivastava and Yeh 1991).
//!
//! With `K = Ks exp(alpha h)` and a water content that is linear in it, Richards' equation is linear in `K`. Here `z` is the height
//! above the bottom, `Z = alpha z` and `T = alpha Ks t / (theta_s - theta_r)`; then `K_T = K_ZZ + K_Z`, with the head at the bottom
//! and the flux `K_Z + K` at the surface. The change since the flux has changed is a series of `sin(k Z)` with
//! `tan(k L) + 2 k = 0`, from separation; or, from Laplace's transform, the change in a column without bottom less its image
//! below the bottom, which holds to rounding until the next image is felt. The series is used from then on.

use std::f64::consts::PI;

use super::{Unsolvable, require, require_soil};
use crate::exact::functions::erfcx;

/// Estimated error of conductivity and flux over the change of flux. Image and series differ by 3e-14 where they meet.
pub const ERROR: f64 = 1e-12;

/// Natural logarithm of what counts as nothing: terms of the series, and images that are left out.
const NOTHING: f64 = 40.0;

/// Terms of the series: while it is used, `k^2 T` of the next is above [`NOTHING`].
const TERMS: usize = 14;

/// A soil whose conductivity and water content are exponentials of the pressure head (Gardner 1958).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GardnerSoil {
    /// Growth of the conductivity with the head (1/m).
    pub alpha: f64,
    /// Residual water content, a share of the volume.
    pub residual: f64,
    /// Saturated water content, a share of the volume.
    pub saturated: f64,
    /// Conductivity of the saturated soil (m/s).
    pub conductivity: f64,
}

/// A column of soil above a water table, under a flux that has changed.
#[derive(Debug, Clone, PartialEq)]
pub struct GardnerColumn {
    soil: GardnerSoil,
    /// Height over the length of capillary rise.
    height: f64,
    /// Conductivity at the bottom, over that of saturated soil.
    bottom: f64,
    /// Flux through the surface before and after, over the conductivity of saturated soil; downward is positive.
    before: f64,
    after: f64,
    /// Wave numbers of the series.
    waves: [f64; TERMS],
}

impl GardnerColumn {
    /// A column of a height (m) whose bottom is held at a pressure head (m), zero at a water table. It is in the steady state
    /// under the flux `before` (m/s, downward positive) until the time zero, when that through the surface becomes `after`.
    ///
    /// # Errors
    ///
    /// If a number is out of its range: a flux must neither saturate the soil nor take more water than reaches the surface.
    pub fn new(soil: GardnerSoil, height: f64, bottom: f64, [before, after]: [f64; 2]) -> Result<Self, Unsolvable> {
        require(soil.alpha > 0.0, "alpha", soil.alpha, "above 0 /m")?;
        require_soil(soil.residual, soil.saturated, soil.conductivity)?;
        require(height > 0.0, "the height of the column", height, "above 0 m")?;
        require(bottom <= 0.0, "the head at the bottom", bottom, "at most 0 m")?;
        let (height, bottom) = (soil.alpha * height, (soil.alpha * bottom).exp());
        for (what, flux) in [("the flux before", before), ("the flux after", after)] {
            let scaled = flux / soil.conductivity;
            let top = scaled + (bottom - scaled) * (-height).exp();
            let allowed = "at most the saturated conductivity, and so much that water is left at the surface";
            require(scaled <= 1.0 && top > 0.0, what, flux, allowed)?;
        }
        let [before, after] = [before, after].map(|flux| flux / soil.conductivity);
        let waves = std::array::from_fn(|index| wave(index + 1, height));
        Ok(GardnerColumn { soil, height, bottom, before, after, waves })
    }

    /// Effective saturation, and conductivity over that of saturated soil, at a height (m) above the bottom and a time (s).
    pub fn saturation(&self, z: f64, t: f64) -> f64 {
        let (at, time) = self.scaled(z, t);
        let steady = |flux: f64| flux + (self.bottom - flux) * (-at).exp();
        let change = self.after - self.before;
        if time == 0.0 {
            return steady(self.before);
        }
        if self.is_early(time) {
            let image = (-at).exp() * rise(self.height + at, time);
            return steady(self.before) + change * (rise(self.height - at, time) - image);
        }
        steady(self.after) - change * self.series(at, time, |wave| (wave * at).sin())
    }

    /// Pressure head (m) at a height (m) above the bottom and a time (s).
    pub fn head(&self, z: f64, t: f64) -> f64 {
        self.saturation(z, t).ln() / self.soil.alpha
    }

    /// Water content, a share of the volume, at a height (m) above the bottom and a time (s).
    pub fn water_content(&self, z: f64, t: f64) -> f64 {
        self.soil.residual + (self.soil.saturated - self.soil.residual) * self.saturation(z, t)
    }

    /// Flux (m/s, downward positive) at a height (m) above the bottom and a time (s).
    pub fn flux(&self, z: f64, t: f64) -> f64 {
        let (at, time) = self.scaled(z, t);
        let change = self.after - self.before;
        let scaled = if time == 0.0 {
            self.before
        } else if self.is_early(time) {
            let ahead = self.height - at;
            let image = (-at).exp() * slope(self.height + at, time);
            self.before + change * (rise(ahead, time) - slope(ahead, time) - image)
        } else {
            let derivative = |wave: f64| 0.5 * (wave * at).sin() + wave * (wave * at).cos();
            self.after - change * self.series(at, time, derivative)
        };
        self.soil.conductivity * scaled
    }

    /// Flux (m/s, downward positive) through the bottom at a time (s).
    pub fn bottom_flux(&self, t: f64) -> f64 {
        self.flux(0.0, t)
    }

    /// Height and time without units.
    fn scaled(&self, z: f64, t: f64) -> (f64, f64) {
        let rate = self.soil.alpha * self.soil.conductivity / (self.soil.saturated - self.soil.residual);
        ((self.soil.alpha * z).clamp(0.0, self.height), rate * t.max(0.0))
    }

    /// Whether the second image is not felt yet: it is the negative exponential of this at most.
    fn is_early(&self, time: f64) -> bool {
        self.height * self.height / time + 0.25 * time > NOTHING
    }

    /// The series of what is left of the change, with a factor for each wave number.
    fn series(&self, at: f64, time: f64, factor: impl Fn(f64) -> f64) -> f64 {
        let term = |&wave: &f64| {
            let weight = (wave * self.height).sin() / (1.0 + 0.5 * self.height + 2.0 * wave * wave * self.height);
            factor(wave) * weight * (0.5 * (self.height - at) - (0.25 + wave * wave) * time).exp()
        };
        4.0 * self.waves.iter().map(term).sum::<f64>()
    }
}

/// The positive root of `tan(k L) + 2 k = 0` of a number from one on, by Newton's method. What it is applied to is concave, so
/// from the first step on the root is approached from one side.
fn wave(number: usize, height: f64) -> f64 {
    let whole = number as f64 * PI;
    let mut phase = whole - 0.25 * PI;
    for _ in 0..50 {
        let ratio = 2.0 * phase / height;
        let step = (phase + ratio.atan() - whole) / (1.0 + 2.0 / height / (1.0 + ratio * ratio));
        phase -= step;
        if step.abs() < f64::EPSILON * whole {
            break;
        }
    }
    phase / height
}

/// Growth of the conductivity at a depth, without units, under a flux of one since a time, in a column without bottom: the inverse
/// of the transform `exp(depth / 2 - p depth) / ((p - 1/2) (p + 1/2)^2)`, `p^2 = s + 1/4`.
fn rise(depth: f64, time: f64) -> f64 {
    let (behind, spread, ahead) = parts(depth, time);
    0.5 * behind - 0.5 * (1.0 + depth + time) * ahead + spread
}

/// Derivative of [`rise`] by the depth.
fn slope(depth: f64, time: f64) -> f64 {
    let (_, spread, ahead) = parts(depth, time);
    spread - (1.0 + 0.5 * (depth + time)) * ahead
}

/// `erfc((a - T) / w)`, `sqrt(T / pi) exp(-((a - T) / w)^2)` and `exp(a) erfc((a + T) / w)`, `w = 2 sqrt(T)`, without overflow.
fn parts(depth: f64, time: f64) -> (f64, f64, f64) {
    let width = 2.0 * time.sqrt();
    let (behind, ahead) = ((depth - time) / width, (depth + time) / width);
    let decay = (-behind * behind).exp();
    (libm::erfc(behind), (time / PI).sqrt() * decay, decay * erfcx(ahead))
}

#[cfg(test)]
mod tests;
