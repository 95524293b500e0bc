//! Where profiles stand, and what is called a front.

use std::sync::Arc;

use frazil_core::space::domain::{Domain, Sector};
use frazil_record::{MeanOver, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{self, Options};
use frazil_simulation::reference::Reference;

use crate::sketch::{SHARP, Sketch, even, sand};

const COLD: &str = "temperature_c = -10";

fn planes(result: &RunResult) -> Vec<&str> {
    let mut names: Vec<&str> = result.profiles.iter().map(|row| row.plane.as_str()).collect();
    names.dedup();
    names
}

/// Profiles are in coordinates of the scene, wherever the cold wall is: a probe at a point of one reads what it does.
#[test]
fn profiles_stand_where_the_scene_has_them() {
    let long = |wall: &'static str, domain: Domain| Sketch::new(domain, 0.01).wall(wall, COLD);
    let line = Domain::Line { length: 0.2 };
    let plane = Domain::Rectangle { width: 0.2, height: 0.2 };
    for kind in even() {
        for (wall, domain) in
            [("left", line), ("right", line), ("left", plane), ("right", plane), ("bottom", plane), ("top", plane)]
        {
            let mut sketch = long(wall, domain);
            sketch.duration_s = 12.0 * 3600.0;
            let along_y = matches!(wall, "bottom" | "top");
            let probe = if domain == line {
                "[[0.165]]"
            } else if along_y {
                "[[0.105, 0.165]]"
            } else {
                "[[0.165, 0.105]]"
            };
            sketch.watch = format!("probes_m = {probe}");
            let result = sketch.run(kind);
            let row = result.profiles.iter().find(|row| (row.along_m - 0.165).abs() < 1e-9).expect("a row");
            let probe = result.probes.last().expect("a probe");
            assert!((row.temperature_c - probe.temperature_c).abs() < 1e-12, "{} {wall}: {row:?} {probe:?}", kind.name);
            let (x, y, mean) = match (domain == line, along_y) {
                (true, _) => (Some(row.along_m), None, None),
                (false, false) => (Some(row.along_m), None, Some(MeanOver::Y)),
                (false, true) => (None, Some(row.along_m), Some(MeanOver::X)),
            };
            assert_eq!((row.x_m, row.y_m, row.mean_over), (x, y, mean), "{} {wall}", kind.name);
            let coldest = result.profiles.iter().min_by(|a, b| a.temperature_c.total_cmp(&b.temperature_c));
            let near = if matches!(wall, "right" | "top") { 0.195 } else { 0.005 };
            assert!((coldest.expect("rows").along_m - near).abs() < 1e-9, "{} {wall}: {coldest:?}", kind.name);
        }
    }
}

/// A half space that freezes from the right is as far from its closed form as one that freezes from the left, along
/// the body and along a cut.
#[test]
fn errors_do_not_depend_on_the_side_of_the_cold_wall() {
    let text = |near: &str, far: &str| {
        format!(
            "title = \"t\"\nsource = \"s\"\n[domain.rectangle]\nwidth_m = 0.4\nheight_m = 0.05\n[time]\nduration_h = 24\n\
             [materials]\nsand = {}\n[initial]\ntemperature_c = 3\n[walls.{near}]\ntemperature_c = -10\n\
             [walls.{far}]\ncondition = \"exact\"\n[walls.bottom]\ncondition = \"symmetry\"\n[walls.top]\n\
             condition = \"symmetry\"\n[watch]\nprofile_length_m = 0.3\ncuts_y_m = [0.023]\n[reference]\nkind = \"exact\"\n",
            sand(SHARP)
        )
    };
    for kind in even() {
        let errors = |near: &str, far: &str| {
            let text = format!("{}[method.{}]\nspacing_m = 0.01\n", text(near, far), kind.name);
            let scene = Scene::read(&text, "t", "t", &[], &[kind]).expect("a scene");
            let reference: Arc<dyn Reference> =
                frazil_cases::truth(&scene).expect("a reference").reference.map(Arc::from).expect("one");
            let result = march::run(&scene, kind.name, Some(&reference), &Options::default()).expect("a run");
            assert_eq!(planes(&result), ["line", "y=0.023"]);
            assert!(result.profiles.iter().all(|row| row.temperature_ref_c.is_some()));
            let errors = result.record.errors;
            let all = [errors.temperature_rms_rel, errors.temperature_max_rel, errors.front_rms_rel];
            all.map(|error| error.expect("an error"))
        };
        let (left, right) = (errors("left", "right"), errors("right", "left"));
        for (left, right) in left.into_iter().zip(right) {
            assert!((left - right).abs() < 1e-9, "{}: {left} from the left, {right} from the right", kind.name);
            assert!(left < 0.05, "{}: {left}", kind.name);
        }
    }
}

/// Where something varies across, there is no front, but a frozen volume; profiles run where the scene says, or through the
/// middle, and are no means.
#[test]
fn a_plane_without_a_front_line_has_none() {
    let plane = || Sketch::new(Domain::Rectangle { width: 0.2, height: 0.1 }, 0.01);
    let circle = || "temperature_c = -5\ncircle = { x_m = 0.1, y_m = 0.05, radius_m = 0.03 }".to_owned();
    let mut block = plane();
    block.regions = vec![circle()];
    let mut cracked = plane().wall("left", COLD);
    cracked.cracks = vec!["from_m = [0.05, 0.02]\nto_m = [0.05, 0.07]".into()];
    let cornered = plane().wall("left", COLD).wall("bottom", COLD);
    for kind in even() {
        for sketch in [&block, &cracked, &cornered] {
            let result = sketch.run(kind);
            assert!(result.front.is_empty() && !result.frozen.is_empty(), "{}", kind.name);
            assert_eq!(planes(&result), ["y=0.05", "x=0.1"]);
            assert!(result.profiles.iter().all(|row| row.mean_over.is_none()));
        }
        let mut named = block.clone();
        named.watch = "cuts_x_m = [0.035, 0.1]".into();
        let result = named.run(kind);
        assert_eq!(planes(&result), ["x=0.035", "x=0.1"]);
        let rows: Vec<_> = result.profiles.iter().filter(|row| row.plane == "x=0.035").collect();
        assert!(rows.iter().all(|row| row.x_m == Some(0.035) && row.y_m == Some(row.along_m)) && rows.len() == 10);

        // Layers across are no reason to lose the front.
        let mut layers = plane().wall("left", COLD);
        layers.regions = vec!["temperature_c = 6\nx_min_m = 0.1\nx_max_m = 0.15\ny_min_m = 0\ny_max_m = 0.1".into()];
        assert!(!layers.run(kind).front.is_empty(), "{}", kind.name);
    }
}

/// The frozen volume of a plane is that of all its particles.
#[test]
fn the_frozen_volume_of_a_block_is_that_of_its_ice() {
    for kind in even() {
        let mut sketch = Sketch::new(Domain::Rectangle { width: 0.2, height: 0.2 }, 0.005);
        sketch.initial_c = -5.0;
        sketch.regions = vec!["temperature_c = 1\nx_min_m = 0\nx_max_m = 0.1\ny_min_m = 0\ny_max_m = 0.1".into()];
        sketch.duration_s = 1.0;
        let rows = sketch.run(kind).frozen;
        // Water at its freezing point gives no more than 5 K of the ice beside it away in a second.
        assert!(rows.iter().all(|row| (row.frozen_volume - 0.03).abs() < 1e-4), "{}: {rows:?}", kind.name);
    }
}

/// Cuts of a ring end at its wall, and at the face of its shaft.
#[test]
fn cuts_of_a_ring_stay_in_its_ground() {
    for kind in even() {
        for (sector, cuts, count) in
            [(Sector::Whole, "cuts_y_m = [0.25]", 2), (Sector::Quarter, "cuts_x_m = [0.25]", 1)]
        {
            let mut sketch = Sketch::new(Domain::Ring { outer_radius: 2.0, sector }, 0.1).wall("outer", COLD);
            sketch.watch = cuts.into();
            let whole = sketch.run(kind);
            let reach = whole.profiles.iter().map(|row| row.along_m.abs()).fold(0.0, f64::max);
            assert!(reach > 1.7 && reach < 2.0, "{}: {reach}", kind.name);
            sketch.excavation = "radius_m = 0.8\nstart_s = 0\ncondition = \"symmetry\"".into();
            let dug = sketch.run(kind);
            let radius = |row: &frazil_record::ProfileRow| row.x_m.expect("x").hypot(row.y_m.expect("y"));
            assert!(dug.profiles.iter().all(|row| radius(row) > 0.79), "{}", kind.name);
            // A chord of a circle of 0.8 m, a quarter of a metre from its centre.
            let lost = whole.profiles.len() - dug.profiles.len();
            assert!(lost.abs_diff(count * 8) <= count, "{}: {lost}", kind.name);
        }
    }
}
