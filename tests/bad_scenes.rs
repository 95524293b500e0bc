//! Every bad scene of `cases/bad` is refused with exactly the messages that it carries on its lines `#^ `.

use std::fs;
use std::path::Path;

use frazil_scene::Scene;

#[test]
fn bad_scenes_are_refused_with_their_messages() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/bad");
    let mut paths: Vec<_> =
        fs::read_dir(&folder).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert!(paths.len() >= 40, "found only {} bad scenes", paths.len());
    let mut wrong = Vec::new();
    for path in &paths {
        let file = path.file_name().and_then(|name| name.to_str()).expect("a name");
        let text = fs::read_to_string(path).expect("the text");
        let expected: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("#^ ")).collect();
        let found = match Scene::read(&text, "bad", file, &[], frazil::registry::methods()) {
            Ok(_) => "no problem".to_owned(),
            Err(problems) => problems.to_string(),
        };
        if found != expected.join("\n") {
            wrong.push(format!("=== {file}\n{found}"));
        }
    }
    assert!(wrong.is_empty(), "these messages are not the expected ones:\n{}", wrong.join("\n"));
}
