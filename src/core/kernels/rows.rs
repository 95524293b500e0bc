//! The pair operator on a list: any cloud, any exchange, several materials, and a random part for those who need it.

use crate::bonds::pair_list::PairList;
use crate::boundary::patch::MOST_DOORS;
use std::sync::Arc;

use glam::DVec2;
use rayon::ThreadPool;
use rayon::prelude::*;

use crate::bonds::exchange::{Exchange, Mean};
use crate::boundary::curved_wall::Rim;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::interface::{Chains, Way};
use crate::boundary::patch::{Boundary, Face};
use crate::boundary::pipe::Sink;
use crate::boundary::shells::Touch;
use crate::breakage::crack::Cuts;
use crate::ledger::Sum;
use crate::memory::{Held, shared};
use crate::physics::uptake::{Fields, LatentScheme, Materials};
use crate::solvers::operator::{Operator, Stage, StageColumns};
use crate::solvers::step::{Bound, Clock};
use crate::space::domain::Surface;
use crate::space::volumes::Volumes;

/// Particles that one task handles; fixed, so that results do not depend on the number of threads.
const TASK: usize = 2048;

/// A term beside conduction: eDPD's random heat flux. Off by type where it is [`Off`].
pub trait PairTerm: Held + Clone + Send + Sync + 'static {
    /// Whether the term needs temperatures and conductivities of particles.
    const ACTIVE: bool;
    /// Prepares the term for a step.
    fn begin(&mut self, clock: &Clock);
    /// What the term adds to `weight * conducted`, from partner to particle (W/m3).
    fn add(&self, pair: &PairView<'_>) -> f64;
}

/// A pair as a term sees it.
pub struct PairView<'a> {
    /// Noise names of particle and partner.
    pub names: (u32, u32),
    /// Tells images of one partner apart.
    pub stream: u32,
    /// Weight by volume (m^-2).
    pub weight: f64,
    /// Conducted potential difference (W/m).
    pub conducted: f64,
    /// Least and greatest conductivity (W/mK) of what lies between them, where that is of several materials.
    pub between: Option<(f64, f64)>,
    /// Particle and partner.
    pub indices: (usize, usize),
    /// State.
    pub fields: &'a Fields,
}

/// What of a pair's heat goes a way: in corners a ghost is the image of another one, and the heat to that passes the
/// other's wall.
#[derive(Debug, Clone, Copy)]
enum Portion {
    All,
    /// As far as the ghost that the partner is an image of.
    UpTo(u32),
    /// From there on.
    From(u32),
}

/// A pair of which something passes a door or a surface.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    particle: u32,
    /// Position in the list.
    pair: usize,
    portion: Portion,
}

impl Held for Crossing {
    fn held(&self) -> usize {
        0
    }
}

impl Portion {
    /// The portions of a pair of particle `i` with a ghost, each with the door that it passes.
    fn of(parts: &ListParts, i: usize, k: usize, ghost: usize) -> Vec<(Portion, u8)> {
        let (count, ghosts, materials) = (parts.positions.len(), &parts.ghosts, &parts.materials);
        let Some(door) = ghosts.pays[ghost] else { return Vec::new() };
        let corner = ghosts.original(ghost).filter(|_| ghosts.share(ghost) < 1.0).and_then(|image| {
            let parent = (image as usize).checked_sub(count)?;
            let first = ghosts.pays[parent].filter(|first| *first != door)?;
            // Potentials of other materials say nothing of this pair.
            let alike = materials.index(i) == ghosts.material(parent, materials);
            let plain = parts.chains.of_pair(k, &materials.thermals).is_none();
            (alike && plain).then_some((image, first))
        });
        match corner {
            None => vec![(Portion::All, door)],
            Some((image, first)) => vec![(Portion::UpTo(image), first), (Portion::From(image), door)],
        }
    }
}

/// No term.
#[derive(Debug, Clone, Copy)]
pub struct Off;

impl Held for Off {
    fn held(&self) -> usize {
        0
    }
}

impl PairTerm for Off {
    const ACTIVE: bool = false;

    fn begin(&mut self, _clock: &Clock) {}

    #[inline(always)]
    fn add(&self, _pair: &PairView<'_>) -> f64 {
        0.0
    }
}

