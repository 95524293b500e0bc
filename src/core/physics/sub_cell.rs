//! Sharp fronts inside particles.
//!
//! A particle that is freezing has no temperature of its own to conduct with: the front lies somewhere in its cell, and
//! its frozen fraction `f` tells where. Left alone, its neighbours exchange heat with the centre of the cell, wherever the
//! front is, and fluxes go up and down as the front crosses one cell after another. Here they exchange with the front. The
//! front is taken to lie across the longer axis of a pair, or, where nothing varies along the other axis of the body, across
//! the one that is left, as on the line that stands for such a body: a pair over `k` spacings along it whose one end lies `s`
//! spacings before the freezing cell carries `k / d` times as much between that end and the freezing particle, with
//! `d = s - 1/2 + f` on the frozen side and `s + 1/2 - f` on the other. Over the time in which a cell freezes this and
//! the plain exchange with its centre agree: the mean of `d` is `s`. Where both sides of a cell are in the same phase, two
//! fronts move toward each other, and each has half of the cell. Where a pair reaches over a freezing cell from one
//! phase to the other, both ends exchange with the front and not with each other.
//!
//! Every term is exchanged between two particles, so heat is conserved; weights stay positive, so with a step by the row
//! sums given here the maximum principle holds as without. On a line the error falls with the square of the spacing, for
//! every method (docs/theory/heat.md).

mod changes;
mod pairs;
mod window;

use crate::bonds::stencil::Stencil;
use crate::instruction_set::widest;
use crate::memory::HeapSize;
use crate::physics::latent_heat::Materials;
use crate::physics::laws::Laws;
use crate::physics::sharp_stretches::{Sharp, find, stretches};
use crate::solvers::kept::add_one;
use crate::space::lattice::Lattice;
use changes::Changes;
use pairs::{LANES, OwnPair, Pairs, distance, exchange};
use window::{Front, Surroundings, Window};

/// What fronts need to know of a body beside its particles.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Least and greatest temperature of the scene.
    pub temperatures: (f64, f64),
    /// Left, right, bottom, top: whether what lies beyond is the mirror image of the body.
    pub mirrors: [bool; 4],
    /// Along x and y: whether the body repeats.
    pub repeats: [bool; 2],
    /// Whether fronts run along y, or along x, where nothing varies across.
    pub along_y: Option<bool>,
}

/// The fronts of a body whose materials, or some of them, freeze at one temperature.
#[derive(Debug, Clone)]
pub struct SubCellFront {
    sharp: Vec<Sharp>,
    /// Neighbouring particles of one material whose fronts are followed: the first, one past the last, and which of `sharp`.
    stretches: Vec<(u32, u32, u32)>,
    pairs: Pairs,
    surroundings: Surroundings,
    /// Particles that freeze.
    freezing: Vec<u32>,
    /// Cells and frozen fractions of those at hand.
    fronts: Vec<Front>,
    /// What lies around several of them, in a plane, and around one.
    several: Option<Window<LANES>>,
    one: Window<1>,
    /// What fronts add to the rates of particles (W/m3).
    changes: Changes,
    /// How that follows small changes.
    tangent: FrontTangent,
}

/// How what fronts add follows small changes of the state.
#[derive(Debug, Clone, Default)]
struct FrontTangent {
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
    /// Fronts of materials on a lattice. Particles that `mixed` tells have neighbours of other materials, or pairs that are
    /// cut: they are taken as wholes.
    pub fn new(
        materials: &Materials,
        extent: Extent,
        lattice: &Lattice,
        stencil: &Stencil,
        mixed: impl Fn(usize) -> bool,
    ) -> Self {
        let (sharp, stretches) = stretches(materials, extent.temperatures, lattice.len(), mixed);
        let across = stencil.reach as i64;
        let reach = (across, if lattice.dimension == 1 { 0 } else { across });
        let surroundings = Surroundings { reach, mirrors: extent.mirrors, repeats: extent.repeats };
        let pairs = Pairs::new(stencil, &surroundings, extent.along_y);
        let longest = pairs.longest;
        let several = (lattice.dimension > 1).then(|| Window::new(&surroundings, longest));
        let one = Window::new(&surroundings, longest);
        let changes = Changes::with_room(2 * one.changes.len() * (lattice.columns + lattice.rows));
        SubCellFront {
            sharp,
            stretches,
            pairs,
            surroundings,
            freezing: Vec::new(),
            fronts: Vec::with_capacity(LANES),
            several,
            one,
            changes,
            tangent: FrontTangent::default(),
        }
    }

