//! How particles take up heat: enthalpy, flags with accumulators, or an apparent heat capacity.

use std::sync::Arc;

use crate::memory::HeapSize;
use crate::physics::potential::{Law, PotentialLaw};
use crate::physics::retention::answer::answer;
use crate::physics::thermal::Thermal;
use crate::saved::{Pass, Saved};

/// How latent heat is taken up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LatentHeatScheme {
    /// Enthalpy is the unknown; temperature follows from it.
    Enthalpy,
    /// Temperature and an accumulator of latent heat with a state flag (Chen and Bai 2016, section 1.3), the
    /// overshoot at either end credited.
    Flags,
    /// Temperature with an apparent heat capacity (Nikolaev et al. 2021, eq 13). A sharp front is spread over
    /// `interval` kelvin below the freezing point.
    ApparentCapacity {
        /// Width of the interval (K).
        interval: f64,
    },
}

/// How a particle inside the freezing interval conducts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mushy {
    /// By its frozen fraction (Ng et al. 2017, section 4.1).
    Fraction,
    /// As the phase that it last was.
    LastPhase,
    /// As half of it were frozen, however much is (Nikolaev et al. 2023, eq 1).
    Mean,
}

/// What pairs read from particles; columns that nothing reads stay empty.
#[derive(Debug, Clone, Default)]
pub struct Fields {
    /// Conduction potential, relative to each material's initial state (W/m).
    pub potential: Vec<f64>,
    /// Temperature; of water the pressure head (m).
    pub temperature: Vec<f64>,
    /// Conductivity (W/mK); of water the hydraulic one (m/s).
    pub conductivity: Vec<f64>,
}

/// Materials of particles: one for all, or one each.
#[derive(Debug, Clone)]
pub struct Materials {
    /// Laws by material.
    pub thermals: Arc<[Thermal]>,
    /// Material of each particle; empty if there is only one.
    pub of_particle: Vec<u8>,
    /// Laws of particles whose cells interfaces cut ([`crate::physics::blend`]).
    pub blends: Arc<[Thermal]>,
    /// Law of each particle, those of `blends` numbered after the materials'; empty if no cell is cut.
    pub law_of: Vec<u32>,
}

impl Materials {
    /// Laws of materials, and the material of each particle.
    pub fn new(thermals: Arc<[Thermal]>, of_particle: Vec<u8>) -> Self {
        Materials { thermals, of_particle, blends: Arc::new([]), law_of: Vec::new() }
    }

    /// Takes changes that a system linearised at a state wants into it. Contents of water follow as what holds them back does:
    /// their potential, times `stiffness` (s/m2), and where gravity pulls their conductivity, times `falls` (s/m). `slopes` (m2/s)
    /// are those of the potentials at the state.
    pub(crate) fn take(&self, state: &mut [f64], changes: &[f64], slopes: &[f64], (stiffness, falls): (f64, f64)) {
        if self.thermals[0].curve.moisture().is_none() {
            return state.iter_mut().zip(changes).for_each(|(state, change)| *state += change);
        }
        for (i, ((state, change), slope)) in state.iter_mut().zip(changes).zip(slopes).enumerate() {
            let (thermal, slope) = (self.of(i), stiffness * slope);
            *state = match (&thermal.law, thermal.conducting().filter(|_| falls > 0.0)) {
                (Law::Tabulated(law), None) => {
                    answer(*state, *change, slope, |at| (stiffness * law.potential(at), stiffness * law.slope(at)))
                }
                (Law::Tabulated(law), Some(conducting)) => {
                    let slope = slope + falls * conducting.slope(*state);
                    answer(*state, *change, slope, |at| {
                        let held = stiffness * law.potential(at) + falls * conducting.at(at);
                        (held, stiffness * law.slope(at) + falls * conducting.slope(at))
                    })
                }
                _ => *state + change,
            };
        }
    }

