//! Every bad scene of `cases/bad`, every file of measured points of `cases/bad-measured` and every bad study of `cases/bad-studies` is refused with exactly the messages that it carries
//! on its lines `#^ `.

use std::fs;
use std::path::Path;

use frazil::parts::parts;
use frazil_scene::{Files, Scene, Source};

/// Holds the messages of all files of a folder of `cases` against their own lines.
fn refused_with_their_messages(folder: &str, fewest: usize, read: impl Fn(&str, &str) -> Result<(), String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(folder);
    let mut paths: Vec<_> =
        fs::read_dir(&folder).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert!(paths.len() >= fewest, "found only {} bad files", paths.len());
    let mut wrong = Vec::new();
    for path in &paths {
        let file = path.file_name().and_then(|name| name.to_str()).expect("a name");
        let text = fs::read_to_string(path).expect("the text");
        let expected: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("#^ ")).collect();
        let found = read(&text, file).map_or_else(|problems| problems, |()| "no problem".to_owned());
        if found != expected.join("\n") {
            wrong.push(format!("=== {file}\n{found}"));
        }
    }
    assert!(wrong.is_empty(), "these messages are not the expected ones:\n{}", wrong.join("\n"));
}

#[test]
fn bad_scenes_are_refused_with_their_messages() {
    refused_with_their_messages("bad", 40, |text, file| {
        let read = Scene::read(text, "bad", file, &[], frazil::registry::methods());
        read.map(drop).map_err(|problems| problems.to_string())
    });
}

/// The files are named by the key that names them, and say on a line `# with ` which standard deviation stands beside them.
#[test]
fn bad_measured_points_are_refused_with_their_messages() {
    refused_with_their_messages("bad-measured", 10, |points, file| {
        let key = file.split('-').next().unwrap_or_default();
        let sd =
            points.lines().find_map(|line| line.strip_prefix("# with ")).map_or(String::new(), |sd| format!(", {sd}"));
        let scene = include_str!("../cases/bad/measured-nothing.toml");
        let text = scene.replace(
            "kind = \"measured\"",
            &format!("kind = \"measured\"\nsource = \"a logger\"\n{key} = {{ file = \"{file}\"{sd} }}"),
        );
        let files = Files::held([(file.to_owned(), points.to_owned())]);
        let read = Scene::read(Source { text: &text, files }, "bad", "s.toml", &[], frazil::registry::methods());
        read.map(drop).map_err(|problems| problems.to_string())
    });
}

#[test]
fn bad_studies_are_refused_with_their_messages() {
    refused_with_their_messages("bad-studies", 3, |text, file| {
        let read = frazil_layouts::read::parse(text, "bad", Path::new(file), &[], &parts(false));
        read.map(drop).map_err(|failure| failure.to_string())
    });
}
