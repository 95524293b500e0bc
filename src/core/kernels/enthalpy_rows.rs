//! The rows of a list with enthalpy as the unknown.

use crate::boundary::pipe::Sink;
use crate::kernels::list_parts::steepest;
use crate::kernels::rows::ListOperator;
use crate::kernels::term::{Off, PairTerm};
use crate::memory::HeapSize;
use crate::physics::latent_heat::{Materials, SchemeState};
use crate::solvers::operator::{Operator, Stage, StageColumns};
use crate::solvers::step::{Bound, Clock};

/// The list operator with enthalpy as its unknown, for the shared integrators.
pub struct EnthalpyList {
    /// The operator.
    pub operator: ListOperator<Off>,
    /// The scheme that reads enthalpies.
    pub scheme: Box<dyn SchemeState>,
    /// Rates of one evaluation.
    pub rate: Vec<f64>,
    /// The last linearisation.
    pub tangent: Tangent,
}

/// The exchange of small changes around a state.
#[derive(Debug, Clone, Default)]
pub struct Tangent {
    /// Changes of the potentials of particles and ghosts.
    pub(super) changes: Vec<f64>,
    /// How ghosts follow their images.
    pub(super) ghosts: Vec<f64>,
    /// How the flux of each pair follows its own particle and its partner; empty for a single material.
    pub(super) shares: Vec<(f64, f64)>,
    /// How the gains at each curved wall follow what is seen of it.
    pub(super) views: Vec<Vec<f64>>,
    /// How the gains at touching walls follow the particles.
    pub(super) touches: Vec<f64>,
    /// Resistances with which they meet pipes.
    pub(super) pipes: Vec<f64>,
    /// Time (s) of the linearisation.
    pub(super) time: f64,
}

impl HeapSize for Tangent {
    fn heap_size(&self) -> usize {
        let columns =
            self.changes.heap_size() + self.ghosts.heap_size() + self.shares.heap_size() + self.touches.heap_size();
        columns + self.views.iter().map(HeapSize::heap_size).sum::<usize>()
    }
}

impl Operator for EnthalpyList {
    fn rate(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64], patches: &mut [f64]) {
        let clock = Clock { time, step: 0.0, index: 0, turned: false };
        self.operator.rate_of(self.scheme.as_ref(), enthalpy, &clock, rate, patches);
    }

    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, patches: &mut [f64]) {
        let clock = Clock { time, step, index: 0, turned: false };
        self.operator.rate_of(self.scheme.as_ref(), enthalpy, &clock, &mut self.rate, patches);
        for (h, rate) in enthalpy.iter_mut().zip(&self.rate) {
            *h += step * rate;
        }
    }

    fn stage(&mut self, stage: &Stage, columns: &mut StageColumns<'_>, time: f64, patches: &mut [f64]) {
        let clock = Clock { time, step: 0.0, index: 0, turned: false };
        self.operator.rate_of(self.scheme.as_ref(), columns.newest, &clock, &mut self.rate, patches);
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
        let curved = parts.rims.iter().any(|rim| self.operator.faces[0][rim.patch].holds() > 0.0);
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
        let mut patches = vec![0.0; self.operator.patch_names().len()];
        self.operator.across(self.scheme.as_ref(), enthalpy, time, &mut self.rate, &mut patches)
    }

    fn patches(&self) -> Vec<String> {
        self.operator.patch_names()
    }

    fn pairs(&self) -> u64 {
        self.operator.pair_count()
    }

    fn heap_size(&self) -> usize {
        self.operator.heap_size() + self.scheme.heap_size() + self.rate.heap_size() + self.tangent.heap_size()
    }
}

/// A scheme for [`Operator`] calls: enthalpy is the unknown.
impl<T: PairTerm> ListOperator<T> {
    /// Patches of the operator.
    pub fn patch_names(&self) -> Vec<String> {
        let walls = self.parts.boundary.patches.iter().map(|patch| patch.name.to_string());
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
