//! What a step does to the pairs of a slab.
//!
//! Pairs in reach are gathered, some hundred at a time; all that depends on places and temperatures alone is worked out
//! for them at once, in vectors; then velocities and energies of both ends change, pair by pair. Friction and random force
//! of a pair act on the velocity `u` of one end against the other along the line between them,
//!
//! `u -> c u + root(mu kT (1 - c^2)) xi`,  `c = 1/(1 + x + x^2/2)`,  `x = gamma w_D mu dt`,  `mu = 1/m_i + 1/m_j`
//!
//! (after Shardlow 2003, and Stoltz 2006 for fluids that keep their energy). Whatever `c` is, a velocity of variance
//! `mu kT` keeps it: the balance of friction and noise holds at any step. Both ends take half of the kinetic energy that
//! the pair loses as heat, so energy is conserved to rounding (the one half that eq 8 of Ng et al. 2017 misses).

use frazil_core::noise::StepNoise;

use super::matter::Matter;
use super::particle::{Look, Particle};
use super::power::{parts, raise, round};
use super::sorting::SlabPairs;

/// Pairs that are worked on at once, and the most partners that a particle may have.
pub const AT_ONCE: usize = 256;

/// Places on the desk: one more, for a partner that may be out of reach.
const PLACES: usize = AT_ONCE + 1;

/// The constants of a step.
#[derive(Debug)]
pub struct Frame<'a, const D: usize, M: Matter> {
    /// All particles as pairs see them.
    pub looks: &'a [Look<D, M::Seen>],
    /// What heat means.
    pub matter: &'a M,
    /// Direction across whose periodic sides no heat goes.
    pub shut: Option<usize>,
    /// Lengths of the box.
    pub lengths: [f64; D],
    /// One over them.
    pub inverses: [f64; D],
    /// Square of the largest cut-off radius.
    pub reach: f64,
    /// Distance from all sides of the box beyond which no listed partner is found across one.
    pub margin: f64,
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

/// One particle's pairs among those at hand.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    particle: usize,
    first: usize,
    /// Where partners in the next slab begin.
    next: usize,
    last: usize,
}

/// Particles of a slab, and the number of the first of them.
pub type Part<'a, const D: usize> = (usize, &'a mut [Particle<D>]);

/// Work space of a slab.
#[derive(Debug, Clone)]
pub struct Desk<const D: usize> {
    ways: [[f64; PLACES]; D],
    squares: [f64; PLACES],
    exponents: [f64; PLACES],
    temperatures: [[f64; PLACES]; 2],
    mobilities: [f64; PLACES],
    /// Conduction over that of the reference state, where pairs differ.
    conductions: [f64; PLACES],
    words: [u64; PLACES],
    signs: [f64; PLACES],
    partners: [u32; PLACES],
    /// Impulse by the velocity of one end against the other, and that of noise.
    gains: [f64; PLACES],
    pushed: [f64; PLACES],
    forces: [f64; PLACES],
    heats: [f64; PLACES],
    rows: [Row; AT_ONCE],
    /// Potential of all pairs.
    pub potential: f64,
    /// Pairs within reach.
    pub met: u64,
}

impl<const D: usize> Default for Desk<D> {
    fn default() -> Self {
        Desk {
            ways: [[0.0; PLACES]; D],
            squares: [1.0; PLACES],
            exponents: [0.0; PLACES],
            temperatures: [[1.0; PLACES]; 2],
            mobilities: [0.0; PLACES],
            conductions: [0.0; PLACES],
            words: [0; PLACES],
            signs: [0.0; PLACES],
            partners: [0; PLACES],
            gains: [0.0; PLACES],
            pushed: [0.0; PLACES],
            forces: [0.0; PLACES],
            heats: [0.0; PLACES],
            rows: [Row::default(); AT_ONCE],
            potential: 0.0,
            met: 0,
        }
    }
}

/// Lets all pairs of a slab act. `own` are its particles, `next` those of the next slab.
pub fn act<const D: usize, M: Matter>(
    frame: &Frame<'_, D, M>,
    pairs: &SlabPairs,
    desk: &mut Desk<D>,
    own: Part<'_, D>,
    next: Part<'_, D>,
) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq")
        {
            // SAFETY: the processor has just been asked for these features.
            return unsafe { act_avx512(frame, pairs, desk, own, next) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { act_avx2(frame, pairs, desk, own, next) };
        }
    }
    act_plainly(frame, pairs, desk, own, next);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq")]
