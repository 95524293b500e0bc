//! Paths of bodies on a lattice, by diagonals: all paths to the particle a fixed number of places further on stand together,
//! so that a loop over particles reads columns from end to end and needs no partner's name.
//!
//! A column of paths has a value for every particle on every diagonal, zero where there is no path; both directions share it.
//! Columns of particles have room before the first and behind the last, so that nobody asks where the body ends. The
//! processor's widest vectors are asked for at run time; every particle sees the same operations in the same order.

use std::array::from_fn;

use crate::balances::row::Row;
use crate::instruction_set::widest;

/// Particles that are handled together.
pub const LANES: usize = 16;

/// Diagonals, at most.
const MOST: usize = 128;

/// Share of the places of all diagonals that paths must fill.
const FILLED: f64 = 0.5;

/// The diagonals of a body.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagonals {
    /// How much further on the partner is, ascending.
    pub offsets: Vec<usize>,
    /// Room before the first particle.
    pub pad: usize,
    /// Length of a diagonal.
    pub stride: usize,
    /// The diagonals of the shortest paths.
    pub nearest: Vec<usize>,
}

type Lanes = [f64; LANES];

/// What paths carry, by place on the diagonals; empty where it is not used.
pub struct Carried<'a> {
    /// Heat that water carries from the earlier end for each kelvin.
    pub carried: &'a [f64],
    /// Exchange that is limited.
    pub exchange: &'a [f64],
    /// Weights of the paths (m^-2), not zero where there is one.
    pub weights: &'a [f64],
    /// Weights of what conduction corrects (m^-2).
    pub even: &'a [f64],
    /// Weights of what gradients correct.
    pub bends: [&'a [f64]; 2],
}

/// What particles hold, with room on both sides.
pub struct Fields<'a> {
    /// Temperatures.
    pub temperature: &'a [f64],
    /// Enthalpies (J/m3).
    pub enthalpy: &'a [f64],
    /// What conduction does, times what a bend is worth.
    pub conducted: &'a [f64],
    /// Gradients of the temperature.
    pub gradients: [&'a [f64]; 2],
}

/// The sum of so many terms, in as many sums as vectors are wide.
#[inline]
pub fn sum(count: usize, term: impl Fn(usize) -> f64) -> f64 {
    let mut sums = [0.0; LANES];
    let whole = count / LANES * LANES;
    for first in (0..whole).step_by(LANES) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += term(first + lane);
        }
    }
    sums.iter().sum::<f64>() + (whole..count).map(term).sum::<f64>()
}

#[inline(always)]
fn lanes(column: &[f64], from: usize) -> Lanes {
    let part = &column[from..from + LANES];
    from_fn(|lane| part[lane])
}

impl Diagonals {
    /// The diagonals of these rows of partners, if they are few and full.
    pub fn of(starts: &[usize], partners: &[u32]) -> Option<Self> {
        let count = starts.len() - 1;
        let mut offsets: Vec<usize> = Vec::new();
        let mut paths = 0;
        for i in 0..count {
            for j in partners[starts[i]..starts[i + 1]].iter().map(|j| *j as usize).filter(|j| *j > i) {
                paths += 1;
                if let Err(place) = offsets.binary_search(&(j - i)) {
                    if offsets.len() == MOST {
                        return None;
                    }
                    offsets.insert(place, j - i);
                }
            }
        }
        let pad = offsets.last()?.next_multiple_of(LANES);
        let stride = pad + count.next_multiple_of(LANES) + LANES;
        let full = paths as f64 >= FILLED * (offsets.len() * count) as f64;
        full.then_some(Diagonals { offsets, pad, stride, nearest: Vec::new() })
    }

    /// Place of the path from a particle to the one that is so much further on.
    pub fn slot(&self, low: usize, offset: usize) -> usize {
        let diagonal = self.offsets.partition_point(|own| *own < offset);
        diagonal * self.stride + self.pad + low
    }

    /// Places on all diagonals.
    pub fn slots(&self) -> usize {
        self.offsets.len() * self.stride
    }

