//! Neighbour search behind one contract: every pair within a radius, in a fixed order.
//!
//! On a lattice no search is needed ([`crate::bonds::stencil`]). Uneven particles at rest are searched by a k-d tree, or by a
//! cell list if asked; [`all_pairs`] is the oracle that both are tested against.

pub mod all_pairs;
pub mod cells;
pub mod tree;

use glam::DVec2;

/// Neighbours of the first points of a set, in compressed rows.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NeighbourList {
    /// Start of each point's neighbours, and the end of the last.
    pub starts: Vec<usize>,
    /// Neighbours of all points, by increasing index within a point.
    pub partners: Vec<u32>,
}

impl NeighbourList {
    /// Neighbours of a point, by increasing index.
    pub fn of(&self, point: usize) -> &[u32] {
        &self.partners[self.starts[point]..self.starts[point + 1]]
    }

    /// Builds the list of the first `count` points from a search that reports each point's neighbours.
    pub(crate) fn collect(count: usize, mut search: impl FnMut(usize, &mut Vec<u32>)) -> Self {
        let mut list = NeighbourList { starts: Vec::with_capacity(count + 1), partners: Vec::new() };
        list.starts.push(0);
        let mut row = Vec::new();
        for point in 0..count {
            row.clear();
            search(point, &mut row);
            row.sort_unstable();
            row.dedup();
            list.partners.extend_from_slice(&row);
            list.starts.push(list.partners.len());
        }
        list
    }
}

/// A box that repeats: its extent (m) in each direction, or infinity where it does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period(pub DVec2);

impl Period {
    /// A space without repetition.
    pub const NONE: Period = Period(DVec2::INFINITY);

    /// The shortest image of a difference of positions.
    #[inline]
    pub fn shortest(&self, difference: DVec2) -> DVec2 {
        let wrap = |d: f64, period: f64| if period.is_finite() { d - period * (d / period).round() } else { d };
        DVec2::new(wrap(difference.x, self.0.x), wrap(difference.y, self.0.y))
    }
}

/// The contract: all points within `radius` (m, inclusive) of each of the first `count` points, the point itself
/// left out. Positions must be finite; a radius may not exceed half a period.
pub trait NeighbourSearch {
    /// Finds the neighbours.
    fn neighbours(&self, points: &[DVec2], count: usize, radius: f64, period: Period) -> NeighbourList;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn agree(points: &[DVec2], count: usize, radius: f64, period: Period) -> Result<(), TestCaseError> {
        let oracle = all_pairs::AllPairs.neighbours(points, count, radius, period);
        prop_assert_eq!(&tree::Tree.neighbours(points, count, radius, period), &oracle);
        prop_assert_eq!(&cells::Cells.neighbours(points, count, radius, period), &oracle);
        Ok(())
    }

    fn lattice(n: usize, spacing: f64, jitter: &[f64]) -> Vec<DVec2> {
        (0..n * n)
            .map(|k| {
                let shift = |j: usize| jitter.get(j % jitter.len().max(1)).copied().unwrap_or(0.0);
                DVec2::new((k % n) as f64 + shift(2 * k), (k / n) as f64 + shift(2 * k + 1)) * spacing
            })
            .collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn searches_agree_on_lattices(n in 1usize..20, spacing in 1e-3..10.0, ratio in 0.4..4.5, periodic: bool) {
            let points = lattice(n, spacing, &[]);
            let period = if periodic && n as f64 > 2.0 * ratio { Period(DVec2::splat(n as f64 * spacing)) } else { Period::NONE };
            // Off the shells, where rounding may decide: those are the stencil's business.
            let shell: f64 = f64::round(ratio * ratio) + 0.5;
            prop_assume!(period == Period::NONE || 2.0 * shell.sqrt() < n as f64);
            agree(&points, points.len(), shell.sqrt() * spacing, period)?;
        }

        #[test]
        fn searches_agree_on_jittered_lattices(n in 1usize..16, jitter in prop::collection::vec(-0.5..0.5f64, 1..97), ratio in 0.4..4.0) {
            let points = lattice(n, 0.1, &jitter);
            agree(&points, points.len() / 2 + 1, ratio * 0.1, Period::NONE)?;
        }

        #[test]
        fn searches_agree_on_random_clouds(seed in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 1..300), radius in 0.0..0.49, periodic: bool) {
            let points: Vec<DVec2> = seed.into_iter().map(DVec2::from).collect();
            agree(&points, points.len(), radius, if periodic { Period(DVec2::ONE) } else { Period::NONE })?;
        }

        #[test]
        fn neighbourhood_is_mutual(seed in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 1..200), radius in 0.0..0.4) {
            let points: Vec<DVec2> = seed.into_iter().map(DVec2::from).collect();
            let list = tree::Tree.neighbours(&points, points.len(), radius, Period::NONE);
            for i in 0..points.len() {
                for j in list.of(i) {
                    prop_assert!(list.of(*j as usize).contains(&(i as u32)));
                }
            }
        }
    }

    #[test]
    fn one_point_and_far_points_have_no_neighbours() {
        for points in [vec![DVec2::ZERO], vec![DVec2::ZERO, DVec2::X * 9.0]] {
            for list in [
                all_pairs::AllPairs.neighbours(&points, points.len(), 1.0, Period::NONE),
                tree::Tree.neighbours(&points, points.len(), 1.0, Period::NONE),
                cells::Cells.neighbours(&points, points.len(), 1.0, Period::NONE),
            ] {
                assert!(list.partners.is_empty());
                assert_eq!(list.starts.len(), points.len() + 1);
            }
        }
    }

    #[test]
    fn many_points_in_one_place_are_each_others_neighbours() {
        let points = vec![DVec2::new(0.3, 0.7); 50];
        agree(&points, 50, 0.1, Period::NONE).expect("coincident points");
        assert_eq!(tree::Tree.neighbours(&points, 50, 0.1, Period::NONE).partners.len(), 50 * 49);
    }
}
