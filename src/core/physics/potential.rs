//! What a particle makes of its enthalpy: temperature, frozen fraction and the conduction potential.
//!
//! A [`Curve`] knows a material's exact relations between temperature `T`, enthalpy `H` (J/m3, zero for unfrozen
//! material at the freezing point) and conduction potential `U = integral of k dT` from the freezing point (W/m).
//! A [`PotentialLaw`] is the one function of the inner loop, `H -> U`, with both counted from the initial state:
//! a body at rest then holds exact zeros, so nothing drifts and small changes are not lost in large sums.

use std::sync::Arc;

use crate::memory::{Held, shared};
use crate::physics::blend::Blend;
use crate::physics::material::{FreezingLaw, Material, Mixing};

const HALF_SQRT_PI: f64 = 0.886_226_925_452_758;

/// Intervals of the table of a smooth law. Hermite interpolation over this many leaves less than 1e-7 of the
/// width of the freezing interval for water (measured in the tests below).
const TABLE_INTERVALS: usize = 16_384;

/// Widths below the freezing point at which the unfrozen fraction of a Weibull curve is its residual to the
/// last bit: exp(-6.2^2) < 2^-55.
const WEIBULL_TAIL_WIDTHS: f64 = 6.2;

/// Exact relations of one material.
#[derive(Debug, Clone)]
pub struct Curve {
    law: FreezingLaw,
    mixing: Mixing,
    freezing_point: f64,
    frozen_conductivity: f64,
    unfrozen_conductivity: f64,
    frozen_capacity: f64,
    unfrozen_capacity: f64,
    latent_heat: f64,
    /// What it stores, where that is several materials'.
    blend: Option<Arc<Blend>>,
    /// Potential and conductivity at even steps of temperature below the freezing point, where the potential has no
    /// closed form; empty elsewhere.
    steps: Arc<[(f64, f64)]>,
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
    fn coldest_capacity(&self) -> f64 {
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

    /// Whether potential and enthalpy are piecewise linear in each other.
    pub fn is_kinked(&self) -> bool {
        matches!(self.law, FreezingLaw::None | FreezingLaw::Isothermal)
    }

    /// Distance below the freezing point (K, negative) at which nothing more freezes.
    fn coldest_change(&self) -> f64 {
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

/// The function of the inner loop: enthalpy to potential, both counted from the initial state.
pub trait PotentialLaw: Clone + Send + Sync + 'static {
    /// Potential (W/m) less the initial potential, at an enthalpy (J/m3) less the initial enthalpy.
    fn potential(&self, enthalpy: f64) -> f64;
    /// Slope dU/dH (m2/s) at an enthalpy; at a kink, the steeper of the two.
    fn slope(&self, enthalpy: f64) -> f64;
}

/// The law of numbers that are potentials already: what the linearised operator is swept with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identity;

impl PotentialLaw for Identity {
    #[inline(always)]
    fn potential(&self, potential: f64) -> f64 {
        potential
    }

    #[inline(always)]
    fn slope(&self, _potential: f64) -> f64 {
        1.0
    }
}

/// A law of three straight pieces: frozen, freezing, unfrozen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinked {
    frozen_slope: f64,
    unfrozen_slope: f64,
    frozen_below: f64,
    unfrozen_above: f64,
    frozen_rest: f64,
    unfrozen_rest: f64,
}

impl PotentialLaw for Kinked {
    #[inline(always)]
    fn potential(&self, enthalpy: f64) -> f64 {
        // Plain comparisons: unlike f64::min they need no care for NaN and become one instruction.
        let cold = if enthalpy < self.frozen_below { enthalpy } else { self.frozen_below };
        let warm = if enthalpy > self.unfrozen_above { enthalpy } else { self.unfrozen_above };
        self.frozen_slope * (cold - self.frozen_rest) + self.unfrozen_slope * (warm - self.unfrozen_rest)
    }

    #[inline(always)]
    fn slope(&self, enthalpy: f64) -> f64 {
        let frozen = if enthalpy <= self.frozen_below { self.frozen_slope } else { 0.0 };
        let unfrozen = if enthalpy >= self.unfrozen_above { self.unfrozen_slope } else { 0.0 };
        if frozen > unfrozen { frozen } else { unfrozen }
    }
}

/// A law without any change: potential and enthalpy in proportion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straight {
    slope: f64,
}

impl PotentialLaw for Straight {
    #[inline(always)]
    fn potential(&self, enthalpy: f64) -> f64 {
        self.slope * enthalpy
    }

