//! The pair operator on a lattice: one fused sweep a step, no neighbour list.

use std::sync::Arc;

use rayon::ThreadPool;

use crate::boundary::patch::{Boundary, Face, Side};
use crate::boundary::pipe::Sink;
use crate::kernels::around::{Around, patch_weights};
use crate::kernels::corner::{CornerPair, lattice_pairs};
use crate::kernels::exterior::{Exterior, WallSlopes};
use crate::kernels::lattice_parts::{LatticeParts, bands, bound};
use crate::kernels::sweep::{Band, Frame, Shape, sweep};
use crate::kernels::target::{Beside, Chained, InPlace, Target};
use crate::ledger::Sum;
use crate::memory::total;
use crate::physics::potential::{Identity, PotentialLaw};
use crate::physics::sub_cell::SubCellFront;
use crate::series::Series;
use crate::solvers::operator::{Operator, Stage, StageColumns};
use crate::solvers::step::Bound;

/// Particles that each further thread must have to itself: a step of fewer is over before a thread is woken.
pub const PARTICLES_PER_THREAD: usize = 16_384;

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
    row_patches: Vec<[f64; 4]>,
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
            Side::Wall(patch) => boundary.patches[patch].lets_heat_through(),
            Side::Mirror | Side::Curved => false,
        });
        let exterior = boundary.curved.map(|(_, radius)| Exterior::new(&lattice, &stencil, shape, &boundary, radius));
        let sum = stencil.sum();
        let stiffness = boundary.sides.map(|side| match side {
            Side::Wall(patch) => Some(faces[patch].stiffness()),
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
        let row_patches = vec![[0.0; 4]; lattice.rows];
        let sides = boundary.sides;
        let sink_potentials = sinks.iter().map(|sink| thermal.potential_at(sink.temperature.at(0.0))).collect();
        let sink_heat = vec![0.0; sinks.len()];
        let (patch_weights, patch_own) = patch_weights(&stencil, shape, lattice.columns);
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
            patch_weights,
            patch_own,
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
            row_patches,
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
                patch_weights: around.patch_weights.clone(),
                patch_own: around.patch_own.clone(),
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
            row_patches: self.row_patches.clone(),
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
        if let (Some(exterior), Some((patch, _))) = (&around.exterior, self.boundary.curved) {
            let (face, thermal) = (&around.faces[patch], &around.thermal);
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
        if let (Some(exterior), Some((patch, _))) = (&mut around.exterior, self.boundary.curved) {
            exterior.update(&around.law, enthalpy, &around.faces[patch], thermal, around.slopes.as_ref());
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
                    let mut rest = self.row_patches.as_mut_slice();
                    let last = self.bands.len() - 1;
                    for (number, (band, target)) in self.bands.iter_mut().zip(targets).enumerate() {
                        let (patches, later) = rest.split_at_mut(band.rows.1 - band.rows.0);
                        rest = later;
                        if number < last {
                            scope.spawn(move |_| sweep(frame, band, target, patches));
                        } else {
                            sweep(frame, band, target, patches);
                        }
                    }
                });
            }
            None => sweep(&frame, &mut self.bands[0], &mut targets[0], &mut self.row_patches),
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

    /// Rates of all particles, without booking what passes the patches.
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

    /// Heat in through every patch (W), from what the sweep and the preparation left.
    fn book(&self, patches: &mut [f64]) {
        let volume = self.around.lattice.volume();
        patches.fill(0.0);
        for side in (0..4).filter(|side| self.around.open[*side]) {
            if let Side::Wall(patch) = self.boundary.sides[side] {
                patches[patch] += volume * self.row_patches.iter().map(|rates| rates[side]).collect::<Sum>().value();
            }
        }
        if let (Some(exterior), Some((patch, _))) = (&self.around.exterior, self.boundary.curved) {
            patches[patch] = volume * exterior.heat();
        }
        let walls = self.boundary.patches.len();
        for (sink, heat) in self.sinks.iter().zip(&self.sink_heat) {
            patches[walls + sink.ring] -= heat * sink.share;
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
    fn rate(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64], patches: &mut [f64]) {
        self.rates(enthalpy, time, rate);
        self.book(patches);
    }

    fn stage(&mut self, stage: &Stage, columns: &mut StageColumns<'_>, time: f64, patches: &mut [f64]) {
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
        self.book(patches);
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
        let curved = self.boundary.curved.is_some_and(|(patch, _)| self.around.faces[patch].holds() > 0.0);
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

    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, patches: &mut [f64]) {
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
        self.book(patches);
    }

    fn steepest(&self) -> Vec<f64> {
        vec![self.around.thermal.largest_slope; self.around.lattice.len()]
    }

    fn bound(&self) -> Bound {
        self.bound.clone()
    }

    fn patches(&self) -> Vec<String> {
        self.boundary.patches.iter().map(|patch| patch.name.to_string()).chain(self.rings.iter().cloned()).collect()
    }

    fn pairs(&self) -> u64 {
        (self.around.lattice.len() * self.around.stencil.neighbours() / 2) as u64
    }

    fn heap_size(&self) -> usize {
        let around = &self.around;
        let walls = total(&[&around.stencil, &around.exterior, &around.patch_weights, &around.patch_own]);
        let pipes = total(&[&self.sinks, &self.sink_potentials, &self.sink_heat]);
        let corners = self.corners.capacity() * size_of::<CornerPair>();
        let work = total(&[&self.corner_rates, &self.front, &self.bands, &self.row_patches]);
        walls + pipes + corners + work + self.tangent.as_ref().map_or(0, |tangent| tangent.heap_size())
    }
}
