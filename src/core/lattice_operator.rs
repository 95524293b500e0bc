//! The pair operator on a lattice: one fused sweep a step, no neighbour list.

use std::sync::Arc;

use glam::DVec2;
use rayon::ThreadPool;

use crate::boundary::{Boundary, Face, Side, moving_least_squares};
use crate::corner::{CornerPair, lattice_pairs};
use crate::ghosts::{FIT_RANGE, FIT_SCALE};
use crate::lattice::Lattice;
use crate::ledger::Sum;
use crate::memory::Held;
use crate::method::Bound;
use crate::operator::Operator;
use crate::pipe::Sink;
use crate::potential::{PotentialLaw, Thermal};
use crate::stencil::Stencil;
use crate::sweep::{Band, Beside, Frame, InPlace, Shape, Surroundings, Target, fill_row, sweep};

/// Particles that each further thread must have to itself: a step of fewer is over before a thread is woken.
pub const PARTICLES_PER_THREAD: usize = 16_384;

/// Everything an operator on a lattice is made from.
#[derive(Clone)]
pub struct LatticeParts {
    /// The lattice.
    pub lattice: Arc<Lattice>,
    /// The weights.
    pub stencil: Stencil,
    /// The one material.
    pub thermal: Thermal,
    /// The walls.
    pub boundary: Boundary,
    /// The pipes.
    pub sinks: Vec<Sink>,
    /// Names of pipe rings.
    pub rings: Vec<String>,
    /// Threads, if more than one.
    pub pool: Option<Arc<ThreadPool>>,
    /// The bound of the step, where it is known from elsewhere.
    pub bound: Option<Bound>,
}

/// Ghosts behind a curved wall.
#[derive(Debug, Clone, Default)]
struct Exterior {
    /// Value of each ghost at the current instant.
    values: Vec<f64>,
    /// Depth of each ghost behind the wall (m).
    depths: Vec<f64>,
    /// Start of each ghost's image weights, and their end.
    starts: Vec<u32>,
    /// Particles and weights of the images.
    images: Vec<(u32, f64)>,
    /// Ghosts of each padded row: column + reach, ghost.
    rows: Vec<Vec<(u32, u32)>>,
    /// Sum over particles of the weight with which each ghost acts.
    ghost_weights: Vec<f64>,
    /// Particles that reach ghosts, with the sum of those weights.
    near_wall: Vec<(u32, f64)>,
    /// Largest addition of ghosts to the row sum of a particle that they image.
    stiffness: f64,
}

impl Held for Exterior {
    fn held(&self) -> usize {
        let images = self.values.held() + self.depths.held() + self.starts.held() + self.images.held();
        images + self.rows.held() + self.ghost_weights.held() + self.near_wall.held()
    }
}

/// Ghosts and walls, as the sweep sees them.
struct Around<L> {
    lattice: Arc<Lattice>,
    shape: Shape,
    stencil: Stencil,
    law: L,
    thermal: Thermal,
    sides: [Side; 4],
    open: [bool; 4],
    faces: Vec<Face>,
    exterior: Option<Exterior>,
    /// Weight with which all particles of a row together reach the ghosts of a column wall: by row offset and layer.
    door_weights: Vec<f64>,
    /// Weight with which a particle of a row reaches all ghosts of a column wall: by its distance from the wall.
    door_own: Vec<f64>,
}

/// [`Around::door_weights`] and [`Around::door_own`] of a stencil on rows of `columns` particles.
fn door_weights(stencil: &Stencil, shape: Shape, columns: usize) -> (Vec<f64>, Vec<f64>) {
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
    (weights, own)
}

impl<L: PotentialLaw> Around<L> {
    fn face(&self, side: usize) -> Face {
        match self.sides[side] {
            Side::Wall(door) => self.faces[door],
            Side::Mirror | Side::Curved => Face::Even,
        }
    }

