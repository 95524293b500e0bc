//! Soils that studies know by name.

use frazil_scene::{Change, Scene, Section, Units, soils};
use toml::{Table, Value};

/// What a section of a study changes of the ground: the soil that it names, and then what it sets.
pub(super) fn changes(section: &mut Section<'_>) -> Vec<Change> {
    let soils = soils();
    let words: Vec<(&str, (&String, &Value))> = soils.iter().map(|soil| (soil.0.as_str(), soil)).collect();
    let soil = section.optional_choice("soil", &words).map(|(name, material)| Change {
        key: "materials".to_owned(),
        value: Value::Table(Table::from_iter([(name.clone(), material.clone())])).to_string(),
        spot: section.spot("soil"),
    });
    soil.into_iter().chain(section.changes("set")).collect()
}

/// Between which soils lie, with room beyond (W/mK, J/kg, J/m3K): dry peat conducts some 0.1, quartz 8 and
/// ice 2.2 W/mK; a kilogram of ice takes 334 kJ, and of ground with a hundredth of water in it 3 kJ; dry sand stores 1.2 and water
/// 4.2 MJ/m3K.
const CONDUCTIVITY: (f64, f64) = (0.05, 20.0);
const LATENT_HEAT: (f64, f64) = (2e3, 3.4e5);
const CAPACITY: (f64, f64) = (4e5, 6e6);

/// Materials of the ground around freeze pipes that have what no soil has, as where kJ were given for J.
pub fn odd(scene: &Scene) -> Vec<String> {
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
        if material.freezes() {
            values.push((LATENT_HEAT, "latent heat".into(), "J/kg", material.latent_heat));
        }
        for ((least, most), what, unit, value) in values {
            if !(least..=most).contains(&value) {
                found.push(format!(
                    "materials.{}: its {what} is {value:.4} {unit}, soils have {least:e} to {most:e}: check its unit, J \
                     and not kJ?",
                    material.name
                ));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use frazil_scene::read_section;

    use super::*;
    use crate::bundled;

    fn of(soil: &str) -> Scene {
        let changed = read_section(&format!("soil = \"{soil}\""), "s.toml", Units::Si, |root| Ok(changes(root)));
        let pairs: Vec<_> = changed.expect("a soil").into_iter().map(|change| (change.key, change.value)).collect();
        bundled::scene("frozen-wall-sand", &pairs).expect("a scene")
    }

    #[test]
    fn a_ring_may_be_of_any_soil() {
        let soils = soils();
        assert!(soils.len() > 3);
        for name in soils.keys() {
            assert_eq!(of(name).materials[0].name, *name);
        }
    }

    #[test]
    fn soils_are_those_of_the_scenes_they_come_from() {
        for (soil, scene) in [("sand", "frozen-wall-sand"), ("clay", "frozen-wall-clay")] {
            assert_eq!(of(soil).materials, bundled::scene(scene, &[]).expect("a scene").materials);
        }
    }
}
