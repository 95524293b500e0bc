//! The pair operator on a lattice: one fused sweep a step, no neighbour list.

use crate::boundary::patch::{Boundary, Face, Side};
use crate::boundary::pipe::Sink;
use crate::kernels::around::{Around, patch_weights};
use crate::kernels::corner::{CornerPair, lattice_pairs};
use crate::kernels::exterior::Exterior;
use crate::kernels::irregular::IrregularRows;
use crate::kernels::lattice_bands::{read_some, share, take_some, threads};
use crate::kernels::lattice_parts::{LatticeParts, Stiffness, bands};
use crate::kernels::sweep::{Band, Frame, Shape, Weights, sweep};
use crate::kernels::target::{self, Beside, Chained, InPlace, Target};
use crate::ledger::Source;
use crate::ledger::Sum;
use crate::memory::HeapSize;
use crate::physics::latent_heat::Materials;
use crate::physics::laws::Laws;
use crate::physics::potential::Identity;
use crate::physics::sub_cell::SubCellFront;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::{Balance, BalanceFacts, Rates, Stage, StageColumns, Tangent, TangentShape, Update};
use crate::solvers::kept::Kept;
use crate::solvers::step::Clock;
use crate::space::lattice::Lattice;
use crate::team::Team;

/// The operator, monomorphised over the laws of its particles.
pub struct LatticeBalance<L> {
    pub(super) around: Around<L>,
    pub(super) boundary: Boundary,
    pub(super) weights: Weights,
    pub(super) sinks: Vec<Sink>,
    pub(super) sink_potentials: Vec<f64>,
    pub(super) sink_heat: Vec<f64>,
    pub(super) corners: Vec<CornerPair>,
    pub(super) corner_rates: Vec<f64>,
    pub(super) front: Option<SubCellFront>,
    /// Rows that the stencil does not know.
    pub(super) irregular: Option<Box<IrregularRows>>,
    /// Rows at the surfaces through which heat is counted.
    pub(super) observed: Option<Box<IrregularRows>>,
    pub(super) bands: Vec<Band>,
    pub(super) row_patches: Vec<[f64; 4]>,
    /// Whether the stencil, walls that do not change and fronts are all there is, and one band.
    pub(super) is_bare: bool,
    pub(super) team: Option<Team>,
    /// Volume of a particle (m^d).
    pub(super) volume: f64,
    pub(super) facts: BalanceFacts,
    /// The same operator for small changes of potentials, once it was asked for.
    pub(super) tangent: Option<Box<LatticeBalance<Identity>>>,
    /// Time (s) of the last linearisation.
    pub(super) linear_time: f64,
}

