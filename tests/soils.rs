//! Ground of two soils whose curves differ: at their interface both have one pressure head, and all else jumps.

use frazil_core::physics::curve::Curve;
use frazil_core::physics::retention::scale::place;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, RunResult};
use frazil_scene::method::MethodKind;

use crate::sketch::{Sketch, even, soil, through};

/// Sand that lets water through ten times as well as the soil around it, and almost none once it is as dry.
const SAND: &str = "{ retention = { law = \"van-genuchten\", alpha_per_m = 8, n = 2.5 }, residual_water_content = 0.02, \
     saturated_water_content = 0.35, conductivity_m_per_s = 1e-5 }";

/// Ends of a layer of sand (m) in a column; neither lies where particles or their faces do.
const LAYER: (f64, f64) = (0.0313, 0.0687);
const LENGTH: f64 = 0.1;

fn column(spacing_m: f64, start: &str) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: LENGTH }, spacing_m).wall("left", start);
    (sketch.of_water, sketch.initial_c) = (true, -1.0);
    sketch.materials = vec![("soil", soil()), ("sand", SAND.into())];
    sketch.regions = vec![format!("material = \"sand\"\nx_min_m = {}\nx_max_m = {}", LAYER.0, LAYER.1)];
    sketch
}

fn run(sketch: &Sketch, kind: &'static MethodKind) -> RunResult {
    let result = sketch.run(kind);
    assert_eq!(result.record.outcome, Outcome::Ok, "{}: {:?}", kind.name, result.record.cause);
    assert!(result.record.energy_balance_rel.abs() < 1e-9, "{}: {:e}", kind.name, result.record.energy_balance_rel);
    result
}

/// Flux of water (m/s) at rest between two heads (m): one flux through three layers, each by its own potential.
fn steady(curves: &[Curve; 2], from: f64, to: f64) -> f64 {
    let layers = [(0, LAYER.0), (1, LAYER.1 - LAYER.0), (0, LENGTH - LAYER.1)];
    // The place at the far end, where a flux leaves one.
    let far = |flux: f64| {
        layers.iter().fold(place(from), |at, (soil, length)| {
            let curve = &curves[*soil];
            curve.temperature_of_potential(curve.potential(at) - flux * length)
        })
    };
    let (mut low, mut high) = (0.0, 1e-3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if far(middle) > place(to) { low = middle } else { high = middle }
    }
    low
}

/// Through three layers at rest water flows as through any layers in a row, wherever their interfaces lie.
#[test]
fn water_at_rest_flows_through_soils_in_a_row() {
    for kind in even() {
        let mut sketch = column(2e-3, "head_m = -0.1").wall("right", "head_m = -2").with("tolerance = 1e-5");
        (sketch.duration_s, sketch.outputs) = (1e8, 2);
        let materials = sketch.scene(kind).materials;
        let expected = steady(&[0, 1].map(|k: usize| Curve::new(&materials[k])), -0.1, -2.0);
        let result = run(&sketch, kind);
        let entered = through(&result, "left");
        let times: Vec<f64> = result.budget.iter().map(|row| row.time_s).collect();
        let last = times.len() - 1;
        let flux = (entered[last] - entered[last - 1]) / (times[last] - times[last - 1]);
        eprintln!("{}: {flux:e} of {expected:e} m/s", kind.name);
        assert!((flux / expected - 1.0).abs() < 1e-6, "{}: {flux:e} {expected:e}", kind.name);
    }
}

/// Dry ground of two soils takes up the water that it does on eight times as fine particles: within a tenth of what an error of
/// first order in the spacing is at 50 and 100 of them.
#[test]
fn dry_ground_of_two_soils_is_wetted() {
    let taken = |kind: &'static MethodKind, spacing_m: f64| {
        let mut sketch = column(spacing_m, "saturation = 1");
        (sketch.initial_c, sketch.duration_s) = (f64::NEG_INFINITY, 3.0e3);
        through(&run(&sketch.with("tolerance = 1e-4"), kind), "left").pop().expect("an output")
    };
    let local = even().find(|kind| kind.name == "local").expect("the method");
    let fine = taken(local, 2.5e-4);
    for kind in even() {
        let [coarse, finer] = [2e-3, 1e-3].map(|spacing_m| (taken(kind, spacing_m) / fine - 1.0).abs());
        eprintln!("{}: {coarse:.1e} at 2 mm, {finer:.1e} at 1 mm", kind.name);
        assert!(coarse < 2e-3 && finer < 1e-3, "{}: {coarse} {finer}", kind.name);
    }
}
