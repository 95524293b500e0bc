//! Where along the step a class ends: a coarse map, then bisection.

use frazil_core::statistics;
use frazil_record::Outcome;

use super::cell::{Finding, SEED};

/// Two steps closer than this ratio enclose a boundary well enough.
const CLOSE: f64 = 1.02;
/// Seeds of a noisy cell that lies far from every boundary.
const FEW_SEEDS: usize = 3;

/// One cell: a step and what its runs came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Step over the stated bound.
    pub ratio: f64,
    /// Class: that of most failures where at least half of the runs failed.
    pub class: Outcome,
    /// A run of that class.
    pub finding: Finding,
    /// Runs, which differ by their seed.
    pub seeds: usize,
    /// Runs that are not exact.
    pub failures: usize,
    /// Whether it belongs to the map, and not to a bisection.
    pub mapped: bool,
}

impl Cell {
    /// Takes the runs of a cell together; there is at least one.
    fn of(ratio: f64, mapped: bool, runs: &[Finding]) -> Option<Cell> {
        let failed: Vec<&Finding> = runs.iter().filter(|run| run.outcome != Outcome::Ok).collect();
        let class = if 2 * failed.len() < runs.len() {
            Outcome::Ok
        } else {
            let votes = |class: Outcome| failed.iter().filter(|run| run.outcome == class).count();
            failed.iter().map(|run| run.outcome).max_by_key(|class| votes(*class)).unwrap_or(Outcome::Ok)
        };
        let finding = runs.iter().find(|run| run.outcome == class)?.clone();
        Some(Cell { ratio, class, finding, seeds: runs.len(), failures: failed.len(), mapped })
    }

    fn exact(&self) -> bool {
        self.class == Outcome::Ok
    }

    /// Share of runs that failed, with its interval.
    pub fn share(&self) -> Option<statistics::Share> {
        statistics::wilson(self.failures, self.seeds)
    }
}

/// A boundary between two steps that were run; an end is missing where the map is not crossed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Edge {
    /// Greatest step on the near side.
    pub low: Option<f64>,
    /// Least step on the far side.
    pub high: Option<f64>,
}

impl Edge {
    /// The boundary itself: between its two steps.
    pub fn middle(&self) -> Option<f64> {
        Some((self.low? * self.high?).sqrt())
    }
}

/// Everything that is found along the step.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Cells by step.
    pub cells: Vec<Cell>,
    /// Below it every run is exact.
    pub first_loss: Edge,
    /// Above it no run is exact.
    pub last_exact: Edge,
    /// Above it runs diverge.
    pub divergence: Edge,
}

/// Halvings of one boundary: cells of a map of thirteen are apart by 1.26.
const HALVINGS: f64 = 4.0;
/// Boundaries that are halved: exactness and divergence. First loss and last exact step are mostly the same.
const BOUNDARIES: f64 = 2.0;
/// Cells beside these boundaries, which get all seeds.
const SHARPENED: f64 = 4.0;

/// About how long (s) [`climb`] takes, if a run at the bound takes `at_bound` (s) and none is let run longer than `most` (s).
pub fn seconds(grid: &[f64], bisect: bool, seeds: Option<usize>, at_bound: f64, most: f64) -> f64 {
    let one = |ratio: f64| (at_bound / ratio).min(most);
    let many = seeds.unwrap_or(1) as f64;
    let few = many.min(if bisect { FEW_SEEDS as f64 } else { many });
    let map = few * grid.iter().map(|ratio| one(*ratio)).sum::<f64>();
    // Boundaries lie a little beyond the bound.
    let beside = if bisect { BOUNDARIES * HALVINGS * many + SHARPENED * (many - few) } else { 0.0 };
    map + beside * one(1.5)
}

/// Evenly spaced in the logarithm, ends included.
pub fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| low * (high / low).powf(k as f64 / (count - 1).max(1) as f64)).collect()
}

