//! The least frozen way through a wall: of all ways from the centre to the outer wall that with the least frozen ground on it. The
//! length of that ground is how thick the wall is where it is weakest, and nothing where a way leads through open ground.
//!
//! A way is found by fast sweeping: the arrival D at a cell is the least frozen length from the centre to it, so `|grad D|` is the
//! frozen share of the cell, solved upwind in sweeps of all four directions until nothing changes (Zhao 2005, Math. Comp. 74, 603).

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::space::lattice::Lattice;
use glam::DVec2;

use super::sampler::{Sample, Sampler};
use super::section::narrowed;

/// Frozen share of a cell from which on it bars a way.
const BARS: f64 = 0.5;

/// No cell.
const NONE: u32 = u32::MAX;

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
    /// Columns and rows, with one more on each side, where there are no cells.
    columns: usize,
    rows: usize,
    /// Lower left corner of the first of them (m).
    corner: DVec2,
    spacing: f64,
    /// Distance of the outermost cell from the centre (m), and of the outermost that is frozen.
    outermost: f64,
    frozen: f64,
    /// Frozen share of each cell; NaN where there is none.
    share: Vec<f64>,
    /// Particle of each cell.
    particle: Vec<u32>,
    /// Least frozen length from the centre (m), as far as it is known.
    arrival: Vec<f64>,
    /// Whether the flood has come to a cell.
    flooded: Vec<bool>,
    /// The cell before this one on its way.
    before: Vec<u32>,
    /// Cells that the flood through open ground has come to.
    stack: Vec<u32>,
}

impl HeapSize for PassageFinder {
    fn heap_size(&self) -> usize {
        let cells = self.share.len();
        let kept = size_of::<f64>() + size_of::<bool>() + 2 * size_of::<u32>();
        self.share.heap_size() + self.particle.heap_size() + cells * kept
    }
}

impl PassageFinder {
    /// Over the cells of a lattice.
    pub(super) fn over(lattice: &Lattice) -> Self {
        let (columns, rows) = (lattice.columns + 2, lattice.rows + 2);
        let cells = columns * rows;
        PassageFinder {
            columns,
            rows,
            corner: lattice.corner - DVec2::splat(lattice.spacing),
            spacing: lattice.spacing,
            outermost: lattice.positions().into_iter().map(DVec2::length).fold(0.0, f64::max),
            frozen: 0.0,
            share: vec![f64::NAN; cells],
            particle: vec![NONE; cells],
            arrival: vec![f64::INFINITY; cells],
            flooded: vec![false; cells],
            before: vec![NONE; cells],
            stack: Vec::with_capacity(cells),
        }
    }

    /// The least frozen way through the ground as it is. `sharp`: ground freezes at one temperature, so that the frozen fraction of a
    /// cell is the part of it that is frozen; else what is half frozen bars a way, and a cell is cut where the fraction passes that.
    pub(super) fn passage(&mut self, particles: &Particles, fractions: &[f64], sharp: bool) -> Passage {
        self.read(particles, fractions, sharp);
        let (start, far) = (self.start(), self.far());
        match self.flood(start, far) {
            Some(last) => self.open(last),
            None => {
                let last = self.sweep(start, far);
                self.barred(particles, last)
            }
        }
    }

    /// What is read of particles, read of their cells.
    pub(super) fn in_cells(&self, sample: &Sample, sampler: &Sampler<'_>) -> Sample {
        let cell = |i: u32| self.cell(sampler.place(i as usize)).map(|at| at as u32);
        Sample(sample.0.iter().filter_map(|(i, weight)| Some((cell(*i)?, *weight))).collect())
    }

    /// Sum over the frozen shares of cells, as the ground was at the last passage.
    pub(super) fn sum(&self, cells: &Sample) -> f64 {
        cells.of(|at| self.share[at])
    }

    /// The cell at a place, if any.
    fn cell(&self, place: DVec2) -> Option<usize> {
        let cell = ((place - self.corner) / self.spacing).floor();
        let inside = cell.cmpge(DVec2::ZERO).all() && (cell.x as usize) < self.columns && (cell.y as usize) < self.rows;
        inside.then(|| cell.y as usize * self.columns + cell.x as usize)
    }

