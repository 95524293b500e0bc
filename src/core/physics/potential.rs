//! Temperature, frozen fraction and conduction potential of a particle, as functions of its enthalpy.
//!
//! A [`Curve`] knows a material's exact relations between temperature `T`, enthalpy `H` (J/m3, zero for unfrozen
//! material at the freezing point) and conduction potential `U = integral of k dT` from the freezing point (W/m).
//! A [`PotentialLaw`] is the one function of the inner loop, `H -> U`, with both counted from the initial state:
//! a body at rest then holds exact zeros, so nothing drifts and small changes are not lost in large sums.

use std::sync::Arc;

use crate::memory::HeapSize;
use crate::physics::curve::Curve;
use crate::physics::curved::Curved;
use crate::physics::retention::tabulated::Tabulated;

/// The function of the inner loop: enthalpy to potential, both counted from the initial state.
pub trait PotentialLaw: Clone + Send + Sync + 'static {
    /// Potential (W/m) less the initial potential, at an enthalpy (J/m3) less the initial enthalpy.
    fn potential(&self, enthalpy: f64) -> f64;
    /// Slope dU/dH (m2/s) at an enthalpy; at a kink, the steeper of the two.
    fn slope(&self, enthalpy: f64) -> f64;
    /// The law as one of three straight pieces, where it is one or is less.
    #[inline(always)]
    fn pieces(&self) -> Option<Kinked> {
        None
    }
    /// Potentials of many enthalpies.
    #[inline(always)]
    fn fill(&self, enthalpy: &[f64], potentials: &mut [f64]) {
        for (potential, enthalpy) in potentials.iter_mut().zip(enthalpy) {
            *potential = self.potential(*enthalpy);
        }
    }
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

    #[inline(always)]
    fn pieces(&self) -> Option<Kinked> {
        Straight { slope: 1.0 }.pieces()
    }
}

/// A law of three straight pieces: frozen, freezing, unfrozen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinked {
    pub(crate) frozen_slope: f64,
    pub(crate) unfrozen_slope: f64,
    pub(crate) frozen_below: f64,
    pub(crate) unfrozen_above: f64,
    pub(crate) frozen_rest: f64,
    pub(crate) unfrozen_rest: f64,
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

    #[inline(always)]
    fn pieces(&self) -> Option<Kinked> {
        Some(*self)
    }
}

/// A law without any change: potential and enthalpy in proportion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straight {
    pub(super) slope: f64,
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

    /// All of it frozen.
    #[inline(always)]
    fn pieces(&self) -> Option<Kinked> {
        Some(Kinked {
            frozen_slope: self.slope,
            unfrozen_slope: 0.0,
            frozen_below: f64::INFINITY,
            unfrozen_above: 0.0,
            frozen_rest: 0.0,
            unfrozen_rest: 0.0,
        })
    }
}

/// A law of a particle that stores the heat of several materials and conducts as one of them.
#[derive(Debug, Clone)]
pub struct Blended {
    pub(super) curve: Arc<Curve>,
    /// Initial enthalpy and potential.
    pub(super) zero: (f64, f64),
}

impl Blended {
    pub(super) fn potential(&self, enthalpy: f64) -> f64 {
        // A body at rest holds exact zeros.
        if enthalpy == 0.0 {
            return 0.0;
        }
        self.curve.potential(self.curve.temperature(enthalpy + self.zero.0)) - self.zero.1
    }

    fn slope(&self, enthalpy: f64) -> f64 {
        let absolute = enthalpy + self.zero.0;
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
    /// Along a freezing curve.
    Curved(Curved),
    /// Of unsaturated water.
    Tabulated(Tabulated),
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
            Law::Tabulated(law) => law.potential(enthalpy),
            Law::Blended(law) => law.potential(enthalpy),
        }
    }

    /// The slope dU/dH (m2/s), likewise.
    pub fn slope(&self, enthalpy: f64) -> f64 {
        match self {
            Law::Straight(law) => law.slope(enthalpy),
            Law::Kinked(law) => law.slope(enthalpy),
            Law::Curved(law) => law.slope(enthalpy),
            Law::Tabulated(law) => law.slope(enthalpy),
            Law::Blended(law) => law.slope(enthalpy),
        }
    }
}

impl HeapSize for Law {
    fn heap_size(&self) -> usize {
        match self {
            Law::Straight(_) | Law::Kinked(_) => 0,
            Law::Curved(law) => law.heap_size(),
            Law::Tabulated(law) => law.heap_size(),
            Law::Blended(_) => size_of::<Curve>(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::curve::TABLE_INTERVALS;
    use crate::physics::film::{FILMS, Film};
    use crate::physics::freezing_curve::linear::Linear;
    use crate::physics::freezing_curve::shape::{Given, InScenes, UnfrozenFraction};
    use crate::physics::freezing_curve::table::Table;
    use crate::physics::freezing_curve::van_genuchten::VanGenuchten;
    use crate::physics::freezing_curve::weibull::Weibull;
    use crate::physics::material::{FreezingLaw, Material, Mixing, Phase};
    use crate::physics::thermal::Thermal;

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
            soil: None,
        })
    }

