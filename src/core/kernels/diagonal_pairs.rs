//! Pairs of particles that stand in the order of a lattice, by diagonals: all pairs of a particle and the one a fixed number of
//! places further on stand together, so that a loop over particles reads columns from end to end and needs no partner's name.
//!
//! A pair has one weight and is visited once: what one end gains the other loses. Particles are taken by tiles, and by blocks
//! within them. Where few weights differ, as on a lattice whose particles differ by their laws alone, each kind of block is kept
//! once. Weights of uneven particles are read once a step and are most of what memory has to bring: they are kept in short,
//! rounded towards zero, so that the bound of the step holds. What a diagonal has no use for stays on the list.
//!
//! Every particle sees the same operations in the same order, whatever the vectors of the processor and the share of the body
//! that a thread has: first what it loses to earlier particles, tile by tile, then the sum of what later ones give.

use std::array::from_fn;
use std::collections::HashMap;

use crate::bonds::exchange::{Exchange, Mean};
use crate::instruction_set::widest;
use crate::kernels::conducted::{Arithmetic, Conducted, Even, Geometric, Harmonic};
use crate::kernels::list_parts::ListParts;
use crate::memory::{HeapSize, total};
use crate::space::domain::Surface;

/// Particles that are handled together.
const LANES: usize = 16;

/// Blocks of a tile: what its particles gain stays in the first cache until all diagonals have been visited.
const BLOCKS: usize = 4;
const TILE: usize = BLOCKS * LANES;

/// Share of the places of a diagonal that pairs must fill: tiles that have none of them take next to nothing, and a pair that is left
/// to the list takes six times the memory of its place, and is found by its partner's name.
const FILLED: f64 = 1.0 / 32.0;

/// Where a tile has no pair on a diagonal. In a ring rows differ in length, and with them how much further on partners are.
const NONE: [u32; BLOCKS] = [u32::MAX; BLOCKS];

/// Weights that differ along a diagonal of particles that stand evenly, at most, and part of a weight by which rounding of places may
/// make others of them.
const VALUES: usize = 256;
const ROUNDING: f64 = 1e-10;

type Lanes = [f64; LANES];

/// Pairs of particles that stand so many places apart.
#[derive(Debug, Clone, Copy)]
struct Diagonal {
    offset: usize,
    /// Whether its weights are kept in short.
    uneven: bool,
}

impl HeapSize for Diagonal {
    fn heap_size(&self) -> usize {
        0
    }
}

/// Pairs by diagonals.
#[derive(Debug, Clone)]
pub struct DiagonalPairs {
    /// By ascending offset.
    diagonals: Vec<Diagonal>,
    count: usize,
    /// Where the weights of the blocks of a tile are, diagonal by diagonal.
    places: Vec<[u32; BLOCKS]>,
    /// Weights (m^-2), zero where there is no pair: a block of each kind.
    kinds: Vec<f64>,
    /// Those of uneven diagonals, tile by tile.
    uneven: Vec<f32>,
    /// How pairs exchange heat: by a mean, or by potentials.
    mean: Option<Mean>,
    /// Particles of which some pairs are left on the list.
    listed: Vec<u32>,
}

impl HeapSize for DiagonalPairs {
    fn heap_size(&self) -> usize {
        let places = self.places.capacity() * size_of::<[u32; BLOCKS]>();
        places + total(&[&self.diagonals, &self.kinds, &self.uneven, &self.listed])
    }
}

