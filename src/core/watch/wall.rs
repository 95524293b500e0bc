//! The frozen wall of a ring: neighbouring pipes, joined once a way between them is frozen through, the instant at which a closed wall stands around
//! the centre, and sections of it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::{Ray, Sample, Sampler};
use crate::ledger::Ledger;
use crate::material::FreezingLaw;
use crate::memory::Held;
use crate::particles::Particles;
use crate::pipe::Extent;
use crate::record::{LinkRow, PlaneRow};
use crate::scene::{Domain, Scene, Sector};

/// Two places that are the same, over the size of the plan.
const SAME_PLACE: f64 = 1e-9;

/// Bends of ways that are tried to either side of the straight one, at most.
const MOST_BENDS: f64 = 16.0;

/// Openness of a place that the tip of open ground between two frozen bodies is leaving, over the difference of openness one
/// spacing to either side of it, behind the tip and ahead: a tip is a parabola, as wide as the root of the distance from it, so with
/// it at the place the cell there holds the integral of the root from 0 to 1/2, and the next one that from 1/2 to 3/2.
const AT_A_TIP: f64 = 0.25;

/// Places that all have to freeze for a way through them to be frozen.
#[derive(Debug, Clone)]
pub(super) enum Way {
    /// The place half-way, likely to be the last, and the others.
    Through(Sample, Vec<Sample>),
    /// One place that a tip of open ground is leaving, and places a spacing to either side of it.
    Tip(Sample, [Sample; 2]),
}

impl Way {
    /// The greatest of a value along the way; less is not sought than a greatest value that is known.
    fn greatest(&self, known: f64, value: impl Fn(&Sample) -> f64) -> f64 {
        match self {
            Way::Through(gate, rest) => {
                let mut greatest = value(gate);
                for sample in rest {
                    if greatest >= known {
                        break;
                    }
                    greatest = greatest.max(value(sample));
                }
                greatest
            }
            Way::Tip(place, [before, behind]) => {
                let open = |sample: &Sample| value(sample).clamp(0.0, 1.0);
                value(place) - AT_A_TIP * (open(before) - open(behind)).abs()
            }
        }
    }
}

impl Held for Way {
    fn held(&self) -> usize {
        match self {
            Way::Through(gate, rest) => gate.held() + rest.held(),
            Way::Tip(place, beside) => place.held() + beside.iter().map(Held::held).sum::<usize>(),
        }
    }
}

/// Ways of which the first to freeze joins two frozen bodies.
#[derive(Debug, Clone, Default)]
pub(super) struct Joint {
    ways: Vec<Way>,
    /// Time and openness at the last look: positive while open.
    last: Option<(f64, f64)>,
    pub(super) closed: Option<f64>,
}

impl Joint {
    pub(super) fn new(ways: Vec<Way>) -> Self {
        Joint { ways, ..Joint::default() }
    }

    /// How far it is from being closed: positive while open.
    pub(super) fn openness(&self, value: impl Fn(&Sample) -> f64) -> f64 {
        self.ways.iter().fold(f64::INFINITY, |least, way| least.min(way.greatest(least, &value)))
    }

    /// Takes how far it is from being closed at a time. The instant of closing is interpolated between looks.
    pub(super) fn look(&mut self, time: f64, now: f64) {
        if now <= 0.0 {
            self.closed = Some(match self.last {
                Some((before, open)) if open > 0.0 => before + (time - before) * open / (open - now),
                _ => time,
            });
        }
        self.last = Some((time, now));
    }
}

impl Held for Joint {
    fn held(&self) -> usize {
        self.ways.held()
    }
}

/// Two neighbouring pipes.
#[derive(Debug, Clone)]
struct Link {
    /// Numbers among all pipes of all rings.
    ends: [usize; 2],
    /// Which joint tells of it.
    joint: usize,
    /// Which joint tells of the middle of the arc between both.
    arc: Option<usize>,
}

/// A pipe of the whole plan.
#[derive(Debug, Clone)]
struct Place {
    name: String,
    at: DVec2,
}

/// Neighbouring pipes and their joints.
#[derive(Debug, Clone, Default)]
pub(super) struct Wall {
    places: Vec<Place>,
    links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    /// Rings of pipes, as the wall around them is read.
    rings: Vec<Sunk>,
    /// Sections of the wall over time.
    pub(super) planes: Vec<PlaneRow>,
}

