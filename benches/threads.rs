//! One thread against two, by size and by method.

#![allow(clippy::print_stdout)]

mod shared;

use shared::{Case, ratio, square, take_turns};

/// Particle-steps of a round on one thread: a third of a second, in which the machine's own swings between threads average out.
const PER_ROUND: f64 = 2e8;

fn main() {
    const CASES: [(&str, &str, &str, f64); 3] = [
        ("pd, lattice", "pd", "", 1.0),
        ("local, lattice", "local", "", 2.0),
        ("pd, list", "pd", "search = \"tree\"", 0.1),
    ];
    println!("{:<18} {:>10} {:>26} {:>26} {:>10}", "", "particles", "1 thread, M/s", "2 threads, M/s", "faster by");
    for side in [64, 128, 192, 256, 316, 1000, 3162] {
        // A list of ten million pairs takes longer to make than it is worth here.
        for (name, method, numerics, speed) in CASES.into_iter().filter(|case| case.0 != "pd, list" || side <= 1000) {
            eprintln!("{name}, {side}");
            let steps = (speed * PER_ROUND / (side * side) as f64).ceil() as u64;
            let mut pair = [1, 2].map(|threads| Case::new(name, square(side, method, numerics, threads), steps));
            pair.iter_mut().for_each(|case| case.shared = true);
            take_turns(&mut pair);
            println!(
                "{name:<18} {:>10} {:>26} {:>26} {:>10.2}",
                side * side,
                pair[0].rate(),
                pair[1].rate(),
                ratio(&pair[0], &pair[1])
            );
        }
    }
}
