use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::TimeUnit;
use crate::method::{Discretisation, Stepper};
use crate::settings::*;
use frazil_core::bonds::weight::{Normalisation, PairWeight};
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::Value;

struct Nearest(f64);

impl PairWeight for Nearest {
    fn reach(&self) -> f64 {
        self.0
    }
    fn weight(&self, _distance: f64) -> f64 {
        1.0
    }
}

static PLAIN: MethodKind = MethodKind {
    name: "plain",
    title: "A method for tests",
    source: "none",
    stochastic: false,
    lattice_only: false,
    defaults: |_| Numerics::default(),
    read: |section, _, numerics, _| {
        let ratio = section.number_or("horizon_ratio", 3.0, Range::between(1.0, 12.0));
        Discretisation {
            weight: Arc::new(Nearest(ratio * numerics.spacing)),
            normalisation: Normalisation::DiscreteMoment,
            knobs: vec![("horizon_ratio", Value::Number(ratio))],
            differences: Vec::new(),
            fluctuation: 0.0,
            stepper: Stepper::Shared,
        }
    },
};

const GOOD: &str = r#"
title = "Water freezes from one end"
source = "none"

[domain.line]
length_m = 0.4

[time]
duration_h = 10
outputs = 20
profiles_h = [5, 10.0]

[materials.water]
density_kg_per_m3 = 1000
frozen = { conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }
unfrozen = { conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }
freezing = { law = "isothermal", temperature_c = 0, latent_heat_J_per_kg = 334e3 }

[initial]
temperature_c = 8

[walls.left]
temperature_c = { times_h = [0, 1], values = [8, -20] }

[walls.right]
temperature_c = 8

[watch]
probes_m = [[0.1], [0.2]]
front_from_h = 1

[method.plain]
spacing_m = 0.002
step_s = 5
"#;

fn read(text: &str, sets: &[(&str, &str)]) -> Result<Scene, Problems> {
    let sets: Vec<_> = sets.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Scene::read(text, "water", "water.toml", &sets, &[&PLAIN])
}

fn message(text: &str, sets: &[(&str, &str)]) -> String {
    read(text, sets).map(|_| "no problem".to_owned()).unwrap_or_else(|problems| problems.to_string())
}

#[test]
fn a_phase_of_its_own_density_holds_heat_by_it() {
    let set = [("materials.water.frozen.density_kg_per_m3", "917")];
    let [own, plain] = [&set[..], &[]].map(|set| read(GOOD, set).expect("the scene is good").materials[0].clone());
    let by_volume = own.frozen.heat_capacity * own.density;
    // Rounding.
    assert!((by_volume / (917.0 * 2060.0) - 1.0).abs() < 1e-15);
    assert_eq!((own.unfrozen, own.latent_heat, own.density), (plain.unfrozen, plain.latent_heat, plain.density));
    let wrong = message(GOOD, &[("materials.water.frozen.density_kg_per_m3", "0")]);
    assert!(wrong.contains("must be greater than 0") && !wrong.contains("heat_capacity"), "{wrong}");
}

#[test]
fn a_scene_is_read_in_seconds_and_metres() {
    let scene = read(GOOD, &[]).expect("the scene is good");
    assert_eq!(scene.domain, Domain::Line { length: 0.4 });
    assert_eq!((scene.duration, scene.time_unit), (36000.0, TimeUnit::Hour));
    assert_eq!(scene.watch.profiles, [18000.0, 36000.0]);
    assert_eq!(scene.watch.probes, [(0.1, 0.0), (0.2, 0.0)]);
    let Some(Condition::Temperature(Series::Table(rows))) = scene.wall(WallId::Left) else {
        unreachable!("the left wall is a table");
    };
    assert_eq!(rows, &[(0.0, 8.0), (3600.0, -20.0)]);
    assert_eq!(scene.methods[0].numerics.step, StepChoice::Fixed(5.0));
    assert_eq!(scene.hash.len(), 16);
}

