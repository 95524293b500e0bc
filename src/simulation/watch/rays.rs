//! Planes through the wall of the first ring of pipes: rays through its pipes and between neighbours, and the gaps there.

use std::f64::consts::TAU;

use frazil_core::particles::Particles;
use frazil_core::space::domain::Domain;
use frazil_scene::{PipeRing, Scene};
use glam::DVec2;

use super::loops::{SAME, neighbours, turn};
use super::wall::{Joint, Way};
use super::{Sample, Sampler};

/// A ray of evenly spaced samples.
#[derive(Debug, Clone)]
pub(super) struct Ray {
    /// How many rays of the whole ring it stands for.
    pub(super) multiplicity: usize,
    pub(super) direction: DVec2,
    pub(super) radii: Vec<f64>,
    pub(super) samples: Vec<Sample>,
}

/// A gap between two pipes and whether it has closed.
#[derive(Debug, Clone)]
pub(super) struct Gap {
    pub(super) number: usize,
    /// Names of its pipes.
    pub(super) ends: [String; 2],
    pub(super) angle: f64,
    pub(super) multiplicity: usize,
    pub(super) joint: Joint,
}

/// Rays and gaps of the first ring, those of the part of the plan that is run.
#[derive(Debug, Clone, Default)]
pub(super) struct Planes {
    /// Rays through the pipes that are there.
    pub(super) main: Vec<Ray>,
    /// Rays between neighbours.
    pub(super) interface: Vec<Ray>,
    pub(super) gaps: Vec<Gap>,
}

/// Two neighbours of a ring, anticlockwise as the centre sees them.
pub(crate) struct Pair {
    numbers: [usize; 2],
    /// Where the arc between them is half-way, or else the line (m).
    middle: DVec2,
    /// Outwards, across the line between them.
    across: DVec2,
    distance: f64,
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
        self.numbers.map(|k| format!("1.{}", k + 1))
    }

    /// Angle of the middle between them, from 0 to a turn.
    pub(crate) fn angle(&self) -> f64 {
        self.middle.to_angle().rem_euclid(TAU)
    }
}

/// The planes of a scene. Walls are measured on the first ring; others are part of the layout around it.
pub(super) fn planes(scene: &Scene, sampler: &Sampler<'_>) -> Planes {
    let (Domain::Ring { outer_radius: outer, sector }, Some(ring)) = (&scene.domain, scene.rings.first()) else {
        return Planes::default();
    };
    let (outer, spacing) = (*outer, sampler.lattice.spacing);
    let angle = |place: DVec2| place.to_angle().rem_euclid(TAU);
    let ray = |place: DVec2| {
        let count = ((outer - spacing) / (0.5 * spacing)).ceil().max(1.0) as usize;
        let radii: Vec<f64> = (0..=count).map(|k| (outer - spacing) * k as f64 / count as f64).collect();
        let direction = place.normalize_or_zero();
        let samples = radii.iter().map(|radius| sampler.sample(direction * *radius)).collect();
        Ray { multiplicity: sector.multiplicity(angle(place)), direction, radii, samples }
    };
    let mut planes = Planes::default();
    let off_centre = |place: &DVec2| place.length() > SAME * outer;
    let held = |place: DVec2| sector.holds(angle(place));
    let pipes = ring.numbers().map(|k| ring.place(k)).filter(off_centre);
    planes.main.extend(pipes.filter(|place| held(*place)).map(ray));
    for pair in pairs(ring).into_iter().filter(|pair| held(pair.middle)) {
        if pair.seen {
            planes.interface.push(ray(pair.middle));
        }
        // Columns meet a little inside the ring; look where they can.
        let (from, to) = (-0.5 * pair.distance, 0.3 * pair.distance);
        let count = ((to - from) / (0.25 * spacing)).ceil().max(1.0) as usize;
        let places = (0..=count).map(|k| pair.middle + (from + (to - from) * k as f64 / count as f64) * pair.across);
        // Not beyond the centre, nor the outer wall.
        let near = places.filter(|place| place.length() <= outer && place.dot(pair.middle) >= 0.0);
        let ways = near.map(|place| Way::Through(sampler.sample(place), Vec::new())).collect();
        planes.gaps.push(Gap {
            number: pair.first(),
            ends: pair.names(),
            angle: pair.angle(),
            multiplicity: sector.multiplicity(pair.angle()),
            joint: Joint::new(ways),
        });
    }
    planes
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
        let (radius, distance) = (from.length(), from.distance(to));
        let on_circle = (radius - to.length()).abs() <= SAME * radius && middle.length() > SAME * radius;
        let across = (from - to).perp().normalize_or_zero();
        Pair {
            numbers: [numbers[a], numbers[b]],
            middle: if on_circle { radius * middle.normalize() } else { middle },
            across: if across.dot(middle) < 0.0 { -across } else { across },
            distance,
            seen: around.abs() > SAME,
        }
    };
    let mut pairs: Vec<Pair> = neighbours(&places).into_iter().map(pair).collect();
    pairs.sort_by_key(|pair| pair.numbers);
    pairs
}

/// Frozen length of a ray: the integral of the frozen fraction along it (m).
pub(super) fn frozen_length(ray: &Ray, particles: &Particles) -> f64 {
    let fractions: Vec<f64> = ray.samples.iter().map(|sample| sample.of(|i| particles.frozen_fraction(i))).collect();
    let step = ray.radii[1] - ray.radii[0];
    step * (fractions.iter().sum::<f64>() - 0.5 * (fractions[0] + fractions[fractions.len() - 1]))
}
