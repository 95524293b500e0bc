//! Blocks and lines for the vectors of one processor against those of every processor, and those against sums as they are written.

use proptest::prelude::*;

use super::*;
use crate::kernels::target::{Slots, Taken};
use crate::physics::potential::{Kinked, PotentialLaw};
use crate::solvers::kept::add_one;

/// Potentials, weights and slots of any block.
fn drawn(numbers: &[f64], length: usize, from: usize) -> Vec<f64> {
    (0..length).map(|k| numbers[(k * 5 + from) % 64] * (1.0 + k as f64 / 64.0)).collect()
}

/// Weights of any stencil.
fn weights(numbers: &[f64], disc: bool) -> Weights {
    let by_distance = std::array::from_fn(|k| std::array::from_fn(|dy| numbers[(9 * k + dy) % 64]));
    Weights { by_distance, sum: numbers[7], disc }
}

/// Every kind of vectors that this processor has, of functions for each.
fn kinds<K: Copy>(portable: K, avx2: K, avx512: K) -> Vec<K> {
    let widest = InstructionSet::widest();
    let wide = [(InstructionSet::Avx2, avx2), (InstructionSet::Avx512, avx512)];
    let there = wide.into_iter().filter(|(set, _)| cfg!(target_arch = "x86_64") && widest >= *set).map(|kind| kind.1);
    std::iter::once(portable).chain(there).collect()
}

/// Those of blocks of a reach.
fn blocks(reach: usize) -> Vec<BlockRates> {
    #[cfg(target_arch = "x86_64")]
    return kinds(block::PORTABLE[reach], block::AVX2[reach], block::AVX512[reach]);
    #[cfg(not(target_arch = "x86_64"))]
    kinds(block::PORTABLE[reach], block::PORTABLE[reach], block::PORTABLE[reach])
}

/// Those of lines.
fn lines(reach: usize) -> Vec<LineRates> {
    #[cfg(target_arch = "x86_64")]
    return kinds(line::PORTABLE[reach], line::AVX2[reach], line::AVX512[reach]);
    #[cfg(not(target_arch = "x86_64"))]
    kinds(line::PORTABLE[reach], line::PORTABLE[reach], line::PORTABLE[reach])
}

