//! Ghost particles around a cloud: mirrors of particles at straight walls, or moving least squares.

mod build;
pub mod passing;

use glam::DVec2;

use crate::boundary::interface::Chains;
use crate::boundary::patch::Face;
use crate::memory::{HeapSize, total};
use crate::physics::latent_heat::Materials;
use crate::space::lattice::Lattice;

/// Ghosts, numbered after the particles; each depends only on particles and earlier ghosts.
#[derive(Debug, Clone, Default)]
pub struct Ghosts {
    /// Position (m).
    pub position: Vec<DVec2>,
    /// Wall that the ghost stands behind, or none for a mirror plane of the domain.
    pub patch: Vec<Option<u8>>,
    /// Patch through which heat to the ghost goes: its own, or for mirrors of ghosts their image's.
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
    /// Share of the ghost's pairs that counts; empty where all do.
    share: Vec<f64>,
    starts: Vec<u32>,
    images: Vec<(u32, f64)>,
}

/// By what the number that tells images of one particle apart grows with each mirror, the last one in its remainder.
const SIDES: u32 = 5;

/// A side of the box around a body: its number, the normal out of the body and how far along it the side lies (m).
type BoxSide = (usize, DVec2, f64);

/// Left, right, bottom, top.
fn box_sides(lattice: &Lattice) -> [BoxSide; 4] {
    let (corner, far) = (lattice.corner, lattice.far());
    [(0, DVec2::NEG_X, -corner.x), (1, DVec2::X, far.x), (2, DVec2::NEG_Y, -corner.y), (3, DVec2::Y, far.y)]
}

/// What a ghost becomes in a layer of one value.
pub struct Levelled {
    /// Wall by whose condition it follows its images, or none where it is as they are.
    pub patch: Option<u8>,
    /// Patch through which heat to it goes.
    pub pays: u8,
    /// Particles, or an earlier ghost, with their shares.
    pub images: Vec<(u32, f64)>,
    /// Half of the distance over which it follows them (m).
    pub depth: f64,
    /// The particle whose material it has.
    pub model: u32,
}

impl HeapSize for Ghosts {
    fn heap_size(&self) -> usize {
        // Patches are a byte and whether there is one.
        let patches = (self.patch.capacity() + self.pays.capacity()) * size_of::<Option<u8>>();
        let names = total(&[&self.material, &self.model, &self.identity, &self.stream, &self.starts]);
        patches + names + total(&[&self.position, &self.depth, &self.share, &self.images])
    }
}

