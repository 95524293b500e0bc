//! Freezing around a line that takes heat at a constant rate (Paterson 1952; Nikolaev et al. 2023 compare with it).
//!
//! Not the problem of a pipe with a constant flux through its wall: the line must first freeze the ground where the pipe
//! is, and what passes the pipe's radius comes up to the rate only later.

use frazil_core::physics::material::Material;

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// The exponential integral E1 of a small positive number, by its series.
fn exponential_integral(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, -EULER - x.ln());
    for k in 1..200 {
        term *= -x / f64::from(k);
        sum -= term / f64::from(k);
        if term.abs() < 1e-18 {
            break;
        }
    }
    sum
}

/// The front around a line sink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSink {
    /// Half the radius of the front over the root of diffusivity times time.
    pub constant: f64,
    /// Of frozen ground (m2/s).
    diffusivity: f64,
    freezing_point: f64,
    /// Heat that the line takes over `4 pi` times the conductivity of frozen ground (K).
    depth: f64,
}

impl LineSink {
    /// The front around a line that takes `power` (W/m) from ground at `initial` (C), which freezes sharply.
    pub fn new(material: &Material, initial: f64, power: f64) -> Self {
        let diffusivity = |phase: &frazil_core::physics::material::Phase| {
            phase.conductivity / (material.density * phase.heat_capacity)
        };
        let (frozen, unfrozen) = (diffusivity(&material.frozen), diffusivity(&material.unfrozen));
        let warmth = initial - material.freezing_point;
        // Heat that is taken at the front, less what comes from outside and what freezing gives.
        let excess = |constant: f64| {
            let square = constant * constant;
            let outside = square * frozen / unfrozen;
            power / (4.0 * std::f64::consts::PI) * (-square).exp()
                - material.unfrozen.conductivity * warmth * (-outside).exp() / exponential_integral(outside)
                - square * frozen * material.density * material.latent_heat
        };
        // It falls with the front: more heat comes from outside, more ice is made, less arrives.
        let (mut low, mut high) = (1e-8, 2.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 { low = middle } else { high = middle }
        }
        let depth = power / (4.0 * std::f64::consts::PI * material.frozen.conductivity);
        LineSink { constant: 0.5 * (low + high), diffusivity: frozen, freezing_point: material.freezing_point, depth }
    }

    /// Radius of the front (m) at a time (s).
    pub fn front(&self, time: f64) -> f64 {
        2.0 * self.constant * (self.diffusivity * time).sqrt()
    }

    /// Temperature (C) at a radius (m) inside the front.
    pub fn frozen_temperature(&self, radius: f64, time: f64) -> f64 {
        let place = radius * radius / (4.0 * self.diffusivity * time);
        let front = self.constant * self.constant;
        self.freezing_point - self.depth * (exponential_integral(place) - exponential_integral(front))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E1(1) and E1(0.1) to the digits of Abramowitz and Stegun, table 5.1.
    #[test]
    fn the_exponential_integral_is_the_known_one() {
        assert!((exponential_integral(1.0) - 0.219_383_934_395_520).abs() < 1e-14);
        assert!((exponential_integral(0.1) - 1.822_923_958_419_391).abs() < 1e-14);
    }
}
