//! How cracks, closed parts and shafts change the weights of pairs while a run goes on.

use std::collections::HashMap;

use glam::DVec2;

use crate::bonds::pair_list::PairList;
use crate::boundary::ghosts::Ghosts;
use crate::breakage::crack::Barriers;
use crate::breakage::strength::{Strengths, arm};
use crate::memory::HeapSize;
use crate::saved::{Pass, Saved};
use crate::space::volumes::Volumes;

/// A weight that changes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Change {
    /// When (s).
    time: f64,
    /// Where in the list.
    place: usize,
    before: f64,
    after: f64,
}

/// Weights that change because something is cut.
#[derive(Debug, Clone, Default)]
pub struct Cuts {
    /// In order of time.
    changes: Vec<Change>,
    done: usize,
    /// Particles whose row sums grow, and by what at most.
    growing: Vec<(u32, f64)>,
}

/// A list whose weights change by them.
pub(crate) struct Cutting<'a> {
    /// What changes.
    pub(crate) cuts: &'a mut Cuts,
    /// The weights.
    pub(crate) weights: &'a mut [f64],
}

impl Saved for Cutting<'_> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let mut done = self.cuts.done;
        done.pass(pass);
        if done > self.cuts.changes.len() {
            return pass.refuse();
        }
        for change in &self.cuts.changes[self.cuts.done.min(done)..done] {
            self.weights[change.place] = change.after;
        }
        self.cuts.done = done;
    }
}

impl HeapSize for Cuts {
    fn heap_size(&self) -> usize {
        self.changes.capacity() * size_of::<Change>() + self.growing.capacity() * size_of::<(u32, f64)>()
    }
}

impl Cuts {
    /// Takes pairs that are cut at the start out of a list, strengthens those that are left, and notes how they change later.
    pub fn new(
        pairs: &mut PairList,
        volumes: &Volumes,
        positions: &[DVec2],
        ghosts: &Ghosts,
        barriers: &Barriers<'_>,
    ) -> Self {
        let count = positions.len();
        let mut times = Vec::with_capacity(pairs.partners.len());
        for i in 0..count {
            let partners = &pairs.partners[pairs.starts[i]..pairs.starts[i + 1]];
            times.extend(partners.iter().map(|j| barriers.of_pair(positions, ghosts, i, *j as usize)));
        }
        let strengths = Strengths::new(pairs, &times, volumes, |i, j| arm(positions, ghosts, i, j));
        let (mut kept, mut cuts) = (PairList { starts: vec![0], ..PairList::default() }, Cuts::default());
        for i in 0..count {
            for k in pairs.starts[i]..pairs.starts[i + 1] {
                if times[k] <= 0.0 {
                    continue;
                }
                let (partner, weight, place) = (pairs.partners[k], pairs.weights[k], kept.partners.len());
                let j = (partner as usize).checked_sub(count).map_or(partner, |ghost| ghosts.model[ghost]) as usize;
                let mut before = weight * strengths.of_pair(i, j, 0.0);
                kept.partners.push(partner);
                kept.weights.push(before);
                let later = strengths.instants(i, j).filter(|time| *time < times[k]);
                for time in later.chain((times[k] < f64::INFINITY).then_some(times[k])) {
                    let after = if time < times[k] { weight * strengths.of_pair(i, j, time) } else { 0.0 };
                    if after != before {
                        cuts.changes.push(Change { time, place, before, after });
                        before = after;
                    }
                }
            }
            kept.starts.push(kept.partners.len());
        }
        kept.partners.shrink_to_fit();
        kept.weights.shrink_to_fit();
        *pairs = kept;
        cuts.sort();
        cuts.growing = growing(pairs, &cuts.changes);
        cuts
    }

    /// Multiplies the weights of a list by what its pairs conduct better, now and later.
    pub(crate) fn scale(&mut self, pairs: &mut PairList, factors: &[f64]) {
        pairs.weights.iter_mut().zip(factors).for_each(|(weight, factor)| *weight *= factor);
        if self.changes.is_empty() {
            return;
        }
        for change in &mut self.changes {
            change.before *= factors[change.place];
            change.after *= factors[change.place];
        }
        self.growing = growing(pairs, &self.changes);
    }

    /// Adds pairs that are cut, by time (s), place in the list, and weight before. A pair is cut once, by whatever comes first.
    pub fn add(&mut self, ends: &[(f64, usize, f64)]) {
        self.changes.sort_by(|a, b| a.place.cmp(&b.place).then(a.time.total_cmp(&b.time)));
        for (time, place, weight) in ends.iter().copied() {
            let from = self.changes.partition_point(|change| change.place < place);
            let own = self.changes[from..].iter().take_while(|change| change.place == place);
            let (earlier, all) = (own.clone().take_while(|change| change.time < time).count(), own.count());
            let before = earlier.checked_sub(1).map_or(weight, |last| self.changes[from + last].after);
            let end = (before != 0.0).then_some(Change { time, place, before, after: 0.0 });
            self.changes.splice(from + earlier..from + all, end);
        }
        self.sort();
    }

