//! Whatever is done to a scene file, reading it ends with a scene or with problems, and soon.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use frazil_scene::Scene;
use proptest::prelude::*;

use crate::fuzzed::{End, Pool};

/// The bundled scenes and one bad scene of each kind of body that they lack.
fn sources() -> Vec<&'static str> {
    let mut texts: Vec<&str> = frazil_cases::scenes::all().iter().map(|scene| scene.text).collect();
    for name in ["freeze-thaw-100", "pipes-by-the-hour"] {
        texts.extend(frazil_cases::scenes::find(name).map(|scene| scene.text));
    }
    texts.push(include_str!("../cases/bad/region-outside.toml"));
    texts.push(include_str!("../cases/bad/pipes-overlap-between-rings.toml"));
    texts.push(include_str!("../cases/bad/spacing-does-not-divide-rectangle.toml"));
    texts
}

fn values() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "",
        "0",
        "-1",
        "3",
        "1e-300",
        "1e300",
        "nan",
        "-inf",
        "1e999",
        "0x7f",
        "true",
        "\"x\"",
        "\"rkl2\"",
        "\"random\"",
        "\"whole\"",
        "\"dpd\"",
        "[]",
        "[[]]",
        "[1, 2]",
        "[[1, 2, 3]]",
        "{}",
        "{ times_h = [0, 1], values = [1, 2] }",
        "1979-05-27",
        "\"\"\"",
        "[",
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn edited_scenes_never_panic(
        source in prop::sample::select(sources()),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4usize, values()), 1..6),
        cut in any::<prop::sample::Index>(),
        truncate in prop::bool::weighted(0.2),
    ) {
        let mut lines: Vec<String> = source.lines().map(str::to_owned).collect();
        for (index, edit, value) in edits {
            let index = index.index(lines.len());
            match edit {
                0 => drop(lines.remove(index)),
                1 => lines.insert(index, lines[index].clone()),
                2 => lines.insert(index, value.to_owned()),
                _ => {
                    let key = lines[index].split_once('=').map(|(key, _)| key.to_owned());
                    if let Some(key) = key {
                        lines[index] = format!("{key}= {value}");
                    }
                }
            }
        }
        let mut text = lines.join("\n");
        if truncate {
            let mut end = cut.index(text.len() + 1);
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            text.truncate(end);
        }
        if let Err(problems) = Scene::read(&text, "broken", "broken.toml", &[], frazil::registry::methods()) {
            prop_assert!(!problems.problems.is_empty());
            prop_assert_eq!(problems.to_string().lines().count(), problems.problems.len().min(101));
        }
    }

    #[test]
    fn options_never_panic(
        source in prop::sample::select(sources()),
        key in prop::sample::select(vec![
            "units", "domain", "domain.line", "domain.line.length_m", "domain.ring.sector", "time.duration_s", "materials",
            "walls.left", "walls.outer.temperature_c", "pipes", "pipes.1", "pipes.1.count", "pipes.1.ring_radius_m",
            "regions", "regions.1.x_min_m", "watch.probes_m", "method.pd.spacing_m", "method.edpd.spacing", "method",
            "method.pd.search", "method.pd.layout", "method.local.scheme", "method.sph.smoothing_ratio", "reference.kind",
        ]),
        value in values(),
    ) {
        let overrides = [(key.to_owned(), value.to_owned())];
        if let Err(problems) = Scene::read(source, "set", "set.toml", &overrides, frazil::registry::methods()) {
            prop_assert!(!problems.problems.is_empty());
        }
    }
}

/// Cases that are always made, and those that are made while there is time.
const LEAST: u64 = 2000;
const MOST: u64 = 100_000;
const TIME: Duration = Duration::from_secs(20);

/// Cases as `cargo bench --bench fuzz` makes them by the million.
#[test]
fn fuzzed_files_end_in_one_of_the_ways_there_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let pool = Pool::new(folder.path());
    let began = Instant::now();
    let mut ends: BTreeMap<End, u64> = BTreeMap::new();
    for number in (0..MOST).take_while(|number| *number < LEAST || began.elapsed() < TIME) {
        match pool.end(77, number) {
            Ok(end) => *ends.entry(end).or_default() += 1,
            Err(found) => {
                let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-77-{number}.toml"));
                fs::write(&file, &found.text).expect("written");
                unreachable!("case {number}: {}\nits file is {}\n{}", found.what, file.display(), found.text);
            }
        }
    }
    // Not all alike: cases come through to each end.
    for end in [End::Unread, End::Planned, End::Checked, End::Run, End::Study, End::Fluid] {
        assert!(ends.get(&end).is_some_and(|count| *count > 3), "{end:?}: {ends:?}");
    }
}
