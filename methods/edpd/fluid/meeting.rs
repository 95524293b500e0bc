//! What pairs do to the velocities and energies of their ends.
//!
//! Pairs of a particle act one after the other, each on the velocity that those before have left. Four of them are worked out
//! at once: their partners are different, so that what each would do alone is known, and what it does to those after it is in
//! the direction of its own line.

use super::coefficients::{PairColumns, ROOM};
use super::particle::Particle;
use super::quad::Quad;

/// One particle's pairs among those at hand.
#[derive(Debug, Clone, Copy, Default)]
pub struct PartnerRow {
    /// Its number in the slab.
    pub particle: usize,
    /// Its first pair.
    pub first: usize,
    /// After its last one.
    pub last: usize,
    /// Whether partners are among the particles of the first slab, next to the last one.
    pub beyond: bool,
    /// Number of the first of the particles among which partners are.
    pub base: usize,
}

/// Four pairs of a column.
#[inline(always)]
fn four<T>(column: &[T; ROOM], k: usize) -> &[T; 4] {
    column[k..].first_chunk().expect("room for four")
}

/// Four pairs of a column, to be set.
#[inline(always)]
pub fn four_mut<T>(column: &mut [T; ROOM], k: usize) -> &mut [T; 4] {
    column[k..].first_chunk_mut().expect("room for four")
}

/// A particle while its pairs act, four times.
struct Mover<const D: usize, Q> {
    /// Its velocity before.
    velocity: [Q; D],
    mobility: Q,
    /// What it has received since: momentum, and of force and heat four parts.
    momentum: [Q; D],
    force: [Q; D],
    heat: Q,
}

impl<const D: usize, Q: Quad> Mover<D, Q> {
    #[inline(always)]
    fn of(me: &Particle<D>) -> Self {
        let zero = Q::splat(0.0);
        let mobility = Q::splat(me.mobility);
        let mut mover = Mover { velocity: [zero; D], mobility, momentum: [zero; D], force: [zero; D], heat: zero };
        for axis in 0..D {
            mover.velocity[axis] = Q::splat(me.velocity[axis]);
        }
        mover
    }

    /// Gives the particle what it has received.
    #[inline(always)]
    fn settle(&self, me: &mut Particle<D>) {
        for axis in 0..D {
            me.velocity[axis] = me.mobility.mul_add(self.momentum[axis].first(), me.velocity[axis]);
            me.force[axis] += self.force[axis].sum().first();
        }
        me.heat += self.heat.sum().first();
    }
}

/// Lets the pairs of rows act. `own` are particles of a slab and of the next, `next` those of the first slab, next to the last one.
#[inline(always)]
pub fn rows_meet<const D: usize, Q: Quad>(
    pairs: &PairColumns<D>,
    partners: &[u32; ROOM],
    rows: &[PartnerRow],
    own: &mut [Particle<D>],
    next: &mut [Particle<D>],
) {
    for row in rows {
        let mut me = own[row.particle];
        let others = if row.beyond { &mut *next } else { &mut *own };
        let mut mover = Mover::<D, Q>::of(&me);
        let mut k = row.first;
        while k + 4 <= row.last {
            four_meet(pairs, partners, k, row.base, &mut mover, others);
            k += 4;
        }
        mover.settle(&mut me);
        for k in k..row.last {
            meet(pairs, k, &mut me, &mut others[partners[k] as usize - row.base]);
        }
        own[row.particle] = me;
    }
}

/// Four pairs of a particle that wait for each other: as they would act if those that have not acted yet did not.
struct Chain<const D: usize, Q> {
    /// Displacements.
    ways: [Q; D],
    /// Impulse of friction over the distance, by the relative velocity along the displacement times the distance.
    friction: Q,
    /// Impulses over the distance.
    impulses: Q,
    /// Relative velocities along the displacement times the distance.
    before: Q,
    /// What the particle has received in its row.
    momentum: [Q; D],
}

impl<const D: usize, Q: Quad> Chain<D, Q> {
    /// Lets one of them act, on the particle and on those after it.
    #[inline(always)]
    fn act<const LANE: usize>(&mut self, mobility: Q, pairs: &PairColumns<D>, k: usize) {
        let impulse = self.impulses.one::<LANE>();
        let mut way = [impulse; D];
        for axis in 0..D {
            way[axis] = Q::splat(pairs.displacements[axis][k + LANE]);
            self.momentum[axis] = way[axis].times_plus(impulse, self.momentum[axis]);
        }
        if LANE == 3 {
            return;
        }
        let mut along = way[0].times(self.ways[0]);
        for axis in 1..D {
            along = way[axis].times_plus(self.ways[axis], along);
        }
        let along = mobility.times(along).after::<LANE>();
        self.before = along.times_plus(impulse, self.before);
        self.impulses = self.friction.times(along).times_plus(impulse, self.impulses);
    }
}

