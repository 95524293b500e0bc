//! The law of unsaturated ground, in tables that grow finer towards both of its ends.

use std::sync::Arc;

use crate::memory::{HeapSize, shared};
use crate::physics::potential::PotentialLaw;
use crate::physics::retention::moisture::Moisture;

/// Content to potential in two tables, each against the distance from its end, saturated or dry: nodes lie as many to an
/// octave of that distance, found by the bits of the number. The potential follows powers of it at both ends, steep at the one
/// and flat at the other, which such nodes follow equally well at all sizes.
#[derive(Debug, Clone)]
pub struct Tabulated {
    /// Hydraulic conductivity (m/s) of saturated ground, which potentials are multiples of: tables are those of all soils that
    /// differ in it alone.
    conductivity: f64,
    /// Potential that counts as none, over the conductivity as all that follows.
    zero: f64,
    /// Slope above saturation (m).
    saturated_slope: f64,
    /// Content, less that of saturation, and potential of dry ground.
    dry: (f64, f64),
    middle: f64,
    wet: Nodes,
    moist: Nodes,
}

/// Nodes of one table.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// Leading bits of the distance of the first node.
    base: u64,
    /// That distance; below it the law is straight.
    least: f64,
    /// Potential less that of the end, and its change over the interval by the slope at the node.
    nodes: Arc<[(f64, f64)]>,
}

/// Nodes of an octave are two to this power. A power between 0 and 10 is followed to 1e-7 of itself over so many.
const OCTAVE_BITS: u32 = 6;

/// Bits of a number behind those that tell its node.
const REST: u32 = 52 - OCTAVE_BITS;

/// The first node, over the drainable water: there it is lost in the rounding of contents.
const LEAST: f64 = 1e-17;

/// Leading bits of the first node, and distances of all of them up to one.
pub(super) fn places(scale: f64, most: f64) -> (u64, Vec<f64>) {
    let base = (LEAST * scale).to_bits() >> REST;
    let last = (most.to_bits() >> REST) + 2;
    (base, (base..last).map(|bits| f64::from_bits(bits << REST)).collect())
}

impl Nodes {
    /// The nodes up to a distance, by potential less that of the end and slope at each.
    fn new(scale: f64, most: f64, of: impl Fn(f64) -> (f64, f64)) -> Self {
        let (base, places) = places(scale, most);
        let mut nodes: Vec<(f64, f64)> = Vec::with_capacity(places.len());
        for place in &places {
            let (potential, slope) = of(*place);
            // Rounding must not turn it back.
            let risen = nodes
                .last()
                .map_or(potential, |last| if slope < 0.0 { potential.min(last.0) } else { potential.max(last.0) });
            nodes.push((risen, slope));
        }
        Nodes::monotone(base, &places, nodes)
    }

    /// The same by values alone, which rise or fall all the way: slopes are those of parabolas through three nodes.
    pub(super) fn by_values(scale: f64, most: f64, values: &[f64]) -> Self {
        let (base, places) = places(scale, most);
        let rise = |k: usize| (values[k + 1] - values[k]) / (places[k + 1] - places[k]);
        let slope = |k: usize| match k {
            0 => rise(0),
            _ if k + 1 == values.len() => rise(k - 1),
            _ => {
                let (before, after) = (places[k] - places[k - 1], places[k + 1] - places[k]);
                (rise(k - 1) * after + rise(k) * before) / (before + after)
            }
        };
        let nodes = (0..values.len()).map(|k| (values[k], slope(k))).collect();
        Nodes::monotone(base, &places, nodes)
    }

    /// Nodes whose slopes keep every piece monotone.
    fn monotone(base: u64, places: &[f64], mut nodes: Vec<(f64, f64)>) -> Self {
        // Slopes at most three times a neighbour's rise over the way keep every piece monotone (Fritsch and Carlson 1980).
        for k in 0..nodes.len() {
            let rise = |k: usize| {
                let way = places[k + 1] - places[k];
                ((nodes[k + 1].0 - nodes[k].0) / way).abs()
            };
            let least = match k {
                0 => rise(0),
                _ if k + 1 == nodes.len() => rise(k - 1),
                _ => rise(k - 1).min(rise(k)),
            };
            nodes[k].1 = nodes[k].1.clamp(-3.0 * least, 3.0 * least);
        }
        Nodes { base, least: places[0], nodes: nodes.into() }
    }

