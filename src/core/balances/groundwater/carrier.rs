//! Heat that water carries along its paths.
//!
//! Particle i gains `-C sum_j q_ij (T_ij - T_i)` from the water `q_ij` (1/s by volume) that it sends to j, with the heat
//! capacity C of water and the temperature `T_ij` that the path carries. What i gains so is what the paths bring less
//! what they take, and the heat of the water that i itself keeps or gives as ice; an even temperature stays even
//! whatever water does. With the mean of both ends for `T_ij` this is `-C sum_j q_ij (T_j - T_i) / 2`.
//!
//! A long path sees more of the bend of a profile than a short one: the third derivative that the mean of both ends
//! leaves is taken out with the gradients `g` there, `T_ij = (T_i + T_j)/2 - x_ij.(g_j - g_i)/6`, wherever water is not
//! much slower than conduction.
//!
//! The factor of `T_j - T_i` is negative where water outruns conduction. An exchange beside it mends that, at the price
//! of smeared fronts; limited, most of it is taken back again: as much as leaves every particle within the enthalpies
//! around it (Zalesak 1979).

mod limit;
mod taken_back;

use glam::DVec2;

use crate::balances::groundwater::diagonals::{BENT, sum};
use crate::balances::groundwater::network::{NONE, Network};
use crate::balances::groundwater::numerics::Advection;
use crate::balances::groundwater::pressure::Pressure;
use crate::balances::groundwater::tasks::{any, each, tasks, tasks_of_two, when};
use crate::balances::groundwater::velocity::velocities;
use crate::balances::row::Row;
use crate::memory::{HeapSize, total};
use crate::saved::{Pass, Saved};
use crate::team::Team;

/// Heat that water carries along a path over what the path conducts, from which the bend of profiles counts.
const FAST: f64 = 1.0;

/// The first of the columns of shares.
const SHARES: usize = 5;

/// Water of one particle through one wall of given pressure (1/s by volume).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mouth {
    /// The particle.
    pub particle: u32,
    /// The pressure wall.
    pub wall: u8,
    /// What enters.
    pub inflow: f64,
    /// What leaves.
    pub outflow: f64,
}

/// Water of all paths at one solution for the pressure, as heat meets it.
#[derive(Debug, Clone, Default)]
pub struct Carrier {
    /// Heat carried along each path from its earlier end, for each kelvin of the mean of both ends (W/m3K), by slot.
    carried: Vec<f64>,
    /// The same, and water through each opening (1/s by volume), as the last solution had it; empty before the first.
    last: (Vec<f64>, Vec<f64>),
    /// Exchange of both ends beside it (W/m3K), by slot; empty where there is none.
    exchange: Vec<f64>,
    /// Exchange beside walls, of particles that see each other's images (W/m3K), by slot; and the paths that have some, with
    /// both ends.
    beside: Vec<f64>,
    beside_walls: Vec<(u32, u32, u32)>,
    /// Water through walls.
    pub mouths: Vec<Mouth>,
    /// Water that each particle keeps (1/s by volume).
    pub kept: Vec<f64>,
    /// Greatest sum of factors of one particle (W/m3K), and the particle.
    pub greatest: (f64, usize),
    /// Greatest sum of what paths carry at one particle, whatever its sign (W/m3K).
    pub turning: f64,
    /// Water that passes through particles (1/s by volume), root of the sum of squares.
    pub passing: f64,
    /// Sums over the paths of each particle (W/m3K), while water is taken.
    sums: Vec<f64>,
    limits_now: bool,
    exchanges: bool,
    /// Whether gradients are used, and the gradients.
    bends: bool,
    gradients: Vec<DVec2>,
    /// What conduction does to each particle, times what a bend is worth (W/m); empty where it is not corrected.
    conducted: Vec<f64>,
    /// Columns with room on both sides, on diagonals: temperatures, enthalpies, what conduction does, both parts of gradients, and,
    /// where they are limited, shares of what may be gained and lost.
    columns: [Vec<f64>; SHARES + 2],
    mouth_of: Vec<u32>,
    rows: Vec<Row>,
    /// Where not all of the exchange is taken back, and what sees such places.
    limited: Vec<bool>,
    marked: Vec<bool>,
    limits: Vec<(f64, f64)>,
}