    #[inline(always)]
    fn ghost(&self, face: &Face, image: f64, layer: usize) -> f64 {
        let depth = (layer as f64 + 0.5) * self.lattice.spacing;
        face.ghost(image, depth, &self.thermal.curve, self.thermal.initial_potential)
    }

    /// Potentials of any row, ghost rows included, from the enthalpies of all particles.
    fn fill_any(&self, row: i64, enthalpy: &[f64], potentials: &mut [f64]) {
        let rows = self.lattice.rows as i64;
        if (0..rows).contains(&row) {
            let row = row as usize;
            let (first, end) = self.lattice.span(row);
            let enthalpy = &enthalpy[self.lattice.start(row)..self.lattice.start(row + 1)];
            let reach = self.shape.reach;
            fill_row(&self.law, enthalpy, &mut potentials[first + reach..end + reach]);
            self.complete(row, potentials);
            return;
        }
        let (side, layer, image) = if row < 0 { (2, -1 - row, -1 - row) } else { (3, row - rows, 2 * rows - 1 - row) };
        if self.sides[side] == Side::Curved {
            self.exterior_row(row, potentials);
            self.columns(potentials);
            return;
        }
        self.fill_any(image, enthalpy, potentials);
        let face = self.face(side);
        let used = self.lattice.columns + 2 * self.shape.reach;
        for potential in &mut potentials[..used] {
            *potential = self.ghost(&face, *potential, layer as usize);
        }
    }

    fn exterior_row(&self, row: i64, potentials: &mut [f64]) {
        if let Some(exterior) = &self.exterior {
            let row = (row + self.shape.reach_rows as i64) as usize;
            for (column, ghost) in &exterior.rows[row] {
                potentials[*column as usize] = exterior.values[*ghost as usize];
            }
        }
    }

    /// Ghost columns left and right of a row.
    #[inline]
    fn columns(&self, potentials: &mut [f64]) {
        let (reach, columns) = (self.shape.reach, self.lattice.columns);
        let (left, right) = (self.face(0), self.face(1));
        let (has_left, has_right) = (self.sides[0] != Side::Curved, self.sides[1] != Side::Curved);
        // From the wall outward, both sides in turn: in a body narrower than the reach, images are ghosts themselves.
        for layer in 0..reach {
            if has_left {
                potentials[reach - 1 - layer] = self.ghost(&left, potentials[reach + layer], layer);
            }
            if has_right {
                potentials[reach + columns + layer] =
                    self.ghost(&right, potentials[reach + columns - 1 - layer], layer);
            }
        }
    }
}

impl<L: PotentialLaw> Surroundings for Around<L> {
    #[inline]
    fn complete(&self, row: usize, potentials: &mut [f64]) {
        if self.exterior.is_some() {
            self.exterior_row(row as i64, potentials);
        }
        self.columns(potentials);
    }

    fn doors(&self, row: usize, rows: &[&[f64]]) -> [f64; 4] {
        let (reach, reach_rows) = (self.shape.reach, self.shape.reach_rows);
        let columns = self.lattice.columns;
        let own = rows[reach_rows];
        let mut rates = [0.0; 4];
        for side in 0..2 {
            if !self.open[side] {
                continue;
            }
            let mut rate = 0.0;
            for (near, weights) in rows.iter().zip(self.door_weights.chunks_exact(reach)) {
                for (layer, weight) in weights.iter().enumerate() {
                    let ghost = if side == 0 { near[reach - 1 - layer] } else { near[reach + columns + layer] };
                    rate += weight * ghost;
                }
            }
            for (cell, weight) in self.door_own.iter().enumerate() {
                let inside = if side == 0 { own[reach + cell] } else { own[reach + columns - 1 - cell] };
                rate -= weight * inside;
            }
            rates[side] = rate;
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
                    // Ghosts beyond the ends of the row belong to the walls left and right, if those are open.
                    let from = if self.open[0] { (-dx).max(0) as usize } else { 0 };
                    let beyond = if self.open[1] { dx.max(0) } else { 0 };
                    let to = (columns as i64 - beyond).max(from as i64) as usize;
                    let inside = &own[reach + from..reach + to];
                    let shifted = (reach + from) as i64 + dx;
                    let ghosts = &near[shifted as usize..][..inside.len()];
                    let sum: f64 = ghosts.iter().zip(inside).map(|(ghost, inside)| ghost - inside).sum();
                    rates[side] += weight * sum;
                }
            }
        }
        rates
    }

    fn has_doors(&self) -> bool {
        self.open.iter().any(|open| *open)
    }
}

