//! The least frozen way through a wall: of all ways from the centre to the outer wall that with the least frozen ground on it. The
//! length of that ground is how thick the wall is where it is weakest, and nothing where a way leads through open ground.

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::space::lattice::Lattice;
use glam::DVec2;

use super::arrivals::{Arrivals, BARS, Way};
use super::sampler::{Sample, Sampler};
use super::section::narrowed;

/// A way through the wall.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Passage {
    /// Whether it leads through frozen ground; else through open ground from cell to cell, also across corners.
    pub(super) barred: bool,
    /// Frozen length on it (m); 0 where it is open.
    pub(super) thickness: f64,
    /// Where the frozen ground on the way begins and ends (m from the centre); none where the way is open.
    pub(super) ends: Option<(f64, f64)>,
    /// Mean temperature of the frozen ground on the way; none where it is open.
    pub(super) mean_temperature: Option<f64>,
    /// Where its frozen cells are, or all cells of an open way (m).
    pub(super) places: Vec<DVec2>,
}

impl Passage {
    /// Takes away what frozen ground on it is read as too long by (m).
    pub(super) fn narrow(&mut self, excess: f64) {
        self.thickness = (self.thickness - excess).max(0.0);
        self.ends = self.ends.and_then(|ends| narrowed(ends, excess));
    }
}

/// Finds ways over the cells of a plan. What it needs is kept from one time to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct PassageFinder {
    cells: Arrivals,
    /// Particle of each cell.
    particle: Vec<u32>,
    /// Distance of the outermost cell from the centre (m), and of the outermost that is frozen.
    outermost: f64,
    frozen: f64,
}

impl HeapSize for PassageFinder {
    fn heap_size(&self) -> usize {
        self.cells.heap_size() + self.particle.heap_size()
    }
}

impl PassageFinder {
    /// Over the cells of a lattice.
    pub(super) fn over(lattice: &Lattice) -> Self {
        let cells = Arrivals::over(lattice);
        let mut particle = vec![u32::MAX; cells.share.len()];
        for row in 0..lattice.rows {
            let numbers = lattice.start(row) as u32..lattice.start(row + 1) as u32;
            let at = cells.first(lattice.span(row).0, row);
            particle[at..].iter_mut().zip(numbers).for_each(|(particle, number)| *particle = number);
        }
        PassageFinder {
            particle,
            cells,
            outermost: lattice.positions().into_iter().map(DVec2::length).fold(0.0, f64::max),
            frozen: 0.0,
        }
    }

    /// The least frozen way through the ground as it is. `sharp`: ground freezes at one temperature, so that the frozen fraction of a
    /// cell is the part of it that is frozen; else what is half frozen bars a way, and a cell is cut where the fraction passes that.
    pub(super) fn passage(&mut self, particles: &Particles, fractions: &[f64], sharp: bool) -> Passage {
        self.read(particles, fractions, sharp);
        match self.cells.least_frozen(self.far()) {
            Way::Open(way) => self.open(&way),
            Way::Barred(way, thickness) => self.barred(particles, &way, thickness),
        }
    }

    /// What is read of particles, read of their cells.
    pub(super) fn in_cells(&self, sample: &Sample, sampler: &Sampler<'_>) -> Sample {
        let cell = |i: u32| self.cells.cell(sampler.place(i as usize)).map(|at| at as u32);
        Sample(sample.0.iter().filter_map(|(i, weight)| Some((cell(*i)?, *weight))).collect())
    }

    /// Sum over the frozen shares of cells, as the ground was at the last passage.
    pub(super) fn sum(&self, cells: &Sample) -> f64 {
        cells.of(|at| self.cells.share[at])
    }

    /// Size of a cell (m).
    pub(super) fn spacing(&self) -> f64 {
        self.cells.spacing
    }

    /// Frozen length outwards through a place (m), as the ground was at the last passage.
    pub(super) fn along(&self, through: DVec2) -> f64 {
        self.step() * self.straight(through).map(|at| self.cells.share[at]).sum::<f64>()
    }

