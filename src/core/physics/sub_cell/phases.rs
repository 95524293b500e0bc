//! In which phase each particle is, in a bit for each phase.

use super::numbers::{Flags as _, Kind, LANES, Numbers as _, by_kind};
use crate::instruction_set::widest;
use crate::memory::HeapSize;
use crate::parts::{PART, in_parts};
use crate::physics::sharp_stretches::{Sharp, Stretch};
use crate::team::Team;

/// Particles in a word.
const WORD: usize = u64::BITS as usize;

/// Words in which neighbours are looked for together.
const AT_ONCE: usize = 8;

/// The phases of all particles: those at an end of the freezing interval, and those whose fronts are not followed, are in none.
#[derive(Debug, Clone)]
pub(super) struct Phases {
    frozen: Vec<u64>,
    freezing: Vec<u64>,
    unfrozen: Vec<u64>,
}

/// A word of each phase.
type Words = [u64; 3];

impl Phases {
    /// Of so many particles, none of which is followed.
    pub(super) fn new(count: usize) -> Self {
        // More, so that all words that are looked at together have one behind them.
        let words = || vec![0; count / WORD + 2 + AT_ONCE];
        Phases { frozen: words(), freezing: words(), unfrozen: words() }
    }

    /// Those of a state of enthalpies (J/m3), in stretches whose fronts are followed.
    pub(super) fn update(
        &mut self,
        team: Option<&Team>,
        (materials, stretches): (&[Sharp], &[Stretch]),
        enthalpy: &[f64],
    ) {
        for (first, end, sharp) in stretches {
            let (first, end, interval) = (*first as usize, *end as usize, materials[*sharp as usize].interval);
            // Words that a stretch fills, and its ends, which others may go on from.
            let (from, until) = (first.div_ceil(WORD), end / WORD);
            if from > until {
                self.set_some(enthalpy, (first, end), interval);
                continue;
            }
            self.set_some(enthalpy, (first, from * WORD), interval);
            let range = from..until;
            let told = [&mut self.frozen, &mut self.freezing, &mut self.unfrozen];
            let [frozen, freezing, unfrozen] = told.map(|words| words[range.clone()].chunks_mut(PART / WORD));
            let parts = enthalpy[from * WORD..until * WORD].chunks(PART).zip(frozen.zip(freezing).zip(unfrozen));
            in_parts(team, (until - from) * WORD, parts, |(enthalpy, ((frozen, freezing), unfrozen))| {
                tell_widely(enthalpy, interval, (frozen, freezing, unfrozen));
            });
            self.set_some(enthalpy, (until * WORD, end), interval);
        }
    }

    /// Sets those of the particles of one word that are in a range.
    fn set_some(&mut self, enthalpy: &[f64], (first, end): (usize, usize), interval: (f64, f64)) {
        if first == end {
            return;
        }
        let mut found = [0; 3];
        tell_some_widely(&enthalpy[first..end], interval, &mut found);
        let (word, shift) = (first / WORD, first % WORD);
        let others = !((u64::MAX >> (WORD - (end - first))) << shift);
        let own = [&mut self.frozen, &mut self.freezing, &mut self.unfrozen];
        for (words, found) in own.into_iter().zip(found) {
            words[word] = words[word] & others | found << shift;
        }
    }

    /// Adds the particles of a stretch that freeze.
    pub(super) fn find_freezing(&self, (first, end, _): Stretch, freezing: &mut Vec<u32>) {
        let (first, end) = (first as usize, end as usize);
        for word in first / WORD..end.div_ceil(WORD) {
            let mut bits = self.freezing[word];
            if bits == 0 {
                continue;
            }
            let start = word * WORD;
            bits &= u64::MAX << first.saturating_sub(start);
            bits &= u64::MAX >> (start + WORD).saturating_sub(end);
            add_all(bits, start as u32, |particle| freezing.push(particle));
        }
    }

    /// Adds neighbours of which one is frozen and the other not; these are given by the first that have one, one past the
    /// last, and how many numbers further it is.
    pub(super) fn find_apart(&self, neighbours: &[(u32, u32, u32)], apart: &mut Vec<(u32, u32)>) {
        find_apart_widely(neighbours, (&self.frozen, &self.unfrozen), apart);
    }
}

widest!(find_apart_widely, find_apart_of, (neighbours: &[(u32, u32, u32)], words: (&[u64], &[u64]), apart: &mut Vec<(u32, u32)>));

#[inline(always)]
fn find_apart_of(neighbours: &[(u32, u32, u32)], (frozen, unfrozen): (&[u64], &[u64]), apart: &mut Vec<(u32, u32)>) {
    for (first, end, shift) in neighbours {
        let (first, end) = (*first as usize, *end as usize);
        for word in (first / WORD..end.div_ceil(WORD)).step_by(AT_ONCE) {
            let other = word * WORD + *shift as usize;
            let (other, by) = (other / WORD, (other % WORD) as u32);
            let [own_frozen, own_unfrozen] = [&frozen[word..][..AT_ONCE], &unfrozen[word..][..AT_ONCE]];
            let [others_frozen, others_unfrozen] = [&frozen[other..][..AT_ONCE + 1], &unfrozen[other..][..AT_ONCE + 1]];
            let (mut found, mut any) = ([0; AT_ONCE], 0);
            for k in 0..AT_ONCE {
                let frozen = others_frozen[k] >> by | others_frozen[k + 1] << 1 << (WORD as u32 - 1 - by);
                let unfrozen = others_unfrozen[k] >> by | others_unfrozen[k + 1] << 1 << (WORD as u32 - 1 - by);
                found[k] = own_frozen[k] & unfrozen | frozen & own_unfrozen[k];
                any |= found[k];
            }
            // Few neighbours are apart.
            if any == 0 {
                continue;
            }
            for (bits, word) in found.into_iter().zip(word..end.div_ceil(WORD)) {
                let start = word * WORD;
                let bits =
                    bits & u64::MAX << first.saturating_sub(start) & u64::MAX >> (start + WORD).saturating_sub(end);
                add_all(bits, start as u32, |particle| apart.push((particle, particle + shift)));
            }
        }
    }
}