/// What a record says of settings can be written into a scene, and says the same again; spacing and step stand in `GOOD`, with
/// their units.
#[test]
fn settings_of_a_record_can_be_typed_back() {
    let keys = |setting: &[(&str, &str)]| {
        let scene = read(GOOD, setting).unwrap_or_else(|problems| unreachable!("{setting:?}: {problems}"));
        scene.methods[0].values()
    };
    for setting in [
        [("mean", "harmonic"), ("mushy", "false")],
        [("mean", "geometric"), ("layout", "random")],
        [("integrator", "implicit"), ("tolerance", "1e-4")],
        [("scheme", "flags"), ("search", "tree")],
        [("scheme", "apparent-capacity"), ("interval_K", "0.5")],
        [("layout", "jittered"), ("jitter_fraction", "0.2")],
    ] {
        let typed: Vec<(String, &str)> =
            setting.iter().map(|(key, value)| (format!("method.plain.{key}"), *value)).collect();
        let typed: Vec<(&str, &str)> = typed.iter().map(|(key, value)| (key.as_str(), *value)).collect();
        let first = keys(&typed);
        let text: Vec<(String, String)> = first
            .iter()
            .filter(|(key, _)| !["spacing", "step"].contains(&key.as_str()))
            .map(|(key, value)| {
                let value = match value {
                    Value::Flag(flag) => flag.to_string(),
                    Value::Number(number) => number.to_string(),
                    Value::Text(word) => word.clone(),
                };
                (format!("method.plain.{key}"), value)
            })
            .collect();
        let again: Vec<(&str, &str)> = text.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        assert_eq!(keys(&again), first, "{setting:?}");
    }
}

#[test]
fn set_overrides_a_value_and_changes_the_hash() {
    let scene = read(GOOD, &[("method.plain.horizon_ratio", "4"), ("method.plain.layout", "random")]).expect("good");
    assert_eq!(scene.methods[0].discretisation.knobs[0].1, Value::Number(4.0));
    assert_eq!(scene.methods[0].numerics.arrangement, Arrangement::Random);
    assert_ne!(scene.hash, read(GOOD, &[]).expect("good").hash);
}

#[test]
fn problems_of_set_name_the_option() {
    assert_eq!(
        message(GOOD, &[("method.plain.spacing_m", "-0.1")]),
        "--set method.plain.spacing_m=-0.1: found -0.1, must be greater than 0"
    );
    assert_eq!(
        message(GOOD, &[("method.plain.horizn_ratio", "3")]),
        "--set method.plain.horizn_ratio=3: unknown key, did you mean \"horizon_ratio\"?"
    );
    assert_eq!(
        message(GOOD, &[("title.main", "x")]),
        "--set title.main=x: \"title\" is \"Water freezes from one end\", so it has no key \"main\""
    );
    assert_eq!(
        message(GOOD, &[("watch.probes_m.7", "x")]),
        "--set watch.probes_m.7=x: \"probes_m\" is a list of 2, so \"7\" must be a number from 1 to 2"
    );
    // As older commands have it, which count from 0.
    assert_eq!(
        message(GOOD, &[("watch.probes_m.0", "x")]),
        "--set watch.probes_m.0=x: lists count from 1: what was \"probes_m.0\" is \"probes_m.1\""
    );
    assert_eq!(message(GOOD, &[("time", "3")]), "--set time=3: found 3, must be a table");
}

#[test]
fn all_problems_are_reported_at_once_in_line_order() {
    let text = GOOD.replace("0.4", "-1").replace("outputs = 20", "outputs = 0").replace("= 334e3", "= inf");
    assert_eq!(
        message(&text, &[]),
        "water.toml:6: domain.line.length_m: found -1, must be greater than 0\n\
         water.toml:10: time.outputs: found 0, must be an integer between 1 and 100000\n\
         water.toml:17: materials.water.freezing.latent_heat_J_per_kg: found inf, must be a finite number"
    );
}

#[test]
fn a_misspelt_required_key_is_one_problem() {
    let text = GOOD.replace("duration_h", "duration_hours");
    assert_eq!(
        message(&text, &[]),
        "water.toml:9: time.duration_hours: unit missing or not known, must be \"duration_s\", \
         \"duration_minutes\", \"duration_h\", \"duration_days\" or \"duration_years\""
    );
    assert_eq!(
        message(&GOOD.replace("length_m", "lenght_m"), &[]),
        "water.toml:6: domain.line.lenght_m: unknown key, did you mean \"length_m\"?"
    );
}

/// The good scene as half of the plan of a shaft.
fn half_ring() -> String {
    GOOD.replace("[domain.line]\nlength_m = 0.4", "[domain.ring]\nouter_radius_m = 15\nsector = \"half\"")
        .replace("duration_h = 10\noutputs = 20\nprofiles_h = [5, 10.0]", "duration_days = 2")
        .replace(
            "[walls.left]\ntemperature_c = { times_h = [0, 1], values = [8, -20] }\n\n[walls.right]",
            "[walls.outer]",
        )
        .replace("probes_m = [[0.1], [0.2]]", "probes_m = [[-4, 3]]")
        .replace("spacing_m = 0.002", "spacing_m = 0.1")
}

