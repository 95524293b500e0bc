//! Smoothing kernels: `-W'(r) / r`, all that conduction needs, and `W` itself for the checks.

use std::f64::consts::PI;

/// A smoothing kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// Cubic spline, support 2 h.
    CubicSpline,
    /// Quintic spline, support 3 h.
    QuinticSpline,
    /// Wendland C2, support 2 h.
    WendlandC2,
    /// Wendland C4, support 2 h.
    WendlandC4,
}

impl Kernel {
    /// All kernels by the words of scene files.
    pub const CHOICES: [(&'static str, Kernel); 4] = [
        ("cubic-spline", Kernel::CubicSpline),
        ("quintic-spline", Kernel::QuinticSpline),
        ("wendland-c2", Kernel::WendlandC2),
        ("wendland-c4", Kernel::WendlandC4),
    ];

    /// Support in smoothing lengths.
    pub fn support(self) -> f64 {
        match self {
            Kernel::QuinticSpline => 3.0,
            Kernel::CubicSpline | Kernel::WendlandC2 | Kernel::WendlandC4 => 2.0,
        }
    }

    /// Normalisation of `W` for a smoothing length of one.
    fn normalisation(self, dimension: usize) -> f64 {
        match (self, dimension) {
            (Kernel::CubicSpline, 1) => 2.0 / 3.0,
            (Kernel::CubicSpline, _) => 10.0 / (7.0 * PI),
            (Kernel::QuinticSpline, 1) => 1.0 / 120.0,
            (Kernel::QuinticSpline, _) => 7.0 / (478.0 * PI),
            (Kernel::WendlandC2, 1) => 5.0 / 8.0,
            (Kernel::WendlandC2, _) => 7.0 / (4.0 * PI),
            (Kernel::WendlandC4, 1) => 3.0 / 4.0,
            (Kernel::WendlandC4, _) => 9.0 / (4.0 * PI),
        }
    }

    /// `-W'(q) / q` for a smoothing length of one: finite at the origin, never negative.
    pub fn falling_slope_over_distance(self, q: f64, dimension: usize) -> f64 {
        if q >= self.support() {
            return 0.0;
        }
        let rest = 1.0 - 0.5 * q;
        let shape = match (self, dimension) {
            (Kernel::CubicSpline, _) if q < 1.0 => 3.0 - 2.25 * q,
            (Kernel::CubicSpline, _) => 0.75 * (2.0 - q).powi(2) / q,
            (Kernel::QuinticSpline, _) => {
                let power = |edge: f64| (edge - q).max(0.0).powi(4);
                if q < 1e-6 { 120.0 } else { (5.0 * power(3.0) - 30.0 * power(2.0) + 75.0 * power(1.0)) / q }
            }
            (Kernel::WendlandC2, 1) => 3.0 * rest.powi(2),
            (Kernel::WendlandC2, _) => 5.0 * rest.powi(3),
            (Kernel::WendlandC4, 1) => rest.powi(4) * (7.0 * q + 3.5),
            (Kernel::WendlandC4, _) => rest.powi(5) * (35.0 * q + 14.0) / 3.0,
        };
        self.normalisation(dimension) * shape
    }

    /// The kernel itself for a smoothing length of one.
    #[cfg(test)]
    fn value(self, q: f64, dimension: usize) -> f64 {
        let rest = (1.0 - 0.5 * q).max(0.0);
        let shape = match (self, dimension) {
            (Kernel::CubicSpline, _) if q < 1.0 => 1.0 - 1.5 * q * q + 0.75 * q.powi(3),
            (Kernel::CubicSpline, _) => 0.25 * (2.0 - q).max(0.0).powi(3),
            (Kernel::QuinticSpline, _) => {
                let power = |edge: f64| (edge - q).max(0.0).powi(5);
                power(3.0) - 6.0 * power(2.0) + 15.0 * power(1.0)
            }
            (Kernel::WendlandC2, 1) => rest.powi(3) * (1.5 * q + 1.0),
            (Kernel::WendlandC2, _) => rest.powi(4) * (2.0 * q + 1.0),
            (Kernel::WendlandC4, 1) => rest.powi(5) * (2.0 * q * q + 2.5 * q + 1.0),
            (Kernel::WendlandC4, _) => rest.powi(6) * (35.0 / 12.0 * q * q + 3.0 * q + 1.0),
        };
        self.normalisation(dimension) * shape
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_integrate_to_one_and_their_slopes_are_derivatives() {
        for (name, kernel) in Kernel::CHOICES {
            for dimension in [1, 2] {
                let count = 20_000;
                let step = kernel.support() / count as f64;
                let mut integral = 0.0;
                for k in 0..count {
                    let q = (k as f64 + 0.5) * step;
                    let shell = if dimension == 1 { 2.0 } else { 2.0 * PI * q };
                    integral += kernel.value(q, dimension) * shell * step;
                    let h = 1e-5;
                    if q > h && q < kernel.support() - h {
                        let slope = (kernel.value(q + h, dimension) - kernel.value(q - h, dimension)) / (2.0 * h);
                        let found = kernel.falling_slope_over_distance(q, dimension);
                        // Central differences: truncation and rounding of order 1e-9.
                        assert!((found * q + slope).abs() < 1e-7, "{name} {dimension}D at {q}: {found} {slope}");
                        assert!(found >= 0.0);
                    }
                }
                // Midpoint rule of 20 000 points.
                assert!((integral - 1.0).abs() < 1e-7, "{name} {dimension}D: {integral}");
            }
        }
    }
}