    /// Cells from a place on straight in a direction and in the opposite one, with the length (m) of the way in each.
    pub(super) fn both_ways(&self, place: DVec2, direction: DVec2) -> [Sample; 2] {
        [1.0, -1.0].map(|sign| {
            let steps = (0..).map(|k| place + sign * (f64::from(k) + 0.5) * self.step() * direction);
            let mut cells: Vec<(u32, f64)> = Vec::new();
            for at in steps.map_while(|place| self.cells.cell(place)) {
                match cells.last_mut().filter(|last| last.0 == at as u32) {
                    Some(last) => last.1 += self.step(),
                    None => cells.push((at as u32, self.step())),
                }
            }
            Sample(cells)
        })
    }

    /// Frozen length (m) of the one body around a place on such ways, as the ground was at the last passage.
    pub(super) fn around(&self, ways: &[Sample; 2]) -> f64 {
        let share = |(at, length): &(u32, f64)| (self.cells.share[*at as usize], *length);
        // Where there is no cell the share is NaN, which is not frozen.
        let side = |way: &Sample| {
            let pieces = way.0.iter().map(share).take_while(|(share, _)| *share > 0.0);
            pieces.map(|(share, length)| share * length).sum::<f64>()
        };
        ways.iter().map(side).sum()
    }

    /// Cells of a strip from the centre outwards through a place, as wide as a cell, with how much of it is in each: a line is in now more
    /// and now less of the cells that it touches.
    pub(super) fn strip(&self, through: DVec2) -> Sample {
        let beside = self.step() * through.normalize_or(DVec2::X).perp();
        let lines = [-1.5, -0.5, 0.5, 1.5].map(|steps| self.steps_through(through + steps * beside));
        let mut cells: Vec<(u32, f64)> = lines.into_iter().flatten().map(|at| (at as u32, 1.0)).collect();
        cells.sort_unstable_by_key(|cell| cell.0);
        cells.dedup_by(|cell, kept| {
            let is_same = cell.0 == kept.0;
            kept.1 += if is_same { cell.1 } else { 0.0 };
            is_same
        });
        Sample(cells)
    }

    /// Mean temperature of the frozen ground of some strips together, each of which counts some times.
    pub(super) fn mean_of<'a>(
        &self,
        particles: &Particles,
        strips: impl Iterator<Item = (&'a Sample, usize)>,
    ) -> Option<f64> {
        let cells = |(strip, times): (&'a Sample, usize)| {
            strip.0.iter().map(move |(at, part)| (*at as usize, times as f64 * part))
        };
        self.mean(particles, strips.flat_map(cells))
    }

    /// Length of the steps of a straight way (m).
    fn step(&self) -> f64 {
        0.25 * self.cells.spacing
    }

    /// The cells straight outwards through a place, by steps.
    fn steps_through(&self, through: DVec2) -> impl Iterator<Item = usize> {
        let direction = through.normalize_or(DVec2::X);
        (0..).map_while(move |k: usize| self.cells.cell((k as f64 + 0.5) * self.step() * direction))
    }

    /// Those of them in which there is ground.
    fn straight(&self, through: DVec2) -> impl Iterator<Item = usize> {
        self.steps_through(through).take_while(|at| !self.cells.share[*at].is_nan())
    }

    /// Mean temperature of what is frozen of cells, each of which has a weight.
    fn mean(&self, particles: &Particles, cells: impl Iterator<Item = (usize, f64)>) -> Option<f64> {
        let (mut sum, mut weight) = (0.0, 0.0);
        // Where there is no ground the share is NaN, which is not frozen.
        for (at, own) in cells.filter(|(at, _)| self.cells.share[*at] > 0.0) {
            let (particle, frozen) = (self.particle[at] as usize, own * self.cells.share[at]);
            sum += frozen * particles.frozen_reading(particle, || particles.front_fraction(particle));
            weight += frozen;
        }
        (weight > 0.0).then(|| sum / weight)
    }

