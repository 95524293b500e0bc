//! Where particles stand on columns that a loop reads from end to end, whatever its neighbours are.

use std::ops::Range;

use glam::DVec2;

use crate::balances::groundwater::tasks::{TASK, share};
use crate::memory::HeapSize;
use crate::team::Team;

/// How far from its site a particle may stand, in spacings.
const ON_SITE: f64 = 1e-6;

/// Places of particles on a whole rectangle of lattice sites row by row, if the particles stand on such sites in that order.
pub(super) fn sites(starts: &[usize], partners: &[u32], positions: &[DVec2]) -> Option<Vec<usize>> {
    let ways = positions.iter().enumerate().flat_map(|(i, own)| {
        partners[starts[i]..starts[i + 1]].iter().map(|partner| own.distance(positions[*partner as usize]))
    });
    let spacing = ways.filter(|way| *way > 0.0).fold(f64::INFINITY, f64::min);
    let low = positions.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let columns = positions.iter().map(|place| ((place.x - low.x) / spacing).round()).fold(0.0, f64::max) as usize + 1;
    let sites = positions.iter().map(|place| {
        let site = (*place - low) / spacing;
        let stands = site.distance(site.round()) < ON_SITE;
        stands.then(|| site.y.round() as usize * columns + site.x.round() as usize)
    });
    let sites: Vec<usize> = sites.collect::<Option<_>>()?;
    sites.is_sorted_by(|a, b| a < b).then_some(sites)
}

/// Particles whose places follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    /// The first of them.
    first: usize,
    /// Its place.
    place: usize,
    /// Number of particles.
    count: usize,
}

/// The places of particles, in their order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places {
    /// Room before the first.
    pub room: usize,
    runs: Vec<Run>,
}

/// Consecutive places of particles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    /// How many of the particles that were asked for come before.
    pub before: usize,
    /// The place of the first.
    pub at: usize,
    /// Number of particles.
    pub count: usize,
}

impl Places {
    /// Particles at these places, ascending, with so much room before the first.
    pub fn new(places: &[usize], room: usize) -> Self {
        let mut runs: Vec<Run> = Vec::new();
        for (first, place) in places.iter().map(|place| room + place).enumerate() {
            match runs.last_mut() {
                Some(run) if place == run.place + run.count => run.count += 1,
                _ => runs.push(Run { first, place, count: 1 }),
            }
        }
        Places { room, runs }
    }

    /// The place of a particle.
    pub fn of(&self, particle: usize) -> usize {
        let run = &self.runs[self.runs.partition_point(|run| run.first + run.count <= particle)];
        run.place + particle - run.first
    }

    /// Number of particles.
    fn count(&self) -> usize {
        self.runs.last().map_or(0, |run| run.first + run.count)
    }

    /// Puts the values of particles on a column.
    pub fn spread(&self, team: Option<&Team>, values: &[f64], column: &mut [f64]) {
        self.fill(team, [column], |particles, [column]| column.copy_from_slice(&values[particles]));
    }

    /// Fills the places of particles on some columns: each part with what some particles have, whose places follow each other.
    pub(super) fn fill<const N: usize>(
        &self,
        team: Option<&Team>,
        mut columns: [&mut [f64]; N],
        one: impl Fn(Range<usize>, [&mut [f64]; N]) + Sync,
    ) {
        let (all, mut at) = (self.count(), 0);
        let parts = (0..all).step_by(TASK).map(|first| {
            let particles = first..all.min(first + TASK);
            let (from, to) = (self.of(first), self.of(particles.end - 1) + 1);
            let parts = columns.each_mut().map(|left| {
                let (part, after) = std::mem::take(left)[from - at..].split_at_mut(to - from);
                *left = after;
                part
            });
            at = to;
            (particles, from, parts)
        });
        share(team, all, parts, |(particles, from, mut parts)| {
            for Stretch { before, at, count } in self.stretches(particles.start, particles.len()) {
                let first = particles.start + before;
                one(first..first + count, parts.each_mut().map(|part| &mut part[at - from..][..count]));
            }
        });
    }

    /// Takes the values of particles, from `first` on, from a column that begins at a place.
    pub fn collect_from(&self, column: &[f64], (first, base): (usize, usize), values: &mut [f64]) {
        for Stretch { before, at, count } in self.stretches(first, values.len()) {
            values[before..before + count].copy_from_slice(&column[at - base..at - base + count]);
        }
    }

    /// Puts the values of particles, from `first` on, on a column that begins at a place.
    pub fn spread_from(&self, values: &[f64], (first, base): (usize, usize), column: &mut [f64]) {
        for Stretch { before, at, count } in self.stretches(first, values.len()) {
            column[at - base..at - base + count].copy_from_slice(&values[before..before + count]);
        }
    }

    /// The stretches of `count` particles from `first` on.
    pub(super) fn stretches(&self, first: usize, count: usize) -> impl DoubleEndedIterator<Item = Stretch> + '_ {
        let end = first + count;
        let from = self.runs.partition_point(|run| run.first + run.count <= first);
        let to = self.runs.partition_point(|run| run.first < end);
        self.runs[from..to].iter().map(move |run| {
            let (low, high) = (run.first.max(first), (run.first + run.count).min(end));
            Stretch { before: low - first, at: run.place + low - run.first, count: high - low }
        })
    }
}

impl HeapSize for Places {
    fn heap_size(&self) -> usize {
        self.runs.capacity() * size_of::<Run>()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Threads put on a column what one puts there, each value on the place of its particle, and nothing between.
        #[test]
        fn values_come_to_the_places_of_their_particles(
            gaps in prop::collection::vec((0_usize..3000, 1_usize..5), 0..12),
            count in 1_usize..40_000,
            room in 0_usize..40,
        ) {
            let mut more = vec![0; count];
            for (at, wide) in gaps.iter().filter(|gap| gap.0 < count) {
                more[*at] += wide;
            }
            let mut before = 0;
            let on: Vec<usize> = (0..count).map(|i| { before += more[i]; i + before }).collect();
            let places = Places::new(&on, room);
            let values: Vec<f64> = (0..count).map(|i| 1.0 + i as f64).collect();
            let mut expected = vec![0.0; room + on[count - 1] + 1];
            for (i, place) in on.iter().enumerate() {
                expected[room + place] = values[i];
                prop_assert_eq!(places.of(i), room + place);
            }
            for threads in [1, 3] {
                let team = Team::new(threads).expect("threads");
                let mut columns = [vec![0.0; expected.len()], vec![0.0; expected.len() + 7]];
                let [first, second] = &mut columns;
                places.fill(team.as_ref(), [first, second], |particles, [first, second]| {
                    first.copy_from_slice(&values[particles.clone()]);
                    second.copy_from_slice(&values[particles]);
                });
                prop_assert_eq!(&columns[0], &expected);
                prop_assert_eq!(&columns[1][..expected.len()], &expected[..]);
                let mut single = vec![0.0; expected.len()];
                places.spread(team.as_ref(), &values, &mut single);
                prop_assert_eq!(&single, &expected);
            }
        }
    }
}
