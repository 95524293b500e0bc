//! The least frozen length from the centre of a plan to each of its cells.
//!
//! It is found by fast sweeping: with D the least frozen length, `|grad D|` is the frozen share of a cell, solved upwind in sweeps of
//! all four directions until nothing changes (Zhao 2005, Math. Comp. 74, 603). Ground around the centre in which nothing is frozen is
//! filled first, for nothing is arrived at later there; sweeps go over the rest.

use frazil_core::memory::HeapSize;
use frazil_core::space::lattice::Lattice;
use glam::DVec2;

/// Frozen share of a cell from which on it bars a way.
pub(super) const BARS: f64 = 0.5;

/// No cell.
const NONE: u32 = u32::MAX;

/// A way from the centre out, through cells from the centre on.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Way {
    /// Through open ground from cell to cell, also across corners.
    Open(Vec<usize>),
    /// Through frozen ground of some length (m), the least on any way.
    Barred(Vec<usize>, f64),
}

/// Cells of a plan, and what is known of ways to them. What it needs is kept from one time to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Arrivals {
    /// Columns and rows, with one more on each side, where there are no cells.
    columns: usize,
    rows: usize,
    /// Lower left corner of the first of them (m).
    corner: DVec2,
    pub(super) spacing: f64,
    /// Frozen share of each cell; NaN where there is none.
    pub(super) share: Vec<f64>,
    /// Least frozen length from the centre (m), as far as it is known.
    arrival: Vec<f64>,
    /// Whether the flood has come to a cell.
    flooded: Vec<bool>,
    /// The cell before this one on its way.
    before: Vec<u32>,
    /// Cells that the flood through open ground has come to.
    stack: Vec<u32>,
    /// Cells beside each other in a row that are swept, first and last.
    runs: Vec<(u32, u32)>,
    /// Whether a cell beside this one has been arrived at earlier since this one was looked at.
    is_due: Vec<bool>,
}

impl HeapSize for Arrivals {
    fn heap_size(&self) -> usize {
        // What holds one number for each cell, and at most one for each that the flood has come to.
        let kept = 2 * size_of::<f64>() + 2 * size_of::<bool>() + 2 * size_of::<u32>();
        self.share.len() * kept
    }
}

impl Arrivals {
    /// Over the cells of a lattice.
    pub(super) fn over(lattice: &Lattice) -> Self {
        let (columns, rows) = (lattice.columns + 2, lattice.rows + 2);
        let cells = columns * rows;
        Arrivals {
            columns,
            rows,
            corner: lattice.corner - DVec2::splat(lattice.spacing),
            spacing: lattice.spacing,
            share: vec![f64::NAN; cells],
            arrival: vec![f64::INFINITY; cells],
            flooded: vec![false; cells],
            before: vec![NONE; cells],
            stack: Vec::with_capacity(cells),
            runs: Vec::new(),
            is_due: vec![false; cells],
        }
    }

    /// The first cell of a row of a lattice that begins in some column.
    pub(super) fn first(&self, column: usize, row: usize) -> usize {
        (row + 1) * self.columns + column + 1
    }

    /// The cell at a place, if any.
    pub(super) fn cell(&self, place: DVec2) -> Option<usize> {
        let cell = (place - self.corner) / self.spacing;
        // Whole numbers are cut off, and not rounded.
        let (column, row) = (cell.x as usize, cell.y as usize);
        let inside = cell.cmpge(DVec2::ZERO).all() && column < self.columns && row < self.rows;
        inside.then(|| row * self.columns + column)
    }

    /// Middle of a cell (m).
    pub(super) fn place(&self, at: usize) -> DVec2 {
        let cell = DVec2::new((at % self.columns) as f64, (at / self.columns) as f64);
        self.corner + self.spacing * (cell + 0.5)
    }