impl Ghosts {
    /// No ghosts.
    pub fn none() -> Self {
        Ghosts { starts: vec![0], ..Ghosts::default() }
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
                    self.patch[ghost] = new.patch;
                    self.pays[ghost] = Some(new.pays);
                    self.depth[ghost] = new.depth;
                    self.model[ghost] = new.model;
                }
            }
            starts.push(images.len() as u32);
        }
        (self.images, self.starts) = (images, starts);
    }

    /// Takes ground that conducts across its walls by these factors, along x and y: there a flux has as much less to go through.
    pub fn conduct(&mut self, along: DVec2) {
        if along == DVec2::ONE {
            return;
        }
        for ghost in 0..self.len() {
            if let Some(side) = self.side(ghost) {
                self.depth[ghost] /= along[side / 2];
            }
        }
    }

    /// Adds a ghost at a place behind a patch that holds the wall's own value, in place of the particle `model` of `count`.
    pub fn hold(&mut self, count: usize, model: u32, place: DVec2, patch: u8) {
        let number = (count + self.position.len()) as u32;
        self.position.push(place);
        self.patch.push(Some(patch));
        self.pays.push(Some(patch));
        self.depth.push(0.0);
        self.model.push(model);
        self.identity.push(number);
        self.stream.push(0);
        self.images.push((model, 1.0));
        self.starts.push(self.images.len() as u32);
    }

    /// For each ghost that mirrors one particle, directly or through another ghost: the particle, and the factor
    /// with which the ghost follows it.
    pub fn mirrored(&self, count: usize, faces: &[Face]) -> Vec<Option<(u32, f64)>> {
        let mut mirrored: Vec<Option<(u32, f64)>> = Vec::with_capacity(self.len());
        for ghost in 0..self.len() {
            let sign = -self.patch[ghost].map_or(-1.0, |patch| faces[patch as usize].stiffness());
            mirrored.push(match &self.images[self.images_of(ghost)] {
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

    /// The side that a ghost of one mirror stands behind: left, right, bottom, top.
    fn side(&self, ghost: usize) -> Option<usize> {
        (self.stream[ghost] % SIDES).checked_sub(1).map(|side| side as usize)
    }

    /// Share of the ghost's pairs that counts: ghosts of two mirrors that stand in one place count half each.
    #[inline]
    pub fn share(&self, ghost: usize) -> f64 {
        self.share.get(ghost).copied().unwrap_or(1.0)
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
        let stiffness = self.patch[ghost].map_or(-1.0, |patch| faces[patch as usize].stiffness());
        let images = self.images[self.images_of(ghost)].iter().filter(|image| image.0 == particle);
        stiffness * images.map(|image| image.1).sum::<f64>()
    }

    /// Fills the potentials of ghosts, behind those of the particles.
    pub fn fill_potentials(&self, potentials: &mut [f64], faces: &[Vec<Face>], materials: &Materials, chains: &Chains) {
        let count = potentials.len() - self.len();
        for ghost in 0..self.len() {
            let (image, depth) = (self.image(ghost, potentials), self.depth[ghost]);
            potentials[count + ghost] = match self.patch[ghost] {
                None => image,
                Some(patch) => {
                    let material = self.material(ghost, materials);
                    let (thermal, face) = (&materials.thermals[material], &faces[material][patch as usize]);
                    match chains.of_ghost(ghost, &materials.thermals) {
                        None => face.ghost(image, depth, &thermal.curve, thermal.zero_potential),
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
        slopes.extend((0..self.len()).map(|ghost| match self.patch[ghost] {
            None => 1.0,
            Some(patch) => {
                let (image, depth) = (self.image(ghost, potentials), self.depth[ghost]);
                let material = self.material(ghost, materials);
                let (thermal, face) = (&materials.thermals[material], &faces[material][patch as usize]);
                match chains.of_ghost(ghost, &materials.thermals) {
                    None => face.ghost_slope(image, depth, &thermal.curve, thermal.zero_potential),
                    Some(way) => {
                        let (wall, flux) = way.wall_slopes(face, depth, image);
                        wall + depth * flux
                    }
                }
            }
        }));
    }

    /// How the temperature of each ghost follows that of its image, by temperatures and conductivities (W/mK).
    pub fn temperature_slopes(
        &self,
        temperatures: &[f64],
        conductivities: &[f64],
        faces: &[Vec<Face>],
        materials: &Materials,
        slopes: &mut Vec<f64>,
    ) {
        slopes.clear();
        slopes.extend((0..self.len()).map(|ghost| {
            let material = self.material(ghost, materials);
            match self.patch[ghost].map(|patch| faces[material][patch as usize]) {
                None | Some(Face::Even | Face::Flux(_)) => 1.0,
                Some(Face::Odd { .. }) => -1.0,
                Some(Face::Held { .. }) => 0.0,
                Some(Face::Film { film, through }) => {
                    let (image, depth) = (self.image(ghost, temperatures), self.depth[ghost]);
                    let carried = conductivities[self.model[ghost] as usize];
                    let share = film.coefficient_before(image, carried, through * depth) * depth / carried;
                    1.0 - 2.0 * share / (1.0 + through * share)
                }
                Some(Face::Runoff(runoff)) => {
                    let (image, depth) = (self.image(ghost, temperatures), runoff.through * self.depth[ghost]);
                    let carried = conductivities[self.model[ghost] as usize];
                    let full = runoff.is_full(image, carried, depth, &materials.thermals[material].curve);
                    if full { 1.0 - 2.0 / runoff.through } else { 1.0 }
                }
            }
        }));
    }

    /// Fills the values of ghosts, behind those of the particles, by their numbers and the values of their images.
    pub fn fill(&self, values: &mut [f64], mut value: impl FnMut(usize, f64) -> f64) {
        let count = values.len() - self.len();
        for ghost in 0..self.len() {
            values[count + ghost] = value(ghost, self.image(ghost, values));
        }
    }

    /// Fills small changes of the potentials of ghosts, behind those of the particles.
    pub fn fill_changes(&self, changes: &mut [f64], slopes: &[f64]) {
        self.fill(changes, |ghost, image| slopes[ghost] * image);
    }

    /// Particles that the image of a ghost is made of, directly or through other ghosts.
    pub fn makers(&self, ghost: usize, count: usize) -> Vec<u32> {
        let maker = |index: u32| match (index as usize).checked_sub(count) {
            None => vec![index],
            Some(parent) => self.makers(parent, count),
        };
        self.images[self.images_of(ghost)].iter().flat_map(|image| maker(image.0)).collect()
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
            let (temperature, conductivity) = match self.patch[ghost].map(|patch| faces[material][patch as usize]) {
                // A mirror conducts as what it mirrors, be that a ghost itself.
                None | Some(Face::Even) => match &self.images[self.images_of(ghost)] {
                    [(own, 1.0)] => (image, conductivities[*own as usize]),
                    _ => (image, carried),
                },
                Some(Face::Odd { temperature, .. }) => {
                    let ghost = 2.0 * curve.driver(temperature) - image;
                    (ghost, curve.driven_conductivity(ghost))
                }
                Some(Face::Held { temperature, .. }) => {
                    let driver = curve.driver(temperature);
                    (driver, curve.driven_conductivity(driver))
                }
                Some(Face::Flux(flux)) => (image + 2.0 * self.depth[ghost] * flux / carried, carried),
                Some(Face::Film { film, through }) => {
                    let coefficient = film.coefficient_before(image, carried, through * self.depth[ghost]);
                    let share = coefficient * self.depth[ghost] / carried;
                    (image + 2.0 * share / (1.0 + through * share) * (film.ambient - image), carried)
                }
                Some(Face::Runoff(runoff)) => {
                    let depth = self.depth[ghost];
                    let flux = runoff.flux_by_head(image, carried, runoff.through * depth, curve);
                    (image + 2.0 * depth * flux / carried, carried)
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
