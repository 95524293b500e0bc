//! Ghosts and walls around a lattice, as the sweep sees them.

use std::sync::Arc;

use crate::bonds::stencil::Stencil;
use crate::boundary::patch::{Boundary, Face, Side};
use crate::boundary::pipe::Sink;
use crate::kernels::exterior::{Exterior, WallSlopes};
use crate::kernels::sweep::{Behind, EndWeights, Ends, Shape, Surroundings};
use crate::physics::latent_heat::Materials;
use crate::physics::laws::Laws;
use crate::physics::thermal::Thermal;
use crate::space::lattice::Lattice;
use crate::team::Team;

/// Ghosts and walls, as the sweep sees them.
pub(super) struct Around<L> {
    pub(super) lattice: Arc<Lattice>,
    pub(super) shape: Shape,
    pub(super) stencil: Stencil,
    pub(super) laws: L,
    pub(super) materials: Materials,
    /// The material at each patch, by index.
    pub(super) material_at: Vec<u8>,
    pub(super) sides: [Side; 4],
    pub(super) open: [bool; 4],
    /// Whether heat passes walls that meet in corners.
    pub(super) walls_meet: bool,
    pub(super) faces: Vec<Face>,
    /// Instead of faces, where potentials are small changes.
    pub(super) slopes: Option<WallSlopes>,
    pub(super) exterior: Option<Exterior>,
    /// Weight with which all particles of a row together reach the ghosts of a column wall: by row offset and layer, and
    /// last the sums over rows.
    pub(super) patch_weights: Vec<f64>,
    /// Weight with which a particle of a row reaches all ghosts of a column wall: by its distance from the wall.
    pub(super) patch_own: Vec<f64>,
    /// The ends of a line, where ghosts behind both are images.
    pub(super) ends: Option<Ends>,
}

/// [`Around::patch_weights`] and [`Around::patch_own`] of a stencil on rows of `columns` particles.
pub(super) fn patch_weights(stencil: &Stencil, shape: Shape, columns: usize) -> (Vec<f64>, Vec<f64>) {
    let (reach, rows) = (shape.reach, 2 * shape.reach_rows + 1);
    let cells = reach.min(columns);
    let mut weights = vec![0.0; rows * reach];
    let mut own = vec![0.0; cells];
    for row in 0..rows {
        for (cell, own) in own.iter_mut().enumerate() {
            for layer in 0..reach - cell {
                let weight = stencil.at(cell + layer + 1, row.abs_diff(shape.reach_rows));
                weights[row * reach + layer] += weight;
                *own += weight;
            }
        }
    }
    let all: Vec<f64> = (0..reach).map(|layer| weights.iter().skip(layer).step_by(reach).sum()).collect();
    weights.extend(all);
    (weights, own)
}

impl<L: Laws> Around<L> {
    #[inline(always)]
    pub(super) fn face(&self, side: usize) -> &Face {
        match self.sides[side] {
            Side::Wall(patch) => &self.faces[patch],
            Side::Mirror | Side::Periodic | Side::Curved => &Face::Even,
        }
    }

    /// Whether particles exchange heat with others that are far from them in order.
    pub(super) fn sees_far(&self) -> bool {
        self.exterior.is_some() || self.sides.contains(&Side::Periodic)
    }

    /// Brings the walls that change, or all, to a time (s).
    #[inline]
    pub(super) fn update_faces(&mut self, boundary: &Boundary, time: f64, all: bool) {
        for (patch, wall) in boundary.patches.iter().enumerate().filter(|(_, wall)| all || wall.changes) {
            let thermal = &self.materials.thermals[self.material_at[patch] as usize];
            self.faces[patch] = wall.face(time, &thermal.curve, thermal.zero_potential);
        }
        if all || self.ends.is_some() && boundary.patches.iter().any(|wall| wall.changes) {
            self.ends = self.find_ends();
        }
    }

    /// [`Around::ends`] by the faces of now.
    pub(super) fn find_ends(&self) -> Option<Ends> {
        let behind = |side: usize| match (self.sides[side], self.face(side)) {
            (Side::Curved | Side::Periodic, _) => None,
            (_, Face::Even) => Some(Behind { sign: 1.0, shift: 0.0 }),
            (_, Face::Odd { wall, .. }) => Some(Behind { sign: -1.0, shift: 2.0 * wall }),
            (_, Face::Held { wall, .. }) => Some(Behind { sign: 0.0, shift: *wall }),
            _ => None,
        };
        let behind = if self.lattice.dimension == 1 { [behind(0)?, behind(1)?] } else { return None };
        // Of its only row the first part is that of all rows.
        let first = |weights: &[f64]| std::array::from_fn(|k| weights.get(k).copied().unwrap_or(0.0));
        let weights = EndWeights { of_ghosts: first(&self.patch_weights), of_particles: first(&self.patch_own) };
        Some(Ends { behind, open: [self.open[0], self.open[1]], weights })
    }

