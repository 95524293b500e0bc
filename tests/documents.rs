//! The documents say what is so: their scenes are good, their commands are understood, their links lead somewhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use frazil_core::physics::film::FILMS;
use frazil_core::physics::freezing_curve::CURVES;
use frazil_core::physics::freezing_curve::shape::Parameter;
use frazil_scene::Scene;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()))
}

/// All documents for people, by path.
fn documents() -> Vec<(PathBuf, String)> {
    let in_folder = |folder: PathBuf| {
        let entries = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path());
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect::<Vec<_>>()
    };
    let folders = [root().to_owned(), root().join("docs"), root().join("docs/guide"), root().join("docs/theory")];
    let mut paths: Vec<PathBuf> = folders.into_iter().flat_map(in_folder).collect();
    paths.sort();
    assert!(paths.len() > 6, "{paths:?}");
    paths.into_iter().map(|path| (path.clone(), read(&path))).collect()
}

/// All pages of the guide.
pub fn guide() -> String {
    documents()
        .into_iter()
        .filter(|(path, _)| path.starts_with(root().join("docs/guide")))
        .map(|(_, text)| text)
        .collect()
}

/// Fenced blocks of a language.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    text.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap_or_default()).collect()
}

/// Words in back-quotes, outside fenced blocks.
fn quoted(text: &str) -> BTreeSet<&str> {
    let prose = text.split("```").step_by(2);
    prose.flat_map(|part| part.split('`').skip(1).step_by(2)).collect()
}

#[test]
fn every_scene_in_the_documents_is_good() {
    let mut count = 0;
    for (path, text) in documents() {
        for block in blocks(&text, "toml") {
            let name = path.display().to_string();
            if let Err(problems) = Scene::read(block, "example", &name, &[], frazil::registry::methods()) {
                unreachable!("{problems}");
            }
            count += 1;
        }
    }
    assert!(count >= 2);
}

