//! A solute that steadily flowing water carries into a half space, spread by dispersion, held back by sorption and lost by decay
//! (Ogata and Banks 1961; with decay, Bear 1979 and van Genuchten 1981).

use super::{Unsolvable, require};
use crate::exact::functions::erfcx;

/// Estimated error of concentrations, over that at the wall: library error functions.
pub const ERROR: f64 = 1e-13;

/// `R C_t = D C_xx - v C_x - mu R C` in a half space without solute at first, with the concentration one at its wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoluteFront {
    /// Velocity of water in the pores (m/s).
    velocity: f64,
    /// Dispersion in the water (m2/s).
    dispersion: f64,
    /// Solute in water and on grains over that in water.
    retardation: f64,
    /// Rate of decay (1/s), in water and on grains.
    decay: f64,
}

/// Retardation `1 + rho_b Kd / theta` of linear sorption: bulk density (kg/m3), distribution coefficient (m3/kg) and water content.
pub fn retardation(bulk_density: f64, distribution_coefficient: f64, water_content: f64) -> f64 {
    1.0 + bulk_density * distribution_coefficient / water_content
}

impl SoluteFront {
    /// A solute that is neither sorbed nor decays, from the velocity of water in the pores (m/s) and the dispersion there (m2/s).
    ///
    /// # Errors
    ///
    /// If the velocity is negative or the dispersion not positive.
    pub fn new(velocity: f64, dispersion: f64) -> Result<Self, Unsolvable> {
        require(velocity >= 0.0, "the velocity", velocity, "at least 0 m/s")?;
        require(dispersion > 0.0, "the dispersion", dispersion, "above 0 m2/s")?;
        Ok(SoluteFront { velocity, dispersion, retardation: 1.0, decay: 0.0 })
    }

    /// The same with a retardation and a rate of decay (1/s) in water and on grains.
    ///
    /// # Errors
    ///
    /// If the retardation is below one or the rate negative.
    pub fn with_reactions(self, retardation: f64, decay: f64) -> Result<Self, Unsolvable> {
        require(retardation >= 1.0, "the retardation", retardation, "at least 1")?;
        require(decay >= 0.0, "the rate of decay", decay, "at least 0 /s")?;
        Ok(SoluteFront { retardation, decay, ..self })
    }