    /// Size of a cell (m).
    pub(super) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Frozen length outwards through a place (m), as the ground was at the last passage.
    pub(super) fn along(&self, through: DVec2) -> f64 {
        self.step() * self.straight(through).map(|at| self.share[at]).sum::<f64>()
    }

    /// Frozen length of the one body around a place, straight through it in a direction (m), as the ground was at the last passage.
    pub(super) fn around(&self, place: DVec2, direction: DVec2) -> f64 {
        let share = |k: f64| self.cell(place + k * self.step() * direction).map_or(0.0, |at| self.share[at]);
        let side = |sign: f64| {
            let shares = (0..).map(|k| share(sign * (f64::from(k) + 0.5)));
            shares.take_while(|share| *share > 0.0).sum::<f64>()
        };
        self.step() * (side(1.0) + side(-1.0))
    }

    /// Mean temperature of the frozen ground on that way.
    pub(super) fn mean_along(&self, particles: &Particles, through: DVec2) -> Option<f64> {
        self.mean(particles, self.straight(through))
    }

    /// Length of the steps of a straight way (m).
    fn step(&self) -> f64 {
        0.25 * self.spacing
    }

    /// The cells straight outwards through a place, by steps.
    fn straight(&self, through: DVec2) -> impl Iterator<Item = usize> {
        let direction = through.normalize_or(DVec2::X);
        let cell = move |k: usize| {
            let place = (k as f64 + 0.5) * self.step() * direction;
            self.cell(place).filter(|at| !self.share[*at].is_nan())
        };
        (0..).map_while(cell)
    }

    /// Mean temperature of what is frozen of cells.
    fn mean(&self, particles: &Particles, cells: impl Iterator<Item = usize>) -> Option<f64> {
        let (mut sum, mut weight) = (0.0, 0.0);
        for at in cells {
            sum += self.share[at] * particles.frozen_reading(self.particle[at] as usize);
            weight += self.share[at];
        }
        (weight > 0.0).then(|| sum / weight)
    }

    /// Takes the frozen shares of all cells.
    fn read(&mut self, particles: &Particles, fractions: &[f64], sharp: bool) {
        let (corner, per_cell, columns) = (self.corner, 1.0 / self.spacing, self.columns);
        let mut farthest: f64 = 0.0;
        particles.visit(|i, place| {
            let cell = (place - corner) * per_cell;
            let at = cell.y as usize * columns + cell.x as usize;
            self.share[at] = fractions[i];
            self.particle[at] = i as u32;
            if fractions[i] > 0.0 {
                farthest = farthest.max(place.length_squared());
            }
        });
        self.frozen = farthest.sqrt();
        if !sharp {
            // Arrivals are not needed yet: they hold the shares meanwhile.
            for at in 0..self.share.len() {
                self.arrival[at] = self.beyond_half(at);
            }
            std::mem::swap(&mut self.share, &mut self.arrival);
        }
        self.arrival.fill(f64::INFINITY);
        self.flooded.fill(false);
        self.before.fill(NONE);
    }

    /// The part of a cell whose fraction is beyond one half, if it is linear in the cell.
    fn beyond_half(&self, at: usize) -> f64 {
        let own = self.share[at];
        if own.is_nan() {
            return own;
        }
        let share = |other: usize| if self.share[other].is_nan() { own } else { self.share[other] };
        let [left, right, below, above] = self.beside(at).map(share);
        let slope = (0.5 * (right - left)).hypot(0.5 * (above - below));
        if slope > 0.0 { (0.5 + (own - 0.5) / slope).clamp(0.0, 1.0) } else { f64::from(u8::from(own >= 0.5)) }
    }

    /// Cells to the left, right, below and above of one that is there.
    #[inline]
    fn beside(&self, at: usize) -> [usize; 4] {
        [at - 1, at + 1, at - self.columns, at + self.columns]
    }

    fn place(&self, at: usize) -> DVec2 {
        let cell = DVec2::new((at % self.columns) as f64, (at / self.columns) as f64);
        self.corner + self.spacing * (cell + 0.5)
    }

