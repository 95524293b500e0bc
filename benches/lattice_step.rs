//! A step on the lattice, on one thread, by size, by method and by the vectors of the processor; against the same step over a
//! pair list, and on a line against the same step in a plain loop. `-- lines` takes the lines alone, `-- huge` a hundred million
//! particles.

#![allow(clippy::print_stdout)]

mod shared;

use cpu_time::ThreadTime;
use frazil_core::instruction_set::InstructionSet;
use frazil_core::statistics::median;

use shared::{
    Case, ROUNDS, WEIBULL, freezing_line, freezing_square, layered_square, line, ratio, resident, square, take_turns,
};

fn main() {
    let asked = |word: &str| std::env::args().any(|argument| argument == word);
    if asked("huge") {
        let mut cases = [Case::new("pd, 100 M", square(10_000, "pd", "", 1), 1)];
        take_turns(&mut cases);
        println!("{}: {} M particle-steps/s", cases[0].name, cases[0].rate());
        return;
    }
    on_lines();
    if asked("lines") {
        return;
    }
    let weigh = |name: &str, plan: &dyn Fn() -> frazil_simulation::plan::Plan, steps: u64| {
        eprintln!("{name}");
        let before = resident();
        let case = Case::new(name, plan(), steps);
        let bytes = before.zip(resident()).map(|(before, after)| (after - before) / case.len() as f64);
        (case, bytes)
    };
    // Steps are so many that the first of a turn, which finds the numbers of other bodies in the caches, weighs little.
    // The list comes last: the memory that its making frees would serve bodies that are weighed after it.
    let rkl2 = "integrator = \"rkl2\"\nstages = 10";
    let (cases, bytes): (Vec<Case>, Vec<Option<f64>>) = [
        weigh("pd, 1 M", &|| square(1000, "pd", "", 1), 32),
        weigh("pd, 65 k", &|| square(256, "pd", "", 1), 128),
        weigh("pd, 10 M", &|| square(3162, "pd", "", 1), 4),
        weigh("local, 1 M", &|| square(1000, "local", "", 1), 64),
        weigh("sph, 1 M", &|| square(1000, "sph", "", 1), 32),
        weigh("pd, freezing along a curve, 1 M", &|| freezing_square(WEIBULL, 1000, "pd", "", 1), 16),
        weigh("pd, the same side by side, 1 M", &|| layered_square(WEIBULL, 1000, "pd", 1), 16),
        weigh("pd, rkl2 of 10 stages, 1 M", &|| square(1000, "pd", rkl2, 1), 2),
        weigh("pd, avx2, 1 M", &|| square(1000, "pd", "", 1), 32),
        weigh("local, avx2, 1 M", &|| square(1000, "local", "", 1), 64),
        weigh("sph, avx2, 1 M", &|| square(1000, "sph", "", 1), 32),
        weigh("pd, portable, 65 k", &|| square(256, "pd", "", 1), 8),
        weigh("pd, list, 1 M", &|| square(1000, "pd", "search = \"tree\"", 1), 4),
    ]
    .into_iter()
    .unzip();
    let mut cases = cases;
    for case in &mut cases {
        let sets = InstructionSet::ALL.into_iter();
        let named = sets.rev().find(|set| case.name.contains(&set.to_string()));
        case.widest = named.unwrap_or(InstructionSet::Avx512);
    }
    take_turns(&mut cases);
    println!(
        "{:<38} {:>28} {:>16} {:>12}",
        "lattice, one thread", "M particle-steps/s", "time over first", "bytes each"
    );
    for (case, bytes) in cases.iter().zip(bytes) {
        let bytes = bytes.map_or_else(|| "-".to_owned(), |bytes| format!("{bytes:.1}"));
        println!("{:<38} {:>28} {:>16.2} {:>12}", case.name, case.rate(), ratio(case, &cases[0]), bytes);
    }
    println!("list over lattice: {:.2}", ratio(&cases[cases.len() - 1], &cases[0]));
    println!("10 M over 1 M, time per particle-step: {:.3}", ratio(&cases[2], &cases[0]));
}

