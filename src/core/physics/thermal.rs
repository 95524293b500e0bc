//! A material in the enthalpies and potentials of a run, both relative to those of one temperature.

use std::sync::{Arc, OnceLock};

use crate::physics::blend::Blend;
use crate::physics::curve::Curve;
use crate::physics::curved::Curved;
use crate::physics::material::Material;
use crate::physics::potential::{Blended, Kinked, Law, Straight};
use crate::physics::retention::conducting::Conducting;
use crate::physics::retention::tabulated::Tabulated;

/// The law of one material as the step needs it, with the exact curve beside it.
#[derive(Debug, Clone)]
pub struct Thermal {
    /// Exact relations.
    pub curve: Curve,
    /// Temperature of zero enthalpy: that at which the body starts, or saturation, where heads are in place of temperatures. The
    /// distance of a content from saturation then has all its digits, which decide on conductivity there.
    pub zero_temperature: f64,
    /// Enthalpy (J/m3) at that temperature, the zero of the enthalpies that particles carry.
    pub zero_enthalpy: f64,
    /// Potential (W/m) at which the body starts, the zero of the potentials that pairs exchange.
    pub zero_potential: f64,
    /// Head and hydraulic conductivity of water, once they are asked for.
    conducting: OnceLock<Arc<Conducting>>,
    /// The inner loop's function.
    pub law: Law,
    /// Largest slope dU/dH (m2/s) of the inner loop's function.
    pub largest_slope: f64,
}

impl Thermal {
    /// Enthalpies (J/m3) of a particle at the freezing point, frozen and unfrozen; none where it freezes over an interval.
    pub fn freezing_interval(&self) -> Option<(f64, f64)> {
        let unfrozen = self.enthalpy(self.curve.freezing_point());
        self.curve.is_sharp().then(|| (unfrozen - self.curve.latent_heat(), unfrozen))
    }

    /// Potential (W/m) at the freezing point, as the law itself has it, to the last bit; none where it freezes over an interval.
    pub fn front_potential(&self) -> Option<f64> {
        self.freezing_interval().map(|(frozen, unfrozen)| self.law.potential(0.5 * (frozen + unfrozen)))
    }

    /// Prepares a material of a body that starts at a temperature, from which enthalpies count; those of water count from saturation.
    pub fn new(curve: Curve, initial_temperature: f64) -> Self {
        let zero_temperature = if curve.moisture().is_some() { 0.0 } else { initial_temperature };
        let zero_enthalpy = curve.enthalpy(zero_temperature);
        let zero_potential = curve.potential(initial_temperature);
        let (law, largest_slope) = if curve.is_kinked() {
            let frozen_below = -curve.latent_heat - zero_enthalpy;
            let unfrozen_above = -zero_enthalpy;
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
        } else if let Some(moisture) = curve.moisture() {
            let law = Tabulated::new(moisture, curve.enthalpy(initial_temperature));
            (Law::Tabulated(law), curve.most_conductive() / curve.least_capacity())
        } else {
            let law = Curved::new(&curve, zero_enthalpy);
            (Law::Curved(law), curve.largest_diffusivity())
        };
        let conducting = OnceLock::new();
        Thermal { curve, zero_temperature, zero_enthalpy, zero_potential, conducting, law, largest_slope }
    }

    /// Another material that starts at the same temperature, where its law follows from this one's: of soils that differ in
    /// conductivity alone.
    pub fn shared(&self, material: &Material, initial_temperature: f64) -> Option<Self> {
        let Law::Tabulated(law) = &self.law else { return None };
        let curve = Curve::of_water(self.curve.moisture()?.shared(material.soil.as_ref()?)?);
        Some(Thermal {
            zero_temperature: self.zero_temperature,
            zero_enthalpy: self.zero_enthalpy,
            zero_potential: curve.potential(initial_temperature),
            conducting: OnceLock::new(),
            law: Law::Tabulated(law.shared(curve.most_conductive())),
            largest_slope: curve.most_conductive() / curve.least_capacity(),
            curve,
        })
    }

    /// Head and hydraulic conductivity by content, of water.
    pub fn conducting(&self) -> Option<&Arc<Conducting>> {
        let moisture = self.curve.moisture()?;
        Some(self.conducting.get_or_init(|| Arc::new(Conducting::new(moisture))))
    }

    /// The law of a particle that conducts as one material and stores the heat of several.
    pub fn blended(own: &Thermal, blend: Arc<Blend>) -> Self {
        let curve = Curve { blend: Some(blend), ..own.curve.clone() };
        let zero = (curve.enthalpy(own.zero_temperature), own.zero_potential);
        // Latent heat only adds to what it stores.
        let largest_slope = curve.most_conductive() / curve.least_capacity();
        Thermal {
            zero_temperature: own.zero_temperature,
            zero_enthalpy: zero.0,
            zero_potential: zero.1,
            conducting: OnceLock::new(),
            law: Law::Blended(Blended { curve: Arc::new(curve.clone()), zero }),
            largest_slope,
            curve,
        }
    }

    /// Temperature of a particle from the enthalpy that it carries.
    pub fn temperature(&self, enthalpy: f64) -> f64 {
        if enthalpy == 0.0 { self.zero_temperature } else { self.curve.temperature(enthalpy + self.zero_enthalpy) }
    }

    /// Frozen fraction of a particle from the enthalpy that it carries.
    #[inline]
    pub fn frozen_fraction(&self, enthalpy: f64) -> f64 {
        match &self.law {
            Law::Tabulated(law) => law.deficit(enthalpy),
            _ => self.curve.frozen_fraction(enthalpy + self.zero_enthalpy),
        }
    }

    /// Heat that a particle lacks, from the enthalpy that it carries, against the unfrozen state at the freezing point, in units of the
    /// latent heat.
    #[inline]
    pub fn latent_heat_lacked(&self, enthalpy: f64) -> f64 {
        -(enthalpy + self.zero_enthalpy) / self.curve.latent_heat
    }

    /// Frozen fractions of several particles from the enthalpies that they carry, after those that are in `fractions`.
    pub fn frozen_fractions(&self, enthalpies: &[f64], fractions: &mut Vec<f64>) {
        if self.curve.is_sharp() {
            let fraction = |enthalpy: &f64| self.latent_heat_lacked(*enthalpy).clamp(0.0, 1.0);
            fractions.extend(enthalpies.iter().map(fraction));
        } else {
            fractions.extend(enthalpies.iter().map(|enthalpy| self.frozen_fraction(*enthalpy)));
        }
    }

    /// Enthalpy that a particle carries at a temperature.
    pub fn enthalpy(&self, temperature: f64) -> f64 {
        self.curve.enthalpy(temperature) - self.zero_enthalpy
    }

    /// Potential, less that of zero enthalpy, at a temperature.
    pub fn potential_at(&self, temperature: f64) -> f64 {
        self.curve.potential(temperature) - self.zero_potential
    }
}
