//! Text that means harm: files of any bytes, names that lead elsewhere, titles that are scripts, cells that are formulas.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A command ends so soon on any file.
const SOON: Duration = Duration::from_secs(2);

const TITLE: &str = "<script>alert(1)</script> & \\\"><img src=x onerror=alert(1)>";

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frazil")).args(arguments).current_dir(folder).output().expect("the program starts")
}

/// What a command says that ends soon: at the third attempt, where other work keeps the machine busy.
fn soon(folder: &Path, arguments: &[&str]) -> Output {
    let timed = || {
        let began = Instant::now();
        (frazil(folder, arguments), began.elapsed())
    };
    let attempts = std::iter::repeat_with(timed).take(3);
    let first = attempts.into_iter().find(|(_, took)| *took < SOON);
    first.unwrap_or_else(|| unreachable!("{arguments:?} takes longer than {SOON:?}")).0
}

fn done(folder: &Path, arguments: &[&str]) {
    let output = frazil(folder, arguments);
    assert!(output.status.success(), "{arguments:?} {output:?}");
}

fn bundled(name: &str) -> &'static str {
    frazil_cases::scenes::find(name).expect("bundled").text
}

/// Whether all that is printed can be seen, and leaves the terminal as it is.
fn seen(output: &Output) {
    for bytes in [&output.stdout, &output.stderr] {
        let text = str::from_utf8(bytes).expect("text");
        assert!(text.chars().all(|letter| letter == '\n' || !frazil_record::is_hidden(letter)), "{text:?}");
    }
}

fn deep(count: usize) -> Vec<(&'static str, String)> {
    let lines = |line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<Vec<_>>().join("\n");
    vec![
        ("lists", format!("a = {}{}", "[".repeat(count), "]".repeat(count))),
        ("open-lists", format!("a = {}", "[".repeat(count))),
        ("tables", format!("a = {}1{}", "{a=".repeat(count), "}".repeat(count))),
        ("dots", format!("{} = 1", vec!["a"; count].join("."))),
        ("head", format!("title = 1\n[{}]", vec!["a"; count].join("."))),
        ("heads", format!("[[{}]]", vec!["a"; count].join("."))),
        ("keys", lines(&|k| format!("k{k} = 1"))),
        ("twice", lines(&|_| "a = 1".into())),
        ("no-keys", lines(&|_| "= 1".into())),
        ("materials", lines(&|k| format!("[materials.m{k}]\nd = 1"))),
        ("pipes", lines(&|_| "[[pipes]]\ncount = 3".into())),
        ("regions", lines(&|_| "[[regions]]\nx_min_m = 1".into())),
        ("long-key", format!("{} = 1", "a".repeat(10 * count))),
        ("long-text", format!("title = {}", "1".repeat(10 * count))),
        ("escapes", "title = \"\u{1b}[2J\"\n\"\\u001b[31m\\u202e\\nbad.toml:1: x\" = 1\n\u{202e} = 1".into()),
        ("hidden", "title = \"a\\u001b[2J\"\nsource = \"\\u202e\"\n[materials.\"\\u2066a\"]".into()),
        ("nothing", "\0".repeat(count)),
    ]
}

#[test]
fn files_of_any_depth_and_bytes_are_refused_soon_with_a_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut files: Vec<(String, Vec<u8>)> =
        deep(50_000).into_iter().map(|(name, text)| (format!("{name}.toml"), text.into_bytes())).collect();
    files.push(("bytes.toml".into(), (0..=255).cycle().take(100_000).collect()));
    files.push(("large.toml".into(), vec![b'#'; 9 << 20]));
    for (name, bytes) in files {
        fs::write(folder.path().join(&name), bytes).expect("written");
        for command in ["check", "layout", "calibrate"] {
            let output = soon(folder.path(), &[command, &name]);
            assert_eq!(output.status.code(), Some(2), "{command} {name}: {output:?}");
            seen(&output);
            let said = String::from_utf8(output.stderr).expect("text");
            assert!(said.len() < 100_000, "{command} {name}: {} letters", said.len());
            for line in said.lines() {
                assert!(line.trim_start_matches('"').starts_with(&name), "{command} {name}: {line}");
            }
        }
    }
}

