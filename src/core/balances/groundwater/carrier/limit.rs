//! How much of the exchange beside water is taken back: as much as leaves every particle within the enthalpies around it
//! (Zalesak 1979).

use crate::balances::groundwater::carrier::{Carrier, State};
use crate::balances::groundwater::diagonals::{Carried, Diagonals, Fields};
use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::tasks::{among, each, tasks, tasks_of_two, when};
use crate::balances::row::Row;

impl Carrier {
    /// What each particle gains with the whole exchange, and what lies around it.
    pub(super) fn gather(&mut self, network: &Network, state: &State<'_>) {
        let mut rows = std::mem::take(&mut self.rows);
        match &network.diagonals {
            Some(diagonals) if !state.mixed => self.gather_diagonals(network, diagonals, state, &mut rows),
            _ => self.gather_paths(network, state, &mut rows),
        }
        self.rows = rows;
        for (i, temperature) in state.beside {
            let wall = (state.enthalpy_at)(*i as usize, *temperature);
            self.rows[*i as usize].see(wall);
        }
    }

    fn gather_diagonals(&mut self, network: &Network, diagonals: &Diagonals, state: &State<'_>, rows: &mut [Row]) {
        let Carrier { columns, conducted, gradients, .. } = self;
        let [of_temperature, of_enthalpy, of_conducted, x, y, ..] = columns.each_mut().map(|column| &mut column[..]);
        let columns = [of_temperature, of_enthalpy, of_conducted, x, y];
        diagonals.places.fill(state.team, columns, |particles, [of_temperature, of_enthalpy, of_conducted, x, y]| {
            of_temperature.copy_from_slice(&state.temperature[particles.clone()]);
            of_enthalpy.copy_from_slice(&state.enthalpy[particles.clone()]);
            if !conducted.is_empty() {
                of_conducted.copy_from_slice(&conducted[particles.clone()]);
            }
            if !gradients.is_empty() {
                for ((gradient, x), y) in gradients[particles].iter().zip(x).zip(y) {
                    (*x, *y) = (gradient.x, gradient.y);
                }
            }
        });
        let (carried, fields) = (self.carried(network), self.fields());
        let aside = if self.bends { &network.aside[..] } else { &[] };
        tasks(state.team, rows, |first, rows| {
            diagonals.gather(&carried, &fields, first, rows);
            for i in among(aside, first, rows.len()) {
                rows[i - first] = self.row_by_paths(network, state, i);
            }
        });
    }

    /// What paths carry, by diagonals.
    pub(super) fn carried<'a>(&'a self, network: &'a Network) -> Carried<'a> {
        Carried {
            carried: &self.carried,
            exchange: when(self.exchanges, &self.exchange),
            weights: &network.weights,
            even: when(!self.conducted.is_empty(), &network.even_weights),
            reaches: if self.bends { &network.reaches } else { &[] },
        }
    }

    /// What particles hold, once it is gathered.
    pub(super) fn fields(&self) -> Fields<'_> {
        let [temperature, enthalpy, conducted, x, y, ..] = &self.columns;
        Fields { temperature, enthalpy, conducted, gradients: [x, y] }
    }

    /// Shares that each place may gain and lose, once they are known.
    pub(super) fn shares(&self) -> [&[f64]; 2] {
        let [.., up, down] = &self.columns;
        [up, down]
    }

    fn gather_paths(&self, network: &Network, state: &State<'_>, rows: &mut [Row]) {
        each(state.team, rows, |i, row| *row = self.row_by_paths(network, state, i));
    }

    fn row_by_paths(&self, network: &Network, state: &State<'_>, i: usize) -> Row {
        let (own, enthalpy) = (state.temperature[i], state.enthalpy[i]);
        let mut row = Row::around(enthalpy);
        let mut warmest = (own, i);
        let mut coldest = (own, i);
        for (j, slot, later) in network.paths(i) {
            let rise = state.temperature[j] - own;
            row.gain += self.factor(slot, later) * rise;
            let exchange = if self.exchanges { self.exchange[slot] } else { 0.0 };
            row.add(self.bend(network, i, j, slot) - exchange * rise);
            if !state.mixed {
                row.see(state.enthalpy[j]);
            } else {
                warmest = if state.temperature[j] > warmest.0 { (state.temperature[j], j) } else { warmest };
                coldest = if state.temperature[j] < coldest.0 { (state.temperature[j], j) } else { coldest };
            }
        }
        if state.mixed {
            row.see((state.enthalpy_at)(i, warmest.0));
            row.see((state.enthalpy_at)(i, coldest.0));
        }
        row
    }

    /// How much of the exchange may be taken back at each particle; marks those where it is not all.
    pub(super) fn limit(&mut self, network: &Network, state: &State<'_>, rate: &[f64]) {
        let nearest_only = network.diagonals.is_some() && !state.mixed;
        let Carrier { rows, limits, limited, marked, .. } = self;
        tasks_of_two(state.team, (limits, limited), |first, limits, limited| {
            for ((i, limits), limited) in (first..).zip(limits).zip(limited) {
                let mut row = rows[i];
                let low = state.enthalpy[i] + state.step * (rate[i] + row.gain);
                let shares = |row: &Row| row.shares(row.most - low, low - row.least, state.step);
                let (mut up, mut down) = shares(&row);
                if nearest_only && (up < 1.0 || down < 1.0) {
                    network.paths(i).for_each(|(j, ..)| row.see(state.enthalpy[j]));
                    (up, down) = shares(&row);
                }
                (*limits, *limited) = ((up, down), up < 1.0 || down < 1.0);
            }
        });
        marked.fill(false);
        for i in (0..network.len()).filter(|i| limited[*i]) {
            marked[i] = true;
            for j in &network.partners[network.starts[i]..network.starts[i + 1]] {
                marked[*j as usize] = true;
            }
        }
    }
}
