//! How long the next step should be, and whether the last one was good enough.

use crate::memory::{HeapSize, total};
use crate::physics::latent_heat::Materials;
use crate::saved::{Pass, Saved};
use crate::side_by_side::{MinMax, distance};

/// Longest growth and strongest shrinking from one step to the next.
const MOST_GROWTH: f64 = 2.0;
const MOST_SHRINKING: f64 = 0.2;

/// Safety of the proposed step against its own estimate.
const SAFETY: f64 = 0.9;

/// Steps by an error estimate. The error of a step is heat in the wrong place: the sum over particles of the estimated
/// error of their enthalpy, over the most heat that particles have held so far (against their start). It measures a
/// front of one cell in a large body by the heat that the front has moved, in any dimension and at any spacing.
#[derive(Debug, Clone)]
pub struct Control {
    /// Error allowed in one step.
    tolerance: f64,
    /// Exponent of the step's length in its error.
    order: f64,
    /// Steps up to this length are always good enough (s): explicit Euler's own.
    least: f64,
    next: f64,
    most_heat: f64,
    /// Whether the step that is being made was too long at first.
    shortened: bool,
}

/// What is to be done with a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Judgement {
    /// Keep it.
    Keep,
    /// Make it again, this long (s).
    Again(f64),
}

impl Saved for Control {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.next, &mut self.most_heat, &mut self.shortened]);
    }
}

impl Control {
    /// A control that starts with steps of `least` seconds.
    pub fn new(tolerance: f64, order: f64, least: f64) -> Self {
        Control { tolerance, order, least, next: least, most_heat: 0.0, shortened: false }
    }

    /// The step that should come next (s).
    pub fn next(&self) -> f64 {
        self.next
    }

    /// Whether a step's error is no more than is allowed, both by the sum of magnitudes of enthalpies (J/m3).
    pub fn is_small(&self, error: f64, state: f64) -> bool {
        error <= self.tolerance * self.most_heat.max(state)
    }

    /// Judges a step of length `step` (s) that moved particles to `state` with the estimated `error`, both by the sum
    /// of magnitudes of enthalpies (J/m3); `allowed` is what the step was cut to by others.
    pub fn judge(&mut self, step: f64, error: f64, state: f64) -> Judgement {
        let most_heat = self.most_heat.max(state);
        let relative = if error == 0.0 { 0.0 } else { error / most_heat };
        let factor = SAFETY * (self.tolerance / relative).powf(1.0 / self.order);
        let keep = relative <= self.tolerance || step <= self.least * (1.0 + 1e-9);
        if keep {
            self.most_heat = most_heat;
            // A step cut short by an output says nothing against a longer one.
            let grown = step * factor.min(if self.shortened { 1.0 } else { MOST_GROWTH });
            self.shortened = false;
            let kept = if relative <= self.tolerance { self.next.min(step * factor) } else { 0.0 };
            self.next = grown.max(kept).max(self.least);
            Judgement::Keep
        } else {
            self.again(step, factor.max(MOST_SHRINKING))
        }
    }

    /// Makes a step again, shorter by a factor.
    pub fn again(&mut self, step: f64, factor: f64) -> Judgement {
        self.shortened = true;
        self.next = (step * factor.min(SAFETY)).max(self.least);
        Judgement::Again(self.next)
    }

    /// Whether no shorter step than this one (s) will be asked for.
    pub fn is_least(&self, step: f64) -> bool {
        step <= self.least * (1.0 + 1e-9)
    }
}

/// Sum of magnitudes of the enthalpies (J/m3) that particles have taken up since the start. `by_state` is the sum of those of
/// the state itself, which are the same where all started from zero.
pub fn taken_up(state: &[f64], start: &[f64], by_state: f64) -> f64 {
    if start.is_empty() {
        return by_state;
    }
    distance(state, start)
}

/// Least share of the whole range of enthalpies that errors are measured by: below, the rounding of latent heat would be
/// taken for an error.
const LEAST_SCALE: f64 = 1e-4;

/// Part of the water between dry and saturated that is little beside any.
const FLOOR: f64 = 1e-3;

/// The range of enthalpies that the data of a scene span, where nothing can drive particles beyond it.
#[derive(Debug, Clone)]
pub struct EnthalpyRange {
    by_material: Vec<MaterialRange>,
    of_particle: Vec<u32>,
    /// Particles that stand for pipes and not for ground, in order.
    exempt: Vec<u32>,
    /// Whether fluxes can drive particles out of the range.
    open: bool,
    /// See [`EnthalpyRange::floor`].
    floor: f64,
}

