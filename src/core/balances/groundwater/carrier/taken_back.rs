//! What is taken back of the exchange beside water, and what bends mend, at particles where it is not all of it.

use crate::balances::groundwater::carrier::{Carrier, State};
use crate::balances::groundwater::diagonals::{
    Brought, Carried, Diagonals, Fields, LANES, Own, blocks, by_parts, lanes,
};
use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::places::Stretch;
use crate::balances::groundwater::tasks::{among, each, tasks};
use crate::instruction_set::widest;

impl Carrier {
    /// Adds to the rates (W/m3) what each particle gains, and what of it is taken back.
    pub(super) fn take_back(&mut self, network: &Network, state: &State<'_>, rate: &mut [f64]) {
        let by_diagonals = network.diagonals.as_ref().filter(|_| !state.mixed);
        if let Some(diagonals) = by_diagonals.filter(|_| self.limited.contains(&true)) {
            self.take_back_by_diagonals(network, diagonals, state);
        }
        let Carrier { rows, marked, sums, .. } = &*self;
        each(state.team, rate, |i, rate| {
            let row = rows[i];
            let back = match (marked[i], by_diagonals) {
                (false, _) => row.up + row.down,
                (true, Some(_)) => sums[i],
                (true, None) => self.taken_back(network, state, i),
            };
            *rate += row.gain + back;
        });
    }

    /// Puts what the marked particles keep into the sums.
    fn take_back_by_diagonals(&mut self, network: &Network, diagonals: &Diagonals, state: &State<'_>) {
        let Carrier { limits, columns: [.., up, down], .. } = self;
        diagonals.places.fill(state.team, [up, down], |particles, [up, down]| {
            for ((limits, up), down) in limits[particles].iter().zip(up).zip(down) {
                (*up, *down) = *limits;
            }
        });
        let mut sums = std::mem::take(&mut self.sums);
        let (carried, fields, shares) = (self.carried(network), self.fields(), self.shares());
        let aside = if self.bends { &network.aside[..] } else { &[] };
        tasks(state.team, &mut sums, |first, sums| {
            let marked = &self.marked[first..first + sums.len()];
            diagonals.take_back(&carried, &fields, (shares, marked), first, sums);
            for i in among(aside, first, sums.len()).filter(|i| self.marked[*i]) {
                sums[i - first] = self.taken_back(network, state, i);
            }
        });
        self.sums = sums;
    }

    /// What one particle keeps of what is taken back, by its paths.
    fn taken_back(&self, network: &Network, state: &State<'_>, i: usize) -> f64 {
        let (own, (up, down)) = (state.temperature[i], self.limits[i]);
        let paths = network.paths(i).map(|(j, slot, _)| {
            let exchange = if self.exchanges { self.exchange[slot] } else { 0.0 };
            let back = exchange * (own - state.temperature[j]) + self.bend(network, i, j, slot);
            back * if back > 0.0 { up.min(self.limits[j].1) } else { down.min(self.limits[j].0) }
        });
        paths.sum()
    }
}

/// Shares that each place may gain and lose, and which of the particles are asked for.
type Limits<'a> = ([&'a [f64]; 2], &'a [bool]);

impl Diagonals {
    /// Fills `back`, from particle `first` on, with what those that are asked for keep of what is taken back.
    fn take_back(
        &self,
        carried: &Carried<'_>,
        fields: &Fields<'_>,
        limits: Limits<'_>,
        first: usize,
        back: &mut [f64],
    ) {
        by_parts!(carried, keep(self, carried, fields, limits, first, back));
    }
}