#[test]
fn options_and_names_of_files_are_shown_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = "a\u{1b}[31m\u{202e}\nb.toml";
    fs::write(folder.path().join(name), "title = 1").expect("written");
    let deep = format!("{}=1", vec!["a"; 10_000].join("."));
    for arguments in [
        &["check", name][..],
        &["run", name],
        &["layout", name],
        &["calibrate", name],
        &["compare", name],
        &["check", "stefan-water", "--set", "a\u{1b}[2J.b=\u{202e}"],
        &["check", "stefan-water", "--set", &deep],
        &["check", "stefan-water", "--set", "title=\u{1b}[2J"],
        &["check", "stefan-water", "--\u{1b}[2J"],
        &["check", "stefan-water", "--method", "\u{1b}[2J"],
        &["check", "no\u{1b}[2Jthing"],
        &["check", "missing\u{1b}[2J.toml"],
        &["layout", "no\u{1b}[2Jthing"],
    ] {
        let output = frazil(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        seen(&output);
    }
    let output = frazil(folder.path(), &["check", name]);
    let said = String::from_utf8(output.stderr).expect("text");
    assert!(said.contains("a\\u{1b}[31m\\u{202e}\\nb.toml:1: title: found 1, must be a text"), "{said}");
}

/// All files below a folder, relative to it.
fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(&next).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.insert(path.strip_prefix(folder).expect("below").to_owned());
            }
        }
    }
    found
}

#[test]
fn results_stay_in_their_folder_whatever_a_file_is_called() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenes = ["...toml", "..toml", "CON.toml", ".hidden.toml", "-rf.toml", "a\\..\\b.toml", "<b>.toml"];
    let quick = ["--method", "local", "--set", "time.duration_h=0.1", "--set", "time.profiles_h=[0.1]"];
    for name in scenes {
        fs::write(folder.path().join(name), bundled("stefan-water")).expect("written");
        let asked = format!("./{name}");
        let output = frazil(folder.path(), &[&["run", &asked], &quick[..]].concat());
        let said = String::from_utf8(output.stderr).expect("text");
        assert!(said.contains("not one of a folder on every system: it is called \""), "{name}: {said}");
    }
    let all = files(folder.path());
    let records: Vec<&PathBuf> = all.iter().filter(|path| path.ends_with("record.json")).collect();
    assert_eq!(records.len(), scenes.len(), "{records:?}");
    for path in &all {
        assert!(path.starts_with("out") || path.components().count() == 1, "{}", path.display());
        let below = path.strip_prefix("out").map_or(0, |path| path.components().count());
        assert!(below == 0 || below == 3, "{}", path.display());
    }
    // Scenes whose results would lie in one folder are refused before the first run.
    for other in ["A", "a"] {
        fs::create_dir(folder.path().join(other)).expect("a folder");
    }
    for (one, other) in [("A/x.toml", "a/x.toml"), ("A/x.toml", "a/X.toml")] {
        fs::write(folder.path().join(one), bundled("stefan-water")).expect("written");
        fs::write(folder.path().join(other), bundled("stefan-water")).expect("written");
        for command in ["compare", "stability"] {
            let output = frazil(folder.path(), &[command, one, other]);
            assert_eq!(output.status.code(), Some(2));
            let said = String::from_utf8(output.stderr).expect("text");
            assert!(said.contains("must be scenes of different names"), "{said}");
        }
    }
}

/// A page without the scripts that are its own to the letter, and without what its chart or plans show, which ends no element.
fn without_its_scripts(page: &str) -> String {
    let mut rest = page.to_owned();
    for own in ["vendor/uplot/uPlot.iife.min.js", "page/chart.js", "page/plan.js", "page/page.js"] {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("plots").join(own)).expect("a script");
        rest = rest.replacen(&format!("<script>{text}</script>"), "", 1);
    }
    for data in ["chart-data", "plan-data"] {
        let data = format!("<script type=\"application/json\" id=\"{data}\">");
        let Some((before, after)) = rest.split_once(&data) else { continue };
        let (shown, after) = after.split_once("</script>").expect("an end");
        assert!(!shown.contains('<') && serde_json::from_str::<serde_json::Value>(shown).is_ok());
        rest = format!("{before}{after}");
    }
    rest
}

/// Whether nothing on a page or in a figure is run, loaded or sent: its elements are known, none of them listens, and links lead
/// to files beside it.
fn harmless(path: &Path) {
    const KNOWN: &str = "a body button caption circle dd defs details dl dt ellipse figcaption figure g h1 h2 h3 head html li line meta nav p path \
                         polygon polyline pre rect section span style summary svg table tbody td text th thead title tr tspan ul div";
    let text = without_its_scripts(&fs::read_to_string(path).expect("text"));
    let known: BTreeSet<&str> = KNOWN.split_whitespace().collect();
    let mut count = 0;
    for tag in text.split('<').skip(1) {
        let (inside, _) = tag.split_once('>').expect("an end");
        let name = inside.trim_start_matches('/').split(|letter: char| !letter.is_ascii_alphanumeric()).next();
        let name = name.unwrap_or_default();
        assert!(known.contains(name) || inside.starts_with("!DOCTYPE"), "{}: <{inside}>", path.display());
        let attributes = inside.to_ascii_lowercase();
        assert!(!attributes.contains(" on") && !attributes.contains(" src"), "{}: <{inside}>", path.display());
        if let Some((_, link)) = inside.split_once("href=\"") {
            assert!(!link.split('"').next().unwrap_or_default().contains(':'), "{}: <{inside}>", path.display());
        }
        count += 1;
    }
    assert!(count > 3, "{}", path.display());
    if path.extension().is_some_and(|ending| ending == "html") {
        let policy = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
                      script-src ";
        assert_eq!(text.matches(policy).count(), 1);
        assert!(text.find(policy) < text.find("<style>"));
        // Nothing but scripts of these hashes may run.
        let (allowed, rest) = text.split_once(policy).and_then(|(_, rest)| rest.split_once(';')).expect("a policy");
        assert!(allowed.split(' ').all(|one| one.starts_with("'sha256-") && one.ends_with('\'')), "{allowed}");
        assert!(rest.starts_with(" base-uri 'none'; form-action 'none'\">"), "{}", path.display());
        assert!(text.contains("&lt;script&gt;alert(1)"), "{}", path.display());
    }
}