#[test]
fn times_have_the_unit_of_their_key() {
    let duration = |time: &str| {
        let text = GOOD.replace("duration_h = 10\noutputs = 20\nprofiles_h = [5, 10.0]", time);
        let scene = read(&text, &[]).expect("the scene is good");
        (scene.duration, scene.time_unit.symbol())
    };
    assert_eq!(duration("duration_minutes = 90"), (5400.0, "min"));
    assert_eq!(duration("duration_years = 2"), (2.0 * 365.25 * 86_400.0, "yr"));
    assert_eq!(duration("duration_days = 2"), (172_800.0, "d"));
}

#[test]
fn a_ring_in_days_is_read() {
    let text = half_ring()
        + "[[pipes]]\ncount = 5\nring_radius_m = 5\nfirst_angle_deg = 36\npipe_radius_m = 0.1\ntemperature_c = -20\n";
    let scene = read(&text, &[("pipes.1.temperature_c", "-25")]).expect("the scene is good");
    assert_eq!((scene.duration, scene.time_unit, scene.watch.outputs), (172800.0, TimeUnit::Day, 60));
    assert_eq!(scene.watch.profiles, [172800.0]);
    assert_eq!(scene.pipes().len(), 5);
    assert_eq!(scene.rings[0].first_angle, 36f64.to_radians());
    assert_eq!(scene.temperature_range(), (-25.0, 8.0));
    assert_eq!(
        message(&text, &[("domain.ring.sector", "quarter")]),
        "water.toml:25: watch.probes_m: found [-4, 3], must lie inside the domain\n\
         water.toml:32: pipes.1.count: found 5, must be even for the mirror planes of a quarter"
    );
}

#[test]
fn pairs_reach_beyond_a_body_only_between_straight_walls() {
    assert_eq!(message(GOOD, &[("method.plain.spacing_m", "0.2")]), "no problem");
    assert_eq!(
        message(&half_ring(), &[("method.plain.spacing_m", "7.5")]),
        "--set method.plain.spacing_m=7.5: found 7.5, for which the reach of pairs is 22.5, must be at most 15, the \
         shortest extent of the domain"
    );
}

#[test]
fn tables_and_work_may_repeat() {
    let wall = "walls.left.temperature_c";
    let scene = read(GOOD, &[(wall, "{ times_h = [0, 12], values = [8, -20], period_days = 1 }")]);
    let scene = scene.expect("the scene is good");
    let Some(Condition::Temperature(series)) = scene.wall(WallId::Left) else {
        unreachable!("the left wall has a temperature");
    };
    assert_eq!(series, &Series::Repeated { rows: vec![(0.0, 8.0), (43_200.0, -20.0)], period: 86_400.0 });
    let text = half_ring() + "[[pipes]]\ncount = 2\nring_radius_m = 5\npipe_radius_m = 0.1\ntemperature_c = -20\n";
    let schedule = |sets: &[(&str, &str)]| read(&text, sets).expect("the scene is good").rings[0].schedule.clone();
    assert_eq!(schedule(&[]), None);
    let nights = schedule(&[("pipes.1.on_h", "[[0, 8], [20, 24]]"), ("pipes.1.on_period_days", "1")]);
    let nights = nights.expect("a schedule");
    assert_eq!(nights.on, [(0.0, 28_800.0), (72_000.0, 86_400.0)]);
    assert_eq!(nights.period, Some(86_400.0));
    let late = schedule(&[("pipes.1.on_days", "[[10]]")]).expect("a schedule");
    assert_eq!((late.on.as_slice(), late.period), (&[(864_000.0, f64::INFINITY)][..], None));
}

#[test]
fn a_line_of_the_file_is_named_by_its_number_also_after_windows_line_ends() {
    let text = GOOD.replace('\n', "\r\n").replace("0.4", "0");
    assert_eq!(message(&text, &[]), "water.toml:6: domain.line.length_m: found 0, must be greater than 0");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever stands in a file, reading it ends with a scene or with problems.
    #[test]
    fn broken_files_never_panic(
        cut in 0..GOOD.len(),
        at in 0..GOOD.len(),
        from in 0..GOOD.len(),
        length in 0usize..40,
        junk in prop::sample::select(vec![
            "", "[", "]", "[[", "=", "\"", "\n", ".", "{", "}", "nan", "-inf", "1e400", "-1", "0", "0x7f", "true",
            "1979-05-27", "\u{0}", "é", "[walls]", "[[pipes]]", "99999999999999999999", "units = \"dpd\"\n",
        ]),
        truncate in any::<bool>(),
    ) {
        let mut text = if truncate { GOOD[..cut].to_owned() } else { GOOD.to_owned() };
        let at = at.min(text.len());
        let piece = &GOOD[from..(from + length).min(GOOD.len())];
        text.insert_str(at, junk);
        text.insert_str(at, if length % 2 == 0 { piece } else { "" });
        if let Err(problems) = read(&text, &[]) {
            prop_assert!(!problems.problems.is_empty());
        }
    }

    /// The same holds for the command line.
    #[test]
    fn broken_options_never_panic(key in "[a-z_.0-9]{0,30}", value in "\\PC{0,12}") {
        if let Err(problems) = read(GOOD, &[(&key, &value)]) {
            prop_assert!(!problems.problems.is_empty());
        }
    }

    /// Every key replaced by every kind of value is read without a panic.
    #[test]
    fn wrong_types_never_panic(
        line in 0..GOOD.lines().count(),
        value in prop::sample::select(vec!["3", "-1e300", "1e-300", "nan", "\"x\"", "true", "[]", "[[]]", "{}", "[1, 2]"]),
    ) {
        let lines: Vec<String> = GOOD
            .lines()
            .enumerate()
            .map(|(index, text)| match text.split_once(" = ") {
                Some((key, _)) if index == line => format!("{key} = {value}"),
                _ => text.to_owned(),
            })
            .collect();
        if let Err(problems) = read(&lines.join("\n"), &[]) {
            prop_assert!(!problems.problems.is_empty());
        }
    }
}