    /// Takes the part of each cell that is beyond half frozen for its share.
    pub(super) fn cut_at_half(&mut self) {
        // Arrivals are not needed yet: they hold the shares meanwhile.
        for at in 0..self.share.len() {
            self.arrival[at] = self.beyond_half(at);
        }
        std::mem::swap(&mut self.share, &mut self.arrival);
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

    /// The least frozen way out, to where nothing is frozen `far` from the centre (m) and beyond, as shares of cells are now.
    pub(super) fn least_frozen(&mut self, far: f64) -> Way {
        self.arrival.fill(f64::INFINITY);
        self.flooded.fill(false);
        self.is_due.fill(false);
        let start = self.start();
        if self.leads_out(start, far)
            && let Some(last) = self.open_way(start, far)
        {
            return Way::Open(self.way(last));
        }
        let last = self.sweep(start, far);
        Way::Barred(self.way(last), self.arrival[last])
    }

    /// Fills ground around the centre in which nothing is frozen, from cell to cell, and goes on through open ground around it, also
    /// across corners; whether that comes to a cell beyond all frozen ground.
    fn leads_out(&mut self, start: usize, far: f64) -> bool {
        self.stack.clear();
        if self.share[start] > 0.0 {
            self.arrival[start] = 0.5 * self.share[start] * self.spacing;
            self.before[start] = NONE;
            self.flooded[start] = true;
            self.stack.push(start as u32);
        } else {
            self.fill(start);
        }
        for known in 0..self.stack.len() {
            self.beside(self.stack[known] as usize).into_iter().for_each(|at| self.is_due[at] = true);
        }
        self.share[start] < BARS && self.flood(far).is_some()
    }

    /// Goes through open ground from the cells that are known, also across corners, until it comes to one beyond all frozen ground. First
    /// in, first out: the way that is found is a short one.
    fn flood(&mut self, far: f64) -> Option<usize> {
        let mut next = 0;
        while let Some(at) = self.stack.get(next).map(|at| *at as usize) {
            next += 1;
            if self.place(at).length() >= far {
                return Some(at);
            }
            let (up, down) = (at + self.columns, at - self.columns);
            for other in [at + 1, at - 1, up, down, up + 1, up - 1, down + 1, down - 1] {
                // Where there is no cell the share is NaN, which is not open.
                if !self.flooded[other] && self.share[other] < BARS {
                    self.flooded[other] = true;
                    self.before[other] = at as u32;
                    self.stack.push(other as u32);
                }
            }
        }
        None
    }

    /// Fills cells from one on in which nothing is frozen, a row's piece at a time: nothing is the least frozen length to them. Those at
    /// the rim of the pieces are left as where a flood goes on from.
    fn fill(&mut self, start: usize) {
        let is_empty = |finder: &Self, at: usize| finder.share[at] == 0.0 && finder.arrival[at] > 0.0;
        let mut seeds = vec![start];
        let mut pieces = std::mem::take(&mut self.runs);
        pieces.clear();
        while let Some(seed) = seeds.pop() {
            if !is_empty(self, seed) {
                continue;
            }
            let (mut first, mut last) = (seed, seed);
            while is_empty(self, first - 1) {
                first -= 1;
            }
            while is_empty(self, last + 1) {
                last += 1;
            }
            self.arrival[first..=last].fill(0.0);
            self.before[first..=last].fill(NONE);
            self.flooded[first..=last].fill(true);
            pieces.push((first as u32, last as u32));
            for beside in [first - self.columns..=last - self.columns, first + self.columns..=last + self.columns] {
                let mut was_empty = false;
                for at in beside {
                    let now = is_empty(self, at);
                    if now && !was_empty {
                        seeds.push(at);
                    }
                    was_empty = now;
                }
            }
        }
        // A cell between others that are filled leads nowhere else: cells at its corners are beside those.
        for (first, last) in pieces.iter().copied() {
            let leads_on = |at: &u32| {
                let (up, down) = (*at as usize + self.columns, *at as usize - self.columns);
                *at == first || *at == last || !self.flooded[up] || !self.flooded[down]
            };
            self.stack.extend((first..=last).filter(leads_on));
        }
        self.runs = pieces;
    }

    /// A short way through open ground from the centre to a cell beyond all frozen ground.
    fn open_way(&mut self, start: usize, far: f64) -> Option<usize> {
        self.flooded.fill(false);
        self.stack.clear();
        self.stack.push(start as u32);
        self.flooded[start] = true;
        self.before[start] = NONE;
        self.flood(far)
    }

    /// Sweeps from the centre; of the cells beyond all frozen ground the one that is reached at least cost.
    fn sweep(&mut self, start: usize, far: f64) -> usize {
        self.find_runs(far + 1.5 * self.spacing);
        let runs = std::mem::take(&mut self.runs);
        // A sweep that changes nothing, in whichever direction, has found no cell that would be reached earlier.
        let directions = [(true, true), (true, false), (false, false), (false, true)];
        for (upwards, rightwards) in directions.into_iter().cycle() {
            let mut changed = false;
            let mut along = |(first, last): (u32, u32)| {
                let cells = first as usize..=last as usize;
                if rightwards {
                    cells.for_each(|at| changed |= self.reach(at));
                } else {
                    cells.rev().for_each(|at| changed |= self.reach(at));
                }
            };
            if upwards {
                runs.iter().copied().for_each(&mut along);
            } else {
                runs.iter().rev().copied().for_each(&mut along);
            }
            if !changed {
                break;
            }
        }
        let beyond = |at: &usize| self.arrival[*at].is_finite() && self.place(*at).length() >= far;
        let cells = runs.iter().flat_map(|(first, last)| *first as usize..=*last as usize).filter(beyond);
        let last = cells.min_by(|a, b| self.arrival[*a].total_cmp(&self.arrival[*b])).unwrap_or(start);
        self.runs = runs;
        last
    }

    /// Finds what is swept: cells up to a distance from the centre (m) that were not filled. Between pieces of a row there are filled
    /// ones, across which nothing is passed on, so that their order does not matter.
    fn find_runs(&mut self, reach: f64) {
        self.runs.clear();
        for row in 1..self.rows - 1 {
            let y = self.place(row * self.columns).y;
            let half = (reach * reach - y * y).max(0.0).sqrt();
            let column = |x: f64| ((x - self.corner.x) / self.spacing).floor();
            let (left, right) = (column(-half).max(1.0) as usize, column(half).min((self.columns - 2) as f64) as usize);
            let is_swept = |at: &usize| self.arrival[*at] > 0.0;
            let (mut from, end) = (row * self.columns + left, row * self.columns + right + 1);
            while let Some(first) = (from..end).find(is_swept) {
                from = (first..end).find(|at| !is_swept(at)).unwrap_or(end);
                self.runs.push((first as u32, from as u32 - 1));
            }
        }
    }

    /// Takes the arrival at a cell from those beside it, if any of these is earlier than when it was looked at last; whether it is
    /// earlier than before.
    #[inline]
    fn reach(&mut self, at: usize) -> bool {
        if !std::mem::take(&mut self.is_due[at]) {
            return false;
        }
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
            for (other, known) in beside.into_iter().zip(arrivals) {
                self.is_due[other] |= known > arrival;
            }
        }
        earlier
    }

