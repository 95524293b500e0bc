//! Which ghosts a body has, and what they mirror.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::boundary::ghosts::{BoxSide, Ghosts, SIDES, box_sides};
use crate::boundary::patch::{Boundary, Side, moving_least_squares};
use crate::neighbours::tree::Tree;
use crate::neighbours::{NeighbourSearch, Period};
use crate::space::lattice::Lattice;

/// Range of moving least squares in units of the spacing, and the scale of its weights.
const FIT_RANGE: f64 = 2.3;
const FIT_SCALE: f64 = 1.2;
/// Relative difference of squared distances that rounding may make.
const SAME_DISTANCE: f64 = 1e-9;

/// How much farther than its own ends a part of a wall may act, and half the stretch over which a pair passes it (spacings).
const LONGER: f64 = 3.0;

/// Straight walls left and right, or at the bottom and the top.
#[derive(Clone, Copy)]
enum Walls {
    Columns,
    Rows,
}

/// The mirrors between a ghost and its particle, by [`Walls`]: whether there are any, and whether heat passes one.
#[derive(Clone, Copy, Default)]
struct Mirrors {
    mirrored: [bool; 2],
    open: [bool; 2],
}

/// Ghosts in the making.
struct Builder<'a> {
    points: &'a [DVec2],
    lattice: &'a Lattice,
    boundary: &'a Boundary,
    /// How far outside the walls ghosts stand (m).
    reach: f64,
    ghosts: Ghosts,
    mirrors: Vec<Mirrors>,
}

impl Ghosts {
    /// Ghosts within `reach` (m) outside the walls. `fitted` takes images at straight walls from moving least
    /// squares as well, with ghosts on their own lattice.
    ///
    /// Ghosts in corners are mirrored twice. Where heat passes both walls, the order matters: there are two ghosts then, one
    /// for each order, and half of the pairs at their place is with either.
    pub fn new(points: &[DVec2], lattice: &Lattice, boundary: &Boundary, reach: f64, fitted: bool) -> Self {
        let (ghosts, mirrors) = (Ghosts::none(), Vec::new());
        let mut builder = Builder { points, lattice, boundary, reach: reach * (1.0 + 1e-9), ghosts, mirrors };
        let kinds: &[Walls] = if lattice.dimension == 1 { &[Walls::Columns] } else { &[Walls::Columns, Walls::Rows] };
        let walled = |walls: &Walls| builder.sides(*walls).iter().any(|s| matches!(boundary.sides[s.0], Side::Wall(_)));
        let fitted: Vec<bool> = kinds.iter().map(|walls| fitted && walled(walls)).collect();
        let both_fitted = fitted == [true, true];
        for (walls, fitted) in kinds.iter().zip(&fitted) {
            if *fitted {
                builder.fit_straight(*walls, both_fitted || matches!(walls, Walls::Rows));
            } else {
                // Over everything so far.
                let all = points.len() + builder.ghosts.len();
                builder.mirror(*walls, (0..all as u32).collect(), true);
            }
        }
        let first = builder.mirrors.len();
        if lattice.dimension > 1 && !fitted.contains(&true) {
            builder.mirror_the_other_way_round();
        }
        builder.ghosts.share = builder.shares(first, fitted.contains(&true));
        builder.ghosts
    }
}

