//! Walls as layers of particles, in place of mirror images: the papers' other two ways.
//!
//! - *Naive*: all particles of the layers behind a place of a wall hold one value. At a wall of known temperature it is the
//!   wall's own; at a flux or film it is the mean of the particles that see the layers there, by the strength of their
//!   pairs, and as much more as makes the pairs together carry the flux. A film conducts from that mean through all pairs
//!   at once.
//! - *Inner layers*: nothing lies behind the wall, and the outermost particles of the body within reach of it are the wall.
//!   At a known temperature the others see the wall's value there, and they themselves follow it through a conductance as
//!   strong as all their pairs were, so what they take up is counted like all heat. At a flux or film each of them takes the
//!   same share of the heat.
//!
//! Either way a rate rises with the potential of every other particle, so the maximum principle holds, and what particles
//! gain is what walls book. But a known temperature holds over a layer as deep as pairs reach, and not at the wall, so errors
//! fall with the first power of the reach alone (docs/theory/walls.md).

use std::collections::BTreeMap;

use glam::DVec2;

use crate::bonds::pair_list::PairList;
use crate::boundary::ghosts::{Ghosts, Levelled};
use crate::boundary::patch::{Boundary, share_of};
use crate::boundary::shells::Touch;
use crate::physics::latent_heat::Materials;
use crate::space::lattice::Lattice;
use crate::space::symmetry::Symmetry;
use crate::space::volumes::Volumes;
use crate::space::wall::{PatchId, WallId};

/// How walls act on particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WallModel {
    /// Ghosts mirrored about the wall.
    Mirror,
    /// Ghosts from moving least squares everywhere.
    MovingLeastSquares,
    /// Layers of ghosts that hold one value: the papers' simplest way.
    Naive,
    /// The outermost particles of the body as the wall.
    InnerLayers,
}

impl WallModel {
    /// All of them with the words of files.
    pub const WORDS: [(&str, WallModel); 4] = [
        ("mirror", WallModel::Mirror),
        ("moving-least-squares", WallModel::MovingLeastSquares),
        ("naive", WallModel::Naive),
        ("inner-layers", WallModel::InnerLayers),
    ];
}

/// A body between layers.
pub struct Body<'a> {
    /// Positions of particles (m).
    pub positions: &'a [DVec2],
    /// Cells.
    pub lattice: &'a Lattice,
    /// Walls.
    pub boundary: &'a Boundary,
    /// Volumes of particles.
    pub volumes: &'a Volumes,
    /// Materials of particles.
    pub materials: &'a Materials,
    /// What the body does not vary along, if it is one of shells.
    pub symmetry: Option<Symmetry>,
}

impl Body<'_> {
    /// Column and row of the cell of a particle.
    fn cell(&self, particle: usize) -> (usize, usize) {
        let place = (self.positions[particle] - self.lattice.corner) / self.lattice.spacing;
        let number = |x: f64, count: usize| (x.max(0.0) as usize).min(count - 1);
        let row = if self.lattice.dimension == 1 { 0 } else { number(place.y, self.lattice.rows) };
        (number(place.x, self.lattice.columns), row)
    }

    /// Patch of a side (left or inner, right or outer, bottom, top) beside a particle, if heat crosses it.
    fn open_patch(&self, side: usize, particle: usize) -> Option<usize> {
        let is_here = |id: PatchId| matches!(id, PatchId::Whole(wall) if wall.side() == side);
        let whole = self.boundary.patches.iter().position(|patch| is_here(patch.id))?;
        let place = self.positions[particle];
        let patch = self.boundary.patch_at(whole, if side < 2 { place.y } else { place.x });
        self.boundary.patches[patch].lets_heat_through().then_some(patch)
    }

    /// The side that a patch lies at.
    fn side(&self, patch: usize) -> usize {
        self.boundary.patches[patch].id.wall().map_or(3, WallId::side)
    }

    /// Area of a wall (m^(d-1); of shells by length of the axis or of the whole sphere) that belongs to a column or row.
    fn area(&self, side: usize, column: usize) -> f64 {
        let Lattice { spacing, dimension, corner, .. } = *self.lattice;
        let height = if dimension == 2 { spacing } else { 1.0 };
        let edge = |column: usize| corner.x + column as f64 * spacing;
        match self.symmetry {
            None => height,
            Some(symmetry) if side == 0 => symmetry.area(edge(0)) * height,
            Some(symmetry) if side == 1 => symmetry.area(edge(self.lattice.columns)) * height,
            Some(symmetry) => symmetry.volume(edge(column), edge(column + 1)),
        }
    }

    /// The part of the wall beside a column or row that lies in a patch. Shells stand in one patch each.
    fn share(&self, patch: usize, along: usize) -> f64 {
        let wall = self.boundary.patches[patch].id.wall();
        let Some(whole) = wall.and_then(|wall| self.boundary.whole(wall)).filter(|_| self.symmetry.is_none()) else {
            return 1.0;
        };
        let Lattice { corner, spacing, .. } = *self.lattice;
        let (far, axis) = (self.lattice.far(), usize::from(self.side(patch) < 2));
        let stretches = self.boundary.parts_between(whole, (corner[axis], far[axis]));
        let middle = corner[axis] + (along as f64 + 0.5) * spacing;
        if stretches.is_empty() { 1.0 } else { share_of(&stretches, patch, middle, spacing) }
    }

    /// Depth (m) of a particle behind a side, as a plane wall would have it.
    fn depth(&self, side: usize, particle: usize) -> f64 {
        let (far, place) = (self.lattice.far(), self.positions[particle]);
        match (side, self.symmetry) {
            (0, Some(symmetry)) => symmetry.depth(self.lattice.corner.x, place.x),
            (1, Some(symmetry)) => symmetry.depth(far.x, place.x),
            (0, None) => place.x - self.lattice.corner.x,
            (1, None) => far.x - place.x,
            (2, _) => place.y - self.lattice.corner.y,
            _ => far.y - place.y,
        }
    }
}

