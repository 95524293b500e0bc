//! The frozen wall of a ring: neighbouring pipes, joined once a way between them is frozen through, when a closed wall stands around
//! the centre and how thick it is where it is weakest, and sections of it.

use frazil_core::boundary::pipe::Extent;
use frazil_core::ledger::Ledger;
use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::{LinkRow, PlaneRow, WallRecord};
use frazil_scene::Scene;
use glam::DVec2;

use super::loops::{closure, neighbours};
use super::passage::{Passage, PassageFinder};
use super::standing::Standing;
use super::sunk::{FrozenIn, Sunk, frozen_in};
use super::{Ray, Sample, Sampler};

/// Two places that are the same, over the size of the plan.
pub(super) const SAME_PLACE: f64 = 1e-9;

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

impl HeapSize for Way {
    fn heap_size(&self) -> usize {
        match self {
            Way::Through(gate, rest) => gate.heap_size() + rest.heap_size(),
            Way::Tip(place, beside) => place.heap_size() + beside.iter().map(HeapSize::heap_size).sum::<usize>(),
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

impl HeapSize for Joint {
    fn heap_size(&self) -> usize {
        self.ways.heap_size()
    }
}

/// Two neighbouring pipes.
#[derive(Debug, Clone)]
struct Link {
    /// Numbers among all pipes of all rings.
    ends: [usize; 2],
    /// Which joint tells of it.
    joint: usize,
    /// Its line in the part of the plan that is run.
    line: usize,
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
    /// Lines between pipes, as mirrors bring them into the part of the plan that is run.
    lines: Vec<[DVec2; 2]>,
    pub(super) joints: Vec<Joint>,
    /// Rings of pipes, as the wall around them is read.
    rings: Vec<Sunk>,
    /// Sections of the wall over time.
    pub(super) planes: Vec<PlaneRow>,
    /// What finds the least frozen way through it.
    finder: PassageFinder,
    /// Whether its ground freezes at one temperature.
    sharp: bool,
    standing: Standing,
    /// The wall where it is weakest, at the last output.
    weakest: Option<Weakest>,
}

/// The wall where it is weakest.
#[derive(Debug, Clone, PartialEq)]
struct Weakest {
    /// Number of the link between whose pipes it is weakest.
    link: usize,
    /// Frozen length on the least frozen way through it (m), and the mean temperature on it.
    thickness: f64,
    mean_temperature: Option<f64>,
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
        let sharp = scene.materials[0].is_sharp();
        let finder = PassageFinder::over(sampler.lattice);
        let mut wall = Wall { places, rings, finder, sharp, ..Wall::default() };
        let stand: Vec<DVec2> = wall.places.iter().map(|place| place.at).collect();
        let mut joints: Vec<(usize, Option<usize>)> = Vec::new();
        for ends in neighbours(&stand) {
            let line = folded(ends.map(|end| wall.places[end].at), sector);
            let same = |a: DVec2, b: DVec2| a.distance(b) <= SAME_PLACE * scene.domain.extent();
            let known = wall.lines.iter().position(|other| {
                (same(line[0], other[0]) && same(line[1], other[1]))
                    || (same(line[0], other[1]) && same(line[1], other[0]))
            });
            let number = known.unwrap_or_else(|| {
                wall.lines.push(line);
                let middle = 0.5 * (line[0] + line[1]);
                wall.joints.push(Joint::new(ways(line, sampler)));
                joints.push((wall.joints.len() - 1, None));
                if (line[0].length() - line[1].length()).abs() <= SAME_PLACE * scene.domain.extent() {
                    let outwards = middle.normalize_or_zero();
                    let arc = line[0].length() * outwards;
                    let step = sampler.lattice.spacing * outwards;
                    // Half frozen ground, by which other laws are judged, passes a place like any level.
                    let way = match sharp {
                        true => {
                            Way::Tip(sampler.sample(arc), [arc - step, arc + step].map(|place| sampler.sample(place)))
                        }
                        false => Way::Through(sampler.sample(arc), Vec::new()),
                    };
                    wall.joints.push(Joint::new(vec![way]));
                    joints[wall.lines.len() - 1].1 = Some(wall.joints.len() - 1);
                }
                wall.lines.len() - 1
            });
            let (joint, arc) = joints[number];
            wall.links.push(Link { ends, joint, line: number, arc });
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
                from: String::new(),
                to: String::new(),
            });
        }
        let area: f64 = pipes.iter().map(FrozenIn::area).sum();
        let excess: f64 = pipes.iter().map(FrozenIn::excess).sum();
        let frozen = particles.integral(|i| particles.frozen_fraction(i)) - area;
        let weighted = particles.integral(|i| particles.frozen_fraction(i) * particles.frozen_reading(i)) - excess;
        let mean_temperature_c = (frozen > 0.0).then(|| weighted / frozen);
        self.planes.push(PlaneRow {
            time_s: time,
            plane: "wall".into(),
            inner_m: None,
            outer_m: None,
            mean_temperature_c,
            from: String::new(),
            to: String::new(),
        });
    }

