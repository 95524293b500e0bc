//! Particles that move as a method.

use std::sync::Arc;

use frazil_core::ledger::{Ledger, Source};
use frazil_core::memory::HeapSize;
use frazil_core::particles::{Particles, Places};
use frazil_core::saved::{Pass, Saved};
use frazil_core::series::Series;
use frazil_core::solvers::solver::{Solver, SolverReport};
use frazil_core::solvers::step::{Bound, Clock, StepError};
use frazil_record::Work;
use glam::DVec2;

use super::ground::SceneMatter;
use super::map::DpdUnits;
use super::patches::WallPatches;
use crate::fluid::{Drive, Fluid, WallState};

/// A scene whose liquid particles move.
pub struct MovingParticles<W: Drive<2>> {
    fluid: Fluid<2, SceneMatter>,
    drive: W,
    map: DpdUnits,
    /// Temperature of each patch over time; none where it is insulated.
    patches: Vec<Option<Series>>,
    ledger: Ledger,
    /// Patch of the ledger for what motion turns into heat, and its energy so far turned.
    motion: (usize, f64),
    /// Heat that the drive had brought when last booked.
    driven: f64,
    /// Time of the last booking of motion (s), and now.
    times: (f64, f64),
    /// Enthalpy (J by metre of each missing dimension) of one unit of heat.
    joule: f64,
    bound: Bound,
    steps: u64,
}

impl<W: Drive<2>> MovingParticles<W> {
    /// A fluid in the units of `map` that a drive acts on, behind patches; `joule` is the enthalpy (J by metre of each missing
    /// dimension) of one unit of heat.
    pub fn new(
        fluid: Fluid<2, SceneMatter>,
        drive: W,
        map: DpdUnits,
        patches: &WallPatches,
        joule: f64,
        bound: Bound,
    ) -> Self {
        let sources = patches.ids.iter().map(|id| Source::Patch(*id)).chain([Source::Motion]).collect();
        let mut method = MovingParticles {
            fluid,
            drive,
            map,
            patches: patches.temperatures.clone(),
            ledger: Ledger::new(sources),
            motion: (patches.ids.len(), 0.0),
            driven: 0.0,
            times: (0.0, 0.0),
            joule,
            bound,
            steps: 0,
        };
        method.motion.1 = method.unheated();
        method
    }

    /// Kinetic and potential energy, less what is still to be given back.
    fn unheated(&self) -> f64 {
        let totals = self.fluid.totals();
        totals.kinetic + totals.potential - self.fluid.owed()
    }
}

impl<W: Drive<2> + Send> Solver for MovingParticles<W> {
    fn report(&self) -> SolverReport {
        let work = Work { evaluations: self.steps, ..Work::default() };
        let pairs = self.fluid.pairs();
        SolverReport { bound: self.bound.clone(), pairs, gentle_step: None, is_dense: false, work }
    }

    fn make_step(&mut self, _particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let now = clock.time + clock.step;
        for (face, patch) in self.fluid.faces().iter_mut().zip(&self.patches) {
            if let Some(series) = patch {
                *face = WallState::Held((series.at(now) - self.map.zero) / self.map.degree);
            }
        }
        self.fluid
            .advance_by(clock.step / self.map.time, &self.drive)
            .map_err(|wrong| StepError::Own(wrong.to_string()))?;
        if let Some(walls) = self.fluid.walls() {
            for (patch, received) in walls.received.iter().enumerate() {
                self.ledger.book(patch, -received * self.joule, clock.step);
            }
        }
        self.times.1 = now;
        self.steps += 1;
        Ok(clock.step)
    }

    fn publish(&mut self, particles: &mut Particles) {
        let (per_heat, length) = (self.fluid.matter().per_heat(), self.map.length);
        let speed = self.map.length / self.map.time;
        let count = particles.enthalpy.len();
        let Places::Cloud(places) = &mut particles.places else { return };
        let places = Arc::make_mut(places);
        for particle in self.fluid.particles() {
            let name = particle.name as usize;
            if name < count {
                particles.enthalpy[name] = particle.heat * per_heat;
                let [x, y] = particle.position;
                places[name] = DVec2::new(x, y) * length;
                let [u, v] = particle.velocity;
                particles.velocity[name] = DVec2::new(u, v) * speed;
            }
        }
        // Energy that has left motion has become heat; what a drive brought came in on the way.
        let unheated = self.unheated();
        let step = self.times.1 - self.times.0;
        if step > 0.0 {
            let (patch, before) = self.motion;
            let brought = self.fluid.driven - self.driven;
            self.ledger.book(patch, (before - unheated + brought) * self.joule, step);
            self.driven = self.fluid.driven;
            self.times.0 = self.times.1;
        }
        self.motion.1 = unheated;
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }
}

impl<W: Drive<2>> Saved for MovingParticles<W> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [
            &mut self.fluid,
            &mut self.ledger,
            &mut self.motion.1,
            &mut self.driven,
            &mut self.times,
            &mut self.steps,
        ]);
    }
}

impl<W: Drive<2>> HeapSize for MovingParticles<W> {
    fn heap_size(&self) -> usize {
        self.fluid.heap_size() + self.patches.len() * size_of::<Option<Series>>()
    }
}
