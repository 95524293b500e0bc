//! The law of a material that freezes along a curve, in tables.

use std::sync::Arc;

use crate::memory::{HeapSize, shared};
use crate::physics::curve::{Curve, TABLE_INTERVALS};
use crate::physics::integral::simpson;
use crate::physics::potential::PotentialLaw;

/// A smooth law in two tables, each against the root of the distance to its end of the freezing interval: the
/// curve bends sharply at both ends, and there the nodes lie close.
#[derive(Debug, Clone)]
pub struct Curved {
    /// Initial enthalpy and potential.
    pub(super) initial: (f64, f64),
    pub(super) unfrozen_slope: f64,
    pub(super) frozen_slope: f64,
    pub(super) coldest: (f64, f64),
    pub(super) middle: f64,
    pub(super) per_interval: f64,
    /// Potential and its derivative by the interval's own coordinate, from the freezing point down.
    pub(super) warm: Arc<[(f64, f64)]>,
    /// The same from the cold end up.
    pub(super) cold: Arc<[(f64, f64)]>,
}

/// Neighbours whose potentials are taken together.
const GROUP: usize = 16;

impl Curved {
    #[inline(always)]
    fn unfrozen(&self, absolute: f64) -> f64 {
        self.unfrozen_slope * absolute
    }

    #[inline(always)]
    fn frozen(&self, absolute: f64) -> f64 {
        self.coldest.1 + self.frozen_slope * (absolute - self.coldest.0)
    }

    #[inline(always)]
    fn look_up(&self, enthalpy: f64) -> f64 {
        let absolute = enthalpy + self.initial.0;
        let potential = if absolute >= 0.0 {
            self.unfrozen(absolute)
        } else if absolute <= self.coldest.0 {
            self.frozen(absolute)
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
}

impl PotentialLaw for Curved {
    fn potential(&self, enthalpy: f64) -> f64 {
        self.look_up(enthalpy)
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

    /// Neighbours mostly are in one phase, where the law is straight: only groups that are not look into the tables.
    #[inline(always)]
    fn fill(&self, enthalpy: &[f64], potentials: &mut [f64]) {
        for (potentials, enthalpy) in potentials.chunks_mut(GROUP).zip(enthalpy.chunks(GROUP)) {
            let absolute = |enthalpy: &f64| enthalpy + self.initial.0;
            if enthalpy.iter().all(|enthalpy| absolute(enthalpy) >= 0.0) {
                for (potential, enthalpy) in potentials.iter_mut().zip(enthalpy) {
                    *potential = self.unfrozen(absolute(enthalpy)) - self.initial.1;
                }
            } else if enthalpy.iter().all(|enthalpy| absolute(enthalpy) <= self.coldest.0) {
                for (potential, enthalpy) in potentials.iter_mut().zip(enthalpy) {
                    *potential = self.frozen(absolute(enthalpy)) - self.initial.1;
                }
            } else {
                for (potential, enthalpy) in potentials.iter_mut().zip(enthalpy) {
                    *potential = self.look_up(*enthalpy);
                }
            }
        }
    }
}

impl HeapSize for Curved {
    fn heap_size(&self) -> usize {
        shared(&self.warm) + shared(&self.cold)
    }
}

impl Curved {
    /// Conduction potential.
    pub(super) fn new(curve: &Curve, zero_enthalpy: f64) -> Self {
        Self::integral(curve, zero_enthalpy, |temperature| curve.conductivity(temperature))
    }

    /// Temperature above the freezing point, by the same tables.
    pub fn of_temperature(curve: &Curve) -> Self {
        Self::integral(curve, 0.0, |_| 1.0)
    }

    /// The integral of a function of the temperature from the freezing point.
    fn integral(curve: &Curve, zero_enthalpy: f64, of: impl Fn(f64) -> f64) -> Self {
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
            initial: (zero_enthalpy, 0.0),
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
