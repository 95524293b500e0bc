//! The balance of heat where water flows: conduction, and what water carries beside it.

use frazil_record::plain;

use crate::balances::groundwater::Groundwater;
use crate::balances::groundwater::bend::Bend;
use crate::balances::groundwater::carrier::State;
use crate::balances::groundwater::network::MOST_WALLS;
use crate::balances::groundwater::surfaces::Crossed;
use crate::balances::groundwater::tasks::sum;
use crate::boundary::patch::{Boundary, Face};
use crate::memory::{HeapSize, total};
use crate::particles::Particles;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::{Balance, BalanceFacts, Companion, Rates, Tangent, TangentShape, Update};
use crate::solvers::solver::Water;
use crate::solvers::step::{Bound, Clock, StepError};
use crate::team::Team;

/// Heat that is conducted and carried by water.
pub struct AdvectedHeat {
    pub(super) conduction: Box<dyn Balance>,
    pub(super) water: Groundwater,
    pub(super) bend: Option<Bend>,
    pub(super) boundary: Boundary,
    /// The bound of conduction alone.
    pub(super) own_bound: Bound,
    pub(super) facts: BalanceFacts,
    pub(super) surfaces: Vec<Crossed>,
    pub(super) beside: Vec<(u32, f64)>,
    pub(super) opening_temperatures: Vec<Option<f64>>,
    /// Rates of a step of Euler or a stage, and temperatures that small changes of potentials make (m K/W).
    pub(super) rate: Vec<f64>,
    pub(super) warmed: Vec<f64>,
    pub(super) changes: Vec<f64>,
}

impl AdvectedHeat {
    /// The step that conduction and water allow together.
    pub(super) fn bind(&mut self) {
        let (carrier, materials) = (&self.water.carrier, &self.water.materials);
        let least = materials.laws().map(|thermal| thermal.curve.least_capacity()).fold(f64::INFINITY, f64::min);
        let carried = carrier.greatest.0 / least;
        let step = 1.0 / (1.0 / self.own_bound.step + carried);
        let carries = if carried > 0.0 {
            format!("advection ({} s alone, at particle {})", plain(1.0 / carried, 4), carrier.greatest.1)
        } else {
            "no advection, as no water flows".to_owned()
        };
        let cause = format!(
            "conduction ({} s alone) and {carries}; latent heat can only increase it: {}",
            plain(self.own_bound.step, 4),
            self.own_bound.cause
        );
        let linear = 1.0 / (1.0 / self.own_bound.linear_step() + carried);
        self.facts.bound = Bound { step, slack: linear / step, cause };
        self.facts.turning = carrier.turning / least;
    }

    /// Brings walls and openings to a time (s).
    fn bring_walls_to(&mut self, time: f64) {
        let water = &mut self.water;
        let first = &water.materials.thermals[0];
        self.boundary.update_faces(&mut water.faces, time, &first.curve, first.zero_potential);
        let held = |patch: u8| match water.faces[patch as usize] {
            Face::Odd { temperature, .. } | Face::Held { temperature, .. } => Some(temperature),
            Face::Film { film, .. } => Some(film.ambient),
            Face::Even | Face::Flux(_) | Face::Runoff(_) => None,
        };
        let of_walls: [Option<f64>; MOST_WALLS] =
            std::array::from_fn(|wall| if wall < water.walls.len() { water.wall_temperature(wall) } else { None });
        self.opening_temperatures.clear();
        let openings = water.network.openings.iter();
        self.opening_temperatures.extend(openings.map(|opening| of_walls[opening.wall as usize]));
        self.beside.clear();
        self.beside.extend(water.network.beside.iter().filter_map(|(i, patch)| Some((*i, held(*patch)?))));
    }