    /// Length of a column of particles with room on both sides.
    pub fn padded(&self) -> usize {
        self.stride + self.pad
    }

    /// What each particle gains, what limits may take, and what lies nearest around it; `first` is the first of the rows.
    pub(super) fn gather(&self, carried: &Carried<'_>, fields: &Fields<'_>, first: usize, rows: &mut [Row]) {
        let (exchange, bends) = (!carried.exchange.is_empty(), !carried.bends[0].is_empty());
        match (exchange, bends, !carried.even.is_empty()) {
            (false, false, false) => gather::<false, false, false>(self, carried, fields, first, rows),
            (false, false, true) => gather::<false, false, true>(self, carried, fields, first, rows),
            (false, true, false) => gather::<false, true, false>(self, carried, fields, first, rows),
            (false, true, true) => gather::<false, true, true>(self, carried, fields, first, rows),
            (true, false, false) => gather::<true, false, false>(self, carried, fields, first, rows),
            (true, false, true) => gather::<true, false, true>(self, carried, fields, first, rows),
            (true, true, false) => gather::<true, true, false>(self, carried, fields, first, rows),
            (true, true, true) => gather::<true, true, true>(self, carried, fields, first, rows),
        }
    }

    /// Adds to rates what water brings and what particles exchange beside it; `first` is the first of the rates.
    pub fn carry(&self, carried: &[f64], exchange: &[f64], temperature: &[f64], first: usize, rates: &mut [f64]) {
        if exchange.is_empty() {
            carry::<false>(self, carried, exchange, temperature, first, rates);
        } else {
            carry::<true>(self, carried, exchange, temperature, first, rates);
        }
    }

    /// The product of a symmetric matrix with a column that has room on both sides.
    pub fn multiply(&self, diagonal: &[f64], rest: &[f64], column: &[f64], image: &mut [f64]) {
        multiply(self, diagonal, rest, column, image);
    }

    /// Symmetric Gauss-Seidel for a residual: forward, then back; `swept` has room on both sides, which stays zero.
    pub fn sweep(&self, inverse: &[f64], rest: &[f64], residual: &[f64], swept: &mut [f64]) {
        sweep(self, inverse, rest, residual, swept);
    }
}

widest!(gather, gather_rows<EXCHANGE, BENDS, CORRECTED>, (own: &Diagonals, carried: &Carried<'_>, fields: &Fields<'_>, first: usize, rows: &mut [Row]));
widest!(carry, carry_rows<EXCHANGE>, (own: &Diagonals, carried: &[f64], exchange: &[f64], temperature: &[f64], first: usize, rates: &mut [f64]));
widest!(multiply, multiply_rows, (own: &Diagonals, diagonal: &[f64], rest: &[f64], column: &[f64], image: &mut [f64]));
widest!(sweep, sweep_rows, (own: &Diagonals, inverse: &[f64], rest: &[f64], residual: &[f64], swept: &mut [f64]));

/// A particle's own part of [`Fields`].
#[derive(Clone, Copy)]
struct Own {
    temperature: Lanes,
    conducted: Lanes,
    gradients: [Lanes; 2],
}

impl Own {
    #[inline(always)]
    fn at<const BENDS: bool, const CORRECTED: bool>(fields: &Fields<'_>, place: usize) -> Self {
        let none = [0.0; LANES];
        Own {
            temperature: lanes(fields.temperature, place),
            conducted: if CORRECTED { lanes(fields.conducted, place) } else { none },
            gradients: if BENDS { fields.gradients.map(|column| lanes(column, place)) } else { [none; 2] },
        }
    }
}

