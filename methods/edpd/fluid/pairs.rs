//! What a step does to the pairs of a slab.
//!
//! Pairs in reach are found (`scan`) and gathered, some hundred at a time; all that depends on places and temperatures alone is worked out
//! for them at once, in vectors (`coefficients`); then velocities and energies of both ends change, pair by pair (`meeting`). Friction and random force
//! of a pair act on the velocity `u` of one end against the other along the line between them,
//!
//! `u -> c u + root(mu kT (1 - c^2)) xi`,  `c = 1/(1 + x + x^2/2)`,  `x = gamma w_D mu dt`,  `mu = 1/m_i + 1/m_j`
//!
//! (after Shardlow 2003, and Stoltz 2006 for fluids that keep their energy). Whatever `c` is, a velocity of variance
//! `mu kT` keeps it: the balance of friction and noise holds at any step. Both ends take half of the kinetic energy that
//! the pair loses as heat, so energy is conserved to rounding (the one half that eq 8 of Ng et al. 2017 misses).

#[cfg(target_arch = "x86_64")]
use frazil_core::instruction_set::InstructionSet;

use super::apart::{Apart, Work};
use super::coefficients::{AT_ONCE, PairColumns, PairConstants, ROOM};
use super::matter::Matter;
use super::meeting::{PartnerRow, four_mut, rows_meet};
use super::particle::{Look, Particle};
use super::quad::Quad;
use super::scan::{self, Kind, MOST, Notes, Stretch, TOGETHER, near};
use super::sorting::{CellGrid, PartnerRange, RANGES};
use super::walls::Walls;

/// The constants of a step.
#[derive(Debug)]
pub struct StepConstants<'a, const D: usize, M: Matter> {
    /// All particles as pairs see them.
    pub looks: &'a [Look<D, M::Seen>],
    /// Where they stand, by direction, in single precision; `scan::LANES` places longer.
    pub places: [&'a [f32]; D],
    /// Cells.
    pub grid: &'a CellGrid<D>,
    /// The first particle of each cell.
    pub starts: &'a [u32],
    /// The walls, behind which particles have no pairs with each other.
    pub walls: Option<&'a Walls<D>>,
    /// What heat means.
    pub matter: &'a M,
    /// Direction across whose periodic sides no heat goes.
    pub shut: Option<usize>,
    /// Square of the largest cut-off radius, taken larger by the error of single precision.
    pub reach: f32,
    /// What pairs act by.
    pub constants: PairConstants,
}

impl<const D: usize, M: Matter> StepConstants<'_, D, M> {
    #[inline(always)]
    fn is_behind_walls(&self, name: u32) -> bool {
        self.walls.is_some_and(|walls| name >= walls.first)
    }

    /// Particles of some slabs.
    pub fn count(&self, slabs: std::ops::Range<usize>) -> usize {
        (self.starts[self.grid.cells(slabs.end - 1).end] - self.starts[self.grid.cells(slabs.start).start]) as usize
    }
}

/// Particles of a slab, and the number of the first of them.
pub type SlabParticles<'a, const D: usize> = (usize, &'a mut [Particle<D>]);

/// Work space of a slab.
#[derive(Debug, Clone)]
pub struct Desk<const D: usize> {
    pairs: PairColumns<D>,
    /// Partners: their numbers among all.
    partners: [u32; ROOM],
    /// Pairs at hand.
    filled: usize,
    /// None is empty.
    rows: [PartnerRow; AT_ONCE + 1],
    row_count: usize,
    /// Potential of all pairs.
    pub potential: f64,
    /// Pairs within reach, and a few in a million beyond.
    pub met: u64,
    /// What is noted of the particles whose partners are searched for; nothing between two cells.
    notes: Notes,
}

impl<const D: usize> Default for Desk<D> {
    fn default() -> Self {
        Desk {
            pairs: PairColumns::default(),
            partners: [0; ROOM],
            filled: 0,
            rows: [PartnerRow::default(); AT_ONCE + 1],
            row_count: 0,
            potential: 0.0,
            met: 0,
            notes: Notes::default(),
        }
    }
}

/// Lets all pairs of a slab act. `own` are its particles and those of the next slab, which stand right after them; of the last
/// slab, its particles alone, and `next` are those of the first one.
pub fn act<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    slab: usize,
    desk: &mut Desk<D>,
    own: SlabParticles<'_, D>,
    next: SlabParticles<'_, D>,
) {
    let acting = Acting { frame, slab, desk, own, next };
    #[cfg(target_arch = "x86_64")]
    match InstructionSet::widest() {
        InstructionSet::Avx512 => return scan::Avx512::apart(acting),
        InstructionSet::Avx2 => return scan::Avx2::apart(acting),
        InstructionSet::Portable => {}
    }
    scan::Portable::apart(acting);
}

/// The pairs of a slab.
struct Acting<'a, const D: usize, M: Matter> {
    frame: &'a StepConstants<'a, D, M>,
    slab: usize,
    desk: &'a mut Desk<D>,
    own: SlabParticles<'a, D>,
    next: SlabParticles<'a, D>,
}