impl Saved for Carrier {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [
            &mut self.carried,
            &mut self.last.0,
            &mut self.last.1,
            &mut self.exchange,
            &mut self.beside,
            &mut self.beside_walls,
            &mut self.kept,
            &mut self.greatest,
            &mut self.turning,
            &mut self.passing,
            &mut self.limits_now,
            &mut self.exchanges,
            &mut self.bends,
            &mut self.gradients,
        ]);
        for mouth in &mut self.mouths {
            pass.all(&mut [&mut mouth.inflow, &mut mouth.outflow]);
        }
    }
}

impl HeapSize for Carrier {
    fn heap_size(&self) -> usize {
        let rows = self.rows.capacity() * size_of::<Row>() + self.mouths.capacity() * size_of::<Mouth>();
        let more = self.columns.iter().map(HeapSize::heap_size).sum::<usize>();
        let beside = self.beside_walls.capacity() * size_of::<(u32, u32, u32)>() + 2 * self.marked.capacity();
        let paths = total(&[&self.exchange, &self.sums, &self.beside, &self.carried, &self.conducted]);
        let last = self.last.0.heap_size() + self.last.1.heap_size();
        rows + paths + more + beside + last + total(&[&self.kept, &self.mouth_of, &self.limits])
    }
}

/// What the carrier must know of the ground.
pub struct Ground<'a> {
    /// Heat capacity of water (J/m3K).
    pub capacity: f64,
    /// Whether each pressure wall has a temperature of its own.
    pub warm: &'a [bool],
    /// Threads, if more than one.
    pub team: Option<&'a Team>,
    /// How far beyond this solution its water is to go on as it has changed since the last one, over the time between both.
    pub ahead: f64,
}

impl Carrier {
    /// Room for a network.
    pub fn new(network: &Network, advection: Advection) -> Self {
        let (count, paths) = (network.len(), network.places);
        let mut carrier = Carrier {
            carried: vec![0.0; paths],
            beside: vec![0.0; paths],
            sums: vec![0.0; count],
            kept: vec![0.0; count],
            mouth_of: Vec::with_capacity(network.openings.len()),
            ..Carrier::default()
        };
        for opening in &network.openings {
            let same = |mouth: &Mouth| (mouth.particle, mouth.wall) == (opening.particle, opening.wall);
            let mouth = Mouth { particle: opening.particle, wall: opening.wall, inflow: 0.0, outflow: 0.0 };
            // Openings of one particle stand together.
            let near = carrier.mouths.len().saturating_sub(crate::balances::groundwater::network::MOST_WALLS);
            let place = carrier.mouths[near..].iter().position(same).map_or(carrier.mouths.len(), |place| near + place);
            if place == carrier.mouths.len() {
                carrier.mouths.push(mouth);
            }
            carrier.mouth_of.push(place as u32);
        }
        if !matches!(advection, Advection::Central | Advection::Paper) {
            carrier.exchange = vec![0.0; paths];
        }
        if advection == Advection::Limited {
            carrier.rows = vec![Row::default(); count];
            carrier.limited = vec![false; count];
            carrier.marked = vec![false; count];
            carrier.limits = vec![(1.0, 1.0); count];
        }
        if let Some(diagonals) = &network.diagonals {
            let used = if advection == Advection::Limited { carrier.columns.len() } else { SHARES };
            carrier.columns[..used].fill(vec![0.0; diagonals.padded()]);
        }
        carrier
    }

    /// Takes the rates of conduction (W/m3), whose bends are to be taken out, and what those are worth (m2).
    pub fn conducted(&mut self, rates: &[f64], kappa: f64) {
        self.conducted.clear();
        self.conducted.extend(rates.iter().map(|rate| kappa * rate));
    }

