//! Which particles of a body freeze at one temperature.

use crate::physics::latent_heat::Materials;
use crate::physics::thermal::Thermal;

/// A material that freezes at one temperature.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sharp {
    /// Enthalpies (J/m3) of a particle at the freezing point, frozen and unfrozen.
    pub(super) interval: (f64, f64),
    /// Potential (W/m) at the freezing point.
    pub(super) potential: f64,
    /// Largest distance of a potential from it.
    pub(super) most: f64,
}

/// The materials that freeze at one temperature, and the stretches of particles whose fronts are followed.
pub(super) fn stretches(
    materials: &Materials,
    temperatures: (f64, f64),
    count: usize,
    mixed: impl Fn(usize) -> bool,
) -> (Vec<Sharp>, Vec<(u32, u32, u32)>) {
    let (mut sharp, mut stretches) = (Vec::new(), Vec::<(u32, u32, u32)>::new());
    let of_material: Vec<Option<u32>> = materials
        .thermals
        .iter()
        .map(|thermal| {
            if !thermal.curve.is_sharp() {
                return None;
            }
            let interval = interval(thermal);
            // As the law itself has it, to the last bit.
            let potential = thermal.law.potential(0.5 * (interval.0 + interval.1));
            let far = |temperature: f64| (thermal.potential_at(temperature) - potential).abs();
            sharp.push(Sharp { interval, potential, most: far(temperatures.0).max(far(temperatures.1)) });
            Some(sharp.len() as u32 - 1)
        })
        .collect();
    for particle in 0..count {
        let own = of_material.get(materials.law(particle)).copied().flatten().filter(|_| !mixed(particle));
        match (own, stretches.last_mut()) {
            (None, _) => {}
            (Some(own), Some(last)) if last.2 == own && last.1 as usize == particle => last.1 += 1,
            (Some(own), _) => stretches.push((particle as u32, particle as u32 + 1, own)),
        }
    }
    (sharp, stretches)
}

/// Enthalpies (J/m3) that a particle carries at the freezing point, frozen and unfrozen.
fn interval(thermal: &Thermal) -> (f64, f64) {
    let unfrozen = thermal.enthalpy(thermal.curve.freezing_point());
    (unfrozen - thermal.curve.latent_heat(), unfrozen)
}
