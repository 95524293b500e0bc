//! Water content, pressure head and conduction potential of one soil.

use crate::memory::HeapSize;
use crate::physics::integral::Integral;
use crate::physics::retention::Retention;
use crate::physics::retention::scale::{DRIEST, DRY, place, stretch, suction};
use crate::physics::retention::shape::RetentionCurve;
use crate::physics::root::{solve_increasing, solve_increasing_from};
use crate::physics::solute_material::SoluteMaterial;

/// What water finds in unsaturated ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Soil {
    /// How the water content follows the suction.
    pub retention: Retention,
    /// Residual water content.
    pub residual: f64,
    /// Saturated water content.
    pub saturated: f64,
    /// Hydraulic conductivity of saturated ground (m/s).
    pub conductivity: f64,
    /// Specific storage (1/m).
    pub storage: f64,
    /// What it does to a solute, where water carries one.
    pub solute: Option<SoluteMaterial>,
}

impl Soil {
    /// Effective saturation at a place.
    pub fn saturation(&self, place: f64) -> f64 {
        if place >= 0.0 {
            1.0
        } else if place <= DRY {
            0.0
        } else {
            self.retention.saturation(suction(place))
        }
    }

    /// The place at which ground has an effective saturation, 0 to 1.
    pub fn place_of(&self, saturation: f64) -> f64 {
        let suction = self.retention.suction(1.0 - saturation);
        if saturation <= 0.0 || suction > DRIEST { DRY } else { place(-suction) }
    }

    /// Whether another soil has the same saturation and relative conductivity at all heads.
    pub fn curves_like(&self, other: &Soil) -> bool {
        self.retention == other.retention
    }

    /// Whether another soil holds the same at all heads.
    pub fn holds_like(&self, other: &Soil) -> bool {
        let held = |soil: &Soil| (soil.residual, soil.saturated, soil.storage);
        self.curves_like(other) && held(self) == held(other)
    }

    /// How many times better than another soil of the same curve this one conducts at all heads; none where their curves differ.
    pub fn scaled_from(&self, other: &Soil) -> Option<f64> {
        self.curves_like(other).then(|| self.conductivity / other.conductivity)
    }
}

/// Relations of one soil, by the place of the pressure head ([`crate::physics::retention::scale`]), for which potentials count
/// from the head zero.
///
/// What a particle holds is the water content less the saturated one, with what the pressure stores: `S U / Ks` with the
/// potential U. Above saturation that is the specific storage times the head; below it fades with the conductivity, so that
/// the diffusivity is nowhere greater than `Ks / S`.
#[derive(Debug, Clone, PartialEq)]
pub struct Moisture {
    soil: Soil,
    /// Driest place at which the ground still conducts.
    end: f64,
    /// Relative conductivity, integrated over the place.
    relative: Integral,
    /// Its value at the end and below: by how much the potential of dry ground is lower, over Ks (m).
    depth: f64,
}

/// The first piece of the integral ends at this part of the suction at which the curve bends; conductivities of fine soils have
/// a cusp at saturation.
const FIRST_PIECE: f64 = 1e-12;

/// Steps of a piece, which is half as long as the next: the conductivity is about a power there, whose integral Simpson's rule
/// then has to 1e-11 of itself.
const STEPS: usize = 128;

/// Relative conductivity below which nothing flows, whatever drives it.
const STANDS: f64 = 1e-60;

/// What dry ground conducts, over what saturated ground does: so that its potential still has one place each.
const TRACE: f64 = 1e-30;

impl Moisture {
    /// The relations of a soil.
    pub fn new(soil: Soil) -> Self {
        let curve = &soil.retention;
        let bends = curve.bends();
        // Where the conductivity has died out, or the scale ends.
        let mut last = bends.last().copied().unwrap_or(1.0);
        while curve.relative_conductivity(last) * (1.0 + last) > STANDS && last < DRIEST {
            last = (2.0 * last).min(DRIEST);
        }
        let first = FIRST_PIECE * bends.first().copied().unwrap_or(1.0);
        let growing = std::iter::successors(Some(first), |end| Some(2.0 * end)).take_while(|end| *end < last);
        let mut ends: Vec<f64> =
            growing.chain(bends.iter().copied()).chain([last]).map(|suction| place(-suction)).collect();
        ends.sort_by(|a, b| b.total_cmp(a));
        ends.dedup();
        let of = |at: f64| if at < 0.0 { curve.relative_conductivity(suction(at)) * stretch(at) } else { 1.0 };
        let relative = Integral::new(of, &ends, STEPS);
        let end = place(-last);
        Moisture { depth: relative.at(end), soil, end, relative }
    }

