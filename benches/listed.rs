//! Bodies of a million particles whose pairs the sweep over a lattice does not know, on one thread: what a step makes, and
//! what a particle holds.

#![allow(clippy::print_stdout)]

mod shared;

use frazil_simulation::plan::Plan;
use shared::{Case, WEIBULL, freezing_square, square, take_turns};

/// Particles along each side.
const SIDE: usize = 1000;

/// The right half of another material.
const HALF: &str = "search = \"tree\"\n\
    [[regions]]\nmaterial = \"second\"\nx_min_m = 1\nx_max_m = 2\ny_min_m = 0\ny_max_m = 2\n\
    [materials.second]\ndensity_kg_per_m3 = 2000\n\
    frozen = { conductivity_W_per_m_K = 3, heat_capacity_J_per_kg_K = 1000 }\n\
    unfrozen = { conductivity_W_per_m_K = 2, heat_capacity_J_per_kg_K = 1200 }\n\
    freezing = { law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 50000 }";

const EVEN: &str = "search = \"tree\"";
const JITTERED: &str = "layout = \"jittered\"\njitter_fraction = 0.2";
const HARMONIC: &str = "mean = \"harmonic\"";

fn main() {
    let of_water = |method: &str, numerics: &str| square(SIDE, method, numerics, 1);
    let plans: Vec<(&str, Plan)> = vec![
        ("pd, even", of_water("pd", EVEN)),
        ("pd, jittered", of_water("pd", JITTERED)),
        ("pd, harmonic mean", of_water("pd", HARMONIC)),
        ("pd, two materials", of_water("pd", HALF)),
        ("pd, freezing along a curve", freezing_square(WEIBULL, SIDE, "pd", EVEN, 1)),
        ("sph, even", of_water("sph", EVEN)),
        ("sph, jittered", of_water("sph", JITTERED)),
    ];
    let mut cases: Vec<Case> = plans.into_iter().map(|(name, plan)| Case::new(name, plan, 2)).collect();
    take_turns(&mut cases);
    println!("{:<32} {:>28} {:>12} {:>12}", "on a list, one thread", "M particle-steps/s", "bytes each", "pairs each");
    for case in &cases {
        let count = case.len() as f64;
        let bytes = case.plan.summary.memory.total() as f64 / count;
        let pairs = case.plan.method.report().pairs as f64 / count;
        println!("{:<32} {:>28} {bytes:>12.1} {pairs:>12.2}", case.name, case.rate());
    }
}
