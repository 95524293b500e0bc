//! In which phase each particle is, in a byte.

use crate::instruction_set::widest;
use crate::memory::HeapSize;
use crate::physics::sharp_stretches::{Sharp, Stretch};

/// Particles that are looked at together: mostly none of them freezes.
const LOOK: usize = 64;

/// What a particle that freezes is.
const FREEZING: u8 = 0;

/// What two neighbours add up to of which one is frozen, 1, and one is not, 2. One at an end of the freezing interval is 4,
/// one whose front is not followed 8.
const APART: u8 = 3;

/// The phases of all particles.
#[derive(Debug, Clone)]
pub(super) struct Phases(Vec<u8>);

impl Phases {
    /// Of so many particles, none of which is followed.
    pub(super) fn new(count: usize) -> Self {
        Phases(vec![8; count])
    }

    /// Those of a state of enthalpies (J/m3), in stretches whose fronts are followed.
    pub(super) fn update(&mut self, (materials, stretches): (&[Sharp], &[Stretch]), enthalpy: &[f64]) {
        for (first, end, sharp) in stretches {
            let range = *first as usize..*end as usize;
            tell(&enthalpy[range.clone()], materials[*sharp as usize].interval, &mut self.0[range]);
        }
    }

    /// Adds the particles of a stretch that freeze.
    pub(super) fn find_freezing(&self, (first, end, _): Stretch, freezing: &mut Vec<u32>) {
        find_freezing(&self.0[first as usize..end as usize], first, freezing);
    }

    /// Adds neighbours of which one is frozen and the other not; these are given by the first that have one, one past the
    /// last, and how many numbers further it is.
    pub(super) fn find_apart(&self, neighbours: &[(u32, u32, u32)], apart: &mut Vec<(u32, u32)>) {
        find_apart(&self.0, neighbours, apart);
    }
}

widest!(tell, tell_each, (enthalpy: &[f64], interval: (f64, f64), phases: &mut [u8]));

/// Tells the phases of particles.
#[inline(always)]
fn tell_each(enthalpy: &[f64], (frozen, unfrozen): (f64, f64), phases: &mut [u8]) {
    for (phase, own) in phases.iter_mut().zip(enthalpy) {
        let between = (*own > frozen) & (*own < unfrozen);
        let outside = u8::from(*own < frozen) + 2 * u8::from(*own > unfrozen);
        *phase = if between {
            FREEZING
        } else if outside == 0 {
            4
        } else {
            outside
        };
    }
}

widest!(find_freezing, find_freezing_each, (phases: &[u8], first: u32, freezing: &mut Vec<u32>));

#[inline(always)]
fn find_freezing_each(phases: &[u8], first: u32, freezing: &mut Vec<u32>) {
    let (looks, rest) = phases.as_chunks::<LOOK>();
    for (look, first) in looks.iter().zip((first..).step_by(LOOK)) {
        if any_freezes(look) {
            find_closely(look, first, freezing);
        }
    }
    find_closely(rest, first + (phases.len() - rest.len()) as u32, freezing);
}

/// Whether any of some particles freezes. Answers as wide as phases stay where these are compared.
#[inline(always)]
fn any_freezes<const COUNT: usize>(phases: &[u8; COUNT]) -> bool {
    phases.iter().fold(0, |any, phase| any | u8::from(*phase == FREEZING)) != 0
}

/// The same as [`find_freezing`], of few particles.
#[inline(always)]
fn find_closely(phases: &[u8], first: u32, freezing: &mut Vec<u32>) {
    let (groups, rest) = phases.as_chunks::<8>();
    let mut one_by_one = |phases: &[u8], first: u32| {
        freezing.extend((first..).zip(phases).filter(|(_, phase)| **phase == FREEZING).map(|(particle, _)| particle));
    };
    for (group, first) in groups.iter().zip((first..).step_by(8)) {
        if any_freezes(group) {
            one_by_one(group, first);
        }
    }
    one_by_one(rest, first + (phases.len() - rest.len()) as u32);
}

widest!(find_apart, find_apart_each, (phases: &[u8], neighbours: &[(u32, u32, u32)], apart: &mut Vec<(u32, u32)>));

#[inline(always)]
fn find_apart_each(phases: &[u8], neighbours: &[(u32, u32, u32)], apart: &mut Vec<(u32, u32)>) {
    for (first, end, shift) in neighbours {
        let own = &phases[*first as usize..*end as usize];
        let others = &phases[(first + shift) as usize..(end + shift) as usize];
        let (own_looks, own_rest) = own.as_chunks::<LOOK>();
        let (other_looks, other_rest) = others.as_chunks::<LOOK>();
        let mut note = |at: usize, own: &[u8], others: &[u8]| {
            for (k, (own, other)) in own.iter().zip(others).enumerate() {
                if own + other == APART {
                    let particle = first + (at + k) as u32;
                    apart.push((particle, particle + shift));
                }
            }
        };
        for (look, (own, others)) in own_looks.iter().zip(other_looks).enumerate() {
            if own.iter().zip(others).fold(0, |any, (own, other)| any | u8::from(own + other == APART)) != 0 {
                note(look * LOOK, own, others);
            }
        }
        let rest = own_rest.iter().zip(other_rest);
        if rest.fold(0, |any, (own, other)| any | u8::from(own + other == APART)) != 0 {
            note(own.len() - own_rest.len(), own_rest, other_rest);
        }
    }
}

impl HeapSize for Phases {
    fn heap_size(&self) -> usize {
        self.0.heap_size()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// As if particles were looked at one by one.
    fn plainly(own: f64, (frozen, unfrozen): (f64, f64)) -> u8 {
        if own < frozen {
            1
        } else if own > unfrozen {
            2
        } else if own > frozen && own < unfrozen {
            FREEZING
        } else {
            4
        }
    }

    proptest! {
        /// Particles that freeze, and neighbours between which a front lies, are found wherever they are.
        #[test]
        fn phases_are_found(
            states in prop::collection::vec(prop_oneof![Just(-1.0), Just(0.0), -2.0..3.0f64, Just(1.0), Just(f64::NAN)], 2..300),
            first in 0usize..300, shift in 1usize..150,
        ) {
            let count = states.len();
            let interval = (0.0, 1.0);
            let material = Sharp { interval, potential: 0.0, most: 1.0 };
            let first = first % count;
            let stretches = [(first as u32, count as u32, 0)];
            let mut phases = Phases::new(count);
            phases.update((&[material], &stretches), &states);
            let plain: Vec<u8> =
                (0..count).map(|k| if k < first { 8 } else { plainly(states[k], interval) }).collect();
            prop_assert_eq!(&phases.0, &plain);
            let mut freezing = Vec::new();
            phases.find_freezing(stretches[0], &mut freezing);
            let expected: Vec<u32> = (0..count).filter(|k| plain[*k] == FREEZING).map(|k| k as u32).collect();
            prop_assert_eq!(freezing, expected);
            let shift = shift % count;
            let mut apart = Vec::new();
            phases.find_apart(&[(0, (count - shift) as u32, shift as u32)], &mut apart);
            let are_apart = |k: &usize| [plain[*k], plain[*k + shift]] == [1, 2] || [plain[*k], plain[*k + shift]] == [2, 1];
            let expected: Vec<(u32, u32)> =
                (0..count - shift).filter(are_apart).map(|k| (k as u32, (k + shift) as u32)).collect();
            prop_assert_eq!(apart, expected);
        }
    }
}