/// Runs a map over `grid` and bisects its boundaries, if `bisect` says so. `run` makes one run at a step with a seed,
/// and stops everything where it has no answer. Cells of a noisy column get `seeds` runs near a boundary.
pub fn climb(
    grid: &[f64],
    bisect: bool,
    seeds: Option<usize>,
    run: &mut dyn FnMut(f64, u64) -> Option<Finding>,
) -> Option<Ladder> {
    let mut search = Search { run, cells: Vec::new() };
    let few = seeds.map_or(1, |seeds| seeds.min(if bisect { FEW_SEEDS } else { seeds }));
    let many = seeds.unwrap_or(1);
    for ratio in grid {
        search.cell(*ratio, true, few)?;
    }
    if many > few {
        search.sharpen(many)?;
    }
    let mut edges = search.edges();
    if bisect {
        let sides: [fn(&Cell) -> bool; 3] = [Cell::exact, Cell::exact, |cell| cell.class != Outcome::Diverged];
        for (k, near) in sides.into_iter().enumerate() {
            search.bisect(edges[k], near, many)?;
            // A step between may have turned out to be the true first, or last.
            edges = search.edges();
        }
    }
    let [first_loss, last_exact, divergence] = edges;
    Some(Ladder { cells: search.cells, first_loss, last_exact, divergence })
}

struct Search<'a> {
    run: &'a mut dyn FnMut(f64, u64) -> Option<Finding>,
    cells: Vec<Cell>,
}

