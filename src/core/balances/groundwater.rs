//! Groundwater that flows through freezing ground.
//!
//! The pairs that conduct heat conduct water: particle i sends `q_ij = w_ij K_ij (p_i - p_j)` to j (1/s by volume), with
//! the pair's weight, a mean of the hydraulic conductivities of both and the difference of pressures, which follow from `sum_j q_ij = -n (1 - rho_i/rho_w) dS_w/dt` (Nikolaev et al. 2021, eqs 3 and 6). The pressure follows
//! the state of heat at once: it is solved for between steps of heat, which see it frozen ([`advected`]). What cuts pairs
//! cuts the paths of water.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;

use crate::balances::groundwater::aquifer::Aquifer;
use crate::balances::groundwater::carrier::{Carrier, Ground};
use crate::balances::groundwater::cuts::CutPaths;
use crate::balances::groundwater::displaced::Displaced;
use crate::balances::groundwater::error::GroundwaterError;
use crate::balances::groundwater::ground::Flow;
use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::numerics::{Advection, FlowNumerics};
use crate::balances::groundwater::pressure::Pressure;
use crate::balances::groundwater::tasks::{each, sum, tasks};
use crate::balances::groundwater::velocity::velocities;
use crate::boundary::patch::Face;
use crate::ledger::Sum;
use crate::memory::{HeapSize, shared, total};
use crate::particles::Particles;
use crate::physics::latent_heat::Materials;
use crate::saved::{Pass, Saved};
use crate::solvers::solver::Water;
use crate::team::Team;

pub mod advected;
pub mod aquifer;
pub mod bend;
mod build;
pub mod carrier;
mod cuts;
pub mod diagonals;
mod displaced;
pub mod error;
pub mod ground;
mod matrix;
pub mod network;
pub mod numerics;
mod path_sums;
pub mod places;
pub mod pressure;
pub mod surfaces;
pub mod tasks;
pub mod velocity;

pub use build::FlowParts;

/// Intervals between solutions for the pressure grow at most by this factor where ice displaces water.
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

/// Water in the pores of a body.
struct Groundwater {
    network: Network,
    pressure: Pressure,
    carrier: Carrier,
    cuts: Option<Box<CutPaths>>,
    aquifers: Vec<Aquifer>,
    materials: Materials,
    faces: Vec<Face>,
    flow: Flow,
    numerics: FlowNumerics,
    volume: f64,
    across: f64,
    /// What gravity adds to the pressure of each wall, and to that of each particle (Pa); none without gravity.
    lifts: Vec<f64>,
    heights: Vec<f64>,
    /// Heat capacity of water (J/m3K).
    capacity: f64,
    team: Option<Team>,
    temperature: Vec<f64>,
    permeability: Vec<f64>,
    /// How much better water passes the ground of each particle than its material; empty where it passes all as its material.
    passes: Arc<[f64]>,
    /// Permeabilities that the pressure was solved for, and how steep it then was.
    solved: Vec<f64>,
    steepness: Vec<f64>,
    conductivity: Vec<f64>,
    walls: Vec<f64>,
    /// Sums of tasks.
    sums: Vec<f64>,
    displaced: Displaced,
    last_solution: f64,
    interval: f64,
    /// How long (s) the last solution may stand.
    lasts: f64,
    ledger: WaterLedger,
    steps: u64,
    seconds: f64,
}

impl Groundwater {
    fn aquifer(&self, particle: usize) -> &Aquifer {
        &self.aquifers[self.materials.index(particle)]
    }

    /// Fills the temperatures.
    fn warm(&mut self, enthalpy: &[f64]) {
        let Groundwater { temperature, aquifers, materials, team, .. } = self;
        tasks(team.as_ref(), temperature, |first, temperatures| {
            for (run, _) in materials.runs(first..first + temperatures.len()) {
                let aquifer = &aquifers[materials.index(run.start)];
                aquifer
                    .fill_temperatures(&enthalpy[run.clone()], &mut temperatures[run.start - first..run.end - first]);
            }
        });
    }

    /// Fills the relative permeabilities.
    fn permeate(&mut self, enthalpy: &[f64]) {
        let (law, least) = (self.flow.relative_permeability, self.flow.least_relative_permeability);
        let Groundwater { permeability, temperature, aquifers, materials, team, .. } = self;
        each(team.as_ref(), permeability, |i, permeability| {
            let aquifer = &aquifers[materials.index(i)];
            *permeability = if enthalpy[i] + aquifer.thermal.zero_enthalpy >= 0.0 {
                1.0
            } else {
                law.at(aquifer.unfrozen(enthalpy[i], temperature[i]), aquifer.pores.porosity).max(least)
            };
        });
    }