    fn sort(&mut self) {
        self.changes.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.place.cmp(&b.place)));
        self.changes.shrink_to_fit();
    }

    /// Whether no weight changes after the start.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Where in the list weights change.
    pub(crate) fn places(&self) -> impl Iterator<Item = usize> + '_ {
        self.changes.iter().map(|change| change.place)
    }

    /// Follows weights that change to other places in the list.
    pub(crate) fn renumber(&mut self, places: &HashMap<usize, usize>) {
        for change in &mut self.changes {
            change.place = places[&change.place];
        }
    }

    /// Particles whose row sums grow beyond those at the start, and by what at most.
    pub(crate) fn growing(&self) -> &[(u32, f64)] {
        &self.growing
    }

    /// Brings weights to a time (s), back again in a step that is made anew; whether anything changes.
    #[inline]
    pub fn bring_to(&mut self, time: f64, weights: &mut [f64]) -> bool {
        let before = self.done;
        while let Some(change) = self.changes.get(self.done).filter(|change| change.time <= time) {
            weights[change.place] = change.after;
            self.done += 1;
        }
        while let Some(change) = self.done.checked_sub(1).map(|k| self.changes[k]).filter(|change| change.time > time) {
            weights[change.place] = change.before;
            self.done -= 1;
        }
        self.done != before
    }
}

/// Rows whose sums grow beyond those at the start, and by what at most; changes are in order of time.
fn growing(pairs: &PairList, changes: &[Change]) -> Vec<(u32, f64)> {
    let row = |change: &Change| pairs.starts.partition_point(|start| *start <= change.place) - 1;
    let mut by_row: Vec<(usize, Change)> = changes.iter().map(|change| (row(change), *change)).collect();
    by_row.sort_by_key(|(row, _)| *row);
    let rows = by_row.chunk_by(|a, b| a.0 == b.0).map(|own| {
        let row = own[0].0;
        let start: f64 = pairs.weights[pairs.starts[row]..pairs.starts[row + 1]].iter().sum();
        let own: Vec<Change> = own.iter().map(|(_, change)| *change).collect();
        (row as u32, greatest(start, &own) / start)
    });
    rows.filter(|(_, growth)| *growth > 1.0).collect()
}

/// The greatest that a sum of weights becomes by changes in order of time.
fn greatest(start: f64, changes: &[Change]) -> f64 {
    let at_once = changes.chunk_by(|a, b| a.time == b.time);
    let sums = at_once.scan(start, |sum, changes| {
        *sum += changes.iter().map(|change| change.after - change.before).sum::<f64>();
        Some(*sum)
    });
    sums.fold(start, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(time: f64, place: usize, before: f64, after: f64) -> Change {
        Change { time, place, before, after }
    }

    #[test]
    fn cuts_go_with_time_in_either_direction() {
        let changes = vec![change(1.0, 2, 5.0, 0.0), change(1.0, 1, 6.0, 6.5), change(2.0, 0, 7.0, 0.0)];
        let mut cuts = Cuts { changes, ..Cuts::default() };
        let mut weights = [7.0, 6.0, 5.0];
        for (time, expected) in [(0.5, [7.0, 6.0, 5.0]), (1.0, [7.0, 6.5, 0.0]), (9.0, [0.0, 6.5, 0.0])] {
            cuts.bring_to(time, &mut weights);
            assert_eq!(weights, expected);
        }
        cuts.bring_to(1.5, &mut weights);
        assert_eq!(weights, [7.0, 6.5, 0.0]);
        cuts.bring_to(0.0, &mut weights);
        assert_eq!(weights, [7.0, 6.0, 5.0]);
    }

    #[test]
    fn a_pair_is_cut_once() {
        let changes = vec![change(1.0, 0, 5.0, 6.0), change(2.0, 0, 6.0, 0.0), change(1.0, 1, 4.0, 0.0)];
        let mut cuts = Cuts { changes, ..Cuts::default() };
        cuts.add(&[(1.5, 0, 5.0), (1.5, 1, 4.0), (1.5, 2, 3.0)]);
        let expected =
            [change(1.0, 0, 5.0, 6.0), change(1.0, 1, 4.0, 0.0), change(1.5, 0, 6.0, 0.0), change(1.5, 2, 3.0, 0.0)];
        assert_eq!(cuts.changes, expected);
        assert_eq!(greatest(5.0, &expected[..1]), 6.0);
    }
}
