//! The pair operator on a lattice: one fused sweep a step, no neighbour list.

use std::sync::Arc;

use rayon::ThreadPool;

use crate::bonds::stencil::Stencil;
use crate::boundary::curved_wall::{Contacts, Neighbourhood};
use crate::boundary::patch::{Boundary, Face, Side};
use crate::boundary::pipe::Sink;
use crate::kernels::corner::{CornerPair, lattice_pairs};
use crate::kernels::sweep::{Band, Beside, Chained, Frame, InPlace, Shape, Surroundings, Target, fill_row, sweep};
use crate::ledger::Sum;
use crate::memory::Held;
use crate::physics::potential::{Identity, PotentialLaw, Thermal};
use crate::physics::sub_cell::SubCellFront;
use crate::series::Series;
use crate::solvers::operator::{Operator, Stage, StageColumns};
use crate::solvers::step::Bound;
use crate::space::lattice::Lattice;

/// Particles that each further thread must have to itself: a step of fewer is over before a thread is woken.
pub const PARTICLES_PER_THREAD: usize = 16_384;

/// Everything an operator on a lattice is made from.
#[derive(Clone)]
pub struct LatticeParts {
    /// The lattice.
    pub lattice: Arc<Lattice>,
    /// The weights.
    pub stencil: Stencil,
    /// Fronts inside particles, if they are to be followed.
    pub front: Option<SubCellFront>,
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

/// What lies behind a curved wall.
#[derive(Debug, Clone, Default)]
struct Exterior {
    /// Cells behind the wall that pairs reach, by padded row: column + reach. They hold zero.
    rows: Vec<Vec<u32>>,
    /// Particles whose pairs the wall cuts.
    contacts: Contacts,
    /// What each of them gains at the current instant, and what the sweep takes from it for the cut pairs (W/m3).
    gains: Vec<(f64, f64)>,
}

/// How small changes meet the walls: the ghosts of straight walls with a film follow their images by padded place along the
/// wall and layer (those of other straight walls all follow alike), the gains at a curved wall follow what is seen of it.
#[derive(Debug, Clone, Default)]
struct WallSlopes {
    by_side: [Vec<f64>; 4],
    curved: Vec<f64>,
}

impl Held for Exterior {
    fn held(&self) -> usize {
        self.rows.held() + self.contacts.held() + self.gains.held()
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
    /// Whether heat passes walls that meet in corners.
    walls_meet: bool,
    faces: Vec<Face>,
    /// Instead of faces, where potentials are small changes.
    slopes: Option<WallSlopes>,
    exterior: Option<Exterior>,
    /// Weight with which all particles of a row together reach the ghosts of a column wall: by row offset and layer, and
    /// last the sums over rows.
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
    let all: Vec<f64> = (0..reach).map(|layer| weights.iter().skip(layer).step_by(reach).sum()).collect();
    weights.extend(all);
    (weights, own)
}

impl<L: PotentialLaw> Around<L> {
    fn face(&self, side: usize) -> Face {
        match self.sides[side] {
            Side::Wall(door) => self.faces[door],
            Side::Mirror | Side::Curved => Face::Even,
        }
    }

    /// A ghost of a straight wall, `layer` rows behind it at the padded `place` along it.
    #[inline(always)]
    fn ghost(&self, side: usize, face: &Face, image: f64, place: usize, layer: usize) -> f64 {
        if let (Some(slopes), Face::Film { .. }) = (&self.slopes, face) {
            return slopes.by_side[side][place * self.shape.reach + layer] * image;
        }
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
            self.columns((row + self.shape.reach_rows as i64) as usize, potentials);
            return;
        }
        self.fill_any(image, enthalpy, potentials);
        let face = self.face(side);
        let used = self.lattice.columns + 2 * self.shape.reach;
        for (place, potential) in potentials[..used].iter_mut().enumerate() {
            *potential = self.ghost(side, &face, *potential, place, layer as usize);
        }
        if self.walls_meet {
            self.meet_columns((row + self.shape.reach_rows as i64) as usize, potentials);
        }
    }

