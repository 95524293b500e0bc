//! Blocks for the vectors of one processor against those of every processor, and those against sums as they are written.

use proptest::prelude::*;

use super::*;
use crate::kernels::target::Taken;
use crate::solvers::kept::add_one;

/// Potentials, weights and slots of any block.
fn drawn(numbers: &[f64], length: usize, from: usize) -> Vec<f64> {
    (0..length).map(|k| numbers[(k * 5 + from) % 64] * (1.0 + k as f64 / 64.0)).collect()
}

proptest! {
    #[test]
    fn blocks_for_wide_vectors_give_the_same_bits(
        reach in 1..=WIDEST,
        plane in 0..=1_usize,
        (column, count) in (0..40_usize, 1..100_usize),
        disc in any::<bool>(),
        step in prop::option::of(1e-3_f64..1.0),
        numbers in prop::collection::vec(-1e3_f64..1e3, 64),
    ) {
        let width = column + count.next_multiple_of(LANES) + 2 * LANES;
        let rows: Vec<Vec<f64>> = (0..2 * WIDEST + 1).map(|row| drawn(&numbers, width, row)).collect();
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let by_distance = std::array::from_fn(|k| std::array::from_fn(|dy| numbers[(9 * k + dy) % 64]));
        let weights = Weights { by_distance, sum: numbers[7], disc };
        let near = Near { weights: &weights, rows: &rows, column, soon: Soon::of(&[]) };
        let made = |block: BlockRates| {
            let mut slots = drawn(&numbers, count, 3);
            // SAFETY: asked for below, where a block needs more than every processor has.
            unsafe { block(&near, &mut slots, step.map_or(Taken::Replacing, Taken::Adding)) };
            slots
        };
        let kept = |block: BlockRates| {
            let (mut slots, mut lost) = (drawn(&numbers, count, 3), drawn(&numbers, count, 4));
            let taken = Taken::Keeping { step: step.unwrap_or(1.0), lost: &mut lost };
            // SAFETY: as above.
            unsafe { block(&near, &mut slots, taken) };
            (slots, lost)
        };
        if step.is_none() {
            let (mut slots, mut lost) = (drawn(&numbers, count, 3), drawn(&numbers, count, 4));
            let rates = made(block::PORTABLE[plane][reach]);
            for ((slot, lost), rate) in slots.iter_mut().zip(&mut lost).zip(rates) {
                add_one(slot, rate, lost);
            }
            prop_assert_eq!(kept(block::PORTABLE[plane][reach]), (slots, lost));
        }
        let portable = made(block::PORTABLE[plane][reach]);
        let reach_rows = plane * reach;
        for (place, slot) in portable.iter().enumerate() {
            let at = |dx: i64, dy: i64| rows[(reach_rows as i64 + dy) as usize][((LANES + column + place) as i64 + dx) as usize];
            let (across, up) = (reach as i64, reach_rows as i64);
            let (mut rate, mut size) = (-weights.sum * at(0, 0), (weights.sum * at(0, 0)).abs());
            for (dx, dy) in (-across..=across).flat_map(|dx| (-up..=up).map(move |dy| (dx, dy))) {
                let outside = plane == 0 || disc;
                if (dx, dy) != (0, 0) && !(outside && dx * dx + dy * dy > across * across) {
                    let term = weights.by_distance[dx.unsigned_abs() as usize][dy.unsigned_abs() as usize] * at(dx, dy);
                    rate += term;
                    size += term.abs();
                }
            }
            let old = drawn(&numbers, count, 3)[place];
            let (wanted, size) = step.map_or((rate, size), |step| (old + step * rate, old.abs() + step * size));
            // A rounding for each of the terms.
            prop_assert!((slot - wanted).abs() <= 300.0 * f64::EPSILON * size, "{place}: {slot} {wanted}");
        }
        #[cfg(target_arch = "x86_64")]
        {
            let widest = InstructionSet::widest();
            if widest >= InstructionSet::Avx2 {
                prop_assert_eq!(&made(block::AVX2[plane][reach]), &portable);
                prop_assert_eq!(kept(block::AVX2[plane][reach]), kept(block::PORTABLE[plane][reach]));
            }
            if widest >= InstructionSet::Avx512 {
                prop_assert_eq!(&made(block::AVX512[plane][reach]), &portable);
                prop_assert_eq!(kept(block::AVX512[plane][reach]), kept(block::PORTABLE[plane][reach]));
            }
        }
    }
}
