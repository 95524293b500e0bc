//! Paths of bodies on a lattice, by diagonals: all paths to the particle a fixed number of places further on stand together,
//! so that a loop over particles reads columns from end to end and needs no partner's name.
//!
//! Particles have places: their numbers, or, where rows of the lattice differ in length, those of a whole rectangle around
//! them. A column of paths has a value for every place on every diagonal, zero where there is no path; both directions share
//! it. Columns of places have room before the first and behind the last, so that nobody asks where the body ends. The
//! processor's widest vectors are asked for at run time; every particle sees the same operations in the same order.

use std::array::from_fn;

use glam::DVec2;

use crate::balances::groundwater::places::{Places, Stretch, sites};
use crate::balances::row::Row;
use crate::instruction_set::widest;

/// Particles that are handled together.
pub const LANES: usize = 16;

/// Particles whose paths on one diagonal are read in a row: so many streams as there are diagonals would be too many at once.
const STRETCH: usize = 512;

/// Diagonals, at most.
const MOST: usize = 128;

/// Share of the places of all diagonals that paths must fill.
const FILLED: f64 = 0.5;

/// How much of the rise of the gradients along it a path carries less than the mean of its ends, over what it carries and its span.
pub(super) const BENT: f64 = 1.0 / 3.0;

/// The diagonals of a body.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Diagonals {
    /// How much further on the partner is, ascending.
    pub offsets: Vec<usize>,
    /// Length of a diagonal.
    pub stride: usize,
    /// Where particles stand.
    pub places: Places,
    /// The diagonals of the shortest paths.
    pub nearest: Vec<usize>,
}

pub(super) type Lanes = [f64; LANES];

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
    /// Vectors of the diagonals (m), where gradients correct.
    pub reaches: &'a [DVec2],
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
#[inline(always)]
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

/// A stretch in blocks, of which the last may have fewer particles than lanes.
#[inline(always)]
pub(super) fn blocks(Stretch { before, at, count }: Stretch) -> impl DoubleEndedIterator<Item = Stretch> {
    let block = move |from| Stretch { before: before + from, at: at + from, count: LANES.min(count - from) };
    (0..count).step_by(LANES).map(block)
}

#[inline(always)]
pub(super) fn lanes(column: &[f64], from: usize) -> Lanes {
    let part = &column[from..from + LANES];
    from_fn(|lane| part[lane])
}

/// Calls the kernel for what paths carry: exchange, bends, corrections of conduction.
macro_rules! by_parts {
    ($carried:ident, $kernel:ident($($argument:expr),*)) => {
        match (!$carried.exchange.is_empty(), !$carried.reaches.is_empty(), !$carried.even.is_empty()) {
            (false, false, false) => $kernel::<false, false, false>($($argument),*),
            (false, false, true) => $kernel::<false, false, true>($($argument),*),
            (false, true, false) => $kernel::<false, true, false>($($argument),*),
            (false, true, true) => $kernel::<false, true, true>($($argument),*),
            (true, false, false) => $kernel::<true, false, false>($($argument),*),
            (true, false, true) => $kernel::<true, false, true>($($argument),*),
            (true, true, false) => $kernel::<true, true, false>($($argument),*),
            (true, true, true) => $kernel::<true, true, true>($($argument),*),
        }
    };
}

pub(super) use by_parts;

impl Diagonals {
    /// The diagonals of these rows of partners, if they are few and full.
    pub fn of(starts: &[usize], partners: &[u32], positions: &[DVec2]) -> Option<Self> {
        let numbers: Vec<usize> = (0..positions.len()).collect();
        let of = |places: &[usize]| Self::at(starts, partners, places);
        of(&numbers).or_else(|| of(&sites(starts, partners, positions)?))
    }

