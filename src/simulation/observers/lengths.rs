//! Frozen length on a straight line through a wall, from frozen fractions of particles.
//!
//! A particle tells of its whole cell, and a point of a line is read from several, so a sum of fractions along a line is a mean over
//! lines up to a spacing aside. Between two pipes, whose fronts meet in a cusp, the wall is thinnest on the line itself: beside it, at
//! the distance v, it is `L + c (sqrt(v^2 + s^2) - s) + b v^2`. Sums along the line and along two on either side tell L, c and b, by the
//! means of both terms over what each of them reads.

use frazil_core::memory::HeapSize;
use glam::DVec2;

use super::joint::Joint;
use super::observer::{Setup, View};
use super::rays::Ray;
use super::sampler::{Sample, Sampler};

/// Distance (spacings) of lines side by side: as near to the cusp as they can be without reading the same particles, and nearer
/// to it where pipes are close together, by the part of their distance.
const APART: (f64, f64, f64) = (1.0, 1.5, 1.0 / 8.0);

/// Radius (spacings) to which a cusp is rounded. Fronts that meet leave a sharp one, which heat rounds within days to a spacing and
/// more: of a sharp one two thirds of what it is read as too long are found, of a round one up to a fifth too much.
const ROUND: f64 = 0.25;

/// Pipes that stand closer (spacings) leave no room for lines between them.
const ROOM: f64 = 4.0;

/// A line across a wall, on which its frozen length is read.
#[derive(Debug, Clone)]
pub(super) struct Across {
    /// How many lines of the whole wall it stands for.
    multiplicity: usize,
    /// Particles and the length of the line (m) in each.
    alone: Sample,
    /// By how much that is read as too long where fronts of two pipes meet; nothing on lines through pipes.
    excess: Sample,
    /// Tells whether the pipes between which it goes have joined, where nothing but their frozen bodies reaches the line: before, what
    /// is read on it is beside it.
    joint: Option<Joint>,
}

impl Across {
    /// Along a ray.
    pub(super) fn along(ray: &Ray, setup: &Setup<'_>, sampler: &Sampler<'_>) -> Self {
        let line = Straight { origin: ray.origin, direction: ray.direction, along: &ray.radii };
        let is_only_ring = setup.scene.rings.len() == 1;
        let joint = ray.pipes.filter(|_| is_only_ring).map(|pipes| Joint::between(pipes, setup, sampler));
        Across {
            multiplicity: ray.multiplicity,
            alone: merged(line.lengths(&ray.samples)),
            excess: ray.pipes.map_or(Sample::default(), |pipes| line.excess(pipes, sampler)),
            joint,
        }
    }

    /// Frozen length (m), and by how much it is read as too long on the line alone.
    pub(super) fn frozen(&self, view: &View<'_>) -> (f64, f64) {
        let fractions = view.fractions();
        let alone = self.alone.of(|i| fractions[i]);
        // What is read beside a line may leave less than nothing on it.
        let length = (alone - self.excess.of(|i| fractions[i])).max(0.0);
        let is_open = || self.joint.as_ref().is_some_and(|joint| joint.is_open(view.particles, &view.fractions));
        let length = if length > 0.0 && is_open() { 0.0 } else { length };
        (length, alone - length)
    }
}

impl HeapSize for Across {
    fn heap_size(&self) -> usize {
        self.alone.heap_size() + self.excess.heap_size() + self.joint.as_ref().map_or(0, HeapSize::heap_size)
    }
}

/// Mean frozen length over lines (m), each for all that it stands for; none of none.
pub(super) fn mean_length(lines: &[Across], view: &View<'_>) -> Option<f64> {
    let weights: usize = lines.iter().map(|line| line.multiplicity).sum();
    let lengths = lines.iter().map(|line| line.multiplicity as f64 * line.frozen(view).0);
    (weights > 0).then(|| lengths.sum::<f64>() / weights as f64)
}