    #[inline(always)]
    fn slope(&self, _enthalpy: f64) -> f64 {
        self.slope
    }
}

/// A smooth law in two tables, each against the root of the distance to its end of the freezing interval: the
/// curve bends sharply at both ends, and there the nodes lie close.
#[derive(Debug, Clone)]
pub struct Curved {
    /// Initial enthalpy and potential.
    initial: (f64, f64),
    unfrozen_slope: f64,
    frozen_slope: f64,
    coldest: (f64, f64),
    middle: f64,
    per_interval: f64,
    /// Potential and its derivative by the interval's own coordinate, from the freezing point down.
    warm: Arc<[(f64, f64)]>,
    /// The same from the cold end up.
    cold: Arc<[(f64, f64)]>,
}

impl PotentialLaw for Curved {
    #[inline]
    fn potential(&self, enthalpy: f64) -> f64 {
        let absolute = enthalpy + self.initial.0;
        let potential = if absolute >= 0.0 {
            self.unfrozen_slope * absolute
        } else if absolute <= self.coldest.0 {
            self.coldest.1 + self.frozen_slope * (absolute - self.coldest.0)
        } else {
            let (nodes, distance) =
                if absolute > self.middle { (&self.warm, -absolute) } else { (&self.cold, absolute - self.coldest.0) };
            let place = distance.sqrt() * self.per_interval;
            let k = (place as usize).min(TABLE_INTERVALS - 1);
            let s = place - k as f64;
            let ((u0, d0), (u1, d1)) = (nodes[k], nodes[k + 1]);
            let rise = u1 - u0;
            u0 + s * (d0 + s * ((3.0 * rise - 2.0 * d0 - d1) + s * (d0 + d1 - 2.0 * rise)))
        };
        potential - self.initial.1
    }

    #[inline]
    fn slope(&self, enthalpy: f64) -> f64 {
        let absolute = enthalpy + self.initial.0;
        if absolute >= 0.0 {
            return self.unfrozen_slope;
        }
        if absolute <= self.coldest.0 {
            return self.frozen_slope;
        }
        let warm = absolute > self.middle;
        let (nodes, distance) = if warm { (&self.warm, -absolute) } else { (&self.cold, absolute - self.coldest.0) };
        // At the very end of a table the derivative by the root vanishes with the root: a thousandth of an interval
        // away their ratio is still a ratio of numbers and not of rounding errors.
        let place = (distance.sqrt() * self.per_interval).max(1e-3);
        let k = (place as usize).min(TABLE_INTERVALS - 1);
        let s = place - k as f64;
        let ((u0, d0), (u1, d1)) = (nodes[k], nodes[k + 1]);
        let rise = u1 - u0;
        let by_place = d0 + s * (2.0 * (3.0 * rise - 2.0 * d0 - d1) + s * 3.0 * (d0 + d1 - 2.0 * rise));
        // place = per_interval sqrt(distance), so d place / d distance = per_interval^2 / (2 place).
        let by_distance = by_place * self.per_interval * self.per_interval / (2.0 * place);
        (if warm { -by_distance } else { by_distance }).max(0.0)
    }
}

/// The law of one material as the step needs it, with the exact curve beside it.
#[derive(Debug, Clone)]
pub struct Thermal {
    /// Exact relations.
    pub curve: Curve,
    /// Initial temperature.
    pub initial_temperature: f64,
    /// Initial enthalpy (J/m3), the zero of the enthalpies that particles carry.
    pub initial_enthalpy: f64,
    /// Initial potential (W/m), the zero of the potentials that pairs exchange.
    pub initial_potential: f64,
    /// The inner loop's function.
    pub law: Law,
    /// Largest slope dU/dH (m2/s) of the inner loop's function.
    pub largest_slope: f64,
}

/// A law of a particle that stores the heat of several materials and conducts as one of them.
#[derive(Debug, Clone)]
pub struct Blended {
    curve: Arc<Curve>,
    /// Initial enthalpy and potential.
    initial: (f64, f64),
}

impl Blended {
    fn potential(&self, enthalpy: f64) -> f64 {
        // A body at rest holds exact zeros.
        if enthalpy == 0.0 {
            return 0.0;
        }
        self.curve.potential(self.curve.temperature(enthalpy + self.initial.0)) - self.initial.1
    }