impl<const D: usize, M: Matter> Work for Acting<'_, D, M> {
    type Made = ();

    #[inline(always)]
    fn work<S: Apart>(self) {
        let Acting { frame, slab, desk, own: (begin, own), next: (begin_next, next) } = self;
        desk.potential = 0.0;
        desk.met = 0;
        for cell in frame.grid.cells(slab) {
            let (ranges, count) = frame.grid.ranges(slab, cell, frame.starts);
            // Ranges whose particles are seen where they stand, on one side, are looked through together.
            let alike = |a: &PartnerRange<D>, b: &PartnerRange<D>| (a.beyond, a.shift) == (b.beyond, b.shift);
            let (mut sides, mut side_count) = ([&ranges[..0]; RANGES], 0);
            for side in ranges[..count].chunk_by(alike) {
                sides[side_count] = side;
                side_count += 1;
            }
            let (start, end) = (frame.starts[cell] as usize, frame.starts[cell + 1] as usize);
            for first in (start..end).step_by(TOGETHER) {
                let few = first..end.min(first + TOGETHER);
                // Of pairs within the cell each is met from its first end.
                let mut begin_at = first + 1;
                for ranges in &sides[..side_count] {
                    let PartnerRange { shift, beyond, .. } = ranges[0];
                    let side = Side { shift, beyond, begin, base: if beyond { begin_next } else { begin } };
                    let places = side.seen(&frame.looks[few.clone()]);
                    for range in *ranges {
                        let mut steps = usize::from(begin_at > 0);
                        let mut from = std::mem::take(&mut begin_at).max(range.begin);
                        while from < range.end {
                            if desk.notes.counts.iter().any(|count| *count > MOST) {
                                put_all::<D, M, S>(frame, desk, few.clone(), &side, own, next);
                            }
                            let to = range.end.min(from + MOST);
                            near::<S::Lanes, D>(
                                &frame.places,
                                &places,
                                Stretch { from, to, steps },
                                frame.reach,
                                &mut desk.notes,
                            );
                            (from, steps) = (to, 0);
                        }
                    }
                    put_all::<D, M, S>(frame, desk, few.clone(), &side, own, next);
                }
            }
        }
        finish::<D, M, S>(frame, desk, own, next);
    }
}

/// Where partners of the particles of a cell are.
struct Side<const D: usize> {
    /// How far they are shifted.
    shift: [f64; D],
    /// Whether they are of the next slab, which is the first one.
    beyond: bool,
    /// Numbers of the first particle of the slab and of that of theirs.
    begin: usize,
    base: usize,
}

impl<const D: usize> Side<D> {
    /// Where they see some particles; no numbers, where there are fewer.
    #[inline(always)]
    fn seen<S>(&self, few: &[Look<D, S>]) -> [[f32; D]; TOGETHER] {
        let mut places = [[f32::NAN; D]; TOGETHER];
        for (place, look) in places.iter_mut().zip(few) {
            for axis in 0..D {
                place[axis] = (look.position[axis] - self.shift[axis]) as f32;
            }
        }
        places
    }
}

/// Puts what is noted of some particles down on the desk, and clears it.
#[inline(always)]
fn put_all<const D: usize, M: Matter, S: Apart>(
    frame: &StepConstants<'_, D, M>,
    desk: &mut Desk<D>,
    few: std::ops::Range<usize>,
    side: &Side<D>,
    own: &mut [Particle<D>],
    next: &mut [Particle<D>],
) {
    for (l, i) in few.enumerate() {
        if desk.filled > AT_ONCE {
            finish::<D, M, S>(frame, desk, own, next);
        }
        put::<D, M, S>(frame, desk, l, i, side);
    }
    desk.notes.counts = [0; TOGETHER];
}

/// Keeps those of the particles noted that may have pairs with particles behind walls.
fn keep<const D: usize, M: Matter>(frame: &StepConstants<'_, D, M>, notes: &mut Notes, l: usize) {
    let (numbers, count) = (&mut notes.numbers[l], &mut notes.counts[l]);
    let mut kept = 0;
    for k in 0..*count {
        let j = numbers[k];
        numbers[kept] = j;
        kept += usize::from(!frame.is_behind_walls(frame.looks[j as usize].name));
    }
    *count = kept;
}