    /// In the corners of a ghost row, whose ghosts are images of ghost columns: the mean with the images that the walls left
    /// and right have of the row itself, so that neither wall goes first.
    fn meet_columns(&self, place: usize, potentials: &mut [f64]) {
        let (reach, columns) = (self.shape.reach, self.lattice.columns);
        for layer in 0..reach {
            for (side, ghost, image) in
                [(0, reach - 1 - layer, reach + layer), (1, reach + columns + layer, reach + columns - 1 - layer)]
            {
                if self.sides[side] != Side::Curved {
                    let other = self.ghost(side, &self.face(side), potentials[image], place, layer);
                    potentials[ghost] = 0.5 * (potentials[ghost] + other);
                }
            }
        }
    }

    fn exterior_row(&self, row: i64, potentials: &mut [f64]) {
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
    fn through_corner(
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
            let jump = self.ghost(side, &face, images[ghost], ghost, layer) - images[ghost];
            0.5 * (jump + ghosts[mirror - ghost] - own[reach + cell])
        };
        cells.map(share).sum()
    }

    /// Ghost columns left and right of a row at a padded place.
    #[inline]
    fn columns(&self, place: usize, potentials: &mut [f64]) {
        let (reach, columns) = (self.shape.reach, self.lattice.columns);
        let (left, right) = (self.face(0), self.face(1));
        let (has_left, has_right) = (self.sides[0] != Side::Curved, self.sides[1] != Side::Curved);
        // The two commonest walls without asking again at each layer. In a body narrower than the reach, images are ghosts
        // themselves: there both sides take turns.
        if columns >= reach && has_left && has_right {
            let (near_left, rest) = potentials.split_at_mut(reach);
            let (inside, near_right) = rest.split_at_mut(columns);
            let images = near_left.iter_mut().rev().zip(inside.iter());
            self.mirror(0, &left, images, place);
            self.mirror(1, &right, near_right[..reach].iter_mut().zip(inside.iter().rev()), place);
            return;
        }
        // From the wall outward.
        for layer in 0..reach {
            if has_left {
                potentials[reach - 1 - layer] = self.ghost(0, &left, potentials[reach + layer], place, layer);
            }
            if has_right {
                potentials[reach + columns + layer] =
                    self.ghost(1, &right, potentials[reach + columns - 1 - layer], place, layer);
            }
        }
    }

