//! Walls of a rectangle in parts: what is booked is what comes in, wherever parts end, under every method and model of walls.

use frazil::registry::methods;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, RunResult};
use frazil_scene::method::MethodKind;

use crate::sketch::{SHARP, Sketch, even, sand, soil_with_solute, steady_material, through, without_noise};

const BODY: Domain = Domain::Rectangle { width: 0.3, height: 0.4 };
const MODELS: [&str; 4] = ["mirror", "naive", "inner-layers", "moving-least-squares"];

/// Sand at 3 degrees between closed walls, for some steps of a method that has no noise of its own.
fn sand_between(kind: &MethodKind, numerics: &str) -> Sketch {
    let mut sketch = Sketch::new(BODY, 0.02).with(without_noise(kind)).with(numerics);
    sketch.materials = vec![("sand", sand(SHARP))];
    sketch
}

/// What goes with a model of walls under a method.
fn models(kind: &MethodKind) -> impl Iterator<Item = &'static str> {
    MODELS.into_iter().filter(|model| !kind.stochastic || ["mirror", "moving-least-squares"].contains(model))
}

fn kept(result: &RunResult, what: &str) {
    let record = &result.record;
    assert_eq!(record.outcome, Outcome::Ok, "{what}: {:?}", record.cause);
    assert!(record.energy_balance_rel.abs() < 1e-9, "{what}: {:e}", record.energy_balance_rel);
}

/// Temperatures of all particles at the end of a run.
fn end(result: &RunResult) -> Vec<f64> {
    let last = result.profiles.iter().map(|row| row.time_s).fold(0.0, f64::max);
    result.profiles.iter().filter(|row| row.time_s == last).map(|row| row.temperature_c).collect()
}

#[test]
fn heat_that_parts_book_is_what_the_body_gains_wherever_they_end() {
    for kind in methods() {
        for model in models(kind) {
            for layout in ["", "layout = \"jittered\"\njitter_fraction = 0.2"] {
                if layout.len() > 1 && (kind.lattice_only || model == "inner-layers") {
                    continue;
                }
                // Parts end at edges of cells, at centres and anywhere, in corners too, and shorter than pairs reach.
                let sketch = sand_between(kind, &format!("wall_model = \"{model}\"\n{layout}"))
                    .wall(
                        "left",
                        "temperature_c = -5\nparts = [{ from_m = 0.11, to_m = 0.2, condition = \"symmetry\" }, \
                         { from_m = 0.26, to_m = 0.4, flux_W_per_m2 = -900 }]",
                    )
                    .wall(
                        "bottom",
                        "condition = \"symmetry\"\nparts = [{ from_m = 0, to_m = 0.0537, temperature_c = 9 }, \
                         { from_m = 0.17, to_m = 0.19, coefficient_W_per_m2_K = 50, ambient_c = -20 }, \
                         { from_m = 0.25, to_m = 0.3, temperature_c = -3 }]",
                    )
                    .wall("right", "coefficient_W_per_m2_K = 20\nambient_c = 8");
                kept(&sketch.run(kind), &format!("{} {model} {layout}", kind.name));
            }
        }
    }
}

#[test]
fn a_wall_in_parts_that_are_alike_is_a_whole_wall() {
    for kind in even() {
        for model in models(kind) {
            for line in ["temperature_c = -5", "flux_W_per_m2 = -400", "coefficient_W_per_m2_K = 30\nambient_c = -9"] {
                // A naive layer hands out what its own part brings.
                if model == "naive" && !line.starts_with("temp") {
                    continue;
                }
                let part = line.replace('\n', ", ");
                let parts = format!("parts = [{{ from_m = 0.07, to_m = 0.18, {part} }}]");
                let run = |walls: &str| {
                    let sketch =
                        sand_between(kind, &format!("wall_model = \"{model}\"\nsearch = \"tree\"")).wall("left", walls);
                    end(&sketch.wall("bottom", "temperature_c = 6").run(kind))
                };
                let (whole, parted) = (run(line), run(&format!("{line}\n{parts}")));
                for (whole, parted) in whole.iter().zip(&parted) {
                    assert!((whole - parted).abs() < 1e-9, "{} {model} {line}: {whole} {parted}", kind.name);
                }
            }
        }
    }
}

/// Pairs of each direction cross the wall at places a spacing apart, so their stretches of it cover the part without gap.
#[test]
fn a_part_of_given_flux_brings_what_its_length_says() {
    for kind in even() {
        for model in ["mirror", "naive"] {
            let numerics = format!("wall_model = \"{model}\"");
            let part = "condition = \"symmetry\"\nparts = [{ from_m = 0.013, to_m = 0.27, flux_W_per_m2 = 500 }]";
            let result = sand_between(kind, &numerics).wall("left", part).run(kind);
            let came = *through(&result, "left_part_1").last().expect("an output");
            let wanted = 500.0 * 0.257 * 3600.0;
            assert!((came / wanted - 1.0).abs() < 1e-9, "{} {model}: {came} {wanted}", kind.name);
        }
    }
}