    /// Takes the frozen shares of all cells.
    fn read(&mut self, particles: &Particles, fractions: &[f64], sharp: bool) {
        self.frozen = match particles.cloud() {
            None => self.copy(&particles.lattice, fractions),
            Some(positions) => self.scatter(positions, fractions),
        };
        if !sharp {
            self.cells.cut_at_half();
        }
    }

    /// Takes the fractions of a lattice, row by row; the distance of the outermost cell in which anything is frozen (m).
    fn copy(&mut self, lattice: &Lattice, fractions: &[f64]) -> f64 {
        let is_frozen = |fraction: &f64| *fraction > 0.0;
        let mut farthest: f64 = 0.0;
        for row in 0..lattice.rows {
            let ((first, end), start) = (lattice.span(row), lattice.start(row));
            let (at, row_of) = (self.cells.first(first, row), &fractions[start..start + end - first]);
            self.cells.share[at..at + row_of.len()].copy_from_slice(row_of);
            let ends = row_of.iter().position(is_frozen).zip(row_of.iter().rposition(is_frozen));
            for column in ends.into_iter().flat_map(|(left, right)| [left, right]) {
                farthest = farthest.max(lattice.centre((first + column) as i64, row as i64).length_squared());
            }
        }
        farthest.sqrt()
    }

    /// Takes the fractions of particles that stand anywhere; the distance of the outermost in which anything is frozen (m).
    fn scatter(&mut self, positions: &[DVec2], fractions: &[f64]) -> f64 {
        let mut farthest: f64 = 0.0;
        for ((particle, place), fraction) in (0..).zip(positions).zip(fractions) {
            let Some(at) = self.cells.cell(*place) else { continue };
            (self.cells.share[at], self.particle[at]) = (*fraction, particle);
            if *fraction > 0.0 {
                farthest = farthest.max(place.length_squared());
            }
        }
        farthest.sqrt()
    }

    /// Distance from the centre (m) from which on nothing is frozen, or that of the outermost cells.
    fn far(&self) -> f64 {
        (self.frozen + 1.5 * self.cells.spacing).min(self.outermost - self.cells.spacing)
    }

    /// A way through open ground.
    fn open(&self, way: &[usize]) -> Passage {
        let places = way.iter().map(|at| self.cells.place(*at)).collect();
        Passage { barred: false, thickness: 0.0, ends: None, mean_temperature: None, places }
    }

