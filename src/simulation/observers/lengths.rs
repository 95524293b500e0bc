//! Frozen length on a straight line through a wall, from frozen fractions of particles.
//!
//! A particle tells of its whole cell, and a point of a line is read from several, so a sum of fractions along a line is a mean over
//! lines up to a spacing aside. Between two pipes, whose fronts meet in a cusp, the wall is thinnest on the line itself: beside it, at
//! the distance v, it is `L + c (sqrt(v^2 + s^2) - s) + b v^2`. Sums along the line and along two on either side tell L, c and b, by the
//! means of both terms over what each of them reads.

use glam::DVec2;

use super::sampler::{Sample, Sampler};

/// Distance (spacings) of lines side by side: as near to the cusp as they can be without reading the same particles, and nearer
/// to it where pipes are close together, by the part of their distance.
const APART: (f64, f64, f64) = (1.0, 1.5, 1.0 / 8.0);

/// Radius (spacings) to which a cusp is rounded. Fronts that meet leave a sharp one, which heat rounds within days to a spacing and
/// more: of a sharp one two thirds of what it is read as too long are found, of a round one up to a fifth too much.
const ROUND: f64 = 0.25;

/// A straight line of evenly spaced points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Straight<'a> {
    pub(super) origin: DVec2,
    pub(super) direction: DVec2,
    /// Distances of the points from the origin (m).
    pub(super) along: &'a [f64],
}

/// By how much (m) frozen ground is read as too long on the line through the middle between two pipes, as a sum over frozen fractions.
pub(super) fn excess_between(pipes: [DVec2; 2], sampler: &Sampler<'_>) -> Sample {
    let between = pipes[1] - pipes[0];
    let apart = between.length();
    let count = (4.0 * apart / sampler.lattice.spacing).ceil().max(1.0);
    let along: Vec<f64> = (0..=count as usize).map(|k| apart * (2.0 * k as f64 / count - 1.0)).collect();
    let (origin, direction) = (0.5 * (pipes[0] + pipes[1]), between.perp().normalize_or(DVec2::X));
    let line = Straight { origin, direction, along: &along };
    let mut entries = line.lengths(sampler).0;
    entries.extend(line.lengths_at_cusp(pipes, sampler).0.into_iter().map(|(i, length)| (i, -length)));
    merged(entries)
}

/// What sums along lines read: particles with the length of line (m) in each, and how far from the middle line they are.
#[derive(Debug, Clone)]
struct Read {
    lengths: Vec<(u32, f64)>,
    /// Mean of the rounded distance (m), and of the square of the distance (m2).
    distance: f64,
    square: f64,
}

impl Straight<'_> {
    /// Particles and the length of line (m) in each: times their frozen fractions, the frozen length as it is read on the line.
    pub(super) fn lengths(self, sampler: &Sampler<'_>) -> Sample {
        merged(self.read([0.0], (f64::NEG_INFINITY, f64::INFINITY), sampler).lengths)
    }

    /// The same for a line between two pipes, where they stand (m): fronts of both may meet on it.
    pub(super) fn lengths_at_cusp(self, pipes: [DVec2; 2], sampler: &Sampler<'_>) -> Sample {
        let (middle, distance) = (0.5 * (pipes[0] + pipes[1]), pipes[0].distance(pipes[1]));
        let at = (middle - self.origin).dot(self.direction);
        let meet = (at - 0.5 * distance, at + 0.5 * distance);
        let spacing = sampler.lattice.spacing;
        let apart = (APART.2 * distance).clamp(APART.0 * spacing, APART.1 * spacing);
        let here = self.read([0.0], meet, sampler);
        let [near, far] = [apart, 2.0 * apart].map(|aside| self.read([aside, -aside], meet, sampler));
        let (a, b) = (near.distance - here.distance, far.distance - here.distance);
        let (c, d) = (near.square - here.square, far.square - here.square);
        let determinant = a * d - b * c;
        let of_near = (b * here.square - d * here.distance) / determinant;
        let of_far = (c * here.distance - a * here.square) / determinant;
        let weighted = [(here, 1.0 - of_near - of_far), (near, of_near), (far, of_far)];
        merged(
            weighted
                .into_iter()
                .flat_map(|(read, weight)| read.lengths.into_iter().map(move |(i, length)| (i, weight * length)))
                .collect(),
        )
    }

    /// Mean of sums along lines to the side of this one (m), and how far from it they read between two points (m along it).
    fn read<const N: usize>(self, asides: [f64; N], (from, to): (f64, f64), sampler: &Sampler<'_>) -> Read {
        let (aside, last) = (self.direction.perp(), self.along.len() - 1);
        let step = self.along[1] - self.along[0];
        let mut read = Read { lengths: Vec::new(), distance: 0.0, square: 0.0 };
        let mut parts = 0.0;
        for offset in asides {
            let origin = self.origin + offset * aside;
            let places: Vec<DVec2> = self.along.iter().map(|along| origin + *along * self.direction).collect();
            for (k, (place, sample)) in places.iter().zip(sampler.samples(&places)).enumerate() {
                let ends = if k == 0 || k == last { 0.5 } else { 1.0 };
                let length = ends * step / N as f64;
                read.lengths.extend(sample.0.iter().map(|(i, weight)| (*i, length * weight)));
                if !(from..=to).contains(&self.along[k]) {
                    continue;
                }
                for (seen, weight) in sampler.seen(*place, &sample) {
                    let off = (seen - self.origin).dot(aside);
                    let (distance, square) = of_cell(off, aside, sampler.lattice.spacing);
                    parts += weight;
                    read.distance += weight * distance;
                    read.square += weight * square;
                }
            }
        }
        Read { distance: read.distance / parts, square: read.square / parts, ..read }
    }
}

