//! Which particles of a body freeze at one temperature.

use crate::instruction_set::widest;
use crate::physics::latent_heat::Materials;

/// Particles that are looked at together: mostly none of them freezes.
const LOOK: usize = 32;

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

widest!(find_widely, find_each, (enthalpy: &[f64], first: u32, range: (f64, f64), freezing: &mut Vec<u32>));

/// Finds the particles that freeze, the first of which has the number `first`: those whose enthalpies (J/m3) lie within a range.
#[inline]
pub(super) fn find(enthalpy: &[f64], first: u32, range: (f64, f64), freezing: &mut Vec<u32>) {
    find_widely(enthalpy, first, range, freezing);
}

#[inline(always)]
fn find_each(enthalpy: &[f64], first: u32, range: (f64, f64), freezing: &mut Vec<u32>) {
    let (looks, rest) = enthalpy.as_chunks::<LOOK>();
    for (look, first) in looks.iter().zip((first..).step_by(LOOK)) {
        if any_freezes(look, range) {
            find_closely(look, first, range, freezing);
        }
    }
    // Those left over together with some before them, as long as none of all these freezes.
    if enthalpy.last_chunk::<LOOK>().is_none_or(|look| any_freezes(look, range)) {
        find_closely(rest, first + (enthalpy.len() - rest.len()) as u32, range, freezing);
    }
}

/// Whether an enthalpy lies within a range.
#[inline(always)]
fn freezes(own: f64, (frozen, unfrozen): (f64, f64)) -> bool {
    (own > frozen) & (own < unfrozen)
}

/// Whether any does. Answers as wide as enthalpies stay where these are compared.
#[inline(always)]
fn any_freezes<const COUNT: usize>(look: &[f64; COUNT], range: (f64, f64)) -> bool {
    look.iter().fold(0, |any, own| any | u64::from(freezes(*own, range))) != 0
}

/// The same as [`find`], mostly of particles of which some freeze.
#[inline(always)]
fn find_closely(enthalpy: &[f64], first: u32, range: (f64, f64), freezing: &mut Vec<u32>) {
    let (groups, rest) = enthalpy.as_chunks::<8>();
    let one_by_one = |own: &[f64], first: u32, freezing: &mut Vec<u32>| {
        freezing.extend((first..).zip(own).filter(|(_, own)| freezes(**own, range)).map(|(particle, _)| particle));
    };
    for (group, first) in groups.iter().zip((first..).step_by(8)) {
        if any_freezes(group, range) {
            one_by_one(group, first, freezing);
        }
    }
    one_by_one(rest, first + (enthalpy.len() - rest.len()) as u32, freezing);
}