fn act_avx512<const D: usize, M: Matter>(
    frame: &Frame<'_, D, M>,
    pairs: &SlabPairs,
    desk: &mut Desk<D>,
    own: Part<'_, D>,
    next: Part<'_, D>,
) {
    act_plainly(frame, pairs, desk, own, next);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn act_avx2<const D: usize, M: Matter>(
    frame: &Frame<'_, D, M>,
    pairs: &SlabPairs,
    desk: &mut Desk<D>,
    own: Part<'_, D>,
    next: Part<'_, D>,
) {
    act_plainly(frame, pairs, desk, own, next);
}

#[inline(always)]
fn act_plainly<const D: usize, M: Matter>(
    frame: &Frame<'_, D, M>,
    pairs: &SlabPairs,
    desk: &mut Desk<D>,
    (begin, own): Part<'_, D>,
    (begin_next, next): Part<'_, D>,
) {
    desk.potential = 0.0;
    desk.met = 0;
    let (looks, next_looks) = (&frame.looks[begin..][..own.len()], &frame.looks[begin_next..][..next.len()]);
    let (mut filled, mut rows) = (0, 0);
    for (i, me) in looks.iter().enumerate() {
        let ([from, middle], to) = (pairs.starts[i], pairs.starts[i + 1][0]);
        if filled + (to - from) as usize > AT_ONCE || rows == AT_ONCE {
            work(frame, desk, filled);
            change(desk, rows, own, next);
            (filled, rows) = (0, 0);
        }
        let first = filled;
        filled = gather(frame, desk, filled, me, looks, &pairs.partners[from as usize..middle as usize]);
        let beyond = filled;
        filled = gather(frame, desk, filled, me, next_looks, &pairs.partners[middle as usize..to as usize]);
        if filled > first {
            desk.rows[rows] = Row { particle: i, first, next: beyond, last: filled };
            rows += 1;
        }
    }
    work(frame, desk, filled);
    change(desk, rows, own, next);
}

/// Puts those of a particle's partners that are within reach down on the desk; returns how many pairs lie there then.
#[inline(always)]
fn gather<const D: usize, M: Matter>(
    frame: &Frame<'_, D, M>,
    desk: &mut Desk<D>,
    filled: usize,
    me: &Look<D, M::Seen>,
    looks: &[Look<D, M::Seen>],
    partners: &[u32],
) -> usize {
    let inside = (0..D).all(|axis| {
        let place = me.position[axis];
        place > frame.margin && place < frame.lengths[axis] - frame.margin
    });
    let at = if inside {
        near::<D, M, false>(frame, desk, filled, me, looks, partners)
    } else {
        near::<D, M, true>(frame, desk, filled, me, looks, partners)
    };
    for k in filled..at {
        let other = &looks[desk.partners[k] as usize];
        desk.exponents[k] = 0.5 * (me.exponent + other.exponent);
        desk.temperatures[0][k] = me.temperature;
        desk.temperatures[1][k] = other.temperature;
        desk.mobilities[k] = me.mobility + other.mobility;
        if M::UNEVEN {
            let conduction = frame.matter.between([(me.seen, me.temperature), (other.seen, other.temperature)]);
            let across = frame
                .shut
                .is_some_and(|axis| (me.position[axis] - other.position[axis]).abs() > 0.5 * frame.lengths[axis]);
            desk.conductions[k] = if across { 0.0 } else { conduction };
        }
        let (low, high) = (me.name.min(other.name), me.name.max(other.name));
        desk.words[k] = (u64::from(high) << 32) | u64::from(low);
        desk.signs[k] = if me.name < other.name { 1.0 } else { -1.0 };
    }
    at
}

/// Puts ways and numbers of those partners down that are within reach; `ACROSS` says whether any may be found across a
/// periodic side.
#[inline(always)]
fn near<const D: usize, M: Matter, const ACROSS: bool>(
    frame: &Frame<'_, D, M>,
    desk: &mut Desk<D>,
    filled: usize,
    me: &Look<D, M::Seen>,
    looks: &[Look<D, M::Seen>],
    partners: &[u32],
) -> usize {
    let mut at = filled;
    // Whether a partner is within reach cannot be guessed: each is put down, and the next one over it if it is not.
    for &j in partners {
        let other = &looks[j as usize];
        let mut square = 0.0;
        for axis in 0..D {
            let mut way = me.position[axis] - other.position[axis];
            if ACROSS {
                way -= frame.lengths[axis] * round(way * frame.inverses[axis]);
            }
            desk.ways[axis][at] = way;
            square += way * way;
        }
        desk.squares[at] = square;
        desk.partners[at] = j;
        at += usize::from(square < frame.reach);
    }
    at
}

/// All that depends on places and temperatures alone.
#[inline(always)]
fn work<const D: usize, M: Matter>(frame: &Frame<'_, D, M>, desk: &mut Desk<D>, count: usize) {
    let count = count.min(AT_ONCE);
    let [conservative, dissipative, thermal] = frame.inverse_cutoffs;
    let conductance = 0.25 * frame.conductance;
    let heat_noise = (2.0 * conductance).sqrt();
    let mut potential = 0.0;
    for k in 0..count {
        let distance = desk.squares[k].max(1e-30).sqrt();
        let (a, b) = (desk.temperatures[0][k], desk.temperatures[1][k]);
        let (sum, product) = (a + b, a * b);
        let mobility = desk.mobilities[k];
        // Ends at rest take no impulse, whatever it is.
        let mobility = if mobility > 0.0 { mobility } else { 1.0 };
        let rough = (1.0 - distance * dissipative).max(0.0);
        let (mantissa, count) = parts(rough);
        // One division for four: divisions are what takes longest here.
        let (temperatures, places) = (sum * product, (mantissa + 1.0) * distance);
        let inverse = 1.0 / (temperatures * places * mobility);
        let inverse_places = inverse * temperatures * mobility;
        let inverse_distance = inverse_places * (mantissa + 1.0);
        let z = (mantissa - 1.0) * (inverse_places * distance);
        let inverse_temperatures = inverse * places * mobility;
        let inverse_mobility = inverse * temperatures * places;
        for axis in 0..D {
            desk.ways[axis][k] *= inverse_distance;
        }
        let near = (1.0 - distance * conservative).max(0.0);
        desk.forces[k] = frame.repulsion * near;
        desk.squares[k] = near * near;
        let (force_random, heat_random) = frame.noise.two(desk.words[k]);
        let lost = frame.friction * raise(rough, (count, z), desk.exponents[k]) * mobility;
        let kept = 1.0 / (1.0 + lost + 0.5 * lost * lost);
        desk.gains[k] = (kept - 1.0) * inverse_mobility;
        let variance = mobility * (2.0 * product * product * inverse_temperatures) * (1.0 - kept * kept);
        desk.pushed[k] = variance.sqrt() * force_random * inverse_mobility;
        let warm = sum * (1.0 - distance * thermal).max(0.0);
        let (conducted, random) = match M::UNEVEN {
            true => {
                let conduction = desk.conductions[k];
                (conductance * conduction * (warm * warm), heat_noise * conduction.sqrt() * warm)
            }
            false => (conductance * (warm * warm), heat_noise * warm),
        };
        desk.heats[k] = conducted * (b - a) * (sum * inverse_temperatures) + random * heat_random * desk.signs[k];
    }
    for near in &desk.squares[..count] {
        potential += near;
    }
    desk.potential += potential * 0.5 * frame.repulsion / conservative;
    desk.met += count as u64;
}

/// Changes of velocities and energies, pair by pair.
#[inline(always)]
fn change<const D: usize>(desk: &Desk<D>, rows: usize, own: &mut [Particle<D>], next: &mut [Particle<D>]) {
    for row in &desk.rows[..rows] {
        let mut me = own[row.particle];
        for k in row.first..row.next {
            meet(desk, k, &mut me, &mut own[desk.partners[k % AT_ONCE] as usize]);
        }
        for k in row.next..row.last {
            meet(desk, k, &mut me, &mut next[desk.partners[k % AT_ONCE] as usize]);
        }
        own[row.particle] = me;
    }
}

#[inline(always)]
fn meet<const D: usize>(desk: &Desk<D>, k: usize, me: &mut Particle<D>, other: &mut Particle<D>) {
    let k = k % AT_ONCE;
    let gain = desk.gains[k];
    // Pairs of one particle wait for each other: what does not hang on its velocity is summed apart.
    let (mut before, mut others) = (0.0, 0.0);
    for axis in 0..D {
        let way = desk.ways[axis][k];
        before += way * (me.velocity[axis] - other.velocity[axis]);
        others += gain * way * other.velocity[axis];
    }
    let mut impulse = desk.pushed[k] - others;
    for axis in 0..D {
        impulse += gain * desk.ways[axis][k] * me.velocity[axis];
    }
    // Half of what the pair loses of its kinetic energy.
    let lost = -0.25 * impulse * (2.0 * before + desk.mobilities[k] * impulse);
    for axis in 0..D {
        let way = desk.ways[axis][k];
        me.velocity[axis] += me.mobility * way * impulse;
        other.velocity[axis] -= other.mobility * way * impulse;
        me.force[axis] += desk.forces[k] * way;
        other.force[axis] -= desk.forces[k] * way;
    }
    me.heat += lost + desk.heats[k];
    other.heat += lost - desk.heats[k];
}
