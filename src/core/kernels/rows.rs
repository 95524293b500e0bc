//! The pair operator on a list: any cloud, any exchange, several materials, and a random part for those who need it.

use std::array::from_fn;

use crate::bonds::exchange::{Exchange, Mean};
use crate::bonds::pair_list::PairList;
use crate::boundary::curved_wall::{Contact, Rim};
use crate::boundary::interface::Way;
use crate::boundary::patch::{Face, MOST_PATCHES};
use crate::boundary::shells::Touch;
use crate::kernels::conducted::{Arithmetic, Conducted, Geometric, Harmonic};
use crate::kernels::crossing::{Crossing, Portion, pairs_across};
use crate::kernels::diagonal_pairs::{Columns, DiagonalPairs};
use crate::kernels::gravity::Gravity;
use crate::kernels::list_parts::ListParts;
use crate::kernels::runs::Runs;
use crate::kernels::term::{PairTerm, PairView};
use crate::ledger::Sum;
use crate::memory::{HeapSize, shared, total};
use crate::physics::latent_heat::{Fields, SchemeState};
use crate::solvers::step::Clock;
use crate::space::domain::Surface;

/// Rows that are summed side by side.
const ABREAST: usize = 4;

/// The operator.
pub struct ListRows<T> {
    pub(super) parts: ListParts,
    pub(super) term: T,
    pub(super) fields: Fields,
    pub(super) gravity: Option<Gravity>,
    pub(super) faces: Vec<Vec<Face>>,
    pub(super) sink_heat: Vec<f64>,
    /// Pairs across open patches, and the patches.
    pub(super) crossings: Vec<(Crossing, u8)>,
    /// Pairs across each surface, and the volume of the particle, negative where heat to it comes from greater coordinates.
    pub(super) across: Vec<Vec<(Crossing, f64)>>,
    /// Pairs that need no list.
    pub(super) diagonals: Option<DiagonalPairs>,
    /// The runs among the pairs, where a term beside conduction makes each pair dear.
    runs: Option<Runs>,
}

impl<T: PairTerm> ListRows<T> {
    /// An operator on the given parts with a term.
    pub fn new(parts: ListParts, term: T) -> Self {
        Self::of(parts.varied(), term, None)
    }

    /// The same with what pairs there are by diagonals off the list, where none is asked for on its own.
    pub fn by_diagonals(parts: ListParts, term: T) -> Self {
        let mut parts = parts.varied();
        let diagonals = if T::ACTIVE { None } else { DiagonalPairs::split(&mut parts) };
        Self::of(parts, term, diagonals)
    }

    fn of(parts: ListParts, term: T, diagonals: Option<DiagonalPairs>) -> Self {
        let total = parts.positions.len() + parts.ghosts.len();
        let means = parts.exchange != Exchange::Potential;
        let temperatures = means || T::ACTIVE;
        let fields = Fields {
            // Pipes take heat by potential under every exchange.
            potential: if means && parts.sinks.is_empty() { Vec::new() } else { vec![0.0; total] },
            temperature: if temperatures { vec![0.0; total] } else { Vec::new() },
            conductivity: if temperatures { vec![0.0; total] } else { Vec::new() },
        };
        let faces: Vec<Vec<Face>> = parts
            .materials
            .thermals
            .iter()
            .map(|thermal| parts.boundary.first_faces(&thermal.curve, thermal.zero_potential))
            .collect();
        let count = parts.positions.len();
        let mut crossings = Vec::new();
        for i in 0..count {
            for k in parts.pairs.starts[i]..parts.pairs.starts[i + 1] {
                if let Some(ghost) = (parts.pairs.partners[k] as usize).checked_sub(count) {
                    let portions = Portion::of(&parts, i, k, ghost).into_iter();
                    crossings.extend(
                        portions.map(|(portion, patch)| (Crossing { particle: i as u32, pair: k, portion }, patch)),
                    );
                }
            }
        }
        let across = parts.surfaces.iter().map(|surface| pairs_across(&parts, surface)).collect();
        let sink_heat = vec![0.0; parts.sinks.len()];
        let gravity = Gravity::of(&parts);
        let runs = if T::ACTIVE { Runs::of(&parts) } else { None };
        ListRows { parts, term, fields, gravity, faces, sink_heat, crossings, across, diagonals, runs }
    }

