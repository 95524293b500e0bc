//! Unsaturated water and its solute in words: heads, saturations, soils.

use frazil_core::physics::retention::Retention;
use frazil_core::physics::retention::moisture::Soil;
use frazil_core::physics::retention::scale::{DRY, head, suction};
use frazil_core::physics::retention::shape::RetentionCurve;
use frazil_core::physics::solute_material::{SoluteMaterial, Tortuosity};
use frazil_core::series::Series;
use frazil_plots::page::Fact;
use frazil_plots::style::number;
use frazil_scene::SoluteWall;

use super::Words;

/// The state of ground at a place of the scale of heads.
pub(super) fn state(words: &Words<'_>, place: f64) -> String {
    if place <= DRY {
        return "dry".into();
    }
    let head = words.with(head(place), "m");
    let saturation = |soil: &Soil| if place >= 0.0 { 1.0 } else { soil.retention.saturation(suction(place)) };
    let mut all: Vec<String> =
        words.scene.materials.iter().filter_map(|m| m.soil.as_ref()).map(|soil| number(saturation(soil), 4)).collect();
    all.dedup();
    format!("head {head}, saturation {}", all.join(" or "))
}

/// Rain, or a face at which water seeps out.
pub(super) fn runoff(words: &Words<'_>, rain: &Series, ponding: &Series) -> String {
    if rain.constant() == Some(0.0) {
        return "water seeps out where the ground is saturated".into();
    }
    let stands = match ponding.constant() {
        Some(0.0) => "no ponding".to_owned(),
        _ => format!("ponding up to {}", words.series(ponding, "m")),
    };
    format!("rain {}, {stands}, the rest runs off", words.series(rain, "m/s"))
}

/// A soil.
pub(super) fn soil(words: &Words<'_>, soil: &Soil) -> String {
    let mut all = vec![
        retention(words, &soil.retention),
        format!("water content {} to {}", number(soil.residual, 4), number(soil.saturated, 4)),
        format!("conductivity when saturated {}", words.with(soil.conductivity, "m/s")),
        format!("specific storage {}", words.with(soil.storage, "1/m")),
    ];
    all.extend(soil.solute.as_ref().map(|solute| format!("solute: {}", material(words, solute))));
    all.join("; ")
}

fn retention(words: &Words<'_>, retention: &Retention) -> String {
    match retention {
        Retention::VanGenuchten(curve) => format!(
            "van Genuchten, alpha {}, n {}, connectivity {}",
            words.with(curve.alpha, "1/m"),
            number(curve.exponent, 4),
            number(curve.connectivity, 4)
        ),
        Retention::BrooksCorey(curve) => {
            format!("Brooks-Corey, air entry {}, index {}", words.with(curve.air_entry, "m"), number(curve.index, 4))
        }
        Retention::Gardner(curve) => format!("Gardner, alpha {}", words.with(curve.alpha, "1/m")),
        Retention::Table(table) => format!("by a table, dry at a suction of {}", words.with(table.driest(), "m")),
    }
}

fn material(words: &Words<'_>, solute: &SoluteMaterial) -> String {
    let tortuosity = match solute.tortuosity {
        Tortuosity::None => "",
        Tortuosity::MillingtonQuirk { .. } => " with the tortuosity of Millington and Quirk",
    };
    let (along, across) = (solute.longitudinal_dispersivity, solute.transverse_dispersivity);
    let parts = [
        (true, format!("diffusion {}{tortuosity}", words.with(solute.diffusion, "m²/s"))),
        (along > 0.0, format!("dispersivity {} along and {} across", words.with(along, "m"), words.with(across, "m"))),
        (solute.sorption > 0.0, format!("sorbed: {} times the concentration", number(solute.sorption, 4))),
        (solute.decay > 0.0, format!("decay {}", words.with(solute.decay, "1/s"))),
    ];
    parts.into_iter().filter(|part| part.0).map(|part| part.1).collect::<Vec<_>>().join(", ")
}

/// Concentrations at the start and at the walls.
pub(super) fn solute(words: &Words<'_>) -> Vec<Fact> {
    let Some(solute) = &words.scene.solute else { return Vec::new() };
    let region = |(k, own): (usize, &Option<f64>)| own.map(|own| format!("; {} in region {k}", number(own, 4)));
    let regions: String = solute.regions.iter().enumerate().filter_map(region).collect();
    let wall = |wall: &SoluteWall| {
        let name = format!("{}: concentration", words.patch(wall.patch));
        Fact::new(name, words.series(&wall.concentration, ""))
    };
    let start = Fact::new("Initial concentration", format!("{}{regions}", number(solute.initial, 4)));
    [start].into_iter().chain(solute.walls.iter().map(wall)).collect()
}

#[cfg(test)]
mod tests {
    use frazil_scene::Scene;

    use crate::bundled;
    use crate::words::parameters;

    #[test]
    fn a_scene_of_water_says_heads_and_saturations_and_no_temperature() {
        let text = "title = \"Column\"\nsource = \"none\"\nbalance = \"water\"\n\
                    domain.line = { length_m = 0.1 }\ntime = { duration_days = 1, outputs = 2 }\n\
                    initial = { saturation = 0, concentration = 0 }\n\
                    walls = { left = { head_m = -1, concentration = 1 }, right = { water_flux_m_per_s = 1e-9 } }\n\
                    reference.kind = \"none\"\nmethod.local.spacing_m = 0.01\n\
                    [materials.soil]\nretention = { law = \"van-genuchten\", alpha_per_m = 1, n = 2 }\n\
                    residual_water_content = 0.1\nsaturated_water_content = 0.4\nconductivity_m_per_s = 1e-9\n\
                    solute = { diffusion_m2_per_s = 9e-11 }\n";
        let scene = Scene::read(text, "column", "column", &[], bundled::methods()).expect("a scene");
        let said: Vec<String> =
            parameters(&scene).into_iter().map(|fact| format!("{}: {}", fact.name, fact.value)).collect();
        let said = said.join("\n");
        for words in [
            "Start: dry",
            "Wall left: head −1 m, saturation 0.7071",
            "Wall right: water flux into the body: 1 · 10⁻⁹ m/s",
            "Material soil: van Genuchten, alpha 1 1/m, n 2, connectivity 0.5; water content 0.1 to 0.4",
            "solute: diffusion 9 · 10⁻¹¹ m²/s",
            "Wall left: concentration: 1",
        ] {
            assert!(said.contains(words), "{words} in\n{said}");
        }
        assert!(!said.contains("°C") && !said.contains("heat"), "{said}");
    }
}
