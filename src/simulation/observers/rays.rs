//! Planes through the wall of the first ring or row of pipes: rays through its pipes and between neighbours.

use std::f64::consts::TAU;

use frazil_core::memory::HeapSize;
use frazil_core::space::domain::Domain;
use frazil_scene::{PipeName, PipeRing, Scene};
use glam::DVec2;

use super::loops::{SAME, neighbours, turn};
use super::sampler::{Sample, Sampler};

/// A ray of evenly spaced samples.
#[derive(Debug, Clone)]
pub(super) struct Ray {
    /// How many rays of the whole ring it stands for.
    pub(super) multiplicity: usize,
    /// The centre of a ring, or the place on a row that it crosses (m).
    pub(super) origin: DVec2,
    pub(super) direction: DVec2,
    /// Distances from its origin along it (m).
    pub(super) radii: Vec<f64>,
    pub(super) samples: Vec<Sample>,
    /// Where the pipes stand between which it goes (m); none through a pipe.
    pub(super) pipes: Option<[DVec2; 2]>,
}

impl HeapSize for Ray {
    fn heap_size(&self) -> usize {
        self.radii.heap_size() + self.samples.heap_size()
    }
}

/// Two neighbours of a ring, anticlockwise as the centre sees them.
pub(crate) struct Pair {
    numbers: [usize; 2],
    /// Where the arc between them is half-way, or else the line (m).
    pub(super) middle: DVec2,
    /// Where they stand (m).
    pub(super) places: [DVec2; 2],
    /// Whether the line between them is seen from the centre at all, and not along itself.
    seen: bool,
}

impl Pair {
    /// Number of the first pipe, from 0.
    pub(crate) fn first(&self) -> usize {
        self.numbers[0]
    }

    /// Names of both.
    pub(crate) fn names(&self) -> [String; 2] {
        self.numbers.map(|pipe| PipeName { ring: 0, pipe }.to_string())
    }

    /// Angle of the middle between them, from 0 to a turn.
    pub(crate) fn angle(&self) -> f64 {
        self.middle.to_angle().rem_euclid(TAU)
    }
}

/// Rays through the pipes of the first ring that are there, and between its neighbours, in the part of the plan that is run. Walls
/// are measured on that ring; others are part of the layout around it.
pub(super) fn rays(scene: &Scene, sampler: &Sampler<'_>) -> [Vec<Ray>; 2] {
    let (outer, sector, ring) = match (&scene.domain, scene.rings.first()) {
        (Domain::Ring { outer_radius, sector }, Some(ring)) => (*outer_radius, *sector, ring),
        (Domain::Rectangle { width, height }, Some(row)) => return across(row, DVec2::new(*width, *height), sampler),
        _ => return [Vec::new(), Vec::new()],
    };
    let spacing = sampler.lattice.spacing;
    let angle = |place: DVec2| place.to_angle().rem_euclid(TAU);
    let ray = |place: DVec2, pipes: Option<[DVec2; 2]>| {
        let count = ((outer - spacing) / (0.5 * spacing)).ceil().max(1.0) as usize;
        let radii: Vec<f64> = (0..=count).map(|k| (outer - spacing) * k as f64 / count as f64).collect();
        let direction = place.normalize_or_zero();
        let samples = radii.iter().map(|radius| sampler.sample(direction * *radius)).collect();
        let multiplicity = sector.multiplicity(angle(place));
        Ray { multiplicity, origin: DVec2::ZERO, direction, radii, samples, pipes }
    };
    let off_centre = |place: &DVec2| place.length() > SAME * outer;
    let held = |place: &DVec2| sector.holds(angle(*place));
    let pipes = ring.numbers().map(|k| ring.place(k)).filter(off_centre);
    let between = pairs(ring).into_iter().filter(|pair| pair.seen && held(&pair.middle));
    [
        pipes.filter(held).map(|place| ray(place, None)).collect(),
        between.map(|pair| ray(pair.middle, Some(pair.places))).collect(),
    ]
}

/// Rays across a row of pipes in a rectangle of some size, from wall to wall.
fn across(row: &PipeRing, size: DVec2, sampler: &Sampler<'_>) -> [Vec<Ray>; 2] {
    let direction = row.direction().perp();
    let half = 0.5 * sampler.lattice.spacing;
    let ray = |place: DVec2, pipes: Option<[DVec2; 2]>| {
        // Where the line enters and leaves the rectangle of the particles' centres, as distances from the place.
        let mut ends = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in (0..2).filter(|axis| direction[*axis].abs() > SAME) {
            let [a, b] = [half, size[axis] - half].map(|wall| (wall - place[axis]) / direction[axis]);
            ends = (ends.0.max(a.min(b)), ends.1.min(a.max(b)));
        }
        let count = ((ends.1 - ends.0) / half).ceil().max(1.0) as usize;
        let radii: Vec<f64> = (0..=count).map(|k| ends.0 + (ends.1 - ends.0) * k as f64 / count as f64).collect();
        let samples = radii.iter().map(|radius| sampler.sample(place + *radius * direction)).collect();
        Ray { multiplicity: 1, origin: place, direction, radii, samples, pipes }
    };
    let pipes = row.numbers().map(|k| ray(row.place(k), None)).collect();
    [pipes, following(row).into_iter().map(|pair| ray(pair.middle, Some(pair.places))).collect()]
}

/// Neighbours of a row, in order.
pub(crate) fn following(row: &PipeRing) -> Vec<Pair> {
    let numbers: Vec<usize> = row.numbers().collect();
    let pair = |numbers: &[usize]| {
        let places = [row.place(numbers[0]), row.place(numbers[1])];
        Pair { numbers: [numbers[0], numbers[1]], middle: 0.5 * (places[0] + places[1]), places, seen: true }
    };
    numbers.windows(2).map(pair).collect()
}

/// Neighbours of a ring, in order of the first of each pair.
pub(crate) fn pairs(ring: &PipeRing) -> Vec<Pair> {
    let numbers: Vec<usize> = ring.numbers().collect();
    let places: Vec<DVec2> = numbers.iter().map(|k| ring.place(*k)).collect();
    let pair = |ends: [usize; 2]| {
        let around = turn(places[ends[0]], places[ends[1]]);
        let [a, b] = if around < 0.0 { [ends[1], ends[0]] } else { ends };
        let (from, to) = (places[a], places[b]);
        let middle = 0.5 * (from + to);
        let radius = from.length();
        let on_circle = (radius - to.length()).abs() <= SAME * radius && middle.length() > SAME * radius;
        Pair {
            numbers: [numbers[a], numbers[b]],
            middle: if on_circle { radius * middle.normalize() } else { middle },
            places: [from, to],
            seen: around.abs() > SAME,
        }
    };
    let mut pairs: Vec<Pair> = neighbours(&places).into_iter().map(pair).collect();
    pairs.sort_by_key(|pair| pair.numbers);
    pairs
}