    /// The laws of some of the particles.
    pub fn of_some(&self, particles: &[u32]) -> Self {
        let some = |all: &[u8]| particles.iter().filter_map(|particle| all.get(*particle as usize).copied()).collect();
        let laws = particles.iter().filter_map(|particle| self.law_of.get(*particle as usize).copied()).collect();
        Materials {
            thermals: self.thermals.clone(),
            of_particle: some(&self.of_particle),
            blends: self.blends.clone(),
            law_of: laws,
        }
    }

    /// The law of all particles, where it is one.
    pub fn single(&self) -> Option<&Thermal> {
        self.of_particle.is_empty().then(|| &self.thermals[0])
    }

    /// The law of a particle.
    #[inline(always)]
    pub fn of(&self, particle: usize) -> &Thermal {
        if self.of_particle.is_empty() {
            &self.thermals[0]
        } else if self.law_of.is_empty() {
            &self.thermals[self.of_particle[particle] as usize]
        } else {
            let law = self.law_of[particle] as usize;
            match law.checked_sub(self.thermals.len()) {
                None => &self.thermals[law],
                Some(blend) => &self.blends[blend],
            }
        }
    }

    /// All laws, in the order of their numbers.
    pub fn laws(&self) -> impl Iterator<Item = &Thermal> {
        self.thermals.iter().chain(self.blends.iter())
    }

    /// Number of a particle's law.
    pub fn law(&self, particle: usize) -> usize {
        match self.law_of.get(particle) {
            Some(law) => *law as usize,
            None => self.index(particle),
        }
    }

    /// Index of a particle's material.
    pub fn index(&self, particle: usize) -> usize {
        self.of_particle.get(particle).map_or(0, |material| *material as usize)
    }

    /// Whether there is more than one.
    pub fn mixed(&self) -> bool {
        !self.of_particle.is_empty()
    }
}

/// A scheme: turns its state into fields, and heat into state.
pub trait SchemeState: Send + HeapSize + Saved {
    /// Fills the non-empty columns of `fields` (of the first particles).
    fn read(&self, materials: &Materials, enthalpy: &[f64], fields: &mut Fields);
    /// Adds `step` times the rates (W/m3).
    fn add(&mut self, materials: &Materials, enthalpy: &mut [f64], rate: &[f64], step: f64);
    /// Brings the column of enthalpies up to date.
    fn publish(&self, materials: &Materials, enthalpy: &mut [f64]);
}

/// The scheme of a choice, for `count` particles that carry the enthalpies of `start`, or none if that is empty.
pub fn scheme(
    choice: LatentHeatScheme,
    mushy: Mushy,
    materials: &Materials,
    start: &[f64],
    count: usize,
) -> Box<dyn SchemeState> {
    let carried = |i: usize| start.get(i).copied().unwrap_or(0.0);
    let frozen = |i: usize| materials.of(i).frozen_fraction(carried(i));
    let temperature = || (0..count).map(|i| materials.of(i).temperature(carried(i))).collect();
    match choice {
        LatentHeatScheme::Enthalpy if mushy == Mushy::Fraction => Box::new(Enthalpy),
        LatentHeatScheme::Enthalpy if mushy == Mushy::Mean => Box::new(HalfFrozen),
        LatentHeatScheme::Enthalpy => Box::new(LastPhase { frozen: (0..count).map(|i| frozen(i) >= 1.0).collect() }),
        LatentHeatScheme::Flags => Box::new(Flags {
            temperature: temperature(),
            released: (0..count).map(|i| frozen(i) * materials.of(i).curve.latent_heat()).collect(),
            mushy,
        }),
        LatentHeatScheme::ApparentCapacity { .. } => Box::new(ApparentCapacity { temperature: temperature() }),
    }
}

/// Enthalpy is the unknown.
struct Enthalpy;

impl HeapSize for Enthalpy {
    fn heap_size(&self) -> usize {
        0
    }
}