/// What is larger than anyone means is refused by what was found and what is allowed, and no file ends in more words than can be read.
#[test]
fn files_tables_and_lists_have_a_size() {
    let many = |count: usize, item: &str| vec![item; count].join(", ");
    let numbers = |count: usize| (1..=count).map(|k| k.to_string()).collect::<Vec<_>>().join(", ");
    let profiles = |count: usize| GOOD.replace("[5, 10.0]", &format!("[{}]", numbers(count)));
    assert_eq!(
        message(&profiles(1001), &[("time.duration_h", "2000")]),
        "water.toml:11: time.profiles_h: found 1001, must be at most 1000"
    );
    assert!(read(&profiles(1000), &[("time.duration_h", "2000")]).is_ok());
    for (key, item) in [("probes_m", "[0.1]"), ("isotherms_c", "1")] {
        let watched = GOOD.replace("[watch]", &format!("[watch]\n{key} = [{}]", many(1001, item)));
        let watched = if key == "probes_m" { watched.replace("probes_m = [[0.1], [0.2]]", "") } else { watched };
        let expected = format!("water.toml:29: watch.{key}: found 1001, must be at most 1000");
        assert_eq!(message(&watched, &[]), expected);
    }
    let long = GOOD.replace("[5, 10.0]", &format!("[{}]", numbers(100_001)));
    assert_eq!(
        message(&long, &[]),
        "water.toml:11: time.profiles_h: found a list of 100001 items, must have at most 100000"
    );
    let regions = format!("{GOOD}\nregions = [{}]", many(1001, "{}"));
    assert!(message(&regions, &[]).ends_with("regions: found a list of 1001 tables, must have at most 1000"));
    let material = |k: usize| format!("[materials.m{k}]\n");
    let materials: String = (0..255).map(material).collect();
    let said = message(&format!("{GOOD}\n{materials}"), &[]);
    assert!(said.contains("materials: found 256 materials, must be at most 255"), "{}", &said[..200]);
    let keys: String = (0..1001).map(|k| format!("k{k} = 1\n")).collect();
    assert_eq!(message(&keys, &[]), "water.toml: found 1001 keys, must have at most 1000");
    let large = "#".repeat(4_000_001);
    assert_eq!(message(&large, &[]), "water.toml: found 4000001 bytes, must have at most 4000000");
    let said = message(&"a = 1\n".repeat(5000), &[]);
    assert_eq!(said.lines().count(), 101);
    assert!(said.contains("more problems"), "{}", &said[..200]);
}

#[test]
fn a_heading_is_read_by_itself() {
    let said =
        |text: &str| heading(text, "x.toml").map(|own| (own.title, own.source)).map_err(|found| found.to_string());
    let own = |title: &str, source: &str| Ok((title.to_owned(), source.to_owned()));
    assert_eq!(said("title = \"a\"\nsource = \"b\"\nother = 3\n[walls]\nleft ="), own("a", "b"));
    // A line that only looks like a section.
    assert_eq!(said("title = \"\"\"a \\\n[b\"\"\"\nsource = \"c\"\n"), own("a [b", "c"));
    assert_eq!(said("list = [\n[1], [2]\n]\ntitle = \"a\"\nsource = \"c\""), own("a", "c"));
    assert_eq!(
        said("title = \"a\"\n[watch]\nsource = \"c\""),
        Err("x.toml: source: missing, must be a text".to_owned())
    );
    assert!(said("title = \"a\nsource = \"b\"\n").is_err());
}
