//! Isotherms and fronts of planes, beside closed forms.

use std::f64::consts::PI;
use std::sync::Arc;

use frazil::registry::methods;
use frazil_cases::exact::neumann::Neumann;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_record::{ReferenceInfo, RunResult, Table};
use frazil_simulation::march::{self, Options};
use frazil_simulation::reduce::{self, Finding};
use frazil_simulation::reference::Reference;

use crate::sketch::{Sketch, even, steady_material};

const COLD: &str = "temperature_c = -10";

fn table<'a>(result: &'a RunResult, file: &str) -> &'a Table {
    result.tables.iter().find(|table| table.file == file).expect("the table")
}

/// A column of the last instant, row by row.
fn last(result: &RunResult, file: &str, column: &str) -> Vec<Option<f64>> {
    let table = table(result, file);
    let at = table.columns.iter().position(|own| own.name == column).expect("the column");
    let end = table.rows.last().expect("a row")[0];
    table.rows.iter().filter(|row| row[0] == end).map(|row| row[at]).collect()
}

#[test]
fn isotherms_of_a_freezing_slab_come_to_those_of_neumann() {
    let isotherms = [-5.0, -1.0, 1.0, 2.0];
    for kind in even() {
        let errors = [0.02, 0.01, 0.005].map(|spacing| {
            let mut sketch = Sketch::new(Domain::Line { length: 0.6 }, spacing).wall("left", COLD);
            sketch.watch = format!("isotherms_c = {isotherms:?}");
            // The far wall does not feel it: it is seven lengths of diffusion away.
            sketch.duration_s = 43_200.0;
            let scene = sketch.scene(kind);
            let exact = Neumann::new(&scene.materials[0], -10.0, 3.0).expect("a solution");
            let place = |isotherm: f64| {
                let (mut low, mut high) = (0.0, 0.6);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if exact.temperature(middle, 43_200.0) < isotherm { low = middle } else { high = middle }
                }
                low
            };
            let found = last(&sketch.run(kind), "isotherms.csv", "depth_m");
            let errors = found.iter().zip(isotherms).map(|(depth, of)| (depth.expect("a depth") - place(of)).abs());
            errors.fold(0.0, f64::max)
        });
        // First order, as the front that they follow is, which is known to two particles.
        assert!(errors[2] < 0.5 * errors[0] && errors[2] < 2.0 * 0.005, "{}: {errors:?}", kind.name);
    }
}

#[test]
fn isotherms_of_a_linear_profile_are_exact_from_either_side() {
    for kind in even() {
        for (near, far) in [("left", "right"), ("right", "left")] {
            let mut sketch = Sketch::new(Domain::Line { length: 0.1 }, 0.01);
            sketch.materials = vec![("rock", steady_material())];
            sketch = sketch.wall(near, "temperature_c = -4").wall(far, "temperature_c = 3.5");
            sketch.watch = "isotherms_c = [-3.9, 0, 2, 4]".into();
            // Sixty times as long as the slowest part of what there was at the start takes to fall e-fold.
            sketch.duration_s = 60_000.0;
            let found = last(&sketch.run(kind), "isotherms.csv", "depth_m");
            for (depth, isotherm) in found.iter().zip([-3.9, 0.0, 2.0]) {
                let expected = 0.1 * (isotherm + 4.0) / 7.5;
                // Rounding of some 1e5 steps.
                assert!((depth.expect("a depth") - expected).abs() < 1e-10, "{}: {found:?}", kind.name);
            }
            assert_eq!(found[3], None);
        }
    }
}

/// Temperatures between two cylinders are linear in the logarithm of the radius.
#[test]
fn isotherms_between_cylinders_lie_where_the_logarithm_says() {
    let (inner, outer) = (0.02, 0.12);
    for kind in even() {
        let errors = [0.01, 0.005].map(|spacing| {
            let mut sketch = Sketch::new(Domain::Radial { symmetry: Symmetry::Axial, inner, outer }, spacing);
            sketch.materials = vec![("rock", steady_material())];
            sketch = sketch.wall("inner", "temperature_c = -4").wall("outer", "temperature_c = 4");
            sketch.watch = "isotherms_c = [0]".into();
            sketch.duration_s = 60_000.0;
            let depth = last(&sketch.run(kind), "isotherms.csv", "depth_m")[0].expect("a depth");
            (depth - (f64::sqrt(inner * outer) - inner)).abs()
        });
        // A chord between two particles is off by the square of their distance.
        assert!(errors[1] < 0.5 * errors[0] && errors[1] < 0.1 * 0.005, "{}: {errors:?}", kind.name);
    }
}

/// In a disc that is cooled all around isotherms are circles.
#[test]
fn isotherms_of_a_disc_are_as_far_from_its_wall_everywhere() {
    let spacing = 0.02;
    for kind in even() {
        for sector in [Sector::Quarter, Sector::Whole] {
            let mut sketch = Sketch::new(Domain::Ring { outer_radius: 0.5, sector }, spacing).wall("outer", COLD);
            sketch.materials = vec![("rock", steady_material())];
            sketch.watch = "isotherms_c = [0]".into();
            sketch.duration_s = 20_000.0;
            let result = sketch.run(kind);
            let of = |column: &str| last(&result, "isotherms.csv", column)[0].expect("a value");
            let (least, mean) = (of("distance_least_m"), of("distance_mean_m"));
            // A curved wall is a staircase of particles, known to a part of a spacing.
            assert!(mean - least < 0.25 * spacing && mean > 3.0 * spacing, "{}: {least} to {mean}", kind.name);
            let length = 2.0 * PI * (0.5 - mean);
            assert!((of("length_m") / length - 1.0).abs() < 0.01, "{}: {} for {length}", kind.name, of("length_m"));
        }
    }
}