impl Search<'_> {
    /// Runs a cell, or runs it again with more seeds.
    fn cell(&mut self, ratio: f64, mapped: bool, seeds: usize) -> Option<Cell> {
        let runs: Option<Vec<Finding>> = (0..seeds as u64).map(|k| (self.run)(ratio, SEED + k)).collect();
        let place = self.cells.partition_point(|cell| cell.ratio < ratio);
        let again = self.cells.get(place).filter(|cell| cell.ratio == ratio).map(|cell| cell.mapped);
        let cell = Cell::of(ratio, again.unwrap_or(mapped), &runs?)?;
        match again {
            Some(_) => self.cells[place] = cell.clone(),
            None => self.cells.insert(place, cell.clone()),
        }
        Some(cell)
    }

    /// More seeds for cells whose runs disagree, and for those beside a change of class.
    fn sharpen(&mut self, seeds: usize) -> Option<()> {
        loop {
            let near = |k: usize| {
                let cell = &self.cells[k];
                let differs = |other: Option<&Cell>| other.is_some_and(|other| other.class != cell.class);
                let before = k.checked_sub(1).and_then(|before| self.cells.get(before));
                let mixed = cell.failures > 0 && cell.failures < cell.seeds;
                cell.seeds < seeds && (mixed || differs(before) || differs(self.cells.get(k + 1)))
            };
            let Some(k) = (0..self.cells.len()).find(|k| near(*k)) else { return Some(()) };
            let ratio = self.cells[k].ratio;
            self.cell(ratio, true, seeds)?;
        }
    }

    fn bisect(&mut self, edge: Edge, near: fn(&Cell) -> bool, seeds: usize) -> Option<()> {
        let (Some(mut low), Some(mut high)) = (edge.low, edge.high) else { return Some(()) };
        while high / low > CLOSE {
            let middle = (low * high).sqrt();
            let cell = self.cell(middle, false, seeds)?;
            if near(&cell) { low = middle } else { high = middle }
        }
        Some(())
    }

    /// First loss of exactness, last exact step, first divergence.
    fn edges(&self) -> [Edge; 3] {
        let at = |k: Option<usize>| k.and_then(|k| self.cells.get(k)).map(|cell| cell.ratio);
        let before = |k: Option<usize>| Edge { low: at(k.and_then(|k| k.checked_sub(1))), high: at(k) };
        let last = self.cells.len().checked_sub(1);
        // Without a change the near side is all that was run.
        let or_all = |edge: Edge| if edge.high.is_none() { Edge { low: at(last), high: None } } else { edge };
        let lost = self.cells.iter().position(|cell| !cell.exact());
        let kept = self.cells.iter().rposition(Cell::exact);
        let above = match kept {
            Some(kept) => Edge { low: at(Some(kept)), high: at(Some(kept + 1)) },
            None => Edge { low: None, high: at(Some(0)) },
        };
        let gone = self.cells.iter().position(|cell| cell.class == Outcome::Diverged);
        [or_all(before(lost)), above, or_all(before(gone))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(outcome: Outcome) -> Finding {
        Finding {
            outcome,
            cause: None,
            steps: 1,
            step_s: 1.0,
            violation_rel: None,
            setback_rel: None,
            energy_balance_rel: None,
        }
    }

    fn climbed(seeds: Option<usize>, class: impl Fn(f64, u64) -> Outcome) -> (Ladder, usize) {
        let mut runs = 0;
        let mut run = |ratio: f64, seed: u64| {
            runs += 1;
            Some(finding(class(ratio, seed)))
        };
        let ladder = climb(&grid(0.25, 4.0, 13), true, seeds, &mut run).expect("not stopped");
        (ladder, runs)
    }

    fn encloses(edge: Edge, truth: f64) -> bool {
        let (low, high) = (edge.low.expect("low"), edge.high.expect("high"));
        low <= truth && truth <= high && high / low <= CLOSE
    }

    #[test]
    fn boundaries_are_enclosed_within_two_per_cent() {
        let (ladder, runs) = climbed(None, |ratio, _| match ratio {
            ratio if ratio < 1.5 => Outcome::Ok,
            ratio if ratio < 3.3 => Outcome::Oscillating,
            _ => Outcome::Diverged,
        });
        assert!(encloses(ladder.first_loss, 1.5) && encloses(ladder.last_exact, 1.5));
        assert!(encloses(ladder.divergence, 3.3));
        // Thirteen for the map, four halvings of a ratio of 1.26 for each of two boundaries.
        assert_eq!(runs, 21);
        assert!(ladder.cells.windows(2).all(|pair| pair[0].ratio < pair[1].ratio));
        assert_eq!(ladder.cells.iter().filter(|cell| cell.mapped).count(), 13);
    }

    #[test]
    fn an_island_has_its_own_two_boundaries() {
        let (ladder, _) =
            climbed(
                None,
                |ratio, _| {
                    if (1.2..1.8).contains(&ratio) || ratio > 2.2 { Outcome::Oscillating } else { Outcome::Ok }
                },
            );
        assert!(encloses(ladder.first_loss, 1.2), "{:?}", ladder.first_loss);
        assert!(encloses(ladder.last_exact, 2.2), "{:?}", ladder.last_exact);
        assert_eq!(ladder.divergence, Edge { low: Some(4.0), high: None });
    }

    #[test]
    fn a_map_that_is_not_crossed_has_no_boundary() {
        let (ladder, runs) = climbed(None, |_, _| Outcome::Ok);
        assert_eq!((ladder.first_loss.middle(), ladder.last_exact.high, runs), (None, None, 13));
        let (ladder, _) = climbed(None, |_, _| Outcome::Diverged);
        assert_eq!(ladder.first_loss, Edge { low: None, high: Some(0.25) });
        assert_eq!(ladder.last_exact, Edge { low: None, high: Some(0.25) });
    }

    #[test]
    fn noisy_cells_get_many_seeds_near_their_boundary_and_few_elsewhere() {
        // One seed in five fails a little below the boundary.
        let (ladder, _) = climbed(Some(10), |ratio, seed| {
            if ratio > 1.5 || (ratio > 1.3 && seed % 5 == 0) { Outcome::Diverged } else { Outcome::Ok }
        });
        assert!(encloses(ladder.first_loss, 1.5), "{:?}", ladder.first_loss);
        for cell in &ladder.cells {
            let near = (1.2..1.7).contains(&cell.ratio);
            assert!(cell.seeds == if near { 10 } else { 3 } || !cell.mapped, "{cell:?}");
            if cell.ratio > 1.3 && cell.ratio < 1.5 {
                assert_eq!((cell.seeds, cell.failures, cell.class), (10, 2, Outcome::Ok));
            }
        }
    }

    /// Against what climbing really runs, where a run takes the longer the shorter its steps are.
    #[test]
    fn the_time_of_a_climb_is_told_beforehand() {
        for seeds in [None, Some(10)] {
            let mut spent = 0.0;
            let mut run = |ratio: f64, _: u64| {
                spent += f64::min(2.0 / ratio, 5.0);
                Some(finding(match ratio {
                    ratio if ratio < 1.5 => Outcome::Ok,
                    ratio if ratio < 3.3 => Outcome::Oscillating,
                    _ => Outcome::Diverged,
                }))
            };
            let grid = grid(0.25, 4.0, 13);
            climb(&grid, true, seeds, &mut run).expect("not stopped");
            let told = seconds(&grid, true, seeds, 2.0, 5.0);
            assert!((0.7..1.4).contains(&(told / spent)), "{seeds:?}: {told} told, {spent} spent");
        }
        assert_eq!(seconds(&[1.0, 2.0], false, Some(10), 2.0, 5.0), 30.0);
    }

    #[test]
    fn a_run_without_an_answer_stops_the_search() {
        let mut left = 5;
        let mut run = |_: f64, _: u64| {
            left -= 1;
            (left > 0).then(|| finding(Outcome::Ok))
        };
        assert_eq!(climb(&grid(0.25, 4.0, 13), true, None, &mut run), None);
    }
}
