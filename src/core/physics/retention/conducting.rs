//! Hydraulic conductivity and head of unsaturated ground by its content, in tables like those of its potential.

use crate::memory::HeapSize;
use crate::physics::retention::moisture::Moisture;
use crate::physics::retention::scale::{head, place};
use crate::physics::retention::tabulated::{Nodes, places};

/// Content to hydraulic conductivity and head, by the same nodes as [`crate::physics::retention::tabulated::Tabulated`] has them:
/// what gravity moves, and what bonds by means of conductivities do, is asked for at every particle in every evaluation, and a
/// root each time would cost more than all pairs.
#[derive(Debug, Clone)]
pub struct Conducting {
    saturated: f64,
    dry: f64,
    middle: f64,
    wet: Nodes,
    moist: Nodes,
    /// Places on the scale of heads, by the same distances: less that of the driest conducting ground in the moist table.
    wet_place: Nodes,
    moist_place: Nodes,
    end: f64,
    storage: f64,
}

/// Suction (m) below which the conductivity rises in proportion to the content. Curves of fine soils rise to saturation infinitely
/// steeply, by half of their conductivity within this much, which nothing measures and no step can follow.
pub const LEAST_SUCTION: f64 = 1e-6;

/// How far tables go over the middle, where the other begins: by more than a node, as the slope at the last is a guess.
const BEYOND: f64 = 1.04;

impl Conducting {
    /// The conductivity of a soil.
    pub fn new(soil: &Moisture) -> Self {
        let (dry, scale, saturated) = (soil.driest_content(), soil.drainable(), soil.soil().conductivity);
        let (middle, end, storage) = (0.5 * dry, soil.end(), soil.soil().storage);
        let most = -BEYOND * middle;
        let (_, distances) = places(scale, most);
        let nodes = |values: Vec<f64>| Nodes::by_values(scale, most, &values);
        let wet: Vec<f64> = distances.iter().map(|distance| soil.place_of_content(-distance)).collect();
        let moist: Vec<f64> = distances.iter().map(|distance| soil.place_of_content(dry + distance).max(end)).collect();
        let conductivity = |place: &f64| soil.hydraulic_conductivity(*place);
        Conducting {
            saturated,
            dry,
            middle,
            end,
            storage,
            wet: nodes(wet.iter().map(|place| conductivity(place) - saturated).collect())
                .straight_below(-soil.content(place(-LEAST_SUCTION))),
            moist: nodes(moist.iter().map(conductivity).collect()),
            moist_place: nodes(moist.iter().map(|place| place - end).collect()),
            wet_place: nodes(wet),
        }
    }

    /// Conductivity (m/s) at a content less that of saturation.
    #[inline]
    pub fn at(&self, content: f64) -> f64 {
        if content >= 0.0 {
            self.saturated
        } else if content > self.middle {
            self.saturated + self.wet.at(-content)
        } else if content > self.dry {
            self.moist.at(content - self.dry)
        } else {
            0.0
        }
    }

    /// Pressure head (m) at such a content; of ground that is drier than any that conducts, the head of that.
    #[inline]
    pub fn head(&self, content: f64) -> f64 {
        if content >= 0.0 {
            content / self.storage
        } else if content > self.middle {
            head(self.wet_place.at(-content))
        } else {
            head(self.end + self.moist_place.at((content - self.dry).max(0.0)))
        }
    }

    /// How the conductivity follows the content (m/s).
    #[inline]
    pub fn slope(&self, content: f64) -> f64 {
        if content >= 0.0 || content <= self.dry {
            0.0
        } else if content > self.middle {
            -self.wet.slope(-content)
        } else {
            self.moist.slope(content - self.dry)
        }
    }
}

impl HeapSize for Conducting {
    fn heap_size(&self) -> usize {
        [&self.wet, &self.moist, &self.wet_place, &self.moist_place].into_iter().map(HeapSize::heap_size).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::retention::gardner::Gardner;
    use crate::physics::retention::moisture::Soil;
    use crate::physics::retention::van_genuchten::VanGenuchten;

    #[test]
    fn tables_follow_the_exact_conductivity_and_never_fall() {
        let mut curves = vec![Gardner { alpha: 2.0 }.into()];
        for (alpha, exponent) in [(1.0, 1.53), (10.0, 1.1), (0.1, 3.0)] {
            curves.push(VanGenuchten { alpha, exponent, connectivity: 0.5 }.into());
        }
        for retention in curves {
            let soil =
                Soil { retention, residual: 0.05, saturated: 0.4, conductivity: 1e-5, storage: 1e-6, solute: None };
            let soil = Moisture::new(soil);
            let table = Conducting::new(&soil);
            let mut last = 0.0;
            for k in 1..20_000 {
                let saturation = 0.5 * (1.0 + (8.0 * (k as f64 / 10_000.0 - 1.0)).tanh());
                let content = soil.driest_content() * (1.0 - saturation);
                let exact = soil.hydraulic_conductivity(soil.place_of_content(content));
                let own = table.at(content);
                let followed = (own - exact).abs() < 1e-6 * 1e-5 || table.head(content) > -2.0 * LEAST_SUCTION;
                assert!(followed, "{:?} {saturation}: {own} {exact}", soil.soil());
                // The head of the driest ground has hundreds of digits, and is known as well as its logarithm; the table has a kink
                // where nothing flows any more.
                let (exact, by_table) = (soil.place_of_content(content), place(table.head(content)));
                let close = (by_table - exact).abs() < 1e-6 * (1.0 - soil.end());
                assert!(close || exact < soil.end() + 1.0, "{:?} {saturation}: {by_table} {exact}", soil.soil());
                assert!(own >= last && table.slope(content) >= 0.0, "{:?} {saturation}", soil.soil());
                last = own;
            }
        }
    }
}
