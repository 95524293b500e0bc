//! How what fronts add follows small changes of the state.

use super::exchange::opposite;
use super::numbers::{Flags as _, Portable};
use super::pairs::{Cut, End, distance};
use super::window::Window;
use super::{Acting, Found, Group, SubCellFront};
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
        self.look(None, enthalpy, laws);
        self.find(lattice, enthalpy, 1);
        let Found { fronts, groups } = std::mem::take(&mut self.found);
        for Group { fronts: some, sharp, particle, .. } in &groups {
            let SubCellFront { sharp: materials, surroundings, faces, one: Acting { window, .. }, .. } = self;
            let (sharp, states) = (materials[*sharp as usize], (laws, enthalpy));
            let at = (sharp.potential, sharp.middle());
            window.look_around((lattice, &*surroundings), &fronts[some.clone()], states, at);
            window.note_phases(faces);
            let slope = &mut slopes[*particle as usize];
            *slope = steepest(*particle as usize);
            self.tangent.freezing.push((*particle, 1.0 / *slope));
            self.exchange_changes(sharp.interval);
        }
        self.found = Found { fronts, groups };
    }

    /// How what the front in the middle of the window exchanges follows the potentials around it, and the enthalpy of its own
    /// particle, which freezes between two (J/m3).
    fn exchange_changes(&mut self, interval: (f64, f64)) {
        let slope = -1.0 / (interval.1 - interval.0);
        let FrontTangent { freezing, by_potential, by_enthalpy, .. } = &mut self.tangent;
        let (window, pairs) = (&self.one.window, &self.pairs);
        let mut flows = Flows { window, by_potential, by_enthalpy, own: freezing.len() as u32 - 1, slope };
        for pair in pairs.own.iter().filter(|pair| pair.cells < 2.0) {
            flows.add_straight(pair.other, pair.cells, pair.weight);
        }
        for (number, cut) in pairs.cuts.iter().enumerate() {
            let is_over = number >= pairs.own_cuts;
            let Cut { end, other, weight, number, cells, .. } = *cut;
            if !cut.is_made(Portable, pairs, (window, interval), !is_over).any() {
                if !is_over && !window.is_clear && !window.is_free(Portable, cut.sums).any() {
                    flows.add_straight(end, cells, weight);
                }
            } else {
                flows.add((end, other), end, -weight);
                let End { before, cells: to_end, .. } = pairs.ends[number as usize];
                flows.add_to_front((end, before), to_end, weight * cells);
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

/// How heat that flows between particles around a front follows their potentials, and the frozen fraction of the front.
struct Flows<'a> {
    window: &'a Window<1>,
    by_potential: &'a mut Vec<(u32, u32, f64)>,
    by_enthalpy: &'a mut Vec<(u32, u32, f64)>,
    /// Which of the freezing particles the front is in.
    own: u32,
    /// How its frozen fraction goes with its enthalpy (m3/J).
    slope: f64,
}

impl Flows<'_> {
    fn name(&self, place: u32) -> u32 {
        self.window.particle(place as usize, 0)
    }

    fn middle(&self) -> u32 {
        self.window.above.len() as u32 / 2
    }

    /// Heat from one place to another that goes by the potential of a place, with a factor (m^-2).
    fn add(&mut self, (from, to): (u32, u32), by: u32, factor: f64) {
        let (from, to, by) = (self.name(from), self.name(to), self.name(by));
        self.by_potential.extend([(from, by, -factor), (to, by, factor)]);
    }

    /// Heat from a place, so many spacings before the middle, with another place next to the middle on its way, to the front, by a
    /// factor (m^-2) over a spacing.
    fn add_to_front(&mut self, (place, before): (u32, u32), spacings: f64, factor: f64) {
        let seen = |place: u32| self.window.above[place as usize][0];
        let (above, [fraction]) = (seen(place), self.window.fractions);
        let (share, grows) = if above < 0.0 { (fraction, 1.0) } else { (1.0 - fraction, -1.0) };
        let are_two = seen(before) * seen(opposite(self.window.above.len(), before)) > 0.0;
        let fronts = if are_two { 2.0 } else { 1.0 };
        let far = distance(spacings, share / fronts);
        self.add((place, self.middle()), place, factor / far);
        let by_fraction = -factor * above / (far * far) * grows / fronts * self.slope;
        let (from, to) = (self.name(place), self.name(self.middle()));
        self.by_enthalpy.extend([(from, self.own, -by_fraction), (to, self.own, by_fraction)]);
    }

    /// What a pair of the middle over so many spacings exchanges more than plainly, by its weight (m^-2).
    fn add_straight(&mut self, place: u32, cells: f64, weight: f64) {
        if self.window.above[place as usize][0] != 0.0 {
            self.add((place, self.middle()), place, -weight);
            self.add_to_front((place, place), cells, weight * cells);
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
