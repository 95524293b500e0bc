//! The order in which slabs act: all of even number at once, then all of odd number, so that no two touch the same particle.

use super::matter::Matter;
use super::pairs::{Desk, SlabParticles, StepConstants, act};
use super::particle::Particle;

/// Lets all pairs act, on the threads of the pool at hand where `parallel`.
pub fn act_in_turn<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    parallel: bool,
    desks: &mut [Desk<D>],
    particles: &mut [Particle<D>],
) {
    twos(frame, parallel, 0, desks, (0, particles));
    // Those of odd number; the last one's next is the first.
    let count = desks.len();
    let (first, rest) = particles.split_at_mut(frame.count(0..1));
    let (middle, last) = rest.split_at_mut(rest.len() - frame.count(count - 1..count));
    let (middle_desks, last_desks) = desks[1..].split_at_mut(count - 2);
    let begins = (first.len(), first.len() + middle.len());
    let wrapped = || act(frame, count - 1, &mut last_desks[0], (begins.1, last), (0, first));
    let inside = || {
        if count > 2 {
            twos(frame, parallel, 1, middle_desks, (begins.0, middle));
        }
    };
    both(parallel, wrapped, inside);
}

/// Slabs of one parity, from one on: `desks` come in twos, whose first ones' slabs act, at once with all others.
fn twos<const D: usize, M: Matter>(
    frame: &StepConstants<'_, D, M>,
    parallel: bool,
    slab: usize,
    desks: &mut [Desk<D>],
    (begin, particles): SlabParticles<'_, D>,
) {
    if let [desk, _] = desks {
        return act(frame, slab, desk, (begin, particles), (0, &mut []));
    }
    let half = (desks.len() / 4 * 2).max(2);
    let (desks, other_desks) = desks.split_at_mut(half);
    let (particles, other_particles) = particles.split_at_mut(frame.count(slab..slab + half));
    let other_begin = begin + particles.len();
    both(
        parallel,
        || twos(frame, parallel, slab, desks, (begin, particles)),
        || twos(frame, parallel, slab + half, other_desks, (other_begin, other_particles)),
    );
}

fn both(parallel: bool, a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    if parallel {
        rayon::join(a, b);
    } else {
        a();
        b();
    }
}
