//! The symmetric matrix of paths on diagonals: its product with a column, and sweeps that come near its inverse.

use crate::balances::groundwater::diagonals::{Diagonals, LANES, Lanes, blocks, lanes};
use crate::balances::groundwater::places::Stretch;
use crate::instruction_set::widest;

impl Diagonals {
    /// The product of a symmetric matrix, whose diagonal is given from particle `first` on, with a column of places.
    pub fn multiply(&self, [diagonal, rest, column]: [&[f64]; 3], first: usize, image: &mut [f64]) {
        multiply(self, diagonal, rest, column, first, image);
    }

    /// The first half of symmetric Gauss-Seidel for the residual from particle `first` on. What lies along a row within a block
    /// follows to first order alone, so that it needs no other. `swept` begins at a place, so far before the particles as paths
    /// reach; whatever is none of theirs must be zero, and stays it.
    pub fn forward(&self, [inverse, rest, residual]: [&[f64]; 3], (first, base): (usize, usize), swept: &mut [f64]) {
        forward(self, inverse, rest, residual, (first, base), swept);
    }

    /// The other half, for so many particles.
    pub fn back(&self, [inverse, rest]: [&[f64]; 2], (first, base, count): (usize, usize, usize), swept: &mut [f64]) {
        back(self, inverse, rest, (first, base, count), swept);
    }
}

widest!(multiply, multiply_rows, (own: &Diagonals, diagonal: &[f64], rest: &[f64], column: &[f64], first: usize, image: &mut [f64]));
widest!(forward, forward_rows, (own: &Diagonals, inverse: &[f64], rest: &[f64], residual: &[f64], start: (usize, usize), swept: &mut [f64]));
widest!(back, back_rows, (own: &Diagonals, inverse: &[f64], rest: &[f64], start: (usize, usize, usize), swept: &mut [f64]));

#[inline(always)]
fn multiply_rows(
    diagonals: &Diagonals,
    diagonal: &[f64],
    rest: &[f64],
    column: &[f64],
    first: usize,
    image: &mut [f64],
) {
    for Stretch { before, at, count } in diagonals.places.stretches(first, image.len()).flat_map(blocks) {
        let own = lanes(column, at);
        let mut sum = [0.0; LANES];
        for (number, offset) in diagonals.offsets.iter().enumerate() {
            let place = number * diagonals.stride + at;
            let (forth, back) = (lanes(rest, place), lanes(rest, place - offset));
            let (higher, lower) = (lanes(column, at + offset), lanes(column, at - offset));
            for lane in 0..LANES {
                sum[lane] += forth[lane] * higher[lane] + back[lane] * lower[lane];
            }
        }
        let rows = image[before..before + count].iter_mut().zip(&diagonal[before..before + count]);
        for (lane, (image, diagonal)) in rows.enumerate() {
            *image = diagonal * own[lane] + sum[lane];
        }
    }
}

/// So many values of a column, and zeros.
#[inline(always)]
fn some(column: &[f64], from: usize, count: usize) -> Lanes {
    let mut part = [0.0; LANES];
    match column.get(from..from + LANES) {
        Some(whole) if count == LANES => part.copy_from_slice(whole),
        _ => part[..count].copy_from_slice(&column[from..from + count]),
    }
    part
}

#[inline(always)]
fn forward_rows(
    diagonals: &Diagonals,
    inverse: &[f64],
    rest: &[f64],
    residual: &[f64],
    (first, base): (usize, usize),
    swept: &mut [f64],
) {
    // Partners beyond a block are known, those within it by what is known without each other.
    let near = diagonals.offsets.partition_point(|offset| *offset < LANES);
    let (close, far) = diagonals.offsets.split_at(near);
    let stride = diagonals.stride;
    for stretch in diagonals.places.stretches(first, residual.len()) {
        let mut alone = [0.0; 2 * LANES];
        for Stretch { before, at, count } in blocks(stretch) {
            let (own, mut left) = (some(inverse, before, count), some(residual, before, count));
            for (number, offset) in far.iter().enumerate() {
                let (back, lower) =
                    (lanes(rest, (near + number) * stride + at - offset), lanes(swept, at - offset - base));
                for lane in 0..LANES {
                    left[lane] -= back[lane] * lower[lane];
                }
            }
            alone.copy_within(LANES.., 0);
            for lane in 0..LANES {
                alone[LANES + lane] = left[lane] * own[lane];
            }
            let mut sum = [0.0; LANES];
            for (number, offset) in close.iter().enumerate() {
                let (back, lower) = (lanes(rest, number * stride + at - offset), lanes(&alone, LANES - offset));
                for lane in 0..LANES {
                    sum[lane] += back[lane] * lower[lane];
                }
            }
            let mut found = [0.0; LANES];
            for lane in 0..LANES {
                found[lane] = alone[LANES + lane] - own[lane] * sum[lane];
            }
            swept[at - base..at - base + count].copy_from_slice(&found[..count]);
        }
    }
}