/// The front of a body that is frozen from several sides is the line on which half is frozen: around a round core it is as long as a
/// circle of that area, and as far from the walls as it lies.
#[test]
fn the_front_of_a_core_is_told_by_its_shape() {
    let (radius, spacing) = (0.06, 0.004);
    for kind in even() {
        let mut sketch =
            Sketch::new(Domain::Rectangle { width: 0.2, height: 0.16 }, spacing).wall("left", "temperature_c = -5");
        sketch = sketch.wall("bottom", "temperature_c = -5");
        sketch.initial_c = -5.0;
        sketch.regions = vec![format!("temperature_c = 3\ncircle = {{ x_m = 0.1, y_m = 0.08, radius_m = {radius} }}")];
        sketch.duration_s = 1.0;
        let result = sketch.run(kind);
        assert!(result.front.is_empty(), "{}", kind.name);
        let of = |column: &str| last(&result, "front_shape.csv", column)[0].expect("a value");
        let (frozen, length) = (0.2 * 0.16 - PI * radius * radius, 2.0 * PI * radius);
        // Particles that the edge cuts hold their share of it, so that the line lies within a part of a spacing of it.
        assert!(
            (of("frozen_m2") - frozen).abs() < 0.1 * spacing * length,
            "{}: {} of {frozen}",
            kind.name,
            of("frozen_m2")
        );
        assert!((of("length_m") / length - 1.0).abs() < 0.05, "{}: {} of {length}", kind.name, of("length_m"));
        let least = of("distance_least_m");
        assert!((least - (0.08 - radius)).abs() < 0.25 * spacing, "{}: {least}", kind.name);
        assert!(of("distance_mean_m") > least && of("distance_mean_m") < 0.08, "{}", kind.name);
        let area = result.frozen[0].frozen_volume;
        assert!((of("frozen_m2") - area).abs() < 0.1 * spacing * length, "{}: {area} in frozen.csv", kind.name);
    }
}

/// Where a front runs one way, or nothing freezes, there is no such table.
#[test]
fn a_plane_front_has_no_shape() {
    let plane = || Sketch::new(Domain::Rectangle { width: 0.2, height: 0.1 }, 0.02).wall("left", COLD);
    let mut rock = plane().wall("bottom", COLD);
    rock.materials = vec![("rock", steady_material())];
    for kind in even() {
        for sketch in [plane(), rock.clone()] {
            assert!(sketch.run(kind).tables.is_empty(), "{}", kind.name);
        }
        assert_eq!(plane().wall("bottom", COLD).run(kind).tables.len(), 1, "{}", kind.name);
    }
}

/// Errors of all temperatures are those of the field beside a reference that knows points.
#[test]
fn a_plane_is_measured_everywhere_where_a_reference_knows_points() {
    /// A field that is as warm as the walls everywhere.
    struct Cold;
    impl Reference for Cold {
        fn describe(&self) -> ReferenceInfo {
            ReferenceInfo::new("exact", "a test", 0.0)
        }
        fn point_temperature(&self, _: f64, _: f64, _: f64) -> Option<f64> {
            Some(-10.0)
        }
    }
    let mut sketch = Sketch::new(Domain::Rectangle { width: 0.2, height: 0.1 }, 0.02).wall("left", COLD);
    sketch = sketch.wall("bottom", COLD);
    // So short that all but the particles at the walls are as at the start.
    sketch.duration_s = 1.0;
    let reference: Arc<dyn Reference> = Arc::new(Cold);
    for kind in even() {
        let result = march::run(&sketch.scene(kind), kind.name, Some(&reference), &Options::default()).expect("a run");
        let error = last(&result, "front_shape.csv", "temperature_rms_rel")[0].expect("an error");
        assert!((error - 1.0).abs() < 0.01, "{}: {error}", kind.name);
    }
}

/// Half of a body has half of the area and of the length, and the same distances.
#[test]
fn a_part_of_a_plane_tells_of_all_of_it() {
    let walls = ["left", "right", "bottom", "top"];
    let mut sketch = Sketch::new(Domain::Rectangle { width: 0.2, height: 0.12 }, 0.01);
    for wall in walls {
        sketch = sketch.wall(wall, COLD);
    }
    sketch.watch = "isotherms_c = [-2, 1]".into();
    for kind in even() {
        let scene = sketch.scene(kind);
        let Finding::Smaller(reduction) = reduce::find(&scene, kind.name, None).expect("a plan") else {
            unreachable!("a symmetric body is made smaller")
        };
        let (own, other) = (sketch.run(kind), reduction.run(None, &Options::default()).expect("a run"));
        let rows = |result: &RunResult| -> Vec<Vec<Option<f64>>> {
            ["isotherms.csv", "front_shape.csv"].iter().flat_map(|file| table(result, file).rows.clone()).collect()
        };
        for (row, found) in rows(&own).iter().zip(&rows(&other)) {
            for (a, b) in row.iter().zip(found) {
                // Sums in another order.
                assert!(a.is_some() == b.is_some(), "{}: {row:?} {found:?}", kind.name);
                assert!(a.zip(*b).is_none_or(|(a, b)| (a - b).abs() < 1e-9), "{}: {row:?} {found:?}", kind.name);
            }
        }
    }
}

#[test]
fn methods_of_moving_particles_have_isotherms_too() {
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        let mut sketch = Sketch::new(Domain::Rectangle { width: 0.2, height: 0.12 }, 0.01).wall("left", COLD);
        sketch = sketch.wall("bottom", COLD);
        sketch.watch = "isotherms_c = [0]".into();
        let colder = last(&sketch.run(kind), "isotherms.csv", "colder_m2")[0];
        assert!(colder.is_some_and(|area| area > 0.0 && area < 0.024), "{}: {colder:?}", kind.name);
    }
}
