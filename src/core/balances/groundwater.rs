//! Groundwater that flows through freezing ground, and the heat that it carries.
//!
//! The pairs that conduct heat conduct water: particle i sends `q_ij = w_ij K_ij (p_i - p_j)` to j (1/s by volume), with
//! the pair's weight, a mean of the hydraulic conductivities of both and the difference of pressures, which follow from `sum_j q_ij = -n (1 - rho_i/rho_w) dS_w/dt` (Nikolaev et al. 2021, eqs 3 and 6). Water carries heat along
//! the same pairs ([`carrier`]). Both are beside the conduction of the shared operator.
//!
//! A step is Heun's, of two explicit Euler steps: second order, and a mean of two states that each keep the range of
//! the data, so it keeps it too (Shu and Osher 1988).

use std::sync::Arc;
use std::time::Instant;

use frazil_record::Work;
use glam::DVec2;
use rayon::ThreadPool;

use crate::balances::groundwater::aquifer::{Aquifer, Warmth};
use crate::balances::groundwater::bend::Bend;
use crate::balances::groundwater::carrier::{Carrier, Ground, State};
use crate::balances::groundwater::ground::Flow;
use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::numerics::FlowNumerics;
use crate::balances::groundwater::pressure::Pressure;
use crate::balances::groundwater::velocity::velocities;
use crate::boundary::patch::{Boundary, Face};
use crate::ledger::{Ledger, Sum};
use crate::memory::HeapSize;
use crate::particles::Particles;
use crate::physics::latent_heat::Materials;
use crate::solvers::method::{Method, Water};
use crate::solvers::operator::Operator;
use crate::solvers::sharp::{just_before, sharp_step};
use crate::solvers::step::{Bound, Clock, StepError};

pub mod aquifer;
pub mod bend;
mod build;
pub mod carrier;
pub mod diagonals;
pub mod ground;
pub mod network;
pub mod numerics;
pub mod pressure;
pub mod row;
pub mod tasks;
pub mod velocity;

pub use build::FlowParts;

/// Intervals between solutions for the pressure grow at most by this factor: the water that ice has taken or given
/// meanwhile is made up for over the next interval.
const GROWTH: f64 = 2.0;

/// Water so far, by volume of the body (m^d).
#[derive(Debug, Clone, Default)]
struct WaterLedger {
    /// In through each pressure wall.
    walls: Vec<Sum>,
    /// In and out, whatever the wall.
    exchanged: Sum,
    /// What the pressures were solved for.
    asked: Sum,
}

/// Flowing water beside conduction: the method of scenes with water.
pub struct FlowMethod {
    /// Conduction.
    operator: Box<dyn Operator>,
    pairs: u64,
    network: Network,
    pressure: Pressure,
    carrier: Carrier,
    bend: Option<Bend>,
    aquifers: Vec<Aquifer>,
    materials: Materials,
    boundary: Boundary,
    faces: Vec<Face>,
    flow: Flow,
    numerics: FlowNumerics,
    fraction: f64,
    volume: f64,
    across: f64,
    /// What gravity adds to the pressure of each wall, and to that of each particle (Pa); none without gravity.
    lifts: Vec<f64>,
    heights: Vec<f64>,
    capacity: f64,
    pool: Option<Arc<ThreadPool>>,
    temperature: Vec<f64>,
    permeability: Vec<f64>,
    solved: Vec<f64>,
    conductivity: Vec<f64>,
    walls: Vec<f64>,
    /// Unfrozen fractions at the start, water asked for by volume so far, and what is asked for now (1/s): empty where
    /// ice is as dense as water.
    started: Vec<f64>,
    asked: Vec<f64>,
    asking: Vec<f64>,
    last_solution: f64,
    interval: f64,
    ledger: Ledger,
    water: WaterLedger,
    rate: Vec<f64>,
    start: Vec<f64>,
    patches: [Vec<f64>; 2],
    beside: Vec<(u32, f64)>,
    opening_temperatures: Vec<Option<f64>>,
    own_bound: Bound,
    bound: Bound,
    steps: u64,
    seconds: f64,
}

impl FlowMethod {
    fn aquifer(&self, particle: usize) -> &Aquifer {
        &self.aquifers[self.materials.index(particle)]
    }

