//! What particles store whose cells an interface cuts: the heat of each material in its share of the cell.
//!
//! A particle has one temperature. What it stores at that temperature is the sum over the materials in its cell, so bodies of
//! any shape hold their own heat and latent heat wherever interfaces lie. It conducts as the material at its centre; what
//! lies between it and others is known exactly ([`crate::boundary::interface`]).

use crate::physics::curve::Curve;
use crate::physics::retention::scale::DRY;
use crate::physics::root::solve_increasing;

/// Materials in shares of one volume, all at one temperature.
#[derive(Debug, Clone)]
pub struct Blend {
    parts: Vec<(f64, Curve)>,
    /// Sharp freezing points in order, with the enthalpies (J/m3) at which all that freezes there is frozen and is not.
    plateaus: Vec<(f64, f64, f64)>,
    /// Enthalpies and temperatures between which the relation is straight, where it is so everywhere.
    nodes: Vec<(f64, f64)>,
}

impl Blend {
    /// Materials with their shares.
    pub fn new(parts: Vec<(f64, Curve)>) -> Self {
        let mut points: Vec<f64> = parts.iter().map(|part| part.1.freezing_point()).collect();
        points.sort_unstable_by(f64::total_cmp);
        points.dedup();
        let straight = parts.iter().all(|part| part.1.is_kinked());
        let mut blend = Blend { parts, plateaus: Vec::new(), nodes: Vec::new() };
        let ends = points.into_iter().map(|point| (point, blend.least_enthalpy(point), blend.enthalpy(point)));
        let ends: Vec<(f64, f64, f64)> = ends.collect();
        if straight {
            blend.nodes = ends.iter().flat_map(|(point, low, high)| [(*low, *point), (*high, *point)]).collect();
        }
        blend.plateaus = ends.into_iter().filter(|(_, low, high)| low < high).collect();
        blend
    }

    /// The sum of something by volume.
    pub fn sum(&self, of: impl Fn(&Curve) -> f64) -> f64 {
        self.parts.iter().map(|(share, curve)| share * of(curve)).sum()
    }

    /// Enthalpy (J/m3) at a temperature.
    pub fn enthalpy(&self, temperature: f64) -> f64 {
        self.sum(|curve| curve.enthalpy(temperature))
    }

    /// Least enthalpy (J/m3) at a temperature.
    pub fn least_enthalpy(&self, temperature: f64) -> f64 {
        self.sum(|curve| curve.least_enthalpy(temperature))
    }

    /// Heat capacity dH/dT (J/m3K), latent heat included, away from sharp freezing points.
    pub fn apparent_capacity(&self, temperature: f64) -> f64 {
        self.sum(|curve| curve.apparent_capacity(temperature))
    }

    /// The freezing point at which heat is taken up at an enthalpy, with the enthalpies between which it is.
    fn plateau(&self, enthalpy: f64) -> Option<&(f64, f64, f64)> {
        self.plateaus.iter().find(|(_, low, high)| (*low..=*high).contains(&enthalpy))
    }

    /// Temperature at an enthalpy (J/m3).
    pub fn temperature(&self, enthalpy: f64) -> f64 {
        if let Some(plateau) = self.plateau(enthalpy) {
            return plateau.0;
        }
        if let (Some(first), Some(last)) = (self.nodes.first(), self.nodes.last()) {
            return if enthalpy <= first.0 {
                first.1 + (enthalpy - first.0) / self.sum(Curve::frozen_capacity)
            } else if enthalpy >= last.0 {
                last.1 + (enthalpy - last.0) / self.sum(Curve::unfrozen_capacity)
            } else {
                let k = self.nodes.partition_point(|node| node.0 < enthalpy).max(1);
                let ((h0, t0), (h1, t1)) = (self.nodes[k - 1], self.nodes[k]);
                t0 + (t1 - t0) * (enthalpy - h0) / (h1 - h0)
            };
        }
        let least = self.sum(Curve::least_capacity);
        let point = self.parts[0].1.freezing_point();
        let away = (enthalpy - self.enthalpy(point)) / least;
        let (mut low, mut high) = (point + away.min(0.0), point + away.max(0.0));
        if self.parts.iter().any(|(_, curve)| curve.moisture().is_some()) {
            low = low.max(DRY);
        }
        for (point, bottom, top) in &self.plateaus {
            if enthalpy > *top {
                low = low.max(*point);
            } else if enthalpy < *bottom {
                high = high.min(*point);
            }
        }
        let missing = |temperature: f64| (self.enthalpy(temperature) - enthalpy, self.apparent_capacity(temperature));
        solve_increasing(missing, low, high)
    }

    /// Frozen fraction of the whole volume at an enthalpy (J/m3).
    pub fn frozen_fraction(&self, enthalpy: f64) -> f64 {
        if let Some((point, low, high)) = self.plateau(enthalpy) {
            let part = (high - enthalpy) / (high - low);
            let frozen = |curve: &Curve| match curve.freezing_point() == *point && curve.least_enthalpy(*point) < 0.0 {
                true => part,
                false => 1.0 - curve.unfrozen_fraction(*point),
            };
            return self.sum(frozen);
        }
        let temperature = self.temperature(enthalpy);
        self.sum(|curve| 1.0 - curve.unfrozen_fraction(temperature))
    }

    /// Whether heat is taken up at one temperature at an enthalpy (J/m3), and more and less of it is.
    pub fn stands_still(&self, enthalpy: f64) -> bool {
        self.plateaus.iter().any(|(_, low, high)| enthalpy > *low && enthalpy < *high)
    }
}