impl<L: Laws> LatticeBalance<L> {
    /// An operator on the given parts, with the laws of their particles.
    pub fn new(parts: LatticeParts, laws: L) -> Self {
        let LatticeParts { lattice, stencil, materials, boundary, team, .. } = parts;
        let shape = Shape::new(lattice.columns, stencil.reach, lattice.dimension == 1);
        let open = boundary.sides.map(|side| matches!(side, Side::Wall(_)) && !boundary.mirrors(side));
        let (patch_weights, patch_own) = patch_weights(&stencil, shape, lattice.columns);
        let material_at = material_at(&boundary, &lattice, &materials);
        let mut around = Around {
            shape,
            laws,
            sides: boundary.sides,
            open,
            walls_meet: (open[0] || open[1]) && (open[2] || open[3]),
            faces: boundary.patches.iter().map(|_| Face::Even).collect(),
            slopes: None,
            ends: None,
            exterior: Exterior::new((&lattice, shape), &stencil, &boundary, (&materials, parts.front.is_some())),
            patch_weights,
            patch_own,
            lattice,
            stencil,
            materials,
            material_at,
        };
        around.update_faces(&boundary, 0.0, true);
        let stiffness = boundary.sides.map(|side| match side {
            Side::Wall(patch) => Some(around.faces[patch].stiffness()),
            Side::Mirror => Some(-1.0),
            Side::Periodic | Side::Curved => None,
        });
        let corners = lattice_pairs(&around.lattice, &around.stencil, stiffness);
        let stiffness = Stiffness {
            around: &around,
            boundary: &boundary,
            irregular: parts.irregular.as_deref(),
            sinks: &parts.sinks,
            corners: &corners,
            front: parts.front.as_ref(),
        };
        let derived = stiffness.bound();
        let bands = bands(&around.lattice, threads(&team, &around), shape);
        let is_bare = parts.sinks.is_empty()
            && corners.is_empty()
            && parts.irregular.is_none()
            && around.exterior.is_none()
            && boundary.patches.iter().all(|wall| !wall.changes)
            && boundary.patches.len() == boundary.sides.iter().filter(|side| matches!(side, Side::Wall(_))).count()
            && shape.reach_rows == 0;
        let potential = |sink: &Sink| sink.own_potential(0.0, around.thermal_at_sink(sink));
        let walls = boundary.patches.iter().map(|patch| Source::Patch(patch.id));
        let facts = BalanceFacts {
            patches: walls.chain(Source::rings(parts.rings)).collect(),
            pairs: (around.lattice.len() * around.stencil.neighbours() / 2) as u64,
            surfaces: parts.observed.as_deref().map_or(0, IrregularRows::surfaces),
            bound: parts.bound.unwrap_or(derived),
            turning: 0.0,
        };
        LatticeBalance {
            weights: Weights::new(&around.stencil),
            volume: around.lattice.volume(),
            sink_potentials: parts.sinks.iter().map(potential).collect(),
            sink_heat: vec![0.0; parts.sinks.len()],
            sinks: parts.sinks,
            corner_rates: vec![0.0; corners.len()],
            corners,
            front: parts.front.map(|front| front.shared_among(bands.len())),
            irregular: parts.irregular,
            observed: parts.observed,
            row_patches: vec![[0.0; 4]; around.lattice.rows],
            is_bare,
            team: if bands.len() > 1 { team } else { None },
            bands,
            facts,
            tangent: None,
            linear_time: 0.0,
            boundary,
            around,
        }
    }

    /// Brings ghosts, pipes and the rows around each band to the given state.
    #[inline(always)]
    fn prepare(&mut self, enthalpy: &[f64], time: f64) {
        // What is not there need not be asked for one by one: a short line is made in less time.
        if !self.is_bare {
            self.prepare_all(enthalpy, time);
        }
        if let Some(front) = &mut self.front {
            front.update(self.team.as_ref(), &self.around.lattice, enthalpy, &self.around.laws);
        }
    }

    fn prepare_all(&mut self, enthalpy: &[f64], time: f64) {
        let around = &mut self.around;
        around.update_faces(&self.boundary, time, false);
        around.update_exterior(self.team.as_ref(), &self.boundary, enthalpy);
        let around = &self.around;
        for ((sink, potential), heat) in self.sinks.iter().zip(&mut self.sink_potentials).zip(&mut self.sink_heat) {
            let thermal = around.thermal_at_sink(sink);
            if sink.condition.series().changes() {
                *potential = sink.own_potential(time, thermal);
            }
            *heat = if sink.works(time) {
                let sampled = sink.sampled(|index| around.laws.potential_of(index, enthalpy[index]));
                sink.heat(sampled, *potential, time, thermal)
            } else {
                0.0
            };
        }
        for (pair, rate) in self.corners.iter().zip(&mut self.corner_rates) {
            let potential = |index: u32| around.laws.potential_of(index as usize, enthalpy[index as usize]);
            *rate = pair.weight * (potential(pair.second) - potential(pair.first));
        }
        match (&mut self.irregular, &around.slopes) {
            (Some(irregular), None) => irregular.evaluate(enthalpy, time),
            (Some(irregular), Some(_)) => irregular.act(enthalpy),
            (None, _) => {}
        }
        let reach_rows = around.shape.reach_rows;
        let fill = |band: &mut Band| {
            let (first, end) = band.rows;
            for k in 0..reach_rows {
                let row = first as i64 - (reach_rows - k) as i64;
                around.fill_any(row, enthalpy, band.below.row(k));
                around.fill_any((end + k) as i64, enthalpy, band.above.row(k));
            }
        };
        // A few rows a band: less work than a second hand-over between threads.
        self.bands.iter_mut().for_each(fill);
    }

