//! What ghosts are to a solute.

use glam::{BVec2, DVec2};

use crate::boundary::patch::Face;
use crate::kernels::list_parts::ListParts;

/// How a ghost follows what it mirrors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// It is what it mirrors, and what goes to it goes to that.
    Inner,
    /// It mirrors through an open wall of given concentration.
    Odd,
    /// It holds the concentration of a wall.
    Layer,
    /// It stands behind a wall that only water crosses, or behind two open walls, whose concentrations cancel.
    Open,
    /// It follows several particles, by moving least squares.
    Fitted,
}

/// A ghost as pairs with it see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Image {
    /// The particle that it mirrors, or one near its image.
    pub original: u32,
    /// How it follows that.
    pub kind: Kind,
    /// Axes along which its directions are the other way round.
    flipped: BVec2,
}

impl Image {
    /// All ghosts of a list, for walls that hold concentrations or not.
    pub(super) fn all(list: &ListParts, held: &[bool]) -> Vec<Image> {
        let count = list.positions.len();
        let faces: Vec<Face> = held
            .iter()
            .zip(&list.boundary.patches)
            .map(|(held, patch)| match (held, patch.layers) {
                (false, _) => Face::Even,
                (true, false) => Face::Odd { wall: 0.0, temperature: 0.0 },
                (true, true) => Face::Held { wall: 0.0, temperature: 0.0 },
            })
            .collect();
        let kind = |ghost: usize, factor: f64| match list.ghosts.pays[ghost] {
            None => Kind::Inner,
            Some(patch) if held[patch as usize] && factor < 0.0 => Kind::Odd,
            Some(patch) if held[patch as usize] && factor == 0.0 => Kind::Layer,
            Some(_) => Kind::Open,
        };
        let image = |(ghost, mirrored): (usize, &Option<(u32, f64)>)| match *mirrored {
            None => Image { original: list.ghosts.model[ghost], kind: Kind::Fitted, flipped: BVec2::FALSE },
            Some((original, factor)) => {
                let far = (list.ghosts.position[ghost] - list.positions[original as usize]).abs();
                let flipped = far.cmpgt(DVec2::splat(1e-9 * list.spacing));
                Image { original, kind: kind(ghost, factor), flipped }
            }
        };
        list.ghosts.mirrored(count, &faces).iter().enumerate().map(image).collect()
    }

    /// A direction or velocity behind the mirrors, or in front of them.
    pub(super) fn mirror(&self, vector: DVec2) -> DVec2 {
        DVec2::select(self.flipped, -vector, vector)
    }
}