    /// Fills the temperatures.
    fn warm(&mut self, enthalpy: &[f64]) {
        for (i, (temperature, enthalpy)) in self.temperature.iter_mut().zip(enthalpy).enumerate() {
            *temperature = self.aquifers[self.materials.index(i)].warmth.at(*enthalpy);
        }
    }

    /// Fills the relative permeabilities.
    fn permeate(&mut self, enthalpy: &[f64]) {
        let (law, least) = (self.flow.relative_permeability, self.flow.least_relative_permeability);
        for i in 0..enthalpy.len() {
            let aquifer = &self.aquifers[self.materials.index(i)];
            self.permeability[i] = if enthalpy[i] + aquifer.thermal.initial_enthalpy >= 0.0 {
                1.0
            } else {
                law.at(aquifer.unfrozen(enthalpy[i], self.temperature[i]), aquifer.pores.porosity).max(least)
            };
        }
    }

    /// Whether permeabilities, walls or ice have changed enough for another solution by this time (s).
    fn is_due(&self, time: f64) -> bool {
        let since = time - self.last_solution;
        if since >= self.numerics.pressure_interval || (!self.asked.is_empty() && since >= GROWTH * self.interval) {
            return true;
        }
        if (0..self.walls.len()).any(|wall| self.wall_pressure(wall, time) != self.walls[wall]) {
            return true;
        }
        let changed: f64 = self.permeability.iter().zip(&self.solved).map(|(now, then)| (now - then).abs()).sum();
        changed > self.numerics.pressure_change * self.across
    }

    /// The pressure of a wall (Pa), at y = 0.
    fn wall_pressure(&self, wall: usize, time: f64) -> f64 {
        self.flow.walls[wall].pressure.at(time) + self.lifts[wall]
    }

    /// Solves for the pressure at a time (s), for what the state is now.
    fn solve(&mut self, time: f64, enthalpy: &[f64]) -> Result<(), String> {
        let began = Instant::now();
        for i in 0..self.conductivity.len() {
            self.conductivity[i] = self.aquifer(i).open * self.permeability[i];
        }
        for wall in 0..self.walls.len() {
            self.walls[wall] = self.wall_pressure(wall, time);
        }
        self.interval = time - self.last_solution;
        if !self.asked.is_empty() && self.interval > 0.0 {
            for i in 0..self.asking.len() {
                let aquifer = self.aquifer(i);
                let taken =
                    aquifer.expansion() * (aquifer.unfrozen(enthalpy[i], self.temperature[i]) - self.started[i]);
                self.asking[i] = (taken - self.asked[i]) / (GROWTH * self.interval);
            }
        }
        self.last_solution = time;
        let asking = (!self.asking.is_empty()).then_some(&self.asking[..]);
        self.pressure.solve(&self.network, &self.conductivity, &self.walls, asking, self.numerics.mean)?;
        self.solved.clone_from(&self.permeability);
        let warm: Vec<bool> = (0..self.walls.len()).map(|wall| self.wall_temperature(wall).is_some()).collect();
        let least = |particle: usize| self.aquifers[self.materials.index(particle)].least_conductivity;
        let ground = Ground { least_conductivity: &least, capacity: self.capacity, warm: &warm };
        self.carrier.take(&self.network, &self.pressure, &ground, self.numerics.advection);
        self.seconds += began.elapsed().as_secs_f64();
        self.bind();
        Ok(())
    }

    /// The step that conduction and water allow together.
    fn bind(&mut self) {
        let least =
            self.aquifers.iter().map(|aquifer| aquifer.thermal.curve.least_capacity()).fold(f64::INFINITY, f64::min);
        let carried = self.carrier.greatest.0 / least;
        let step = 1.0 / (1.0 / self.own_bound.step + carried);
        let carries = if carried > 0.0 {
            format!("advection ({:.3e} s alone, at particle {})", 1.0 / carried, self.carrier.greatest.1)
        } else {
            "no advection, as no water flows".to_owned()
        };
        let cause = format!(
            "conduction ({:.3e} s alone) and {carries}; latent heat only lengthens it: {}",
            self.own_bound.step, self.own_bound.cause
        );
        self.bound = Bound { step, cause };
    }