    /// The cell at the centre, or beside it.
    fn start(&self) -> usize {
        let cell = (-self.corner / self.spacing).floor().max(DVec2::ONE);
        (cell.y as usize).min(self.rows - 2) * self.columns + (cell.x as usize).min(self.columns - 2)
    }

    /// Distance from the centre (m) from which on nothing is frozen, or that of the outermost cells.
    fn far(&self) -> f64 {
        (self.frozen + 1.5 * self.spacing).min(self.outermost - self.spacing)
    }

    /// Goes through open ground from the centre, also across corners; the cell beyond all frozen ground that it comes to, if any.
    fn flood(&mut self, start: usize, far: f64) -> Option<usize> {
        let open = |share: f64| share < BARS;
        if !open(self.share[start]) {
            return None;
        }
        self.stack.clear();
        self.stack.push(start as u32);
        self.flooded[start] = true;
        let mut found = None;
        // First in, first out: the way that is found is a short one.
        let mut next = 0;
        while let Some(at) = self.stack.get(next).map(|at| *at as usize) {
            next += 1;
            if self.place(at).length() >= far {
                found = Some(at);
                break;
            }
            let (up, down) = (at + self.columns, at - self.columns);
            for other in [at + 1, at - 1, up, down, up + 1, up - 1, down + 1, down - 1] {
                // Where there is no cell the share is NaN, which is not open.
                if !self.flooded[other] && open(self.share[other]) {
                    self.flooded[other] = true;
                    self.before[other] = at as u32;
                    self.stack.push(other as u32);
                }
            }
        }
        if found.is_none() {
            self.flooded.fill(false);
            self.before.fill(NONE);
        }
        found
    }

    /// Sweeps from the centre; of the cells beyond all frozen ground the one that is reached at least cost.
    fn sweep(&mut self, start: usize, far: f64) -> usize {
        self.arrival[start] = 0.5 * self.share[start] * self.spacing;
        // Cells around the centre as far as the way may go.
        let reach = (far / self.spacing).ceil() as usize + 2;
        let around =
            |middle: usize, count: usize| (middle.saturating_sub(reach).max(1), (middle + reach).min(count - 2));
        let (left, right) = around(start % self.columns, self.columns);
        let (below, above) = around(start / self.columns, self.rows);
        // A sweep that changes nothing, in whichever direction, has found no cell that would be reached earlier.
        let directions = [(true, true), (true, false), (false, false), (false, true)];
        for (upwards, rightwards) in directions.into_iter().cycle() {
            let mut changed = false;
            for row in 0..=above - below {
                let row = self.columns * if upwards { below + row } else { above - row };
                for column in 0..=right - left {
                    changed |= self.reach(row + if rightwards { left + column } else { right - column });
                }
            }
            if !changed {
                break;
            }
        }
        let beyond = |at: &usize| self.arrival[*at].is_finite() && self.place(*at).length() >= far;
        let cells = (below..=above).flat_map(|row| (left..=right).map(move |column| (row, column)));
        let cells = cells.map(|(row, column)| row * self.columns + column).filter(beyond);
        cells.min_by(|a, b| self.arrival[*a].total_cmp(&self.arrival[*b])).unwrap_or(start)
    }

    /// Takes the arrival at a cell from those beside it; whether it is earlier than before.
    #[inline]
    fn reach(&mut self, at: usize) -> bool {
        let cost = self.share[at] * self.spacing;
        let beside = self.beside(at);
        let arrivals = beside.map(|other| self.arrival[other]);
        let (across, along) = (arrivals[0].min(arrivals[1]), arrivals[2].min(arrivals[3]));
        let (low, high) = (across.min(along), across.max(along));
        // A cell costs at least this much, crossed by the diagonal of what is known beside it. Where there is no cell it is NaN.
        let least = low + cost * std::f64::consts::FRAC_1_SQRT_2;
        if least.is_nan() || least >= self.arrival[at] {
            return false;
        }
        let arrival = if high - low >= cost {
            low + cost
        } else {
            0.5 * (low + high + (2.0 * cost * cost - (high - low) * (high - low)).sqrt())
        };
        let earlier = arrival < self.arrival[at];
        if earlier {
            self.arrival[at] = arrival;
            self.before[at] = arrivals.iter().position(|arrival| *arrival == low).map_or(NONE, |k| beside[k] as u32);
        }
        earlier
    }