    /// The same without nodes before a distance: the law is straight up to the next.
    pub(super) fn straight_below(self, distance: f64) -> Self {
        let dropped = ((distance.to_bits() >> REST) + 1).saturating_sub(self.base);
        let first = dropped.min(self.nodes.len() as u64 - 2);
        let base = self.base + first;
        Nodes { base, least: f64::from_bits(base << REST), nodes: self.nodes[first as usize..].into() }
    }

    /// Potential less that of the end, at a distance from it.
    #[inline(always)]
    pub(super) fn at(&self, distance: f64) -> f64 {
        if distance < self.least {
            return self.nodes[0].0 * (distance / self.least);
        }
        let (k, s, way) = self.place(distance);
        let ((u0, d0), (u1, d1)) = (self.nodes[k], self.nodes[k + 1]);
        let (rise, d0, d1) = (u1 - u0, d0 * way, d1 * way);
        u0 + s * (d0 + s * ((3.0 * rise - 2.0 * d0 - d1) + s * (d0 + d1 - 2.0 * rise)))
    }

    /// Slope of the potential over the distance.
    #[inline(always)]
    pub(super) fn slope(&self, distance: f64) -> f64 {
        if distance < self.least {
            return self.nodes[0].0 / self.least;
        }
        let (k, s, way) = self.place(distance);
        let ((u0, d0), (u1, d1)) = (self.nodes[k], self.nodes[k + 1]);
        let (rise, d0, d1) = (u1 - u0, d0 * way, d1 * way);
        (d0 + s * (2.0 * (3.0 * rise - 2.0 * d0 - d1) + s * 3.0 * (d0 + d1 - 2.0 * rise))) / way
    }

    /// The node below a distance, how far it is on the way to the next, and how long that way is.
    #[inline(always)]
    fn place(&self, distance: f64) -> (usize, f64, f64) {
        let bits = distance.to_bits();
        let k = ((bits >> REST) - self.base).min(self.nodes.len() as u64 - 2) as usize;
        let from = f64::from_bits((self.base + k as u64) << REST);
        let way = f64::from_bits((self.base + k as u64 + 1) << REST) - from;
        (k, (distance - from) / way, way)
    }
}

impl Tabulated {
    /// The law of a soil whose potentials count from that of a content.
    pub fn new(soil: &Moisture, initial_content: f64) -> Self {
        let conductivity = soil.soil().conductivity;
        let dry = (soil.driest_content(), soil.driest_potential() / conductivity);
        let scale = soil.drainable();
        let middle = 0.5 * dry.0;
        let at = |content: f64| {
            let place = soil.place_of_content(content).max(soil.end());
            (soil.potential(place) / conductivity, soil.diffusivity(place) / conductivity)
        };
        let wet = Nodes::new(scale, -middle, |distance| {
            let (potential, slope) = at(-distance);
            (potential, -slope)
        });
        let moist = Nodes::new(scale, -middle, |distance| {
            let (potential, slope) = at(dry.0 + distance);
            (potential - dry.1, slope)
        });
        let saturated_slope = 1.0 / soil.soil().storage;
        let mut law = Tabulated { conductivity, zero: 0.0, saturated_slope, dry, middle, wet, moist };
        // What the table itself gives, so that bodies at rest exchange nothing to the last bit.
        law.zero = law.look_up(initial_content);
        law
    }

    /// The law of a soil that differs in its conductivity (m/s) alone.
    pub fn shared(&self, conductivity: f64) -> Self {
        Tabulated { conductivity, ..self.clone() }
    }

    /// What has drained at a content, over all that can: without a root, since what pressure stores follows from the potential.
    pub fn deficit(&self, content: f64) -> f64 {
        if content >= 0.0 {
            return 0.0;
        }
        if content <= self.dry.0 {
            return 1.0;
        }
        let stored = (self.look_up(content) + self.zero) / self.saturated_slope;
        let drainable = self.dry.1 / self.saturated_slope - self.dry.0;
        ((stored - content) / drainable).clamp(0.0, 1.0)
    }