    /// Keeps what the rates of irregular rows are to be added to.
    fn keep(&mut self, base: impl Fn(usize) -> f64) {
        if let Some(irregular) = &mut self.irregular {
            irregular.keep(base);
        }
    }

    /// Sweeps all bands; `target` is asked for that of each, in their order, by how many particles it has.
    #[inline(always)]
    fn sweep<T: Target + Send>(&mut self, mut target: impl FnMut(usize) -> T) {
        let around = &self.around;
        let frame = Frame {
            shape: around.shape,
            lattice: &around.lattice,
            weights: &self.weights,
            laws: &around.laws,
            surroundings: around,
        };
        match &self.team {
            Some(team) => share(team, &frame, &mut self.bands, target, &mut self.row_patches),
            None => sweep(&frame, &mut self.bands[0], &mut target(around.lattice.len()), &mut self.row_patches),
        }
    }

    /// One step of explicit Euler in place.
    #[inline]
    fn euler(&mut self, enthalpy: &mut [f64], clock: &Clock) {
        let step = clock.step;
        self.prepare(enthalpy, clock.time);
        self.keep(|particle| enthalpy[particle]);
        let mut rest = &mut *enthalpy;
        self.sweep(|count| InPlace { enthalpy: take_some(&mut rest, count), step });
        self.complete(enthalpy, step);
    }

    /// The same with what rounding takes from it kept for the next; only where nothing but fronts is added to what the stencil finds.
    fn euler_keeping(&mut self, enthalpy: &mut [f64], lost: &mut [f64], clock: &Clock) {
        let step = clock.step;
        self.prepare(enthalpy, clock.time);
        let (mut rest, mut rest_lost) = (&mut *enthalpy, &mut *lost);
        self.sweep(|count| {
            let (enthalpy, lost) = (take_some(&mut rest, count), take_some(&mut rest_lost, count));
            target::Kept { enthalpy, lost, step }
        });
        if let Some(front) = &self.front {
            front.add_keeping(enthalpy, lost, step);
        }
    }

    /// One stage of a chain, its rate taken at a time (s).
    fn stage(&mut self, stage: &Stage, columns: &mut StageColumns<'_>, time: f64) {
        self.prepare(columns.newest, time);
        self.keep(|particle| {
            let states = (columns.newest[particle], columns.oldest[particle], columns.start[particle]);
            stage.without_rate(states, columns.first[particle])
        });
        let StageColumns { mut newest, ref mut oldest, mut start, mut first } = *columns;
        let mut rest = &mut **oldest;
        self.sweep(|count| {
            let [newest, start, first] = [&mut newest, &mut start, &mut first].map(|column| read_some(column, count));
            let columns = StageColumns { newest, oldest: take_some(&mut rest, count), start, first };
            Chained { stage: *stage, columns }
        });
        self.complete(columns.oldest, stage.rate);
    }

