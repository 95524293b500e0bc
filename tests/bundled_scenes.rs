//! The scenes that come with the program are good, say what they are, and are held to what they gave.

use frazil_scene::method::MethodKind;
use frazil_scene::{Front, Scene};

#[test]
fn every_bundled_scene_is_good_under_every_method() {
    let kinds = frazil::registry::methods();
    for bundled in frazil_cases::scenes::all() {
        let scene = Scene::read(bundled, bundled.name, bundled.name, &[], kinds);
        let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
        let named: Vec<&str> = scene.methods.iter().map(|settings| settings.method).collect();
        // Particles of one volume are no shells, and noise moves no water.
        let quiet = scene.domain.symmetry().is_some() || scene.flow.is_some() || scene.of_water;
        // Only particles that move can be driven.
        let driven = scene.stream.is_some();
        let can = |kind: &&&MethodKind| if kind.stochastic { !quiet } else { !driven };
        let able: Vec<_> = kinds.iter().filter(can).map(|kind| kind.name).collect();
        assert_eq!(named, able, "{}", bundled.name);
        assert!(bundled.text.starts_with("# "), "{} opens with what it is", bundled.name);
        assert!(scene.watch.profiles.contains(&scene.duration), "{} keeps its last profile", bundled.name);
    }
}

/// Fronts inside particles are the default where something freezes at one temperature, slowly enough, and nothing excludes them.
#[test]
fn fronts_lie_inside_particles_where_that_pays() {
    let (cell, inside) = (Front::Cell, Front::SubCell);
    for (name, set, expected) in [
        ("stefan-water", "", inside),
        ("stefan-water", "method.pd.front = cell", cell),
        ("stefan-water", "method.pd.setting = paper", cell),
        ("stefan-water", "method.pd.scheme = flags", cell),
        ("stefan-water", "method.pd.mean = harmonic", cell),
        ("stefan-water", "method.pd.search = tree", cell),
        // Nothing is as cold as ice.
        ("stefan-water", "walls.left.temperature_c = 5", cell),
        ("stefan-water", "walls.left = { flux_W_per_m2 = -100 }", inside),
        // The Stefan number.
        ("stefan-number-1e-2", "", inside),
        ("stefan-number-10", "", cell),
        ("stefan-number-10", "materials.body.freezing.latent_heat = 0.51", inside),
        ("stefan-number-10", "materials.body.freezing.latent_heat = 0.49", cell),
        ("no-latent-heat", "", cell),
        // Shells, and a material that freezes over an interval.
        ("ice-in-glass", "", cell),
        ("thawing-inclusion", "", cell),
        ("frozen-wall-seepage", "", inside),
    ] {
        let set: Vec<(String, String)> =
            set.split_once(" = ").map(|(key, value)| (key.into(), value.into())).into_iter().collect();
        let scene = frazil::load::scene(name, &set).unwrap_or_else(|failure| unreachable!("{name} {set:?}: {failure}"));
        let found = scene.method("pd").map(|settings| settings.numerics.front);
        assert_eq!(found, Some(expected), "{name} {set:?}");
    }
}

/// A scene or study whose results nothing holds could change without being seen.
#[test]
fn every_bundled_scene_under_its_methods_and_every_study_has_a_row_of_the_baseline() {
    let table = include_str!("baseline.csv");
    let commands: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    let mut wanted: Vec<String> =
        frazil_cases::studies::all().iter().map(|study| format!("layout {}", study.name)).collect();
    for bundled in frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme()) {
        let scene = frazil::load::scene(bundled.name, &[]).unwrap_or_else(|failure| unreachable!("{failure}"));
        wanted.extend(scene.methods.iter().map(|own| format!("run {} --method {}", bundled.name, own.method)));
    }
    // Long ones are cut short or made coarse.
    let is_row = |wanted: &str, command: &str| {
        let rest = command.strip_prefix(wanted);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(" --set "))
    };
    let missing = |wanted: &&String| !commands.iter().any(|command| is_row(wanted, command));
    let missing: Vec<&String> = wanted.iter().filter(missing).collect();
    assert!(missing.is_empty(), "tests/baseline.csv has no row for {missing:#?}");
    let twice: Vec<_> = commands.iter().enumerate().filter(|(k, row)| commands[..*k].contains(row)).collect();
    assert!(twice.is_empty(), "tests/baseline.csv has two rows for {twice:#?}");
}