/// The operator, monomorphised over the law of its material.
pub struct LatticeOperator<L> {
    around: Around<L>,
    boundary: Boundary,
    sum: f64,
    sinks: Vec<Sink>,
    rings: Vec<String>,
    sink_potentials: Vec<f64>,
    sink_heat: Vec<f64>,
    corners: Vec<CornerPair>,
    corner_rates: Vec<f64>,
    bands: Vec<Band>,
    row_doors: Vec<[f64; 4]>,
    pool: Option<Arc<ThreadPool>>,
    bound: Bound,
}

impl<L: PotentialLaw> LatticeOperator<L> {
    /// An operator on the given parts, with the law of their material.
    pub fn new(parts: LatticeParts, law: L) -> Self {
        let LatticeParts { lattice, stencil, thermal, boundary, sinks, rings, pool, bound: known } = parts;
        let reach = stencil.reach;
        let shape = Shape::new(lattice.columns, reach, lattice.dimension == 1);
        let faces = boundary.first_faces(&thermal.curve, thermal.initial_potential);
        let open = boundary.sides.map(|side| match side {
            Side::Wall(door) => boundary.doors[door].lets_heat_through(),
            Side::Mirror | Side::Curved => false,
        });
        let exterior = boundary.curved.map(|(_, radius)| Exterior::new(&lattice, &stencil, shape, &boundary, radius));
        let sum = stencil.sum();
        let stiffness = boundary.sides.map(|side| match side {
            Side::Wall(door) => Some(faces[door].stiffness()),
            Side::Mirror => Some(-1.0),
            Side::Curved => None,
        });
        let corners = lattice_pairs(&lattice, &stencil, stiffness);
        let corner_rates = vec![0.0; corners.len()];
        let derived = bound(&lattice, &stencil, sum, &thermal, &boundary, &faces, exterior.as_ref(), &sinks, &corners);
        let bound = known.unwrap_or(derived);
        let threads = pool.as_ref().map_or(1, |pool| pool.current_num_threads());
        let most = (lattice.len() / PARTICLES_PER_THREAD).min(lattice.rows / (4 * shape.reach_rows).max(1));
        let count = if lattice.rows == 1 { 1 } else { threads.min(most).max(1) };
        let bands = bands(&lattice, count, shape);
        let pool = if bands.len() > 1 { pool } else { None };
        let row_doors = vec![[0.0; 4]; lattice.rows];
        let sides = boundary.sides;
        let sink_potentials = sinks.iter().map(|sink| thermal.potential_at(sink.temperature.at(0.0))).collect();
        let sink_heat = vec![0.0; sinks.len()];
        let (door_weights, door_own) = door_weights(&stencil, shape, lattice.columns);
        let around =
            Around { lattice, shape, stencil, law, thermal, sides, open, faces, exterior, door_weights, door_own };
        LatticeOperator {
            around,
            boundary,
            sum,
            sinks,
            rings,
            sink_potentials,
            sink_heat,
            corners,
            corner_rates,
            bands,
            row_doors,
            pool,
            bound,
        }
    }

