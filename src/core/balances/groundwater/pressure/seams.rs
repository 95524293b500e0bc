//! Seams: the particles of bands that have paths to earlier bands. Beside them, no band sees another.
//!
//! A sweep comes to all bands before it comes to their seams, and back to these first: symmetric Gauss-Seidel of all particles,
//! in an order that lets bands be swept side by side, and then seams. Bands cost no iteration so.

use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::pressure::bands::Bands;
use crate::memory::{HeapSize, total};

/// Paths of some particles to some others, with their entries of the matrix side by side: those are read in every sweep, and
/// taken from all over the matrix once.
#[derive(Debug, Clone, Default)]
struct Links {
    /// Start of each particle's paths, and the end of the last.
    starts: Vec<usize>,
    /// The other end, and the slot of each.
    paths: Vec<[u32; 2]>,
    entries: Vec<f64>,
}

impl Links {
    /// Ends the paths of one particle.
    fn close(&mut self) {
        self.starts.push(self.paths.len());
    }

    fn take(&mut self, rest: &[f64]) {
        self.entries.clear();
        self.entries.extend(self.paths.iter().map(|[_, slot]| rest[*slot as usize]));
    }

    /// What the other ends of a particle's paths bring.
    #[inline]
    fn brought(&self, row: usize, value: impl Fn(usize) -> f64) -> f64 {
        let range = self.starts[row]..self.starts[row + 1];
        let paths = self.paths[range.clone()].iter().zip(&self.entries[range]);
        paths.fold(0.0, |sum, ([end, _], entry)| sum + entry * value(*end as usize))
    }
}

impl HeapSize for Links {
    fn heap_size(&self) -> usize {
        total(&[&self.starts, &self.paths, &self.entries])
    }
}

/// A particle, and its place on the column of its band.
#[derive(Debug, Clone, Copy)]
struct Member {
    particle: u32,
    at: u32,
}

/// All seams.
#[derive(Debug, Clone, Default)]
pub(super) struct Seams {
    /// Their particles, ascending, with the paths to particles of bands and to members of the same seam by their number.
    members: Vec<Member>,
    outward: Links,
    among: Links,
    /// The first of each band, and the end of the last.
    starts: Vec<usize>,
    /// Particles of bands beside seams, with the paths to members.
    beside: Vec<Member>,
    to_seams: Links,
    beside_starts: Vec<usize>,
    inverse: Vec<f64>,
    /// What the sweep found for each member.
    found: Vec<f64>,
}

impl HeapSize for Seams {
    fn heap_size(&self) -> usize {
        let members = (self.members.capacity() + self.beside.capacity()) * size_of::<Member>();
        let links = total(&[&self.outward, &self.among, &self.to_seams]);
        members + links + total(&[&self.starts, &self.beside_starts, &self.inverse, &self.found])
    }
}

impl Seams {
    pub(super) fn new(network: &Network, bands: &Bands) -> Self {
        let sewn = |i: usize| network.paths(i).any(|(j, ..)| j < i && bands.number(j) != bands.number(i));
        let on: Vec<usize> = (0..network.len()).filter(|i| sewn(*i)).collect();
        let places = network.diagonals.as_ref().map(|diagonals| &diagonals.places);
        let mut seams = Seams { inverse: vec![0.0; on.len()], found: vec![0.0; on.len()], ..Seams::default() };
        [&mut seams.outward, &mut seams.among, &mut seams.to_seams].into_iter().for_each(Links::close);
        for (number, band) in bands.iter().enumerate() {
            seams.starts.push(seams.members.len());
            seams.beside_starts.push(seams.beside.len());
            for i in (band.first..network.len()).take_while(|i| bands.number(*i) == number) {
                let at = places.map_or(i, |places| places.of(i)) - band.base;
                seams.add(network, bands, Member { particle: i as u32, at: at as u32 }, &on);
            }
        }
        seams.starts.push(seams.members.len());
        seams.beside_starts.push(seams.beside.len());
        seams
    }

    /// Takes note of a particle, of which `on` are on seams.
    fn add(&mut self, network: &Network, bands: &Bands, member: Member, on: &[usize]) {
        let i = member.particle as usize;
        let is_on = on.binary_search(&i).is_ok();
        for (j, slot, _) in network.paths(i) {
            match on.binary_search(&j) {
                Ok(other) if !is_on => self.to_seams.paths.push([other as u32, slot as u32]),
                // Two seams meet only where a band is thinner than paths are long; they then do not see each other.
                Ok(other) if bands.number(i) == bands.number(j) => self.among.paths.push([other as u32, slot as u32]),
                Err(_) if is_on => self.outward.paths.push([j as u32, slot as u32]),
                _ => {}
            }
        }
        if is_on {
            self.members.push(member);
            self.outward.close();
            self.among.close();
        } else if self.to_seams.starts.last() != Some(&self.to_seams.paths.len()) {
            self.beside.push(member);
            self.to_seams.close();
        }
    }

    /// Takes the matrix, and the inverse of the diagonal of members, for which it leaves zeros: sweeps of bands then leave them out.
    pub(super) fn take(&mut self, rest: &[f64], inverse: &mut [f64]) {
        for (own, member) in self.inverse.iter_mut().zip(&self.members) {
            *own = std::mem::take(&mut inverse[member.particle as usize]);
        }
        [&mut self.outward, &mut self.among, &mut self.to_seams].into_iter().for_each(|links| links.take(rest));
    }

    /// Sweeps over each seam, after what was found for bands on the way there.
    pub(super) fn sweep(&mut self, bands: &Bands, [residual, swept]: [&[f64]; 2]) {
        let Seams { members, outward, among, starts, inverse, found, .. } = self;
        let mut left = &mut found[..];
        let parts = starts.windows(2).map(|ends| {
            let (part, after) = std::mem::take(&mut left).split_at_mut(ends[1] - ends[0]);
            left = after;
            (ends[0], part)
        });
        bands.each(parts, |(first, found)| {
            for k in 0..found.len() {
                let of_bands = outward.brought(first + k, |particle| swept[particle]);
                let earlier = |member: usize| if member - first < k { found[member - first] } else { 0.0 };
                let brought = of_bands + among.brought(first + k, earlier);
                found[k] = (residual[members[first + k].particle as usize] - brought) * inverse[first + k];
            }
            for k in (0..found.len()).rev() {
                let later = |member: usize| if member - first > k { found[member - first] } else { 0.0 };
                found[k] -= among.brought(first + k, later) * inverse[first + k];
            }
        });
    }

    /// Takes from what was found for a band, on its column, what the seams beside it hold: before the way back. Members are zero.
    pub(super) fn before(&self, number: usize, inverse: &[f64], column: &mut [f64]) {
        for (member, _) in self.members(number) {
            column[member.at as usize] = 0.0;
        }
        for row in self.beside_starts[number]..self.beside_starts[number + 1] {
            let Member { particle, at } = self.beside[row];
            column[at as usize] -= self.to_seams.brought(row, |member| self.found[member]) * inverse[particle as usize];
        }
    }

    /// Puts what was found for a band's seam on its column: after the way back.
    pub(super) fn after(&self, number: usize, column: &mut [f64]) {
        for (member, found) in self.members(number) {
            column[member.at as usize] = found;
        }
    }

    fn members(&self, number: usize) -> impl Iterator<Item = (Member, f64)> + '_ {
        let range = self.starts[number]..self.starts[number + 1];
        self.members[range.clone()].iter().copied().zip(self.found[range].iter().copied())
    }
}