/// With the ground turned upside down, so is what happens: where a part ends at the centre of a particle, too.
#[test]
fn mirrored_parts_make_the_mirror_image() {
    for kind in even() {
        let run = |from: f64, to: f64| {
            let part =
                format!("condition = \"symmetry\"\nparts = [{{ from_m = {from}, to_m = {to}, temperature_c = -5 }}]");
            let mut sketch = sand_between(kind, "").wall("left", part);
            sketch.watch = "cuts_x_m = [0.03, 0.15]".into();
            end(&sketch.run(kind))
        };
        let (below, above) = (run(0.04, 0.13), run(0.27, 0.36));
        let height = below.len() / 2;
        for (below, above) in below.chunks(height).zip(above.chunks(height)) {
            for (below, above) in below.iter().zip(above.iter().rev()) {
                assert!((below - above).abs() < 1e-9, "{}: {below} {above}", kind.name);
            }
        }
    }
}

/// Steady heat through two parts of one wall at 1 and -1 degrees, closed elsewhere: by symmetry nothing crosses the middle, which
/// stays at zero, and what comes in at one part leaves at the other. Heat falls with the first power of the spacing.
#[test]
fn what_comes_in_at_one_part_leaves_at_the_other() {
    for kind in even() {
        let flow = |spacing: f64| {
            let mut sketch = Sketch::new(Domain::Rectangle { width: 0.4, height: 0.4 }, spacing)
                .wall(
                    "left",
                    "condition = \"symmetry\"\nparts = [{ from_m = 0.04, to_m = 0.12, temperature_c = 1 }, \
                     { from_m = 0.28, to_m = 0.36, temperature_c = -1 }]",
                )
                .with("integrator = \"implicit\"");
            sketch.materials = vec![("steady", steady_material())];
            (sketch.initial_c, sketch.duration_s, sketch.outputs) = (0.0, 2e6, 10);
            let result = sketch.run(kind);
            kept(&result, kind.name);
            let [came, left] = ["left_part_1", "left_part_2"].map(|part| through(&result, part));
            let last = |all: &[f64]| all[all.len() - 1] - all[all.len() - 2];
            assert!((last(&came) / -last(&left) - 1.0).abs() < 1e-6, "{}: {came:?} {left:?}", kind.name);
            last(&came)
        };
        let [coarse, middle, fine] = [0.04, 0.02, 0.01].map(flow);
        let order = ((coarse - middle) / (middle - fine)).abs().log2();
        eprintln!("{}: {coarse} {middle} {fine}, order {order:.2}", kind.name);
        assert!(order > 0.7, "{}: {order}", kind.name);
    }
}

/// Heads, fluxes, closed parts and one that drains, with a solute whose concentration has parts of its own.
#[test]
fn water_and_solute_pass_parts() {
    for kind in even() {
        for model in ["mirror", "naive"] {
            let mut sketch = Sketch::new(Domain::Rectangle { width: 0.2, height: 0.2 }, 0.02)
                .with(&format!("wall_model = \"{model}\""))
                .wall(
                    "top",
                    "head_m = 0\nconcentration = 1\nparts = [{ from_m = 0.05, to_m = 0.09, condition = \"symmetry\" }, \
                     { from_m = 0.13, to_m = 0.17, concentration = 0.5 }, \
                     { from_m = 0.17, to_m = 0.18, condition = \"symmetry\" }, \
                     { from_m = 0.18, to_m = 0.2, water_flux_m_per_s = 1e-7, concentration = 2 }]",
                )
                .wall(
                    "bottom",
                    "condition = \"free-drainage\"\nparts = [{ from_m = 0, to_m = 0.071, condition = \"symmetry\" }]",
                );
            (sketch.of_water, sketch.initial_c, sketch.duration_s) = (true, -1.0, 2e4);
            sketch.materials = vec![("soil", soil_with_solute())];
            sketch.gravity = "towards = \"bottom\"".into();
            let result = sketch.run(kind);
            kept(&result, &format!("{} {model}", kind.name));
            let solute = result.record.solute_balance_rel.expect("a solute");
            assert!(solute.abs() < 1e-9, "{} {model}: {solute:e}", kind.name);
            let last = |part: &str| *through(&result, part).last().expect("an output");
            assert_eq!(last("top_part_2"), 0.0);
            let (brought, came) = (1e-7 * 0.02 * 2e4, last("top_part_5"));
            // Gravity pulls along pairs with layers of one value, which stand at no height of their own.
            let slack = if model == "mirror" { 1e-6 } else { 0.03 };
            assert!((came / brought - 1.0).abs() < slack, "{} {model}: {came}", kind.name);
        }
    }
}