    /// Brings ghosts, pipes and the rows around each band to the given state.
    fn prepare(&mut self, enthalpy: &[f64], time: f64) {
        let around = &mut self.around;
        let thermal = &around.thermal;
        self.boundary.update_faces(&mut around.faces, time, &thermal.curve, thermal.initial_potential);
        if let (Some(exterior), Some((door, _))) = (&mut around.exterior, self.boundary.curved) {
            exterior.update(&around.law, enthalpy, &around.faces[door], thermal);
        }
        for ((sink, potential), heat) in self.sinks.iter().zip(&mut self.sink_potentials).zip(&mut self.sink_heat) {
            if sink.temperature.changes() {
                *potential = thermal.potential_at(sink.temperature.at(time));
            }
            *heat = sink.heat(|index| around.law.potential(enthalpy[index]), *potential);
        }
        let around = &self.around;
        for (pair, rate) in self.corners.iter().zip(&mut self.corner_rates) {
            let potential = |index: u32| around.law.potential(enthalpy[index as usize]);
            *rate = pair.weight * (potential(pair.second) - potential(pair.first));
        }
        let Shape { reach_rows, width, .. } = around.shape;
        let fill = |band: &mut Band| {
            let (first, end) = band.rows;
            for k in 0..reach_rows {
                let row = first as i64 - (reach_rows - k) as i64;
                around.fill_any(row, enthalpy, &mut band.below[k * width..][..width]);
                around.fill_any((end + k) as i64, enthalpy, &mut band.above[k * width..][..width]);
            }
        };
        // A few rows a band: less work than a second hand-over between threads.
        self.bands.iter_mut().for_each(fill);
    }

    /// Sweeps all bands; `targets` holds one target for each.
    fn sweep<T: Target + Send>(&mut self, targets: &mut [T]) {
        let around = &self.around;
        let frame = Frame {
            shape: around.shape,
            lattice: &around.lattice,
            stencil: &around.stencil,
            sum: self.sum,
            law: &around.law,
            surroundings: around,
        };
        match &self.pool {
            Some(pool) => {
                // The calling thread sweeps the last band itself: one thread less to be woken each step.
                pool.in_place_scope(|scope| {
                    let frame = &frame;
                    let mut rest = self.row_doors.as_mut_slice();
                    let last = self.bands.len() - 1;
                    for (number, (band, target)) in self.bands.iter_mut().zip(targets).enumerate() {
                        let (doors, later) = rest.split_at_mut(band.rows.1 - band.rows.0);
                        rest = later;
                        if number < last {
                            scope.spawn(move |_| sweep(frame, band, target, doors));
                        } else {
                            sweep(frame, band, target, doors);
                        }
                    }
                });
            }
            None => sweep(&frame, &mut self.bands[0], &mut targets[0], &mut self.row_doors),
        }
    }

    /// Heat in through every door (W), from what the sweep and the preparation left.
    fn book(&self, enthalpy_was: &[f64], doors: &mut [f64]) {
        let volume = self.around.lattice.volume();
        doors.fill(0.0);
        for side in (0..4).filter(|side| self.around.open[*side]) {
            if let Side::Wall(door) = self.boundary.sides[side] {
                doors[door] += volume * self.row_doors.iter().map(|rates| rates[side]).collect::<Sum>().value();
            }
        }
        if let (Some(exterior), Some((door, _))) = (&self.around.exterior, self.boundary.curved)
            && self.boundary.doors[door].lets_heat_through()
        {
            doors[door] = volume * exterior.heat(&self.around.law, enthalpy_was);
        }
        let walls = self.boundary.doors.len();
        for (sink, heat) in self.sinks.iter().zip(&self.sink_heat) {
            doors[walls + sink.ring] -= heat * sink.share;
        }
    }

    /// Adds what strengthened corner pairs exchange to `rates`, scaled.
    fn strengthen(&self, rates: &mut [f64], scale: f64) {
        for (pair, rate) in self.corners.iter().zip(&self.corner_rates) {
            rates[pair.first as usize] += scale * rate;
            rates[pair.second as usize] -= scale * rate;
        }
    }

