//! The pressure: what leaves each particle through its paths and openings is what it gives.
//!
//! The matrix is symmetric and positive. Conjugate gradients start from the last pressure, with a symmetric
//! Gauss-Seidel sweep as preconditioner, and are deflated: the body is cut into blocks, and the balance of every block
//! is met exactly in each iteration (Nicolaides 1987; Saad et al. 2000). Slow changes over the whole body are then not
//! left to the iteration, and no water is lost however early it ends.
//!
//! Threads share an iteration by bands of particles, whose number follows from that of the particles alone. Sweeps of bands see
//! no other (`seams`), so that none waits, and sums are added band by band: any number of threads finds the same bits.

mod bands;
mod coarse;
mod envelope;
mod seams;

use glam::DVec2;

use self::bands::{Band, Bands};
use self::coarse::Coarse;
use self::seams::Seams;
use crate::balances::groundwater::diagonals::{Diagonals, sum};
use crate::balances::groundwater::error::GroundwaterError;
use crate::balances::groundwater::network::{NONE, Network, Opening};
use crate::balances::groundwater::tasks::each;
use crate::bonds::exchange::Mean;
use crate::instruction_set::widest;
use crate::memory::{HeapSize, total};
use crate::saved::{Pass, Saved};
use crate::team::Team;

/// What remains of a particle's balance over the water that passes through it, in the root of the mean of squares. A hundred times as
/// much shows in no error of a scene, but bodies that are mirrored or turned are then no more the same to a millionth.
const TOLERANCE: f64 = 1e-7;

/// The same over what drives water, for the first solution and others before which none has passed.
const FIRST_TOLERANCE: f64 = 1e-11;
/// The same where hardly any water passed before, as far as numbers tell it from none.
const ROUNDING: f64 = 1e-15;

/// How steep the pressure counts at most, over its mean in open ground: that in the last gap of a ring of pipes, whose whole head is lost
/// over a tenth of its width. Ice itself may hold it a thousand times as steep, and lets no more water through when it thaws.
const STEEPEST: f64 = 10.0;

/// Iterations of one solution, beyond which there is none.
const MOST_ITERATIONS: usize = 10_000;

/// Pressure of all particles, and the solver.
#[derive(Clone)]
pub struct Pressure {
    /// Pressure (Pa).
    pub pressure: Vec<f64>,
    /// Conductance by volume (m/(Pa s m^2) times m: `weight K`) of each path, by slot.
    pub conductances: Vec<f64>,
    /// The same of each opening.
    pub mouths: Vec<f64>,
    /// Solutions so far.
    pub solutions: u64,
    /// Iterations of all solutions.
    pub iterations: u64,
    walls: Vec<f64>,
    diagonal: Vec<f64>,
    /// Inverse of the diagonal, without what lies on seams.
    inverse: Vec<f64>,
    /// By slot.
    rest: Vec<f64>,
    right: Vec<f64>,
    bands: Bands,
    /// One of each band.
    sums: Vec<f64>,
    seams: Seams,
    coarse: Coarse,
    residual: Vec<f64>,
    swept: Vec<f64>,
    /// The same, on columns of places of each band.
    swept_places: Vec<Vec<f64>>,
    direction: Vec<f64>,
    /// A column of places, on diagonals.
    places: Vec<f64>,
    image: Vec<f64>,
}

impl Saved for Pressure {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [
            &mut self.pressure,
            &mut self.conductances,
            &mut self.mouths,
            &mut self.solutions,
            &mut self.iterations,
            &mut self.walls,
        ]);
    }
}

impl HeapSize for Pressure {
    fn heap_size(&self) -> usize {
        let columns = [
            &self.places,
            &self.pressure,
            &self.diagonal,
            &self.inverse,
            &self.right,
            &self.residual,
            &self.swept,
            &self.direction,
        ];
        let columns: usize = columns.into_iter().chain(&self.swept_places).map(HeapSize::heap_size).sum();
        columns
            + self.bands.heap_size()
            + self.seams.heap_size()
            + total(&[&self.image, &self.conductances, &self.mouths, &self.rest, &self.coarse])
    }
}

impl Pressure {
    /// A solver for particles at these places, with threads if more than one.
    pub fn new(network: &Network, positions: &[DVec2], team: Option<Team>) -> Self {
        Pressure::by(network, positions, Bands::new(network, team))
    }

