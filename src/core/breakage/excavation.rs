//! A shaft dug inside a ring of pipes: from that instant on no pair reaches across its face, and what pairs carried to
//! the ground that is gone is given back as the flux through the face ([`crate::boundary::curved_wall`], from within).

use glam::DVec2;

use crate::bonds::pair_list::PairList;
use crate::boundary::curved_wall::{Contacts, Neighbourhood, Rim};
use crate::boundary::ghosts::Ghosts;
use crate::boundary::patch::Dug;
use crate::breakage::cuts::Cuts;
use crate::physics::latent_heat::Materials;

/// The contacts of the ground around the face, from when pairs across it are cut on. The ground conducts `along` x and y by factors,
/// and fronts inside particles may be followed.
pub fn face(
    pairs: &PairList,
    positions: &[DVec2],
    ghosts: &Ghosts,
    (materials, along, followed): (&Materials, DVec2, bool),
    dug: &Dug,
    cuts: &mut Cuts,
) -> Rim {
    let count = positions.len();
    // Beside a ring there are mirror planes alone, whose ghosts are their particles.
    let particle = |k: usize| {
        let partner = pairs.partners[k] as usize;
        partner.checked_sub(count).map_or(partner, |ghost| ghosts.model[ghost] as usize)
    };
    let depth = |i: usize| positions[i].length() - dug.radius;
    let (mut events, mut contacts) = (Vec::new(), Contacts::default());
    for i in 0..count {
        let own = depth(i);
        let mut near = Neighbourhood::new(own);
        let mut sum = 0.0;
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            let (other, weight) = (particle(k), pairs.weights[k]);
            let there = depth(other);
            sum += weight;
            if (own < 0.0) != (there < 0.0) {
                events.push((dug.start, k, weight));
                near.cut(weight, -there);
            } else if materials.index(other) == materials.index(i) {
                // A neighbour of another material pulls by the potential of the interface, not by its own.
                near.pair(other as u32, weight, there);
            }
        }
        if own >= 0.0 {
            contacts.add(i as u32, &near, sum, (materials, followed));
        }
    }
    contacts.conduct(along, |particle| positions[particle]);
    cuts.add(&events);
    Rim { patch: dug.patch, from: dug.start, contacts }
}
