//! Heat that is released inside the body: by the hydration of concrete, by currents, by decay.

use glam::DVec2;

use crate::formula::Formula;
use crate::ledger::Source;
use crate::memory::HeapSize;
use crate::saved::{Pass, Saved};
use crate::series::Series;
use crate::solvers::balance::{Balance, BalanceFacts, Companion, Rates, StageColumns, Tangent, Update};
use crate::solvers::passenger::Passenger;
use crate::solvers::step::Clock;
use crate::team::Team;

/// Heat by volume and time (W/m3); negative where heat is taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Power {
    /// The same all over the part.
    Even(Series),
    /// By a formula of place and time.
    Formula(Formula),
}

/// A part of the body that releases heat.
#[derive(Debug, Clone)]
pub struct HeatSource {
    /// Number of the region, from 0.
    pub region: usize,
    /// What it releases.
    pub power: Power,
    /// Its ground, and that of it which is dug.
    pub parts: Vec<SourcePart>,
}

/// Ground that releases heat up to one time.
#[derive(Debug, Clone)]
pub struct SourcePart {
    /// Particles that lie in it, and the share of each that does.
    pub shares: Vec<(u32, f64)>,
    /// Their volume (m^d, in shells that of the shells).
    pub volume: f64,
    /// Where each of them stands (m), and its own volume in the part; empty where all release alike.
    pub places: Vec<(DVec2, f64)>,
    /// When it ends (s): infinite where it stays.
    pub until: f64,
}

impl SourcePart {
    /// Its particles with their shares, places and volumes.
    fn placed(&self) -> impl Iterator<Item = (&(u32, f64), &(DVec2, f64))> {
        self.shares.iter().zip(&self.places)
    }
}

/// A balance, and heat that is released inside its body. What exchanges heat knows nothing of it.
pub struct Heated {
    balance: Box<dyn Balance>,
    sources: Vec<HeatSource>,
    /// Patches of the balance alone.
    patches: usize,
}

impl Heated {
    /// The balance of a body with these sources of heat: the balance itself where there are none.
    pub fn or_bare(balance: Box<dyn Balance>, sources: Vec<HeatSource>) -> Box<dyn Balance> {
        if sources.is_empty() {
            return balance;
        }
        let patches = balance.patches().len();
        Box::new(Heated { balance, sources, patches })
    }

    /// Adds what is released at a time (s), times a factor, to a column; `patches` takes it by source (W).
    fn release(&self, time: f64, factor: f64, column: &mut [f64], patches: &mut [f64]) {
        for (source, patch) in self.sources.iter().zip(patches) {
            *patch = 0.0;
            let parts = source.parts.iter().filter(|part| time < part.until);
            match &source.power {
                Power::Even(power) => {
                    let power = power.at(time);
                    for part in parts {
                        *patch += power * part.volume;
                        for (particle, share) in &part.shares {
                            column[*particle as usize] += factor * power * share;
                        }
                    }
                }
                Power::Formula(formula) => {
                    for ((particle, share), (place, volume)) in parts.flat_map(SourcePart::placed) {
                        let power = formula.at(&[place.x, place.y, time]);
                        *patch += power * volume;
                        column[*particle as usize] += factor * power * share;
                    }
                }
            }
        }
    }
}

impl Balance for Heated {
    fn facts(&self) -> &BalanceFacts {
        self.balance.facts()
    }

    fn patches(&self) -> Vec<Source> {
        let own = self.sources.iter().map(|source| Source::Region(source.region));
        self.balance.patches().into_iter().chain(own).collect()
    }

    fn next_kink(&self, enthalpy: &[f64], rates: &[f64], within: f64) -> f64 {
        self.balance.next_kink(enthalpy, rates, within)
    }

    fn team(&self) -> Option<&Team> {
        self.balance.team()
    }

    fn rate(&mut self, enthalpy: &[f64], clock: &Clock, rates: &mut Rates<'_>) {
        let (patches, released) = rates.patches.split_at_mut(self.patches);
        let (of_particles, surfaces) = (&mut *rates.of_particles, &mut *rates.surfaces);
        self.balance.rate(enthalpy, clock, &mut Rates { of_particles, patches, surfaces });
        self.release(clock.time, 1.0, rates.of_particles, released);
    }

    fn advance(&mut self, update: Update<'_, '_>, clock: &Clock, patches: &mut [f64]) {
        let (patches, released) = patches.split_at_mut(self.patches);
        match update {
            Update::Euler(contents) => {
                self.balance.advance(Update::Euler(contents), clock, patches);
                self.release(clock.time, clock.step, contents, released);
            }
            Update::Stage(stage, columns) => {
                let StageColumns { newest, start, first, .. } = *columns;
                let mut own = StageColumns { newest, oldest: columns.oldest, start, first };
                self.balance.advance(Update::Stage(stage, &mut own), clock, patches);
                self.release(clock.time, stage.rate, columns.oldest, released);
            }
        }
    }

    fn tangent(&mut self) -> &mut dyn Tangent {
        self.balance.tangent()
    }

    fn companion(&self) -> Option<&dyn Companion> {
        self.balance.companion()
    }

    fn companion_mut(&mut self) -> Option<&mut dyn Companion> {
        self.balance.companion_mut()
    }

    fn passenger_mut(&mut self) -> Option<&mut dyn Passenger> {
        self.balance.passenger_mut()
    }
}

impl Saved for Heated {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.balance.pass(pass);
    }
}

impl HeapSize for Heated {
    fn heap_size(&self) -> usize {
        let parts = self.sources.iter().flat_map(|source| &source.parts);
        let of = |part: &SourcePart| {
            part.shares.capacity() * size_of::<(u32, f64)>() + part.places.capacity() * size_of::<(DVec2, f64)>()
        };
        let shares: usize = parts.map(of).sum();
        self.balance.heap_size() + shares + self.sources.capacity() * size_of::<HeatSource>()
    }
}
