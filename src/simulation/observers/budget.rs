//! The heat balance.

use frazil_core::ledger::{Ledger, Source, Sum};
use frazil_core::particles::Particles;
use frazil_record::BudgetRow;

use super::observer::{Instants, Made, Setup};
use super::series::series;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let names: Vec<String> = setup.method.ledger().sources().iter().map(Source::to_string).collect();
    let by_row = names.len() * size_of::<f64>();
    let started = started_j(setup.particles);
    series(
        Instants::Outputs,
        Vec::with_capacity(setup.outputs()),
        (by_row, 0),
        move |view, rows| rows.push(balance(view.particles, view.ledger, view.time, started)),
        |rows, result| (result.budget_names, result.budget) = (names, rows),
    )
}

/// Exchange, over what particles started with, below which rounding of what they hold hides what is missing.
const LEAST_EXCHANGE: f64 = 1e-6;

/// What all particles started with (J), each by its magnitude.
fn started_j(particles: &Particles) -> f64 {
    if particles.start.is_empty() { 0.0 } else { particles.integrals(&particles.start, &[])[1] }
}

/// The heat balance at a time, of particles that started with so much (J).
fn balance(particles: &Particles, ledger: &Ledger, time: f64, started_j: f64) -> BudgetRow {
    // What all have taken up since the start, and how much each by its magnitude, summed.
    let [stored_j, moved_j] = particles.integrals(&particles.enthalpy, &particles.start);
    let in_j = ledger.heat();
    let total: Sum = in_j.iter().copied().collect();
    let exchanged = in_j.iter().map(|heat| heat.abs()).sum::<f64>().max(stored_j.abs());
    // Particles exchange heat even if nothing comes in: where they start from different temperatures, and by noise.
    let exchanged = exchanged.max(0.5 * moved_j).max(LEAST_EXCHANGE * started_j);
    let balance_rel = if exchanged > 0.0 { (stored_j - total.value()) / exchanged } else { 0.0 };
    BudgetRow { time_s: time, stored_j, in_j, balance_rel }
}
