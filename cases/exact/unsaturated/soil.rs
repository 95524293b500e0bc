//! Soils of the exact solutions: how much water they hold at a pressure head, and how well they conduct it.

use super::graded::{Panel, Rule, panels};
use super::{Unsolvable, require, require_soil};

/// How the effective saturation follows from the pressure head `h` (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Retention {
    /// `Se = [1 + (alpha |h|)^n]^-m`, `m = 1 - 1/n` (van Genuchten 1980).
    VanGenuchten {
        /// Inverse of a head (1/m).
        alpha: f64,
        /// Exponent, above one.
        n: f64,
    },
    /// `Se = (alpha |h|)^-lambda` below air entry at `|h| = 1/alpha`, and one above (Brooks and Corey 1964).
    BrooksCorey {
        /// Inverse of the head of air entry (1/m).
        alpha: f64,
        /// Exponent, above zero.
        lambda: f64,
    },
}

/// A soil whose conductivity follows from its retention by Mualem's integral.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Soil {
    retention: Retention,
    /// Exponent of the saturation in front of Mualem's integral.
    tortuosity: f64,
    residual: f64,
    saturated: f64,
    conductivity: f64,
}

/// How water and Kirchhoff's potential grow along a coordinate, at one point of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Growth {
    /// Derivative of the effective saturation.
    pub(super) saturation: f64,
    /// Derivative of the potential (m2/s).
    pub(super) potential: f64,
}

impl Soil {
    /// A soil with Mualem's own exponent 1/2. Water contents are shares of the volume, the conductivity is that of the
    /// saturated soil (m/s).
    ///
    /// # Errors
    ///
    /// If a number is out of its range.
    pub fn new(retention: Retention, residual: f64, saturated: f64, conductivity: f64) -> Result<Self, Unsolvable> {
        Soil { retention, tortuosity: 0.5, residual, saturated, conductivity }.checked()
    }

    /// The same soil with another exponent of the saturation in front of Mualem's integral; with one, a soil of Brooks and
    /// Corey conducts by Burdine's formula.
    ///
    /// # Errors
    ///
    /// If it is negative.
    pub fn with_tortuosity(self, tortuosity: f64) -> Result<Self, Unsolvable> {
        Soil { tortuosity, ..self }.checked()
    }

    fn checked(self) -> Result<Self, Unsolvable> {
        match self.retention {
            Retention::VanGenuchten { alpha, n } => {
                require(alpha > 0.0, "alpha", alpha, "above 0 /m")?;
                require(n > 1.0, "n", n, "above 1")?;
            }
            Retention::BrooksCorey { alpha, lambda } => {
                require(alpha > 0.0, "alpha", alpha, "above 0 /m")?;
                require(lambda > 0.0, "lambda", lambda, "above 0")?;
            }
        }
        require(self.tortuosity >= 0.0, "the exponent of the tortuosity", self.tortuosity, "at least 0")?;
        require_soil(self.residual, self.saturated, self.conductivity)?;
        Ok(self)
    }

    /// Water between the residual and the saturated content, as a share of the volume.
    pub fn range(&self) -> f64 {
        self.saturated - self.residual
    }

    /// Water content, as a share of the volume, at an effective saturation.
    pub fn water_content(&self, saturation: f64) -> f64 {
        self.residual + self.range() * saturation
    }

    /// Conductivity of the saturated soil (m/s).
    pub fn saturated_conductivity(&self) -> f64 {
        self.conductivity
    }

    /// Effective saturation at a pressure head (m).
    pub fn saturation(&self, head: f64) -> f64 {
        let suction = (-head).max(0.0);
        match self.retention {
            Retention::VanGenuchten { alpha, n } => (1.0 + (alpha * suction).powf(n)).powf(1.0 / n - 1.0),
            Retention::BrooksCorey { alpha, lambda } => (alpha * suction).max(1.0).powf(-lambda),
        }
    }

    /// Greatest pressure head (m) at which water still leaves the soil: that of air entry, or zero.
    pub fn air_entry(&self) -> f64 {
        match self.retention {
            Retention::VanGenuchten { .. } => 0.0,
            Retention::BrooksCorey { alpha, .. } => -1.0 / alpha,
        }
    }