    /// Follows the state of heat at a time (s), where permeabilities, walls, ice or paths have changed enough; whether they
    /// have.
    fn follow(&mut self, enthalpy: &[f64], time: f64) -> Result<bool, GroundwaterError> {
        if self.steps == 0 {
            return Ok(false);
        }
        // Temperatures are those within the last step.
        self.warm(enthalpy);
        self.permeate(enthalpy);
        let cut = self.cut(time)?;
        let jumps = (0..self.walls.len()).any(|wall| self.wall_pressure(wall, time) != self.walls[wall]);
        let due = self.is_due(time) || cut || jumps;
        if due {
            let goes_on = !cut && !jumps && self.numerics.advection != Advection::Paper;
            self.solve(time, enthalpy, goes_on)?;
        }
        Ok(due)
    }

    /// Cuts the paths whose pairs are cut by a time (s); whether there are any new ones.
    fn cut(&mut self, time: f64) -> Result<bool, GroundwaterError> {
        let Some(cuts) = &mut self.cuts else { return Ok(false) };
        let Some(network) = cuts.bring_to(time)? else { return Ok(false) };
        self.network = network;
        Ok(true)
    }

    /// Whether permeabilities, walls or ice have changed enough for another solution by this time (s).
    fn is_due(&mut self, time: f64) -> bool {
        let since = time - self.last_solution;
        let Groundwater { permeability, solved, steepness, team, sums, .. } = self;
        let count = permeability.len();
        let (now, then, steep) = (&permeability[..count], &solved[..count], &steepness[..count]);
        let changed = sum(team.as_ref(), sums, count, |i| (now[i] - then[i]).abs() * steep[i]);
        let allowed = self.numerics.pressure_change * self.across;
        let lasts = if changed > 0.0 { since * allowed / changed } else { f64::INFINITY };
        self.lasts = lasts.min(self.numerics.pressure_interval);
        let expands = !self.displaced.is_none() && since >= GROWTH * self.interval;
        since >= self.numerics.pressure_interval || expands || changed > allowed
    }

    /// The pressure of a wall (Pa), at y = 0.
    fn wall_pressure(&self, wall: usize, time: f64) -> f64 {
        self.flow.walls[wall].pressure.at(time) + self.lifts[wall]
    }

    /// Solves for the pressure at a time (s), for what the state is now. Where water goes on as it has changed since the last
    /// solution, it is that of the middle of the time until the next.
    fn solve(&mut self, time: f64, enthalpy: &[f64], goes_on: bool) -> Result<(), GroundwaterError> {
        let began = Instant::now();
        for i in 0..self.conductivity.len() {
            self.conductivity[i] = self.aquifer(i).open * self.permeability[i];
        }
        for (conductivity, factor) in self.conductivity.iter_mut().zip(self.passes.iter()) {
            *conductivity *= factor;
        }
        for wall in 0..self.walls.len() {
            self.walls[wall] = self.wall_pressure(wall, time);
        }
        self.interval = time - self.last_solution;
        if self.interval > 0.0 {
            let Groundwater { displaced, aquifers, materials, temperature, cuts, interval, .. } = self;
            let comes = |i| cuts.as_ref().is_none_or(|cuts| cuts.is_open(i));
            displaced.ask(*interval, GROWTH, comes, |i, started| {
                let aquifer = &aquifers[materials.index(i)];
                aquifer.expansion() * (aquifer.unfrozen(enthalpy[i], temperature[i]) - started)
            });
        }
        self.last_solution = time;
        // Half of the time until the next solution, which is as long as that since the last, or shorter where much has changed.
        let ahead = if goes_on && self.interval > 0.0 { (self.lasts / self.interval).min(0.5) } else { 0.0 };
        let Groundwater { network, conductivity, walls, carrier, numerics, displaced, .. } = self;
        let displaced = displaced.solve_for(ahead);
        self.pressure.solve(network, conductivity, walls, displaced, carrier.passing, numerics.mean)?;
        self.solved.clone_from(&self.permeability);
        self.pressure.steepness(&self.network, &self.permeability, &mut self.steepness);
        let warm: Vec<bool> = (0..self.walls.len()).map(|wall| self.wall_temperature(wall).is_some()).collect();
        let ground = Ground { capacity: self.capacity, warm: &warm, team: self.team.as_ref(), ahead };
        self.carrier.take(&self.network, &self.pressure, &ground, self.numerics.advection);
        self.seconds += began.elapsed().as_secs_f64();
        Ok(())
    }