    /// A way through the wall, with the frozen length on it (m).
    fn barred(&self, particles: &Particles, way: &[usize], thickness: f64) -> Passage {
        let frozen: Vec<usize> = way.iter().copied().filter(|at| self.cells.share[*at] >= BARS).collect();
        // The cells at both ends are frozen in part, as are perhaps those before them.
        let part = |at: Option<&usize>| at.map_or(0.0, |at| self.cells.share[*at]);
        let ends = frozen.first().zip(frozen.last()).map(|(first, last)| {
            let within = way.iter().position(|at| at == first).and_then(|k| k.checked_sub(1)).map(|k| &way[k]);
            let without = way.iter().rposition(|at| at == last).and_then(|k| way.get(k + 1));
            let frozen =
                |own: &usize, beside: Option<&usize>| self.cells.spacing * (part(Some(own)) - 0.5 + part(beside));
            (
                (self.cells.place(*first).length() - frozen(first, within)).max(0.0),
                self.cells.place(*last).length() + frozen(last, without),
            )
        });
        Passage {
            barred: true,
            thickness,
            ends,
            mean_temperature: self.mean(particles, way.iter().map(|at| (*at, 1.0))),
            places: frozen.iter().map(|at| self.cells.place(*at)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::space::domain::{Domain, Sector};

    /// Cells of 0.1 m over a disc of 6 m whose frozen share is given.
    fn ground(share: impl Fn(DVec2) -> f64) -> PassageFinder {
        let lattice = Lattice::new(&Domain::Ring { outer_radius: 6.0, sector: Sector::Whole }, 0.1);
        let mut finder = PassageFinder::over(&lattice);
        for place in lattice.positions() {
            let at = finder.cells.cell(place).expect("a cell");
            finder.cells.share[at] = share(place);
        }
        finder.frozen = 5.0;
        finder
    }

    /// The least frozen way out, and the frozen length on it; none where it is open.
    fn barred(finder: &mut PassageFinder) -> (Vec<usize>, f64) {
        match finder.cells.least_frozen(finder.far()) {
            Way::Barred(way, length) => (way, length),
            Way::Open(way) => (way, 0.0),
        }
    }

    /// Share of a cell inside an area, from 10 x 10 places in it.
    fn covered(inside: impl Fn(DVec2) -> bool) -> impl Fn(DVec2) -> f64 {
        move |place| {
            let at = |k: usize| 0.1 * ((k as f64 + 0.5) / 10.0 - 0.5);
            let all = (0..100).filter(|k| inside(place + DVec2::new(at(k % 10), at(k / 10))));
            all.count() as f64 / 100.0
        }
    }

    /// Between a circle of 2 m and one of 4 m whose centre is 0.5 m aside, in any direction, the wall is 1.5 m thick on the other side.
    #[test]
    fn a_wall_is_as_thick_as_at_its_thinnest_place() {
        for angle in [0.0, 0.3, 0.8, 2.0, 4.0] {
            let aside = 0.5 * DVec2::from_angle(angle);
            let wall = covered(move |place| place.length() > 2.0 && place.distance(aside) < 4.0);
            let mut finder = ground(wall);
            let (way, length) = barred(&mut finder);
            // Half a cell: fronts are cut into cells.
            assert!((length - 1.5).abs() < 0.05, "{angle}: {length}");
            let on_the_way = way.into_iter().map(|at| finder.cells.place(at)).find(|place| place.length() > 2.75);
            let off = on_the_way.expect("a place").angle_to(-aside).abs();
            // The thickness is the same to half a cell over some 30 degrees.
            assert!(off < 0.6, "{angle}: {off}");
            // Straight outwards it is as thick as geometry says.
            assert!((finder.along(aside) - 2.5).abs() < 0.05 && (finder.along(-aside) - 1.5).abs() < 0.05);
        }
    }

    /// A way through one cell, or from corner to corner of cells, opens a wall.
    #[test]
    fn a_wall_with_a_hole_of_a_cell_is_open() {
        let wall = |place: DVec2| (2.0..4.0).contains(&place.length());
        let slit = |place: DVec2| wall(place) && !(place.x > 0.0 && (0.0..0.1).contains(&place.y));
        let mut finder = ground(|place| f64::from(u8::from(slit(place))));
        assert!(matches!(finder.cells.least_frozen(finder.far()), Way::Open(_)));
        // Cells on a diagonal are open, and those beside them frozen.
        let cell = |place: DVec2| ((place.x / 0.1).floor(), (place.y / 0.1).floor());
        let diagonal = |place: DVec2| wall(place) && cell(place).0 != cell(place).1;
        let mut finder = ground(|place| f64::from(u8::from(diagonal(place))));
        assert!(matches!(finder.cells.least_frozen(finder.far()), Way::Open(_)));
    }

    /// Where ground freezes over a range, cells count from where they are half frozen on.
    #[test]
    fn what_is_half_frozen_counts() {
        // From half to whole within 0.5 m: half frozen from 2 m to 4 m.
        let mut finder = ground(|place| (0.5 + (place.length() - 2.0).min(4.0 - place.length())).clamp(0.0, 1.0));
        finder.cells.cut_at_half();
        let (_, length) = barred(&mut finder);
        assert!((length - 2.0).abs() < 0.05, "{length}");
    }
}
