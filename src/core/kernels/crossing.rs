//! What of the heat of pairs passes walls and surfaces.

use crate::kernels::list_parts::ListParts;
use crate::memory::HeapSize;
use crate::space::domain::Surface;
use crate::space::wall::WallId;

/// What of a pair's heat goes a way: in corners a ghost is the image of another one, and the heat to that passes the
/// other's wall.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Portion {
    All,
    /// As far as the ghost that the partner is an image of.
    UpTo(u32),
    /// From there on.
    From(u32),
}

/// A pair of which something passes a patch or a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub(super) particle: u32,
    /// Position in the list.
    pub(super) pair: usize,
    pub(super) portion: Portion,
}

impl HeapSize for Crossing {
    fn heap_size(&self) -> usize {
        0
    }
}

impl Portion {
    /// The portions of a pair of particle `i` with a ghost, each with the patch that it passes.
    pub(crate) fn of(parts: &ListParts, i: usize, k: usize, ghost: usize) -> Vec<(Portion, u8)> {
        let (count, ghosts, materials) = (parts.positions.len(), &parts.ghosts, &parts.materials);
        let Some(patch) = ghosts.pays[ghost] else { return Vec::new() };
        let corner = ghosts.original(ghost).filter(|_| ghosts.share(ghost) < 1.0).and_then(|image| {
            let parent = (image as usize).checked_sub(count)?;
            let first = ghosts.pays[parent].filter(|first| *first != patch)?;
            // Potentials of other materials say nothing of this pair.
            let alike = materials.index(i) == ghosts.material(parent, materials);
            let plain = parts.chains.of_pair(k, &materials.thermals).is_none();
            (alike && plain).then_some((image, first))
        });
        match corner {
            None => vec![(Portion::All, patch)],
            Some((image, first)) => vec![(Portion::UpTo(image), first), (Portion::From(image), patch)],
        }
    }
}

/// Pairs across a surface, each once: those of particles beyond it with partners before it. A ghost is a partner like any
/// other where it mirrors through closed walls. What an open wall brings passes the surface where the wall faces it, from
/// whichever side the ghost's own particle is on, and does not where the wall meets it.
pub(super) fn pairs_across(parts: &ListParts, surface: &Surface) -> Vec<(Crossing, f64)> {
    let count = parts.positions.len();
    let beyond = |j: usize| {
        let place = j.checked_sub(count).map_or_else(|| parts.positions[j], |ghost| parts.ghosts.position[ghost]);
        surface.is_beyond(place)
    };
    let faces = |patch: u8| {
        let wall = parts.boundary.patches[patch as usize].id.wall();
        wall.is_some_and(WallId::is_across_y) == surface.across_y
    };
    let mut found = Vec::new();
    for i in 0..count {
        for k in parts.pairs.starts[i]..parts.pairs.starts[i + 1] {
            let j = parts.pairs.partners[k] as usize;
            let portions = j.checked_sub(count).map_or_else(Vec::new, |ghost| Portion::of(parts, i, k, ghost));
            let crossing = |portion: Portion| Crossing { particle: i as u32, pair: k, portion };
            match (beyond(i), beyond(j), portions.is_empty()) {
                (true, false, true) => found.push((crossing(Portion::All), parts.volumes.of(i))),
                (own, other, false) if own != other => {
                    let volume = if own { parts.volumes.of(i) } else { -parts.volumes.of(i) };
                    let faced = portions.into_iter().filter(|(_, patch)| faces(*patch));
                    found.extend(faced.map(|(portion, _)| (crossing(portion), volume)));
                }
                _ => {}
            }
        }
    }
    found
}
