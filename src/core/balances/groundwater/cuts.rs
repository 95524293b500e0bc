//! Paths of water that cracks or a shaft cut.

use std::sync::Arc;

use glam::DVec2;

use crate::balances::groundwater::error::GroundwaterError;
use crate::balances::groundwater::ground::Flow;
use crate::balances::groundwater::network::WayOut;
use crate::balances::groundwater::network::{Network, NetworkParts};
use crate::balances::groundwater::numerics::Conduction;
use crate::bonds::pair_list::PairList;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::patch::{Boundary, Face};
use crate::breakage::cuts::{Cuts, Cutting};
use crate::memory::{HeapSize, shared, total};
use crate::saved::{Pass, Saved};

/// What paths are made of, as long as pairs are cut while a run goes on.
pub(super) struct CutPaths {
    pub(super) positions: Arc<[DVec2]>,
    pub(super) pairs: PairList,
    pub(super) cuts: Cuts,
    pub(super) ways_out: Vec<WayOut>,
    pub(super) ghosts: Ghosts,
    pub(super) boundary: Boundary,
    pub(super) faces: Vec<Face>,
    pub(super) flow: Flow,
    pub(super) conduction: Conduction,
    pub(super) least_conductivities: Vec<f64>,
    pub(super) factors: Arc<[f64]>,
    /// Whether each particle has a way to a wall of given pressure.
    pub(super) open: Vec<bool>,
}

impl CutPaths {
    /// The paths at a time (s), if pairs were cut since the last one.
    pub(super) fn bring_to(&mut self, time: f64) -> Result<Option<Network>, GroundwaterError> {
        if !self.cuts.bring_to(time, &mut self.pairs.weights) {
            return Ok(None);
        }
        self.network().map(Some)
    }

    /// The paths at the start.
    pub(super) fn start(&mut self) -> Result<Network, GroundwaterError> {
        self.cuts.bring_to(0.0, &mut self.pairs.weights);
        self.network()
    }

    /// Hands over how far the paths have been cut; the paths then, where they are put in.
    pub(super) fn pass(&mut self, pass: &mut Pass<'_>) -> Result<Option<Network>, GroundwaterError> {
        Cutting { cuts: &mut self.cuts, weights: &mut self.pairs.weights }.pass(pass);
        if pass.loads() { self.network().map(Some) } else { Ok(None) }
    }

    fn network(&mut self) -> Result<Network, GroundwaterError> {
        let network = Network::new(&NetworkParts {
            positions: &self.positions,
            pairs: &self.pairs,
            ways_out: &self.ways_out,
            ghosts: &self.ghosts,
            boundary: &self.boundary,
            faces: &self.faces,
            flow: &self.flow,
            conduction: self.conduction,
            least_conductivities: &self.least_conductivities,
            factors: &self.factors,
        })?;
        self.open = network.reached();
        Ok(network)
    }

    /// Whether water can reach a particle: in a pocket that is cut off, ice has to make room for itself.
    pub(super) fn is_open(&self, particle: usize) -> bool {
        self.open[particle]
    }
}

impl HeapSize for CutPaths {
    fn heap_size(&self) -> usize {
        let pairs = total(&[&self.pairs.starts, &self.pairs.partners, &self.pairs.weights]);
        let ways_out = self.ways_out.capacity() * size_of::<WayOut>() + self.least_conductivities.heap_size();
        pairs + ways_out + shared(&self.factors) + total(&[&self.cuts, &self.ghosts, &self.open])
    }
}