    /// Takes the wall where it is weakest at a time: whether it stands closed, and how thick it is (m); none where it is not watched.
    pub(super) fn stand(&mut self, particles: &Particles, time: f64) -> Option<(bool, f64)> {
        if self.places.is_empty() {
            return None;
        }
        let mut row = PlaneRow { time_s: time, plane: "weakest".into(), ..PlaneRow::default() };
        // Until its pipes have joined all around, the wall is open whatever else is frozen.
        let joined = self.joined();
        if let Some(joined) = joined {
            let mut passage = self.finder.passage(particles, self.sharp);
            self.standing.look(time, passage.thickness, joined);
            let link = self.crossed(&passage, joined);
            // Of ways that are as short, the lattice picks now one and now another: straight through the gap it is the warmest.
            if let Some(through) = link.map(|link| self.middle(link)).filter(|at| self.is_weakest(*at, &passage)) {
                passage.mean_temperature = self.finder.mean_along(particles, through);
            }
            (row.inner_m, row.outer_m) = (passage.ends.map(|ends| ends.0), passage.ends.map(|ends| ends.1));
            row.mean_temperature_c = passage.mean_temperature;
            self.weakest = link.map(|link| Weakest {
                link,
                thickness: passage.thickness,
                mean_temperature: passage.mean_temperature,
            });
        }
        if let Some(link) = self.weakest.as_ref().map(|weakest| weakest.link).or_else(|| self.widest_open()) {
            let [from, to] = self.links[link].ends.map(|end| self.places[end].name.clone());
            (row.from, row.to) = (from, to);
        }
        self.planes.push(row);
        let thickness = self.weakest.as_ref().map_or(0.0, |weakest| weakest.thickness);
        Some((self.standing.stands(), thickness))
    }

    /// When the frozen bodies of its pipes joined all around the centre (s).
    fn joined(&self) -> Option<f64> {
        let joined = self.links.iter().filter_map(|link| Some((link.ends, self.joints[link.joint].closed?)));
        let places: Vec<DVec2> = self.places.iter().map(|place| place.at).collect();
        closure(&places, joined.collect())
    }

    /// The link that was last to close the wall, at this time.
    fn last_to_close(&self, joined: f64) -> Option<usize> {
        self.links.iter().position(|link| self.joints[link.joint].closed == Some(joined))
    }

    /// The widest of the links that have not closed; of those as wide the first.
    fn widest_open(&self) -> Option<usize> {
        let open = (0..self.links.len()).filter(|link| self.joints[self.links[*link].joint].closed.is_none());
        open.reduce(|best, link| if self.width(link) > (1.0 + SAME_PLACE) * self.width(best) { link } else { best })
    }

    /// The middle of a link (m).
    fn middle(&self, link: usize) -> DVec2 {
        let [a, b] = self.lines[self.links[link].line];
        0.5 * (a + b)
    }