impl DiagonalPairs {
    /// Takes the pairs of particles off a list that fill diagonals, if any do. Those that pass interfaces, that are cut while the
    /// run goes on, and those across surfaces through which heat is counted are asked for one by one, and stay, as do all of water.
    pub fn split(parts: &mut ListParts) -> Option<Self> {
        let mean = match parts.exchange {
            Exchange::Potential => None,
            Exchange::Mean(mean) => Some(mean),
            Exchange::Upstream => return None,
        };
        // Gravity moves water along its pairs, small changes of its conductivities are part of its tangent, and a solute goes with what
        // each pair exchanges.
        if parts.materials.laws().any(|thermal| thermal.curve.moisture().is_some()) {
            return None;
        }
        let count = parts.positions.len();
        let both = Both::new(parts);
        let mut filled = vec![0u32; count];
        both.each(parts, |offset, _, _| filled[offset] += 1);
        let full = |offset: &usize| f64::from(filled[*offset]) >= FILLED * count as f64;
        let offsets: Vec<usize> = (1..count).filter(full).collect();
        if offsets.is_empty() {
            return None;
        }
        // Places of weights are short numbers.
        u32::try_from(offsets.len() * (count.next_multiple_of(TILE) + LANES)).ok()?;
        // In one piece, which goes back to the system as a whole.
        let mut columns = vec![0.0; offsets.len() * count];
        let mut taken = vec![false; parts.pairs.partners.len()];
        both.each(parts, |offset, low, [forth, back]| {
            if let Ok(diagonal) = offsets.binary_search(&offset) {
                columns[diagonal * count + low] = parts.pairs.weights[forth];
                (taken[forth], taken[back]) = (true, true);
            }
        });
        parts.keep(|entry| !taken[entry]);
        let starts = &parts.pairs.starts;
        let listed = (0..count as u32).filter(|i| starts[*i as usize] < starts[*i as usize + 1]).collect();
        let diagonals = offsets.into_iter().map(|offset| Diagonal { offset, uneven: false }).collect();
        let (places, kinds, uneven) = (Vec::new(), Vec::new(), Vec::new());
        let mut own = DiagonalPairs { diagonals, count, places, kinds, uneven, mean, listed };
        own.store(columns);
        Some(own)
    }

    /// Keeps the weights of columns, one behind the other for each diagonal.
    fn store(&mut self, mut columns: Vec<f64>) {
        for (diagonal, column) in self.diagonals.iter_mut().zip(columns.chunks_exact_mut(self.count)) {
            diagonal.uneven = !even_out(column);
        }
        let mut kinds: Vec<HashMap<[u64; LANES], u32>> = vec![HashMap::new(); self.diagonals.len()];
        for tile in (0..self.count).step_by(TILE) {
            let columns = columns.chunks_exact(self.count);
            for ((diagonal, column), kinds) in self.diagonals.iter().zip(columns).zip(&mut kinds) {
                if column[tile..self.count.min(tile + TILE)].iter().all(|weight| *weight == 0.0) {
                    self.places.push(NONE);
                    continue;
                }
                self.places.push(from_fn(|number| {
                    let first = tile + number * LANES;
                    let block: Lanes = from_fn(|lane| column.get(first + lane).copied().unwrap_or(0.0));
                    if diagonal.uneven {
                        self.uneven.extend(block.map(short));
                        return (self.uneven.len() - LANES) as u32;
                    }
                    *kinds.entry(block.map(f64::to_bits)).or_insert_with(|| {
                        self.kinds.extend(block);
                        (self.kinds.len() - LANES) as u32
                    })
                }));
            }
        }
        self.places.shrink_to_fit();
        self.kinds.shrink_to_fit();
        self.uneven.shrink_to_fit();
    }

    /// The farthest partner in the numbering of particles.
    pub(super) fn reach(&self) -> usize {
        self.diagonals.last().map_or(0, |diagonal| diagonal.offset)
    }

    /// Particles of which some pairs are left on the list, of so many from a first one on.
    pub(super) fn listed(&self, first: usize, count: usize) -> impl ExactSizeIterator<Item = usize> + '_ {
        let place = |particle: usize| self.listed.partition_point(|listed| (*listed as usize) < particle);
        self.listed[place(first)..place(first + count)].iter().map(|listed| *listed as usize)
    }

    /// Particles of which each of some threads takes the rates: pairs with earlier ones are visited by both.
    pub(super) fn share(&self, threads: usize) -> usize {
        self.count.div_ceil(threads).max(4 * self.reach()).next_multiple_of(TILE)
    }

    /// What pairs give neighbouring particles (W/m3) from a first one on, from columns of all.
    pub(super) fn gather(&self, columns: &Columns<'_>, first: usize, rates: &mut [f64]) {
        match self.mean {
            None => gather::<Even>(self, columns, first, rates),
            Some(Mean::Harmonic) => gather::<Harmonic>(self, columns, first, rates),
            Some(Mean::Arithmetic) => gather::<Arithmetic>(self, columns, first, rates),
            Some(Mean::Geometric) => gather::<Geometric>(self, columns, first, rates),
        }
    }
}

