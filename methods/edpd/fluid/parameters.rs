//! What a fluid of eDPD particles is made of, in DPD units: masses of 1, k_B of 1, temperatures over the reference one.

use super::FluidError;
use crate::calibration::Constants;

/// Exponent s of the dissipative weight `(1 - r/rc)^s` over temperature.
#[derive(Debug, Clone, PartialEq)]
pub enum Exponent {
    /// The same at every temperature.
    Constant(f64),
    /// Straight lines between rows (temperature, exponent), sorted by temperature; the end rows' values beyond them.
    Table(Vec<(f64, f64)>),
}

impl Exponent {
    /// The exponent at a temperature.
    #[inline]
    pub fn at(&self, temperature: f64) -> f64 {
        match self {
            Exponent::Constant(value) => *value,
            Exponent::Table(rows) => {
                let next = rows.partition_point(|row| row.0 <= temperature);
                match (next.checked_sub(1).and_then(|last| rows.get(last)), rows.get(next)) {
                    (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (temperature - a.0) / (b.0 - a.0),
                    (Some(end), None) | (None, Some(end)) => end.1,
                    (None, None) => 0.0,
                }
            }
        }
    }

    /// The smallest value that occurs.
    fn least(&self) -> f64 {
        match self {
            Exponent::Constant(value) => *value,
            Exponent::Table(rows) => rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min),
        }
    }
}

/// Constants of a fluid.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Particles by volume.
    pub density: f64,
    /// Largest conservative force of a pair, a.
    pub repulsion: f64,
    /// Friction coefficient of a pair, gamma.
    pub friction: f64,
    /// Exponent of the dissipative weight.
    pub exponent: Exponent,
    /// Cut-off radius of the conservative force.
    pub conservative_cutoff: f64,
    /// Cut-off radius of friction and random force.
    pub dissipative_cutoff: f64,
    /// Cut-off radius of the exchange of heat.
    pub thermal_cutoff: f64,
    /// Heat capacity of a particle.
    pub heat_capacity: f64,
    /// Mesoscopic heat friction, kappa (Ng et al. 2017, eq 20).
    pub heat_friction: f64,
    /// Time step.
    pub step: f64,
}

impl Parameters {
    /// Water in the plane as Ng et al. 2017 set it up, at 25 degC: cut-off 1.96, friction 8, density 4.
    pub fn water() -> Self {
        Parameters {
            density: 4.0,
            repulsion: 75.0 / 4.0,
            friction: 8.0,
            exponent: Exponent::Constant(1.2153),
            conservative_cutoff: 1.96,
            dissipative_cutoff: 1.96,
            thermal_cutoff: 1.96,
            heat_capacity: 1e5,
            heat_friction: 7.1177e-6,
            step: 0.007,
        }
    }

    /// The largest of the cut-off radii.
    pub fn reach(&self) -> f64 {
        self.conservative_cutoff.max(self.dissipative_cutoff).max(self.thermal_cutoff)
    }

    /// Neighbours in the plane that a particle exchanges heat with.
    pub fn heat_neighbours(&self) -> f64 {
        std::f64::consts::PI * self.density * self.thermal_cutoff.powi(2)
    }

    /// What of them kinetic theory takes, in the plane (2) or in space (3).
    pub fn constants(&self, dimension: usize) -> Constants {
        Constants {
            dimension,
            density: self.density,
            friction: self.friction,
            conservative_cutoff: self.conservative_cutoff,
            dissipative_cutoff: self.dissipative_cutoff,
            thermal_cutoff: self.thermal_cutoff,
            heat_capacity: self.heat_capacity,
        }
    }

    /// Looks whether the constants mean anything.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<(), FluidError> {
        let positive = [
            ("density", self.density),
            ("conservative_cutoff", self.conservative_cutoff),
            ("dissipative_cutoff", self.dissipative_cutoff),
            ("thermal_cutoff", self.thermal_cutoff),
            ("heat_capacity", self.heat_capacity),
            ("step", self.step),
        ];
        let not_negative =
            [("repulsion", self.repulsion), ("friction", self.friction), ("heat_friction", self.heat_friction)];
        for (key, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(FluidError::NotPositive(key, value));
            }
        }
        for (key, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(FluidError::Negative(key, value));
            }
        }
        let grows = |pair: &[(f64, f64)]| pair[1].0 > pair[0].0;
        if matches!(&self.exponent, Exponent::Table(rows) if rows.is_empty() || !rows.windows(2).all(grows)) {
            return Err(FluidError::Rows);
        }
        let least = self.exponent.least();
        if !(least >= 0.0 && least.is_finite()) {
            return Err(FluidError::Exponent(least));
        }
        Ok(())
    }
}