/// Everything a list operator is made from.
#[derive(Clone)]
pub struct ListParts {
    /// Positions of particles (m).
    pub positions: Arc<[DVec2]>,
    /// Volumes of particles.
    pub volumes: Volumes,
    /// Spacing (m).
    pub spacing: f64,
    /// Materials.
    pub materials: Materials,
    /// Pairs.
    pub pairs: PairList,
    /// Those of several materials.
    pub chains: Chains,
    /// What cracks and shafts do to them.
    pub cuts: Cuts,
    /// Ghosts.
    pub ghosts: Ghosts,
    /// Walls.
    pub boundary: Boundary,
    /// Contacts with curved walls.
    pub rims: Vec<Rim>,
    /// Where walls touch a body of shells.
    pub touches: Vec<Touch>,
    /// Pipes.
    pub sinks: Vec<Sink>,
    /// Names of pipe rings.
    pub rings: Vec<String>,
    /// Surfaces through which heat is counted.
    pub surfaces: Vec<Surface>,
    /// How pairs exchange heat.
    pub exchange: Exchange,
    /// Threads, if more than one.
    pub pool: Option<Arc<ThreadPool>>,
    /// The bound of the step, where it is known from elsewhere.
    pub bound: Option<Bound>,
}

impl ListParts {
    /// Pairs, each once.
    pub fn pair_count(&self) -> u64 {
        let count = self.positions.len();
        let inner = self.pairs.partners.iter().filter(|j| (**j as usize) < count).count();
        (inner / 2 + self.pairs.partners.len() - inner) as u64
    }
}

/// The operator.
pub struct ListOperator<T> {
    parts: ListParts,
    term: T,
    fields: Fields,
    faces: Vec<Vec<Face>>,
    sink_heat: Vec<f64>,
    /// Pairs across open doors, and the doors.
    crossings: Vec<(Crossing, u8)>,
    /// Pairs across each surface, and the volume of the particle, negative where heat to it comes from greater coordinates.
    across: Vec<Vec<(Crossing, f64)>>,
    bound: Bound,
}

impl<T: PairTerm> ListOperator<T> {
    /// An operator on the given parts with a term.
    pub fn new(parts: ListParts, term: T) -> Self {
        let total = parts.positions.len() + parts.ghosts.len();
        let means = matches!(parts.exchange, Exchange::Mean(_));
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
            .map(|thermal| parts.boundary.first_faces(&thermal.curve, thermal.initial_potential))
            .collect();
        let count = parts.positions.len();
        let mut crossings = Vec::new();
        for i in 0..count {
            for k in parts.pairs.starts[i]..parts.pairs.starts[i + 1] {
                if let Some(ghost) = (parts.pairs.partners[k] as usize).checked_sub(count) {
                    let portions = Portion::of(&parts, i, k, ghost).into_iter();
                    crossings.extend(
                        portions.map(|(portion, door)| (Crossing { particle: i as u32, pair: k, portion }, door)),
                    );
                }
            }
        }
        let across = parts.surfaces.iter().map(|surface| pairs_across(&parts, surface)).collect();
        let bound = parts.bound.clone().unwrap_or_else(|| bound(&parts, &faces[0]));
        let sink_heat = vec![0.0; parts.sinks.len()];
        ListOperator { parts, term, fields, faces, sink_heat, crossings, across, bound }
    }

    /// Rates from the state of a scheme. `clock` feeds the term.
    pub fn rate_of(
        &mut self,
        scheme: &dyn LatentScheme,
        enthalpy: &[f64],
        clock: &Clock,
        rate: &mut [f64],
        doors: &mut [f64],
    ) {
        self.term.begin(clock);
        self.parts.cuts.bring_to(clock.time, &mut self.parts.pairs.weights);
        let parts = &self.parts;
        scheme.read(&parts.materials, enthalpy, &mut self.fields);
        for (faces, thermal) in self.faces.iter_mut().zip(parts.materials.thermals.iter()) {
            parts.boundary.update_faces(faces, clock.time, &thermal.curve, thermal.initial_potential);
        }
        if !self.fields.potential.is_empty() {
            parts.ghosts.fill_potentials(&mut self.fields.potential, &self.faces, &parts.materials, &parts.chains);
        }
        if !self.fields.temperature.is_empty() {
            let (temperature, conductivity) = (&mut self.fields.temperature, &mut self.fields.conductivity);
            parts.ghosts.fill_temperatures(temperature, conductivity, &self.faces, &parts.materials);
        }
        doors.fill(0.0);
        // The one place where exchange and materials become types.
        match (parts.exchange, parts.materials.mixed()) {
            (Exchange::Potential, false) => self.exchange(&|o, i, j, _| o.potential_difference(i, j), rate, doors),
            (Exchange::Potential, true) => self.exchange(&|o, i, j, k| o.across_materials(i, j, k), rate, doors),
            (Exchange::Mean(Mean::Harmonic), _) => {
                self.exchange(&|o, i, j, _| o.by_mean(i, j, |a, b| 2.0 * a * b / (a + b)), rate, doors);
            }
            (Exchange::Mean(Mean::Arithmetic), _) => {
                self.exchange(&|o, i, j, _| o.by_mean(i, j, |a, b| 0.5 * (a + b)), rate, doors);
            }
            (Exchange::Mean(Mean::Geometric), _) => {
                self.exchange(&|o, i, j, _| o.by_mean(i, j, |a, b| (a * b).sqrt()), rate, doors);
            }
        }
        self.contact(clock.time, rate, doors);
        self.touch(rate, doors);
        let parts = &self.parts;
        let walls = parts.boundary.doors.len();
        for (sink, heat) in parts.sinks.iter().zip(&mut self.sink_heat) {
            let material = parts.materials.of(sink.sample.first().map_or(0, |entry| entry.0 as usize));
            let wall = material.potential_at(sink.temperature.at(clock.time));
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
            doors[walls + sink.ring] -= taken;
        }
    }