/// Means of a rounded distance (m) and of the square of the distance (m2) of a cell from a line, across `aside`, from which its centre
/// lies `off`: over places in it.
fn of_cell(off: f64, aside: DVec2, spacing: f64) -> (f64, f64) {
    const SIDE: usize = 4;
    let round = ROUND * spacing;
    let at = |k: usize| ((k as f64 + 0.5) / SIDE as f64 - 0.5) * spacing;
    let offs = (0..SIDE * SIDE).map(|k| off + aside.dot(DVec2::new(at(k % SIDE), at(k / SIDE))));
    let sums = offs.fold((0.0, 0.0), |sums, off| (sums.0 + off.hypot(round) - round, sums.1 + off * off));
    let places = (SIDE * SIDE) as f64;
    (sums.0 / places, sums.1 / places)
}

/// Entries with one for each particle.
fn merged(mut entries: Vec<(u32, f64)>) -> Sample {
    entries.sort_by_key(|entry| entry.0);
    entries.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    entries.shrink_to_fit();
    Sample(entries)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use frazil_core::space::domain::{Domain, Sector};
    use frazil_core::space::lattice::Lattice;
    use proptest::prelude::*;

    const SPACING: f64 = 0.1;

    /// Lengths that are read on the line alone and where fronts may meet, through a middle from which two pipes lie to either side, of
    /// frozen ground whose share of each cell is found by a hundred places in it.
    fn read(middle: DVec2, aside: DVec2, frozen: impl Fn(DVec2) -> bool) -> (f64, f64) {
        let lattice = Lattice::new(&Domain::Ring { outer_radius: 2.5, sector: Sector::Whole }, SPACING);
        let sampler = Sampler::on(&lattice);
        let at = |k: usize| ((k as f64 + 0.5) / 10.0 - 0.5) * SPACING;
        let share = |i: usize| {
            let places = (0..100).map(|k| lattice.position(i) + DVec2::new(at(k % 10), at(k / 10)));
            places.filter(|place| frozen(*place)).count() as f64 / 100.0
        };
        let shares: Vec<f64> = (0..lattice.len()).map(share).collect();
        let along: Vec<f64> = (-40..=40).map(|k| 0.5 * SPACING * f64::from(k)).collect();
        let line = Straight { origin: middle, direction: aside.perp().normalize(), along: &along };
        let pipes = [middle - aside, middle + aside];
        let read = [line.lengths(&sampler), line.lengths_at_cusp(pipes, &sampler)];
        let [alone, at_cusp] = read.map(|lengths| lengths.of(|i| shares[i]));
        (alone, at_cusp)
    }

    proptest! {
            #![proptest_config(ProptestConfig::with_cases(48))]

            /// Two discs that overlap, however they lie to the lattice: between them frozen ground is as long as their common chord.
            /// Read on that line alone it is longer, by one to three spacings.
            #[test]
            fn the_chord_of_two_discs_is_found(
                turn in 0.0..TAU, x in -0.05..0.05f64, y in -0.05..0.05f64, chord in 0.2..1.0f64,
            ) {
                let (middle, aside) = (DVec2::new(x, y), 0.6 * DVec2::from_angle(turn));
                let radius = 0.6_f64.hypot(0.5 * chord);
                let discs = [middle - aside, middle + aside];
                let (alone, found) = read(middle, aside, |place| discs.iter().any(|disc| disc.distance(place) <= radius));
                // A third of that is left for a cusp as sharp as theirs, two thirds just after they have met.
                let left = 0.75 * (alone - chord) + 0.05 * SPACING;
                prop_assert!((-0.2 * SPACING..left).contains(&(found - chord)), "{found} for {chord}, alone {alone}");
            }

            /// A wall that is thinnest at a cusp, sharp or round, or at a parabola, or is even: it is found within half of what is read too
            /// much on the line alone, and a fifth of a spacing, by which cells read an even wall at most.
            #[test]
            fn a_wall_is_found_however_round_its_cusp(
                turn in 0.0..TAU, x in -0.05..0.05f64, y in -0.05..0.05f64, round in 0.0..0.4f64, slope in 0.0..2.0f64,
            ) {
                let (middle, aside) = (DVec2::new(x, y), 0.6 * DVec2::from_angle(turn));
                let (_, found) = read(middle, aside, |place| {
                    let off = (place - middle).dot(aside.normalize());
                    let across = (place - middle).dot(aside.normalize().perp());
                    2.0 * across.abs() <= 0.5 + slope * (off.hypot(round) - round)
                });
                let wrong = (found - 0.5) / SPACING;
    prop_assert!(wrong.abs() < 0.2 * (slope + 1.0), "{wrong} for {round}, {slope}");
            }
        }
}
