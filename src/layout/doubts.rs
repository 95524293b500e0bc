//! What can be run but is hardly meant: told before anything is.

use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;

use super::study::Study;
use super::{soils, strata};

/// Reach of cold: thickness of ground between pipes and the outer wall, over the root of its diffusivity times the
/// time, below which the wall is felt. In `frozen-wall-sand` under `local` the load after 120 days is 1 % off with the wall at
/// some 9.2 m, 4.2 m from the pipes.
const REACH: f64 = 1.7;

/// Doubts about a study, each once.
pub fn of(study: &Study<'_>) -> Vec<String> {
    let mut found = Vec::new();
    for pair in study.ground.strata.windows(2) {
        let (above, below) = (&pair[0], &pair[1]);
        if below.from > above.to + strata::SAME {
            found.push(format!(
                "strata: \"{}\" ends at {} m and \"{}\" begins at {} m: the ground between them is not defined, \
                 and the load of the shaft excludes it",
                above.name, above.to, below.name, below.from
            ));
        }
    }
    for layout in study.compared() {
        let mut doubts = soils::odd(&layout.scene);
        let freezing = layout.scene.materials[0].freezing_point;
        if let Some(design) = study.design_of(layout).filter(|design| design.mean_temperature_c >= freezing) {
            doubts.push(format!(
                "design: mean_temperature_c: found {}, all frozen ground is colder: it freezes at {freezing}",
                design.mean_temperature_c
            ));
        }
        doubts.extend(near_wall(&layout.scene));
        for doubt in doubts {
            // Layouts of the same ground have the same.
            if !found.contains(&doubt) {
                found.push(doubt);
            }
        }
    }
    found
}

/// Whether cold reaches the outer wall before the run ends, as far as the ground alone tells.
fn near_wall(scene: &Scene) -> Option<String> {
    let Domain::Ring { outer_radius, .. } = scene.domain else { return None };
    // Water brings heat from farther than any wall; what is symmetric there is meant as another shaft.
    if scene.flow.is_some() || scene.wall(WallId::Outer) == Some(&Condition::Symmetry) {
        return None;
    }
    let farthest =
        scene.rings.iter().flat_map(|ring| ring.pipes()).map(|pipe| pipe.x.hypot(pipe.y)).fold(0.0, f64::max);
    let material = &scene.materials[0];
    let conductivity = material.unfrozen.conductivity * scene.along.max_element();
    let diffusivity = conductivity / (material.density * material.unfrozen.heat_capacity);
    let reach = REACH * (diffusivity * scene.duration).sqrt();
    (outer_radius - farthest < reach).then(|| {
        format!(
            "domain.ring.outer_radius_m: found {outer_radius}, {:.1} m from the pipes, but the cooled zone extends \
             about {reach:.1} m in {:.0} days: the wall affects the result, set {:.0} or more",
            outer_radius - farthest,
            scene.duration / super::answers::DAY,
            (farthest + reach).ceil()
        )
    })
}