    /// The temperature that a pressure wall holds, as its patch was seen last.
    fn wall_temperature(&self, wall: usize) -> Option<f64> {
        match self.faces[self.network.patches[wall]] {
            Face::Odd { temperature, .. } | Face::Held { temperature, .. } => Some(temperature),
            Face::Even | Face::Flux(_) | Face::Film { .. } | Face::Runoff(_) => None,
        }
    }

    /// Books the water of a step (s).
    fn book(&mut self, step: f64) {
        self.steps += 1;
        let volume = self.volume * step;
        for mouth in &self.carrier.mouths {
            self.ledger.walls[mouth.wall as usize].add(volume * (mouth.inflow - mouth.outflow));
            self.ledger.exchanged.add(volume * (mouth.inflow + mouth.outflow));
        }
        let Groundwater { displaced, ledger, .. } = self;
        displaced.book(step, |asking| ledger.asked.add(volume * asking));
    }

    /// Where it stands.
    fn water(&self, particles: &Particles) -> Water {
        let mut inflow = vec![0.0; self.walls.len()];
        let (mut entering, mut leaving) = (0.0, 0.0);
        for mouth in &self.carrier.mouths {
            inflow[mouth.wall as usize] += self.volume * (mouth.inflow - mouth.outflow);
            entering += self.volume * mouth.inflow;
            leaving += self.volume * mouth.outflow;
        }
        let (mut ice, mut liquid, mut taken) = (Sum::default(), Sum::default(), Sum::default());
        // What was dug out holds none.
        for i in (0..particles.len()).filter(|i| !particles.is_gone(*i)) {
            let aquifer = self.aquifer(i);
            let unfrozen = 1.0 - particles.frozen_fraction(i);
            ice.add(self.volume * aquifer.pores.porosity * (1.0 - unfrozen));
            liquid.add(self.volume * aquifer.pores.porosity * unfrozen);
            if let Some(started) = self.displaced.started.get(i) {
                taken.add(self.volume * aquifer.expansion() * (unfrozen - started));
            }
        }
        let exchanged = self.ledger.exchanged.value();
        let over = |amount: f64| if exchanged > 0.0 { amount / exchanged } else { 0.0 };
        let came: f64 = self.ledger.walls.iter().map(Sum::value).sum();
        let asked = self.ledger.asked.value();
        Water {
            walls: self.flow.walls.iter().map(|wall| wall.wall).collect(),
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
        }
    }

    /// Pressures (Pa) and Darcy velocities (m/s) of all particles.
    fn fields(&self) -> (Vec<f64>, Vec<DVec2>) {
        let mut pressure = self.pressure.pressure.clone();
        for (pressure, height) in pressure.iter_mut().zip(&self.heights) {
            *pressure -= height;
        }
        (pressure, velocities(&self.network, &self.pressure))
    }
}

impl Saved for WaterLedger {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.walls, &mut self.exchanged, &mut self.asked]);
    }
}

impl Saved for Groundwater {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        if let Some(cuts) = &mut self.cuts {
            match cuts.pass(pass) {
                Ok(Some(network)) => self.network = network,
                Ok(None) => {}
                Err(_) => pass.refuse(),
            }
        }
        pass.all(&mut [
            &mut self.pressure,
            &mut self.carrier,
            &mut self.solved,
            &mut self.steepness,
            &mut self.walls,
            &mut self.displaced,
            &mut self.last_solution,
            &mut self.interval,
            &mut self.lasts,
            &mut self.ledger,
            &mut self.steps,
            &mut self.seconds,
        ]);
    }
}

impl HeapSize for Groundwater {
    fn heap_size(&self) -> usize {
        let ground = total(&[&self.temperature, &self.permeability, &self.solved, &self.steepness, &self.conductivity]);
        let columns = ground + total(&[&self.heights, &self.walls, &self.sums]) + self.displaced.heap_size();
        let parts = self.network.heap_size() + self.pressure.heap_size() + self.carrier.heap_size();
        let tables = self.aquifers.iter().map(HeapSize::heap_size);
        let cuts = self.cuts.as_ref().map_or(0, |cuts| cuts.heap_size());
        columns + parts + tables.sum::<usize>() + cuts + shared(&self.passes) + self.materials.of_particle.heap_size()
    }
}
