//! The steady wall of one ring in closed form, for a check on numbers: the image of a straight row of pipes under the
//! logarithm of the radius.
//!
//! With `s = ln(r/R)`, `T = A/2 ln(2 (cosh n s - cos n th)) + B s + C` is harmonic. Its constants follow from the freezing
//! point at the inner and outer front and the pipes' temperature on their walls; a pipe takes `2 pi k A`.

use std::f64::consts::{PI, TAU};

/// A ring and its fronts.
#[derive(Debug, Clone, Copy)]
pub struct SteadyRing {
    /// Pipes.
    pub count: usize,
    /// Radius of the ring (m).
    pub ring_radius: f64,
    /// Radius of a pipe (m).
    pub pipe_radius: f64,
    /// Temperature of the pipes above that of freezing (K): below 0.
    pub pipe: f64,
    /// Fronts (m from the centre).
    pub fronts: (f64, f64),
    /// Conductivity of frozen ground (W/mK).
    pub conductivity: f64,
}

impl SteadyRing {
    /// Mean temperature of the wall above that of freezing (K) and heat taken by a pipe (W/m); none where fronts do not
    /// enclose the ring.
    pub fn mean_and_heat(&self) -> Option<(f64, f64)> {
        let (inner, outer) = self.fronts;
        if !(inner > 0.0 && inner < self.ring_radius && outer > self.ring_radius) {
            return None;
        }
        let n = self.count as f64;
        let (outward, inward) = ((outer / self.ring_radius).ln(), (self.ring_radius / inner).ln());
        // The logarithm of the cosh is n |s| at the fronts, but for exp(-n |s|).
        let row = |s: f64, angle: f64| 0.5 * (2.0 * ((n * s).cosh() - (n * angle).cos())).ln();
        let far = |s: f64| 0.5 * (n * s.abs() + (1.0 + (-2.0 * n * s.abs()).exp()).ln());
        // A far(outward) + B outward + C = 0, A far(inward) - B inward + C = 0, A ln(n r0/R) + C = pipe.
        let near = (n * self.pipe_radius / self.ring_radius).ln();
        let (a1, a2) = (far(outward) - near, far(inward) - near);
        let a = -self.pipe * (outward + inward) / (a1 * inward + a2 * outward);
        let b = (-self.pipe - a * a1) / outward;
        let c = self.pipe - a * near;
        // Means over the angle between two planes, and over the area.
        let (mut sum, mut area) = (0.0, 0.0);
        let (radii, angles) = (400, 64);
        for i in 0..radii {
            let radius = inner + (outer - inner) * (f64::from(i) + 0.5) / f64::from(radii);
            let s = (radius / self.ring_radius).ln();
            for j in 0..angles {
                let angle = PI / n * (f64::from(j) + 0.5) / f64::from(angles);
                let temperature = (a * row(s, angle) + b * s + c).max(self.pipe);
                if temperature < 0.0 {
                    sum += radius * temperature;
                    area += radius;
                }
            }
        }
        (area > 0.0).then(|| (sum / area, TAU * self.conductivity * a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fronts of the numerical solution and the closed form beside it, sand, 26 pipes of 54 mm on 5 m at -20 degC: as found
    /// by an independent program (day 60: fronts 3.72 and 6.03 m, mean -7.12 K, 75.6 W/m).
    #[test]
    fn the_ring_is_that_of_an_independent_program() {
        let ring = SteadyRing {
            count: 26,
            ring_radius: 5.0,
            pipe_radius: 0.054,
            pipe: -20.0,
            fronts: (3.725, 6.033),
            conductivity: 2.56,
        };
        let (mean, heat) = ring.mean_and_heat().expect("a wall");
        assert!((mean + 7.12).abs() < 0.03, "{mean}");
        assert!((heat - 75.6).abs() < 0.5, "{heat}");
        assert_eq!(SteadyRing { fronts: (5.1, 6.0), ..ring }.mean_and_heat(), None);
    }
}
