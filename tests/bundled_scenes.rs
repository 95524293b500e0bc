//! The scenes that come with the program are good, and say what they are.

use frazil_core::scene::Scene;

#[test]
fn every_bundled_scene_is_good_under_every_method() {
    let kinds = frazil::registry::methods();
    for bundled in frazil_cases::scenes::all() {
        let scene = Scene::read(bundled.text, bundled.name, bundled.name, &[], kinds);
        let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
        let named: Vec<&str> = scene.methods.iter().map(|settings| settings.method).collect();
        // Particles of one volume are no shells.
        let shells = scene.domain.symmetry().is_some();
        let able = kinds.iter().filter(|kind| !(kind.stochastic && shells)).map(|kind| kind.name);
        assert_eq!(named, able.collect::<Vec<_>>(), "{}", bundled.name);
        assert!(bundled.text.starts_with("# "), "{} opens with what it is", bundled.name);
        assert!(scene.watch.profiles.contains(&scene.duration), "{} keeps its last profile", bundled.name);
    }
}