    /// Cells to the left, right, below and above of one that is there.
    #[inline]
    fn beside(&self, at: usize) -> [usize; 4] {
        [at - 1, at + 1, at - self.columns, at + self.columns]
    }

    /// The cell at the centre, or beside it.
    fn start(&self) -> usize {
        let cell = (-self.corner / self.spacing).floor().max(DVec2::ONE);
        (cell.y as usize).min(self.rows - 2) * self.columns + (cell.x as usize).min(self.columns - 2)
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::space::domain::{Domain, Sector};
    use proptest::prelude::*;

    /// The least frozen length to any cell `far` from the centre, found from cell to cell until nothing changes.
    fn plainly(cells: &Arrivals, far: f64) -> f64 {
        let mut arrival = vec![f64::INFINITY; cells.share.len()];
        let start = cells.start();
        arrival[start] = 0.5 * cells.share[start] * cells.spacing;
        loop {
            let before = arrival.clone();
            for at in (0..arrival.len()).filter(|at| !cells.share[*at].is_nan()) {
                let cost = cells.share[at] * cells.spacing;
                let [left, right, below, above] = cells.beside(at).map(|other| arrival[other]);
                let (a, b) = (left.min(right), below.min(above));
                let (low, high) = (a.min(b), a.max(b));
                let both = 0.5 * (low + high + (2.0 * cost * cost - (high - low) * (high - low)).sqrt());
                arrival[at] = arrival[at].min(if high - low >= cost { low + cost } else { both });
            }
            if arrival == before {
                break;
            }
        }
        let out = (0..arrival.len()).filter(|at| cells.place(*at).length() >= far && !cells.share[*at].is_nan());
        out.map(|at| arrival[at]).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Ground that is open here, frozen in part there and frozen all round: filling and leaving out cells changes no length.
        #[test]
        fn filled_ground_and_sweeps_tell_what_single_cells_tell(
            shares in prop::collection::vec(prop_oneof![3 => Just(0.0), 2 => 0.0..1.0_f64, 3 => Just(1.0)], 600),
            wall in 2.0..6.0f64,
        ) {
            let lattice = Lattice::new(&Domain::Ring { outer_radius: 10.0, sector: Sector::Whole }, 1.0);
            let mut cells = Arrivals::over(&lattice);
            for (place, share) in lattice.positions().into_iter().zip(&shares) {
                let at = cells.cell(place).expect("a cell");
                // Nothing is frozen beyond 8.2 m, and a ring is closed.
                let is_wall = (place.length() - wall).abs() <= 1.0;
                cells.share[at] = if place.length() > 7.0 { 0.0 } else if is_wall { share.max(BARS) } else { *share };
            }
            let far = 8.5;
            let expected = plainly(&cells, far);
            let Way::Barred(way, length) = cells.least_frozen(far) else { return Err(TestCaseError::fail("an open way")) };
            prop_assert!((length - expected).abs() <= 1e-12 * expected, "{length} for {expected}");
            // It begins where nothing is frozen yet and ends beyond all that is.
            prop_assert!(cells.arrival[way[0]] <= 0.5 * cells.share[way[0]] * cells.spacing);
            prop_assert!(cells.place(way[way.len() - 1]).length() >= far);
        }
    }
}
