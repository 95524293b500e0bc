//! All methods on the same freezing square at the same spacing, on one thread: what a step costs, and what a second
//! of simulated time costs at the step that each method allows.

#![allow(clippy::print_stdout)]

mod shared;

use shared::{Case, ratio, square, take_turns};

fn main() {
    const SIDE: usize = 500;
    let mut cases: Vec<Case> = frazil::registry::methods()
        .iter()
        .map(|kind| {
            eprintln!("{}", kind.name);
            Case::new(kind.name, square(SIDE, kind.name, "", 1), if kind.stochastic { 1 } else { 16 })
        })
        .collect();
    take_turns(&mut cases);
    let first = &cases[0];
    println!(
        "{:<8} {:>28} {:>16} {:>12} {:>10} {:>24}",
        "method", "M particle-steps/s", "time over first", "neighbours", "step (s)", "cost of time over first"
    );
    for case in &cases {
        let steps = ratio(case, first);
        let neighbours = 2.0 * case.plan.method.report().pairs as f64 / case.len() as f64;
        println!(
            "{:<8} {:>28} {:>16.2} {:>12.1} {:>10.3} {:>24.2}",
            case.name,
            case.rate(),
            steps,
            neighbours,
            case.plan.step,
            steps * first.plan.step / case.plan.step
        );
    }
}
