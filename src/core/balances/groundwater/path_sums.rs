//! What all paths have, and what the paths of each particle have together.

use glam::DVec2;

use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::tasks::{TASK, each, share, tasks};
use crate::team::Team;

impl Network {
    /// Fills a column by slot from another and what particles at the earlier and at the later end hold; `places` takes what they
    /// hold, on diagonals. Where there is no path the other column is zero, and so must the value be.
    #[inline(always)]
    pub(super) fn by_path(
        &self,
        team: Option<&Team>,
        (column, field): (&[f64], &[f64]),
        places: &mut [f64],
        value: impl Fn(f64, f64, f64) -> f64 + Sync,
        out: &mut [f64],
    ) {
        let Some(diagonals) = &self.diagonals else {
            return self.each_path(|i, j, slot| out[slot] = value(column[slot], field[i], field[j]));
        };
        diagonals.places.spread(team, field, places);
        let places = &*places;
        let (pad, stride) = (diagonals.places.room, diagonals.stride);
        let parts = diagonals.offsets.iter().zip(out.chunks_mut(stride)).zip(column.chunks(stride));
        let parts = parts.flat_map(|((offset, out), column)| {
            let pieces = out[pad..].chunks_mut(TASK).zip(column[pad..].chunks(TASK));
            let later = places[pad + offset..].chunks(TASK);
            pieces.zip(places[pad..].chunks(TASK)).zip(later)
        });
        share(team, self.len(), parts, |(((out, column), earlier), later)| {
            let count = out.len();
            let (column, earlier, later) = (&column[..count], &earlier[..count], &later[..count]);
            for i in 0..count {
                out[i] = value(column[i], earlier[i], later[i]);
            }
        });
    }

    /// Fills a column of particles with the sums over their paths of a term of `columns` by slot, as it is seen from the
    /// earlier end (`true`) or from the later. Without a path, where all columns are zero, the term must be zero.
    #[inline(always)]
    pub(super) fn sums(
        &self,
        team: Option<&Team>,
        columns: [&[f64]; 3],
        term: impl Fn([f64; 3], bool) -> f64 + Sync,
        sums: &mut [f64],
    ) {
        if let Some(diagonals) = &self.diagonals {
            return tasks(team, sums, |first, sums| diagonals.sums(columns, &term, first, sums));
        }
        sums.fill(0.0);
        self.each_path(|i, j, slot| {
            let columns = columns.map(|column| column[slot]);
            sums[i] += term(columns, true);
            sums[j] += term(columns, false);
        });
    }

    /// Fills a column of particles with half of the sums over their paths of how much a field rises along them, times their factors by
    /// slot and their vectors (m): the gradients of the field by weights, whose second moment is twice the unit matrix. `places` takes the
    /// field, on diagonals. Where there is no path the factor must be zero.
    pub(super) fn slopes(
        &self,
        team: Option<&Team>,
        (factors, field): (&[f64], &[f64]),
        places: &mut [f64],
        slopes: &mut [DVec2],
    ) {
        let half = |slot: u32, i: usize, j: u32| 0.5 * factors[slot as usize] * (field[j as usize] - field[i]);
        let Some(diagonals) = &self.diagonals else {
            return each(team, slopes, |i, slope| {
                let paths = self.starts[i]..self.starts[i + 1];
                *slope = paths.map(|k| half(self.slots[k], i, self.partners[k]) * self.arms[k]).sum();
            });
        };
        diagonals.places.spread(team, field, places);
        let places = &*places;
        tasks(team, slopes, |first, slopes| diagonals.slopes((factors, &self.reaches), places, first, slopes));
        for odd in &self.odd_arms {
            slopes[odd.from as usize] += half(odd.slot, odd.from as usize, odd.to) * odd.more;
        }
    }
}
