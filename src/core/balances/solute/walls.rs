//! Walls as a solute meets them.

use crate::balances::solute::Entering;
use crate::balances::solute::image::{Image, Kind};
use crate::boundary::ghosts::Ghosts;
use crate::kernels::crossing::Portion;
use crate::kernels::list_parts::ListParts;
use crate::memory::HeapSize;
use crate::series::Series;

/// A pair with a ghost behind an open wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mouth {
    /// The particle, and the pair's place in the list.
    pub particle: u32,
    pub pair: usize,
    /// The partner, and how it follows what it mirrors.
    pub partner: u32,
    pub image: Image,
    /// The wall that water comes in through.
    pub patch: u8,
    /// The ghost that the partner is an image of, and the wall that what goes as far as there passes, in corners.
    corner: Option<(u32, u8)>,
    /// Water that the particle gains (1/s by volume), and the exchange with the wall that comes with it (1/s).
    pub flow: f64,
    pub exchange: f64,
    /// What diffusion exchanges through it (1/s).
    pub conductance: f64,
}

/// What goes through a mouth.
pub(super) struct Passing {
    /// Into the particle as far as the ghost that the partner is an image of, in corners (1/s).
    pub near: f64,
    /// The rest (1/s).
    pub far: f64,
}

/// Walls, their concentrations, and the pairs across them.
#[derive(Debug, Clone)]
pub(super) struct Walls {
    series: Vec<Option<Series>>,
    /// Whether walls hold their concentrations, by patch.
    pub held: Vec<bool>,
    layers: Vec<bool>,
    /// Concentrations now, by patch.
    pub values: Vec<Option<f64>>,
    pub mouths: Vec<Mouth>,
}

impl Walls {
    /// The walls of a list with their concentrations, and what its ghosts are.
    pub(super) fn new(list: &ListParts, entering: Vec<Option<Entering>>, held: Vec<bool>, images: &[Image]) -> Self {
        let series: Vec<Option<Series>> = entering.into_iter().map(|own| own.map(|own| own.concentration)).collect();
        let (count, pairs) = (list.positions.len(), &list.pairs);
        let mut mouths = Vec::new();
        for i in 0..count {
            for k in pairs.starts[i]..pairs.starts[i + 1] {
                let partner = pairs.partners[k];
                let Some(ghost) = (partner as usize).checked_sub(count) else { continue };
                let mut portions = Portion::of(list, i, k, ghost).into_iter();
                let corner = |(portion, patch)| match portion {
                    Portion::UpTo(image) => Some((image, patch)),
                    Portion::All | Portion::From(_) => None,
                };
                let Some(first) = portions.next() else { continue };
                let (_, patch) = portions.next().unwrap_or(first);
                let (particle, image, corner) = (i as u32, images[ghost], corner(first));
                mouths.push(Mouth {
                    particle,
                    pair: k,
                    partner,
                    image,
                    patch,
                    corner,
                    flow: 0.0,
                    exchange: 0.0,
                    conductance: 0.0,
                });
            }
        }
        let layers = list.boundary.patches.iter().map(|patch| patch.layers).collect();
        let values = series.iter().map(|series| series.as_ref().map(|series| series.at(0.0))).collect();
        Walls { series, held, layers, values, mouths }
    }

    /// Brings the walls to a time (s).
    pub(super) fn bring_to(&mut self, time: f64) {
        for (value, series) in self.values.iter_mut().zip(&self.series) {
            *value = series.as_ref().map(|series| series.at(time));
        }
    }

    /// Fills the concentrations of ghosts, behind those of the particles.
    pub(super) fn fill(&self, ghosts: &Ghosts, concentrations: &mut [f64]) {
        ghosts.fill(concentrations, |ghost, image| match self.of(ghosts, ghost) {
            None => image,
            Some((wall, true)) => wall,
            Some((wall, false)) => 2.0 * wall - image,
        });
    }

    /// Fills small changes of the concentrations of ghosts, behind those of the particles.
    pub(super) fn fill_changes(&self, ghosts: &Ghosts, changes: &mut [f64]) {
        ghosts.fill(changes, |ghost, image| match self.of(ghosts, ghost) {
            None => image,
            Some((_, true)) => 0.0,
            Some((_, false)) => -image,
        });
    }

    /// The concentration of the wall that a ghost stands behind, and whether the ghost holds it.
    fn of(&self, ghosts: &Ghosts, ghost: usize) -> Option<(f64, bool)> {
        let patch = ghosts.patch[ghost].filter(|patch| self.held[*patch as usize])? as usize;
        Some((self.values[patch]?, self.layers[patch]))
    }

    /// What water brings through a wall: nothing, where only water crosses it.
    pub(super) fn brought(&self, mouth: &Mouth) -> f64 {
        self.values[mouth.patch as usize].unwrap_or(0.0)
    }

    /// What a mouth gives its particle, by the rate (1/s) with which that follows the partner.
    pub(super) fn passing(&self, mouth: &Mouth, concentrations: &[f64], factor: f64) -> Passing {
        let own = concentrations[mouth.particle as usize];
        let partner = concentrations[mouth.partner as usize];
        let near = mouth.corner.map_or(0.0, |(image, _)| factor * (concentrations[image as usize] - own));
        let carried = mouth.flow * own + mouth.exchange * (self.brought(mouth) - own);
        Passing { near, far: factor * (partner - own) - near + carried }
    }

    /// Books what passes a mouth.
    pub(super) fn book(mouth: &Mouth, passing: &Passing, volume: f64, mut book: impl FnMut(usize, f64)) {
        if let Some((_, patch)) = mouth.corner {
            book(patch as usize, passing.near * volume);
        }
        book(mouth.patch as usize, passing.far * volume);
    }

    /// How strongly a mouth lets its particle fall beside what it would without a mirror (1/s), by its conductance (1/s).
    pub(super) fn mirrored(mouth: &Mouth, conductance: f64) -> f64 {
        match mouth.image.kind {
            Kind::Odd if mouth.image.original == mouth.particle => conductance,
            Kind::Fitted => conductance,
            Kind::Inner | Kind::Odd | Kind::Layer | Kind::Open => 0.0,
        }
    }
}

impl HeapSize for Walls {
    fn heap_size(&self) -> usize {
        let series = self.series.capacity() * size_of::<Option<Series>>();
        let values = self.values.capacity() * size_of::<Option<f64>>();
        series + values + self.mouths.capacity() * size_of::<Mouth>() + self.layers.heap_size() + self.held.heap_size()
    }
}
