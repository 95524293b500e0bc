//! One thread against two, by size and by method, and against what the machine has to give: two bodies of half the size, one a thread,
//! which share nothing.

#![allow(clippy::print_stdout)]

mod shared;

use std::sync::Barrier;
use std::time::Instant;

use frazil_core::statistics::median;

use shared::{Case, ISOTHERMAL, ROUNDS, freezing_rectangle, ratio, square};

/// Particle-steps of a round on one thread: a third of a second, in which the machine's own swings between threads average out.
const PER_ROUND: f64 = 2e8;

/// Two halves of a body, each on a thread of its own.
struct Halves {
    halves: [Case; 2],
    steps: u64,
    /// Seconds, by round.
    times: Vec<f64>,
}

impl Halves {
    fn new(side: usize, method: &str, numerics: &str, steps: u64) -> Self {
        let halves = [side / 2, side - side / 2].map(|height| {
            Case::new("half", freezing_rectangle(ISOTHERMAL, [side, height], method, numerics, 1), steps)
        });
        Halves { halves, steps, times: Vec::new() }
    }

    fn round(&mut self) {
        let (ready, steps) = (Barrier::new(3), self.steps);
        std::thread::scope(|scope| {
            let threads = self.halves.each_mut().map(|half| {
                scope.spawn(|| {
                    ready.wait();
                    half.advance(steps);
                })
            });
            ready.wait();
            let began = Instant::now();
            for thread in threads {
                thread.join().expect("half a body");
            }
            self.times.push(began.elapsed().as_secs_f64());
        });
    }
}

fn main() {
    const CASES: [(&str, &str, &str, f64); 3] = [
        ("pd, lattice", "pd", "", 1.0),
        ("local, lattice", "local", "", 2.0),
        ("pd, list", "pd", "search = \"tree\"", 0.1),
    ];
    let titles = ["particles", "1 thread, M/s", "2 threads, M/s", "faster by", "two halves"];
    println!("{:<18} {:>10} {:>26} {:>26} {:>10} {:>11}", "", titles[0], titles[1], titles[2], titles[3], titles[4]);
    for side in [64, 128, 192, 256, 316, 1000, 3162] {
        // A list of ten million pairs takes longer to make than it is worth here.
        for (name, method, numerics, speed) in CASES.into_iter().filter(|case| case.0 != "pd, list" || side <= 1000) {
            let steps = (speed * PER_ROUND / (side * side) as f64).ceil() as u64;
            let mut pair = [1, 2].map(|threads| Case::new(name, square(side, method, numerics, threads), steps));
            pair.iter_mut().for_each(|case| case.shared = true);
            let mut halves = Halves::new(side, method, numerics, steps);
            for round in 1..=ROUNDS {
                eprintln!("{name}, {side}, round {round} of {ROUNDS}");
                pair.iter_mut().for_each(Case::round);
                halves.round();
            }
            let whole = (steps * pair[0].len() as u64) as f64;
            let most: Vec<f64> = pair[0].times.iter().zip(&halves.times).map(|(one, two)| one * whole / two).collect();
            println!(
                "{name:<18} {:>10} {:>26} {:>26} {:>10.2} {:>11.2}",
                side * side,
                pair[0].rate(),
                pair[1].rate(),
                ratio(&pair[0], &pair[1]),
                median(&most).unwrap_or(f64::NAN)
            );
        }
    }
}