impl HeapSize for EnthalpyRange {
    fn heap_size(&self) -> usize {
        let materials = self.by_material.capacity() * size_of::<MaterialRange>();
        materials + total(&[&self.of_particle, &self.exempt])
    }
}

/// Enthalpies of one material, less the initial one (J/m3).
#[derive(Debug, Clone, Copy)]
struct MaterialRange {
    low: f64,
    high: f64,
    /// Sensible heat of the range of temperatures, or of one degree where there is no range: errors of enthalpy over it
    /// are errors of temperature over its range.
    scale: f64,
}

impl EnthalpyRange {
    /// The range between two temperatures.
    pub fn new(
        materials: &Materials,
        temperatures: (f64, f64),
        exempt: Vec<u32>,
        (open, count): (bool, usize),
    ) -> Self {
        let width = temperatures.1 - temperatures.0;
        let by_material = materials
            .laws()
            .map(|thermal| {
                let low = thermal.curve.least_enthalpy(temperatures.0) - thermal.zero_enthalpy;
                let high = thermal.enthalpy(temperatures.1);
                let sensible = thermal.curve.least_capacity() * if width > 0.0 { width } else { 1.0 };
                // What pressure stores is little beside the water that ground gives off as it dries.
                let scale = match thermal.curve.moisture() {
                    Some(moisture) => moisture.drainable(),
                    None => sensible.max(LEAST_SCALE * (high - low)),
                };
                MaterialRange { low, high, scale }
            })
            .collect();
        // Where the data are one temperature, nothing moves, or only fluxes move it.
        let open = open || width <= 0.0;
        let of_particle = match materials.law_of.is_empty() {
            true => materials.of_particle.iter().map(|material| u32::from(*material)).collect(),
            false => materials.law_of.clone(),
        };
        let water = |i: usize| materials.of(i).curve.moisture().map_or(0.0, |moisture| moisture.drainable());
        let floor = FLOOR * (0..count).map(water).sum::<f64>();
        EnthalpyRange { by_material, of_particle, exempt, open, floor }
    }

    #[inline(always)]
    fn of(&self, particle: usize) -> &MaterialRange {
        &self.by_material[self.of_particle.get(particle).map_or(0, |material| *material as usize)]
    }

    /// The enthalpy (J/m3) by which errors of a particle are measured.
    #[inline(always)]
    pub fn scale(&self, particle: usize) -> f64 {
        self.of(particle).scale
    }

    /// Sum over particles of what errors of a step need not be small beside: ground that stays saturated takes up next to no
    /// water, however much flows through it.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// How far, over its scale, the worst particle has left its range.
    pub fn excess(&self, enthalpy: &[f64]) -> f64 {
        self.excess_from(0, enthalpy)
    }

    /// The same of the particles from one on.
    pub fn excess_from(&self, first: usize, enthalpy: &[f64]) -> f64 {
        if self.open {
            return 0.0;
        }
        if let [MaterialRange { low, high, scale }] = self.by_material[..] {
            let MinMax { least, greatest, .. } = MinMax::without(enthalpy, (first, &self.exempt));
            return ((low - least).max(greatest - high) / scale).max(0.0);
        }
        let exempt = &self.exempt[self.exempt.partition_point(|particle| (*particle as usize) < first)..];
        let mut exempt = exempt.iter().copied().peekable();
        let mut worst: f64 = 0.0;
        for (i, h) in (first..).zip(enthalpy) {
            if exempt.next_if_eq(&(i as u32)).is_none() {
                let MaterialRange { low, high, scale } = *self.of(i);
                worst = worst.max((low - h).max(h - high) / scale);
            }
        }
        worst
    }

    /// Largest share (0 to 1) of the way from `inside` to `beyond` that stays in the range, widened by `slack` of its
    /// scale.
    pub fn share(&self, inside: &[f64], beyond: &[f64], slack: f64) -> f64 {
        if self.open {
            return 1.0;
        }
        let mut exempt = self.exempt.iter().copied().peekable();
        let mut share: f64 = 1.0;
        for (i, (from, to)) in inside.iter().zip(beyond).enumerate() {
            if exempt.next_if_eq(&(i as u32)).is_some() {
                continue;
            }
            let MaterialRange { low, high, scale } = *self.of(i);
            let limit = if *to > high { high + slack * scale } else { low - slack * scale };
            if *to > limit && *to > high || *to < limit && *to < low {
                share = share.min(((limit - from) / (to - from)).max(0.0));
            }
        }
        share
    }
}
