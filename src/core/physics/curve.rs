//! Temperature, enthalpy and conduction potential of one material.

use std::sync::Arc;

use crate::memory::{HeapSize, shared};
use crate::physics::blend::Blend;
use crate::physics::material::{FreezingLaw, Material, Mixing};

const HALF_SQRT_PI: f64 = 0.886_226_925_452_758;

/// Intervals of the table of a smooth law. Hermite interpolation over this many leaves less than 1e-7 of the
/// width of the freezing interval for water (measured in the tests below).
pub(super) const TABLE_INTERVALS: usize = 16_384;

/// Widths below the freezing point at which the unfrozen fraction of a Weibull curve is its residual to the
/// last bit: exp(-6.2^2) < 2^-55.
const WEIBULL_TAIL_WIDTHS: f64 = 6.2;

/// Exact relations of one material.
#[derive(Debug, Clone)]
pub struct Curve {
    pub(super) law: FreezingLaw,
    pub(super) mixing: Mixing,
    pub(super) freezing_point: f64,
    pub(super) frozen_conductivity: f64,
    pub(super) unfrozen_conductivity: f64,
    pub(super) frozen_capacity: f64,
    pub(super) unfrozen_capacity: f64,
    pub(super) latent_heat: f64,
    /// What it stores, where that is several materials'.
    pub(super) blend: Option<Arc<Blend>>,
    /// Potential and conductivity at even steps of temperature below the freezing point, where the potential has no
    /// closed form; empty elsewhere.
    pub(super) steps: Arc<[(f64, f64)]>,
}

/// Steps of temperature over which a geometric mean of conductivities is integrated. Cubic interpolation between
/// them is exact to rounding: the step is a thousandth of the width of the curve.
const POTENTIAL_STEPS: usize = 8192;

impl Curve {
    /// The relations of a material.
    pub fn new(material: &Material) -> Self {
        let curve = Curve {
            law: material.law,
            mixing: material.mixing,
            freezing_point: material.freezing_point,
            frozen_conductivity: material.frozen.conductivity,
            unfrozen_conductivity: material.unfrozen.conductivity,
            frozen_capacity: material.frozen_capacity(),
            unfrozen_capacity: material.unfrozen_capacity(),
            latent_heat: material.volumetric_latent_heat(),
            blend: None,
            steps: Vec::new().into(),
        };
        curve.with_steps()
    }

    /// Fills the table of the potential, if its law needs one.
    fn with_steps(mut self) -> Self {
        if self.is_kinked() || self.mixing == Mixing::Arithmetic {
            return self;
        }
        let step = self.coldest_change() / POTENTIAL_STEPS as f64;
        let conductivity = |below: f64| self.mixed_conductivity(1.0 - self.frozen_part(below));
        let mut potential = 0.0;
        let mut steps = Vec::with_capacity(POTENTIAL_STEPS + 1);
        for k in 0..=POTENTIAL_STEPS {
            let below = k as f64 * step;
            if k > 0 {
                potential += simpson(conductivity, below - step, below);
            }
            steps.push((potential, conductivity(below)));
        }
        self.steps = steps.into();
        self
    }

    /// The same material with its latent heat spread linearly over `width` kelvin below the freezing point, if it
    /// was released all at once.
    pub fn spread(&self, width: f64) -> Self {
        match self.law {
            FreezingLaw::Isothermal => Curve { law: FreezingLaw::Linear { width }, ..self.clone() }.with_steps(),
            _ => self.clone(),
        }
    }

    /// Freezing point.
    pub fn freezing_point(&self) -> f64 {
        self.freezing_point
    }

