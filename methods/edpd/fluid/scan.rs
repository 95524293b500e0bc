//! Which of some places, one after the other in memory, are near each of a few others: up to sixteen at once, in single precision.
//!
//! Places are told apart up to an error that grows with the box, by which the reach is taken larger ([`widened`]): no pair
//! within reach is missed, and the few that are farther apart act with a weight of zero.

use super::lanes::Lanes;
#[cfg(target_arch = "x86_64")]
use super::lanes::{Eight, Sixteen};
use super::quad::Quad;
#[cfg(target_arch = "x86_64")]
use super::quad::Wide;

/// Places that are looked at at once, at most.
pub const LANES: usize = 16;

/// Places that are looked through at a time.
pub const MOST: usize = 128;

/// Particles for which places are looked through together.
pub const TOGETHER: usize = 4;

/// Numbers that are noted of a particle before they are taken down, at most.
pub const NOTED: usize = 2 * MOST;

/// Which places are near each of a few particles.
#[derive(Debug, Clone)]
pub struct Notes {
    /// Their numbers, with room for the lanes of the last ones.
    pub numbers: [[u32; NOTED + LANES]; TOGETHER],
    /// How many they are.
    pub counts: [usize; TOGETHER],
}

impl Default for Notes {
    fn default() -> Self {
        Notes { numbers: [[0; NOTED + LANES]; TOGETHER], counts: [0; TOGETHER] }
    }
}

/// Places from one number to another, which are looked through; each particle's own first ones are passed over.
#[derive(Debug, Clone, Copy)]
pub struct Stretch {
    /// The first of them.
    pub from: usize,
    /// After the last.
    pub to: usize,
    /// How many more of the first ones each particle passes over than the one before it: none or one.
    pub steps: usize,
}

/// Square of a reach, in single precision, that takes in all pairs within reach in a box of a longest side.
pub fn widened(reach: f64, longest: f64) -> f32 {
    // Two places of up to twice the box each lose half of a last digit; then squares and their sum lose some.
    let lost = 4.0 * 2.0 * longest * f64::from(f32::EPSILON);
    ((reach + lost).powi(2) * (1.0 + 8.0 * f64::from(f32::EPSILON))) as f32
}

/// What a kind of processor does in its own way.
pub trait Kind {
    /// Four numbers at once.
    type Quad: Quad;
    /// Several places at once.
    type Lanes: Lanes;
}

/// By what all processors have.
#[derive(Debug)]
pub struct Portable;

impl Kind for Portable {
    type Quad = [f64; 4];
    type Lanes = [f32; 8];
}

/// By the instructions of AVX2, which a caller must know to be there.
#[cfg(target_arch = "x86_64")]
#[derive(Debug)]
pub struct Avx2;

#[cfg(target_arch = "x86_64")]
impl Kind for Avx2 {
    type Quad = Wide;
    type Lanes = Eight;
}

/// By the instructions of AVX-512, which a caller must know to be there.
#[cfg(target_arch = "x86_64")]
#[derive(Debug)]
pub struct Avx512;

#[cfg(target_arch = "x86_64")]
impl Kind for Avx512 {
    type Quad = Wide;
    type Lanes = Sixteen;
}

