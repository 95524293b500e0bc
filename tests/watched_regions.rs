//! Integrals over parts of a body: their sizes are those of the shapes, parts add up to the whole, and the whole holds what came in.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::space::domain::Domain;
use frazil_record::RunResult;
use frazil_scene::method::MethodKind;

use crate::sketch::{Sketch, water, without_noise};

const BODY: Domain = Domain::Rectangle { width: 0.9, height: 0.7 };
const SHARP: &str = "law = \"isothermal\", latent_heat_J_per_kg = 50000, temperature_c = 0";

/// Values of a column of `regions.csv` at the last output, region by region.
fn last(result: &RunResult, column: &str) -> Vec<f64> {
    let table = result.tables.iter().find(|table| table.file == "regions.csv").expect("a table");
    let at = table.columns.iter().position(|own| own.name == column).expect("a column");
    let end = table.rows.last().expect("rows")[0];
    table.rows.iter().filter(|row| row[0] == end).map(|row| row[at].expect("a value")).collect()
}

/// A body at 3 degC that freezes from two of its walls, and in which regions are watched.
fn freezing(kind: &'static MethodKind, regions: &[&str]) -> RunResult {
    let mut sketch = Sketch::new(BODY, 0.05).with(without_noise(kind));
    sketch.materials = vec![("water", water(SHARP))];
    sketch.walls = ["left", "bottom"].map(|wall| (wall, "temperature_c = -10".to_owned())).into();
    sketch.duration_s = 2e5;
    sketch.outputs = 3;
    let regions: Vec<String> = regions.iter().map(|shape| format!("{{ {shape} }}")).collect();
    sketch.watch = format!("regions = [{}]", regions.join(", "));
    sketch.run(kind)
}

#[test]
fn sizes_are_those_of_the_shapes() {
    let shapes = [
        "x_min_m = 0.13, x_max_m = 0.52, y_min_m = 0.08, y_max_m = 0.33",
        "circle = { x_m = 0.44, y_m = 0.31, radius_m = 0.234 }",
        "ellipse = { x_m = 0.44, y_m = 0.33, half_axes_m = [0.3, 0.12], angle_deg = 25 }",
    ];
    let areas = [0.39 * 0.25, PI * 0.234 * 0.234, PI * 0.3 * 0.12];
    for kind in methods() {
        for (found, area) in last(&freezing(kind, &shapes), "area_m2").into_iter().zip(areas) {
            // Shares below 1e-9 of some hundred cells count as none.
            assert!((found / area - 1.0).abs() < 1e-8, "{}: {found} {area}", kind.name);
        }
    }
}

#[test]
fn parts_add_up_to_the_whole_which_holds_what_came_in() {
    // Cut through cells, and along their edges.
    let boxes = [
        [0.0, 0.313, 0.0, 0.7],
        [0.313, 0.9, 0.0, 0.7],
        [0.0, 0.9, 0.0, 0.35],
        [0.0, 0.9, 0.35, 0.7],
        [0.0, 0.9, 0.0, 0.7],
    ];
    let shapes = boxes.map(|[left, right, bottom, top]| {
        format!("x_min_m = {left}, x_max_m = {right}, y_min_m = {bottom}, y_max_m = {top}")
    });
    for kind in methods() {
        let result = freezing(kind, &shapes.each_ref().map(String::as_str));
        let area = last(&result, "area_m2");
        for column in ["mean_c", "frozen_fraction", "heat_j_per_m3"] {
            let means = last(&result, column);
            let integral: Vec<f64> = means.iter().zip(&area).map(|(mean, area)| mean * area).collect();
            for (one, other) in [(0, 1), (2, 3)] {
                // Rounding of some hundred particles.
                let (sum, whole) = (integral[one] + integral[other], integral[4]);
                assert!((sum - whole).abs() < 1e-12 * whole.abs(), "{} {column}: {sum} {whole}", kind.name);
            }
        }
        let (heat, budget) = (last(&result, "heat_j_per_m3")[4] * area[4], result.budget.last().expect("a budget"));
        assert!((heat / budget.stored_j - 1.0).abs() < 1e-12, "{}: {heat} {}", kind.name, budget.stored_j);
        let [least, greatest] = ["least_c", "greatest_c"].map(|column| last(&result, column));
        assert!(least.iter().zip(&greatest).all(|(low, high)| -10.0 <= *low && low < high && *high <= 3.0));
        assert!((0..4).all(|part| least[4] <= least[part] && greatest[part] <= greatest[4]));
    }
}

/// In a wall at rest temperatures are a straight line: the mean of a part is that of its middle, and what the part holds follows.
#[test]
fn means_of_a_straight_profile_are_those_of_the_middle() {
    for kind in methods() {
        let mut sketch = Sketch::new(Domain::Line { length: 1.0 }, 0.05).with(without_noise(kind));
        sketch.materials = vec![("water", water("law = \"none\", temperature_c = -100"))];
        sketch.initial_c = 4.0;
        sketch.initial_along = "{ x_m = [0, 1], values = [2, 10] }".into();
        sketch.walls = vec![("left", "temperature_c = 2".into()), ("right", "temperature_c = 10".into())];
        sketch.watch = "regions = [{ x_min_m = 0.1, x_max_m = 0.5 }, { x_min_m = 0.5, x_max_m = 1 }]".into();
        sketch.duration_s = 1e4;
        let result = sketch.run(kind);
        for (found, expected) in last(&result, "mean_c").into_iter().zip([2.0 + 8.0 * 0.3, 2.0 + 8.0 * 0.75]) {
            assert!((found - expected).abs() < 1e-9, "{}: {found} {expected}", kind.name);
        }
        assert_eq!(last(&result, "length_m").len(), 2);
    }
}