    /// Takes the heat of the pipes from `rates`, scaled.
    fn sink(&self, rates: &mut [f64], scale: f64) {
        let volume = self.around.lattice.volume();
        for (sink, heat) in self.sinks.iter().zip(&self.sink_heat) {
            let taken = scale * heat * sink.share / volume;
            for (index, weight) in &sink.sample {
                rates[*index as usize] -= taken * weight;
            }
        }
    }
}

impl<L: PotentialLaw> Operator for LatticeOperator<L> {
    fn rate(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64], doors: &mut [f64]) {
        self.prepare(enthalpy, time);
        let mut targets: Vec<Beside<'_>> = Vec::with_capacity(self.bands.len());
        let (mut from, mut into) = (enthalpy, &mut rate[..]);
        for band in &self.bands {
            let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
            let (own, later) = from.split_at(count);
            let (own_rate, later_rate) = into.split_at_mut(count);
            targets.push(Beside { enthalpy: own, rate: own_rate });
            (from, into) = (later, later_rate);
        }
        self.sweep(&mut targets);
        drop(targets);
        self.sink(rate, 1.0);
        self.strengthen(rate, 1.0);
        self.book(enthalpy, doors);
    }

    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, doors: &mut [f64]) {
        self.prepare(enthalpy, time);
        if self.around.exterior.is_some() {
            // The curved wall's heat needs the state before the step.
            self.book(enthalpy, doors);
        }
        let curved = self.boundary.curved.map(|(door, _)| (door, doors[door]));
        if let [_] = self.bands.as_slice() {
            self.sweep(&mut [InPlace { enthalpy, step }]);
        } else {
            let mut targets: Vec<InPlace<'_>> = Vec::with_capacity(self.bands.len());
            let mut rest = &mut enthalpy[..];
            for band in &self.bands {
                let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
                let (own, later) = rest.split_at_mut(count);
                targets.push(InPlace { enthalpy: own, step });
                rest = later;
            }
            self.sweep(&mut targets);
        }
        self.sink(enthalpy, step);
        self.strengthen(enthalpy, step);
        match curved {
            Some((door, heat)) => doors[door] = heat,
            None => self.book(enthalpy, doors),
        }
    }

    fn bound(&self) -> Bound {
        self.bound.clone()
    }

    fn doors(&self) -> Vec<String> {
        self.boundary.doors.iter().map(|door| door.name.to_string()).chain(self.rings.iter().cloned()).collect()
    }

    fn pairs(&self) -> u64 {
        (self.around.lattice.len() * self.around.stencil.neighbours() / 2) as u64
    }

    fn held(&self) -> usize {
        let around = &self.around;
        let walls = around.exterior.held() + around.door_weights.held() + around.door_own.held();
        let pipes = self.sinks.held() + self.sink_potentials.held() + self.sink_heat.held();
        let corners = self.corners.capacity() * size_of::<CornerPair>() + self.corner_rates.held();
        around.stencil.held() + walls + pipes + corners + self.bands.held() + self.row_doors.held()
    }
}

/// Bands of rows with about the same number of particles each.
fn bands(lattice: &Lattice, count: usize, shape: Shape) -> Vec<Band> {
    let mut cuts: Vec<usize> = (0..=count)
        .map(|k| {
            let wanted = lattice.len() * k / count;
            (0..=lattice.rows).find(|row| lattice.start(*row) >= wanted).unwrap_or(lattice.rows)
        })
        .collect();
    cuts.dedup();
    cuts.windows(2).map(|cut| Band::new((cut[0], cut[1]), shape)).collect()
}