    /// Heat rate (W/m3) that a particle gains from a wall that touches it.
    fn touched(&self, number: usize) -> f64 {
        let (materials, fields, touch) = (&self.parts.materials, &self.fields, &self.parts.touches[number]);
        let (particle, door) = (touch.particle as usize, touch.door as usize);
        let face = &self.faces[materials.index(particle)][door];
        let flux = match self.parts.exchange {
            Exchange::Potential => {
                let way = self.parts.chains.of_touch(number, &materials.thermals);
                self.through_wall(way, particle, door, touch.depth)
            }
            Exchange::Mean(_) => {
                let (temperature, conductivity) = (fields.temperature[particle], fields.conductivity[particle]);
                face.flux_by_temperature(temperature, conductivity, touch.depth)
            }
        };
        touch.area * flux
    }

    /// Flux (W/m2) through a wall into a particle at a depth (m) behind it, by what lies between them.
    #[inline]
    fn through_wall(&self, way: Option<Way<'_>>, particle: usize, door: usize, depth: f64) -> f64 {
        let (materials, potential) = (&self.parts.materials, self.fields.potential[particle]);
        match way {
            None => {
                let material = materials.index(particle);
                self.faces[material][door].flux(potential, depth, &materials.thermals[material])
            }
            Some(way) => way.wall(&self.faces[way.near()][door], depth, potential).1,
        }
    }

    /// How that flux follows the potential of the particle (1/m).
    fn through_wall_slope(&self, way: Option<Way<'_>>, particle: usize, door: usize, depth: f64) -> f64 {
        let (materials, potential) = (&self.parts.materials, self.fields.potential[particle]);
        match way {
            None => {
                let material = materials.index(particle);
                self.faces[material][door].flux_slope(potential, depth, &materials.thermals[material])
            }
            Some(way) => way.wall_slopes(&self.faces[way.near()][door], depth, potential).1,
        }
    }

    /// Adds what walls give that touch a body of shells.
    fn touch(&self, rate: &mut [f64], doors: &mut [f64]) {
        for (number, touch) in self.parts.touches.iter().enumerate() {
            let particle = touch.particle as usize;
            let gain = self.touched(number);
            rate[particle] += gain;
            doors[touch.door as usize] += gain * self.parts.volumes.of(particle);
        }
    }

    /// Curved walls that are there at a time (s), with their numbers.
    fn standing(&self, time: f64) -> impl Iterator<Item = (usize, &Rim)> {
        self.parts.rims.iter().enumerate().filter(move |(_, rim)| rim.stands(time))
    }

    /// Adds what curved walls give that are there at a time (s).
    fn contact(&self, time: f64, rate: &mut [f64], doors: &mut [f64]) {
        let (materials, fields) = (&self.parts.materials, &self.fields);
        for (number, Rim { door, contacts, .. }) in self.standing(time) {
            let by_potential = |particle: usize, depth: f64| {
                let way = self.parts.chains.of_rim(number, particle, &materials.thermals);
                self.through_wall(way, particle, *door, depth)
            };
            let by_temperature = |particle: usize, depth: f64| {
                let (temperature, conductivity) = (fields.temperature[particle], fields.conductivity[particle]);
                self.faces[0][*door].flux_by_temperature(temperature, conductivity, depth)
            };
            let mut sum = Sum::default();
            for contact in &contacts.contacts {
                let gain = match self.parts.exchange {
                    Exchange::Potential => contacts.gain(contact, by_potential),
                    Exchange::Mean(_) => contacts.gain(contact, by_temperature),
                };
                rate[contact.particle as usize] += gain;
                sum.add(gain);
            }
            doors[*door] = sum.value() * self.parts.volumes.unit();
        }
    }