impl Saved for Enthalpy {
    fn pass(&mut self, _: &mut Pass<'_>) {}
}

impl SchemeState for Enthalpy {
    fn read(&self, materials: &Materials, enthalpy: &[f64], fields: &mut Fields) {
        let Fields { potential, temperature, conductivity } = fields;
        for (run, thermal) in materials.runs(0..enthalpy.len()) {
            let enthalpy = &enthalpy[run.clone()];
            if !potential.is_empty() {
                thermal.law.fill(enthalpy, &mut potential[run.clone()]);
            }
            if !temperature.is_empty() {
                thermal.fill_temperatures(enthalpy, &mut temperature[run.clone()]);
            }
            if !conductivity.is_empty() {
                thermal.fill_conductivities(enthalpy, &mut conductivity[run]);
            }
        }
    }

    fn add(&mut self, _materials: &Materials, enthalpy: &mut [f64], rate: &[f64], step: f64) {
        for (h, rate) in enthalpy.iter_mut().zip(rate) {
            *h += step * rate;
        }
    }

    fn publish(&self, _materials: &Materials, _enthalpy: &mut [f64]) {}
}

/// Enthalpy, with the conductivity of the last whole phase (the state rule that mushy particles replaced: Ng et
/// al. 2017, section 4.1).
struct LastPhase {
    frozen: Vec<bool>,
}

impl HeapSize for LastPhase {
    fn heap_size(&self) -> usize {
        self.frozen.heap_size()
    }
}

impl Saved for LastPhase {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.frozen]);
    }
}

impl SchemeState for LastPhase {
    fn read(&self, materials: &Materials, enthalpy: &[f64], fields: &mut Fields) {
        Enthalpy.read(materials, enthalpy, fields);
        for (i, (conductivity, frozen)) in fields.conductivity.iter_mut().zip(&self.frozen).enumerate() {
            *conductivity = materials.of(i).curve.mixed_conductivity(if *frozen { 0.0 } else { 1.0 });
        }
    }

    fn add(&mut self, materials: &Materials, enthalpy: &mut [f64], rate: &[f64], step: f64) {
        Enthalpy.add(materials, enthalpy, rate, step);
        for (i, (frozen, h)) in self.frozen.iter_mut().zip(enthalpy).enumerate() {
            let fraction = materials.of(i).frozen_fraction(*h);
            *frozen = fraction >= 1.0 || (*frozen && fraction > 0.0);
        }
    }

    fn publish(&self, _materials: &Materials, _enthalpy: &mut [f64]) {}
}

/// A frozen fraction as Nikolaev et al. 2023 see it in eq 1: none, half or all.
fn half(frozen: f64) -> f64 {
    if frozen > 0.0 && frozen < 1.0 { 0.5 } else { frozen }
}

/// Enthalpy, with the mean conductivity of both phases throughout the freezing interval.
struct HalfFrozen;

impl HeapSize for HalfFrozen {
    fn heap_size(&self) -> usize {
        0
    }
}

impl Saved for HalfFrozen {
    fn pass(&mut self, _: &mut Pass<'_>) {}
}

impl SchemeState for HalfFrozen {
    fn read(&self, materials: &Materials, enthalpy: &[f64], fields: &mut Fields) {
        Enthalpy.read(materials, enthalpy, fields);
        for (i, (conductivity, h)) in fields.conductivity.iter_mut().zip(enthalpy).enumerate() {
            let thermal = materials.of(i);
            *conductivity = thermal.curve.mixed_conductivity(1.0 - half(thermal.frozen_fraction(*h)));
        }
    }

    fn add(&mut self, materials: &Materials, enthalpy: &mut [f64], rate: &[f64], step: f64) {
        Enthalpy.add(materials, enthalpy, rate, step);
    }

    fn publish(&self, _materials: &Materials, _enthalpy: &mut [f64]) {}
}

/// Temperature and an accumulator of released latent heat (Chen and Bai 2016, section 1.3). The flag is the
/// accumulator itself: empty is unfrozen, full is frozen, between them the temperature stands still. What a step
/// overshoots at either end is credited to the other side, so no heat is lost.
struct Flags {
    temperature: Vec<f64>,
    released: Vec<f64>,
    mushy: Mushy,
}

impl HeapSize for Flags {
    fn heap_size(&self) -> usize {
        self.temperature.heap_size() + self.released.heap_size()
    }
}

impl Saved for Flags {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.temperature, &mut self.released]);
    }
}