    /// Adds what water carries to the rates (W/m3) of conduction; `patches` takes what comes in through its walls, and last what
    /// stays with ice (W).
    fn carry(&mut self, enthalpy: &[f64], step: f64, rate: &mut [f64], patches: &mut [f64]) {
        let Groundwater { network, carrier, temperature, materials, volume, capacity, .. } = &self.water;
        let zero = materials.thermals[0].curve.freezing_point();
        for mouth in &carrier.mouths {
            let i = mouth.particle as usize;
            let entering = self.water.wall_temperature(mouth.wall as usize).unwrap_or(temperature[i]);
            rate[i] += capacity * mouth.inflow * (entering - temperature[i]);
            let carried = mouth.inflow * (entering - zero) - mouth.outflow * (temperature[i] - zero);
            patches[network.patches[mouth.wall as usize]] += volume * capacity * carried;
        }
        let Groundwater { network, carrier, temperature, materials, team, volume, capacity, sums, .. } =
            &mut self.water;
        let (count, kept, held) = (enthalpy.len(), &carrier.kept[..enthalpy.len()], &temperature[..enthalpy.len()]);
        let stays = sum(team.as_ref(), sums, count, |i| kept[i] * (held[i] - zero));
        patches[patches.len() - 1] = -*volume * *capacity * stays;
        let enthalpy_at = |particle: usize, temperature: f64| materials.of(particle).enthalpy(temperature);
        let state = State {
            temperature,
            enthalpy,
            step,
            mixed: materials.mixed(),
            enthalpy_at: &enthalpy_at,
            beside: &self.beside,
            openings: &self.opening_temperatures,
            team: team.as_ref(),
        };
        carrier.carry(network, &state, rate);
    }

    /// Adds the heat (W) that water carries through the surfaces, towards greater coordinates.
    fn across(&self, heat: &mut [f64]) {
        let Groundwater { network, carrier, temperature, materials, volume, capacity, .. } = &self.water;
        let zero = materials.thermals[0].curve.freezing_point();
        let of_path = |i: usize, j: usize, slot: usize| carrier.along(network, temperature, (i, j, slot), zero);
        let of_mouth = |number: usize| {
            let mouth = &carrier.mouths[number];
            let own = temperature[mouth.particle as usize];
            let entering = self.water.wall_temperature(mouth.wall as usize).unwrap_or(own);
            capacity * (mouth.inflow * (entering - zero) - mouth.outflow * (own - zero))
        };
        for (heat, crossed) in heat.iter_mut().zip(&self.surfaces) {
            *heat += volume * crossed.heat(of_path, of_mouth);
        }
    }
}

impl Saved for AdvectedHeat {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.conduction.pass(pass);
        self.water.pass(pass);
        self.bind();
    }
}

impl Balance for AdvectedHeat {
    fn facts(&self) -> &BalanceFacts {
        &self.facts
    }

    fn next_kink(&self, enthalpy: &[f64], rates: &[f64], within: f64) -> f64 {
        self.conduction.next_kink(enthalpy, rates, within)
    }

    fn team(&self) -> Option<&Team> {
        self.water.team.as_ref()
    }

    fn rate(&mut self, enthalpy: &[f64], clock: &Clock, rates: &mut Rates<'_>) {
        let Rates { of_particles, patches, surfaces } = rates;
        let own = patches.len() - 1;
        let mut conducted = Rates { of_particles, patches: &mut patches[..own], surfaces };
        self.conduction.rate(enthalpy, clock, &mut conducted);
        if let Some(bend) = &self.bend {
            self.water.carrier.conducted(of_particles, bend.kappa);
        }
        self.water.warm(enthalpy);
        self.bring_walls_to(clock.time);
        self.carry(enthalpy, clock.step.min(self.facts.bound.step), of_particles, patches);
        self.across(surfaces);
    }