#[allow(clippy::too_many_arguments)]
fn bound(
    lattice: &Lattice,
    stencil: &Stencil,
    sum: f64,
    thermal: &Thermal,
    boundary: &Boundary,
    faces: &[Face],
    exterior: Option<&Exterior>,
    sinks: &[Sink],
    corners: &[CornerPair],
) -> Bound {
    let mut largest = sum;
    let mut cause = "pair exchange inside the body".to_string();
    // A particle reaches its own image behind a wall at twice its distance from it.
    let stiffness = |side: usize| match boundary.sides[side] {
        Side::Wall(door) => faces[door].stiffness().max(0.0),
        Side::Mirror | Side::Curved => 0.0,
    };
    let excess = |near: usize, far: usize, cells: usize| {
        let own = |side: usize, layer: usize| stiffness(side) * stencil.at(2 * layer + 1, 0);
        (0..cells).map(|layer| own(near, layer) + own(far, cells - 1 - layer)).fold(0.0, f64::max)
    };
    let across = if lattice.dimension == 1 { 0.0 } else { excess(2, 3, lattice.rows) };
    let wall_excess = excess(0, 1, lattice.columns) + across;
    if wall_excess > 0.0 {
        let mut strengthened = std::collections::BTreeMap::new();
        for pair in corners {
            *strengthened.entry(pair.first).or_insert(0.0) += pair.weight;
            *strengthened.entry(pair.second).or_insert(0.0) += pair.weight;
        }
        largest = sum + wall_excess + strengthened.values().copied().fold(0.0, f64::max);
        let stiff: Vec<&str> = (0..4)
            .filter(|side| stiffness(*side) > 0.0)
            .filter_map(|side| match boundary.sides[side] {
                Side::Wall(door) => Some(boundary.doors[door].name),
                Side::Mirror | Side::Curved => None,
            })
            .collect();
        cause = format!("pair exchange of the particles at wall `{}`", stiff.join("` and `"));
    }
    if let Some(exterior) = exterior
        && sum + exterior.stiffness > largest
    {
        largest = sum + exterior.stiffness;
        cause = "pair exchange of the particles at the curved wall".to_string();
    }
    for sink in sinks {
        for (index, row_sum) in sink.row_sums(lattice.spacing) {
            if sum + row_sum > largest {
                largest = sum + row_sum;
                let at = lattice.position(index);
                cause = format!(
                    "particle {index} at ({:.4}, {:.4}) m, which the pipe at ({:.4}, {:.4}) m cools",
                    at.x, at.y, sink.extent.0.x, sink.extent.0.y
                );
            }
        }
    }
    Bound { step: 1.0 / (largest * thermal.largest_slope), cause }
}

