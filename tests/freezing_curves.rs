//! Freezing curves in runs: each under every method.

use frazil::registry::methods;
use frazil_core::physics::freezing_curve::CURVES;
use frazil_core::space::domain::Domain;
use frazil_scene::Scene;

use crate::sketch::{Sketch, even, sand, through, water, without_noise};

/// Keys of a curve of each kind: a new one needs its line.
const KEYS: &[(&str, &str)] = &[
    ("linear", "width_K = 1.5"),
    ("weibull", "width_K = 0.8, residual_fraction = 0.1"),
    ("van-genuchten", "alpha_per_m = 3.6, n = 1.56, residual_fraction = 0.1"),
    ("table", "temperatures_c = [-6, -2, -0.7, -0.2], unfrozen_fractions = [0.05, 0.1, 0.4, 1]"),
];

/// Materials that freeze along each of the curves.
fn laws() -> Vec<String> {
    let law = |word: &str| {
        let keys = KEYS.iter().find(|row| row.0 == word).unwrap_or_else(|| unreachable!("no keys for {word}"));
        format!("law = \"{word}\", temperature_c = -0.2, {}", keys.1)
    };
    CURVES.iter().map(|kind| law(kind.word)).collect()
}

/// A plate of sand at 3 degC that one wall freezes.
fn slab(law: &str, spacing: f64) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: 0.2 }, spacing)
        .wall("left", "temperature_c = -10")
        .wall("right", "temperature_c = 3");
    sketch.materials = vec![("sand", sand(&format!("{law}, latent_heat_J_per_kg = 52875.8")))];
    (sketch.duration_s, sketch.outputs) = (6.0 * 3600.0, 4);
    sketch
}

#[test]
fn no_heat_is_lost_along_any_curve() {
    for kind in methods() {
        for law in laws() {
            for numerics in ["", "search = \"tree\"", "integrator = \"implicit\"", "integrator = \"rkl2\""] {
                let name = format!("{} {law} {numerics}", kind.name);
                if kind.stochastic && numerics.contains("integrator") {
                    continue;
                }
                let mut sketch = Sketch::new(Domain::Rectangle { width: 0.6, height: 0.4 }, 0.05)
                    .with(without_noise(kind))
                    .with(numerics)
                    .wall("left", "temperature_c = -12")
                    .wall("top", "coefficient_W_per_m2_K = 20\nambient_c = { times_h = [0, 30], values = [5, -15] }");
                sketch.materials = vec![("water", water(&format!("{law}, latent_heat_J_per_kg = 334000")))];
                sketch.duration_s = 2e5;
                let result = sketch.run(kind);
                let balance = result.record.energy_balance_rel;
                // Implicit steps stop their solver at a stated part of the heat; explicit ones round.
                let allowed = if numerics.contains("implicit") { 1e-9 } else { 1e-12 };
                assert!(balance.abs() <= allowed, "{name}: {balance:e}");
                assert!(through(&result, "left").last().is_some_and(|heat| *heat < -1e5), "{name}");
            }
        }
    }
}

/// A coarse run takes as much heat out of a plate as one of the local method with a quarter of the spacing.
#[test]
fn a_plate_freezes_as_a_fine_one_does() {
    let local = methods().iter().find(|kind| kind.lattice_only).expect("a method of a lattice");
    for law in laws() {
        let heat = |sketch: Sketch, kind| through(&sketch.run(kind), "left").last().copied().expect("an output");
        let fine = heat(slab(&law, 0.001_25), local);
        for kind in even() {
            let own = heat(slab(&law, 0.005), kind);
            assert!((own / fine - 1.0).abs() < 0.02, "{} {law}: {own} J/m2, not {fine}", kind.name);
        }
    }
}

/// What goes with no curve is refused beside each, by the one table of what does not go together.
#[test]
fn every_curve_is_a_material_that_freezes_over_an_interval() {
    for kind in even() {
        for law in laws() {
            let text = slab(&law, 0.005).with("scheme = \"flags\"").text(kind.name);
            let refused =
                Scene::read(&text, "slab", "slab", &[], &[kind]).map(drop).map_err(|problems| problems.to_string());
            let reason = "cannot be combined with a material that freezes over an interval";
            assert!(refused.as_ref().is_err_and(|problems| problems.contains(reason)), "{law}: {refused:?}");
        }
    }
}

/// Points on the line of the linear law make the same run, but for rounding.
#[test]
fn a_table_of_the_linear_curve_is_the_linear_curve() {
    let table = "law = \"table\", temperature_c = -0.2, temperatures_c = [-1.7, -1.2, -0.2], unfrozen_fractions = [0, THIRD, 1]";
    let laws = [
        "law = \"linear\", temperature_c = -0.2, width_K = 1.5",
        &table.replace("THIRD", &(1.0_f64 / 3.0).to_string()),
    ];
    for kind in even() {
        let [linear, table] = laws.map(|law| through(&slab(law, 0.005).run(kind), "left"));
        for (own, other) in linear.iter().zip(&table) {
            // A point of the table inside a step of the law's own table bends nothing: rounding of ten thousand steps.
            assert!((own / other - 1.0).abs() < 1e-11, "{}: {own} {other}", kind.name);
        }
    }
}