    /// Brings a curved wall to a state, with threads if there are more than one.
    #[inline]
    pub(super) fn update_exterior(&mut self, team: Option<&Team>, boundary: &Boundary, enthalpy: &[f64]) {
        if let (Some(exterior), Some((patch, _))) = (&mut self.exterior, boundary.curved) {
            let thermal = &self.materials.thermals[self.material_at[patch] as usize];
            exterior.update(team, (&self.laws, enthalpy), &self.faces[patch], thermal, self.slopes.as_ref());
        }
    }

    /// The material at a pipe.
    pub(super) fn thermal_at_sink(&self, sink: &Sink) -> &Thermal {
        self.materials.of(sink.sample.first().map_or(0, |entry| entry.0 as usize))
    }

    /// A ghost of a straight wall, `layer` rows behind it at the padded `place` along it.
    #[inline(always)]
    pub(super) fn ghost(&self, side: usize, face: &Face, image: f64, place: usize, layer: usize) -> f64 {
        if let Some(slopes) = self.slopes.as_ref().filter(|_| face.bends()) {
            return slopes.by_side[side][place * self.shape.reach + layer] * image;
        }
        let thermal = self.thermal_at(side);
        let depth = self.depth(side, layer);
        face.ghost(image, depth, &thermal.curve, thermal.zero_potential)
    }

    /// Depth (m) of a ghost, over how well the ground conducts across its wall.
    #[inline(always)]
    pub(super) fn depth(&self, side: usize, layer: usize) -> f64 {
        (layer as f64 + 0.5) * self.lattice.spacing / self.stencil.along()[side / 2]
    }

    /// The material at a side.
    #[inline]
    pub(super) fn thermal_at(&self, side: usize) -> &Thermal {
        let material = if let Side::Wall(patch) = self.sides[side] { self.material_at[patch] } else { 0 };
        &self.materials.thermals[material as usize]
    }

    /// The material at a patch.
    #[inline]
    pub(super) fn thermal_of(&self, patch: usize) -> &Thermal {
        &self.materials.thermals[self.material_at[patch] as usize]
    }

    /// Potentials of any row, ghost rows included, from the enthalpies of all particles.
    pub(super) fn fill_any(&self, row: i64, enthalpy: &[f64], potentials: &mut [f64]) {
        let rows = self.lattice.rows as i64;
        if (0..rows).contains(&row) {
            let row = row as usize;
            let (first, end) = self.lattice.span(row);
            let enthalpy = &enthalpy[self.lattice.start(row)..self.lattice.start(row + 1)];
            let reach = self.shape.reach;
            self.laws.fill(self.lattice.start(row), enthalpy, &mut potentials[first + reach..end + reach]);
            self.complete(row, potentials);
            return;
        }
        if self.sides[2] == Side::Periodic {
            self.fill_any(row.rem_euclid(rows), enthalpy, potentials);
            return;
        }
        let (side, layer, image) = if row < 0 { (2, -1 - row, -1 - row) } else { (3, row - rows, 2 * rows - 1 - row) };
        if self.sides[side] == Side::Curved {
            self.exterior_row(row, potentials);
            self.columns((row + self.shape.reach_rows as i64) as usize, potentials);
            return;
        }
        self.fill_any(image, enthalpy, potentials);
        let face = self.face(side);
        let used = self.lattice.columns + 2 * self.shape.reach;
        for (place, potential) in potentials[..used].iter_mut().enumerate() {
            *potential = self.ghost(side, face, *potential, place, layer as usize);
        }
        if self.walls_meet {
            self.meet_columns((row + self.shape.reach_rows as i64) as usize, potentials);
        }
    }

    /// In the corners of a ghost row, whose ghosts are images of ghost columns: the mean with the images that the walls left
    /// and right have of the row itself, so that neither wall goes first.
    pub(super) fn meet_columns(&self, place: usize, potentials: &mut [f64]) {
        let (reach, columns) = (self.shape.reach, self.lattice.columns);
        for layer in 0..reach {
            for (side, ghost, image) in
                [(0, reach - 1 - layer, reach + layer), (1, reach + columns + layer, reach + columns - 1 - layer)]
            {
                if !matches!(self.sides[side], Side::Curved | Side::Periodic) {
                    let other = self.ghost(side, self.face(side), potentials[image], place, layer);
                    potentials[ghost] = 0.5 * (potentials[ghost] + other);
                }
            }
        }
    }

