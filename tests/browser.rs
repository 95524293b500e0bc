//! Pages as a browser shows them: the interactive chart, sorted tables, dark, narrow, and without scripts. Where no Chromium is installed
//! the tests say so and check nothing.

mod devtools;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use devtools::Browser;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A browser, or a word that there is none.
fn browser() -> Option<Browser> {
    let browser = Browser::start();
    if browser.is_none() {
        eprintln!("no Chromium is installed: pages were not looked at in a browser");
    }
    browser
}

/// The page that a command writes into a folder.
fn page(folder: &Path, command: &[&str]) -> PathBuf {
    let mut process = Command::new(env!("CARGO_BIN_EXE_frazil"));
    let output = process.args(command).args(["--quiet", "--out", "out"]).current_dir(folder).output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("out/report.html")
}

/// Two scenes, of which one has a name that would run something.
fn comparison(folder: &Path) -> PathBuf {
    let scene = frazil_cases::scenes::all().iter().find(|scene| scene.name == "stefan-water").expect("a scene");
    let title = "title = \"</script><script>document.title = 'ran'</script><img src=x onerror='document.title = 1'>\"";
    let lines = scene.text.lines().map(|line| if line.starts_with("title") { title } else { line });
    fs::write(folder.join("<script>.toml"), lines.collect::<Vec<_>>().join("\n")).expect("a file");
    let scenes = ["compare", "stefan-water", "<script>.toml"];
    page(folder, &[&scenes[..], &["--methods", "local,sph,pd", "--levels", "3", "--repeats", "1"]].concat())
}

/// Layouts of freeze pipes, of which one has a name that would run something.
fn layouts(folder: &Path) -> PathBuf {
    let study = r#"
        title = "</script><script>document.title = 'ran'</script>"
        source = "none"
        scene = "frozen-wall-sand"
        shaft_radius_m = 3.5

        [set]
        "time.duration_days" = 60

        [[layouts]]
        name = "all pipes"

        [[layouts]]
        name = "<img src=x onerror='document.title = 1'>"
        set = { "pipes.1.missing" = ["1.1", "1.2"] }
    "#;
    fs::write(folder.join("rings.toml"), study).expect("a file");
    page(folder, &["layout", "rings.toml"])
}

/// Moves over the chart until the numbers of a run are shown; where that was.
fn hover(browser: &mut Browser) -> (f64, f64) {
    let [x, y, width, height] = browser.place("#chart .u-over");
    for row in 0..30 {
        for column in 0..40 {
            let at = (x + width * (column as f64 / 40.0 - 0.49), y + height * (row as f64 / 30.0 - 0.49));
            browser.mouse("mouseMoved", at, 0);
            if browser.value("!document.querySelector('.tip').hidden") == true {
                return at;
            }
        }
    }
    unreachable!("no run of the chart tells its numbers")
}

fn column(browser: &mut Browser, number: usize) -> Vec<String> {
    let cells = browser.value(&format!(
        "[...document.querySelector('.scroll table').tBodies[0].rows].map((row) => row.cells[{number}].textContent)"
    ));
    let cells = cells.as_array().cloned().unwrap_or_default();
    cells.iter().filter_map(Value::as_str).map(Into::into).collect()
}