/// Pairs of particles of which both entries on a list have the same weight, and may be taken off it.
struct Both {
    /// Entries that stay.
    stay: Vec<bool>,
}

impl Both {
    fn new(parts: &ListParts) -> Self {
        let mut stay = vec![false; parts.pairs.partners.len()];
        for (stay, chain) in stay.iter_mut().zip(&parts.chains.of_pair) {
            *stay = *chain > 0;
        }
        for place in parts.cuts.places() {
            stay[place] = true;
        }
        Both { stay }
    }

    /// Visits all such pairs by offset, lower end and both entries.
    fn each(&self, parts: &ListParts, mut visit: impl FnMut(usize, usize, [usize; 2])) {
        let (pairs, count) = (&parts.pairs, parts.positions.len());
        let beyond = |i: usize, surface: &Surface| surface.is_beyond(parts.positions[i]);
        // Partners ascend, so that those before a particle are met in order too.
        let mut met = pairs.starts[..count].to_vec();
        for low in 0..count {
            for forth in pairs.starts[low]..pairs.starts[low + 1] {
                let high = pairs.partners[forth] as usize;
                if high <= low || high >= count {
                    continue;
                }
                let (end, back) = (pairs.starts[high + 1], &mut met[high]);
                while *back < end && (pairs.partners[*back] as usize) < low {
                    *back += 1;
                }
                let back = *back;
                let mutual = back < end && pairs.partners[back] as usize == low;
                let alike = mutual && pairs.weights[back].to_bits() == pairs.weights[forth].to_bits();
                let counted = || parts.surfaces.iter().any(|surface| beyond(low, surface) != beyond(high, surface));
                if alike && !self.stay[forth] && !self.stay[back] && !counted() {
                    visit(high - low, low, [forth, back]);
                }
            }
        }
    }
}

/// A weight in short, which is not more than it.
fn short(weight: f64) -> f32 {
    let nearest = weight as f32;
    if f64::from(nearest) > weight { nearest.next_down() } else { nearest }
}

/// Makes one weight of those along a diagonal that differ by rounding, where few are left then; whether they are.
fn even_out(column: &mut [f64]) -> bool {
    let alike = |value: f64, weight: f64| (value - weight).abs() <= ROUNDING * value;
    let (mut values, mut last) = (Vec::new(), 0.0);
    for weight in column.iter().copied().filter(|weight| *weight != 0.0) {
        if alike(last, weight) {
            continue;
        }
        last = values.iter().copied().find(|value| alike(*value, weight)).unwrap_or_else(|| {
            values.push(weight);
            weight
        });
        if values.len() > VALUES {
            return false;
        }
    }
    for weight in column.iter_mut().filter(|weight| **weight != 0.0) {
        *weight = values.iter().copied().find(|value| alike(*value, *weight)).unwrap_or(*weight);
    }
    true
}

/// What particles hold.
pub(super) struct Columns<'a> {
    /// What pairs even out.
    pub(super) values: &'a [f64],
    /// Conductivities; nothing reads them where pairs exchange by potentials.
    pub(super) conductivity: &'a [f64],
}

