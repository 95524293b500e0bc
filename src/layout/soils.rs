//! Soils that studies know by name.

use toml::{Table, Value};

use super::study::literals;
use crate::load::Overrides;

/// What a scene must be changed by to be all of this soil.
pub(super) fn overrides(soil: Option<&String>) -> Result<Overrides, String> {
    let Some(name) = soil else { return Ok(Overrides::new()) };
    let soils: Table = frazil_cases::soils::TEXT.parse().map_err(|error| format!("soils: {error}"))?;
    let Some(material) = soils.get(name) else {
        let known: Vec<String> = soils.keys().map(|known| format!("\"{known}\"")).collect();
        return Err(format!("soil: found \"{name}\", must be one of {}", known.join(", ")));
    };
    let materials = Table::from_iter([(name.clone(), material.clone())]);
    Ok(literals(&Table::from_iter([("materials".to_owned(), Value::Table(materials))])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load;

    #[test]
    fn a_ring_may_be_of_any_soil() {
        let soils: Table = frazil_cases::soils::TEXT.parse().expect("a table");
        for name in soils.keys() {
            let changed = overrides(Some(name)).expect("a soil");
            let scene = load::scene("frozen-wall-sand", &changed).expect("a scene");
            assert_eq!(scene.materials[0].name, *name);
        }
        let refused = overrides(Some(&"mud".to_owned())).expect_err("no soil");
        assert!(refused.starts_with("soil: found \"mud\", must be one of \"clay\", \"clay-as-printed\""), "{refused}");
    }

    #[test]
    fn soils_are_those_of_the_scenes_they_come_from() {
        for (soil, scene) in [("sand", "frozen-wall-sand"), ("clay", "frozen-wall-clay")] {
            let changed = overrides(Some(&soil.to_owned())).expect("a soil");
            let (own, bundled) = (load::scene("frozen-wall-sand", &changed), load::scene(scene, &[]));
            assert_eq!(own.expect("a scene").materials, bundled.expect("a scene").materials);
        }
    }
}