#[inline(always)]
fn back_rows(
    diagonals: &Diagonals,
    inverse: &[f64],
    rest: &[f64],
    (first, base, all): (usize, usize, usize),
    swept: &mut [f64],
) {
    let near = diagonals.offsets.partition_point(|offset| *offset < LANES);
    let (close, far) = diagonals.offsets.split_at(near);
    let stride = diagonals.stride;
    for stretch in diagonals.places.stretches(first, all).rev() {
        let mut alone = [0.0; 2 * LANES];
        for Stretch { before, at, count } in blocks(stretch).rev() {
            let (own, here) = (some(inverse, before, count), some(swept, at - base, count));
            let mut sum = [0.0; LANES];
            for (number, offset) in far.iter().enumerate() {
                let (forth, higher) = (lanes(rest, (near + number) * stride + at), lanes(swept, at + offset - base));
                for lane in 0..LANES {
                    sum[lane] += forth[lane] * higher[lane];
                }
            }
            alone.copy_within(..LANES, LANES);
            for lane in 0..LANES {
                alone[lane] = here[lane] - own[lane] * sum[lane];
            }
            sum = [0.0; LANES];
            for (number, offset) in close.iter().enumerate() {
                let (forth, higher) = (lanes(rest, number * stride + at), lanes(&alone, *offset));
                for lane in 0..LANES {
                    sum[lane] += forth[lane] * higher[lane];
                }
            }
            let mut found = [0.0; LANES];
            for lane in 0..LANES {
                found[lane] = alone[lane] - own[lane] * sum[lane];
            }
            swept[at - base..at - base + count].copy_from_slice(&found[..count]);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The widest vectors of the processor and those of every processor see the same operations in the same order.
        #[test]
        fn kernels_for_wide_vectors_give_the_same_bits(
            (columns, rows) in (3_usize..40, 2_usize..12),
            numbers in prop::collection::vec(-1e3_f64..1e3, 64),
        ) {
            // Pairs with the next in a row and in a column.
            let count = columns * rows;
            let (mut starts, mut partners) = (vec![0], Vec::new());
            for i in 0..count {
                let row = [i.wrapping_sub(columns), i.wrapping_sub(1), i + 1, i + columns];
                partners.extend(row.into_iter().filter(|j| *j < count).map(|j| j as u32));
                starts.push(partners.len());
            }
            let own = Diagonals::of(&starts, &partners, &vec![DVec2::ZERO; count]).expect("diagonals");
            let drawn = |length: usize, from: usize| -> Vec<f64> {
                (0..length).map(|k| numbers[(k * 7 + from) % 64] * (1.0 + k as f64 / 64.0)).collect()
            };
            let mut rest = vec![0.0; own.slots()];
            for i in 0..count {
                for j in partners[starts[i]..starts[i + 1]].iter().map(|j| *j as usize).filter(|j| *j > i) {
                    rest[own.slot(i, j)] = numbers[(i + 3 * j) % 64];
                }
            }
            let (diagonal, mut column) = (drawn(count, 3), vec![0.0; own.padded()]);
            own.places.spread(None, &drawn(count, 11), &mut column);
            let (mut wide, mut plain) = (vec![0.0; count], vec![0.0; count]);
            multiply(&own, &diagonal, &rest, &column, 0, &mut wide);
            multiply_rows(&own, &diagonal, &rest, &column, 0, &mut plain);
            prop_assert_eq!(wide, plain);
            let (mut wide, mut plain) = (vec![0.0; own.padded()], vec![0.0; own.padded()]);
            let inverse: Vec<f64> = diagonal.iter().map(|own| 1e-3 / (own.abs() + 1.0)).collect();
            forward(&own, &inverse, &rest, &drawn(count, 5), (0, 0), &mut wide);
            forward_rows(&own, &inverse, &rest, &drawn(count, 5), (0, 0), &mut plain);
            prop_assert_eq!(&wide, &plain);
            back(&own, &inverse, &rest, (0, 0, count), &mut wide);
            back_rows(&own, &inverse, &rest, (0, 0, count), &mut plain);
            prop_assert_eq!(wide, plain);
        }
    }
}