    /// Brings the fronts to a state of enthalpies (J/m3).
    pub fn update(&mut self, lattice: &Lattice, enthalpy: &[f64], laws: &impl Laws) {
        self.changes.clear();
        let most = if self.several.is_some() { LANES } else { 1 };
        self.each_front(lattice, enthalpy, most, |front, fronts, _, sharp| {
            let SubCellFront { pairs, surroundings, several, one, changes, .. } = front;
            let (place, states, at_front) =
                ((lattice, &*surroundings), (laws, enthalpy), (sharp.potential, sharp.middle()));
            match several {
                Some(window) => act_widely(window, pairs, place, fronts, states, at_front, changes),
                None => act(one, pairs, place, fronts, states, at_front, changes),
            }
        });
    }

    /// Time (s) after which, if the rates (W/m3) go on, a particle of a line next begins or ends to freeze; infinite in a plane, where
    /// one of so many always does soon.
    pub fn next_kink(&self, enthalpy: &[f64], rates: &[f64]) -> f64 {
        let mut next = f64::INFINITY;
        if self.several.is_some() {
            return next;
        }
        for (first, end, sharp) in &self.stretches {
            let (of_stretch, sharp) = (*first as usize..*end as usize, &self.sharp[*sharp as usize]);
            for (enthalpy, rate) in enthalpy[of_stretch.clone()].iter().zip(&rates[of_stretch]) {
                for edge in [sharp.interval.0, sharp.interval.1] {
                    let time = (edge - enthalpy) / rate;
                    next = if time > 0.0 && time < next { time } else { next };
                }
            }
        }
        next
    }