/// A ring of pipes sunk into particles.
#[derive(Debug, Clone, Default)]
struct Sunk {
    pipes: Vec<Extent>,
    /// Particles that the heat of its pipes is spread over.
    near: Vec<u32>,
}

impl Wall {
    /// The neighbouring pipes of a scene that asks for them.
    pub(super) fn of(scene: &Scene, sampler: &Sampler<'_>, pipes: &[Extent]) -> Self {
        let Domain::Ring { sector, .. } = scene.domain else { return Wall::default() };
        if !scene.watch.frozen_wall {
            return Wall::default();
        }
        let mut places = Vec::new();
        for (number, ring) in scene.rings.iter().enumerate() {
            let name = |k: usize| format!("{}.{}", number + 1, k + 1);
            places.extend(ring.numbers().map(|k| Place { name: name(k), at: ring.place(k) }));
        }
        let mut rings = vec![Sunk::default(); scene.rings.len()];
        for pipe in pipes {
            rings[pipe.ring].pipes.push(*pipe);
            let inside = |i: &u32| sampler.lattice.position(*i as usize).distance(pipe.centre) <= pipe.half_width;
            rings[pipe.ring].near.extend(pipe.particles(sampler.lattice).into_iter().filter(inside));
        }
        let mut wall = Wall { places, rings, ..Wall::default() };
        let mut lines: Vec<[DVec2; 2]> = Vec::new();
        let mut joints: Vec<(usize, Option<usize>)> = Vec::new();
        for ends in neighbours(&wall.places) {
            let line = folded(ends.map(|end| wall.places[end].at), sector);
            let same = |a: DVec2, b: DVec2| a.distance(b) <= SAME_PLACE * scene.domain.extent();
            let known = lines.iter().position(|other| {
                (same(line[0], other[0]) && same(line[1], other[1]))
                    || (same(line[0], other[1]) && same(line[1], other[0]))
            });
            let number = known.unwrap_or_else(|| {
                lines.push(line);
                let middle = 0.5 * (line[0] + line[1]);
                wall.joints.push(Joint::new(ways(line, sampler)));
                joints.push((wall.joints.len() - 1, None));
                if (line[0].length() - line[1].length()).abs() <= SAME_PLACE * scene.domain.extent() {
                    let outwards = middle.normalize_or_zero();
                    let arc = line[0].length() * outwards;
                    let step = sampler.lattice.spacing * outwards;
                    // Half frozen ground, by which other laws are judged, passes a place like any level.
                    let way = match scene.materials[0].law {
                        FreezingLaw::Isothermal => {
                            Way::Tip(sampler.sample(arc), [arc - step, arc + step].map(|place| sampler.sample(place)))
                        }
                        _ => Way::Through(sampler.sample(arc), Vec::new()),
                    };
                    wall.joints.push(Joint::new(vec![way]));
                    joints[lines.len() - 1].1 = Some(wall.joints.len() - 1);
                }
                lines.len() - 1
            });
            let (joint, arc) = joints[number];
            wall.links.push(Link { ends, joint, arc });
        }
        wall
    }