    /// Rates of all particles, without booking what passes the patches.
    pub(super) fn rates(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64]) {
        self.prepare(enthalpy, time);
        self.keep(|_| 0.0);
        let (mut from, mut into) = (enthalpy, &mut *rate);
        self.sweep(|count| Beside { enthalpy: read_some(&mut from, count), rate: take_some(&mut into, count) });
        self.complete(rate, 1.0);
    }

    /// Heat in through every patch (W), from what the sweep and the preparation left.
    #[inline]
    fn book(&self, patches: &mut [f64]) {
        if !self.is_bare {
            return self.book_all(patches);
        }
        for side in 0..2 {
            if let Side::Wall(patch) = self.boundary.sides[side] {
                patches[patch] = if self.around.open[side] { self.volume * self.row_patches[0][side] } else { 0.0 };
            }
        }
    }

    fn book_all(&self, patches: &mut [f64]) {
        let volume = self.volume;
        patches.fill(0.0);
        for side in (0..4).filter(|side| self.around.open[*side]) {
            if let Side::Wall(patch) = self.boundary.sides[side] {
                patches[patch] += volume * self.row_patches.iter().map(|rates| rates[side]).collect::<Sum>().value();
            }
        }
        if let (Some(exterior), Some((patch, _))) = (&self.around.exterior, self.boundary.curved) {
            patches[patch] = volume * exterior.heat();
        }
        if let Some(irregular) = &self.irregular {
            irregular.book(patches);
        }
        let walls = self.boundary.patches.len();
        for (sink, heat) in self.sinks.iter().zip(&self.sink_heat) {
            patches[walls + sink.ring] -= heat * sink.share;
        }
    }

    /// Adds to the rates of a sweep, scaled, what no stencil knows.
    #[inline(always)]
    fn complete(&self, rates: &mut [f64], scale: f64) {
        if !self.is_bare {
            self.complete_all(rates, scale);
        }
        if let Some(front) = &self.front {
            front.add(rates, scale);
        }
    }

    fn complete_all(&self, rates: &mut [f64], scale: f64) {
        if let Some(irregular) = &self.irregular {
            irregular.settle(rates, scale);
        }
        self.sink(rates, scale);
        for (pair, rate) in self.corners.iter().zip(&self.corner_rates) {
            rates[pair.first as usize] += scale * rate;
            rates[pair.second as usize] -= scale * rate;
        }
        if let Some(exterior) = &self.around.exterior {
            exterior.add(rates, scale);
        }
    }

    /// Takes the heat of the pipes from `rates`, scaled.
    #[inline]
    fn sink(&self, rates: &mut [f64], scale: f64) {
        for (sink, heat) in self.sinks.iter().zip(&self.sink_heat) {
            let taken = scale * heat * sink.share / self.volume;
            for (index, weight) in &sink.sample {
                rates[*index as usize] -= taken * weight;
            }
        }
    }
}

/// The material at each patch, by index, for patches within whose reach there is one alone.
fn material_at(boundary: &Boundary, lattice: &Lattice, materials: &Materials) -> Vec<u8> {
    let mut found = vec![0; boundary.patches.len()];
    let rows = lattice.rows;
    let beside = [0, lattice.start(1) - 1, 0, lattice.start(rows - 1)];
    for (side, particle) in boundary.sides.iter().zip(beside) {
        if let Side::Wall(patch) = side {
            found[*patch] = materials.index(particle) as u8;
        }
    }
    if let Some((patch, _)) = boundary.curved {
        found[patch] = materials.index(lattice.start(1) - 1) as u8;
    }
    found
}

impl<L: Laws> Balance for LatticeBalance<L> {
    fn facts(&self) -> &BalanceFacts {
        &self.facts
    }

    fn next_kink(&self, enthalpy: &[f64], rates: &[f64], within: f64) -> f64 {
        self.front.as_ref().map_or(f64::INFINITY, |front| front.next_kink(enthalpy, rates, within, &self.around.laws))
    }

    fn team(&self) -> Option<&Team> {
        self.team.as_ref()
    }

    fn rate(&mut self, enthalpy: &[f64], clock: &Clock, rates: &mut Rates<'_>) {
        self.rates(enthalpy, clock.time, rates.of_particles);
        self.book(rates.patches);
        if let (Some(observed), false) = (&mut self.observed, rates.surfaces.is_empty()) {
            observed.across(enthalpy, clock.time, rates.surfaces);
        }
    }

    fn advance(&mut self, update: Update<'_, '_>, clock: &Clock, patches: &mut [f64]) {
        match update {
            Update::Euler(enthalpy) => self.euler(enthalpy, clock),
            Update::Stage(stage, columns) => self.stage(stage, columns, clock.time),
        }
        self.book(patches);
    }

