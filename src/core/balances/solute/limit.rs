//! How much of the exchange beside water is taken back: as much as leaves every particle within the concentrations around it.

use crate::balances::row::Row;

/// A particle at the start of a step.
pub(super) struct Held {
    /// What it holds, with all that it holds it in: for a concentration of one, at the start of the step and at its end.
    pub content: f64,
    pub holds: [f64; 2],
    /// Share that decays in the step.
    pub decays: f64,
}

impl Held {
    /// Shares of what would be added and taken in a step (s) that leave the particle within its range. Decay is no part of that:
    /// the range decays as the particle does.
    pub(super) fn shares(&self, row: &Row, step: f64) -> (f64, f64) {
        let [before, after] = self.holds;
        let own = self.content / before;
        let low = self.content + step * row.gain;
        let kept = if after > 0.0 { self.decays * before / after } else { 0.0 };
        let least = after * (row.least + kept * (own - row.least));
        let most = after * (row.most - kept * (row.most - own));
        row.shares(most - low, low - least, step)
    }
}