    fn slope(&self, enthalpy: f64) -> f64 {
        let absolute = enthalpy + self.initial.0;
        if self.curve.blend.as_ref().is_some_and(|blend| blend.stands_still(absolute)) {
            return 0.0;
        }
        let temperature = self.curve.temperature(absolute);
        self.curve.conductivity(temperature) / self.curve.apparent_capacity(temperature)
    }
}

/// The kinds of inner-loop functions; a run decides once between them.
#[derive(Debug, Clone)]
pub enum Law {
    /// In proportion.
    Straight(Straight),
    /// Piecewise linear.
    Kinked(Kinked),
    /// Tabulated.
    Curved(Curved),
    /// Of several materials.
    Blended(Blended),
}

impl Law {
    /// The potential, for places where speed does not matter.
    pub fn potential(&self, enthalpy: f64) -> f64 {
        match self {
            Law::Straight(law) => law.potential(enthalpy),
            Law::Kinked(law) => law.potential(enthalpy),
            Law::Curved(law) => law.potential(enthalpy),
            Law::Blended(law) => law.potential(enthalpy),
        }
    }

    /// The slope dU/dH (m2/s), likewise.
    pub fn slope(&self, enthalpy: f64) -> f64 {
        match self {
            Law::Straight(law) => law.slope(enthalpy),
            Law::Kinked(law) => law.slope(enthalpy),
            Law::Curved(law) => law.slope(enthalpy),
            Law::Blended(law) => law.slope(enthalpy),
        }
    }
}

impl Held for Curve {
    fn held(&self) -> usize {
        shared(&self.steps)
    }
}

impl Held for Curved {
    fn held(&self) -> usize {
        shared(&self.warm) + shared(&self.cold)
    }
}

impl Held for Law {
    fn held(&self) -> usize {
        match self {
            Law::Straight(_) | Law::Kinked(_) => 0,
            Law::Curved(law) => law.held(),
            Law::Blended(_) => size_of::<Curve>(),
        }
    }
}

impl Thermal {
    /// Prepares a material that starts at `initial_temperature`.
    pub fn new(curve: Curve, initial_temperature: f64) -> Self {
        let initial_enthalpy = curve.enthalpy(initial_temperature);
        let initial_potential = curve.potential(initial_temperature);
        let (law, largest_slope) = if curve.is_kinked() {
            let frozen_below = -curve.latent_heat - initial_enthalpy;
            let unfrozen_above = -initial_enthalpy;
            let law = Kinked {
                frozen_slope: curve.frozen_conductivity / curve.frozen_capacity,
                unfrozen_slope: curve.unfrozen_conductivity / curve.unfrozen_capacity,
                frozen_below,
                unfrozen_above,
                frozen_rest: frozen_below.min(0.0),
                unfrozen_rest: unfrozen_above.max(0.0),
            };
            // Without latent heat and with one slope there is no kink.
            let law = if curve.latent_heat == 0.0 && law.frozen_slope == law.unfrozen_slope {
                Law::Straight(Straight { slope: law.frozen_slope })
            } else {
                Law::Kinked(law)
            };
            (
                law,
                (curve.frozen_conductivity / curve.frozen_capacity)
                    .max(curve.unfrozen_conductivity / curve.unfrozen_capacity),
            )
        } else {
            let law = Curved::new(&curve, initial_enthalpy);
            (Law::Curved(law), curve.largest_diffusivity())
        };
        Thermal { curve, initial_temperature, initial_enthalpy, initial_potential, law, largest_slope }
    }

    /// The law of a particle that conducts as one material and stores the heat of several.
    pub fn blended(own: &Thermal, blend: Arc<Blend>) -> Self {
        let curve = Curve { blend: Some(blend), ..own.curve.clone() };
        let initial = (curve.enthalpy(own.initial_temperature), own.initial_potential);
        // Latent heat only adds to what it stores.
        let largest_slope = curve.most_conductive() / curve.least_capacity();
        Thermal {
            initial_temperature: own.initial_temperature,
            initial_enthalpy: initial.0,
            initial_potential: initial.1,
            law: Law::Blended(Blended { curve: Arc::new(curve.clone()), initial }),
            largest_slope,
            curve,
        }
    }

    /// Temperature of a particle from the enthalpy that it carries.
    pub fn temperature(&self, enthalpy: f64) -> f64 {
        if enthalpy == 0.0 {
            self.initial_temperature
        } else {
            self.curve.temperature(enthalpy + self.initial_enthalpy)
        }
    }

    /// Frozen fraction of a particle from the enthalpy that it carries.
    pub fn frozen_fraction(&self, enthalpy: f64) -> f64 {
        self.curve.frozen_fraction(enthalpy + self.initial_enthalpy)
    }