impl SchemeState for Flags {
    fn read(&self, materials: &Materials, _enthalpy: &[f64], fields: &mut Fields) {
        for (i, (potential, t)) in fields.potential.iter_mut().zip(&self.temperature).enumerate() {
            *potential = materials.of(i).potential_at(*t);
        }
        for (temperature, t) in fields.temperature.iter_mut().zip(&self.temperature) {
            *temperature = *t;
        }
        // Columns are longer than the particles: ghosts stand behind them.
        for (i, (conductivity, t)) in fields.conductivity.iter_mut().zip(&self.temperature).enumerate() {
            let curve = &materials.of(i).curve;
            let frozen = if curve.latent_heat() > 0.0 {
                self.released[i] / curve.latent_heat()
            } else {
                f64::from(u8::from(*t < curve.freezing_point()))
            };
            let frozen = match self.mushy {
                Mushy::Fraction => frozen,
                Mushy::LastPhase => frozen.floor(),
                Mushy::Mean => half(frozen),
            };
            *conductivity = curve.mixed_conductivity(1.0 - frozen);
        }
    }

    fn add(&mut self, materials: &Materials, _enthalpy: &mut [f64], rate: &[f64], step: f64) {
        for i in 0..self.temperature.len() {
            let curve = &materials.of(i).curve;
            let (freezing_point, latent) = (curve.freezing_point(), curve.latent_heat());
            let (t, released) = (&mut self.temperature[i], &mut self.released[i]);
            let mut heat = step * rate[i];
            // At most three stretches: out of one phase, through the change, into the other. Without latent heat the
            // temperature alone tells the phase.
            if *released <= 0.0 && (latent > 0.0 || *t >= freezing_point) {
                *t += heat / curve.unfrozen_capacity();
                heat = ((*t - freezing_point) * curve.unfrozen_capacity()).min(0.0);
            } else if *released >= latent {
                *t += heat / curve.frozen_capacity();
                heat = ((*t - freezing_point) * curve.frozen_capacity()).max(0.0);
            }
            if heat == 0.0 {
                continue;
            }
            *t = freezing_point;
            *released -= heat;
            if *released > latent {
                *t = freezing_point - (*released - latent) / curve.frozen_capacity();
                *released = latent;
            } else if *released < 0.0 {
                *t = freezing_point - *released / curve.unfrozen_capacity();
                *released = 0.0;
            }
        }
    }

    fn publish(&self, materials: &Materials, enthalpy: &mut [f64]) {
        for (i, h) in enthalpy.iter_mut().enumerate() {
            let thermal = materials.of(i);
            let curve = &thermal.curve;
            let offset = self.temperature[i] - curve.freezing_point();
            let sensible = offset * if offset < 0.0 { curve.frozen_capacity() } else { curve.unfrozen_capacity() };
            *h = sensible - self.released[i] - thermal.zero_enthalpy;
        }
    }
}

/// Temperature with an apparent heat capacity (Nikolaev et al. 2021, eqs 13 and 47): a step may jump over the
/// freezing interval and lose latent heat, and the heat balance shows it.
struct ApparentCapacity {
    temperature: Vec<f64>,
}

impl HeapSize for ApparentCapacity {
    fn heap_size(&self) -> usize {
        self.temperature.heap_size()
    }
}

impl Saved for ApparentCapacity {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.temperature]);
    }
}

impl SchemeState for ApparentCapacity {
    fn read(&self, materials: &Materials, _enthalpy: &[f64], fields: &mut Fields) {
        for (i, (potential, t)) in fields.potential.iter_mut().zip(&self.temperature).enumerate() {
            *potential = materials.of(i).potential_at(*t);
        }
        for (temperature, t) in fields.temperature.iter_mut().zip(&self.temperature) {
            *temperature = *t;
        }
        for (i, (conductivity, t)) in fields.conductivity.iter_mut().zip(&self.temperature).enumerate() {
            *conductivity = materials.of(i).curve.conductivity(*t);
        }
    }

