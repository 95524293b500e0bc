//! Ghost particles around a cloud: mirrors of particles at straight walls, or moving least squares.

use glam::DVec2;

use crate::boundary::{Boundary, Face, Side, moving_least_squares};
use crate::interface::Chains;
use crate::lattice::Lattice;
use crate::memory::Held;
use crate::neighbours::{NeighbourSearch, Period, tree::Tree};
use crate::uptake::Materials;

/// Range of moving least squares in units of the spacing, and the scale of its weights.
pub(crate) const FIT_RANGE: f64 = 2.3;
pub(crate) const FIT_SCALE: f64 = 1.2;
/// Relative difference of squared distances that rounding may make.
const SAME_DISTANCE: f64 = 1e-9;

/// Ghosts, numbered after the particles; each depends only on particles and earlier ghosts.
#[derive(Debug, Clone, Default)]
pub struct Ghosts {
    /// Position (m).
    pub position: Vec<DVec2>,
    /// Wall that the ghost stands behind, or none for a mirror plane of the domain.
    pub door: Vec<Option<u8>>,
    /// Door through which heat to the ghost goes: its own, or for mirrors of ghosts their image's.
    pub pays: Vec<Option<u8>>,
    /// Depth behind the wall (m).
    pub depth: Vec<f64>,
    /// A particle near the image, whose material and normalisation the ghost takes.
    pub model: Vec<u32>,
    /// Its material, by index; empty where it is that of the model.
    pub material: Vec<u8>,
    /// What noise calls the ghost: the particle that it mirrors by symmetry alone, or a number of its own.
    pub identity: Vec<u32>,
    /// Tells images of one particle apart.
    pub stream: Vec<u32>,
    starts: Vec<u32>,
    images: Vec<(u32, f64)>,
}

/// What a ghost becomes in a layer of one value.
pub struct Levelled {
    /// Wall by whose condition it follows its images, or none where it is as they are.
    pub door: Option<u8>,
    /// Door through which heat to it goes.
    pub pays: u8,
    /// Particles, or an earlier ghost, with their shares.
    pub images: Vec<(u32, f64)>,
    /// Half of the distance over which it follows them (m).
    pub depth: f64,
    /// The particle whose material it has.
    pub model: u32,
}

impl Held for Ghosts {
    fn held(&self) -> usize {
        // Doors are a byte and whether there is one.
        let doors = (self.door.capacity() + self.pays.capacity()) * size_of::<Option<u8>>();
        let names = self.material.held() + self.model.held() + self.identity.held() + self.stream.held();
        self.position.held() + doors + self.depth.held() + names + self.starts.held() + self.images.held()
    }
}

impl Ghosts {
    /// No ghosts.
    pub fn none() -> Self {
        Ghosts { starts: vec![0], ..Ghosts::default() }
    }

    /// Ghosts within `reach` (m) outside the walls. `fitted` takes images at straight walls from moving least
    /// squares as well, with ghosts on their own lattice.
    pub fn new(points: &[DVec2], lattice: &Lattice, boundary: &Boundary, reach: f64, fitted: bool) -> Self {
        let mut ghosts = Ghosts::none();
        let reach = reach * (1.0 + 1e-9);
        let extent = lattice.spacing * DVec2::new(lattice.columns as f64, lattice.rows as f64);
        let sides: [(usize, DVec2, f64); 4] = [
            (0, DVec2::NEG_X, -lattice.corner.x),
            (1, DVec2::X, lattice.corner.x + extent.x),
            (2, DVec2::NEG_Y, -lattice.corner.y),
            (3, DVec2::Y, lattice.corner.y + extent.y),
        ];
        // Columns first, then rows over everything so far: corners are mirrored twice, always in this order.
        for pair in [&sides[..2], &sides[2..]] {
            if lattice.dimension == 1 && pair[0].0 == 2 {
                continue;
            }
            if fitted && pair.iter().any(|side| matches!(boundary.sides[side.0], Side::Wall(_))) {
                ghosts.fit_straight(points, lattice, boundary, pair, reach);
                continue;
            }
            let mut frontier: Vec<(u32, usize)> =
                (0..(points.len() + ghosts.position.len()) as u32).map(|index| (index, usize::MAX)).collect();
            while !frontier.is_empty() {
                let mut next = Vec::new();
                for (index, came_from) in frontier {
                    for (side, normal, offset) in pair {
                        if *side == came_from || boundary.sides[*side] == Side::Curved {
                            continue;
                        }
                        let place = ghosts.place(points, index);
                        let depth = offset - normal.dot(place);
                        if depth < 0.0 || depth > reach {
                            continue;
                        }
                        let door = match boundary.sides[*side] {
                            Side::Wall(door) => {
                                Some(boundary.door_at(door, if *side < 2 { place.y } else { place.x }) as u8)
                            }
                            Side::Mirror | Side::Curved => None,
                        };
                        let open = door
                            .filter(|door| boundary.books_all || boundary.doors[*door as usize].lets_heat_through());
                        let number = (points.len() + ghosts.position.len()) as u32;
                        ghosts.mirror(points.len(), index, place + 2.0 * depth * *normal, door, open, depth, *side);
                        next.push((number, *side));
                    }
                }
                frontier = next;
            }
        }
        ghosts
    }

