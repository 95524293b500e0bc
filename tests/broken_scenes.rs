//! Whatever is done to a scene file, reading it ends with a scene or with problems, and soon.

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
            prop_assert_eq!(problems.to_string().lines().count(), problems.problems.len());
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

/// Cases as `cargo bench --bench fuzz` makes a million of: a few thousand, of another seed.
#[test]
fn scenes_that_nobody_wrote_end_in_one_of_the_ways_there_are() {
    let pool = Pool::new();
    let mut ends = Vec::new();
    for case in 0..3000 {
        match pool.case(77, case) {
            Ok(end) => ends.push(end),
            Err(found) => unreachable!("case {case}: {}\n{}", found.what, found.text),
        }
    }
    // Not all alike: cases come through to each end.
    for end in [End::Unread, End::Planned, End::Run, End::Study] {
        assert!(ends.iter().filter(|other| **other == end).count() > 10, "{end:?}");
    }
}
