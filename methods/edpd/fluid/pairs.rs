//! What a step does to the pairs of a slab.
//!
//! Pairs in reach are found (`scan`) and gathered, some hundred at a time; all that depends on places and temperatures alone is worked out
//! for them at once, in vectors; then velocities and energies of both ends change, pair by pair. Friction and random force
//! of a pair act on the velocity `u` of one end against the other along the line between them,
//!
//! `u -> c u + root(mu kT (1 - c^2)) xi`,  `c = 1/(1 + x + x^2/2)`,  `x = gamma w_D mu dt`,  `mu = 1/m_i + 1/m_j`
//!
//! (after Shardlow 2003, and Stoltz 2006 for fluids that keep their energy). Whatever `c` is, a velocity of variance
//! `mu kT` keeps it: the balance of friction and noise holds at any step. Both ends take half of the kinetic energy that
//! the pair loses as heat, so energy is conserved to rounding (the one half that eq 8 of Ng et al. 2017 misses).

#[cfg(target_arch = "x86_64")]
use frazil_core::instruction_set::InstructionSet;
use frazil_core::noise::StepNoise;

use super::matter::Matter;
use super::particle::{Look, Particle};
use super::power::raise;
use super::scan::{self, FoundPartners, LANES, MOST, Scan};
use super::sorting::{CellGrid, PartnerRange, RANGES};

/// Pairs that are worked on at once.
const AT_ONCE: usize = 128;

/// Pairs in a vector, or more.
const VECTOR: usize = 8;

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
    /// Particles of this name or above have no pairs with each other.
    pub apart: u32,
    /// What heat means.
    pub matter: &'a M,
    /// Direction across whose periodic sides no heat goes.
    pub shut: Option<usize>,
    /// Square of the largest cut-off radius, taken larger by the error of single precision.
    pub reach: f32,
    /// One over the cut-off radius of the conservative force, of friction, of heat.
    pub inverse_cutoffs: [f64; 3],
    /// Largest conservative force.
    pub repulsion: f64,
    /// Friction times the step.
    pub friction: f64,
    /// Square of the heat capacity, times the heat friction and the step.
    pub conductance: f64,
    /// Random numbers of the step.
    pub noise: StepNoise,
}

impl<const D: usize, M: Matter> StepConstants<'_, D, M> {
    /// Particles of some slabs.
    pub fn count(&self, slabs: std::ops::Range<usize>) -> usize {
        (self.starts[self.grid.cells(slabs.end - 1).end] - self.starts[self.grid.cells(slabs.start).start]) as usize
    }
}

/// One particle's pairs among those at hand.
#[derive(Debug, Clone, Copy, Default)]
struct PartnerRow {
    particle: usize,
    first: usize,
    last: usize,
    /// Whether partners are of the next slab.
    beyond: bool,
}

/// Particles of a slab, and the number of the first of them.
pub type SlabParticles<'a, const D: usize> = (usize, &'a mut [Particle<D>]);

/// Work space of a slab.
#[derive(Debug, Clone)]
pub struct Desk<const D: usize> {
    ways: [[f64; AT_ONCE]; D],
    nears: [f64; AT_ONCE],
    exponents: [f64; AT_ONCE],
    temperatures: [[f64; AT_ONCE]; 2],
    mobilities: [f64; AT_ONCE],
    /// Conduction over that of the reference state, where pairs differ.
    conductions: [f64; AT_ONCE],
    /// Names of both ends: the one in the upper half, its partner's in the lower.
    names: [u64; AT_ONCE],
    found: FoundPartners,
    partners: [u32; AT_ONCE],
    /// Impulse by the velocity of one end against the other, and that of noise.
    gains: [f64; AT_ONCE],
    pushed: [f64; AT_ONCE],
    forces: [f64; AT_ONCE],
    heats: [f64; AT_ONCE],
    rows: [PartnerRow; AT_ONCE],
    /// Potential of all pairs.
    pub potential: f64,
    /// Pairs within reach, and a few in a million beyond.
    pub met: u64,
}

