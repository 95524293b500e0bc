//! Seams: the particles of bands that have paths to earlier bands. Beside them, no band sees another.
//!
//! A sweep comes to all bands before it comes to their seams, and back to these first: symmetric Gauss-Seidel of all particles,
//! in an order that lets bands be swept side by side, and then seams. Bands cost no iteration so.

use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::pressure::bands::Bands;
use crate::memory::{HeapSize, total};

/// A particle with its paths to particles on seams.
#[derive(Debug, Clone, Copy)]
struct Member {
    particle: u32,
    /// Its place on the column of its band.
    at: u32,
    /// Its first path, and the end of its last.
    paths: [u32; 2],
}

/// All seams.
#[derive(Debug, Clone, Default)]
pub(super) struct Seams {
    /// Their particles, ascending, with the paths to others on the same seam.
    members: Vec<Member>,
    /// The first of each band, and the end of the last.
    starts: Vec<usize>,
    /// Other particles with paths to seams, in the same way.
    beside: Vec<Member>,
    beside_starts: Vec<usize>,
    /// Number among the members of the other end, and slot of each path.
    paths: Vec<[u32; 2]>,
    inverse: Vec<f64>,
    /// What the sweep found for each member.
    pub(super) found: Vec<f64>,
}

impl HeapSize for Seams {
    fn heap_size(&self) -> usize {
        let members = (self.members.capacity() + self.beside.capacity()) * size_of::<Member>();
        members + total(&[&self.starts, &self.beside_starts, &self.paths, &self.inverse, &self.found])
    }
}

impl Seams {
    pub(super) fn new(network: &Network, bands: &Bands) -> Self {
        let sewn = |i: usize| network.paths(i).any(|(j, ..)| j < i && bands.number(j) != bands.number(i));
        let on: Vec<u32> = (0..network.len()).filter(|i| sewn(*i)).map(|i| i as u32).collect();
        let places = network.diagonals.as_ref().map(|diagonals| &diagonals.places);
        let mut seams = Seams { inverse: vec![0.0; on.len()], found: vec![0.0; on.len()], ..Seams::default() };
        for (number, band) in bands.iter().enumerate() {
            seams.starts.push(seams.members.len());
            seams.beside_starts.push(seams.beside.len());
            for i in (band.first..network.len()).take_while(|i| bands.number(*i) == number) {
                let (first, is_on) = (seams.paths.len() as u32, on.binary_search(&(i as u32)).is_ok());
                for (j, slot, _) in network.paths(i) {
                    if let Ok(member) = on.binary_search(&(j as u32)) {
                        // Two seams never meet but between bands that are too thin to tell.
                        if !is_on || bands.number(j) == number {
                            seams.paths.push([member as u32, slot as u32]);
                        }
                    }
                }
                let at = places.map_or(i, |places| places.of(i)) - band.base;
                let member = Member { particle: i as u32, at: at as u32, paths: [first, seams.paths.len() as u32] };
                if is_on {
                    seams.members.push(member);
                } else if member.paths[0] < member.paths[1] {
                    seams.beside.push(member);
                }
            }
        }
        seams.starts.push(seams.members.len());
        seams.beside_starts.push(seams.beside.len());
        seams
    }

    /// Takes the inverse of the diagonal of its members, for which it leaves zeros: a sweep of a band then leaves them out.
    pub(super) fn take_out(&mut self, inverse: &mut [f64]) {
        for (own, member) in self.inverse.iter_mut().zip(&self.members) {
            *own = std::mem::take(&mut inverse[member.particle as usize]);
        }
    }

    /// Sweeps over each seam, after what was found for bands on the way there.
    pub(super) fn sweep(&mut self, network: &Network, bands: &Bands, [rest, residual, swept]: [&[f64]; 3]) {
        let Seams { members, starts, paths, inverse, found, .. } = self;
        let mut left = &mut found[..];
        let parts = starts.windows(2).map(|ends| {
            let (part, after) = std::mem::take(&mut left).split_at_mut(ends[1] - ends[0]);
            left = after;
            (ends[0], part)
        });
        bands.each(parts, |(first, found)| {
            let among = |k: usize, earlier: bool, found: &[f64]| -> f64 {
                let [from, to] = members[first + k].paths.map(|path| path as usize);
                let others = paths[from..to].iter().map(|[member, slot]| (*member as usize - first, *slot as usize));
                others.filter(|(other, _)| (*other < k) == earlier).map(|(other, slot)| rest[slot] * found[other]).sum()
            };
            for k in 0..found.len() {
                let i = members[first + k].particle as usize;
                // Nothing was found for members on the way there.
                let of_bands: f64 = network.paths(i).map(|(j, slot, _)| rest[slot] * swept[j]).sum();
                found[k] = (residual[i] - of_bands - among(k, true, found)) * inverse[first + k];
            }
            for k in (0..found.len()).rev() {
                found[k] -= among(k, false, found) * inverse[first + k];
            }
        });
    }

    /// Takes from what was found for a band, on its column, what the seams beside it hold: before the way back. Members are zero.
    pub(super) fn before(&self, number: usize, rest: &[f64], inverse: &[f64], column: &mut [f64]) {
        for at in self.members(number).map(|(member, _)| member.at) {
            column[at as usize] = 0.0;
        }
        for member in &self.beside[self.beside_starts[number]..self.beside_starts[number + 1]] {
            let paths = self.paths[member.paths[0] as usize..member.paths[1] as usize].iter();
            let held: f64 = paths.map(|[other, slot]| rest[*slot as usize] * self.found[*other as usize]).sum();
            column[member.at as usize] -= held * inverse[member.particle as usize];
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
