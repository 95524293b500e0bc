//! Whole states, frames and pictures on request: what is there can be read, and a folder never mixes two runs.

use std::fs;
use std::path::Path;

use frazil::run::{RunRequest, run};
use frazil_core::space::domain::Domain;
use frazil_plots::canvas::Formats;
use vtkio::Vtk;
use vtkio::model::{Attribute, DataSet, IOBuffer, Piece};

use crate::sketch::Sketch;

fn request(scene: &Path, out: &Path, fields: bool, frames: bool) -> RunRequest {
    RunRequest {
        scene: scene.display().to_string(),
        method: None,
        overrides: Vec::new(),
        threads: 1,
        seed: 1,
        out: Some(out.to_owned()),
        reduce: false,
        estimated: None,
        fields,
        frames,
        formats: if fields { Formats::ALL } else { Formats::SVG },
        checkpoints: None,
        resume: false,
        quiet: true,
        json: false,
        command_line: String::new(),
        yes: false,
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").file_name());
    let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Names of figures in a folder without their ending.
fn figures(folder: &Path, ending: &str) -> Vec<String> {
    names(folder).iter().filter_map(|name| Some(name.strip_suffix(ending)?.to_owned())).collect()
}

/// Columns of a state by name, as numbers.
fn columns(path: &Path) -> Vec<(String, Vec<f64>)> {
    let vtk = Vtk::import(path).expect("a state");
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { unreachable!("particles are points") };
    let Some(Piece::Inline(piece)) = pieces.into_iter().next() else { unreachable!("one piece") };
    let count = piece.num_points();
    let column = |attribute: Attribute| match attribute {
        Attribute::DataArray(array) => {
            let values = match array.data {
                IOBuffer::F64(values) => values,
                IOBuffer::I32(values) => values.into_iter().map(f64::from).collect(),
                other => unreachable!("{other:?}"),
            };
            assert_eq!(values.len(), count, "{}", array.name);
            (array.name, values)
        }
        Attribute::Field { .. } => unreachable!("columns alone"),
    };
    piece.data.point.into_iter().map(column).collect()
}

#[test]
fn states_frames_and_pictures_are_whole_and_gone_when_not_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    let mut sketch = Sketch::new(Domain::Rectangle { width: 0.6, height: 0.4 }, 0.1).wall("left", "temperature_c = -5");
    sketch.regions = vec!["temperature_c = -2\ncircle = { x_m = 0.3, y_m = 0.2, radius_m = 0.1 }".to_owned()];
    sketch.outputs = 3;
    for integrator in ["", "integrator = \"implicit\"\n"] {
        sketch.numerics = integrator.to_owned();
        fs::write(&scene, sketch.text("pd")).expect("written");
        run(&request(&scene, &out, true, true)).expect("a run");
        // The start and every output.
        let states: Vec<String> = (0..4).map(|k| format!("{k:05}.vtu")).collect();
        assert_eq!(names(&out.join("fields")), states);
        let stems = figures(&out, "svg");
        // The movie of the frames is a PNG, too.
        let pictures: Vec<String> = figures(&out, "png").into_iter().filter(|stem| stem != "movie.").collect();
        assert!(stems.len() > 1 && pictures == stems, "{stems:?}");
        assert!(out.join("movie.png").is_file());
        assert_eq!(names(&out.join("frames")), (0..4).map(|k| format!("{k:05}.png")).collect::<Vec<_>>());
        let list = fs::read_to_string(out.join("fields.pvd")).expect("the list");
        for (state, time) in states.iter().zip([0, 1200, 2400, 3600]) {
            assert!(list.contains(&format!("timestep=\"{time}\" part=\"0\" file=\"fields/{state}\"")), "{list}");
        }
        let columns_of = |k: usize| columns(&out.join("fields").join(&states[k]));
        let wanted = ["temperature_c", "frozen_fraction", "enthalpy_J_per_m3", "volume", "material"];
        let heat = |k: usize| {
            let found = columns_of(k);
            assert_eq!(found.iter().map(|column| column.0.as_str()).collect::<Vec<_>>(), wanted);
            let products = found[2].1.iter().zip(&found[3].1).map(|(enthalpy, volume)| enthalpy * volume);
            products.sum::<f64>()
        };
        // What the budget says was taken up since the start, to the rounding of the sums.
        let budget = fs::read_to_string(out.join("budget.csv")).expect("the budget");
        let last = budget.lines().last().expect("a row").split(',').nth(1).expect("a column");
        let stored: f64 = last.parse().expect("a number");
        assert!((heat(3) - heat(0) - stored).abs() < 1e-9 * stored.abs(), "{} {stored}", heat(3) - heat(0));
        assert!(columns_of(0)[0].1.contains(&3.0));
    }
    run(&request(&scene, &out, false, false)).expect("a run");
    let left = names(&out);
    assert!(left.contains(&"record.json".to_owned()));
    assert!(
        !left.iter().any(|name| name.contains("fields") || name.contains("frames") || name.contains("movie")),
        "{left:?}"
    );
    assert!(figures(&out, "svg").len() > 1 && figures(&out, "png").is_empty(), "{left:?}");
}

#[test]
fn frames_of_a_line_are_refused_and_leave_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    fs::write(&scene, Sketch::new(Domain::Line { length: 1.0 }, 0.1).text("pd")).expect("written");
    let refused = run(&request(&scene, &out, false, true)).map(|_| ()).map_err(|failure| failure.to_string());
    assert_eq!(refused, Err("--frames draws planes, but the domain of `scene` is a line".to_owned()));
    assert!(!out.exists());
}
