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
//! phase to the other, both ends exchange with the front and not with each other. Where a front has left one cell and not yet
//! entered the next, it lies on the face between them.
//!
//! Every term is exchanged between two particles, so heat is conserved; weights stay positive, so with a step by the row
//! sums given here the maximum principle holds as without. On a line the error falls with the square of the spacing, for
//! every method (docs/theory/heat.md).

mod changes;
mod exchange;
mod extent;
mod faces;
mod numbers;
mod orientation;
mod pairs;
mod phases;
mod readings;
mod tangent;
mod window;

use std::ops::Range;

use crate::bonds::stencil::Stencil;
use crate::memory::HeapSize;
use crate::physics::latent_heat::Materials;
use crate::physics::laws::Laws;
use crate::physics::sharp_stretches::{Sharp, Stretch, material_of, stretches};
use crate::side_by_side::first_reached;
use crate::solvers::kept::add_one;
use crate::space::lattice::Lattice;
use crate::team::{Team, share};
use changes::Changes;
use exchange::exchange;
pub use extent::Extent;
use faces::Faces;
use numbers::{Kind, LANES, Portable, by_kind};
use pairs::{OwnPair, Pairs, distance};
use phases::Phases;
pub use readings::{at_the_centre, cells_with_fronts, front_fraction};
use tangent::FrontTangent;
use window::{Front, Surroundings, Window};

/// The fronts of a body whose materials, or some of them, freeze at one temperature.
#[derive(Debug, Clone)]
pub struct SubCellFront {
    sharp: Vec<Sharp>,
    /// Particles whose fronts are followed.
    stretches: Vec<Stretch>,
    phases: Phases,
    pairs: Pairs,
    surroundings: Surroundings,
    /// Fronts on faces between particles.
    faces: Faces,
    /// Particles of a stretch that freeze.
    freezing: Vec<u32>,
    /// Fronts that were found.
    found: Found,
    /// Where several of them act at once, in a plane: one for each thread.
    several: Vec<Acting<LANES>>,
    /// Where one does.
    one: Acting<1>,
    /// How that follows small changes.
    tangent: FrontTangent,
}

/// Where a front is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Where {
    /// In the cell of a freezing particle.
    Inside,
    /// On the face of a particle that it enters.
    Entering,
}

/// Fronts that were found, in groups of which all are alike.
#[derive(Debug, Clone, Default)]
struct Found {
    /// Cells and frozen fractions.
    fronts: Vec<Front>,
    groups: Vec<Group>,
}

/// Fronts that act at once.
#[derive(Debug, Clone)]
struct Group {
    /// Which of those found.
    fronts: Range<usize>,
    lies: Where,
    /// Number of their material.
    sharp: u32,
    /// Particle of the first.
    particle: u32,
}

/// Where some fronts act at once.
#[derive(Debug, Clone)]
struct Acting<const L: usize> {
    /// What lies around them.
    window: Window<L>,
    /// What fronts add to the rates of particles (W/m3).
    changes: Changes,
}

