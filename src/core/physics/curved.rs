//! The law of a material that freezes along a curve, in tables.

#[cfg(target_arch = "x86_64")]
mod rows;

use std::sync::Arc;

use crate::instruction_set::InstructionSet;
use crate::memory::HeapSize;
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
    /// Potential and its derivative by the interval's own coordinate: from the cold end up, then from the freezing point down.
    pub(super) nodes: Arc<Nodes>,
}

/// Nodes of one of the two tables.
const TABLE_NODES: usize = TABLE_INTERVALS + 1;

/// Both tables.
type Nodes = [(f64, f64); 2 * TABLE_NODES];

/// Neighbours whose potentials are taken together: so many that the compiler takes loops over them for vectors, and so few that
/// what it keeps of them stays in the first cache.
const GROUP: usize = 64;

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
            let place = self.distance(absolute).sqrt() * self.per_interval;
            let k = (place as usize).min(TABLE_INTERVALS - 1);
            let first = self.table(absolute) as usize + k;
            cubic(self.nodes[first], self.nodes[first + 1], place - k as f64)
        };
        potential - self.initial.1
    }

    /// Where the table of an enthalpy between both ends begins.
    #[inline(always)]
    fn table(&self, absolute: f64) -> u32 {
        if absolute > self.middle { TABLE_NODES as u32 } else { 0 }
    }

    /// The distance of an enthalpy between both ends from that of its table.
    #[inline(always)]
    fn distance(&self, absolute: f64) -> f64 {
        let (warm, cold) = (-absolute, absolute - self.coldest.0);
        if absolute > self.middle { warm } else { cold }
    }

    /// The same as [`Curved::look_up`] for many enthalpies, without a branch: one loop for each thing to be done, which
    /// becomes one of vectors, the reading of nodes too.
    #[inline(always)]
    fn look_up_group(&self, enthalpy: &[f64; GROUP], potentials: &mut [f64; GROUP]) {
        let absolute = |lane: usize| enthalpy[lane] + self.initial.0;
        let (mut places, mut intervals) = ([0.0; GROUP], [0; GROUP]);
        for lane in 0..GROUP {
            places[lane] = self.distance(absolute(lane)).sqrt() * self.per_interval;
        }
        for lane in 0..GROUP {
            const LAST: f64 = (TABLE_INTERVALS - 1) as f64;
            // Beyond both ends any interval does.
            let place = if places[lane] < LAST { places[lane] } else { LAST };
            let place = if place > 0.0 { place } else { 0.0 };
            // SAFETY: it lies between 0 and the last interval, and is a number: comparisons with none are false.
            intervals[lane] = unsafe { place.to_int_unchecked::<i32>() };
        }
        for lane in 0..GROUP {
            places[lane] -= f64::from(intervals[lane]);
        }
        let (mut starts, mut ends) = (([0.0; GROUP], [0.0; GROUP]), ([0.0; GROUP], [0.0; GROUP]));
        for lane in 0..GROUP {
            let first = (intervals[lane] as u32 + self.table(absolute(lane))) as usize;
            let first = first.min(2 * TABLE_NODES - 2);
            (starts.0[lane], starts.1[lane]) = self.nodes[first];
            (ends.0[lane], ends.1[lane]) = self.nodes[first + 1];
        }
        for lane in 0..GROUP {
            let absolute = absolute(lane);
            let mixed = cubic((starts.0[lane], starts.1[lane]), (ends.0[lane], ends.1[lane]), places[lane]);
            let (frozen, unfrozen) = (self.frozen(absolute), self.unfrozen(absolute));
            let below = if absolute <= self.coldest.0 { frozen } else { mixed };
            potentials[lane] = if absolute >= 0.0 { unfrozen } else { below } - self.initial.1;
        }
    }
}

