//! What pairs exchange, by entry of their list.

use crate::kernels::list_parts::ListParts;
use crate::kernels::rows::ListRows;
use crate::kernels::term::Off;
use crate::memory::{HeapSize, total};
use crate::physics::latent_heat::SchemeState;
use crate::saved::{Pass, Saved};

/// The rows of a list, asked for each of their entries.
pub struct PairFlows {
    rows: ListRows<Off>,
    scheme: Box<dyn SchemeState>,
    /// What the particle of each entry has gained, by its volume and by time.
    flows: Vec<f64>,
}

impl PairFlows {
    /// The entries of these parts, for a scheme that reads their particles.
    pub fn new(parts: ListParts, scheme: Box<dyn SchemeState>) -> Self {
        let flows = vec![0.0; parts.pairs.partners.len()];
        PairFlows { rows: ListRows::new(parts, Off), scheme, flows }
    }

    /// Takes a mean over states, each with its share and its time (s).
    pub fn take<'a>(&mut self, states: impl Iterator<Item = (f64, f64, &'a [f64])>) -> &[f64] {
        self.flows.fill(0.0);
        for (share, time, state) in states.filter(|state| state.0 != 0.0) {
            self.rows.bring_to(self.scheme.as_ref(), state, time);
            self.rows.add_flows(share, &mut self.flows);
        }
        &self.flows
    }
}

impl Saved for PairFlows {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.rows.parts.pass(pass);
        self.scheme.pass(pass);
    }
}

impl HeapSize for PairFlows {
    fn heap_size(&self) -> usize {
        self.rows.heap_size() + total(&[&self.flows]) + self.scheme.heap_size()
    }
}