    /// The same by these bands.
    fn by(network: &Network, positions: &[DVec2], bands: Bands) -> Self {
        let (count, paths) = (network.len(), network.places);
        let padded = network.diagonals.as_ref().map_or(0, Diagonals::padded);
        Pressure {
            pressure: vec![0.0; count],
            conductances: vec![0.0; paths],
            mouths: vec![0.0; network.openings.len()],
            solutions: 0,
            iterations: 0,
            walls: Vec::new(),
            diagonal: vec![0.0; count],
            inverse: vec![0.0; count],
            rest: vec![0.0; paths],
            right: vec![0.0; count],
            coarse: Coarse::new(network, positions),
            residual: vec![0.0; count],
            swept: vec![0.0; count],
            swept_places: bands.columns(network),
            sums: vec![0.0; bands.count()],
            seams: Seams::new(network, &bands),
            bands,
            direction: vec![0.0; count],
            places: vec![0.0; padded],
            image: vec![0.0; count],
        }
    }

    /// Solves for hydraulic conductivities (m2/(Pa s)) of particles, pressures (Pa) of walls, and the water that each
    /// particle takes up by volume (1/s), where `passing` passed through particles before (1/s by volume, root of the sum of
    /// squares).
    ///
    /// # Errors
    /// A pressure that is not found, or is no number.
    pub fn solve(
        &mut self,
        network: &Network,
        conductivity: &[f64],
        walls: &[f64],
        taken: Option<&[f64]>,
        passing: f64,
        mean: Mean,
    ) -> Result<(), GroundwaterError> {
        self.walls.clear();
        self.walls.extend_from_slice(walls);
        match mean {
            Mean::Harmonic => self.assemble(network, conductivity, walls, taken, |a, b| 2.0 * a * b / (a + b)),
            Mean::Arithmetic => self.assemble(network, conductivity, walls, taken, |a, b| 0.5 * (a + b)),
            Mean::Geometric => self.assemble(network, conductivity, walls, taken, |a, b| (a * b).sqrt()),
        }
        self.coarse.assemble(network, &self.diagonal, &self.rest, &self.bands);
        let norm = |column: &[f64]| dot(column, column).sqrt();
        let limit = match passing > 0.0 {
            true => (TOLERANCE * passing).max(ROUNDING * norm(&self.right)),
            false => FIRST_TOLERANCE * norm(&self.right),
        };
        // The balance of each block first.
        self.face(network);
        self.coarse.correct(&mut self.pressure, &mut self.residual, &self.bands);
        let (mut last, mut count) = (0.0, 0);
        let mut left = self.left();
        while left > limit {
            if count == MOST_ITERATIONS {
                return Err(GroundwaterError::NotFound(MOST_ITERATIONS));
            }
            let product = self.sweep(network);
            self.coarse.find(&self.swept, &self.bands);
            self.turn(network, if count == 0 { 0.0 } else { product / last });
            last = product;
            let length = product / self.multiply(network);
            if !length.is_finite() {
                return Err(GroundwaterError::NotFinite);
            }
            left = self.go(length);
            count += 1;
        }
        // Rounding of the sums over iterations.
        self.coarse.correct(&mut self.pressure, &mut self.residual, &self.bands);
        self.solutions += 1;
        self.iterations += count as u64;
        Ok(())
    }

    /// Fills in how steep the pressure is at each particle, over the mean of all ground that water passes as it does its own: how
    /// much a change of a particle's permeability changes the flow around it. One everywhere where water stands.
    pub fn steepness(&mut self, network: &Network, permeability: &[f64], steepness: &mut [f64]) {
        let Pressure { pressure, rest, places, bands, .. } = self;
        let team = bands.team();
        network.by_path(team, (&network.weights, pressure), places, |weight, i, j| weight * (i - j).abs(), rest);
        network.sums(team, [rest; 3], |[driven, ..], _| driven, steepness);
        let mean = dot(steepness, permeability) / permeability.iter().sum::<f64>();
        for steep in steepness {
            *steep = if mean > 0.0 { (*steep / mean).min(STEEPEST) } else { 1.0 };
        }
    }

    /// The part of a ghost's pressure (Pa) that walls held in the last solution.
    pub fn wall_parts(&self, opening: &Opening) -> f64 {
        opening.wall_part(&self.walls)
    }