/// Four pairs of a particle, one after the other, worked out together.
#[inline(always)]
fn four_meet<const D: usize, Q: Quad>(
    pairs: &PairColumns<D>,
    partners: &[u32; ROOM],
    k: usize,
    base: usize,
    me: &mut Mover<D, Q>,
    others: &mut [Particle<D>],
) {
    let mut ways = [me.mobility; D];
    for axis in 0..D {
        ways[axis] = Q::load(four(&pairs.displacements[axis], k));
    }
    let mut at = [0; 4];
    for l in 0..4 {
        at[l] = partners[k + l] as usize - base;
        assert!(at[l] < others.len());
    }
    // SAFETY: all are within, as has just been asked, and a particle has each partner once in a row.
    let others = unsafe { others.get_disjoint_unchecked_mut(at) };
    let mut columns = [Q::splat(0.0); 4];
    for l in 0..4 {
        columns[l] = Q::load(others[l].motion());
    }
    let mut columns = Q::turned(columns);
    let friction = Q::wide(four(&pairs.friction_impulses, k));
    // What the four would do each alone, before the particle has met any in this row.
    let mut before = ways[0].times(me.velocity[0].minus(columns[0]));
    for axis in 1..D {
        before = ways[axis].times_plus(me.velocity[axis].minus(columns[axis]), before);
    }
    let mut impulses = friction.times_plus(before, Q::wide(four(&pairs.noise_impulses, k)));
    for axis in 0..D {
        let along = me.mobility.times(ways[axis]);
        impulses = friction.times(along).times_plus(me.momentum[axis], impulses);
        before = along.times_plus(me.momentum[axis], before);
    }
    // What the first does to the others, and the second to the two after it, and the third to the last.
    let mut chain = Chain { ways, friction, impulses, before, momentum: me.momentum };
    chain.act::<0>(me.mobility, pairs, k);
    chain.act::<1>(me.mobility, pairs, k);
    chain.act::<2>(me.mobility, pairs, k);
    chain.act::<3>(me.mobility, pairs, k);
    let Chain { impulses, before, momentum, .. } = chain;
    me.momentum = momentum;
    let twice = before.plus(before);
    let mobilities = Q::wide(four(&pairs.mobilities, k));
    let inertias = mobilities.times(Q::load(four(&pairs.squares, k)));
    let lost = Q::splat(-0.25).times(impulses).times(inertias.times_plus(impulses, twice));
    let heats = Q::wide(four(&pairs.heats, k));
    me.heat = me.heat.plus(lost.plus(heats));
    columns[D] = columns[D].plus(lost.minus(heats));
    let forces = Q::load(four(&pairs.forces, k));
    let pull = mobilities.minus(me.mobility).times(impulses);
    let mut pushes = [Q::splat(0.0); 4];
    for axis in 0..D {
        columns[axis] = pull.times_from(ways[axis], columns[axis]);
        pushes[axis] = forces.times(ways[axis]);
        me.force[axis] = me.force[axis].plus(pushes[axis]);
    }
    let (motions, pushes) = (Q::turned(columns), Q::turned(pushes));
    for l in 0..4 {
        motions[l].store(others[l].motion());
        let pushed = others[l].pushed();
        Q::load(pushed).minus(pushes[l]).store(pushed);
    }
}

#[inline(always)]
fn meet<const D: usize>(pairs: &PairColumns<D>, k: usize, me: &mut Particle<D>, other: &mut Particle<D>) {
    let mut displacement = [0.0; D];
    for axis in 0..D {
        displacement[axis] = pairs.displacements[axis][k];
    }
    // Pairs of one particle wait for each other: its velocity comes in last.
    let mut before = 0.0;
    for axis in 0..D {
        before = (-displacement[axis]).mul_add(other.velocity[axis], before);
    }
    for axis in 0..D {
        before = displacement[axis].mul_add(me.velocity[axis], before);
    }
    let impulse = f64::from(pairs.friction_impulses[k]).mul_add(before, f64::from(pairs.noise_impulses[k]));
    // Half of what the pair loses of its kinetic energy.
    let inertia = f64::from(pairs.mobilities[k]) * pairs.squares[k];
    let lost = -0.25 * impulse * inertia.mul_add(impulse, 2.0 * before);
    let (push, pull) = (me.mobility * impulse, -other.mobility * impulse);
    for axis in 0..D {
        let way = displacement[axis];
        me.velocity[axis] = push.mul_add(way, me.velocity[axis]);
        other.velocity[axis] = pull.mul_add(way, other.velocity[axis]);
        me.force[axis] = pairs.forces[k].mul_add(way, me.force[axis]);
        other.force[axis] = (-pairs.forces[k]).mul_add(way, other.force[axis]);
    }
    let heat = f64::from(pairs.heats[k]);
    me.heat += lost + heat;
    other.heat += lost - heat;
}
