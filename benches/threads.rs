//! One thread against two, on a million particles.

#![allow(clippy::print_stdout)]

mod shared;

use shared::{Case, ratio, square, take_turns};

fn main() {
    // Rounds of a third of a second: the machine's own swings between threads average out.
    const CASES: [(&str, &str, &str, u64); 3] = [
        ("pd, lattice", "pd", "", 150),
        ("local, lattice", "local", "", 300),
        ("pd, list", "pd", "search = \"tree\"", 10),
    ];
    println!("{:<18} {:>28} {:>28} {:>10}", "1 M particles", "1 thread, M/s", "2 threads, M/s", "faster by");
    for (name, method, numerics, steps) in CASES {
        eprintln!("{name}");
        let mut pair =
            [1, 2].map(|threads| Case::new(name, square(1000, method, numerics, threads), steps * threads as u64));
        pair.iter_mut().for_each(|case| case.shared = true);
        take_turns(&mut pair);
        println!("{name:<18} {:>28} {:>28} {:>10.2}", pair[0].rate(), pair[1].rate(), ratio(&pair[0], &pair[1]));
    }
}