/// Groups that a thread must have to itself: fewer are done before they are shared.
const GROUPS_PER_THREAD: usize = 16;

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
        let pairs = Pairs::new(stencil, &surroundings, &extent);
        let numbers = (pairs.ends.len(), pairs.spans.len());
        let (is_plane, window) = (lattice.dimension > 1, Window::new(&surroundings, numbers));
        // In a plane, one front at a time is for the linearisation alone, which has no list of changes.
        let along = 2 * window.changes.len() * (lattice.columns + lattice.rows);
        let several = is_plane
            .then(|| Acting { window: Window::new(&surroundings, numbers), changes: Changes::with_room(along) });
        SubCellFront {
            phases: Phases::new(lattice.len()),
            faces: Faces::new(lattice, &extent),
            sharp,
            stretches,
            pairs,
            surroundings,
            freezing: Vec::new(),
            found: Found::default(),
            several: several.into_iter().collect(),
            one: Acting { changes: Changes::with_room(if is_plane { 0 } else { along }), window },
            tangent: FrontTangent::default(),
        }
    }

    /// With room for so many threads, which share it.
    #[must_use]
    pub fn shared_among(mut self, threads: usize) -> Self {
        if let Some(first) = self.several.first().cloned() {
            self.several.resize(threads, first);
        }
        self
    }

    /// Brings the fronts to a state of enthalpies (J/m3), with threads if there are more than one.
    pub fn update(&mut self, team: Option<&Team>, lattice: &Lattice, enthalpy: &[f64], laws: &impl Laws) {
        self.look(team, enthalpy, laws);
        let most = if self.several.is_empty() { 1 } else { LANES };
        self.find(lattice, enthalpy, most);
        let SubCellFront { sharp, pairs, faces, surroundings, found: Found { fronts, groups }, several, one, .. } =
            self;
        one.changes.clear();
        several.iter_mut().for_each(|acting| acting.changes.clear());
        let place = (lattice, &*surroundings);
        let of_group = |group: &Group| {
            let all = (&*pairs, &*faces, group.lies);
            (all, (&fronts[group.fronts.clone()], &sharp[group.sharp as usize]))
        };
        let states = (laws, enthalpy);
        if several.is_empty() {
            for group in &*groups {
                let (all, fronts) = of_group(group);
                act(Portable, one, all, place, fronts, states);
            }
            return;
        }
        // Parts of groups in their order: whoever does them, changes come as they would from one thread.
        let parts = several.len().min(groups.len() / GROUPS_PER_THREAD).max(1);
        let length = groups.len().div_ceil(parts).max(1);
        share(team.filter(|_| parts > 1), several.iter_mut().zip(groups.chunks(length)), |(acting, groups)| {
            for group in groups {
                let (all, fronts) = of_group(group);
                act_widely(acting, all, place, fronts, states);
            }
        });
    }

    /// Time (s) after which, if the rates (W/m3) go on, a particle of a line next begins or ends to freeze, or a front on a
    /// face turns to the particle on the other side, or `within` where none does so earlier; infinite in a plane, where one of so many
    /// always does soon.
    pub fn next_kink(&self, enthalpy: &[f64], rates: &[f64], within: f64, laws: &impl Laws) -> f64 {
        if !self.several.is_empty() {
            return f64::INFINITY;
        }
        let mut next = within;
        for (first, end, sharp) in &self.stretches {
            let (of_stretch, interval) = (*first as usize..*end as usize, self.sharp[*sharp as usize].interval);
            first_reached(&enthalpy[of_stretch.clone()], &rates[of_stretch], interval, &mut next);
        }
        let mut note = |time: f64| next = if time > 0.0 && time < next { time } else { next };
        for (one, other) in self.faces.apart() {
            let potential = self.sharp[material_of(&self.stretches, *one) as usize].potential;
            let sides = [one, other].map(|particle| {
                let particle = *particle as usize;
                let above = laws.potential_of(particle, enthalpy[particle]) - potential;
                (above, laws.slope_of(particle, enthalpy[particle]) * rates[particle])
            });
            note(-(sides[0].0 + sides[1].0) / (sides[0].1 + sides[1].1));
        }
        next
    }

    /// Finds the fronts of a state of enthalpies (J/m3).
    fn look(&mut self, team: Option<&Team>, enthalpy: &[f64], laws: &impl Laws) {
        let followed = (self.sharp.as_slice(), self.stretches.as_slice());
        self.phases.update(team, followed, enthalpy);
        self.faces.update(&self.phases, followed, enthalpy, laws);
    }

    /// Finds the fronts of the phases and faces that were found, at most so many of them in a group.
    fn find(&mut self, lattice: &Lattice, enthalpy: &[f64], most: usize) {
        let SubCellFront { sharp, stretches, phases, faces, freezing, found: Found { fronts, groups }, .. } = self;
        let fraction = |number: u32, particle: usize| {
            let (frozen, unfrozen) = sharp[number as usize].interval;
            ((unfrozen - enthalpy[particle]) / (unfrozen - frozen)).clamp(0.0, 1.0)
        };
        fronts.clear();
        groups.clear();
        // Particles come in the order of their rows.
        let mut row = 0;
        for stretch in &*stretches {
            let sharp = stretch.2;
            freezing.clear();
            phases.find_freezing(*stretch, freezing);
            for particles in freezing.chunks(most) {
                let first = fronts.len();
                fronts.extend(particles.iter().map(|particle| {
                    let particle = *particle as usize;
                    while lattice.start(row + 1) <= particle {
                        row += 1;
                    }
                    let column = lattice.span(row).0 + particle - lattice.start(row);
                    ((column as i64, row as i64), fraction(sharp, particle))
                }));
                groups.push(Group { fronts: first..fronts.len(), lies: Where::Inside, sharp, particle: particles[0] });
            }
        }
        for alike in faces.entered().chunk_by(|one, next| one.0 == next.0) {
            for entered in alike.chunks(most) {
                let (first, (sharp, particle)) = (fronts.len(), entered[0]);
                fronts.extend(entered.iter().map(|(_, particle)| {
                    let particle = *particle as usize;
                    (lattice.cell(particle), fraction(sharp, particle))
                }));
                groups.push(Group { fronts: first..fronts.len(), lies: Where::Entering, sharp, particle });
            }
        }
    }

    /// What fronts add to the rates of particles (W/m3), in the order of the fronts.
    #[inline(always)]
    fn changes(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let of_one = self.one.changes.all();
        self.several.iter().map(|acting| acting.changes.all()).chain([of_one])
    }

    /// Adds what the fronts exchange to `rates`, scaled.
    #[inline]
    pub fn add(&self, rates: &mut [f64], scale: f64) {
        for changes in self.changes() {
            for (particle, change) in changes {
                rates[*particle as usize] += scale * change;
            }
        }
    }

    /// The same to contents, with what rounding takes from them kept in `lost`.
    #[inline]
    pub fn add_keeping(&self, contents: &mut [f64], lost: &mut [f64], scale: f64) {
        for changes in self.changes() {
            for (particle, change) in changes {
                add_one(&mut contents[*particle as usize], scale * change, &mut lost[*particle as usize]);
            }
        }
    }

    /// What fronts may add to the row sum (m^-2) of a particle, where they have just come nearest: on all sides, and one front on the
    /// side on which it adds most.
    pub fn row_sums(&self) -> [f64; 2] {
        let added = |pair: &OwnPair| pair.weight * (pair.cells / distance(1.0, 0.0) - 1.0);
        let towards = |x: f64, y: f64| {
            let lies_there = |pair: &&OwnPair| x * pair.offset[0] + y * pair.offset[1] > 0.0;
            self.pairs.own.iter().filter(lies_there).map(added).sum::<f64>()
        };
        let sides = [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| towards(x, y));
        [self.pairs.own.iter().map(added).sum(), sides.into_iter().fold(0.0, f64::max)]
    }

    /// Rate (1/s) at which a freezing particle answers to its own frozen fraction, at most: all that surrounds it is as
    /// far from the freezing point as can be, and every pair as near as a front across it comes.
    ///
    /// Of two opposite pairs, only one is that near, or both by half. Pairs at an angle to a front answer no faster than those across
    /// it, and the heat along it is less than what is left.
    pub fn own_rate(&self) -> f64 {
        let nearest = |pair: &OwnPair| -> f64 {
            (1..=pair.cells as usize).map(|before| distance(before as f64, 0.0).powi(-2)).sum()
        };
        let by_pairs: f64 = self.pairs.own.iter().map(|pair| pair.weight * pair.cells * nearest(pair)).sum();
        let answer = |sharp: &Sharp| sharp.most / (sharp.interval.1 - sharp.interval.0);
        by_pairs * self.sharp.iter().map(answer).fold(0.0, f64::max)
    }
}