    pub(super) fn exterior_row(&self, row: i64, potentials: &mut [f64]) {
        if let Some(exterior) = &self.exterior {
            let row = (row + self.shape.reach_rows as i64) as usize;
            for column in &exterior.rows[row] {
                potentials[*column as usize] = 0.0;
            }
        }
    }

    /// What ghosts in a corner give through the wall at the bottom or the top, `layer` rows behind it: half of it the jump that
    /// this wall makes to the images beyond the columns, half what the particles have of its own ghosts where it is the first
    /// of both. So each wall brings what its condition says. The rows are those of the particles, of the ghosts' images and
    /// of the ghosts, `dx` columns on.
    pub(super) fn through_corner(
        &self,
        (side, layer): (usize, usize),
        [own, images, ghosts]: [&[f64]; 3],
        dx: i64,
        cells: std::ops::Range<usize>,
    ) -> f64 {
        let (reach, face) = (self.shape.reach, self.face(side));
        let mirror = if dx < 0 { 2 * reach - 1 } else { 2 * (reach + self.lattice.columns) - 1 };
        let share = |cell: usize| {
            let ghost = ((reach + cell) as i64 + dx) as usize;
            let jump = self.ghost(side, face, images[ghost], ghost, layer) - images[ghost];
            0.5 * (jump + ghosts[mirror - ghost] - own[reach + cell])
        };
        cells.map(share).sum()
    }

    /// Ghost columns left and right of a row at a padded place.
    #[inline(always)]
    pub(super) fn columns(&self, place: usize, potentials: &mut [f64]) {
        let (reach, columns) = (self.shape.reach, self.lattice.columns);
        let (left, right) = (self.face(0), self.face(1));
        let has = |side: usize| !matches!(self.sides[side], Side::Curved | Side::Periodic);
        let (has_left, has_right) = (has(0), has(1));
        // The two commonest walls without asking again at each layer. In a body narrower than the reach, images are ghosts
        // themselves: there both sides take turns.
        if columns >= reach && has_left && has_right {
            let (near_left, rest) = potentials.split_at_mut(reach);
            let (inside, near_right) = rest.split_at_mut(columns);
            let images = near_left.iter_mut().rev().zip(inside.iter());
            self.mirror(0, left, images, place);
            self.mirror(1, right, near_right[..reach].iter_mut().zip(inside.iter().rev()), place);
            return;
        }
        if self.sides[0] == Side::Periodic {
            potentials.copy_within(columns..columns + reach, 0);
            potentials.copy_within(reach..2 * reach, reach + columns);
            return;
        }
        // From the wall outward.
        for layer in 0..reach {
            if has_left {
                potentials[reach - 1 - layer] = self.ghost(0, left, potentials[reach + layer], place, layer);
            }
            if has_right {
                potentials[reach + columns + layer] =
                    self.ghost(1, right, potentials[reach + columns - 1 - layer], place, layer);
            }
        }
    }

    /// Ghosts of one side from their images, both from the wall outward.
    #[inline(always)]
    pub(super) fn mirror<'a>(
        &self,
        side: usize,
        face: &Face,
        pairs: impl Iterator<Item = (&'a mut f64, &'a f64)>,
        place: usize,
    ) {
        match *face {
            Face::Even => pairs.for_each(|(ghost, image)| *ghost = *image),
            Face::Odd { wall, .. } => pairs.for_each(|(ghost, image)| *ghost = 2.0 * wall - image),
            _ => {
                for (layer, (ghost, image)) in pairs.enumerate() {
                    *ghost = self.ghost(side, face, *image, place, layer);
                }
            }
        }
    }
}

impl<L: Laws> Surroundings for Around<L> {
    #[inline(always)]
    fn complete(&self, row: usize, potentials: &mut [f64]) {
        if self.exterior.is_some() {
            self.exterior_row(row as i64, potentials);
        }
        self.columns(row + self.shape.reach_rows, potentials);
    }

    #[inline(always)]
    fn patches(&self, row: usize, rows: &[&[f64]], rates: &mut [f64; 4]) {
        match rows {
            // A line ends left and right.
            [own] => {
                for side in (0..2).filter(|side| self.open[*side]) {
                    let reach = self.shape.reach;
                    rates[side] =
                        self.through_end(side, self.ghosts_give(side, own, &self.patch_weights[reach..]), own);
                }
            }
            _ => *rates = self.patches_of_row(row, rows),
        }
    }

    #[inline]
    fn has_patches(&self) -> bool {
        self.open.iter().any(|open| *open)
    }