    /// The diagonals of particles at these places.
    fn at(starts: &[usize], partners: &[u32], places: &[usize]) -> Option<Self> {
        let count = places.len();
        let mut offsets: Vec<usize> = Vec::new();
        let mut paths = 0;
        for i in 0..count {
            for j in partners[starts[i]..starts[i + 1]].iter().map(|j| *j as usize).filter(|j| *j > i) {
                paths += 1;
                let offset = places[j] - places[i];
                if let Err(found) = offsets.binary_search(&offset) {
                    if offsets.len() == MOST {
                        return None;
                    }
                    offsets.insert(found, offset);
                }
            }
        }
        let room = offsets.last()?.next_multiple_of(LANES);
        let all = places.last()? + 1;
        let stride = room + all.next_multiple_of(LANES) + LANES;
        let full = paths as f64 >= FILLED * (offsets.len() * all) as f64;
        full.then(|| Diagonals { offsets, stride, places: Places::new(places, room), nearest: Vec::new() })
    }

    /// Place on the columns of paths of the path from a particle to a later one.
    pub fn slot(&self, low: usize, high: usize) -> usize {
        let [low, high] = [low, high].map(|particle| self.places.of(particle));
        let diagonal = self.offsets.partition_point(|own| *own < high - low);
        diagonal * self.stride + low
    }

    /// Places on all diagonals.
    pub fn slots(&self) -> usize {
        self.offsets.len() * self.stride
    }

    /// Length of a column of particles with room on both sides.
    pub fn padded(&self) -> usize {
        self.stride + self.places.room
    }

    /// What each particle gains, what limits may take, and what lies nearest around it; `first` is the first of the rows.
    pub(super) fn gather(&self, carried: &Carried<'_>, fields: &Fields<'_>, first: usize, rows: &mut [Row]) {
        by_parts!(carried, gather(self, carried, fields, first, rows));
    }

    /// Adds to rates what water brings and what particles exchange beside it; `first` is the first of the rates.
    pub fn carry(&self, carried: &[f64], exchange: &[f64], temperature: &[f64], first: usize, rates: &mut [f64]) {
        if exchange.is_empty() {
            carry::<false>(self, carried, exchange, temperature, first, rates);
        } else {
            carry::<true>(self, carried, exchange, temperature, first, rates);
        }
    }

    /// Fills a column, from particle `first` on, with half of the sums over the paths of each particle of how much what is in `places` rises along
    /// them, times their factors and the vectors of their diagonals.
    pub(super) fn slopes(
        &self,
        (factors, reaches): (&[f64], &[DVec2]),
        places: &[f64],
        first: usize,
        slopes: &mut [DVec2],
    ) {
        self::slopes(self, factors, reaches, places, first, slopes);
    }

    /// Fills a column, from particle `first` on, with the sums over the paths of each particle of a term of `columns`, as it is seen
    /// from the earlier end (`true`) or from the later.
    pub(super) fn sums(
        &self,
        columns: [&[f64]; 3],
        term: &impl Fn([f64; 3], bool) -> f64,
        first: usize,
        out: &mut [f64],
    ) {
        sums(self, term, columns, first, out);
    }
}

widest!(gather, gather_rows<EXCHANGE, BENDS, CORRECTED>, (own: &Diagonals, carried: &Carried<'_>, fields: &Fields<'_>, first: usize, rows: &mut [Row]));
widest!(carry, carry_rows<EXCHANGE>, (own: &Diagonals, carried: &[f64], exchange: &[f64], temperature: &[f64], first: usize, rates: &mut [f64]));
widest!(slopes, slope_rows, (own: &Diagonals, factors: &[f64], reaches: &[DVec2], places: &[f64], first: usize, slopes: &mut [DVec2]));
widest!(sums, sum_rows[F: Fn([f64; 3], bool) -> f64], (own: &Diagonals, term: &F, columns: [&[f64]; 3], first: usize, out: &mut [f64]));

/// A particle's own part of [`Fields`].
#[derive(Clone, Copy)]
pub(super) struct Own {
    temperature: Lanes,
    conducted: Lanes,
    gradients: [Lanes; 2],
}

