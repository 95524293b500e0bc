//! `--paper`: the discretisation that a paper prints of a scene is what runs.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use frazil::registry::methods;
use frazil_cases::{paper, scenes};
use frazil_core::space::symmetry::Symmetry;
use frazil_scene::{Scene, Setting};
use frazil_simulation::plan::{self, Plan};

use crate::sketch::advance;

/// A bundled scene as its paper prints it, with further overrides.
fn printed(name: &str, further: &[(&str, &str)]) -> Scene {
    let bundled = scenes::find(name).expect("bundled");
    let mut overrides = paper::overrides(name).expect("printed");
    overrides.extend(further.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())));
    Scene::read(bundled, name, name, &overrides, methods()).unwrap_or_else(|problems| unreachable!("{problems}"))
}

fn planned(scene: &Scene) -> Plan {
    let settings = scene.method("pd").expect("pd");
    plan::build(scene, settings, None, 1, 1).unwrap_or_else(|refused| unreachable!("{}: {refused}", scene.name))
}

#[test]
fn every_file_is_listed_and_can_be_run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/paper");
    let files: BTreeSet<String> = fs::read_dir(folder)
        .expect("the folder")
        .map(|entry| entry.expect("an entry").path().file_stem().expect("a name").to_string_lossy().into_owned())
        .collect();
    let listed: BTreeSet<String> = paper::all().iter().map(|printed| printed.name.to_owned()).collect();
    assert_eq!(files, listed);
    for name in &listed {
        assert_eq!(paper::method(name).as_deref(), Some("pd"));
        let scene = printed(name, &[]);
        assert_eq!(scene.method("pd").map(|settings| settings.setting), Some(Setting::Paper), "{name}");
        // A file says nothing that the scene would not read: a line is a key, and nothing but a key.
        let lines = scenes_lines(name);
        assert_eq!(lines, paper::overrides(name).map(|keys| keys.len()).unwrap_or_default(), "{name}");
        planned(&scene);
    }
}

fn scenes_lines(name: &str) -> usize {
    let printed = paper::all().iter().find(|printed| printed.name == name).expect("listed");
    printed.text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).count()
}

/// Phases of a particle in the sense of eq 1 of Nikolaev et al. 2023.
#[derive(Clone, Copy)]
struct State {
    temperature: f64,
    conductivity: f64,
    enthalpy: f64,
}

/// One explicit step of eq 24 of Nikolaev et al. 2023 by hand, on a radius: shape factors, harmonic means, conductivity over
/// the horizon, half of the outermost cells, and half of the sum of the two nearest bonds for the own cell; away from walls.
#[test]
fn a_step_around_an_axis_and_a_centre_is_the_printed_one() {
    for (name, symmetry) in [("freezing-annulus", Symmetry::Axial), ("copper-sphere", Symmetry::Spherical)] {
        let mut plan = planned(&printed(name, &[]));
        let spacing = plan.particles.lattice.spacing;
        let water = name == "freezing-annulus";
        // Ice, freezing and water in turn; of copper a wave. Enthalpies count from the start, 8 degC or 726.85 degC.
        let state = |i: usize| {
            let wave = (0.7 * i as f64).sin();
            match (water, i % 3) {
                (true, 0) => State {
                    temperature: -5.0 + wave,
                    conductivity: 2.14,
                    enthalpy: -8.0 * 4.182e6 - 3.33e8 + (-5.0 + wave) * 2.06e6,
                },
                (true, 1) => State {
                    temperature: 0.0,
                    conductivity: 0.5 * (2.14 + 0.6),
                    enthalpy: -8.0 * 4.182e6 - 3.33e8 * (0.5 + 0.4 * wave),
                },
                (true, _) => {
                    State { temperature: 4.0 + wave, conductivity: 0.6, enthalpy: (4.0 + wave - 8.0) * 4.182e6 }
                }
                (false, _) => State {
                    temperature: 400.0 * wave,
                    conductivity: 400.0,
                    enthalpy: (400.0 * wave - 726.85) * 8920.0 * 385.0,
                },
            }
        };
        let count = plan.particles.len();
        for i in 0..count {
            plan.particles.enthalpy[i] = state(i).enthalpy;
        }
        advance(&mut plan, 1);
        let inner = if water { 0.1 } else { 0.0 };
        let radius = |i: usize| inner + (i as f64 + 0.5) * spacing;
        let horizon = 3.0 * spacing;
        for i in 3..count - 3 {
            let own = state(i);
            let rate: f64 = [(1, 1.5), (2, 1.0), (3, 0.5)]
                .into_iter()
                .flat_map(|(cells, volume)| [(i - cells, cells, volume), (i + cells, cells, volume)])
                .map(|(j, cells, volume)| {
                    let other = state(j);
                    let (r, s) = (radius(i), radius(j));
                    let shape = match symmetry {
                        Symmetry::Axial => 2.0 * s / (r + s),
                        Symmetry::Spherical => 3.0 * s * s / (r * r + r * s + s * s),
                    };
                    let mean = 2.0 * own.conductivity * other.conductivity / (own.conductivity + other.conductivity);
                    let distance = cells as f64 * spacing;
                    shape * mean / horizon * (other.temperature - own.temperature) / (distance * distance)
                        * volume
                        * spacing
                })
                .sum();
            let found = plan.particles.enthalpy[i] - own.enthalpy;
            let wanted = plan.step * rate;
            // Sums of some terms of 1e9 that are known to 16 digits.
            assert!((found - wanted).abs() < 1e-5, "{name} {i}: {found} {wanted}");
        }
    }
}

/// The layers of section 5 of Nikolaev et al. 2021: three particles behind the wall hold its temperature.
#[test]
fn a_step_at_a_wall_is_the_printed_one() {
    let mut plan = planned(&printed("stefan-water-mushy", &[]));
    advance(&mut plan, 1);
    // The first particle at 8 degC sees -20 degC at 1, 2 and 3 cells by the mean of both conductivities, the second at 2 and
    // 3, the third at 3 alone, as half a cell.
    let (spacing, mean) = (0.002, 0.5 * (2.14 + 0.6));
    let seen: [f64; 4] = [1.5 + 1.0 / 4.0 + 0.5 / 9.0, 1.0 / 4.0 + 0.5 / 9.0, 0.5 / 9.0, 0.0];
    for (i, seen) in seen.into_iter().enumerate() {
        let rate = -28.0 * mean * seen / (3.0 * spacing * spacing);
        let temperature = plan.particles.materials.of(0).temperature(plan.particles.enthalpy[i]);
        let wanted = 8.0 + plan.step * rate / 4.182e6;
        assert!((temperature - wanted).abs() < 1e-9, "{i}: {temperature} {wanted}");
    }
}