    /// Whether a closed wall is hardly thicker straight through a place than where it is weakest.
    fn is_weakest(&self, through: DVec2, passage: &Passage) -> bool {
        let least = passage.thickness;
        least > 0.0 && self.finder.along(through) <= least + 0.5 * self.finder.spacing()
    }

    /// Distance of the pipes of a link (m).
    fn width(&self, link: usize) -> f64 {
        let [a, b] = self.links[link].ends.map(|end| self.places[end].at);
        a.distance(b)
    }

    /// The link between whose pipes a way goes. Where the wall is hardly thicker at the link that was last to close it, that one: by how
    /// they lie to the lattice, places that are alike differ by less than half a spacing.
    fn crossed(&self, passage: &Passage, joined: f64) -> Option<usize> {
        let last = self.last_to_close(joined);
        if let Some(last) = last.filter(|last| self.is_weakest(self.middle(*last), passage)) {
            return Some(last);
        }
        let off = |link: &Link| {
            let [a, b] = self.lines[link.line];
            passage.places.iter().map(|place| from_segment(*place, a, b)).fold(f64::INFINITY, f64::min)
        };
        let near: Vec<f64> = self.links.iter().map(off).collect();
        let least = near.iter().copied().fold(f64::INFINITY, f64::min).max(self.finder.spacing());
        // A way through several rings crosses a link of each: the last of them to close is the weakest.
        let closed = |link: usize| self.joints[self.links[link].joint].closed.unwrap_or(f64::INFINITY);
        let crossed = (0..self.links.len()).filter(|link| near[*link] <= least);
        crossed.reduce(|best, link| if closed(link) > closed(best) { link } else { best })
    }

    /// All links.
    pub(super) fn rows(&self) -> Vec<LinkRow> {
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
        rows.collect()
    }

    /// What has become of the wall; none where it was not watched.
    pub(super) fn record(&self) -> Option<WallRecord> {
        if self.places.is_empty() {
            return None;
        }
        let named = |link: usize| self.links[link].ends.map(|end| self.places[end].name.clone());
        let link = self.weakest.as_ref().map(|weakest| weakest.link).or_else(|| self.widest_open());
        let periods = &self.standing.periods;
        Some(WallRecord {
            closed: self.standing.stands(),
            closure_s: periods.first().map(|period| period.0),
            reopening_s: periods.first().and_then(|period| period.1),
            standing_s: periods.clone(),
            thickness_m: self.weakest.as_ref().map_or(0.0, |weakest| weakest.thickness),
            mean_temperature_c: self.weakest.as_ref().and_then(|weakest| weakest.mean_temperature),
            weakest_gap: link.map(named),
            last_gap: self.joined().and_then(|joined| self.last_to_close(joined)).map(named),
        })
    }
}

impl HeapSize for Wall {
    fn heap_size(&self) -> usize {
        self.joints.iter().map(HeapSize::heap_size).sum::<usize>() + self.finder.heap_size()
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

/// A line's image in a sector, by the mirrors that bring its middle there.
fn folded(line: [DVec2; 2], sector: Sector) -> [DVec2; 2] {
    let middle = 0.5 * (line[0] + line[1]);
    let flip = DVec2::new(
        if sector == Sector::Quarter && middle.x < 0.0 { -1.0 } else { 1.0 },
        if sector != Sector::Whole && middle.y < 0.0 { -1.0 } else { 1.0 },
    );
    line.map(|place| place * flip)
}

/// Distance (m) of a place from the segment between two others.
fn from_segment(place: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = ((place - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
    place.distance(a.lerp(b, along))
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

    #[test]
    fn ends_lie_between_samples() {
        let radii = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(ends(&radii, &[0.0, 1.0, 1.0, 0.0]), Some((1.5, 3.5)));
        assert_eq!(ends(&radii, &[0.0; 4]), None);
        assert_eq!(ends(&radii, &[1.0, 0.0, 0.0, 1.0]), Some((1.0, 4.0)));
    }
}
