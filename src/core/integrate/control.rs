//! How long the next step should be, and whether the last one was good enough.

use crate::uptake::Materials;

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
}

/// What is to be done with a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Judgement {
    /// Keep it.
    Keep,
    /// Make it again, this long (s).
    Again(f64),
}

impl Control {
    /// A control that starts with steps of `least` seconds.
    pub fn new(tolerance: f64, order: f64, least: f64) -> Self {
        Control { tolerance, order, least, next: least, most_heat: 0.0 }
    }

    /// The step that should come next (s).
    pub fn next(&self) -> f64 {
        self.next
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
            let grown = step * factor.min(MOST_GROWTH);
            let kept = if relative <= self.tolerance { self.next.min(step * factor) } else { 0.0 };
            self.next = grown.max(kept).max(self.least);
            Judgement::Keep
        } else {
            self.again(step, factor.max(MOST_SHRINKING))
        }
    }

    /// Makes a step again, shorter by a factor.
    pub fn again(&mut self, step: f64, factor: f64) -> Judgement {
        self.next = (step * factor.min(SAFETY)).max(self.least);
        Judgement::Again(self.next)
    }

    /// Whether no shorter step than this one (s) will be asked for.
    pub fn is_least(&self, step: f64) -> bool {
        step <= self.least * (1.0 + 1e-9)
    }
}

/// The range of enthalpies that the data of a scene span, where nothing can drive particles beyond it.
#[derive(Debug, Clone)]
pub struct EnthalpyRange {
    /// Least and greatest enthalpy by material, less the initial one (J/m3).
    by_material: Vec<(f64, f64)>,
    of_particle: Vec<u8>,
    /// Particles that stand for pipes and not for ground, in order.
    exempt: Vec<u32>,
    /// Whether fluxes can drive particles out of the range.
    open: bool,
    /// Heat of one degree (J/m3K).
    by_degree: f64,
}

impl EnthalpyRange {
    /// The range between two temperatures.
    pub fn new(materials: &Materials, temperatures: (f64, f64), exempt: Vec<u32>, open: bool) -> Self {
        let by_material = materials
            .thermals
            .iter()
            .map(|thermal| {
                let low = thermal.curve.least_enthalpy(temperatures.0) - thermal.initial_enthalpy;
                (low, thermal.enthalpy(temperatures.1))
            })
            .collect();
        let by_degree = materials.thermals.iter().map(|thermal| thermal.curve.least_capacity()).fold(0.0, f64::max);
        // Where the data are one temperature, nothing moves, or only fluxes move it.
        let open = open || temperatures.0 >= temperatures.1;
        EnthalpyRange { by_material, of_particle: materials.of_particle.clone(), exempt, open, by_degree }
    }

    /// Least and greatest enthalpy of a particle (J/m3).
    #[inline]
    pub fn of(&self, particle: usize) -> (f64, f64) {
        self.by_material[self.of_particle.get(particle).map_or(0, |material| *material as usize)]
    }

    /// The scale of enthalpies in a scene (J/m3): the width of the widest range, and at least one degree of sensible
    /// heat.
    pub fn scale(&self) -> f64 {
        self.by_material.iter().map(|(low, high)| high - low).fold(self.by_degree, f64::max)
    }

    /// How far, over the width of its range, the worst particle has left it.
    pub fn excess(&self, enthalpy: &[f64]) -> f64 {
        if self.open {
            return 0.0;
        }
        let beyond = |h: f64, (low, high): (f64, f64)| (low - h).max(h - high) / (high - low);
        let mut exempt = self.exempt.iter().copied().peekable();
        let mut worst: f64 = 0.0;
        for (i, h) in enthalpy.iter().enumerate() {
            if exempt.peek() == Some(&(i as u32)) {
                exempt.next();
                continue;
            }
            worst = worst.max(beyond(*h, self.of(i)));
        }
        worst
    }

    /// Largest share (0 to 1) of the way from `inside` to `beyond` that stays in the range, widened by `slack` of its
    /// width.
    pub fn share(&self, inside: &[f64], beyond: &[f64], slack: f64) -> f64 {
        if self.open {
            return 1.0;
        }
        let mut exempt = self.exempt.iter().copied().peekable();
        let mut share: f64 = 1.0;
        for (i, (from, to)) in inside.iter().zip(beyond).enumerate() {
            if exempt.peek() == Some(&(i as u32)) {
                exempt.next();
                continue;
            }
            let (low, high) = self.of(i);
            let room = slack * (high - low);
            if *to > high + room {
                share = share.min(((high + room - from) / (to - from)).max(0.0));
            } else if *to < low - room {
                share = share.min(((low - room - from) / (to - from)).max(0.0));
            }
        }
        share
    }
}