/// The cubic between two nodes, given by value and derivative, at a share of the way.
#[inline(always)]
fn cubic((u0, d0): (f64, f64), (u1, d1): (f64, f64), s: f64) -> f64 {
    let rise = u1 - u0;
    u0 + s * (d0 + s * ((3.0 * rise - 2.0 * d0 - d1) + s * (d0 + d1 - 2.0 * rise)))
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
        // At the very end of a table the derivative by the root vanishes with the root: a thousandth of an interval
        // away their ratio is still a ratio of numbers and not of rounding errors.
        let place = (self.distance(absolute).sqrt() * self.per_interval).max(1e-3);
        let k = (place as usize).min(TABLE_INTERVALS - 1);
        let s = place - k as f64;
        let first = self.table(absolute) as usize + k;
        let ((u0, d0), (u1, d1)) = (self.nodes[first], self.nodes[first + 1]);
        let rise = u1 - u0;
        let by_place = d0 + s * (2.0 * (3.0 * rise - 2.0 * d0 - d1) + s * 3.0 * (d0 + d1 - 2.0 * rise));
        // place = per_interval sqrt(distance), so d place / d distance = per_interval^2 / (2 place).
        let by_distance = by_place * self.per_interval * self.per_interval / (2.0 * place);
        (if absolute > self.middle { -by_distance } else { by_distance }).max(0.0)
    }

    /// Neighbours mostly are in one phase, where the law is straight: only groups that are not look into the tables.
    #[inline(always)]
    fn fill(&self, enthalpy: &[f64], potentials: &mut [f64]) {
        let (groups, rest) = enthalpy.as_chunks::<GROUP>();
        let (into_groups, into_rest) = potentials[..enthalpy.len()].as_chunks_mut::<GROUP>();
        for (potentials, enthalpy) in into_groups.iter_mut().zip(groups) {
            let absolute = |enthalpy: f64| enthalpy + self.initial.0;
            // Counted to the end: a loop that may end early takes no vectors.
            let unfrozen = enthalpy.iter().fold(true, |all, enthalpy| all & (absolute(*enthalpy) >= 0.0));
            let frozen = enthalpy.iter().fold(true, |all, enthalpy| all & (absolute(*enthalpy) <= self.coldest.0));
            if unfrozen {
                for lane in 0..GROUP {
                    potentials[lane] = self.unfrozen(absolute(enthalpy[lane])) - self.initial.1;
                }
            } else if frozen {
                for lane in 0..GROUP {
                    potentials[lane] = self.frozen(absolute(enthalpy[lane])) - self.initial.1;
                }
            } else {
                match InstructionSet::widest() {
                    #[cfg(target_arch = "x86_64")]
                    // SAFETY: the processor has just been asked for these features.
                    InstructionSet::Avx2 => unsafe { rows::look_up_group(self, enthalpy, potentials) },
                    _ => self.look_up_group(enthalpy, potentials),
                }
            }
        }
        for (potential, enthalpy) in into_rest.iter_mut().zip(rest) {
            *potential = self.look_up(*enthalpy);
        }
    }
}

impl HeapSize for Curved {
    fn heap_size(&self) -> usize {
        size_of_val(&*self.nodes)
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
        let coldest = (coldest_enthalpy, cold[0].0);
        cold.extend(warm);
        let nodes: Arc<[(f64, f64)]> = cold.into();
        let Ok(nodes) = nodes.try_into() else { unreachable!("two tables of {TABLE_NODES} nodes") };
        let mut law = Curved {
            initial: (zero_enthalpy, 0.0),
            unfrozen_slope: of(curve.freezing_point + 1.0) / curve.unfrozen_capacity,
            frozen_slope: of(coldest_temperature - 1.0) / curve.coldest_capacity(),
            coldest,
            middle: 0.5 * coldest_enthalpy,
            per_interval: 1.0 / interval,
            nodes,
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::instruction_set;
    use crate::physics::freezing_curve::weibull::Weibull;
    use crate::physics::material::{Material, Mixing, Phase};

    fn law() -> Curved {
        let material = Material {
            name: "water".into(),
            density: 1000.0,
            frozen: Phase { conductivity: 2.14, heat_capacity: 2060.0 },
            unfrozen: Phase { conductivity: 0.6, heat_capacity: 4182.0 },
            freezing_point: 0.0,
            latent_heat: 334_000.0,
            law: Weibull { width: 0.5, residual: 0.05 }.into(),
            mixing: Mixing::Geometric,
            pores: None,
            soil: None,
        };
        let curve = Curve::new(&material);
        let start = curve.enthalpy(3.0);
        Curved::new(&curve, start)
    }

    proptest! {
        /// Groups in one phase, in both and at their ends, and what is left over, as each particle by itself, by the vectors of each
        /// processor.
        #[test]
        fn neighbours_together_have_the_potentials_of_each_alone(
            (from, to) in (-4.5_f64..0.5, -4.5_f64..0.5),
            shares in prop::collection::vec(0.0_f64..1.0, 1..200),
            special in any::<prop::sample::Index>(),
        ) {
            let law = law();
            let ends = [0.0, law.coldest.0, law.middle, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
            let mut enthalpy: Vec<f64> = shares.iter().map(|share| 1e8 * (from + share * (to - from))).collect();
            for (k, end) in ends.into_iter().enumerate() {
                let place = special.index(enthalpy.len()) + 7 * k;
                if let Some(enthalpy) = enthalpy.get_mut(place) {
                    *enthalpy = end - law.initial.0;
                }
            }
            for set in InstructionSet::ALL {
                instruction_set::limit(set);
                let mut together = vec![0.0; enthalpy.len()];
                PotentialLaw::fill(&law, &enthalpy, &mut together);
                for (together, enthalpy) in together.iter().zip(&enthalpy) {
                    prop_assert_eq!(together.to_bits(), law.potential(*enthalpy).to_bits(), "{} {}", set, enthalpy);
                }
            }
        }
    }
}