by_kind!(
    act_widely,
    act[Lw: Laws],
    (
        acting: &mut Acting<LANES>,
        all: (&Pairs, &Faces, Where),
        place: (&Lattice, &Surroundings),
        fronts: (&[Front], &Sharp),
        states: (&Lw, &[f64])
    )
);

/// Lets some fronts of a material, which are all inside cells or all enter them, act on what lies around them: see
/// [`Window::look_around`].
#[inline(always)]
fn act<Lw: Laws, const L: usize>(
    kind: impl Kind<L>,
    Acting { window, changes }: &mut Acting<L>,
    (pairs, faces, front): (&Pairs, &Faces, Where),
    place: (&Lattice, &Surroundings),
    (fronts, material): (&[Front], &Sharp),
    states: (&Lw, &[f64]),
) {
    window.look_around(place, fronts, states, (material.potential, material.middle()));
    match front {
        Where::Inside => exchange::<_, L, false>(kind, pairs, faces, material.interval, window),
        Where::Entering => exchange::<_, L, true>(kind, pairs, faces, material.interval, window),
    }
    window.collect(changes);
}

impl HeapSize for SubCellFront {
    fn heap_size(&self) -> usize {
        let several = self.several.capacity() * size_of::<Acting<LANES>>();
        let windows = self.one.heap_size() + several + self.several.iter().map(HeapSize::heap_size).sum::<usize>();
        let groups = self.found.groups.capacity() * size_of::<Group>();
        let states = windows + self.freezing.heap_size() + groups + self.found.fronts.capacity() * size_of::<Front>();
        let found = self.phases.heap_size() + self.faces.heap_size();
        let tangent = self.tangent.heap_size();
        self.pairs.heap_size() + states + found + tangent
    }
}

impl<const L: usize> HeapSize for Acting<L> {
    fn heap_size(&self) -> usize {
        self.window.heap_size() + self.changes.heap_size()
    }
}