    /// Takes sections of the wall at a time: along the first rays through a pipe and between two, and of all that is frozen.
    pub(super) fn output(
        &mut self,
        rays: [&[Ray]; 2],
        scene: &Scene,
        particles: &Particles,
        ledger: &Ledger,
        time: f64,
    ) {
        if self.places.is_empty() {
            return;
        }
        let pipes = frozen_in(&self.rings, scene, particles, ledger, time);
        for (plane, ray) in ["main", "interface"].into_iter().zip(rays.map(<[Ray]>::first)) {
            let Some(ray) = ray else { continue };
            let fraction: Vec<f64> =
                ray.samples.iter().map(|sample| sample.of(|i| particles.frozen_fraction(i))).collect();
            let mut temperature: Vec<f64> =
                ray.samples.iter().map(|sample| sample.of(|i| particles.reading(i))).collect();
            pipes.iter().for_each(|ring| ring.sharpen(ray, &mut temperature));
            let face = particles.shaft.unwrap_or(0.0);
            let ends = ends(&ray.radii, &fraction).map(|(inner, outer)| (inner.max(face), outer));
            self.planes.push(PlaneRow {
                time_s: time,
                plane: plane.into(),
                inner_m: ends.map(|ends| ends.0),
                outer_m: ends.map(|ends| ends.1),
                mean_temperature_c: ends.and_then(|ends| mean(&ray.radii, &temperature, ends)),
            });
        }
        let area: f64 = pipes.iter().map(FrozenIn::area).sum();
        let excess: f64 = pipes.iter().map(FrozenIn::excess).sum();
        let frozen = particles.integral(|i| particles.frozen_fraction(i)) - area;
        let weighted = particles.integral(|i| particles.frozen_fraction(i) * particles.reading(i)) - excess;
        let mean_temperature_c = (frozen > 0.0).then(|| weighted / frozen);
        self.planes.push(PlaneRow {
            time_s: time,
            plane: "wall".into(),
            inner_m: None,
            outer_m: None,
            mean_temperature_c,
        });
    }

    /// All links, and when a closed wall stood around the centre.
    pub(super) fn rows(&self) -> (Vec<LinkRow>, Option<f64>) {
        let rows = self.links.iter().map(|link| {
            let [a, b] = link.ends.map(|end| &self.places[end]);
            let middle = 0.5 * (a.at + b.at);
            LinkRow {
                from: a.name.clone(),
                to: b.name.clone(),
                x_m: middle.x,
                y_m: middle.y,
                distance_m: a.at.distance(b.at),
                closure_s: self.joints[link.joint].closed,
                closure_on_circle_s: link.arc.and_then(|arc| self.joints[arc].closed),
            }
        });
        let joined = self.links.iter().filter_map(|link| Some((link.ends, self.joints[link.joint].closed?)));
        let places: Vec<DVec2> = self.places.iter().map(|place| place.at).collect();
        (rows.collect(), closure(&places, joined.collect()))
    }
}

/// Pipes of a ring in ground that is frozen around them. There the field of a pipe is that of a line sink,
/// `T = T_p + q/(2 pi k) ln(r/r_p)`, but particles hold a smoothed one, over the pipe too.
struct FrozenIn<'a> {
    pipes: &'a [Extent],
    /// Radius of the pipes (m); 0 of single particles.
    radius: f64,
    /// Temperature of their walls.
    temperature: f64,
    /// Heat that one of them takes over the conductivity of the ground (K).
    heat: f64,
}

/// Rings that cool ground which is frozen as far as the heat of their pipes is spread.
fn frozen_in<'a>(
    rings: &'a [Sunk],
    scene: &Scene,
    particles: &Particles,
    ledger: &Ledger,
    time: f64,
) -> Vec<FrozenIn<'a>> {
    let rings = rings.iter().zip(ledger.rings()).zip(&scene.rings);
    rings
        .filter_map(|((sunk, rate), ring)| {
            let first = *sunk.near.first()? as usize;
            let cools = rate < 0.0 && sunk.near.iter().all(|i| particles.frozen_fraction(*i as usize) >= 1.0);
            let pipe = ring.temperature.at(time);
            let share: f64 = sunk.pipes.iter().map(|pipe| pipe.share).sum();
            let conductivity = particles.materials.of(first).curve.conductivity(pipe);
            // Behind a film the wall is warmer than the brine.
            let film = ring.film.map_or(0.0, |film| 1.0 / (film * TAU * ring.pipe_radius));
            let pipe = pipe - rate / share * film;
            let heat = -rate / share / conductivity;
            cools.then_some(FrozenIn { pipes: &sunk.pipes, radius: ring.pipe_radius, temperature: pipe, heat })
        })
        .collect()
}