#[test]
fn every_command_in_the_documents_is_understood() {
    let mut count = 0;
    for (path, text) in documents() {
        let lines = blocks(&text, "sh").concat().replace("\\\n", " ");
        let inline = quoted(&text).into_iter().filter(|words| words.starts_with("frazil ")).map(str::to_owned);
        for line in lines.lines().map(str::to_owned).chain(inline) {
            let line = line.split(" #").next().unwrap_or_default().trim().replace("SCENE...", "SCENE");
            let Some(arguments) =
                line.strip_prefix("cargo run --release --").or_else(|| line.strip_prefix("frazil ")).map(str::trim)
            else {
                continue;
            };
            // Commands named alone, as `frazil run`, stand for themselves.
            if arguments.is_empty() || !arguments.contains(' ') && arguments != "list" {
                continue;
            }
            let words = std::iter::once("frazil").chain(arguments.split_whitespace());
            if let Err(error) = frazil::cli::understood(words) {
                unreachable!("{}: {line}: {error}", path.display());
            }
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

/// Overrides in commands name keys that exist, and values that are allowed.
#[test]
fn every_override_in_the_documents_is_good() {
    let mut count = 0;
    for (path, text) in documents() {
        for line in blocks(&text, "sh").concat().replace("\\\n", " ").lines().chain(quoted(&text)) {
            let mut words = line.split(" #").next().unwrap_or_default().split_whitespace();
            let (Some("frazil"), Some("run" | "check"), Some(scene)) = (words.next(), words.next(), words.next())
            else {
                continue;
            };
            let Some(bundled) = frazil_cases::scenes::find(scene) else { continue };
            let words: Vec<&str> = words.collect();
            for method in if line.contains(" M ") { &["local", "sph", "pd"][..] } else { &[""] } {
                let overrides: Vec<(String, String)> = words
                    .windows(2)
                    .filter(|pair| pair[0] == "--set")
                    .filter_map(|pair| pair[1].split_once('='))
                    .map(|(key, value)| (key.replace(".M.", &format!(".{method}.")), value.to_owned()))
                    .collect();
                let kinds = frazil::registry::methods();
                if let Err(problems) = Scene::read(bundled, scene, scene, &overrides, kinds) {
                    unreachable!("{}: {line}: {problems}", path.display());
                }
                count += 1;
            }
        }
    }
    assert!(count > 20, "{count}");
}

/// What the tutorial has saved is saved, what it runs is run, what it shows is printed, and the results that it names are there.
#[test]
fn the_tutorial_holds_what_it_says() {
    let text = read(&root().join("docs/tutorial.md"));
    let folder = tempfile::tempdir().expect("a folder");
    let (mut prose, mut told, mut commands) = ("", String::new(), 0);
    let mut parts = text.split("```");
    while let (Some(before), Some((language, block))) =
        (parts.next(), parts.next().and_then(|block| block.split_once('\n')))
    {
        prose = if before.trim().is_empty() { prose } else { before };
        match language {
            "toml" => {
                let name = prose.rsplit('`').nth(1).expect("the name of a file");
                fs::write(folder.path().join(name), block).expect("written");
            }
            "sh" => {
                for arguments in block.lines().filter_map(|line| line.strip_prefix("frazil ")) {
                    let done;
                    (done, told) = ran(folder.path(), arguments);
                    assert!(done, "{arguments}: {told}");
                    commands += 1;
                }
            }
            _ if prose.contains("in place of `length_m`") => {
                let path = folder.path().join("pond.toml");
                let good = read(&path);
                fs::write(&path, good.replace("length_m", "lenght_m")).expect("written");
                assert!(ran(folder.path(), "check pond.toml").1.contains(block.trim()), "{block}");
                fs::write(&path, good).expect("written");
            }
            _ => block.lines().for_each(|line| assert!(told.contains(line), "{line}\nis not in\n{told}")),
        }
    }
    assert_eq!(commands, 6);
    let results = quoted(&text).into_iter().filter(|name| name.starts_with("out/"));
    let missing: Vec<&str> = results.filter(|name| !folder.path().join(name).exists()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// Whether a command succeeds in a folder, and all that it prints.
fn ran(folder: &Path, arguments: &str) -> (bool, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    let output = command.current_dir(folder).args(arguments.split_whitespace()).output().expect("it runs");
    let told = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8_lossy(&told).into_owned())
}

#[test]
fn every_link_in_the_documents_leads_somewhere() {
    let mut count = 0;
    for (path, text) in documents() {
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if target.contains("://") {
                continue;
            }
            let (file, heading) = target.split_once('#').map_or((target, None), |(file, part)| (file, Some(part)));
            let folder = path.parent().expect("a folder");
            let file = if file.is_empty() { path.clone() } else { folder.join(file) };
            assert!(file.exists(), "{}: {target}", path.display());
            if let Some(heading) = heading {
                let found = read(&file).lines().any(|line| line.starts_with('#') && anchor(line) == heading);
                assert!(found, "{}: {target} names no heading", path.display());
            }
            count += 1;
        }
    }
    assert!(count > 15, "{count}");
}

/// The anchor that pages make of a heading.
fn anchor(line: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    line.trim_start_matches('#').trim().to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")
}

/// Paths of the program that documents name are there.
#[test]
fn every_path_in_the_documents_is_there() {
    let folders = ["src/", "methods/", "cases/", "plots/", "tests/", "benches/", "docs/"];
    for (path, text) in documents().into_iter().filter(|(path, _)| !path.ends_with("CHANGELOG.md")) {
        for name in quoted(&text).into_iter().filter(|name| folders.iter().any(|folder| name.starts_with(folder))) {
            // Names with a blank for one of many stand for themselves.
            let is_one = !name.contains(|c: char| c.is_ascii_uppercase() || c == '*' || c == ' ');
            assert!(!is_one || name.contains("gauss") || root().join(name).exists(), "{}: {name}", path.display());
        }
    }
}

/// Seams have the functions that the architecture says.
#[test]
fn seams_are_as_the_architecture_says() {
    let text = read(&root().join("docs/architecture.md"));
    let blocks = blocks(&text, "rust seam").concat();
    let mut count = 0;
    for line in blocks.lines() {
        let (name, functions) = line.split_once(" { ").expect("a trait and its functions");
        let declared = format!("pub {name}");
        let is_here =
            |source: &String| source.contains(&format!("{declared}:")) || source.contains(&format!("{declared} "));
        let files = quoted(&text).into_iter().filter(|name| name.ends_with(".rs")).map(|name| read(&root().join(name)));
        let source = files.into_iter().find(is_here).unwrap_or_else(|| unreachable!("{name} stands in no file named"));
        let body = source.split_once(&declared).map_or("", |(_, rest)| rest.split("\n}").next().unwrap_or_default());
        let found: Vec<&str> =
            body.split("\n    fn ").skip(1).filter_map(|rest| rest.split(['(', '<']).next()).collect();
        assert_eq!(found.join(", "), functions.trim_end_matches(" }"), "{name}");
        count += 1;
    }
    assert!(count > 5, "{count}");
}

#[test]
fn every_method_is_in_the_readme_and_its_keys_are_in_the_guide() {
    let (readme, guide) = (read(&root().join("README.md")), guide());
    let (in_readme, in_guide) = (quoted(&readme), quoted(&guide));
    // The record's names of settings that are not keys of the file.
    let derived = ["step", "spacing"];
    let scene = frazil_cases::scenes::find("frozen-wall-sand").expect("bundled");
    let scene = Scene::read(scene, scene.name, scene.name, &[], frazil::registry::methods());
    let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
    for settings in &scene.methods {
        assert!(in_readme.contains(settings.method), "{}", settings.method);
        for key in settings.values().keys().filter(|key| !derived.contains(&key.as_str())) {
            assert!(in_guide.contains(key.as_str()), "{}: {key}", settings.method);
        }
    }
}

/// A key that a section asks for stands in quotes as `("spacing", "m")` or after a call that reads it.
#[test]
fn every_key_that_the_reader_asks_for_is_in_the_guide() {
    let guide = guide();
    let words: BTreeSet<&str> = quoted(&guide)
        .into_iter()
        .chain(blocks(&guide, "toml"))
        .flat_map(|text| text.split(|c: char| !(c.is_alphanumeric() || c == '_')))
        .collect();
    let folder = root().join("src/scene/read");
    let methods = frazil::registry::methods().iter().map(|kind| root().join("methods").join(kind.name).join("lib.rs"));
    let files = [
        "body.rs",
        "cracks.rs",
        "flow.rs",
        "ground.rs",
        "numerics.rs",
        "porous.rs",
        "regions.rs",
        "shells.rs",
        "watch.rs",
    ]
    .map(|name| folder.join(name));
    let mut count = 0;
    let fluids = [root().join("src/calibrate/fluid.rs")];
    for file in files.into_iter().chain(methods).chain(fluids) {
        let text = read(&file);
        for (key, unit) in keys(&text) {
            let written = match unit {
                Some(unit) => format!("{key}_{unit}"),
                None => key.to_owned(),
            };
            let times = ["s", "h", "days"].map(|unit| format!("{key}_{unit}"));
            let known = words.contains(written.as_str()) || times.iter().all(|time| words.contains(time.as_str()));
            assert!(known, "{}: {written}", file.display());
            count += 1;
        }
    }
    let curves = CURVES.iter().flat_map(|kind| kind.parameters).map(Parameter::key);
    let films = FILMS.iter().map(|kind| kind.key());
    for (key, unit) in curves.chain(films) {
        let written = if unit.is_empty() { key.to_owned() } else { format!("{key}_{unit}") };
        assert!(words.contains(written.as_str()), "{written}");
    }
    assert!(count > 50, "{count}");
}

/// Keys and units in the text of a reader: first arguments of its calls, and pairs of words.
fn keys(text: &str) -> Vec<(&str, Option<&str>)> {
    let calls = [
        "section(",
        "sections(",
        "text(",
        "number(",
        "number_or(",
        "positive(",
        "choice(",
        "choice_or(",
        "integer(",
        "integer_or(",
        "flag_or(",
        "optional_flag(",
        "optional_choice(",
        "duration(",
        "times(",
        "optional_number(",
    ];
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let mut found = Vec::new();
    for call in calls {
        for rest in code.split(&format!(".{call}")).skip(1) {
            if let Some(key) = rest.trim_start().strip_prefix('"').and_then(|rest| rest.split('"').next()) {
                found.push((key, None));
            }
        }
    }
    for rest in code.split("(\"").skip(1) {
        let mut parts = rest.split('"');
        if let (Some(key), Some(", "), Some(unit), Some(end)) = (parts.next(), parts.next(), parts.next(), parts.next())
            && end.starts_with(')')
            && key.chars().all(|c| c.is_ascii_lowercase() || c == '_')
            && unit.chars().all(|c| c.is_alphanumeric() || c == '_')
        {
            found.push((key, Some(unit)));
        }
    }
    found
}

/// Files that count lists from 0 and name the second ring mean the first now, which no message can tell: the guide and the changes do.
#[test]
fn what_older_files_mean_now_is_told() {
    for (name, text) in [("the guide", guide()), ("CHANGELOG.md", read(&root().join("CHANGELOG.md")))] {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let told = "`pipes.1.KEY` was a key of the second ring and is now one of the first";
        assert!(text.contains(told), "{name}");
    }
}

/// Commands of the README that take more than ten minutes, or nearly, say so beside them, and that longer ones warn of it.
#[test]
fn commands_of_the_readme_that_take_long_say_so() {
    let readme = read(&root().join("README.md"));
    assert!(readme.contains("more than ten\nminutes on your machine says so before it starts"));
    let lines = blocks(&readme, "sh").concat();
    let long =
        ["layout shaft-strata --method all", "layout shaft-seepage", "compare stefan-water frozen", "cargo test"];
    for command in long {
        let line = lines.lines().find(|line| line.contains(command)).expect("the command");
        assert!(line.split_once('#').is_some_and(|(_, words)| words.contains(" min")), "{line}");
    }
}