    fn assemble(
        &mut self,
        network: &Network,
        conductivity: &[f64],
        walls: &[f64],
        taken: Option<&[f64]>,
        mean: impl Fn(f64, f64) -> f64 + Sync,
    ) {
        let Pressure { diagonal, conductances, rest, right, places, bands, .. } = self;
        let team = bands.team();
        let conductance = |weight: f64, i: f64, j: f64| if weight == 0.0 { 0.0 } else { weight * mean(i, j) };
        network.by_path(team, (&network.weights, conductivity), places, conductance, conductances);
        network.sums(team, [conductances; 3], |[conductance, ..], _| conductance, diagonal);
        each(team, rest, |slot, rest| *rest = -conductances[slot]);
        for (i, right) in right.iter_mut().enumerate() {
            *right = taken.map_or(0.0, |taken| -taken[i]);
        }
        for (opening, mouth) in network.openings.iter().zip(&mut self.mouths) {
            let (i, j) = (opening.particle as usize, opening.image as usize);
            *mouth = opening.weight * mean(conductivity[i], conductivity[j]);
            self.diagonal[i] += *mouth;
            if opening.path == NONE {
                self.diagonal[i] -= opening.sign * *mouth;
            } else if i < j {
                // The other way is the opening of the image, with the same mouth.
                self.rest[network.slots[opening.path as usize] as usize] -= opening.sign * *mouth;
            }
            self.right[i] += *mouth * opening.wall_part(walls);
        }
        // A particle without any path stays as it is.
        for (diagonal, right) in self.diagonal.iter_mut().zip(&mut self.right).filter(|row| *row.0 <= 0.0) {
            (*diagonal, *right) = (1.0, 0.0);
        }
        for (inverse, diagonal) in self.inverse.iter_mut().zip(&self.diagonal) {
            *inverse = 1.0 / diagonal;
        }
        self.seams.take(&self.rest, &mut self.inverse);
    }

    /// Fills the residual of the pressure.
    fn face(&mut self, network: &Network) {
        self.direction.copy_from_slice(&self.pressure);
        let Pressure { bands, sums, places, direction, .. } = self;
        bands.share(sums, bands.placed(places), |band, places| {
            set_out(network, band, bands.part(band, direction), places);
            0.0
        });
        self.multiply(network);
        for ((residual, right), image) in self.residual.iter_mut().zip(&self.right).zip(&self.image) {
            *residual = right - image;
        }
    }

    /// The root of the sum of squares of the residual.
    fn left(&mut self) -> f64 {
        let Pressure { bands, sums, residual, .. } = self;
        bands.share(sums, bands.parts(residual), |_, residual| dot(residual, residual)).sqrt()
    }

    /// Turns the direction to where the last sweep points, without what blocks see.
    fn turn(&mut self, network: &Network, grow: f64) {
        let Pressure { bands, sums, coarse, swept, direction, places, .. } = self;
        let parts = bands.parts(direction).zip(bands.placed(places));
        bands.share(sums, parts, |band, (direction, places)| {
            let (swept, blocks) = (bands.part(band, swept), bands.part(band, &coarse.blocks));
            turn(grow, swept, (blocks, &coarse.work), direction);
            set_out(network, band, direction, places);
            0.0
        });
    }

    /// Fills the image of the direction; the product of both.
    fn multiply(&mut self, network: &Network) -> f64 {
        let Pressure { bands, sums, diagonal, rest, direction, places, image, .. } = self;
        bands.share(sums, bands.parts(image), |band, image| {
            let (first, own) = (band.first, bands.part(band, direction));
            if let Some(diagonals) = &network.diagonals {
                diagonals.multiply([bands.part(band, diagonal), rest, places], first, image);
                return dot(own, image);
            }
            for (i, image) in (first..).zip(image.iter_mut()) {
                let range = network.starts[i]..network.starts[i + 1];
                let paths = network.partners[range.clone()].iter().zip(&network.slots[range]);
                let rest: f64 = paths.map(|(j, slot)| rest[*slot as usize] * direction[*j as usize]).sum();
                *image = diagonal[i] * direction[i] + rest;
            }
            dot(own, image)
        })
    }

    /// Goes so far along the direction; what is then left.
    fn go(&mut self, length: f64) -> f64 {
        let Pressure { bands, sums, pressure, direction, residual, image, .. } = self;
        let parts = bands.parts(pressure).zip(bands.parts(residual));
        let squares = bands.share(sums, parts, |band, (pressure, residual)| {
            go(length, [bands.part(band, direction), bands.part(band, image)], pressure, residual);
            dot(residual, residual)
        });
        squares.sqrt()
    }

