//! The time that `check` foretells against the time that the run then takes, for bundled scenes under every method that
//! is done in half a minute.

#![allow(clippy::print_stdout)]

use std::sync::Arc;

use frazil::registry::methods;
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};
use frazil_simulation::predict::forecast;

const SCENES: [&str; 6] =
    ["stefan-water", "stefan-water-mushy", "soil-column", "stefan-dpd-1", "frozen-wall-clay", "frozen-wall-sand"];

/// Longer runs (s) are left out.
const LONGEST: f64 = 30.0;

/// Within this factor a forecast is called right.
const FACTOR: f64 = 1.5;

fn main() {
    println!("{:<20} {:<6} {:>12} {:>12} {:>8}", "scene, one thread", "method", "foretold, s", "taken, s", "ratio");
    let (mut right, mut all) = (0, 0);
    for name in SCENES {
        let Some(bundled) = frazil_cases::scenes::find(name) else { continue };
        let scene = match Scene::read(bundled, name, name, &[], methods()) {
            Ok(scene) => scene,
            Err(problems) => {
                println!("{problems}");
                continue;
            }
        };
        for kind in methods() {
            let reference = frazil_cases::truth(&scene).ok().and_then(|truth| truth.reference).map(Arc::from);
            let foretold = match forecast(&scene, kind.name, reference.as_ref(), 1, 1) {
                Ok(forecast) => forecast.seconds(),
                Err(refused) => {
                    println!("{name:<20} {:<6} {refused}", kind.name);
                    continue;
                }
            };
            let Some(foretold) = foretold.filter(|seconds| *seconds < LONGEST) else {
                println!("{name:<20} {:<6} left out", kind.name);
                continue;
            };
            let Ok(result) = march::run(&scene, kind.name, reference.as_ref(), &Options::default()) else { continue };
            let taken = result.record.solve_cpu_s + result.record.observation_cpu_s;
            let ratio = foretold / taken;
            all += 1;
            right += usize::from((1.0 / FACTOR..=FACTOR).contains(&ratio));
            println!("{name:<20} {:<6} {foretold:>12.4} {taken:>12.4} {ratio:>8.2}", kind.name);
        }
    }
    println!("{right} of {all} within a factor of {FACTOR}");
}
