//! Which particles of a body freeze at one temperature.

use crate::physics::latent_heat::Materials;

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

impl Sharp {
    /// Enthalpy (J/m3) of a particle half frozen.
    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.interval.0 + self.interval.1)
    }
}

/// Neighbouring particles of one material whose fronts are followed: the first, one past the last, and which of the
/// materials that freeze at one temperature.
pub(super) type Stretch = (u32, u32, u32);

/// Which of the materials a particle is of whose front is followed.
pub(super) fn material_of(stretches: &[Stretch], particle: u32) -> u32 {
    stretches[stretches.partition_point(|stretch| stretch.1 <= particle)].2
}

/// The materials that freeze at one temperature, and the stretches of particles whose fronts are followed.
pub(super) fn stretches(
    materials: &Materials,
    temperatures: (f64, f64),
    count: usize,
    mixed: impl Fn(usize) -> bool,
) -> (Vec<Sharp>, Vec<Stretch>) {
    let (mut sharp, mut stretches) = (Vec::new(), Vec::<Stretch>::new());
    let of_material: Vec<Option<u32>> = materials
        .thermals
        .iter()
        .map(|thermal| {
            let (interval, potential) = (thermal.freezing_interval()?, thermal.front_potential()?);
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
