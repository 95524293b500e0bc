//! Cholesky's factor of a symmetric positive matrix whose entries are all near its diagonal.
//!
//! It stands as an upper triangle, of whose rows each ends with its last entry that is not zero or that of an earlier row. What rows
//! find is taken from all later ones at once: a sum over a row would have to end before the next can begin. Four rows end
//! alike and are solved together: what they write is read again as it was written, which a processor does not wait for.

use std::ops::Range;

use crate::instruction_set::widest;
use crate::memory::{HeapSize, total};

/// A pivot over the largest entry of the diagonal below which a row has no balance of its own.
const PIVOT: f64 = 1e-14;

/// Rows that are solved together, and numbers that are read together.
pub(super) const FOUR: usize = 4;

/// The matrix, and then its factor.
#[derive(Debug, Clone, Default)]
pub(super) struct Envelope {
    /// Rows that the matrix has; some of zeros follow.
    count: usize,
    /// Start of each row's entries, its diagonal, and the end of the last.
    starts: Vec<usize>,
    entries: Vec<f64>,
    /// Inverse of the factor's diagonal; zero where there is no pivot.
    inverses: Vec<f64>,
}

/// Some rows of the upper triangle.
pub(super) struct Piece<'a> {
    /// The first of them.
    first: usize,
    /// Start of each row's entries among all, and the end of the last.
    starts: &'a [usize],
    entries: &'a mut [f64],
}

impl Piece<'_> {
    /// Its rows, of so many in all.
    pub(super) fn rows(&self, count: usize) -> Range<usize> {
        self.first.min(count)..(self.first + self.starts.len() - 1).min(count)
    }

    /// Zeros everywhere.
    pub(super) fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// The entry of one of its rows and of a column not before it.
    #[inline(always)]
    pub(super) fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.entries[self.starts[row - self.first] - self.starts[0] + column - row]
    }
}

impl HeapSize for Envelope {
    fn heap_size(&self) -> usize {
        self.starts.heap_size() + total(&[&self.entries, &self.inverses])
    }
}

impl Envelope {
    /// Room for a matrix whose lower triangle has rows that begin at these columns.
    pub(super) fn new(firsts: &[usize]) -> Self {
        let count = firsts.len();
        let mut ends: Vec<usize> = (1..=count.next_multiple_of(FOUR)).map(|end| end.next_multiple_of(FOUR)).collect();
        for (row, first) in firsts.iter().enumerate() {
            let fours = &mut ends[first / FOUR * FOUR..][..FOUR];
            fours.fill(fours[0].max((row + 1).next_multiple_of(FOUR)));
        }
        let (mut starts, mut end) = (vec![0], 0);
        for (row, own) in ends.iter().enumerate() {
            end = end.max(*own);
            starts.push(starts[row] + end - row);
        }
        Envelope { count, entries: vec![0.0; starts[ends.len()]], inverses: vec![0.0; ends.len()], starts }
    }

    /// The upper triangle in pieces of so many rows.
    pub(super) fn pieces(&mut self, rows: usize) -> impl Iterator<Item = Piece<'_>> + Send {
        let Envelope { starts, entries, .. } = self;
        let (starts, mut rest, count) = (&starts[..], &mut entries[..], starts.len() - 1);
        (0..count).step_by(rows).map(move |first| {
            let starts = &starts[first..=(first + rows).min(count)];
            let (own, later) = std::mem::take(&mut rest).split_at_mut(starts[starts.len() - 1] - starts[0]);
            rest = later;
            Piece { first, starts, entries: own }
        })
    }

    /// Puts the factor in the place of the matrix.
    pub(super) fn factorise(&mut self) {
        factorise(self);
    }

    /// Solves in place; what has no pivot is zero.
    pub(super) fn solve(&self, column: &mut Vec<f64>) {
        column.resize(self.inverses.len(), 0.0);
        solve(self, column);
        column.truncate(self.count);
    }

    /// Four rows from one on: the first entries of each, up to the last of the four, its diagonal among them; and the others of
    /// each.
    #[inline(always)]
    fn four(&self, row: usize) -> ([[f64; FOUR]; FOUR], [&[f64]; FOUR]) {
        let (mut near, mut far) = ([[0.0; FOUR]; FOUR], [&self.entries[..0]; FOUR]);
        let beyond = self.starts[row + 1] - self.starts[row] - FOUR;
        for k in 0..FOUR {
            let (own, more) = self.entries[self.starts[row + k]..self.starts[row + k + 1]].split_at(FOUR - k);
            near[k][k..].copy_from_slice(own);
            far[k] = &more[..beyond];
        }
        (near, far)
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
fn solve_rows(factor: &Envelope, column: &mut [f64]) {
    let count = factor.inverses.len();
    for row in (0..count).step_by(FOUR) {
        let (near, far) = factor.four(row);
        let (own, later) = column[row..].split_at_mut(FOUR);
        let mut found = [0.0; FOUR];
        for k in 0..FOUR {
            let mut left = own[k];
            for before in 0..k {
                left -= near[before][k] * found[before];
            }
            found[k] = left * factor.inverses[row + k];
        }
        own.copy_from_slice(&found);
        let later = later.as_chunks_mut::<FOUR>().0;
        let [a, b, c, d] = far.map(|far| far.as_chunks::<FOUR>().0);
        for ((later, (a, b)), (c, d)) in later.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
            for lane in 0..FOUR {
                let left = later[lane] - a[lane] * found[0] - b[lane] * found[1];
                later[lane] = left - c[lane] * found[2] - d[lane] * found[3];
            }
        }
    }
    for row in (0..count).step_by(FOUR).rev() {
        let (near, far) = factor.four(row);
        let (own, later) = column[row..].split_at_mut(FOUR);
        let later = later[..far[0].len()].as_chunks::<FOUR>().0;
        let [a, b, c, d] = far.map(|far| far.as_chunks::<FOUR>().0);
        // Those just found come last.
        let mut sums = [[0.0; FOUR]; FOUR];
        for ((later, (a, b)), (c, d)) in later.iter().zip(a.iter().zip(b)).zip(c.iter().zip(d)).rev() {
            for lane in 0..FOUR {
                sums[0][lane] += a[lane] * later[lane];
                sums[1][lane] += b[lane] * later[lane];
                sums[2][lane] += c[lane] * later[lane];
                sums[3][lane] += d[lane] * later[lane];
            }
        }
        let mut found = [0.0; FOUR];
        for k in (0..FOUR).rev() {
            let [a, b, c, d] = sums[k];
            let mut left = own[k] - ((a + c) + (b + d));
            for after in (k + 1..FOUR).rev() {
                left -= near[k][after] * found[after];
            }
            found[k] = left * factor.inverses[row + k];
        }
        own.copy_from_slice(&found);
    }
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
            }
            for mut piece in envelope.pieces(5) {
                for row in piece.rows(count) {
                    for column in (row..count).filter(|column| firsts[*column] <= row) {
                        *piece.entry(row, column) = matrix[row][column];
                    }
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
            same.resize(plain.inverses.len(), 0.0);
            envelope.solve(&mut column);
            solve_rows(&plain, &mut same);
            prop_assert_eq!(&column, &same[..count]);
            // Rounding of sixty terms, as much greater as the matrix, of which a row is at most by a hundred times out of balance, lets it.
            for (found, expected) in column.iter().zip(&expected) {
                prop_assert!((found - expected).abs() <= 60.0 * 100.0 * f64::EPSILON, "{} for {}", found, expected);
            }
        }
    }
}
