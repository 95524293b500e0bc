//! The frozen wall of a ring: neighbouring pipes, joined once a way between them is frozen through, when a closed wall stands around
//! the centre and how thick it is where it is weakest, and sections of it.

use crate::recorded::Recorded;
use frazil_core::memory::total;
use frazil_core::saved::{Pass, Saved};
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::segment::distance;
use frazil_record::{LinkRow, PlaneRow, RunResult, WallRecord, WallRow};
use frazil_scene::{PipeName, Scene};
use glam::DVec2;

use super::alike::first_alike;
use super::joint::Joint;
use super::lengths::{Across, excess_between, mean_length};
use super::loops::{closure, neighbours};
use super::observer::{Cadence, End, Made, Moment, Observer, Schedule, Setup, View, room};
use super::passage::{Passage, PassageFinder};
use super::rays::{Ray, rays};
use super::readings::{SAME_PLACE, Way, is_same, is_sharp};
use super::sampler::{Sample, Sampler};
use super::section::{ends, mean, narrowed, refined};
use super::standing::Standing;
use super::sunk::{FrozenIn, Sunk, frozen_in};

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
    /// The first of the links that symmetry makes equal to it.
    alike: usize,
}

/// A pipe of the whole plan.
#[derive(Debug, Clone)]
struct Place {
    name: PipeName,
    at: DVec2,
}

/// Rays through the wall of the first ring, and neighbouring pipes and their joints.
struct Wall {
    /// Lines through its pipes and between them.
    across: [Vec<Across>; 2],
    /// The first ray of each kind, on which sections are taken.
    rays: [Option<Ray>; 2],
    /// Pipes of the whole plan, and how often the part that is run is in it.
    pipe_count: usize,
    images: f64,
    rows: Vec<WallRow>,
    cadence: Cadence,
    places: Vec<Place>,
    links: Vec<Link>,
    /// Lines between pipes, as mirrors bring them into the part of the plan that is run.
    lines: Vec<[DVec2; 2]>,
    /// By how much frozen ground across the middle of each is read as too long, the ways there, and a strip there, in cells of the finder.
    excesses: Vec<(Sample, [Sample; 2], Sample)>,
    joints: Vec<Joint>,
    /// Rings of pipes, as the wall around them is read.
    rings: Vec<Sunk>,
    /// Sections of the wall over time.
    planes: Vec<PlaneRow>,
    /// What finds the least frozen way through it.
    finder: PassageFinder,
    /// Whether its ground freezes at one temperature.
    sharp: bool,
    standing: Standing,
    /// The wall where it is weakest, at the last output.
    weakest: Option<Weakest>,
}

/// The wall where it is weakest.
#[derive(Debug, Clone, Default, PartialEq)]
struct Weakest {
    /// Number of the link between whose pipes it is weakest.
    link: usize,
    /// Frozen length on the least frozen way through it (m), and the mean temperature on it.
    thickness: f64,
    mean_temperature: Option<f64>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, sampler, outputs) = (setup.scene, setup.sampler(), setup.outputs());
    let sector = match scene.domain {
        Domain::Ring { sector, .. } => sector,
        Domain::Rectangle { .. } => Sector::Whole,
        _ => return None,
    };
    let rays = rays(scene, &sampler);
    let across = |ray: &Ray| Across::along(ray, setup, &sampler);
    let mut wall = Wall {
        pipe_count: scene.rings.iter().map(|ring| ring.numbers().count()).sum(),
        images: setup.images(),
        rows: Vec::with_capacity(outputs),
        across: rays.each_ref().map(|rays| rays.iter().map(across).collect()),
        rays: rays.map(|rays| rays.into_iter().next()),
        cadence: Cadence::of(scene),
        places: Vec::new(),
        links: Vec::new(),
        lines: Vec::new(),
        excesses: Vec::new(),
        joints: Vec::new(),
        rings: Vec::new(),
        planes: Vec::new(),
        finder: PassageFinder::default(),
        sharp: is_sharp(scene),
        standing: Standing::default(),
        weakest: None,
    };
    if scene.watch.frozen_wall {
        wall.link(setup, sector, &sampler);
        wall.planes.reserve_exact(4 * outputs);
    }
    (wall.pipe_count > 0).then(|| Box::new(wall) as _)
}

