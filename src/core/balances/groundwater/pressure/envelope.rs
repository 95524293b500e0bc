//! Cholesky's factor of a symmetric positive matrix whose entries are all near its diagonal.
//!
//! It stands as an upper triangle, of whose rows each ends with its last entry that is not zero or that of an earlier row. What a row
//! finds is taken from all later ones at once: a sum over a row would have to end before the next can begin.

use crate::instruction_set::widest;
use crate::memory::{HeapSize, total};

/// A pivot over the largest entry of the diagonal below which a row has no balance of its own.
const PIVOT: f64 = 1e-14;

/// Numbers that are added side by side.
const LANES: usize = 8;

/// Unknowns just found that come last into the sum for the next: all others are added meanwhile.
const NEAR: usize = 4;

/// The matrix, and then its factor.
#[derive(Debug, Clone, Default)]
pub(super) struct Envelope {
    /// After the last column of each row; ascending.
    ends: Vec<usize>,
    /// Start of each row's entries, its diagonal, and the end of the last.
    starts: Vec<usize>,
    entries: Vec<f64>,
    /// Inverse of the factor's diagonal; zero where there is no pivot.
    inverses: Vec<f64>,
}

impl HeapSize for Envelope {
    fn heap_size(&self) -> usize {
        total(&[&self.ends, &self.starts]) + total(&[&self.entries, &self.inverses])
    }
}

impl Envelope {
    /// Room for a matrix whose lower triangle has rows that begin at these columns.
    pub(super) fn new(firsts: &[usize]) -> Self {
        let mut ends: Vec<usize> = (1..=firsts.len()).collect();
        for (row, first) in firsts.iter().enumerate() {
            ends[*first] = ends[*first].max(row + 1);
        }
        let mut starts = vec![0];
        for row in 0..ends.len() {
            ends[row] = ends[row].max(if row > 0 { ends[row - 1] } else { 0 });
            starts.push(starts[row] + ends[row] - row);
        }
        Envelope { entries: vec![0.0; starts[ends.len()]], inverses: vec![0.0; ends.len()], ends, starts }
    }

    /// Zeros everywhere.
    pub(super) fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// The entry of a row and of one not after it.
    pub(super) fn entry(&mut self, row: usize, before: usize) -> &mut f64 {
        &mut self.entries[self.starts[before] + row - before]
    }

    /// Puts the factor in the place of the matrix.
    pub(super) fn factorise(&mut self) {
        factorise(self);
    }

    /// Solves in place; what has no pivot is zero.
    pub(super) fn solve(&self, column: &mut [f64]) {
        solve(self, column);
    }
}

widest!(factorise, factorise_rows, (matrix: &mut Envelope));
widest!(solve, solve_rows, (factor: &Envelope, column: &mut [f64]));

#[inline(always)]
fn factorise_rows(Envelope { starts, entries, inverses, .. }: &mut Envelope) {
    let most = starts[..inverses.len()].iter().map(|start| entries[*start]).fold(0.0, f64::max);
    for (row, inverse) in inverses.iter_mut().enumerate() {
        let (own, mut later) = entries[starts[row]..].split_at_mut(starts[row + 1] - starts[row]);
        *inverse = if own[0] > PIVOT * most { 1.0 / own[0].sqrt() } else { 0.0 };
        for entry in own.iter_mut() {
            *entry *= *inverse;
        }
        for k in 1..own.len() {
            let (factor, own) = (own[k], &own[k..]);
            for (entry, own) in later.iter_mut().zip(own) {
                *entry -= factor * own;
            }
            later = &mut later[starts[row + k + 1] - starts[row + k]..];
        }
    }
}

#[inline(always)]
fn solve_rows(Envelope { ends, starts, entries, inverses }: &Envelope, column: &mut [f64]) {
    let row_of = |row: usize| &entries[starts[row] + 1..starts[row + 1]];
    for (row, inverse) in inverses.iter().enumerate() {
        let value = column[row] * inverse;
        column[row] = value;
        for (later, entry) in column[row + 1..ends[row]].iter_mut().zip(row_of(row)) {
            *later -= entry * value;
        }
    }
    for (row, inverse) in inverses.iter().enumerate().rev() {
        let (own, found) = (row_of(row), &column[row + 1..ends[row]]);
        let near = NEAR.min(own.len());
        let mut left = column[row] - sum(&own[near..], &found[near..]);
        for k in (0..near).rev() {
            left -= own[k] * found[k];
        }
        column[row] = left * inverse;
    }
}

/// The sum of products, by lanes and then by halves of them.
#[inline(always)]
fn sum(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    for (sum, (a, b)) in sums.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *sum += a * b;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// What is found solves the matrix, whatever its rows reach; a row of zeros has no part, and all kinds of vectors see the same.
        #[test]
        fn what_is_found_solves_the_matrix(
            reaches in prop::collection::vec(0_usize..24, 1..60),
            numbers in prop::collection::vec(-1.0_f64..1.0, 41),
            empty in prop::option::of(any::<prop::sample::Index>()),
        ) {
            let count = reaches.len();
            let empty = empty.map(|empty| empty.index(count));
            let firsts: Vec<usize> = reaches.iter().enumerate().map(|(row, reach)| row.saturating_sub(*reach)).collect();
            let mut matrix = vec![vec![0.0; count]; count];
            for row in (0..count).filter(|row| Some(*row) != empty) {
                for column in (firsts[row]..row).filter(|column| Some(*column) != empty) {
                    let entry = numbers[(row * 7 + column * 3) % 41];
                    (matrix[row][column], matrix[column][row]) = (entry, entry);
                }
            }
            let mut envelope = Envelope::new(&firsts);
            for row in 0..count {
                // More than all others together: positive.
                let others: f64 = matrix[row].iter().map(|entry| entry.abs()).sum();
                matrix[row][row] = if Some(row) == empty { 0.0 } else { others + 0.5 };
                for column in firsts[row]..=row {
                    *envelope.entry(row, column) = matrix[row][column];
                }
            }
            let mut plain = envelope.clone();
            envelope.factorise();
            factorise_rows(&mut plain);
            prop_assert_eq!(&envelope.entries, &plain.entries);
            let mut expected: Vec<f64> = (0..count).map(|row| numbers[(row * 5 + 2) % 41]).collect();
            if let Some(empty) = empty {
                expected[empty] = 0.0;
            }
            let mut column: Vec<f64> =
                matrix.iter().map(|row| row.iter().zip(&expected).map(|(entry, value)| entry * value).sum()).collect();
            let mut same = column.clone();
            envelope.solve(&mut column);
            solve_rows(&plain, &mut same);
            prop_assert_eq!(&column, &same);
            // Rounding of sixty terms, as much greater as the matrix, of which a row is at most by a hundred times out of balance, lets it.
            for (found, expected) in column.iter().zip(&expected) {
                prop_assert!((found - expected).abs() <= 60.0 * 100.0 * f64::EPSILON, "{} for {}", found, expected);
            }
        }
    }
}