impl Own {
    #[inline(always)]
    pub fn at<const BENDS: bool, const CORRECTED: bool>(fields: &Fields<'_>, place: usize) -> Self {
        let none = [0.0; LANES];
        Own {
            temperature: lanes(fields.temperature, place),
            conducted: if CORRECTED { lanes(fields.conducted, place) } else { none },
            gradients: if BENDS { fields.gradients.map(|column| lanes(column, place)) } else { [none; 2] },
        }
    }
}

/// What paths of one diagonal carry.
pub(super) struct Brought {
    pub water: Lanes,
    pub exchange: Lanes,
    even: Lanes,
    bent: DVec2,
}

impl Brought {
    /// On the diagonal of a number, from a place on it.
    #[inline(always)]
    pub fn at<const EXCHANGE: bool, const BENDS: bool, const CORRECTED: bool>(
        carried: &Carried<'_>,
        number: usize,
        place: usize,
    ) -> Self {
        let none = [0.0; LANES];
        Brought {
            water: lanes(carried.carried, place),
            exchange: if EXCHANGE { lanes(carried.exchange, place) } else { none },
            even: if CORRECTED { lanes(carried.even, place) } else { none },
            bent: if BENDS { BENT * carried.reaches[number] } else { DVec2::ZERO },
        }
    }

    /// What bends mend at a particle, and what taking the exchange back would bring it.
    #[inline(always)]
    pub fn back<const EXCHANGE: bool, const BENDS: bool, const CORRECTED: bool>(
        &self,
        own: &Own,
        other: &Own,
        lane: usize,
    ) -> f64 {
        let mut back = 0.0;
        if CORRECTED {
            back += self.even[lane] * (own.conducted[lane] - other.conducted[lane]);
        }
        if BENDS {
            let rise = [0, 1].map(|axis| other.gradients[axis][lane] - own.gradients[axis][lane]);
            back += self.water[lane] * (self.bent.x * rise[0] + self.bent.y * rise[1]);
        }
        if EXCHANGE {
            back -= self.exchange[lane] * (other.temperature[lane] - own.temperature[lane]);
        }
        back
    }
}

/// Sums over the paths of one stretch of particles.
struct Sums {
    gain: [f64; STRETCH],
    up: [f64; STRETCH],
    down: [f64; STRETCH],
    least: [f64; STRETCH],
    most: [f64; STRETCH],
}

#[inline(always)]
fn gather_rows<const EXCHANGE: bool, const BENDS: bool, const CORRECTED: bool>(
    diagonals: &Diagonals,
    carried: &Carried<'_>,
    fields: &Fields<'_>,
    first: usize,
    rows: &mut [Row],
) {
    let mut sums = Sums {
        gain: [0.0; STRETCH],
        up: [0.0; STRETCH],
        down: [0.0; STRETCH],
        least: [0.0; STRETCH],
        most: [0.0; STRETCH],
    };
    for Stretch { before, at, count } in diagonals.places.stretches(first, rows.len()) {
        for (number, rows) in rows[before..before + count].chunks_mut(STRETCH).enumerate() {
            let at = at + number * STRETCH;
            gather_stretch::<EXCHANGE, BENDS, CORRECTED>(diagonals, carried, fields, (at, rows.len()), &mut sums);
            for (i, row) in rows.iter_mut().enumerate() {
                *row = Row {
                    gain: sums.gain[i],
                    up: sums.up[i],
                    down: sums.down[i],
                    least: sums.least[i],
                    most: sums.most[i],
                };
            }
        }
    }
}

