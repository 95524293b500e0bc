//! A cell list: points sorted into square cells at least as wide as the radius.

use glam::{DVec2, I64Vec2};

use crate::neighbours::{NeighbourList, NeighbourSearch, Period};

/// Most cells along one direction: finer grids would cost more memory than the points.
const MOST_CELLS: f64 = 4096.0;

/// The cell list.
#[derive(Debug, Clone, Copy)]
pub struct Cells;

impl NeighbourSearch for Cells {
    fn neighbours(&self, points: &[DVec2], count: usize, radius: f64, period: Period) -> NeighbourList {
        let least = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let most = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let along = |least: f64, most: f64, period: f64| {
            let extent = if period.is_finite() { period } else { most - least };
            let cells = (extent / radius.max(extent / MOST_CELLS)).floor();
            if cells.is_finite() { (cells.max(1.0), extent / cells.max(1.0)) } else { (1.0, 1.0) }
        };
        let (nx, wx) = along(least.x, most.x, period.0.x);
        let (ny, wy) = along(least.y, most.y, period.0.y);
        let counts = I64Vec2::new(nx as i64, ny as i64);
        let size = DVec2::new(wx.max(f64::MIN_POSITIVE), wy.max(f64::MIN_POSITIVE));
        let repeats = [period.0.x.is_finite(), period.0.y.is_finite()];
        let cell = |point: DVec2| {
            let place = ((point - least) / size).floor();
            let inside = |place: f64, count: i64, repeats: bool| {
                if repeats { (place as i64).rem_euclid(count) } else { (place as i64).clamp(0, count - 1) }
            };
            I64Vec2::new(inside(place.x, counts.x, repeats[0]), inside(place.y, counts.y, repeats[1]))
        };
        let number = |cell: I64Vec2| (cell.y * counts.x + cell.x) as usize;
        // Counting sort: points of each cell side by side, by increasing index.
        let mut starts = vec![0usize; (counts.x * counts.y) as usize + 1];
        for point in points {
            starts[number(cell(*point)) + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0u32; points.len()];
        for (index, point) in points.iter().enumerate() {
            let slot = &mut next[number(cell(*point))];
            sorted[*slot] = index as u32;
            *slot += 1;
        }
        NeighbourList::collect(count, |i, found| {
            let home = cell(points[i]);
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let mut near = home + I64Vec2::new(dx, dy);
                    if repeats[0] {
                        near.x = near.x.rem_euclid(counts.x);
                    }
                    if repeats[1] {
                        near.y = near.y.rem_euclid(counts.y);
                    }
                    if near.x < 0 || near.y < 0 || near.x >= counts.x || near.y >= counts.y {
                        continue;
                    }
                    let cell = number(near);
                    for j in &sorted[starts[cell]..starts[cell + 1]] {
                        let difference = period.shortest(points[*j as usize] - points[i]);
                        if *j as usize != i && difference.length_squared() <= radius * radius {
                            found.push(*j);
                        }
                    }
                }
            }
        })
    }
}