    #[inline(always)]
    fn ends(&self) -> Option<&Ends> {
        self.ends.as_ref()
    }
}

impl<L: Laws> Around<L> {
    /// What the ghosts left or right of a row give by weights, by layer.
    #[inline(always)]
    fn ghosts_give(&self, side: usize, near: &[f64], weights: &[f64]) -> f64 {
        let reach = self.shape.reach;
        let weigh = |(weight, ghost): (&f64, &f64)| weight * ghost;
        if side == 0 {
            weights.iter().zip(near[..reach].iter().rev()).map(weigh).sum()
        } else {
            weights.iter().zip(&near[reach + self.lattice.columns..][..reach]).map(weigh).sum()
        }
    }

    /// Heat rate through the end of a row left or right, of which `ghosts` comes from there.
    #[inline(always)]
    fn through_end(&self, side: usize, ghosts: f64, own: &[f64]) -> f64 {
        let inside = &own[self.shape.reach..][..self.lattice.columns];
        let mut rate = ghosts;
        if side == 0 {
            self.patch_own.iter().zip(inside).for_each(|(weight, inside)| rate -= weight * inside);
        } else {
            self.patch_own.iter().zip(inside.iter().rev()).for_each(|(weight, inside)| rate -= weight * inside);
        }
        rate
    }

    /// Heat rate through each wall (W per volume of a particle) into a row of a plane.
    fn patches_of_row(&self, row: usize, rows: &[&[f64]]) -> [f64; 4] {
        let (reach, reach_rows) = (self.shape.reach, self.shape.reach_rows);
        let columns = self.lattice.columns;
        let own = rows[reach_rows];
        let mut rates = [0.0; 4];
        for side in 0..2 {
            if !self.open[side] {
                continue;
            }
            // Only the sum over all rows is asked for: a row of ghosts is booked at once for all rows that see it, the ghosts
            // of ghost rows with the first and the last row.
            let ghosts = |near: &[f64], weights: &[f64]| self.ghosts_give(side, near, weights);
            let mut rate = 0.0;
            let ends = if row >= reach_rows && row + reach_rows < self.lattice.rows {
                rate += ghosts(own, &self.patch_weights[(2 * reach_rows + 1) * reach..]);
                0..0
            } else {
                let from = if row == 0 { 0 } else { reach_rows };
                from..if row + 1 == self.lattice.rows { rows.len() } else { reach_rows + 1 }
            };
            for offset in ends {
                let seen_by = |distance: usize| {
                    let seeing = (row + offset + distance).checked_sub(2 * reach_rows);
                    seeing.is_some_and(|seeing| seeing < self.lattice.rows)
                };
                for distance in (0..rows.len()).filter(|distance| seen_by(*distance)) {
                    rate += ghosts(rows[offset], &self.patch_weights[distance * reach..][..reach]);
                }
            }
            rates[side] = self.through_end(side, rate, own);
        }
        for side in 2..4 {
            let to_wall = if side == 2 { row } else { self.lattice.rows - 1 - row };
            if !self.open[side] || to_wall >= reach_rows {
                continue;
            }
            for distance in to_wall + 1..=reach_rows {
                let near = rows[if side == 2 { reach_rows - distance } else { reach_rows + distance }];
                for dx in -(reach as i64)..=reach as i64 {
                    let weight = self.stencil.at(dx.unsigned_abs() as usize, distance);
                    if weight == 0.0 {
                        continue;
                    }
                    let sum = |from: usize, to: usize| -> f64 {
                        let inside = &own[reach + from..reach + to];
                        let shifted = (reach + from) as i64 + dx;
                        let ghosts = &near[shifted as usize..][..inside.len()];
                        ghosts.iter().zip(inside).map(|(ghost, inside)| ghost - inside).sum()
                    };
                    // Ghosts beyond the ends of the row have been booked left and right above, if those walls are open.
                    let cells = dx.unsigned_abs() as usize;
                    let (beyond, corner) =
                        if dx < 0 { (0, 0..cells.min(columns)) } else { (1, columns - cells.min(columns)..columns) };
                    if cells == 0 || !self.open[beyond] {
                        rates[side] += weight * sum(0, columns);
                        continue;
                    }
                    let (from, to) = if dx < 0 { (corner.end, columns) } else { (0, corner.start) };
                    rates[side] += weight * sum(from, to);
                    let layer = distance - to_wall - 1;
                    let image = if side == 2 { reach_rows + layer - to_wall } else { reach_rows + to_wall - layer };
                    let shared = self.through_corner((side, layer), [own, rows[image], near], dx, corner);
                    rates[side] += weight * shared;
                    rates[beyond] -= weight * shared;
                }
            }
        }
        rates
    }
}