/// Does something with the number of each bit, from a first number on.
#[inline(always)]
fn add_all(mut bits: u64, first: u32, mut add: impl FnMut(u32)) {
    while bits != 0 {
        add(first + bits.trailing_zeros());
        bits &= bits - 1;
    }
}

/// Adds a bit for each of a group of enthalpies, by phase; what is no number is in none.
#[inline(always)]
fn add_group<K: Kind<LANES>>(
    kind: K,
    group: usize,
    enthalpy: &[f64; LANES],
    limits: [K::Numbers; 2],
    found: &mut Words,
) {
    let ([frozen, unfrozen], own) = (limits, kind.load(enthalpy));
    let freezing = frozen.is_less(own) & own.is_less(unfrozen);
    let phases = [own.is_less(frozen).bits(), freezing.bits(), unfrozen.is_less(own).bits()];
    for (word, bits) in found.iter_mut().zip(phases) {
        *word |= bits << (group * LANES);
    }
}

by_kind!(tell_some_widely, tell_some, (enthalpy: &[f64], interval: (f64, f64), found: &mut Words));

/// Tells the phases of particles, no more than are in a word.
#[inline(always)]
fn tell_some(kind: impl Kind<LANES>, enthalpy: &[f64], (frozen, unfrozen): (f64, f64), found: &mut Words) {
    let limits = [kind.of(frozen), kind.of(unfrozen)];
    let (groups, rest) = enthalpy.as_chunks::<LANES>();
    for (group, enthalpy) in groups.iter().enumerate() {
        add_group(kind, group, enthalpy, limits, found);
    }
    if !rest.is_empty() {
        let mut last = [f64::NAN; LANES];
        for (last, enthalpy) in last.iter_mut().zip(rest) {
            *last = *enthalpy;
        }
        add_group(kind, groups.len(), &last, limits, found);
    }
}

/// Words of frozen, freezing and unfrozen particles.
type Filled<'a> = (&'a mut [u64], &'a mut [u64], &'a mut [u64]);

by_kind!(tell_widely, tell, (enthalpy: &[f64], interval: (f64, f64), words: Filled<'_>));

/// Tells the phases of particles, as many as fill the words.
#[inline(always)]
fn tell(kind: impl Kind<LANES>, enthalpy: &[f64], interval: (f64, f64), (frozen, freezing, unfrozen): Filled<'_>) {
    let limits = [kind.of(interval.0), kind.of(interval.1)];
    let words = frozen.iter_mut().zip(freezing).zip(unfrozen);
    for (enthalpy, ((frozen, freezing), unfrozen)) in enthalpy.as_chunks::<WORD>().0.iter().zip(words) {
        let groups = enthalpy.as_chunks::<LANES>().0;
        let mut found = [0; 3];
        // Mostly all particles of a word are frozen, or none is, which takes less to be told.
        if enthalpy[0] < interval.0 && are_frozen(kind, groups, limits[0]) {
            found[0] = u64::MAX;
        } else if enthalpy[0] > interval.1 && are_unfrozen(kind, groups, limits[1]) {
            found[2] = u64::MAX;
        } else {
            for (group, enthalpy) in groups.iter().enumerate() {
                add_group(kind, group, enthalpy, limits, &mut found);
            }
        }
        [*frozen, *freezing, *unfrozen] = found;
    }
}

/// Whether all of some groups are frozen.
#[inline(always)]
fn are_frozen<K: Kind<LANES>>(kind: K, groups: &[[f64; LANES]], limit: K::Numbers) -> bool {
    let mut all = kind.load(&groups[0]).is_less(limit);
    for group in &groups[1..] {
        all = all & kind.load(group).is_less(limit);
    }
    !(!all).any()
}

/// Whether all of some groups are unfrozen.
#[inline(always)]
fn are_unfrozen<K: Kind<LANES>>(kind: K, groups: &[[f64; LANES]], limit: K::Numbers) -> bool {
    let mut all = limit.is_less(kind.load(&groups[0]));
    for group in &groups[1..] {
        all = all & limit.is_less(kind.load(group));
    }
    !(!all).any()
}

impl HeapSize for Phases {
    fn heap_size(&self) -> usize {
        self.frozen.heap_size() + self.freezing.heap_size() + self.unfrozen.heap_size()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FREEZING: u8 = 0;

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
            alike in prop::collection::vec(
                (
                    prop_oneof![Just(-1.0), Just(0.0), -2.0..3.0f64, Just(1.0), Just(2.0), Just(f64::NAN)],
                    // Few beside each other, or whole words.
                    prop_oneof![3 => 1usize..3, 1 => 60usize..200],
                ),
                2..100,
            ),
            first in 0usize..300, shift in 1usize..150,
        ) {
            let states: Vec<f64> = alike.into_iter().flat_map(|(state, count)| vec![state; count]).take(600).collect();
            let count = states.len();
            let interval = (0.0, 1.0);
            let material = Sharp { interval, potential: 0.0, most: 1.0 };
            let first = first % count;
            let stretches = [(first as u32, count as u32, 0)];
            let mut phases = Phases::new(count);
            phases.update(None, (&[material], &stretches), &states);
            let plain: Vec<u8> =
                (0..count).map(|k| if k < first { 8 } else { plainly(states[k], interval) }).collect();
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
