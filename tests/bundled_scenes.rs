//! The scenes that come with the program are good, and say what they are.

use frazil_scene::Scene;
use frazil_scene::method::MethodKind;

#[test]
fn every_bundled_scene_is_good_under_every_method() {
    let kinds = frazil::registry::methods();
    for bundled in frazil_cases::scenes::all() {
        let scene = Scene::read(bundled.text, bundled.name, bundled.name, &[], kinds);
        let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
        let named: Vec<&str> = scene.methods.iter().map(|settings| settings.method).collect();
        // Particles of one volume are no shells, and noise moves no water.
        let quiet = scene.domain.symmetry().is_some() || scene.flow.is_some();
        // Only particles that move can be driven.
        let driven = scene.stream.is_some();
        let can = |kind: &&&MethodKind| if kind.stochastic { !quiet } else { !driven };
        let able: Vec<_> = kinds.iter().filter(can).map(|kind| kind.name).collect();
        assert_eq!(named, able, "{}", bundled.name);
        assert!(bundled.text.starts_with("# "), "{} opens with what it is", bundled.name);
        assert!(scene.watch.profiles.contains(&scene.duration), "{} keeps its last profile", bundled.name);
    }
}