    #[inline(always)]
    fn exchange<F>(&self, conducted: &F, rate: &mut [f64], doors: &mut [f64])
    where
        F: Fn(&Self, usize, usize, usize) -> f64 + Sync,
    {
        let pairs = &self.parts.pairs;
        let row = |i: usize| {
            let mut total = 0.0;
            for k in pairs.starts[i]..pairs.starts[i + 1] {
                total += self.flux(conducted, i, k);
            }
            total
        };
        let task = |(number, rates): (usize, &mut [f64])| {
            for (offset, rate) in rates.iter_mut().enumerate() {
                *rate = row(number * TASK + offset);
            }
        };
        match &self.parts.pool {
            Some(pool) if rate.len() > 2 * TASK => {
                pool.install(|| rate.par_chunks_mut(TASK).enumerate().for_each(task));
            }
            _ => rate.chunks_mut(TASK).enumerate().for_each(task),
        }
        let mut sums = [Sum::default(); MOST_DOORS];
        for (Crossing { particle, pair: k, portion }, door) in &self.crossings {
            let (i, k) = (*particle as usize, *k);
            let up_to = |image: u32| pairs.weights[k] * conducted(self, i, image as usize, k);
            let flux = match *portion {
                Portion::All => self.flux(conducted, i, k),
                Portion::UpTo(image) => up_to(image),
                Portion::From(image) => self.flux(conducted, i, k) - up_to(image),
            };
            sums[*door as usize].add(flux * self.parts.volumes.share(i));
        }
        for (door, sum) in doors.iter_mut().zip(&sums).take(self.parts.boundary.doors.len()) {
            *door = sum.value() * self.parts.volumes.unit();
        }
    }