    /// Symmetric Gauss-Seidel: forward over the paths to earlier particles, back over those to later ones; the product of the
    /// residual with what it finds.
    fn sweep(&mut self, network: &Network) -> f64 {
        let Pressure { bands, sums, seams, inverse, rest, residual, swept, swept_places, .. } = self;
        let parts = bands.parts(swept).zip(&mut *swept_places);
        bands.share(sums, parts, |band, (swept, places)| {
            let columns = [bands.part(band, inverse), rest, bands.part(band, residual)];
            if let Some(diagonals) = &network.diagonals {
                diagonals.forward(columns, (band.first, band.base), places);
                diagonals.places.collect_from(places, (band.first, band.base), swept);
            } else {
                forward(network, band, columns, swept);
            }
            0.0
        });
        seams.sweep(bands, [residual, swept]);
        let (parts, seams) = (bands.parts(swept).zip(swept_places), &*seams);
        bands.share(sums, parts, |band, (swept, places)| {
            let own = bands.part(band, inverse);
            if let Some(diagonals) = &network.diagonals {
                seams.before(band.number, inverse, places);
                diagonals.back([own, rest], (band.first, band.base, swept.len()), places);
                seams.after(band.number, places);
                diagonals.places.collect_from(places, (band.first, band.base), swept);
            } else {
                seams.before(band.number, inverse, swept);
                back(network, band, [own, rest], swept);
                seams.after(band.number, swept);
            }
            dot(bands.part(band, residual), swept)
        })
    }
}

/// Puts a band's part of a column of particles on its places, on diagonals.
fn set_out(network: &Network, band: &Band, part: &[f64], places: &mut [f64]) {
    if let Some(diagonals) = &network.diagonals {
        diagonals.places.spread_from(part, (band.first, band.from), places);
    }
}

/// What paths of a particle bring from what was found for the others of its band.
fn brought(network: &Network, band: &Band, paths: std::ops::Range<usize>, rest: &[f64], swept: &[f64]) -> f64 {
    let paths = network.partners[paths.clone()].iter().zip(&network.slots[paths]);
    let within = paths.map(|(j, slot)| ((*j as usize).wrapping_sub(band.first), slot));
    within.filter(|(j, _)| *j < swept.len()).map(|(j, slot)| rest[*slot as usize] * swept[j]).sum()
}

/// The first half of the sweep of a band along its paths.
fn forward(network: &Network, band: &Band, [inverse, rest, residual]: [&[f64]; 3], swept: &mut [f64]) {
    for (k, i) in (0..swept.len()).zip(band.first..) {
        let earlier = brought(network, band, network.starts[i]..network.laters[i], rest, swept);
        swept[k] = (residual[k] - earlier) * inverse[k];
    }
}

/// The other half.
fn back(network: &Network, band: &Band, [inverse, rest]: [&[f64]; 2], swept: &mut [f64]) {
    for k in (0..swept.len()).rev() {
        let i = band.first + k;
        let later = brought(network, band, network.laters[i]..network.starts[i + 1], rest, swept);
        swept[k] -= later * inverse[k];
    }
}

widest!(turn, turn_rows, (grow: f64, swept: &[f64], found: (&[u32], &[f64]), direction: &mut [f64]));
widest!(go, go_rows, (length: f64, columns: [&[f64]; 2], pressure: &mut [f64], residual: &mut [f64]));

#[inline(always)]
fn turn_rows(grow: f64, swept: &[f64], (blocks, found): (&[u32], &[f64]), direction: &mut [f64]) {
    for ((direction, swept), block) in direction.iter_mut().zip(swept).zip(blocks) {
        *direction = grow * *direction + swept - found[*block as usize];
    }
}

#[inline(always)]
fn go_rows(length: f64, [direction, image]: [&[f64]; 2], pressure: &mut [f64], residual: &mut [f64]) {
    for (pressure, direction) in pressure.iter_mut().zip(direction) {
        *pressure += length * direction;
    }
    for (residual, image) in residual.iter_mut().zip(image) {
        *residual -= length * image;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut product = 0.0;
    dot_widely([a, b], &mut product);
    product
}

widest!(dot_widely, dot_of, (columns: [&[f64]; 2], product: &mut f64));

#[inline(always)]
fn dot_of([a, b]: [&[f64]; 2], product: &mut f64) {
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    *product = sum(count, |i| a[i] * b[i]);
}

#[cfg(test)]
mod tests;
