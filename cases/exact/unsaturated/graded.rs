//! Integrals over saturation, by panels that shrink toward the places where diffusivity vanishes or has no bound.

use std::f64::consts::PI;

use super::soil::{Growth, Soil};

/// Nodes of a panel. A singularity is at least a panel's length away, so that each node gains three quarters of a digit.
pub(super) const NODES: usize = 21;

/// Least saturation above the initial one that is told from it, over the range.
const LEAST_EXCESS: f64 = 1e-12;

/// Dryness below which the rest is one panel: it holds a part of potential and water below rounding.
const LEAST_DRYNESS: f64 = 1e-18;

/// What stands on the nodes of a panel.
pub(super) type Nodal = [f64; NODES];

/// Chebyshev's nodes from -1 to 1, ends included, and integrals of what passes through values there.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    nodes: Nodal,
    /// Weights of values in integrals from -1 to each node.
    weights: [Nodal; NODES],
}

impl Rule {
    pub(super) fn new() -> Self {
        const LAST: usize = NODES - 1;
        let angle = |node: usize| PI * (LAST - node) as f64 / LAST as f64;
        let is_end = |index: usize| index == 0 || index == LAST;
        let halved = |index: usize| if is_end(index) { 0.5 } else { 1.0 };
        let integral = |degree: usize, node: usize| {
            let s = angle(node).cos();
            let (k, sign) = (degree as f64, if degree.is_multiple_of(2) { 1.0 } else { -1.0 });
            match degree {
                0 => s + 1.0,
                1 => 0.5 * (s * s - 1.0),
                _ => {
                    let polynomial = |order: f64| ((order * angle(node)).cos() + sign) / order;
                    0.5 * (polynomial(k + 1.0) - polynomial(k - 1.0))
                }
            }
        };
        let weight = |node: usize, of: usize| {
            let terms =
                (0..NODES).map(|degree| halved(degree) * (degree as f64 * angle(of)).cos() * integral(degree, node));
            2.0 / LAST as f64 * halved(of) * terms.sum::<f64>()
        };
        let nodes = std::array::from_fn(|node| angle(node).cos());
        let weights = std::array::from_fn(|node| std::array::from_fn(|of| weight(node, of)));
        Rule { nodes, weights }
    }

    /// The nodes, from -1 to 1.
    pub(super) fn nodes(&self) -> Nodal {
        self.nodes
    }

    /// Integrals from the beginning of the panel to each node.
    pub(super) fn integrals(&self, values: &Nodal) -> Nodal {
        let sum = |weights: &Nodal| weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
        self.weights.each_ref().map(sum)
    }

    /// The integral over the whole panel.
    pub(super) fn total(&self, values: &Nodal) -> f64 {
        self.weights[NODES - 1].iter().zip(values).map(|(weight, value)| weight * value).sum()
    }

    /// The value at a place of the panel, from -1 to 1, by the barycentric formula.
    pub(super) fn value(&self, values: &Nodal, at: f64) -> f64 {
        let (mut above, mut below) = (0.0, 0.0);
        for (index, (node, value)) in self.nodes.iter().zip(values).enumerate() {
            if at == *node {
                return *value;
            }
            let size = if index == 0 || index == NODES - 1 { 0.5 } else { 1.0 };
            let weight = if index.is_multiple_of(2) { size } else { -size } / (at - node);
            above += weight * value;
            below += weight;
        }
        above / below
    }
}

/// By what a panel is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinate {
    /// Effective saturation above this initial one.
    Excess(f64),
    /// Dryness of the soil.
    Dryness,
}

/// A panel on the way from the initial to the greatest saturation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Panel {
    pub(super) coordinate: Coordinate,
    /// Where it begins, at its drier end.
    pub(super) start: f64,
    pub(super) end: f64,
}

impl Panel {
    /// Coordinate at a place from -1 to 1.
    pub(super) fn coordinate_at(&self, place: f64) -> f64 {
        self.start + 0.5 * (self.end - self.start) * (place + 1.0)
    }

    /// Place from -1 to 1 of a coordinate.
    pub(super) fn place_of(&self, coordinate: f64) -> f64 {
        (2.0 * (coordinate - self.start) / (self.end - self.start) - 1.0).clamp(-1.0, 1.0)
    }

    /// Effective saturation at a place from -1 to 1.
    pub(super) fn saturation(&self, soil: &Soil, place: f64) -> f64 {
        let coordinate = self.coordinate_at(place);
        match self.coordinate {
            Coordinate::Excess(initial) => initial + coordinate,
            Coordinate::Dryness => soil.saturation_at(coordinate),
        }
    }

    /// Growths with the place in the panel, at its nodes.
    pub(super) fn growth(&self, soil: &Soil, rule: &Rule) -> [Growth; NODES] {
        let half = 0.5 * (self.end - self.start);
        rule.nodes.map(|node| {
            let growth = match self.coordinate {
                Coordinate::Excess(initial) => soil.along_saturation(initial + self.coordinate_at(node)),
                Coordinate::Dryness => soil.along_dryness(self.coordinate_at(node)),
            };
            Growth { saturation: half * growth.saturation, potential: half * growth.potential }
        })
    }
}

/// Panels from just above an initial saturation to a greater one. None is longer than the distance to a place where the
/// potential is singular in its coordinate, but the last one before saturation.
pub(super) fn panels(soil: &Soil, initial: f64, greatest: f64) -> Vec<Panel> {
    let mut found = Vec::new();
    let room = 1.0 - initial;
    // From here on by the dryness, in which full soil is not singular.
    let half_full = soil.saturation_at(0.5).max(initial + 0.5 * room);
    let last = half_full.min(greatest) - initial;
    let mut start = LEAST_EXCESS * (greatest - initial);
    while start < last {
        let mut end = start + start.min(0.5 * (room - start));
        if end > 0.9 * last {
            end = last;
        }
        found.push(Panel { coordinate: Coordinate::Excess(initial), start, end });
        start = end;
    }
    if half_full >= greatest {
        return found;
    }
    let (driest, least) = (soil.dryness(initial), soil.dryness(greatest));
    let mut start = soil.dryness(half_full);
    while start > least {
        let mut end = start - (0.5 * start).min(driest - start);
        if end < least + 0.1 * (start - least) || end < LEAST_DRYNESS {
            end = least;
        }
        found.push(Panel { coordinate: Coordinate::Dryness, start, end });
        start = end;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_and_interpolated() {
        let rule = Rule::new();
        let values = rule.nodes.map(|s| 3.0 * s * s - 4.0 * s * s * s + 1.0);
        for (node, found) in rule.nodes.iter().zip(rule.integrals(&values)) {
            let expected = node.powi(3) - node.powi(4) + node + 3.0;
            assert!((found - expected).abs() < 1e-14, "{node}: {found}, must be {expected}");
        }
        assert!((rule.total(&values) - 4.0).abs() < 1e-14);
        assert!((rule.value(&values, 0.3) - (0.27 - 0.108 + 1.0)).abs() < 1e-14);
    }
}