    /// Rates from the state of a scheme. `clock` feeds the term.
    pub fn rate_of(
        &mut self,
        scheme: &dyn SchemeState,
        enthalpy: &[f64],
        clock: &Clock,
        rate: &mut [f64],
        patches: &mut [f64],
    ) {
        self.bring_to(scheme, enthalpy, clock.time);
        self.term.begin(&self.fields, clock);
        let parts = &self.parts;
        patches.fill(0.0);
        // The one place where exchange and materials become types.
        match (parts.exchange, parts.materials.mixed()) {
            (Exchange::Potential, false) => match &self.gravity {
                None => self.exchange(&|o, i, j, _| o.potential_difference(i, j), rate, patches),
                Some(gravity) => {
                    let both = |o: &Self, i, j, _| o.potential_difference(i, j) + gravity.brings(i, j);
                    self.exchange(&both, rate, patches);
                }
            },
            (Exchange::Potential, true) => self.exchange(&|o, i, j, k| o.across_materials(i, j, k), rate, patches),
            (Exchange::Mean(Mean::Harmonic), _) => {
                self.exchange(&|o, i, j, _| o.by_mean::<Harmonic>(i, j), rate, patches);
            }
            (Exchange::Mean(Mean::Arithmetic), _) => {
                self.exchange(&|o, i, j, _| o.by_mean::<Arithmetic>(i, j), rate, patches);
            }
            (Exchange::Mean(Mean::Geometric), _) => {
                self.exchange(&|o, i, j, _| o.by_mean::<Geometric>(i, j), rate, patches);
            }
            (Exchange::Upstream, _) => self.exchange(&|o, i, j, _| o.by_upstream(i, j), rate, patches),
        }
        self.contact(clock.time, rate, patches);
        self.touch(rate, patches);
        let parts = &self.parts;
        let walls = parts.boundary.patches.len();
        for (sink, heat) in parts.sinks.iter().zip(&mut self.sink_heat) {
            let material = parts.materials.of(sink.sample.first().map_or(0, |entry| entry.0 as usize));
            let wall = sink.own_potential(clock.time, material);
            *heat = if sink.works(clock.time) {
                let sampled = sink.sampled(|index| self.fields.potential[index]);
                sink.heat(sampled, wall, clock.time, material)
            } else {
                0.0
            };
            let taken = *heat * sink.share;
            for (index, weight) in &sink.sample {
                rate[*index as usize] -= taken * weight / parts.volumes.of(*index as usize);
            }
            patches[walls + sink.ring] -= taken;
        }
    }

    /// Brings pairs, walls and fields to a state and a time (s).
    pub(super) fn bring_to(&mut self, scheme: &dyn SchemeState, enthalpy: &[f64], time: f64) {
        self.parts.cuts.bring_to(time, &mut self.parts.pairs.weights);
        let parts = &self.parts;
        scheme.read(&parts.materials, enthalpy, &mut self.fields);
        for (faces, thermal) in self.faces.iter_mut().zip(parts.materials.thermals.iter()) {
            parts.boundary.update_faces(faces, time, &thermal.curve, thermal.zero_potential);
        }
        if !self.fields.potential.is_empty() {
            parts.ghosts.fill_potentials(&mut self.fields.potential, &self.faces, &parts.materials, &parts.chains);
        }
        if let Some(gravity) = &mut self.gravity {
            gravity.bring_to(parts, enthalpy, &self.fields.potential, &self.faces);
        }
        if !self.fields.temperature.is_empty() {
            let (temperature, conductivity) = (&mut self.fields.temperature, &mut self.fields.conductivity);
            parts.ghosts.fill_temperatures(temperature, conductivity, &self.faces, &parts.materials);
        }
    }

    /// Heat rate (W/m3) that a particle gains from a wall that touches it.
    fn touched(&self, number: usize) -> f64 {
        let (materials, fields, touch) = (&self.parts.materials, &self.fields, &self.parts.touches[number]);
        let (particle, patch) = (touch.particle as usize, touch.patch as usize);
        let face = &self.faces[materials.index(particle)][patch];
        let flux = match self.parts.exchange {
            Exchange::Potential => {
                let way = self.parts.chains.of_touch(number, &materials.thermals);
                self.through_wall(way, (particle, fields.potential[particle]), patch, touch.depth)
            }
            Exchange::Mean(_) | Exchange::Upstream => {
                let (temperature, conductivity) = (fields.temperature[particle], fields.conductivity[particle]);
                face.flux_by_temperature(temperature, conductivity, touch.depth, &materials.of(particle).curve)
            }
        };
        touch.area * flux
    }

