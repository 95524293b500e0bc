//! Direct solution of narrow banded systems.

use crate::memory::HeapSize;
use crate::saved::{Pass, Saved};

/// A square matrix with entries within `half` of its diagonal, row by row.
#[derive(Debug, Clone)]
pub struct Band {
    half: usize,
    rows: Vec<f64>,
}

impl Band {
    /// A matrix of zeros of `count` rows with `half` entries on either side of the diagonal.
    pub fn new(count: usize, half: usize) -> Self {
        Band { half, rows: vec![0.0; count * (2 * half + 1)] }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len() / (2 * self.half + 1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Distance over which rows reach to either side.
    pub fn half(&self) -> usize {
        self.half
    }

    /// Entries of a row, from `half` left of the diagonal to `half` right of it.
    pub fn row(&self, row: usize) -> &[f64] {
        let width = 2 * self.half + 1;
        &self.rows[row * width..][..width]
    }

    /// The same, to be changed.
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        let width = 2 * self.half + 1;
        &mut self.rows[row * width..][..width]
    }

    /// Solves in place by elimination without exchange of rows, which is safe where every column is dominated by its
    /// diagonal; the matrix is used up.
    pub fn solve(&mut self, right: &mut [f64]) {
        let (half, count) = (self.half, self.len());
        let width = 2 * half + 1;
        for pivot in 0..count {
            let last = (pivot + half).min(count - 1);
            let (upper, lower) = self.rows.split_at_mut((pivot + 1) * width);
            let pivots = &upper[pivot * width + half..];
            let inverse = 1.0 / pivots[0];
            let reached = last - pivot;
            for (below, row) in lower.chunks_exact_mut(width).take(reached).enumerate() {
                // Column `pivot` stands `below + 1` left of this row's diagonal.
                let left = half - below - 1;
                let factor = row[left] * inverse;
                if factor == 0.0 {
                    continue;
                }
                for (entry, pivot_entry) in row[left + 1..].iter_mut().zip(&pivots[1..=reached]) {
                    *entry -= factor * pivot_entry;
                }
                right[pivot + 1 + below] -= factor * right[pivot];
            }
        }
        for row in (0..count).rev() {
            let reached = half.min(count - 1 - row);
            let entries = &self.rows[row * width + half..][..=reached];
            let known: f64 = entries[1..].iter().zip(&right[row + 1..]).map(|(entry, value)| entry * value).sum();
            right[row] = (right[row] - known) / entries[0];
        }
    }
}

impl Saved for Band {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.rows.pass(pass);
    }
}

impl HeapSize for Band {
    fn heap_size(&self) -> usize {
        self.rows.heap_size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Solving undoes multiplying, for matrices whose columns are dominated by their diagonal.
        #[test]
        fn a_dominated_system_is_solved(
            count in 1usize..20,
            half in 1usize..5,
            numbers in prop::collection::vec(-1.0..1.0f64, 20 * 11),
            wanted in prop::collection::vec(-1.0..1.0f64, 20),
        ) {
            let mut band = Band::new(count, half);
            for row in 0..count {
                for offset in 0..=2 * half {
                    let column = (row + offset).checked_sub(half).filter(|column| *column < count);
                    if column.is_some() {
                        let dominant = if offset == half { 2.0 * half as f64 + 1.0 } else { 0.0 };
                        band.row_mut(row)[offset] = numbers[row * 11 + offset.min(10)] + dominant;
                    }
                }
            }
            let mut right: Vec<f64> = (0..count)
                .map(|row| {
                    let reached = (0..=2 * half).filter_map(|offset| {
                        let column = (row + offset).checked_sub(half).filter(|column| *column < count)?;
                        Some(band.row(row)[offset] * wanted[column])
                    });
                    reached.sum()
                })
                .collect();
            band.solve(&mut right);
            for (found, wanted) in right.iter().zip(&wanted) {
                // Condition numbers below a hundred: rounding times a few dozen operations.
                prop_assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
            }
        }
    }
}