    /// Latent heat (J/m3).
    pub fn latent_heat(&self) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.sum(Curve::latent_heat);
        }
        self.latent_heat
    }

    /// Volumetric heat capacity of the unfrozen phase (J/m3K).
    pub fn unfrozen_capacity(&self) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.sum(Curve::unfrozen_capacity);
        }
        self.unfrozen_capacity
    }

    /// Volumetric heat capacity of the frozen phase (J/m3K).
    pub fn frozen_capacity(&self) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.sum(Curve::frozen_capacity);
        }
        self.frozen_capacity
    }

    /// Unfrozen fraction far below the freezing point.
    fn residual(&self) -> f64 {
        match self.law {
            FreezingLaw::None | FreezingLaw::Isothermal | FreezingLaw::Linear { .. } => 0.0,
            FreezingLaw::Weibull { residual, .. } => residual,
        }
    }

    /// Heat capacity (J/m3K) far below the freezing point.
    pub(super) fn coldest_capacity(&self) -> f64 {
        self.residual() * self.unfrozen_capacity + (1.0 - self.residual()) * self.frozen_capacity
    }

    /// Conductivity (W/mK) far below the freezing point.
    fn coldest_conductivity(&self) -> f64 {
        self.mixed_conductivity(self.residual())
    }

    /// Least conductivity of either phase (W/mK).
    pub fn least_conductive(&self) -> f64 {
        self.frozen_conductivity.min(self.unfrozen_conductivity)
    }

    /// Whether all latent heat of one material is released at one temperature.
    pub fn is_sharp(&self) -> bool {
        self.law == FreezingLaw::Isothermal && self.blend.is_none()
    }

    /// Whether potential and enthalpy are piecewise linear in each other.
    pub fn is_kinked(&self) -> bool {
        matches!(self.law, FreezingLaw::None | FreezingLaw::Isothermal)
    }

    /// Distance below the freezing point (K, negative) at which nothing more freezes.
    pub(super) fn coldest_change(&self) -> f64 {
        match self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Linear { width } => -width,
            FreezingLaw::Weibull { width, .. } => -WEIBULL_TAIL_WIDTHS * width,
        }
    }

    /// Unfrozen fraction at a temperature; at the freezing point itself, one.
    pub fn unfrozen_fraction(&self, temperature: f64) -> f64 {
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return 1.0;
        }
        match self.law {
            FreezingLaw::None => 1.0,
            FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Linear { width } => (1.0 + below / width).max(0.0),
            FreezingLaw::Weibull { width, residual } => residual + (1.0 - residual) * (-(below / width).powi(2)).exp(),
        }
    }

    /// Frozen fraction at `below` kelvin (negative) under the freezing point, without cancellation near it.
    fn frozen_part(&self, below: f64) -> f64 {
        match self.law {
            FreezingLaw::None => 0.0,
            FreezingLaw::Isothermal => 1.0,
            FreezingLaw::Linear { width } => (-below / width).min(1.0),
            FreezingLaw::Weibull { width, residual } => -(1.0 - residual) * libm::expm1(-(below / width).powi(2)),
        }
    }

    /// Integral of the unfrozen fraction from the freezing point down to `below` kelvin (negative) under it.
    fn unfrozen_integral(&self, below: f64) -> f64 {
        match self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Linear { width } => {
                let inside = below.max(-width);
                inside + inside * inside / (2.0 * width)
            }
            FreezingLaw::Weibull { width, residual } => {
                (1.0 - residual) * width * HALF_SQRT_PI * libm::erf(below / width) + residual * below
            }
        }
    }

    /// Enthalpy (J/m3) at a temperature.
    pub fn enthalpy(&self, temperature: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.enthalpy(temperature);
        }
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return self.unfrozen_capacity * below;
        }
        match self.law {
            FreezingLaw::None => self.frozen_capacity * below,
            FreezingLaw::Isothermal => self.frozen_capacity * below - self.latent_heat,
            _ => {
                let unfrozen = self.unfrozen_integral(below);
                self.unfrozen_capacity * unfrozen + self.frozen_capacity * (below - unfrozen)
                    - self.latent_heat * self.frozen_part(below)
            }
        }
    }

    /// Least enthalpy (J/m3) at a temperature: at a sharp freezing point, with all latent heat released.
    pub fn least_enthalpy(&self, temperature: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.least_enthalpy(temperature);
        }
        let sharp = matches!(self.law, FreezingLaw::Isothermal) && temperature == self.freezing_point;
        if sharp { -self.latent_heat } else { self.enthalpy(temperature) }
    }

    /// Heat capacity dH/dT (J/m3K), latent heat included, away from the jump of an isothermal law.
    pub fn apparent_capacity(&self, temperature: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.apparent_capacity(temperature);
        }
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return self.unfrozen_capacity;
        }
        let unfrozen = match self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0.0,
            _ => self.unfrozen_fraction(temperature),
        };
        let release = match self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Linear { width } => {
                if below > -width {
                    1.0 / width
                } else {
                    0.0
                }
            }
            FreezingLaw::Weibull { width, residual } => {
                -2.0 * (1.0 - residual) * below / (width * width) * (-(below / width).powi(2)).exp()
            }
        };
        unfrozen * self.unfrozen_capacity + (1.0 - unfrozen) * self.frozen_capacity + self.latent_heat * release
    }

    /// Temperature at an enthalpy (J/m3).
    pub fn temperature(&self, enthalpy: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.temperature(enthalpy);
        }
        if enthalpy >= 0.0 {
            return self.freezing_point + enthalpy / self.unfrozen_capacity;
        }
        match self.law {
            FreezingLaw::None => self.freezing_point + enthalpy / self.frozen_capacity,
            FreezingLaw::Isothermal => {
                self.freezing_point + (enthalpy + self.latent_heat).min(0.0) / self.frozen_capacity
            }
            _ => {
                let coldest = self.freezing_point + self.coldest_change();
                let at_coldest = self.enthalpy(coldest);
                if enthalpy <= at_coldest {
                    return coldest + (enthalpy - at_coldest) / self.coldest_capacity();
                }
                solve_increasing(
                    |temperature| (self.enthalpy(temperature) - enthalpy, self.apparent_capacity(temperature)),
                    coldest,
                    self.freezing_point,
                )
            }
        }
    }

    /// Frozen fraction at an enthalpy (J/m3).
    pub fn frozen_fraction(&self, enthalpy: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.frozen_fraction(enthalpy);
        }
        match self.law {
            FreezingLaw::None => 0.0,
            FreezingLaw::Isothermal => (-enthalpy / self.latent_heat).clamp(0.0, 1.0),
            _ => 1.0 - self.unfrozen_fraction(self.temperature(enthalpy)),
        }
    }

    /// Conductivity (W/mK) of material of which `unfrozen` is unfrozen.
    pub fn mixed_conductivity(&self, unfrozen: f64) -> f64 {
        match self.mixing {
            Mixing::Arithmetic => unfrozen * self.unfrozen_conductivity + (1.0 - unfrozen) * self.frozen_conductivity,
            Mixing::Geometric => {
                self.unfrozen_conductivity.powf(unfrozen) * self.frozen_conductivity.powf(1.0 - unfrozen)
            }
        }
    }

    /// Conductivity (W/mK) at a temperature.
    pub fn conductivity(&self, temperature: f64) -> f64 {
        if temperature >= self.freezing_point {
            return self.unfrozen_conductivity;
        }
        match self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => self.frozen_conductivity,
            _ => self.mixed_conductivity(self.unfrozen_fraction(temperature)),
        }
    }

    /// Conduction potential (W/m) at a temperature: the integral of the conductivity from the freezing point.
    pub fn potential(&self, temperature: f64) -> f64 {
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return self.unfrozen_conductivity * below;
        }
        if self.is_kinked() {
            return self.frozen_conductivity * below;
        }
        match self.mixing {
            Mixing::Arithmetic => {
                let unfrozen = self.unfrozen_integral(below);
                self.unfrozen_conductivity * unfrozen + self.frozen_conductivity * (below - unfrozen)
            }
            Mixing::Geometric => {
                let step = self.coldest_change() / POTENTIAL_STEPS as f64;
                let place = below / step;
                let k = place as usize;
                let Some(((u0, k0), (u1, k1))) = self.steps.get(k).zip(self.steps.get(k + 1)) else {
                    let (deepest, conductivity) = self.steps[POTENTIAL_STEPS];
                    return deepest + (below - self.coldest_change()) * conductivity;
                };
                let (s, d0, d1, rise) = (place - k as f64, k0 * step, k1 * step, u1 - u0);
                u0 + s * (d0 + s * ((3.0 * rise - 2.0 * d0 - d1) + s * (d0 + d1 - 2.0 * rise)))
            }
        }
    }

    /// Temperature at a conduction potential (W/m): the inverse of [`Curve::potential`].
    pub fn temperature_of_potential(&self, potential: f64) -> f64 {
        if potential >= 0.0 {
            return self.freezing_point + potential / self.unfrozen_conductivity;
        }
        if self.is_kinked() {
            return self.freezing_point + potential / self.frozen_conductivity;
        }
        let least = self.frozen_conductivity.min(self.unfrozen_conductivity);
        solve_increasing(
            |temperature| (self.potential(temperature) - potential, self.conductivity(temperature)),
            self.freezing_point + potential / least * (1.0 + 1e-12),
            self.freezing_point,
        )
    }

    /// Heat flux (W/m2) that enters through a film of `coefficient` (W/m2K) from surroundings at `ambient`,
    /// into a particle with potential `inside` (W/m) whose centre is `depth` (m) behind the wall.
    pub fn film_flux(&self, inside: f64, depth: f64, coefficient: f64, ambient: f64) -> f64 {
        if coefficient == 0.0 {
            return 0.0;
        }
        // The wall's temperature Tw makes coefficient (ambient - Tw) = (U(Tw) - inside) / depth.
        let target = coefficient * depth;
        let wall = if self.is_kinked() {
            let warm = (target * (ambient - self.freezing_point) + inside) / (target + self.unfrozen_conductivity);
            let cold = (target * (ambient - self.freezing_point) + inside) / (target + self.frozen_conductivity);
            self.freezing_point + if warm >= 0.0 { warm } else { cold }
        } else {
            let start = self.temperature_of_potential(inside);
            solve_increasing(
                |temperature| {
                    let missing = self.potential(temperature) - inside + target * (temperature - ambient);
                    (missing, self.conductivity(temperature) + target)
                },
                start.min(ambient),
                start.max(ambient),
            )
        };
        // The smaller of the two differences of temperature would be lost in rounding.
        if target > self.most_conductive() {
            (self.potential(wall) - inside) / depth
        } else {
            coefficient * (ambient - wall)
        }
    }

    /// How the flux of [`Curve::film_flux`] changes with the particle's potential (1/m).
    pub fn film_slope(&self, inside: f64, depth: f64, coefficient: f64, ambient: f64) -> f64 {
        if coefficient == 0.0 {
            return 0.0;
        }
        let wall = ambient - self.film_flux(inside, depth, coefficient, ambient) / coefficient;
        -coefficient / (self.conductivity(wall) + coefficient * depth)
    }

    /// The conductivity (W/mK) at all temperatures between two, if it is one.
    pub fn conductivity_between(&self, low: f64, high: f64) -> Option<f64> {
        if self.frozen_conductivity == self.unfrozen_conductivity || low >= self.freezing_point {
            Some(self.unfrozen_conductivity)
        } else if high <= self.freezing_point + self.coldest_change() {
            Some(self.coldest_conductivity())
        } else {
            None
        }
    }

    /// Greatest conductivity of either phase (W/mK).
    pub fn most_conductive(&self) -> f64 {
        self.frozen_conductivity.max(self.unfrozen_conductivity)
    }

    /// Least heat capacity of either phase (J/m3K).
    pub fn least_capacity(&self) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.sum(Curve::least_capacity);
        }
        self.frozen_capacity.min(self.unfrozen_capacity)
    }

    /// Largest slope dU/dH (m2/s) of the exact curve: the largest diffusivity.
    pub fn largest_diffusivity(&self) -> f64 {
        let ends = (self.unfrozen_conductivity / self.unfrozen_capacity)
            .max(self.coldest_conductivity() / self.coldest_capacity());
        let coldest = self.coldest_change();
        (1..4096)
            .map(|k| self.freezing_point + coldest * k as f64 / 4096.0)
            .map(|temperature| self.conductivity(temperature) / self.apparent_capacity(temperature))
            .fold(ends, f64::max)
    }
}

/// Root of an increasing function between two bounds by Newton's method, kept inside by bisection.
pub(crate) fn solve_increasing(residual: impl Fn(f64) -> (f64, f64), mut low: f64, mut high: f64) -> f64 {
    let mut guess = 0.5 * (low + high);
    for _ in 0..200 {
        let (value, slope) = residual(guess);
        if value == 0.0 {
            return guess;
        }
        if value > 0.0 {
            high = guess;
        } else {
            low = guess;
        }
        let newton = guess - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == guess || (high - low) <= f64::EPSILON * high.abs().max(low.abs()) {
            return next;
        }
        guess = next;
    }
    guess
}

pub(super) fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    (to - from) / 6.0 * (f(from) + 4.0 * f(0.5 * (from + to)) + f(to))
}

impl HeapSize for Curve {
    fn heap_size(&self) -> usize {
        shared(&self.steps)
    }
}