    fn advance_keeping(&mut self, contents: &mut [f64], kept: &mut Kept, clock: &Clock, patches: &mut [f64]) {
        let alone = self.sinks.is_empty() && self.corners.is_empty() && self.around.exterior.is_none();
        if alone && self.irregular.is_none() {
            self.euler_keeping(contents, &mut kept.lost, clock);
        } else {
            self.rates(contents, clock.time, kept.rates(contents.len()));
            kept.add(contents, clock.step);
        }
        self.book(patches);
    }

    fn tangent(&mut self) -> &mut dyn Tangent {
        self
    }
}

impl<L: Laws> Tangent for LatticeBalance<L> {
    fn shape(&mut self) -> TangentShape {
        let Around { lattice, shape, faces, .. } = &self.around;
        let irregular = self.irregular.as_deref();
        // Particles see a curved wall through others, and behind a film deeper ghosts, and those of neighbours, follow otherwise.
        let one_each = shape.reach == 1 && self.around.stencil.at(1, 1) == 0.0;
        let film = (0..4).any(|side| self.around.face(side).bends());
        let curved = self.boundary.curved.is_some_and(|(patch, _)| faces[patch].holds() > 0.0);
        let symmetric = irregular.is_none_or(IrregularRows::is_symmetric);
        let scheduled = !self.sinks.iter().all(Sink::is_constant);
        let constant = irregular.is_none_or(IrregularRows::is_constant) && self.boundary.is_linear();
        let far = irregular.is_some_and(IrregularRows::has_rims) || self.around.sees_far() || !self.sinks.is_empty();
        let by_pairs = shape.reach_rows * lattice.columns + shape.reach.min(lattice.columns);
        TangentShape {
            is_symmetric: symmetric && !curved && (one_each || !film) && self.front.is_none(),
            is_constant: constant && !scheduled && self.front.is_none(),
            is_steep: false,
            bandwidth: if far { lattice.len() } else { by_pairs.min(lattice.len()) },
        }
    }

    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]) {
        self.linearise_at(enthalpy, time, slopes);
    }

    fn act(&mut self, potentials: &[f64], rate: &mut [f64]) {
        match &mut self.tangent {
            Some(tangent) => {
                std::mem::swap(&mut tangent.irregular, &mut self.irregular);
                let changes = self.front.as_mut().map_or(potentials, |front| front.hold_back(potentials));
                tangent.rates(changes, self.linear_time, rate);
                std::mem::swap(&mut tangent.irregular, &mut self.irregular);
                if let Some(front) = &self.front {
                    front.act(rate);
                }
            }
            None => rate.fill(0.0),
        }
    }

    fn steepest(&mut self) -> Vec<f64> {
        (0..self.around.lattice.len()).map(|i| self.around.materials.of(i).largest_slope).collect()
    }

    fn take(&self, state: &mut [f64], changes: &[f64], slopes: &[f64], (weight, row_sum): (f64, f64)) {
        self.around.materials.take(state, changes, slopes, (weight * row_sum, 0.0));
    }
}

impl<L> Saved for LatticeBalance<L> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        for rows in [&mut self.irregular, &mut self.observed].into_iter().flatten() {
            rows.pass(pass);
        }
    }
}

impl<L> HeapSize for LatticeBalance<L> {
    fn heap_size(&self) -> usize {
        let around = &self.around;
        let walls = around.exterior.heap_size() + around.patch_weights.heap_size() + around.patch_own.heap_size();
        let pipes = self.sinks.heap_size() + self.sink_potentials.heap_size() + self.sink_heat.heap_size();
        let corners = self.corners.capacity() * size_of::<CornerPair>() + self.corner_rates.heap_size();
        let tangent = self.front.heap_size() + self.tangent.as_ref().map_or(0, |tangent| tangent.heap_size());
        let rows = self.irregular.heap_size() + self.observed.heap_size() + around.materials.of_particle.heap_size();
        let bands = self.bands.heap_size() + self.row_patches.heap_size();
        around.stencil.heap_size() + walls + pipes + corners + bands + tangent + rows
    }
}
