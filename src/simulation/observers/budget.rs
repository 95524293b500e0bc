//! The heat balance.

use frazil_core::ledger::{Ledger, Source, Sum};
use frazil_core::particles::Particles;
use frazil_record::{BudgetRow, RunResult};

use super::observer::{End, Made, Observer, Schedule, Setup, View, room};

struct Budget {
    names: Vec<String>,
    rows: Vec<BudgetRow>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let names = setup.method.ledger().sources().iter().map(Source::to_string).collect();
    Some(Box::new(Budget { names, rows: Vec::with_capacity(setup.outputs()) }))
}

impl Observer for Budget {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        self.rows.push(balance(view.particles, view.ledger, view.time));
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        (result.budget_names, result.budget) = (self.names, self.rows);
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows) + self.rows.capacity() * self.names.len() * size_of::<f64>()
    }
}

/// The heat balance at a time.
fn balance(particles: &Particles, ledger: &Ledger, time: f64) -> BudgetRow {
    let (stored_j, moved_j) = taken_up(particles);
    let in_j = ledger.heat();
    let total: Sum = in_j.iter().copied().collect();
    let exchanged = in_j.iter().map(|heat| heat.abs()).sum::<f64>().max(stored_j.abs());
    // Where particles start from different temperatures, they exchange heat even if nothing comes in.
    let exchanged = exchanged.max(0.5 * moved_j);
    let balance_rel = if exchanged > 0.0 { (stored_j - total.value()) / exchanged } else { 0.0 };
    BudgetRow { time_s: time, stored_j, in_j, balance_rel }
}

/// What all particles have taken up since the start (J), and, where they started from different temperatures, how much each
/// by its magnitude, summed.
fn taken_up(particles: &Particles) -> (f64, f64) {
    match &particles.start[..] {
        [] => (particles.integral(|i| particles.enthalpy[i]), 0.0),
        start => {
            let change = |i: usize| particles.enthalpy[i] - start[i];
            (particles.integral(change), particles.integral(|i| change(i).abs()))
        }
    }
}