impl Builder<'_> {
    fn sides(&self, walls: Walls) -> [BoxSide; 2] {
        let [left, right, bottom, top] = box_sides(self.lattice);
        match walls {
            Walls::Columns => [left, right],
            Walls::Rows => [bottom, top],
        }
    }

    /// Place of a particle or ghost (m).
    fn place(&self, index: u32) -> DVec2 {
        let index = index as usize;
        index.checked_sub(self.points.len()).map_or_else(|| self.points[index], |ghost| self.ghosts.position[ghost])
    }

    /// Mirrors particles and ghosts at two walls, and their images again, as far as pairs reach. Without `all`, only images
    /// whose heat passes walls of both kinds.
    fn mirror(&mut self, walls: Walls, mut frontier: Vec<u32>, all: bool) {
        let sides = self.sides(walls);
        let mut came_from = vec![usize::MAX; frontier.len()];
        while !frontier.is_empty() {
            let (mut next, mut next_from) = (Vec::new(), Vec::new());
            for (index, from) in frontier.into_iter().zip(came_from) {
                for side in sides {
                    if side.0 == from || self.boundary.sides[side.0] == Side::Curved {
                        continue;
                    }
                    let place = self.place(index);
                    let depth = side.2 - side.1.dot(place);
                    // As far behind the wall as it lies before the opposite one where the body repeats.
                    let repeats = self.boundary.sides[side.0] == Side::Periodic;
                    let (depth, way) = match repeats {
                        true => (self.length(walls) - depth, self.length(walls)),
                        false => (depth, 2.0 * depth),
                    };
                    if depth < 0.0 || depth > self.reach || repeats && from != usize::MAX {
                        continue;
                    }
                    for patch in self.patches(index, side.0) {
                        if let Some(number) = self.add(index, place + way * side.1, depth, (side.0, patch), all) {
                            next.push(number);
                            next_from.push(side.0);
                        }
                    }
                }
            }
            (frontier, came_from) = (next, next_from);
        }
    }

    /// Distance of two walls (m).
    fn length(&self, walls: Walls) -> f64 {
        let size = self.lattice.far() - self.lattice.corner;
        match walls {
            Walls::Columns => size.x,
            Walls::Rows => size.y,
        }
    }

    /// The patches of a side that pairs with the image of a particle or ghost may pass: one, but where a wall is in parts.
    fn patches(&self, image: u32, side: usize) -> Vec<Option<u8>> {
        let Side::Wall(whole) = self.boundary.sides[side] else { return vec![None] };
        let model = (image as usize).checked_sub(self.points.len()).map_or(image, |ghost| self.ghosts.model[ghost]);
        // A part of a wall goes on behind the other wall of a corner.
        let (place, low, high) = (self.points[model as usize], self.lattice.corner, self.lattice.far());
        let (along, ends) = if side < 2 { (place.y, (low.y, high.y)) } else { (place.x, (low.x, high.x)) };
        let near = self.boundary.patches_near(whole, along, self.reach + LONGER * self.lattice.spacing, ends);
        near.into_iter().map(|patch| Some(patch as u8)).collect()
    }

    /// Adds the image of a particle or ghost at a patch of a side, and gives its number.
    fn add(
        &mut self,
        image: u32,
        place: DVec2,
        depth: f64,
        (side, patch): (usize, Option<u8>),
        all: bool,
    ) -> Option<u32> {
        let (count, boundary, ghosts) = (self.points.len(), self.boundary, &mut self.ghosts);
        let number = (count + ghosts.len()) as u32;
        let parent = (image as usize).checked_sub(count);
        let (model, identity, stream, pays) = match parent {
            Some(k) => (ghosts.model[k], ghosts.identity[k], ghosts.stream[k], ghosts.pays[k]),
            None => (image, image, 0, None),
        };
        let open = patch.filter(|patch| boundary.books_all || boundary.patches[*patch as usize].lets_heat_through());
        let mut mirrors = parent.map_or(Mirrors::default(), |k| self.mirrors[k]);
        mirrors.mirrored[side / 2] = true;
        mirrors.open[side / 2] |= open.is_some();
        if !all && mirrors.open != [true, true] {
            return None;
        }
        self.mirrors.push(mirrors);
        ghosts.position.push(place);
        ghosts.patch.push(patch);
        ghosts.pays.push(open.or(pays));
        ghosts.depth.push(depth);
        ghosts.model.push(model);
        ghosts.identity.push(if open.is_some() { number } else { identity });
        // Two particles see each other over both walls of a body that repeats, and share one noise.
        let told = if boundary.sides[side] == Side::Periodic { side & !1 } else { side };
        ghosts.stream.push(stream * SIDES + told as u32 + 1);
        ghosts.images.push((image, 1.0));
        ghosts.starts.push(ghosts.images.len() as u32);
        Some(number)
    }

    /// Mirrors what stands behind walls at the bottom and the top at those left and right, where heat passes both.
    fn mirror_the_other_way_round(&mut self) {
        let behind_rows =
            |ghost: &usize| self.mirrors[*ghost].mirrored == [false, true] && self.mirrors[*ghost].open[1];
        let count = self.points.len();
        let frontier = (0..self.mirrors.len()).filter(behind_rows).map(|ghost| (count + ghost) as u32).collect();
        // In a body narrower than the reach, images that pass a closed wall first have images that pass an open one.
        let narrow = self.lattice.columns as f64 * self.lattice.spacing < self.reach;
        self.mirror(Walls::Columns, frontier, narrow);
    }

    /// Which part of its pairs each ghost has, or nothing where all have all of them. From `other_way` on corners are mirrored
    /// the other way round.
    fn shares(&self, other_way: usize, fitted: bool) -> Vec<f64> {
        let in_both = |passed: &Mirrors| passed.mirrored == [true, true] && passed.open == [true, true];
        if !self.mirrors.iter().any(in_both) {
            return Vec::new();
        }
        if fitted {
            // Deep in corners one of two fits may have found no particles.
            let key = |place: &DVec2| (place.x.to_bits(), place.y.to_bits());
            let mut at: BTreeMap<(u64, u64), f64> = BTreeMap::new();
            self.ghosts.position.iter().for_each(|place| *at.entry(key(place)).or_default() += 1.0);
            return self.ghosts.position.iter().map(|place| 1.0 / at[&key(place)]).collect();
        }
        let share = |(ghost, passed): (usize, &Mirrors)| match passed.mirrored {
            [true, true] if in_both(passed) => 0.5,
            [true, true] if ghost >= other_way => 0.0,
            _ => 1.0,
        };
        self.mirrors.iter().enumerate().map(share).collect()
    }

    /// Ghosts on lattice points outside straight walls, with fitted images; behind the other walls of corners too, where
    /// they are asked for.
    fn fit_straight(&mut self, walls: Walls, corners: bool) {
        let (lattice, sides) = (self.lattice, self.sides(walls));
        let layers = (self.reach / lattice.spacing).ceil() as i64;
        let (columns, rows) = (lattice.columns as i64, lattice.rows as i64);
        let margin = if corners { layers } else { 0 };
        for (side, normal, offset) in sides {
            let Side::Wall(whole) = self.boundary.sides[side] else { continue };
            let (along, across) = if side < 2 { (rows, columns) } else { (columns, rows) };
            let outside = |layer: i64| if side % 2 == 0 { -1 - layer } else { across + layer };
            let cells = (-margin..along + margin).flat_map(|at| (0..layers).map(move |layer| (at, outside(layer))));
            let targets: Vec<(DVec2, DVec2, f64)> = cells
                .map(|(at, outside)| {
                    let place = if side < 2 { lattice.centre(outside, at) } else { lattice.centre(at, outside) };
                    let depth = normal.dot(place) - offset;
                    (place, place - 2.0 * depth * normal, depth)
                })
                .collect();
            self.fit(&targets, side, whole);
        }
    }

    /// Adds ghosts at `targets` (place, image, depth) behind a side, with images fitted to nearby particles.
    fn fit(&mut self, targets: &[(DVec2, DVec2, f64)], side: usize, whole: usize) {
        let across = [self.sides(Walls::Columns), self.sides(Walls::Rows)];
        let (points, lattice, ghosts) = (self.points, self.lattice, &mut self.ghosts);
        let range = FIT_RANGE * lattice.spacing;
        let offset = targets.len();
        let mut all: Vec<DVec2> = targets.iter().map(|target| target.1).collect();
        all.extend_from_slice(points);
        let near = Tree.neighbours(&all, offset, range, Period::NONE);
        for (k, (place, image, depth)) in targets.iter().enumerate() {
            let found: Vec<usize> =
                near.of(k).iter().filter(|j| **j as usize >= offset).map(|j| *j as usize - offset).collect();
            let Some(first) = model(*image, &found, points) else { continue };
            let neighbours: Vec<DVec2> = found.iter().map(|j| points[*j]).collect();
            let weights = moving_least_squares(*image, &neighbours, FIT_SCALE * lattice.spacing, lattice.dimension);
            let number = (points.len() + ghosts.len()) as u32;
            let along = if side < 2 { place.y } else { place.x };
            let patch = self.boundary.patch_at(whole, along);
            ghosts.images.extend(found.iter().zip(weights).map(|(j, weight)| (*j as u32, weight)));
            ghosts.position.push(*place);
            ghosts.patch.push(Some(patch as u8));
            ghosts.pays.push(Some(patch as u8));
            ghosts.depth.push(*depth);
            ghosts.model.push(first as u32);
            ghosts.identity.push(number);
            ghosts.stream.push(0);
            ghosts.starts.push(ghosts.images.len() as u32);
            let beyond = |sides: [BoxSide; 2]| sides.iter().any(|side| side.1.dot(*place) > side.2);
            let mirrored = [beyond(across[0]), beyond(across[1])];
            self.mirrors.push(Mirrors { mirrored, open: mirrored });
        }
    }
}