    /// Potential over the conductivity.
    #[inline(always)]
    fn look_up(&self, content: f64) -> f64 {
        let potential = if content >= 0.0 {
            self.saturated_slope * content
        } else if content > self.middle {
            self.wet.at(-content)
        } else if content > self.dry.0 {
            self.dry.1 + self.moist.at(content - self.dry.0)
        } else {
            self.dry.1
        };
        potential - self.zero
    }
}

impl PotentialLaw for Tabulated {
    #[inline(always)]
    fn potential(&self, content: f64) -> f64 {
        self.conductivity * self.look_up(content)
    }

    #[inline]
    fn slope(&self, content: f64) -> f64 {
        let slope = if content >= 0.0 {
            self.saturated_slope
        } else if content > self.middle {
            (-self.wet.slope(-content)).max(0.0)
        } else if content > self.dry.0 {
            self.moist.slope(content - self.dry.0).max(0.0)
        } else {
            0.0
        };
        self.conductivity * slope
    }
}

impl HeapSize for Nodes {
    fn heap_size(&self) -> usize {
        shared(&self.nodes)
    }
}

impl HeapSize for Tabulated {
    fn heap_size(&self) -> usize {
        self.wet.heap_size() + self.moist.heap_size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::retention::moisture::Soil;
    use crate::physics::retention::van_genuchten::VanGenuchten;

    #[test]
    fn tables_follow_the_exact_law_at_all_sizes_and_never_fall() {
        for (alpha, exponent) in [(1.0, 1.53), (0.1, 1.1), (10.0, 1.1), (10.0, 3.0), (0.1, 3.0)] {
            let retention = VanGenuchten { alpha, exponent, connectivity: 0.5 }.into();
            let soil = Moisture::new(Soil {
                retention,
                residual: 0.05,
                saturated: 0.4,
                conductivity: 1e-5,
                storage: 1e-6,
                solute: None,
            });
            let law = Tabulated::new(&soil, 0.0);
            let depth = -soil.driest_potential();
            let mut last = f64::NEG_INFINITY;
            for k in 1..20_000 {
                let saturation = 0.5 * (1.0 + (8.0 * (k as f64 / 10_000.0 - 1.0)).tanh());
                let content = soil.driest_content() * (1.0 - saturation);
                let exact = soil.potential(soil.place_of_content(content));
                let own = law.potential(content);
                assert!((own - exact).abs() < 2e-8 * depth, "{alpha} {exponent} {saturation}: {own} {exact}");
                assert!(own >= last, "{alpha} {exponent} {saturation}");
                assert!(law.slope(content) >= 0.0);
                // What the potential is off by, as far as pressure stores. Ground that does not conduct has one place.
                let (place, allowed) = (soil.place_of_content(content), 2e-8 * depth / 1e-5 * 1e-6 / 0.35 + 1e-14);
                let off = (law.deficit(content) - (1.0 - soil.saturation(place))).abs();
                assert!(off < allowed || place == soil.end(), "{alpha} {exponent} {saturation}: {off}");
                last = own;
            }
        }
    }

    #[test]
    fn what_starts_dry_is_at_rest_to_the_last_bit() {
        let retention = VanGenuchten { alpha: 1.0, exponent: 1.53, connectivity: 0.5 }.into();
        let soil = Moisture::new(Soil {
            retention,
            residual: 0.186,
            saturated: 0.363,
            conductivity: 1e-9,
            storage: 1e-6,
            solute: None,
        });
        let dry = soil.driest_content();
        let law = Tabulated::new(&soil, dry);
        assert_eq!((law.potential(dry), law.slope(dry)), (0.0, 0.0));
        assert!((law.potential(0.0) + soil.driest_potential()).abs() < 1e-24);
        for beside in [dry.next_down(), dry.next_up(), dry - 1e-3] {
            assert_eq!(law.potential(beside), 0.0);
        }
    }
}