impl FrozenIn<'_> {
    fn share(&self) -> f64 {
        self.pipes.iter().map(|pipe| pipe.share).sum()
    }

    /// Area of the pipes (m2), in the sector.
    fn area(&self) -> f64 {
        self.share() * PI * self.radius * self.radius
    }

    /// By how much the integral of the temperature over all particles is greater than over the ground outside the pipes
    /// (K m2): what smoothing takes off the field, and what the field of a line has inside the pipes.
    fn excess(&self) -> f64 {
        let smoothed: f64 = self.pipes.iter().map(|pipe| pipe.share * pipe.smoothing).sum();
        let inside = self.area() * self.temperature - self.share() * 0.25 * self.heat * self.radius * self.radius;
        self.heat * smoothed + inside
    }

    /// Puts pipes and the field around them where readings along a ray through their axes are smoothed.
    fn sharpen(&self, ray: &Ray, temperature: &mut [f64]) {
        for pipe in self.pipes.iter().filter(|_| self.radius > 0.0) {
            let axis = pipe.centre.dot(ray.direction);
            if axis <= 0.0 || pipe.centre.distance(axis * ray.direction) > SAME_PLACE * axis {
                continue;
            }
            // Beyond the particles that the heat is spread over the field is that of a line.
            for side in [-1.0, 1.0] {
                let far = |radius: f64| side * (radius - axis) >= pipe.half_width;
                let edge = match side < 0.0 {
                    true => ray.radii.iter().rposition(|radius| far(*radius)),
                    false => ray.radii.iter().position(|radius| far(*radius)),
                };
                let Some(edge) = edge else { continue };
                let width = (ray.radii[edge] - axis).abs();
                let slope = (temperature[edge] - self.temperature) / (width / self.radius).ln();
                for (radius, temperature) in ray.radii.iter().zip(temperature.iter_mut()) {
                    let distance = side * (radius - axis);
                    if (0.0..width).contains(&distance) {
                        *temperature = self.temperature + slope * (distance / self.radius).ln().max(0.0);
                    }
                }
            }
        }
    }
}

/// Ways from one pipe to another: straight to a point half-way between both, and straight on.
fn ways([a, b]: [DVec2; 2], sampler: &Sampler<'_>) -> Vec<Way> {
    let step = 0.5 * sampler.lattice.spacing;
    let (middle, across) = (0.5 * (a + b), 0.5 * (b - a).perp());
    let count = (across.length() / step).ceil().min(MOST_BENDS) as i64;
    let leg = |from: DVec2, to: DVec2| {
        let pieces = (from.distance(to) / step).ceil() as i64;
        (0..pieces).map(move |k| from.lerp(to, k as f64 / pieces as f64))
    };
    let way = |bend: DVec2| {
        let rest = leg(bend, a).chain(leg(bend, b)).map(|place| sampler.sample(place)).collect();
        Way::Through(sampler.sample(bend), rest)
    };
    (-count..=count).map(|k| way(middle + k as f64 / count as f64 * across)).collect()
}

/// Pairs of pipes between which no other stands: none lies in the circle over the line between them. Pipes that see each
/// other across more than a quarter of the plan are no neighbours.
fn neighbours(places: &[Place]) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    for a in 0..places.len() {
        for b in a + 1..places.len() {
            let ends = [places[a].at, places[b].at];
            if turn(ends[0], ends[1]).abs() > FRAC_PI_2 + SAME_PLACE {
                continue;
            }
            let (middle, radius) = (0.5 * (ends[0] + ends[1]), 0.5 * ends[0].distance(ends[1]));
            let between = |k: usize| k != a && k != b && places[k].at.distance(middle) < radius * (1.0 - SAME_PLACE);
            if !(0..places.len()).any(between) {
                found.push([a, b]);
            }
        }
    }
    found
}

/// Angle from one place to another as seen from the centre, at most half a turn.
fn turn(from: DVec2, to: DVec2) -> f64 {
    let angle = to.to_angle() - from.to_angle();
    angle - TAU * (angle / TAU).round()
}

/// A line's image in a sector, by the mirrors that bring its middle there.
fn folded(line: [DVec2; 2], sector: Sector) -> [DVec2; 2] {
    let middle = 0.5 * (line[0] + line[1]);
    let flip = DVec2::new(
        if sector == Sector::Quarter && middle.x < 0.0 { -1.0 } else { 1.0 },
        if sector != Sector::Whole && middle.y < 0.0 { -1.0 } else { 1.0 },
    );
    line.map(|place| place * flip)
}

