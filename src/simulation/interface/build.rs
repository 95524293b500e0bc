//! Which pairs, ghosts and walls see several materials.

use frazil_core::bonds::pair_list::PairList;
use frazil_core::boundary::curved_wall::Rim;
use frazil_core::boundary::ghosts::Ghosts;
use frazil_core::boundary::interface::{Chains, Piece};
use frazil_core::boundary::patch::Boundary;
use frazil_core::boundary::shells::Touch;
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::latent_heat::Materials;
use frazil_core::space::lattice::Lattice;
use frazil_scene::{Numerics, Scene};
use glam::DVec2;

use super::ground::Ground;

/// Particles and what they see.
pub struct Seen<'a> {
    /// Positions of particles (m).
    pub positions: &'a [DVec2],
    /// Materials.
    pub materials: &'a Materials,
    /// Pairs.
    pub pairs: &'a PairList,
    /// Walls.
    pub boundary: &'a Boundary,
    /// Curved walls.
    pub rims: &'a [Rim],
    /// Walls that touch shells.
    pub touches: &'a [Touch],
    /// The lattice of the particles.
    pub lattice: &'a Lattice,
}

/// The chains of a body of several materials. Ghosts behind walls that heat passes take the material at the wall.
pub fn chains(scene: &Scene, numerics: &Numerics, seen: &Seen<'_>, ghosts: &mut Ghosts) -> Chains {
    let mut chains = Chains::default();
    if !seen.materials.mixed() {
        return chains;
    }
    let ground = Ground::new(scene, seen.lattice, seen.boundary);
    ghosts.material = ghosts.model.iter().map(|model| seen.materials.index(*model as usize) as u8).collect();
    if numerics.walls == WallModel::Mirror {
        behind_walls(&mut chains, &ground, seen, ghosts);
    }
    between_pairs(&mut chains, &ground, seen, ghosts);
    let thermals = &seen.materials.thermals;
    let mut from_wall = |foot: DVec2, particle: usize| {
        let own = seen.materials.index(particle) as u8;
        let pieces = ground.pieces((foot, ground.material(foot)), (seen.positions[particle], own));
        pieces.map_or(0, |pieces| chains.number(&pieces, thermals))
    };
    let mut of_rim = Vec::new();
    for rim in seen.rims {
        let outer = seen.boundary.curved.filter(|curved| curved.0 == rim.patch).map(|curved| curved.1);
        let radius = outer.or(seen.boundary.dug.filter(|dug| dug.patch == rim.patch).map(|dug| dug.radius));
        let mut numbers = vec![0; seen.positions.len()];
        for particle in rim.contacts.seen() {
            let place = seen.positions[particle as usize];
            if let Some(radius) = radius.filter(|_| place != DVec2::ZERO && numbers[particle as usize] == 0) {
                numbers[particle as usize] = from_wall(place.normalize() * radius, particle as usize);
            }
        }
        of_rim.push(numbers);
    }
    let of_touch = seen.touches.iter().map(|touch| {
        let side = 2 * usize::from(touch.across_y) + usize::from(touch.at_end);
        from_wall(seen.lattice.foot(side, seen.positions[touch.particle as usize]), touch.particle as usize)
    });
    let of_touch = of_touch.collect();
    (chains.of_rim, chains.of_touch) = (of_rim, of_touch);
    chains
}

/// Gives ghosts the materials that go on behind their walls, and chains to those whose images see them through others.
fn behind_walls(chains: &mut Chains, ground: &Ground<'_>, seen: &Seen<'_>, ghosts: &mut Ghosts) {
    let count = seen.positions.len();
    let mut of_ghost = vec![0; ghosts.len()];
    for (ghost, number) in of_ghost.iter_mut().enumerate() {
        let Some(image) = ghosts.original(ghost) else { continue };
        let (place, own) = match (image as usize).checked_sub(count) {
            None => (seen.positions[image as usize], seen.materials.index(image as usize) as u8),
            Some(parent) => (ghosts.position[parent], ghosts.material[parent]),
        };
        let open = ghosts.patch[ghost].filter(|patch| seen.boundary.patches[*patch as usize].lets_heat_through());
        if open.is_none() {
            ghosts.material[ghost] = own;
            continue;
        }
        let foot = 0.5 * (place + ghosts.position[ghost]);
        let there = ground.material(ghosts.position[ghost]);
        ghosts.material[ghost] = there;
        if let Some(pieces) = ground.pieces((foot, there), (place, own)) {
            *number = chains.number(&pieces, &seen.materials.thermals);
        }
    }
    chains.of_ghost = of_ghost;
}

/// Gives chains to pairs.
fn between_pairs(chains: &mut Chains, ground: &Ground<'_>, seen: &Seen<'_>, ghosts: &Ghosts) {
    let (count, pairs) = (seen.positions.len(), seen.pairs);
    let place = |j: usize| j.checked_sub(count).map_or_else(|| seen.positions[j], |ghost| ghosts.position[ghost]);
    let material =
        |j: usize| j.checked_sub(count).map_or_else(|| seen.materials.index(j) as u8, |ghost| ghosts.material[ghost]);
    let mut of_pair: Vec<u32> = vec![0; pairs.partners.len()];
    for i in 0..count {
        let row = pairs.starts[i]..pairs.starts[i + 1];
        let farthest = row.clone().map(|k| (place(pairs.partners[k] as usize) - place(i)).length());
        let farthest = farthest.fold(0.0, f64::max);
        // Behind walls materials are those of places that are no farther.
        let alike = row.clone().all(|k| material(pairs.partners[k] as usize) == material(i));
        if alike && ground.is_uniform(place(i), farthest) {
            continue;
        }
        for k in row {
            let j = pairs.partners[k] as usize;
            // From the end of lower number on, so that both directions of a pair share one chain.
            let back =
                (j < i).then(|| (pairs.starts[j]..pairs.starts[j + 1]).find(|k| pairs.partners[*k] as usize == i));
            of_pair[k] = match back.flatten() {
                Some(back) => of_pair[back],
                None => {
                    let (low, high) = (i.min(j), i.max(j));
                    let pieces: Option<Vec<Piece>> =
                        ground.pieces((place(low), material(low)), (place(high), material(high)));
                    pieces.map_or(0, |pieces| chains.number(&pieces, &seen.materials.thermals))
                }
            };
        }
    }
    chains.of_pair = of_pair;
}