/// Ghosts that hold one value, and how strongly particles see them.
#[derive(Default)]
struct Group {
    members: Vec<usize>,
    seen: BTreeMap<u32, f64>,
}

/// Gives all ghosts behind a place of a wall one value. `closed` takes in walls through which no heat passes, which are
/// mirrors otherwise.
pub fn level(ghosts: &mut Ghosts, pairs: &PairList, body: &Body<'_>, closed: bool) {
    let count = body.positions.len();
    let takes = |patch: &u8| closed || body.boundary.patches[*patch as usize].lets_heat_through();
    // By patch, column or row, and material.
    let mut groups: BTreeMap<(u8, usize, usize), Group> = BTreeMap::new();
    let mut key_of = vec![None; ghosts.len()];
    for ghost in 0..ghosts.len() {
        // At corners the wall that books the heat also has the value.
        let Some(patch) = ghosts.pays[ghost].filter(takes).or(ghosts.patch[ghost].filter(takes)) else { continue };
        let model = ghosts.model[ghost] as usize;
        let (column, row) = body.cell(model);
        let along = if body.side(patch as usize) >= 2 { column } else { row };
        let key = (patch, along, body.materials.index(model));
        groups.entry(key).or_default().members.push(ghost);
        key_of[ghost] = Some(key);
    }
    for i in 0..count {
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            let Some(ghost) = (pairs.partners[k] as usize).checked_sub(count) else { continue };
            if let Some(key) = key_of[ghost].filter(|key| key.2 == body.materials.index(i))
                && let Some(group) = groups.get_mut(&key)
                && pairs.weights[k] > 0.0
            {
                *group.seen.entry(i as u32).or_default() += body.volumes.of(i) * pairs.weights[k];
            }
        }
    }
    let mut levelled: Vec<Option<Levelled>> = (0..ghosts.len()).map(|_| None).collect();
    for ((patch, along, _), Group { members, seen }) in groups {
        let Some(first) = members.first().copied() else { continue };
        let side = body.side(patch as usize);
        let sum: f64 = seen.values().sum();
        let nearest = |a: &&usize, b: &&usize| {
            let depth = |ghost: usize| body.depth(side, ghosts.model[ghost] as usize);
            depth(**a).total_cmp(&depth(**b))
        };
        let model = members.iter().min_by(nearest).map_or(ghosts.model[first], |ghost| ghosts.model[*ghost]);
        let images = match sum > 0.0 {
            true => seen.iter().map(|(particle, strength)| (*particle, strength / sum)).collect(),
            false => vec![(model, 1.0)],
        };
        // Half of the distance over which a difference of potentials drives the flux through all pairs at once.
        let area = body.area(side, along) * body.share(patch as usize, along);
        let depth = if sum > 0.0 { 0.5 * area / sum } else { 0.0 };
        for ghost in &members[1..] {
            let images = vec![((count + first) as u32, 1.0)];
            levelled[*ghost] = Some(Levelled { patch: None, pays: patch, images, depth: 0.0, model });
        }
        levelled[first] = Some(Levelled { patch: Some(patch), pays: patch, images, depth, model });
    }
    ghosts.level(levelled);
}

/// The outermost layers of particles of a body.
struct Layers<'a> {
    body: &'a Body<'a>,
    number: usize,
}