    /// The relations of a soil that holds the same as this one, at whatever conductivity: by the same tables.
    pub fn shared(&self, soil: &Soil) -> Option<Self> {
        soil.holds_like(&self.soil).then(|| Moisture { soil: soil.clone(), ..self.clone() })
    }

    /// The soil.
    pub fn soil(&self) -> &Soil {
        &self.soil
    }

    /// Water between the residual and the saturated content.
    pub fn drainable(&self) -> f64 {
        self.soil.saturated - self.soil.residual
    }

    /// Effective saturation at a place.
    pub fn saturation(&self, place: f64) -> f64 {
        if place < self.end { 0.0 } else { self.soil.saturation(place) }
    }

    /// Integral of the conductivity from saturation (m2/s).
    pub fn potential(&self, place: f64) -> f64 {
        self.soil.conductivity * self.relative_potential(place)
    }

    fn relative_potential(&self, place: f64) -> f64 {
        if place >= 0.0 {
            place
        } else if place < self.end {
            self.depth + TRACE * (place - self.end)
        } else {
            self.relative.at(place)
        }
    }

    /// The place of a potential (m2/s).
    pub fn place_of_potential(&self, potential: f64) -> f64 {
        let relative = potential / self.soil.conductivity;
        if relative >= 0.0 {
            return relative;
        }
        if relative <= self.depth {
            return self.end + (relative - self.depth) / TRACE;
        }
        solve_increasing(|place| (self.relative_potential(place) - relative, self.steepness(place)), self.end, 0.0)
    }

    fn relative_conductivity(&self, place: f64) -> f64 {
        if place >= 0.0 {
            1.0
        } else if place < self.end {
            TRACE
        } else {
            (self.soil.retention.relative_conductivity(suction(place)) * stretch(place)).max(TRACE)
        }
    }

    /// How the relative potential follows the place, by its table.
    fn steepness(&self, place: f64) -> f64 {
        if place >= 0.0 {
            1.0
        } else if place < self.end {
            TRACE
        } else {
            self.relative.slope(place).max(TRACE)
        }
    }

    /// How the potential follows the place (m/s): the hydraulic conductivity times how far the scale stretches suctions there.
    pub fn conductivity(&self, place: f64) -> f64 {
        self.soil.conductivity * self.steepness(place)
    }

    /// Hydraulic conductivity (m/s) at a place.
    pub fn hydraulic_conductivity(&self, place: f64) -> f64 {
        if place >= 0.0 {
            self.soil.conductivity
        } else if place < self.end {
            0.0
        } else {
            self.soil.conductivity * self.soil.retention.relative_conductivity(suction(place))
        }
    }

    /// What a particle holds.
    pub fn content(&self, place: f64) -> f64 {
        if place >= 0.0 {
            return self.soil.storage * place;
        }
        let stored = self.soil.storage * self.relative_potential(place.max(self.end));
        if place < self.end {
            return stored - self.drainable();
        }
        stored - self.drainable() * self.soil.retention.deficit(suction(place))
    }

    /// How the content follows the place.
    pub fn capacity(&self, place: f64) -> f64 {
        if place >= 0.0 {
            return self.soil.storage;
        }
        let at = place.max(self.end);
        let released = self.soil.retention.release(suction(at)) * stretch(at);
        self.drainable() * released + self.soil.storage * self.relative_conductivity(at)
    }

    /// The place of a content.
    pub fn place_of_content(&self, content: f64) -> f64 {
        if content >= 0.0 {
            return content / self.soil.storage;
        }
        if content <= self.driest_content() {
            return DRY;
        }
        if content <= self.content(self.end) {
            return self.end;
        }
        // Either what has drained or, near saturation, what pressure stores is little beside the other.
        let drained = place(-self.soil.retention.suction((-content / self.drainable()).min(1.0)));
        let guess = drained.max(content / self.soil.storage).clamp(self.end, 0.0);
        let residual = |place: f64| {
            let left = self.content(place) - content;
            // Below that, steps of the root are those of rounding.
            (if left.abs() <= f64::EPSILON * content.abs() { 0.0 } else { left }, self.capacity(place))
        };
        solve_increasing_from(residual, guess, self.end, 0.0)
    }

    /// Content of dry ground.
    pub fn driest_content(&self) -> f64 {
        self.soil.storage * self.depth - self.drainable()
    }

    /// Driest place at which the ground still conducts.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// By how much the potential of dry ground is lower than that of saturated ground (m2/s), negative.
    pub fn driest_potential(&self) -> f64 {
        self.soil.conductivity * self.depth
    }

