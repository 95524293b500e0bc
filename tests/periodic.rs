//! Bodies that go on at the opposite wall.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::space::domain::Domain;
use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;

use crate::sketch::{SHARP, Sketch, even, order_of_decay, sand, through};

const PERIODIC: &str = "condition = \"periodic\"";

/// A wave of any phase decays as the same in an endless body does, to second order in the spacing.
#[test]
fn a_wave_goes_on_at_the_opposite_wall() {
    for kind in methods() {
        for search in ["auto", "tree"] {
            let square = |spacing_m: f64| {
                let square = Sketch::new(Domain::Rectangle { width: 1.0, height: 1.0 }, spacing_m);
                let walls = ["left", "right", "bottom", "top"];
                let repeated = walls.iter().fold(square, |square, wall| square.wall(wall, PERIODIC));
                repeated.with(&format!("search = \"{search}\""))
            };
            let wave = |x: f64, y: f64| (2.0 * PI * x + 0.3).sin() * (4.0 * PI * y + 1.0).cos();
            let order = order_of_decay(kind, square, wave, 1e-6 * PI * PI * 20.0);
            assert!((order - 2.0).abs() < 0.1, "{}, {search}: {order}", kind.name);
        }
    }
}

/// Ground that freezes from below, in which a block of warm ground, or of another material, lies in the middle or at the periodic walls.
fn block(kind: &'static MethodKind, at_walls: bool, material: bool, settings: &str) -> RunResult {
    let what = if material { "material = \"clay\"" } else { "temperature_c = 20" };
    let part = |from: f64, to: f64| format!("{what}\nx_min_m = {from}\nx_max_m = {to}\ny_min_m = 0.2\ny_max_m = 0.7");
    let mut sketch = Sketch::new(Domain::Rectangle { width: 1.0, height: 1.0 }, 0.05)
        .wall("left", PERIODIC)
        .wall("right", PERIODIC)
        .wall("bottom", "temperature_c = -10")
        .wall("top", "temperature_c = 3")
        .with(settings);
    sketch.materials = vec![("sand", sand(SHARP))];
    if material {
        sketch.materials.push(("clay", sand("law = \"isothermal\", temperature_c = -1, latent_heat_J_per_kg = 90000")));
    }
    sketch.regions = if at_walls { vec![part(0.0, 0.1), part(0.9, 1.0)] } else { vec![part(0.4, 0.6)] };
    (sketch.duration_s, sketch.outputs) = (4e5, 4);
    sketch.sound(kind, 1e-12)
}

/// Nothing tells where a period begins: not the sweep, lists, interfaces, fronts inside particles or integrators.
#[test]
fn a_scene_moved_by_half_a_period_is_the_same() {
    for kind in even() {
        for material in [false, true] {
            for settings in
                ["", "front = \"cell\"", "integrator = \"implicit\"", "integrator = \"rkl2\"", "mean = \"harmonic\""]
            {
                let [middle, moved] = [false, true].map(|at_walls| block(kind, at_walls, material, settings));
                for wall in ["bottom", "top"] {
                    for (a, b) in through(&middle, wall).iter().zip(through(&moved, wall)) {
                        // Rounding, which steps by error and Krylov iterations amplify.
                        assert!((a / b - 1.0).abs() < 1e-9, "{}, {material}, {settings}, {wall}: {a} {b}", kind.name);
                    }
                }
            }
        }
    }
}

/// Both ends of a pair over a periodic wall have one noise: no heat is lost there.
#[test]
fn noise_over_a_periodic_wall_conserves_heat() {
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        for material in [false, true] {
            block(kind, true, material, "");
        }
    }
}

/// One wall alone, and walls closer than pairs reach, are refused.
#[test]
fn a_period_needs_two_walls_and_room() {
    let kind = methods().iter().find(|kind| kind.name == "pd").expect("a method");
    let line = |spacing_m: f64| Sketch::new(Domain::Line { length: 1.0 }, spacing_m).wall("left", PERIODIC);
    let text = line(0.05).text(kind.name);
    let problems = Scene::read(&text[..], "one", "one.toml", &[], &[kind]).expect_err("one wall").to_string();
    assert!(problems.contains("walls.left: condition \"periodic\" needs the same at the wall \"right\""), "{problems}");
    let narrow = line(0.5).wall("right", PERIODIC);
    let refused = frazil_simulation::march::run(&narrow.scene(kind), "pd", None, &Default::default());
    assert!(refused.is_err_and(|refused| refused.to_string().contains("at least as far apart as pairs reach")));
}
