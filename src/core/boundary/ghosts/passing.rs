//! Which share of a pair passes which part of a wall.
//!
//! Beside the ends of parts a ghost stands once for each part, and a pair counts with each of them by the share of a stretch of
//! the wall, as long as the spacing and around the place at which the pair crosses the wall, that lies in the part. A pair
//! of one particle with the image of another and that of the other with the image of the first cross the wall at one place: so
//! both know the same parts, and what a closed part gives to one particle it takes from the other.

use glam::DVec2;

use crate::boundary::ghosts::{BoxSide, Ghosts, box_sides};
use crate::boundary::patch::{Boundary, Side, Stretch, share_of};
use crate::boundary::wall_ends::lengthened;
use crate::space::lattice::Lattice;

/// A side with the parts of its wall.
struct Gate {
    side: BoxSide,
    /// Ends of the wall along itself (m).
    ends: (f64, f64),
    /// Its parts; empty where it is in one.
    stretches: Vec<Stretch>,
}

/// Tells of pairs with ghosts how much of them counts.
pub struct Passing<'a> {
    ghosts: &'a Ghosts,
    /// How many particles there are.
    count: usize,
    spacing: f64,
    /// Left, right, bottom, top; empty where no wall is in parts.
    gates: Vec<Gate>,
}

impl<'a> Passing<'a> {
    /// The walls of a body of `count` particles, and the ghosts behind them.
    ///
    /// Parts of known temperature act up to `cover` spacings from the edge of the last cell that they cover whole
    /// ([`lengthened`]), by the share of a spacing from that edge to their own end.
    pub fn new(
        ghosts: &'a Ghosts,
        count: usize,
        lattice: &Lattice,
        boundary: &Boundary,
        cover: impl Fn(f64) -> f64,
    ) -> Self {
        let (low, high) = (lattice.corner, lattice.far());
        let gate = |side: BoxSide| {
            let ends = if side.0 < 2 { (low.y, high.y) } else { (low.x, high.x) };
            let stretches = match boundary.sides[side.0] {
                Side::Wall(whole) if !boundary.parts_between(whole, ends).is_empty() => {
                    let wall = boundary.patches[whole].id.wall();
                    wall.map_or_else(Vec::new, |wall| lengthened(boundary, wall, ends, lattice.spacing, &cover))
                }
                Side::Wall(_) | Side::Mirror | Side::Periodic | Side::Curved => Vec::new(),
            };
            Gate { side, ends, stretches }
        };
        let gates: Vec<Gate> = box_sides(lattice).map(gate).into();
        let in_parts = gates.iter().any(|gate| !gate.stretches.is_empty());
        Passing { ghosts, count, spacing: lattice.spacing, gates: if in_parts { gates } else { Vec::new() } }
    }

    /// How much of the pair of a particle at a place with a ghost counts.
    pub fn share(&self, from: DVec2, ghost: usize) -> f64 {
        let mut share = self.ghosts.share(ghost);
        if self.gates.is_empty() {
            return share;
        }
        let (mut from, mut next) = (from, Some(ghost));
        while let Some(ghost) = next {
            let Some(gate) = self.ghosts.side(ghost).map(|side| &self.gates[side]) else { break };
            let (number, outwards, offset) = gate.side;
            let (near, far) = (offset - outwards.dot(from), self.ghosts.depth[ghost]);
            if let Some(patch) = self.ghosts.patch[ghost].filter(|_| !gate.stretches.is_empty()) {
                let to = self.ghosts.position[ghost];
                let (from, to) = if number < 2 { (from.y, to.y) } else { (from.x, to.x) };
                let foot = fold((far * from + near * to) / (near + far), gate.ends);
                share *= share_of(&gate.stretches, patch as usize, foot, self.spacing);
            }
            // Seen from the mirror image of the particle, the pair goes on to what the ghost mirrors.
            from += 2.0 * near * outwards;
            next = self.ghosts.original(ghost).and_then(|image| (image as usize).checked_sub(self.count));
        }
        share
    }
}

/// The place (m) on a wall that lies mirrored at one beyond its ends.
fn fold(along: f64, (low, high): (f64, f64)) -> f64 {
    if along >= low && along <= high {
        return along;
    }
    let beyond = (along - low).rem_euclid(2.0 * (high - low));
    low + beyond.min(2.0 * (high - low) - beyond)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_beyond_a_wall_are_those_of_its_mirror_image() {
        for (along, there) in [(2.25, 2.25), (1.5, 2.5), (3.25, 2.75), (4.5, 2.5), (-0.25, 2.25)] {
            assert!((fold(along, (2.0, 3.0)) - there).abs() < 1e-12, "{along}");
        }
    }
}