    /// Pressure head (m) at an effective saturation; where the soil is saturated, that of air entry.
    pub fn head(&self, saturation: f64) -> f64 {
        match self.retention {
            Retention::VanGenuchten { alpha, n } => {
                let filled = saturation.powf(n / (n - 1.0));
                -((1.0 - filled) / filled).powf(1.0 / n) / alpha
            }
            Retention::BrooksCorey { alpha, lambda } => -saturation.powf(-1.0 / lambda) / alpha,
        }
    }

    /// Conductivity (m/s) at an effective saturation.
    pub fn conductivity(&self, saturation: f64) -> f64 {
        let integral = match self.retention {
            Retention::VanGenuchten { n, .. } => {
                let m = 1.0 - 1.0 / n;
                mualem(saturation.powf(1.0 / m), m)
            }
            Retention::BrooksCorey { lambda, .. } => saturation.powf(1.0 + 1.0 / lambda),
        };
        self.conductivity * saturation.powf(self.tortuosity) * integral * integral
    }

    /// Kirchhoff's potential (m2/s) at an effective saturation: the integral of the conductivity over the head.
    pub fn potential(&self, saturation: f64) -> f64 {
        let rule = Rule::new();
        let whole = |panel: &Panel| rule.total(&panel.growth(self, &rule).map(|growth| growth.potential));
        panels(self, 0.0, saturation).iter().map(whole).sum()
    }

    /// Growth of the potential with the saturation (m2/s): conductivity over capacity. Has no value at one where the capacity
    /// vanishes there.
    pub(super) fn along_saturation(&self, saturation: f64) -> Growth {
        let potential = match self.retention {
            Retention::VanGenuchten { alpha, n } => {
                let m = 1.0 - 1.0 / n;
                let filled = saturation.powf(1.0 / m);
                if filled < f64::MIN_POSITIVE {
                    return Growth { saturation: 1.0, potential: 0.0 };
                }
                let integral = mualem(filled, m);
                let shape = integral * (integral / filled) * (1.0 - filled).powf(-m);
                self.conductivity / alpha * (1.0 - m) / m * saturation.powf(self.tortuosity) * shape
            }
            Retention::BrooksCorey { alpha, lambda } => {
                self.conductivity / (alpha * lambda) * saturation.powf(self.tortuosity + 1.0 + 1.0 / lambda)
            }
        };
        Growth { saturation: 1.0, potential }
    }

    /// How dry the soil is, by a coordinate that is zero at saturation and in which the potential has no singularity there.
    pub(super) fn dryness(&self, saturation: f64) -> f64 {
        match self.retention {
            Retention::VanGenuchten { n, .. } => (-f64::exp_m1(saturation.ln() * n / (n - 1.0))).max(0.0).powf(1.0 / n),
            Retention::BrooksCorey { .. } => 1.0 - saturation,
        }
    }

    /// Effective saturation at a dryness.
    pub(super) fn saturation_at(&self, dryness: f64) -> f64 {
        match self.retention {
            Retention::VanGenuchten { n, .. } => filled(dryness, n).powf(1.0 - 1.0 / n),
            Retention::BrooksCorey { .. } => 1.0 - dryness,
        }
    }

    /// Growths with the dryness.
    pub(super) fn along_dryness(&self, dryness: f64) -> Growth {
        match self.retention {
            Retention::VanGenuchten { alpha, n } => {
                let m = 1.0 - 1.0 / n;
                let filled = filled(dryness, n);
                let drained = dryness.powf(n - 1.0);
                let integral = if dryness > 0.0 { -f64::exp_m1((n - 1.0) * dryness.ln()) } else { 1.0 };
                let powers = filled.powf(m * (self.tortuosity + 1.0) - 2.0);
                Growth {
                    saturation: -(n - 1.0) * drained * filled.powf(m - 1.0),
                    potential: -self.conductivity / alpha * powers * integral * integral,
                }
            }
            Retention::BrooksCorey { .. } => {
                let growth = self.along_saturation(1.0 - dryness);
                Growth { saturation: -1.0, potential: -growth.potential }
            }
        }
    }
}

/// The saturation to the power of `1/m` at a dryness.
fn filled(dryness: f64, n: f64) -> f64 {
    if dryness > 0.0 { -f64::exp_m1(n * dryness.ln()) } else { 1.0 }
}

