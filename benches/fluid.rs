//! Steps of moving eDPD particles: particles and pairs by second, in the plane and in space, by threads, and by
//! the vectors of AVX2 where there are wider ones.

#![allow(clippy::print_stdout)]

use std::sync::Arc;
use std::time::Instant;

use cpu_time::ThreadTime;

use frazil_core::instruction_set::{InstructionSet, limit};
use frazil_edpd::fluid::{Exponent, Fluid, Parameters, Undriven};

/// Cut-off radius, friction and exponent at which others' codes were timed (Li et al. 2014 for water at 300 K).
fn water() -> Parameters {
    Parameters {
        friction: 4.5,
        conservative_cutoff: 1.58,
        dissipative_cutoff: 1.58,
        thermal_cutoff: 1.58,
        exponent: Exponent::Table(vec![
            (0.8, -0.27 + 0.4),
            (0.9, 0.41 - 0.361),
            (1.0, 0.41),
            (1.1, 0.809),
            (1.3, 1.721),
        ]),
        step: 0.01,
        ..Parameters::water()
    }
}

fn time<const D: usize>(what: &str, lengths: [f64; D], threads: usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let pool = (threads > 1).then(|| Arc::new(pool));
    let mut fluid = Fluid::new(water(), lengths, 1.0, 1, pool).unwrap_or_else(|refused| unreachable!("{refused}"));
    let steps =
        |fluid: &mut Fluid<D>, count| fluid.advance(count, &Undriven).unwrap_or_else(|error| unreachable!("{error}"));
    steps(&mut fluid, 100);
    let sortings = fluid.sortings;
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        // One thread by its own clock: the machine may be shared.
        let (start, own) = (Instant::now(), ThreadTime::now());
        steps(&mut fluid, 50);
        let seconds = if threads == 1 { own.elapsed() } else { start.elapsed() };
        best = best.min(seconds.as_secs_f64() / 50.0);
    }
    let count = fluid.particles().len() as f64;
    println!(
        "{what}, {threads} threads, {count} particles: {:.2} M particle-steps/s, {:.1} M pairs/s, {:.1} pairs a particle, a sorting \
         every {:.1} steps",
        count / best * 1e-6,
        fluid.pairs() as f64 / best * 1e-6,
        fluid.pairs() as f64 / count,
        250.0 / (fluid.sortings - sortings) as f64
    );
}

fn main() {
    for threads in [1, 2] {
        time("plane", [109.5, 109.6], threads);
        time("space", [29.2, 29.2, 29.3], threads);
    }
    if InstructionSet::widest() == InstructionSet::Avx512 {
        limit(InstructionSet::Avx2);
        time("plane, avx2", [109.5, 109.6], 1);
        time("space, avx2", [29.2, 29.2, 29.3], 1);
    }
}
