//! Which rows of a lattice the stencil does not know: those whose pairs interfaces, cracks or a shaft cut, and those at
//! walls near them.

use frazil_core::boundary::patch::{Boundary, Side};
use frazil_core::breakage::crack::Crack;
use frazil_core::space::lattice::Lattice;
use frazil_core::space::segment::distance;
use frazil_scene::region::Cell;
use frazil_scene::{Scene, Shape};
use glam::DVec2;

use crate::interface::Ground;
use crate::plan::prepared::Prepared;

/// Cells along the edge of a block that is looked at as a whole, before its particles are.
const BLOCK: usize = 16;

/// Part of the reach by which rounding may widen it.
const ROUNDING: f64 = 1e-9;

/// Part of the spacing by which neighbourhoods are widened that must hold one material: interfaces may run through the places
/// of the farthest neighbours.
const MARGIN: f64 = 0.01;

/// Particles of a lattice with rows of their own.
pub(super) struct Selection {
    /// Numbers on the lattice: first those with rows, in order, then those that they see.
    pub(super) particles: Vec<u32>,
    /// How many have rows.
    pub(super) rows: usize,
    /// Whether pairs of a particle pass interfaces, or are ever cut; empty where none are.
    pub(super) cut: Vec<bool>,
    /// The walls that the sweep sees: those that these rows are at are mirrors to it.
    pub(super) swept: Boundary,
}

/// Where pairs of a lattice reach.
struct Reach<'a> {
    lattice: &'a Lattice,
    boundary: &'a Boundary,
    cells: usize,
    /// Longest pair (m).
    length: f64,
}

/// The rows that interfaces, cracks or a shaft make irregular; none if all are alike.
pub(super) fn select(scene: &Scene, prepared: &Prepared) -> Option<Selection> {
    let reach = Reach::new(prepared);
    let (lattice, boundary) = (reach.lattice, reach.boundary);
    let mut cut = vec![false; lattice.len()];
    if prepared.materials.mixed() {
        let ground = Ground::new(scene, lattice, boundary);
        reach.mark_interfaces(&ground, &mut cut);
    }
    // What is left of the pairs of a particle that a barrier cuts is stronger, in the rows of its neighbours too.
    let twice = 2.0 * reach.length;
    let near_crack = |place: DVec2, crack: &Crack| distance((crack.from, crack.to), place) <= twice;
    let near_shape = |place: DVec2, shape: &Shape| shape.share_of(&Cell::around(place, 2.0 * twice)) > 0.0;
    let near_face = |place: DVec2| boundary.dug.is_some_and(|dug| (place.length() - dug.radius).abs() <= reach.length);
    if scene.has_barriers() || boundary.dug.is_some() {
        for (mark, place) in cut.iter_mut().zip(lattice.positions()) {
            *mark |= near_face(place)
                || scene.cracks.iter().any(|crack| near_crack(place, crack))
                || scene.impermeable.iter().any(|shape| near_shape(place, shape));
        }
    }
    if !cut.contains(&true) {
        return None;
    }
    let mut listed = cut.clone();
    let swept = reach.list_walls(&mut listed);
    Some(Selection { cut, swept, ..reach.selection(&listed) })
}

/// Rows from which pairs reach over the surfaces of a scene.
pub(super) fn at_surfaces(scene: &Scene, prepared: &Prepared) -> Selection {
    let reach = Reach::new(prepared);
    let near = |place: DVec2| {
        scene.watch.surfaces.iter().any(|surface| {
            let across = if surface.across_y { place.y } else { place.x };
            (across - surface.at).abs() <= reach.length
        })
    };
    reach.selection(&reach.lattice.positions().into_iter().map(near).collect::<Vec<bool>>())
}

impl<'a> Reach<'a> {
    fn new(prepared: &'a Prepared) -> Self {
        let stencil = &prepared.stencil;
        let square = if stencil.fits_disc() { 1.0 } else { std::f64::consts::SQRT_2 };
        let length = stencil.reach as f64 * prepared.lattice.spacing * square * (1.0 + ROUNDING);
        Reach { lattice: &prepared.lattice, boundary: &prepared.boundary, cells: stencil.reach, length }
    }