    /// Flux (W/m2) through a wall into a particle of a potential (W/m) at a depth (m) behind it, by what lies between them.
    #[inline]
    fn through_wall(&self, way: Option<Way<'_>>, (particle, potential): (usize, f64), patch: usize, depth: f64) -> f64 {
        let materials = &self.parts.materials;
        match way {
            None => {
                let material = materials.index(particle);
                self.faces[material][patch].flux(potential, depth, &materials.thermals[material])
            }
            Some(way) => way.wall(&self.faces[way.near()][patch], depth, potential).1,
        }
    }

    /// Adds what walls give that touch a body of shells.
    fn touch(&self, rate: &mut [f64], patches: &mut [f64]) {
        for (number, touch) in self.parts.touches.iter().enumerate() {
            let particle = touch.particle as usize;
            let gain = self.touched(number);
            rate[particle] += gain;
            patches[touch.patch as usize] += gain * self.parts.volumes.of(particle);
        }
    }

    /// Curved walls that are there at a time (s), with their numbers.
    pub(super) fn standing(&self, time: f64) -> impl Iterator<Item = (usize, &Rim)> {
        self.parts.rims.iter().enumerate().filter(move |(_, rim)| rim.stands(time))
    }

    /// Adds what curved walls give that are there at a time (s).
    fn contact(&self, time: f64, rate: &mut [f64], patches: &mut [f64]) {
        let (materials, fields) = (&self.parts.materials, &self.fields);
        for (number, Rim { patch, contacts, .. }) in self.standing(time) {
            let by_potential = |contact: &Contact, particle: usize, depth: f64| {
                let way = self.parts.chains.of_rim(number, particle, &materials.thermals);
                let potential = |particle: usize| fields.potential[particle];
                let seen = contact.seen(potential(contact.particle as usize), potential(particle));
                self.through_wall(way, (particle, seen), *patch, depth)
            };
            let by_temperature = |particle: usize, depth: f64| {
                let (temperature, conductivity) = (fields.temperature[particle], fields.conductivity[particle]);
                let curve = &materials.of(particle).curve;
                self.faces[0][*patch].flux_by_temperature(temperature, conductivity, depth, curve)
            };
            let mut sum = Sum::default();
            for contact in &contacts.contacts {
                let gain = match self.parts.exchange {
                    Exchange::Potential => {
                        contacts.gain(contact, |particle, depth| by_potential(contact, particle, depth))
                    }
                    Exchange::Mean(_) | Exchange::Upstream => contacts.gain(contact, by_temperature),
                };
                rate[contact.particle as usize] += gain;
                sum.add(gain);
            }
            patches[*patch] = sum.value() * self.parts.volumes.unit();
        }
    }

    #[inline(always)]
    fn exchange<F>(&self, conducted: &F, rate: &mut [f64], patches: &mut [f64])
    where
        F: Fn(&Self, usize, usize, usize) -> f64 + Sync,
    {
        let pairs = &self.parts.pairs;
        let means = self.parts.exchange != Exchange::Potential;
        let values = if means { &self.fields.temperature } else { &self.fields.potential };
        let columns = Columns { values, conductivity: &self.fields.conductivity };
        match &self.diagonals {
            None => {
                let listed = self.runs.as_ref().map_or(pairs, |runs| &runs.rest);
                self.parts.in_tasks(rate, |first, rates| {
                    let end = first + rates.len();
                    self.in_groups(listed, conducted, first..end, |row, sum| rates[row - first] = sum);
                });
            }
            Some(diagonals) => {
                self.parts.in_tasks_of(diagonals.share(self.parts.threads()), rate, |first, rates| {
                    diagonals.gather(&columns, first, rates);
                    let rows = diagonals.listed(first, rates.len());
                    self.in_groups(pairs, conducted, rows, |row, sum| rates[row - first] += sum);
                });
            }
        }
        if let Some(runs) = &self.runs {
            runs.add((self.parts.exchange, self.parts.team.as_ref()), &self.term, &self.fields, rate);
        }
        let mut sums = [Sum::default(); MOST_PATCHES];
        for (Crossing { particle, pair: k, portion }, patch) in &self.crossings {
            let (i, k) = (*particle as usize, *k);
            let up_to = |image: u32| pairs.weights[k] * conducted(self, i, image as usize, k);
            let all = || self.flux(conducted, i, pairs.partners[k] as usize, pairs.weights[k], k);
            let flux = match *portion {
                Portion::All => all(),
                Portion::UpTo(image) => up_to(image),
                Portion::From(image) => all() - up_to(image),
            };
            sums[*patch as usize].add(flux * self.parts.volumes.share(i));
        }
        for (patch, sum) in patches.iter_mut().zip(&sums).take(self.parts.boundary.patches.len()) {
            *patch = sum.value() * self.parts.volumes.unit();
        }
    }

