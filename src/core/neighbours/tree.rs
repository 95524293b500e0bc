//! A k-d tree (kiddo), for uneven particles at rest.

use glam::DVec2;
use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::neighbours::all_pairs::AllPairs;
use crate::neighbours::{NeighbourList, NeighbourSearch, Period};

/// Relative widening of the tree's query; the exact test is ours, so that all searches decide alike.
const WIDENING: f64 = 1.0 + 1e-9;

/// The tree.
#[derive(Debug, Clone, Copy)]
pub struct Tree;

impl NeighbourSearch for Tree {
    fn neighbours(&self, points: &[DVec2], count: usize, radius: f64, period: Period) -> NeighbourList {
        let coordinates: Vec<[f64; 2]> = points.iter().map(|point| point.to_array()).collect();
        let Ok(tree) = ImmutableKdTree::<f64, 2>::new_from_slice(&coordinates) else {
            return AllPairs.neighbours(points, count, radius, period);
        };
        let squared = radius * radius * WIDENING + f64::MIN_POSITIVE;
        let shifts = |period: f64| if period.is_finite() { vec![0.0, -period, period] } else { vec![0.0] };
        let images: Vec<DVec2> = shifts(period.0.y)
            .into_iter()
            .flat_map(|y| shifts(period.0.x).into_iter().map(move |x| DVec2::new(x, y)))
            .collect();
        NeighbourList::collect(count, |i, found| {
            for shift in &images {
                let place = (points[i] + *shift).to_array();
                tree.query(&place).within::<SquaredEuclidean<f64>>(squared).unsorted().visit(|hit| {
                    let j = hit.item as usize;
                    let difference = period.shortest(points[j] - points[i]);
                    if j != i && difference.length_squared() <= radius * radius {
                        found.push(j as u32);
                    }
                });
            }
        })
    }
}
