//! The rows of a list as a balance: with enthalpy as the unknown, or whatever a latent-heat scheme keeps.

use crate::bonds::exchange::Exchange;
use crate::boundary::pipe::Sink;
use crate::kernels::diagonal_pairs::DiagonalPairs;
use crate::kernels::list_parts::{ListParts, steepest};
use crate::kernels::rows::ListRows;
use crate::kernels::term::PairTerm;
use crate::ledger::Source;
use crate::memory::{HeapSize, total};
use crate::physics::latent_heat::SchemeState;
use crate::saved::{Pass, Saved};
use crate::solvers::balance::{Balance, BalanceFacts, Rates, Tangent, TangentShape, Update};
use crate::solvers::step::Clock;
use crate::team::Team;

/// Rows of a list under a latent-heat scheme, with a term beside conduction.
pub struct ListBalance<T> {
    rows: ListRows<T>,
    scheme: Box<dyn SchemeState>,
    rate: Vec<f64>,
    linearised: Linearised,
    facts: BalanceFacts,
}

impl<T: PairTerm> ListBalance<T> {
    /// The rows of these parts, for a scheme that reads their particles.
    pub fn new(parts: ListParts, term: T, scheme: Box<dyn SchemeState>) -> Self {
        let (count, pairs, surfaces) = (parts.positions.len(), parts.pair_count(), parts.surfaces.len());
        // While all pairs are on the list.
        let parts = parts.varied();
        let bound = parts.step_bound();
        let rows = ListRows::by_diagonals(parts, term);
        let facts = BalanceFacts { patches: rows.sources(), pairs, surfaces, bound, turning: 0.0 };
        ListBalance { rows, scheme, rate: vec![0.0; count], linearised: Linearised::default(), facts }
    }
}

/// The exchange of small changes around a state.
#[derive(Debug, Clone, Default)]
pub struct Linearised {
    /// Changes of the potentials of particles and ghosts.
    pub(super) changes: Vec<f64>,
    /// How ghosts follow their images.
    pub(super) ghosts: Vec<f64>,
    /// How the flux of each pair on the list follows its own particle and its partner; empty for a single material.
    pub(super) shares: Vec<(f64, f64)>,
    /// What pairs by diagonals conduct by, over the largest conductivity of all, where they do by a mean.
    pub(super) conductivity: Vec<f64>,
    /// How the gains at each curved wall follow what is seen of it.
    pub(super) views: Vec<Vec<f64>>,
    /// How the gains at touching walls follow the particles.
    pub(super) touches: Vec<f64>,
    /// Resistances with which they meet pipes.
    pub(super) pipes: Vec<f64>,
    /// Time (s) of the linearisation.
    pub(super) time: f64,
}

impl HeapSize for Linearised {
    fn heap_size(&self) -> usize {
        let columns = total(&[&self.changes, &self.ghosts, &self.shares, &self.conductivity, &self.touches]);
        columns + self.views.iter().map(HeapSize::heap_size).sum::<usize>()
    }
}

impl<T: PairTerm> Balance for ListBalance<T> {
    fn facts(&self) -> &BalanceFacts {
        &self.facts
    }

    fn rate(&mut self, enthalpy: &[f64], clock: &Clock, rates: &mut Rates<'_>) {
        self.rows.rate_of(self.scheme.as_ref(), enthalpy, clock, rates.of_particles, rates.patches);
        if !rates.surfaces.is_empty() {
            self.rows.across(rates.surfaces);
        }
    }

    fn advance(&mut self, update: Update<'_, '_>, clock: &Clock, patches: &mut [f64]) {
        let scheme = self.scheme.as_mut();
        match update {
            Update::Euler(enthalpy) => {
                self.rows.rate_of(scheme, enthalpy, clock, &mut self.rate, patches);
                scheme.add(&self.rows.parts.materials, enthalpy, &self.rate, clock.step);
                scheme.publish(&self.rows.parts.materials, enthalpy);
            }
            Update::Stage(stage, columns) => {
                self.rows.rate_of(scheme, columns.newest, clock, &mut self.rate, patches);
                stage.take(self.rows.parts.team.as_ref(), columns, &self.rate);
            }
        }
    }

    fn team(&self) -> Option<&Team> {
        self.rows.parts.team.as_ref()
    }

    fn tangent(&mut self) -> &mut dyn Tangent {
        self
    }
}

impl<T: PairTerm> Tangent for ListBalance<T> {
    fn shape(&mut self) -> TangentShape {
        let parts = &self.rows.parts;
        let curved = parts.rims.iter().any(|rim| self.rows.faces[0][rim.patch].holds() > 0.0);
        let (even, linear) = (parts.volumes.is_even(), !parts.materials.mixed() && parts.boundary.is_linear());
        let (means, falls) = (parts.exchange != Exchange::Potential, parts.up.is_some());
        let scheduled = !parts.sinks.iter().all(Sink::is_constant);
        TangentShape {
            is_symmetric: even && parts.ghosts.all_mirrored() && linear && !curved && !falls,
            is_constant: linear && !means && !falls && !scheduled && parts.cuts.is_empty(),
            is_steep: falls,
            bandwidth: bandwidth(parts).max(self.rows.diagonals.as_ref().map_or(0, DiagonalPairs::reach)),
        }
    }

    fn linearise(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]) {
        self.rows.linearise(self.scheme.as_ref(), enthalpy, time, slopes, &mut self.linearised);
    }

    fn act(&mut self, potentials: &[f64], rate: &mut [f64]) {
        self.rows.act(&mut self.linearised, potentials, rate);
    }

    fn steepest(&mut self) -> Vec<f64> {
        (0..self.rows.parts.positions.len()).map(|i| steepest(&self.rows.parts, i)).collect()
    }

    fn take(&self, state: &mut [f64], changes: &[f64], slopes: &[f64], (weight, row_sum): (f64, f64)) {
        let parts = &self.rows.parts;
        // Under means of conductivities a content is not held back by its own potential alone.
        if parts.exchange != Exchange::Potential {
            return state.iter_mut().zip(changes).for_each(|(state, change)| *state += change);
        }
        let falls = if parts.up.is_some() { weight / parts.spacing } else { 0.0 };
        parts.materials.take(state, changes, slopes, (weight * row_sum, falls));
    }
}

impl<T: PairTerm> Saved for ListBalance<T> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.rows.parts.pass(pass);
        self.scheme.pass(pass);
    }
}

impl<T: PairTerm> HeapSize for ListBalance<T> {
    fn heap_size(&self) -> usize {
        self.rows.heap_size() + self.scheme.heap_size() + self.rate.heap_size() + self.linearised.heap_size()
    }
}

/// Greatest distance in the numbering of particles over which rows reach.
pub(crate) fn bandwidth(parts: &ListParts) -> usize {
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

impl<T: PairTerm> ListRows<T> {
    /// Walls, then rings of pipes.
    fn sources(&self) -> Vec<Source> {
        let walls = self.parts.boundary.patches.iter().map(|patch| Source::Patch(patch.id));
        walls.chain(Source::rings(self.parts.rings)).collect()
    }
}