#[inline(always)]
fn gather_rows<const EXCHANGE: bool, const BENDS: bool, const CORRECTED: bool>(
    diagonals: &Diagonals,
    carried: &Carried<'_>,
    fields: &Fields<'_>,
    first: usize,
    rows: &mut [Row],
) {
    for (block, rows) in rows.chunks_mut(LANES).enumerate() {
        let at = diagonals.pad + first + block * LANES;
        let own = Own::at::<BENDS, CORRECTED>(fields, at);
        let (mut gain, mut up, mut down) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (number, offset) in diagonals.offsets.iter().enumerate() {
            for side in 0..2 {
                // From the lower end the path has the particle's own place, from the higher that of the other end.
                let (place, partner) = if side == 0 { (at, at + offset) } else { (at - offset, at - offset) };
                let place = number * diagonals.stride + place;
                let other = Own::at::<BENDS, CORRECTED>(fields, partner);
                let water = lanes(carried.carried, place);
                let exchange = if EXCHANGE { lanes(carried.exchange, place) } else { [0.0; LANES] };
                let even = if CORRECTED { lanes(carried.even, place) } else { [0.0; LANES] };
                let bends = if BENDS { carried.bends.map(|column| lanes(column, place)) } else { [[0.0; LANES]; 2] };
                for lane in 0..LANES {
                    let rise = other.temperature[lane] - own.temperature[lane];
                    // Water to a partner brings none of its heat.
                    let brought = water[lane] * rise;
                    gain[lane] += if side == 0 { -brought } else { brought };
                    let mut back = 0.0;
                    if CORRECTED {
                        back += even[lane] * (own.conducted[lane] - other.conducted[lane]);
                    }
                    if BENDS {
                        back += bends[0][lane] * (other.gradients[0][lane] - own.gradients[0][lane])
                            + bends[1][lane] * (other.gradients[1][lane] - own.gradients[1][lane]);
                    }
                    if EXCHANGE {
                        gain[lane] += exchange[lane] * rise;
                        back -= exchange[lane] * rise;
                    }
                    up[lane] += if back > 0.0 { back } else { 0.0 };
                    down[lane] += if back < 0.0 { back } else { 0.0 };
                }
            }
        }
        let enthalpy = lanes(fields.enthalpy, at);
        let (mut least, mut most) = (enthalpy, enthalpy);
        for number in &diagonals.nearest {
            let offset = diagonals.offsets[*number];
            for (place, partner) in [(at, at + offset), (at - offset, at - offset)] {
                let weight = lanes(carried.weights, number * diagonals.stride + place);
                let other = lanes(fields.enthalpy, partner);
                for lane in 0..LANES {
                    let there = if weight[lane] != 0.0 { other[lane] } else { enthalpy[lane] };
                    least[lane] = if there < least[lane] { there } else { least[lane] };
                    most[lane] = if there > most[lane] { there } else { most[lane] };
                }
            }
        }
        for (lane, row) in rows.iter_mut().enumerate() {
            *row = Row { gain: gain[lane], up: up[lane], down: down[lane], least: least[lane], most: most[lane] };
        }
    }
}

#[inline(always)]
fn carry_rows<const EXCHANGE: bool>(
    diagonals: &Diagonals,
    carried: &[f64],
    exchange: &[f64],
    temperature: &[f64],
    first: usize,
    rates: &mut [f64],
) {
    for (block, rates) in rates.chunks_mut(LANES).enumerate() {
        let at = diagonals.pad + first + block * LANES;
        let own = lanes(temperature, at);
        let mut gain = [0.0; LANES];
        for (number, offset) in diagonals.offsets.iter().enumerate() {
            let place = number * diagonals.stride + at;
            let (higher, lower) = (lanes(temperature, at + offset), lanes(temperature, at - offset));
            let (forth, back) = (lanes(carried, place), lanes(carried, place - offset));
            for lane in 0..LANES {
                // Water to a partner brings none of its heat.
                gain[lane] += back[lane] * (lower[lane] - own[lane]) - forth[lane] * (higher[lane] - own[lane]);
            }
            if EXCHANGE {
                let (forth, back) = (lanes(exchange, place), lanes(exchange, place - offset));
                for lane in 0..LANES {
                    gain[lane] += back[lane] * (lower[lane] - own[lane]) + forth[lane] * (higher[lane] - own[lane]);
                }
            }
        }
        for (rate, gain) in rates.iter_mut().zip(gain) {
            *rate += gain;
        }
    }
}