    fn add(&mut self, materials: &Materials, _enthalpy: &mut [f64], rate: &[f64], step: f64) {
        for (i, (t, rate)) in self.temperature.iter_mut().zip(rate).enumerate() {
            *t += step * rate / materials.of(i).curve.apparent_capacity(*t);
        }
    }

    fn publish(&self, materials: &Materials, enthalpy: &mut [f64]) {
        for (i, (h, t)) in enthalpy.iter_mut().zip(&self.temperature).enumerate() {
            *h = materials.of(i).enthalpy(*t);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::curve::Curve;
    use crate::physics::freezing_curve::linear::Linear;
    use crate::physics::material::{FreezingLaw, Material, Mixing, Phase};
    use proptest::prelude::*;

    fn materials(law: FreezingLaw, initial: f64) -> Materials {
        let curve = Curve::new(&Material {
            name: "water".into(),
            density: 1000.0,
            frozen: Phase { conductivity: 2.14, heat_capacity: 2060.0 },
            unfrozen: Phase { conductivity: 0.6, heat_capacity: 4182.0 },
            freezing_point: 0.0,
            latent_heat: 334_000.0,
            law,
            mixing: Mixing::Arithmetic,
            pores: None,
            soil: None,
        });
        Materials::new(vec![Thermal::new(curve, initial)].into(), Vec::new())
    }

    proptest! {
        /// Flags with credited overshoot are the enthalpy method in other words, whatever heat comes and goes.
        #[test]
        fn flags_store_every_joule(heats in prop::collection::vec(-6e8..6e8f64, 1..60), initial in -30.0..30.0f64) {
            prop_assume!(initial.abs() > 1e-3);
            let materials = materials(FreezingLaw::Isothermal, initial);
            let mut scheme = scheme(LatentHeatScheme::Flags, Mushy::Fraction, &materials, &[], 1);
            let (mut enthalpy, mut sum) = ([0.0], 0.0);
            for heat in heats {
                scheme.add(&materials, &mut [], &[heat], 1.0);
                sum += heat;
                scheme.publish(&materials, &mut enthalpy);
                // Rounding of sums of up to sixty terms of 6e8.
                prop_assert!((enthalpy[0] - sum).abs() < 1e-4, "{} {}", enthalpy[0], sum);
                let mut fields = Fields { temperature: vec![0.0], ..Fields::default() };
                scheme.read(&materials, &[], &mut fields);
                prop_assert!((fields.temperature[0] - materials.thermals[0].temperature(sum)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn every_scheme_leaves_the_places_of_ghosts_alone() {
        let materials = materials(FreezingLaw::Isothermal, 2.0);
        for choice in
            [LatentHeatScheme::Enthalpy, LatentHeatScheme::Flags, LatentHeatScheme::ApparentCapacity { interval: 1.0 }]
        {
            for mushy in [Mushy::Fraction, Mushy::LastPhase, Mushy::Mean] {
                let scheme = scheme(choice, mushy, &materials, &[], 2);
                let column = || vec![-7.0; 3];
                let mut fields = Fields { potential: column(), temperature: column(), conductivity: column() };
                scheme.read(&materials, &[0.0; 2], &mut fields);
                assert_eq!((fields.potential[2], fields.temperature[2], fields.conductivity[2]), (-7.0, -7.0, -7.0));
                assert_eq!((fields.temperature[1], fields.conductivity[1]), (2.0, 0.6), "{choice:?}");
            }
        }
    }

    #[test]
    fn apparent_capacity_loses_latent_heat_in_a_long_step() {
        let materials = materials(Linear { width: 1.0 }.into(), 0.5);
        let mut scheme =
            scheme(LatentHeatScheme::ApparentCapacity { interval: 1.0 }, Mushy::Fraction, &materials, &[], 1);
        let mut enthalpy = [0.0];
        scheme.add(&materials, &mut [], &[-1e7], 1.0);
        scheme.publish(&materials, &mut enthalpy);
        // 1e7 J/m3 cools water by 2.4 K, past the whole interval: nearly all latent heat appears from nowhere.
        assert!(enthalpy[0] < -3e8);
    }
}