    #[inline(always)]
    fn flux<F: Fn(&Self, usize, usize, usize) -> f64>(&self, conducted: &F, i: usize, k: usize) -> f64 {
        let (j, weight) = (self.parts.pairs.partners[k] as usize, self.parts.pairs.weights[k]);
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

    /// Heat (W) through each surface, towards greater coordinates; `rate` and `doors` are used up.
    pub fn across(
        &mut self,
        scheme: &dyn LatentScheme,
        enthalpy: &[f64],
        time: f64,
        rate: &mut [f64],
        doors: &mut [f64],
    ) -> Vec<f64> {
        if self.across.is_empty() {
            return Vec::new();
        }
        let clock = Clock { time, step: 0.0, index: 0, turned: false };
        self.rate_of(scheme, enthalpy, &clock, rate, doors);
        let conducted = |i: usize, j: usize, k: usize| match (self.parts.exchange, self.parts.materials.mixed()) {
            (Exchange::Potential, false) => self.potential_difference(i, j),
            (Exchange::Potential, true) => self.across_materials(i, j, k),
            (Exchange::Mean(Mean::Harmonic), _) => self.by_mean(i, j, |a, b| 2.0 * a * b / (a + b)),
            (Exchange::Mean(Mean::Arithmetic), _) => self.by_mean(i, j, |a, b| 0.5 * (a + b)),
            (Exchange::Mean(Mean::Geometric), _) => self.by_mean(i, j, |a, b| (a * b).sqrt()),
        };
        let pairs = &self.parts.pairs;
        let heat = |(Crossing { particle, pair, portion }, volume): &(Crossing, f64)| {
            let to = |j: u32| conducted(*particle as usize, j as usize, *pair);
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
                let place = self.parts.positions[touch.particle as usize];
                let beyond = (if surface.across_y { place.y } else { place.x }) >= surface.at;
                touch.across_y == surface.across_y && touch.at_end != beyond
            });
            near.map(|(number, touch)| {
                let heat = self.touched(number) * self.parts.volumes.of(touch.particle as usize);
                if touch.at_end { -heat } else { heat }
            })
            .sum::<f64>()
        };
        let pairs = self.across.iter().map(|pairs| pairs.iter().map(heat).collect::<Sum>().value());
        pairs.zip(&self.parts.surfaces).map(|(pairs, surface)| pairs + walls(surface)).collect()
    }

    #[inline(always)]
    fn potential_difference(&self, i: usize, j: usize) -> f64 {
        self.fields.potential[j] - self.fields.potential[i]
    }

    #[inline(always)]
    fn by_mean(&self, i: usize, j: usize, mean: impl Fn(f64, f64) -> f64) -> f64 {
        let difference = self.fields.temperature[j] - self.fields.temperature[i];
        mean(self.fields.conductivity[i], self.fields.conductivity[j]) * difference
    }

    /// How the flux that [`ListOperator::across_materials`] gives follows the potentials of both sides: it falls by the
    /// first share of the change of `i` and rises by the second share of the change of `j`.
    fn shares(&self, i: usize, j: usize, k: usize) -> (f64, f64) {
        let potential = &self.fields.potential;
        match self.way(k) {
            None => (1.0, 1.0),
            Some(way) if i < j => way.shares(potential[i], potential[j]),
            Some(way) => {
                let (near, far) = way.shares(potential[j], potential[i]);
                (far, near)
            }
        }
    }

    /// Linearises around a state: `slopes` takes dU/dH (m2/s) of every particle, `tangent` the exchange of small changes.
    pub fn linearise(
        &mut self,
        scheme: &dyn LatentScheme,
        enthalpy: &[f64],
        time: f64,
        slopes: &mut [f64],
        tangent: &mut Tangent,
    ) {
        let total = self.parts.positions.len() + self.parts.ghosts.len();
        self.fields.potential.resize(total, 0.0);
        self.parts.cuts.bring_to(time, &mut self.parts.pairs.weights);
        let parts = &self.parts;
        scheme.read(&parts.materials, enthalpy, &mut self.fields);
        for (faces, thermal) in self.faces.iter_mut().zip(parts.materials.thermals.iter()) {
            parts.boundary.update_faces(faces, time, &thermal.curve, thermal.initial_potential);
        }
        let potential = &mut self.fields.potential;
        parts.ghosts.fill_potentials(potential, &self.faces, &parts.materials, &parts.chains);
        parts.ghosts.slopes(potential, &self.faces, &parts.materials, &parts.chains, &mut tangent.ghosts);
        tangent.changes.resize(potential.len(), 0.0);
        for (i, (slope, enthalpy)) in slopes.iter_mut().zip(enthalpy).enumerate() {
            *slope = parts.materials.of(i).law.slope(*enthalpy);
        }
        tangent.time = time;
        tangent.views.resize_with(parts.rims.len(), Vec::new);
        for (number, Rim { door, contacts, .. }) in self.standing(time) {
            let slope = |particle: usize, depth: f64| {
                let way = parts.chains.of_rim(number, particle, &parts.materials.thermals);
                self.through_wall_slope(way, particle, *door, depth)
            };
            contacts.slopes(slope, &mut tangent.views[number]);
        }
        tangent.pipes.clear();
        tangent.pipes.extend(parts.sinks.iter().map(|sink| {
            let material = parts.materials.of(sink.sample.first().map_or(0, |entry| entry.0 as usize));
            sink.resistance_to_changes(sink.sampled(|index| self.fields.potential[index]), time, material)
        }));
        tangent.touches.clear();
        tangent.touches.extend(parts.touches.iter().enumerate().map(|(number, touch)| {
            let way = parts.chains.of_touch(number, &parts.materials.thermals);
            touch.area * self.through_wall_slope(way, touch.particle as usize, touch.door as usize, touch.depth)
        }));
        if parts.materials.mixed() {
            let pairs = &parts.pairs;
            tangent.shares.clear();
            for i in 0..enthalpy.len() {
                let row = pairs.starts[i]..pairs.starts[i + 1];
                tangent.shares.extend(row.map(|k| self.shares(i, pairs.partners[k] as usize, k)));
            }
        }
    }

    /// Rates (W/m3) that small changes of the potentials (W/m) of particles cause.
    pub fn act(&self, tangent: &mut Tangent, potentials: &[f64], rate: &mut [f64]) {
        let parts = &self.parts;
        let Tangent { changes, ghosts, shares, views, touches, pipes, time } = tangent;
        changes[..potentials.len()].copy_from_slice(potentials);
        parts.ghosts.fill_changes(changes, ghosts);
        let changes = &*changes;
        let pairs = &parts.pairs;
        let row = |i: usize| {
            let range = pairs.starts[i]..pairs.starts[i + 1];
            let own = changes[i];
            let partners = pairs.partners[range.clone()].iter().zip(&pairs.weights[range.clone()]);
            if shares.is_empty() {
                partners.map(|(j, weight)| weight * (changes[*j as usize] - own)).sum::<f64>()
            } else {
                let flux = |((j, weight), (own_share, other_share)): ((&u32, &f64), &(f64, f64))| {
                    weight * (other_share * changes[*j as usize] - own_share * own)
                };
                partners.zip(&shares[range]).map(flux).sum()
            }
        };
        let task = |(number, rates): (usize, &mut [f64])| {
            for (offset, rate) in rates.iter_mut().enumerate() {
                *rate = row(number * TASK + offset);
            }
        };
        match &parts.pool {
            Some(pool) if rate.len() > 2 * TASK => {
                pool.install(|| rate.par_chunks_mut(TASK).enumerate().for_each(task));
            }
            _ => rate.chunks_mut(TASK).enumerate().for_each(task),
        }
        for (rim, views) in parts.rims.iter().zip(views.iter()).filter(|(rim, _)| rim.stands(*time)) {
            for contact in &rim.contacts.contacts {
                rate[contact.particle as usize] += rim.contacts.change(contact, views, |particle| changes[particle]);
            }
        }
        for (touch, slope) in parts.touches.iter().zip(touches.iter()) {
            rate[touch.particle as usize] += slope * changes[touch.particle as usize];
        }
        for (sink, resistance) in parts.sinks.iter().zip(pipes).filter(|(sink, _)| sink.works(*time)) {
            let heat = sink.sampled(|index| changes[index]) / *resistance * sink.share;
            for (index, weight) in &sink.sample {
                rate[*index as usize] -= heat * weight / parts.volumes.of(*index as usize);
            }
        }
    }

    /// What lies between the ends of a pair, if that is of several materials.
    #[inline(always)]
    fn way(&self, pair: usize) -> Option<Way<'_>> {
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