impl Exterior {
    fn new(lattice: &Lattice, stencil: &Stencil, shape: Shape, boundary: &Boundary, radius: f64) -> Self {
        let mirror = |side: usize| boundary.sides[side] == Side::Mirror;
        let fold = |column: i64, row: i64| {
            (
                if mirror(0) && column < 0 { -1 - column } else { column },
                if mirror(2) && row < 0 { -1 - row } else { row },
            )
        };
        let mut exterior = Exterior {
            rows: vec![Vec::new(); lattice.rows + 2 * shape.reach_rows],
            starts: vec![0],
            ..Exterior::default()
        };
        let mut numbers = std::collections::BTreeMap::new();
        let mut reaches: Vec<(u32, u32, f64)> = Vec::new();
        let reach = shape.reach as i64;
        for row in 0..lattice.rows {
            let (first, end) = lattice.span(row);
            for column in first as i64..end as i64 {
                let row = row as i64;
                let mut outside = 0.0;
                // Deep inside every offset stays inside.
                let depth = radius - lattice.centre(column, row).length();
                if depth > (reach as f64 + 1.5) * lattice.spacing * 1.5 {
                    continue;
                }
                for (dx, dy, weight) in stencil.offsets() {
                    let (dx, dy) = (dx as i64, dy as i64);
                    for (sx, sy) in [(1, 1), (-1, 1), (1, -1), (-1, -1)] {
                        if (dx == 0 && sx < 0) || (dy == 0 && sy < 0) {
                            continue;
                        }
                        let cell = fold(column + sx * dx, row + sy * dy);
                        if lattice.index(cell.0, cell.1).is_none() {
                            outside += weight;
                            let next = numbers.len();
                            let number = *numbers.entry(cell).or_insert(next);
                            if number == exterior.ghost_weights.len() {
                                exterior.ghost_weights.push(0.0);
                            }
                            exterior.ghost_weights[number] += weight;
                            if let Some(index) = lattice.index(column, row) {
                                reaches.push((index as u32, number as u32, weight));
                            }
                        }
                    }
                }
                if outside > 0.0
                    && let Some(index) = lattice.index(column, row)
                {
                    exterior.near_wall.push((index as u32, outside));
                }
            }
        }
        let mut cells: Vec<((i64, i64), usize)> = numbers.into_iter().collect();
        cells.sort_unstable_by_key(|cell| cell.1);
        for ((column, row), number) in cells {
            let place = lattice.centre(column, row);
            let depth = (place.length() - radius).max(0.0);
            let image = place * ((radius - depth) / place.length());
            exterior.depths.push(depth);
            exterior.rows[(row + shape.reach_rows as i64) as usize].push(((column + reach) as u32, number as u32));
            let near = lattice.to_cells(image).round();
            let mut points: Vec<(usize, DVec2)> = Vec::new();
            // The rounded image is at most half a cell off, so the box holds the disc of the fit.
            let across = (FIT_RANGE + 0.5).ceil() as i64;
            for dy in -across..=across {
                for dx in -across..=across {
                    let cell = (near.x as i64 + dx, near.y as i64 + dy);
                    let folded = fold(cell.0, cell.1);
                    let centre = lattice.centre(cell.0, cell.1);
                    if let Some(index) = lattice.index(folded.0, folded.1)
                        && (centre - image).length() <= FIT_RANGE * lattice.spacing
                    {
                        points.push((index, centre));
                    }
                }
            }
            let places: Vec<DVec2> = points.iter().map(|point| point.1).collect();
            let weights = moving_least_squares(image, &places, FIT_SCALE * lattice.spacing, 2);
            for ((index, _), weight) in points.iter().zip(weights) {
                exterior.images.push((*index as u32, weight));
            }
            exterior.starts.push(exterior.images.len() as u32);
        }
        exterior.values = vec![0.0; exterior.depths.len()];
        // What a particle finds of itself in the ghosts that it reaches, ghosts falling as their images rise.
        let (mut last, mut own) = (u32::MAX, 0.0);
        for (index, ghost, weight) in reaches {
            own = if index == last { own } else { 0.0 };
            last = index;
            let images = exterior.starts[ghost as usize] as usize..exterior.starts[ghost as usize + 1] as usize;
            let share = exterior.images[images].iter().filter(|image| image.0 == index).map(|image| image.1);
            own += weight * share.sum::<f64>();
            exterior.stiffness = exterior.stiffness.max(own);
        }
        exterior
    }

    fn update<L: PotentialLaw>(&mut self, law: &L, enthalpy: &[f64], face: &Face, thermal: &Thermal) {
        for (ghost, value) in self.values.iter_mut().enumerate() {
            let images = &self.images[self.starts[ghost] as usize..self.starts[ghost + 1] as usize];
            let image: f64 =
                images.iter().map(|(index, weight)| weight * law.potential(enthalpy[*index as usize])).sum();
            *value = face.ghost(image, self.depths[ghost], &thermal.curve, thermal.initial_potential);
        }
    }

    /// Heat rate in through the wall, by volume of a particle.
    fn heat<L: PotentialLaw>(&self, law: &L, enthalpy: &[f64]) -> f64 {
        let ghosts: Sum = self.values.iter().zip(&self.ghost_weights).map(|(value, weight)| value * weight).collect();
        let inside: Sum =
            self.near_wall.iter().map(|(index, weight)| weight * law.potential(enthalpy[*index as usize])).collect();
        ghosts.value() - inside.value()
    }
}
