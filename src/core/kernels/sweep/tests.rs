//! Blocks for the vectors of one processor against those of every processor.

use proptest::prelude::*;

use super::*;

proptest! {
    #[test]
    fn blocks_for_wide_vectors_give_the_same_bits(
        reach in 1..=WIDEST,
        count in 1_usize..100,
        disc in any::<bool>(),
        step in prop::option::of(1e-3_f64..1.0),
        numbers in prop::collection::vec(-1e3_f64..1e3, 64),
    ) {
        let drawn = |length: usize, from: usize| -> Vec<f64> {
            (0..length).map(|k| numbers[(k * 5 + from) % 64] * (1.0 + k as f64 / 64.0)).collect()
        };
        let rows: Vec<Vec<f64>> = (0..17).map(|row| drawn(PADDED, row)).collect();
        let rows: [&[f64]; 17] = std::array::from_fn(|row| rows[row].as_slice());
        let weights: [[f64; 9]; 9] = std::array::from_fn(|k| std::array::from_fn(|dy| numbers[(9 * k + dy) % 64]));
        let near = Near { weights: &weights, disc, sum: numbers[7], reach, rows: &rows, column: 0 };
        let made = |block: BlockSums| {
            let mut sums: Vec<Sums> = (0..=WIDEST).map(|_| Sums([0.0; PADDED])).collect();
            let mut slots = drawn(count, 3);
            // SAFETY: asked for below, where a block needs more than every processor has.
            unsafe { block(&near, &mut sums, &mut slots, step) };
            slots
        };
        let plain = made(plain::BY_REACH[reach]);
        prop_assert!(plain.iter().all(|slot| slot.is_finite()));
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            prop_assert_eq!(&made(avx2::BY_REACH[reach]), &plain);
        }
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
            prop_assert_eq!(&made(avx512::BY_REACH[reach]), &plain);
        }
    }
}