impl<const D: usize> Default for Desk<D> {
    fn default() -> Self {
        Desk {
            ways: [[0.0; AT_ONCE]; D],
            nears: [0.0; AT_ONCE],
            exponents: [0.0; AT_ONCE],
            temperatures: [[1.0; AT_ONCE]; 2],
            mobilities: [0.0; AT_ONCE],
            conductions: [0.0; AT_ONCE],
            names: [0; AT_ONCE],
            found: [0; MOST + LANES],
            partners: [0; AT_ONCE],
            gains: [0.0; AT_ONCE],
            pushed: [0.0; AT_ONCE],
            forces: [0.0; AT_ONCE],
            heats: [0.0; AT_ONCE],
            rows: [PartnerRow::default(); AT_ONCE],
            potential: 0.0,
            met: 0,
        }
    }
}

/// Lets all pairs of a slab act. `own` are its particles, `next` those of the next slab.
pub fn act<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    slab: usize,
    desk: &mut Desk<D>,
    own: SlabParticles<'_, D>,
    next: SlabParticles<'_, D>,
) {
    #[cfg(target_arch = "x86_64")]
    match InstructionSet::widest() {
        // SAFETY: the processor has just been asked for these features.
        InstructionSet::Avx512 => return unsafe { act_avx512(frame, slab, desk, own, next) },
        // SAFETY: as above.
        InstructionSet::Avx2 => return unsafe { act_avx2(frame, slab, desk, own, next) },
        InstructionSet::Portable => {}
    }
    act_by::<D, M, scan::Portable>(frame, slab, desk, own, next);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,fma,popcnt")]
fn act_avx512<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    slab: usize,
    desk: &mut Desk<D>,
    own: SlabParticles<'_, D>,
    next: SlabParticles<'_, D>,
) {
    act_by::<D, M, scan::Avx512>(frame, slab, desk, own, next);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn act_avx2<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    slab: usize,
    desk: &mut Desk<D>,
    own: SlabParticles<'_, D>,
    next: SlabParticles<'_, D>,
) {
    act_by::<D, M, scan::Portable>(frame, slab, desk, own, next);
}

#[inline(always)]
fn act_by<const D: usize, M: Matter, S: Scan>(
    frame: &StepConstants<'_, D, M>,
    slab: usize,
    desk: &mut Desk<D>,
    (begin, own): SlabParticles<'_, D>,
    (begin_next, next): SlabParticles<'_, D>,
) {
    desk.potential = 0.0;
    desk.met = 0;
    let (mut filled, mut rows) = (0, 0);
    for cell in frame.grid.cells(slab) {
        let (ranges, count) = frame.grid.ranges(slab, cell, frame.starts);
        for i in frame.starts[cell] as usize..frame.starts[cell + 1] as usize {
            let me = &frame.looks[i];
            let (mut at, mut from) = (0, i + 1);
            while at < count {
                // Ranges whose particles are seen where they stand, on one side, are looked through together.
                let range = ranges[at];
                let mut place = me.position;
                (0..D).for_each(|axis| place[axis] -= range.shift[axis]);
                let single = place.map(|along| along as f32);
                let mut found = 0;
                while at < count && (ranges[at].beyond, ranges[at].shift) == (range.beyond, range.shift) {
                    let to = ranges[at].end.min(from + MOST - found);
                    found = S::near(&frame.places, &single, (from, to), frame.reach, found, &mut desk.found);
                    from = to;
                    if to < ranges[at].end {
                        break;
                    }
                    at += 1;
                    from = ranges[at % RANGES].begin;
                }
                if me.name >= frame.apart {
                    found = keep(frame, desk, found);
                }
                let base = if range.beyond { begin_next } else { begin };
                let mut taken = 0;
                while taken < found {
                    if filled == AT_ONCE {
                        work(frame, desk, filled);
                        change(desk, rows, own, next);
                        (filled, rows) = (0, 0);
                    }
                    let some = (found - taken).min(AT_ONCE - filled);
                    put(frame, desk, (filled, taken, some), me, &place, &range, base);
                    let last = filled + some;
                    desk.rows[rows % AT_ONCE] =
                        PartnerRow { particle: i - begin, first: filled, last, beyond: range.beyond };
                    (filled, rows) = (last, rows + 1);
                    taken += some;
                }
            }
        }
    }
    work(frame, desk, filled);
    change(desk, rows, own, next);
}

