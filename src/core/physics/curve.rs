//! Temperature, enthalpy and conduction potential of one material.

use std::sync::Arc;

use crate::memory::HeapSize;
use crate::physics::blend::Blend;
use crate::physics::film::Film;
use crate::physics::freezing_curve::linear::Linear;
use crate::physics::freezing_curve::shape::UnfrozenFraction;
use crate::physics::integral::Integral;
use crate::physics::material::{FreezingLaw, Material, Mixing};
use crate::physics::retention::moisture::Moisture;
use crate::physics::retention::scale::{head, place};
use crate::physics::root::solve_increasing;

/// Intervals of the table of a smooth law. Hermite interpolation over this many leaves less than 1e-7 of the
/// width of the freezing interval for water (measured in the tests below).
pub(super) const TABLE_INTERVALS: usize = 16_384;

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
    /// Potential below the freezing point, where it has no closed form.
    pub(super) mixed_potential: Option<Integral>,
    /// The relations of water, of ground that is given for water and not for heat.
    pub(super) moisture: Option<Arc<Moisture>>,
}

/// Least steps of temperature over which a geometric mean of conductivities is integrated. Cubic interpolation between
/// them is exact to rounding: the step is a thousandth of the width of a curve of one piece.
const POTENTIAL_STEPS: usize = 8192;

/// Part of a head over which its conductivity is differentiated: errors and rounding of a slope are both far below it.
const DRIVEN_STEP: f64 = 1e-5;

/// Temperatures below the freezing point, at least, at which a curve is searched for its largest diffusivity.
const DIFFUSIVITY_SAMPLES: usize = 4096;

/// Steps of each of `count` pieces, of which all together have at least this many.
fn steps_each(all: usize, count: usize) -> usize {
    all.div_ceil(count).next_power_of_two()
}

impl Curve {
    /// The relations of a material.
    pub fn new(material: &Material) -> Self {
        if let Some(soil) = &material.soil {
            return Curve::of_water(Moisture::new(soil.clone()));
        }
        let curve = Curve {
            law: material.law.clone(),
            mixing: material.mixing,
            freezing_point: material.freezing_point,
            frozen_conductivity: material.frozen.conductivity,
            unfrozen_conductivity: material.unfrozen.conductivity,
            frozen_capacity: material.frozen_capacity(),
            unfrozen_capacity: material.unfrozen_capacity(),
            latent_heat: material.volumetric_latent_heat(),
            blend: None,
            mixed_potential: None,
            moisture: None,
        };
        curve.with_mixed_potential()
    }

    /// The relations of water in unsaturated ground: what is said of temperatures holds of places on the scale of heads
    /// ([`crate::physics::retention::scale`]), of enthalpies of contents, of the unfrozen fraction of the saturation.
    pub(super) fn of_water(moisture: Moisture) -> Self {
        let (conductivity, storage) = (moisture.soil().conductivity, moisture.soil().storage);
        Curve {
            law: FreezingLaw::None,
            mixing: Mixing::Arithmetic,
            freezing_point: 0.0,
            frozen_conductivity: conductivity,
            unfrozen_conductivity: conductivity,
            frozen_capacity: storage,
            unfrozen_capacity: storage,
            latent_heat: moisture.drainable(),
            blend: None,
            mixed_potential: None,
            moisture: Some(Arc::new(moisture)),
        }
    }

    /// The relations of water, where it is water that flows.
    pub fn moisture(&self) -> Option<&Moisture> {
        self.moisture.as_deref()
    }

    /// Fills the table of the potential, if its law needs one.
    fn with_mixed_potential(mut self) -> Self {
        if let (FreezingLaw::Curve(curve), Mixing::Geometric) = (&self.law, self.mixing) {
            let pieces = curve.pieces();
            let conductivity = |below: f64| self.mixed_conductivity(1.0 - curve.frozen(below));
            let steps = steps_each(POTENTIAL_STEPS, pieces.len());
            self.mixed_potential = Some(Integral::new(conductivity, &pieces, steps));
        }
        self
    }

    /// The same material with its latent heat spread linearly over `width` kelvin below the freezing point, if it
    /// was released all at once.
    pub fn spread(&self, width: f64) -> Self {
        match &self.law {
            FreezingLaw::Isothermal => Curve { law: Linear { width }.into(), ..self.clone() }.with_mixed_potential(),
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
        match &self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Curve(curve) => curve.unfrozen(f64::NEG_INFINITY),
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
        !matches!(self.law, FreezingLaw::Curve(_)) && self.moisture.is_none()
    }

    /// Distance below the freezing point (K, negative) at which nothing more freezes.
    pub(super) fn coldest_change(&self) -> f64 {
        match &self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Curve(curve) => curve.end(),
        }
    }