    /// Materials, with how near (K, at the conductivity of ice) the law of the inner loop comes to the exact one.
    fn laws_with_accuracies() -> Vec<(Curve, f64)> {
        let mut curves = vec![(water(FreezingLaw::Isothermal, Mixing::Arithmetic), 0.0)];
        for mixing in [Mixing::Arithmetic, Mixing::Geometric] {
            for width in [0.01, 0.5, 3.0] {
                let weibull = |residual: f64| Weibull { width, residual }.into();
                for law in [Linear { width }.into(), weibull(0.0), weibull(0.2)] {
                    curves.push((water(law, mixing), 1e-7 * width));
                }
                let given = |values: &[&[f64]]| Given {
                    freezing_point: 0.0,
                    absolute_zero: -273.15,
                    values: values.iter().map(|values| values.to_vec()).collect(),
                };
                // The suction of a kelvin is 125 m.
                let alpha = 1.0 / (125.0 * width);
                let soil = VanGenuchten::new(&given(&[&[alpha], &[1.6], &[0.05]])).expect("a curve");
                let table = Table::new(&given(&[&[-4.0 * width, -width, 0.0], &[0.1, 0.4, 1.0]])).expect("a curve");
                curves.push((water(soil.into(), mixing), 1e-7 * width));
                // A point falls between two nodes, which are nearer to each other than even ones.
                curves.push((water(table.into(), mixing), 4.0 * width / TABLE_INTERVALS as f64));
            }
        }
        curves
    }

    fn laws() -> impl Iterator<Item = Curve> {
        laws_with_accuracies().into_iter().map(|law| law.0)
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
                // A kink may fall between two of the sampled temperatures.
                let pieces = match &curve.law {
                    FreezingLaw::Curve(curve) => curve.pieces(),
                    _ => Vec::new(),
                };
                let scale = curve.apparent_capacity(temperature);
                assert!(
                    (capacity / scale - 1.0).abs() < 2e-5 || pieces.iter().any(|end| (temperature - end).abs() <= step)
                );
                assert!((conductivity / curve.conductivity(temperature) - 1.0).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn the_inner_law_is_the_exact_potential() {
        for (curve, accuracy) in laws_with_accuracies() {
            for initial in [8.0, -20.0] {
                let thermal = Thermal::new(curve.clone(), initial);
                let (mut worst, mut at): (f64, f64) = (0.0, 0.0);
                for k in 0..20_000 {
                    let enthalpy = -4.2e8 + 4.7e8 * k as f64 / 20_000.0;
                    let exact = curve.potential(curve.temperature(enthalpy)) - thermal.zero_potential;
                    let error = (thermal.law.potential(enthalpy - thermal.zero_enthalpy) - exact).abs();
                    if error > worst {
                        worst = error;
                        at = enthalpy;
                    }
                }
                // Or rounding of the range.
                assert!(worst / 2.14 <= accuracy + 1e-12, "{:?} from {initial}: {} K at {at}", curve.law, worst / 2.14);
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

    /// Soils at the ends of what keys allow: a law is a law, however near to a jump or to nothing.
    #[test]
    fn laws_of_extreme_soils_rise_and_have_inverses() {
        for (alpha, n) in [(1e-30, 1.5), (1e-3, 1.0 + 1e-12), (1.0, 20.0), (1e4, 20.0), (1e4, 1.001)] {
            for mixing in [Mixing::Arithmetic, Mixing::Geometric] {
                let values = vec![vec![alpha], vec![n], vec![0.0]];
                let given = Given { freezing_point: 0.0, absolute_zero: -273.15, values };
                let curve = water(VanGenuchten::new(&given).expect("a curve").into(), mixing);
                let thermal = Thermal::new(curve.clone(), 5.0);
                assert!(thermal.largest_slope.is_finite() && thermal.largest_slope > 0.0);
                let mut last = f64::NEG_INFINITY;
                for temperature in temperatures() {
                    let enthalpy = curve.enthalpy(temperature);
                    let potential = thermal.law.potential(enthalpy - thermal.zero_enthalpy);
                    assert!(potential >= last, "{alpha} {n} at {temperature}: {potential} {last}");
                    last = potential;
                    let back = curve.enthalpy(curve.temperature(enthalpy));
                    // Rounding of the temperature, which latent heat multiplies, and of sums as large as that.
                    let rounding = curve.apparent_capacity(temperature) * temperature.abs() + curve.latent_heat;
                    assert!((back - enthalpy).abs() <= 8.0 * f64::EPSILON * rounding, "{alpha} {n} at {temperature}");
                }
            }
        }
    }

    #[test]
    fn film_flux_matches_conduction_behind_the_wall() {
        for curve in laws() {
            for (inside, ambient) in [(4.8, -20.0), (-30.0, 5.0), (0.0, -1.0), (-0.1, -30.0)] {
                for (kind, strength, depth) in FILMS.iter().flat_map(|kind| [(*kind, 0.9, 0.05), (*kind, 0.3, 0.001)]) {
                    let film = Film { kind, strength, ambient };
                    let flux = curve.film_flux(inside, depth, &film);
                    let wall = curve.temperature_of_potential(inside + flux * depth);
                    // Balance of film and conduction, to the rounding of the potentials.
                    let through = film.coefficient(wall) * (ambient - wall);
                    assert!((through - flux).abs() * depth < 1e-9 * inside.abs().max(1.0), "{kind:?} {flux} {through}");
                    // A film is never steeper than a wall of given temperature.
                    let slope = curve.film_slope(inside, depth, &film);
                    assert!(slope < 0.0 && slope > -1.0 / depth);
                    let step = 1e-6;
                    let beside = |inside: f64| curve.film_flux(inside, depth, &film);
                    let measured = (beside(inside + step) - beside(inside - step)) / (2.0 * step);
                    // Not where the wall stands at a kink; else to rounding of the differences.
                    let steady = |below: f64| curve.conductivity(wall + below) / curve.conductivity(wall - below) - 1.0;
                    assert!((measured / slope - 1.0).abs() < 1e-4 || steady(1e-5).abs() > 1e-4, "{measured} {slope}");
                }
            }
        }
    }
}