widest!(keep, keep_rows<EXCHANGE, BENDS, CORRECTED>, (own: &Diagonals, carried: &Carried<'_>, fields: &Fields<'_>, limits: Limits<'_>, first: usize, back: &mut [f64]));

#[inline(always)]
fn keep_rows<const EXCHANGE: bool, const BENDS: bool, const CORRECTED: bool>(
    diagonals: &Diagonals,
    carried: &Carried<'_>,
    fields: &Fields<'_>,
    (shares, marked): Limits<'_>,
    first: usize,
    back: &mut [f64],
) {
    for block in diagonals.places.stretches(first, back.len()).flat_map(blocks) {
        let Stretch { before, at, count } = block;
        if !marked[before..before + count].contains(&true) {
            continue;
        }
        let own = Own::at::<BENDS, CORRECTED>(fields, at);
        let own_shares = shares.map(|column| lanes(column, at));
        let mut kept = [0.0; LANES];
        // In the order of the partners: on one diagonal after the other the earlier ones, then the later.
        let diagonal_count = diagonals.offsets.len();
        for side in 0..2 * diagonal_count {
            let number = if side < diagonal_count { diagonal_count - 1 - side } else { side - diagonal_count };
            let offset = diagonals.offsets[number];
            let (place, partner) = if side < diagonal_count { (at - offset, at - offset) } else { (at, at + offset) };
            let place = number * diagonals.stride + place;
            let path = Brought::at::<EXCHANGE, BENDS, CORRECTED>(carried, number, place);
            let other = Own::at::<BENDS, CORRECTED>(fields, partner);
            let [up, down] = shares.map(|column| lanes(column, partner));
            for lane in 0..LANES {
                let back = path.back::<EXCHANGE, BENDS, CORRECTED>(&own, &other, lane);
                let added = if own_shares[0][lane] < down[lane] { own_shares[0][lane] } else { down[lane] };
                let taken = if own_shares[1][lane] < up[lane] { own_shares[1][lane] } else { up[lane] };
                kept[lane] += back * if back > 0.0 { added } else { taken };
            }
        }
        back[before..before + count].copy_from_slice(&kept[..count]);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;
    use crate::balances::groundwater::network::tests::{on_paths, rows};
    use crate::balances::row::Row;

    proptest! {
        /// What is kept by diagonals is what is kept path by path.
        #[test]
        fn diagonals_keep_what_paths_keep(
            lengths in prop::collection::vec(20_usize..24, 8..16),
            (reach, odd) in (1_usize..4, 5_usize..200),
            numbers in prop::collection::vec(-1.0_f64..1.0, 31),
            (exchanges, bends, corrected) in any::<(bool, bool, bool)>(),
        ) {
            let mut network = rows(&lengths, reach, odd);
            let drawn = |i: usize| numbers[i * 7 % 31];
            let by_slot = |first: usize| on_paths(&network, |slot| drawn(slot + first));
            let [weights, even, carried, exchange] = [0, 3, 1, 2].map(by_slot);
            network.weights = weights.into_iter().map(f64::abs).collect();
            network.even_weights = even;
            network.straighten();
            let count = network.len();
            let by_particle = |first: usize| -> Vec<f64> { (0..count).map(|i| drawn(i + first)).collect() };
            let (temperature, enthalpy) = (by_particle(5), by_particle(6));
            let diagonals = network.diagonals.as_ref().expect("a lattice");
            let mut carrier = Carrier {
                carried,
                exchange: exchange.into_iter().map(f64::abs).collect(),
                exchanges,
                bends,
                gradients: (0..count).map(|i| DVec2::new(drawn(i + 7), drawn(i + 8))).collect(),
                conducted: if corrected { by_particle(9) } else { Vec::new() },
                columns: std::array::from_fn(|_| vec![0.0; diagonals.padded()]),
                rows: vec![Row::default(); count],
                marked: by_particle(10).iter().map(|number| *number > 0.5).collect(),
                limits: (0..count).map(|i| (drawn(i + 11).abs(), drawn(i + 12).abs())).collect(),
                sums: vec![0.0; count],
                ..Carrier::default()
            };
            let state = State {
                temperature: &temperature,
                enthalpy: &enthalpy,
                step: 1.0,
                mixed: false,
                enthalpy_at: &|_, temperature| temperature,
                openings: &[],
                beside: &[],
                team: None,
            };
            carrier.gather(&network, &state);
            carrier.take_back_by_diagonals(&network, diagonals, &state);
            for i in (0..count).filter(|i| carrier.marked[*i]) {
                let expected = carrier.taken_back(&network, &state, i);
                // Some fifty terms of order one, whose spans differ by the rounding of places.
                prop_assert!((carrier.sums[i] - expected).abs() <= 1e-13, "{} for {expected}", carrier.sums[i]);
            }
        }
    }
}
