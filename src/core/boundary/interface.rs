//! Pairs through several materials: what lies between two particles, and the flux that it carries.
//!
//! A pair that interfaces cut is a chain of pieces in series, each of one material. All carry one flux `q`, and at each
//! interface both sides share a temperature: with the lengths `l` of the pieces, `q l = U(T_next) - U(T_last)` from piece to
//! piece. A pair of length `r` then exchanges `w r q` where one within a single material exchanges `w (U_j - U_i)`. At rest
//! `q` is the flux of the layers themselves, whatever the weights and wherever interfaces lie: thin layers need no particles
//! of their own. It is found from the one monotone equation that the pieces make together, in closed form wherever each
//! piece is in one phase between the temperatures of both ends.
//!
//! Walls are seen through pieces as well: behind a wall that heat passes, the material at the wall goes on.

use crate::boundary::patch::Face;
use crate::boundary::runoff::Runoff;
use crate::memory::HeapSize;
use crate::physics::curve::Curve;
use crate::physics::film::Film;
use crate::physics::root::solve_increasing;
use crate::physics::thermal::Thermal;

/// A piece of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Index of its material.
    pub material: u8,
    /// Its share of the whole, by length; in bodies of shells by what a steady profile sees of it. Zero at the end of a pair
    /// whose particle stands on an interface.
    pub share: f64,
}

/// A chain in the list of all pieces.
#[derive(Debug, Clone, Copy)]
struct Chain {
    first: u32,
    count: u32,
    /// Exchange by potential of either end, where all pieces conduct alike at all temperatures.
    straight: Option<(f64, f64)>,
    /// Least and greatest conductivity of the whole chain (W/mK).
    conductivity: (f64, f64),
}

/// All chains of a body; empty where there is one material, and where pairs exchange by a mean.
#[derive(Debug, Clone, Default)]
pub struct Chains {
    /// By pair of the list: none, or the number of its chain from 1 on.
    pub of_pair: Vec<u32>,
    /// By ghost: none, or the chain from the wall to its image; empty if all see their walls through one material.
    pub of_ghost: Vec<u32>,
    /// By curved wall and particle: none, or the chain from the wall to the particle.
    pub of_rim: Vec<Vec<u32>>,
    /// By touching wall, likewise.
    pub of_touch: Vec<u32>,
    chains: Vec<Chain>,
    pieces: Vec<Piece>,
}

/// A chain with its materials: its methods see it from the first piece to the last.
#[derive(Clone, Copy)]
pub struct Way<'a> {
    chain: &'a Chain,
    pieces: &'a [Piece],
    thermals: &'a [Thermal],
}

/// How a potential at the last end, and a conducted difference, follow each other along a chain.
struct Marched {
    /// Potential (W/m) at the far end.
    potential: f64,
    /// Its slope by what is conducted.
    by_conducted: f64,
    /// Its slope by the potential at the near end.
    by_start: f64,
}

impl Chains {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.of_pair.is_empty()
    }

    /// Adds a chain of pieces, and gives its number.
    pub fn number(&mut self, pieces: &[Piece], thermals: &[Thermal]) -> u32 {
        let first = self.pieces.len() as u32;
        self.pieces.extend_from_slice(pieces);
        self.chains.push(Chain::new(first, pieces, thermals));
        self.chains.len() as u32
    }

    #[inline]
    fn way<'a>(&'a self, number: u32, thermals: &'a [Thermal]) -> Option<Way<'a>> {
        let chain = self.chains.get((number as usize).wrapping_sub(1))?;
        let pieces = &self.pieces[chain.first as usize..(chain.first + chain.count) as usize];
        Some(Way { chain, pieces, thermals })
    }

    /// What lies between the ends of a pair of the list, from the end of lower number on; none within one material.
    #[inline]
    pub fn of_pair<'a>(&'a self, pair: usize, thermals: &'a [Thermal]) -> Option<Way<'a>> {
        self.way(*self.of_pair.get(pair)?, thermals)
    }

    /// What lies between a ghost's wall and its image, from the wall on.
    #[inline]
    pub fn of_ghost<'a>(&'a self, ghost: usize, thermals: &'a [Thermal]) -> Option<Way<'a>> {
        self.way(*self.of_ghost.get(ghost)?, thermals)
    }

    /// What lies between a curved wall and a particle, from the wall on.
    #[inline]
    pub fn of_rim<'a>(&'a self, rim: usize, particle: usize, thermals: &'a [Thermal]) -> Option<Way<'a>> {
        self.way(*self.of_rim.get(rim)?.get(particle)?, thermals)
    }

    /// What lies between a touching wall and its particle, from the wall on.
    #[inline]
    pub fn of_touch<'a>(&'a self, touch: usize, thermals: &'a [Thermal]) -> Option<Way<'a>> {
        self.way(*self.of_touch.get(touch)?, thermals)
    }
}