/// Mualem's integral, `1 - (1 - filled)^m`, without cancellation in dry soil.
fn mualem(filled: f64, m: f64) -> f64 {
    if filled < 1.0 { -f64::exp_m1(m * f64::ln_1p(-filled)) } else { 1.0 }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Seconds of a day.
    pub(crate) const DAY: f64 = 86_400.0;

    /// The soil of Yan et al. 2020.
    pub(crate) fn yan() -> Soil {
        Soil::new(Retention::VanGenuchten { alpha: 1.0, n: 1.53 }, 0.186, 0.363, 1e-9).expect("a soil")
    }

    #[test]
    fn potential_at_saturation_is_the_published_one() {
        let found = yan().potential(1.0) * 1e4 * DAY;
        assert!((found - 0.203_765).abs() < 5e-7, "{found} cm2/day");
    }

    #[test]
    fn potential_is_the_integral_of_conductivity_over_head() {
        let retentions = [
            Retention::VanGenuchten { alpha: 0.1, n: 1.1 },
            Retention::VanGenuchten { alpha: 10.0, n: 3.0 },
            Retention::BrooksCorey { alpha: 2.0, lambda: 0.7 },
        ];
        for retention in retentions {
            let soil = Soil::new(retention, 0.05, 0.4, 1e-6).expect("a soil");
            let (dry, wet) = (soil.head(0.5), soil.head(0.9));
            // Simpson's rule in the logarithm of the suction.
            let steps = 2000;
            let width = (wet / dry).ln() / f64::from(steps);
            let sum: f64 = (0..=steps)
                .map(|step| {
                    let head = dry * (width * f64::from(step)).exp();
                    let weight = if step == 0 || step == steps { 1.0 } else { 2.0 + 2.0 * f64::from(step % 2) };
                    weight * soil.conductivity(soil.saturation(head)) * head
                })
                .sum();
            let (expected, found) = (sum * width / 3.0, soil.potential(0.9) - soil.potential(0.5));
            assert!((found / expected - 1.0).abs() < 1e-9, "{retention:?}: {found} against {expected}");
        }
    }

    #[test]
    fn potential_of_brooks_and_corey_is_a_power() {
        let soil = Soil::new(Retention::BrooksCorey { alpha: 2.0, lambda: 0.7 }, 0.05, 0.4, 1e-6).expect("a soil");
        let power = 2.5 + 1.0 / 0.7;
        for saturation in [1e-3, 0.3, 1.0_f64] {
            let expected = 1e-6 / (2.0 * 0.7) * saturation.powf(power) / power;
            assert!((soil.potential(saturation) / expected - 1.0).abs() < 1e-12, "{saturation}");
        }
    }

    #[test]
    fn heads_and_saturations_are_inverse() {
        for retention in
            [Retention::VanGenuchten { alpha: 3.0, n: 1.4 }, Retention::BrooksCorey { alpha: 3.0, lambda: 0.4 }]
        {
            let soil = Soil::new(retention, 0.0, 0.4, 1e-6).expect("a soil");
            for saturation in [0.01, 0.4, 0.99, 1.0] {
                assert!((soil.saturation(soil.head(saturation)) - saturation).abs() < 1e-12, "{saturation}");
            }
            for saturation in [0.4, 0.99, 1.0] {
                let there = soil.saturation_at(soil.dryness(saturation));
                assert!((there - saturation).abs() < 1e-12, "{saturation}");
            }
            assert_eq!(soil.saturation(1.0), 1.0);
            assert_eq!(soil.saturation(soil.air_entry()), 1.0);
            assert_eq!(soil.conductivity(1.0), soil.saturated_conductivity());
            assert_eq!(soil.water_content(1.0), 0.4);
        }
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let error =
            Soil::new(Retention::VanGenuchten { alpha: 1.0, n: 0.9 }, 0.1, 0.4, 1e-6).expect_err("no such soil");
        assert_eq!(error.to_string(), "n is 0.9, it must be above 1");
        assert!(Soil::new(Retention::VanGenuchten { alpha: 1.0, n: 2.0 }, 0.4, 0.4, 1e-6).is_err());
        assert!(yan().with_tortuosity(-1.0).is_err());
    }
}