fn range(browser: &mut Browser) -> Value {
    browser.value("[document.getElementById('chart').dataset.low, document.getElementById('chart').dataset.high]")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

#[test]
fn the_chart_of_a_comparison_is_interactive() {
    let Some(mut browser) = browser() else { return };
    let folder = folder();
    let path = comparison(folder.path());
    assert!(fs::metadata(&path).expect("a page").len() <= 700_000);
    browser.resize(1280);
    browser.open(&path);

    // What a scene is called runs nothing, and nothing is asked for but the page.
    assert_eq!(browser.value("document.title"), "Which method reaches a given error soonest?");
    assert!(browser.asked_for.iter().all(|address| address.starts_with("file://") && address.ends_with("report.html")));

    // The answer and the chart are on the first screen.
    let [_, answer, ..] = browser.place(".answer");
    assert!(answer < 300.0 && browser.value("scrollY") == 0, "{answer}");
    assert!(
        browser.value("document.querySelector('#chart .u-over').getBoundingClientRect().top < innerHeight") == true
    );

    hover(&mut browser);
    let told = browser.value("document.querySelector('.tip').textContent");
    let told = told.as_str().unwrap_or_default();
    for words in ["frazil run", "--set method.", "particles", "steps", "error", " mm"] {
        assert!(told.contains(words), "{words}: {told}");
    }

    // A drag zooms, two clicks go back.
    let whole = range(&mut browser);
    let [x, y, width, height] = browser.place("#chart .u-over");
    browser.mouse("mouseMoved", (x - 0.2 * width, y - 0.2 * height), 0);
    browser.mouse("mousePressed", (x - 0.2 * width, y - 0.2 * height), 1);
    browser.mouse("mouseMoved", (x, y), 1);
    browser.mouse("mouseMoved", (x + 0.2 * width, y + 0.2 * height), 1);
    browser.mouse("mouseReleased", (x + 0.2 * width, y + 0.2 * height), 1);
    browser.wait("!document.querySelector('.reset').disabled");
    assert_ne!(range(&mut browser), whole);
    browser.click("#chart .u-over", 2);
    browser.wait("document.querySelector('.reset').disabled");
    assert_eq!(range(&mut browser), whole);

    // A click on a name hides its curve, and another shows it again.
    let hidden = "document.querySelectorAll('.u-legend .u-off').length";
    let before = browser.value(hidden);
    browser.click(".u-legend .u-series:nth-child(2) .u-label", 1);
    assert_ne!(browser.value(hidden), before);
    browser.click(".u-legend .u-series:nth-child(2) .u-label", 1);
    assert_eq!(browser.value(hidden), before);

    // Other costs and other scenes.
    let drawn = "document.querySelector('#chart').dataset.points";
    let points = browser.value(drawn);
    for (name, value) in [("cost", "2"), ("cost", "3"), ("measure", "1"), ("scene", "1")] {
        browser.value(&format!(
            "(() => {{ const select = document.querySelector('select[name={name}]'); select.value = '{value}'; \
             select.dispatchEvent(new Event('change')); }})()"
        ));
        assert_eq!(browser.value(drawn), points, "{name} {value}");
    }
}

#[test]
fn tables_are_sorted_by_numbers_and_pages_fit_dark_and_narrow_screens() {
    let Some(mut browser) = browser() else { return };
    let folder = folder();
    let path = comparison(folder.path());
    browser.resize(1280);
    browser.open(&path);
    let before = column(&mut browser, 1);
    browser.click(".scroll th:nth-child(2)", 1);
    let ascending = column(&mut browser, 1);
    let mut words = before.clone();
    words.sort_by_key(|word| word.to_lowercase());
    assert_eq!(ascending, words);
    browser.click(".scroll th:nth-child(2)", 1);
    assert_eq!(column(&mut browser, 1), words.into_iter().rev().collect::<Vec<_>>());
    assert_eq!(browser.value("document.querySelector('.scroll th:nth-child(2)').ariaSort"), "descending");

    let ground = "getComputedStyle(document.body).backgroundColor";
    let light = browser.value(ground);
    browser.click("#theme", 1);
    assert_ne!(browser.value(ground), light);
    browser.value("document.documentElement.removeAttribute('data-theme')");
    let dark = json!({ "features": [{ "name": "prefers-color-scheme", "value": "dark" }] });
    browser.call("Emulation.setEmulatedMedia", dark);
    assert_ne!(browser.value(ground), light);

    browser.resize(400);
    browser.open(&path);
    let wide = browser.value("document.scrollingElement.scrollWidth");
    assert!(wide.as_f64().is_some_and(|wide| wide <= 400.0), "{wide}");
    hover(&mut browser);
}

#[test]
fn plans_of_layouts_follow_the_day() {
    let Some(mut browser) = browser() else { return };
    let folder = folder();
    let path = layouts(folder.path());
    assert!(fs::metadata(&path).expect("a page").len() <= 700_000);
    browser.resize(1280);
    browser.open(&path);
    assert!(browser.value("document.title.startsWith('</script><script>')") == true);
    assert!(browser.asked_for.iter().all(|address| address.starts_with("file://") && address.ends_with("report.html")));
    assert!(
        browser.value("document.querySelector('#plan input[type=range]').getBoundingClientRect().bottom < innerHeight")
            == true
    );
    assert_eq!(browser.value("document.querySelectorAll('.layout svg').length"), 2);

    // It begins on the day on which the first wall stands; a day earlier none does.
    let facts = |browser: &mut Browser, layout: usize| {
        let value = browser.value(&format!("document.querySelectorAll('.layout dl')[{layout}].textContent"));
        value.as_str().map(String::from).unwrap_or_default()
    };
    let closed = facts(&mut browser, 0);
    assert!(closed.contains("closed, 26 of 26 gaps closed") && closed.contains("m thick"), "{closed}");
    assert!(facts(&mut browser, 1).contains("open, "));
    let day = "Number(document.getElementById('plan').dataset.day)";
    let (began, ground) = (browser.value(day), "document.querySelector('.ice').getAttribute('d')");
    let then = browser.value(ground);
    let [x, y, width, _] = browser.place("#plan input[type=range]");
    for kind in ["mousePressed", "mouseReleased"] {
        browser.mouse(kind, (x - 0.45 * width, y), 1);
    }
    assert!(browser.value(day).as_f64() < began.as_f64());
    assert_ne!(browser.value(ground), then);
    assert!(facts(&mut browser, 0).contains("open, 0 of 26 gaps closed"));
    assert_eq!(browser.value("document.querySelectorAll('.layout')[0].querySelectorAll('.gap.open').length"), 26);

    // Played to the end, where the gap of the two missing pipes is still the widest one.
    browser.click("#plan .play", 1);
    browser.wait("document.querySelector('#plan .play').textContent === 'Play'");
    assert_eq!(browser.value(day), 60);
    // Of gaps that are all alike none is the weakest.
    assert_eq!(browser.value("document.querySelectorAll('.gap.weakest').length"), 1);
    assert!(facts(&mut browser, 0).contains("all gaps are alike, "));

    // Layouts that are switched off and on.
    browser.click("#plan input[type=checkbox]", 1);
    assert_eq!(browser.value("document.querySelectorAll('.layout svg').length"), 1);
    browser.click("#plan input[type=checkbox]", 1);
    assert_eq!(browser.value("document.querySelectorAll('.layout svg').length"), 2);

    browser.resize(400);
    browser.open(&path);
    let wide = browser.value("document.scrollingElement.scrollWidth");
    assert!(wide.as_f64().is_some_and(|wide| wide <= 400.0), "{wide}");

    browser.call("Emulation.setScriptExecutionDisabled", json!({ "value": true }));
    browser.open(&path);
    assert_eq!(browser.value("document.getElementById('plan').hidden"), true);
    assert!(
        browser.value(
            "document.querySelectorAll('figure svg').length > 3 && document.querySelectorAll('.answer').length > 0"
        ) == true
    );
}

#[test]
fn a_page_says_the_same_without_scripts() {
    let Some(mut browser) = browser() else { return };
    let folder = folder();
    let path = comparison(folder.path());
    browser.call("Emulation.setScriptExecutionDisabled", json!({ "value": true }));
    browser.resize(1280);
    browser.open(&path);
    assert_eq!(browser.value("document.documentElement.classList.length"), 0);
    let drawn = "document.querySelector('.standin svg').getBoundingClientRect().height > 200";
    assert_eq!(browser.value(drawn), true);
    assert_eq!(
        browser.value("document.getElementById('chart').hidden && document.getElementById('theme').hidden"),
        true
    );
    assert!(browser.value("document.querySelectorAll('.answer').length") == 2);
}
