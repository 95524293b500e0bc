//! A step on the lattice against the same step over a pair list, on one thread; and a body ten times larger.

#![allow(clippy::print_stdout)]

mod shared;

use shared::{Case, ratio, resident, square, take_turns};

fn main() {
    // The list comes last: the memory that its making frees would serve bodies that are weighed after it.
    let weigh = |name: &str, side: usize, method: &str, numerics: &str, steps: u64| {
        eprintln!("{name}");
        let before = resident();
        let case = Case::new(name, square(side, method, numerics, 1), steps);
        let bytes = before.zip(resident()).map(|(before, after)| (after - before) / case.len() as f64);
        (case, bytes)
    };
    let (cases, bytes): (Vec<Case>, Vec<Option<f64>>) = [
        weigh("pd, lattice, 1 M", 1000, "pd", "", 8),
        weigh("local, lattice, 1 M", 1000, "local", "", 16),
        weigh("sph, lattice, 1 M", 1000, "sph", "", 8),
        weigh("pd, lattice, 10 M", 3162, "pd", "", 1),
        weigh("pd, lattice, rkl2 of 10 stages, 1 M", 1000, "pd", "integrator = \"rkl2\"\nstages = 10", 1),
        weigh("pd, list, 1 M", 1000, "pd", "search = \"tree\"", 1),
    ]
    .into_iter()
    .unzip();
    let mut cases = cases;
    take_turns(&mut cases);
    println!("{:<38} {:>28} {:>16} {:>12}", "case, one thread", "M particle-steps/s", "time over first", "bytes each");
    for (case, bytes) in cases.iter().zip(bytes) {
        let bytes = bytes.map_or_else(|| "-".to_owned(), |bytes| format!("{bytes:.1}"));
        println!("{:<38} {:>28} {:>16.2} {:>12}", case.name, case.rate(), ratio(case, &cases[0]), bytes);
    }
    println!("list over lattice: {:.2}", ratio(&cases[5], &cases[0]));
    println!("10 M over 1 M, time per particle-step: {:.3}", ratio(&cases[3], &cases[0]));
}