    /// Hands on what the pairs of each of some rows of a list give its particle (W/m3).
    #[inline(always)]
    fn in_groups<F>(
        &self,
        pairs: &PairList,
        conducted: &F,
        mut rows: impl ExactSizeIterator<Item = usize>,
        mut give: impl FnMut(usize, f64),
    ) where
        F: Fn(&Self, usize, usize, usize) -> f64,
    {
        while rows.len() >= ABREAST {
            let group: [usize; ABREAST] = from_fn(|_| rows.next().unwrap_or(0));
            let sums = self.rows(pairs, conducted, group);
            group.into_iter().zip(sums).for_each(|(row, sum)| give(row, sum));
        }
        for row in rows {
            let [sum] = self.rows(pairs, conducted, [row]);
            give(row, sum);
        }
    }

    /// What the pairs of some rows of a list give their particles (W/m3). Each sum runs in the order of its row; side by side they
    /// need not wait for their own last term.
    #[inline(always)]
    fn rows<const N: usize, F>(&self, pairs: &PairList, conducted: &F, own: [usize; N]) -> [f64; N]
    where
        F: Fn(&Self, usize, usize, usize) -> f64,
    {
        let starts: [usize; N] = own.map(|row| pairs.starts[row]);
        let partners: [&[u32]; N] = from_fn(|row| &pairs.partners[starts[row]..pairs.starts[own[row] + 1]]);
        let weights: [&[f64]; N] = from_fn(|row| &pairs.weights[starts[row]..starts[row] + partners[row].len()]);
        let common = partners.iter().map(|row| row.len()).min().unwrap_or(0);
        let mut sums = [0.0; N];
        let heads: [(&[u32], &[f64]); N] = from_fn(|row| (&partners[row][..common], &weights[row][..common]));
        for k in 0..common {
            for row in 0..N {
                let (j, weight) = (heads[row].0[k] as usize, heads[row].1[k]);
                sums[row] += self.flux(conducted, own[row], j, weight, starts[row] + k);
            }
        }
        for row in 0..N {
            for k in common..partners[row].len() {
                let (j, weight) = (partners[row][k] as usize, weights[row][k]);
                sums[row] += self.flux(conducted, own[row], j, weight, starts[row] + k);
            }
        }
        sums
    }

    /// What pair `k` of particle `i` with `j` gives `i` (W/m3).
    #[inline(always)]
    fn flux<F: Fn(&Self, usize, usize, usize) -> f64>(
        &self,
        conducted: &F,
        i: usize,
        j: usize,
        weight: f64,
        k: usize,
    ) -> f64 {
        let conducted = conducted(self, i, j, k);
        if !T::ACTIVE {
            return weight * conducted;
        }
        let count = self.parts.positions.len();
        let (name, stream) = match j.checked_sub(count) {
            None => (j as u32, 0),
            Some(ghost) => (self.parts.ghosts.identity[ghost], self.parts.ghosts.stream[ghost]),
        };
        let between = self.way(k).map(|way| way.conductivity());
        let (indices, fields) = ((i, j), &self.fields);
        let view = PairView { names: (i as u32, name), stream, weight, conducted, between, indices, fields };
        weight * conducted + self.term.add(&view)
    }

    /// What a pair conducts, whatever the exchange.
    fn conducted(&self, i: usize, j: usize, k: usize) -> f64 {
        match (self.parts.exchange, self.parts.materials.mixed()) {
            (Exchange::Potential, false) => {
                self.potential_difference(i, j) + self.gravity.as_ref().map_or(0.0, |gravity| gravity.brings(i, j))
            }
            (Exchange::Potential, true) => self.across_materials(i, j, k),
            (Exchange::Mean(Mean::Harmonic), _) => self.by_mean::<Harmonic>(i, j),
            (Exchange::Mean(Mean::Arithmetic), _) => self.by_mean::<Arithmetic>(i, j),
            (Exchange::Mean(Mean::Geometric), _) => self.by_mean::<Geometric>(i, j),
            (Exchange::Upstream, _) => self.by_upstream(i, j),
        }
    }