    /// Concentration over that at the wall, at a distance (m) from it and a time (s).
    pub fn concentration(&self, x: f64, t: f64) -> f64 {
        if x <= 0.0 {
            return 1.0;
        }
        if t <= 0.0 {
            return 0.0;
        }
        let lost = self.decay * self.retardation;
        let spread = self.velocity.hypot(2.0 * (lost * self.dispersion).sqrt());
        let width = 2.0 * (self.dispersion * self.retardation * t).sqrt();
        let (behind, ahead) =
            ((self.retardation * x - spread * t) / width, (self.retardation * x + spread * t) / width);
        // (v - u) x / 2 D without cancellation; and exp(u x / D) erfc(ahead) without overflow.
        let decayed = if lost > 0.0 { libm::exp(-2.0 * lost * x / (self.velocity + spread)) } else { 1.0 };
        0.5 * decayed * (libm::erfc(behind) + libm::exp(-behind * behind) * erfcx(ahead))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of Yan et al. 2020, section 4.1: water at 1 cm/s, dispersion 1 and 0.01 cm2/s.
    fn yan(dispersion: f64) -> SoluteFront {
        SoluteFront::new(1e-2, dispersion).expect("a front")
    }

    /// Dispersion (cm2/s), distance (cm), time (s) and concentration, computed with 400 digits.
    const ROWS: [(f64, f64, f64, f64); 13] = [
        (1.0, 0.1, 1.0, 0.979_042_017_963_793_1),
        (1.0, 2.5, 1.0, 0.225_608_325_612_532_52),
        (1.0, 1.0, 2.0, 0.873_063_262_493_356),
        (1.0, 8.0, 2.0, 0.002_204_394_324_321_443_7),
        (1.0, 5.0, 3.0, 0.288_055_236_395_748_06),
        (1.0, 8.0, 3.0, 0.031_192_699_933_737_39),
        (0.01, 1.0, 1.0, 0.528_070_496_371_911_3),
        (0.01, 2.5, 1.0, 1.987_544_597_561_277e-26),
        (0.01, 2.5, 2.0, 0.006_987_171_097_745_072),
        (0.01, 5.0, 2.0, 5.249_882_112_696_757e-51),
        (0.01, 2.5, 3.0, 0.981_594_515_111_523),
        (0.01, 5.0, 3.0, 2.015_017_994_538_930_6e-16),
        (0.01, 8.0, 3.0, 9.439_446_663_278_566e-93),
    ];

    #[test]
    fn columns_of_the_paper() {
        for (dispersion, x, t, expected) in ROWS {
            let found = yan(dispersion * 1e-4).concentration(x * 1e-2, t);
            assert!((found / expected - 1.0).abs() < 1e-12, "{x} cm, {t} s: {found}, must be {expected}");
        }
    }

    #[test]
    fn without_water_or_reactions_the_solute_diffuses() {
        let front = SoluteFront::new(0.0, 1e-9).expect("a front");
        let found = front.concentration(2e-3, 1e3);
        assert!((found - libm::erfc(1.0)).abs() < 1e-15, "{found}");
        assert_eq!((front.concentration(0.0, 0.0), front.concentration(1e-3, 0.0)), (1.0, 0.0));
    }

    #[test]
    fn retardation_slows_time_and_decay_ends_in_a_steady_state() {
        let slow = yan(1e-4).with_reactions(3.0, 0.0).expect("a front");
        let shared = SoluteFront::new(1e-2 / 3.0, 1e-4 / 3.0).expect("a front");
        for x in [1e-3, 1e-2, 0.05] {
            let (found, expected) = (slow.concentration(x, 5.0), shared.concentration(x, 5.0));
            assert!((found / expected - 1.0).abs() < 1e-13, "{x}: {found}");
        }
        let decaying = yan(1e-4).with_reactions(2.0, 0.3).expect("a front");
        let root = (1e-4_f64 + 4.0 * 0.3 * 2.0 * 1e-4).sqrt();
        for x in [1e-3, 1e-2, 0.05] {
            let (found, expected) = (decaying.concentration(x, 1e6), ((1e-2 - root) * x / 2e-4).exp());
            assert!((found / expected - 1.0).abs() < 1e-12, "{x}: {found}");
        }
        assert!((retardation(1600.0, 5e-4, 0.4) - 3.0).abs() < 1e-14);
    }

    /// Differences of fourth order stand for the derivatives.
    #[test]
    fn concentrations_obey_the_equation() {
        for (velocity, retardation, decay) in
            [(1e-2, 1.0, 0.0), (1e-2, 2.5, 0.0), (1e-2, 1.0, 0.4), (3e-3, 2.5, 0.4), (0.0, 2.5, 0.4)]
        {
            let front = SoluteFront::new(velocity, 1e-4).and_then(|front| front.with_reactions(retardation, decay));
            let front = front.expect("a front");
            for (x, t) in [(0.01, 0.8), (0.02, 1.0), (0.03, 4.0)] {
                let at = |x: f64, t: f64| front.concentration(x, t);
                let (dx, dt) = (1e-3 * x, 1e-3 * t);
                let first = |value: &dyn Fn(f64) -> f64, step: f64| {
                    (8.0 * (value(step) - value(-step)) - (value(2.0 * step) - value(-2.0 * step))) / (12.0 * step)
                };
                let across = |step: f64| at(x + step, t) + at(x - step, t);
                let second = (16.0 * across(dx) - across(2.0 * dx) - 30.0 * at(x, t)) / (12.0 * dx * dx);
                let change = retardation * first(&|step| at(x, t + step), dt);
                let carried = velocity * first(&|step| at(x + step, t), dx);
                let residual = change - (1e-4 * second - carried - decay * retardation * at(x, t));
                assert!(
                    residual.abs() < 1e-7 * (change.abs() + carried.abs() + decay),
                    "{velocity} {x} {t}: {residual}"
                );
            }
        }
    }

    #[test]
    fn no_ratio_overflows() {
        let front = SoluteFront::new(1.0, 1e-7).and_then(|front| front.with_reactions(1.0, 1e-3)).expect("a front");
        assert!((front.concentration(0.3, 0.3) - 0.5).abs() < 1e-3);
        assert!(front.concentration(0.31, 0.3) < 1e-12 && front.concentration(10.0, 0.3) == 0.0);
        let error = SoluteFront::new(-1.0, 1e-7).expect_err("no such front");
        assert_eq!(error.to_string(), "the velocity is -1, it must be at least 0 m/s");
    }
}