impl HeapSize for Chains {
    fn heap_size(&self) -> usize {
        let rims: usize = self.of_rim.iter().map(HeapSize::heap_size).sum();
        let numbers = self.of_pair.heap_size() + self.of_ghost.heap_size() + self.of_touch.heap_size() + rims;
        numbers + self.chains.capacity() * size_of::<Chain>() + self.pieces.capacity() * size_of::<Piece>()
    }
}

impl Chain {
    fn new(first: u32, pieces: &[Piece], thermals: &[Thermal]) -> Self {
        let curve = |piece: &Piece| &thermals[piece.material as usize].curve;
        let through =
            |of: &dyn Fn(&Piece) -> f64| 1.0 / pieces.iter().map(|piece| piece.share / of(piece)).sum::<f64>();
        let conductivity =
            (through(&|piece| curve(piece).least_conductive()), through(&|piece| curve(piece).most_conductive()));
        let alike = pieces.iter().all(|piece| curve(piece).scaled_from(curve(&pieces[0])).is_some());
        let ends = pieces.first().zip(pieces.last()).filter(|_| alike);
        let by = |piece: &Piece| conductivity.0 / curve(piece).least_conductive();
        let straight = ends.map(|(near, far)| (by(near), by(far)));
        Chain { first, count: pieces.len() as u32, straight, conductivity }
    }
}

impl<'a> Way<'a> {
    /// Index of the material at the first end.
    pub fn near(&self) -> usize {
        self.pieces[0].material as usize
    }

    /// Least and greatest conductivity of the whole (W/mK), as of one material that is as long.
    pub fn conductivity(&self) -> (f64, f64) {
        self.chain.conductivity
    }

