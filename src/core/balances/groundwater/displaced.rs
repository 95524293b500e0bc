//! Water that ice displaces, or takes up as it thaws.

use crate::memory::{HeapSize, total};
use crate::saved::{Pass, Saved};

/// Water displaced by volume, of each particle: no columns where ice is as dense as water.
///
/// Until the next solution for the pressure it goes on to be displaced as it was since the last one, and what was then asked for too
/// little or too much is made up for.
#[derive(Default)]
pub(super) struct Displaced {
    /// Unfrozen fractions at the start.
    pub(super) started: Vec<f64>,
    /// What ice has taken until the last solution.
    taken: Vec<f64>,
    /// What has been asked for so far, and what is now (1/s).
    asked: Vec<f64>,
    asking: Vec<f64>,
    /// What the last solution was asked for (1/s).
    asked_for: Vec<f64>,
}

impl Displaced {
    /// Nothing displaced yet, from these unfrozen fractions.
    pub(super) fn from(started: Vec<f64>) -> Self {
        let column = || vec![0.0; started.len()];
        Displaced { taken: column(), asked: column(), asking: column(), asked_for: column(), started }
    }

    /// Whether ice displaces none.
    pub(super) fn is_none(&self) -> bool {
        self.started.is_empty()
    }

    /// Asks for what `taken` has been taken by a particle of an unfrozen fraction at the start, over this time (s) since the last
    /// solution; `growth` is how much longer the next may stand. None is asked for where no water comes.
    pub(super) fn ask(
        &mut self,
        since: f64,
        growth: f64,
        comes: impl Fn(usize) -> bool,
        taken: impl Fn(usize, f64) -> f64,
    ) {
        for (i, started) in self.started.iter().enumerate() {
            let now = taken(i, *started);
            let newly = now - std::mem::replace(&mut self.taken[i], now);
            let owed = (now - self.asked[i]) / growth;
            self.asking[i] = if comes(i) { (newly + owed) / since } else { 0.0 };
        }
    }

    /// What to solve for (1/s), so that water which goes on from the last solution as far as `ahead` says is what is asked for.
    pub(super) fn solve_for(&mut self, ahead: f64) -> Option<&[f64]> {
        for (asked_for, asking) in self.asked_for.iter_mut().zip(&self.asking) {
            *asked_for = (asking + ahead * *asked_for) / (1.0 + ahead);
        }
        (!self.is_none()).then_some(&self.asked_for[..])
    }

    /// Books a step (s); `each` takes what every particle asked for (1/s).
    pub(super) fn book(&mut self, step: f64, mut each: impl FnMut(f64)) {
        for (asked, asking) in self.asked.iter_mut().zip(&self.asking) {
            *asked += step * asking;
            each(*asking);
        }
    }
}

impl Saved for Displaced {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.taken, &mut self.asked, &mut self.asking, &mut self.asked_for]);
    }
}

impl HeapSize for Displaced {
    fn heap_size(&self) -> usize {
        total(&[&self.started, &self.taken, &self.asked, &self.asking, &self.asked_for])
    }
}
