//! Ground that conducts better in one place than in another, by a factor on the conductivity of its material.
//!
//! With the factor f of its place a particle has the potential `f U(T)`, and what a pair of two places in series conducts is the
//! harmonic mean of both factors times the difference of U: a pair weighs that much more. A ghost has the factor of the particle
//! that it mirrors, so that what a mirror takes the pair itself outweighs, as in even ground. A layer of a depth d before a wall
//! resists like one of `d / f` in even ground, whatever the wall does; for a ghost f is the mean of its pairs, so that a wall of given flux
//! brings just that.

use std::sync::Arc;

use crate::kernels::list_parts::ListParts;
use crate::space::random_field::between;

impl ListParts {
    /// The same parts with the factors in their pairs, walls and pipes: a step then knows nothing of them.
    pub(super) fn varied(mut self) -> Self {
        if self.factors.is_empty() {
            return self;
        }
        let factors = std::mem::replace(&mut self.factors, Arc::new([]));
        let count = self.positions.len();
        let of =
            |index: usize| factors[index.checked_sub(count).map_or(index, |ghost| self.ghosts.model[ghost] as usize)];
        let mut by_entry = Vec::with_capacity(self.pairs.partners.len());
        // Weights of each ghost's pairs, as in even ground and in this.
        let mut of_ghosts = vec![(0.0, 0.0); self.ghosts.len()];
        for i in 0..count {
            for k in self.pairs.starts[i]..self.pairs.starts[i + 1] {
                let j = self.pairs.partners[k] as usize;
                let factor = between(factors[i], of(j));
                by_entry.push(factor);
                if let Some(ghost) = j.checked_sub(count) {
                    let weight = self.pairs.weights[k];
                    of_ghosts[ghost].0 += weight;
                    of_ghosts[ghost].1 += weight * factor;
                }
            }
        }
        self.cuts.scale(&mut self.pairs, &by_entry);
        for (depth, (even, varied)) in self.ghosts.depth.iter_mut().zip(of_ghosts).filter(|(_, sums)| sums.0 > 0.0) {
            *depth *= even / varied;
        }
        for rim in &mut self.rims {
            rim.contacts.vary(&factors);
        }
        for touch in &mut self.touches {
            touch.depth /= factors[touch.particle as usize];
        }
        for sink in &mut self.sinks {
            // Around a pipe places conduct in series and side by side: by the geometric mean.
            sink.resistance /= sink.sampled(|index| factors[index].ln()).exp();
        }
        self
    }
}