impl Layers<'_> {
    /// How many cells lie between a particle and a side.
    fn depth(&self, side: usize, particle: usize) -> usize {
        let (column, row) = self.body.cell(particle);
        match side {
            0 => column,
            1 => self.body.lattice.columns - 1 - column,
            2 => row,
            _ => self.body.lattice.rows - 1 - row,
        }
    }

    /// Sides and patches that are open beside a particle of these layers, the nearest first.
    fn patches(&self, particle: usize) -> Vec<(usize, usize)> {
        let near = (0..4).filter(|side| self.depth(*side, particle) < self.number);
        let mut near: Vec<(usize, usize)> =
            near.filter_map(|side| Some((side, self.body.open_patch(side, particle)?))).collect();
        near.sort_by_key(|(side, _)| self.depth(*side, particle));
        near
    }

    /// The nearest that hold a particle at a temperature: several in corners, which share it.
    fn holding(&self, particle: usize) -> Vec<(usize, usize)> {
        let mut near = self.patches(particle);
        near.retain(|(_, patch)| self.body.boundary.patches[*patch].is_held());
        let nearest = near.first().map(|(side, _)| self.depth(*side, particle));
        near.retain(|(side, _)| Some(self.depth(*side, particle)) == nearest);
        near
    }
}

/// As many layers at each wall hold all particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("wall_model = \"inner-layers\" holds the {0} outermost layers at each wall, which leaves no particle free")]
pub struct NoFreeParticle(pub usize);

/// Makes the outermost `number` of layers of particles at open walls the walls themselves; gives where walls touch them.
///
/// # Errors
/// Layers that leave no particle free.
pub fn inner(
    pairs: &mut PairList,
    ghosts: &mut Ghosts,
    body: &Body<'_>,
    number: usize,
) -> Result<Vec<Touch>, NoFreeParticle> {
    let count = body.positions.len();
    let layers = Layers { body, number };
    let held: Vec<Vec<(usize, usize)>> = (0..count).map(|i| layers.holding(i)).collect();
    if held.iter().all(|held| !held.is_empty()) {
        return Err(NoFreeParticle(number));
    }
    let mut touches = Vec::new();
    // The first of the ghosts that stand for a held particle, one for each of its walls.
    let mut stands_for: Vec<u32> = vec![0; count];
    for i in 0..count {
        let touch = |(side, patch): (usize, usize), depth: f64, area: f64| Touch {
            particle: i as u32,
            patch: patch as u8,
            depth,
            area,
            across_y: side >= 2,
            at_end: side % 2 == 1,
        };
        if !held[i].is_empty() {
            let stiffness: f64 = pairs.weights[pairs.starts[i]..pairs.starts[i + 1]].iter().sum();
            let depth = 0.5 * body.lattice.spacing;
            stands_for[i] = (count + ghosts.len()) as u32;
            for (side, patch) in &held[i] {
                touches.push(touch((*side, *patch), depth, stiffness * depth / held[i].len() as f64));
                // On the wall: what the others gain of it crosses every surface in between.
                ghosts.hold(count, i as u32, body.lattice.foot(*side, body.positions[i]), *patch as u8);
            }
        } else {
            for (side, patch) in layers.patches(i) {
                let area = body.area(side, body.cell(i).0) / (number as f64 * body.volumes.of(i));
                touches.push(touch((side, patch), body.depth(side, i), area));
            }
        }
    }
    *pairs = without(pairs, ghosts, body, &held, &stands_for);
    Ok(touches)
}

/// The pairs of particles that no wall holds: with those that one holds through the ghosts that stand for them, and with none
/// behind open walls.
fn without(
    pairs: &PairList,
    ghosts: &Ghosts,
    body: &Body<'_>,
    held: &[Vec<(usize, usize)>],
    stands_for: &[u32],
) -> PairList {
    let count = held.len();
    let is_open =
        |patch: &Option<u8>| patch.is_some_and(|patch| body.boundary.patches[patch as usize].lets_heat_through());
    let mut kept = PairList { starts: vec![0], ..PairList::default() };
    for i in 0..count {
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            let (partner, weight) = (pairs.partners[k], pairs.weights[k]);
            let particle = match (partner as usize).checked_sub(count) {
                _ if !held[i].is_empty() => continue,
                None => partner as usize,
                Some(ghost) if is_open(&ghosts.pays[ghost]) || is_open(&ghosts.patch[ghost]) => continue,
                // Mirrors of the wall are the wall.
                Some(ghost) => ghosts.model[ghost] as usize,
            };
            match held[particle].len() as u32 {
                0 => {
                    kept.partners.push(partner);
                    kept.weights.push(weight);
                }
                walls => {
                    kept.partners.extend((0..walls).map(|wall| stands_for[particle] + wall));
                    kept.weights.extend((0..walls).map(|_| weight / f64::from(walls)));
                }
            }
        }
        kept.starts.push(kept.partners.len());
    }
    kept
}