#[test]
fn nothing_that_a_scene_says_is_run_by_its_pages_and_figures() {
    let folder = tempfile::tempdir().expect("a folder");
    let named = |name: &str| {
        let title = bundled(name).lines().find(|line| line.starts_with("title")).expect("a title");
        let source = bundled(name).lines().find(|line| line.starts_with("source")).expect("a source");
        let (new, from) = (format!("title = \"{TITLE}\""), format!("source = \"{TITLE}\""));
        bundled(name).replace(title, &new).replace(source, &from)
    };
    let scene = "<script>alert(1)<.toml";
    fs::write(folder.path().join(scene), named("stefan-water")).expect("written");
    fs::write(folder.path().join("noisy.toml"), named("stefan-dpd-1")).expect("written");
    fs::write(folder.path().join("wall.toml"), named("frozen-wall-sand")).expect("written");
    let study = format!(
        "title = \"{TITLE}\"\nsource = \"{TITLE}\"\nscene = \"wall.toml\"\ndepth_m = 50\nset = {{ \"time.duration_days\" = 30, \
         \"time.outputs\" = 3, \"time.profiles_days\" = [15, 30], \"method.local.spacing_m\" = 0.4 }}\n\
         [[layouts]]\nname = \"{TITLE}\"\n[[layouts]]\nname = \"=HYPERLINK(\\\"x\\\", \\\"y\\\")\"\n\
         set = {{ \"pipes.1.temperature_c\" = -30 }}\n[[layouts]]\nname = \"../../../../x\"\n"
    );
    fs::write(folder.path().join("study.toml"), study).expect("written");
    let at = |arguments: &[&str], out: &str| done(folder.path(), &[arguments, &["--quiet", "--out", out]].concat());
    let short = ["--set", "time.duration_h=1", "--set", "time.profiles_h=[1]"];
    at(&[&["run", scene, "--method", "local"], &short[..]].concat(), "o/run");
    at(
        &[&["compare", scene, "--methods", "local,pd", "--levels", "2", "--repeats", "1"], &short[..]].concat(),
        "o/compare",
    );
    at(
        &["compare", scene, "--methods", "pd", "--levels", "1", "--vary", "spacing,horizon_ratio", "--ratios", "2,3"],
        "o/vary",
    );
    at(&["stability", scene, "--axes", "stefan", "--methods", "local", "--values", "3", "--grid", "2"], "o/stability");
    at(&[&["sweep", scene, "--vary", "initial.temperature_c=1,2"], &short[..]].concat(), "o/sweep");
    let ensemble = ["--set", "time.duration=14", "--set", "time.profiles=[7, 14]", "--set", "watch.front_from=5"];
    at(&[&["run", "noisy.toml", "--method", "edpd", "--seeds", "2"], &ensemble[..]].concat(), "o/ensemble");
    at(&["layout", "study.toml", "--method", "local"], "o/layout");
    let all = files(&folder.path().join("o"));
    let ending = |own: &str| all.iter().filter(|path| path.extension().is_some_and(|ending| ending == own)).count();
    assert!(ending("html") >= 4 && ending("svg") >= 20 && ending("csv") >= 20, "{all:?}");
    for path in &all {
        let whole = folder.path().join("o").join(path);
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("html" | "svg") => harmless(&whole),
            Some("csv") => {
                let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(&whole).expect("a table");
                for cell in
                    reader.records().flat_map(|row| row.expect("a row").iter().map(str::to_owned).collect::<Vec<_>>())
                {
                    let begins = cell.starts_with(['=', '+', '-', '@', '\t', '\r']);
                    assert!(!begins || cell.parse::<f64>().is_ok(), "{}: {cell}", path.display());
                }
            }
            _ => {}
        }
    }
    assert!(
        fs::read_to_string(folder.path().join("o/layout/layouts.csv")).expect("a table").contains("\"'=HYPERLINK(")
    );
}