/// Puts the particles noted down on the desk as partners of one.
#[inline(always)]
fn put<const D: usize, M: Matter, S: Kind>(
    frame: &StepConstants<'_, D, M>,
    desk: &mut Desk<D>,
    l: usize,
    i: usize,
    side: &Side<D>,
) {
    let me = &frame.looks[i];
    if frame.is_behind_walls(me.name) {
        keep(frame, &mut desk.notes, l);
    }
    let Desk { pairs, partners, rows, row_count, filled, notes, .. } = desk;
    let (first, last) = (*filled, (*filled + notes.counts[l]).min(ROOM));
    if first >= last {
        return;
    }
    let mut place = me.position;
    for axis in 0..D {
        place[axis] -= side.shift[axis];
    }
    let sight = Sight::<D, S::Quad>::of(me, &place);
    // The last four may go beyond the row, where numbers of particles noted before stand; the next row is written over them.
    for (noted, k) in notes.numbers[l].as_chunks().0.iter().zip((first..last).step_by(4)) {
        *four_mut(partners, k) = *noted;
        gather_four(frame.looks, &sight, k, noted, pairs);
    }
    if M::UNEVEN {
        let shut = frame.shut.is_some_and(|axis| side.shift[axis] != 0.0);
        for k in first..last {
            let other = &frame.looks[partners[k] as usize];
            let conduction = frame.matter.between([(me.seen, me.temperature), (other.seen, other.temperature)]);
            let behind = me.name.max(other.name);
            let closeness = match frame.walls {
                _ if shut => 0.0,
                Some(walls) if behind >= walls.first => walls.closeness(behind, |axis| pairs.displacements[axis][k]),
                _ => 1.0,
            };
            pairs.conductions[k] = (closeness * conduction) as f32;
        }
    }
    rows[*row_count] = PartnerRow { particle: i - side.begin, first, last, beyond: side.beyond, base: side.base };
    *row_count += 1;
    *filled = last;
}

/// A particle, four times, as its partners are compared with it.
struct Sight<const D: usize, Q: Quad> {
    place: [Q; D],
    coldness: Q,
    singles: [Q::Single; 4],
}

impl<const D: usize, Q: Quad> Sight<D, Q> {
    #[inline(always)]
    fn of<S>(me: &Look<D, S>, place: &[f64; D]) -> Self {
        let coldness = Q::splat(me.coldness);
        let mut sight = Sight { place: [coldness; D], coldness, singles: [Q::single_splat(0.0); 4] };
        for axis in 0..D {
            sight.place[axis] = Q::splat(place[axis]);
        }
        for l in 0..4 {
            sight.singles[l] = Q::single_splat(me.single()[l]);
        }
        sight
    }
}

/// Takes down what four pairs of a particle act by.
#[inline(always)]
fn gather_four<const D: usize, S, Q: Quad>(
    looks: &[Look<D, S>],
    me: &Sight<D, Q>,
    k: usize,
    partners: &[u32; 4],
    pairs: &mut PairColumns<D>,
) {
    let (mut columns, mut singles) = ([Q::splat(0.0); 4], [Q::single_splat(0.0); 4]);
    for l in 0..4 {
        let other = &looks[partners[l] as usize];
        columns[l] = Q::load(other.wide());
        singles[l] = Q::single_load(other.single());
    }
    let columns = Q::turned(columns);
    for axis in 0..D {
        me.place[axis].minus(columns[axis]).store(four_mut(&mut pairs.displacements[axis], k));
    }
    Q::single_store(me.coldness.minus(columns[D]).single(), four_mut(&mut pairs.differences, k));
    let [temperature, half_exponent, mobility, name] = Q::single_turned(singles);
    Q::single_store(me.singles[0], four_mut(&mut pairs.temperatures[0], k));
    Q::single_store(temperature, four_mut(&mut pairs.temperatures[1], k));
    Q::single_store(Q::single_plus(me.singles[1], half_exponent), four_mut(&mut pairs.weights, k));
    Q::single_store(Q::single_plus(me.singles[2], mobility), four_mut(&mut pairs.mobilities, k));
    Q::single_store(me.singles[3], four_mut(&mut pairs.names[0], k));
    Q::single_store(name, four_mut(&mut pairs.names[1], k));
}

/// The coefficients of the pairs on a desk; makes their potential.
struct Coefficients<'a, const D: usize, M: Matter> {
    frame: &'a StepConstants<'a, D, M>,
    pairs: &'a mut PairColumns<D>,
    count: usize,
}

impl<const D: usize, M: Matter> Work for Coefficients<'_, D, M> {
    type Made = f64;

    #[inline(always)]
    fn work<S: Apart>(self) -> f64 {
        let Coefficients { frame, pairs, count } = self;
        if M::UNEVEN {
            pairs.evaluate::<true>(&frame.constants, count)
        } else {
            pairs.evaluate::<false>(&frame.constants, count)
        }
    }
}

/// The rows on a desk, with particles of the slab and of the next.
struct Rows<'a, const D: usize> {
    desk: &'a Desk<D>,
    own: &'a mut [Particle<D>],
    next: &'a mut [Particle<D>],
}

impl<const D: usize> Work for Rows<'_, D> {
    type Made = ();

    #[inline(always)]
    fn work<S: Apart>(self) {
        let Desk { pairs, partners, rows, row_count, .. } = self.desk;
        rows_meet::<D, S::Quad>(pairs, partners, &rows[..*row_count], self.own, self.next);
    }
}

/// Lets the pairs on the desk act, and clears it.
#[inline(always)]
fn finish<const D: usize, M: Matter, S: Apart>(
    frame: &StepConstants<'_, D, M>,
    desk: &mut Desk<D>,
    own: &mut [Particle<D>],
    next: &mut [Particle<D>],
) {
    desk.potential += S::apart(Coefficients { frame, pairs: &mut desk.pairs, count: desk.filled });
    desk.met += desk.filled as u64;
    S::apart(Rows { desk, own, next });
    (desk.filled, desk.row_count) = (0, 0);
}
