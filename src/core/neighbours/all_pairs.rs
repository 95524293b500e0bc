//! Every pair: slow, and right by inspection.

use glam::DVec2;

use crate::neighbours::{NeighbourList, NeighbourSearch, Period};

/// The oracle.
#[derive(Debug, Clone, Copy)]
pub struct AllPairs;

impl NeighbourSearch for AllPairs {
    fn neighbours(&self, points: &[DVec2], count: usize, radius: f64, period: Period) -> NeighbourList {
        NeighbourList::collect(count, |i, found| {
            for (j, point) in points.iter().enumerate() {
                if j != i && period.shortest(*point - points[i]).length_squared() <= radius * radius {
                    found.push(j as u32);
                }
            }
        })
    }
}