/// The place nearest to an image. Equally near ones are told apart by their distances from the axes, so that mirror
/// images of a ghost take mirror images of a particle.
fn model(image: DVec2, found: &[usize], places: &[DVec2]) -> Option<usize> {
    let distance = |place: usize| (places[place] - image).length_squared();
    let least = found.iter().copied().map(distance).fold(f64::INFINITY, f64::min);
    let nearest = found.iter().copied().filter(|place| distance(*place) <= least * (1.0 + SAME_DISTANCE));
    nearest.min_by(|a, b| {
        let (a, b) = (places[*a].abs(), places[*b].abs());
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a diagonal two particles are equally near. Mirror images of the image must take mirror images of one of them.
    #[test]
    fn mirrored_ghosts_take_mirrored_models() {
        let places = [DVec2::new(1.1, 0.9), DVec2::new(0.9, 1.1), DVec2::new(1.5, 1.5)];
        let model = |image: DVec2, places: &[DVec2]| model(image, &[0, 1, 2], places).map(|found| places[found].abs());
        let own = model(DVec2::ONE, &places);
        for mirror in [DVec2::new(-1.0, 1.0), DVec2::new(1.0, -1.0), DVec2::NEG_ONE] {
            // A lattice numbers its particles upward, whichever side of an axis they are on.
            let mut mirrored = places.map(|place| place * mirror);
            mirrored.sort_by(|a, b| a.y.total_cmp(&b.y));
            assert_eq!(model(mirror, &mirrored), own);
        }
    }
}