    /// Unfrozen fraction at a temperature; at the freezing point itself, one.
    pub fn unfrozen_fraction(&self, temperature: f64) -> f64 {
        if let Some(moisture) = &self.moisture {
            return moisture.saturation(temperature);
        }
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return 1.0;
        }
        match &self.law {
            FreezingLaw::None => 1.0,
            FreezingLaw::Isothermal => 0.0,
            FreezingLaw::Curve(curve) => curve.unfrozen(below),
        }
    }

    /// Enthalpy (J/m3) at a temperature.
    pub fn enthalpy(&self, temperature: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.enthalpy(temperature);
        }
        if let Some(moisture) = &self.moisture {
            return moisture.content(temperature);
        }
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return self.unfrozen_capacity * below;
        }
        match &self.law {
            FreezingLaw::None => self.frozen_capacity * below,
            FreezingLaw::Isothermal => self.frozen_capacity * below - self.latent_heat,
            FreezingLaw::Curve(curve) => {
                let unfrozen = curve.integral(below);
                self.unfrozen_capacity * unfrozen + self.frozen_capacity * (below - unfrozen)
                    - self.latent_heat * curve.frozen(below)
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
        if let Some(moisture) = &self.moisture {
            return moisture.capacity(temperature);
        }
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return self.unfrozen_capacity;
        }
        let (unfrozen, release) = match &self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => (0.0, 0.0),
            FreezingLaw::Curve(curve) => (curve.unfrozen(below), curve.release(below)),
        };
        unfrozen * self.unfrozen_capacity + (1.0 - unfrozen) * self.frozen_capacity + self.latent_heat * release
    }

    /// Temperature at an enthalpy (J/m3).
    pub fn temperature(&self, enthalpy: f64) -> f64 {
        if let Some(blend) = &self.blend {
            return blend.temperature(enthalpy);
        }
        if let Some(moisture) = &self.moisture {
            return moisture.place_of_content(enthalpy);
        }
        if enthalpy >= 0.0 {
            return self.freezing_point + enthalpy / self.unfrozen_capacity;
        }
        match &self.law {
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
        match &self.law {
            FreezingLaw::None if self.moisture.is_none() => 0.0,
            FreezingLaw::Isothermal => (-enthalpy / self.latent_heat).clamp(0.0, 1.0),
            _ => 1.0 - self.unfrozen_fraction(self.temperature(enthalpy)),
        }
    }

    /// Conductivity (W/mK) of material of which `unfrozen` is unfrozen.
    pub fn mixed_conductivity(&self, unfrozen: f64) -> f64 {
        self.mixing.conductivity(unfrozen, self.unfrozen_conductivity, self.frozen_conductivity)
    }

    /// Conductivity (W/mK) at a temperature.
    pub fn conductivity(&self, temperature: f64) -> f64 {
        if let Some(moisture) = &self.moisture {
            return moisture.conductivity(temperature);
        }
        if temperature >= self.freezing_point {
            return self.unfrozen_conductivity;
        }
        match &self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => self.frozen_conductivity,
            _ => self.mixed_conductivity(self.unfrozen_fraction(temperature)),
        }
    }

    /// What a mean of conductivities is multiplied by a difference of: the temperature, and of water the pressure head (m).
    pub fn driver(&self, temperature: f64) -> f64 {
        if self.moisture.is_some() { head(temperature) } else { temperature }
    }

    /// Conductivity (W/mK) at what drives it; of water the hydraulic one (m/s).
    pub fn driven_conductivity(&self, driver: f64) -> f64 {
        match &self.moisture {
            Some(moisture) => moisture.hydraulic_conductivity(place(driver)),
            None => self.conductivity(driver),
        }
    }

    /// How the hydraulic conductivity follows the head (1/s); zero of heat, whose conductivities change little beside.
    pub fn driven_slope(&self, driver: f64) -> f64 {
        if self.moisture.is_none() || driver >= 0.0 {
            return 0.0;
        }
        let step = DRIVEN_STEP * driver.abs();
        (self.driven_conductivity(driver + step) - self.driven_conductivity(driver - step)) / (2.0 * step)
    }

    /// Conduction potential (W/m) at a temperature: the integral of the conductivity from the freezing point.
    pub fn potential(&self, temperature: f64) -> f64 {
        if let Some(moisture) = &self.moisture {
            return moisture.potential(temperature);
        }
        let below = temperature - self.freezing_point;
        if below >= 0.0 {
            return self.unfrozen_conductivity * below;
        }
        match (&self.law, &self.mixed_potential) {
            (FreezingLaw::None | FreezingLaw::Isothermal, _) => self.frozen_conductivity * below,
            (FreezingLaw::Curve(_), Some(integral)) => integral.at(below),
            (FreezingLaw::Curve(curve), None) => {
                let unfrozen = curve.integral(below);
                self.unfrozen_conductivity * unfrozen + self.frozen_conductivity * (below - unfrozen)
            }
        }
    }

    /// Temperature at a conduction potential (W/m): the inverse of [`Curve::potential`].
    pub fn temperature_of_potential(&self, potential: f64) -> f64 {
        if let Some(moisture) = &self.moisture {
            return moisture.place_of_potential(potential);
        }
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

    /// Heat flux (W/m2) that enters through a film into a particle with potential `inside` (W/m) whose centre is `depth` (m)
    /// behind the wall.
    pub fn film_flux(&self, inside: f64, depth: f64, film: &Film) -> f64 {
        if film.is_closed() {
            return 0.0;
        }
        let wall = self.film_wall(inside, depth, film);
        let coefficient = film.coefficient(wall);
        // The smaller of the two differences of temperature would be lost in rounding.
        if coefficient * depth > self.most_conductive() {
            (self.potential(wall) - inside) / depth
        } else {
            coefficient * (film.ambient - wall)
        }
    }

    /// The temperature of the wall between them, at which film and ground carry the same flux.
    fn film_wall(&self, inside: f64, depth: f64, film: &Film) -> f64 {
        let ambient = film.ambient;
        if self.is_kinked() && film.is_linear() {
            let target = film.strength * depth;
            let warm = (target * (ambient - self.freezing_point) + inside) / (target + self.unfrozen_conductivity);
            let cold = (target * (ambient - self.freezing_point) + inside) / (target + self.frozen_conductivity);
            return self.freezing_point + if warm >= 0.0 { warm } else { cold };
        }
        let start = self.temperature_of_potential(inside);
        solve_increasing(
            |wall| {
                let missing = self.potential(wall) - inside + film.coefficient(wall) * depth * (wall - ambient);
                (missing, self.conductivity(wall) + film.steepness(wall) * depth)
            },
            start.min(ambient),
            start.max(ambient),
        )
    }

    /// How the flux of [`Curve::film_flux`] changes with the particle's potential (1/m).
    pub fn film_slope(&self, inside: f64, depth: f64, film: &Film) -> f64 {
        if film.is_closed() {
            return 0.0;
        }
        let wall = if film.is_linear() {
            film.ambient - self.film_flux(inside, depth, film) / film.strength
        } else {
            self.film_wall(inside, depth, film)
        };
        let steepness = film.steepness(wall);
        -steepness / (self.conductivity(wall) + steepness * depth)
    }

    /// The conductivity (W/mK) at all temperatures between two, if it is one.
    pub fn conductivity_between(&self, low: f64, high: f64) -> Option<f64> {
        if self.moisture.is_some() {
            return (low >= 0.0).then_some(self.unfrozen_conductivity);
        }
        if self.frozen_conductivity == self.unfrozen_conductivity || low >= self.freezing_point {
            Some(self.unfrozen_conductivity)
        } else if high <= self.freezing_point + self.coldest_change() {
            Some(self.coldest_conductivity())
        } else {
            None
        }
    }

    /// How many times better than another material this one conducts at all temperatures, if that is one number.
    pub fn scaled_from(&self, other: &Curve) -> Option<f64> {
        match (&self.moisture, &other.moisture) {
            (Some(own), Some(other)) => own.soil().scaled_from(other.soil()),
            (None, None) => {
                let constant = |curve: &Curve| curve.least_conductive() == curve.most_conductive();
                (constant(self) && constant(other)).then(|| self.most_conductive() / other.most_conductive())
            }
            _ => None,
        }
    }

    /// Whether another material stores the same at all temperatures.
    pub fn stores_like(&self, other: &Curve) -> bool {
        match (&self.moisture, &other.moisture) {
            (Some(own), Some(other)) => own.soil().holds_like(other.soil()),
            _ => false,
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
        let FreezingLaw::Curve(curve) = &self.law else { return ends };
        let pieces = curve.pieces();
        let samples = steps_each(DIFFUSIVITY_SAMPLES, pieces.len());
        let tops = std::iter::once(0.0).chain(pieces.iter().copied());
        tops.zip(&pieces)
            .flat_map(|(top, end)| (1..samples).map(move |k| top + (end - top) * k as f64 / samples as f64))
            .map(|below| self.freezing_point + below)
            .map(|temperature| self.conductivity(temperature) / self.apparent_capacity(temperature))
            .fold(ends, f64::max)
    }
}

impl HeapSize for Curve {
    fn heap_size(&self) -> usize {
        let law = match &self.law {
            FreezingLaw::None | FreezingLaw::Isothermal => 0,
            FreezingLaw::Curve(curve) => curve.heap_size(),
        };
        law + self.mixed_potential.heap_size() + self.moisture.as_ref().map_or(0, |moisture| moisture.heap_size())
    }
}