/// A scheme for [`Operator`] calls: enthalpy is the unknown.
impl<T: PairTerm> ListOperator<T> {
    /// Doors of the operator.
    pub fn door_names(&self) -> Vec<String> {
        let walls = self.parts.boundary.doors.iter().map(|door| door.name.to_string());
        walls.chain(self.parts.rings.iter().cloned()).collect()
    }

    /// The explicit bound.
    pub fn step_bound(&self) -> Bound {
        self.bound.clone()
    }

    /// Pairs, each once.
    pub fn pair_count(&self) -> u64 {
        self.parts.pair_count()
    }

    /// The largest slope dU/dH (m2/s) with which each particle can answer: under pair means, the largest conductivity
    /// of all over its least capacity.
    pub fn steepest(&self) -> Vec<f64> {
        (0..self.parts.positions.len()).map(|i| steepest(&self.parts, i)).collect()
    }

    /// Materials.
    pub fn materials(&self) -> &Materials {
        &self.parts.materials
    }
}

/// The list operator with enthalpy as its unknown, for the shared integrators.
pub struct EnthalpyList {
    /// The operator.
    pub operator: ListOperator<Off>,
    /// The scheme that reads enthalpies.
    pub scheme: Box<dyn LatentScheme>,
    /// Rates of one evaluation.
    pub rate: Vec<f64>,
    /// The last linearisation.
    pub tangent: Tangent,
}

/// The exchange of small changes around a state.
#[derive(Debug, Clone, Default)]
pub struct Tangent {
    /// Changes of the potentials of particles and ghosts.
    changes: Vec<f64>,
    /// How ghosts follow their images.
    ghosts: Vec<f64>,
    /// How the flux of each pair follows its own particle and its partner; empty for a single material.
    shares: Vec<(f64, f64)>,
    /// How the gains at each curved wall follow what is seen of it.
    views: Vec<Vec<f64>>,
    /// How the gains at touching walls follow the particles.
    touches: Vec<f64>,
    /// Resistances with which they meet pipes.
    pipes: Vec<f64>,
    /// Time (s) of the linearisation.
    time: f64,
}

