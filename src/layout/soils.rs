//! Soils that studies know by name.

use frazil_core::physics::material::FreezingLaw;
use frazil_scene::{Scene, Units};
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

/// Between which soils lie, with room beyond (W/mK, J/kg, J/m3K): dry peat conducts some 0.1, quartz 8 and
/// ice 2.2 W/mK; a kilogram of ice takes 334 kJ, and of ground with a hundredth of water in it 3 kJ; dry sand stores 1.2 and water
/// 4.2 MJ/m3K.
const CONDUCTIVITY: (f64, f64) = (0.05, 20.0);
const LATENT_HEAT: (f64, f64) = (2e3, 3.4e5);
const CAPACITY: (f64, f64) = (4e5, 6e6);

/// Materials of the ground around freeze pipes that have what no soil has, as where kJ were given for J.
pub(crate) fn odd(scene: &Scene) -> Vec<String> {
    if scene.rings.is_empty() || scene.units != Units::Si {
        return Vec::new();
    }
    let mut found = Vec::new();
    for material in &scene.materials {
        let mut values = Vec::new();
        for (phase, own) in [("frozen", material.frozen), ("unfrozen", material.unfrozen)] {
            values.push((CONDUCTIVITY, format!("{phase} conductivity"), "W/mK", own.conductivity));
            let by_volume = material.density * own.heat_capacity;
            values.push((CAPACITY, format!("{phase} heat capacity by volume"), "J/m3K", by_volume));
        }
        if material.law != FreezingLaw::None {
            values.push((LATENT_HEAT, "latent heat".into(), "J/kg", material.latent_heat));
        }
        for ((least, most), what, unit, value) in values {
            if !(least..=most).contains(&value) {
                found.push(format!(
                    "materials.{}: its {what} is {value:.4} {unit}, soils have {least:e} to {most:e}: is it in the units of its \
                     key, J and not kJ?",
                    material.name
                ));
            }
        }
    }
    found
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