    /// Linearises at a state of enthalpies (J/m3). Potentials of freezing particles do not follow their enthalpies: they are given the
    /// slope `steepest` (m2/s) in `slopes`, and stand for the change of the enthalpy.
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
        self.each_front(lattice, enthalpy, 1, |front, fronts, particle, sharp| {
            let states = (laws, enthalpy);
            front.one.look_around((lattice, &front.surroundings), fronts, states, (sharp.potential, sharp.middle()));
            front.one.note_phases();
            slopes[particle] = steepest(particle);
            front.tangent.freezing.push((particle as u32, 1.0 / slopes[particle]));
            front.exchange_changes(-1.0 / (sharp.interval.1 - sharp.interval.0));
        });
    }

    /// Does something at every front, at most so many of them at a time: by their cells and frozen fractions, by the particle of the
    /// first, and by the material.
    fn each_front(
        &mut self,
        lattice: &Lattice,
        enthalpy: &[f64],
        most: usize,
        mut some: impl FnMut(&mut Self, &[Front], usize, Sharp),
    ) {
        // Particles come in the order of their rows.
        let mut row = 0;
        let (mut freezing, mut fronts) = (std::mem::take(&mut self.freezing), std::mem::take(&mut self.fronts));
        for stretch in 0..self.stretches.len() {
            let (first, end, sharp) = self.stretches[stretch];
            let sharp = self.sharp[sharp as usize];
            let (frozen, unfrozen) = sharp.interval;
            freezing.clear();
            find(&enthalpy[first as usize..end as usize], first, (frozen, unfrozen), &mut freezing);
            for particles in freezing.chunks(most) {
                fronts.clear();
                fronts.extend(particles.iter().map(|particle| {
                    let particle = *particle as usize;
                    while lattice.start(row + 1) <= particle {
                        row += 1;
                    }
                    let column = lattice.span(row).0 + particle - lattice.start(row);
                    ((column as i64, row as i64), (unfrozen - enthalpy[particle]) / (unfrozen - frozen))
                }));
                some(self, &fronts, particles[0] as usize, sharp);
            }
        }
        (self.freezing, self.fronts) = (freezing, fronts);
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
        for OwnPair { other, opposite, cells, weight } in &pairs.own {
            let (above, beyond, other, cells) = (seen(*other), seen(*opposite), *other as usize, *cells as f64);
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

    /// Adds what the fronts exchange to `rates`, scaled.
    #[inline]
    pub fn add(&self, rates: &mut [f64], scale: f64) {
        for (particle, change) in self.changes.all() {
            rates[*particle as usize] += scale * change;
        }
    }

    /// The same to contents, with what rounding takes from them kept in `lost`.
    #[inline]
    pub fn add_keeping(&self, contents: &mut [f64], lost: &mut [f64], scale: f64) {
        for (particle, change) in self.changes.all() {
            add_one(&mut contents[*particle as usize], scale * change, &mut lost[*particle as usize]);
        }
    }

    /// What fronts may add to the row sum (m^-2) of a particle: where they have just come nearest on all sides.
    pub fn row_sum(&self) -> f64 {
        self.pairs.own.iter().map(|pair| pair.weight * (pair.cells as f64 / distance(1.0, 0.0) - 1.0)).sum()
    }

    /// Rate (1/s) at which a freezing particle answers to its own frozen fraction, at most: all that surrounds it is as
    /// far from the freezing point as can be.
    pub fn own_rate(&self) -> f64 {
        let nearest =
            |pair: &OwnPair| -> f64 { (1..=pair.cells).map(|before| distance(before as f64, 0.0).powi(-2)).sum() };
        let by_pairs: f64 = self.pairs.own.iter().map(|pair| pair.weight * pair.cells as f64 * nearest(pair)).sum();
        let answer = |sharp: &Sharp| sharp.most / (sharp.interval.1 - sharp.interval.0);
        by_pairs * self.sharp.iter().map(answer).fold(0.0, f64::max)
    }
}

/// Temperature at the centre of a freezing particle, less that of freezing: on the line from the front in its cell to the
/// neighbours in the phase in which the centre is. `temperature` tells that of a particle, less that of freezing.
pub fn at_the_centre(lattice: &Lattice, index: usize, fraction: f64, temperature: impl Fn(usize) -> f64) -> f64 {
    let (column, row) = lattice.cell(index);
    let frozen_side = fraction > 0.5;
    let depth = (fraction - 0.5).abs();
    let (mut sum, mut count) = (0.0, 0.0);
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().take(2 * lattice.dimension) {
        if let Some(other) = lattice.index(column + dx, row + dy) {
            let above = temperature(other);
            if above != 0.0 && (above < 0.0) == frozen_side {
                sum += above * depth / (depth + 1.0);
                count += 1.0;
            }
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

widest!(
    act_widely,
    act[Lw: Laws, _],
    (
        window: &mut Window<LANES>,
        pairs: &Pairs,
        place: (&Lattice, &Surroundings),
        fronts: &[Front],
        states: (&Lw, &[f64]),
        at_front: (f64, f64),
        changes: &mut Changes
    )
);

/// Lets some fronts act on what lies around them: see [`Window::look_around`].
#[inline(always)]
fn act<Lw: Laws, const L: usize>(
    window: &mut Window<L>,
    pairs: &Pairs,
    place: (&Lattice, &Surroundings),
    fronts: &[Front],
    states: (&Lw, &[f64]),
    at_front: (f64, f64),
    changes: &mut Changes,
) {
    window.look_around(place, fronts, states, at_front);
    exchange(pairs, window);
    window.collect(changes);
}

impl HeapSize for SubCellFront {
    fn heap_size(&self) -> usize {
        let windows = self.one.heap_size() + self.several.as_ref().map_or(0, HeapSize::heap_size);
        let states = windows + self.changes.heap_size() + self.freezing.heap_size();
        let FrontTangent { freezing, by_potential, by_enthalpy, changes, kept } = &self.tangent;
        let factors = freezing.heap_size() + by_potential.heap_size() + by_enthalpy.heap_size();
        let tangent = factors + changes.heap_size() + kept.heap_size();
        self.pairs.heap_size() + states + tangent
    }
}