    /// Slope of the potential over the content (m2/s) at a place: the diffusivity.
    pub fn diffusivity(&self, place: f64) -> f64 {
        self.soil.conductivity * self.relative_conductivity(place) / self.capacity(place)
    }
}

impl HeapSize for Moisture {
    fn heap_size(&self) -> usize {
        self.relative.heap_size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::retention::van_genuchten::VanGenuchten;
    use crate::physics::retention::{brooks_corey::BrooksCorey, gardner::Gardner};

    /// Soils from coarse to fine, and the one of Yan et al. 2020, table 1, first.
    fn soils() -> Vec<Moisture> {
        let soil = |retention: Retention| {
            Moisture::new(Soil {
                retention,
                residual: 0.186,
                saturated: 0.363,
                conductivity: 1e-9,
                storage: 1e-6,
                solute: None,
            })
        };
        let genuchten = |alpha: f64, exponent: f64| VanGenuchten { alpha, exponent, connectivity: 0.5 };
        let mut all = vec![soil(genuchten(1.0, 1.53).into())];
        for alpha in [0.1, 1.0, 10.0] {
            all.extend([1.1, 1.3, 2.0, 3.0].map(|n| soil(genuchten(alpha, n).into())));
        }
        all.push(soil(BrooksCorey { air_entry: 0.3, index: 0.6 }.into()));
        all.push(soil(Gardner { alpha: 2.0 }.into()));
        all
    }

    fn places() -> impl Iterator<Item = f64> {
        (-400..=100).map(|k| (k as f64 / 50.0).powi(5) / 100.0)
    }

    #[test]
    fn the_potential_of_saturated_ground_is_that_of_the_independent_quadrature() {
        // 0.203765 cm2/day for n = 1.53, alpha = 1/m, Ks = 8.64e-3 cm/day.
        let depth = -soils()[0].driest_potential() * 1e4 * 86400.0;
        assert!((depth - 0.203765).abs() < 1e-6, "{depth}");
    }

    #[test]
    fn contents_and_potentials_have_one_place_each() {
        for soil in soils() {
            for at in places().filter(|at| *at > soil.end()) {
                let content = soil.content(at);
                let back = soil.content(soil.place_of_content(content));
                assert!((back - content).abs() <= 4.0 * f64::EPSILON, "{:?} at {at}: {back} {content}", soil.soil);
                let potential = soil.potential(at);
                let back = soil.potential(soil.place_of_potential(potential));
                assert!((back - potential).abs() <= 1e-14 * soil.driest_potential().abs(), "{at}: {back} {potential}");
            }
        }
    }

    #[test]
    fn saturations_come_back_from_their_places() {
        for soil in soils() {
            for saturation in [0.0, 1e-4, 1e-2, 0.1, 0.5, 0.9, 0.999, 1.0] {
                let back = soil.saturation(soil.soil.place_of(saturation));
                assert!((back - saturation).abs() < 1e-12, "{:?} {saturation}: {back}", soil.soil);
            }
        }
    }

    #[test]
    fn capacity_and_conductivity_are_the_derivatives() {
        for soil in soils() {
            let kinks = soil.soil.retention.bends();
            for at in places().filter(|at| *at > soil.end() && at.abs() > 1e-6) {
                let step = 1e-5 * at.abs();
                let near_kink = |bend: &f64| (place(-bend) - at).abs() <= 2.0 * step;
                if kinks.iter().any(near_kink) {
                    continue;
                }
                let slope = |f: &dyn Fn(f64) -> f64| (f(at + step) - f(at - step)) / (2.0 * step);
                let capacity = slope(&|at| soil.content(at));
                // The content is a difference of numbers of the size of the drainable water.
                let rounding = 4.0 * f64::EPSILON / step;
                assert!(
                    (capacity - soil.capacity(at)).abs() < 1e-6 * soil.capacity(at) + rounding,
                    "{:?} {at}",
                    soil.soil
                );
                let conductivity = slope(&|at| soil.potential(at));
                let rounding = 4.0 * f64::EPSILON * soil.driest_potential().abs() / step;
                let allowed = 1e-6 * soil.conductivity(at) + rounding;
                assert!((conductivity - soil.conductivity(at)).abs() < allowed, "{:?} {at}", soil.soil);
            }
        }
    }

    #[test]
    fn dry_ground_holds_the_residual_content_and_conducts_nothing() {
        for soil in soils() {
            assert_eq!(soil.soil.place_of(0.0), DRY);
            assert_eq!(soil.saturation(DRY), 0.0);
            let held = soil.content(DRY) - soil.soil.storage * soil.depth;
            assert!((held + soil.drainable()).abs() < 1e-15);
            assert!(soil.conductivity(DRY) < 1e-29 * soil.soil.conductivity);
        }
    }
}