impl Wall {
    /// Watches neighbouring pipes.
    fn link(&mut self, setup: &Setup<'_>, sector: Sector, sampler: &Sampler<'_>) {
        let scene = setup.scene;
        for (number, ring) in scene.rings.iter().enumerate() {
            let place = |k: usize| Place { name: PipeName { ring: number, pipe: k }, at: ring.place(k) };
            self.places.extend(ring.numbers().map(place));
        }
        self.rings = vec![Sunk::default(); scene.rings.len()];
        for sink in setup.pipes {
            let pipe = &sink.extent;
            self.rings[pipe.ring].pipes.push(sink.clone());
            let inside = |i: &u32| sampler.lattice.position(*i as usize).distance(pipe.centre) <= pipe.half_width;
            self.rings[pipe.ring].near.extend(pipe.particles(sampler.lattice).into_iter().filter(inside));
        }
        self.finder = PassageFinder::over(sampler.lattice);
        let stand: Vec<DVec2> = self.places.iter().map(|place| place.at).collect();
        let mut joints: Vec<(usize, Option<usize>)> = Vec::new();
        for ends in neighbours(&stand) {
            let line = folded(ends.map(|end| self.places[end].at), sector);
            let known = self.lines.iter().position(|other| is_same(line, *other, scene));
            let number = known.unwrap_or_else(|| {
                self.lines.push(line);
                let middle = 0.5 * (line[0] + line[1]);
                let across = (line[1] - line[0]).perp().normalize_or(DVec2::X);
                let excess = self.finder.in_cells(&excess_between(line, sampler), sampler);
                self.excesses.push((excess, self.finder.both_ways(middle, across), self.finder.strip(middle)));
                self.joints.push(Joint::between(line, setup, sampler));
                joints.push((self.joints.len() - 1, None));
                if (line[0].length() - line[1].length()).abs() <= SAME_PLACE * scene.domain.extent() {
                    let outwards = middle.normalize_or_zero();
                    let arc = line[0].length() * outwards;
                    let step = sampler.lattice.spacing * outwards;
                    // Half frozen ground, by which other laws are judged, passes a place like any level.
                    let way = match self.sharp {
                        true => {
                            Way::Tip(sampler.sample(arc), [arc - step, arc + step].map(|place| sampler.sample(place)))
                        }
                        false => Way::Through(sampler.sample(arc), Vec::new()),
                    };
                    self.joints.push(Joint::at(way, self.sharp));
                    joints[self.lines.len() - 1].1 = Some(self.joints.len() - 1);
                }
                self.lines.len() - 1
            });
            let (joint, arc) = joints[number];
            self.links.push(Link { ends, joint, line: number, arc, alike: self.links.len() });
        }
        self.compare(scene);
    }

    /// Finds links that symmetry makes equal.
    fn compare(&mut self, scene: &Scene) {
        let places: Vec<_> = self.places.iter().map(|place| (place.name.ring, place.at)).collect();
        let ends: Vec<_> = self.links.iter().map(|link| link.ends).collect();
        for (link, first) in self.links.iter_mut().zip(first_alike(scene, &places, &ends)) {
            link.alike = first;
        }
    }

    /// When the frozen bodies of a link joined (s).
    fn own_closure(&self, link: usize) -> Option<f64> {
        self.joints[self.links[link].joint].closed
    }

    /// Links that symmetry makes equal to one, itself among them.
    fn alike(&self, link: usize) -> impl Iterator<Item = usize> {
        let first = self.links[link].alike;
        (0..self.links.len()).filter(move |other| self.links[*other].alike == first)
    }