    /// Ghosts of one side from their images, both from the wall outward.
    #[inline(always)]
    fn mirror<'a>(&self, side: usize, face: &Face, pairs: impl Iterator<Item = (&'a mut f64, &'a f64)>, place: usize) {
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

impl<L: PotentialLaw> Surroundings for Around<L> {
    #[inline]
    fn complete(&self, row: usize, potentials: &mut [f64]) {
        if self.exterior.is_some() {
            self.exterior_row(row as i64, potentials);
        }
        self.columns(row + self.shape.reach_rows, potentials);
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
            // Only the sum over all rows is asked for: a row of ghosts is booked at once for all rows that see it, the ghosts
            // of ghost rows with the first and the last row.
            let ghosts = |near: &[f64], weights: &[f64]| -> f64 {
                let ghost =
                    |layer: usize| if side == 0 { near[reach - 1 - layer] } else { near[reach + columns + layer] };
                weights.iter().enumerate().map(|(layer, weight)| weight * ghost(layer)).sum()
            };
            let mut rate = 0.0;
            let ends = if row >= reach_rows && row + reach_rows < self.lattice.rows {
                rate += ghosts(own, &self.door_weights[(2 * reach_rows + 1) * reach..]);
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
                    rate += ghosts(rows[offset], &self.door_weights[distance * reach..][..reach]);
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
    front: Option<SubCellFront>,
    bands: Vec<Band>,
    row_doors: Vec<[f64; 4]>,
    pool: Option<Arc<ThreadPool>>,
    bound: Bound,
    /// The same operator for small changes of potentials, once it was asked for.
    tangent: Option<Box<LatticeOperator<Identity>>>,
    /// Time (s) of the last linearisation.
    linear_time: f64,
}

impl<L: PotentialLaw> LatticeOperator<L> {
    /// An operator on the given parts, with the law of their material.
    pub fn new(parts: LatticeParts, law: L) -> Self {
        let LatticeParts { lattice, stencil, front, thermal, boundary, sinks, rings, pool, bound: known } = parts;
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
        let beside_fronts = front.as_ref().map_or(0.0, SubCellFront::row_sum);
        let most = sum + beside_fronts;
        let mut derived =
            bound(&lattice, &stencil, most, &thermal, &boundary, &faces, exterior.as_ref(), &sinks, &corners);
        let front_rate = front.as_ref().map_or(0.0, SubCellFront::own_rate);
        if front_rate * derived.step > 1.0 {
            derived = Bound { step: 1.0 / front_rate, cause: "the front inside a particle".to_string() };
        }
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
        let around = Around {
            lattice,
            shape,
            stencil,
            law,
            thermal,
            sides,
            open,
            walls_meet: (open[0] || open[1]) && (open[2] || open[3]),
            faces,
            slopes: None,
            exterior,
            door_weights,
            door_own,
        };
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
            front,
            bands,
            row_doors,
            pool,
            bound,
            tangent: None,
            linear_time: 0.0,
        }
    }

    /// The operator on small changes of potentials: walls and pipes hold still, and no heat is booked.
    fn tangent(&self) -> LatticeOperator<Identity> {
        let still = |sink: &Sink| Sink { temperature: Series::Constant(0.0), film: None, ..sink.clone() };
        let around = &self.around;
        let mut boundary = self.boundary.clone();
        boundary.hold_still();
        LatticeOperator {
            around: Around {
                lattice: around.lattice.clone(),
                shape: around.shape,
                stencil: around.stencil.clone(),
                law: Identity,
                thermal: around.thermal.clone(),
                sides: around.sides,
                open: [false; 4],
                walls_meet: around.walls_meet,
                faces: around.faces.iter().map(Face::homogeneous).collect(),
                slopes: Some(WallSlopes::default()),
                exterior: around.exterior.clone(),
                door_weights: around.door_weights.clone(),
                door_own: around.door_own.clone(),
            },
            boundary,
            sum: self.sum,
            sinks: self.sinks.iter().map(still).collect(),
            rings: self.rings.clone(),
            sink_potentials: vec![0.0; self.sinks.len()],
            sink_heat: vec![0.0; self.sinks.len()],
            corners: self.corners.clone(),
            corner_rates: vec![0.0; self.corners.len()],
            front: None,
            bands: self.bands.clone(),
            row_doors: self.row_doors.clone(),
            pool: self.pool.clone(),
            bound: self.bound.clone(),
            tangent: None,
            linear_time: 0.0,
        }
    }

    /// How small changes around a state meet the walls.
    fn wall_slopes(&self, enthalpy: &[f64]) -> WallSlopes {
        let around = &self.around;
        let Shape { reach, width, .. } = around.shape;
        let (columns, rows) = (around.lattice.columns, around.lattice.rows);
        let slope = |face: &Face, image: f64, depth: f64| {
            face.ghost_slope(image, depth, &around.thermal.curve, around.thermal.initial_potential)
        };
        let mut slopes = WallSlopes::default();
        let mut row_buffer = vec![0.0; width];
        for side in 0..4 {
            let face = around.face(side);
            if !matches!(face, Face::Film { .. }) {
                continue;
            }
            let depth = |layer: usize| (layer as f64 + 0.5) * around.lattice.spacing;
            let table = &mut slopes.by_side[side];
            if side < 2 {
                let beyond = around.shape.reach_rows as i64;
                for row in -beyond..rows as i64 + beyond {
                    around.fill_any(row, enthalpy, &mut row_buffer);
                    table.extend((0..reach).map(|layer| {
                        let image = if side == 0 { reach + layer } else { reach + columns - 1 - layer };
                        slope(&face, row_buffer[image], depth(layer))
                    }));
                }
            } else {
                table.resize((columns + 2 * reach) * reach, 0.0);
                for layer in 0..around.shape.reach_rows {
                    let image = if side == 2 { layer as i64 } else { rows as i64 - 1 - layer as i64 };
                    around.fill_any(image, enthalpy, &mut row_buffer);
                    for (place, potential) in row_buffer[..columns + 2 * reach].iter().enumerate() {
                        table[place * reach + layer] = slope(&face, *potential, depth(layer));
                    }
                }
            }
        }
        if let (Some(exterior), Some((door, _))) = (&around.exterior, self.boundary.curved) {
            let (face, thermal) = (&around.faces[door], &around.thermal);
            let slope =
                |particle: usize, depth: f64| face.flux_slope(around.law.potential(enthalpy[particle]), depth, thermal);
            exterior.contacts.slopes(slope, &mut slopes.curved);
        }
        slopes
    }

    /// Brings ghosts, pipes and the rows around each band to the given state.
    fn prepare(&mut self, enthalpy: &[f64], time: f64) {
        let around = &mut self.around;
        let thermal = &around.thermal;
        self.boundary.update_faces(&mut around.faces, time, &thermal.curve, thermal.initial_potential);
        if let (Some(exterior), Some((door, _))) = (&mut around.exterior, self.boundary.curved) {
            exterior.update(&around.law, enthalpy, &around.faces[door], thermal, around.slopes.as_ref());
        }
        for ((sink, potential), heat) in self.sinks.iter().zip(&mut self.sink_potentials).zip(&mut self.sink_heat) {
            if sink.temperature.changes() {
                *potential = thermal.potential_at(sink.temperature.at(time));
            }
            *heat = if sink.works(time) {
                let sampled = sink.sampled(|index| around.law.potential(enthalpy[index]));
                sink.heat(sampled, *potential, time, thermal)
            } else {
                0.0
            };
        }
        let around = &self.around;
        for (pair, rate) in self.corners.iter().zip(&mut self.corner_rates) {
            let potential = |index: u32| around.law.potential(enthalpy[index as usize]);
            *rate = pair.weight * (potential(pair.second) - potential(pair.first));
        }
        if let Some(front) = &mut self.front {
            front.update(&around.lattice, enthalpy, |enthalpy| around.law.potential(enthalpy));
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

    /// The sweep of a stage over several bands.
    fn stage_in_bands(&mut self, stage: &Stage, columns: &mut StageColumns<'_>) {
        let mut targets: Vec<Chained<'_>> = Vec::with_capacity(self.bands.len());
        let (mut newest, mut start, mut first) = (columns.newest, columns.start, columns.first);
        let mut oldest = &mut columns.oldest[..];
        for band in &self.bands {
            let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
            let (own_newest, own_start, own_first);
            (own_newest, newest) = newest.split_at(count);
            (own_start, start) = start.split_at(count);
            (own_first, first) = first.split_at(count);
            let (own_oldest, later) = oldest.split_at_mut(count);
            oldest = later;
            let columns = StageColumns { newest: own_newest, oldest: own_oldest, start: own_start, first: own_first };
            targets.push(Chained { stage: *stage, columns });
        }
        self.sweep(&mut targets);
    }

    /// Rates of all particles, without booking what passes the doors.
    fn rates(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64]) {
        self.prepare(enthalpy, time);
        if let [_] = self.bands.as_slice() {
            self.sweep(&mut [Beside { enthalpy, rate }]);
        } else {
            self.rates_in_bands(enthalpy, rate);
        }
        self.sink(rate, 1.0);
        self.strengthen(rate, 1.0);
        self.contact(rate, 1.0);
        self.fronts(rate, 1.0);
    }

    /// The sweep of the rates over several bands.
    fn rates_in_bands(&mut self, enthalpy: &[f64], rate: &mut [f64]) {
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
    }

    /// Heat in through every door (W), from what the sweep and the preparation left.
    fn book(&self, doors: &mut [f64]) {
        let volume = self.around.lattice.volume();
        doors.fill(0.0);
        for side in (0..4).filter(|side| self.around.open[*side]) {
            if let Side::Wall(door) = self.boundary.sides[side] {
                doors[door] += volume * self.row_doors.iter().map(|rates| rates[side]).collect::<Sum>().value();
            }
        }
        if let (Some(exterior), Some((door, _))) = (&self.around.exterior, self.boundary.curved) {
            doors[door] = volume * exterior.heat();
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

    /// Adds what a curved wall gives to `rates`, scaled.
    fn contact(&self, rates: &mut [f64], scale: f64) {
        if let Some(exterior) = &self.around.exterior {
            exterior.add(rates, scale);
        }
    }

    /// Adds what fronts exchange to `rates`, scaled.
    fn fronts(&self, rates: &mut [f64], scale: f64) {
        if let Some(front) = &self.front {
            front.add(rates, scale);
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
        self.rates(enthalpy, time, rate);
        self.book(doors);
    }

    fn stage(&mut self, stage: &Stage, columns: &mut StageColumns<'_>, time: f64, doors: &mut [f64]) {
        self.prepare(columns.newest, time);
        if let [_] = self.bands.as_slice() {
            let StageColumns { newest, ref mut oldest, start, first } = *columns;
            self.sweep(&mut [Chained { stage: *stage, columns: StageColumns { newest, oldest, start, first } }]);
        } else {
            self.stage_in_bands(stage, columns);
        }
        self.sink(columns.oldest, stage.rate);
        self.strengthen(columns.oldest, stage.rate);
        self.contact(columns.oldest, stage.rate);
        self.fronts(columns.oldest, stage.rate);
        self.book(doors);
    }

    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]) {
        let around = &mut self.around;
        let thermal = &around.thermal;
        self.boundary.update_faces(&mut around.faces, time, &thermal.curve, thermal.initial_potential);
        for (slope, enthalpy) in slopes.iter_mut().zip(enthalpy) {
            *slope = around.law.slope(*enthalpy);
        }
        self.linear_time = time;
        let wall_slopes = self.wall_slopes(enthalpy);
        let mut tangent = self.tangent.take().unwrap_or_else(|| Box::new(self.tangent()));
        for (linear, face) in tangent.around.faces.iter_mut().zip(&self.around.faces) {
            *linear = face.homogeneous();
        }
        tangent.around.slopes = Some(wall_slopes);
        for (linear, sink) in tangent.sinks.iter_mut().zip(&self.sinks) {
            let sampled = sink.sampled(|index| self.around.law.potential(enthalpy[index]));
            linear.resistance = sink.resistance_to_changes(sampled, time, &self.around.thermal);
        }
        self.tangent = Some(tangent);
    }

    fn act(&mut self, potentials: &[f64], rate: &mut [f64]) {
        match &mut self.tangent {
            Some(tangent) => tangent.rates(potentials, self.linear_time, rate),
            None => rate.fill(0.0),
        }
    }

    fn is_symmetric(&self) -> bool {
        // Particles see a curved wall through others, and behind a film deeper ghosts follow less.
        let film = |side: usize| matches!(self.around.face(side), Face::Film { .. });
        let curved = self.boundary.curved.is_some_and(|(door, _)| self.around.faces[door].holds() > 0.0);
        !curved && (self.around.shape.reach == 1 || !(0..4).any(film))
    }

    fn is_constant(&self) -> bool {
        self.boundary.is_linear() && self.sinks.iter().all(|sink| sink.schedule.is_none() && sink.film.is_none())
    }

    fn bandwidth(&self) -> usize {
        let lattice = &self.around.lattice;
        let by_pairs = self.around.shape.reach_rows * lattice.columns + self.around.shape.reach.min(lattice.columns);
        if self.around.exterior.is_some() || !self.sinks.is_empty() {
            lattice.len()
        } else {
            by_pairs.min(lattice.len())
        }
    }

    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, doors: &mut [f64]) {
        self.prepare(enthalpy, time);
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
        self.contact(enthalpy, step);
        self.fronts(enthalpy, step);
        self.book(doors);
    }

    fn steepest(&self) -> Vec<f64> {
        vec![self.around.thermal.largest_slope; self.around.lattice.len()]
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
        let corners = self.corners.capacity() * size_of::<CornerPair>() + self.corner_rates.held() + self.front.held();
        let tangent = self.tangent.as_ref().map_or(0, |tangent| tangent.held());
        around.stencil.held() + walls + pipes + corners + self.bands.held() + self.row_doors.held() + tangent
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
                Side::Wall(door) => Some(boundary.doors[door].name.as_str()),
                Side::Mirror | Side::Curved => None,
            })
            .collect();
        cause = format!("pair exchange of the particles at wall `{}`", stiff.join("` and `"));
    }
    if let (Some(exterior), Some((door, _))) = (exterior, boundary.curved) {
        let contacts = exterior.contacts.contacts.iter();
        let added = contacts.map(|contact| faces[door].holds() * contact.stiffness - contact.cut).fold(0.0, f64::max);
        if sum + added > largest {
            largest = sum + added;
            cause = "pair exchange of the particles at the curved wall".to_string();
        }
    }
    for sink in sinks {
        for (index, row_sum) in sink.row_sums(lattice.spacing) {
            if sum + row_sum > largest {
                largest = sum + row_sum;
                let at = lattice.position(index);
                cause = format!(
                    "particle {index} at ({:.4}, {:.4}) m, which the pipe at ({:.4}, {:.4}) m cools",
                    at.x, at.y, sink.extent.centre.x, sink.extent.centre.y
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
        let (reach, reach_rows) = (shape.reach as i64, shape.reach_rows as i64);
        let mut rows = vec![std::collections::BTreeSet::new(); lattice.rows + 2 * shape.reach_rows];
        let mut contacts = Contacts::default();
        let sum = stencil.sum();
        let layers = boundary.curved.is_some_and(|(door, _)| boundary.doors[door].layers);
        for row in 0..lattice.rows {
            let (first, end) = lattice.span(row);
            for column in first as i64..end as i64 {
                let row = row as i64;
                let depth = radius - lattice.centre(column, row).length();
                // Deep inside every offset stays inside.
                if depth > (reach as f64 + 1.5) * lattice.spacing * 1.5 {
                    continue;
                }
                let mut near = Neighbourhood::new(depth);
                for (dx, dy, weight) in stencil.offsets() {
                    let (dx, dy) = (dx as i64, dy as i64);
                    for (sx, sy) in [(1, 1), (-1, 1), (1, -1), (-1, -1)] {
                        if (dx == 0 && sx < 0) || (dy == 0 && sy < 0) {
                            continue;
                        }
                        let cell = fold(column + sx * dx, row + sy * dy);
                        let depth = radius - lattice.centre(cell.0, cell.1).length();
                        match lattice.index(cell.0, cell.1) {
                            Some(index) => near.pair(index as u32, weight, depth),
                            None => {
                                near.cut(weight, if layers { 0.0 } else { -depth });
                                rows[(cell.1 + reach_rows) as usize].insert((cell.0 + reach) as u32);
                            }
                        }
                    }
                }
                if let Some(index) = lattice.index(column, row) {
                    contacts.add(index as u32, &near, sum);
                }
            }
        }
        let rows = rows.into_iter().map(|row| row.into_iter().collect()).collect();
        Exterior { rows, gains: vec![(0.0, 0.0); contacts.contacts.len()], contacts }
    }

    fn update<L: PotentialLaw>(
        &mut self,
        law: &L,
        enthalpy: &[f64],
        face: &Face,
        thermal: &Thermal,
        slopes: Option<&WallSlopes>,
    ) {
        let potential = |particle: usize| law.potential(enthalpy[particle]);
        for (contact, gain) in self.contacts.contacts.iter().zip(&mut self.gains) {
            let given = match slopes {
                Some(slopes) => self.contacts.change(contact, &slopes.curved, potential),
                None => {
                    let flux = |particle: usize, depth: f64| face.flux(potential(particle), depth, thermal);
                    self.contacts.gain(contact, flux)
                }
            };
            *gain = (given, contact.cut * potential(contact.particle as usize));
        }
    }

    /// Adds what the wall gives to `rates`, scaled, and gives back what the sweep took for the cut pairs.
    fn add(&self, rates: &mut [f64], scale: f64) {
        for (contact, (gain, taken)) in self.contacts.contacts.iter().zip(&self.gains) {
            rates[contact.particle as usize] += scale * (gain + taken);
        }
    }

    /// Heat rate in through the wall, by volume of a particle.
    fn heat(&self) -> f64 {
        self.gains.iter().map(|gain| gain.0).collect::<Sum>().value()
    }
}