    /// Takes the water of a solution for the pressure.
    pub fn take(&mut self, network: &Network, pressure: &Pressure, ground: &Ground<'_>, advection: Advection) {
        self.follow(network, pressure, ground, advection);
        for mouth in &mut self.mouths {
            (mouth.inflow, mouth.outflow) = (0.0, 0.0);
        }
        for (_, _, slot) in self.beside_walls.drain(..) {
            self.beside[slot as usize] = 0.0;
        }
        let values = &pressure.pressure;
        self.last.1.resize(network.openings.len(), 0.0);
        let openings = network.openings.iter().zip(&pressure.mouths).zip(&self.mouth_of).zip(&mut self.last.1);
        for (((opening, conductance), mouth), last) in openings {
            let (own, image) = (values[opening.particle as usize], values[opening.image as usize]);
            let water = conductance * (own - opening.sign * image - pressure.wall_parts(opening));
            let water = water + ground.ahead * (water - std::mem::replace(last, water));
            self.kept[opening.particle as usize] -= water;
            let mouth = &mut self.mouths[*mouth as usize];
            if water < 0.0 {
                mouth.inflow -= water;
            } else {
                mouth.outflow += water;
            }
            // Two particles and their images exchange water twice across the wall. What enters has its temperature, and
            // what leaves that of the particles; the mean of a pair differs from that by an exchange of the two.
            let enters_warm = water < 0.0 && ground.warm[opening.wall as usize];
            let leaves_free = water > 0.0 && !ground.warm[opening.wall as usize];
            if opening.path != NONE
                && opening.particle < opening.image
                && opening.sign < 0.0
                && advection != Advection::Upwind
                && (enters_warm || leaves_free)
            {
                let slot = network.slots[opening.path as usize];
                if self.beside[slot as usize] == 0.0 {
                    self.beside_walls.push((opening.particle, opening.image, slot));
                }
                self.beside[slot as usize] -= 0.5 * ground.capacity * water.abs();
            }
        }
        self.bound(network, ground, advection);
    }

    /// The water of paths, and what particles keep of it.
    fn follow(&mut self, network: &Network, pressure: &Pressure, ground: &Ground<'_>, advection: Advection) {
        let Carrier { carried, last: (last, _), kept, columns, .. } = self;
        let (half, values, team) = (0.5 * ground.capacity, &pressure.pressure[..], ground.team);
        // Water along a path carries half of each end's temperature.
        if advection == Advection::Paper {
            let velocity = velocities(network, pressure);
            network.each_path(|i, j, slot| {
                let sent = 0.5 * network.weights[slot] * network.spans[slot].dot(velocity[i] + velocity[j]);
                carried[slot] = half * sent;
            });
        } else {
            let sent = |conductance: f64, i: f64, j: f64| half * (conductance * (i - j));
            network.by_path(team, (&pressure.conductances, values), &mut columns[0], sent, carried);
        }
        last.resize(carried.len(), 0.0);
        tasks_of_two(team, (carried, last), |_, carried, last| {
            for (carried, last) in carried.iter_mut().zip(last) {
                let now = *carried;
                *carried += ground.ahead * (now - *last);
                *last = now;
            }
        });
        network.sums(team, [carried; 3], |[carried, ..], earlier| if earlier { -carried } else { carried }, kept);
        each(team, kept, |_, kept| *kept /= half);
    }