#[inline(always)]
fn multiply_rows(diagonals: &Diagonals, diagonal: &[f64], rest: &[f64], column: &[f64], image: &mut [f64]) {
    for (block, (image, diagonal)) in image.chunks_mut(LANES).zip(diagonal.chunks(LANES)).enumerate() {
        let at = diagonals.pad + block * LANES;
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
        for (lane, (image, diagonal)) in image.iter_mut().zip(diagonal).enumerate() {
            *image = diagonal * own[lane] + sum[lane];
        }
    }
}

#[inline(always)]
fn sweep_rows(diagonals: &Diagonals, inverse: &[f64], rest: &[f64], residual: &[f64], swept: &mut [f64]) {
    // Partners within a block are known one after the other, those beyond it all at once.
    let near = diagonals.offsets.partition_point(|offset| *offset < LANES);
    let (close, far) = diagonals.offsets.split_at(near);
    let (count, pad, stride) = (residual.len(), diagonals.pad, diagonals.stride);
    for first in (0..count).step_by(LANES) {
        let at = pad + first;
        let mut sum = [0.0; LANES];
        for (number, offset) in far.iter().enumerate() {
            let (back, lower) = (lanes(rest, (near + number) * stride + at - offset), lanes(swept, at - offset));
            for lane in 0..LANES {
                sum[lane] += back[lane] * lower[lane];
            }
        }
        for lane in 0..LANES.min(count - first) {
            let mut left = residual[first + lane] - sum[lane];
            // The nearest is known last.
            for (number, offset) in close.iter().enumerate().rev() {
                left -= rest[number * stride + at + lane - offset] * swept[at + lane - offset];
            }
            swept[at + lane] = left * inverse[first + lane];
        }
    }
    for first in (0..count).step_by(LANES).rev() {
        let at = pad + first;
        let mut sum = [0.0; LANES];
        for (number, offset) in far.iter().enumerate() {
            let (forth, higher) = (lanes(rest, (near + number) * stride + at), lanes(swept, at + offset));
            for lane in 0..LANES {
                sum[lane] += forth[lane] * higher[lane];
            }
        }
        for lane in (0..LANES.min(count - first)).rev() {
            let mut sum = sum[lane];
            for (number, offset) in close.iter().enumerate().rev() {
                sum += rest[number * stride + at + lane] * swept[at + lane + offset];
            }
            swept[at + lane] -= sum * inverse[first + lane];
        }
    }
}

#[cfg(test)]
mod tests {
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
            let own = Diagonals::of(&starts, &partners).expect("diagonals");
            let drawn = |length: usize, from: usize| -> Vec<f64> {
                (0..length).map(|k| numbers[(k * 7 + from) % 64] * (1.0 + k as f64 / 64.0)).collect()
            };
            let mut rest = vec![0.0; own.slots()];
            for i in 0..count {
                for j in partners[starts[i]..starts[i + 1]].iter().map(|j| *j as usize).filter(|j| *j > i) {
                    rest[own.slot(i, j - i)] = numbers[(i + 3 * j) % 64];
                }
            }
            let (diagonal, mut column) = (drawn(count, 3), vec![0.0; own.padded()]);
            column[own.pad..own.pad + count].copy_from_slice(&drawn(count, 11));
            let (mut wide, mut plain) = (vec![0.0; count], vec![0.0; count]);
            own.multiply(&diagonal, &rest, &column, &mut wide);
            multiply_rows(&own, &diagonal, &rest, &column, &mut plain);
            prop_assert_eq!(wide, plain);
            let (mut wide, mut plain) = (vec![0.0; own.padded()], vec![0.0; own.padded()]);
            let inverse: Vec<f64> = diagonal.iter().map(|own| 1e-3 / (own.abs() + 1.0)).collect();
            own.sweep(&inverse, &rest, &drawn(count, 5), &mut wide);
            sweep_rows(&own, &inverse, &rest, &drawn(count, 5), &mut plain);
            prop_assert_eq!(wide, plain);
        }
    }
}
