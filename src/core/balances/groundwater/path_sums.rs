//! What all paths have, and what the paths of each particle have together.

use crate::balances::groundwater::network::Network;

impl Network {
    /// Fills a column by slot from another and what particles at the earlier and at the later end hold; `places` takes what they
    /// hold, on diagonals. Where there is no path the other column is zero, and so must the value be.
    #[inline(always)]
    pub(super) fn by_path(
        &self,
        column: &[f64],
        field: &[f64],
        places: &mut [f64],
        value: impl Fn(f64, f64, f64) -> f64,
        out: &mut [f64],
    ) {
        let Some(diagonals) = &self.diagonals else {
            return self.each_path(|i, j, slot| out[slot] = value(column[slot], field[i], field[j]));
        };
        diagonals.places.spread(field, places);
        let pad = diagonals.places.room;
        for (number, offset) in diagonals.offsets.iter().enumerate() {
            let (base, count) = (number * diagonals.stride + pad, diagonals.stride - pad);
            let (column, out) = (&column[base..base + count], &mut out[base..base + count]);
            let (earlier, later) = (&places[pad..pad + count], &places[pad + offset..pad + offset + count]);
            for i in 0..count {
                out[i] = value(column[i], earlier[i], later[i]);
            }
        }
    }

    /// Fills a column of particles with the sums over their paths of a term of `columns` by slot, as it is seen from the
    /// earlier end (`true`) or from the later. Without a path, where all columns are zero, the term must be zero.
    #[inline(always)]
    pub(super) fn sums(&self, columns: [&[f64]; 3], term: impl Fn([f64; 3], bool) -> f64, sums: &mut [f64]) {
        if let Some(diagonals) = &self.diagonals {
            return diagonals.sums(columns, term, sums);
        }
        sums.fill(0.0);
        self.each_path(|i, j, slot| {
            let columns = columns.map(|column| column[slot]);
            sums[i] += term(columns, true);
            sums[j] += term(columns, false);
        });
    }
}