/// When links that join one after the other first make a loop around the centre.
fn closure(places: &[DVec2], mut joined: Vec<([usize; 2], f64)>) -> Option<f64> {
    joined.sort_by(|a, b| a.1.total_cmp(&b.1));
    // Groups of joined pipes: each pipe's next towards the head of its group, and the angle to it.
    let mut heads: Vec<(usize, f64)> = (0..places.len()).map(|k| (k, 0.0)).collect();
    fn head(heads: &[(usize, f64)], mut at: usize) -> (usize, f64) {
        let mut angle = 0.0;
        while heads[at].0 != at {
            angle += heads[at].1;
            at = heads[at].0;
        }
        (at, angle)
    }
    for ([a, b], time) in joined {
        let (from, to) = (head(&heads, a), head(&heads, b));
        let around = turn(places[a], places[b]) + to.1 - from.1;
        if from.0 != to.0 {
            heads[from.0] = (to.0, around);
        } else if around.abs() > PI {
            return Some(time);
        }
    }
    None
}

/// First and last radius at which a ray is frozen; none where nothing is.
fn ends(radii: &[f64], fraction: &[f64]) -> Option<(f64, f64)> {
    let first = fraction.iter().position(|f| *f >= 0.5)?;
    let last = fraction.iter().rposition(|f| *f >= 0.5)?;
    let between = |a: usize, b: usize| {
        let part = (0.5 - fraction[a]) / (fraction[b] - fraction[a]);
        radii[a] + part * (radii[b] - radii[a])
    };
    let inner = if first == 0 { radii[0] } else { between(first - 1, first) };
    let outer = if last + 1 == radii.len() { radii[last] } else { between(last, last + 1) };
    Some((inner, outer))
}

/// Mean of what is read along a ray between two radii.
fn mean(radii: &[f64], values: &[f64], (inner, outer): (f64, f64)) -> Option<f64> {
    let inside: Vec<f64> = radii
        .iter()
        .zip(values)
        .filter(|(radius, _)| (inner..=outer).contains(*radius))
        .map(|(_, value)| *value)
        .collect();
    (!inside.is_empty()).then(|| inside.iter().sum::<f64>() / inside.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: usize, radius: f64, first: f64) -> Vec<Place> {
        let at = |k: usize| radius * DVec2::from_angle(first + TAU * k as f64 / count as f64);
        (0..count).map(|k| Place { name: k.to_string(), at: at(k) }).collect()
    }

    #[test]
    fn neighbours_of_a_ring_are_those_beside_each_other() {
        for count in [4, 5, 26] {
            let mut found = neighbours(&ring(count, 5.0, 0.1));
            found.sort();
            let mut expected: Vec<_> = (0..count).map(|k| [k.min((k + 1) % count), k.max((k + 1) % count)]).collect();
            expected.sort();
            assert_eq!(found, expected);
        }
        // Two staggered rings: each ring's own, and twice as many between them.
        let mut both = ring(26, 5.0, 0.0);
        both.extend(ring(26, 4.2, PI / 26.0));
        let between = |pair: &&[usize; 2]| (pair[0] < 26) != (pair[1] < 26);
        let found = neighbours(&both);
        assert_eq!(found.iter().filter(between).count(), 52);
    }

    #[test]
    fn a_wall_is_closed_once_a_loop_runs_around_the_centre() {
        let places: Vec<DVec2> = ring(6, 5.0, 0.0).iter().map(|place| place.at).collect();
        let around: Vec<_> = (0..6).map(|k| ([k, (k + 1) % 6], k as f64)).collect();
        assert_eq!(closure(&places, around.clone()), Some(5.0));
        assert_eq!(closure(&places, around[..5].to_vec()), None);
        // A loop beside the centre is none around it.
        let mut beside = places.clone();
        beside.extend([DVec2::new(6.0, 0.0), DVec2::new(6.0, 1.0)]);
        assert_eq!(closure(&beside, vec![([0, 6], 1.0), ([6, 7], 2.0), ([7, 0], 3.0)]), None);
    }

    #[test]
    fn ends_lie_between_samples() {
        let radii = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(ends(&radii, &[0.0, 1.0, 1.0, 0.0]), Some((1.5, 3.5)));
        assert_eq!(ends(&radii, &[0.0; 4]), None);
        assert_eq!(ends(&radii, &[1.0, 0.0, 0.0, 1.0]), Some((1.0, 4.0)));
    }
}
