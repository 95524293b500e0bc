//! Steps of `thawing-inclusion` with water, over steps of conduction alone on the same particles: on a list and on the
//! lattice. Whole runs to the end of the scene, one thread, in turns.

#![allow(clippy::print_stdout)]

mod shared;

use cpu_time::ThreadTime;
use frazil_core::solvers::step::Clock;
use frazil_core::statistics::median;
use frazil_simulation::plan::Plan;
use shared::planned;

/// Seconds of the scene, and turns.
const DURATION: f64 = 3000.0;
const TURNS: usize = 3;

/// The scene without its reference, and without water if asked for.
fn scene(water: bool, method: &str, search: &str) -> String {
    let text = frazil_cases::scenes::find("thawing-inclusion").map_or("", |bundled| bundled.text);
    let dropped = |name: &str| name == "[reference]" || name.starts_with("[method.") || (!water && name == "[flow]");
    let mut kept = String::new();
    let mut section = String::new();
    for line in text.lines() {
        if line.starts_with('[') {
            section = line.trim().to_owned();
        }
        if !dropped(&section) && (water || !line.starts_with("permeability_m2")) {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    format!("{kept}[method.{method}]\nspacing_m = 0.005\n{search}\n")
}

/// Seconds a step over a whole run, and steps.
fn run(mut plan: Plan) -> (f64, u64) {
    let (mut time, mut index) = (0.0, 0);
    let began = ThreadTime::now();
    while time < DURATION {
        let clock = Clock {
            time,
            step: plan.step.min(plan.method.wanted_step()).min(DURATION - time),
            index,
            turned: index == 0,
        };
        time += plan.method.advance(&mut plan.particles, &clock).expect("a step");
        index += 1;
    }
    (began.elapsed().as_secs_f64() / index as f64, index)
}

fn main() {
    println!(
        "{:<8} {:>10} {:>14} {:>14} {:>16} {:>10}",
        "method", "steps", "ms a step", "list", "lattice", "over list"
    );
    for method in ["pd", "sph", "local"] {
        let mut times: [Vec<f64>; 3] = Default::default();
        let mut steps = 0;
        for _ in 0..TURNS {
            let cases = [(true, ""), (false, "search = \"tree\""), (false, "search = \"lattice\"")];
            for ((water, search), times) in cases.into_iter().zip(&mut times) {
                let (time, made) = run(planned(&scene(water, method, search), method, 1));
                times.push(1e3 * time);
                steps = if water { made } else { steps };
            }
        }
        let [water, list, lattice] = times.map(|times| median(&times).unwrap_or(f64::NAN));
        println!(
            "{method:<8} {steps:>10} {water:>14.3} {list:>14.3} {lattice:>16.3} {:>10.2} ({:.1} over lattice)",
            water / list,
            water / lattice
        );
    }
}