    fn thermal(&self, piece: &Piece) -> &'a Thermal {
        &self.thermals[piece.material as usize]
    }

    /// Potentials of both ends from the freezing points of their materials (W/m).
    fn absolute(&self, near: f64, far: f64) -> (f64, f64) {
        let last = self.pieces[self.pieces.len() - 1];
        (near + self.thermal(&self.pieces[0]).zero_potential, far + self.thermal(&last).zero_potential)
    }

    /// Temperatures of both ends, from potentials that count from the freezing points.
    fn temperatures(&self, near: f64, far: f64) -> (f64, f64) {
        let last = self.pieces[self.pieces.len() - 1];
        let of = |piece: &Piece, potential: f64| self.thermal(piece).curve.temperature_of_potential(potential);
        (of(&self.pieces[0], near), of(&last, far))
    }

    /// What the chain conducts from its far end to its near one, times its length (W/m), by their potentials less the
    /// initial ones: what the difference of potentials is within one material.
    #[inline]
    pub fn conducted(&self, near: f64, far: f64) -> f64 {
        // Potentials count from the initial temperature, which all materials share: two zeros are at rest, and temperatures
        // would know it only to rounding.
        if near == 0.0 && far == 0.0 {
            return 0.0;
        }
        if let Some((by_near, by_far)) = self.chain.straight {
            return by_far * far - by_near * near;
        }
        let (near, far) = self.absolute(near, far);
        self.conducted_between(near, far)
    }

    /// The same through materials whose conductivity changes, by potentials from the freezing points.
    fn conducted_between(&self, near: f64, far: f64) -> f64 {
        let (from, to) = self.temperatures(near, far);
        let (low, high) = (from.min(to), from.max(to));
        let mut resistance = 0.0;
        for piece in self.pieces {
            match self.thermal(piece).curve.conductivity_between(low, high) {
                Some(conductivity) => resistance += piece.share / conductivity,
                None if self.pieces.len() == 2 => return self.met(near, far, low, high),
                None => return self.solved(near, far, from, to),
            }
        }
        (to - from) / resistance
    }

    /// The same through two pieces of which one changes its conductivity between these temperatures: by the temperature at which
    /// they meet, for which no potential has to be turned into a temperature.
    fn met(&self, near: f64, far: f64, low: f64, high: f64) -> f64 {
        let [first, second] = [0, 1].map(|k| (self.pieces[k].share, &self.thermal(&self.pieces[k]).curve));
        let missing = |temperature: f64| {
            let (before, behind) = (first.1.potential(temperature) - near, far - second.1.potential(temperature));
            let slope = second.0 * first.1.conductivity(temperature) + first.0 * second.1.conductivity(temperature);
            (second.0 * before - first.0 * behind, slope)
        };
        let interface = solve_increasing(missing, low, high);
        // Errors of the temperature show least in the piece that resists more.
        let resists = |(share, curve): (f64, &Curve)| share / curve.conductivity(interface);
        if resists(first) > resists(second) {
            (first.1.potential(interface) - near) / first.0
        } else {
            (far - second.1.potential(interface)) / second.0
        }
    }

    /// The same through more pieces.
    fn solved(&self, near: f64, far: f64, from: f64, to: f64) -> f64 {
        // No piece conducts more than the whole difference would drive through it.
        let drives = |piece: &Piece| {
            let curve = &self.thermal(piece).curve;
            (curve.potential(to) - curve.potential(from)) / piece.share
        };
        let least = |best: f64, own: f64| if own.abs() < best.abs() { own } else { best };
        let greatest = self.pieces.iter().map(drives).fold(f64::INFINITY, least);
        // Rounding of the ends must not leave the root outside.
        let (a, b) = (-1e-12 * greatest, (1.0 + 1e-12) * greatest);
        let missing = |conducted: f64| {
            let marched = self.march(near, conducted, false);
            (marched.potential - far, marched.by_conducted)
        };
        solve_increasing(missing, a.min(b), a.max(b))
    }

    /// Potential at one end from that at the other (both from the freezing points) and what is conducted to it; from the
    /// last piece to the first if turned.
    fn march(&self, start: f64, conducted: f64, turned: bool) -> Marched {
        let piece = |k: usize| &self.pieces[if turned { self.pieces.len() - 1 - k } else { k }];
        let mut at = Marched { potential: start, by_conducted: 0.0, by_start: 1.0 };
        for k in 0..self.pieces.len() {
            if k > 0 {
                let (last, next) = (&self.thermal(piece(k - 1)).curve, &self.thermal(piece(k)).curve);
                let interface = last.temperature_of_potential(at.potential);
                let ratio = next.conductivity(interface) / last.conductivity(interface);
                at = Marched {
                    potential: next.potential(interface),
                    by_conducted: ratio * at.by_conducted,
                    by_start: ratio * at.by_start,
                };
            }
            at.potential += piece(k).share * conducted;
            at.by_conducted += piece(k).share;
        }
        at
    }

    /// How what the chain conducts follows the potentials of its ends: it falls by the first share of a change of the near
    /// one and rises by the second share of a change of the far one.
    pub fn shares(&self, near: f64, far: f64) -> (f64, f64) {
        if let Some(straight) = self.chain.straight {
            return straight;
        }
        let (from, to) = self.absolute(near, far);
        let marched = self.march(from, self.conducted_between(from, to), false);
        (marched.by_start / marched.by_conducted, 1.0 / marched.by_conducted)
    }

    /// The greatest shares that any temperatures can make of [`Way::shares`].
    pub fn greatest_shares(&self) -> (f64, f64) {
        (self.greatest_share(false), self.greatest_share(true))
    }

    fn greatest_share(&self, turned: bool) -> f64 {
        if let Some(straight) = self.chain.straight {
            return if turned { straight.1 } else { straight.0 };
        }
        let piece = |k: usize| &self.pieces[if turned { self.pieces.len() - 1 - k } else { k }];
        let curve = |k: usize| &self.thermal(piece(k)).curve;
        // Each piece behind an interface counts by how much better it conducts there, at most.
        let (mut sum, mut better) = (piece(0).share, 1.0);
        for k in 1..self.pieces.len() {
            better *= curve(k).most_conductive() / curve(k - 1).least_conductive();
            sum += piece(k).share / better;
        }
        1.0 / sum
    }

    /// Potential (W/m, less the initial one of the first material) at a wall at the near end, and the flux (W/m2) from it
    /// into the body, by the wall's condition, the length of the chain (m) and the potential of the particle at its far end.
    pub fn wall(&self, face: &Face, depth: f64, far: f64) -> (f64, f64) {
        let (near, beyond) = self.absolute(0.0, far);
        match *face {
            Face::Odd { wall, .. } | Face::Held { wall, .. } => (wall, -self.conducted(wall, far) / depth),
            Face::Even => (self.march(beyond, 0.0, true).potential - near, 0.0),
            Face::Flux(flux) => (self.march(beyond, flux * depth, true).potential - near, flux),
            Face::Film { ref film, .. } => {
                let flux = self.film_flux(depth, beyond, film);
                (self.march(beyond, flux * depth, true).potential - near, flux)
            }
            Face::Runoff(ref runoff) => self.wall(&self.face_of(runoff, depth, far), depth, far),
        }
    }

    /// What a wall with rain is before a chain: one of the flux of the rain, or of the greatest head. One soil alone falls.
    fn face_of(&self, runoff: &Runoff, depth: f64, far: f64) -> Face {
        if runoff.rain * depth < -self.conducted(runoff.wall, far) {
            Face::Flux(runoff.rain)
        } else {
            Face::Odd { wall: runoff.wall, temperature: runoff.place }
        }
    }

    /// Flux (W/m2) through a film and the chain behind it.
    fn film_flux(&self, depth: f64, far: f64, film: &Film) -> f64 {
        if film.is_closed() {
            return 0.0;
        }
        let curve = &self.thermal(&self.pieces[0]).curve;
        let last = self.pieces[self.pieces.len() - 1];
        let inside = self.thermal(&last).curve.temperature_of_potential(far);
        // In units of the film's greatest flux, which may be too large to be told from its neighbours.
        let missing = |flux: f64| {
            let marched = self.march(far, flux * depth, true);
            let wall = curve.temperature_of_potential(marched.potential);
            let slope = marched.by_conducted * depth / curve.conductivity(wall);
            let coefficient = film.coefficient(wall);
            (wall - film.ambient + flux / coefficient, slope * (film.steepness(wall) / coefficient) + 1.0 / coefficient)
        };
        // The coefficient of a wall between both is none greater than at either.
        let greatest = film.coefficient(inside).max(film.coefficient(film.ambient));
        let most =
            (film.ambient - inside) * (1.0 / (1.0 / greatest + depth / self.chain.conductivity.1)) * (1.0 + 1e-12);
        solve_increasing(missing, most.min(0.0), most.max(0.0))
    }

    /// How the potential at the wall and the flux of [`Way::wall`] follow the potential at the far end.
    pub fn wall_slopes(&self, face: &Face, depth: f64, far: f64) -> (f64, f64) {
        let beyond = self.absolute(0.0, far).1;
        match *face {
            Face::Odd { wall, .. } | Face::Held { wall, .. } => (0.0, -self.shares(wall, far).1 / depth),
            Face::Even => (self.march(beyond, 0.0, true).by_start, 0.0),
            Face::Flux(flux) => (self.march(beyond, flux * depth, true).by_start, 0.0),
            Face::Film { ref film, .. } => {
                if film.is_closed() {
                    return (self.march(beyond, 0.0, true).by_start, 0.0);
                }
                let curve = &self.thermal(&self.pieces[0]).curve;
                let flux = self.film_flux(depth, beyond, film);
                let marched = self.march(beyond, flux * depth, true);
                let wall = curve.temperature_of_potential(marched.potential);
                let by_flux = marched.by_conducted * depth;
                let slope = -marched.by_start / (by_flux + curve.conductivity(wall) / film.steepness(wall));
                (marched.by_start + by_flux * slope, slope)
            }
            Face::Runoff(ref runoff) => self.wall_slopes(&self.face_of(runoff, depth, far), depth, far),
        }
    }
}
