//! Scenes whose liquid particles move.
//!
//! The scene is mapped to DPD units: the mean distance of particles is the spacing, a temperature of 1 is 300 K, and time
//! is such that the liquid has the wanted thermal diffusivity; so Fourier and Stefan numbers are the scene's. Particles come
//! to rest when all of them is frozen and move again when nothing is. Walls are layers of particles at rest
//! ([`crate::fluid::walls`]); what drifts into them is sent back the way it came. Opposite sides that are both planes of
//! symmetry are joined to a period instead.

mod drive;
mod ground;
mod limit;
mod place;
mod settings;

use std::sync::Arc;

use frazil_core::boundary::condition::Condition;
use frazil_core::ledger::Ledger;
use frazil_core::particles::{Particles, Places};
use frazil_core::physics::curve::Curve;
use frazil_core::physics::thermal::Thermal;
use frazil_core::series::Series;
use frazil_core::solvers::method::Method;
use frazil_core::solvers::moving::{Crowd, Purpose};
use frazil_core::solvers::step::{Bound, Clock, StepError};
use frazil_core::space::domain::Domain;
use frazil_record::Work;
use frazil_scene::method::MethodSettings;
use frazil_scene::region::Cell;
use frazil_scene::{Scene, Units};
use glam::DVec2;
use rayon::ThreadPool;

use crate::fluid::{Drive, Exponent, Face, Fluid, Parameters, Walls};
use drive::{Confined, Driven};
use ground::Ground;
use place::{Body, fill, wall};

pub use settings::{Motion, read};

/// Temperature (K) that is 1 in DPD units.
const DEGREE: f64 = 300.0;

/// Thermal diffusivity of the liquid in DPD units, where the scene has other units and names none.
const DIFFUSIVITY: f64 = 1.1;

/// Time step of the liquid before the scene begins.
const SETTLING_STEP: f64 = 0.01;

/// How lengths, times and temperatures of a scene become those of the particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Map {
    /// Length (m) of one DPD unit.
    pub length: f64,
    /// Time (s) of one DPD unit.
    pub time: f64,
    /// Absolute zero on the scale of the scene.
    pub zero: f64,
    /// Degrees of the scene in one DPD unit of temperature.
    pub degree: f64,
}

impl Map {
    fn new(units: Units, spacing: f64, motion: &Motion, diffusivity: f64) -> Self {
        let length = spacing * motion.number_density.sqrt();
        let (time, degree) = match units {
            Units::Dpd => (length * length, 1.0),
            Units::Si | Units::Dimensionless => {
                let degree = if units == Units::Si { DEGREE } else { 1.0 };
                (motion.diffusivity.unwrap_or(DIFFUSIVITY) * length * length / diffusivity, degree)
            }
        };
        Map { length, time, zero: units.absolute_zero(), degree }
    }

    /// A temperature of the scene in DPD units.
    fn temperature(&self, temperature: f64) -> f64 {
        (temperature - self.zero) / self.degree
    }

    /// In words, for the report.
    pub fn words(&self, units: Units) -> String {
        let (length, time, degree) = match units {
            Units::Si => (" m", " s", " K"),
            Units::Dpd | Units::Dimensionless => ("", "", ""),
        };
        format!(
            "scales: one DPD length is {:.6e}{length}, one DPD time {:.6e}{time}, a temperature of 1 is {}{degree}",
            self.length, self.time, self.degree
        )
    }
}

/// A scene whose liquid particles move.
struct Moving<W: Drive<2>> {
    fluid: Fluid<2, Ground>,
    drive: W,
    map: Map,
    /// Temperature of each door over time; none where it is insulated.
    doors: Vec<Option<Series>>,
    ledger: Ledger,
    /// Door of the ledger for what motion turns into heat, and its energy so far turned.
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

impl<W: Drive<2>> Moving<W> {
    fn new(parts: Parts, drive: W) -> Self {
        let Parts { fluid, map, doors, ledger, joule, bound } = parts;
        let motion = (doors.len(), 0.0);
        let mut method =
            Moving { fluid, drive, map, doors, ledger, motion, driven: 0.0, times: (0.0, 0.0), joule, bound, steps: 0 };
        method.motion.1 = method.unheated();
        method
    }

    /// Kinetic and potential energy, less what is still to be given back.
    fn unheated(&self) -> f64 {
        let totals = self.fluid.totals();
        totals.kinetic + totals.potential - self.fluid.owed()
    }
}

impl<W: Drive<2> + Send> Method for Moving<W> {
    fn bound(&self) -> Bound {
        self.bound.clone()
    }

    fn sharp_step(&mut self) -> f64 {
        self.bound.step
    }