widest!(gather, gather_rows[C: Conducted], (own: &DiagonalPairs, columns: &Columns<'_>, first: usize, rates: &mut [f64]));

#[inline(always)]
fn gather_rows<C: Conducted>(own: &DiagonalPairs, columns: &Columns<'_>, first: usize, rates: &mut [f64]) {
    let (reach, diagonals, end) = (own.reach(), own.diagonals.len(), first + rates.len());
    let mut cleared = first;
    for at in (first.saturating_sub(reach) / TILE * TILE..end).step_by(TILE) {
        // As far as this tile is the first to reach, which the cache still holds when the next ones do.
        let until = (at + TILE + reach).clamp(cleared, end);
        rates[cleared - first..until - first].fill(0.0);
        cleared = until;
        let mut tile = Tile { columns, count: own.count, at, gains: Gains([0.0; TILE]), first, rates };
        let places = &own.places[at / TILE * diagonals..][..diagonals];
        for (diagonal, places) in own.diagonals.iter().zip(places).filter(|(_, places)| **places != NONE) {
            if diagonal.uneven {
                tile.visit::<C, f32>(diagonal.offset, &own.uneven, places);
            } else {
                tile.visit::<C, f64>(diagonal.offset, &own.kinds, places);
            }
        }
        tile.settle();
    }
}

/// What the particles of a tile gain, on cache lines of their own.
#[repr(align(64))]
struct Gains([f64; TILE]);

/// A tile whose pairs with later particles are visited.
struct Tile<'a> {
    columns: &'a Columns<'a>,
    count: usize,
    at: usize,
    /// What its particles have from later ones.
    gains: Gains,
    /// The first of the particles whose rates are taken.
    first: usize,
    rates: &'a mut [f64],
}

impl Tile<'_> {
    /// Visits the pairs of a diagonal.
    #[inline(always)]
    fn visit<C: Conducted, W: Copy + Into<f64>>(&mut self, offset: usize, weights: &[W], places: &[u32; BLOCKS]) {
        let high = self.at + offset;
        if high >= self.first && high + TILE <= self.first + self.rates.len() {
            return self.inside::<C, W>(high, weights, places);
        }
        for (number, place) in places.iter().enumerate() {
            let ends = (self.at + number * LANES, high + number * LANES);
            self.edge::<C, W>(number, ends, &weights[*place as usize..*place as usize + LANES]);
        }
    }

    /// Visits pairs whose later ends, from a first one on, all are among those whose rates are taken.
    #[inline(always)]
    fn inside<C: Conducted, W: Copy + Into<f64>>(&mut self, high: usize, weights: &[W], places: &[u32; BLOCKS]) {
        let Columns { values, conductivity } = *self.columns;
        let (here, there) = (&values[self.at..self.at + TILE], &values[high..high + TILE]);
        let conducts = if C::BY_CONDUCTIVITY {
            (&conductivity[self.at..self.at + TILE], &conductivity[high..high + TILE])
        } else {
            (here, there)
        };
        let (gains, losses) = (&mut self.gains.0, &mut self.rates[high - self.first..][..TILE]);
        for (number, place) in places.iter().enumerate() {
            let weights = &weights[*place as usize..*place as usize + LANES];
            let mut fluxes = [0.0; LANES];
            for (lane, flux) in fluxes.iter_mut().enumerate() {
                let at = number * LANES + lane;
                let difference = there[at] - here[at];
                let conducted =
                    if C::BY_CONDUCTIVITY { C::mean(conducts.0[at], conducts.1[at]) * difference } else { difference };
                *flux = weights[lane].into() * conducted;
            }
            for (gain, flux) in gains[number * LANES..][..LANES].iter_mut().zip(&fluxes) {
                *gain += flux;
            }
            for (loss, flux) in losses[number * LANES..][..LANES].iter_mut().zip(&fluxes) {
                *loss -= flux;
            }
        }
    }

    /// The same where some are not, or there is none.
    #[cold]
    fn edge<C: Conducted, W: Copy + Into<f64>>(&mut self, number: usize, (low, high): (usize, usize), weights: &[W]) {
        let Columns { values, conductivity } = *self.columns;
        for lane in 0..LANES.min(self.count.saturating_sub(high)) {
            let (low, high) = (low + lane, high + lane);
            let difference = values[high] - values[low];
            let conducted = if C::BY_CONDUCTIVITY {
                C::mean(conductivity[low], conductivity[high]) * difference
            } else {
                difference
            };
            let flux = weights[lane].into() * conducted;
            self.gains.0[number * LANES + lane] += flux;
            if let Some(rate) = high.checked_sub(self.first).and_then(|place| self.rates.get_mut(place)) {
                *rate -= flux;
            }
        }
    }

    /// Adds what particles have from later ones.
    #[inline(always)]
    fn settle(&mut self) {
        let end = self.first + self.rates.len();
        for (particle, gain) in (self.at..end).zip(&self.gains.0).filter(|(particle, _)| *particle >= self.first) {
            self.rates[particle - self.first] += gain;
        }
    }
}

#[cfg(test)]
mod tests;