impl Operator for EnthalpyList {
    fn rate(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64], doors: &mut [f64]) {
        let clock = Clock { time, step: 0.0, index: 0, turned: false };
        self.operator.rate_of(self.scheme.as_ref(), enthalpy, &clock, rate, doors);
    }

    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, doors: &mut [f64]) {
        let clock = Clock { time, step, index: 0, turned: false };
        self.operator.rate_of(self.scheme.as_ref(), enthalpy, &clock, &mut self.rate, doors);
        for (h, rate) in enthalpy.iter_mut().zip(&self.rate) {
            *h += step * rate;
        }
    }

    fn stage(&mut self, stage: &Stage, columns: &mut StageColumns<'_>, time: f64, doors: &mut [f64]) {
        let clock = Clock { time, step: 0.0, index: 0, turned: false };
        self.operator.rate_of(self.scheme.as_ref(), columns.newest, &clock, &mut self.rate, doors);
        let states = columns.newest.iter().zip(columns.start);
        let rates = self.rate.iter().zip(columns.first);
        for (out, ((newest, start), (rate, first))) in columns.oldest.iter_mut().zip(states.zip(rates)) {
            *out = stage.newest * newest
                + stage.oldest * *out
                + stage.start * start
                + stage.rate * rate
                + stage.first * first;
        }
    }

    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]) {
        self.operator.linearise(self.scheme.as_ref(), enthalpy, time, slopes, &mut self.tangent);
    }

    fn act(&mut self, potentials: &[f64], rate: &mut [f64]) {
        self.operator.act(&mut self.tangent, potentials, rate);
    }

    fn is_symmetric(&self) -> bool {
        let parts = &self.operator.parts;
        let curved = parts.rims.iter().any(|rim| self.operator.faces[0][rim.door].holds() > 0.0);
        let even = parts.volumes.is_even();
        even && parts.ghosts.all_mirrored() && !parts.materials.mixed() && parts.boundary.is_linear() && !curved
    }

    fn is_constant(&self) -> bool {
        let parts = &self.operator.parts;
        let scheduled = parts.sinks.iter().any(|sink| sink.schedule.is_some() || sink.film.is_some());
        !parts.materials.mixed() && parts.boundary.is_linear() && !scheduled && parts.cuts.is_empty()
    }

    fn bandwidth(&self) -> usize {
        let parts = &self.operator.parts;
        let count = parts.positions.len();
        let farthest = |i: usize| {
            let partners = &parts.pairs.partners[parts.pairs.starts[i]..parts.pairs.starts[i + 1]];
            let width = |j: u32| match (j as usize).checked_sub(count) {
                None => (j as usize).abs_diff(i),
                Some(ghost) => {
                    let makers = parts.ghosts.makers(ghost, count);
                    makers.iter().map(|maker| (*maker as usize).abs_diff(i)).max().unwrap_or(0)
                }
            };
            partners.iter().map(|j| width(*j)).max().unwrap_or(0)
        };
        let sampled = |sink: &Sink| {
            let numbers = sink.sample.iter().map(|entry| entry.0 as usize);
            numbers.clone().max().unwrap_or(0) - numbers.min().unwrap_or(0)
        };
        let by_pairs = (0..count).map(farthest).max().unwrap_or(0);
        let by_rims = parts.rims.iter().map(|rim| rim.contacts.bandwidth()).max().unwrap_or(0);
        by_pairs.max(by_rims).max(parts.sinks.iter().map(sampled).max().unwrap_or(0))
    }

    fn steepest(&self) -> Vec<f64> {
        self.operator.steepest()
    }

    fn bound(&self) -> Bound {
        self.operator.step_bound()
    }

    fn across(&mut self, enthalpy: &[f64], time: f64) -> Vec<f64> {
        let mut doors = vec![0.0; self.operator.door_names().len()];
        self.operator.across(self.scheme.as_ref(), enthalpy, time, &mut self.rate, &mut doors)
    }

    fn doors(&self) -> Vec<String> {
        self.operator.door_names()
    }

    fn pairs(&self) -> u64 {
        self.operator.pair_count()
    }

    fn held(&self) -> usize {
        let Tangent { changes, ghosts, shares, views, touches, .. } = &self.tangent;
        let tangent = changes.held()
            + ghosts.held()
            + shares.held()
            + views.iter().map(Held::held).sum::<usize>()
            + touches.held();
        self.operator.held() + self.scheme.held() + self.rate.held() + tangent
    }
}

impl<T: PairTerm> Held for ListOperator<T> {
    fn held(&self) -> usize {
        let parts = &self.parts;
        let fields = self.fields.potential.held() + self.fields.temperature.held() + self.fields.conductivity.held();
        let pairs = parts.pairs.starts.held() + parts.pairs.partners.held() + parts.pairs.weights.held();
        // Its copy of the materials of particles, and positions even of those on a lattice.
        let copies = shared(&parts.positions) + parts.materials.of_particle.held();
        copies
            + pairs
            + self.term.held()
            + parts.chains.held()
            + parts.cuts.held()
            + parts.ghosts.held()
            + fields
            + self.crossings.held()
            + self.across.iter().map(Held::held).sum::<usize>()
            + parts.rims.iter().map(|rim| rim.contacts.held()).sum::<usize>()
            + parts.touches.capacity() * size_of::<Touch>()
            + parts.sinks.held()
            + self.sink_heat.held()
    }
}

