//! Bands of the body, whose parts of a solution are found side by side.

use std::ops::Range;

use crate::balances::groundwater::diagonals::LANES;
use crate::balances::groundwater::network::Network;
use crate::memory::HeapSize;
use crate::team::{Team, share};

/// Particles of a band, at least; fixed, so that a pressure does not depend on the number of threads.
const PARTICLES: usize = 8192;

/// One of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Band {
    pub(super) number: usize,
    /// Its first particle.
    pub(super) first: usize,
    /// The place of that, on diagonals.
    pub(super) from: usize,
    /// The first place of columns that are the band's alone.
    pub(super) base: usize,
}

/// All of them.
#[derive(Clone)]
pub(super) struct Bands {
    /// Particles of each; the last may have fewer.
    size: usize,
    bands: Vec<Band>,
    team: Option<Team>,
}

impl HeapSize for Bands {
    fn heap_size(&self) -> usize {
        self.bands.capacity() * size_of::<Band>()
    }
}

impl Bands {
    /// The bands of a network, for one thread or several.
    pub(super) fn new(network: &Network, team: Option<Team>) -> Self {
        Bands::of(network, network.len().div_ceil((network.len() / PARTICLES).max(1)).max(1), team)
    }

    /// Bands of so many particles.
    pub(super) fn of(network: &Network, size: usize, team: Option<Team>) -> Self {
        let places = network.diagonals.as_ref().map(|diagonals| &diagonals.places);
        let band = |first: usize| {
            let from = places.map_or(first, |places| places.of(first));
            Band { number: first / size, first, from, base: from - places.map_or(0, |places| places.room) }
        };
        Bands { size, bands: (0..network.len()).step_by(size).map(band).collect(), team }
    }

    /// All, in their order.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Band> {
        self.bands.iter()
    }

    /// The number of a particle's band.
    pub(super) fn number(&self, particle: usize) -> usize {
        particle / self.size
    }

    /// How many.
    pub(super) fn count(&self) -> usize {
        self.bands.len()
    }

    /// The threads that share them, if more than one.
    pub(super) fn team(&self) -> Option<&Team> {
        self.team.as_ref()
    }

    /// A column of places for each band alone, with room on both sides.
    pub(super) fn columns(&self, network: &Network) -> Vec<Vec<f64>> {
        let Some(diagonals) = &network.diagonals else { return vec![Vec::new(); self.count()] };
        let column = |band: &Band| {
            let last = (band.first + self.size).min(network.len()) - 1;
            vec![0.0; diagonals.places.of(last) - band.base + diagonals.places.room + LANES]
        };
        self.bands.iter().map(column).collect()
    }

    /// A band's part of a column of particles.
    pub(super) fn part<'a, T>(&self, band: &Band, column: &'a [T]) -> &'a [T] {
        &column[self.particles(band, column.len())]
    }

    /// A band's particles, of so many in all.
    pub(super) fn particles(&self, band: &Band, count: usize) -> Range<usize> {
        band.first..(band.first + self.size).min(count)
    }

    /// The parts of a column of entries, of which each particle has those from its start on.
    pub(super) fn rows<'a>(
        &'a self,
        starts: &'a [usize],
        mut column: &'a mut [f64],
    ) -> impl Iterator<Item = (&'a Band, &'a mut [f64])> + Send {
        self.bands.iter().map(move |band| {
            let particles = self.particles(band, starts.len() - 1);
            let (part, after) =
                std::mem::take(&mut column).split_at_mut(starts[particles.end] - starts[particles.start]);
            column = after;
            (band, part)
        })
    }

    /// The parts of a column of particles.
    pub(super) fn parts<'a>(&self, column: &'a mut [f64]) -> impl Iterator<Item = &'a mut [f64]> + Send + use<'a> {
        column.chunks_mut(self.size)
    }

    /// The parts of a column of places, each from its band's first place on; none of one without places.
    pub(super) fn placed<'a>(&'a self, column: &'a mut [f64]) -> impl Iterator<Item = &'a mut [f64]> + Send {
        let whole = column.len();
        let mut at = self.bands.first().map_or(0, |band| band.from).min(whole);
        let mut left = &mut column[at..];
        let ends = self.bands.iter().skip(1).map(|band| band.from).chain([whole]);
        ends.map(move |end| {
            let end = end.min(whole);
            let (part, after) = std::mem::take(&mut left).split_at_mut(end - at);
            (left, at) = (after, end);
            part
        })
    }

    /// Does a work by bands, each with its part; the sum of what they give, in their order whoever is done first. `sums` has one
    /// place for each.
    pub(super) fn share<P: Send>(
        &self,
        sums: &mut [f64],
        parts: impl Iterator<Item = P> + Send,
        one: impl Fn(&Band, P) -> f64 + Sync,
    ) -> f64 {
        let works = self.bands.iter().zip(&mut *sums).zip(parts);
        let work = |((band, sum), part): ((&Band, &mut f64), P)| *sum = one(band, part);
        self.each(works, work);
        sums.iter().sum()
    }

    /// Does parts of a work side by side, if there are several bands.
    pub(super) fn each<P: Send>(&self, parts: impl Iterator<Item = P> + Send, one: impl Fn(P) + Sync) {
        share(self.team().filter(|_| self.bands.len() > 1), parts, one);
    }

    /// Fills a column of what is not cut by bands in as many parts, by the number of the first of each.
    pub(super) fn blocks(&self, column: &mut [f64], one: impl Fn(usize, &mut [f64]) + Sync) {
        let size = column.len().div_ceil(self.count().max(1)).max(1);
        self.each(column.chunks_mut(size).enumerate(), |(number, part)| one(number * size, part));
    }
}