/// Notes which of the places of a stretch are nearer to each of some places than the root of `square`; none, where the first
/// number of such a place is none. Columns must be [`LANES`] longer than what is looked through, and there must be room for all.
#[inline(always)]
pub fn near<L: Lanes, const D: usize>(
    columns: &[&[f32]; D],
    places: &[[f32; D]; TOGETHER],
    Stretch { from, to, steps }: Stretch,
    square: f32,
    notes: &mut Notes,
) {
    const { assert!(L::COUNT <= LANES) };
    assert!(columns.iter().all(|column| column.len() >= to + LANES));
    assert!(notes.counts.iter().all(|count| count + to.saturating_sub(from) <= NOTED));
    let square = L::splat(square);
    let mut wide = [[square; D]; TOGETHER];
    for l in 0..TOGETHER {
        for axis in 0..D {
            wide[l][axis] = L::splat(places[l][axis]);
        }
    }
    let mut counts = notes.counts;
    let mut passed = [0; TOGETHER];
    for l in 0..TOGETHER {
        passed[l] = u32::MAX << (l * steps);
    }
    let (mut at, mut numbers) = (from, L::numbers(from));
    while at < to {
        let inside = (1 << (to - at).min(L::COUNT)) - 1;
        let mut column = [square; D];
        for axis in 0..D {
            // SAFETY: `at` is before `to`, and columns are longer by the most that is loaded, as has been asked.
            column[axis] = unsafe { L::load(columns[axis].as_ptr().add(at)) };
        }
        for l in 0..TOGETHER {
            // What is the second may be loaded for it, where there are too few registers.
            let mut squares = square;
            for axis in 0..D {
                let way = column[axis].minus(wide[l][axis]);
                let along = way.times(way);
                squares = if axis == 0 { along } else { squares.plus(along) };
            }
            let near = squares.below(square, inside & passed[l]);
            // SAFETY: no more is noted than is looked through, for which there is room, and after it for the most that is written.
            unsafe { L::note(near, numbers, notes.numbers[l].as_mut_ptr().add(counts[l])) };
            counts[l] += near.count_ones() as usize;
        }
        numbers = L::after(numbers);
        at += L::COUNT;
        passed = [u32::MAX; TOGETHER];
    }
    notes.counts = counts;
}

#[cfg(test)]
mod tests {
    #[cfg(target_arch = "x86_64")]
    use frazil_core::instruction_set::InstructionSet;
    use proptest::prelude::*;

    use super::*;

    /// What `S` notes.
    fn noted<S: Kind>(
        columns: &[&[f32]; 2],
        places: &[[f32; 2]; TOGETHER],
        stretch: Stretch,
        square: f32,
        counts: [usize; TOGETHER],
    ) -> [Vec<u32>; TOGETHER] {
        let mut notes = Notes { counts, ..Notes::default() };
        near::<S::Lanes, 2>(columns, places, stretch, square, &mut notes);
        std::array::from_fn(|l| notes.numbers[l][counts[l]..notes.counts[l]].to_vec())
    }

    proptest! {
        #[test]
        fn wide_and_portable_ways_note_the_same_places(
            x in prop::collection::vec(-2.0_f32..2.0, 1..=MOST),
            seed in 0_u32..1000,
            from in any::<prop::sample::Index>(),
            steps in 0_usize..=1,
            square in prop_oneof![0.0_f32..9.0, Just(f32::NAN), Just(f32::INFINITY)],
            counts in prop::array::uniform4(0..=NOTED - MOST),
            few in 1..=TOGETHER,
        ) {
            let length = x.len();
            let y: Vec<f32> = (0..length).map(|k| ((k as u32 * 7919 + seed) % 997) as f32 / 300.0 - 1.6).collect();
            let padded = |column: &[f32]| [column, &[0.0; LANES]].concat();
            let (x, y) = (padded(&x), padded(&y));
            let (columns, stretch) = ([x.as_slice(), y.as_slice()], Stretch { from: from.index(length), to: length, steps });
            let mut places = [[f32::NAN; 2]; TOGETHER];
            for (l, place) in places[..few].iter_mut().enumerate() {
                *place = [x[(seed as usize + l) % length], y[from.index(length)]];
            }
            let plain = noted::<Portable>(&columns, &places, stretch, square, counts);
            for (l, plain) in plain.iter().enumerate() {
                let expected = (stretch.from + l * steps..length).filter(|k| {
                    let way = [places[l][0] - x[*k], places[l][1] - y[*k]];
                    way[0] * way[0] + way[1] * way[1] < square
                });
                prop_assert_eq!(plain, &expected.map(|k| k as u32).collect::<Vec<_>>());
            }
            #[cfg(target_arch = "x86_64")]
            {
                let widest = InstructionSet::widest();
                if widest >= InstructionSet::Avx2 {
                    prop_assert_eq!(&plain, &noted::<Avx2>(&columns, &places, stretch, square, counts));
                }
                if widest >= InstructionSet::Avx512 {
                    prop_assert_eq!(&plain, &noted::<Avx512>(&columns, &places, stretch, square, counts));
                }
            }
        }
    }
}