    /// Enthalpy that a particle carries at a temperature.
    pub fn enthalpy(&self, temperature: f64) -> f64 {
        self.curve.enthalpy(temperature) - self.initial_enthalpy
    }

    /// Potential, less the initial one, at a temperature.
    pub fn potential_at(&self, temperature: f64) -> f64 {
        self.curve.potential(temperature) - self.initial_potential
    }
}

impl Curved {
    /// Conduction potential.
    fn new(curve: &Curve, initial_enthalpy: f64) -> Self {
        Self::integral(curve, initial_enthalpy, |temperature| curve.conductivity(temperature))
    }

    /// Temperature above the freezing point, by the same tables.
    pub fn of_temperature(curve: &Curve) -> Self {
        Self::integral(curve, 0.0, |_| 1.0)
    }

    /// The integral of a function of the temperature from the freezing point.
    fn integral(curve: &Curve, initial_enthalpy: f64, of: impl Fn(f64) -> f64) -> Self {
        let coldest_temperature = curve.freezing_point + curve.coldest_change();
        let coldest_enthalpy = curve.enthalpy(coldest_temperature);
        let interval = (-0.5 * coldest_enthalpy).sqrt() / TABLE_INTERVALS as f64;
        let warm = Self::nodes(curve, &of, interval, curve.freezing_point, |root| -root * root);
        let bottom = warm[TABLE_INTERVALS].0;
        let mut cold = Self::nodes(curve, &of, interval, coldest_temperature, |root| coldest_enthalpy + root * root);
        let shift = bottom - cold[TABLE_INTERVALS].0;
        for node in &mut cold {
            node.0 += shift;
        }
        let mut law = Curved {
            initial: (initial_enthalpy, 0.0),
            unfrozen_slope: of(curve.freezing_point + 1.0) / curve.unfrozen_capacity,
            frozen_slope: of(coldest_temperature - 1.0) / curve.coldest_capacity(),
            coldest: (coldest_enthalpy, cold[0].0),
            middle: 0.5 * coldest_enthalpy,
            per_interval: 1.0 / interval,
            warm: warm.into(),
            cold: cold.into(),
        };
        // What the table itself gives, so that a body at rest holds exact zeros.
        law.initial.1 = law.potential(0.0);
        law
    }

    /// Nodes of one table, from one end of the freezing interval to the middle.
    fn nodes(
        curve: &Curve,
        of: &impl Fn(f64) -> f64,
        interval: f64,
        end_temperature: f64,
        enthalpy: impl Fn(f64) -> f64,
    ) -> Vec<(f64, f64)> {
        let mut nodes = Vec::with_capacity(TABLE_INTERVALS + 1);
        let (mut last, mut potential) = (end_temperature, 0.0);
        for k in 0..=TABLE_INTERVALS {
            let root = k as f64 * interval;
            let temperature = if k == 0 { end_temperature } else { curve.temperature(enthalpy(root)) };
            // Potential by running quadrature between nodes: exact to rounding, and one pass.
            potential += simpson(of, last, temperature);
            last = temperature;
            let slope = of(temperature) / curve.apparent_capacity(temperature);
            let falling = enthalpy(interval) < enthalpy(0.0);
            nodes.push((potential, if falling { -2.0 } else { 2.0 } * root * slope * interval));
        }
        // Slopes at most three times a neighbour's rise keep every piece monotone (Fritsch and Carlson 1980).
        for k in 1..TABLE_INTERVALS {
            let rise = (nodes[k].0 - nodes[k - 1].0).abs().min((nodes[k + 1].0 - nodes[k].0).abs());
            nodes[k].1 = nodes[k].1.clamp(-3.0 * rise, 3.0 * rise);
        }
        nodes
    }
}

fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    (to - from) / 6.0 * (f(from) + 4.0 * f(0.5 * (from + to)) + f(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::material::Phase;

    fn water(law: FreezingLaw, mixing: Mixing) -> Curve {
        Curve::new(&Material {
            name: "water".into(),
            density: 1000.0,
            frozen: Phase { conductivity: 2.14, heat_capacity: 2060.0 },
            unfrozen: Phase { conductivity: 0.6, heat_capacity: 4182.0 },
            freezing_point: 0.0,
            latent_heat: 334_000.0,
            law,
            mixing,
            pores: None,
        })
    }

    fn laws() -> Vec<Curve> {
        let mut curves = vec![water(FreezingLaw::Isothermal, Mixing::Arithmetic)];
        for mixing in [Mixing::Arithmetic, Mixing::Geometric] {
            for width in [0.01, 0.5, 3.0] {
                curves.push(water(FreezingLaw::Linear { width }, mixing));
                curves.push(water(FreezingLaw::Weibull { width, residual: 0.0 }, mixing));
                curves.push(water(FreezingLaw::Weibull { width, residual: 0.2 }, mixing));
            }
        }
        curves
    }

    fn temperatures() -> impl Iterator<Item = f64> {
        (-4000..=1000).map(|k| (k as f64 / 100.0).powi(3) / 1600.0).filter(|t| *t != 0.0)
    }

    #[test]
    fn temperature_inverts_enthalpy_to_rounding() {
        for curve in laws() {
            for temperature in temperatures() {
                let enthalpy = curve.enthalpy(temperature);
                let back = curve.enthalpy(curve.temperature(enthalpy));
                // Two roundings of sums as large as the latent heat.
                assert!(
                    (back - enthalpy).abs() <= 4.0 * f64::EPSILON * (enthalpy.abs() + curve.latent_heat),
                    "{:?} at {temperature}: {back} {enthalpy}",
                    curve.law
                );
            }
        }
    }

    #[test]
    fn derivatives_of_enthalpy_and_potential_are_capacity_and_conductivity() {
        for curve in laws() {
            for temperature in temperatures().filter(|t| t.abs() > 1e-3) {
                let step = 1e-5 * temperature.abs();
                let slope = |f: &dyn Fn(f64) -> f64| (f(temperature + step) - f(temperature - step)) / (2.0 * step);
                let capacity = slope(&|t| curve.enthalpy(t));
                let conductivity = slope(&|t| curve.potential(t));
                // The kink of a linear interval falls between two of the sampled temperatures.
                let scale = curve.apparent_capacity(temperature);
                assert!(
                    (capacity / scale - 1.0).abs() < 2e-5
                        || matches!(curve.law, FreezingLaw::Linear { width } if (temperature + width).abs() <= step)
                );
                assert!((conductivity / curve.conductivity(temperature) - 1.0).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn the_inner_law_is_the_exact_potential() {
        for curve in laws() {
            for initial in [8.0, -20.0] {
                let thermal = Thermal::new(curve.clone(), initial);
                let width = match curve.law {
                    FreezingLaw::Linear { width } | FreezingLaw::Weibull { width, .. } => width,
                    _ => 0.0,
                };
                let (mut worst, mut at): (f64, f64) = (0.0, 0.0);
                for k in 0..20_000 {
                    let enthalpy = -4.2e8 + 4.7e8 * k as f64 / 20_000.0;
                    let exact = curve.potential(curve.temperature(enthalpy)) - thermal.initial_potential;
                    let error = (thermal.law.potential(enthalpy - thermal.initial_enthalpy) - exact).abs();
                    if error > worst {
                        worst = error;
                        at = enthalpy;
                    }
                }
                // In kelvin at the conductivity of ice: 1e-7 of the interval, or rounding of the range.
                assert!(
                    worst / 2.14 <= 1e-7 * width + 1e-12,
                    "{:?} from {initial}: {} K at {at}",
                    curve.law,
                    worst / 2.14
                );
            }
        }
    }

    #[test]
    fn a_body_at_rest_holds_exact_zeros_and_the_law_rises() {
        for curve in laws() {
            for initial in [8.0, 0.0, -0.2, -20.0] {
                let thermal = Thermal::new(curve.clone(), initial);
                assert_eq!(thermal.law.potential(0.0), 0.0);
                let mut last = f64::NEG_INFINITY;
                for k in 0..100_000 {
                    let here = thermal.law.potential(-5e8 + 1e4 * k as f64);
                    assert!(here >= last);
                    last = here;
                }
            }
        }
    }

    #[test]
    fn film_flux_matches_conduction_behind_the_wall() {
        for curve in laws() {
            for (inside, ambient) in [(4.8, -20.0), (-30.0, 5.0), (0.0, -1.0), (-0.1, -30.0)] {
                let (depth, coefficient) = (0.001, 25.0);
                let flux = curve.film_flux(inside, depth, coefficient, ambient);
                let wall = ambient - flux / coefficient;
                // Balance of film and conduction, to the rounding of the potentials.
                assert!((curve.potential(wall) - inside - flux * depth).abs() < 1e-9 * inside.abs().max(1.0));
            }
        }
    }
}