/// Sums of so many particles from a place on.
#[inline(always)]
fn gather_stretch<const EXCHANGE: bool, const BENDS: bool, const CORRECTED: bool>(
    diagonals: &Diagonals,
    carried: &Carried<'_>,
    fields: &Fields<'_>,
    (first, count): (usize, usize),
    sums: &mut Sums,
) {
    let blocks = || (0..count).step_by(LANES);
    for (number, offset) in diagonals.offsets.iter().enumerate() {
        for block in blocks() {
            let at = first + block;
            let own = Own::at::<BENDS, CORRECTED>(fields, at);
            let (mut gain, mut up, mut down) = match number {
                0 => ([0.0; LANES], [0.0; LANES], [0.0; LANES]),
                _ => (lanes(&sums.gain, block), lanes(&sums.up, block), lanes(&sums.down, block)),
            };
            for side in 0..2 {
                // From the lower end the path has the particle's own place, from the higher that of the other end.
                let (place, partner) = if side == 0 { (at, at + offset) } else { (at - offset, at - offset) };
                let place = number * diagonals.stride + place;
                let other = Own::at::<BENDS, CORRECTED>(fields, partner);
                let path = Brought::at::<EXCHANGE, BENDS, CORRECTED>(carried, number, place);
                for lane in 0..LANES {
                    let rise = other.temperature[lane] - own.temperature[lane];
                    // Water to a partner brings none of its heat.
                    let brought = path.water[lane] * rise;
                    gain[lane] += if side == 0 { -brought } else { brought };
                    if EXCHANGE {
                        gain[lane] += path.exchange[lane] * rise;
                    }
                    let back = path.back::<EXCHANGE, BENDS, CORRECTED>(&own, &other, lane);
                    up[lane] += if back > 0.0 { back } else { 0.0 };
                    down[lane] += if back < 0.0 { back } else { 0.0 };
                }
            }
            sums.gain[block..block + LANES].copy_from_slice(&gain);
            sums.up[block..block + LANES].copy_from_slice(&up);
            sums.down[block..block + LANES].copy_from_slice(&down);
        }
    }
    for block in blocks() {
        let at = first + block;
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
        sums.least[block..block + LANES].copy_from_slice(&least);
        sums.most[block..block + LANES].copy_from_slice(&most);
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
    let blocks = diagonals.places.stretches(first, rates.len()).flat_map(blocks);
    for Stretch { before, at, count } in blocks {
        let rates = &mut rates[before..before + count];
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
fn slope_rows(
    diagonals: &Diagonals,
    factors: &[f64],
    reaches: &[DVec2],
    places: &[f64],
    first: usize,
    slopes: &mut [DVec2],
) {
    for Stretch { before, at, count } in diagonals.places.stretches(first, slopes.len()).flat_map(blocks) {
        let own = lanes(places, at);
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for ((number, offset), reach) in diagonals.offsets.iter().enumerate().zip(reaches) {
            let place = number * diagonals.stride + at;
            let (higher, lower) = (lanes(places, at + offset), lanes(places, at - offset));
            let (forth, back) = (lanes(factors, place), lanes(factors, place - offset));
            for lane in 0..LANES {
                // Seen from either end a path rises the same way.
                let rise = forth[lane] * (higher[lane] - own[lane]) + back[lane] * (own[lane] - lower[lane]);
                x[lane] += rise * reach.x;
                y[lane] += rise * reach.y;
            }
        }
        for (slope, (x, y)) in slopes[before..before + count].iter_mut().zip(x.into_iter().zip(y)) {
            *slope = 0.5 * DVec2::new(x, y);
        }
    }
}

#[inline(always)]
fn sum_rows<F: Fn([f64; 3], bool) -> f64>(
    diagonals: &Diagonals,
    term: &F,
    columns: [&[f64]; 3],
    first: usize,
    sums: &mut [f64],
) {
    for Stretch { before, at, count } in diagonals.places.stretches(first, sums.len()).flat_map(blocks) {
        let mut sum = [0.0; LANES];
        for (number, offset) in diagonals.offsets.iter().enumerate() {
            let place = number * diagonals.stride + at;
            let [a, b, c] = columns.map(|column| lanes(column, place));
            for lane in 0..LANES {
                sum[lane] += term([a[lane], b[lane], c[lane]], true);
            }
            let [a, b, c] = columns.map(|column| lanes(column, place - offset));
            for lane in 0..LANES {
                sum[lane] += term([a[lane], b[lane], c[lane]], false);
            }
        }
        sums[before..before + count].copy_from_slice(&sum[..count]);
    }
}