    /// When a link closed (s): the mean over those that symmetry makes equal to it, whose bodies join at different times by how they
    /// lie to the lattice alone; none before all have.
    fn closed(&self, link: usize) -> Option<f64> {
        let closures: Option<Vec<f64>> = self.alike(link).map(|other| self.own_closure(other)).collect();
        closures.map(|closures| closures.iter().sum::<f64>() / closures.len() as f64)
    }

    /// Root mean square by which links that symmetry makes equal differ from their mean (s).
    fn spread(&self, link: usize) -> Option<f64> {
        let (mean, count) = (self.closed(link)?, self.alike(link).count());
        let squares = self.alike(link).filter_map(|other| Some((self.own_closure(other)? - mean).powi(2)));
        Some((squares.sum::<f64>() / count as f64).sqrt())
    }

    /// Takes sections of the wall at a time: along the first rays through a pipe and between two, and of all that is frozen.
    fn sections(&mut self, view: &View<'_>) {
        let (particles, fractions, time) = (view.particles, view.fractions(), view.time);
        let pipes = frozen_in(&self.rings, view.scene, particles, view.ledger, time);
        let planes = ["main", "interface"].into_iter().zip(&self.rays).zip(&self.across);
        for ((plane, ray), lines) in planes {
            let Some(ray) = ray else { continue };
            let fraction: Vec<f64> = ray.samples.iter().map(|sample| sample.of(|i| fractions[i])).collect();
            let face = particles.shaft.unwrap_or(0.0);
            let (_, excess) = lines[0].frozen(view);
            let ends = ends(&ray.radii, &fraction).and_then(|ends| narrowed(ends, excess));
            let ends = ends.map(|(inner, outer)| (inner.max(face), outer));
            let mean_temperature = |ends: (f64, f64)| {
                let temperature =
                    ray.samples.iter().map(|sample| sample.of(|i| particles.reading_by(i, || fractions[i])));
                let (radii, mut temperature) = refined(&ray.radii, &temperature.collect::<Vec<_>>());
                pipes.iter().for_each(|ring| ring.sharpen(ray.direction, &radii, &mut temperature));
                mean(&radii, &temperature, ends)
            };
            self.planes.push(PlaneRow {
                time_s: time,
                plane: plane.into(),
                inner_m: ends.map(|ends| ends.0),
                outer_m: ends.map(|ends| ends.1),
                mean_temperature_c: ends.and_then(mean_temperature),
                from: String::new(),
                to: String::new(),
            });
        }
        let area: f64 = pipes.iter().map(FrozenIn::area).sum();
        let excess: f64 = pipes.iter().map(FrozenIn::excess).sum();
        let frozen = view.frozen() - area;
        let weight = |i: usize| match fractions[i] {
            0.0 => 0.0,
            fraction => fraction * particles.frozen_reading(i, || fraction),
        };
        let weighted = particles.integral_where(fractions, weight) - excess;
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

    /// Takes the wall where it is weakest at a time: whether it stands closed, and how thick it is (m); none where it is not watched
    /// or no pipes are neighbours.
    fn stand(&mut self, view: &View<'_>) -> Option<(bool, f64)> {
        if self.links.is_empty() {
            return None;
        }
        let (particles, time) = (view.particles, view.time);
        let mut row = PlaneRow { time_s: time, plane: "weakest".into(), ..PlaneRow::default() };
        // Until its pipes have joined all around, the wall is open whatever else is frozen.
        let joined = self.joined();
        if joined.is_none() {
            self.standing.is_open(time);
        }
        if let Some(joined) = joined {
            let mut passage = self.finder.passage(particles, view.fractions(), self.sharp);
            let link = self.crossed(&passage, joined);
            // Of ways that are as short, the lattice picks now one and now another: straight through the gap it is the warmest. The mean
            // is that over gaps that are alike, as are their closures.
            if let Some(link) = link.filter(|link| self.is_weakest(self.middle(*link), &passage)) {
                let times = |line| self.alike(link).filter(|other| self.links[*other].line == line).count();
                let strips = self.excesses.iter().enumerate().map(|(line, cells)| (&cells.2, times(line)));
                passage.mean_temperature = self.finder.mean_of(particles, strips.filter(|strip| strip.1 > 0));
            }
            passage.narrow(link.map_or(0.0, |link| self.excess(link, &passage)));
            self.standing.look(time, passage.barred.then_some(passage.thickness), joined);
            (row.inner_m, row.outer_m) = (passage.ends.map(|ends| ends.0), passage.ends.map(|ends| ends.1));
            row.mean_temperature_c = passage.mean_temperature;
            self.weakest = link.map(|link| Weakest {
                link,
                thickness: passage.thickness,
                mean_temperature: passage.mean_temperature,
            });
        }
        if let Some(link) = self.weakest.as_ref().map(|weakest| weakest.link).or_else(|| self.widest_open()) {
            let [from, to] = self.links[link].ends.map(|end| self.places[end].name.to_string());
            (row.from, row.to) = (from, to);
        }
        self.planes.push(row);
        let thickness = self.weakest.as_ref().map_or(0.0, |weakest| weakest.thickness);
        Some((self.standing.stands(), thickness))
    }

    /// When the frozen bodies of its pipes joined all around the centre (s).
    fn joined(&self) -> Option<f64> {
        // Of links that are alike the closure is found once.
        let closures: Vec<Option<f64>> = (0..self.links.len())
            .map(|link| if self.links[link].alike == link { self.closed(link) } else { None })
            .collect();
        let joined = self.links.iter().filter_map(|link| Some((link.ends, closures[link.alike]?)));
        let places: Vec<DVec2> = self.places.iter().map(|place| place.at).collect();
        closure(&places, joined.collect())
    }

    /// The link that was last to close the wall, at this time.
    fn last_to_close(&self, joined: f64) -> Option<usize> {
        (0..self.links.len()).find(|link| self.closed(*link) == Some(joined))
    }

    /// The widest of the links that have not closed; of those as wide the first.
    fn widest_open(&self) -> Option<usize> {
        let open = (0..self.links.len()).filter(|link| self.closed(*link).is_none());
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

    /// By how much the wall is read as too thick where a way through it crosses a link (m): nothing where straight across the middle of
    /// the link it is thicker by more than that. Means over links that symmetry makes equal to it.
    fn excess(&self, link: usize, passage: &Passage) -> f64 {
        let lines = self.alike(link).map(|other| &self.excesses[self.links[other].line]);
        let sums = lines.fold((0.0, 0.0), |sums, (excess, ways, _)| {
            (sums.0 + self.finder.sum(excess), sums.1 + self.finder.around(ways))
        });
        let count = self.alike(link).count() as f64;
        let (excess, straight) = (sums.0 / count, sums.1 / count);
        (excess - (straight - passage.thickness).max(0.0)).max(0.0)
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
            passage.places.iter().map(|place| distance((a, b), *place)).fold(f64::INFINITY, f64::min)
        };
        let near: Vec<f64> = self.links.iter().map(off).collect();
        let least = near.iter().copied().fold(f64::INFINITY, f64::min).max(self.finder.spacing());
        // A way through several rings crosses a link of each: the last of them to close is the weakest.
        let closed = |link: usize| self.closed(link).unwrap_or(f64::INFINITY);
        let crossed = (0..self.links.len()).filter(|link| near[*link] <= least);
        crossed.reduce(|best, link| if closed(link) > closed(best) { link } else { best })
    }

    /// Takes thicknesses, what is frozen and what a pipe takes.
    fn row(&mut self, view: &View<'_>, stand: Option<(bool, f64)>) {
        let length = |lines: &Vec<Across>| mean_length(lines, view);
        let [main, interface] = self.across.each_ref().map(length);
        let heat = 0.0 - view.ledger.rings().sum::<f64>();
        self.rows.push(WallRow {
            time_s: view.time,
            thickness_main_mean_m: main,
            thickness_main_mean_ref_m: None,
            thickness_interface_mean_m: interface,
            thickness_interface_mean_ref_m: None,
            frozen_area_m2: view.frozen() * self.images,
            frozen_area_ref_m2: None,
            heat_per_pipe_w_per_m: heat / (self.pipe_count as f64 / self.images),
            closed: stand.map(|(closed, _)| closed),
            thickness_weakest_m: stand.map(|(_, thickness)| thickness),
        });
    }

    /// All links.
    fn link_rows(&self) -> Vec<LinkRow> {
        let rows = self.links.iter().enumerate().map(|(number, link)| {
            let [a, b] = link.ends.map(|end| &self.places[end]);
            let middle = 0.5 * (a.at + b.at);
            LinkRow {
                from: a.name.to_string(),
                to: b.name.to_string(),
                x_m: middle.x,
                y_m: middle.y,
                distance_m: a.at.distance(b.at),
                closure_s: self.joints[link.joint].closed,
                closure_on_circle_s: link.arc.and_then(|arc| self.joints[arc].closed),
                alike: link.alike + 1,
                closure_alike_s: self.closed(number),
            }
        });
        rows.collect()
    }

    /// What has become of the wall; none where it was not watched or no pipes are neighbours.
    fn record(&self) -> Option<WallRecord> {
        if self.links.is_empty() {
            return None;
        }
        let named = |link: usize| self.links[link].ends.map(|end| self.places[end].name.to_string());
        let link = self.weakest.as_ref().map(|weakest| weakest.link).or_else(|| self.widest_open());
        let periods = &self.standing.periods;
        let last = self.joined().and_then(|joined| self.last_to_close(joined));
        Some(WallRecord {
            closed: self.standing.stands(),
            closure_s: self.standing.closure,
            reopening_s: periods.first().and_then(|period| period.1),
            standing_s: periods.clone(),
            thickness_m: self.weakest.as_ref().map_or(0.0, |weakest| weakest.thickness),
            mean_temperature_c: self.weakest.as_ref().and_then(|weakest| weakest.mean_temperature),
            weakest_gap: link.map(named),
            last_gap: last.map(named),
            last_gap_alike: last.map_or(0, |last| self.alike(last).count()),
            last_gap_spread_s: last.and_then(|last| self.spread(last)),
        })
    }
}

impl Saved for Weakest {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.link, &mut self.thickness, &mut self.mean_temperature]);
    }
}