/// Slots after they have taken rates, and what rounding has kept from them: by a step they are added, else they take their place.
fn taken(
    numbers: &[f64],
    (count, step, keeping): (usize, Option<f64>, bool),
    rates: impl FnOnce(Slots<'_>),
) -> [Vec<f64>; 2] {
    let (mut slots, mut lost) = (drawn(numbers, count, 3), drawn(numbers, count, 4));
    let taken = match step {
        Some(step) if keeping => Taken::Keeping { step, lost: &mut lost },
        Some(step) => Taken::Adding(step),
        None => Taken::Replacing,
    };
    rates(Slots { rates: &mut slots, enthalpy: None, taken });
    [slots, lost]
}

/// Holds slots against rates, each the sum of terms.
fn assert_sums(
    numbers: &[f64],
    (count, step, keeping): (usize, Option<f64>, bool),
    [slots, lost]: &[Vec<f64>; 2],
    terms: impl Fn(usize) -> Vec<f64>,
) -> Result<(), TestCaseError> {
    for place in 0..count {
        let (terms, old) = (terms(place), drawn(numbers, count, 3)[place]);
        let (rate, size): (f64, f64) = (terms.iter().sum(), terms.iter().map(|term| term.abs()).sum());
        let (wanted, size) = step.map_or((rate, size), |step| (old + step * rate, old.abs() + step * size));
        // What is kept back is as small as a rounding, but for what had been kept back before.
        let before = if keeping && step.is_some() { drawn(numbers, count, 4)[place] } else { 0.0 };
        let kept_back = if keeping && step.is_some() { lost[place] } else { 0.0 };
        let found = slots[place] + kept_back - before;
        // A rounding for each of the terms.
        prop_assert!(
            (found - wanted).abs() <= 300.0 * f64::EPSILON * (size + before.abs()),
            "{place}: {found} {wanted}"
        );
    }
    Ok(())
}

proptest! {
    #[test]
    fn blocks_for_wide_vectors_give_the_same_bits(
        reach in 1..=WIDEST,
        (column, count) in (0..40_usize, 1..100_usize),
        disc in any::<bool>(),
        (step, keeping) in (prop::option::of(1e-3_f64..1.0), any::<bool>()),
        numbers in prop::collection::vec(-1e3_f64..1e3, 64),
    ) {
        let width = column + count.next_multiple_of(LANES) + 2 * LANES;
        let rows: Vec<Vec<f64>> = (0..2 * WIDEST + 1).map(|row| drawn(&numbers, width, row)).collect();
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let weights = weights(&numbers, disc);
        let near = Near { weights: &weights, rows: &rows, column, soon: Soon::of(&[]) };
        let how = (count, step, keeping);
        // SAFETY: blocks are of the vectors that this processor has.
        let made = |block: BlockRates| taken(&numbers, how, |slots| unsafe { block(&near, slots) });
        let blocks = blocks(reach);
        let portable = made(blocks[0]);
        for block in &blocks[1..] {
            prop_assert_eq!(&made(*block), &portable);
        }
        let far = reach as i64;
        assert_sums(&numbers, how, &portable, |place| {
            let at = |dx: i64, dy: i64| rows[(far + dy) as usize][((LANES + column + place) as i64 + dx) as usize];
            let around = (-far..=far).flat_map(|dx| (-far..=far).map(move |dy| (dx, dy)));
            let seen = around.filter(|(dx, dy)| (*dx, *dy) != (0, 0) && !(disc && dx * dx + dy * dy > far * far));
            let weight = |dx: i64, dy: i64| weights.by_distance[dx.unsigned_abs() as usize][dy.unsigned_abs() as usize];
            let others = seen.map(|(dx, dy)| weight(dx, dy) * at(dx, dy));
            std::iter::once(-weights.sum * at(0, 0)).chain(others).collect()
        })?;
    }

    #[test]
    fn lines_for_wide_vectors_give_the_same_bits(
        reach in 1..=WIDEST,
        count in 1..100_usize,
        (step, keeping) in (prop::option::of(1e-3_f64..1.0), any::<bool>()),
        signs in [0..3_usize, 0..3_usize],
        (open, by_law) in (any::<[bool; 2]>(), any::<bool>()),
        numbers in prop::collection::vec(-1e3_f64..1e3, 64),
    ) {
        let weights = weights(&numbers, true);
        let (law, behind) = (
            Kinked {
                frozen_slope: 2.0,
                unfrozen_slope: 0.5,
                frozen_below: -300.0,
                unfrozen_above: 100.0,
                frozen_rest: -300.0,
                unfrozen_rest: 100.0,
            },
            std::array::from_fn(|end| Behind { sign: [-1.0, 0.0, 1.0][signs[end]], shift: numbers[end] }),
        );
        let of_ends = EndWeights {
            of_ghosts: std::array::from_fn(|k| numbers[20 + k]),
            of_particles: std::array::from_fn(|k| numbers[30 + k]),
        };
        let ends = Ends { behind, open, weights: of_ends.clone() };
        let law = Some((&law, &ends)).filter(|_| by_law && count >= line::FEWEST);
        let drawn_row = drawn(&numbers, count.next_multiple_of(LANES) + 3 * LANES, 9);
        let how = (count, step, keeping);
        let made = |line: LineRates| {
            let (mut row, mut through) = (drawn_row.clone(), [7.0; 4]);
            let along = Along { weights: &weights, potentials: &mut row, law };
            // SAFETY: lines are of the vectors that this processor has.
            let slots = taken(&numbers, how, |slots| unsafe { line(along, slots, &mut through) });
            (slots, through)
        };
        let lines = lines(reach);
        let (portable, through) = made(lines[0]);
        for line in &lines[1..] {
            prop_assert_eq!(&made(*line), &(portable.clone(), through));
        }
        // Where there is no law, potentials are given; else they follow from what is in the slots, and ghosts from their images.
        let potential = |place: i64| match law {
            None => drawn_row[(LANES as i64 + place) as usize],
            Some((law, _)) => {
                let of = |particle: i64| law.potential(drawn(&numbers, count, 3)[particle as usize]);
                let last = count as i64 - 1;
                if place < 0 {
                    behind[0].sign * of(-1 - place) + behind[0].shift
                } else if place > last {
                    behind[1].sign * of(2 * last + 1 - place) + behind[1].shift
                } else {
                    of(place)
                }
            }
        };
        assert_sums(&numbers, how, &portable, |place| {
            let near = (-(reach as i64)..=reach as i64).filter(|dx| *dx != 0);
            let others = near.map(|dx| weights.by_distance[dx.unsigned_abs() as usize][0] * potential(place as i64 + dx));
            std::iter::once(-weights.sum * potential(place as i64)).chain(others).collect()
        })?;
        for end in 0..2 {
            let place = |outward: i64| if end == 0 { -1 - outward } else { count as i64 + outward };
            let ghosts = (0..reach).map(|k| of_ends.of_ghosts[k] * potential(place(k as i64)));
            let particles = (0..reach).map(|k| -of_ends.of_particles[k] * potential(place(-1 - k as i64)));
            let terms: Vec<f64> = if law.is_some() && open[end] { ghosts.chain(particles).collect() } else { vec![7.0] };
            let (wanted, size): (f64, f64) = (terms.iter().sum(), terms.iter().map(|term| term.abs()).sum());
            prop_assert!((through[end] - wanted).abs() <= 60.0 * f64::EPSILON * size, "{end}: {} {wanted}", through[end]);
        }
    }

    #[test]
    fn what_rounding_keeps_back_is_that_of_single_sums(
        count in 1..100_usize,
        step in 1e-3_f64..1.0,
        numbers in prop::collection::vec(-1e3_f64..1e3, 64),
    ) {
        let (weights, mut row) = (weights(&numbers, true), drawn(&numbers, count.next_multiple_of(LANES) + 3 * LANES, 9));
        let mut made = |step: Option<f64>| {
            let along = Along { weights: &weights, potentials: &mut row, law: None };
            // SAFETY: it is that of every processor.
            taken(&numbers, (count, step, true), |slots| unsafe { line::PORTABLE[3](along, slots, &mut [0.0; 4]) })
        };
        let [rates, _] = made(None);
        let (mut slots, mut lost) = (drawn(&numbers, count, 3), drawn(&numbers, count, 4));
        for ((slot, lost), rate) in slots.iter_mut().zip(&mut lost).zip(rates) {
            add_one(slot, step * rate, lost);
        }
        prop_assert_eq!(made(Some(step)), [slots, lost]);
    }
}
