//! The state from which particles start, and what their size makes of the shapes of regions.

use std::sync::Arc;

use frazil_core::boundary::pipe::Sink;
use frazil_core::physics::latent_heat::Materials;
use frazil_core::physics::thermal::Thermal;
use frazil_core::space::lattice::Lattice;
use frazil_core::space::volumes::Volumes;
use frazil_scene::Scene;
use frazil_scene::region::{Cell, Part};
use glam::DVec2;

/// Part of a region's volume by which its particles may differ from it without a word.
const TOLD: f64 = 0.01;

/// Enthalpies (J/m3) with which particles start; empty if all are zero. A particle that the edge of a region cuts starts with the heat of its parts, so that no heat is
/// lost or made wherever edges fall. Off the lattice, particles are taken as squares around their positions.
pub fn enthalpies(scene: &Scene, materials: &Materials, lattice: &Lattice, cloud: Option<&[DVec2]>) -> Arc<[f64]> {
    let (initial, zero) = (scene.initial_temperature, materials.thermals[0].zero_temperature);
    if !scene.has_uneven_start() && initial == zero {
        return Arc::new([]);
    }
    let carried = |thermal: &Thermal, states: &[(f64, f64)]| -> f64 {
        // Exactly at rest where nothing else is said.
        let enthalpy = |temperature: f64| if temperature == zero { 0.0 } else { thermal.enthalpy(temperature) };
        states.iter().map(|(temperature, share)| share * enthalpy(*temperature)).sum()
    };
    let enthalpy = |(i, place): (usize, DVec2)| {
        let cell = Cell::around(place, lattice.spacing);
        if materials.law_of.is_empty() {
            return carried(materials.of(i), &scene.starts_in(&cell));
        }
        let elsewhere = scene.initial_in(&cell);
        let part = |part: Part| {
            let thermal = &materials.thermals[part.material];
            let own = part.temperature.map(|temperature| [(temperature, 1.0)]);
            part.share * carried(thermal, own.as_ref().map_or(elsewhere.as_slice(), |own| own))
        };
        scene.parts_of(&cell).into_iter().map(part).sum()
    };
    match cloud {
        Some(places) => places.iter().copied().enumerate().map(enthalpy).collect(),
        None => lattice.positions().into_iter().enumerate().map(enthalpy).collect(),
    }
}

/// The same without the heat of ground in whose place pipes stand that work from the start on: its particles start with what is
/// left of them once it has come to the temperature of the pipe. It would have to be frozen before the ground around the pipe is.
pub fn without_displaced(
    start: Arc<[f64]>,
    sinks: &[Sink],
    materials: &Materials,
    volumes: &Volumes,
    count: usize,
) -> Arc<[f64]> {
    let mut sinks = sinks.iter().filter(|sink| sink.radius > 0.0 && sink.works(0.0)).peekable();
    if sinks.peek().is_none() {
        return start;
    }
    let mut left = if start.is_empty() { vec![0.0; count] } else { start.to_vec() };
    for sink in sinks {
        for (index, weight) in &sink.sample {
            let particle = *index as usize;
            let taken = sink.content(materials.of(particle), left[particle]) - left[particle];
            left[particle] += taken * sink.share * weight * sink.area() / volumes.of(particle);
        }
    }
    left.into()
}

/// Regions whose particles of their material, which belong to them by their centres, fill another volume than the region, in
/// words.
pub fn volume_errors(scene: &Scene, lattice: &Lattice, cloud: Option<&[DVec2]>) -> Vec<String> {
    let regions = scene.regions.iter().enumerate().filter(|(_, region)| region.material.is_some());
    let told = regions.filter_map(|(number, region)| {
        let (mut covered, mut assigned) = (0.0, 0.0);
        let mut see = |place: DVec2| {
            covered += region.shape.share_of(&Cell::around(place, lattice.spacing));
            assigned += f64::from(u8::from(region.shape.contains(place)));
        };
        match cloud {
            Some(places) => places.iter().copied().for_each(&mut see),
            None => lattice.positions().into_iter().for_each(&mut see),
        }
        let error = assigned / covered - 1.0;
        (error.is_nan() || error.abs() > TOLD).then(|| {
            if assigned == 0.0 {
                return format!("region {number} contains no particle centre: its material is not represented");
            }
            format!(
                "the material of region {number} fills {:.1} % {} than the region: particles belong to it by their centres",
                100.0 * error.abs(),
                if error > 0.0 { "more" } else { "less" }
            )
        })
    });
    told.collect()
}
