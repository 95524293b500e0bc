//! Tables of values in files beside a scene.

use frazil::registry::methods;
use frazil_core::space::domain::Domain;
use frazil_scene::{Files, Scene, Source};
use frazil_simulation::march::{self, Options};

use crate::sketch::{Sketch, steady_material};

/// A file of air, and of a start.
const AIR: &str = "# of a logger\ntime_h,temperature_c\n0,4\n2,-9.5\n5,-20\n";
const START: &str = "y_m,temperature_c\n0,2\n0.5,7\n1,4\n";

fn read(text: &str, files: &[(&str, &str)]) -> Result<Scene, String> {
    let files = files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    let source = Source { text, files: Files::held(files) };
    Scene::read(source, "own", "own.toml", &[], methods()).map_err(|problems| problems.to_string())
}

fn text(wall: &str, start: &str) -> String {
    let mut sketch = Sketch::new(Domain::Rectangle { width: 0.2, height: 1.0 }, 0.1)
        .wall("bottom", format!("temperature_c = {wall}"));
    sketch.materials = vec![("ground", steady_material())];
    sketch.initial_along = start.into();
    sketch.text("pd")
}

#[test]
fn tables_of_files_are_those_of_the_scene() {
    for period in ["", ", period_h = 8"] {
        let inline = text(
            &format!("{{ times_h = [0, 2, 5], values = [4, -9.5, -20]{period} }}"),
            "{ y_m = [0, 0.5, 1], values = [2, 7, 4] }",
        );
        let named = text(&format!("{{ file = \"air.csv\"{period} }}"), "{ file = \"data/start.csv\" }");
        let files = [("air.csv", AIR), ("data/start.csv", START)];
        let hash = |scene: Result<Scene, String>| {
            let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
            march::run(&scene, "pd", None, &Options::default()).expect("a run").record.state_hash
        };
        assert_eq!(hash(read(&inline, &[])), hash(read(&named, &files)), "{period}");
    }
}

#[test]
fn what_is_wrong_with_a_file_is_said_by_its_line_and_column() {
    let plain = "{ y_m = [0, 1], values = [2, 7] }";
    let air = |wall: &str, file: &str| read(&text(wall, plain), &[("air.csv", file)]).err().unwrap_or_default();
    let named = "{ file = \"air.csv\" }";
    assert_eq!(air(named, AIR), "");
    for (file, words) in [
        ("time_h,temperature_c\n0,4\n3,5\n3,6\n", "air.csv:4: time_h: found 3, must be greater than in the row before"),
        ("time_h,temperature_c\n0,4\n1,warm\n", "air.csv:3: temperature_c: found \"warm\", must be a number"),
        ("time_h,temperature_c\n0,-300\n", "air.csv:2: temperature_c: found -300"),
        ("time_h,temperature_k\n0,270\n", "air.csv:2: temperature_k"),
        ("temperature_c\n4\n", "air.csv:2: time: missing"),
        ("time_h,temperature_c,sun\n0,4,1\n", "air.csv:2: sun: unknown key"),
        ("time_h,temperature_c\n0,4\n1\n", "found a row of 1 cells"),
        ("time_h,temperature_c\n", "air.csv: found no rows"),
    ] {
        let found = air(named, file);
        assert!(found.contains(words), "{file}: {found}");
    }
    let found = air("{ file = \"air.csv\", period_h = 3 }", AIR);
    assert!(found.contains("file: found an end at 5 h, must end within the period, 3 h"), "{found}");
    let found = air("{ file = \"air.csv\", values = [1] }", AIR);
    assert!(found.contains("values: has no effect, values are those of the file"), "{found}");
    let found = air("{ file = \"air.csv\", times_h = [1] }", AIR);
    assert!(found.contains("times_h: has no effect, times are those of the file"), "{found}");
    let found = air("{ file = \"wind.csv\" }", AIR);
    assert!(
        found.contains("walls.bottom.temperature_c.file: found \"wind.csv\", must be a file beside the scene"),
        "{found}"
    );
    let found = air("{ fil = \"air.csv\" }", AIR);
    assert!(found.contains("did you mean \"file\""), "{found}");
    let start =
        |file: &str| read(&text("-5", "{ file = \"start.csv\" }"), &[("start.csv", file)]).err().unwrap_or_default();
    assert_eq!(start(START), "");
    for (file, words) in [
        ("y_m,temperature_c\n0,4\n", "initial.temperature_c: found fewer than two places"),
        ("y_m,temperature_c\n1,4\n0,4\n", "start.csv:3: y_m: found 0, must be greater than in the row before"),
        ("depth_m,temperature_c\n1,4\n0,4\n", "start.csv:2: depth_m: unknown key"),
    ] {
        let found = start(file);
        assert!(found.contains(words), "{file}: {found}");
    }
}