    /// Adds a share of what each entry of the rows gives its particle (W/m3) at the last state.
    pub(super) fn add_flows(&self, share: f64, flows: &mut [f64]) {
        let pairs = &self.parts.pairs;
        for i in 0..self.parts.positions.len() {
            for k in pairs.starts[i]..pairs.starts[i + 1] {
                flows[k] += share * pairs.weights[k] * self.conducted(i, pairs.partners[k] as usize, k);
            }
        }
    }

    /// Heat (W) through each surface, towards greater coordinates, at the last state.
    pub fn across(&self, heat: &mut [f64]) {
        let pairs = &self.parts.pairs;
        let of_pair = |(Crossing { particle, pair, portion }, volume): &(Crossing, f64)| {
            let to = |j: u32| self.conducted(*particle as usize, j as usize, *pair);
            let all = pairs.partners[*pair];
            let conducted = match *portion {
                Portion::All => to(all),
                Portion::UpTo(image) => to(image),
                Portion::From(image) => to(all) - to(image),
            };
            volume * pairs.weights[*pair] * conducted
        };
        // A wall touches the outermost particles from beyond surfaces that lie nearer to it.
        let walls = |surface: &Surface| {
            let near = self.parts.touches.iter().enumerate().filter(|(_, touch)| {
                let beyond = surface.is_beyond(self.parts.positions[touch.particle as usize]);
                touch.across_y == surface.across_y && touch.at_end != beyond
            });
            near.map(|(number, touch)| {
                let heat = self.touched(number) * self.parts.volumes.of(touch.particle as usize);
                if touch.at_end { -heat } else { heat }
            })
            .sum::<f64>()
        };
        let pairs = self.across.iter().map(|pairs| pairs.iter().map(of_pair).collect::<Sum>().value());
        for ((heat, pairs), surface) in heat.iter_mut().zip(pairs).zip(&self.parts.surfaces) {
            *heat = pairs + walls(surface);
        }
    }

    #[inline(always)]
    fn potential_difference(&self, i: usize, j: usize) -> f64 {
        self.fields.potential[j] - self.fields.potential[i]
    }

    #[inline(always)]
    fn by_mean<C: Conducted>(&self, i: usize, j: usize) -> f64 {
        let difference = self.fields.temperature[j] - self.fields.temperature[i];
        C::mean(self.fields.conductivity[i], self.fields.conductivity[j]) * difference
    }

    #[inline(always)]
    fn by_upstream(&self, i: usize, j: usize) -> f64 {
        let difference = self.fields.temperature[j] - self.fields.temperature[i];
        self.fields.conductivity[if difference > 0.0 { j } else { i }] * difference
    }

    /// What lies between the ends of a pair, if that is of several materials.
    #[inline(always)]
    pub(super) fn way(&self, pair: usize) -> Option<Way<'_>> {
        self.parts.chains.of_pair(pair, &self.parts.materials.thermals)
    }

    /// What a pair conducts that may reach through several materials.
    #[inline]
    fn across_materials(&self, i: usize, j: usize, k: usize) -> f64 {
        let potential = &self.fields.potential;
        match self.way(k) {
            None => self.potential_difference(i, j),
            // Exchanging i and j must only turn the sign, so chains always see them in the same order.
            Some(way) if i < j => way.conducted(potential[i], potential[j]),
            Some(way) => -way.conducted(potential[j], potential[i]),
        }
    }
}

impl<T: PairTerm> HeapSize for ListRows<T> {
    fn heap_size(&self) -> usize {
        let parts = &self.parts;
        let fields = total(&[&self.fields.potential, &self.fields.temperature, &self.fields.conductivity]);
        let pairs = total(&[&parts.pairs.starts, &parts.pairs.partners, &parts.pairs.weights]);
        // Its copy of the materials of particles, and positions even of those on a lattice.
        let copies = shared(&parts.positions) + parts.materials.of_particle.heap_size();
        copies
            + pairs
            + self.term.heap_size()
            + parts.chains.heap_size()
            + parts.cuts.heap_size()
            + parts.ghosts.heap_size()
            + fields
            + self.runs.heap_size()
            + self.gravity.as_ref().map_or(0, HeapSize::heap_size)
            + self.crossings.heap_size()
            + self.across.iter().map(HeapSize::heap_size).sum::<usize>()
            + self.diagonals.as_ref().map_or(0, HeapSize::heap_size)
            + parts.rims.iter().map(|rim| rim.contacts.heap_size()).sum::<usize>()
            + parts.touches.capacity() * size_of::<Touch>()
            + parts.sinks.heap_size()
            + self.sink_heat.heap_size()
    }
}