    /// The cells on the way to one, from the centre on.
    fn way(&self, last: usize) -> Vec<usize> {
        let mut way = vec![last];
        while let Some(before) = way.last().map(|at| self.before[*at]).filter(|before| *before != NONE) {
            way.push(before as usize);
        }
        way.reverse();
        way
    }

    /// A way through open ground.
    fn open(&self, last: usize) -> Passage {
        let places = self.way(last).into_iter().map(|at| self.place(at)).collect();
        Passage { barred: false, thickness: 0.0, ends: None, mean_temperature: None, places }
    }

    /// The way to a cell beyond the wall.
    fn barred(&self, particles: &Particles, last: usize) -> Passage {
        let way = self.way(last);
        let thickness = self.arrival[last];
        let frozen: Vec<usize> = way.iter().copied().filter(|at| self.share[*at] >= BARS).collect();
        // The cells at both ends are frozen in part, as are perhaps those before them.
        let part = |at: Option<&usize>| at.map_or(0.0, |at| self.share[*at]);
        let ends = frozen.first().zip(frozen.last()).map(|(first, last)| {
            let within = way.iter().position(|at| at == first).and_then(|k| k.checked_sub(1)).map(|k| &way[k]);
            let without = way.iter().rposition(|at| at == last).and_then(|k| way.get(k + 1));
            let frozen = |own: &usize, beside: Option<&usize>| self.spacing * (part(Some(own)) - 0.5 + part(beside));
            (
                (self.place(*first).length() - frozen(first, within)).max(0.0),
                self.place(*last).length() + frozen(last, without),
            )
        });
        Passage {
            barred: true,
            thickness,
            ends,
            mean_temperature: self.mean(particles, way.iter().copied()),
            places: frozen.iter().map(|at| self.place(*at)).collect(),
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
            let cell = ((place - finder.corner) / finder.spacing).floor();
            finder.share[cell.y as usize * finder.columns + cell.x as usize] = share(place);
        }
        finder.frozen = 5.0;
        finder
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
            let (start, far) = (finder.start(), finder.far());
            assert_eq!(finder.flood(start, far), None);
            let last = finder.sweep(start, far);
            // Half a cell: fronts are cut into cells.
            assert!((finder.arrival[last] - 1.5).abs() < 0.05, "{angle}: {}", finder.arrival[last]);
            let on_the_way =
                finder.way(last).into_iter().map(|at| finder.place(at)).find(|place| place.length() > 2.75);
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
        assert!(finder.flood(finder.start(), finder.far()).is_some());
        // Cells on a diagonal are open, and those beside them frozen.
        let cell = |place: DVec2| ((place.x / 0.1).floor(), (place.y / 0.1).floor());
        let diagonal = |place: DVec2| wall(place) && cell(place).0 != cell(place).1;
        let mut finder = ground(|place| f64::from(u8::from(diagonal(place))));
        assert!(finder.flood(finder.start(), finder.far()).is_some());
    }

    /// Where ground freezes over a range, cells count from where they are half frozen on.
    #[test]
    fn what_is_half_frozen_counts() {
        // From half to whole within 0.5 m: half frozen from 2 m to 4 m.
        let mut finder = ground(|place| (0.5 + (place.length() - 2.0).min(4.0 - place.length())).clamp(0.0, 1.0));
        let shares: Vec<f64> = (0..finder.share.len()).map(|at| finder.beyond_half(at)).collect();
        finder.share = shares;
        let (start, far) = (finder.start(), finder.far());
        assert_eq!(finder.flood(start, far), None);
        let last = finder.sweep(start, far);
        assert!((finder.arrival[last] - 2.0).abs() < 0.05, "{}", finder.arrival[last]);
    }
}