/// Keeps those of the particles found that may have pairs with particles behind walls.
fn keep<const D: usize, M: Matter>(frame: &StepConstants<'_, D, M>, desk: &mut Desk<D>, found: usize) -> usize {
    let mut kept = 0;
    for k in 0..found {
        let j = desk.found[k];
        desk.found[kept] = j;
        kept += usize::from(frame.looks[j as usize].name < frame.apart);
    }
    kept
}

/// Puts the particles found down on the desk as partners of one.
#[inline(always)]
fn put<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    desk: &mut Desk<D>,
    (filled, taken, some): (usize, usize, usize),
    me: &Look<D, M::Seen>,
    place: &[f64; D],
    range: &PartnerRange<D>,
    base: usize,
) {
    let shut = M::UNEVEN && frame.shut.is_some_and(|axis| range.shift[axis] != 0.0);
    for (k, j) in (filled..filled + some).zip(taken..) {
        let k = k % AT_ONCE;
        let j = desk.found[j % MOST] as usize;
        let other = &frame.looks[j];
        for axis in 0..D {
            desk.ways[axis][k] = place[axis] - other.position[axis];
        }
        desk.exponents[k] = me.exponent + other.exponent;
        desk.temperatures[0][k] = me.temperature;
        desk.temperatures[1][k] = other.temperature;
        desk.mobilities[k] = me.mobility + other.mobility;
        if M::UNEVEN {
            let conduction = frame.matter.between([(me.seen, me.temperature), (other.seen, other.temperature)]);
            desk.conductions[k] = if shut { 0.0 } else { conduction };
        }
        desk.names[k] = (u64::from(me.name) << 32) | u64::from(other.name);
        desk.partners[k] = (j - base) as u32;
    }
}

