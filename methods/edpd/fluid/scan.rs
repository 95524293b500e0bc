//! Which of some places, one after the other in memory, are near each of a few others: sixteen at once, in single precision.
//!
//! Places are told apart up to an error that grows with the box, by which the reach is taken larger ([`widened`]): no pair
//! within reach is missed, and the few that are farther apart act with a weight of zero.

use super::quad::Quad;
#[cfg(target_arch = "x86_64")]
use super::quad::Wide;

/// Places that are looked at at once.
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

    /// Notes which of the places of a stretch are nearer to each of some places than the root of `square`; none, where the first
    /// number of such a place is none. Columns must be [`LANES`] longer than what is looked through, and there must be room for all.
    fn near<const D: usize>(
        columns: &[&[f32]; D],
        places: &[[f32; D]; TOGETHER],
        stretch: Stretch,
        square: f32,
        notes: &mut Notes,
    );
}

/// Places that are told apart at once where there is no instruction that packs the near ones together.
const GROUP: usize = 8;

/// For each set of near places in a group, which they are, the first ones first.
const PACKED: [[u8; GROUP]; 1 << GROUP] = {
    let mut packed = [[0; GROUP]; 1 << GROUP];
    let mut set = 0;
    while set < packed.len() {
        let (mut lane, mut count) = (0, 0);
        while lane < GROUP {
            if set >> lane & 1 == 1 {
                packed[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    packed
};

/// By what all processors have.
#[derive(Debug)]
pub struct Portable;

impl Kind for Portable {
    type Quad = [f64; 4];

    #[inline(always)]
    fn near<const D: usize>(
        columns: &[&[f32]; D],
        places: &[[f32; D]; TOGETHER],
        Stretch { from, to, steps }: Stretch,
        square: f32,
        notes: &mut Notes,
    ) {
        for (l, place) in places.iter().enumerate().filter(|(_, place)| !place[0].is_nan()) {
            let from = from + l * steps;
            let (found, count) = (&mut notes.numbers[l], &mut notes.counts[l]);
            let whole = to.saturating_sub(from).next_multiple_of(GROUP);
            let groups: [&[[f32; GROUP]]; D] = columns.map(|column| column[from..from + whole].as_chunks().0);
            for group in 0..whole / GROUP {
                let mut squares = [0.0; GROUP];
                for axis in 0..D {
                    for lane in 0..GROUP {
                        let way = place[axis] - groups[axis][group][lane];
                        squares[lane] += way * way;
                    }
                }
                let at = from + group * GROUP;
                let near = below(&squares, square) & (0xff >> (at + GROUP).saturating_sub(to));
                // Whether a place is near cannot be guessed: all of the group are written, and what is beyond the near ones is
                // written over by the next.
                let lanes = &PACKED[near];
                if let Some(noted) = found[*count..].first_chunk_mut::<GROUP>() {
                    for lane in 0..GROUP {
                        noted[lane] = at as u32 + u32::from(lanes[lane]);
                    }
                }
                *count += near.count_ones() as usize;
            }
        }
    }
}

/// Which of the squares are below another, as bits.
#[inline(always)]
fn below(squares: &[f32; GROUP], square: f32) -> usize {
    (0..GROUP).fold(0, |set, lane| set | usize::from(squares[lane] < square) << lane)
}

/// By the instructions of AVX2, which a caller must know to be there.
#[cfg(target_arch = "x86_64")]
#[derive(Debug)]
pub struct Avx2;

#[cfg(target_arch = "x86_64")]
impl Kind for Avx2 {
    type Quad = Wide;

    #[inline(always)]
    fn near<const D: usize>(
        columns: &[&[f32]; D],
        places: &[[f32; D]; TOGETHER],
        Stretch { from, to, steps }: Stretch,
        square: f32,
        notes: &mut Notes,
    ) {
        use std::arch::x86_64::{
            _CMP_LT_OQ, _mm_loadl_epi64, _mm256_add_epi32, _mm256_add_ps, _mm256_cmp_ps, _mm256_cvtepu8_epi32,
            _mm256_loadu_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setzero_ps,
            _mm256_storeu_si256, _mm256_sub_ps,
        };
        assert!(is_roomy(columns, &notes.counts, from, to));
        // SAFETY: the processor has these instructions (see the type). Places are read from `from` up to less than
        // `to + GROUP`, within the columns; numbers are written up to `count + GROUP`, and `count` stays within `NOTED`.
        unsafe {
            let square = _mm256_set1_ps(square);
            for l in (0..TOGETHER).filter(|l| !places[*l][0].is_nan()) {
                let place = places[l].map(|along| _mm256_set1_ps(along));
                let (mut at, mut count) = (from + l * steps, notes.counts[l]);
                while at < to {
                    let mut squares = _mm256_setzero_ps();
                    for axis in 0..D {
                        let way = _mm256_sub_ps(place[axis], _mm256_loadu_ps(columns[axis].as_ptr().add(at)));
                        let along = _mm256_mul_ps(way, way);
                        squares = if axis == 0 { along } else { _mm256_add_ps(squares, along) };
                    }
                    let near = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(squares, square)) as usize;
                    let near = near & (0xff >> (at + GROUP).saturating_sub(to));
                    let lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(PACKED[near].as_ptr().cast()));
                    let numbers = _mm256_add_epi32(lanes, _mm256_set1_epi32(at as i32));
                    _mm256_storeu_si256(notes.numbers[l].as_mut_ptr().add(count).cast(), numbers);
                    count += near.count_ones() as usize;
                    at += GROUP;
                }
                notes.counts[l] = count;
            }
        }
    }
}

/// By the instructions of AVX-512, which a caller must know to be there.
#[cfg(target_arch = "x86_64")]
#[derive(Debug)]
pub struct Avx512;

#[cfg(target_arch = "x86_64")]
impl Kind for Avx512 {
    type Quad = Wide;

    #[inline(always)]
    fn near<const D: usize>(
        columns: &[&[f32]; D],
        places: &[[f32; D]; TOGETHER],
        Stretch { from, to, steps }: Stretch,
        square: f32,
        notes: &mut Notes,
    ) {
        use std::arch::x86_64::{
            _CMP_LT_OQ, _mm512_add_epi32, _mm512_add_ps, _mm512_loadu_ps, _mm512_mask_cmp_ps_mask,
            _mm512_maskz_compress_epi32, _mm512_mul_ps, _mm512_set1_epi32, _mm512_set1_ps, _mm512_setr_epi32,
            _mm512_setzero_ps, _mm512_storeu_si512, _mm512_sub_ps,
        };
        assert!(is_roomy(columns, &notes.counts, from, to));
        // SAFETY: the processor has these instructions (see the type). Places are read from `from` up to less than
        // `to + LANES`, within the columns; numbers are written up to `count + LANES`, and `count` stays within `NOTED`.
        unsafe {
            let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            let mut numbers = _mm512_add_epi32(lanes, _mm512_set1_epi32(from as i32));
            let square = _mm512_set1_ps(square);
            let mut wide = [[square; D]; TOGETHER];
            for l in 0..TOGETHER {
                for axis in 0..D {
                    wide[l][axis] = _mm512_set1_ps(places[l][axis]);
                }
            }
            let mut counts = notes.counts;
            let mut passed = [0; TOGETHER];
            for l in 0..TOGETHER {
                passed[l] = u16::MAX << (l * steps);
            }
            let mut at = from;
            while at < to {
                let inside = ((1u32 << (to - at).min(LANES)) - 1) as u16;
                let mut column = [square; D];
                for axis in 0..D {
                    column[axis] = _mm512_loadu_ps(columns[axis].as_ptr().add(at));
                }
                for l in 0..TOGETHER {
                    let mut squares = _mm512_setzero_ps();
                    for axis in 0..D {
                        let way = _mm512_sub_ps(wide[l][axis], column[axis]);
                        let along = _mm512_mul_ps(way, way);
                        squares = if axis == 0 { along } else { _mm512_add_ps(squares, along) };
                    }
                    let near = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(inside & passed[l], squares, square);
                    let chosen = _mm512_maskz_compress_epi32(near, numbers);
                    _mm512_storeu_si512(notes.numbers[l].as_mut_ptr().add(counts[l]).cast(), chosen);
                    counts[l] += near.count_ones() as usize;
                }
                numbers = _mm512_add_epi32(numbers, _mm512_set1_epi32(LANES as i32));
                at += LANES;
                passed = [u16::MAX; TOGETHER];
            }
            notes.counts = counts;
        }
    }
}

/// Whether columns are long enough for what is looked through, and there is room to note all of it.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn is_roomy<const D: usize>(columns: &[&[f32]; D], counts: &[usize; TOGETHER], from: usize, to: usize) -> bool {
    columns.iter().all(|column| column.len() >= to + LANES)
        && counts.iter().all(|count| count + to.saturating_sub(from) <= NOTED)
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
        S::near(columns, places, stretch, square, &mut notes);
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