/// By how much (m) frozen ground is read as too long on the line through the middle between two pipes, as a sum over frozen fractions.
pub(super) fn excess_between(pipes: [DVec2; 2], sampler: &Sampler<'_>) -> Sample {
    let between = pipes[1] - pipes[0];
    let apart = between.length();
    let count = (4.0 * apart / sampler.lattice.spacing).ceil().max(1.0);
    let along: Vec<f64> = (0..=count as usize).map(|k| apart * (2.0 * k as f64 / count - 1.0)).collect();
    let (origin, direction) = (0.5 * (pipes[0] + pipes[1]), between.perp().normalize_or(DVec2::X));
    Straight { origin, direction, along: &along }.excess(pipes, sampler)
}

/// A straight line of evenly spaced points.
#[derive(Debug, Clone, Copy)]
struct Straight<'a> {
    origin: DVec2,
    direction: DVec2,
    /// Distances of the points from the origin (m).
    along: &'a [f64],
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
    /// Particles and the length of line (m) in each, by samples of its points.
    fn lengths(&self, samples: &[Sample]) -> Vec<(u32, f64)> {
        let step = self.along[1] - self.along[0];
        let mut lengths = Vec::with_capacity(4 * samples.len());
        for (k, sample) in samples.iter().enumerate() {
            let length = if k == 0 || k + 1 == samples.len() { 0.5 * step } else { step };
            lengths.extend(sample.0.iter().map(|(i, weight)| (*i, length * weight)));
        }
        lengths
    }

    /// By how much (m) frozen ground is read as too long on the line, which goes between two pipes, where they stand (m).
    fn excess(&self, pipes: [DVec2; 2], sampler: &Sampler<'_>) -> Sample {
        let (middle, distance) = (0.5 * (pipes[0] + pipes[1]), pipes[0].distance(pipes[1]));
        let spacing = sampler.lattice.spacing;
        if distance < ROOM * spacing {
            return Sample::default();
        }
        let at = (middle - self.origin).dot(self.direction);
        let meet = (at - 0.5 * distance, at + 0.5 * distance);
        let apart = (APART.2 * distance).clamp(APART.0 * spacing, APART.1 * spacing);
        let here = self.read(&[0.0], meet, sampler);
        let [near, far] = [apart, 2.0 * apart].map(|aside| self.read(&[aside, -aside], meet, sampler));
        let (a, b) = (near.distance - here.distance, far.distance - here.distance);
        let (c, d) = (near.square - here.square, far.square - here.square);
        let determinant = a * d - b * c;
        let of_near = (b * here.square - d * here.distance) / determinant;
        let of_far = (c * here.distance - a * here.square) / determinant;
        let weighted = [(here, of_near + of_far), (near, -of_near), (far, -of_far)];
        let entries = weighted
            .into_iter()
            .flat_map(|(read, weight)| read.lengths.into_iter().map(move |(i, length)| (i, weight * length)));
        merged(entries.collect())
    }

    /// Mean of sums along lines to the side of this one (m), and how far from it they read between two points (m along it).
    fn read(&self, asides: &[f64], (from, to): (f64, f64), sampler: &Sampler<'_>) -> Read {
        let (aside, share) = (self.direction.perp(), 1.0 / asides.len() as f64);
        let mut read = Read { lengths: Vec::new(), distance: 0.0, square: 0.0 };
        let mut parts = 0.0;
        for offset in asides {
            let origin = self.origin + *offset * aside;
            let places: Vec<DVec2> = self.along.iter().map(|along| origin + *along * self.direction).collect();
            let samples = sampler.samples(&places);
            read.lengths.extend(self.lengths(&samples).into_iter().map(|(i, length)| (i, share * length)));
            let points = self.along.iter().zip(places.iter().zip(&samples));
            for (place, sample) in points.filter(|(along, _)| (from..=to).contains(*along)).map(|(_, point)| point) {
                for (seen, weight) in sampler.seen(*place, sample) {
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
    let sums =
        offs.fold((0.0, 0.0), |sums, off| (sums.0 + (off * off + round * round).sqrt() - round, sums.1 + off * off));
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
        let places: Vec<DVec2> = along.iter().map(|along| middle + *along * line.direction).collect();
        let alone: f64 =
            line.lengths(&sampler.samples(&places)).iter().map(|(i, length)| length * shares[*i as usize]).sum();
        let at_cusp = alone - line.excess(pipes, &sampler).of(|i| shares[i]);
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
