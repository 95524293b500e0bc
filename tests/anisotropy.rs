//! Ground that conducts heat better along y than along x.

use std::f64::consts::PI;

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::RunResult;

use crate::rows::row;
use crate::sketch::{SHARP, Sketch, even, order_of_decay, sand, steady_material, through};

/// How such ground conducts.
fn anisotropy(ratio: f64) -> String {
    format!("conductivity_y_over_x = {ratio}")
}

/// A square metre of such ground.
fn ground(spacing_m: f64, ratio: f64) -> Sketch {
    let square = Sketch::new(Domain::Rectangle { width: 1.0, height: 1.0 }, spacing_m);
    Sketch { anisotropy: anisotropy(ratio), ..square }
}

/// A wave between symmetry planes decays by `alpha (a kx^2 + b ky^2)`, to second order in the spacing.
#[test]
fn a_wave_decays_by_the_conductivities_of_both_directions() {
    for kind in methods() {
        for ratio in [0.3, 2.0, 12.0] {
            let wave = |x: f64, y: f64| (2.0 * PI * x).cos() * (PI * y).cos();
            let order =
                order_of_decay(kind, |spacing_m| ground(spacing_m, ratio), wave, 1e-6 * PI * PI * (4.0 + ratio));
            assert!((order - 2.0).abs() < 0.1, "{}, {ratio}: {order}", kind.name);
        }
    }
}

/// Where nothing varies along x, ground is as one whose conductivities are those along y; at walls of all kinds.
#[test]
fn along_y_ground_conducts_as_its_conductivity_there() {
    let walls = [
        ("temperature_c = -10", "temperature_c = 3"),
        ("flux_W_per_m2 = -40", "temperature_c = 3"),
        ("coefficient_W_per_m2_K = 8\nambient_c = -15", "flux_W_per_m2 = 3"),
    ];
    for kind in even() {
        for (bottom, top) in walls {
            for settings in ["", "integrator = \"implicit\"\ntolerance = 1e-4", "mean = \"harmonic\""] {
                let heats = [2.5, 1.0].map(|ratio| {
                    let mut sketch = ground(0.05, ratio).wall("bottom", bottom).wall("top", top);
                    // The same along y.
                    let scaled = |conductivity: f64| conductivity * 2.5 / ratio;
                    let material = format!(
                        "{{ density_kg_per_m3 = 2000, frozen = {{ conductivity_W_per_m_K = {}, heat_capacity_J_per_kg_K = 1000 }}, \
                         unfrozen = {{ conductivity_W_per_m_K = {}, heat_capacity_J_per_kg_K = 1400 }}, freezing = {{ {SHARP} }} }}",
                        scaled(2.0),
                        scaled(1.5)
                    );
                    (sketch.materials, sketch.duration_s) = (vec![("ground", material)], 2e6);
                    let taken = |result: &RunResult, wall: &str| *through(result, wall).last().expect("an output");
                    let result = sketch.with(settings).sound(kind, 1e-9);
                    taken(&result, "bottom") + taken(&result, "top")
                });
                let error = heats[0] / heats[1] - 1.0;
                eprintln!("{}, {bottom}, {settings}: {error:.1e}", kind.name);
                // Pairs see a front in one column of cells more or fewer: (spacing / 1 m)^2.
                assert!(error.abs() < 2.5e-3, "{}, {bottom}, {settings}: {heats:?}", kind.name);
            }
        }
    }
}

/// A row of pipes of radius r, s apart, between walls at a distance h, at rest. Measured by how well heat goes there, lengths along y are
/// shorter by the root of the ratio; there a pipe is an ellipse, which acts as a circle of the mean of its half axes, and the row takes
/// what line sinks take (`rows::a_row_at_rest_takes_what_line_sinks_take`), times that root.
#[test]
fn a_row_of_pipes_takes_what_ellipses_take() {
    for kind in even() {
        for (ratio, upright) in [(2.0, false), (2.0, true), (0.4, false), (6.0, true)] {
            let shorter = f64::sqrt(1.0 / ratio);
            let (apart, far) = if upright { (shorter, 1.5) } else { (1.0, 1.5 * shorter) };
            let radius = 0.02 * 0.5 * (1.0 + shorter);
            let resistance = PI * far / apart - (2.0 * PI * radius / apart).ln();
            let exact = 2.0 * PI * 2.0 * 30.0 / shorter / resistance;
            let errors = [0.1, 0.05].map(|spacing_m| {
                let mut sketch = row(2, upright, spacing_m).with("integrator = \"implicit\"\ntolerance = 0.001");
                sketch.pipes[0] = sketch.pipes[0].replace("pipe_radius_m = 0.05", "pipe_radius_m = 0.02");
                (sketch.anisotropy, sketch.materials) = (anisotropy(ratio), vec![("ground", steady_material())]);
                (sketch.duration_s, sketch.outputs) = (2.5e7, 10);
                sketch.sound(kind, 1e-9).walls.last().expect("a wall").heat_per_pipe_w_per_m / exact - 1.0
            });
            eprintln!("{}, {ratio}, {upright}: off by {:.2e}, {:.2e}", kind.name, errors[0], errors[1]);
            // Ellipses beside each other are no circles, by the square of their half axes over the distance: below 1e-3.
            assert!(errors[0].abs() < 1e-2, "{}, {ratio}: {errors:?}", kind.name);
            assert!((errors[0] / errors[1] - 4.0).abs() < 0.5, "{}, {ratio}: {errors:?}", kind.name);
        }
    }
}

/// A ring with as many pipes in each quarter, turned by a quarter: x becomes y.
#[test]
fn a_ring_turned_by_a_quarter_freezes_alike() {
    for kind in even() {
        let [along_y, along_x] = [(2.0, 1.0), (0.5, 2.0)].map(|(ratio, factor)| {
            let mut sketch = Sketch::new(Domain::Ring { outer_radius: 10.0, sector: Sector::Quarter }, 0.2)
                .wall("outer", "temperature_c = 15");
            sketch.anisotropy = anisotropy(ratio);
            let sand = sand(SHARP).replace("2.56", &(2.56 * factor).to_string());
            sketch.materials = vec![("sand", sand.replace("1.86", &(1.86 * factor).to_string()))];
            sketch.pipes = vec!["count = 24\nring_radius_m = 5\npipe_radius_m = 0.054\ntemperature_c = -20".into()];
            (sketch.initial_c, sketch.duration_s, sketch.outputs) = (15.0, 30.0 * 86_400.0, 60);
            sketch.sound(kind, 1e-9)
        });
        let [there, here] = [&along_y, &along_x].map(|result| *through(result, "pipes").last().expect("an output"));
        assert!((there / here - 1.0).abs() < 1e-9, "{}: {there} {here}", kind.name);
        let days = |result: &RunResult| -> Vec<f64> {
            result.gaps.iter().map(|gap| gap.closure_s.expect("closed") / 86_400.0).collect()
        };
        let (own, mut turned) = (days(&along_y), days(&along_x));
        turned.reverse();
        assert!(own.iter().zip(&turned).all(|(a, b)| (a - b).abs() < 1e-6), "{}: {own:?} {turned:?}", kind.name);
        // Frozen ground grows along y: gaps between pipes that stand above each other close first.
        assert!(own.is_sorted() && own[5] > 1.5 * own[0], "{}: {own:?}", kind.name);
        // None of them is like another, but for mirrors.
        let alike: Vec<_> = along_y.gaps.iter().map(|gap| gap.multiplicity).collect();
        assert!(alike.iter().all(|count| *count == 4), "{alike:?}");
    }
}
