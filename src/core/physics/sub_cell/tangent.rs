//! How what fronts add follows small changes of the state.

use super::SubCellFront;
use super::pairs::{OwnPair, distance};
use crate::memory::HeapSize;
use crate::physics::laws::Laws;
use crate::space::lattice::Lattice;

/// How rates follow potentials and the enthalpies of freezing particles, where fronts stay in cells, across the axes of pairs.
#[derive(Debug, Clone, Default)]
pub(super) struct FrontTangent {
    /// Particles whose fronts are followed, and what their enthalpy changes by for each watt a metre that they are given (s/m2).
    freezing: Vec<(u32, f64)>,
    /// Rates by potentials: the particle that is changed, the one that changes it, and the factor (m^-2).
    by_potential: Vec<(u32, u32, f64)>,
    /// Rates by enthalpies of freezing particles: the particle that is changed, which of `freezing`, and the factor (1/s).
    by_enthalpy: Vec<(u32, u32, f64)>,
    /// Changes of potentials (W/m), without those of freezing particles, and what their enthalpies change by (J/m3).
    changes: Vec<f64>,
    kept: Vec<f64>,
}

impl SubCellFront {
    /// Linearises at a state of enthalpies (J/m3) of a body whose equations are solved. Potentials of freezing particles do
    /// not follow their enthalpies: they are given the slope `steepest` (m2/s) in `slopes`, and stand for the change of the
    /// enthalpy.
    pub fn linearise(
        &mut self,
        lattice: &Lattice,
        enthalpy: &[f64],
        laws: &impl Laws,
        steepest: impl Fn(usize) -> f64,
        slopes: &mut [f64],
    ) {
        let FrontTangent { freezing, by_potential, by_enthalpy, .. } = &mut self.tangent;
        freezing.clear();
        by_potential.clear();
        by_enthalpy.clear();
        self.look(enthalpy, laws);
        self.each_front(lattice, enthalpy, 1, |front, _, fronts, particle, sharp| {
            let states = (laws, enthalpy);
            front.one.look_around((lattice, &front.surroundings), fronts, states, (sharp.potential, sharp.middle()));
            front.one.note_phases(&front.faces);
            slopes[particle] = steepest(particle);
            front.tangent.freezing.push((particle as u32, 1.0 / slopes[particle]));
            front.exchange_changes(-1.0 / (sharp.interval.1 - sharp.interval.0));
        });
    }

    /// How what the front in the middle of the window exchanges follows the potentials around it, and the enthalpy of its own
    /// particle, with which the frozen fraction goes by `slope` (m3/J).
    fn exchange_changes(&mut self, slope: f64) {
        let FrontTangent { freezing, by_potential, by_enthalpy, .. } = &mut self.tangent;
        let (window, pairs) = (&self.one, &self.pairs);
        let [fraction] = window.fractions;
        let (middle, own) = (window.above.len() / 2, freezing.len() as u32 - 1);
        let name = |place: usize| window.particle(place, 0);
        let seen = |place: u32| window.above[place as usize][0];
        for OwnPair { other, opposite, cells, weight, .. } in &pairs.own {
            let (above, beyond, other, cells) = (seen(*other), seen(*opposite), *other as usize, *cells);
            if above != 0.0 {
                let (share, grows) = if above < 0.0 { (fraction, 1.0) } else { (1.0 - fraction, -1.0) };
                let fronts = if above * beyond > 0.0 { 2.0 } else { 1.0 };
                let far = distance(cells, share / fronts);
                let by_above = weight * (cells / far - 1.0);
                let by_fraction = -weight * above * cells / (far * far) * grows / fronts * slope;
                by_potential.extend([(name(other), name(other), -by_above), (name(middle), name(other), by_above)]);
                by_enthalpy.extend([(name(other), own, -by_fraction), (name(middle), own, by_fraction)]);
            }
        }
        for pair in &pairs.over {
            let (below, above) = (seen(pair.frozen), seen(pair.unfrozen));
            if pairs.is_taken(pair, window) {
                let carried = pair.weight * pair.cells as f64;
                let near = distance(pair.before as f64, fraction);
                let far = distance((pair.cells - pair.before) as f64, 1.0 - fraction);
                let (cold, warm, direct) = (carried / near, carried / far, pair.weight);
                let rows = [name(pair.frozen as usize), name(pair.unfrozen as usize), name(middle)];
                for (row, (by_below, by_above)) in
                    rows.into_iter().zip([(direct - cold, -direct), (-direct, direct - warm), (cold, warm)])
                {
                    by_potential.extend([(row, rows[0], by_below), (row, rows[1], by_above)]);
                }
                let (cold, warm) = (-cold * below / near * slope, warm * above / far * slope);
                by_enthalpy.extend([(rows[0], own, -cold), (rows[1], own, -warm), (rows[2], own, cold + warm)]);
            }
        }
    }

    /// Takes small changes of potentials (W/m) apart, and gives them without those of freezing particles.
    pub fn hold_back(&mut self, potentials: &[f64]) -> &[f64] {
        let FrontTangent { freezing, changes, kept, .. } = &mut self.tangent;
        changes.clear();
        changes.extend_from_slice(potentials);
        kept.clear();
        let enthalpy = |(particle, by): &(u32, f64)| by * std::mem::take(&mut changes[*particle as usize]);
        kept.extend(freezing.iter().map(enthalpy));
        changes
    }

    /// Adds to `rates` (W/m3) how fronts follow the changes that were taken apart last.
    pub fn act(&self, rates: &mut [f64]) {
        let FrontTangent { by_potential, by_enthalpy, changes, kept, .. } = &self.tangent;
        for (row, column, factor) in by_potential {
            rates[*row as usize] += factor * changes[*column as usize];
        }
        for (row, number, factor) in by_enthalpy {
            rates[*row as usize] += factor * kept[*number as usize];
        }
    }
}

impl HeapSize for FrontTangent {
    fn heap_size(&self) -> usize {
        let FrontTangent { freezing, by_potential, by_enthalpy, changes, kept } = self;
        let factors = freezing.heap_size() + by_potential.heap_size() + by_enthalpy.heap_size();
        factors + changes.heap_size() + kept.heap_size()
    }
}