    /// Adds the exchange that keeps factors and conduction together from being negative, and finds the greatest sum.
    fn bound(&mut self, network: &Network, ground: &Ground<'_>, advection: Advection) {
        let (limited, team) = (advection == Advection::Limited, ground.team);
        let may_bend = matches!(advection, Advection::Central | Advection::Limited);
        let conducted = &network.least_conductances;
        let Carrier { carried, exchange, beside, sums, .. } = self;
        if matches!(advection, Advection::Central | Advection::Paper) {
            let stiff = |[carried, beside, _]: [f64; 3], earlier: bool| {
                if earlier { (beside - carried).abs() } else { (beside + carried).abs() }
            };
            network.sums(team, [carried, beside, beside], stiff, sums);
        } else {
            tasks(team, exchange, |first, exchange| {
                let slots = carried[first..].iter().zip(&beside[first..]).zip(&conducted[first..]);
                for (added, ((carried, beside), conducted)) in exchange.iter_mut().zip(slots) {
                    let most = carried.abs() - beside;
                    *added = if advection == Advection::Upwind { most } else { (most - conducted).max(0.0) };
                }
            });
            let stiff = |[carried, beside, added]: [f64; 3], earlier: bool| {
                (if earlier { beside - carried } else { beside + carried } + added).max(0.0)
            };
            network.sums(team, [carried, beside, exchange], stiff, sums);
        }
        let (exchange, carried) = (&self.exchange, &self.carried);
        self.exchanges = any(team, exchange.len(), |slot| exchange[slot] > 0.0);
        let outruns = |slot: usize| 2.0 * carried[slot].abs() > FAST * conducted[slot].abs();
        self.bends = may_bend && any(team, carried.len().min(conducted.len()), outruns);
        self.limits_now = limited && (self.bends || self.exchanges);
        self.gradients.resize(if self.bends { network.len() } else { 0 }, DVec2::ZERO);
        let sums = &mut self.sums;
        for mouth in &self.mouths {
            sums[mouth.particle as usize] += ground.capacity * mouth.inflow;
        }
        self.greatest =
            sums.iter().enumerate().fold((0.0, 0), |most, (i, sum)| if *sum > most.0 { (*sum, i) } else { most });
        // What passes, whichever way.
        network.sums(team, [&self.carried; 3], |[carried, ..], _| carried.abs(), sums);
        self.turning = sums.iter().copied().fold(0.0, f64::max);
        self.passing = sum(sums.len(), |i| sums[i] * sums[i]).sqrt() / (0.5 * ground.capacity);
    }

    /// Adds what paths carry to the rates (W/m3), from temperatures and enthalpies (J/m3) at the start of a step (s);
    /// `beside` are particles next to walls with the enthalpies that those hold.
    pub fn carry(&mut self, network: &Network, state: &State<'_>, rate: &mut [f64]) {
        let temperature = state.temperature;
        if self.bends {
            self.slope(network, state);
        }
        if !self.limits_now && self.conducted.is_empty() {
            return self.carry_unlimited(network, temperature, state.team, self.bends, rate);
        }
        self.gather(network, state);
        let mut rows = std::mem::take(&mut self.rows);
        self.exchange_beside(temperature, |particle, gain| rows[particle].gain += gain);
        self.rows = rows;
        self.limit(network, state, rate);
        self.take_back(network, state, rate);
    }

    /// Adds what paths carry to the rates (W/m3), with all of the exchange beside it, and what gradients mend or not.
    pub fn carry_unlimited(
        &mut self,
        network: &Network,
        temperature: &[f64],
        team: Option<&Team>,
        bends: bool,
        rate: &mut [f64],
    ) {
        self.exchange_beside(temperature, |particle, gain| rate[particle] += gain);
        match &network.diagonals {
            Some(diagonals) if !bends => {
                let [column, ..] = &mut self.columns;
                diagonals.places.spread(team, temperature, column);
                let exchange = when(self.exchanges, &self.exchange);
                tasks(team, rate, |first, rates| {
                    diagonals.carry(&self.carried, exchange, &self.columns[0], first, rates);
                });
            }
            _ => each(team, rate, |i, rate| {
                let own = temperature[i];
                for (j, slot, later) in network.paths(i) {
                    *rate += self.factor(slot, later) * (temperature[j] - own);
                    if bends {
                        *rate += self.bend(network, i, j, slot);
                    }
                }
            }),
        }
    }