impl Saved for Wall {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.joints.iter_mut().for_each(|joint| joint.pass(pass));
        pass.all(&mut [
            &mut Recorded(&mut self.rows),
            &mut Recorded(&mut self.planes),
            &mut self.cadence,
            &mut self.standing,
            &mut self.weakest,
        ]);
    }
}

impl Observer for Wall {
    fn schedule(&self) -> Schedule {
        let next = if self.joints.is_empty() { f64::INFINITY } else { self.cadence.next };
        Schedule { start: true, next, ..Schedule::OUTPUTS }
    }

    fn observe(&mut self, view: &View<'_>) {
        // At outputs too: a wall that is open there closes later.
        self.joints.iter_mut().for_each(|joint| joint.look(view));
        if !matches!(view.moment, Moment::Output { .. }) {
            self.cadence.seen(view.time);
            return;
        }
        let stand = self.stand(view);
        self.row(view, stand);
        if !self.places.is_empty() {
            self.sections(view);
        }
    }

    fn joints(&self) -> &[Joint] {
        &self.joints
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        (result.links, result.record.wall) = (self.link_rows(), self.record());
        (result.walls, result.planes) = (self.rows, self.planes);
    }

    fn held_at_the_end(&self) -> usize {
        let names = self.planes.capacity() * "interface".len();
        room(&self.rows)
            + room(&self.planes)
            + names
            + total(&[&self.rays, &self.across, &self.excesses, &self.joints, &self.finder])
    }
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