    /// Marks particles in whose neighbourhood there is more than one material.
    fn mark_interfaces(&self, ground: &Ground<'_>, marks: &mut [bool]) {
        let Lattice { rows, columns, spacing, .. } = *self.lattice;
        let reach = self.length + MARGIN * spacing;
        let half = 0.5 * BLOCK as f64 * spacing + reach;
        for block_row in (0..rows).step_by(BLOCK) {
            for block_column in (0..columns).step_by(BLOCK) {
                let low = self.lattice.centre(block_column as i64, block_row as i64);
                let middle = low + DVec2::splat(0.5 * (BLOCK - 1) as f64 * spacing);
                if ground.is_uniform(middle, half) {
                    continue;
                }
                for row in block_row..rows.min(block_row + BLOCK) {
                    for column in block_column..columns.min(block_column + BLOCK) {
                        if let Some(index) = self.lattice.index(column as i64, row as i64) {
                            let place = self.lattice.centre(column as i64, row as i64);
                            marks[index] = !ground.is_uniform(place, reach);
                        }
                    }
                }
            }
        }
    }

    /// Marks all particles at walls that heat passes and that marked ones are near: a list or the sweep makes what a wall
    /// does, not both. Gives the walls that are left to the sweep.
    fn list_walls(&self, marks: &mut [bool]) -> Boundary {
        let mut swept = self.boundary.clone();
        let opens = |side: usize| match self.boundary.sides[side] {
            Side::Wall(patch) => self.boundary.patches[patch].lets_heat_through(),
            Side::Mirror | Side::Periodic | Side::Curved => false,
        };
        let mut open: Vec<Wall> = (0..4).filter(|side| opens(*side)).map(Wall::Straight).collect();
        open.extend(self.boundary.curved.map(|(_, radius)| Wall::Curved(radius)));
        while let Some(place) = open.iter().position(|wall| self.beside(*wall).any(|index| marks[index])) {
            let wall = open.swap_remove(place);
            self.beside(wall).for_each(|index| marks[index] = true);
            match wall {
                Wall::Straight(side) => swept.sides[side] = Side::Mirror,
                Wall::Curved(_) => swept.curved = None,
            }
        }
        swept
    }

    /// Particles whose pairs reach over a wall.
    fn beside(&self, wall: Wall) -> impl Iterator<Item = usize> + '_ {
        let Lattice { rows, columns, .. } = *self.lattice;
        (0..self.lattice.len()).filter(move |index| match wall {
            Wall::Curved(radius) => radius - self.lattice.position(*index).length() <= self.length,
            Wall::Straight(side) => {
                let (column, row) = self.lattice.cell(*index);
                let (column, row) = (column as usize, row as usize);
                [column, columns - 1 - column, row, rows - 1 - row][side] < self.cells
            }
        })
    }

    /// The cell of the body for one that may lie behind walls at which it repeats.
    fn repeated(&self, column: i64, row: i64) -> (i64, i64) {
        let [along_x, along_y] = self.boundary.repeats();
        (
            if along_x { column.rem_euclid(self.lattice.columns as i64) } else { column },
            if along_y { row.rem_euclid(self.lattice.rows as i64) } else { row },
        )
    }

    /// The particles that are marked, and those within their reach.
    fn selection(&self, marks: &[bool]) -> Selection {
        let own: Vec<u32> = (0..marks.len() as u32).filter(|index| marks[*index as usize]).collect();
        let mut seen = vec![false; marks.len()];
        let cells = self.cells as i64;
        let up = if self.lattice.dimension == 1 { 0 } else { cells };
        for index in &own {
            let (column, row) = self.lattice.cell(*index as usize);
            for (dx, dy) in (-up..=up).flat_map(|dy| (-cells..=cells).map(move |dx| (dx, dy))) {
                let (column, row) = self.repeated(column + dx, row + dy);
                if let Some(other) = self.lattice.index(column, row) {
                    seen[other] = true;
                }
            }
        }
        let others = (0..marks.len() as u32).filter(|index| seen[*index as usize] && !marks[*index as usize]);
        let rows = own.len();
        let swept = self.boundary.clone();
        Selection { particles: own.into_iter().chain(others).collect(), rows, cut: Vec::new(), swept }
    }
}

/// A wall that heat passes.
#[derive(Clone, Copy)]
enum Wall {
    /// By its side.
    Straight(usize),
    /// By its radius (m).
    Curved(f64),
}
