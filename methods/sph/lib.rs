//! Smoothed particle hydrodynamics conduction (Cleary and Monaghan 1999; Chen and Bai 2016): the weight of a pair.
//!
//! The pair sum `2 V_j |W'(r)| / r (U_j - U_i)` is the standard second derivative of SPH; its continuum second
//! moment is exact, its discrete one is not, and the best setting scales by it. The paper's setting takes the
//! continuum constant, the harmonic mean of two conductivities and latent-heat flags. Other published Laplacians
//! are settings: Brookshaw's (1985) takes the arithmetic mean (docs/theory/weights.md).

use std::sync::Arc;

use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::bonds::weight::PairWeight;
use frazil_core::physics::latent_heat::LatentHeatScheme;
use frazil_record::Value;
use frazil_scene::method::{self, Discretisation, MethodKind, SceneFacts, Stepper};
use frazil_scene::{Numerics, Range, Section, Setting};

pub mod kernel;

use kernel::Kernel;

/// The method as the registry lists it.
pub static METHOD: MethodKind = MethodKind {
    name: "sph",
    title: "Smoothed particle hydrodynamics",
    source: "Cleary and Monaghan 1999; Chen and Bai 2016, eqs 5-8",
    stochastic: false,
    lattice_only: false,
    defaults,
    read,
};

/// The weight of a pair.
#[derive(Debug, Clone, Copy)]
struct SmoothedPair {
    dimension: usize,
    kernel: Kernel,
    smoothing_length: f64,
}

impl PairWeight for SmoothedPair {
    fn reach(&self) -> f64 {
        self.kernel.support() * self.smoothing_length
    }

    fn weight(&self, distance: f64) -> f64 {
        let slope = self.kernel.falling_slope_over_distance(distance / self.smoothing_length, self.dimension);
        2.0 * slope / self.smoothing_length.powi(self.dimension as i32 + 2)
    }
}

fn defaults(setting: Setting) -> Numerics {
    match setting {
        Setting::Best => Numerics::default(),
        Setting::Paper => Numerics {
            exchange: Exchange::Mean(Mean::Harmonic),
            latent_heat_scheme: LatentHeatScheme::Flags,
            ..Numerics::default()
        },
    }
}

fn read(section: &mut Section<'_>, setting: Setting, numerics: &Numerics, facts: &SceneFacts) -> Discretisation {
    let dimension = facts.dimension;
    let kernel = section.choice_or("kernel", &Kernel::CHOICES, Kernel::CubicSpline);
    let ratio = section.number_or("smoothing_ratio", 1.2, Range::between(0.6, 3.0));
    let (normalisation, scaled) = method::normalisation(section, setting);
    let word = Kernel::CHOICES.iter().find(|choice| choice.1 == kernel).map_or("", |choice| choice.0);
    Discretisation {
        weight: Arc::new(SmoothedPair { dimension, kernel, smoothing_length: ratio * numerics.spacing }),
        normalisation,
        knobs: vec![
            ("kernel", Value::Text(word.into())),
            ("smoothing_ratio", Value::Number(ratio)),
            ("normalisation", scaled),
        ],
        differences: Vec::new(),
        fluctuation: 0.0,
        stepper: Stepper::Shared,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::bonds::stencil::Stencil;
    use frazil_core::bonds::weight::Normalisation;

    /// Second moment and explicit limit by row sums (units h^2 / a) on a square lattice, from independent sums of
    /// four and three digits.
    #[test]
    fn lattice_moments_and_limits_are_the_known_ones() {
        use Kernel::{CubicSpline, WendlandC2};
        for (kernel, dimension, ratio, moment, limit) in [
            (CubicSpline, 1, 1.2, 1.0224, 0.383),
            (CubicSpline, 1, 1.5, 0.9877, 0.321),
            (CubicSpline, 2, 1.2, 0.9908, 0.244),
            (CubicSpline, 2, 1.3, 1.0105, 0.231),
            (CubicSpline, 2, 2.0, 0.9991, 0.197),
            (WendlandC2, 1, 1.2, 0.9796, 0.435),
            (WendlandC2, 2, 1.2, 0.9639, 0.237),
            (WendlandC2, 2, 1.5, 0.9974, 0.196),
            (WendlandC2, 2, 2.0, 0.9992, 0.171),
        ] {
            let pair = SmoothedPair { dimension, kernel, smoothing_length: ratio };
            let stencil = Stencil::new(&pair, Normalisation::Nominal, 1.0, dimension);
            assert!(
                (stencil.moment(1.0) - moment).abs() < 6e-5,
                "{kernel:?} {dimension}D {ratio}: {}",
                stencil.moment(1.0)
            );
            let found = 1.0 / (stencil.sum() * ratio * ratio);
            assert!((found - limit).abs() < 6e-4, "{kernel:?} {dimension}D {ratio}: {found}");
        }
    }
}
