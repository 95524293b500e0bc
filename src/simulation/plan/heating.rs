//! Regions that release heat.

use frazil_core::balances::heated::{HeatSource, Heated, Power, SourcePart};
use frazil_core::solvers::balance::Balance;
use frazil_scene::region::Cell;
use frazil_scene::{Region, Scene};

use crate::plan::prepared::Prepared;

/// A balance with the sources of heat of a scene.
pub(super) fn heated(balance: Box<dyn Balance>, scene: &Scene, prepared: &Prepared) -> Box<dyn Balance> {
    Heated::or_bare(balance, sources(scene, prepared))
}

/// The sources of heat of a scene: each particle releases by the share of its cell that lies in the region, a particle that
/// several regions cover by all of them.
pub(super) fn sources(scene: &Scene, prepared: &Prepared) -> Vec<HeatSource> {
    let source = |(number, region): (usize, &Region)| {
        let power = region.heat.clone()?;
        Some(HeatSource { region: number, power, parts: parts(scene, region, prepared) })
    };
    scene.regions.iter().enumerate().filter_map(source).collect()
}

/// The ground of a region, and that of it which is dug.
fn parts(scene: &Scene, region: &Region, prepared: &Prepared) -> Vec<SourcePart> {
    let part = |until| SourcePart { shares: Vec::new(), volume: 0.0, places: Vec::new(), until };
    let by_place = matches!(region.heat, Some(Power::Formula(_)));
    let (mut stays, mut dug) = (part(f64::INFINITY), part(scene.excavation.as_ref().map_or(0.0, |shaft| shaft.start)));
    for i in 0..prepared.count() {
        let place = prepared.place(i);
        let share = scene.share_of(&region.shape, &Cell::around(place, prepared.lattice.spacing));
        if share > 0.0 {
            let in_shaft = scene.excavation.as_ref().is_some_and(|shaft| place.length() < shaft.radius);
            let part = if in_shaft { &mut dug } else { &mut stays };
            part.shares.push((i as u32, share));
            let volume = share * prepared.volumes.of(i);
            part.volume += volume;
            part.places.extend(by_place.then_some((place, volume)));
        }
    }
    [stays, dug].into_iter().filter(|part| !part.shares.is_empty()).collect()
}
