//! What pairs on a list read from particles, for neighbours of one law at once.

use std::ops::Range;

use crate::instruction_set::widest;
use crate::physics::latent_heat::Materials;
use crate::physics::material::FreezingLaw;
use crate::physics::mixing::Mixing;
use crate::physics::potential::{Law, PotentialLaw};
use crate::physics::thermal::Thermal;

widest!(fill, fill_each[L: PotentialLaw], (law: &L, enthalpy: &[f64], potentials: &mut [f64]));
widest!(temperatures, kinked_temperatures, (thermal: &Thermal, enthalpy: &[f64], temperatures: &mut [f64]));
widest!(conductivities, kinked_conductivities, (thermal: &Thermal, enthalpy: &[f64], conductivities: &mut [f64]));

#[inline(always)]
fn fill_each<L: PotentialLaw>(law: &L, enthalpy: &[f64], potentials: &mut [f64]) {
    law.fill(enthalpy, potentials);
}

impl Materials {
    /// Runs of neighbouring particles of one law, among some.
    pub(crate) fn runs(&self, among: Range<usize>) -> impl Iterator<Item = (Range<usize>, &Thermal)> + '_ {
        let (mut first, end) = (among.start, among.end);
        std::iter::from_fn(move || {
            let run = first..if self.mixed() { self.end_of_run(first, end) } else { end };
            first = run.end;
            (!run.is_empty()).then(|| (run.clone(), self.of(run.start)))
        })
    }

    fn end_of_run(&self, first: usize, end: usize) -> usize {
        (first..end).find(|particle| self.law(*particle) != self.law(first)).unwrap_or(end)
    }
}

impl Law {
    /// Potentials of many enthalpies.
    pub fn fill(&self, enthalpy: &[f64], potentials: &mut [f64]) {
        match self {
            Law::Straight(law) => fill(law, enthalpy, potentials),
            Law::Kinked(law) => fill(law, enthalpy, potentials),
            Law::Curved(law) => fill(law, enthalpy, potentials),
            Law::Tabulated(law) => fill(law, enthalpy, potentials),
            Law::Blended(law) => {
                for (potential, enthalpy) in potentials.iter_mut().zip(enthalpy) {
                    *potential = law.potential(*enthalpy);
                }
            }
        }
    }
}

impl Thermal {
    /// Temperatures of many particles from the enthalpies that they carry; of water the pressure heads (m).
    pub(crate) fn fill_temperatures(&self, enthalpy: &[f64], temperatures: &mut [f64]) {
        if self.is_kinked() {
            return self::temperatures(self, enthalpy, temperatures);
        }
        let water = self.conducting();
        for (temperature, h) in temperatures.iter_mut().zip(enthalpy) {
            *temperature = water.map_or_else(|| self.temperature(*h), |water| water.head(*h));
        }
    }

    /// Conductivities (W/mK) of many particles from the enthalpies that they carry; of water the hydraulic ones (m/s).
    pub(super) fn fill_conductivities(&self, enthalpy: &[f64], conductivities: &mut [f64]) {
        if self.is_kinked() && self.curve.mixing == Mixing::Arithmetic {
            return self::conductivities(self, enthalpy, conductivities);
        }
        let water = self.conducting();
        for (conductivity, h) in conductivities.iter_mut().zip(enthalpy) {
            *conductivity = match water {
                Some(water) => water.at(*h),
                None => self.curve.mixed_conductivity(1.0 - self.frozen_fraction(*h)),
            };
        }
    }

    fn is_kinked(&self) -> bool {
        self.curve.is_kinked() && self.curve.blend.is_none()
    }
}

/// [`Thermal::temperature`] without a branch.
#[inline(always)]
fn kinked_temperatures(thermal: &Thermal, enthalpy: &[f64], temperatures: &mut [f64]) {
    let curve = &thermal.curve;
    let latent_heat = if matches!(curve.law, FreezingLaw::None) { 0.0 } else { curve.latent_heat };
    for (temperature, carried) in temperatures.iter_mut().zip(enthalpy) {
        let absolute = carried + thermal.zero_enthalpy;
        let frozen = absolute + latent_heat;
        let frozen = if frozen < 0.0 { frozen } else { 0.0 };
        let (heat, capacity) =
            if absolute >= 0.0 { (absolute, curve.unfrozen_capacity) } else { (frozen, curve.frozen_capacity) };
        let own = curve.freezing_point + heat / capacity;
        *temperature = if *carried == 0.0 { thermal.zero_temperature } else { own };
    }
}

/// Conductivities by a frozen fraction that is in proportion to the latent heat, without a branch.
#[inline(always)]
fn kinked_conductivities(thermal: &Thermal, enthalpy: &[f64], conductivities: &mut [f64]) {
    let curve = &thermal.curve;
    let freezes = !matches!(curve.law, FreezingLaw::None);
    for (conductivity, carried) in conductivities.iter_mut().zip(enthalpy) {
        let absolute = carried + thermal.zero_enthalpy;
        let frozen = if freezes { (-absolute / curve.latent_heat).clamp(0.0, 1.0) } else { 0.0 };
        let unfrozen = 1.0 - frozen;
        *conductivity = unfrozen * curve.unfrozen_conductivity + (1.0 - unfrozen) * curve.frozen_conductivity;
    }
}