    /// The temperature that a pressure wall holds, as its patch was seen last.
    fn wall_temperature(&self, wall: usize) -> Option<f64> {
        match self.faces[self.network.patches[wall]] {
            Face::Odd { temperature, .. } | Face::Held { temperature, .. } => Some(temperature),
            Face::Even | Face::Flux(_) | Face::Film { .. } => None,
        }
    }

    /// Rates at a state and time, for a step of this length; `patches` takes the heat that comes in (W).
    fn rates(&mut self, enthalpy: &[f64], clock: &Clock, stage: usize) {
        let mut patches = std::mem::take(&mut self.patches[stage]);
        let walls = patches.len() - 1;
        self.operator.rate(enthalpy, clock.time, &mut self.rate, &mut patches[..walls]);
        if let Some(bend) = &self.bend {
            self.carrier.conducted(&self.rate, bend.kappa);
        }
        self.warm(enthalpy);
        let first = &self.materials.thermals[0];
        self.boundary.update_faces(&mut self.faces, clock.time, &first.curve, first.initial_potential);
        self.beside.clear();
        let held = |patch: u8| match self.faces[patch as usize] {
            Face::Odd { temperature, .. } | Face::Held { temperature, .. } => Some(temperature),
            Face::Film { film, .. } => Some(film.ambient),
            Face::Even | Face::Flux(_) => None,
        };
        self.opening_temperatures.clear();
        let wall_temperatures: [Option<f64>; network::MOST_WALLS] =
            std::array::from_fn(|wall| if wall < self.walls.len() { self.wall_temperature(wall) } else { None });
        let of_opening = |opening: &network::Opening| wall_temperatures[opening.wall as usize];
        self.opening_temperatures.extend(self.network.openings.iter().map(of_opening));
        self.beside.extend(self.network.beside.iter().filter_map(|(i, patch)| Some((*i, held(*patch)?))));
        // Heat in water counts from the freezing point.
        let zero = first.curve.freezing_point();
        for mouth in &self.carrier.mouths {
            let i = mouth.particle as usize;
            let own = self.temperature[i];
            let wall = self.wall_temperature(mouth.wall as usize);
            let entering = wall.unwrap_or(own);
            self.rate[i] += self.capacity * mouth.inflow * (entering - own);
            let carried = mouth.inflow * (entering - zero) - mouth.outflow * (own - zero);
            patches[self.network.patches[mouth.wall as usize]] += self.volume * self.capacity * carried;
        }
        let (kept, temperature) = (&self.carrier.kept[..enthalpy.len()], &self.temperature[..enthalpy.len()]);
        let kept = diagonals::sum(kept.len(), |i| kept[i] * (temperature[i] - zero));
        patches[walls] = -self.volume * self.capacity * kept;
        let materials = &self.materials;
        let enthalpy_at = |particle: usize, temperature: f64| materials.of(particle).enthalpy(temperature);
        let state = State {
            temperature: &self.temperature,
            enthalpy,
            step: clock.step,
            mixed: materials.mixed(),
            enthalpy_at: &enthalpy_at,
            beside: &self.beside,
            openings: &self.opening_temperatures,
            pool: self.pool.as_ref(),
        };
        self.carrier.carry(&self.network, &state, &mut self.rate);
        self.patches[stage] = patches;
    }

    fn book(&mut self, step: f64) {
        for patch in 0..self.patches[0].len() {
            self.ledger.book(patch, 0.5 * step * (self.patches[0][patch] + self.patches[1][patch]), step);
        }
        let volume = self.volume * step;
        for mouth in &self.carrier.mouths {
            self.water.walls[mouth.wall as usize].add(volume * (mouth.inflow - mouth.outflow));
            self.water.exchanged.add(volume * (mouth.inflow + mouth.outflow));
        }
        for (asked, asking) in self.asked.iter_mut().zip(&self.asking) {
            *asked += step * asking;
            self.water.asked.add(volume * asking);
        }
    }
}

impl Method for FlowMethod {
    fn bound(&self) -> Bound {
        self.bound.clone()
    }

    fn sharp_step(&mut self) -> f64 {
        sharp_step(self.operator.as_mut())
    }

