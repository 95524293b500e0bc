//! Properties of a material along its freezing curve.

use frazil_core::physics::freezing_curve::linear::Linear;
use frazil_core::physics::freezing_curve::weibull::Weibull;
use frazil_core::physics::freezing_curve::{FreezingCurve, FreezingLaw};
use frazil_core::physics::material::{Material, Mixing};

/// Widths below the freezing point at which a Weibull curve begins to be felt: exp(-49) is beyond the last digit.
const WEIBULL_PEAK: f64 = 7.0;

/// Part of the freezing curve on which it is smooth. Each formula is also meaningful a little outside its part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CurvePart {
    /// Above it.
    Unfrozen,
    /// Between both ends.
    Interval,
    /// Below it.
    Frozen,
}

/// Properties at one temperature.
#[derive(Debug, Clone, Copy)]
pub struct LocalProperties {
    /// Apparent heat capacity, latent heat included (J/m3K).
    pub capacity: f64,
    /// Conductivity (W/mK).
    pub conductivity: f64,
    /// Of the water (-).
    pub frozen_fraction: f64,
}

impl LocalProperties {
    /// Diffusivity (m2/s).
    pub fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
    }
}

/// Curves whose solutions are solved for.
#[derive(Debug, Clone, Copy)]
enum Shape {
    Linear { width: f64 },
    Weibull { width: f64, residual: f64 },
}

/// Properties of a material over temperature.
#[derive(Debug, Clone)]
pub struct Medium {
    /// The material.
    pub material: Material,
    shape: Shape,
}

impl Medium {
    /// A material, if its curve is one of those that are solved for.
    pub fn new(material: &Material) -> Option<Self> {
        let shape = match material.law {
            FreezingLaw::Curve(FreezingCurve::Linear(Linear { width })) => Shape::Linear { width },
            FreezingLaw::Curve(FreezingCurve::Weibull(Weibull { width, residual })) => {
                Shape::Weibull { width, residual }
            }
            _ => return None,
        };
        let medium = Medium { material: material.clone(), shape };
        (medium.width() > 0.0).then_some(medium)
    }

    /// Width (K) of the curve.
    pub fn width(&self) -> f64 {
        match self.shape {
            Shape::Linear { width } | Shape::Weibull { width, .. } => width,
        }
    }

    /// Properties at a temperature, by the formulas of a part.
    pub fn properties(&self, part: CurvePart, temperature: f64) -> LocalProperties {
        let material = &self.material;
        let below = temperature - material.freezing_point;
        let (unfrozen, slope) = match (part, self.shape) {
            (CurvePart::Unfrozen, _) => (1.0, 0.0),
            (CurvePart::Frozen, _) => (0.0, 0.0),
            (CurvePart::Interval, Shape::Linear { width }) => (1.0 + below / width, 1.0 / width),
            (CurvePart::Interval, Shape::Weibull { width, residual }) => {
                let free = (1.0 - residual) * libm::exp(-(below / width) * (below / width));
                (residual + free, -2.0 * below / (width * width) * free)
            }
        };
        let frozen = 1.0 - unfrozen;
        let capacity = unfrozen * material.unfrozen_capacity()
            + frozen * material.frozen_capacity()
            + material.volumetric_latent_heat() * slope;
        let (liquid, solid) = (material.unfrozen.conductivity, material.frozen.conductivity);
        let conductivity = match material.mixing {
            Mixing::Arithmetic => unfrozen * liquid + frozen * solid,
            Mixing::Geometric => solid * libm::pow(liquid / solid, unfrozen),
        };
        LocalProperties { capacity, conductivity, frozen_fraction: frozen }
    }

    /// The part that holds temperatures just beside `temperature`, in the direction of `towards`.
    pub fn part(&self, temperature: f64, towards: f64) -> CurvePart {
        let below = temperature - self.material.freezing_point;
        let is_warming = towards > temperature;
        let is_past = |limit: f64| below > limit || (below == limit && is_warming);
        match self.shape {
            _ if is_past(0.0) => CurvePart::Unfrozen,
            Shape::Linear { width } if !is_past(-width) => CurvePart::Frozen,
            _ => CurvePart::Interval,
        }
    }

    /// Longest step in temperature (K) from a given one: inside the peak of the apparent capacity, half its width,
    /// lest a step leap over all of it.
    pub fn longest_step(&self, temperature: f64) -> f64 {
        let below = temperature - self.material.freezing_point;
        match self.shape {
            Shape::Linear { width } if below.abs() <= width => 0.5 * width,
            Shape::Weibull { width, .. } if below.abs() <= WEIBULL_PEAK * width * (1.0 + 1e-9) => 0.5 * width,
            _ => f64::INFINITY,
        }
    }

    /// Kinks of the curve strictly between two temperatures, in the order in which they are met.
    pub fn kinks(&self, from: f64, to: f64) -> Vec<f64> {
        let freezing_point = self.material.freezing_point;
        let mut kinks = match self.shape {
            Shape::Linear { width } => vec![freezing_point - width, freezing_point],
            // No kink, but where the peak of the apparent capacity begins.
            Shape::Weibull { width, .. } => vec![freezing_point - WEIBULL_PEAK * width, freezing_point],
        };
        kinks.retain(|&kink| (kink - from) * (kink - to) < 0.0);
        if to < from {
            kinks.reverse();
        }
        kinks
    }
}