    fn advance(&mut self, update: Update<'_, '_>, clock: &Clock, patches: &mut [f64]) {
        let mut rate = std::mem::take(&mut self.rate);
        match update {
            Update::Euler(enthalpy) => {
                rate.resize(enthalpy.len(), 0.0);
                (self as &mut dyn Balance).rates(enthalpy, clock, &mut rate, patches);
                for (h, rate) in enthalpy.iter_mut().zip(&rate) {
                    *h += clock.step * rate;
                }
            }
            Update::Stage(stage, columns) => {
                rate.resize(columns.newest.len(), 0.0);
                (self as &mut dyn Balance).rates(columns.newest, clock, &mut rate, patches);
                stage.take(self.team(), columns, &rate);
            }
        }
        self.rate = rate;
    }

    fn tangent(&mut self) -> &mut dyn Tangent {
        self
    }

    fn companion(&self) -> Option<&dyn Companion> {
        Some(self)
    }

    fn companion_mut(&mut self) -> Option<&mut dyn Companion> {
        Some(self)
    }
}

impl Companion for AdvectedHeat {
    fn begin(&mut self, enthalpy: &[f64], clock: &Clock) -> Result<bool, StepError> {
        let follows = self.water.follow(enthalpy, clock.time)?;
        if follows {
            self.bind();
        }
        Ok(follows)
    }

    fn kept(&mut self, step: f64) {
        self.water.book(step);
    }

    fn lasts(&self) -> f64 {
        self.water.lasts
    }

    fn water(&self, particles: &Particles) -> Water {
        self.water.water(particles)
    }

    fn water_fields(&self) -> (Vec<f64>, Vec<glam::DVec2>) {
        self.water.fields()
    }
}

/// Water carries the temperature of its paths' ends, limited by nothing: what is limited, or mended by gradients, has no
/// linearisation of its own.
impl Tangent for AdvectedHeat {
    fn shape(&mut self) -> TangentShape {
        let own = self.conduction.tangent().shape();
        let network = &self.water.network;
        let farthest = |i: usize| network.paths(i).map(|(j, ..)| i.abs_diff(j)).max().unwrap_or(0);
        let bandwidth = (0..network.len()).map(farthest).max().unwrap_or(0).max(own.bandwidth);
        TangentShape { is_symmetric: false, is_constant: false, is_steep: false, bandwidth }
    }

    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]) {
        self.conduction.tangent().linearise(enthalpy, time, slopes);
        self.water.warm(enthalpy);
        self.bring_walls_to(time);
        self.warmed.resize(enthalpy.len(), 0.0);
        let Groundwater { materials, temperature, .. } = &self.water;
        for (i, (warmed, slope)) in self.warmed.iter_mut().zip(slopes).enumerate() {
            let thermal = materials.of(i);
            let by_enthalpy = thermal.law.slope(enthalpy[i]) / thermal.curve.conductivity(temperature[i]);
            *warmed = if *slope > 0.0 { by_enthalpy / *slope } else { 0.0 };
        }
    }

    fn act(&mut self, potentials: &[f64], rate: &mut [f64]) {
        self.conduction.tangent().act(potentials, rate);
        self.changes.clear();
        self.changes.extend(potentials.iter().zip(&self.warmed).map(|(potential, warmed)| potential * warmed));
        for mouth in &self.water.carrier.mouths {
            // Without a temperature of its own, a wall lets in what has the particle's.
            if self.water.wall_temperature(mouth.wall as usize).is_some() {
                let i = mouth.particle as usize;
                rate[i] -= self.water.capacity * mouth.inflow * self.changes[i];
            }
        }
        let Groundwater { network, carrier, team, .. } = &mut self.water;
        carrier.carry_unlimited(network, &self.changes, team.as_ref(), false, rate);
    }

    fn steepest(&mut self) -> Vec<f64> {
        self.conduction.tangent().steepest()
    }
}

impl HeapSize for AdvectedHeat {
    fn heap_size(&self) -> usize {
        let columns = total(&[&self.beside, &self.rate, &self.warmed, &self.changes, &self.surfaces]);
        self.conduction.heap_size() + self.water.heap_size() + columns
    }
}