    fn place(&self, points: &[DVec2], index: u32) -> DVec2 {
        let index = index as usize;
        if index < points.len() { points[index] } else { self.position[index - points.len()] }
    }

    #[allow(clippy::too_many_arguments)]
    fn mirror(
        &mut self,
        count: usize,
        image: u32,
        place: DVec2,
        door: Option<u8>,
        open: Option<u8>,
        depth: f64,
        side: usize,
    ) {
        let number = (count + self.position.len()) as u32;
        let parent = (image as usize).checked_sub(count);
        let (model, identity, stream, pays) = match parent {
            Some(k) => (self.model[k], self.identity[k], self.stream[k], self.pays[k]),
            None => (image, image, 0, None),
        };
        self.position.push(place);
        self.door.push(door);
        // Corners beside an open wall left or right are its own, as on the lattice.
        self.pays.push(if side >= 2 { pays.or(open) } else { open.or(pays) });
        self.depth.push(depth);
        self.model.push(model);
        self.identity.push(if open.is_some() { number } else { identity });
        self.stream.push(stream * 5 + side as u32 + 1);
        self.images.push((image, 1.0));
        self.starts.push(self.images.len() as u32);
    }

    /// Ghosts on lattice points outside straight walls, with fitted images.
    fn fit_straight(
        &mut self,
        points: &[DVec2],
        lattice: &Lattice,
        boundary: &Boundary,
        pair: &[(usize, DVec2, f64)],
        reach: f64,
    ) {
        let layers = (reach / lattice.spacing).ceil() as i64;
        for (side, normal, offset) in pair {
            let Side::Wall(door) = boundary.sides[*side] else { continue };
            let margin = if *side >= 2 { layers } else { 0 };
            let (columns, rows) = (lattice.columns as i64, lattice.rows as i64);
            let cells: Vec<(i64, i64)> = match side {
                0 => (0..rows).flat_map(|row| (1..=layers).map(move |k| (-k, row))).collect(),
                1 => (0..rows).flat_map(|row| (0..layers).map(move |k| (columns + k, row))).collect(),
                2 => (-margin..columns + margin).flat_map(|c| (1..=layers).map(move |k| (c, -k))).collect(),
                _ => (-margin..columns + margin).flat_map(|c| (0..layers).map(move |k| (c, rows + k))).collect(),
            };
            let targets: Vec<(DVec2, DVec2, f64)> = cells
                .into_iter()
                .map(|(column, row)| {
                    let place = lattice.centre(column, row);
                    let depth = normal.dot(place) - offset;
                    (place, place - 2.0 * depth * *normal, depth)
                })
                .collect();
            self.fit(points, lattice, &targets, door);
        }
    }

    /// Gives ghosts other images, where there are any.
    pub fn level(&mut self, levelled: Vec<Option<Levelled>>) {
        let mut images = Vec::with_capacity(self.images.len());
        let mut starts = vec![0];
        for (ghost, new) in levelled.into_iter().enumerate() {
            match new {
                None => images.extend_from_slice(&self.images[self.images_of(ghost)]),
                Some(new) => {
                    images.extend(new.images);
                    self.door[ghost] = new.door;
                    self.pays[ghost] = Some(new.pays);
                    self.depth[ghost] = new.depth;
                    self.model[ghost] = new.model;
                }
            }
            starts.push(images.len() as u32);
        }
        (self.images, self.starts) = (images, starts);
    }