    fn advance(&mut self, particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let enthalpy = &mut particles.enthalpy;
        if self.steps > 0 {
            // Temperatures are those of the second stage.
            self.warm(enthalpy);
            self.permeate(enthalpy);
            if self.is_due(clock.time) {
                self.solve(clock.time, enthalpy).map_err(|reason| StepError { reason })?;
            }
        }
        // What flows faster than it did when the step was chosen shortens it.
        let step = clock.step.min(self.bound.step);
        self.start.copy_from_slice(enthalpy);
        self.rates(enthalpy, &Clock { step, ..*clock }, 0);
        for (h, rate) in enthalpy.iter_mut().zip(&self.rate) {
            *h += step * rate;
        }
        self.rates(enthalpy, &Clock { step, time: just_before(clock.time, step), ..*clock }, 1);
        for ((h, start), rate) in enthalpy.iter_mut().zip(&self.start).zip(&self.rate) {
            *h = 0.5 * (start + (*h + step * rate));
        }
        self.book(step);
        self.steps += 1;
        Ok(step)
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn pairs(&self) -> u64 {
        self.pairs
    }

    fn heap_size(&self) -> usize {
        let columns =
            [&self.temperature, &self.permeability, &self.solved, &self.conductivity, &self.started, &self.heights];
        let more = [&self.asked, &self.asking, &self.rate, &self.start];
        let columns: usize = columns.iter().chain(&more).map(|column| column.heap_size()).sum();
        let parts = self.network.heap_size() + self.pressure.heap_size() + self.carrier.heap_size();
        let tables = self.aquifers.iter().map(|aquifer| match &aquifer.warmth {
            Warmth::Exact(_) => 0,
            Warmth::Table { table, .. } => table.heap_size(),
        });
        let copies = self.materials.of_particle.heap_size() + self.beside.capacity() * size_of::<(u32, f64)>();
        self.operator.heap_size() + columns + parts + tables.sum::<usize>() + copies
    }

    fn wanted_step(&self) -> f64 {
        self.fraction * self.bound.step
    }

    fn work(&self) -> Work {
        Work { evaluations: 2 * self.steps, linear_iterations: self.pressure.iterations, ..Work::default() }
    }

    fn water(&self, particles: &Particles) -> Option<Water> {
        let mut inflow = vec![0.0; self.walls.len()];
        let (mut entering, mut leaving) = (0.0, 0.0);
        for mouth in &self.carrier.mouths {
            inflow[mouth.wall as usize] += self.volume * (mouth.inflow - mouth.outflow);
            entering += self.volume * mouth.inflow;
            leaving += self.volume * mouth.outflow;
        }
        let (mut ice, mut liquid, mut taken) = (Sum::default(), Sum::default(), Sum::default());
        for i in 0..particles.len() {
            let aquifer = self.aquifer(i);
            let unfrozen = 1.0 - particles.frozen_fraction(i);
            ice.add(self.volume * aquifer.pores.porosity * (1.0 - unfrozen));
            liquid.add(self.volume * aquifer.pores.porosity * unfrozen);
            if let Some(started) = self.started.get(i) {
                taken.add(self.volume * aquifer.expansion() * (unfrozen - started));
            }
        }
        let exchanged = self.water.exchanged.value();
        let over = |amount: f64| if exchanged > 0.0 { amount / exchanged } else { 0.0 };
        let came: f64 = self.water.walls.iter().map(Sum::value).sum();
        let asked = self.water.asked.value();
        Some(Water {
            walls: self.flow.walls.iter().map(|wall| wall.name).collect(),
            inflow,
            entering,
            leaving,
            balance: over(came - asked),
            owed: over(taken.value() - asked),
            ice: ice.value(),
            liquid: liquid.value(),
            solutions: self.pressure.solutions,
            iterations: self.pressure.iterations,
            seconds: self.seconds,
        })
    }

    fn water_fields(&self) -> Option<(Vec<f64>, Vec<DVec2>)> {
        let mut pressure = self.pressure.pressure.clone();
        for (pressure, height) in pressure.iter_mut().zip(&self.heights) {
            *pressure -= height;
        }
        Some((pressure, velocities(&self.network, &self.pressure)))
    }
}