    /// What particles exchange that see each other's images behind walls (W/m3).
    fn exchange_beside(&self, temperature: &[f64], mut add: impl FnMut(usize, f64)) {
        for (i, j, slot) in &self.beside_walls {
            let (i, j) = (*i as usize, *j as usize);
            let gain = self.beside[*slot as usize] * (temperature[j] - temperature[i]);
            add(i, gain);
            add(j, -gain);
        }
    }

    /// Heat (W/m3) that a path brings to one end from the other, at the state that was carried last: what water carries counts
    /// from the temperature `zero`.
    pub fn along(
        &self,
        network: &Network,
        temperature: &[f64],
        (own, other, slot): (usize, usize, usize),
        zero: f64,
    ) -> f64 {
        let [here, there] = [own, other].map(|particle| temperature[particle] - zero);
        let carried = if other > own { -self.carried[slot] } else { self.carried[slot] };
        let exchange = if self.exchanges { self.exchange[slot] } else { 0.0 };
        let back = self.bend(network, own, other, slot);
        let limited = self.limits_now || !self.conducted.is_empty();
        let mended = if limited {
            let back = back - exchange * (there - here);
            let (here, there) = (self.limits[own], self.limits[other]);
            back * if back > 0.0 { here.0.min(there.1) } else { here.1.min(there.0) }
        } else if self.bends {
            back
        } else {
            0.0
        };
        carried * (here + there) + (exchange + self.beside[slot]) * (there - here) + mended
    }

    /// Factor with which a particle takes part in a path, whose other end may be the later one.
    #[inline(always)]
    fn factor(&self, slot: usize, later: bool) -> f64 {
        let exchange = if self.exchanges { self.exchange[slot] } else { 0.0 };
        if later { exchange - self.carried[slot] } else { exchange + self.carried[slot] }
    }

    /// What the bend of the profile takes from what a path carries and conducts (W/m3).
    #[inline(always)]
    fn bend(&self, network: &Network, i: usize, j: usize, slot: usize) -> f64 {
        let conducted = if self.conducted.is_empty() {
            0.0
        } else {
            network.even_weights[slot] * (self.conducted[i] - self.conducted[j])
        };
        if !self.bends {
            return conducted;
        }
        let rise = self.gradients[j] - self.gradients[i];
        conducted + self.carried[slot] * (BENT * network.spans[slot]).dot(rise)
    }

    /// Gradients of the temperature.
    fn slope(&mut self, network: &Network, state: &State<'_>) {
        let Carrier { gradients, columns: [places, ..], .. } = self;
        network.slopes(state.team, (&network.weights, state.temperature), places, gradients);
        for (opening, wall) in network.openings.iter().zip(state.openings) {
            let (own, image) = (opening.particle as usize, opening.image as usize);
            let image = state.temperature[image];
            let ghost = wall.map_or(image, |wall| if opening.sign == 0.0 { wall } else { 2.0 * wall - image });
            self.gradients[own] += 0.5 * opening.weight * (ghost - state.temperature[own]) * opening.arm;
        }
    }
}

/// The state from which heat is carried.
pub struct State<'a> {
    /// Temperatures.
    pub temperature: &'a [f64],
    /// Enthalpies (J/m3), relative to each particle's own zero.
    pub enthalpy: &'a [f64],
    /// The step that the rates are for (s).
    pub step: f64,
    /// Whether there are several materials.
    pub mixed: bool,
    /// Enthalpy (J/m3) of a particle at a temperature.
    pub enthalpy_at: &'a (dyn Fn(usize, f64) -> f64 + Sync),
    /// Temperatures that pressure walls hold, by opening.
    pub openings: &'a [Option<f64>],
    /// Particles next to walls, with the temperatures that those hold.
    pub beside: &'a [(u32, f64)],
    /// Threads, if more than one.
    pub team: Option<&'a Team>,
}