/// The largest slope dU/dH (m2/s) of a particle. Pair means act with conductivities of either partner, so there it is the
/// largest of all over the least capacity.
fn steepest(parts: &ListParts, particle: usize) -> f64 {
    let thermal = parts.materials.of(particle);
    match parts.exchange {
        Exchange::Potential => thermal.largest_slope,
        Exchange::Mean(_) => {
            let most =
                parts.materials.thermals.iter().map(|thermal| thermal.curve.most_conductive()).fold(0.0, f64::max);
            most / thermal.curve.least_capacity()
        }
    }
}

/// Pairs across a surface, each once: those of particles beyond it with partners before it. A ghost is a partner like any
/// other where it mirrors through closed walls. What an open wall brings passes the surface where the wall faces it, from
/// whichever side the ghost's own particle is on, and does not where the wall meets it.
fn pairs_across(parts: &ListParts, surface: &Surface) -> Vec<(Crossing, f64)> {
    let count = parts.positions.len();
    let beyond = |j: usize| {
        let place = j.checked_sub(count).map_or_else(|| parts.positions[j], |ghost| parts.ghosts.position[ghost]);
        (if surface.across_y { place.y } else { place.x }) >= surface.at
    };
    let faces = |door: u8| {
        let name = &parts.boundary.doors[door as usize].name;
        (name.starts_with("bottom") || name.starts_with("top")) == surface.across_y
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
                    let faced = portions.into_iter().filter(|(_, door)| faces(*door));
                    found.extend(faced.map(|(portion, _)| (crossing(portion), volume)));
                }
                _ => {}
            }
        }
    }
    found
}

fn bound(parts: &ListParts, faces: &[Face]) -> Bound {
    let count = parts.positions.len();
    let mirrored = parts.ghosts.mirrored(count, faces);
    // How a ghost falls when the particle rises: through any number of mirrors, or by its share in a fit.
    let falls = |ghost: usize, particle: u32| match mirrored[ghost] {
        Some((own, factor)) if own == particle => -factor,
        Some(_) => 0.0,
        None => parts.ghosts.own_share(ghost, particle, faces),
    };
    let thermals = &parts.materials.thermals;
    // How much more than within one material a pair follows its particle and its partner.
    let shares = |i: usize, k: usize| match parts.chains.of_pair(k, thermals).map(|way| way.greatest_shares()) {
        None => (1.0, 1.0),
        Some((near, far)) if i < parts.pairs.partners[k] as usize => (near, far),
        Some((near, far)) => (far, near),
    };
    let mut sums: Vec<f64> = (0..count)
        .map(|i| {
            let range = parts.pairs.starts[i]..parts.pairs.starts[i + 1];
            let own: f64 = range.clone().map(|k| parts.pairs.weights[k] * shares(i, k).0).sum();
            let mirrored: f64 = range
                .filter_map(|k| (parts.pairs.partners[k] as usize).checked_sub(count).map(|ghost| (k, ghost)))
                .map(|(k, ghost)| {
                    let falls = falls(ghost, i as u32);
                    match parts.chains.of_ghost(ghost, thermals).map(|way| way.greatest_shares()) {
                        None => parts.pairs.weights[k] * shares(i, k).1 * falls,
                        Some((_, far)) => parts.pairs.weights[k] * shares(i, k).1 * far * falls.max(0.0),
                    }
                })
                .sum();
            own + mirrored.max(0.0)
        })
        .collect();
    let from_wall = |way: Option<Way<'_>>| way.map_or(1.0, |way| way.greatest_shares().1);
    for (number, rim) in parts.rims.iter().enumerate() {
        for contact in &rim.contacts.contacts {
            let share = from_wall(parts.chains.of_rim(number, contact.particle as usize, thermals));
            sums[contact.particle as usize] += faces[rim.door].holds() * contact.stiffness * share;
        }
    }
    for (number, touch) in parts.touches.iter().enumerate() {
        let share = from_wall(parts.chains.of_touch(number, thermals));
        sums[touch.particle as usize] += faces[touch.door as usize].holds() * touch.area / touch.depth * share;
    }
    for sink in &parts.sinks {
        for (index, row_sum) in sink.row_sums(parts.spacing) {
            sums[index] += row_sum;
        }
    }
    let mut stiffest = (0.0, 0usize);
    for (i, sum) in sums.iter().enumerate() {
        let slope = steepest(parts, i);
        if sum * slope > stiffest.0 {
            stiffest = (sum * slope, i);
        }
    }
    let at = parts.positions[stiffest.1];
    let cause = format!("pair exchange of particle {} at ({:.6}, {:.6}) m", stiffest.1, at.x, at.y);
    Bound { step: if stiffest.0 > 0.0 { 1.0 / stiffest.0 } else { f64::INFINITY }, cause }
}