    fn advance(&mut self, _particles: &mut Particles, clock: &Clock) -> Result<f64, StepError> {
        let now = clock.time + clock.step;
        for (face, door) in self.fluid.faces().iter_mut().zip(&self.doors) {
            if let Some(series) = door {
                *face = Face::Held((series.at(now) - self.map.zero) / self.map.degree);
            }
        }
        self.fluid.advance_by(clock.step / self.map.time, &self.drive).map_err(|reason| StepError { reason })?;
        if let Some(walls) = self.fluid.walls() {
            for (door, received) in walls.received.iter().enumerate() {
                self.ledger.book(door, -received * self.joule, clock.step);
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
            let (door, before) = self.motion;
            let brought = self.fluid.driven - self.driven;
            self.ledger.book(door, (before - unheated + brought) * self.joule, step);
            self.driven = self.fluid.driven;
            self.times.0 = self.times.1;
        }
        self.motion.1 = unheated;
    }

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn pairs(&self) -> u64 {
        self.fluid.pairs()
    }

    fn held(&self) -> usize {
        self.fluid.held() + self.doors.len() * size_of::<Option<Series>>()
    }

    fn work(&self) -> Work {
        Work { evaluations: self.steps, ..Work::default() }
    }
}

/// Particles and method of a scene with motion.
///
/// # Errors
/// What the method cannot represent, by key.
pub fn build(
    scene: &Scene,
    settings: &MethodSettings,
    (motion, cutoff_ratio, capacity): (&Motion, f64, f64),
    pool: Option<Arc<ThreadPool>>,
    seed: u64,
    purpose: Purpose,
) -> Result<Crowd, String> {
    let numerics = &settings.numerics;
    let (extent, width) = match scene.domain {
        Domain::Line { length } => ((length, 0.0), None),
        Domain::Rectangle { width, height } => ((width, height), Some(())),
        Domain::Ring { .. } | Domain::Radial { .. } | Domain::Axial { .. } => {
            return Err("motion = true needs the domain \"line\" or \"rectangle\"".into());
        }
    };
    refuse(scene)?;
    let thermal = Thermal::new(Curve::new(&scene.materials[0]), scene.initial_temperature);
    let curve = &thermal.curve;
    let diffusivity = curve.mixed_conductivity(1.0) / curve.unfrozen_capacity();
    let map = Map::new(scene.units, numerics.spacing, motion, diffusivity);
    let strip = if width.is_some() { extent.1 / map.length } else { motion.strip_width };
    let lengths = [extent.0 / map.length, strip];
    let (low, high) = scene.temperature_range();
    let (low, high) = (map.temperature(low), map.temperature(high));
    let cutoff = cutoff_ratio / motion.number_density.sqrt();
    let liquid_diffusivity = diffusivity * map.time / map.length.powi(2);
    let mut parameters = Parameters {
        density: motion.number_density,
        repulsion: motion.repulsion * 0.5 * (low + high),
        friction: motion.friction,
        exponent: motion.exponent.clone(),
        conservative_cutoff: cutoff,
        dissipative_cutoff: cutoff,
        thermal_cutoff: cutoff,
        heat_capacity: capacity,
        heat_friction: 1.0,
        step: SETTLING_STEP,
    };
    parameters.heat_friction = parameters.constants(2).heat_friction(liquid_diffusivity);
    let bound = limit::bound(&parameters, &map, curve, (low, high), liquid_diffusivity);
    parameters.step = SETTLING_STEP.min(bound.step / map.time);
    let condition = |name: &str| scene.wall(name).unwrap_or(&Condition::Symmetry);
    let closed = |name: &str| *condition(name) == Condition::Symmetry;
    let names = ["left", "right", "bottom", "top"];
    let walled = [!(closed("left") && closed("right")), width.is_some() && !(closed("bottom") && closed("top"))];
    let start = map.temperature(scene.initial_temperature);
    let settling = limit::settling(&parameters, &map, curve, (low, high), liquid_diffusivity);
    let placed = fill(&Body { lengths, walled }, &settling, start, seed, pool.clone(), purpose)?;
    let count = placed.particles.len() - placed.behind.len();
    let volume = map.length.powi(2) / motion.number_density / if width.is_some() { 1.0 } else { strip * map.length };
    let per_heat = curve.unfrozen_capacity() * map.degree / capacity;
    let joule = per_heat * volume;
    let ground = Ground::new(
        thermal.clone(),
        per_heat,
        (map.zero, map.degree),
        (numerics.exchange, numerics.mushy),
        (0.5 * low, 2.0 * high),
    );
    let mut particles = placed.particles;
    if scene.has_regional_starts() {
        for particle in &mut particles[..count] {
            let place = DVec2::from_array(particle.position) * map.length;
            let parts = scene.starts_in(&Cell::around(place, numerics.spacing));
            particle.heat = parts.into_iter().map(|(temperature, share)| share * ground.heat(temperature)).sum();
        }
    }
    if let Some(stream) = &scene.stream {
        let half = 0.5 * lengths[1];
        for particle in &mut particles[..count] {
            let across = particle.position[1] / half - 1.0;
            particle.velocity[0] += stream.start_speed * map.time / map.length * (1.0 - across * across);
        }
    }
    let mut doors = vec![None; 4 + scene.wall_parts.len()];
    let mut ledger_names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    for (axis, walled) in walled.into_iter().enumerate() {
        for end in [false, true].into_iter().filter(|_| walled) {
            let door = wall(axis, end);
            if let Condition::Temperature(series) = condition(names[door]) {
                doors[door] = Some(series.clone());
            }
        }
    }
    let mut behind = placed.behind;
    for (k, part) in scene.wall_parts.iter().enumerate() {
        ledger_names.push(format!("{}_part_{}", part.wall, k + 1));
        if let Condition::Temperature(series) = &part.condition {
            doors[4 + k] = Some(series.clone());
        }
        let whole = names.iter().position(|name| *name == part.wall).map_or(u32::MAX, |wall| wall as u32);
        let along = usize::from(whole < 2);
        for behind in &mut behind {
            let place = behind.image[along].rem_euclid(lengths[along]) * map.length;
            let of_wall = behind.door == whole
                || (behind.door >= 4 && scene.wall_parts[behind.door as usize - 4].wall == part.wall);
            if of_wall && place >= part.from && place < part.to {
                behind.door = 4 + k as u32;
            }
        }
    }
    ledger_names.push("motion".into());
    let first = count as u32;
    let door_count = doors.len();
    let enthalpies: Vec<f64> = particles[..count].iter().map(|particle| particle.heat * per_heat).collect();
    let walls = Walls::new(first, behind, door_count);
    let walls = walled.contains(&true).then_some(walls);
    let shut = scene.stream.as_ref().map(|_| 0);
    let reset = scene.stream.as_ref().and_then(|stream| stream.reset);
    let reset = reset.map(|((from, to), warm)| ((from / map.length, to / map.length), ground.heat(warm)));
    let fluid = Fluid::assembled(parameters, placed.lengths, ground, particles, walls, shut, seed, pool)?;
    let differences = vec![map.words(scene.units), words(&fluid, count)];
    let confined = Confined { lengths, walled };
    let parts = Parts { fluid, map, doors, ledger: Ledger::new(ledger_names), joule, bound };
    let method: Box<dyn Method> = match &scene.stream {
        None => Box::new(Moving::new(parts, confined)),
        Some(stream) => {
            let pump = stream.pump.unwrap_or((0.0, extent.0));
            let drive = Driven {
                confined,
                acceleration: stream.acceleration * map.time * map.time / map.length,
                pump: (pump.0 / map.length, pump.1 / map.length),
                reset,
                walls_from: first,
            };
            Box::new(Moving::new(parts, drive))
        }
    };
    Ok(Crowd { thermal, enthalpy: enthalpies, volume, differences, method })
}

/// What a moving scene is made of but for its drive.
struct Parts {
    fluid: Fluid<2, Ground>,
    map: Map,
    doors: Vec<Option<Series>>,
    ledger: Ledger,
    joule: f64,
    bound: Bound,
}

fn words(fluid: &Fluid<2, Ground>, count: usize) -> String {
    let behind = fluid.particles().len() - count;
    match &fluid.parameters().exponent {
        Exponent::Constant(value) => format!("{behind} particles stand behind walls; exponent of friction {value}"),
        Exponent::Table(rows) => {
            format!("{behind} particles stand behind walls; exponent of friction from a table of {} rows", rows.len())
        }
    }
}

/// What a scene has that moving particles cannot represent.
fn refuse(scene: &Scene) -> Result<(), String> {
    let problems = [
        (scene.materials.len() > 1, "more than one material"),
        (!scene.cracks.is_empty(), "cracks"),
        (!scene.rings.is_empty(), "freeze pipes"),
        (scene.flow.is_some(), "groundwater"),
        (!scene.watch.surfaces.is_empty(), "heat through surfaces"),
    ];
    if let Some((_, what)) = problems.into_iter().find(|problem| problem.0) {
        return Err(format!("motion = true knows no {what}: the liquid itself moves"));
    }
    let whole = scene.walls.iter().map(|wall| (wall.name, &wall.condition));
    for (name, condition) in whole.chain(scene.wall_parts.iter().map(|part| (part.wall, &part.condition))) {
        let kind = match condition {
            Condition::Symmetry | Condition::Temperature(_) => continue,
            Condition::Flux(_) => "a flux",
            Condition::Convection { .. } => "a film",
            Condition::Exact => "an exact solution",
        };
        return Err(format!(
            "the wall \"{}\" has {kind}, but walls of moving particles have a temperature or none: motion = true needs \
             \"temperature\" or condition = \"symmetry\"",
            name
        ));
    }
    Ok(())
}