/// All that depends on places and temperatures alone.
#[inline(always)]
fn work<const D: usize, M: Matter>(frame: &StepConstants<'_, D, M>, desk: &mut Desk<D>, count: usize) {
    let count = count.min(AT_ONCE);
    let [conservative, dissipative, thermal] = frame.inverse_cutoffs;
    let conductance = 0.25 * frame.conductance;
    let heat_noise = (2.0 * conductance).sqrt();
    let far = 2.0 * f64::from(frame.reach).sqrt();
    // Whole vectors, the last one filled up with pairs out of reach.
    let whole = count.next_multiple_of(VECTOR).min(AT_ONCE);
    desk.ways[0][count..whole].fill(far);
    for k in 0..whole {
        let mut square: f64 = 1e-30;
        for axis in 0..D {
            square = desk.ways[axis][k].mul_add(desk.ways[axis][k], square);
        }
        let distance = square.sqrt();
        let (a, b) = (desk.temperatures[0][k], desk.temperatures[1][k]);
        let (sum, product) = (a + b, a * b);
        let mobility = desk.mobilities[k];
        // Ends at rest take no impulse, whatever it is.
        let mobility = if mobility > 0.0 { mobility } else { 1.0 };
        let rough = distance.mul_add(-dissipative, 1.0).max(0.0);
        // One division for three: divisions are what takes longest here.
        let temperatures = sum * product;
        let inverse = 1.0 / (temperatures * distance * mobility);
        let inverse_distance = inverse * temperatures * mobility;
        let inverse_temperatures = inverse * distance * mobility;
        let inverse_mobility = inverse * temperatures * distance;
        for axis in 0..D {
            desk.ways[axis][k] *= inverse_distance;
        }
        let near = distance.mul_add(-conservative, 1.0).max(0.0);
        desk.forces[k] = frame.repulsion * near;
        desk.nears[k] = near * near;
        let names = desk.names[k];
        let turned = names.rotate_left(32);
        let sign = if names < turned { 1.0 } else { -1.0 };
        let (force_random, heat_random) = frame.noise.two(names.max(turned));
        let (force_random, heat_random) = (f64::from(force_random), f64::from(heat_random));
        let weight = f64::from(raise(rough as f32, (0.5 * desk.exponents[k]) as f32));
        let lost = frame.friction * weight * mobility;
        let kept = 1.0 / lost.mul_add(lost.mul_add(0.5, 1.0), 1.0);
        desk.gains[k] = (kept - 1.0) * inverse_mobility;
        let variance = mobility * (2.0 * product * product * inverse_temperatures) * kept.mul_add(-kept, 1.0);
        desk.pushed[k] = variance.sqrt() * force_random * inverse_mobility;
        let warm = sum * distance.mul_add(-thermal, 1.0).max(0.0);
        let (conducted, random) = match M::UNEVEN {
            true => {
                let conduction = desk.conductions[k];
                (conductance * conduction * (warm * warm), heat_noise * conduction.sqrt() * warm)
            }
            false => (conductance * (warm * warm), heat_noise * warm),
        };
        desk.heats[k] = (conducted * (b - a)).mul_add(sum * inverse_temperatures, random * heat_random * sign);
    }
    let mut sums = [0.0; VECTOR];
    for nears in desk.nears[..whole].as_chunks::<VECTOR>().0 {
        for lane in 0..VECTOR {
            sums[lane] += nears[lane];
        }
    }
    let potential: f64 = sums.iter().sum();
    desk.potential += potential * 0.5 * frame.repulsion / conservative;
    desk.met += count as u64;
}

/// Changes of velocities and energies, pair by pair.
#[inline(always)]
fn change<const D: usize>(desk: &Desk<D>, rows: usize, own: &mut [Particle<D>], next: &mut [Particle<D>]) {
    for row in &desk.rows[..rows] {
        let mut me = own[row.particle];
        if row.beyond {
            for k in row.first..row.last {
                meet(desk, k, &mut me, &mut next[desk.partners[k % AT_ONCE] as usize]);
            }
        } else {
            for k in row.first..row.last {
                meet(desk, k, &mut me, &mut own[desk.partners[k % AT_ONCE] as usize]);
            }
        }
        own[row.particle] = me;
    }
}

#[inline(always)]
fn meet<const D: usize>(desk: &Desk<D>, k: usize, me: &mut Particle<D>, other: &mut Particle<D>) {
    let k = k % AT_ONCE;
    let ways: [f64; D] = std::array::from_fn(|axis| desk.ways[axis][k]);
    // Pairs of one particle wait for each other: its velocity comes in last.
    let mut before = 0.0;
    for axis in 0..D {
        before = (-ways[axis]).mul_add(other.velocity[axis], before);
    }
    for axis in 0..D {
        before = ways[axis].mul_add(me.velocity[axis], before);
    }
    let impulse = desk.gains[k].mul_add(before, desk.pushed[k]);
    // Half of what the pair loses of its kinetic energy.
    let lost = -0.25 * impulse * desk.mobilities[k].mul_add(impulse, 2.0 * before);
    for axis in 0..D {
        let way = ways[axis];
        me.velocity[axis] = (me.mobility * way).mul_add(impulse, me.velocity[axis]);
        other.velocity[axis] = (-other.mobility * way).mul_add(impulse, other.velocity[axis]);
        me.force[axis] = desk.forces[k].mul_add(way, me.force[axis]);
        other.force[axis] = (-desk.forces[k]).mul_add(way, other.force[axis]);
    }
    me.heat += lost + desk.heats[k];
    other.heat += lost - desk.heats[k];
}