    /// Adds a ghost at a place behind a door that holds the wall's own value, in place of the particle `model` of `count`.
    pub fn hold(&mut self, count: usize, model: u32, place: DVec2, door: u8) {
        let number = (count + self.position.len()) as u32;
        self.position.push(place);
        self.door.push(Some(door));
        self.pays.push(Some(door));
        self.depth.push(0.0);
        self.model.push(model);
        self.identity.push(number);
        self.stream.push(0);
        self.images.push((model, 1.0));
        self.starts.push(self.images.len() as u32);
    }

    /// Adds ghosts at `targets` (place, image, depth) with images fitted to nearby particles.
    fn fit(&mut self, points: &[DVec2], lattice: &Lattice, targets: &[(DVec2, DVec2, f64)], door: usize) {
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
            let number = (points.len() + self.position.len()) as u32;
            self.images.extend(found.iter().zip(weights).map(|(j, weight)| (*j as u32, weight)));
            self.position.push(*place);
            self.door.push(Some(door as u8));
            self.pays.push(Some(door as u8));
            self.depth.push(*depth);
            self.model.push(first as u32);
            self.identity.push(number);
            self.stream.push(0);
            self.starts.push(self.images.len() as u32);
        }
    }

    /// For each ghost that mirrors one particle, directly or through another ghost: the particle, and the factor
    /// with which the ghost follows it.
    pub fn mirrored(&self, count: usize, faces: &[Face]) -> Vec<Option<(u32, f64)>> {
        let mut mirrored: Vec<Option<(u32, f64)>> = Vec::with_capacity(self.len());
        for ghost in 0..self.len() {
            let sign = -self.door[ghost].map_or(-1.0, |door| faces[door as usize].stiffness());
            let images = &self.images[self.starts[ghost] as usize..self.starts[ghost + 1] as usize];
            mirrored.push(match images {
                [(image, 1.0)] => match (*image as usize).checked_sub(count) {
                    None => Some((*image, sign)),
                    Some(parent) => mirrored[parent].map(|(particle, factor)| (particle, sign * factor)),
                },
                _ => None,
            });
        }
        mirrored
    }

    /// What a ghost mirrors, a particle or an earlier ghost (counted after `count` particles), if it mirrors one alone.
    pub fn original(&self, ghost: usize) -> Option<u32> {
        match &self.images[self.images_of(ghost)] {
            [(original, 1.0)] => Some(*original),
            _ => None,
        }
    }

    /// Number of ghosts.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// How strongly a fitted ghost falls when a particle rises, by the particle's share in the fit.
    pub fn own_share(&self, ghost: usize, particle: u32, faces: &[Face]) -> f64 {
        let stiffness = self.door[ghost].map_or(-1.0, |door| faces[door as usize].stiffness());
        let images = &self.images[self.starts[ghost] as usize..self.starts[ghost + 1] as usize];
        stiffness * images.iter().filter(|image| image.0 == particle).map(|image| image.1).sum::<f64>()
    }

    /// Fills the potentials of ghosts, behind those of the particles.
    pub fn fill_potentials(&self, potentials: &mut [f64], faces: &[Vec<Face>], materials: &Materials, chains: &Chains) {
        let count = potentials.len() - self.len();
        for ghost in 0..self.len() {
            let (image, depth) = (self.image(ghost, potentials), self.depth[ghost]);
            potentials[count + ghost] = match self.door[ghost] {
                None => image,
                Some(door) => {
                    let material = self.material(ghost, materials);
                    let (thermal, face) = (&materials.thermals[material], &faces[material][door as usize]);
                    match chains.of_ghost(ghost, &materials.thermals) {
                        None => face.ghost(image, depth, &thermal.curve, thermal.initial_potential),
                        Some(way) => {
                            let (wall, flux) = way.wall(face, depth, image);
                            wall + depth * flux
                        }
                    }
                }
            };
        }
    }

    /// How each ghost follows its image, from the potentials of particles and ghosts.
    pub fn slopes(
        &self,
        potentials: &[f64],
        faces: &[Vec<Face>],
        materials: &Materials,
        chains: &Chains,
        slopes: &mut Vec<f64>,
    ) {
        slopes.clear();
        slopes.extend((0..self.len()).map(|ghost| match self.door[ghost] {
            None => 1.0,
            Some(door) => {
                let (image, depth) = (self.image(ghost, potentials), self.depth[ghost]);
                let material = self.material(ghost, materials);
                let (thermal, face) = (&materials.thermals[material], &faces[material][door as usize]);
                match chains.of_ghost(ghost, &materials.thermals) {
                    None => face.ghost_slope(image, depth, &thermal.curve, thermal.initial_potential),
                    Some(way) => {
                        let (wall, flux) = way.wall_slopes(face, depth, image);
                        wall + depth * flux
                    }
                }
            }
        }));
    }

    /// Fills small changes of the potentials of ghosts, behind those of the particles.
    pub fn fill_changes(&self, changes: &mut [f64], slopes: &[f64]) {
        let count = changes.len() - self.len();
        for (ghost, slope) in slopes.iter().enumerate() {
            changes[count + ghost] = slope * self.image(ghost, changes);
        }
    }

    /// Particles that the image of a ghost is made of, directly or through other ghosts.
    pub fn makers(&self, ghost: usize, count: usize) -> Vec<u32> {
        let images = &self.images[self.starts[ghost] as usize..self.starts[ghost + 1] as usize];
        let maker = |index: u32| match (index as usize).checked_sub(count) {
            None => vec![index],
            Some(parent) => self.makers(parent, count),
        };
        images.iter().flat_map(|image| maker(image.0)).collect()
    }

    /// Whether every ghost is the mirror image of one particle or ghost.
    pub fn all_mirrored(&self) -> bool {
        self.images.len() == self.len()
    }

    /// Fills the temperatures and conductivities of ghosts, behind those of the particles.
    pub fn fill_temperatures(
        &self,
        temperatures: &mut [f64],
        conductivities: &mut [f64],
        faces: &[Vec<Face>],
        materials: &Materials,
    ) {
        let count = temperatures.len() - self.len();
        for ghost in 0..self.len() {
            let image = self.image(ghost, temperatures);
            let carried = conductivities[self.model[ghost] as usize];
            let material = self.material(ghost, materials);
            let curve = &materials.thermals[material].curve;
            let (temperature, conductivity) = match self.door[ghost].map(|door| faces[material][door as usize]) {
                // A mirror conducts as what it mirrors, be that a ghost itself.
                None | Some(Face::Even) => match &self.images[self.images_of(ghost)] {
                    [(own, 1.0)] => (image, conductivities[*own as usize]),
                    _ => (image, carried),
                },
                Some(Face::Odd { temperature, .. }) => {
                    let ghost = 2.0 * temperature - image;
                    (ghost, curve.conductivity(ghost))
                }
                Some(Face::Held { temperature, .. }) => (temperature, curve.conductivity(temperature)),
                Some(Face::Flux(flux)) => (image + 2.0 * self.depth[ghost] * flux / carried, carried),
                Some(Face::Film { coefficient, ambient, through }) => {
                    let film = coefficient * self.depth[ghost] / carried;
                    (image + 2.0 * film / (1.0 + through * film) * (ambient - image), carried)
                }
            };
            temperatures[count + ghost] = temperature;
            conductivities[count + ghost] = conductivity;
        }
    }

    #[inline]
    fn images_of(&self, ghost: usize) -> std::ops::Range<usize> {
        self.starts[ghost] as usize..self.starts[ghost + 1] as usize
    }

    #[inline]
    fn image(&self, ghost: usize, values: &[f64]) -> f64 {
        self.images[self.images_of(ghost)].iter().map(|(index, weight)| weight * values[*index as usize]).sum()
    }

    /// Material of a ghost.
    #[inline]
    pub fn material(&self, ghost: usize, materials: &Materials) -> usize {
        match self.material.get(ghost) {
            Some(material) => *material as usize,
            None => materials.index(self.model[ghost] as usize),
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