/// Steps of small bodies on a line, where what a step costs beside its particles shows. Over two thousand times as many hours rounding is
/// made up for. Fronts inside particles are one, as a line that freezes from its wall has.
fn on_lines() {
    println!("{:<46} {:>12} {:>12} {:>8}", "line, one thread", "ns a step", "by hand", "ratio");
    for count in [75, 600] {
        for (hours, steps) in [(10, ""), (24_000, ", many steps")] {
            on_line::<3>(&format!("pd, {count}{steps}"), line(count, "pd", hours));
            on_line::<1>(&format!("local, {count}{steps}"), line(count, "local", hours));
            on_line::<3>(&format!("pd, front inside a particle, {count}{steps}"), freezing_line(count, "pd", hours));
            on_line::<1>(
                &format!("local, front inside a particle, {count}{steps}"),
                freezing_line(count, "local", hours),
            );
        }
    }
}

/// The same of one body, whose particles reach so many neighbours to each side.
fn on_line<const REACH: usize>(name: &str, plan: frazil_simulation::plan::Plan) {
    const STEPS: u64 = 20_000;
    let mut case = Case::new(name, plan, STEPS);
    let mut by_hand = PlainLine::<REACH>::new(&case);
    let mut times = Vec::new();
    for _ in 0..3 * ROUNDS {
        case.round();
        let began = ThreadTime::now();
        (0..STEPS).for_each(|_| std::hint::black_box(&mut by_hand).step());
        times.push(began.elapsed().as_secs_f64() / STEPS as f64);
    }
    let (own, plain) = (case.median() * case.len() as f64, median(&times).unwrap_or(f64::NAN));
    println!("{:<46} {:>12.1} {:>12.1} {:>8.2}", case.name, 1e9 * own, 1e9 * plain, own / plain);
}

/// A line of water that freezes at 0 °C, `REACH` neighbours to each side, a wall of given temperature at the left and a symmetry
/// plane at the right: the loop that one would write.
struct PlainLine<const REACH: usize> {
    enthalpy: Vec<f64>,
    potential: Vec<f64>,
    step: f64,
    weights: [f64; REACH],
}

impl<const REACH: usize> PlainLine<REACH> {
    fn new(case: &Case) -> Self {
        let enthalpy = case.plan.particles.enthalpy.clone();
        let potential = vec![0.0; enthalpy.len() + 2 * REACH];
        // Weights of any size serve: they are as stable as those of the program at its step.
        let largest = 2.14 / (1000.0 * 2060.0);
        let shares: [f64; REACH] = std::array::from_fn(|layer| 1.0 / (layer + 1) as f64);
        let sum = 2.0 * shares.iter().sum::<f64>();
        let weights = shares.map(|share| share / (2.0 * sum * largest * case.plan.step));
        PlainLine { enthalpy, potential, step: case.plan.step, weights }
    }

    fn step(&mut self) {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
            // SAFETY: the processor has just been asked for these features.
            return unsafe { self.step_avx512() };
        }
        self.plain_step();
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512vl")]
    fn step_avx512(&mut self) {
        self.plain_step();
    }

    #[inline(always)]
    fn plain_step(&mut self) {
        let count = self.enthalpy.len();
        for (potential, enthalpy) in self.potential[REACH..].iter_mut().zip(&self.enthalpy) {
            let frozen = if *enthalpy < -334e6 { enthalpy + 334e6 } else { 0.0 };
            let unfrozen = if *enthalpy > 0.0 { *enthalpy } else { 0.0 };
            *potential = 2.14 / (1000.0 * 2060.0) * frozen + 0.6 / (1000.0 * 4182.0) * unfrozen;
        }
        for layer in 0..REACH {
            self.potential[REACH - 1 - layer] = 2.0 * (-20.0 * 2.14) - self.potential[REACH + layer];
            self.potential[REACH + count + layer] = self.potential[REACH + count - 1 - layer];
        }
        let (before, here): ([&[f64]; REACH], _) =
            (std::array::from_fn(|k| &self.potential[REACH - 1 - k..][..count]), &self.potential[REACH..][..count]);
        let after: [&[f64]; REACH] = std::array::from_fn(|k| &self.potential[REACH + 1 + k..][..count]);
        for (i, enthalpy) in self.enthalpy.iter_mut().enumerate() {
            let mut rate = 0.0;
            for (k, weight) in self.weights.iter().enumerate() {
                rate += weight * (before[k][i] + after[k][i] - 2.0 * here[i]);
            }
            *enthalpy += self.step * rate;
        }
    }
}
